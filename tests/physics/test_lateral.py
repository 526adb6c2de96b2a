"""Lateral systems of the library against a model without a mesh, their twin, statics and limits.

Closed forms are in `test_lateral_twin`, which holds both the library and its twin against them.
"""

from __future__ import annotations

import itertools
import math
import pickle
from dataclasses import fields, replace
from typing import Any

import hypothesis.strategies as st
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings

import cardan
import tiers
from cardan import ElasticBearing, LateralSystem, Load, PointMass, RigidShaft, Unbalance, reference
from cardan.lateral import LateralResponse
from cardan.lateral.results import VECTORS
from cardan.reference import lateral as twin
from lateral_cases import (
    BENDING,
    CASES,
    LINE,
    TUBE,
    between_machines,
    check,
    library,
    load,
    load_of,
    pinned,
    probes_of,
    rigid_limit,
    speeds_of,
    system_of,
    two_piece,
)
from refusals import refusals

mp = mpmath.mp.clone()

POINTS = [(0, 0, 0), (0.3, 0, 0), (1.5, 0.06, 0.05), (3.2, 0.3, 0), (3.5, 0.3, 0)]
DRIVEN = Load(drive_torque=1500.0)


def points_of(*heights: float) -> cardan.Driveline:
    return cardan.Driveline.from_points(
        [(x, y + h, z) for (x, y, z), h in zip(POINTS, heights, strict=True)]
    )


def simple(**options: Any) -> LateralSystem:  # noqa: ANN401 - arguments of a system
    """Two rods on a centre bearing, or what the options make of them."""
    rod = RigidShaft(10.0, 0.6, 1.0)
    own: dict[str, Any] = {
        "line": cardan.Driveline.from_points(POINTS),
        "shafts": [None, rod, rod, None],
        "bearings": [ElasticBearing(1, 1.1, 3e5)],
    }
    return LateralSystem(**(own | options))


# --- a model without a mesh ----------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_systems_are_those_of_the_model_without_elements(name: str) -> None:
    case = CASES[name]
    system = library(system_of(case))
    assert library(replace(system_of(case), sliding=None)).sliding == tuple(case["sliding"])
    frequencies = system.natural_frequencies(len(case["natural_frequencies_rad_s"]))
    response = system.response(
        speeds_of(case), load(load_of(case)), case["orders"], probes_of(case)
    )
    check(case, frequencies, response, 1e-11, 1e-12)


# --- the twin ------------------------------------------------------------------------------------


def mixed(step: float = 0.2) -> twin.System:
    """A driveline in space with all that there is: rigid shafts, both theories, two directions."""
    points = [
        (0, 0, 0),
        (0.4, 0, 0),
        (1.5, -0.1, 0.1),
        (2.7, -0.2, 0),
        (3.9, -0.5, -0.1),
        (4.3, -0.5, 0),
    ]
    skew = {"loss_factor": (0.1, 0.2), "damping": (150.0, 50.0)}
    return twin.System(
        reference.from_points(points, [0.3, 1.2, -0.5]),
        [math.dist(p, q) for p, q in itertools.pairwise(points)],
        [
            twin.RigidShaft(80.0, 0.1, 6.0, 1.0),
            replace(TUBE, shear_coefficient=0.53, loss_factor=0.02),
            replace(TUBE, loss_factor=0.01),
            twin.RigidShaft(15.0, 0.6, 2.0, 0.1),
            None,
        ],
        [
            twin.ElasticBearing(0, 0.05, (2e6, 2e6), None, 0.1),
            twin.ElasticBearing(0, 0.3, (1e6, 1e6), None, 0.05),
            twin.ElasticBearing(1, 0.9, (3e5, 2e5), (0, 1, 1), **skew),
            twin.ElasticBearing(2, 1.1, (4e5, 3e5), (0, 1, 0), **skew),
        ],
        [
            twin.PointMass(1, 0.3, 3.0, 0.02, 0.03),
            twin.PointMass(1, 0.7, 2.0, 0.01, 0.02),
            twin.PointMass(2, 0.5, 4.0, 0.05, 0.1),
            twin.PointMass(3, 0.2, 3.0, 0.02, 0.02),
        ],
        [twin.Unbalance(1, 0.5, 5e-4, (0, 1, 0)), twin.Unbalance(2, 0.8, 3e-4, (0, 0, 1))],
        step=step,
    )


PLACES = [(0, 0.1), (1, 0.0), (1, 0.5), (1, 0.62), (2, 0.9), (3, 0.7), (4, 0.2)]
INERTIAS = {"output_torque": 900.0, "inertias": [0.1, 0.05, 0.02, 0.03, 0.4]}


def furthest(found: LateralResponse, known: Any) -> float:  # noqa: ANN401 - a response of either
    """Return the largest difference, by the largest number of its kind and order.

    An order counts as at least 1e-4 of the largest.
    """
    off = []
    for field in fields(found):
        if field.name == "orders":
            continue
        own, other = getattr(found, field.name), getattr(known, field.name)
        axis = -2 if field.name in VECTORS else -1
        parts = (np.moveaxis(x, axis, 0).reshape(x.shape[axis], -1) for x in (own - other, other))
        errors, sizes = (np.max(np.abs(part), axis=1, initial=0.0) for part in parts)
        if np.max(sizes) > 1e-15:
            off.append(np.max(errors / np.maximum(sizes, 1e-4 * np.max(sizes))))
        else:
            assert np.max(errors) < 1e-15, field.name
    return float(max(off, default=0.0))


