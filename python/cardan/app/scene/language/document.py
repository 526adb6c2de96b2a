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

from cardan.app.scene.language.errors import Location, SceneError, path_of
from cardan.app.scene.language.paths import nested
from cardan.app.scene.language.rules import shown
from cardan.app.scene.language.section import Section
from cardan.app.scene.language.units import units_of
from cardan.app.scene.sections.table import FORMAT
from cardan.arrays.errors import ArgumentValueError, nearest


class Document:
    """A scene file being read: its sections, and the first or all of what is wrong with them.

    Attributes:
        name: what to call it in messages.
        sections: values by section and key, each of the right kind.
        tables: the same of each table of the sections that may be given repeatedly.
        problems: what is wrong, one line each, if they are being gathered.
    """

    def __init__(self, text: str, name: str, *, gather: bool = False) -> None:
        """Read the text; raises ValueError at the first problem unless they are gathered."""
        self.name = name
        self.sections: dict[str, dict[str, Any]] = {}
        self.tables: dict[str, list[dict[str, Any]]] = {}
        self.problems: list[str] = []
        self._text = text
        self._gather = gather
        self._document: dict[str, Any] = {}
        with self.within(""):
            self._document = _toml(text)
        if not self.problems:
            self._read()

    def _read(self) -> None:
        top, *sections = FORMAT
        known = [*FORMAT[top].keys, *sections]
        for name, value in self._document.items():
            with self.within("", name):
                if name in sections:
                    if not _is_given_as(FORMAT[name], value):
                        what = "sections" if FORMAT[name].repeated else "a section"
                        problem = f"is {shown(value)}; it must be {what} "
                        raise ArgumentValueError(name, problem + FORMAT[name].heading(name))
                elif name not in FORMAT[top].keys:
                    what = "section" if isinstance(value, dict) else "key"
                    raise ValueError(f"unknown {what} {shown(name)}; {_meant(name, known)}")
        entries = self._document.items()
        given = {top: {key: value for key, value in entries if key in FORMAT[top].keys}}
        given |= {
            name: part for name, part in entries if name in sections and isinstance(part, dict)
        }
        for name, values in given.items():
            if not FORMAT[name].repeated:
                self.sections[name] = self._checked(name, FORMAT[name], values)
        for name, tables in entries:
            if name in sections and FORMAT[name].repeated and _is_given_as(FORMAT[name], tables):
                self.tables[name] = [
                    self._checked(f"{name}.{i}", FORMAT[name], values)
                    for i, values in enumerate(tables)
                ]

    def _checked(self, name: str, section: Section, values: Mapping[str, Any]) -> dict[str, Any]:
        checked = {}
        if section.paths:
            with self.within(name):
                values = nested(values)
        for key, value in values.items():
            with self.within(name, key):
                if key not in section.keys:
                    hint = _meant(key, section.keys, studied=name == "study")
                    if name == "study" and key.partition(".")[0] in section.keys:
                        hint = "write it without quotes"
                    raise ValueError(f"unknown key {shown(key)}; {hint}")
                checked[key] = section.keys[key].kind.rule.read(Location(key), value)
        for one, other in section.together:
            with self.within(name):
                if one in values and other in values:
                    raise ArgumentValueError(one, f"and {other} are both given; give one of them")
        for keys in section.needed:
            with self.within(name):
                if not set(keys) & set(values):
                    *others, last = keys[1:] or ("",)
                    choice = f"{', '.join(others)} or {last}" if others else last
                    problem = f"is missing; or give {choice}" if choice else "is missing"
                    raise ArgumentValueError(keys[0], problem)
        for key, other in section.with_key:
            with self.within(name):
                if key in values and other not in values:
                    raise ArgumentValueError(key, f"needs {other}, which is missing")
        with self.within(name):
            if len(values) < section.fewest:
                raise ValueError("is empty; give at least one key")
        return checked

    @contextmanager
    def within(self, section: str, key: str = "") -> Iterator[None]:
        """Put file, line and section in front of what is wrong there, and raise or gather it.

        Args:
            section: where; of an array of tables with the number of the table: ``"bearing.2"``;
                ``""`` for the file itself.
            key: what errors without fields are about, if that is one key.
        """
        try:
            yield
        except ValueError as error:
            line = self._line(section, path_of(error, key))
            placed = SceneError.of(error, self.name, section, line, key)
            if not self._gather:
                raise placed from None
            self.problems.append(str(placed))

    def _line(self, section: str, key: str) -> int | None:
        """The line of a key, or of its section.

        TOML readers keep no line numbers, so the key is looked for in the text; None where no line
        or more than one could be meant.
        """
        # In strings of several lines anything could look like a key.
        if '"""' in self._text or "'''" in self._text:
            return None
        target = f"{section}.{key}" if section else key
        lines = _keys_by_line(self._text)
        ways: tuple[Callable[[str], bool], ...] = (
            lambda path: path == target,
            lambda path: path != section and target.startswith(f"{path}."),
            lambda path: path.startswith(f"{target}."),
            lambda path: path == section,
        )
        for fits in ways:
            found = {number for number, path in lines if fits(path)}
            if found:
                return found.pop() if len(found) == 1 else None
        return None


def read_text(path: str | PathLike[str]) -> str:
    """Return the text of a scene file.

    Raises:
        OSError: it cannot be read.
        ValueError: it is not UTF-8.
    """
    try:
        # Some editors put a byte order mark in front, which TOML does not know.
        with open(path, encoding="utf-8-sig") as file:
            return file.read()
    except UnicodeDecodeError as error:
        raise ValueError(f"{fspath(path)}: not UTF-8 text at byte {error.start}") from None


def _is_given_as(section: Section, value: object) -> bool:
    """Whether a value is a table, or a list of tables if the section may be given repeatedly."""
    if not section.repeated:
        return isinstance(value, dict)
    return isinstance(value, list) and all(isinstance(part, dict) for part in value)


def _keys_by_line(text: str) -> list[tuple[int, str]]:
    """Every line that begins a section or a value, with the dotted path to it.

    The path of a table in an array of tables has its number: ``bearing.2.shaft``.
    """
    found, section = [], ""
    tables: Counter[str] = Counter()
    for number, line in enumerate(text.split("\n"), start=1):
        if header := re.match(r"\s*\[(\[?)\s*([A-Za-z][\w .-]*?)\s*\]\]?\s*(#.*)?$", line):
            section = name = _path(header[2])
            if header[1] and name in FORMAT and FORMAT[name].repeated:
                section = f"{name}.{tables[name]}"
                tables[name] += 1
            found.append((number, section))
        elif entry := re.match(r"""\s*["']?([A-Za-z0-9][\w .-]*?)["']?\s*=""", line):
            found.append((number, _path(f"{section}.{entry[1]}" if section else entry[1])))
    return found


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
)
"""What people write that is not TOML, and what to say of it."""


def _meant(key: str, known: Iterable[str], *, studied: bool = False) -> str:
    known = list(known)
    for name, section in FORMAT.items():
        if name and key in section.keys:
            if studied:
                return "[study] varies numbers of [driveline], [load] and [[bearing]]"
            return f"it belongs in {section.heading(name)}"
    stem, column, _ = key.partition("_column")
    stems = [name.partition("_column")[0] for name in known]
    if column and not difflib.get_close_matches(stem, stems):
        # What columns have in common would bring a column of another quantity near.
        return f"known are {', '.join(known)}"
    return units_of(key, known) or nearest(key, known)
