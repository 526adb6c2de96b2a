"""Torsional vibration of drivelines with compliant shafts."""

from cardan.torsion.results import Orbit, Stability, SteadyState
from cardan.torsion.system import TorsionalSystem
from cardan.torsion.tube import Tube, tube

__all__ = ["Orbit", "Stability", "SteadyState", "TorsionalSystem", "Tube", "tube"]