def test_a_system_of_everything_against_the_twin() -> None:
    system = mixed()
    own, speeds, orders = library(system), np.array([20.0, 90.0, -150.0]), [0, 1, 1.5, 2, 4]
    assert own.sliding == system.slides
    found = own.natural_frequencies(12)
    assert found == pytest.approx(system.natural_frequencies(12), rel=2e-8)
    options = INERTIAS | {"acceleration": 0.0}
    known = system.response(speeds, options, orders, PLACES, turns=2)
    assert furthest(own.response(speeds, load(options), orders, PLACES), known) < 2e-8
    stiffness, other = own.torque_stiffness(900.0), system.torque_stiffness(900.0)
    assert np.max(np.abs(stiffness.mean - other.mean)) < 1e-5
    assert np.max(np.abs(stiffness.turning - other.turning)) < 1e-5
    assert stiffness.kappa == pytest.approx(other.kappa, rel=1e-7)
    for speed in (80.0, 130.0):
        limit = float(own.largest_stable_torque(speed))
        assert own.is_stable(speed, 0.999 * limit) == system.is_stable(speed, 0.999 * limit)
        assert own.is_stable(speed, 1.001 * limit) == system.is_stable(speed, 1.001 * limit)


@pytest.mark.parametrize("shear", [None, 0.53])
def test_elements_of_the_twin_converge_to_the_library(shear: float | None) -> None:
    """With the eighth power of their length, also between masses."""
    tube, length = replace(TUBE, shear_coefficient=shear, loss_factor=0.01), 1.6
    errors = []
    for step in (0.4, 0.2):
        system = replace(
            between_machines(tube, length, (0.1, -0.15), step),
            masses=[twin.PointMass(1, 0.8, 3.0, 0.02)],
        )
        # Near the second pair of modes, which the mass hardly moves.
        speeds = 0.45 * pinned(tube, length, 2) * np.array([0.9, 1.0])
        known = system.response(speeds, {"drive_torque": 900.0}, [2], [(1, 0.4)])
        found = library(system).response(speeds, Load(drive_torque=900.0), [2], [(1, 0.4)])
        errors.append(np.max(np.abs(found.displacement / known.displacement - 1.0)[..., 1:]))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.4)


lengths = st.floats(0.5, 2.0)
shares = st.floats(0.05, 0.95)
stiffnesses = st.floats(1e5, 3e6)


@st.composite
def systems(draw: st.DrawFn) -> tuple[twin.System, list[tuple[int, float]]]:
    """Up to three shafts between machines, each with a bearing and perhaps a mass, and probes."""
    count = draw(st.integers(1, 3))
    bends = draw(st.lists(st.floats(-0.3, 0.3), min_size=count + 1, max_size=count + 1))
    slopes = np.cumsum([0.0, *bends])
    aside = draw(st.floats(-0.2, 0.2))
    directions = [(1.0, math.tan(x), aside * i % 0.3) for i, x in enumerate(slopes)]
    phases = draw(st.lists(st.floats(-3.0, 3.0), min_size=count, max_size=count))
    own = [0.3, *draw(st.lists(lengths, min_size=count, max_size=count)), 0.3]
    shafts: list[Any] = [None]
    for i in range(1, count + 1):
        # Joints alone hold a rigid shaft between machines.
        kind = draw(st.sampled_from(["Euler", "Timoshenko", "rigid"][: 3 if count > 1 else 2]))
        if kind == "rigid":
            mass, centre = draw(st.floats(2.0, 30.0)), own[i] * draw(shares)
            shafts.append(twin.RigidShaft(mass, centre, mass * draw(st.floats(0.01, 0.3)), 0.1))
        else:
            tube = twin.Tube(draw(st.floats(0.05, 0.12)), 0.003, loss_factor=0.02)
            shafts.append(replace(tube, shear_coefficient=None if kind == "Euler" else 0.5))
    bearings = []
    for i in range(1, count + 1):
        stiff = draw(stiffnesses), draw(stiffnesses)
        axis = draw(st.tuples(st.just(0.1), st.just(1.0), st.floats(-2.0, 2.0)))
        bearings.append(
            twin.ElasticBearing(
                i, own[i] * draw(shares), stiff, axis, 0.15, draw(st.floats(0.0, 300.0))
            )
        )
    masses = [
        twin.PointMass(i, own[i] * draw(shares), draw(st.floats(0.0, 5.0)), 0.02, 0.03)
        for i in draw(st.sets(st.integers(1, count)))
    ]
    unbalance = [twin.Unbalance(1, own[1] * draw(shares), 1e-3, (0.0, 1.0, 0.3))]
    probes = [(i, own[i] * draw(shares)) for i in range(1, count + 1)]
    line = reference.from_directions(directions, phases)
    return twin.System(line, own, [*shafts, None], bearings, masses, unbalance), probes


@settings(max_examples=tiers.part(80))
@given(systems(), st.floats(1.0, 120.0))
def test_random_systems_against_the_twin(
    drawn: tuple[twin.System, list[tuple[int, float]]], speed: float
) -> None:
    system, probes = drawn
    own, orders = library(system), [0, 1, 2, 4]
    options = {"drive_torque": 500.0, "inertias": [0.05] * len(system.lengths)}
    found = own.response(speed, load(options), orders, probes)
    known = system.response(speed, options, orders, probes)
    assert furthest(found, known) < 1e-6
    # Where bearings hardly move, what is lost is a small part of the product of force and velocity,
    # to which rounding is relative.
    lost = found.bearing_power.sum(axis=0) + found.tube_power
    assert found.given_power == pytest.approx(lost, rel=1e-9, abs=1e-12 * np.max(lost))
    # Waves that are long beside the elements of the twin.
    lowest = system.natural_frequencies(3)
    lowest = lowest[lowest < 3000.0]
    assert own.natural_frequencies(3)[: len(lowest)] == pytest.approx(lowest, rel=1e-6)


# --- tubes without a mesh ------------------------------------------------------------------------


