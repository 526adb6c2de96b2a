"""Rows of answers: what a figure is called, its unit, its meaning, its source and its limit.

A part of an answer is a dataclass whose fields are declared here. From these come the keys of the
JSON and its schema, the printed lines, the rows of the page and of the reference, and the verdict.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple, TypeVar, get_args, get_type_hints

from cardan.app.scene.language.units import ENDINGS, RPM, ending_of
from cardan.design.judged import VERDICTS, is_within

_T = TypeVar("_T")
Kind = Literal["figure", "numbers", "item", "count", "word", "flag", "parts", "place"]
Rounds = Literal["nearest", "up", "down"]


class Unit(NamedTuple):
    """A unit as people read it, and how many of it are one unit inside."""

    symbol: str
    factor: float = 1.0


_FACTORS = {
    **{"deg": 180.0 / math.pi, "mm": 1e3, "rpm": 1.0 / RPM},
    **{"MPa": 1e-6, "GPa": 1e-9, "um_per_MPa": 1e12, "N_per_mm": 1e-3, "gmm": 1e6},
}
_MORE = {
    "": Unit(""),
    "h": Unit("h"),
    "W": Unit("W"),
    "Hz": Unit("Hz", 1.0 / math.tau),
    "percent": Unit("%", 100.0),
    "per_rad": Unit("per rad"),
    "rpm_deg": Unit("rpm·deg", 180.0 / math.pi / RPM),
}
UNITS: Mapping[str, Unit] = _MORE | {
    ending: Unit(
        "°" if ending == "deg" else unit.symbol,
        _FACTORS.get(unit.si or ending, 1.0) / unit.size,
    )
    for ending, unit in ENDINGS.items()
}
"""The units of rows by the ending of a key. Inside, figures are in SI; lives are in hours.

Rows and JSON have SI units; US units are those in which figures are shown.
"""
SI_UNITS = tuple(unit for unit in UNITS if unit not in ENDINGS or not ENDINGS[unit].si)
"""Units of the JSON."""


class Digits(NamedTuple):
    """Digits with which a kind of figure is shown; all that were given if both are ``None``."""

    decimals: int | None = None
    digits: int | None = None  # so many, but every one before the point
    apart: float | None = None  # what only a figure that equals it is shown as
    finest: float = 0.0  # a figure below it is rounding, and shown as 0


_THREE = Digits(digits=3)
_UNITS = dict.fromkeys(UNITS, _THREE) | {
    "": Digits(digits=3, finest=1e-15),
    "deg": Digits(decimals=2, finest=1e-6),
    "rad": Digits(decimals=4, finest=1e-8),
    "m": Digits(decimals=4),
    "mm": Digits(decimals=1, finest=1e-6),
    "rad_s2": Digits(decimals=0, finest=1e-9),
    "MPa": Digits(decimals=1),
    # A thousandth of an inch, and not coarser than in SI units.
    "in": Digits(decimals=3, finest=4e-8),
    "ft": Digits(decimals=4),
    "psi": Digits(decimals=0),
    "h": Digits(decimals=0),
    "percent": Digits(digits=3, apart=100.0),
}
DIGITS: Mapping[str, Digits] = _UNITS | {
    "phase": Digits(decimals=1, finest=1e-3),  # yokes, bend planes and the drive, in degrees
    "twist": Digits(decimals=1, finest=1e-3),
    "angle_error": Digits(digits=3, finest=1e-12),
    "small": Digits(digits=3, finest=1e-6),  # what joints and seats yield, and the play they have
    "small_in": Digits(digits=3, finest=4e-8),
    "speed_ratio": Digits(decimals=4, apart=1.0),
    "direction": Digits(decimals=4, finest=1e-9),
    "margin": Digits(decimals=2),
    "share": Digits(decimals=1, apart=100.0),  # in percent, of drivelines or of a scatter
    "measured": Digits(digits=4),
    "given": Digits(),
}
"""Digits with which figures are shown, by their unit or their kind.

