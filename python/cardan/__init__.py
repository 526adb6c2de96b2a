"""Universal (Cardan) joints and drivelines: motion, moments and phasing over large angle arrays.

Angles are in radians and quantities in SI units; degrees appear only where a name or keyword says
so. A driveline of ``n`` joints has ``n + 1`` shafts, both counted from 0; shaft 0 drives.

>>> import cardan
>>> joint = cardan.Driveline.from_bends([30], degrees=True)
>>> result = joint.evaluate([0.0, 0.5, 1.0], outputs=("angle_error", "speed_ratio"))
>>> result.speed_ratio.round(6)
array([1.154701, 1.072527, 0.934205])
"""

from typing import TYPE_CHECKING

from cardan._core import __version__ as __version__

if TYPE_CHECKING:
    from cardan import plots as plots
    from cardan import reference as reference
    from cardan import scene as scene
    from cardan import workshop as workshop
    from cardan.ball_joint import BallJoint as BallJoint
    from cardan.check import Check as Check
    from cardan.derivatives import Derivatives as Derivatives
    from cardan.derivatives import Gradient as Gradient
    from cardan.driveline import Driveline as Driveline
    from cardan.equivalent import EquivalentJoint as EquivalentJoint
    from cardan.equivalent import Motion as Motion
    from cardan.equivalent import Transmission as Transmission
    from cardan.errors import ArgumentError as ArgumentError
    from cardan.errors import ArgumentTypeError as ArgumentTypeError
    from cardan.errors import ArgumentValueError as ArgumentValueError
    from cardan.finding import Finding as Finding
    from cardan.free_running import FreeRunning as FreeRunning
    from cardan.harmonics import Harmonics as Harmonics
    from cardan.identification import Identification as Identification
    from cardan.identification import TwoJoints as TwoJoints
    from cardan.identification import identify as identify
    from cardan.identification import identify_two_joints as identify_two_joints
    from cardan.interop import jax as jax
    from cardan.interop import scipy as scipy
    from cardan.interop import torch as torch
    from cardan.life import Life as Life
    from cardan.limits import Limit as Limit
    from cardan.limits import Limits as Limits
    from cardan.load import Load as Load
    from cardan.losses import Losses as Losses
    from cardan.optimisation import ActiveLimit as ActiveLimit
    from cardan.optimisation import Optimum as Optimum
    from cardan.optimisation import optimise as optimise
    from cardan.order_tolerances import OrderTolerances as OrderTolerances
    from cardan.outputs import OUTPUTS as OUTPUTS
    from cardan.outputs import Output as Output
    from cardan.plan import Plan as Plan
    from cardan.reference import approximations as approximations
    from cardan.result import Result as Result
    from cardan.scene import Scene as Scene
    from cardan.slides import Slides as Slides
    from cardan.slip import Lengths as Lengths
    from cardan.slip import SplineForce as SplineForce
    from cardan.steering import Steering as Steering
    from cardan.sweep import Sweep as Sweep
    from cardan.tolerances import Tolerances as Tolerances
    from cardan.torsion import TorsionalSystem as TorsionalSystem
    from cardan.torsion.tube import Tube as Tube
    from cardan.torsion.tube import tube as tube
else:
    from importlib import import_module as _import_module

    # All are imported when they are asked for: few programs need many of them.
    _NAMES = {
        "ball_joint": "BallJoint",
        "check": "Check",
        "derivatives": "Derivatives Gradient",
        "driveline": "Driveline",
        "equivalent": "EquivalentJoint Motion Transmission",
        "errors": "ArgumentError ArgumentTypeError ArgumentValueError",
        "finding": "Finding",
        "free_running": "FreeRunning",
        "harmonics": "Harmonics",
        "identification": "Identification TwoJoints identify identify_two_joints",
        "life": "Life",
        "limits": "Limit Limits",
        "load": "Load",
        "losses": "Losses",
        "optimisation": "ActiveLimit Optimum optimise",
        "order_tolerances": "OrderTolerances",
        "outputs": "OUTPUTS Output",
        "plan": "Plan",
        "result": "Result",
        "scene": "Scene",
        "slides": "Slides",
        "slip": "Lengths SplineForce",
        "steering": "Steering",
        "sweep": "Sweep",
        "tolerances": "Tolerances",
        "torsion": "TorsionalSystem",
        "torsion.tube": "Tube tube",
    }
    _HOMES = {
        name: f"cardan.{module}" for module, names in _NAMES.items() for name in names.split()
    }
    _MODULES = {
        "approximations": "cardan.reference.approximations",
        "plots": "cardan.plots",
        "reference": "cardan.reference",
        "workshop": "cardan.workshop",
    }
    # A star must not replace what its user has by these names.
    _NOT_BY_STAR = {
        "jax": "cardan.interop.jax",
        "scene": "cardan.scene",
        "scipy": "cardan.interop.scipy",
        "torch": "cardan.interop.torch",
    }
    __all__ = sorted(["__version__", *_HOMES, *_MODULES])

    def __getattr__(name: str) -> object:
        if name in _HOMES:
            found = getattr(_import_module(_HOMES[name]), name)
        elif module := _MODULES.get(name) or _NOT_BY_STAR.get(name):
            found = _import_module(module)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        return sorted({*__all__, *_NOT_BY_STAR})
