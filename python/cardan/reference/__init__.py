"""The library's answers again, slow and easy to follow, from vectors and the laws of mechanics.

No module of this room uses the core or one of its formulas, so that agreement with it means
something. Angles are in radians, everything else in SI units.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
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
else:
    from importlib import import_module as _import_module

    # They are imported when they are asked for: the library needs the formulas of the sources only.
    _NAMES = {
        "forces": "Loads loads",
        "vectors": "Cross ShaftMotion Shafts Vector crosses from_bends from_directions from_points "
        "mean_offset motion tilts turning_axes",
    }

    def __getattr__(name: str) -> object:
        for module, names in _NAMES.items():
            if name in names.split():
                return getattr(_import_module(f"cardan.reference.{module}"), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted(name for names in _NAMES.values() for name in names.split())
