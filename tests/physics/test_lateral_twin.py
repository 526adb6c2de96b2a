"""The twin of lateral vibration against a model without elements and statics.

Closed forms judge both the twin and the library.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cardan import reference
from cardan.reference import design, forces
from cardan.reference.lateral import (
    Array,
    Complex,
    ElasticBearing,
    PointMass,
    RigidShaft,
    System,
    Unbalance,
    largest,
)
from lateral_cases import (
    BENDING,
    CASES,
    LINE,
    RIGID,
    TUBE,
    TUBES,
    Library,
    between_machines,
    bracket,
    check,
    effective_mass,
    load_of,
    pinned,
    planar,
    probes_of,
    rigid_limit,
    speeds_of,
    summed,
    system_of,
    two_piece,
)
from tiers import few

Made = Callable[[System], Any]
"""What computes with a system: the twin itself, or the library with the arguments of the twin."""

both = pytest.mark.parametrize("of", [lambda system: system, Library], ids=["twin", "library"])


def check_twin(case: dict[str, Any], step: float, close: float, energy: float) -> None:
    """Compare a system with elements of some length with a case, as `check` does."""
    system = system_of(case, step)
    frequencies = system.natural_frequencies(len(case["natural_frequencies_rad_s"]))
    response = system.response(speeds_of(case), load_of(case), case["orders"], probes_of(case))
    check(case, frequencies, response, close, energy)


@pytest.mark.parametrize("name", RIGID)
def test_rigid_shafts_are_those_of_the_model_without_elements(name: str) -> None:
    check_twin(CASES[name], 0.2, 1e-11, 1e-13)


@pytest.mark.parametrize("name", TUBES)
def test_tubes_are_those_of_the_model_without_elements(name: str) -> None:
    check_twin(CASES[name], 0.2, 1e-7, 1e-11)


@pytest.mark.long
@pytest.mark.parametrize("name", TUBES)
def test_tubes_of_short_elements(name: str) -> None:
    # Rounding grows with the number of elements: it leaves the balance up to 2e-11.
    check_twin(CASES[name], 0.1, 4e-9, 1e-10)


@pytest.mark.parametrize("name", CASES)
def test_joints_that_support_a_shaft_slide_on_it(name: str) -> None:
    system = system_of(CASES[name])
    assert replace(system, sliding=None).slides == tuple(CASES[name]["sliding"])


@pytest.mark.parametrize("shear", [None, 0.5224])
def test_modes_of_a_pinned_tube(shear: float | None) -> None:
    tube, length = replace(TUBE, shear_coefficient=shear), 1.6
    found = between_machines(tube, length, step=0.1).natural_frequencies(6)
    wanted = [pinned(tube, length, mode) for mode in (1, 1, 2, 2, 3, 3)]
    assert found == pytest.approx(wanted, rel=3e-9)


# --- tubes -------------------------------------------------------------------------------------


@pytest.mark.parametrize("shear", [None, 0.5224])
def test_elements_converge_with_the_eighth_power_of_their_length(shear: float | None) -> None:
    tube, length = replace(TUBE, shear_coefficient=shear), 1.6
    errors = [
        between_machines(tube, length, step=step).natural_frequencies(7)[6]
        / pinned(tube, length, 4)
        - 1.0
        for step in (0.2, 0.1)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.15)


def test_critical_speed_is_that_of_the_library() -> None:
    known = design.tube(0.09, 0.003, 1.6, 7.93e10, 2.06e11, 7850.0)
    found = between_machines(TUBE, 1.6).natural_frequencies(1)
    # The other twin divides the length into pieces.
    assert found == pytest.approx(known["critical_speed"], rel=1e-5)


@both
@pytest.mark.parametrize("share", [0.01, 0.2, 0.45, 0.6])
def test_a_tube_between_machines_by_its_closed_form(of: Made, share: float) -> None:
    """Joints of a Z bend it, those of a W load its bearings."""
    length, bend, torque = 1.5074813, math.radians(5.7106), 1500.0
    speed = share * pinned(TUBE, length, 1)
    phase = math.sqrt(2.0 * speed * math.sqrt(LINE / BENDING)) * length / 2.0
    options: Any = {"orders": [2], "probes": [(1, length / 2.0)]}
    loads = {"drive_torque": torque}

    z = of(between_machines(TUBE, length, (bend, -bend))).response(speed, loads, **options)
    # The couple has the size D tan(bend/2), D sin(bend/2) or one between them.
    couple = torque * bend / 2.0
    middle = 2.0 * couple * length**2 / (16.0 * BENDING * phase**2)
    middle *= 1.0 / math.cos(phase) - 1.0 / math.cosh(phase)
    off = 2.0 * bend**2
    shape = np.linalg.norm(z.displacement[0, 0]) / math.sqrt(2.0)
    assert shape == pytest.approx(abs(middle), rel=off)
    force = couple / length * phase * (math.tan(phase) - math.tanh(phase))
    borne = np.linalg.norm(z.joint_force[:, 0], axis=-1) / math.sqrt(2.0)
    assert borne == pytest.approx(2 * [abs(force)], rel=off)

    w = of(between_machines(TUBE, length, (bend, bend))).response(speed, loads, **options)
    assert np.linalg.norm(w.displacement[0, 0]) < off * abs(middle) + 1e-12


@both
def test_a_tube_between_machines_near_half_its_critical_speed(of: Made) -> None:
    """Numbers of an independent model."""
    system = system_of(CASES["one-piece-euler-held"])
    length = system.lengths[1]
    speeds = pinned(TUBE, length, 1) * np.array([1e-3, 0.45])
    load = {"drive_torque": 1500.0}
    response = of(system).response(speeds, load, [2], [(1, length / 2.0)])
    z = np.abs(response.displacement[0, :, 0, 2])
    assert z == pytest.approx([0.1324933e-3, 0.7153832e-3], rel=1e-6)
    assert abs(response.joint_force[0, 1, 0, 2]) == pytest.approx(846.5643, rel=1e-6)
    assert np.max(np.abs(response.joint_force[:, 0, 0])) < 1e-2


@both
@pytest.mark.parametrize(
    ("stiffness", "hertz", "shudder", "force", "displacement"),
    few(
        [
            (1.5e5, 15.13, 454.0, 555.1, 3.67e-3),
            (3e5, 21.30, 640.0, 513.4, 1.70e-3),
            (6e5, 29.85, 895.0, 420.8, 0.70e-3),
        ],
        [(6e5, 29.85, 895.0, 420.8, 0.70e-3)],
    ),
)
def test_shudder_of_a_truck(
    of: Made, stiffness: float, hertz: float, shudder: float, force: float, displacement: float
) -> None:
    """Numbers of an independent model, in its digits."""
    truck = system_of(CASES["truck"])
    bearing = replace(truck.bearings[0], stiffness=(stiffness, stiffness))
    truck, rpm = replace(truck, bearings=[bearing]), math.pi / 30.0
    found = of(truck).natural_frequencies(1) / (2.0 * math.pi)
    assert found == pytest.approx([hertz], abs=0.005)
    speeds = rpm * (shudder + np.array([-6.0, 0.0, 6.0]))
    response = of(truck).response(speeds, {"drive_torque": 1500.0}, [2])
    below, peak, above = largest(response.bearing_force[0], [2])
    assert peak == pytest.approx(force, abs=0.2)
    assert peak > max(below, above)
    moved = largest(response.bearing_displacement[0, 1], [2])
    assert moved == pytest.approx(displacement, abs=0.5e-5)


@both
@pytest.mark.parametrize(
    ("slopes", "phases", "static", "shudder"),
    few(
        [
            ((3, 4, 9, 4), (0, 0), 69.65, 513.4),
            ((3, 4, 9, 7), (0, 0), 94.5, 756.0),
            ((3, 4, 9, 4), (90, 0), 46.5, 319.0),
            ((3, 4, 9, 14), (0, 0), 152.0, 1322.0),
        ],
        [((3, 4, 9, 14), (0, 0), 152.0, 1322.0)],
    ),
    ids=["Z", "pinion wound up", "yokes turned", "W"],
)
def test_layouts_of_a_truck(
    of: Made, slopes: Sequence[float], phases: Sequence[float], static: float, shudder: float
) -> None:
    """Numbers of an independent model: slopes, and phases, in degrees."""
    down = -np.radians(slopes)
    line = planar(np.diff(down).tolist(), np.radians(phases).tolist())
    truck = replace(system_of(CASES["truck"], 0.3), line=line, lengths=[0.3, 1.25, 1.75, 0.3])
    speeds = np.array([0.1, 640.0]) * math.pi / 30.0
    force = of(truck).response(speeds, {"drive_torque": 1500.0}, [2]).bearing_force[0]
    assert largest(force, [2]) == pytest.approx([static, shudder], rel=2e-3)


# --- rigid shafts ------------------------------------------------------------------------------


@both
def test_two_rigid_rods_are_one_mass_on_a_spring(of: Made) -> None:
    bends = [math.radians(bend) for bend in (3.0, 9.0, 4.0)]
    eta, at_joint = 0.12, 1.5e5 * (1.13 / 1.25) ** 2
    system = two_piece(bends, loss_factor=eta)
    in_plane, across = (math.sqrt(at_joint / effective_mass(c)) for c in (math.cos(bends[1]), 1.0))
    assert of(system).natural_frequencies() == pytest.approx(sorted([in_plane, across]), rel=1e-12)
    speeds = in_plane * np.array([1e-4, 0.2, 0.45, 0.5, 0.52, 1.5])
    force = of(system).response(speeds, {"drive_torque": 1500.0}, [2]).bearing_force[0, :, 0]
    u, m = system.line.directions[1], system.line.normals[1]
    for direction, natural in ((np.cross(m, u), in_plane), (np.array(m), across)):
        own = force @ direction
        factor = (1.0 + 1j * eta) / (1.0 + 1j * eta - (2.0 * speeds / natural) ** 2)
        # At rest is not quite at the first speed.
        assert own / own[0] * factor[0] == pytest.approx(factor, rel=1e-11)


@both
@pytest.mark.parametrize("phases", [(0.0, 0.0), (math.pi / 2.0, 0.0), (0.4, -1.1)])
@pytest.mark.parametrize("signs", [(1, 1, 1), (1, -1, 1), (1, 1, -1)])
def test_order_2_of_a_rigid_bearing_by_its_layout(
    of: Made, phases: tuple[float, float], signs: tuple[int, int, int]
) -> None:
    bends = [sign * math.radians(bend) for sign, bend in zip(signs, (0.3, 0.5, 0.4), strict=True)]
    response = of(two_piece(bends, phases)).response(1e-6, {"drive_torque": 1500.0}, [2])
    found = np.linalg.norm(response.bearing_force[0, 0]) / math.sqrt(2.0)
    assert found == pytest.approx(750.0 * 1.25 / 1.13 * abs(bracket(bends, phases)), rel=2e-4)


@both
def test_a_layout_without_order_2(of: Made) -> None:
    bends = [math.radians(bend) for bend in (0.3, 0.5, 0.0)]
    bends[2] = -1.75 * bracket(bends, (0.0, 0.0)).real
    response = of(two_piece(bends)).response(1e-6, {"drive_torque": 1500.0}, [0, 2])
    mean, second = np.linalg.norm(response.bearing_force[0], axis=-1)
    assert second < 1e-3 * mean


@both
def test_stiff_bearings_and_slow_turns_are_statics(of: Made) -> None:
    system, load, places = rigid_limit()
    orders = range(0, 22, 2)
    response = of(system).response(1e-3, load, list(orders))
    for angle in np.linspace(0.0, 3.0, 7):
        known = forces.forces(
            system.line, reference.loads(system.line, angle, **load), system.lengths, places
        )
        size = np.max(np.abs(known.bearing_force))
        for own, wanted in (
            (response.bearing_force, known.bearing_force),
            (response.joint_force, known.joint_force),
        ):
            off = np.abs(summed(own, orders, angle) - wanted)
            assert np.max(off) < 1e-12 * size


def test_a_torque_that_pulsates_brings_other_orders() -> None:
    """With the torque of each instant, they add up to its statics."""
    system, _, places = rigid_limit()

    def drive(angle: float) -> float:
        return 1000.0 + 400.0 * math.cos(1.5 * angle + 0.3)

    def torques(angle: float) -> tuple[float, ...]:
        return reference.loads(system.line, angle, drive_torque=drive(angle)).torque[:-1]

    orders = (0, 0.5, 1.5, 2, 3.5)
    response = system.response(1e-3, torques, orders, turns=2)
    for angle in (0.0, 1.0, 4.0, 8.0):
        load = reference.loads(system.line, angle, drive_torque=drive(angle))
        known = forces.forces(system.line, load, system.lengths, places).bearing_force
        found = summed(response.bearing_force, orders, angle)
        assert found == pytest.approx(np.array(known), abs=1e-11 * np.max(np.abs(known)))
    none = system.response(1e-3, torques, (1, 3, 4), turns=2)
    assert np.max(np.abs(none.bearing_force)) < 1e-11 * np.max(np.abs(response.bearing_force))


@both
def test_a_turning_shaft_is_stiffer_or_softer_by_its_polar_inertia(of: Made) -> None:
    """For a forward order k it is one with ``across - along / k``."""
    line = reference.from_bends([1e-4])
    bearings = [ElasticBearing(1, 0.2, (3e6, 3e6), None, 0.05), ElasticBearing(1, 1.0, (2e6, 2e6))]

    def found(across: float, along: float) -> Complex:
        system = System(
            line,
            [0.4, 1.2],
            [None, RigidShaft(20.0, 0.7, across, along)],
            bearings,
            unbalance=[Unbalance(1, 0.5, 1e-3, (0, 1, 0))],
        )
        response = of(system).response(400.0, {"drive_torque": 500.0}, [1, 2])
        return np.asarray(response.bearing_force)

    whole = found(2.4, 0.8)
    assert whole[:, 0] == pytest.approx(found(1.6, 0.0)[:, 0], rel=1e-9)
    # The couples of order 2 turn forward but for the square of the bend.
    assert whole[:, 1] == pytest.approx(found(2.0, 0.0)[:, 1], rel=1e-6)
    assert np.max(np.abs(whole[:, 1] / found(2.4, 0.0)[:, 1] - 1.0)) > 0.01


@both
def test_a_disc_is_a_part_of_its_shaft(of: Made) -> None:
    """Mass and moments of inertia add up about the common centre."""
    line = reference.from_bends([0.2])
    bearings = [ElasticBearing(1, 0.2, (3e6, 3e6)), ElasticBearing(1, 1.0, (2e6, 2e6))]
    disc = PointMass(1, 0.3, 5.0, 0.3, 0.5)
    apart = System(line, [0.4, 1.2], [None, RigidShaft(15.0, 0.7, 2.0, 0.1)], bearings, [disc])
    joined = RigidShaft(20.0, 0.6, 2.3 + 15.0 * 0.1**2 + 5.0 * 0.3**2, 0.6)
    whole = replace(apart, shafts=[None, joined], masses=[])
    first, second = (
        of(own).response(90.0, {"drive_torque": 500.0}, [2]).bearing_force for own in (apart, whole)
    )
    assert first == pytest.approx(second, rel=1e-11)


@both
def test_directions_of_a_bearing_are_independent_in_a_plane(of: Made) -> None:
    """Those of a bearing turned by its axis are the same bearing in other coordinates."""
    bends = [math.radians(bend) for bend in (3.0, 9.0, 4.0)]
    system = two_piece(bends)
    u, m = system.line.directions[1], system.line.normals[1]
    aside = np.cross(u, m)
    skew = {"loss_factor": (0.1, 0.2), "damping": (100.0, 50.0)}
    one = ElasticBearing(1, 1.13, (2e5, 3e5), m, **skew)
    other = ElasticBearing(1, 1.13, (3e5, 2e5), np.array(u) + aside, (0.2, 0.1), (50.0, 100.0))
    first, second = (
        of(replace(system, bearings=[own]))
        .response(70.0, {"drive_torque": 1500.0}, [2])
        .bearing_force
        for own in (one, other)
    )
    assert first == pytest.approx(second, rel=1e-11)
    for direction, k in (
        (np.array(m), 2e5 * (1 + 0.1j) + 14000j),
        (aside, 3e5 * (1 + 0.2j) + 7000j),
    ):
        response = of(replace(system, bearings=[one])).response(70.0, {"drive_torque": 1500.0}, [2])
        moved = response.bearing_displacement[0, 0] @ direction
        assert response.bearing_force[0, 0] @ direction == pytest.approx(-k * moved, rel=1e-12)


# --- the torque's own stiffness ----------------------------------------------------------------


@both
@pytest.mark.parametrize("phases", [(0.0, 0.0), (math.pi / 2.0, 0.0), (0.4, -1.1)])
def test_torque_stiffness_of_two_pieces(of: Made, phases: tuple[float, float]) -> None:
    own = of(two_piece([1e-3, 2e-3, -1e-3], phases)).torque_stiffness(1500.0)
    turn, first, second = np.exp(2j * np.cumsum(phases)), 1.25, 1.75
    wanted = first**-2 - turn[0] * (1 / first + 1 / second) ** 2 + turn[1] * second**-2
    assert own.kappa == pytest.approx(750.0 * abs(wanted), rel=1e-5)
    # Of its mean part nothing is left to first order.
    assert np.max(np.abs(own.mean)) < 1e-4 * own.kappa


@both
def test_torque_stiffness_in_numbers(of: Made) -> None:
    bends = [math.radians(bend) for bend in (1.0, 5.0, 5.0)]
    assert of(two_piece(bends)).torque_stiffness(1500.0).kappa == pytest.approx(685.7, rel=0.01)
    turned = of(two_piece(bends, (math.pi / 2.0, 0.0))).torque_stiffness(1500.0)
    assert turned.kappa == pytest.approx(1646.0, rel=0.01)


@both
def test_a_single_joint_circulates(of: Made) -> None:
    line = reference.from_bends([math.radians(5.0)])
    bearing = ElasticBearing(1, 1.0, (1e6, 1e6))
    system = System(line, [0.3, 1.0], [None, RigidShaft(20.0, 0.7, 2.4)], [bearing])
    own = of(system).torque_stiffness(1500.0)
    assert own.mean[1, 0] == pytest.approx(750.0, rel=0.01)
    assert own.mean[0, 1] == pytest.approx(-750.0, rel=0.01)
    assert np.max(np.abs(np.diag(own.mean))) < 1e-4


@both
def test_a_joint_moves_across_the_shaft_that_does_not_slide(of: Made) -> None:
    """Before a long shaft, what is across the other one turns it, what is along it lengthens it."""
    bend = 1.0
    line = planar([0.3, bend], [0.4])
    rod = RigidShaft(1.0, 0.5, 1.0)
    bearings = [ElasticBearing(2, 1.0, (1.0, 1.0)), ElasticBearing(2, 2.0, (1.0, 1.0))]
    system = System(line, [0.3, 1.0, 1e5], [None, rod, rod], bearings)
    assert system.slides == (1, 1)
    across_long, across_short = (
        of(replace(system, sliding=sliding)).torque_stiffness(10.0).mean[0, 1]
        for sliding in ([1, 1], [1, 2])
    )
    # The first direction is across the plane, the second one in it.
    angles = np.linspace(0.0, math.pi, 100, endpoint=False)
    moments = np.mean([reference.loads(line, x, drive_torque=10.0).moment for x in angles], axis=0)
    force = np.cross(moments[0] - moments[1], line.directions[1])[2]
    wanted = math.cos(bend) * across_short - math.sin(bend) * force
    assert across_long == pytest.approx(wanted, abs=1e-4 * abs(across_short))


def grows(mass: float, damping: float, stiffness: float, kappa: float, speed: float) -> bool:
    """Whether ``m z'' + c z' + k z - kappa e^(2iwt) conj(z)`` grows, over half a turn."""
    count = 600
    step = math.pi / speed / count

    def rates(time: float, state: Array) -> Array:
        turn = kappa * np.exp(2j * speed * time)
        turning = np.array([[turn.real, turn.imag], [turn.imag, -turn.real]])
        place, rate = state[:2], state[2:]
        return np.concatenate([rate, (turning @ place - stiffness * place - damping * rate) / mass])

    state = np.eye(4)
    for time in step * np.arange(count):
        first = rates(time, state)
        second = rates(time + step / 2, state + step / 2 * first)
        third = rates(time + step / 2, state + step / 2 * second)
        last = rates(time + step, state + step * third)
        state = state + step / 6 * (first + 2 * second + 2 * third + last)
    return bool(np.max(np.abs(np.linalg.eigvals(state))) > 1.0)


