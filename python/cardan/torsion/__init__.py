"""Torsional vibration of drivelines with compliant shafts."""

from cardan.torsion.analyses import BendRule as BendRule
from cardan.torsion.analyses import LargestTorque as LargestTorque
from cardan.torsion.analyses import Mode as Mode
from cardan.torsion.analyses import RunningSpeed as RunningSpeed
from cardan.torsion.analyses import SideBySide as SideBySide
from cardan.torsion.analyses import SpeedResponse as SpeedResponse
from cardan.torsion.analyses import StabilityMap as StabilityMap
from cardan.torsion.analyses import UnstableRange as UnstableRange
from cardan.torsion.excitation import Coupling as Coupling
from cardan.torsion.excitation import TorqueHarmonic as TorqueHarmonic
from cardan.torsion.excitation import firing_harmonics as firing_harmonics
from cardan.torsion.results import Coexisting as Coexisting
from cardan.torsion.results import Orbit as Orbit
from cardan.torsion.results import Stability as Stability
from cardan.torsion.results import SteadyState as SteadyState
from cardan.torsion.system import TorsionalSystem as TorsionalSystem
from cardan.torsion.transient import TorsionalMotion as TorsionalMotion
from cardan.torsion.transient import Transient as Transient
from cardan.torsion.tube import Tube as Tube
from cardan.torsion.tube import tube as tube
