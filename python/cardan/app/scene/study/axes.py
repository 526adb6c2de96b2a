"""The axes of a study: which of a scene's keys it varies, their values, and the rules for these.

An axis gives a key values, or changes what the key has: it adds to entries, or turns points. Values
come first, then what is added, then turns. A schema cannot say that a spread of one step needs
equal ends; only the reader checks that.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.scene.language import errors, rules, units
from cardan.app.scene.sections.bearing import POSITIONS
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.app.scene.sections.load import LOAD
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.geometry.wound_up import turned

MOST_ROWS = 10_000_000
"""Rows that a study takes at most."""


class Spread(NamedTuple):
    """Evenly spaced values of a study, both ends included."""

    start: float
    stop: float
    steps: int


_ADD, _TURN, _AXIS = "add", "turn_deg", "axis"


class Varying(NamedTuple):
    """Values that a study sets, adds, or turns points by, as ``way`` says.

    Points turn about a point of the file's unit and an axis through it.
    """

    steps: Spread | list[float]
    way: Literal["", "add", "turn_deg"] = ""
    about: Sequence[float] = ()
    axis: Sequence[float] = ()
    unit: str = ""

    @property
    def size(self) -> int:
        """How many values there are, of which no memory is taken."""
        return self.steps.steps if isinstance(self.steps, Spread) else len(self.steps)

    @property
    def values(self) -> FloatArray:
        """The values, ``(size,)``."""
        if not isinstance(self.steps, Spread):
            return np.array(self.steps, dtype=np.float64)
        start, stop, steps = self.steps
        # Dividing last keeps round values round.
        spread: FloatArray = start + (stop - start) * np.arange(steps) / max(steps - 1, 1)
        return spread


Varied: TypeAlias = Mapping[str, Mapping[str, Varying]]
"""Variations of a section by key and place."""

_SPREAD = rules.Table(
    {"from": rules.Number(), "to": rules.Number(), "steps": rules.COUNT},
    f"{rules.SPREAD} or a list of numbers",
)
_LISTED = rules.ListOf(rules.Number(), "numbers")
_ABOUT = tuple(key for si in ("about_mm", "about_m") for key in (si, *units.us_keys(si)))
_OF_TURN = (_TURN, *_ABOUT, _AXIS)
_AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}


@dataclass(frozen=True)
class Direction(rules.Rule):
    """The direction of an axis: its name or a vector of any length."""

    name = "axis"

    def read(self, where: errors.Location, value: object) -> list[float]:
        if isinstance(value, str):
            if value not in _AXES:
                raise where.error(f'is {rules.shown(value)}; it is "x", "y", "z" or three numbers')
            return _AXES[value]
        axis = rules.VECTOR.read(where, value)
        if not any(axis):
            raise where.error("is [0, 0, 0]; an axis needs a direction")
        return axis

    @property
    def schema(self) -> rules.Schema:
        return {"oneOf": [{"enum": list(_AXES)}, rules.VECTOR.schema]}


DIRECTION = Direction()


@dataclass(frozen=True)
class AxisValues(rules.Rule):
    """Variation of a number: values under no place, listed or evenly spread."""

    name = "values"
    keeps_unit = True

    def read(self, where: errors.Location, value: object) -> dict[str, Varying]:
        """Return the values by their place, which is empty."""
        return {"": Varying(_steps(where, value))}

    @property
    def schema(self) -> rules.Schema:
        return _VALUES


_VALUES, _CHANGED = ({"$ref": f"#/$defs/{name}"} for name in ("values", "changed"))

DEFINITIONS = {
    "values": {
        "description": "what a study gives a key: a list, or values evenly spread",
        "oneOf": [{**_LISTED.schema, "minItems": 1}, _SPREAD.schema],
    },
    "changed": {
        "description": "values, or what is added to those of the drawing",
        "oneOf": [
            _VALUES,
            {
                "type": "object",
                "properties": {_ADD: _VALUES},
                "required": [_ADD],
                "additionalProperties": False,
            },
        ],
    },
}
"""JSON Schemas of the values of an axis, for the schema to define once."""


def _changed(where: errors.Location, value: object) -> Varying:
    """Values, or with ``add`` changes."""
    if not isinstance(value, dict) or _ADD not in value:
        return Varying(_steps(where, value))
    for key in value:
        if key != _ADD:
            raise where.error(f"has an unknown key {rules.shown(key)}; {_ADD} stands alone")
    return Varying(_steps(where.at(_ADD), value[_ADD]), "add")


def _turned(where: errors.Location, value: Mapping[str, object]) -> Varying:
    """Return the rotation of points about a point and an axis."""
    about = [key for key in _ABOUT if key in value]
    if len(about) != 1 or _AXIS not in value or _TURN not in value:
        points = " or ".join(units.alike(where.key, _ABOUT))
        raise where.error(f"must have {_TURN}, {points}, and {_AXIS}")
    axis = DIRECTION.read(where.at(_AXIS), value[_AXIS])
    steps = _steps(where.at(_TURN), value[_TURN])
    point = rules.VECTOR.read(where.at(about[0]), value[about[0]])
    return Varying(steps, "turn_deg", point, axis, about[0].rpartition("_")[2])


def _steps(where: errors.Location, value: object) -> Spread | list[float]:
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


ENTRIES = "[0-9]{1,9}(-[0-9]{1,9})?"
"""Pattern of an entry, or some, of a list."""
_NO_ENTRY = "does not exist; write 0 for the first entry, 0-1 for two"


@dataclass(frozen=True)
class ListAxes(AxisValues):
    """Variation of a list of numbers: values for all entries, or for some by their place."""

    def read(self, where: errors.Location, value: object) -> dict[str, Varying]:
        """Return the values by place: ``""``, ``"1"`` or ``"0-1"``."""
        if not _is_table(value) or value.keys() & {*_SPREAD.keys, _ADD}:
            return {"": _changed(where, value)}
        for index in value:
            if not re.fullmatch(ENTRIES, index):
                raise where.at(index).error(_NO_ENTRY)
        return {index: _changed(where.at(index), entry) for index, entry in value.items()}

    @property
    def schema(self) -> rules.Schema:
        return {"anyOf": [_CHANGED, rules.tables(f"^{ENTRIES}$", _CHANGED)]}


@dataclass(frozen=True)
class NestedAxes(rules.Rule):
    """Variation of a part of an entry, as a component of a vector: values by entry and part.

    ``what`` is entry and part in words with an example; ``no_entry`` says what names no entry.
    Parts that change can be added to, and all of them be turned together.
    """

    what: tuple[str, str]
    entry: str
    no_entry: str
    parts: tuple[str, ...]
    changes: bool = False
    name = "values"
    keeps_unit = True

    def read(self, where: errors.Location, value: object) -> dict[str, Varying]:
        """Return the values by entry and part: ``{"2": {"y": …}}`` as ``{"2.y": …}``."""
        if not _is_table(value) or not all(map(_is_table, value.values())):
            words, example = self.what
            raise where.error(f"is {rules.shown(value)}; name {words}, as in {where}.{example}")
        axes: dict[str, Varying] = {}
        for index, parts in value.items():
            at = where.at(index)
            if not re.fullmatch(self.entry, index):
                raise at.error(self.no_entry)
            turn = {key: parts[key] for key in _OF_TURN if self.changes and key in parts}
            known = (*self.parts, *(_OF_TURN if self.changes else ()))
            for part, entry in parts.items():
                if part not in known:
                    raise at.error(
                        f"has no {rules.shown(part)}; {nearest(part, units.alike(part, known))}"
                    )
                if part not in turn:
                    own = at.at(part)
                    axes[f"{index}.{part}"] = (
                        _changed(own, entry) if self.changes else Varying(_steps(own, entry))
                    )
            if turn:
                axes[index] = _turned(at, turn)
        return axes

    @property
    def schema(self) -> rules.Schema:
        values = dict.fromkeys(self.parts, _CHANGED if self.changes else _VALUES)
        parts: dict[str, Any] = {"type": "object", "additionalProperties": False}
        alone = {**parts, "properties": values, "minProperties": 1}
        if not self.changes:
            return rules.tables(f"^{self.entry}$", alone)
        turns = [
            {
                **parts,
                "properties": {
                    **values,
                    _TURN: _VALUES,
                    about: rules.VECTOR.schema,
                    _AXIS: DIRECTION.schema,
                },
                "required": [_TURN, about, _AXIS],
            }
            for about in _ABOUT
        ]
        return rules.tables(f"^{self.entry}$", {"oneOf": [alone, *turns]})


def _is_table(value: object) -> TypeGuard[dict[str, Any]]:
    return isinstance(value, dict) and bool(value)


@dataclass(frozen=True)
class Entry(rules.Rule):
    """Entries of a list: ``"2"`` or ``"2-3"``, or the number of one."""

    name = "text"

    def read(self, where: errors.Location, value: object) -> str:
        """Return it as text."""
        index = str(value) if isinstance(value, int) and not isinstance(value, bool) else value
        if not isinstance(index, str) or not re.search(f"^{ENTRIES}$", index):
            raise where.error(f'is {rules.shown(value)}; it must be as 2 or "2-3", counted from 0')
        return index

    @property
    def schema(self) -> rules.Schema:
        return {"anyOf": [rules.INDEX.schema, {"type": "string", "pattern": f"^{ENTRIES}$"}]}


ENTRY = Entry()
NUMBER_AXIS = AxisValues()
LIST_AXES = ListAxes()
VECTOR_AXES = NestedAxes(("place and axis", "2.y"), ENTRIES, _NO_ENTRY, ("x", "y", "z"), True)
BEARING_AXES = NestedAxes(
    ("number and key", "0.position_mm"),
    "[0-9]{1,9}",
    "does not exist; write 0 for the first bearing",
    tuple(key for si in POSITIONS for key in (si, *units.us_keys(si))),
)


class Rotation(NamedTuple):
    """A turn about a point of the file and a direction of length 1."""

    about: FloatArray
    axis: FloatArray


@dataclass(frozen=True, eq=False)
class Axis:
    """One key of a scene and the values that it takes in a study.

    Attributes:
        key: as the file says it: ``bends_deg.0``, ``points_mm.2-3.y``, ``points_mm.2.y.add``,
            ``points_mm.2.turn_deg``, ``speed_rpm``.
        section: where the key belongs.
        name: the key without place and component, in the SI unit.
        place: which entries of a list it varies; ``None`` where the value is one number.
        component: which component of a vector.
        values: the values, ``(steps,)``, in the key's own unit; how much is added; or the angles in
            degrees by which points turn.
        is_added: whether the values are added to those of the drawing.
        rotation: about what points turn.
        size: the key's own unit in that of the name.
    """

    key: str
    section: str
    name: str
    place: slice | None
    component: int | None
    values: FloatArray
    is_added: bool = False
    rotation: Rotation | None = None
    size: float = 1.0

    @property
    def location(self) -> errors.Location:
        """Place of the values in the file, for errors."""
        return errors.Location.of(self.key)

    @property
    def where(self) -> tuple[Any, ...]:
        """The index of its entries in an array of the key."""
        place = slice(None) if self.place is None else self.place
        if self.rotation:
            return (..., place, slice(None))
        return (..., place) if self.component is None else (..., place, self.component)

    @property
    def turn(self) -> int:
        """Its turn among the axes of a key: values, what is added, rotations."""
        return 2 if self.rotation else int(self.is_added)

    def change(self, entries: FloatArray, column: FloatArray) -> None:
        """Give entries ``(rows, ..., n[, 3])`` these values of the axis, one per row, in place."""
        own = entries[self.where]
        rows = (self.size * column).reshape(-1, *[1] * (own.ndim - 1))
        if self.rotation:
            rows = turned(own, *self.rotation, np.radians(rows))
        elif self.is_added:
            rows = own + rows
        entries[self.where] = rows

    def entries(self, count: int) -> set[tuple[int, int | None]]:
        """Return which entries of a list of so many it varies, and which of their components."""
        places = range(*(self.place or slice(None)).indices(count))
        return {(place, self.component) for place in places}


def grid_of(
    given: Varied,
    driveline: Mapping[str, Any],
    load: Mapping[str, Any] | None,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the axes of the grid that the section [study] describes; it has not too many rows."""
    sizes = {
        _location(name, place): varying.size
        for name, places in given.items()
        for place, varying in places.items()
    }
    rows = math.prod(sizes.values())
    if rows > MOST_ROWS:
        product = " x ".join(map(rules.shown, sizes.values()))
        count = f"{product} = {rules.shown(rows)}" if len(sizes) > 1 else rules.shown(rows)
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
    of: str,
    bearings: Sequence[Mapping[str, Any]] = (),
) -> tuple[Axis, ...]:
    """Return the keys that vary, given by key and place; ``of`` says in words what varies them."""
    axes = []
    for name, place, varying in (
        (n, p, v) for n, places in given.items() for p, v in places.items()
    ):
        where = _location(name, place)
        if name == "bearing":
            axes.append(_of_bearing(where, varying, bearings))
            continue
        section = "driveline" if name in DRIVELINE.keys else "load"
        base = _base(name, driveline if section == "driveline" else load, section, of)
        index, _, component = place.partition(".")
        entries = None if base is None else slice(None)
        if base is not None and index:
            entries = entries_of(where, index, len(base))
        rotation = _rotation(where, varying) if varying.way == _TURN else None
        axes.append(
            Axis(
                f"{where}.{varying.way}".rstrip("."),
                section,
                units.si_key(name),
                entries,
                "xyz".index(component) if component else None,
                varying.values,
                varying.way == _ADD,
                rotation,
                1.0 if rotation else units.size_of(name),
            )
        )
    check_apart(axes, {**driveline, **(load or {})})
    return tuple(axes)


