"""Derivatives of what rows of samples are reduced to.

An extreme changes as the sample at which it is. Mean, root mean square and peak change as their
formulas say. All of them are sums of samples with weights that depend on the outputs, so that the
derivatives are those of the samples, weighted and summed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.derivatives import Derivatives, Gradient, checked_weights
from cardan.evaluation.layout import PlanePlace

if TYPE_CHECKING:
    from cardan.evaluation.plan import Plan


def reduced_gradient(
    whole: Plan,
    reduce: str,
    places: Mapping[str, PlanePlace],
    angle: Any,  # noqa: ANN401 - angles or a sweep
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
    found: Gradient = whole.gradient(angle, of_samples)
    return found


def reduced_derivatives(
    whole: Plan,
    reduce: str,
    angle: Any,  # noqa: ANN401 - angles or a sweep
    by: str | Iterable[str],
) -> Derivatives:
    """Return the derivatives of reduced outputs, with the arguments of ``reduced_gradient``."""
    by = by if isinstance(by, str) or not isinstance(by, Iterable) else tuple(by)
    if by == "angle" or "angle" in by:
        raise ArgumentValueError(
            "by", "has 'angle', of which a reduced output has many; a plan with reduce=None has it"
        )
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


def _slopes(
    whole: Plan,
    reduce: str,
    angle: Any,  # noqa: ANN401 - angles or a sweep
) -> dict[str, FloatArray]:
    """The derivatives of the reduced outputs by the samples, in the shape of the samples."""
    result = whole(angle)
    return {
        name: _slope(reduce, np.asarray(result[name], np.float64), whole.places[name][2])
        for name in result
    }


def _slope(reduce: str, samples: FloatArray, vector: bool) -> FloatArray:
    axis = samples.ndim - (2 if vector else 1)
    count = samples.shape[axis]
    if reduce == "mean":
        return np.full_like(samples, 1.0 / count)
    if reduce == "rms":
        root = np.sqrt(np.mean(samples**2, axis=axis, keepdims=True))
        return _ratio(samples, count * root)
    if reduce == "peak":
        size = np.linalg.norm(samples, axis=-1) if vector else np.abs(samples)
        at = np.argmax(size, axis=axis, keepdims=True)
        direction = _ratio(samples, size[..., np.newaxis] if vector else size)
        return direction * _only(at[..., np.newaxis] if vector else at, samples.shape, axis)
    find = np.argmin if reduce == "min" else np.argmax
    return _only(find(samples, axis=axis, keepdims=True), samples.shape, axis)


def _only(at: NDArray[np.intp], shape: tuple[int, ...], axis: int) -> FloatArray:
    """Return 1 at one index along an axis, and 0 elsewhere."""
    along = np.arange(shape[axis]).reshape(-1, *(1,) * (len(shape) - axis - 1))
    return np.where(along == at, 1.0, 0.0)


def _ratio(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the ratio, 0 where both vanish: a magnitude has no derivative there."""
    return np.divide(x, y, out=np.zeros(np.broadcast_shapes(x.shape, y.shape)), where=y != 0.0)
