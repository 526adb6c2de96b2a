"""Torsional vibration of drivelines with compliant shafts."""

from cardan.torsion.equations import TorsionalMotion
from cardan.torsion.results import Coexisting, Orbit, Stability
from cardan.torsion.steady_state import SteadyState
from cardan.torsion.system import TorsionalSystem
from cardan.torsion.transient import Transient
from cardan.torsion.tube import Tube, tube

__all__ = [
    "Coexisting",
    "Orbit",
    "Stability",
    "SteadyState",
    "TorsionalMotion",
    "TorsionalSystem",
    "Transient",
    "Tube",
    "tube",
]