@pytest.mark.parametrize("shear", [None, 0.5224])
def test_modes_of_a_pinned_tube(shear: float | None) -> None:
    """Their frequencies are roots of a quadratic equation, their shapes are sines."""
    tube, length = replace(TUBE, shear_coefficient=shear), 1.6
    system = library(between_machines(tube, length))
    places = np.linspace(0.0, length, 13)
    modes = system.modes(12, [(1, place) for place in places])
    numbers = np.repeat(np.arange(1, 7), 2)
    wanted = [pinned(tube, length, mode) for mode in numbers.tolist()]
    assert modes.frequencies == pytest.approx(wanted, rel=2e-12)
    sizes = np.linalg.norm(modes.displacement, axis=-1)
    sines = np.abs(np.sin(np.multiply.outer(places * math.pi / length, numbers)))
    assert np.max(np.abs(sizes - sines / np.max(sines, axis=0))) < 1e-8
    if shear is None:
        slowest = cardan.tube(0.09, 0.003, length=length).critical_speed
        assert modes.frequencies[::2] / slowest == pytest.approx([1, 4, 9, 16, 25, 36], rel=4e-12)


@pytest.mark.parametrize("bends", [(0.1, -0.1), (0.1, 0.25)])
@pytest.mark.parametrize("share", [1e-3, 0.2, 0.45, 0.6, 0.9])
def test_a_tube_between_machines(share: float, bends: tuple[float, float]) -> None:
    """By the couples of the joints themselves, and not those of small bends."""
    length, torque = 1.5074813, Load(drive_torque=1500.0)
    system = library(between_machines(TUBE, length, bends))
    speed = share * pinned(TUBE, length, 1)
    response = system.response(speed, torque, [2], [(1, length / 2.0)])
    moments = system.line.harmonics([2], outputs="moment", load=torque)
    first, last = moments.complex_amplitude["moment"][..., 0]
    # Half the difference of the couples conjugate to the slopes at both ends.
    couple = (np.cross(first, u := system.line.directions[1]) + np.cross(last, u)) / 2.0
    wave = math.sqrt(2.0 * speed * math.sqrt(LINE / BENDING))
    x = wave * length / 2.0
    middle = couple / (2.0 * BENDING * wave**2) * (1.0 / math.cos(x) - 1.0 / math.cosh(x))
    # The difference of both terms has lost digits.
    close = 1e-12 / min(1.0, x**2)
    assert response.displacement[0, 0] == pytest.approx(middle, abs=close * np.max(np.abs(middle)))
    force = couple * wave / 2.0 * (math.tan(x) - math.tanh(x))
    borne = (response.joint_force[0, 0] - response.joint_force[1, 0]) / 2.0
    # Statics of either couple alone is what rounding is small beside.
    close = 1e-11 * np.max(np.abs(force)) + 1e-15 * np.max(np.abs(couple)) / length
    assert borne == pytest.approx(-force, abs=close)


# --- limits --------------------------------------------------------------------------------------


@pytest.mark.parametrize("bending", [False, True], ids=["rods", "tubes"])
def test_stiff_bearings_and_slow_turns_are_the_statics_of_the_package(bending: bool) -> None:
    system, options, places = rigid_limit()
    if bending:
        system = replace(system, shafts=[None, TUBE, TUBE, TUBE, None])
    own, given = library(system), Load(**options)
    line, orders = own.line.with_bearings(places), [0, 2, 4, 6]
    found = own.response(0.01 * math.pi / 30.0, given, orders)
    outputs = ["bearing_force", "joint_force"]
    known = line.harmonics(orders[1:], outputs=outputs, load=given)
    for name in outputs:
        mean, others = known.mean[name], np.moveaxis(known.complex_amplitude[name], -1, 1)
        wanted = np.concatenate([mean[:, np.newaxis], others], axis=1)
        size = np.max(np.abs(wanted), axis=(0, 2))[:, np.newaxis]
        close = (1e-9 if bending else 1e-11) * np.maximum(size, 1e-3 * np.max(size))
        assert np.all(np.abs(getattr(found, name) - wanted) < close), name


def test_a_torsional_motion_brings_its_orders() -> None:
    """Shafts without mass follow the torque of each instant, whatever the speed."""
    system, _, places = rigid_limit()
    massless = [None, *[twin.RigidShaft(0.0, 0.5, 0.0)] * 3, None]
    own = library(replace(system, shafts=massless))
    inf = math.inf
    torsional = cardan.TorsionalSystem(
        own.line.with_bearings(places),
        inertias=[[0.0, 0.0], [0.0, 0.05], [0.02, 0.1], [0.03, 0.0], [0.0, 0.4]],
        stiffnesses=[inf, 20000.0, 30000.0, inf, inf],
        dampings=[0.0, 2.0, 3.0, 0.0, 0.0],
        load_torque=500.0,
    )
    speeds, orders = np.array([60.0, 95.0]), [0, 1, 2, 4, 6]
    motion = torsional.steady(speeds)
    found = own.response(speeds, motion, orders).bearing_force
    samples = motion.evaluate(64, "bearing_force").bearing_force
    spectrum = np.fft.fft(samples, axis=-2) / 64
    turns = torsional.period_turns
    size = np.max(np.abs(samples))
    for i, order in enumerate(orders):
        number = order * turns
        wanted = (1.0 if order == 0 else 2.0) * spectrum[..., round(number), :]
        if number != round(number):
            wanted = 0.0 * wanted
        assert np.max(np.abs(found[:, :, i] - wanted)) < 1e-9 * size
    assert np.max(np.abs(found[:, :, 3])) > 0.01 * size
    high = own.response(speeds, motion, [300]).bearing_force
    assert np.max(np.abs(high)) < 1e-9 * size
    steady = own.response(speeds, Load(drive_torque=500.0), orders).bearing_force
    assert np.max(np.abs(steady[:, :, 3])) < 1e-9 * size


