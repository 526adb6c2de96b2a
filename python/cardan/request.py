"""What is asked of a driveline: outputs, of which shafts and joints, and how to evaluate them."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, Protocol, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import DTypeLike

from cardan import _core
from cardan.errors import ArgumentTypeError, ArgumentValueError, Place, located
from cardan.load import Load
from cardan.outputs import nearest

Items: TypeAlias = int | slice | Sequence[int] | None
Reduction: TypeAlias = Literal["min", "max", "mean", "rms", "peak"]
Axes: TypeAlias = Literal["space", "shaft"]
AngleOf: TypeAlias = Literal["drive", "driven"]

REDUCTIONS: tuple[Reduction, ...] = ("min", "max", "mean", "rms", "peak")
"""What rows of samples can be reduced to."""


class Plannable(Protocol):
    """What a plan needs of a driveline."""

    _lines: _core.Lines

    @property
    def n_joints(self) -> int:
        """Number of joints."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""

    @property
    def n_bearings(self) -> int:
        """Number of bearings."""


@dataclass(frozen=True, eq=False)
class Request:
    """The arguments of ``Driveline.plan`` and the driveline; names of outputs are checked."""

    line: Plannable
    names: tuple[str, ...]
    shafts: Items = None
    joints: Items = None
    load: Load | None = None
    reduce: Reduction | None = None
    dtype: DTypeLike | None = None
    tolerance: float | None = None
    workers: int | None = None
    axes: Axes = "space"
    angle_of: AngleOf = "drive"

    def arguments(self) -> tuple[Any, ...]:
        """Return the values in order."""
        return tuple(getattr(self, field.name) for field in fields(self))


def item_index(argument: str, value: SupportsIndex, count: int, place: Place = ()) -> int:
    """Return the index of a shaft or joint counted from 0; negative ones count from the end."""
    if isinstance(value, (bool, np.bool_)):
        problem = f"is {value}, which is no index; for a mask give np.flatnonzero(mask)"
        raise ArgumentTypeError(argument, problem, place)
    try:
        index = operator.index(value)
    except TypeError:
        raise ArgumentTypeError(argument, f"is {value!r}; it must be an integer", place) from None
    if not -count <= index < count:
        raise IndexError(
            f"{located(argument, place)} is {index}; there are {count}, counted from 0"
        )
    return index % count


def is_index(value: Items) -> bool:
    """Whether one item is asked for, not a list of one."""
    # NumPy's arrays have `__index__` as well, whatever their shape; its booleans have it before
    # NumPy 2.4 and are refused by name with every version.
    return isinstance(value, (int, np.bool_)) or (
        hasattr(value, "__index__") and np.ndim(value) == 0  # type: ignore[arg-type]
    )


def item_indices(argument: str, value: int | slice | Sequence[int], count: int) -> list[int]:
    """Return the indices of the shafts or joints asked for."""
    if isinstance(value, slice):
        return list(range(count))[value]
    if is_index(value):
        return [item_index(argument, value, count)]  # type: ignore[arg-type]
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise ArgumentTypeError(argument, f"is {value!r}; it must be an index, a slice or a list")
    return [item_index(argument, item, count, (i,)) for i, item in enumerate(value)]


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


def checked_choice(argument: str, value: Any, known: tuple[str, str]) -> str:  # noqa: ANN401
    """Return one of two words."""
    if not isinstance(value, str) or value not in known:
        wanted = " or ".join(map(repr, known))
        raise ArgumentValueError(argument, f"is {value!r}; it must be {wanted}")
    return value


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
