"""Derivatives of outputs by the parameters of drivelines: those of every sample, or of a sum.

The native module sums them over the samples in the pass that evaluates
(``docs/theory/derivatives.md``). Those of reduced samples are sums of those of the samples with
weights that depend on the outputs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_shape, nearest
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.reductions import REDUCTIONS, Reduction
from cardan.evaluation.request import PlanePlace, components_first, layout_of
from cardan.evaluation.sweep import Sweep
from cardan.geometry.parameters import checked_variables, has_lengths, parameter_shape

if TYPE_CHECKING:
    from cardan.driveline import Driveline
    from cardan.evaluation.plan import Plan

# Names of variables in the native module, in the order of its columns.
_COLUMNS = {
    **{name: name for name in ("value", "bends", "twists", "phases", "points", "angle")},
    **dict.fromkeys(("drive_torque", "output_torque"), "torque"),
    **{name: name for name in ("inertias", "lengths", "positions", "deviations")},
}

_Stepped = tuple[FloatArray, int, int]


class Derivatives(dict[str, Mapping[str, NDArray[np.float64]]]):
    """Derivatives of every sample: ``d["speed_ratio"]["bends"]``; made by ``Plan.derivatives``."""

    def __repr__(self) -> str:
        """Show outputs and variables."""
        by = next(iter(self.values()), {})
        return f"<Derivatives of {', '.join(self)} by {', '.join(by)}>"


@dataclass(frozen=True, eq=False)
class Gradient:
    """A weighted sum of outputs and its derivatives; made by ``Plan.gradient``.

    There is one sum for each driveline of a batch. Derivatives are per radian, per unit of the
    points, per N m and per kg m². Those that the plan does not have are missing: ``points`` of a
    driveline that was not made from points or has deviations, torques and inertias without a load,
    lengths that are unknown, positions without bearings, deviations of ideal joints, which
    ``Plan.derivatives`` gives.

    Attributes:
        value: ``sum(weights * outputs)`` over items, components and samples, in the shape of the
            batch.
        bends: ``(..., n)``.
        twists: ``(..., n - 1)``.
        phases: ``(..., n - 1)``.
        points: ``(..., n + 2, 3)``; only of drivelines made from points.
        drive_torque: in the shape of the batch, if the load has a drive torque.
        output_torque: in the shape of the batch, if the load has an output torque.
        inertias: ``(..., n + 1)``, if there is a load. An array of inertias that changes over the
            samples changes by the same amount at each.
        lengths: ``(..., n + 1)``, if the lengths of the shafts are known; all directions are held.
        positions: of the bearings, ``(..., m)``, if there are any.
        deviations: of driving yoke, cross and driven yoke of each joint, ``(..., n, 3)``, if the
            driveline has deviations.
    """

    value: NDArray[np.float64]
    bends: NDArray[np.float64]
    twists: NDArray[np.float64]
    phases: NDArray[np.float64]
    _others: Mapping[str, NDArray[np.float64]]

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        """Return what only some gradients have."""
        wanted = {
            "points": "a driveline made from points",
            "drive_torque": "a load with a drive_torque",
            "output_torque": "a load with an output_torque",
            "inertias": "a load",
            "lengths": "the lengths of the shafts",
            "positions": "bearings",
            "deviations": "a driveline with deviations",
        }
        if needs := wanted.get(name):
            if name in self._others:
                return self._others[name]
            raise AttributeError(f"there is no derivative by {name}; it needs {needs}")
        raise AttributeError(f"Gradient has no attribute {name!r}")


class DerivativeSamples:
    """The samples of one call: for each driveline the same number, one after another.

    The axes of the batch come first and the others behind them, whatever the order in which they
    broadcast.
    """

    def __init__(self, plan: Plan, angle: ArrayLike | Sweep) -> None:
        """Broadcast the angles."""
        line, request = plan.line, plan.request
        forces = [name for name in plan.places if OUTPUTS[name].unit == "N"]
        if request.axes == "shaft" and forces:
            # They need the derivatives of the axes themselves, which only moments do without.
            problem = f"is 'shaft'; derivatives of {forces[0]} are known in 'space' only"
            raise ArgumentValueError("axes", problem)
        self._level = plan._level
        self.request, self.places, self.line = request, plan.places, line
        self._angle = angle if isinstance(angle, Sweep) else as_float64("angle", angle)
        load = request.load
        of_load = {} if load is None else load.shapes()
        self.shape = common_shape(driveline=line.shape, angle=self._angle.shape, **of_load)
        own = common_shape(driveline=line.shape, angle=self._angle.shape)
        if self.shape != own:
            # As for a call of the plan, whose results have the shape of driveline and angle.
            raise ArgumentValueError("load", f"has shape {self.shape}; the samples have {own}")
        padded = (1,) * (len(self.shape) - len(line.shape)) + line.shape
        self._lines = [axis for axis, length in enumerate(padded) if length != 1]
        rest = [axis for axis in range(len(self.shape)) if axis not in self._lines]
        self._order = [*self._lines, *rest]
        self.line_count = math.prod(line.shape)
        self.count = math.prod(self.shape[axis] for axis in rest)

    def spread(self, array: FloatArray) -> _Stepped:
        """Return an array that broadcasts to the samples, flat, with its two steps."""
        if array.size == 1:
            return array.reshape(-1), 0, 0
        if not self._lines and array.shape == self.shape:
            return np.ascontiguousarray(array).reshape(-1), 0, 1
        padded = array.reshape((1,) * (len(self.shape) - array.ndim) + array.shape)
        moved = padded.transpose(self._order)
        own, split = moved.shape, len(self._lines)
        varies = [math.prod(own[:split]) != 1, math.prod(own[split:]) != 1]
        full = [self.shape[axis] for axis in self._order]
        lead = full[:split] if varies[0] else own[:split]
        tail = full[split:] if varies[1] else own[split:]
        flat = np.ascontiguousarray(np.broadcast_to(moved, (*lead, *tail))).reshape(-1)
        step = math.prod(tail)
        return flat, step if varies[0] else 0, 1 if varies[1] else 0

    def run(self, by: Sequence[str], weights: list[FloatArray] | None) -> FloatArray:
        """Call the native module; weights are one flat array per plane."""
        request, n = self.request, self.line.n_joints
        layout = layout_of(
            request.names, n, request.shafts, request.joints, None, self.line.n_bearings
        )
        bearings = [*range(self.line.n_bearings)]
        items = {"shaft": layout.shafts, "joint": layout.joints, "bearing": bearings}
        outputs = [(name, items[OUTPUTS[name].per]) for name in self.places]
        wanted = sorted({_COLUMNS[name] for name in by})
        return _core.differentiate(
            self.line._lines,
            outputs,
            self.count,
            self._drive_angles(),
            self._load(),
            weights,
            wanted,
            (request.axes, request.angle_of == "driven"),
            threads.at_most(request.workers),
            self._level,
        )

    def _drive_angles(self) -> Any:  # noqa: ANN401 - a native sweep or an array
        if not isinstance(self._angle, Sweep):
            return self.spread(self._angle)
        if len(self._angle) == self.count:
            return self._angle._core
        # The angles of the sweep differ from driveline to driveline, not within one.
        return self.spread(np.asarray(self._angle))

    def _load(self) -> Any:  # noqa: ANN401 - the arrays of the load, if there is one
        load = self.request.load
        if load is None:
            return None
        inertias: Any = () if load.inertias is None else np.moveaxis(load.inertias, -1, 0)
        arrays = (load.torque, load.speed, load.acceleration)
        of_shafts = [(i, self.spread(np.asarray(x))) for i, x in enumerate(inertias)]
        return (load.end, *map(self.spread, arrays), of_shafts)


def gradient(plan: Plan, angle: ArrayLike | Sweep, weights: Mapping[str, ArrayLike]) -> Gradient:
    """Return a weighted sum and its derivatives at drive angles, as ``Plan.gradient`` does."""
    samples = DerivativeSamples(plan, angle)
    line, load = plan.line, plan.request.load
    others = {
        "points": line.has_points and not line.has_deviations,
        "lengths": has_lengths(line),
        "positions": line.n_bearings,
        "deviations": line.has_deviations,
    }
    of_load = [] if load is None else [f"{load.end}_torque", "inertias"]
    by = [
        "value",
        "bends",
        "twists",
        "phases",
        *of_load,
        *(name for name in others if others[name]),
    ]
    flat = samples.run(by, [*_planes(samples, weights)])
    columns = [*_columns(by, line)]
    width = sum(math.prod(shape) for _, _, shape in columns)
    # The size of an axis cannot be left open in a batch of none.
    rows = flat.reshape(*line.shape, width)
    parts = {
        name: rows[..., start : start + math.prod(shape)].reshape((*line.shape, *shape))[()]
        for name, start, shape in columns
    }
    value, bends, twists, phases = (parts.pop(name) for name in by[:4])
    return Gradient(value, bends, twists, phases, parts)


def derivatives(plan: Plan, angle: ArrayLike | Sweep, by: str | Iterable[str]) -> Derivatives:
    """Return the derivatives of every sample at drive angles, as ``Plan.derivatives`` does."""
    line, places = plan.line, plan.places
    names = checked_variables(line, by)
    _check_load(plan.request.load, names)
    samples = DerivativeSamples(plan, angle)
    total = math.prod(samples.shape)
    planes = sum(place.planes for place in places.values())
    columns = [*_columns(names, line)]
    width = sum(math.prod(shape) for _, _, shape in columns)
    flat = samples.run(names, None) if width and total else np.empty(planes * total * width)
    plane = (samples.shape[axis] for axis in samples._order)
    ndim = len(samples.shape)
    # The axes of the samples in their own order.
    axes = 1 + np.argsort(samples._order)
    block = flat.reshape(planes, *plane, width).transpose(0, *axes, 1 + ndim)
    found: dict[str, dict[str, NDArray[np.float64]]] = {}
    for output, place in places.items():
        own = block[place.first : place.first + place.planes]
        lead = place.shape(())
        whole = own.reshape((*lead, *own.shape[1:]))
        if place.vector:
            whole = np.moveaxis(whole, len(lead) - 1, len(lead) - 1 + ndim)
        found[output] = {}
        for name, start, shape in columns:
            part = whole[..., start : start + math.prod(shape)]
            found[output][name] = part.reshape((*part.shape[:-1], *shape))[()]
    return Derivatives({name: {kind: found[name][kind] for kind in names} for name in found})


def _columns(names: Iterable[str], line: Driveline) -> Iterator[tuple[str, int, tuple[int, ...]]]:
    """The first column and the shape of each variable, in the order of the native module."""
    at = 0
    for name in sorted(names, key=[*_COLUMNS].index):
        shape = parameter_shape(name, line.n_joints, line.n_bearings)
        yield name, at, shape
        at += math.prod(shape)


def _planes(samples: DerivativeSamples, weights: Mapping[str, ArrayLike]) -> Iterator[FloatArray]:
    full = checked_weights(weights, samples.places, samples.shape)
    for name, place in samples.places.items():
        if name not in full:
            yield from [np.zeros(samples.line_count * samples.count)] * place.planes
            continue
        planes = components_first(full[name], place).reshape(place.planes, *samples.shape)
        moved = planes.transpose(0, *(axis + 1 for axis in samples._order))
        yield from np.ascontiguousarray(moved).reshape(place.planes, -1)


def checked_weights(
    weights: Mapping[str, ArrayLike], places: Mapping[str, PlanePlace], shape: tuple[int, ...]
) -> dict[str, FloatArray]:
    """Return the weights, each in the shape of its output for samples of this shape."""
    if not isinstance(weights, Mapping):
        problem = f"is {type(weights).__name__}; it must map names of outputs to arrays"
        raise ArgumentTypeError("weights", problem)
    full = {}
    for name, given in weights.items():
        if name in ("bend", "equivalent_bend"):
            problem = "has an infinite slope at constant velocity; differentiate abs(q)**2 instead"
            problem += ", by Driveline.transmission(shaft).d_abs2(by)"
            raise ArgumentValueError("weights", problem, (name,))
        if name not in places:
            problem = f"is not an output of the plan; {nearest(name, places)}"
            raise ArgumentValueError("weights", problem, (name,))
        array = as_float64("weights", given)
        wanted = places[name].shape(shape)
        try:
            full[name] = np.broadcast_to(array, wanted)
        except ValueError:
            check_shape("weights", array, False, f"it must be {wanted}", (name,))
    return full


def _check_load(load: Load | None, by: Iterable[str]) -> None:
    known = () if load is None else ("inertias", f"{load.end}_torque")
    has = "no load" if load is None else f"a load with {load.end}_torque"
    for i, name in enumerate(by):
        if (name == "inertias" or name.endswith("_torque")) and name not in known:
            raise ArgumentValueError("by", f"is {name!r}; the plan has {has}", (i,))


def reduced_gradient(
    whole: Plan,
    reduce: Reduction,
    places: Mapping[str, PlanePlace],
    angle: ArrayLike | Sweep,
    weights: Mapping[str, ArrayLike],
) -> Gradient:
    """Return a weighted sum of reduced outputs and its derivatives, from a plan of the samples."""
    rows = whole._rows(whole._sample_shape(np.shape(angle)))
    full = checked_weights(weights, places, rows)
    slopes = _slopes(whole, reduce, angle)
    of_samples = {}
    for name, weight in full.items():
        vector = whole.places[name][2]
        if vector and reduce == "peak":
            weight = weight[..., np.newaxis]
        of_samples[name] = np.expand_dims(weight, -2 if vector else -1) * slopes[name]
    return whole.gradient(angle, of_samples)


def reduced_derivatives(
    whole: Plan, reduce: Reduction, angle: ArrayLike | Sweep, by: str | Iterable[str]
) -> Derivatives:
    """Return the derivatives of reduced outputs, with the arguments of ``reduced_gradient``."""
    by = by if isinstance(by, str) or not isinstance(by, Iterable) else tuple(by)
    if by == "angle" or "angle" in by:
        problem = "has 'angle', of which a reduced output has many; a plan with reduce=None has it"
        raise ArgumentValueError("by", problem)
    whole._rows(whole._sample_shape(np.shape(angle)))
    slopes = _slopes(whole, reduce, angle)
    found: dict[str, dict[str, NDArray[np.float64]]] = {}
    for name, of_samples in whole.derivatives(angle, by).items():
        slope = slopes[name]
        axis = slope.ndim - (2 if whole.places[name][2] else 1)
        found[name] = {}
        for kind, array in of_samples.items():
            weighted = slope.reshape(slope.shape + (1,) * (array.ndim - slope.ndim)) * array
            summed = weighted.sum(axis=axis)
            if reduce == "peak" and whole.places[name][2]:
                summed = summed.sum(axis=axis)
            found[name][kind] = summed
    return Derivatives(found)


def _slopes(whole: Plan, reduce: Reduction, angle: ArrayLike | Sweep) -> dict[str, FloatArray]:
    """The derivatives of the reduced outputs by the samples, in the shape of the samples."""
    result = whole(angle)
    return {
        name: REDUCTIONS[reduce].slope(np.asarray(result[name], float), whole.places[name][2])
        for name in result
    }