@both
@pytest.mark.parametrize("share", few([0.9, 0.97, 1.0, 1.02, 1.2], [1.0]))
def test_stability_under_torque(of: Made, share: float) -> None:
    """A speed is stable while kappa is below the dynamic stiffness of order 1."""
    damping, bends = 300.0, [1e-3, 2e-3, -1e-3]
    system = two_piece(bends, (math.pi / 2.0, 0.0), damping=damping)
    lever = (1.13 / 1.25) ** 2
    stiffness, mass = 1.5e5 * lever, effective_mass()
    speed = share * math.sqrt(stiffness / mass)
    left = abs(stiffness - mass * speed**2 + 1j * damping * lever * speed)
    per_torque = of(system).torque_stiffness(1.0).kappa
    for torque, stable in ((0.98 * left / per_torque, True), (1.02 * left / per_torque, False)):
        assert of(system).is_stable(speed, torque) is stable
        assert grows(mass, damping * lever, stiffness, per_torque * torque, speed) is not stable


@both
def test_stability_by_the_loss_factor(of: Made) -> None:
    """At the critical speed kappa must stay below the loss factor times the stiffness."""
    system = two_piece([1e-3, 2e-3, -1e-3], loss_factor=0.12)
    speed, lost = of(system).natural_frequencies()[0], 0.12 * 1.5e5 * (1.13 / 1.25) ** 2
    torque = lost / of(system).torque_stiffness(1.0).kappa
    assert of(system).is_stable(speed, 0.99 * torque)
    assert not of(system).is_stable(speed, 1.01 * torque)
    assert of(system).is_stable(0.8 * speed, 1.01 * torque)