def test_a_constant_torque_of_the_output_brings_order_4() -> None:
    """By the square of the tangent of half the bend, of a driven end at 25 degrees."""
    line = cardan.Driveline.from_points([(0, 0, 0), (1, 0, 0), (2, math.tan(math.radians(25)), 0)])
    bearings = [ElasticBearing(1, at, 1e9) for at in (0.2, 0.9)]
    system = LateralSystem(line, shafts=[None, RigidShaft(0.0, 0.5, 0.0)], bearings=bearings)
    force = system.response(1.0, Load(output_torque=100.0), [2, 4]).bearing_force
    second, fourth = np.max(np.abs(force), axis=(0, 2))
    assert fourth / second == pytest.approx(math.tan(math.radians(12.5)) ** 2, rel=0.02)
    driven = system.response(1.0, Load(drive_torque=100.0), [2, 4]).bearing_force
    assert np.max(np.abs(driven[:, 1])) < 1e-12 * np.max(np.abs(driven[:, 0]))


def test_a_redundant_joint_bears_a_force() -> None:
    """With two bearings on each shaft, statics takes it as zero; no elastic model does."""
    line = cardan.Driveline.from_points([(0, 0, 0), (1, 0, 0), (2, math.tan(math.radians(8)), 0)])
    places = [(0, 0.2), (0, 0.8), (1, 0.2), (1, 0.8)]
    system = LateralSystem(
        line,
        shafts=[RigidShaft(20.0, 0.5, 2.0), RigidShaft(20.0, 0.5, 2.0)],
        bearings=[
            ElasticBearing(shaft, at, k)
            for (shaft, at), k in zip(places, (1e6, 2e6, 3e6, 1e6), strict=True)
        ],
    )
    assert system.sliding == (1,)
    known = line.with_bearings(places).harmonics(
        [2], outputs="joint_force", load=Load(drive_torque=900.0)
    )
    assert np.max(np.abs(known.complex_amplitude["joint_force"])) == 0.0
    force = system.response(1.0, Load(drive_torque=900.0), [2]).of_order("joint_force")
    assert 5.0 < force[0, 0] < 100.0


# --- arrays --------------------------------------------------------------------------------------


def batch() -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """A batch (2, 3) of the mixed system, and each of its systems alone."""
    whole = library(mixed())
    stiff = np.array([2e5, 3e5, 4e5])
    moved = np.array([[[0.0]], [[0.02]]])
    points = np.array(
        [
            [0, 0, 0],
            [0.4, 0, 0],
            [1.5, -0.1, 0.1],
            [2.7, -0.2, 0],
            [3.9, -0.5, -0.1],
            [4.3, -0.5, 0],
        ]
    )
    lines = cardan.Driveline.from_points(
        points + moved * np.eye(6)[2][:, np.newaxis], [0.3, 1.2, -0.5]
    )

    def options(line: cardan.Driveline, k: Any, at: Any) -> dict[str, Any]:  # noqa: ANN401
        bearings = list(whole.bearings)
        bearings[2] = replace(bearings[2], stiffness=np.stack([k, 0.7 * k], axis=-1))
        masses = [replace(whole.masses[0], position=at), *whole.masses[1:]]
        return {
            "line": line,
            "shafts": whole.shafts,
            "bearings": bearings,
            "masses": masses,
            "unbalance": whole.unbalance,
        }

    at = np.array([[0.25], [0.35]])
    each = [options(lines[i], stiff[j], at[i, 0]) for i in range(2) for j in range(3)]
    return options(lines.reshape(2, 1), stiff, at), each


def test_a_batch_is_its_systems_bit_for_bit() -> None:
    options, each = batch()
    system = LateralSystem(**options)
    assert system.shape == (2, 3)
    assert system.lengths.shape == (2, 3, 5)
    speeds = np.linspace(10.0, 150.0, 4)
    given = Load(drive_torque=np.array([500.0, 800.0])[:, np.newaxis, np.newaxis, np.newaxis])
    response = system.response(speeds[:, np.newaxis, np.newaxis], given, (0, 1, 2), PLACES)
    assert response.bearing_force.shape == (4, 2, 4, 2, 3, 3, 3)
    modes, stiffness = system.modes(5, PLACES), system.torque_stiffness([[500.0], [800.0]])
    stable = system.largest_stable_torque(speeds[:, np.newaxis, np.newaxis])
    assert stable.shape == (4, 2, 3)
    for i, own in enumerate(each):
        place = divmod(i, 3)
        alone = LateralSystem(**own)
        for j, torque in enumerate((500.0, 800.0)):
            found = alone.response(speeds, Load(drive_torque=torque), (0, 1, 2), PLACES)
            for field in fields(found):
                if field.name != "orders":
                    of_batch, of_one = getattr(response, field.name), getattr(found, field.name)
                    axes = of_one.ndim - of_batch.ndim + 3
                    first = (slice(None),) * (field.name not in ("tube_power", "given_power"))
                    at = (*first, j, slice(None), *place)
                    np.testing.assert_array_equal(
                        of_batch[at], of_one, err_msg=f"{field.name} {axes}"
                    )
        np.testing.assert_array_equal(modes.frequencies[place], alone.modes(5).frequencies)
        np.testing.assert_array_equal(
            modes.displacement[(slice(None), *place)], alone.modes(5, PLACES).displacement
        )
        own_stiffness = alone.torque_stiffness((500.0, 800.0)[place[0]])
        np.testing.assert_array_equal(stiffness.mean[place], own_stiffness.mean)
        np.testing.assert_array_equal(stiffness.kappa[place], own_stiffness.kappa)
        np.testing.assert_array_equal(
            stable[(slice(None), *place)], alone.largest_stable_torque(speeds)
        )


