"""Other values in the text of a scene file, all else as it stands: comments, order, spaces."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

# What stands between values: spaces, line ends, comments, commas.
_BETWEEN = re.compile(r"(?:[\s,]|#[^\n]*)*")
_SPACES = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[ \t]*(?:"([^"\n]*)"|'([^'\n]*)'|([\w-]+))[ \t]*""")
_HEADER = re.compile(r"\[(\[?)([^\[\]\n]+)\]\]?[ \t]*(#[^\n]*)?(?=\n|$)")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL
)
_SCALAR = re.compile(r"[^\s,\]}#]+(?: \d\d:[\d:.Z+-]+)?")


@dataclass(frozen=True)
class Span:
    """Begin and end of a value in a text, and the entries of an array."""

    start: int
    end: int
    items: tuple[Span, ...] = ()


@dataclass
class Map:
    """Places of values by dotted path, section first, and ends of sections with a heading.

    Of repeated sections the path has their number: ``"bearing.0.position_mm"``. ``wholes`` are keys
    with their values.
    """

    values: dict[str, Span] = field(default_factory=dict)
    ends: dict[str, int] = field(default_factory=dict)
    wholes: dict[str, Span] = field(default_factory=dict)


def map_of(text: str) -> Map:
    """Return where the values of a TOML text stand; the text must be valid."""
    found, section, at = Map(), "", _SPACES.match(text).end()  # type: ignore[union-attr]
    tables: Counter[str] = Counter()
    while at < len(text):
        if header := _HEADER.match(text, at):
            section, at = ".".join(_parts(header[2])), header.end()
            if header[1]:
                tables[section] += 1
                section = f"{section}.{tables[section] - 1}"
            else:
                found.ends[section] = at
        else:
            start = at
            names, at = _key(text, at)
            path = ".".join([section, *names] if section else names)
            at = _value(text, at, path, found.values)
            found.wholes[path] = Span(start, at)
            if section in found.ends:
                found.ends[section] = _line_end(text, at)
        at = _SPACES.match(text, at).end()  # type: ignore[union-attr]
    return found


def with_values(text: str, values: Mapping[str, Any]) -> str:
    """Return the text of a valid scene with other numbers, or lists of the same shape, by path.

    For a key that its section does not have, a line is added. Of values that the text gives as
    evenly spread, both ends are set. A place that cannot be changed is refused.
    """
    known = map_of(text)
    edits: list[tuple[int, int, str]] = []
    values = _by_ends(values, known)
    for path, value in values.items():
        if path in known.values:
            edits += _edits(text, known.values[path], value, path)
            continue
        section, _, key = path.partition(".")
        if section not in known.ends:
            raise ValueError(f"cannot set {path} in the text; write [{section}] as a section")
        end = known.ends[section]
        edits.append((end, end, f"\n{key} = {_written(value)}"))
    for start, end, written in sorted(edits, reverse=True):
        text = text[:start] + written + text[end:]
    _check(text, values)
    return text


def _by_ends(values: Mapping[str, Any], known: Map) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for path, value in values.items():
        if f"{path}.from" in known.values:
            found |= {f"{path}.from": value[0], f"{path}.to": value[-1]}
        else:
            found[path] = value
    return found


def _edits(text: str, span: Span, value: Any, path: str) -> Iterator[tuple[int, int, str]]:  # noqa: ANN401
    if isinstance(value, Sequence):
        if not span.items and len(value) == 1:
            value = value[0]
        elif len(span.items) != len(value):
            raise ValueError(f"cannot set {path} in the text; write it as a list")
        else:
            for item, entry in zip(span.items, value, strict=True):
                yield from _edits(text, item, entry, path)
            return
    if tomllib.loads(f"value = {text[span.start : span.end]}")["value"] != value:
        yield span.start, span.end, _written(value)


def _written(value: Any) -> str:  # noqa: ANN401 - a number or a list
    if isinstance(value, Sequence):
        return f"[{', '.join(map(_written, value))}]"
    # What adding left of rounding errors is no digit of a drawing.
    return f"{round(value, 9) + 0.0:.15g}"


def _check(text: str, values: Mapping[str, Any]) -> None:
    """Make sure that TOML reads these values."""
    document = tomllib.loads(text)
    for path, value in values.items():
        read: Any = document
        rest = path
        while rest:
            if isinstance(read, list):
                key, _, rest = rest.partition(".")
                read = read[int(key)]
                continue
            # Keys in quotes may contain dots.
            key = next(key for key in read if rest == key or rest.startswith(f"{key}."))
            read, rest = read[key], rest[len(key) + 1 :]
        if isinstance(value, Sequence) and not isinstance(read, list):
            read = [read]
        if _written(read) != _written(value):
            raise ValueError(f"cannot set {path} in the text; write [{path.split('.')[0]}] simply")


def _parts(dotted: str) -> list[str]:
    return [next(filter(None, found.groups()), "") for found in _KEY.finditer(dotted)]


def _key(text: str, at: int) -> tuple[list[str], int]:
    """The parts of a key, and behind its equals sign."""
    parts: list[str] = []
    while True:
        found = _KEY.match(text, at)
        assert found
        parts.append(next(part for part in found.groups() if part is not None))
        at = found.end() + 1
        if text[found.end()] == "=":
            return parts, at


def _value(text: str, at: int, path: str, into: dict[str, Span]) -> int:
    """Note where the value stands that begins at or behind a place; return its end."""
    at = _SPACES.match(text, at).end()  # type: ignore[union-attr]
    if text[at] == "{":
        at = _BETWEEN.match(text, at + 1).end()  # type: ignore[union-attr]
        while text[at] != "}":
            names, at = _key(text, at)
            at = _value(text, at, ".".join([path, *names]), into)
            at = _BETWEEN.match(text, at).end()  # type: ignore[union-attr]
        return at + 1
    span = _span(text, at)
    into[path] = span
    return span.end


def _span(text: str, at: int) -> Span:
    if text[at] == "[":
        items, start = [], at
        at = _BETWEEN.match(text, at + 1).end()  # type: ignore[union-attr]
        while text[at] != "]":
            items.append(_span(text, at))
            at = _BETWEEN.match(text, items[-1].end).end()  # type: ignore[union-attr]
        return Span(start, at + 1, tuple(items))
    if text[at] == "{":
        inner: dict[str, Span] = {}
        return Span(at, _value(text, at, "", inner))
    found = _STRING.match(text, at) or _SCALAR.match(text, at)
    assert found
    return Span(at, found.end())


def _line_end(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end < 0 else end
