"""The key figures of a scene as text beside its pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from cardan.app.answers.turn.figures import SummaryRow
from cardan.app.answers.turn.text import summary_lines

_MANY = 4


def key_figures(rows: Sequence[SummaryRow], most: int) -> list[tuple[str, str]]:
    """Return label and value of each figure, at most so many lines.

    Of a figure of more than four shafts or joints only the largest stays, and where the lines are
    too many still, of each figure. What is left out from the end then is counted in a last line.
    """
    lines = list(_lines(rows, _MANY))
    if len(lines) > most:
        lines = list(_lines(rows, 1))
    if len(lines) > most:
        lines = [*lines[: most - 1], (f"and {len(lines) - most + 1} more", "")]
    return lines


def _lines(rows: Sequence[SummaryRow], most: int) -> Iterator[tuple[str, str]]:
    for _, group in groupby(rows, key=lambda row: row.quantity):
        found = list(group)
        if len({row.item for row in found}) <= most:
            yield from summary_lines(found)
            continue
        item = max(found, key=lambda row: abs(row.value)).item
        for label, text in summary_lines(row for row in found if row.item == item):
            yield label if label.startswith("largest") else f"largest {label}", text
