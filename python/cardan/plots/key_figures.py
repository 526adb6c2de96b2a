"""The key figures of a scene as text beside its pictures."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from cardan.figures.summary import Row
from cardan.plots.style import number

_MANY = 4


def key_figures(rows: Sequence[Row], most: int) -> list[tuple[str, str]]:
    """Return label and value of each row, at most so many.

    Where that is too many, of rows that differ in their shaft or joint alone only the one with the
    largest value stays; what is still too much is left out from the end, and a last line says so.
    """
    if len(rows) > most:
        rows = list(_largest(rows))
    lines = [(row.label, _value(row)) for row in rows]
    if len(lines) > most:
        lines = [*lines[: most - 1], (f"and {len(lines) - most + 1} more", "")]
    return lines


def _largest(rows: Sequence[Row]) -> Iterable[Row]:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(re.sub(r", (shaft|joint) \d+\b", "", row.label), []).append(row)
    for group in groups.values():
        yield max(group, key=lambda row: max(map(abs, row.values), default=0.0))


def _value(row: Row) -> str:
    values, count = row.values, ""
    if row.is_range:
        text = _range(values[0], values[-1])
    elif len(values) > _MANY:
        text, count = _range(min(values), max(values)), f" ({len(values)} values)"
    else:
        text = ", ".join(map(_short, values))
    text += "°" if row.unit == "deg" else row.unit and f" {row.unit}"
    text += count
    return text if row.at_deg is None else f"{text} at {_short(row.at_deg)}°"


def _range(low: float, high: float) -> str:
    """A range, with decimals enough for three digits of the difference."""
    decimals = 2 - math.floor(math.log10(high - low)) if 0.0 < high - low < math.inf else 99
    if decimals > 9:
        return _short(low)
    text = f"{low:.{max(0, decimals)}f} to {high:.{max(0, decimals)}f}"
    return text.replace("-", "\N{MINUS SIGN}")


def _short(value: float) -> str:
    return number(float(f"{value:.4g}") + 0.0)
