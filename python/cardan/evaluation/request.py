"""What is asked of a driveline, and where the outputs lie among the planes of the result.

A plane has one number for each sample. There is one for each item and component.
"""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import DTypeLike, NDArray

from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest
from cardan.arrays.indices import Items, is_index, item_indices
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, checked
from cardan.evaluation.reductions import REDUCTIONS, Reduction

Axes: TypeAlias = Literal["space", "shaft"]
AngleOf: TypeAlias = Literal["drive", "driven"]


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


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance as a number that is not negative."""
    try:
        # Of a text, float would make a number as well.
        permitted = float(operator.pos(tolerance))
    except OverflowError:
        problem = "is an integer above the largest double; it must be a number that a double holds"
        raise ArgumentTypeError("tolerance", problem) from None
    except (TypeError, ValueError):
        raise ArgumentTypeError("tolerance", f"is {tolerance!r}; it must be a number") from None
    if not permitted >= 0.0:
        raise ArgumentValueError("tolerance", f"is {permitted}; it must not be negative")
    return permitted


# Lists of the joints of longer drivelines would take too much memory to be remembered.
_LONGEST = 64


class PlanePlace(NamedTuple):
    """Where an output lies among the planes of a result."""

    first: int  # its first plane
    items: int | None  # how many it has; ``None`` for one without an axis for it
    vector: bool

    @property
    def planes(self) -> int:
        """How many planes it has."""
        return (1 if self.items is None else self.items) * (3 if self.vector else 1)

    def shape(self, samples: tuple[int, ...]) -> tuple[int, ...]:
        """Return the shape of the output for samples of this shape."""
        lead = () if self.items is None else (self.items,)
        return lead + samples + ((3,) if self.vector else ())


@dataclass(frozen=True, slots=True)
class Layout:
    """What a plan knows of its result before it knows the driveline."""

    names: tuple[str, ...]
    shafts: list[int]  # of the outputs per shaft
    joints: list[int]  # of the outputs per joint
    shown: tuple[int | list[int], int | list[int]]  # the same as asked for, an index or a list
    places: Mapping[str, PlanePlace]
    planes: int  # their number
    shapes: list[tuple[int | None, bool]]  # items of each output, and whether it is a vector


def layout_of(
    names: str | Iterable[str],
    n: int,
    shafts: Items,
    joints: Items,
    reduce: Reduction | None,
    bearings: int,
) -> Layout:
    """Return the layout of outputs of a driveline with ``n`` joints, as ``Plan`` reads them."""
    key = (names if isinstance(names, str) else tuple(names), n, shafts, joints, reduce, bearings)
    # Of plain arguments only those are equal that mean the same; 1.0 is no index.
    one_shaft = shafts is None or type(shafts) is int
    if n <= _LONGEST and one_shaft and (joints is None or type(joints) is int):
        try:
            return _remembered(*key)  # type: ignore[arg-type]
        except TypeError:
            pass  # What is wrong is said below: here it may be that a name has no hash.
    return _layout(*key)


def _layout(
    names: str | tuple[str, ...],
    n: int,
    shafts: Items,
    joints: Items,
    reduce: Reduction | None,
    bearings: int,
) -> Layout:
    listed = tuple(map(str, checked(names)))
    # The last shaft is asked for, not a list of one.
    one_shaft = shafts is None or is_index(shafts)
    one_joint = joints is not None and is_index(joints)
    shaft_items = [n] if shafts is None else item_indices("shafts", shafts, n + 1)
    joint_items = [*range(n)] if joints is None else item_indices("joints", joints, n)
    if reduce is not None and reduce not in REDUCTIONS:
        raise ArgumentValueError("reduce", f"is {reduce!r}; {nearest(str(reduce), REDUCTIONS)}")
    places: dict[str, PlanePlace] = {}
    first = 0
    for name in listed:
        output = OUTPUTS[name]
        vector = output.vector and reduce != "peak"
        if output.per == "bearing":
            count, one = bearings, False
        elif output.per == "shaft":
            count, one = len(shaft_items), one_shaft
        else:
            count, one = len(joint_items), one_joint
        places[name] = PlanePlace(first, None if one else count, vector)
        first += places[name].planes
    shown = (
        shaft_items[0] if one_shaft else shaft_items,
        joint_items[0] if one_joint else joint_items,
    )
    shapes = [(items, vector) for _, items, vector in places.values()]
    return Layout(listed, shaft_items, joint_items, shown, places, first, shapes)


_remembered = functools.lru_cache(maxsize=256)(_layout)


def view(planes: NDArray[Any], place: PlanePlace) -> Any:  # noqa: ANN401 - an array or a scalar
    """Return an output as a view of the planes of a result, a vector's components last."""
    first, items, vector = place
    if items is None and not vector:
        return planes[first]
    if items is None:
        return _moved(planes[first : first + 3], 0, -1)
    if not vector:
        return planes[first : first + items]
    part = planes[first : first + 3 * items]
    return _moved(part.reshape(items, 3, *planes.shape[1:]), 1, -1)


def planes_of(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Return the planes of an array whose last ``axes`` are the samples, of which none may be left.

    NumPy cannot infer the number of planes from planes without elements.
    """
    before = array.ndim - axes
    return array.reshape(math.prod(array.shape[:before]), *array.shape[before:])


def components_first(array: NDArray[Any], place: PlanePlace) -> NDArray[Any]:
    """Return an output plane by plane: a vector's components before the samples."""
    return _moved(array, -1, 0 if place[1] is None else 1) if place[2] else array


def _moved(array: NDArray[Any], source: int, to: int) -> NDArray[Any]:
    """As ``numpy.moveaxis``, which takes ten times as long."""
    axes = [*range(array.ndim)]
    axis = axes.pop(source)
    axes.insert(to % array.ndim, axis)
    return array.transpose(axes)
