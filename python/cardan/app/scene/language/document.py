"""The text of a scene file as checked sections, and where in the text something is wrong."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike, fspath
from typing import Any

from cardan.app.scene.language.errors import Location, SceneError, as_file_has_it, path_of
from cardan.app.scene.language.rules import FileName, InUnit, shown
from cardan.app.scene.language.section import Section
from cardan.app.scene.language.units import alike, si_key, units_of
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest

_VARIED = {
    "study": "[study] varies numbers of [driveline], [load] and [[bearing]]",
    "states": "[states] varies numbers of [driveline] and [load]",
}
"""Meaning of the keys in sections that vary those of others."""

_LIST_OF_NUMBERS = re.compile(r"\[[-+.,\d \t]*\]")


class Document:
    """A scene file being read: its sections, and the first or all of what is wrong with them.

    Attributes:
        name: what to call it in messages.
        format: what may be in it, by name.
        text: of the file.
        sections: values by section and key, each of the right kind.
        tables: the same of each table of the sections that may be given repeatedly.
        given: by section, each key as the file has it, in US units or not, by that in SI units.
        problems: what is wrong, one line each, if they are being gathered.
    """

    def __init__(
        self, text: str, name: str, sections: Mapping[str, Section[Any]], *, gather: bool = False
    ) -> None:
        """Read the text; raises ValueError at the first problem unless they are gathered.

        Anything but text is a TypeError.
        """
        if not isinstance(text, str):
            raise ArgumentTypeError("text", f"is {shown(text)}; it must be the text of a scene")
        self.name, self.format = name, sections
        self.sections: dict[str, dict[str, Any]] = {}
        self.tables: dict[str, list[dict[str, Any]]] = {}
        self.given: dict[str, dict[str, str]] = {}
        self.problems: list[str] = []
        self.text = text
        self._gather = gather
        every = {**sections, **_inner(sections)}
        self._repeated = {own for own, section in every.items() if section.repeated}
        self._document: dict[str, Any] = {}
        with self.within(""):
            self._document = _toml(text)
        if not self.problems:
            self._read()

    def _read(self) -> None:
        top, found = self.format[""], dict[str, Any]()
        for name, value in self._document.items():
            section = self.format.get(name) if name else None
            with self.within("", name):
                if section:
                    found[name] = _as_given(name, section, value)
                elif name not in top.keys:
                    what = "section" if isinstance(value, dict) else "key"
                    known = [*top.keys, *filter(None, self.format)]
                    raise ValueError(f"unknown {what} {shown(name)}; {self._meant(name, known)}")
        given = {key: value for key, value in self._document.items() if key in top.keys}
        self.sections[""] = self._checked("", top, given)
        for name, value in found.items():
            own: dict[str, Any] = self.tables if self.format[name].repeated else self.sections
            own[name] = self._all_checked(name, self.format[name], value)

    def _all_checked(self, name: str, section: Section[Any], value: Any) -> Any:  # noqa: ANN401
        """The values of a table, or of each of several."""
        if not isinstance(value, list):
            return self._checked(name, section, value)
        return [self._checked(f"{name}.{i}", section, each) for i, each in enumerate(value)]

    def _checked(
        self, name: str, section: Section[Any], values: Mapping[str, Any]
    ) -> dict[str, Any]:
        checked = {}
        given: dict[str, str] = {}
        if section.paths:
            with self.within(name):
                values = nested(values)
        for key, value in values.items():
            with self.within(name, key):
                if own := section.inner.get(key):
                    # One of several may be given alone.
                    alone = own.repeated and isinstance(value, dict)
                    tables = _as_given(key, own, [value] if alone else value)
                    checked[key] = self._all_checked(f"{name}.{key}", own, tables)
                    continue
                if key not in section.keys:
                    known = [*section.keys, *section.inner]
                    hint = section.meant(key, value)
                    hint = hint or self._meant(key, known, _VARIED.get(name, ""))
                    if name == "study" and key.partition(".")[0] in section.keys:
                        hint = "write it without quotes"
                    raise ValueError(f"unknown key {shown(key)}; {hint}")
                rule, si = section.keys[key].rule, si_key(key)
                if si in given:
                    problem = f"and {given[si]} are both given; give one of them"
                    raise ArgumentValueError(key, problem)
                given[si] = key
                checked[si if isinstance(rule, InUnit) else key] = rule.read(Location(key), value)
        for wrong in broken(section, given):
            with self.within(name):
                raise wrong
        self.given[name] = given
        return checked

    def decimal_commas(self) -> tuple[tuple[int, str], ...]:
        """Return line and text of lists in which commas with and without a blank are mixed."""
        return tuple(
            (self.text.count("\n", 0, found.start()) + 1, found[0])
            for found in _LIST_OF_NUMBERS.finditer(self.text)
            if re.search(r"\d,\d", found[0])
            and re.search(r",[ \t]", found[0])
            and "#" not in self.text[: found.start()].rpartition("\n")[2]
        )

    @contextmanager
    def within(self, section: str, key: str = "") -> Iterator[None]:
        """Put file, line and section in front of what is wrong there, and raise or gather it.

        An array of tables has the number of the table, ``"bearing.2"``, and the file itself is
        ``""``. Errors without fields are about the key, if that is one.
        """
        try:
            yield
        except SceneError:
            # It happened in another section, on which this one depends.
            raise
        except ValueError as error:
            given = as_file_has_it(error, section, self.given)
            line = self._line(section, path_of(given, key))
            placed = SceneError(given, self.name, section, line, key)
            if not self._gather:
                raise placed from None
            self.problems.append(str(placed))

    def _line(self, section: str, key: str) -> int | None:
        """The line of a key, or of its section.

        TOML readers keep no line numbers, so the key is looked for in the text; None where no line
        or more than one could be meant.
        """
        # In strings of several lines anything could look like a key.
        if '"""' in self.text or "'''" in self.text:
            return None
        within = f"{section}." if section else ""
        target = f"{within}{key}"
        lines = self._keys_by_line()
        ways: tuple[Callable[[str], bool], ...] = (
            lambda path: path == target,
            lambda path: path.startswith(within) and target.startswith(f"{path}."),
            lambda path: path.startswith(f"{target}."),
            lambda path: path == section,
        )
        for fits in ways:
            found = {number for number, path in lines if fits(path)}
            if found:
                return found.pop() if len(found) == 1 else None
        return None

    def _keys_by_line(self) -> list[tuple[int, str]]:
        """Every line that begins a section or a value, with the dotted path to it.

        The path of a table in an array of tables has its number: ``bearing.2.shaft``.
        """
        found, section = [], ""
        tables: Counter[str] = Counter()
        for number, line in enumerate(self.text.split("\n"), start=1):
            if header := re.match(r"\s*\[(\[?)\s*([A-Za-z][\w .-]*?)\s*\]\]?\s*(#.*)?$", line):
                section = name = _path(header[2])
                if name in self._repeated and (header[1] or "." in name):
                    section = f"{name}.{tables[name]}"
                    tables[name] += 1
                found.append((number, section))
            elif entry := re.match(r"""\s*["']?([A-Za-z0-9][\w .-]*?)["']?\s*=""", line):
                found.append((number, _path(f"{section}.{entry[1]}" if section else entry[1])))
        return found

    def _meant(self, key: str, known: Iterable[str], varied: str = "") -> str:
        for name, section in {**self.format, **_inner(self.format)}.items():
            if name and key in section.keys:
                return varied or f"it belongs in {section.heading}"
        known = alike(key, known)
        stem, column, _ = key.partition("_column")
        stems = [name.partition("_column")[0] for name in known]
        if column and not difflib.get_close_matches(stem, stems):
            # What columns have in common would bring a column of another quantity near.
            return f"known are {', '.join(known)}"
        return units_of(key, known) or nearest(key, known)

    @property
    def files(self) -> dict[str, str]:
        """The files that it reads, by the section that names each."""
        return {
            section: values[key]
            for section, values in self.sections.items()
            for key, entry in self.format[section].keys.items()
            if isinstance(entry.rule, FileName) and entry.rule.folders and key in values
        }


