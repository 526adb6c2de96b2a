"""Numbers and lists as sentences have them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from cardan.app.answers.turn.text import figure_text


def listed(parts: Sequence[str]) -> str:
    """Return ``"a, b and c"``."""
    *others, last = parts or [""]
    return " and ".join(filter(None, (", ".join(others), last)))


def rounded_up(value: float) -> str:
    """Return three digits, not below the value."""
    if value <= 0.0 or not math.isfinite(value):
        return figure_text(value)
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.ceil(value / step * (1.0 - 1e-12)) * step:.3g}"


def short(value: float) -> str:
    """Return four significant digits without zeros at the end."""
    text = figure_text(value)
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def table_text(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as lines: what each is about to the left, its figures in columns to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for label, *figures in rows:
        right = (figure.rjust(width) for figure, width in zip(figures, widths[1:], strict=True))
        lines.append("  ".join((label.ljust(widths[0]), *right)))
    return "\n".join(lines)
