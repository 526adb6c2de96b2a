"""Universal (Cardan) joints and drivelines: motion, moments and phasing over large angle arrays.

Angles are in radians and quantities in SI units; degrees appear only where a name or keyword says
so. A driveline of ``n`` joints has ``n + 1`` shafts, both counted from 0; shaft 0 drives.

>>> import cardan
>>> joint = cardan.Driveline.from_bends([30], degrees=True)
>>> result = joint.evaluate([0.0, 0.5, 1.0], outputs=("angle_error", "speed_ratio"))
>>> result.speed_ratio.round(6)
array([1.154701, 1.072527, 0.934205])

What there is, by what it is for:

* Drivelines and their motion: ``Driveline`` with ``Load``, ``Sweep``, ``Plan``, ``Result``,
  ``Output``, ``OUTPUTS``, ``Harmonics``, ``Derivatives`` and ``Gradient``.
* One joint in place of several: ``EquivalentJoint``, ``Transmission``, ``Motion``, ``Steering``.
* Limits: ``Limits``, ``Limit``, ``Check``, ``Finding``, and ``Machine`` for all states at once.
* Wear and forces: ``Life``, ``Losses``, ``Lengths``, ``SplineForce``, ``Slides``, ``tube`` with
  ``Tube``, ``BallJoint``.
* Vibration: ``TorsionalSystem``, ``TorqueHarmonic``, ``Coupling``, ``firing_harmonics``,
  ``FreeRunning``; ``LateralSystem`` with ``RigidShaft``, ``ElasticBearing``, ``PointMass`` and
  ``Unbalance``.
* Inexact drivelines: ``Tolerances``, ``OrderTolerances``.
* From measurements: ``identify`` and ``identify_two_joints``, with ``Identification`` and
  ``TwoJoints``.
* Better layouts: ``optimise`` with ``Optimum`` and ``ActiveLimit``, ``workshop`` for yokes.
* Scenes: ``Scene``, ``Answer``, and the modules ``scene``, ``plots`` and ``files``.
* To compare with: ``reference`` and ``approximations``.
* Errors: ``ArgumentError``, ``ArgumentTypeError``, ``ArgumentValueError``.
"""

from typing import TYPE_CHECKING

from cardan._core import __version__ as __version__

if TYPE_CHECKING:
    from cardan import reference as reference
    from cardan.app import files as files
    from cardan.app import plots as plots
    from cardan.app import scene as scene
    from cardan.app.answers.answer import Answer as Answer
    from cardan.app.scene import Scene as Scene
    from cardan.arrays.errors import ArgumentError as ArgumentError
    from cardan.arrays.errors import ArgumentTypeError as ArgumentTypeError
    from cardan.arrays.errors import ArgumentValueError as ArgumentValueError
    from cardan.ball_joint import BallJoint as BallJoint
    from cardan.design.check import Check as Check
    from cardan.design.judged import Finding as Finding
    from cardan.design.limits import Limit as Limit
    from cardan.design.limits import Limits as Limits
    from cardan.design.machine import Machine as Machine
    from cardan.driveline import Driveline as Driveline
    from cardan.evaluation.derivatives import Derivatives as Derivatives
    from cardan.evaluation.derivatives import Gradient as Gradient
    from cardan.evaluation.harmonics import Harmonics as Harmonics
    from cardan.evaluation.load import Load as Load
    from cardan.evaluation.outputs import OUTPUTS as OUTPUTS
    from cardan.evaluation.outputs import Output as Output
    from cardan.evaluation.plan import Plan as Plan
    from cardan.evaluation.result import Result as Result
    from cardan.evaluation.sweep import Sweep as Sweep
    from cardan.interop import jax as jax
    from cardan.interop import scipy as scipy
    from cardan.interop import torch as torch
    from cardan.lateral import ElasticBearing as ElasticBearing
    from cardan.lateral import LateralSystem as LateralSystem
    from cardan.lateral import PointMass as PointMass
    from cardan.lateral import RigidShaft as RigidShaft
    from cardan.lateral import Unbalance as Unbalance
    from cardan.motion import workshop as workshop
    from cardan.motion.equivalent import EquivalentJoint as EquivalentJoint
    from cardan.motion.equivalent import Motion as Motion
    from cardan.motion.equivalent import Steering as Steering
    from cardan.motion.equivalent import Transmission as Transmission
    from cardan.motion.free_running import FreeRunning as FreeRunning
    from cardan.motion.identification import Identification as Identification
    from cardan.motion.identification import TwoJoints as TwoJoints
    from cardan.motion.identification import identify as identify
    from cardan.motion.identification import identify_two_joints as identify_two_joints
    from cardan.optimisation import ActiveLimit as ActiveLimit
    from cardan.optimisation import Optimum as Optimum
    from cardan.optimisation import optimise as optimise
    from cardan.reference import approximations as approximations
    from cardan.tolerances import Tolerances as Tolerances
    from cardan.tolerances.order_tolerances import OrderTolerances as OrderTolerances
    from cardan.torsion import Coupling as Coupling
    from cardan.torsion import TorqueHarmonic as TorqueHarmonic
    from cardan.torsion import TorsionalSystem as TorsionalSystem
    from cardan.torsion import firing_harmonics as firing_harmonics
    from cardan.torsion.tube import Tube as Tube
    from cardan.torsion.tube import tube as tube
    from cardan.wear.axial_travel import Slides as Slides
    from cardan.wear.life import Life as Life
    from cardan.wear.losses import Losses as Losses
    from cardan.wear.spline import Lengths as Lengths
    from cardan.wear.spline import SplineForce as SplineForce
else:
    from importlib import import_module as _import_module

    # All are imported when they are asked for: few programs need many of them.
    _NAMES = {
        "app.answers.answer": "Answer",
        "app.scene": "Scene",
        "arrays.errors": "ArgumentError ArgumentTypeError ArgumentValueError",
        "ball_joint": "BallJoint",
        "design.check": "Check",
        "design.judged": "Finding",
        "design.limits": "Limit Limits",
        "design.machine": "Machine",
        "driveline": "Driveline",
        "evaluation.derivatives": "Derivatives Gradient",
        "evaluation.harmonics": "Harmonics",
        "evaluation.load": "Load",
        "evaluation.outputs": "OUTPUTS Output",
        "evaluation.plan": "Plan",
        "evaluation.result": "Result",
        "evaluation.sweep": "Sweep",
        "lateral": "ElasticBearing LateralSystem PointMass RigidShaft Unbalance",
        "motion.equivalent": "EquivalentJoint Motion Steering Transmission",
        "motion.free_running": "FreeRunning",
        "motion.identification": "Identification TwoJoints identify identify_two_joints",
        "optimisation": "ActiveLimit Optimum optimise",
        "tolerances": "Tolerances",
        "tolerances.order_tolerances": "OrderTolerances",
        "torsion": "Coupling TorqueHarmonic TorsionalSystem firing_harmonics",
        "torsion.tube": "Tube tube",
        "wear.axial_travel": "Slides",
        "wear.life": "Life",
        "wear.losses": "Losses",
        "wear.spline": "Lengths SplineForce",
    }
    _HOMES = {
        name: f"cardan.{module}" for module, names in _NAMES.items() for name in names.split()
    }
    _MODULES = {
        "approximations": "cardan.reference.approximations",
        "plots": "cardan.app.plots",
        "reference": "cardan.reference",
        "workshop": "cardan.motion.workshop",
    }
    # A star must not replace what its user has by these names.
    _NOT_BY_STAR = {
        "files": "cardan.app.files",
        "jax": "cardan.interop.jax",
        "scene": "cardan.app.scene",
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