def broken(section: Section[Any], values: Mapping[str, str]) -> Iterator[ValueError]:
    """Yield what is wrong with the choice of keys, which are given as the file has them."""
    for one, other in section.together:
        if one in values and other in values:
            problem = f"and {values[other]} are both given; give one of them"
            yield ArgumentValueError(values[one], problem)
    for first, *others in section.needed:
        if not {first, *others} & values.keys():
            choice = " or ".join(filter(None, (", ".join(others[:-1]), *others[-1:])))
            or_give = f"; or give {choice}" if choice else ""
            yield ArgumentValueError(first, f"is missing{or_give}")
    for key, other in section.with_key:
        if key in values and other not in values:
            yield ArgumentValueError(values[key], f"needs {other}, which is missing")
    if len(values) < section.fewest:
        yield ValueError("is empty; give at least one key")


def read_text(path: str | PathLike[str]) -> str:
    """Return the text of a scene file, which must be UTF-8."""
    try:
        # Some editors put a byte order mark in front, which TOML does not know.
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except UnicodeDecodeError as error:
        raise ValueError(f"{fspath(path)}: not UTF-8 text at byte {error.start}") from None


def _inner(sections: Mapping[str, Section[Any]]) -> dict[str, Section[Any]]:
    """The tables within sections by their names."""
    return {own.name: own for section in sections.values() for own in section.inner.values()}


