"""The key figures of a scene as text beside its pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

from cardan.figures.summary import Row
from cardan.words.summary import summary_lines

# Values of as many shafts or joints share a line.
_MANY = 4


def key_figures(rows: Sequence[Row], most: int) -> list[tuple[str, str]]:
    """Return label and value of each line of the table, at most so many.

    Of a quantity of many shafts or joints the least and the largest stay. Where there are too many
    lines, only the largest of each quantity stays; what is still too much is left out from the
    end, and a last line says so.
    """
    lines = summary_lines(_ends(rows))
    if len(lines) > most:
        lines = summary_lines(_largest(rows))
    if len(lines) > most:
        lines = [*lines[: most - 1], (f"and {len(lines) - most + 1} more", "")]
    return [(label, text.replace("-", "\N{MINUS SIGN}")) for label, text in lines]


def _ends(rows: Iterable[Row]) -> Iterable[Row]:
    for _, group in groupby(rows, key=_about):
        found = list(group)
        if found[0].statistic == "value" and len(found) > _MANY:
            ends = {found.index(pick(found, key=_value)) for pick in (min, max)}
            found = [found[i] for i in sorted(ends)]
        yield from found


def _largest(rows: Iterable[Row]) -> Iterable[Row]:
    for _, group in groupby(rows, key=_about):
        yield max(group, key=lambda row: abs(row.value))


def _about(row: Row) -> tuple[str, str]:
    return row.quantity, row.statistic


def _value(row: Row) -> float:
    return row.value
