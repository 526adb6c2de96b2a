"""An engine as a scene, and the cases of ``torsion_engine.json``, an independent model's."""

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

# Three cylinders, a coupling, a shaft and a propeller of three blades.
ENGINE = """\
[driveline]
bends_deg = [0, 8]
[torsion]
drive = "free"
names = ["engine", "shaft", "propeller"]
inertias_kgm2 = [[0.8, 0], [0.05, 0.01], [0, 0.15]]
stiffnesses_Nm_per_rad = ["coupling", 40000, "rigid"]
dampings_Nms_per_rad = [8, 5, 0]
load_damping_Nms_per_rad = 0.8
speed_rpm = {from = 700, to = 1300, steps = 13}

[[torsion.harmonic]]
order = [0.5, 1, 1.5, 2, 3]
cos_Nm = [90, 70, 50, 20, 10]
sin_Nm = [60, 120, 90, 60, 20]
firing_order = [1, 3, 2]

[[torsion.harmonic]]
shaft = 2
end = "output"
order = 3
amplitude_Nm = 15
phase_deg = 30

[[torsion.coupling]]
shaft = 0
stiffness_Nm_per_rad = 3000
"""


def coupling_of(curve: dict[str, list[float]]) -> Coupling:
    """Return the play or the odd table of a curve with two kinks."""
    twist, torque, slope = curve["twist"][1], curve["torque"][1], curve["slopes"][2]
    if torque == 0.0:
        return Coupling(slope, play=2.0 * twist)
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