# --- the rest ----------------------------------------------------------------------------------


def test_largest_value_over_the_turn() -> None:
    rng = np.random.default_rng(1)
    vectors = rng.normal(size=(4, 4, 3)) + 1j * rng.normal(size=(4, 4, 3))
    vectors[..., 0, :] = vectors[..., 0, :].real
    orders, angles = (0, 1.5, 2, 4), np.linspace(0.0, 4.0 * math.pi, 20001)
    sampled = np.einsum("ak,ikx->iax", np.exp(1j * np.multiply.outer(angles, orders)), vectors)
    wanted = np.max(np.linalg.norm(sampled.real, axis=-1), axis=-1)
    assert largest(vectors, orders) == pytest.approx(wanted, rel=1e-6)
    assert np.all(largest(vectors, orders) >= wanted * (1.0 - 1e-14))
    one = vectors[:, 1]
    wanted = np.sqrt((np.sum(np.abs(one) ** 2, -1) + np.abs(np.sum(one**2, -1))) / 2.0)
    assert largest(one[:, None], [2]) == pytest.approx(wanted, rel=1e-12)
    circle = np.array([[[1.0, 1.0j, 0.0]]])
    assert largest(circle, [1]) == pytest.approx(1.0, rel=1e-12)
    assert largest(vectors[:, :1], [0]) == pytest.approx(np.linalg.norm(vectors[:, 0], axis=-1))


