"""The axes of a study: which of a scene's keys it varies, their values, and the rules for these.

A schema cannot say that a spread of one step needs equal ends; only the reader checks that.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import (
    COUNT,
    SPREAD,
    ListOf,
    Number,
    Rule,
    Schema,
    Table,
    shown,
)
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.app.scene.sections.load import LOAD
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest

MOST_ROWS = 10_000_000
"""Rows that a study takes at most."""


class Spread(NamedTuple):
    """Evenly spaced values of a study, both ends included."""

    start: float
    stop: float
    steps: int


Varied: TypeAlias = Mapping[str, Mapping[str, Spread | list[float]]]
"""Values by key and place, as a section has them."""

_SPREAD = Table(
    {"from": Number(), "to": Number(), "steps": COUNT}, f"{SPREAD} or a list of numbers"
)
_LISTED = ListOf(Number(), "numbers")


@dataclass(frozen=True)
class AxisValues(Rule):
    """What varies a number: values under no place, listed or evenly spread."""

    name = "values"

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by their place, which is empty."""
        return {"": _values(where, value)}

    @property
    def schema(self) -> Schema:
        """A reference to the definition."""
        return {"$ref": "#/$defs/values"}


DEFINITION = {
    "description": "what a study gives a key: a list, or values evenly spread",
    "oneOf": [{**_LISTED.schema, "minItems": 1}, _SPREAD.schema],
}
"""JSON Schema of the values of an axis, for the schema to define once."""


def _values(where: Location, value: object) -> Spread | list[float]:
    if isinstance(value, list):
        if not value:
            raise where.error("is []; a study needs at least one value")
        return _LISTED.read(where, value)
    given = _SPREAD.read(where, value)
    spread = Spread(given["from"], given["to"], given["steps"])
    if spread.steps == 1 and spread.start != spread.stop:
        ends = f"from {spread.start:g} to {spread.stop:g}"
        raise where.at("steps").error(f"is 1; {ends} takes at least 2")
    return spread


def _tables(pattern: str, entry: Schema) -> Schema:
    return {
        "type": "object",
        "patternProperties": {pattern: entry},
        "additionalProperties": False,
        "minProperties": 1,
    }


ENTRIES = "[0-9]{1,9}(-[0-9]{1,9})?"
"""Pattern of an entry, or some, of a list."""
_NO_ENTRY = "does not exist; write 0 for the first entry, 0-1 for two"


@dataclass(frozen=True)
class ListAxes(AxisValues):
    """What varies a list of numbers: values for all entries, or for some by their place."""

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by place: ``""``, ``"1"`` or ``"0-1"``."""
        if not _is_table(value) or value.keys() & _SPREAD.keys.keys():
            return super().read(where, value)
        for index in value:
            if not re.fullmatch(ENTRIES, index):
                raise where.at(index).error(_NO_ENTRY)
        return {index: _values(where.at(index), entry) for index, entry in value.items()}

    @property
    def schema(self) -> Schema:
        """The values, or an object of them."""
        values = AxisValues().schema
        return {"anyOf": [values, _tables(f"^{ENTRIES}$", values)]}


@dataclass(frozen=True)
class NestedAxes(Rule):
    """What varies a part of an entry, as a component of a vector: values by entry and part.

    ``what`` is entry and part in words with an example; ``no_entry`` says what names no entry.
    """

    what: tuple[str, str]
    entry: str
    no_entry: str
    parts: tuple[str, ...]
    name = "values"

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by entry and part: ``{"2": {"y": …}}`` as ``{"2.y": …}``."""
        if not _is_table(value) or not all(map(_is_table, value.values())):
            words, example = self.what
            raise where.error(f"is {shown(value)}; name {words}, as in {where}.{example}")
        axes = {}
        for index, parts in value.items():
            at = where.at(index)
            if not re.fullmatch(self.entry, index):
                raise at.error(self.no_entry)
            for part, entry in parts.items():
                if part not in self.parts:
                    raise at.error(f"has no {shown(part)}; {nearest(part, self.parts)}")
                axes[f"{index}.{part}"] = _values(at.at(part), entry)
        return axes

    @property
    def schema(self) -> Schema:
        """An object of objects."""
        parts = {
            "type": "object",
            "properties": dict.fromkeys(self.parts, AxisValues().schema),
            "additionalProperties": False,
            "minProperties": 1,
        }
        return _tables(f"^{self.entry}$", parts)


def _is_table(value: object) -> TypeGuard[dict[str, Any]]:
    return isinstance(value, dict) and bool(value)


NUMBER_AXIS = AxisValues()
LIST_AXES = ListAxes()
VECTOR_AXES = NestedAxes(("place and axis", "2.y"), ENTRIES, _NO_ENTRY, ("x", "y", "z"))
BEARING_AXES = NestedAxes(
    ("number and key", "0.position_mm"),
    "[0-9]{1,9}",
    "does not exist; write 0 for the first bearing",
    ("position_mm", "position_m"),
)


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
    given: Varied,
    driveline: Mapping[str, Any],
    load: Mapping[str, Any] | None,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the axes of the grid that the section [study] describes; it has not too many rows."""
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
    given: Varied,
    driveline: Mapping[str, Any],
    load: Mapping[str, Any] | None,
    varying: str,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the keys that vary, given by key and place; ``varying`` says in words what does it."""
    axes = []
    for name, places in given.items():
        if name == "bearing":
            axes += [_of_bearing(place, values, bearings) for place, values in places.items()]
            continue
        section = "driveline" if name in DRIVELINE.keys else "load"
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
            number = "xyz".index(component) if component else None
            axes.append(Axis(str(location), section, name, entries, number, _listed(values)))
    return tuple(axes)


def _of_bearing(
    place: str, values: Spread | list[float], bearings: Sequence[Mapping[str, Any]]
) -> Axis:
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
        for pair in LOAD.together:
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