def _as_given(name: str, section: Section[Any], value: object) -> Any:  # noqa: ANN401
    """Return a value that is a table, or a list of them if the section may be given repeatedly."""
    tables = value if section.repeated and isinstance(value, list) else [value]
    if section.repeated != isinstance(value, list) or not all(isinstance(t, dict) for t in tables):
        what = "sections" if section.repeated else "a section"
        raise ArgumentValueError(name, f"is {shown(value)}; it must be {what} {section.heading}")
    return value


def _path(key: str) -> str:
    return ".".join(part.strip() for part in key.split("."))


def _toml(text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except ValueError as error:
        hints = (hint for pattern, hint in _HINTS if pattern.search(text))
        raise ValueError(f"not TOML: {error}{next(hints, '')}") from None
    except RecursionError:
        raise ValueError("not TOML: nested too deeply") from None


_HINTS = (
    # A path of Windows in double quotes, in which a backslash begins an escape.
    (re.compile(r'"[A-Za-z]:\\[^"\\]'), "; a path with backslashes needs single quotes"),
    # A decimal comma, or a list without its brackets.
    (
        re.compile(r"^[^#\[{\"'\n]*=\s*[-+]?[\d.]+\s*,", re.MULTILINE),
        "; a decimal has a point (8.5), a list has brackets ([8, 5])",
    ),
    (
        re.compile(r"^[^#\"'\n]*[=\[,\s][-+]?\.\d", re.MULTILINE),
        "; a decimal has a digit before its point (0.5)",
    ),
    (re.compile(r"^[^#\"'\n]*[\u2212\u2013]\d", re.MULTILINE), "; the minus of a number is -"),
)
"""Common mistakes in TOML, each with a hint."""


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section with its quoted paths as TOML reads bare ones: tables within tables.

    >>> nested({"points_mm.2.y": [1, 2]})
    {'points_mm': {'2': {'y': [1, 2]}}}
    """
    made: dict[str, Any] = {}
    for path, value in values.items():
        for name in reversed(path.split(".")):
            value = {name: value}
        _merge(made, value, path, "")
    return made


def _merge(made: dict[str, Any], more: Mapping[str, Any], path: str, above: str) -> None:
    for key, value in more.items():
        here = f"{above}.{key}" if above else key
        if isinstance(value, dict):
            inner = made.setdefault(key, {})
            if isinstance(inner, dict):
                _merge(inner, value, path, here)
                continue
        elif key not in made:
            made[key] = value
            continue
        if here.startswith(path):
            raise ArgumentValueError(here, "is given twice, with quotes and without")
        raise ArgumentValueError(path, f"and {here} are both given; give one of them")