def test_no_bit_depends_on_threads() -> None:
    system, speeds = library(mixed()), np.linspace(1.0, 200.0, 333)
    first, *others = (
        system.response(speeds, DRIVEN, workers=workers) for workers in (1, 2, 4, None)
    )
    for other in others:
        for field in fields(first):
            np.testing.assert_array_equal(getattr(first, field.name), getattr(other, field.name))
    alone = system.response(speeds[77], DRIVEN)
    np.testing.assert_array_equal(first.bearing_force[:, 77], alone.bearing_force)


def test_the_largest_value_over_the_turn() -> None:
    rng = np.random.default_rng(2)
    response = simple().response(np.ones(40), DRIVEN, orders := (0, 0.5, 1, 2, 4))
    vectors = rng.normal(size=(1, 40, 5, 3)) + 1j * rng.normal(size=(1, 40, 5, 3))
    vectors[..., 0, :] = vectors[..., 0, :].real
    response = replace(response, bearing_force=vectors)
    found = response.largest("bearing_force")
    assert found.shape == (1, 40)
    turns = np.linspace(0.0, 4.0 * math.pi, 20001)
    sampled = np.einsum("ak,ijkx->ijax", np.exp(1j * np.multiply.outer(turns, orders)), vectors)
    wanted = np.max(np.linalg.norm(sampled.real, axis=-1), axis=-1)
    assert found == pytest.approx(wanted, rel=1e-6)
    assert np.all(found >= wanted * (1.0 - 1e-13))
    assert found == pytest.approx(twin.largest(vectors, orders), rel=1e-12)
    each = response.of_order("bearing_force")
    assert each.shape == (1, 40, 5)
    for i, order in enumerate(orders):
        one = replace(response, orders=np.array([order]), bearing_force=vectors[..., i : i + 1, :])
        assert each[..., i] == pytest.approx(one.largest("bearing_force"), rel=1e-13)


def test_a_pickle_is_the_same_system() -> None:
    options, _ = batch()
    for system in (library(mixed()), LateralSystem(**options, sliding=[1, 1, 2, 3])):
        again = pickle.loads(pickle.dumps(system))
        assert again.sliding == system.sliding
        assert repr(again) == repr(system)
        first, second = (own.response(50.0, DRIVEN, probes=PLACES) for own in (system, again))
        for field in fields(first):
            np.testing.assert_array_equal(getattr(first, field.name), getattr(second, field.name))


# --- frequencies and resonances ------------------------------------------------------------------


def test_shapes_of_rods_by_their_motion() -> None:
    """Rods between machines turn about their far ends; the bearing is not at the joint."""
    system = library(two_piece([0.05, 0.16, 0.07]))
    modes = system.modes(4, [(1, 0.0), (1, 0.625), (1, 1.25), (2, 0.0), (2, 1.75)])
    assert np.isinf(modes.frequencies[2:]).all()
    assert np.isnan(modes.displacement[:, 2:]).all()
    sizes = np.linalg.norm(modes.displacement[:, :2], axis=-1)
    # The mode in the plane of the bend moves the second rod by the cosine only.
    assert sizes == pytest.approx(
        np.array([[0, 0], [0.5, 0.5], [1, 1], sizes[3], [0, 0]]), abs=1e-12
    )
    assert sorted(sizes[3]) == pytest.approx([math.cos(0.16), 1.0], rel=1e-12)
    one, other = np.moveaxis(modes.displacement[2, :2], 0, 0)
    assert abs(one @ other) < 1e-12


def test_resonances_are_where_orders_meet_natural_frequencies() -> None:
    system = library(system_of(CASES["truck"]))
    frequencies = system.natural_frequencies(12)
    found = system.resonances((20.0, 400.0), orders=(1, 2, 4))
    assert [own.speed for own in found] == sorted(own.speed for own in found)
    wanted = sorted(w / k for w in frequencies for k in (1, 2, 4) if 20.0 <= w / k <= 400.0)
    assert [own.speed for own in found] == pytest.approx(wanted, rel=1e-12)
    for own in found:
        assert own.speed * own.order == pytest.approx(own.frequency, rel=1e-15)
        assert np.linalg.norm(own.direction) == pytest.approx(1.0, rel=1e-12)
        assert np.dot(own.direction, system.line.directions[own.shaft]) == pytest.approx(
            0.0, abs=1e-9
        )
    # On soft rubber joint 1 moves most, then the middle of the longer shaft.
    assert (found[0].shaft, found[0].position) in ((1, system.lengths[1]), (2, 0.0))
    of_tube = next(own for own in found if own.frequency > 400.0)
    assert of_tube.shaft == 2
    assert of_tube.position == pytest.approx(system.lengths[2] / 2.0, rel=0.3)
    assert system.resonances((1.0, 2.0)) == ()


def test_resonance_without_damping() -> None:
    """Near it the amplitude grows with the inverse of the distance."""
    system = library(two_piece([0.05, 0.1, 0.07]))
    speed = system.natural_frequencies(1)[0] / 2.0
    off = speed * (1.0 + np.array([1e-6, 1e-5, 1e-4]))
    moved = system.response(off, DRIVEN, [2]).of_order("bearing_displacement")[0, :, 0]
    assert moved[:2] / moved[1:] == pytest.approx([10.0, 10.0], rel=1e-3)
    at = system.response(speed, DRIVEN, [2]).of_order("bearing_displacement")[0, 0]
    assert not at < 1e4 * moved[0]


# --- stubborn cases ------------------------------------------------------------------------------


