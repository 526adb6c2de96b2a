"""What rows of samples can be reduced to: one table, for all that a reduction needs in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray

Reduction: TypeAlias = Literal["min", "max", "mean", "rms", "peak"]


class _Row(NamedTuple):
    """A reduction: how it is called in files, combines pieces of a row, and is differentiated."""

    cell_method: str  # of the CF conventions, appendix E
    of_pieces: Callable[[Any, NDArray[np.float64]], Any]
    """From the results of the pieces of a row, on the last axis, and their shares of the row."""
    slope: Callable[[FloatArray, bool], FloatArray]
    """Its derivatives by the samples, which may be vectors, in the shape of the samples."""


def _slope_of_min(samples: FloatArray, vector: bool) -> FloatArray:
    axis = _axis(samples, vector)
    return _only(np.argmin(samples, axis=axis, keepdims=True), samples.shape, axis)


def _slope_of_max(samples: FloatArray, vector: bool) -> FloatArray:
    axis = _axis(samples, vector)
    return _only(np.argmax(samples, axis=axis, keepdims=True), samples.shape, axis)


def _slope_of_mean(samples: FloatArray, vector: bool) -> FloatArray:
    return np.full_like(samples, 1.0 / samples.shape[_axis(samples, vector)])


def _slope_of_rms(samples: FloatArray, vector: bool) -> FloatArray:
    axis = _axis(samples, vector)
    root = np.sqrt(np.mean(samples**2, axis=axis, keepdims=True))
    return _ratio(samples, samples.shape[axis] * root)


def _slope_of_peak(samples: FloatArray, vector: bool) -> FloatArray:
    axis = _axis(samples, vector)
    size = np.linalg.norm(samples, axis=-1) if vector else np.abs(samples)
    at = np.argmax(size, axis=axis, keepdims=True)
    direction = _ratio(samples, size[..., np.newaxis] if vector else size)
    return direction * _only(at[..., np.newaxis] if vector else at, samples.shape, axis)


def _axis(samples: FloatArray, vector: bool) -> int:
    """The axis of the samples; the last axis of vectors holds their components."""
    return samples.ndim - (2 if vector else 1)


def _only(at: NDArray[np.intp], shape: tuple[int, ...], axis: int) -> FloatArray:
    """Return 1 at one index along an axis, and 0 elsewhere."""
    along = np.arange(shape[axis]).reshape(-1, *(1,) * (len(shape) - axis - 1))
    return np.where(along == at, 1.0, 0.0)


def _ratio(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the ratio, 0 where both vanish: a magnitude has no derivative there."""
    return np.divide(x, y, out=np.zeros(np.broadcast_shapes(x.shape, y.shape)), where=y != 0.0)


REDUCTIONS: Mapping[Reduction, _Row] = MappingProxyType(
    {
        "min": _Row("minimum", lambda found, _: found.min(axis=-1), _slope_of_min),
        "max": _Row("maximum", lambda found, _: found.max(axis=-1), _slope_of_max),
        "mean": _Row("mean", lambda found, shares: (found * shares).sum(axis=-1), _slope_of_mean),
        "rms": _Row(
            "root_mean_square",
            lambda found, shares: np.sqrt((found**2 * shares).sum(axis=-1)),
            _slope_of_rms,
        ),
        "peak": _Row("maximum_absolute_value", lambda found, _: found.max(axis=-1), _slope_of_peak),
    }
)
"""Every reduction by name; ``peak`` is the largest magnitude, of a vector its largest length."""
