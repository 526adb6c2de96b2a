"""Numbers, lists and rows of answers as people read them: the only place that formats a number."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from textwrap import indent
from typing import Any

import numpy as np

from cardan.app.answers.rounding import ROUNDING
from cardan.app.answers.rows import UNITS, Entry, Judged, Row, item_of, rows_of
from cardan.arrays import FloatArray
from cardan.design.wrapping import fill

_WIDTH, _SHORT = 79, 16

# What is less than this, in the unit in which it is shown, is rounding.
_FINEST = {"deg": 1e-6, "rad": 1e-8, "mm": 1e-6, "rad_s2": 1e-9}


def capital(text: str) -> str:
    """Return a text that begins with a capital letter, the rest as it is."""
    return f"{text[:1].upper()}{text[1:]}"


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


def rounded_down(value: float, unit: str, digits: int = 3) -> str:
    """Return so many digits, not above the value, with its unit: ``"16.1°"``."""
    shown, step = UNITS[unit].factor * value, 1.0
    if shown > 0.0:
        step = 10.0 ** (math.floor(math.log10(shown)) + 1 - digits)
    return given(math.floor(shown / step) * step / UNITS[unit].factor, unit)


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
    return _with_unit(value, unit, radians, figure_text)


def given(value: float, unit: str, *, radians: bool = False) -> str:
    """Return a value that someone gave, as ``quantity`` but without zeros at its end: ``"3°"``."""
    return _with_unit(value, unit, radians, short)


def _with_unit(value: float, unit: str, radians: bool, shown: Callable[[float], str]) -> str:
    number = value * (1.0 if radians and unit == "deg" else UNITS[unit].factor)
    if not math.isfinite(number):
        return "not known" if math.isnan(number) else "unlimited"
    return in_unit([shown(settled(number, unit))], unit, radians=radians)


def settled(number: float, unit: str) -> float:
    """Return a number in the unit in which it is shown, or 0 where it is mere rounding."""
    return 0.0 if abs(number) < _FINEST.get(unit, 0.0) else number


def in_unit(
    figures: Sequence[str], unit: str, between: str = ", ", *, radians: bool = False
) -> str:
    """Return figures with the unit in which they are: ``"9.5° to 9.8°"``, ``"3 to 4 N m"``."""
    symbol = "rad" if radians and unit == "deg" else UNITS[unit].symbol
    if symbol in ("°", "%", ""):
        return between.join(f"{figure}{symbol}" for figure in figures)
    return f"{between.join(figures)} {symbol}"


def items_text(per: str, items: Sequence[int]) -> str:
    """Return ``"shaft 1"``, ``"shafts 1 and 3"`` or ``"shafts 1 to 3"``."""
    if len(items) == 1:
        return f"{per} {items[0]}"
    if len(items) > 2 and list(items) == list(range(items[0], items[-1] + 1)):
        return f"{per}s {items[0]} to {items[-1]}"
    return f"{per}s {listed([str(item) for item in items])}"


def symbol_of(unit: str) -> str:
    """Return a unit, a key of ``UNITS``, as axes have it: ``"deg"``, ``"mm"``."""
    return UNITS[unit].symbol.replace("°", "deg")


def with_unit(label: str, unit: str) -> str:
    """Return a label with a unit as axes have it: ``"bend [deg]"``."""
    return f"{label} [{symbol_of(unit)}]" if unit else label


def place_of(value: Judged) -> str:
    """Say where a figure is worst: ``" in rebound"``, ``" at bends_deg = 5"`` or ``""``."""
    if value.state:
        return (
            f" in {value.state}" if value.state[0].isalpha() else f' in the state "{value.state}"'
        )
    return f" at {place_text(value.at)}" if value.at else ""


def place_text(at: Mapping[str, float]) -> str:
    """Say where in a study something is: ``"bends_deg.0 = 14, phases_deg = 0"``."""
    return ", ".join(f"{key} = {value:.6g}" for key, value in at.items())


def bound_of(value: Judged, row: Row, *, radians: bool = False) -> str:
    """Say the limit: ``"at most 80.00 MPa"``; "" without one."""
    if value.limit is None:
        return ""
    text = f"at {value.sense} {given(value.limit, row.unit, radians=radians)}"
    if value.maximum is None:
        return text
    return f"{text}, maximum {given(value.maximum, row.unit, radians=radians)}"


def judged_text(value: Judged, row: Row) -> str:
    """Say a figure, where it is worst, and how it stands to its limit or why it is not judged."""
    if value.value is None:
        return value.why
    figure = f"{quantity(value.value, row.unit)}{place_of(value)}"
    if value.limit is None or value.verdict == "not judged":
        return f"{figure}, not judged: {value.why or 'no limit is given'}"
    if value.verdict == "within":
        return f"{figure}, within the limit of {given(value.limit, row.unit)}"
    bound, limit = "limit", value.limit
    if value.maximum is not None and value.verdict == "beyond":
        bound, limit = "maximum", value.maximum
    side = "above" if value.sense == "most" else "below"
    return (
        f"{figure}, {quantity(value.excess, row.unit)} {side} the {bound} of "
        f"{given(limit, row.unit)}"
    )


def cell(value: Any, row: Row, *, radians: bool = False) -> str:  # noqa: ANN401 - of any field
    """Return the value of a field, where it is worst and its limit; "" of what is not known."""
    if isinstance(value, Judged):
        if value.value is None:
            return ""
        text = quantity(value.value, row.unit, radians=radians) + place_of(value)
        return "; ".join(filter(None, (text, bound_of(value, row, radians=radians))))
    if value is None:
        return ""
    if row.kind == "numbers":
        return ", ".join(quantity(each, row.unit, radians=radians) for each in value)
    if row.kind == "figure":
        return quantity(value, row.unit, radians=radians)
    if row.kind == "flag":
        return "yes" if value else "no"
    return str(value)


def _is_printed(row: Row) -> bool:
    return row.kind not in ("parts", "item") and not row.is_detail


def is_nested(row: Row) -> bool:
    """Return whether a field holds further figures that are printed."""
    return row.kind == "parts" and not row.is_detail


def lines_of(found: Any, *, radians: bool = False) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Yield label and value of what is known of a part, one line each; not those of its parts."""
    for name, row, _ in rows_of(type(found)):
        if _is_printed(row):
            text = cell(getattr(found, name), row.beside(found), radians=radians)
            if text:
                yield row.label, text


