"""Rules for the values of a scene: each reads a value and describes itself as JSON Schema.

Both follow from the same attributes, so the reader and the schema accept the same values. A schema
cannot say that the name of a file is printable; only the reader checks that.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from datetime import date, time
from itertools import combinations
from pathlib import Path
from typing import Any, Self, TypeAlias

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.units import ENDINGS, Unit, alike, split, units_of, us_keys
from cardan.arrays.errors import nearest

Schema: TypeAlias = Mapping[str, Any]

# Beyond any driveline, and small enough for the squares of torques and lengths.
_LARGEST = 1e40


class Rule(ABC):
    """Condition on a value; one that keeps its unit leaves values in that of the key."""

    keeps_unit = False

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of a value in the help text."""

    @abstractmethod
    def read(self, where: Location, value: object) -> Any:  # noqa: ANN401 - what the rule makes of it
        """Return a value of TOML as scenes use it; raise KeyValueError where it breaks the rule."""

    @property
    @abstractmethod
    def schema(self) -> Schema:
        """JSON Schema of the values that ``read`` takes."""

    def of_us_key(self, unit: Unit) -> Rule:
        """Return the rule of a key for the same in a US unit, which reads values in the SI unit."""
        return self if self.keeps_unit else InUnit(self.in_unit(unit), unit)

    def in_unit(self, unit: Unit) -> Self:
        """Return the rule for the same values in a US unit, with the same ends."""
        if not is_dataclass(self):
            return self
        own = ((each.name, getattr(self, each.name)) for each in fields(self))
        changed = {name: rule.in_unit(unit) for name, rule in own if isinstance(rule, Rule)}
        return replace(self, **changed)


SPREAD = "{from = …, to = …, steps = …}"
"""How evenly spread values are written."""


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


def refused(where: Location, value: object, must: str) -> ValueError:
    """Return what to raise for a value that breaks a rule."""
    return where.error(f"is {shown(value)}; it must {must}")


@dataclass(frozen=True)
class Text(Rule):
    """Text; only the reader knows which characters a terminal prints as they stand."""

    printable: bool = False
    name = "text"
    keeps_unit = True

    def read(self, where: Location, value: object) -> str:
        if not isinstance(value, str):
            raise refused(where, value, "be text in quotes")
        if self.printable and not value.isprintable():
            raise refused(where, value, "have printable characters only")
        return value

    @property
    def schema(self) -> Schema:
        return {"type": "string"}


