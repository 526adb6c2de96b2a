"""The states of a scene in words: the figures of each, and the verdict on each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from cardan.app.answers.names import key_name
from cardan.app.answers.printed import aligned, figure_text
from cardan.app.answers.rounding import alike
from cardan.app.answers.states.figures import state_name
from cardan.app.answers.study.extremes import Extremes, extremes
from cardan.app.scene.study.states import StatesResult

OF_DRIVELINE = "Angles, motion and loads above are those of [driveline]; the states follow."
"""What the answer of a run says between the two."""

_WIDTH = 79


def states_text(table: StatesResult, *, radians: bool = False) -> str:
    """Return the figures of every state as tables of plain text, at most 79 wide, and the worst."""
    found = list(extremes(table, radians=radians))
    columns = [(axis.key, [f"{value:.6g}" for value in axis.values]) for axis in table.states.axes]
    columns += [
        (each.name, [figure_text(_settled(each.name, float(value))) for value in values])
        for each, values in zip(found, _values(table, found, radians), strict=True)
    ]
    names = ("States", [f"  {name}" for name in table.states.names])
    parts = ["\n".join(_aligned([names, *group])) for group in _groups(names, columns)]
    if worst := list(worst_lines(table, radians=radians)):
        parts.append(f"Largest over the states\n{aligned(worst, indent='  ')}")
    return "\n\n".join(parts)


def worst_lines(table: StatesResult, *, radians: bool = False) -> Iterator[tuple[str, str]]:
    """Yield figures of which less is better: what each is, its largest value, and the state."""
    for each in extremes(table, radians=radians):
        value = each.largest.value
        value = _settled(each.name, value)
        if each.less_is_better and math.isfinite(value) and not alike(each.least.value, value):
            yield each.name, f"{figure_text(value)} in {state_name(table, each.largest)}"


def _settled(name: str, value: float) -> float:
    """An angle, or 0 where it is the rounding of bends that cancel each other."""
    rounding = {"_deg": 1e-6, "_rad": 1e-8}.get(name[-4:], 0.0)
    return 0.0 if abs(value) < rounding else value


def key_names(table: StatesResult) -> list[str]:
    """Return what varies from state to state, in words."""
    return [key_name(axis.key) for axis in table.states.axes]


def _values(table: StatesResult, found: Sequence[Extremes], radians: bool) -> Iterator[Any]:
    for each in found:
        yield np.asarray(table.figure(each.column, radians=radians)[1])


_Column = tuple[str, list[str]]


def _width(column: _Column) -> int:
    return max(len(column[0]), *map(len, column[1])) + 2


def _groups(names: _Column, columns: Sequence[_Column]) -> Iterator[list[_Column]]:
    """Columns that fit beside the names, group by group."""
    group: list[_Column] = []
    left = _WIDTH - _width(names)
    for column in columns:
        if group and _width(column) > left:
            yield group
            group, left = [], _WIDTH - _width(names)
        group.append(column)
        left -= _width(column)
    yield group


def _aligned(columns: Sequence[_Column]) -> Iterator[str]:
    first, *others = columns
    for row in zip((first[0], *first[1]), *((head, *cells) for head, cells in others), strict=True):
        cells = (cell.rjust(_width(of)) for cell, of in zip(row[1:], others, strict=True))
        yield (row[0].ljust(_width(first) - 2) + "".join(cells)).rstrip()
