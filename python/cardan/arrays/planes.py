"""Where an output lies among the planes of a result: a plane per item and component."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from numpy.typing import NDArray

PlanePlace: TypeAlias = tuple[int, int | None, bool]
"""The first plane of an output, how many items it has (``None``: one without an axis for it),
and whether it is a vector."""


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
