"""Torsional vibration of drivelines with compliant shafts."""

from cardan.torsion.equations import TorsionalMotion
from cardan.torsion.instability import StabilityMap, UnstableRange
from cardan.torsion.modes import BendRule, Mode
from cardan.torsion.results import Coexisting, Orbit, Stability
from cardan.torsion.side_by_side import SideBySide
from cardan.torsion.steady_state import SteadyState
from cardan.torsion.system import TorsionalSystem
from cardan.torsion.transient import Transient
from cardan.torsion.tube import Tube, tube

__all__ = [
    "BendRule",
    "Coexisting",
    "Mode",
    "Orbit",
    "SideBySide",
    "Stability",
    "StabilityMap",
    "SteadyState",
    "TorsionalMotion",
    "TorsionalSystem",
    "Transient",
    "Tube",
    "UnstableRange",
    "tube",
]