A figure gets more where it would else read 0, or as what it is told apart from.
"""


def key_of(unit: str) -> str:
    """Return the key of ``UNITS`` for a unit of the library: ``"deg"`` for ``"rad"``."""
    return "deg" if unit == "rad" else ending_of("" if unit == "1" else unit)[1:]


@dataclass(frozen=True)
class Row:
    """Description of a field without its value."""

    kind: Kind
    label: str  # what people call it
    unit: str = ""  # a key of UNITS
    meaning: str = ""  # what it is, for those who do not know the label
    source: str = ""  # formula and source
    limit: str = ""  # the key of the scene that gives its limit: "[slip] travel_mm"
    digits: str = ""  # a key of DIGITS, where that is not the unit
    rounds: Rounds = "nearest"  # "up" or "down" where the figure must do what it promises
    at_zero: str = ""  # what it is if it is 0 and must not be: "within the speed range"
    apart: str = ""  # the field of the same part that it is told apart from
    end: str = ""  # the field of the same part at the other end of a range
    is_detail: bool = False  # whether it is left out of printed text
    # "own": the field "unit" of the same part holds the unit; "each": the keys end in it as well.
    # Of an item, "own": the field "per" holds what it is.
    own: str = ""
    is_optional: bool = False  # whether JSON leaves it out where it is None or empty
    is_shown: bool = False  # whether it is held in the unit in which it is shown, as a scene has it
    bounds: tuple[float, ...] = ()  # what the figures say that it is told apart from
    other_end: tuple[float, ...] = ()  # of its range, whose width has two digits

    def beside(self, found: Any) -> Row:  # noqa: ANN401 - any part
        """Return the row with the unit, or of an item the label, and the bounds of the figures."""
        row = self
        if self.apart and (bound := getattr(found, self.apart)) is not None:
            row = replace(row, bounds=(bound,))
        if self.end and (other := getattr(found, self.end)) is not None:
            row = replace(row, other_end=(other,))
        if not self.own:
            return row
        if self.kind == "item":
            return replace(row, label=found.per)
        return replace(row, unit=found.unit)

    def ending(self, *, radians: bool = False) -> str:
        """Return what follows the name of the field in a key of the JSON."""
        unit = "rad" if radians and self.unit == "deg" else self.unit
        return f"_{unit}" if unit and self.own != "own" else ""

    def shown(self, value: float, *, radians: bool = False) -> float:
        """Return a value in the unit in which it is shown."""
        turned = radians and self.unit == "deg"
        if self.is_shown:
            return math.radians(value) if turned else value
        return value * (1.0 if turned else UNITS[self.unit].factor)


def figure(label: str, unit: str = "", meaning: str = "", **more: Any) -> Any:  # noqa: ANN401
    """Declare a number: ``float``, ``float | None`` where it may be unknown, or ``Judged``.

    The unit is a key of ``UNITS``. It is ``"own"`` if the field ``unit`` of the same part holds
    that key, and ``"each"`` if the keys of the JSON end in it as well. More is what ``Row`` has.
    """
    return _declared(Row("figure", label, unit, meaning, **more))


def numbers(label: str, unit: str = "", meaning: str = "", *, is_detail: bool = True) -> Any:  # noqa: ANN401 - as of figure
    """Declare several numbers of one kind, in an array or tuple in the order of their items."""
    return _declared(Row("numbers", label, unit, meaning, is_detail=is_detail))


def _declared(row: Row) -> Any:  # noqa: ANN401 - as of figure
    if row.unit in ("own", "each"):
        row = replace(row, unit="", own=row.unit)
    return field(metadata={"row": row})


def optional(declared: Any) -> Any:  # noqa: ANN401 - as of figure
    """Return a declared field that JSON leaves out where it is ``None`` or empty."""
    return field(metadata={"row": replace(declared.metadata["row"], is_optional=True)})


def as_shown(declared: Any) -> Any:  # noqa: ANN401 - as of figure
    """Return a declared number that is held in the unit in which it is shown: degrees, rpm, mm."""
    return field(metadata={"row": replace(declared.metadata["row"], is_shown=True)})


def _declares(kind: Kind) -> Callable[..., Any]:
    """Return a function that declares a field: its label, its meaning, whether it is a detail."""

    def declare(label: str, meaning: str = "", *, is_detail: bool = False) -> Any:  # noqa: ANN401
        return field(metadata={"row": Row(kind, label, meaning=meaning, is_detail=is_detail)})

    return declare


count = _declares("count")
"""Declare a number of things."""
word = _declares("word")
"""Declare a word or name: ``str``, ``str | None`` or a ``Literal``."""
flag = _declares("flag")
"""Declare whether something is so."""
parts = _declares("parts")
"""Declare further figures: a dataclass, or a tuple of one kind of dataclass."""
place = _declares("place")
"""Declare where in a study something is: the values of its keys, ``Mapping[str, float]``."""


def item(of: str) -> Any:  # noqa: ANN401 - as of figure
    """Declare the number of what the other fields are about: the shaft, joint or bearing.

    It is ``"own"`` if the field ``per`` of the same part holds which of these it is.
    """
    return _declared(Row("item", "", of) if of == "own" else Row("item", of))


def taken(of: type[_T], found: object, /, **more: Any) -> _T:  # noqa: ANN401 - of any field
    """Return a dataclass with the fields of the same names of a result, and with some more."""
    names = (each.name for each in dataclasses.fields(of) if each.name not in more)  # type: ignore[arg-type]
    return of(**{name: getattr(found, name) for name in names}, **more)


@dataclass(frozen=True)
class Judged:
    """A figure where it is worst, beside its limit."""

    value: float | None  # None where the scene does not determine it
    limit: float | None = None  # what it is judged against; None if the scene gives none
    maximum: float | None = None  # what it must not pass if that is not the limit
    sense: Literal["most", "least"] = "most"  # what the limit is of the value
    source: str = "own limit"  # whose rule the limit is
    size: float = 0.0  # of what is judged; rounding counts by it where the limit is 0
    state: str = ""  # the state, step or driveline in which it is worst; "" if all are alike
    at: Mapping[str, float] = field(default_factory=dict)  # in a study, keys and values there
    each: Mapping[str, float] = field(default_factory=dict)  # the figure in each state, by name
    why: str = ""  # why it is not judged although there is a limit
    may_be_worse: bool = False  # whether it may be, where it is not known

    @property
    def verdict(self) -> str:
        """``"within"``, ``"tolerable"``, ``"beyond"`` or ``"not judged"``."""
        if self.value is None or self.limit is None or self.why or math.isnan(self.value):
            return "not judged"
        bounds = (self.limit, self.limit if self.maximum is None else self.maximum)
        kept = [
            is_within(self.value, bound, most=self.sense == "most", size=self.size)
            for bound in bounds
        ]
        return "within" if kept[0] else "tolerable" if kept[1] else "beyond"

    @property
    def excess(self) -> float:
        """How far the value is on the wrong side of what it must not pass."""
        assert self.value is not None
        assert self.limit is not None
        bound = self.limit
        if self.maximum is not None and self.verdict == "beyond":
            bound = self.maximum
        return self.value - bound if self.sense == "most" else bound - self.value

    @property
    def share_of_limit(self) -> float:
        """How many times its limit the value is, or the inverse of what must not be less.

        Infinity where it is not judged although there is a limit.
        """
        if self.verdict == "not judged" or self.limit is None or self.value is None:
            return math.inf
        above, below = abs(self.value), abs(self.limit)
        if self.sense == "least":
            above, below = below, above
        return above / below if below else math.inf


@dataclass(frozen=True)
class NotFound:
    """A part that a scene asks for and that could not be found: why."""

    reason: str


class Entry(NamedTuple):
    """A field of a part with its value."""

    path: str  # its key: "spline.travel", "tubes.1.stress"
    row: Row
    value: Any  # as the field has it
    item: str  # what it is about: "shaft 1"; "" if there is only one


def rows_of(of: type) -> Iterator[tuple[str, Row, Any]]:
    """Yield name, row and type of each field of a dataclass that has rows."""
    hints = get_type_hints(of)
    for each in dataclasses.fields(of):
        if "row" in each.metadata:
            yield each.name, each.metadata["row"], hints[each.name]


def entries(found: Any, path: str, item: str = "") -> Iterator[Entry]:  # noqa: ANN401 - any part
    """Yield the fields of a part, those of its parts as well."""
    if isinstance(found, tuple):
        for number, each in enumerate(found):
            own = item_of(each)
            key = own.rpartition(" ")[2] if own else str(number)
            yield from entries(each, f"{path}.{key}", own or item)
        return
    for name, row, _ in rows_of(type(found)):
        value = getattr(found, name)
        if row.kind != "parts":
            yield Entry(f"{path}.{name}", row.beside(found), value, item)
        elif value is not None:
            yield from entries(value, f"{path}.{name}", item)


def item_of(found: Any) -> str:  # noqa: ANN401 - any part
    """Return what the figures are about: ``"shaft 1"``, the name of a state, or ""."""
    for name, row, _ in rows_of(type(found)):
        if row.kind == "item":
            value = getattr(found, name)
            return value if isinstance(value, str) else f"{row.beside(found).label} {value}"
    return ""


def element_of(hint: Any) -> Any:  # noqa: ANN401 - any annotation
    """Return the dataclass of a field of parts."""
    found = [each for each in (hint, *get_args(hint)) if dataclasses.is_dataclass(each)]
    return found[0]


def worst_of(verdicts: Iterable[str]) -> str:
    """Return the worst of some verdicts; ``"not judged"`` of none."""
    return max(verdicts, key=VERDICTS.index, default="not judged")