def check_apart(axes: Sequence[Axis], values: Mapping[str, Any]) -> None:
    """Refuse axes that vary the same entries of lists in the same way."""
    taken: set[tuple[Any, ...]] = set()
    for axis in axes:
        if axis.place is None or axis.section == "bearing":
            continue
        for entry, component in sorted(axis.entries(len(values[axis.name]))):
            if (own := (axis.name, axis.turn, entry, component)) in taken:
                raise axis.location.error(f"varies {axis.name}[{entry}], which varies already")
            taken.add(own)


def _rotation(where: errors.Location, varying: Varying) -> Rotation:
    """About what points turn, in the SI unit of their key."""
    name, unit = where.key, varying.unit
    if not name.startswith("points"):
        raise where.error(f"turns; only points can turn, and {name} are none")
    if name != f"points_{unit}":
        raise where.error(f"has about_{unit}; the point is in the unit of {name}")
    along = np.array(varying.axis) / np.linalg.norm(varying.axis)
    return Rotation(units.size_of(name) * np.array(varying.about), along)


def _of_bearing(
    where: errors.Location, varying: Varying, bearings: Sequence[Mapping[str, Any]]
) -> Axis:
    number, key = int(where.place[0]), str(where.place[1])
    if number >= len(bearings):
        raise where.error(f"does not exist; there are {len(bearings)} bearings, counted from 0")
    name = units.si_key(key)
    if name not in bearings[number]:
        used = next(name for name in bearings[number] if name != "shaft")
        raise where.error(f"does not go with {used} of that bearing; vary that")
    entries, size = slice(number, number + 1), units.size_of(key)
    return Axis(str(where), "bearing", name, entries, None, varying.values, size=size)


