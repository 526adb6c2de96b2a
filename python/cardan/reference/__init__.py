"""The library's answers again, slow and easy to follow, from vectors and the laws of mechanics.

No module of this room uses the core or one of its formulas, so that agreement with it means
something. Angles are in radians, everything else in SI units.
"""

from cardan.reference.forces import Loads as Loads
from cardan.reference.forces import loads as loads
from cardan.reference.vectors import Cross as Cross
from cardan.reference.vectors import ShaftMotion as ShaftMotion
from cardan.reference.vectors import Shafts as Shafts
from cardan.reference.vectors import Vector as Vector
from cardan.reference.vectors import crosses as crosses
from cardan.reference.vectors import from_bends as from_bends
from cardan.reference.vectors import from_directions as from_directions
from cardan.reference.vectors import from_points as from_points
from cardan.reference.vectors import mean_offset as mean_offset
from cardan.reference.vectors import motion as motion
from cardan.reference.vectors import tilts as tilts
from cardan.reference.vectors import turning_axes as turning_axes
