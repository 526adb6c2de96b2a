"""What the values of a scene file may be: each kind with its check and its JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from datetime import date, time
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from cardan.files import columns, pictures, recording
from cardan.outputs import OUTPUTS, nearest
from cardan.reductions import CLOSED_FORMS, REDUCTIONS
from cardan.scene.errors import Location

Schema: TypeAlias = Mapping[str, Any]
Reader: TypeAlias = Callable[[Location, object], Any]


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of value.

    Attributes:
        name: what to call it.
        read: takes the place of a value, for errors, and the value as TOML has it; returns it
            checked, or raises ValueError.
        schema: its JSON Schema.
    """

    name: str
    read: Reader
    schema: Schema


class Spread(NamedTuple):
    """Evenly spaced values of a study, both ends included."""

    start: float
    stop: float
    steps: int


def shown(value: object) -> str:
    """Return a value for a message: on one line and not long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a section"
    if isinstance(value, date | time):
        # As TOML writes it.
        return value.isoformat()
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        # Python does not print whole numbers of more than 4300 digits.
        return "a number too large"
    return text if len(text) <= 60 else f"{text[:57]}..."


def _text(where: Location, value: object) -> str:
    if not isinstance(value, str):
        raise where.error(f"is {shown(value)}; it must be text in quotes")
    return value


def _number(where: Location, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise where.error(f"is {shown(value)}; it must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise where.error(f"is {shown(value)}; it must be finite")
    if abs(number) > _LARGEST:
        raise where.error(f"is {shown(value)}; it must lie within ±{_LARGEST:g}")
    return number


# Beyond any driveline, and small enough for the squares of torques and lengths.
_LARGEST = 1e40


def _positive(where: Location, value: object) -> float:
    number = _number(where, value)
    if number <= 0.0:
        raise where.error(f"is {shown(value)}; it must be positive")
    return number


def _tolerance(where: Location, value: object) -> float:
    number = _number(where, value)
    if not 0.0 <= number < 1.0:
        raise where.error(f"is {shown(value)}; it must lie in [0, 1)")
    return number


def _whole(where: Location, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise where.error(f"is {shown(value)}; it must be a whole number of at least 1")
    return value


def _workers(where: Location, value: object) -> int:
    return -1 if value == -1 and not isinstance(value, bool) else _whole(where, value)


def _index(where: Location, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise where.error(f"is {shown(value)}; it must be a whole number, counted from 0")
    return value


def _slope(where: Location, value: object) -> float:
    number = _number(where, value)
    if not -90.0 < number < 90.0:
        raise where.error(f"is {shown(value)}; it must lie between -90 and 90")
    return number


def _vector(where: Location, value: object) -> list[float]:
    numbers: list[float] = _list_of(_number, "three numbers")(where, value)
    if len(numbers) != 3:
        raise where.error(f"is {shown(value)}; it must be a list of three numbers")
    return numbers


def _one_of(known: Iterable[str]) -> Reader:
    names = tuple(known)

    def read(where: Location, value: object) -> str:
        name = _text(where, value)
        if name not in names:
            raise where.error(f"is {shown(name)}; {nearest(name, names)}")
        return name

    return read


def _list_of(item: Reader, what: str) -> Reader:
    def read(where: Location, value: object) -> list[Any]:
        if not isinstance(value, list):
            raise where.error(f"is {shown(value)}; it must be a list of {what}")
        return [item(where.at(i), entry) for i, entry in enumerate(value)]

    return read


def _distinct(item: Reader, what: str) -> Reader:
    """A list of at least one entry, none of them twice."""

    def read(where: Location, value: object) -> list[Any]:
        entries: list[Any] = _list_of(item, what)(where, value)
        if not entries:
            raise where.error("is []; name at least one, or leave it out")
        for i, entry in enumerate(entries):
            if entry in entries[:i]:
                raise where.at(i).error(f"is {shown(entry)} again; name each once")
        return entries

    return read


def _one_or_more(item: Reader, what: str) -> Reader:
    several = _distinct(item, what)

    def read(where: Location, value: object) -> list[Any]:
        return [item(where, value)] if isinstance(value, str) else several(where, value)

    return read


def _file(suffixes: Collection[str]) -> Reader:
    def read(where: Location, value: object) -> str:
        name = _text(where, value)
        # The folder is for whoever runs the scene to choose.
        if Path(name).name != name or "\\" in name or not name.isprintable():
            raise where.error(f"is {shown(name)}; it must be a file name without a folder")
        return _ending(where, name, suffixes)

    return read


def _recording(where: Location, value: object) -> str:
    name = _text(where, value)
    if not name.isprintable():
        raise where.error(f"is {shown(name)}; it must be the name of a file")
    return _ending(where, name, recording.SUFFIXES)


def _ending(where: Location, name: str, suffixes: Collection[str]) -> str:
    if Path(name).suffix not in suffixes:
        raise where.error(f"is {shown(name)}; it must end in {' or '.join(suffixes)}")
    return name


_SPREAD = ("from", "to", "steps")


def _axis(where: Location, value: object) -> Spread | list[float]:
    """The values of one axis of a study: listed, or evenly spread."""
    if isinstance(value, list):
        if not value:
            raise where.error("is []; a study needs at least one value")
        return [_number(where.at(i), entry) for i, entry in enumerate(value)]
    if not isinstance(value, dict):
        wanted = "{from = …, to = …, steps = …} or a list of numbers"
        raise where.error(f"is {shown(value)}; it must be {wanted}")
    for key in value:
        if key not in _SPREAD:
            raise where.error(f"has an unknown key {shown(key)}; {nearest(key, _SPREAD)}")
    for key in _SPREAD:
        if key not in value:
            raise where.error(f"has no {key!r}; it must be {{from = …, to = …, steps = …}}")
    start, stop = (_number(where.at(key), value[key]) for key in ("from", "to"))
    steps = _whole(where.at("steps"), value["steps"])
    if steps == 1 and start != stop:
        raise where.at("steps").error(f"is 1; from {start:g} to {stop:g} takes at least 2")
    return Spread(start, stop, steps)


def _single_axis(where: Location, value: object) -> dict[str, Spread | list[float]]:
    return {"": _axis(where, value)}


def _indexed_axes(where: Location, value: object) -> dict[str, Any]:
    """One axis for all entries of a list, or axes for some of them by their place."""
    if isinstance(value, dict) and value and not set(value) & set(_SPREAD):
        return {key: _axis(where.at(key), entry) for key, entry in value.items()}
    return _single_axis(where, value)


def _is_section(value: object) -> bool:
    return isinstance(value, dict) and bool(value)


def _component_axes(where: Location, value: object) -> dict[str, Any]:
    """Axes for components of vectors: ``{"2": {"y": …}}`` becomes ``{"2.y": …}``."""
    if not isinstance(value, dict) or not all((value, *map(_is_section, value.values()))):
        raise where.error(f"is {shown(value)}; name place and axis, as in {where}.2.y")
    axes = {}
    for index, components in value.items():
        for axis, entry in components.items():
            if axis not in ("x", "y", "z"):
                raise where.at(index).error(f"has no {shown(axis)}; known are x, y, z")
            axes[f"{index}.{axis}"] = _axis(where.at(index).at(axis), entry)
    return axes


def _array(item: Schema, fewest: int = 0) -> Schema:
    return {"type": "array", "items": item} | ({"minItems": fewest} if fewest else {})


def _names(known: Iterable[str]) -> Schema:
    return {**_array({"enum": list(known)}, 1), "uniqueItems": True}


def _ends_in(suffixes: Iterable[str], folder: bool = False) -> Schema:
    endings = "|".join(suffix[1:] for suffix in suffixes)
    return {"type": "string", "pattern": rf"^{'.' if folder else '[^/]'}+\.({endings})$"}


_NUMBER = {"type": "number"}
_NATURAL = {"type": "integer", "minimum": 1}
DEFINITIONS: Schema = {
    "values": {
        "description": "what a study gives a key: a list, or values evenly spread",
        "oneOf": [
            _array(_NUMBER, 1),
            {
                "type": "object",
                "properties": {"from": _NUMBER, "to": _NUMBER, "steps": _NATURAL},
                "required": list(_SPREAD),
                "additionalProperties": False,
            },
        ],
    }
}
"""Parts of the schemas that are referred to by name."""

_AXIS = {"$ref": "#/$defs/values"}


def _by_place(item: Schema) -> Schema:
    return {
        "type": "object",
        "patternProperties": {"^[0-9]+(-[0-9]+)?$": item},
        "additionalProperties": False,
        "minProperties": 1,
    }


TEXT = Kind("text", _text, {"type": "string"})
NUMBER = Kind("number", _number, _NUMBER)
POSITIVE = Kind("positive number", _positive, {"type": "number", "exclusiveMinimum": 0})
NATURAL = Kind("whole number", _whole, _NATURAL)
NUMBERS = Kind("numbers", _list_of(_number, "numbers"), _array(_NUMBER))
BENDS = Kind(
    "numbers",
    _list_of(_number, "numbers"),
    _array({"type": "number", "minimum": 0, "exclusiveMaximum": 90}, 1),
)
SLOPES = Kind(
    "slopes",
    _list_of(_slope, "numbers"),
    _array({"type": "number", "exclusiveMinimum": -90, "exclusiveMaximum": 90}),
)
VECTORS = Kind(
    "vectors",
    _list_of(_vector, "vectors [x, y, z]"),
    _array({**_array(_NUMBER, 3), "maxItems": 3}, 2),
)
QUANTITIES = Kind("names", _distinct(_one_of(OUTPUTS), "names"), _names(OUTPUTS))
CLOSED = Kind("names", _distinct(_one_of(CLOSED_FORMS), "names"), _names(CLOSED_FORMS))
REDUCED = Kind(
    "name or names",
    _one_or_more(_one_of(REDUCTIONS), "names"),
    {"oneOf": [{"enum": list(REDUCTIONS)}, _names(REDUCTIONS)]},
)
INDICES = Kind(
    "whole numbers",
    _distinct(_index, "whole numbers"),
    {**_array({"type": "integer", "minimum": 0}, 1), "uniqueItems": True},
)
TOLERANCE = Kind("number", _tolerance, {"type": "number", "minimum": 0, "exclusiveMaximum": 1})
DTYPE = Kind("name", _one_of(("float64", "float32")), {"enum": ["float64", "float32"]})
WORKERS = Kind("whole number", _workers, {"type": "integer", "minimum": -1, "not": {"const": 0}})
CURVES_FILE = Kind("curves file", _file(columns.SUFFIXES), _ends_in(columns.SUFFIXES))
TABLE_FILE = Kind("table file", _file(columns.SUFFIXES), _ends_in(columns.SUFFIXES))
PICTURE_FILE = Kind("picture file", _file(pictures.SUFFIXES), _ends_in(pictures.SUFFIXES))
RECORDING = Kind("file", _recording, _ends_in(recording.SUFFIXES, folder=True))
COLUMNS = Kind("texts", _distinct(_text, "texts"), {**_array({"type": "string"}, 1)})
AXIS = Kind("values", _single_axis, _AXIS)
AXES = Kind("values", _indexed_axes, {"anyOf": [_AXIS, _by_place(_AXIS)]})
COMPONENT_AXES = Kind(
    "values",
    _component_axes,
    _by_place(
        {
            "type": "object",
            "properties": dict.fromkeys("xyz", _AXIS),
            "additionalProperties": False,
            "minProperties": 1,
        }
    ),
)
