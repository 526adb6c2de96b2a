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


LOSS: dict[str, Any] = {"dampings": [0.0, 0.0], "loss_factors": [0.0, 0.18]}


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
