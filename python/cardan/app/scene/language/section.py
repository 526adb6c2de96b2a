"""Sections of a scene file: their keys, and what a scene makes of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

import numpy as np

from cardan.app.scene.language.rules import Rule, in_us_units
from cardan.app.scene.language.units import ENDINGS, si_key, split
from cardan.arrays.errors import ArgumentValueError

if TYPE_CHECKING:
    from cardan.app.scene import scene

Made = TypeVar("Made")

Reading: TypeAlias = "scene.Reading"
"""The scene that a section belongs to; it knows the sections, and they only know its name."""


@dataclass(frozen=True)
class Key:
    """One key of a scene file.

    Attributes:
        argument: the parameter that it sets.
        factor: what to multiply the value by to get that parameter's unit.
        default: the value where the key is left out.
        per: what a list has one value for: ``"joint"``, ``"shaft"``, … of ``check_counts``.
        kind: what to call its values, if not as the rule does.
        entry: of a list what an entry is, of what, and the number of the first one.
    """

    rule: Rule
    meaning: str
    argument: str = ""
    factor: float = 1.0
    default: Any = None
    per: str = ""
    kind: str = ""
    entry: tuple[str, str, int] | None = None


def with_us_keys(keys: Mapping[str, Key]) -> dict[str, Key]:
    """Return keys and behind each of them those for the same in US units."""
    found: dict[str, Key] = {}
    for name, key in keys.items():
        found[name] = key
        for us, rule in in_us_units(name, key.rule).items():
            meaning = f"as {name}, in {ENDINGS[split(us)[1]].name}"
            found.setdefault(us, replace(key, rule=rule, meaning=meaning, default=None))
    return found


@dataclass(frozen=True, eq=False)
class Section(Generic[Made]):
    """One section of a scene file.

    What it is made of has the values in the units of the keys that are declared; each of these has
    keys for the same in US units.

    Attributes:
        name: of the section; ``""`` for the top of the file.
        make: makes of its values by key what scenes use.
        together: keys of which at most one may be given.
        needed: keys that must be given, one of each group.
        fewest: how many keys there must be.
        with_key: pairs of a key and another that must be given with it.
        paths: whether its keys may be paths in quotes, as in ``"points_mm.2.y"``.
        repeated: whether it is an array of tables, which a scene may give any number of times.
        always: whether something is made of it, of no values, in a scene that leaves it out.
        recorded_bends: whether it goes with recorded bends, which differ by sample.
        help_on_paths: what the help text says in place of the keys that are paths.
        inner: tables within it, ``[torsion.motor]``, by their own key.
        meant: says of an unknown key with its value what to write instead; "" if nothing is known.
    """

    name: str
    meaning: str
    keys: Mapping[str, Key]
    make: Callable[[Mapping[str, Any], Reading], Made]
    together: tuple[tuple[str, str], ...] = ()
    needed: tuple[tuple[str, ...], ...] = ()
    fewest: int = 0
    with_key: tuple[tuple[str, str], ...] = ()
    paths: bool = False
    repeated: bool = False
    always: bool = False
    recorded_bends: bool = True
    help_on_paths: str = ""
    inner: Mapping[str, Section[Any]] = field(default_factory=dict)
    meant: Callable[[str, Any], str] = lambda _key, _value: ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", with_us_keys(self.keys))

    @property
    def heading(self) -> str:
        """The line that begins it in a file: ``[load]``, ``[[bearing]]``."""
        return f"[[{self.name}]]" if self.repeated else f"[{self.name}]"

    def filled(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return values by key with the defaults of those left out."""
        return {key: entry.default for key, entry in self.keys.items()} | dict(values)

    def arguments(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of keys that set a parameter, by parameter and in its unit."""
        return {
            entry.argument: _times(values[key], entry.factor)
            for key, entry in self.keys.items()
            if entry.argument and key in values
        }

    @contextmanager
    def named(self, keys: Iterable[str]) -> Iterator[None]:
        """Let errors name these keys of the file instead of the parameters that they set."""
        si = (key for key in keys if key == si_key(key))
        by_argument = {self.keys[key].argument: key for key in si if self.keys[key].argument}
        try:
            yield
        except ArgumentValueError as error:
            key = by_argument.get(error.argument, error.argument)
            raise ArgumentValueError(key, error.problem, error.place) from None

    def check_counts(self, values: Mapping[str, Any], joints: int) -> None:
        """Check that lists have as many entries as a driveline of so many joints has parts."""
        counts = {
            "joint": joints,
            "shaft": joints + 1,
            "shaft between two joints": joints - 1,
            "point": joints + 2,
        }
        for key, value in values.items():
            if key in self.keys and (per := self.keys[key].per):
                check_count(key, value, counts[per], f"one per {per}")


def made_of(section: Section[Any], attribute: str = "") -> Any:  # noqa: ANN401 - as declared there
    """Declare a field of a scene: what is made of a section, or an attribute of that."""
    return field(metadata={"section": section, "attribute": attribute})


def check_count(
    key: str, value: object, wanted: int, why: str, place: tuple[int, ...] = ()
) -> None:
    """Refuse a list that has not as many entries as wanted."""
    if isinstance(value, list) and len(value) != wanted:
        raise ArgumentValueError(key, f"has length {len(value)}; it needs {wanted}, {why}", place)


def check_exists(key: str, number: int, count: int, place: tuple[int, ...] = ()) -> None:
    """Refuse the number of a part that does not exist."""
    if number >= count:
        raise ArgumentValueError(key, f"is {number}; there are {count}, counted from 0", place)


def _times(value: Any, factor: float) -> Any:  # noqa: ANN401 - a number, numbers or a name
    # Recorded values are long, and in SI units.
    if factor == 1.0:
        return value
    return factor * value if isinstance(value, float) else np.multiply(value, factor)
