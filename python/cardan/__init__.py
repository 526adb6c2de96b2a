"""Universal (Cardan) joints and drivelines: motion, moments and phasing over large angle arrays.

Angles are in radians and quantities in SI units; degrees appear only where a name or keyword says
so. A driveline of ``n`` joints has ``n + 1`` shafts, both counted from 0; shaft 0 drives.

>>> import cardan
>>> joint = cardan.Driveline.from_bends([30], degrees=True)
>>> result = joint.evaluate([0.0, 0.5, 1.0], outputs=("angle_error", "speed_ratio"))
>>> result.speed_ratio.round(6)
array([1.154701, 1.072527, 0.934205])
"""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

from cardan._core import __version__
from cardan.ball_joint import BallJoint
from cardan.check import Check
from cardan.derivatives import Derivatives, Gradient
from cardan.driveline import Driveline
from cardan.equivalent import EquivalentJoint, Motion, Transmission
from cardan.errors import ArgumentError, ArgumentTypeError, ArgumentValueError
from cardan.finding import Finding
from cardan.free_running import FreeRunning
from cardan.harmonics import Harmonics
from cardan.identification import (
    Identification,
    TwoJoints,
    identify,
    identify_two_joints,
)
from cardan.life import Life
from cardan.limits import Limit, Limits
from cardan.load import Load
from cardan.losses import Losses
from cardan.optimisation import ActiveLimit, Optimum, optimise
from cardan.order_tolerances import OrderTolerances
from cardan.outputs import OUTPUTS, Output
from cardan.plan import Plan
from cardan.result import Result
from cardan.slides import Slides
from cardan.slip import Lengths, SplineForce
from cardan.steering import Steering
from cardan.sweep import Sweep
from cardan.tolerances import Tolerances
from cardan.torsion import TorsionalSystem, Tube, tube

if _TYPE_CHECKING:
    from cardan import approximations, plots, reference, workshop
    from cardan import scene as scene
    from cardan.interop import jax, scipy, torch
    from cardan.scene import Scene

__all__ = [
    "OUTPUTS",
    "ActiveLimit",
    "ArgumentError",
    "ArgumentTypeError",
    "ArgumentValueError",
    "BallJoint",
    "Check",
    "Derivatives",
    "Driveline",
    "EquivalentJoint",
    "Finding",
    "FreeRunning",
    "Gradient",
    "Harmonics",
    "Identification",
    "Lengths",
    "Life",
    "Limit",
    "Limits",
    "Load",
    "Losses",
    "Motion",
    "Optimum",
    "OrderTolerances",
    "Output",
    "Plan",
    "Result",
    "Scene",
    "Slides",
    "SplineForce",
    "Steering",
    "Sweep",
    "Tolerances",
    "TorsionalSystem",
    "Transmission",
    "Tube",
    "TwoJoints",
    "__version__",
    "approximations",
    "identify",
    "identify_two_joints",
    "jax",
    "optimise",
    "plots",
    "reference",
    "scipy",
    "torch",
    "tube",
    "workshop",
]

# What takes time to import and not everybody needs is imported when it is asked for.
_LATER = ("approximations", "plots", "reference", "scene", "workshop")
_ADAPTERS = ("jax", "scipy", "torch")


def __getattr__(name: str) -> _Any:  # noqa: ANN401 - a module or a class
    if name == "Scene":
        return _import_module("cardan.scene").Scene
    if name in _LATER:
        return _import_module(f"cardan.{name}")
    if name in _ADAPTERS:
        return _import_module(f"cardan.interop.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*__all__, *_LATER, *_ADAPTERS})
