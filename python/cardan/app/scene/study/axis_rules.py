"""Rules for the values that a study gives the keys of a scene.

A schema cannot say that a spread of one step needs equal ends; only the reader checks that.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import ListOf, Number, Rule, Schema, Whole, refused, shown
from cardan.arrays.errors import nearest


class Spread(NamedTuple):
    """Evenly spaced values of a study, both ends included."""

    start: float
    stop: float
    steps: int


_SPREAD: Mapping[str, Rule] = {"from": Number(), "to": Number(), "steps": Whole(1)}


@dataclass(frozen=True)
class Values(Rule):
    """The values that a study gives a key: listed, or evenly spread."""

    def read(self, where: Location, value: object) -> Spread | list[float]:
        """Return the list or the spread."""
        if isinstance(value, list):
            if not value:
                raise where.error("is []; a study needs at least one value")
            numbers: list[float] = ListOf(Number(), "numbers").read(where, value)
            return numbers
        if not isinstance(value, dict):
            wanted = "{from = …, to = …, steps = …} or a list of numbers"
            raise refused(where, value, f"be {wanted}")
        for key in value:
            if key not in _SPREAD:
                known = nearest(key, tuple(_SPREAD))
                raise where.error(f"has an unknown key {shown(key)}; {known}")
        for key in _SPREAD:
            if key not in value:
                wanted = "{from = …, to = …, steps = …}"
                raise where.error(f"has no {key!r}; it must be {wanted}")
        spread = Spread(*(rule.read(where.at(key), value[key]) for key, rule in _SPREAD.items()))
        if spread.steps == 1 and spread.start != spread.stop:
            ends = f"from {spread.start:g} to {spread.stop:g}"
            raise where.at("steps").error(f"is 1; {ends} takes at least 2")
        return spread

    @property
    def schema(self) -> Schema:
        """A reference to the definition."""
        return {"$ref": "#/$defs/values"}

    @property
    def definition(self) -> Schema:
        """An array or an object, for the schema to define once."""
        return {
            "description": "what a study gives a key: a list, or values evenly spread",
            "oneOf": [
                {**ListOf(Number(), "numbers").schema, "minItems": 1},
                {
                    "type": "object",
                    "properties": {key: rule.schema for key, rule in _SPREAD.items()},
                    "required": list(_SPREAD),
                    "additionalProperties": False,
                },
            ],
        }


_PLACE = "^[0-9]{1,9}(-[0-9]{1,9})?$"


def _by_place(value: object) -> bool:
    return isinstance(value, dict) and bool(value) and not value.keys() & _SPREAD.keys()


def _entries(where: Location, index: str) -> Location:
    entries = where.at(index)
    if not re.fullmatch(_PLACE, index):
        raise entries.error("does not exist; write 0 for the first entry, 0-1 for two")
    return entries


def _places(item: Schema) -> Schema:
    return {
        "type": "object",
        "patternProperties": {_PLACE: item},
        "additionalProperties": False,
        "minProperties": 1,
    }


@dataclass(frozen=True)
class AxisValues(Rule):
    """What varies a number: the values, under no place."""

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by their place, which is empty."""
        return {"": Values().read(where, value)}

    @property
    def schema(self) -> Schema:
        """The values."""
        return Values().schema


@dataclass(frozen=True)
class ListAxes(Rule):
    """What varies a list of numbers: values for all entries, or for some by their place."""

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by place: ``""``, ``"1"`` or ``"0-1"``."""
        if not isinstance(value, dict) or not _by_place(value):
            return AxisValues().read(where, value)
        return {
            index: Values().read(_entries(where, index), entry) for index, entry in value.items()
        }

    @property
    def schema(self) -> Schema:
        """The values, or an object of them."""
        return {"anyOf": [Values().schema, _places(Values().schema)]}


@dataclass(frozen=True)
class VectorAxes(Rule):
    """What varies a list of vectors: values for components by their place."""

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by place and component: ``{"2": {"y": …}}`` as ``{"2.y": …}``."""
        if not isinstance(value, dict) or not value or not all(map(_is_section, value.values())):
            raise where.error(f"is {shown(value)}; name place and axis, as in {where}.2.y")
        axes = {}
        for index, components in value.items():
            at = _entries(where, index)
            for axis, entry in components.items():
                if axis not in ("x", "y", "z"):
                    raise at.error(f"has no {shown(axis)}; known are x, y, z")
                axes[f"{index}.{axis}"] = Values().read(at.at(axis), entry)
        return axes

    @property
    def schema(self) -> Schema:
        """An object of objects."""
        return _places(
            {
                "type": "object",
                "properties": dict.fromkeys("xyz", Values().schema),
                "additionalProperties": False,
                "minProperties": 1,
            }
        )


@dataclass(frozen=True)
class BearingAxes(Rule):
    """What varies the positions of bearings: values by the number of the bearing and by the key."""

    keys: tuple[str, ...]

    def read(self, where: Location, value: object) -> dict[str, Spread | list[float]]:
        """Return the values by number and key: ``{"0": {"position_mm": …}}`` by two parts."""
        if not isinstance(value, dict) or not value or not all(map(_is_section, value.values())):
            raise where.error(
                f"is {shown(value)}; name number and key, as in {where}.0.{self.keys[0]}"
            )
        axes = {}
        for index, keys in value.items():
            at = where.at(index)
            if not re.fullmatch("[0-9]{1,9}", index):
                raise at.error("does not exist; write 0 for the first bearing")
            for key, entry in keys.items():
                if key not in self.keys:
                    raise at.error(f"has no {shown(key)}; {nearest(key, self.keys)}")
                axes[f"{index}.{key}"] = Values().read(at.at(key), entry)
        return axes

    @property
    def schema(self) -> Schema:
        """An object of objects."""
        keys = {
            "type": "object",
            "properties": dict.fromkeys(self.keys, Values().schema),
            "additionalProperties": False,
            "minProperties": 1,
        }
        return {
            "type": "object",
            "patternProperties": {"^[0-9]{1,9}$": keys},
            "additionalProperties": False,
            "minProperties": 1,
        }


def _is_section(value: object) -> bool:
    return isinstance(value, dict) and bool(value)