def table_of(
    found: Sequence[Any], *, radians: bool = False
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return figures of several items: a head with the items, and a row for each figure known.

    A limit that is the same for all is named beside the label; where a figure is worst has a row of
    its own. Items without a name are rows, and their figures columns.
    """
    head = ("", *map(item_of, found))
    rows: list[tuple[str, ...]] = []
    for name, row, _ in rows_of(type(found[0])):
        values = [getattr(each, name) for each in found]
        if is_nested(row) and all(isinstance(value, tuple) for value in values):
            # Columns of figures of the same items, a row each.
            for column in zip(*values, strict=False):
                _, more = table_of(column, radians=radians)
                rows += [(f"{label} of {item_of(column[0])}", *cells) for label, *cells in more]
        if not _is_printed(row) or all(value is None for value in values):
            continue
        units = [row.beside(each) for each in found]
        cells, bounds, places = [], [], []
        for value, unit in zip(values, units, strict=True):
            is_judged = isinstance(value, Judged)
            cells.append(cell(value.value if is_judged else value, unit, radians=radians))
            bounds.append(bound_of(value, unit, radians=radians) if is_judged else "")
            places.append(place_of(value).strip() if is_judged else "")
        if not any(cells):
            continue
        shared = bounds[0] if len(set(bounds)) == 1 else ""
        rows.append((", ".join(filter(None, (row.label, shared))), *cells))
        rows += [("  limit", *bounds)] if any(bounds) and not shared else []
        rows += [("  worst", *places)] if any(places) else []
    if not any(head):
        head, *rows = zip(*rows, strict=True)
    return head, rows


def wherever_text(entries: Iterable[Entry], *, radians: bool = False) -> str:
    """Return the judged figures in each place where they differ, as tables; "" without any.

    The places are the states, the steps of a duty cycle or the drivelines of a study. If the scene
    limits any figure, the others are left out.
    """
    judged = [each for each in entries if each.row.limit and isinstance(each.value, Judged)]
    judged = [each for each in judged if each.value.limit is not None] or judged
    tables: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    for entry in judged:
        value, row = entry.value, entry.row
        if len(set(value.each.values())) > 1:
            label = ", ".join(filter(None, (row.label, entry.item)))
            cells = (quantity(each, row.unit, radians=radians) for each in value.each.values())
            tables.setdefault(tuple(value.each), []).append((label, *cells))
    blocks: list[str] = []
    for places, rows in tables.items():
        columns = [("", *places), *rows]
        # A name of a state is short; of a study it is that of all keys.
        if len(places) <= len(rows) and max(map(len, places)) <= _SHORT:
            columns = list(zip(*columns, strict=True))
        blocks += _in_blocks(columns)
    return "\n".join(["Where they differ", *blocks]) if blocks else ""


def _in_blocks(columns: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """A table of a first column and others, as many side by side as are 79 wide."""
    first, *others = columns
    while others:
        count = next((n for n in range(len(others), 1, -1) if _is_narrow(first, others[:n])), 1)
        yield indent(table_text([*zip(first, *others[:count], strict=True)]), "  ")
        others = others[count:]


def _is_narrow(first: Sequence[str], others: Sequence[Sequence[str]]) -> bool:
    text = table_text([*zip(first, *others, strict=True)])
    return max(map(len, text.splitlines())) <= _WIDTH - 2


def part_text(
    heading: str,
    found: Any,  # noqa: ANN401 - any part
    sentences: Iterable[str],
    *,
    radians: bool = False,
) -> str:
    """Return a part as plain text: heading, figures, tables of its items, sentences."""
    text, words = "\n".join([heading, *_blocks(found, radians)]), filled(sentences)
    return "\n".join([text, "", *words]) if words else text


def filled(sentences: Iterable[str]) -> list[str]:
    """Return sentences 79 wide."""
    return [fill(text, _WIDTH, break_on_hyphens=False) for text in sentences]


def _blocks(found: Any, radians: bool) -> Iterator[str]:  # noqa: ANN401 - any part
    """The figures of a part and those of its parts below their headings."""
    if isinstance(found, tuple):
        yield _several(found, radians)
        return
    if lines := [*lines_of(found, radians=radians)]:
        yield aligned(lines, indent="  ")
    for name, row, _ in rows_of(type(found)):
        if is_nested(row) and (value := getattr(found, name)):
            yield f"  {row.label}"
            yield from (indent(text, "  ") for text in _blocks(value, radians))


def _several(found: Sequence[Any], radians: bool) -> str:
    """A row for each item if these are more than the figures and fit, else a column for each."""
    head, rows = table_of(found, radians=radians)
    whole = [(f"  {label}", *cells) for label, *cells in (head, *rows)]
    turned = [(f"  {label}", *cells) for label, *cells in zip(head, *rows, strict=True)]
    for table in (turned, whole) if len(found) > len(rows) else (whole, turned):
        text = table_text(table)
        if max(map(len, text.splitlines())) <= _WIDTH - 2:
            return text
    half = len(found) // 2
    if not half:
        return table_text(whole)
    return f"{_several(found[:half], radians)}\n{_several(found[half:], radians)}"


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


def curves_text(curves: Sequence[tuple[str, FloatArray]], unit: str, scale: float = 1.0) -> str:
    """Return from where to where curves go, by their labels where they differ.

    >>> curves_text([("shaft 1", np.array([1500.0, 1501.0])), ("2", np.array([1500.0]))], "N m")
    'shaft 1: 1500.00 to 1501.00 N m, 2: 1500 N m'
    """
    texts = {}
    for label, curve in curves:
        low, high = float(np.nanmin(curve)), float(np.nanmax(curve))
        noise = ROUNDING * max(scale, abs(low), abs(high))
        middle = 0.5 * (low + high) if 0.5 * abs(low + high) > noise else 0.0
        ends = range_ends(low, high) if high - low > noise else (short(middle),)
        texts[label] = in_unit([" to ".join(ends)], "deg" if unit == "deg" else "", radians=False)
        texts[label] += "" if unit in ("", "deg") else f" {unit}"
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return ", ".join(f"{label}: {text}" for label, text in texts.items())
