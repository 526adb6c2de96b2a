"""The axes of a study: which of a scene's keys it varies, and their values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import shown
from cardan.app.scene.sections.table import FORMAT
from cardan.app.scene.study.axis_rules import Spread
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError

MOST_ROWS = 10_000_000
"""Rows that a study takes at most."""


@dataclass(frozen=True, eq=False)
class Axis:
    """One key of a scene and the values that it takes in a study.

    Attributes:
        key: as the file says it: ``bends_deg.0``, ``points_mm.2-3.y``, ``speed_rpm``.
        section: where the key belongs.
        name: the key without place and component.
        place: which entries of a list it varies; ``None`` where the value is one number.
        component: which component of a vector.
        values: the values, ``(steps,)``, in the key's own unit.
    """

    key: str
    section: str
    name: str
    place: slice | None
    component: int | None
    values: FloatArray

    @property
    def location(self) -> Location:
        """Where the file gives the values, for errors."""
        return _location(*self.key.partition(".")[::2])


def grid_of(
    given: Mapping[str, Mapping[str, Spread | list[float]]],
    driveline: Mapping[str, Any],
    load: Mapping[str, Any] | None,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the axes of the grid that the section [study] describes.

    Args:
        given: values by key and place.
        driveline: the keys of the scene's driveline.
        load: those of its load, if any.
        bearings: the keys of each of its bearings.

    Raises:
        ValueError: as for ``axes_of``; more rows than a study takes.
    """
    sizes = {
        _location(name, place): values.steps if isinstance(values, Spread) else len(values)
        for name, places in given.items()
        for place, values in places.items()
    }
    rows = math.prod(sizes.values())
    if rows > MOST_ROWS:
        product = " x ".join(map(shown, sizes.values()))
        count = f"{product} = {shown(rows)}" if len(sizes) > 1 else shown(rows)
        largest = max(sizes, key=lambda key: sizes[key])
        raise largest.error(
            f"makes the study {count} rows; it takes at most {MOST_ROWS}: "
            "give fewer steps or vary fewer keys"
        )
    return axes_of(given, driveline, load, "a study", bearings)


def axes_of(
    given: Mapping[str, Mapping[str, Spread | list[float]]],
    driveline: Mapping[str, Any],
    load: Mapping[str, Any] | None,
    varying: str,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the keys that vary, each with its values.

    Args:
        given: values by key and place.
        driveline: the keys of the scene's driveline.
        load: those of its load, if any.
        varying: what varies them, in words.
        bearings: the keys of each bearing, where their positions may vary.

    Raises:
        ValueError: a key that the scene does not use, a place that does not exist or is varied
            twice.
    """
    axes = []
    for name, places in given.items():
        if name == "bearing":
            axes += [_of_bearing(place, values, bearings) for place, values in places.items()]
            continue
        section = "driveline" if name in FORMAT["driveline"].keys else "load"
        base = _base(name, driveline if section == "driveline" else load, section, varying)
        taken: set[tuple[int, str]] = set()
        for place, values in places.items():
            index, _, component = place.partition(".")
            location = _location(name, place)
            entries = _entries(location, index, base)
            for entry in range(*entries.indices(len(base))) if base and entries else ():
                if (entry, component) in taken:
                    raise location.error(f"varies {name}[{entry}], which varies already")
                taken.add((entry, component))
            axes.append(
                Axis(
                    str(location),
                    section,
                    name,
                    entries,
                    "xyz".index(component) if component else None,
                    _listed(values),
                )
            )
    return tuple(axes)


def _of_bearing(
    place: str, values: Spread | list[float], bearings: Sequence[Mapping[str, Any]]
) -> Axis:
    """The axis of the position of a bearing."""
    index, _, key = place.partition(".")
    location, number = _location("bearing", place), int(index)
    if number >= len(bearings):
        raise location.error(f"does not exist; there are {len(bearings)} bearings, counted from 0")
    if key not in bearings[number]:
        used = next(name for name in bearings[number] if name.startswith("position"))
        raise location.error(f"does not go with {used} of that bearing; vary that")
    entries = slice(number, number + 1)
    return Axis(str(location), "bearing", key, entries, None, _listed(values))


def _location(name: str, place: str) -> Location:
    return Location(name, tuple(place.split(".")) if place else ())


def _base(
    name: str, values: Mapping[str, Any] | None, section: str, varying: str
) -> Sequence[Any] | None:
    """The entries that the scene gives a key; ``None`` for one number, which it may leave out."""
    if values is None:
        raise ArgumentValueError(name, f"needs a section [{section}]")
    if name in values:
        entries: Sequence[Any] | None = values[name] if isinstance(values[name], list) else None
        if entries == []:
            raise ArgumentValueError(
                name, "has no entries; one joint has no shaft between two joints"
            )
        return entries
    if section == "load" and name != "inertias_kgm2":
        for pair in FORMAT["load"].together:
            for key in pair:
                if name in pair and key in values:
                    raise ArgumentValueError(name, f"does not go with {key} of [load]; vary that")
        return None
    there = ", ".join(values)
    raise ArgumentValueError(name, f"is not in [{section}]; {varying} can vary {there}")


def _entries(key: Location, index: str, base: Sequence[Any] | None) -> slice | None:
    if base is None:
        return None
    if not index:
        return slice(None)
    ends = [int(end) for end in index.split("-")]
    first, last = ends[0], ends[-1]
    if not first <= last < len(base):
        raise key.error(f"does not exist; there are {len(base)}, counted from 0")
    return slice(first, last + 1)


def _listed(values: Spread | list[float]) -> FloatArray:
    if isinstance(values, list):
        return np.array(values, dtype=np.float64)
    start, stop, steps = values
    # Dividing last keeps round values round.
    spread: FloatArray = start + (stop - start) * np.arange(steps) / max(steps - 1, 1)
    return spread


def values_at(axes: Sequence[Axis], rows: Any) -> list[FloatArray]:  # noqa: ANN401 - integers
    """The values of every axis at some rows of the grid."""
    places = np.unravel_index(rows, [len(axis.values) for axis in axes]) if axes else ()
    return [axis.values[place] for axis, place in zip(axes, places, strict=True)]


def put(values: dict[str, Any], axis: Axis, column: FloatArray) -> None:
    """Give a key the values of an axis, one per row."""
    rows = column.reshape(-1, 1)
    if axis.place is None:
        values[axis.name] = rows
        return
    array = np.asarray(values[axis.name], dtype=np.float64)
    core = 1 if axis.component is None else 2
    if array.ndim == core:
        array = per_row(array, len(rows))
        values[axis.name] = array
    if axis.component is None:
        array[..., axis.place] = rows[..., None]
    else:
        array[..., axis.place, axis.component] = rows[..., None]


def per_row(value: ArrayLike, rows: int) -> FloatArray:
    """A copy of a list of the file for each row, with an axis for the drive angles."""
    array = np.asarray(value, dtype=np.float64)
    return np.array(np.broadcast_to(array, (rows, 1, *array.shape)))
