"""Integers as arguments: indices of shafts and joints, numbers of things, orders."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from typing import SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    Place,
    check_elements,
    check_shape,
    located,
)

Items: TypeAlias = int | slice | Sequence[int] | None
"""Shafts or joints: one index, a slice, several indices, or those of the default."""


def item_index(argument: str, value: SupportsIndex, count: int, place: Place = ()) -> int:
    """Return the index of a shaft or joint counted from 0; negative ones count from the end."""
    if isinstance(value, (bool, np.bool_)):
        problem = f"is {value}, which is no index; for a mask give np.flatnonzero(mask)"
        raise ArgumentTypeError(argument, problem, place)
    index = integer(argument, value, place=place)
    if not -count <= index < count:
        raise IndexError(
            f"{located(argument, place)} is {index}; there are {count}, counted from 0"
        )
    return index % count


def integer(
    argument: str, value: SupportsIndex, least: int | None = None, place: Place = ()
) -> int:
    """Return an integer, which must not be below the least."""
    try:
        number = operator.index(value)
    except TypeError:
        raise ArgumentTypeError(argument, f"is {value!r}; it must be an integer", place) from None
    if least is not None and number < least:
        raise ArgumentValueError(argument, f"is {number}; it must be at least {least}", place)
    return number


def checked_orders(orders: ArrayLike, highest: int | None = None) -> NDArray[np.int64]:
    """Return orders, one or a list."""
    order = np.asarray(orders)
    if order.size and order.dtype.kind not in "iu":
        raise ArgumentTypeError("orders", f"has dtype {order.dtype}; an order is an integer")
    check_shape("orders", order, order.ndim <= 1, "it must be a list")
    rule = "at least 1" if highest is None else f"an integer from 1 to {highest}"
    right = (order >= 1) & (order <= (highest or np.inf))
    check_elements("orders", order, right, f"; an order is {rule}")
    return order.astype(np.int64)


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
