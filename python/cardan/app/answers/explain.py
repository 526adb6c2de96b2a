"""Explanation of figures: one of a scene with its inputs, or all that an answer can have."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from cardan.app.answers.answer import Answer
from cardan.app.answers.identification import Identified
from cardan.app.answers.printed import aligned, bound_of, cell
from cardan.app.answers.rows import UNITS, Entry, Judged, Row, element_of, rows_of
from cardan.app.answers.table import PARTS, Part
from cardan.app.scene.scene import Scene
from cardan.arrays.errors import ArgumentValueError
from cardan.design.limits import CATALOGUE

# More values of a list are counted.
_MOST = 6


def explain_text(answer: Answer, key: str, path: Path) -> str:
    """Return what a figure of a scene is, from what it follows, and what limits it, 79 wide.

    The key is that of the figure, ``"spline.travel"`` or ``"tubes.1.stress"``; the path is that of
    the scene file.

    Raises:
        ValueError: the answer has no such figure.
    """
    part, entry = _entry_of(answer, key)
    row, value = entry.row, entry.value
    name = " of ".join(filter(None, (row.label, part.noun, entry.item)))
    bare = replace(value, limit=None) if isinstance(value, Judged) else value
    lines = [("value", cell(bare, row) or "not known")]
    lines += [("meaning", row.meaning)] if row.meaning else []
    lines += [("formula, source", row.source)] if row.source else []
    limit, worst = row.limit, value.state if isinstance(value, Judged) else ""
    if isinstance(value, Judged) and value.source == CATALOGUE.source:
        limit = f"the default of driveshaft catalogues; {limit} is not given"
    lines += [("limit from", limit)] if limit else []
    if isinstance(value, Judged) and row.limit:
        judged = f"{value.verdict}: {value.why}" if value.why else value.verdict
        lines += [("limit", f"{bound_of(value, row)} ({value.source})")] if value.limit else []
        lines.append(("verdict", judged))
    in_state = dict(_in_state(answer, worst))
    inputs = list(_inputs(part, path, in_state))
    text = f"{name[0].upper()}{name[1:]}\n{aligned(lines, indent='  ')}"
    heading = f'Inputs in the state "{worst}"' if in_state else "Inputs"
    return f"{text}\n\n{heading}\n{aligned(inputs, indent='  ')}" if inputs else text


def _entry_of(answer: Answer, key: str) -> tuple[Part, Entry]:
    known, near, asked = [], [], key.replace("_", " ")
    for name, part in PARTS.items():
        found = answer[name]
        for entry in part.entries(found) if found else ():
            if entry.path == key:
                return part, entry
            known.append(entry.path)
            limit = entry.row.limit.rpartition(" ")[2]
            names = f"{entry.path} {name}.{entry.row.label} {name}.{limit}"
            near += [entry.path] if asked in names.replace("_", " ") else []
    close = near[:4] or difflib.get_close_matches(key, dict.fromkeys(known), n=4)
    if close:
        raise ArgumentValueError("key", f"is {key!r}; did you mean {' or '.join(close)}?")
    parts = dict.fromkeys(path.partition(".")[0] for path in known)
    problem = f"is {key!r}; the keys of this answer begin with {', '.join(parts)}"
    raise ArgumentValueError("key", problem)


def _in_state(answer: Answer, name: str) -> Iterator[tuple[str, str]]:
    """The keys that the states set, with their values in one of them."""
    states = answer.scene.states if isinstance(answer.of, Scene) else None
    if states and name in states.names:
        place = states.names.index(name)
        for axis in states.axes:
            yield axis.key, f"{axis.values[place]:.10g}"


def _inputs(part: Part, path: Path, in_state: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The keys of the driveline and of the part's sections, with their values, in a state those."""
    given = tomllib.loads(path.read_text(encoding="utf-8"))
    for section in dict.fromkeys(("driveline", *part.sections)):
        for key, value in given.get(section, {}).items():
            if key not in in_state:
                is_long = isinstance(value, list) and len(value) > _MOST
                yield f"[{section}] {key}", f"{len(value)} values" if is_long else str(value)
    for key, text in in_state.items():
        yield f"[states] {key}", text


def reference() -> str:
    """Return all figures of all parts as a page of Markdown, a table for each part."""
    text = [
        "# Figures of an answer\n\n"
        "Each part of an answer has the figures of its table. A key is that of the answer in JSON "
        "and of `cardan explain SCENE KEY`; where a part has several shafts, joints, bearings or "
        "states, the number or name of the item follows the name of the part.\n"
    ]
    for part in PARTS.values():
        shown = ", ".join(f"`{command}`" for command in part.shown or ("check",))
        sections = " and ".join(f"`[{section}]`" for section in part.sections)
        text.append(f"\n## {part.title}\n\nShown by {shown}; from {sections or '`[driveline]`'}.\n")
        text += _table(part.figures(), f"{part.name}.")
    text.append(
        "\n## Recorded angles\n\nShown by `identify` alone, from a recording; the keys are those "
        "of its answer in JSON.\n"
    )
    text += _table(Identified, "")
    return "".join(text)


def _table(of: type, path: str) -> Iterator[str]:
    """The rows of a dataclass, then a table for each of its parts; keys begin with the path."""
    yield "\n| figure | key | unit | what it is | limit |\n|---|---|---|---|---|\n"
    further = []
    for name, row, hint in rows_of(of):
        if row.kind == "parts":
            further.append((row, element_of(hint), f"{path}{name}."))
        else:
            yield _line(row, f"{path}{name}")
    for row, inner, inside in further:
        meaning = f": {row.meaning}" if row.meaning else ""
        yield f"\n{row.label}{meaning}.\n"
        yield from _table(inner, inside)


def _line(row: Row, key: str) -> str:
    meaning = "; ".join(filter(None, (row.meaning, row.source))).replace("|", "\\|")
    unit = UNITS[row.unit].symbol or ("1" if row.kind == "figure" else "")
    limit = f"`{row.limit}`" if row.limit else ""
    return f"| {row.label} | `{key}` | {unit} | {meaning} | {limit} |\n"
