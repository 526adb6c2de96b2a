"""Arguments that must be positive or not negative, and those with one number per joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays.coercion import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError, wrong_element


def positive(name: str, value: ArrayLike) -> FloatArray:
    """Return an argument as an array whose elements are positive and finite.

    Raises:
        TypeError: elements that are not real numbers.
        ValueError: any other element; it says which.
    """
    array = as_float64(name, value)
    wrong = ~((array > 0.0) & (array < np.inf))
    if wrong.any():
        raise wrong_element(name, array, wrong, "; it must be positive and finite")
    return array


def not_negative(name: str, value: ArrayLike) -> FloatArray:
    """Return an argument as an array whose elements are finite and not negative.

    Raises:
        TypeError: elements that are not real numbers.
        ValueError: any other element; it says which.
    """
    array = as_float64(name, value)
    wrong = ~((array >= 0.0) & (array < np.inf))
    if wrong.any():
        raise wrong_element(name, array, wrong, "; it must be finite and not negative")
    return array


def per_joint(name: str, array: FloatArray, n: int) -> FloatArray:
    """Return one number for all joints, or one for each on the last axis, as ``(..., n)``.

    Raises:
        ValueError: another number of them.
    """
    if array.ndim and array.shape[-1] not in (1, n):
        raise ArgumentValueError(
            name, f"has shape {array.shape}; it is one number or one per joint, (..., {n})"
        )
    return np.broadcast_to(array, (*array.shape[:-1], n))
