"""Numbers, lists and rows of answers as people read them: the only place that formats a number."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from cardan.app.answers.rows import UNITS, Judged, Row, item_of, rows_of
from cardan.design.wrapping import fill

_WIDTH = 79

# What is less than this, in the unit in which it is shown, is rounding.
_FINEST = {"deg": 1e-6, "mm": 1e-6, "rad_s2": 1e-9}


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
        lines.append("  ".join((label.ljust(widths[0]), *right)).rstrip())
    return "\n".join(lines)


# --- rows ----------------------------------------------------------------------------------------


def quantity(value: float, unit: str, *, radians: bool = False) -> str:
    """Return a value in SI with its unit, a key of ``UNITS``: ``"41.30 MPa"``, ``"2.712°"``."""
    symbol, factor = UNITS[unit]
    if radians and unit == "deg":
        symbol, factor = "rad", 1.0
    shown = factor * value
    if abs(shown) < _FINEST.get(unit, 0.0):
        shown = 0.0
    return f"{figure_text(shown)}{'' if symbol in ('°', '%', '') else ' '}{symbol}"


def place_of(value: Judged) -> str:
    """Say where a figure is worst: ``" in rebound"``, ``" at bends_deg = 5"`` or ``""``."""
    if value.state:
        return f" in {value.state}"
    keys = ", ".join(f"{key} = {place:.6g}" for key, place in value.at.items())
    return f" at {keys}" if keys else ""


def bound_of(value: Judged, row: Row, *, radians: bool = False) -> str:
    """Say the limit: ``"at most 80.00 MPa"``; "" without one."""
    if value.limit is None:
        return ""
    return f"at {value.sense} {quantity(value.limit, row.unit, radians=radians)}"


def cell(value: Any, row: Row, *, radians: bool = False) -> str:  # noqa: ANN401 - of any field
    """Return the value of a field, where it is worst and its limit; "" of what is not known."""
    if isinstance(value, Judged):
        if value.value is None:
            return ""
        text = quantity(value.value, row.unit, radians=radians) + place_of(value)
        return "; ".join(filter(None, (text, bound_of(value, row, radians=radians))))
    if value is None:
        return ""
    if row.kind == "figure":
        return quantity(value, row.unit, radians=radians)
    if row.kind == "flag":
        return "yes" if value else "no"
    return str(value)


def lines_of(found: Any, *, radians: bool = False) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Yield label and value of what is known of a part, one line each; not those of its parts."""
    for name, row, _ in rows_of(type(found)):
        if row.kind not in ("parts", "item"):
            text = cell(getattr(found, name), row, radians=radians)
            if text:
                yield row.label, text


def table_of(
    found: Sequence[Any], *, radians: bool = False
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return figures of several items: a head with the items, and a row for each figure known.

    A limit that is the same for all is named beside the label; where a figure is worst has a row of
    its own.
    """
    head = ("", *map(item_of, found))
    rows: list[tuple[str, ...]] = []
    for name, row, _ in rows_of(type(found[0])):
        values = [getattr(each, name) for each in found]
        if row.kind == "parts" and all(isinstance(value, tuple) for value in values):
            # Columns of figures of the same items, a row each.
            for column in zip(*values, strict=False):
                _, more = table_of(column, radians=radians)
                rows += [(f"{label} of {item_of(column[0])}", *cells) for label, *cells in more]
        if row.kind in ("parts", "item") or all(value is None for value in values):
            continue
        judged = [value for value in values if isinstance(value, Judged)]
        bounds = [bound_of(value, row, radians=radians) for value in judged]
        shared = bounds[0] if bounds and len(set(bounds)) == 1 else ""
        plain = [value.value if isinstance(value, Judged) else value for value in values]
        cells = [cell(value, row, radians=radians) for value in plain]
        if not any(cells):
            continue
        rows.append((", ".join(filter(None, (row.label, shared))), *cells))
        if any(bounds) and not shared:
            rows.append(("  limit", *bounds))
        places = [place_of(value).strip() for value in judged]
        if any(places):
            rows.append(("  worst", *places))
    return head, rows


def part_text(
    heading: str,
    found: Any,  # noqa: ANN401 - any part
    sentences: Iterable[str],
    *,
    radians: bool = False,
) -> str:
    """Return a part as plain text: heading, figures, tables of its items, sentences."""
    blocks = [heading]
    if isinstance(found, tuple):
        blocks.append(_several(found, radians))
    else:
        if lines := list(lines_of(found, radians=radians)):
            blocks.append(aligned(lines, indent="  "))
        for name, row, _ in rows_of(type(found)):
            value = getattr(found, name)
            if row.kind == "parts" and value:
                several = value if isinstance(value, tuple) else (value,)
                blocks.append(f"  {row.label}\n{_several(several, radians)}")
    words = [fill(text, _WIDTH, break_on_hyphens=False) for text in sentences]
    text = "\n".join(blocks)
    return "\n".join([text, "", *words]) if words else text


def _several(found: Sequence[Any], radians: bool) -> str:
    """A column for each item, as many beside each other as fit."""
    texts, left = [], list(found)
    while left:
        shown = len(left)
        while True:
            head, rows = table_of(left[:shown], radians=radians)
            text = table_text([(f"  {label}", *cells) for label, *cells in (head, *rows)])
            if shown == 1 or max(map(len, text.splitlines())) <= _WIDTH:
                break
            shown -= 1
        texts.append(text)
        left = left[shown:]
    return "\n".join(texts)


# --- numbers -------------------------------------------------------------------------------------


def angle_text(value: float, radians: bool) -> str:
    """Write a drive angle in the unit asked for."""
    # What rounds to zero has no sign.
    return f"{round(value, 4) + 0.0:.4f} rad" if radians else f"{round(value, 2) + 0.0:.2f}°"


def aligned(lines: Iterable[tuple[str, str]], width: int = 0, indent: str = "") -> str:
    """Return pairs of a label and a text as two columns, filled to 79 characters."""
    lines = list(lines)
    width = width or max(len(label) for label, _ in lines) + len(indent) + 2
    return "\n".join(_filled(lines, width, indent))


def _filled(lines: Iterable[tuple[str, str]], width: int, indent: str) -> Iterator[str]:
    for label, text in lines:
        yield fill(
            text,
            width=79,
            initial_indent=f"{indent + label:{width}}",
            subsequent_indent=" " * width,
            break_long_words=False,
            break_on_hyphens=False,
        )


def range_ends(low: float, high: float) -> tuple[str, str]:
    """Write both ends of a range with enough decimals for three digits of the difference."""
    decimals = 2 - math.floor(math.log10(min(high - low, sys.float_info.max)))
    if decimals > 9 or high - low >= 1e7:
        return figure_text(low), figure_text(high)
    return f"{low:.{max(0, decimals)}f}", f"{high:.{max(0, decimals)}f}"


def figure_text(value: float) -> str:
    """Four significant digits, without an exponent where that is readable."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value + 0.0:g}"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 < exponent < 7:
        return f"{value:.3e}"
    return f"{value:.{max(0, 3 - exponent)}f}"
