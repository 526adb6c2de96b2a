"""Torsional vibration of drivelines with compliant shafts."""

from cardan.torsion.analyses import (
    BendRule,
    LargestTorque,
    Mode,
    RunningSpeed,
    SideBySide,
    SpeedResponse,
    StabilityMap,
    UnstableRange,
)
from cardan.torsion.excitation import Coupling, TorqueHarmonic, firing_harmonics
from cardan.torsion.results import Coexisting, Orbit, Stability, SteadyState
from cardan.torsion.system import TorsionalSystem
from cardan.torsion.transient import TorsionalMotion, Transient
from cardan.torsion.tube import Tube, tube

__all__ = [
    "BendRule",
    "Coexisting",
    "Coupling",
    "LargestTorque",
    "Mode",
    "Orbit",
    "RunningSpeed",
    "SideBySide",
    "SpeedResponse",
    "Stability",
    "StabilityMap",
    "SteadyState",
    "TorqueHarmonic",
    "TorsionalMotion",
    "TorsionalSystem",
    "Transient",
    "Tube",
    "UnstableRange",
    "firing_harmonics",
    "tube",
]
