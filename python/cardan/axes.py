"""Vectors in axes that turn with the shaft on which they act.

The axis x points along the shaft, y along its input-side pin (along the output-side pin of shaft
0), and z is the cross product of both. The moment of a joint is perpendicular to the pins of its
cross. It has therefore no component along the driven shaft's y, and in those axes it is

``(D, 0, D tan t)``

with the torque ``D`` that enters the driven shaft and the tilt ``t`` of the cross against it (from
Thoma 5 and Grossmann 5). In the same axes of the driving shaft, but with y along its output-side
pin, it is ``(D', 0, -D' tan t')``. The phase turns these into those at the input side. The
magnitudes of the components along z are the bending moments.

Forces are turned from space into these axes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, adapter, array_namespace_of, as_float64
from cardan.arrays.planes import planes_of, view
from cardan.load import Load
from cardan.outputs import OUTPUTS
from cardan.plan import Plan
from cardan.request import Request
from cardan.result import Result
from cardan.sweep import Sweep
from cardan.turning_pin import TurningPin, pin_of

# Samples at a time of rows that are reduced.
_PIECE = 1 << 18

# Samples at a time whose intermediate results stay in the cache.
_CACHED = 1 << 12


class ShaftAxesPlan(Plan):
    """A plan whose vectors have the axes of their shafts; made by ``Driveline.plan``."""

    __slots__ = (
        "_bearings",
        "_driven_side",
        "_driving_side",
        "_forces",
        "_joints",
        "_pins",
        "_scalars",
        "_shafts",
    )

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of Plan
        """Prepare as ``Plan`` does, with the same arguments."""
        super().__init__(*arguments)
        self._arguments = (*self._arguments, "shaft")
        line, names, shafts, joints, load, reduce, dtype, tolerance, workers = self._arguments[:9]
        options = (dtype, tolerance, workers)
        scalars = [name for name in names if not OUTPUTS[name].vector]
        self._scalars = (
            Plan(line, scalars, shafts, joints, load, reduce, *options) if scalars else None
        )
        self._shafts, self._joints = (_listed(items) for items in self.labels[:2])
        self._bearings = [shaft for shaft, _ in line.bearings]
        forces = [name for name in names if OUTPUTS[name].unit == "N"]
        self._forces = Plan(line, forces, shafts, joints, load, None, *options) if forces else None
        loaded = {shaft for name in forces for shaft in self._shafts_of(name)}
        self._pins: dict[int, TurningPin] = {
            shaft: pin_of(line._geometry, shaft) for shaft in loaded
        }
        before, after = set(), set()
        if "moment" in names:
            before |= {joint + 1 for joint in self._joints}
        if "support_moment" in names:
            before |= {shaft for shaft in self._shafts if shaft > 0}
            after |= {shaft for shaft in self._shafts if shaft < line.n_joints}
        self._driven_side = self._side("driven", [shaft - 1 for shaft in sorted(before)])
        self._driving_side = self._side("driving", sorted(after))

    def _side(self, side: str, joints: list[int]) -> _Side | None:
        """The torque behind some joints and the signed bending on one side of them."""
        if not joints:
            return None
        line, _, _, _, load, _, dtype, tolerance, workers = self._arguments[:9]
        return _Side(side, joints, line, load, (None, dtype, tolerance, workers))

    def _shafts_of(self, name: str) -> list[int]:
        """The shaft on which each vector of an output acts."""
        if name == "bearing_force":
            return self._bearings
        return self._shafts if name == "support_moment" else [j + 1 for j in self._joints]

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate as any plan does; with ``out``, the arrays are filled at the end."""
        if not isinstance(angle, Sweep):
            if name := array_namespace_of(angle):
                elsewhere: Result = adapter(name).evaluate(self, angle, out)
                return elsewhere
            angle = as_float64("angle", angle)
        shape = self._sample_shape(angle.shape)
        rows = self._rows(shape) if self._reduce else shape
        given = {} if out is None else self._checked_out(out, rows)
        arrays = dict(self._scalars(angle)) if self._scalars else {}
        arrays |= self._reduced(angle, shape) if self._reduce else self._vectors(angle, shape)
        for name, target in given.items():
            target[...] = arrays[name]
            arrays[name] = target
        return Result({name: arrays[name] for name in self.places}, self.labels, angle)

    def _vectors(self, angle: FloatArray | Sweep, shape: tuple[int, ...]) -> dict[str, Any]:
        """The vectors among the outputs at every sample."""
        vectors = {name: place[1] for name, place in self.places.items() if place[2]}
        planes = {
            name: np.zeros((1 if items is None else items, 3, *shape), self.dtype)
            for name, items in vectors.items()
        }
        # The angles of a part of a sweep are rounded, those of all of it are not.
        samples = math.prod(shape) if isinstance(angle, Sweep) else _CACHED
        for part, own in self._pieces(angle, shape, samples):
            self._fill({name: found[..., part] for name, found in planes.items()}, own)
        return {
            name: view(planes_of(found, len(shape)), (0, vectors[name], True))
            for name, found in planes.items()
        }

    def _pieces(
        self, angle: FloatArray | Sweep, shape: tuple[int, ...], samples: int
    ) -> Iterator[tuple[Any, FloatArray | Sweep]]:
        """The samples in parts along their last axis, each with its angles."""
        length = shape[-1] if shape else 1
        load = self.request.load
        fixed = [self._line_shape, *(array.shape for array in self._load)]
        if load is not None and load.inertias is not None:
            fixed.append(load.inertias.shape[:-1])
        step = max(1, samples // max(1, math.prod(shape[:-1])))
        # What is paired with the angles is not cut.
        paired = any(other and other[-1] > 1 for other in fixed)
        if step >= length or paired or angle.shape[-1:] != (length,):
            yield slice(None), angle
            return
        for start in range(0, length, step):
            yield slice(start, start + step), _part(angle, start, min(step, length - start))

    def _fill(self, planes: Mapping[str, NDArray[Any]], angle: FloatArray | Sweep) -> None:
        """Fill the planes of the vectors of some samples, which are zero."""
        torque, driven = self._driven_side(angle) if self._driven_side else ({}, {})
        _, driving = self._driving_side(angle) if self._driving_side else ({}, {})
        forces = self._forces(angle) if self._forces else {}
        turn = _turn(angle) if forces else None
        for name, found in planes.items():
            for item, (plane, shaft) in enumerate(zip(found, self._shafts_of(name), strict=True)):
                if turn is not None and name in forces:
                    space = forces[name]
                    force = space if self.places[name][1] is None else space[item]
                    values = self._pins[shaft].components(force, turn)
                    for axis, component in enumerate(values):
                        plane[axis] = component
                    continue
                if name == "moment":
                    plane[0], plane[2] = torque[shaft - 1], driven[shaft - 1]
                else:
                    _support(
                        plane, shaft, self.request.line, driven.get(shaft - 1), driving.get(shaft)
                    )
                # Where the angle is NaN, so is what is 0 elsewhere.
                plane[:2] += 0.0 * plane[2]

    def _reduced(self, angle: FloatArray | Sweep, shape: tuple[int, ...]) -> dict[str, Any]:
        """Each component over the last axis of the samples, some samples at a time."""
        reduce, combine = _REDUCTIONS[str(self._reduce)]
        length = shape[-1]
        found: dict[str, list[Any]] = {}
        for part, own in self._pieces(angle, shape, _PIECE):
            piece = len(range(length)[part])
            for name, array in self._vectors(own, (*shape[:-1], piece)).items():
                found.setdefault(name, []).append(reduce(array.astype(np.float64), axis=-2))
        return {
            name: combine(np.stack(parts), length).astype(self.dtype)
            for name, parts in found.items()
        }

    def explain(self, angle: ArrayLike | Sweep | None = None) -> str:
        """Return the steps of the parts, as ``Plan.explain`` does."""
        sides = [side.plan for side in (self._driven_side, self._driving_side) if side]
        plans = [plan for plan in (self._scalars, *sides, self._forces) if plan]
        return "\n".join(["vectors in axes of their shafts", *(p.explain(angle) for p in plans)])

    def _again(self, request: Request) -> Plan:
        """Return a plan of the same kind for another request."""
        return ShaftAxesPlan(*request.arguments()[:9])

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what it was made from."""
        return (ShaftAxesPlan, self._arguments[:9])


class _Side:
    """The torque behind some joints, and the signed bending ``D tan t`` on one side of them."""

    __slots__ = ("_bending", "_joints", "_tilt", "plan")

    def __init__(
        self,
        side: str,
        joints: list[int],
        line: Any,  # noqa: ANN401 - a driveline
        load: Load | None,
        options: tuple[Any, ...],
    ) -> None:
        self._joints, self._bending, self._tilt = joints, f"bending_{side}", f"tilt_{side}"
        behind = [joint + 1 for joint in joints]
        names = ("torque", self._bending, self._tilt)
        self.plan = Plan(line, names, behind, joints, load, *options)

    def __call__(self, angle: FloatArray | Sweep) -> tuple[dict[int, Any], dict[int, Any]]:
        """Return torque and signed bending by joint."""
        result = self.plan(angle)
        torque, tilt = result.torque, result[self._tilt]
        # The bending moment is its magnitude, to the last digits also where the tilt is steep.
        signed = np.copysign(result[self._bending], tilt)
        signed *= np.copysign(1.0, torque, out=tilt)
        joints = self._joints
        return (
            dict(zip(joints, torque, strict=True)),
            dict(zip(joints, signed, strict=True)),
        )


# Of the samples of one piece, and of the pieces of a row of that many samples.
_REDUCTIONS: Mapping[str, tuple[Callable[..., Any], Callable[[FloatArray, int], Any]]] = {
    "min": (np.min, lambda parts, length: np.min(parts, axis=0)),
    "max": (np.max, lambda parts, length: np.max(parts, axis=0)),
    "mean": (np.sum, lambda parts, length: np.sum(parts, axis=0) / length),
    "rms": (
        lambda samples, axis: np.sum(samples**2, axis=axis),
        lambda parts, length: np.sqrt(np.sum(parts, axis=0) / length),
    ),
}


def _support(planes: NDArray[Any], shaft: int, line: Any, driven: Any, driving: Any) -> None:  # noqa: ANN401
    """Fill the components of a support moment from the ``D tan t`` at both ends of the shaft."""
    if driven is not None:
        planes[2] -= driven
    if driving is not None and shaft == 0:
        planes[2] -= driving
    elif driving is not None:
        phase = line.phases[..., shaft - 1]
        planes[1] += np.sin(phase) * driving
        planes[2] -= np.cos(phase) * driving


def _turn(angle: FloatArray | Sweep) -> tuple[FloatArray, FloatArray]:
    """Cosine and sine of drive angles."""
    angles = _part(angle, 0, angle.shape[0]) if isinstance(angle, Sweep) else angle
    return np.cos(angles), np.sin(angles)


def _listed(items: int | list[int]) -> list[int]:
    return items if isinstance(items, list) else [items]


def _part(angle: FloatArray | Sweep, start: int, count: int) -> FloatArray:
    if not isinstance(angle, Sweep):
        return angle[..., start : start + count]
    angles = np.empty(count)
    angle._core.fill(start, angles)
    return angles