@dataclass(frozen=True)
class Number(Rule):
    """A finite number of an interval whose ends ``above`` and ``below`` exclude.

    The message for a number outside calls it ``what`` and gives its ``unit``.
    """

    low: float = -_LARGEST
    high: float = _LARGEST
    above: bool = False
    below: bool = False
    what: str = "it"
    unit: str = ""

    @property
    def name(self) -> str:
        positive = self.high >= 1e6 and (self.low > 0.0 or (self.low == 0.0 and self.above))
        return "positive number" if positive else "number"

    def read(self, where: Location, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise refused(where, value, "be a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise refused(where, value, "be finite")
        if abs(number) > _LARGEST:
            raise refused(where, value, f"lie within ±{_LARGEST:g}")
        fits_low = number > self.low if self.above else number >= self.low
        fits_high = number < self.high if self.below else number <= self.high
        if not (fits_low and fits_high):
            unit = self.unit and f" {self.unit}"
            raise where.error(f"is {shown(value)}{unit}; {self.what} must {self._interval}{unit}")
        return number

    @property
    def _interval(self) -> str:
        if self.low == 0.0 and self.high == _LARGEST:
            return "be positive" if self.above else "not be negative"
        if self.low == -self.high and not (self.above or self.below):
            return f"lie within ±{self.high:g}"
        if self.above and self.below:
            return f"lie between {self.low:g} and {self.high:g}"
        opening, closing = "(" if self.above else "[", ")" if self.below else "]"
        return f"lie in {opening}{self.low:g}, {self.high:g}{closing}"

    def in_unit(self, unit: Unit) -> Self:
        """Return the rule for a number in a US unit."""
        low, high = (
            end if abs(end) == _LARGEST else end / unit.size for end in (self.low, self.high)
        )
        return replace(self, low=low, high=high, unit=self.unit and unit.symbol)

    @property
    def schema(self) -> Schema:
        return {
            "type": "number",
            "exclusiveMinimum" if self.above else "minimum": self.low,
            "exclusiveMaximum" if self.below else "maximum": self.high,
        }


@dataclass(frozen=True)
class Whole(Rule):
    """A whole number; ``also`` is one below the least that is permitted too."""

    least: int
    also: int | None = None
    most: int | None = None
    name = "whole number"

    def read(self, where: Location, value: object) -> int:
        # To Python, true is a whole number.
        if isinstance(value, int) and not isinstance(value, bool):
            most = value if self.most is None else self.most
            if value == self.also or self.least <= value <= most:
                return value
        counted = f" of at least {self.least}" if self.least else ", counted from 0"
        if self.most is not None:
            counted = f" from {self.least} to {self.most}"
        other = "" if self.also is None else f", or {self.also}"
        raise refused(where, value, f"be a whole number{counted}{other}")

    @property
    def schema(self) -> Schema:
        if self.also is None:
            most = {} if self.most is None else {"maximum": self.most}
            return {"type": "integer", "minimum": self.least, **most}
        return {"type": "integer", "anyOf": [{"minimum": self.least}, {"const": self.also}]}


@dataclass(frozen=True)
class OneOf(Rule):
    """One of some names; ``hint`` says what to name in place of another."""

    names: tuple[str, ...]
    hint: Callable[[str], str] | None = None
    name = "name"

    def read(self, where: Location, value: object) -> str:
        name = Text().read(where, value)
        if name not in self.names:
            own = self.hint or (lambda name: f"is {shown(name)}; {nearest(name, self.names)}")
            raise where.error(own(name))
        return name

    @property
    def schema(self) -> Schema:
        return {"enum": list(self.names)}


@dataclass(frozen=True)
class FileName(Rule):
    """The name of a file with one of some endings, which may name folders or not."""

    suffixes: Collection[str]
    folders: bool = False
    name = "file"

    @property
    def _pattern(self) -> str:
        endings = "|".join(suffix[1:] for suffix in self.suffixes)
        stem = "(.*/)?[^/]+" if self.folders else r"[^/\\]+"
        return rf"^{stem}\.({endings})$"

    def read(self, where: Location, value: object) -> str:
        name = Text().read(where, value)
        # On Windows a drive is a folder too.
        if not self.folders and (Path(name).name != name or "\\" in name):
            # The folder is for whoever runs the scene to choose.
            raise refused(where, name, "be a file name without a folder")
        if not name.isprintable():
            raise refused(where, name, "have printable characters only")
        if not re.search(self._pattern, name):
            raise refused(where, name, f"end in {' or '.join(self.suffixes)}")
        return name

    @property
    def schema(self) -> Schema:
        return {"type": "string", "pattern": self._pattern}


@dataclass(frozen=True)
class Directed(Rule):
    """A number with a sign, or text as a workshop notes it: ``"3.0 down"``, ``"5.2 % up"``.

    ``ways`` are the words for a positive and a negative value. ``units`` say what follows the
    number in the text, and what the value is then; those with ``True`` have no sign of their own.
    """

    within: Number
    ways: tuple[str, str]
    units: Mapping[str, tuple[Callable[[float], float], bool]]
    hint: str
    name = "number or text"

    def in_unit(self, unit: Unit) -> Self:
        """Return the rule for a number in a US unit, whose text names that."""
        own = ENDINGS[unit.si].symbol
        units = {unit.symbol if name == own else name: made for name, made in self.units.items()}
        return replace(self, within=self.within.in_unit(unit), units=units)

    @property
    def _pattern(self) -> str:
        units = "|".join(re.escape(unit) for unit in self.units)
        return rf"^\s*([-+]?\d+(?:\.\d*)?)\s*({units})?\s*({'|'.join(self.ways)})?\s*$"

    def read(self, where: Location, value: object) -> float:
        if not isinstance(value, str):
            return self.within.read(where, value)
        match = re.match(self._pattern, value)
        if not match:
            raise refused(where, value, f"be as {self.hint}")
        number, unit, way = float(match[1]), match[2] or "", match[3]
        made, is_unsigned = self.units.get(unit, (float, True))
        if match[1][0] in "+-" and way:
            raise where.error(f"is {shown(value)}, with a sign and {way!r}; give one of them")
        size = made(number)
        if way == self.ways[1]:
            size = -size
        elif not way and is_unsigned and match[1][0] not in "+-" and size != 0.0:
            either = " or ".join(f'"{value.strip()} {each}"' for each in self.ways)
            raise where.error(f"is {shown(value)} without a direction; write {either}")
        return self.within.read(where, size)

    @property
    def schema(self) -> Schema:
        return {"anyOf": [self.within.schema, {"type": "string", "pattern": self._pattern}]}


@dataclass(frozen=True)
class ListOf(Rule):
    """A list of what ``what`` says; a distinct one is not empty and has no entry twice."""

    item: Rule
    what: str
    count: int | None = None
    distinct: bool = False

    @property
    def name(self) -> str:
        return f"{self.item.name}s"

    def read(self, where: Location, value: object) -> list[Any]:
        if not isinstance(value, list):
            raise refused(where, value, f"be a list of {self.what}")
        entries = [self.item.read(where.at(i), entry) for i, entry in enumerate(value)]
        if self.count is not None and len(entries) != self.count:
            raise refused(where, value, f"be a list of {self.what}")
        if self.distinct and not entries:
            raise where.error("is []; name at least one, or leave it out")
        for i, entry in enumerate(entries):
            if self.distinct and entry in entries[:i]:
                raise where.at(i).error(f"is {shown(entry)} again; name each once")
        return entries

    @property
    def schema(self) -> Schema:
        schema: dict[str, Any] = {"type": "array", "items": self.item.schema}
        if self.count is not None:
            schema |= {"minItems": self.count, "maxItems": self.count}
        if self.distinct:
            schema |= {"minItems": 1, "uniqueItems": True}
        return schema


@dataclass(frozen=True)
class OneOrEach(Rule):
    """One value for all, or a list of them with one for each."""

    several: ListOf

    @property
    def name(self) -> str:
        return f"{self.several.item.name.removeprefix('positive ')}(s)"

    def read(self, where: Location, value: object) -> Any:  # noqa: ANN401 - a value or a list
        rule = self.several if isinstance(value, list) else self.several.item
        return rule.read(where, value)

    @property
    def schema(self) -> Schema:
        return {"oneOf": [self.several.item.schema, self.several.schema]}


@dataclass(frozen=True)
class OneOrMore(OneOrEach):
    """A list, or its only entry, of these types of TOML; anything else must be a list."""

    single: type | tuple[type, ...] = str

    @property
    def name(self) -> str:
        name = self.several.item.name
        return name if self.several.count == 1 else f"{name} or {name}s"

    def read(self, where: Location, value: object) -> list[Any]:
        """Return the entries, as a list in either case."""
        # To Python, true is a whole number.
        if isinstance(value, self.single) and not isinstance(value, bool):
            return [self.several.item.read(where, value)]
        return self.several.read(where, value)


@dataclass(frozen=True)
class InUnit(Rule):
    """Values that a file gives in a US unit, which are read in the SI unit; ``rule`` is as given.

    Other entries, as the word "rigid" in place of a number, are read as they are.
    """

    rule: Rule
    unit: Unit

    @property
    def name(self) -> str:
        return self.rule.name

    def read(self, where: Location, value: object) -> Any:  # noqa: ANN401 - as of the rule
        return _times(self.rule.read(where, value), self.unit.size)

    @property
    def schema(self) -> Schema:
        return self.rule.schema


def _times(value: Any, factor: float) -> Any:  # noqa: ANN401 - as of a rule
    if isinstance(value, list):
        return [_times(each, factor) for each in value]
    return value * factor if isinstance(value, float) else value


def in_us_units(key: str, rule: Rule) -> dict[str, Rule]:
    """Return the rules of the keys that hold the same in US units, by key."""
    return {us: rule.of_us_key(ENDINGS[split(us)[1]]) for us in us_keys(key)}


def given_as(key: str) -> Schema:
    """Return the JSON Schema of an object that gives a key, in whichever units."""
    spelled = (key, *us_keys(key))
    ways: list[Schema] = [{"required": [each]} for each in spelled]
    return ways[0] if len(ways) == 1 else {"anyOf": ways}


def not_both(*keys: str) -> Schema:
    """Return the JSON Schema of an object that does not give all of some keys."""
    if not any(map(us_keys, keys)):
        return {"not": {"required": list(keys)}}
    return {"not": {"allOf": [given_as(key) for key in keys]}}


def in_one_unit(keys: Iterable[str]) -> list[Schema]:
    """Return JSON Schemas of an object that gives no value twice, in several units."""
    pairs = (pair for key in keys for pair in combinations((key, *us_keys(key)), 2))
    return [{"not": {"required": list(pair)}} for pair in pairs]


@dataclass(frozen=True)
class Table(Rule):
    """A table of some or all of these keys; ``what`` says in words how it is written."""

    keys: Mapping[str, Rule]
    what: str
    required: bool = True
    name = "table"

    def read(self, where: Location, value: object) -> dict[str, Any]:
        if not isinstance(value, dict):
            raise refused(where, value, f"be {self.what}")
        for key in value:
            if key not in self.keys:
                known = alike(key, self.keys)
                hint = units_of(key, known) or nearest(key, known)
                raise where.error(f"has an unknown key {shown(key)}; {hint}")
        for key in self.keys if self.required else ():
            if key not in value:
                raise where.error(f"has no {key!r}; it must be {SPREAD}")
        return {key: self.keys[key].read(where.at(key), entry) for key, entry in value.items()}

    @property
    def schema(self) -> Schema:
        return {
            "type": "object",
            "properties": {key: rule.schema for key, rule in self.keys.items()},
            **({"required": list(self.keys)} if self.required else {}),
            "additionalProperties": False,
        }


def tables(pattern: str, entry: Schema) -> Schema:
    """Return the JSON Schema of an object of such entries, with keys of a pattern."""
    return {
        "type": "object",
        "minProperties": 1,
        "patternProperties": {pattern: entry},
        "additionalProperties": False,
    }


def names(known: Iterable[str]) -> OneOrMore:
    """Return the rule for one or more of some names."""
    return OneOrMore(ListOf(OneOf(tuple(known)), "names", distinct=True))


def each(number: Rule, what: str = "numbers", count: int | None = None) -> OneOrEach:
    """Return the rule for one value for all parts of a driveline, or one for each."""
    return OneOrEach(ListOf(number, what, count))


def numbers(number: Rule | None = None, count: int | None = None) -> OneOrMore:
    """Return the rule for a list of numbers, or its only number."""
    what = "numbers" if count is None else "one number"
    return OneOrMore(ListOf(number or Number(), what, count), (int, float))


POSITIVE = Number(0, above=True)
NOT_NEGATIVE = Number(0)
COUNT = Whole(1)
INDEX = Whole(0)
BEND = Number(0, 90, below=True, what="a bend", unit="deg")
# Beyond 0 and below the right angle, at which no joint turns.
ACUTE = Number(0, 90, above=True, below=True, unit="deg")
# As far as sweeps go, and small enough for their steps to be told apart; also for torques.
START = Number(-1e12, 1e12)
# Lengths in mm that a part of a machine can have.
SIZE = Number(1e-3, 1e6)
DISTANCE = Number(-1e3, 1e3, unit="mm")
FRICTION = Number(0, 10)
TOOTH_COUNTS = each(Whole(1, most=1000), "whole numbers")
VECTOR = ListOf(Number(), "three numbers", 3)
INDICES = ListOf(INDEX, "whole numbers", distinct=True)
TEXTS = ListOf(Text(), "texts", distinct=True)