def test_speed_zero_is_the_limit_of_slow_turns() -> None:
    own = library(mixed())
    orders, options = [0, 2, 4], Load(output_torque=900.0)
    still, slow = (own.response(speed, options, orders, PLACES) for speed in (0.0, 1e-7))
    for name in VECTORS:
        one, other = getattr(still, name), getattr(slow, name)
        # A loss factor has a sign that jumps at 0, so order 0 and its real parts are compared.
        size = np.max(np.abs(other))
        assert np.max(np.abs(one[:, 0] - other[:, 0])) < 1e-9 * size
        assert np.isfinite(one).all()
    assert np.max(np.abs(still.bearing_power)) == 0.0
    nothing = own.response(0.0, None, [1])
    assert np.max(np.abs(nothing.bearing_force)) == 0.0


def test_a_mean_has_no_imaginary_part() -> None:
    response = library(mixed()).response([0.0, 80.0], DRIVEN, [0], PLACES)
    for name in VECTORS:
        vectors = getattr(response, name)
        assert np.max(np.abs(vectors.imag)) <= 1e-12 * np.max(np.abs(vectors)), name


class Digits:
    """A tube of Euler and Bernoulli between machines in one direction, with 40 digits.

    Args:
        speed: of the vibration in rad/s.
        points: position, stiffness and mass of what is attached, along the tube.
    """

    length = 1.6

    def __init__(self, speed: Any, points: list[tuple[float, float, float]]) -> None:  # noqa: ANN401
        mp.dps = 40
        matrix = mp.zeros(4)
        matrix[0, 1], matrix[3, 2] = 1, -1
        matrix[1, 3], matrix[2, 0] = 1 / mp.mpf(BENDING), -mp.mpf(LINE) * mp.mpf(speed) ** 2
        whole, last, self.states = mp.eye(4), mp.mpf(0), []
        for at, stiffness, mass in [*points, (self.length, 0.0, 0.0)]:
            whole = mp.expm(matrix * (mp.mpf(at) - last), method="taylor") * whole
            self.states.append(whole)
            point, last = mp.eye(4), mp.mpf(at)
            point[2, 0] = stiffness - mass * mp.mpf(speed) ** 2
            whole = point * whole
        # Displacement and moment at the start are 0, slope and force are not.
        self.ends = mp.matrix([[whole[0, 1], whole[0, 2]], [whole[3, 1], whole[3, 2]]])

    def determinant(self) -> Any:  # noqa: ANN401 - a number of mpmath
        return mp.det(self.ends)

    def displacement(self, couple: float) -> float:
        """Return that of the first point under a couple at the end."""
        slope, force = mp.lu_solve(self.ends, mp.matrix([0, couple]))
        return float(self.states[0][0, 1] * slope + self.states[0][0, 2] * force)


def bearing_and_mass(at: float, mass: float) -> LateralSystem:
    """The same tube with a bearing at some place and a mass in its middle, or the other way."""
    line = cardan.Driveline.from_points([(0, 0, 0), (0.3, 0, 0), (1.9, 0, 0), (2.2, 0.1, 0)])
    bearing, place = (at, 0.8) if mass == 0.0 else (0.8, at)
    return LateralSystem(
        line,
        shafts=[None, cardan.tube(0.09, 0.003, length=1.0), None],
        bearings=[ElasticBearing(1, bearing, 3e5)],
        masses=[PointMass(1, place, mass)],
    )


@pytest.mark.parametrize(("at", "close"), [(0.3, 1e-13), (2e-3, 1e-10), (1e-4, 1e-9), (1e-5, 1e-7)])
@pytest.mark.parametrize("speed", [100.0, 600.0])
def test_digits_that_a_bearing_near_an_end_costs(at: float, close: float, speed: float) -> None:
    """Closer than a few ten thousandths of the length it moves with the end as if rigid."""
    system, torque = bearing_and_mass(at, 0.0), Load(drive_torque=100.0)
    moved = system.response(speed / 2.0, torque, [2]).bearing_displacement[0, 0]
    moments = system.line.harmonics([2], outputs="moment", load=torque)
    couple = -np.cross(moments.complex_amplitude["moment"][1, :, 0], system.line.directions[1])
    wanted = Digits(speed, [(at, 3e5, 0.0)]).displacement(1.0) * couple
    assert np.max(np.abs(moved - wanted)) < close * np.max(np.abs(wanted))


@pytest.mark.parametrize(
    ("at", "close"),
    [(0.3, 1e-14), (1e-2, 1e-11), (1e-3, 1e-12), (1e-5, 1e-12), (0.799, 1e-12), (0.803, 1e-12)],
)
def test_digits_that_a_mass_near_an_end_costs(at: float, close: float) -> None:
    system = bearing_and_mass(at, 3.0)
    points = sorted([(at, 0.0, 3.0), (0.8, 3e5, 0.0)])
    for found in system.natural_frequencies(4)[::2]:
        ends = found * (1.0 - 1e-4), found * (1.0 + 1e-4)
        wanted = mp.findroot(lambda w: Digits(w, points).determinant(), ends, tol=1e-25)
        assert abs(float(found / wanted - 1)) < close


@pytest.mark.parametrize(("at", "close"), [(2e-3, 1e-10), (5e-4, 1e-8), (1e-4, 1e-9), (1e-5, 1e-9)])
def test_digits_of_frequencies_that_a_bearing_near_an_end_costs(at: float, close: float) -> None:
    """Next to the end it moves with it."""
    points = [(at, 3e5, 0.0)]
    for found in bearing_and_mass(at, 0.0).natural_frequencies(4)[::2]:
        ends = found * (1.0 - 1e-4), found * (1.0 + 1e-4)
        wanted = mp.findroot(lambda w: Digits(w, points).determinant(), ends, tol=1e-25)
        assert abs(float(found / wanted - 1)) < close


