"""The twin of torsional vibration against models of others: free drives, harmonics, couplings."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, TorsionalSystem, reference
from cardan.reference import torsion
from cardan.reference.torsion import Coupling, Orbit, System, TorqueHarmonic
from engine_cases import CASES, INF, KINKED, SMOOTH, arguments_of, complexes, phases_of


def system_of(case: dict[str, Any]) -> System:
    line = reference.from_bends(case["bends"], None, phases_of(case))
    return System(line, **arguments_of(case))


def same_motion(case: dict[str, Any], found: Orbit, close: float, sampled: float) -> None:
    """Compare a motion with that of a case.

    Args:
        case: of the data.
        found: its motion.
        close: the error of numbers, relative to the largest torque, to the speed, or to 1.
        sampled: that of extremes, and of means and orders of torques.
    """
    motion, speed = found.motion, case["speed"]
    size = np.max(np.abs([case["torque_min"], case["torque_max"]]))
    orders = [float(n) for n in case["torque_orders"][0]]
    # In the data, time begins at the drive angle 0.
    back = np.exp(1j * found.lead * np.array(orders))
    assert found.system.period_turns == case["turns_per_period"]
    off = {
        "torque": (found.drive_torque_mean - case["drive_torque_mean"]) / size / close,
        "lead": (found.lead - case["drive_angle_mean"]) / close,
        "means": (motion.torque.mean(axis=-1) - case["torque_mean"]) / size / sampled,
        "orders": (
            found.orders(motion.torque, orders) * back
            - [complexes(own) for own in case["torque_orders"]]
        )
        / size
        / sampled,
    }
    for name, shaft, side in (("drive", 0, 0), ("last", -1, 1)):
        angle = found.orders(motion.angle_error[shaft, side], orders) * back
        off[f"{name} angle"] = (angle - complexes(case[f"{name}_angle_orders"])) / close
        least, largest = torsion.extremes(motion.speed[shaft, side])
        off[f"{name} least"] = (least - case[f"{name}_speed_min"]) / speed / sampled
        off[f"{name} largest"] = (largest - case[f"{name}_speed_max"]) / speed / sampled
    least, largest = torsion.extremes(motion.torque)
    off["torque least"] = (least - case["torque_min"]) / size / sampled
    off["torque largest"] = (largest - case["torque_max"]) / size / sampled
    assert {
        name: float(np.max(np.abs(x))) for name, x in off.items() if np.any(np.abs(x) > 1)
    } == {}
    power, losses = found.power
    assert power == pytest.approx(losses, rel=sampled)


@pytest.mark.parametrize("name", SMOOTH)
def test_motions_by_their_series(name: int) -> None:
    case = CASES[name]
    found = torsion.collocated(system_of(case), case["speed"])
    same_motion(case, found, 1e-10, 1e-8)
    assert found.state == pytest.approx(case.get("state", found.state), abs=1e-9 * case["speed"])


# Steps of half a turn, and the errors that they leave: of numbers, of what is sampled, and of the
# coefficients of the characteristic polynomial of the multipliers.
SHORT = {"smooth": (60, 1e-5, 1e-3, 3e-2), "kinked": (60, 1e-5, 3e-3, 3e-3)}
LONG = {"smooth": (240, 5e-8, 5e-6, 1e-4), "kinked": (240, 5e-8, 2e-4, 2e-5)}
QUICK = [0, 2, 8, 12, 18, 32, 35]


@pytest.mark.parametrize(
    ("name", "by"),
    [
        *(pytest.param(i, SHORT, id=f"{i}") for i in QUICK),
        *(pytest.param(i, LONG, id=f"{i} fine", marks=pytest.mark.long) for i in CASES if i != 34),
    ],
)
def test_motions_by_integration(name: int, by: dict[str, tuple[int, float, float, float]]) -> None:
    case = CASES[name]
    steps, close, sampled, grown = by["kinked" if name in KINKED else "smooth"]
    # The upper one of two motions is near no motion of rigid shafts.
    start = np.array(case["state"]) if name == 35 else None
    found = torsion.orbit(system_of(case), case["speed"], start, steps=steps)
    same_motion(case, found, close, sampled)
    known = [complex(*x) for x in case["multipliers"]]
    own = [*found.multipliers, *([1.0] if case["free"] else [])]
    assert np.poly(own) == pytest.approx(np.poly(known), abs=grown)
    if case["free"]:
        assert found.shift_error < 1e-2 * grown
    if case["stable"] is not None:
        assert bool(np.all(np.abs(found.multipliers) < 1.0)) == case["stable"]


# --- closed forms --------------------------------------------------------------------------------


def two_inertias(bend: float, **options: Any) -> System:  # noqa: ANN401
    """One joint between the flywheels of a drive and of a load, before the spring."""
    own: dict[str, Any] = {
        "inertias": [(0.1, 0.0), (0.0, 0.05)],
        "stiffnesses": [INF, 8000.0],
        "dampings": [0.0, 2.0],
        "load_torque": 100.0,
        "drive": "free",
    }
    return System(reference.from_bends([math.radians(bend)]), **(own | options))


BEHIND: dict[str, Any] = {
    "inertias": [(0.1, 0.0), (0.05, 0.0)],
    "stiffnesses": [8000.0, INF],
    "dampings": [2.0, 0.0],
}


LOSS: dict[str, Any] = {"dampings": [0.0, 0.0], "loss_factors": [0.0, 0.18]}


@pytest.mark.parametrize(
    ("bend", "options", "exact", "torque"),
    [
        (2.0, {}, -1.8069306684e-4 + 1.7620777262e-5j, 100.0000197763),
        (2.0, BEHIND, -1.7845443058e-4 + 3.4106514765e-5j, None),
        (8.0, {}, -2.8998596974e-3 + 2.827856777e-4j, None),
        (8.0, BEHIND, -2.8634111162e-3 + 5.474149170e-4j, None),
        (2.0, LOSS, -1.6988646700e-4 + 4.4864908438e-5j, None),
    ],
)
def test_small_bends_have_the_twist_of_the_closed_form(
    bend: float, options: dict[str, Any], exact: complex, torque: float | None
) -> None:
    system = two_inertias(bend, **options)
    speed, load, stiffness, drive, last = 150.0, 100.0, 8000.0, 0.1, 0.05
    found = torsion.collocated(system, speed, samples=16)
    shaft = system.compliant[0]
    twist = found.motion.angle_error[shaft, 0] - found.motion.angle_error[shaft, 1]
    # Im z is Re(-i z).
    order = 1j * found.orders(twist, [2.0])[0]
    assert order == pytest.approx(exact, abs=1e-9 * abs(exact))
    if torque is not None:
        assert found.drive_torque_mean == pytest.approx(torque, abs=1e-10)
    k, rate, common = math.tan(math.radians(bend) / 2.0) ** 2, 2.0 * speed, drive * last / 0.15
    spring = stiffness + rate * 2.0j if "loss_factors" not in options else stiffness * (1.0 + 0.18j)
    inner = rate**2 * common
    closed = k * (inner + 2j * load * common / drive) / (inner - spring)
    if shaft == 0:
        turned = np.exp(-2j * load / stiffness)
        closed = k * (inner - 2j * load * common / last) / (inner - spring) * turned
    assert order == pytest.approx(closed, rel=2.0 * k if shaft == 0 else 2.0 * k**2)


def test_an_engine_order_of_a_straight_driveline() -> None:
    harmonic = TorqueHarmonic(0, "input", 1.5, cos=10.0)
    found = torsion.collocated(two_inertias(0.0, harmonics=[harmonic]), 100.0, samples=16)
    twist = found.motion.angle_error[1, 0] - found.motion.angle_error[1, 1]
    exact = 4.58981541679e-4 - 1.89923242963e-5j
    assert found.orders(twist, [1.5])[0] == pytest.approx(exact, abs=1e-14)


@pytest.mark.parametrize(("load", "energy"), [(0.0, 750.322307547), (30.0, 750.322742417)])
def test_a_rigid_driveline_turns_as_its_energy_says(load: float, energy: float) -> None:
    bend, angle = math.radians(20.0), np.arange(4000) * math.pi / 4000
    ratio = math.cos(bend) / ((math.cos(bend) * np.cos(angle)) ** 2 + np.sin(angle) ** 2)
    behind = np.unwrap(np.arctan2(np.sin(angle), math.cos(bend) * np.cos(angle)))
    speed = np.sqrt(2.0 * (energy + load * (angle - behind)) / (0.1 + 0.05 * ratio**2))
    assert np.mean(1.0 / speed) == pytest.approx(0.01, abs=1e-13)
    system = two_inertias(20.0, stiffnesses=[INF, INF], load_torque=load)
    for found, close in (
        (torsion.collocated(system, 100.0), 1e-9),
        (torsion.orbit(system, 100.0, steps=80), 1e-6),
    ):
        own = found.motion.speed[0, 0]
        assert torsion.extremes(own) == pytest.approx(torsion.extremes(speed), abs=100.0 * close)
        assert found.drive_torque_mean == pytest.approx(load, abs=close)


def test_a_large_drive_inertia_holds_the_speed() -> None:
    case = system_of(CASES[0])
    held = torsion.collocated(replace(case, drive="held"), 60.0)
    heavy = 1e4
    free = torsion.collocated(replace(case, inertias=[(heavy, 0.0), (0.0, 0.05)]), 60.0)
    largest = [torsion.extremes(own.motion.torque[0])[1] for own in (free, held)]
    assert (largest[0] - largest[1]) * heavy == pytest.approx(-1.3132, abs=1e-3)
    speed = torsion.extremes(free.motion.speed[0, 0])[1]
    assert (speed - 60.0) * heavy == pytest.approx(0.19473, abs=1e-4)
    assert free.drive_torque_mean == pytest.approx(held.drive_torque_mean, rel=1e-7)


# --- natural frequencies, stability of the speed -------------------------------------------------


@pytest.mark.parametrize(
    ("case", "free", "held"),
    [
        (0, [979.7959], [400.0]),
        (12, [420.9795], [323.4868]),
        (14, [463.3029, 1308.9088], [268.5319, 1216.8742]),
        (16, [367.7536, 801.8017, 1354.4069], [199.6924, 683.1684, 1267.2610]),
    ],
)
def test_natural_frequencies_of_mean_systems(
    case: int, free: list[float], held: list[float]
) -> None:
    system = system_of(CASES[case])
    assert torsion.natural_frequencies(system) == pytest.approx(free, abs=6e-5)
    held_drive = replace(system, drive="held")
    assert torsion.natural_frequencies(held_drive) == pytest.approx(held, abs=6e-5)


@pytest.mark.parametrize(
    ("speed", "slope", "multiplier"),
    [(180.0, 0.30707, 0.984952), (250.0, -0.52205, 1.018855), (300.0, -0.06982, 1.002094)],
)
def test_beyond_a_resonance_the_speed_runs_away(
    speed: float, slope: float, multiplier: float
) -> None:
    own = {"inertias": [(0.3, 0.0), (0.0, 0.05)], "dampings": [0.0, 3.0], "load_torque": 30.0}
    system = two_inertias(20.0, **own)
    found = torsion.orbit(system, speed, steps=60)
    assert found.speed_multiplier == pytest.approx(multiplier, abs=1e-6)
    own_slope = torsion.drive_torque_slope(system, speed, torsion.collocated)
    assert own_slope == pytest.approx(slope, abs=6e-6)


@pytest.mark.parametrize(
    ("orders", "turns"),
    [([], 0.5), ([4.0], 0.5), ([2.0, 3.0], 1.0), ([1.5, 4.0], 2.0), ([0.25], 4.0), ([2 / 3], 1.5)],
)
def test_the_common_period_of_torques(orders: list[float], turns: float) -> None:
    harmonics = [TorqueHarmonic(0, "input", order, 1.0) for order in orders]
    assert two_inertias(5.0, harmonics=harmonics).period_turns == turns


# --- couplings -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("contact", "close"), [(False, 1e-5), (True, 2e-4)])
def test_play_is_that_of_one_equation_in_time(contact: bool, close: float) -> None:
    # A flywheel behind a straight spring of a held drive, until its vibration repeats.
    stiffness, play, damping, inertia, load, speed = 8000.0, 0.02, 6.0, 0.05, 20.0, 80.0
    system = two_inertias(
        0.0,
        drive="held",
        stiffnesses=[INF, INF],
        dampings=[0.0, damping],
        load_torque=load,
        couplings={1: Coupling(stiffness, play=play, contact_damping=contact)},
        harmonics=[TorqueHarmonic(1, "output", 2.0, cos=120.0)],
    )

    def curve(time: float, twist: float, slip: float) -> float:
        beyond = max(abs(twist) - 0.5 * play, 0.0)
        damped = 0.0 if contact and beyond == 0.0 else damping * slip
        driven = 120.0 * math.cos(2.0 * (speed * time - twist))
        return (load - driven - damped - math.copysign(stiffness * beyond, twist)) / inertia

    steps, twist, slip, time = 4000, load / stiffness + 0.5 * play, 0.0, 0.0
    width = math.tau / speed / steps
    for _ in range(5 * steps):
        # By midpoints.
        middle, half = twist + 0.5 * width * slip, slip + 0.5 * width * curve(time, twist, slip)
        slip += width * curve(time + 0.5 * width, middle, half)
        twist, time = twist + width * half, time + width
    known = np.array([0.0, -twist, speed, speed - slip])
    found = torsion.orbit(system, speed, known, steps=60)
    assert found.state == pytest.approx(known, abs=close, rel=close)
    assert np.min(found.motion.torque) < 0.0


def test_a_stiffness_by_the_mean_torque_is_that_at_its_own_mean() -> None:
    table = Coupling(mean_torque=[50.0, 90.0, 130.0], stiffness_by_mean=[4e3, 6e3, 12e3])
    own: dict[str, Any] = {"drive": "free", "stiffnesses": [INF, INF], "load_damping": 0.1}
    system = two_inertias(15.0, couplings={1: table}, **own)
    found = torsion.collocated(system, 150.0)
    mean = float(found.motion.torque.mean())
    # The load is 100 N m and its damping's share of some 15.
    assert 114.0 < mean < 116.0
    own["stiffnesses"] = [INF, 6e3 + (mean - 90.0) / 40.0 * 6e3]
    plain = two_inertias(15.0, **own)
    assert found.state == pytest.approx(torsion.collocated(plain, 150.0).state, abs=1e-8)
    by_steps = torsion.orbit(system, 150.0, steps=40)
    multipliers = torsion.orbit(plain, 150.0, steps=40).multipliers
    assert np.poly(by_steps.multipliers) == pytest.approx(np.poly(multipliers), abs=1e-5)


def test_a_loss_factor_has_no_law_in_time() -> None:
    with pytest.raises(ValueError, match="no law in time"):
        torsion.orbit(two_inertias(5.0, **LOSS), 100.0)


@pytest.mark.parametrize("twin", [False, True])
def test_natural_frequencies_without_the_rotation_of_all(twin: bool) -> None:
    # M. I. Friswell et al., Dynamics of Rotating Machines, 2010, example 9.7.1.
    def frequencies(joints: int, **given: Any) -> Any:  # noqa: ANN401
        given["dampings"] = [0.0] * (joints + 1)
        if twin:
            system = System(reference.from_bends([0.0] * joints), **given)
            return np.asarray(torsion.natural_frequencies(system)) / math.tau
        line = Driveline.from_bends([0.0] * joints)
        return TorsionalSystem(line, **given).natural_frequencies() / math.tau

    chain: dict[str, Any] = {
        "inertias": [[0.0035, 0], [0.0035, 0], [0.0035, 0], [0.15, 0], [0.05, 0]],
        "stiffnesses": [12e3, 12e3, 14e3, 10e3, INF],
    }
    heavy: dict[str, Any] = {"inertias": [[211.4, 0], [8.3, 0]], "stiffnesses": [9.775e6, INF]}
    for drive, known, pair in (
        ("free", [81.2076, 141.2141, 378.9530, 536.3633], 176.0767),
        ("held", [22.6280, 83.1631, 308.1916, 518.2375], 172.7187),
    ):
        np.testing.assert_allclose(frequencies(4, drive=drive, **chain)[-4:], known, atol=5e-5)
        assert frequencies(1, drive=drive, **heavy)[-1] == pytest.approx(pair, abs=5e-5)
