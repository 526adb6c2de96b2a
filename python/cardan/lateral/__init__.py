"""Lateral vibration of drivelines on elastic bearings."""

from cardan.lateral.results import (
    ElasticBearing,
    LateralModes,
    LateralResonance,
    LateralResponse,
    PointMass,
    RigidShaft,
    TorqueStiffness,
    Unbalance,
)
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
