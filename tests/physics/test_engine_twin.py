"""The twin of torsional vibration against models of others: free drives, harmonics, couplings."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cardan import reference
from cardan.reference import torsion
from cardan.reference.torsion import Coupling, Orbit, System, TorqueHarmonic
from oracle import read

CASES: dict[int, dict[str, Any]] = {
    case["case"]: case for case in read("torsion_engine.json")["cases"]
}
KINKED = [28, 30, 32, 35, 36]
SMOOTH = [case for case in CASES if case not in KINKED]
INF = math.inf


def coupling_of(curve: dict[str, list[float]]) -> Coupling:
    """Return the play or the odd table of a curve with two kinks."""
    twist, torque, slope = curve["twist"][1], curve["torque"][1], curve["slopes"][2]
    if torque == 0.0:
        return Coupling(slope, play=twist)
    return Coupling(twist=[0.0, twist, twist + 1.0], torque=[0.0, torque, torque + slope])


def system_of(case: dict[str, Any]) -> System:
    couplings = {int(i): coupling_of(curve) for i, curve in case.get("curves", {}).items()}
    turns = case["p"]
    return System(
        reference.from_bends(case["bends"], None, [p - math.pi / 2 for p in turns]),
        inertias=case["J"],
        stiffnesses=[INF if k is None or i in couplings else k for i, k in enumerate(case["k"])],
        dampings=case["d"],
        load_torque=case["TL"],
        load_damping=case["bL"],
        drive="free" if case["free"] else "held",
        drive_slope=case.get("slope", 0.0),
        harmonics=[
            TorqueHarmonic(
                own["end"] // 2,
                ("input", "output")[own["end"] % 2],
                own["order"],
                own["cos"],
                own["sin"],
            )
            for own in case.get("harmonics", [])
        ],
        couplings=couplings,
        loss_factors=case.get("eta"),
    )


def complexes(orders: dict[str, list[float]]) -> list[complex]:
    return [complex(*x) for x in orders.values()]


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
SLOW = [20, 22, 24, 26, 28, 36]


@pytest.mark.parametrize(
    ("name", "by"),
    [
        *(pytest.param(i, SHORT, id=f"{i}") for i in CASES if i not in {34, *SLOW}),
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
