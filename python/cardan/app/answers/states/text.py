"""The states of a scene in words: the figures of each, and the verdict on each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cardan.app.answers.printed import aligned, settled, table_text
from cardan.app.answers.rounding import alike
from cardan.app.answers.states.figures import StatesFigures

OF_DRIVELINE = "Angles, motion and loads above are those of [driveline]; the states follow."
"""What the answer of a run says between the two."""

_WIDTH = 79


def states_text(found: StatesFigures) -> str:
    """Return the figures of every state as tables of plain text, at most 79 wide, and the worst."""
    columns = [[key.key, *(f"{value:.6g}" for value in key.values)] for key in found.keys]
    columns += [[each.column, *map(each.text, each.values)] for each in found.figures]
    names = ["States", *(f"  {name}" for name in found.names)]
    parts = [table_text([*zip(names, *group, strict=True)]) for group in _groups(names, columns)]
    if worst := list(worst_lines(found)):
        parts.append(f"Largest over the states\n{aligned(worst, indent='  ')}")
    return "\n\n".join(parts)


def worst_lines(found: StatesFigures) -> Iterator[tuple[str, str]]:
    """Yield figures of which less is better: what each is, its largest value, and the state."""
    for each in found.figures:
        value = settled(each.largest.value, each.unit)
        varies = not alike(each.least.value, value)
        if each.source.less_is_better and math.isfinite(value) and varies:
            yield each.column, f"{each.text(value)} in {each.largest.state}"


def _groups(names: Sequence[str], columns: Sequence[list[str]]) -> Iterator[list[list[str]]]:
    """Columns that fit beside the names, group by group."""

    def width(column: Sequence[str]) -> int:
        return max(map(len, column)) + 2

    group: list[list[str]] = []
    left = _WIDTH - width(names)
    for column in columns:
        if group and width(column) > left:
            yield group
            group, left = [], _WIDTH - width(names)
        group.append(column)
        left -= width(column)
    yield group
