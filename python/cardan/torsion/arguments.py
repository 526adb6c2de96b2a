"""Checks of the arguments of torsional systems."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import as_float64
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_elements

# An orbit of more orders would need more points than the native module allows.
_HIGHEST_ORDER = 256


def positive_integer(name: str, value: Any) -> int:  # noqa: ANN401 - anything
    """Return a positive integer."""
    if not hasattr(value, "__index__"):
        raise ArgumentTypeError(name, f"is {value!r}; it must be an integer")
    number = operator.index(value)
    if number < 1:
        raise ArgumentValueError(name, f"is {number}; it must be positive")
    return number


def checked_orders(orders: ArrayLike) -> NDArray[np.int64]:
    """Return orders as an array of one dimension."""
    given = np.atleast_1d(np.asarray(orders))
    if given.dtype.kind not in "iu" or given.ndim != 1:
        raise ArgumentTypeError("orders", "must be one integer or a list of integers")
    right = (given >= 1) & (given <= _HIGHEST_ORDER)
    check_elements("orders", given, right, f"; an order must be from 1 to {_HIGHEST_ORDER}")
    return given.astype(np.int64)


def checked_tolerance(tolerance: float) -> float:
    """Return the permitted error of an orbit."""
    value = float(as_float64("tolerance", tolerance))
    if not 1e-12 <= value <= 1e-3:
        raise ArgumentValueError("tolerance", f"is {value!r}; it must be from 1e-12 to 1e-3")
    return value
