"""Arrays as arguments: what is accepted as an array of doubles, and in which words it is refused.

All functions raise a ``TypeError`` for what are no real numbers, and a ``ValueError`` for numbers
that break their rule.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_elements, check_shape
from cardan.arrays.libraries import adapter as adapter
from cardan.arrays.libraries import array_namespace_of as array_namespace_of
from cardan.arrays.libraries import deferring as deferring
from cardan.arrays.libraries import import_optional as import_optional

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]


def as_float64(name: str, value: ArrayLike) -> FloatArray:
    """Return the argument as a contiguous array of doubles, without a copy where it is one.

    Arrays of another library are refused, and those that carry what would be lost, as a mask.
    """
    if type(value) is not np.ndarray:
        _refuse_more_than_numbers(name, value)
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ArgumentValueError(name, f"is no array of numbers: {error}") from None
    if array.dtype.kind == "O" and any(_is_too_large(item) for item in array.flat):
        largest = np.finfo(np.float64).max
        problem = f"has an integer of magnitude above {largest:.4g}, the largest double"
        raise ArgumentTypeError(name, problem)
    if array.dtype.kind not in "fiub":
        raise ArgumentTypeError(name, f"has dtype {array.dtype}; it must hold real numbers")
    if array.size > sys.maxsize // 8:
        raise MemoryError(f"{name} has shape {array.shape}; there is no room for so many numbers")
    array = np.asarray(array, dtype=np.float64, order="C")
    return array if array.flags.aligned else array.copy()


def finite(name: str, value: ArrayLike) -> FloatArray:
    """Return an argument as an array whose elements are finite."""
    array = as_float64(name, value)
    check_elements(name, array, np.isfinite(array), "; it must be finite")
    return array


def one_number(name: str, value: ArrayLike) -> float:
    """Return an argument that is one finite number."""
    array = finite(name, value)
    check_shape(name, array, array.ndim == 0, "it must be one number")
    return float(array)


def positive(name: str, value: ArrayLike) -> FloatArray:
    """Return an argument as an array whose elements are positive and finite."""
    array = as_float64(name, value)
    right = (array > 0.0) & (array < np.inf)
    check_elements(name, array, right, "; it must be positive and finite")
    return array


def not_negative(name: str, value: ArrayLike) -> FloatArray:
    """Return an argument as an array whose elements are finite and not negative."""
    array = as_float64(name, value)
    right = (array >= 0.0) & (array < np.inf)
    check_elements(name, array, right, "; it must be finite and not negative")
    return array


def shares_of(weights: ArrayLike | None, states: int) -> FloatArray:
    """Return the weights of states with sum 1, by default all alike."""
    if weights is None:
        return np.full(states, 1.0 / states)
    array = not_negative("weights", weights)
    rule = f"it must be ({states},), one per state"
    check_shape("weights", array, array.shape == (states,), rule)
    if not np.any(array):
        raise ArgumentValueError("weights", "are all 0; at least one must be positive")
    return np.asarray(array / np.sum(array))


def per_joint(name: str, array: FloatArray, n: int) -> FloatArray:
    """Return one number for all joints, or one for each on the last axis, as ``(..., n)``."""
    rule = f"it is one number or one per joint, (..., {n})"
    check_shape(name, array, not array.ndim or array.shape[-1] in (1, n), rule)
    return np.broadcast_to(array, (*array.shape[:-1], n))


def per_shaft(name: str, array: FloatArray, shafts: int) -> FloatArray:
    """Return the array, which must have one number for each shaft on the last axis."""
    right = array.shape[-1:] == (shafts,)
    check_shape(name, array, right, f"{shafts} shafts need (..., {shafts})")
    return array


def _refuse_more_than_numbers(name: str, value: ArrayLike) -> None:
    kind = type(value)
    if not hasattr(kind, "__array_function__"):
        return
    if np.ma.is_masked(value):
        raise ArgumentTypeError(name, "has masked entries; fill them or leave them out")
    full = f"{kind.__module__.partition('.')[0]}.{kind.__name__}"
    unit = getattr(value, "unit", getattr(value, "units", None))
    if unit is not None:
        problem = f"is a {full} in {unit}; give plain numbers in the unit asked for"
        raise ArgumentTypeError(name, problem)
    if not isinstance(value, np.ndarray):
        raise ArgumentTypeError(name, f"is a {full}; make it an array of NumPy first")


def _is_too_large(value: object) -> bool:
    if not isinstance(value, int):
        return False
    try:
        float(value)
    except OverflowError:
        return True
    return False


def scalar_or_array(array: FloatArray) -> Any:  # noqa: ANN401 - as NumPy's own functions
    """Return a 0-d array as a NumPy scalar, anything else unchanged."""
    return array[()]


def common_shape(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape to which the named shapes broadcast."""
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"shapes do not broadcast: {listed}") from None


def together(
    arrays: Mapping[str, tuple[FloatArray, int]], **others: tuple[int, ...]
) -> tuple[tuple[int, ...], list[FloatArray]]:
    """Broadcast arrays, of each of which so many last axes belong to one element of a batch.

    Returned are the shape of the batch, to which other shapes broadcast as well, and the arrays.
    """
    batches = {name: array.shape[: array.ndim - own] for name, (array, own) in arrays.items()}
    shape = common_shape(**others, **batches)
    full = []
    for array, own in arrays.values():
        wanted = (*shape, *array.shape[array.ndim - own :])
        full.append(array if array.shape == wanted else np.broadcast_to(array, wanted))
    return shape, full


def numbered(
    batch: tuple[int, ...], of: str = "driveline", **arrays: FloatArray
) -> tuple[tuple[int, ...], NDArray[np.int64], list[FloatArray]]:
    """Return the common shape of a batch and arrays, and flat the numbers of its items and arrays.

    Errors call the batch what it is ``of``.
    """
    shape = common_shape(**{of: batch}, **{name: array.shape for name, array in arrays.items()})
    numbers = np.arange(math.prod(batch)).reshape(batch)
    first, *flat = (np.broadcast_to(x, shape).ravel() for x in (numbers, *arrays.values()))
    return shape, first, flat


def keep(owner: object, **values: Any) -> None:  # noqa: ANN401 - of attributes
    """Keep values in an object that is frozen, with read-only copies of arrays.

    The caller may change the arrays that it gave.
    """
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            value = value.copy()
            value.flags.writeable = False
        object.__setattr__(owner, name, value)
