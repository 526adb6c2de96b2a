"""Numbers, lists and rows of answers as people read them: the only place that formats a number."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from textwrap import indent
from typing import Any

import numpy as np

from cardan.app.answers.rounding import ROUNDING
from cardan.app.answers.rows import (
    DIGITS,
    UNITS,
    Digits,
    Entry,
    Judged,
    Rounds,
    Row,
    item_of,
    rows_of,
)
from cardan.app.scene.language.units import as_shown, shown_unit
from cardan.arrays import FloatArray
from cardan.design.wrapping import fill
from cardan.motion.workshop import both_senses

_WIDTH, _SHORT = 79, 16

# Ends of a range that need more to differ read alike.
_MOST_DECIMALS = 8


def capital(text: str) -> str:
    """Return a text that begins with a capital letter, the rest as it is."""
    return f"{text[:1].upper()}{text[1:]}"


def listed(parts: Sequence[str]) -> str:
    """Return ``"a, b and c"``."""
    *others, last = parts or [""]
    return " and ".join(filter(None, (", ".join(others), last)))


def table_text(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as lines: what each is about to the left, its figures in columns to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for label, *figures in rows:
        right = (figure.rjust(width) for figure, width in zip(figures, widths[1:], strict=True))
        lines.append("  ".join((label.ljust(widths[0]), *right)).rstrip())
    return "\n".join(lines)


# --- rows ----------------------------------------------------------------------------------------


def quantity(
    value: float | Judged,
    unit: str,
    *,
    radians: bool = False,
    digits: str = "",
    rounds: Rounds = "nearest",
    bounds: Sequence[float] = (),
) -> str:
    """Return a value in SI with its unit, a key of ``UNITS``: ``"41.3 MPa"``, ``"2.71°"``.

    It is told apart from the ``bounds``, in SI as well, and a judged one from its limits. It has
    the digits of a key of ``DIGITS``, by default of the unit, and is rounded up or down in
    magnitude if it must still do what it promises.
    """
    row = Row("figure", "", unit, digits=digits, rounds=rounds, bounds=tuple(bounds))
    return row_text(value, row, radians=radians)


def row_text(value: float | Judged, row: Row, *, radians: bool = False) -> str:
    """Return a figure of a row with its unit, told apart from its limits."""
    bounds = row.bounds
    if isinstance(value, Judged):
        assert value.value is not None
        bounds += tuple(each for each in (value.limit, value.maximum) if each is not None)
        return row_text(value.value, replace(row, bounds=bounds), radians=radians)
    number = value
    if not math.isfinite(number):
        return "not known" if math.isnan(number) else "unlimited"
    unit = shown_unit(row.unit)
    turned, kind = radians and unit == "deg", row.digits or unit
    # Fine figures are as fine in inches.
    kind = f"{kind}_{unit}" if f"{kind}_{unit}" in DIGITS else kind
    factor = 1.0 if turned else UNITS[unit].factor
    number, told = factor * number, [factor * bound for bound in bounds]
    if turned or unit != row.unit:
        told = [*map(_given_otherwise, told)]
        number = _given_otherwise(number) if kind == "given" else number
        kind = _in_radians(kind) if turned and kind != "given" else kind
    width = sum(abs(number - factor * other) for other in row.other_end)
    least = _range_decimals(width)
    text = number_text(number, kind, apart_from=told, rounds=row.rounds, least=least)
    return in_unit([text], unit, radians=radians)


def kind_of(quantity: str, unit: str) -> str:
    """Return the key of ``DIGITS`` of an output or a closed form in a unit."""
    name = quantity.removeprefix("max_").removeprefix("min_")
    kind = name if name in DIGITS else unit
    return _in_radians(kind) if unit == "rad" else kind


def kind_of_symbol(symbol: str) -> str:
    """Return the key of ``DIGITS`` of a unit as axes have it; that of a ratio if it is unknown."""
    return next((key for key in UNITS if symbol_of(key) == symbol), "")


def _in_radians(kind: str) -> str:
    return kind if DIGITS[kind].decimals is None else "rad"


def _given_otherwise(value: float) -> float:
    """A value as it is shown in another unit than that in which it may have been given."""
    return float(f"{value:.6g}")


def given(value: float, unit: str, *, radians: bool = False) -> str:
    """Return a value in SI that someone gave with its unit: ``"3°"``."""
    return quantity(value, unit, radians=radians, digits="given")


def settled(number: float, kind: str, apart_from: Iterable[float] = ()) -> float:
    """Return a number in the unit in which it is shown, or 0 where it is mere rounding.

    It is more than that where what it is told apart from is finer still and not beyond it.
    """
    told = any(0.0 < other / number <= 1.0 + ROUNDING for other in apart_from if number)
    return 0.0 if abs(number) < DIGITS[kind].finest and not told else number


def use_text(share: float) -> str:
    """Say how much of a limit is used, in whole percent: 100 only of one that is used exactly."""
    percent = round(100.0 * share)
    if abs(share - 1.0) > ROUNDING:
        percent = min(percent, 99) if share < 1.0 else max(percent, 101)
    return in_unit([f"{percent}"], "percent")


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
    """Return a label with the unit in which something is shown, as axes have it: ``"a [deg]"``."""
    return f"{label} [{symbol_of(shown_unit(unit))}]" if unit else label


def place_of(value: Judged) -> str:
    """Say where a figure is worst: ``" in rebound"``, ``" at bends_deg = 5"`` or ``""``."""
    if value.state.startswith("at "):
        return f" {value.state}"
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


def _bound_beside(value: Judged, row: Row, *, radians: bool) -> str:
    """Say the limit beside a figure, which it does not judge if the figure may be worse."""
    bound = bound_of(value, row, radians=radians)
    is_open = value.may_be_worse and value.verdict == "not judged"
    return f"{bound}, not judged" if bound and is_open else bound


def _known_text(value: Judged, row: Row, *, radians: bool) -> str:
    """Return a figure with its unit, and that it may be worse."""
    text = row_text(value, row, radians=radians)
    if not value.may_be_worse:
        return text
    return f"{text} or {'more' if value.sense == 'most' else 'less'}"


def judged_text(value: Judged, row: Row) -> str:
    """Say a figure, where it is worst, and how it stands to its limit or why it is not judged."""
    if value.value is None:
        return value.why
    number = row_text(value, row)
    figure = f"{number}{place_of(value)}"
    if value.limit is None or value.verdict == "not judged":
        return f"{figure}, not judged: {value.why or 'no limit is given'}"
    if value.verdict == "within":
        return f"{figure}, within the limit of {given(value.limit, row.unit)}"
    if row.at_zero and not value.value:
        return f"{row.at_zero},{place_of(value)}; {bound_of(value, row)}"
    bound, limit = "limit", value.limit
    if value.maximum is not None and value.verdict == "beyond":
        bound, limit = "maximum", value.maximum
    side = "above" if value.sense == "most" else "below"
    past = f"{side} the {bound} of {given(limit, row.unit)}"
    if value.verdict == "tolerable":
        assert value.maximum is not None
        past += f", maximum {given(value.maximum, row.unit)}"
    if math.isinf(value.value):
        return f"{figure}, {past}"
    # As many decimals as the number has.
    decimals = sum(map(str.isdigit, number.split()[0].partition(".")[2]))
    unit = shown_unit(row.unit)
    excess = UNITS[unit].factor * value.excess
    text = f"{excess:.{decimals}f}"
    return f"{figure}, {in_unit([text if float(text) else number_text(excess, unit)], unit)} {past}"


def cell(value: Any, row: Row, *, radians: bool = False) -> str:  # noqa: ANN401 - of any field
    """Return the value of a field, where it is worst and its limit; "" of what is not known."""
    if isinstance(value, Judged):
        if value.value is None:
            return ""
        text = _known_text(value, row, radians=radians) + place_of(value)
        return "; ".join(filter(None, (text, _bound_beside(value, row, radians=radians))))
    if value is None:
        return ""
    if row.kind == "numbers":
        return ", ".join(row_text(each, row, radians=radians) for each in value)
    if row.kind == "figure":
        return row_text(value, row, radians=radians)
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
            if is_judged and value.value is not None:
                cells.append(_known_text(value, unit, radians=radians))
            else:
                cells.append(cell(value, unit, radians=radians))
            bounds.append(_bound_beside(value, unit, radians=radians) if is_judged else "")
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


def wherever_text(entries: Iterable[Entry]) -> str:
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
            every = (replace(value, value=each) for each in value.each.values())
            cells = (row_text(each, row) for each in every)
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
        for count in range(len(others), 0, -1):
            text = table_text([*zip(first, *others[:count], strict=True)])
            if count == 1 or _is_narrow(text):
                break
        yield indent(text, "  ")
        others = others[count:]


def _is_narrow(text: str) -> bool:
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


def bullets(texts: Iterable[str], **layout: Any) -> list[str]:  # noqa: ANN401 - of textwrap
    """Return texts as the points of a list, 79 wide; further lines of a text stay as they are."""
    layout = {"subsequent_indent": "  ", "break_on_hyphens": False, **layout}
    points = (text.partition("\n") for text in texts)
    return [f"{fill(f'- {text}', _WIDTH, **layout)}{end}{lines}" for text, end, lines in points]


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
        if _is_narrow(text):
            return text
    half = len(found) // 2
    if not half:
        return table_text(whole)
    return f"{_several(found[:half], radians)}\n{_several(found[half:], radians)}"


# --- numbers -------------------------------------------------------------------------------------


def turn_text(shown: str, sense: str) -> str:
    """Return a turn in degrees, as it is shown, in both senses with as many decimals."""
    return both_senses(float(shown), sense, decimals=len(shown.partition(".")[2]))


def angle_text(value: float, *, radians: bool) -> str:
    """Write a drive angle in the unit asked for."""
    kind = _in_radians("phase") if radians else "phase"
    return in_unit([number_text(value, kind)], "deg", radians=radians)


def aligned(lines: Iterable[tuple[str, str]], width: int = 0, indent: str = "") -> str:
    """Return pairs of a label and a text as two columns, filled to 79 characters."""
    lines = list(lines)
    width = width or max(len(label) for label, _ in lines) + len(indent) + 2
    layout: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}
    layout["subsequent_indent"] = " " * width
    return "\n".join(
        fill(text, _WIDTH, initial_indent=f"{indent + label:{width}}", **layout)
        for label, text in lines
    )


def number_text(
    number: float,
    kind: str,
    *,
    apart_from: Iterable[float] = (),
    rounds: Rounds = "nearest",
    least: int = 0,
) -> str:
    """Return a number with the digits of its kind, a key of ``DIGITS``, in the unit that is shown.

    It has more digits where it would else read 0, or not stand as it does to what it is told apart
    from. What differs from that by rounding only reads alike. ``least`` are the fewest decimals.
    """
    told = [*apart_from]
    rule, number = DIGITS[kind], settled(number, kind, told)
    if number == 0.0 or not math.isfinite(number):
        return f"{number + 0.0:g}"
    if rule.decimals is None and rule.digits is None:
        return _as_given(number)
    others = [*told, *_landmarks(rule)]
    for other in others:
        if abs(number - other) <= ROUNDING * abs(other):
            return _as_given(other)
    fewest = max(least, _decimals(number, rule))
    if rounds != "nearest":
        fewest = max(fewest, 1 - _exponent(number))
    texts = (_rounded(number, fewest, more, rounds) for more in range(16))
    return next(text for text in texts if _stands(text, number, others))


def plain_text(number: float, kind: str, *, apart_from: Iterable[float] = ()) -> str:
    """Return a number with the digits of its kind, but without zeros at its end."""
    text = number_text(number, kind, apart_from=apart_from)
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def _landmarks(rule: Digits) -> list[float]:
    """Return the values that only a figure equal to them may show."""
    return [0.0] if rule.apart is None else [0.0, rule.apart]


def _stands(text: str, number: float, others: Sequence[float]) -> bool:
    """Whether a text is on the side of the others that the number is on."""
    shown = float(text)
    return all((shown > o, shown < o) == (number > o, number < o) for o in others)


def _as_given(number: float) -> str:
    """All digits that someone gave, without those that a change of units brings."""
    text = f"{number:.10g}"
    return np.format_float_positional(float(text), trim="-") if _is_readable(number) else text


def _is_readable(number: float) -> bool:
    """Whether a number is read without an exponent."""
    return -5 <= _exponent(number) < 7


def _exponent(number: float) -> int:
    return math.floor(math.log10(abs(number)))


def _decimals(number: float, rule: Digits) -> int:
    """The decimals by a rule; at least none."""
    if rule.decimals is not None:
        return rule.decimals
    # Of 9.999 three digits are 10.0.
    assert rule.digits
    exponent = int(f"{number:.{rule.digits - 1}e}".partition("e")[2])
    return max(0, rule.digits - 1 - exponent)


def _rounded(number: float, fewest: int, more: int, rounds: Rounds) -> str:
    if not _is_readable(number):
        return f"{number:.{2 + more}e}"
    decimals = fewest + more
    if rounds != "nearest":
        # A little off, so that a number stays which only rounding keeps from so many digits.
        nearest, slack = (math.ceil, -1e-12) if rounds == "up" else (math.floor, 1e-12)
        steps = nearest(abs(number) * 10.0**decimals * (1.0 + slack))
        number = math.copysign(steps * 10.0**-decimals, number)
    return f"{number:.{decimals}f}"


def range_ends(low: float, high: float, kind: str) -> tuple[str, str]:
    """Write both ends of a range, in the unit that is shown, with as many decimals.

    These are those of its kind, or what gives its width two digits.
    """
    low, high = settled(low, kind), settled(high, kind)
    rule, size, width = DIGITS[kind], max(abs(low), abs(high)), high - low
    decimals = _decimals(size, rule) if 0.0 < size < math.inf else 0
    decimals = max(decimals, _range_decimals(width))

    def written(end: float) -> str:
        text = f"{end:.{decimals}f}"
        is_plain = end != 0.0 and _is_readable(end) and _stands(text, end, _landmarks(rule))
        return text if is_plain else number_text(end, kind)

    first, last = written(low), written(high)
    # Zeros after the point of both ends say nothing.
    if all(text.partition(".")[2].strip("0") == "" for text in (first, last)):
        return first.partition(".")[0], last.partition(".")[0]
    return first, last


def _range_decimals(width: float) -> int:
    """Return the decimals that give the width of a range two digits; 0 of too narrow ones."""
    decimals = 1 - _exponent(width) if 0.0 < width < math.inf else 0
    return max(0, decimals) if decimals <= _MOST_DECIMALS else 0


def curves_text(curves: Sequence[tuple[str, FloatArray]], unit: str, scale: float = 1.0) -> str:
    """Return from where to where curves go, by their labels where they differ.

    They are in a unit as axes have it, and shown in that of the answer.

    >>> curves_text([("shaft 1", np.array([1500.0, 1501.0])), ("2", np.array([1500.0]))], "N m")
    'shaft 1: 1500 to 1501 N m, 2: 1500 N m'
    """
    texts = {}
    curves = [(label, as_shown(curve, unit)[0]) for label, curve in curves]
    size, unit = as_shown(np.array(scale), unit)
    scale, kind = float(size), kind_of_symbol(unit)
    for label, curve in curves:
        low, high = float(np.nanmin(curve)), float(np.nanmax(curve))
        noise = ROUNDING * max(scale, abs(low), abs(high))
        middle = 0.5 * (low + high) if 0.5 * abs(low + high) > noise else 0.0
        is_range = high - low > noise
        ends = range_ends(low, high, kind) if is_range else (plain_text(middle, kind),)
        text = " to ".join(ends)
        texts[label] = f"{text}°" if unit == "deg" else f"{text} {unit}".rstrip()
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return ", ".join(f"{label}: {text}" for label, text in texts.items())