def test_a_batch_of_stiffnesses_may_be_alike_in_both_directions() -> None:
    line = cardan.Driveline.from_points([(0, 0, 0), (0.3, 0, 0), (1.9, 0.1, 0), (2.2, 0.1, 0)])
    shafts = [None, cardan.tube(0.09, 0.003, length=1.0), None]
    each = np.array([1e5, 3e5])

    def force(stiffness: object) -> np.ndarray:
        bearing = ElasticBearing(1, 1.2, stiffness, loss_factor=0.1)  # type: ignore[arg-type]
        system = LateralSystem(line, shafts=shafts, bearings=[bearing])
        return system.response(50.0, Load(drive_torque=100.0), [2]).bearing_force

    batch = force(each[:, np.newaxis])
    assert np.array_equal(batch, np.concatenate([force(k)[:, np.newaxis] for k in each], axis=1))


def test_rods_need_no_stiffness_between_joints() -> None:
    """Joints hold them, also where nothing moves."""
    line = cardan.Driveline.from_points([(0, 0, 0), (0.3, 0, 0), (1.3, 0.1, 0), (1.6, 0.2, 0)])
    system = LateralSystem(line, shafts=[None, RigidShaft(10.0, 0.5, 1.0), None])
    response = system.response([0.0, 50.0], Load(drive_torque=100.0), [0, 2])
    for name in VECTORS:
        assert np.isfinite(getattr(response, name)).all()
    assert response.joint_force[:, 0] == pytest.approx(response.joint_force[:, 1], abs=1e-12)


def test_rounding_beyond_an_end_is_at_the_end() -> None:
    system = library(system_of(CASES["truck"]))
    length = float(system.lengths[1])
    probes = [(1, length), (1, np.nextafter(length, 9.0)), (1, length * (1.0 + 9e-10))]
    for found in (
        system.response(100.0, DRIVEN, [2], probes).displacement,
        system.modes(2, probes).displacement,
    ):
        np.testing.assert_array_equal(found[1], found[0])
        np.testing.assert_array_equal(found[2], found[0])
        assert np.max(np.abs(found)) > 0.0


# --- errors --------------------------------------------------------------------------------------

ROD = RigidShaft(10.0, 0.6, 1.0)


test_systems_that_are_none = refusals(
    {
        "TypeError: line is 3; it must be a driveline": {"line": 3},
        "the driveline has no lengths; drivelines from points have them": {
            "line": cardan.Driveline.from_bends([0.1] * 3)
        },
        "driveline has joints with deviations; lateral systems are computed for ideal joints": {
            "line": cardan.Driveline.from_points(POINTS).with_deviations(0.01)
        },
        "shafts has 2 values; the driveline has 4 shafts": {"shafts": [None, ROD]},
        "TypeError: shafts[1] is 3; a shaft is None, a Rigid": {"shafts": [None, 3, ROD, None]},
        "shafts[1] does not move, nor does shaft 0; one side of a joint must": {
            "shafts": [None, None, ROD, None]
        },
        "shafts[1] has the mass -1.0; it must be finite and not negative": {
            "shafts": [None, replace(ROD, mass=-1.0), ROD, None]
        },
        "shafts[1] has the moment across NaN; it must be finite and not negative": {
            "shafts": [None, replace(ROD, across=math.nan), ROD, None]
        },
        "shafts[1] has the centre inf; it must be finite": {
            "shafts": [None, replace(ROD, centre=math.inf), ROD, None]
        },
        "shafts[2] has the loss factor 1.5; it must lie in [0, 1]": {
            "shafts": [None, ROD, cardan.tube(0.09, 0.003, length=1.0, loss_factor=1.5), None]
        },
        "bearings and joints leave shaft 2 without support": {"bearings": []},
        "TypeError: bearings[0] is 3; it must be of the class ElasticBearing": {"bearings": [3]},
        "bearings[0] has the position 1.3 m; shaft 1 is 1.2": {
            "bearings": [ElasticBearing(1, 1.3, 3e5)]
        },
        "bearings[1, 0] has the position 1.3 m; shaft 1 is 1.2": {
            "bearings": [ElasticBearing(1, [1.1, 1.3], 3e5)]
        },
        "bearings[0].position is nan; it must be finite": {
            "bearings": [ElasticBearing(1, math.nan, 3e5)]
        },
        "IndexError: bearings.shaft[0] is 4; there": {"bearings": [ElasticBearing(4, 1, 3e5)]},
        "TypeError: bearings.shaft[0] is 1.5; it": {"bearings": [ElasticBearing(1.5, 1, 3e5)]},  # type: ignore[arg-type]
        "bearings[0] is on shaft 0, which is held and does not move": {
            "bearings": [ElasticBearing(0, 0.1, 3e5)]
        },
        "bearings[0] has the stiffness -300000.0; it must be finite and not negative": {
            "bearings": [ElasticBearing(1, 1.1, -3e5)]
        },
        "bearings[0].stiffness is inf; it must be finite": {
            "bearings": [ElasticBearing(1, 1.1, math.inf)]
        },
        "bearings[0] has the damping -1.0; it must be finite and not negative": {
            "bearings": [ElasticBearing(1, 1.1, 3e5, damping=(0.0, -1.0), axis=(0, 0, 1))]
        },
        "bearings[0] has the loss factor 1.2; it must lie in [0, 1]": {
            "bearings": [ElasticBearing(1, 1.1, 3e5, loss_factor=1.2)]
        },
        "bearings[0] differs in its two directions; it needs an axis for the first": {
            "bearings": [ElasticBearing(1, 1.1, (3e5, 2e5))]
        },
        "bearings[0] has the axis (1.2, 0.06, 0.05); it must have a part across the shaft": {
            "bearings": [ElasticBearing(1, 1.1, (3e5, 2e5), axis=(1.2, 0.06, 0.05))]
        },
        "bearings[0].stiffness has the shape (3,); its last axis needs 2 numbers or one": {
            "bearings": [ElasticBearing(1, 1.1, (3e5, 2e5, 1e5))]
        },
        "TypeError: bearings[0].position has dtype <U1; it must hold real numbers": {
            "bearings": [ElasticBearing(1, "x", 3e5)]
        },
        "shapes do not broadcast: bearings[0] (2,), bearings[1] (3,)": {
            "bearings": [ElasticBearing(1, [1.0] * n, 3e5) for n in (2, 3)]
        },
        "shapes do not broadcast: shafts[0] (), shafts[1] (2,), shafts[2] (3,), shafts[3] ()": {
            "shafts": [None, replace(ROD, mass=[1.0, 2.0]), replace(ROD, mass=[1.0] * 3), None]
        },
        "shapes do not broadcast: driveline (), lengths (), shafts (), bearings (2,), masses": {
            "bearings": [ElasticBearing(1, [1.0, 1.1], 3e5)],
            "masses": [PointMass(1, [0.1, 0.2, 0.3], 1.0)],
        },
        "masses[1] has the mass -1.0; it must be finite and not negative": {
            "masses": [PointMass(1, 0.5, 1.0), PointMass(1, 0.5, -1.0)]
        },
        "masses[0] is on shaft 3, which is held": {"masses": [PointMass(3, 0.1, 1.0)]},
        "unbalance[0].direction has the shape (2,); its last axis needs 3 numbers": {
            "unbalance": [Unbalance(1, 0.5, 1e-3, (0.0, 1.0))]
        },
        "unbalance[0] has the direction (1.2, 0.06, 0.05); it must have a part across": {
            "unbalance": [Unbalance(1, 0.5, 1e-3, (1.2, 0.06, 0.05))]
        },
        "unbalance[0] has the mass arm -0.001; it must be finite and not negative": {
            "unbalance": [Unbalance(1, 0.5, -1e-3, (0, 1, 0))]
        },
        "sliding has 2 values for 3 joints": {"sliding": [1, 1]},
        "sliding[1] is shaft 3; the joint joins shafts 1 and 2": {"sliding": [1, 3, 2]},
        "IndexError: sliding[2] is 9; there are 4, counted from 0": {"sliding": [1, 1, 9]},
    },
    simple,
)


