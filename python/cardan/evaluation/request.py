"""What is asked of a driveline: outputs, of which shafts and joints, and how to evaluate them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import DTypeLike

from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest
from cardan.arrays.indices import Items
from cardan.evaluation.load import Load

Reduction: TypeAlias = Literal["min", "max", "mean", "rms", "peak"]
Axes: TypeAlias = Literal["space", "shaft"]
AngleOf: TypeAlias = Literal["drive", "driven"]

REDUCTIONS: tuple[Reduction, ...] = ("min", "max", "mean", "rms", "peak")
"""What rows of samples can be reduced to."""


class Request(NamedTuple):
    """The arguments of ``Driveline.plan``."""

    names: str | Iterable[str]
    shafts: Items = None
    joints: Items = None
    load: Load | None = None
    reduce: Reduction | None = None
    dtype: DTypeLike | None = None
    tolerance: float | None = None
    workers: int | None = None
    axes: Axes = "space"
    angle_of: AngleOf = "drive"


DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)


def checked_dtype(dtype: DTypeLike) -> np.dtype[Any]:
    """Return the dtype of the results, one of two objects."""
    try:
        word = np.dtype(dtype)
    except TypeError:
        word = np.dtype(object)
    for known in (DOUBLE, SINGLE):
        if word == known:
            return known
    raise ArgumentValueError("dtype", f"is {dtype!r}; it must be float64 or float32")


def checked_reduction(reduce: str | None) -> str | None:
    """Return the reduction, which must be a known one."""
    if reduce is not None and reduce not in REDUCTIONS:
        raise ArgumentValueError("reduce", f"is {reduce!r}; {nearest(str(reduce), REDUCTIONS)}")
    return reduce


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance as a number that is not negative."""
    try:
        permitted = float(tolerance)
    except OverflowError:
        problem = "is an integer above the largest double; it must be a number that a double holds"
        raise ArgumentTypeError("tolerance", problem) from None
    except (TypeError, ValueError):
        raise ArgumentTypeError("tolerance", f"is {tolerance!r}; it must be a number") from None
    if not permitted >= 0.0:
        raise ArgumentValueError("tolerance", f"is {permitted}; it must not be negative")
    return permitted
