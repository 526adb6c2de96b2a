"""Evaluation as a function of its parameters, with products of weights and derivatives.

The frameworks that differentiate (JAX, PyTorch, the minimisers of SciPy) call these two functions:
outputs from a mapping of parameters, and the derivatives of a weighted sum of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest
from cardan.arrays.indices import Items
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import layout_of

# How many axes of each parameter belong to one driveline.
_ANGLES_OR_POINTS = {"bends": 1, "twists": 1, "phases": 1, "points": 2}
_OWN_AXES = {**_ANGLES_OR_POINTS, "lengths": 1, "positions": 1}
_LOADS = ("drive_torque", "output_torque", "inertias")
NAMES = (*_OWN_AXES, *_LOADS)


class Options(TypedDict, total=False):
    """The keyword arguments of an ``Evaluation``, which the functions of all frameworks take."""

    shafts: Items
    joints: Items
    speed: float
    acceleration: float
    bearings: Sequence[int]


@dataclass(frozen=True)
class Evaluation:
    """Settings of an evaluation, apart from the parameters and the drive angles."""

    outputs: str | Sequence[str]
    shafts: Items = None  # of the outputs per shaft
    joints: Items = None  # of the outputs per joint
    speed: float = 0.0  # of the drive, in rad/s
    acceleration: float = 0.0  # of the drive, in rad/s²
    bearings: Sequence[int] = ()  # the shaft of each, whose position is a parameter

    def check(self, shapes: Mapping[str, tuple[int, ...]]) -> None:
        """Check the names of the parameters and the shapes of those of the load."""
        if not isinstance(shapes, Mapping):
            raise ArgumentTypeError("parameters", "must map names to arrays")
        for name in shapes:
            if name not in NAMES:
                problem = f"is unknown; {nearest(name, NAMES)}"
                raise ArgumentValueError("parameters", problem, (name,))
        if ("bends" in shapes) == ("points" in shapes):
            raise ArgumentValueError("parameters", "must have either 'bends' or 'points'")
        for name in ("twists", "lengths"):
            if "points" in shapes and name in shapes:
                raise ArgumentValueError("parameters", "follow from the points", (name,))
        count = len(self.bearings)
        if shapes.get("positions", (0,))[-1:] != (count,):
            problem = f"must have one position per bearing, of which there are {count}"
            raise ArgumentValueError("parameters", problem, ("positions",))
        for name, ndim in (("drive_torque", 0), ("output_torque", 0), ("inertias", 1)):
            if name in shapes and len(shapes[name]) != ndim:
                wanted = "one number" if ndim == 0 else "one number per shaft"
                problem = f"has shape {shapes[name]}; it must be {wanted}"
                raise ArgumentValueError("parameters", problem, (name,))

    def result_shapes(
        self, shapes: Mapping[str, tuple[int, ...]], angle: tuple[int, ...]
    ) -> dict[str, tuple[int, ...]]:
        """Return the shape of each output, before anything is evaluated."""
        self.check(shapes)
        n = shapes["bends"][-1] if shapes.get("bends") else 1
        if "points" in shapes:
            n = shapes["points"][-2] - 2
        batches = {name: shapes[name][: -_OWN_AXES[name]] for name in _OWN_AXES if name in shapes}
        samples = common_shape(**batches, angle=angle)
        names = self.outputs if isinstance(self.outputs, str) else tuple(self.outputs)
        places = layout_of(names, n, self.shafts, self.joints, None, len(self.bearings)).places
        return {name: place.shape(samples) for name, place in places.items()}

    def plan(self, parameters: Mapping[str, FloatArray]) -> Plan:
        """Return the plan for these parameters."""
        geometry = {name: parameters[name] for name in _ANGLES_OR_POINTS if name in parameters}
        make: Any = Driveline.from_points if "points" in geometry else Driveline.from_bends
        line: Driveline = make(**geometry)
        if self.bearings or "lengths" in parameters:
            positions = np.moveaxis(parameters.get("positions", np.empty(0)), -1, 0)
            bearings = zip(self.bearings, positions, strict=True)
            line = line.with_bearings(bearings, parameters.get("lengths"))
        loaded = {name: parameters[name] for name in _LOADS if name in parameters}
        names = (self.outputs,) if isinstance(self.outputs, str) else tuple(self.outputs)
        load = None
        if loaded or any(OUTPUTS[name].needs_load for name in names if name in OUTPUTS):
            load = Load(**loaded, speed=self.speed, acceleration=self.acceleration)
        return line.plan(names, shafts=self.shafts, joints=self.joints, load=load)

    def values(self, parameters: Mapping[str, Any], angle: Any) -> dict[str, FloatArray]:  # noqa: ANN401 - arrays
        """Return the outputs."""
        result = self.plan(_doubles(parameters))(as_float64("angle", np.asarray(angle)))
        return {name: np.asarray(result[name], np.float64) for name in result}

    def pull_back(
        self,
        parameters: Mapping[str, Any],
        angle: Any,  # noqa: ANN401 - an array
        weights: Mapping[str, Any],
        by_angle: bool = True,
    ) -> tuple[dict[str, FloatArray], FloatArray]:
        """Return the gradient of ``sum(weights * outputs)`` in the parameters and the angles.

        Without ``by_angle`` the latter are 0.
        """
        given, angles = _doubles(parameters), as_float64("angle", np.asarray(angle))
        plan, weights = self.plan(given), _doubles(weights)
        gradient = plan.gradient(angles, weights)
        found = {
            name: summed_to(getattr(gradient, name), array.shape) for name, array in given.items()
        }
        if not by_angle:
            return found, np.zeros_like(angles)
        slopes = plan.derivatives(angles, by="angle")
        total: Any = 0.0
        for name, (_, items, vector) in plan.places.items():
            part = weights[name] * slopes[name]["angle"]
            part = part.sum(axis=-1) if vector else part
            total = total + (part if items is None else part.sum(axis=0))
        return found, summed_to(np.asarray(total), angles.shape)


def summed_to(array: NDArray[np.float64], shape: tuple[int, ...]) -> FloatArray:
    """Return the sums over the axes along which a shape was broadcast to that of the array."""
    if math.prod(shape) == 1:
        return np.asarray(array.sum()).reshape(shape)
    array = array.sum(axis=tuple(range(array.ndim - len(shape))))
    wide = tuple(i for i, n in enumerate(shape) if n == 1 and array.shape[i] != 1)
    summed: FloatArray = array.sum(axis=wide, keepdims=True).reshape(shape)
    return summed


def _doubles(parameters: Mapping[str, Any]) -> dict[str, FloatArray]:
    return {name: as_float64(name, np.asarray(value)) for name, value in parameters.items()}
