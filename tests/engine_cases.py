"""Engines and couplings of an independent model: the cases of ``torsion_engine.json``."""

from __future__ import annotations

import math
from typing import Any

from cardan.torsion import Coupling, TorqueHarmonic
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


def arguments_of(case: dict[str, Any]) -> dict[str, Any]:
    """Return what makes a torsional system of a driveline."""
    couplings = {int(i): coupling_of(curve) for i, curve in case.get("curves", {}).items()}
    return {
        "inertias": case["J"],
        "stiffnesses": [INF if k is None or i in couplings else k for i, k in enumerate(case["k"])],
        "dampings": case["d"],
        "load_torque": case["TL"],
        "load_damping": case["bL"],
        "drive": "free" if case["free"] else "held",
        "drive_slope": case.get("slope", 0.0),
        "harmonics": [
            TorqueHarmonic(
                own["end"] // 2,
                ("input", "output")[own["end"] % 2],
                own["order"],
                own["cos"],
                own["sin"],
            )
            for own in case.get("harmonics", [])
        ],
        "couplings": couplings,
        "loss_factors": case.get("eta"),
    }


def phases_of(case: dict[str, Any]) -> list[float]:
    """Return the phases of a driveline without twists."""
    return [p - math.pi / 2 for p in case["p"]]


def complexes(orders: dict[str, list[float]]) -> list[complex]:
    return [complex(*x) for x in orders.values()]
