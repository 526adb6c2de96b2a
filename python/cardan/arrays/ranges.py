"""Arguments that must be positive, or at least not negative."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays.coercion import FloatArray, as_float64
from cardan.errors import wrong_element


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