def _location(name: str, place: str) -> errors.Location:
    return errors.Location.of(f"{name}.{place}" if place else name)


def _base(
    name: str, values: Mapping[str, Any] | None, section: str, of: str
) -> Sequence[Any] | None:
    """The entries that the scene gives a key; ``None`` for one number, which it may leave out."""
    if values is None:
        raise ArgumentValueError(name, f"needs a section [{section}]")
    own = units.si_key(name)
    if own in values:
        entries: Sequence[Any] | None = values[own] if isinstance(values[own], list) else None
        if entries == []:
            raise ArgumentValueError(
                name, "has no entries; one joint has no shaft between two joints"
            )
        return entries
    if section == "load" and own != "inertias_kgm2":
        for pair in LOAD.together:
            for key in pair:
                if own in pair and key in values:
                    raise ArgumentValueError(name, f"does not go with {key} of [load]; vary that")
        return None
    there = ", ".join(values)
    raise ArgumentValueError(name, f"is not in [{section}]; {of} can vary {there}")


def entries_of(key: errors.Location, index: str, count: int) -> slice:
    """Return which of so many entries ``"2"`` or ``"2-3"`` names."""
    ends = [int(end) for end in index.split("-")]
    first, last = ends[0], ends[-1]
    if not first <= last < count:
        raise key.error(f"does not exist; there are {count}, counted from 0")
    return slice(first, last + 1)


def values_at(axes: Sequence[Axis], rows: Any) -> list[FloatArray]:  # noqa: ANN401 - integers
    """The values of every axis at some rows of the grid."""
    places = np.unravel_index(rows, [len(axis.values) for axis in axes]) if axes else ()
    return [axis.values[place] for axis, place in zip(axes, places, strict=True)]


def put(values: dict[str, Any], axis: Axis, column: FloatArray) -> None:
    """Give a key the values of an axis, one per row."""
    rows = column.reshape(-1, 1)
    if axis.place is None:
        values[axis.name] = axis.size * rows
        return
    array = np.asarray(values[axis.name], dtype=np.float64)
    if array.ndim == (1 if axis.component is None and axis.rotation is None else 2):
        array = per_row(array, len(rows))
        values[axis.name] = array
    axis.change(array, column)


def per_row(value: ArrayLike, rows: int) -> FloatArray:
    """A copy of a list of the file for each row, with an axis for the drive angles."""
    array = np.asarray(value, dtype=np.float64)
    return np.array(np.broadcast_to(array, (rows, 1, *array.shape)))
