"""Lateral vibration of drivelines on elastic bearings."""

from cardan.lateral.elements import ElasticBearing, PointMass, RigidShaft, Unbalance
from cardan.lateral.results import LateralModes, LateralResonance, LateralResponse, TorqueStiffness
from cardan.lateral.system import LateralSystem

__all__ = [
    "ElasticBearing",
    "LateralModes",
    "LateralResonance",
    "LateralResponse",
    "LateralSystem",
    "PointMass",
    "RigidShaft",
    "TorqueStiffness",
    "Unbalance",
]