@both
def test_shapes_of_a_response(of: Made) -> None:
    system = two_piece([0.1, 0.1, 0.1])
    response = of(system).response(np.ones((2, 3)), {"drive_torque": 1.0}, (0, 2), [(1, 0.2)] * 5)
    assert response.bearing_force.shape == (1, 2, 3, 2, 3)
    assert response.joint_force.shape == response.joint_displacement.shape == (3, 2, 3, 2, 3)
    assert response.displacement.shape == (5, 2, 3, 2, 3)
    assert response.bearing_power.shape == (1, 2, 3, 2)
    assert response.tube_power.shape == response.given_power.shape == (2, 3, 2)
    assert of(system).response(1.0, {"drive_torque": 1.0}).bearing_force.shape == (1, 3, 3)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"bearings": []}, "without support"),
        ({"bearings": [ElasticBearing(1, 1.3, (1.0, 1.0))]}, r"1\.3; shaft 1 is 1\.25 m long"),
        ({"bearings": [ElasticBearing(4, 0.1, (1.0, 1.0))]}, "shaft 4"),
        ({"bearings": [ElasticBearing(1, 0.1, (1.0, 2.0))]}, "axis"),
        ({"shafts": [None, None, RigidShaft(1.0, 1.0, 1.0), None]}, "joint 0 joins two machines"),
        ({"sliding": [2, 2, 2]}, "not one of joint 0"),
        ({"lengths": [1.0, 1.0, 1.0]}, "4 shafts"),
    ],
)
def test_systems_that_are_none(change: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        replace(two_piece([0.1, 0.1, 0.1]), **change).natural_frequencies()


@pytest.mark.parametrize("shear", [None, 0.5])
@pytest.mark.parametrize("first", [1.1, 1.7, 2.3])
def test_tubes_without_support(first: float, shear: float | None) -> None:
    """Two pieces without a centre bearing; rounding gives them none."""
    tube = replace(TUBE, shear_coefficient=shear)
    system = two_piece([0.1, 0.1, 0.1])
    bare = replace(system, lengths=[0.3, first, 1.1, 0.3], bearings=[], step=0.2)
    with pytest.raises(ValueError, match="without support"):
        replace(bare, shafts=[None, tube, tube, None]).response(1.0, {"drive_torque": 1.0})


@both
def test_a_rod_that_joints_hold_has_nothing_to_vibrate(of: Made) -> None:
    line, rod = planar([0.1, -0.1], [0.0]), RigidShaft(10.0, 0.5, 1.0)
    system = System(line, [0.3, 1.0, 0.3], [None, rod, None])
    assert of(system).natural_frequencies().shape == (0,)
    assert of(system).torque_stiffness(10.0).kappa == 0.0
    assert of(system).is_stable(10.0, 10.0)
    # Nor does a Z load it.
    response = of(system).response(30.0, {"drive_torque": 100.0}, [2])
    assert np.max(np.abs(response.joint_force)) < 1e-12


@both
def test_rounding_puts_nothing_beyond_an_end(of: Made) -> None:
    system = between_machines(TUBE, 1.6)
    at_end = replace(system, masses=[PointMass(1, 1.6, 3.0, 0.1), PointMass(1, 0.0, 3.0, 0.1)])
    beside = [PointMass(1, np.nextafter(1.6, 2.0), 3.0, 0.1), PointMass(1, 1e-16, 3.0, 0.1)]
    wanted = of(at_end).natural_frequencies()
    assert of(replace(system, masses=beside)).natural_frequencies() == pytest.approx(
        wanted, rel=1e-14
    )