OTHER = cardan.TorsionalSystem(
    cardan.Driveline.from_bends([0.1]),
    inertias=[[0.0, 0.0], [0.0, 0.1]],
    stiffnesses=[1e4, math.inf],
)
SAME = cardan.TorsionalSystem(
    cardan.Driveline.from_points(POINTS),
    inertias=[[0.0, 0.0], *[[0.0, 0.1]] * 3],
    stiffnesses=[1e4, *[math.inf] * 3],
)


SIMPLE = simple()

test_questions_without_an_answer = refusals(
    {
        "count is 0; it must be at least 1": lambda: SIMPLE.natural_frequencies(0),
        "TypeError: count is 2.5; it must be an integer": lambda: SIMPLE.modes(2.5),  # type: ignore[arg-type]
        "probes[0] has the position 9.0 m; shaft 1": lambda: SIMPLE.modes(2, [(1, 9.0)]),
        "IndexError: probes.shaft[0] is 7; there are 4, counted": lambda: SIMPLE.modes(
            2, [(7, 0.1)]
        ),
        "speed[1] is nan; it must be finite": lambda: SIMPLE.response([1.0, math.nan]),
        "TypeError: load is 3; it must be a cardan.Load or the": lambda: SIMPLE.response(1.0, 3),  # type: ignore[arg-type]
        "load has an acceleration; the speeds of a response are steady": lambda: SIMPLE.response(
            1.0, Load(acceleration=1.0)
        ),
        "orders must be in one row, and none": lambda: SIMPLE.response(1.0, orders=[-1]),
        "orders must be in one row, and": lambda: SIMPLE.response(1.0, orders=[[1]]),
        "probes[1] has the": lambda: SIMPLE.response(1.0, probes=[(1, 0.1), (2, -1.0)]),
        "IndexError: probes.shaft[0] is -9; there": lambda: SIMPLE.response(
            1.0, probes=[(-9, 0.1)]
        ),
        "shapes do not broadcast: system (), speed (2,), load (3,)": lambda: SIMPLE.response(
            [1.0, 2.0], Load(drive_torque=[1.0, 2.0, 3.0])
        ),
        "load is the motion of a driveline with other joints": lambda: SIMPLE.response(
            1.0, OTHER.steady(1.0)
        ),
        "load is a motion at other speeds than those of the response": lambda: SIMPLE.response(
            2.0, SAME.steady(1.0)
        ),
        "speeds are 5.0 and 1.0; they must incr": lambda: SIMPLE.resonances((5.0, 1.0)),
        "speeds has shape (); it must be two speeds": lambda: SIMPLE.resonances(5.0),  # type: ignore[arg-type]
        "orders must be positive": lambda: SIMPLE.resonances((1.0, 5.0), [0]),
        "system is a batch (2,); it must be one": lambda: simple(
            bearings=[ElasticBearing(1, [1.0, 1.1], 3e5)]
        ).resonances((1.0, 2.0)),
        "torque is inf; it must be finite": lambda: SIMPLE.torque_stiffness(math.inf),
        "speed is nan; it must be": lambda: SIMPLE.largest_stable_torque(math.nan),
        "shapes do not broadcast: torque (2,), speed (3,)": lambda: SIMPLE.is_stable(
            [1.0, 2.0, 3.0], [1.0, 2.0]
        ),
        "name is 'force'; it must be": lambda: SIMPLE.response(1.0).largest("force"),  # type: ignore[arg-type]
        "name is 'force'; it must be 'bearing_force'": lambda: SIMPLE.response(1.0).of_order(
            "force"  # type: ignore[arg-type]
        ),
        "orders are [0.123, 2.0], which do not repeat within 16 turns": lambda: SIMPLE.response(
            1.0, orders=[0.123, 2]
        ).largest("bearing_force"),
    }
)
