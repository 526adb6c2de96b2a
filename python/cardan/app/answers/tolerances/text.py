"""What tolerances make of a driveline, in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from cardan.app.answers.printed import aligned, figure_text
from cardan.app.answers.tolerances.figures import (
    GROUP_NAMES,
    Permitted,
    ToleranceFigure,
    ToleranceFigures,
)
from cardan.design.wrapping import fill

# Shares below this are not worth a line; at least so many are listed.
_SMALL, _FEWEST, _MOST = 0.01, 3, 8


def tolerances_text(found: ToleranceFigures, permitted: Sequence[Permitted]) -> str:
    """Return all about tolerances as plain text, 79 wide."""
    parts = [aligned(given_lines(found))]
    for figure in found.figures:
        lines = aligned(figure_lines(figure), indent="  ")
        shares = aligned(share_lines(figure), indent="    ")
        parts.append(
            f"{figure.label}{_of_states(figure)}\n{lines}\n  shares in the scatter\n{shares}"
        )
        parts += ["\n".join(_table(figure))] if figure.states else []
    parts.append(_filled([*verdict_texts(found), *permitted_texts(found, permitted)]))
    return "\n\n".join(parts)


def brief(found: ToleranceFigures) -> str:
    """Return the verdicts as plain text, 79 wide."""
    return _filled(verdict_texts(found))


def _filled(texts: Iterable[str]) -> str:
    return "\n".join(fill(text, 79, break_on_hyphens=False) for text in texts)


def given_lines(found: ToleranceFigures) -> list[tuple[str, str]]:
    """Return what the scene permits, as pairs."""
    lines = [
        (f"tolerance of {_called(group)}", _ends((low, high), unit))
        for group, (low, high, unit) in found.given.items()
    ]
    if found.half_tooth:
        lines.append(("half a tooth", _ends(found.half_tooth, "deg")))
    drawn = f"{found.samples}, {found.distribution}, seed {found.seed}"
    return [*lines, ("random drivelines", drawn)]


def _nominal(figure: ToleranceFigure) -> str:
    """What the driveline in the middle of the tolerances is."""
    return "as measured" if figure.measured else "as drawn"


def _called(group: str) -> str:
    return group if group == "points" else GROUP_NAMES.get(group, group)


def figure_lines(figure: ToleranceFigure) -> list[tuple[str, str]]:
    """Return the values of one figure as pairs."""
    half, most, nearly = (with_unit(value, figure.unit) for value in figure.quantiles)
    lines = [
        (_nominal(figure), with_unit(_rounded(figure.nominal, figure.worst), figure.unit)),
        ("half of them up to", half),
        ("95 % up to", most),
        ("99 % up to", nearly),
        ("worst", f"{with_unit(figure.worst, figure.unit)} ({_KINDS[figure.worst_kind]})"),
    ]
    if figure.guaranteed is not None:
        lines.append(("guaranteed bound", with_unit(figure.guaranteed, figure.unit)))
    if figure.limit is not None and figure.passing is not None:
        within = f"{percent(figure.passing)} of the drivelines"
        lines.append((f"within {limit_text(figure)}", within))
    return lines


_KINDS = {
    "box": "searched over all combinations",
    "linear": "to first order, since there are many parameters",
}


def share_lines(figure: ToleranceFigure) -> list[tuple[str, str]]:
    """Return the largest shares as pairs."""
    listed = [
        share
        for place, share in enumerate(figure.shares)
        if place < _FEWEST or (place < _MOST and share.share >= _SMALL)
    ]
    return [(share.label, percent(share.share)) for share in listed]


def _of_states(figure: ToleranceFigure) -> str:
    return f", largest of {len(figure.states)} states" if figure.states else ""


def state_rows(figure: ToleranceFigure) -> list[list[str]]:
    """Return the figure in each state as rows of texts, the heads first; without empty columns."""
    rows = [["state", _nominal(figure), "worst", "bound", "within the limit"]]
    for state in figure.states:
        values = (_rounded(state.nominal, state.worst), state.worst, state.guaranteed)
        texts = ["" if value is None else with_unit(value, figure.unit) for value in values]
        passing = "" if state.passing is None else percent(state.passing)
        rows.append([state.name, *texts, passing])
    known = [i for i, cells in enumerate(zip(*rows[1:], strict=True)) if any(cells)]
    return [[row[i] for i in known] for row in rows]


def _table(figure: ToleranceFigure) -> Iterator[str]:
    """The figure in each state, a line each."""
    rows = state_rows(figure)
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    for first, *others in rows:
        cells = (cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))
        yield "  ".join([f"  {first:{widths[0]}}", *cells]).rstrip()


def _in(state: str) -> str:
    """A state for a sentence, with a space in front; "" of no state."""
    return f" in {state}" if state else ""


def verdict_texts(found: ToleranceFigures) -> list[str]:
    """Return the verdict on each figure: as drawn, then with the tolerances."""
    several = len(found.figures) > 1
    return [verdict_text(figure, named=several or figure.limit is None) for figure in found.figures]


def permitted_texts(found: ToleranceFigures, permitted: Sequence[Permitted]) -> list[str]:
    """Say how exact the driveline must be made, a sentence for each group."""
    return [_permitted(part, found) for part in permitted]


def verdict_text(figure: ToleranceFigure, *, named: bool = False) -> str:
    """Return the verdict on one figure: as drawn, then with the tolerances."""
    name = f"{figure.label[:1].upper()}{figure.label[1:]}: " if named else ""
    about = "about " if figure.worst_kind == "linear" else ""
    worst = f"the worst has {about}{with_unit(figure.worst, figure.unit)}{_in(figure.worst_in)}"
    if figure.shares and figure.shares[0].share > 0.0:
        first = figure.shares[0]
        most = "mostly" if first.share > 0.5 else "the largest share"
        worst += f", {most} from {'' if first.of == 'point' else 'the '}{first.label}"
    nominal = _rounded(figure.nominal, figure.worst)
    if figure.limit is None or figure.passing is None:
        drawn = f"{with_unit(nominal, figure.unit)} {_nominal(figure)}{_in(figure.nominal_in)}"
        return f"{name}{drawn}; with these tolerances {worst}."
    start = _nominal(figure) if named else _nominal(figure).capitalize()
    limit, share = f"the {limit_text(figure)} limit", percent(figure.passing)
    every = " in every state" if figure.states else ""
    if figure.nominal <= figure.limit * (1.0 + 1e-9):
        drawn = f"within {limit}{every}"
    else:
        drawn = f"beyond {limit}{_in(figure.nominal_in)}"
    return (
        f"{name}{start}, the driveline is {drawn}. With these tolerances, "
        f"{share} of all drivelines are within it{every}; {worst}."
    )


def _permitted(part: Permitted, found: ToleranceFigures) -> str:
    limit = limit_text(found.figures[0])
    group = GROUP_NAMES.get(part.group, part.group)
    same = ", with the other tolerances unchanged" if len(found.given) > 1 else ""
    if math.isnan(part.factor):
        return f"No accuracy of the {group} brings every driveline within {limit}{same}."
    if math.isinf(part.factor):
        return f"With any error of the {group} every driveline is within {limit}{same}."
    low, high = (_rounded_down(part.factor * end) for end in part.given)
    sizes = _ends((low, high), part.unit)
    # To first order the worst driveline is only about the worst.
    about = "To first order, every" if found.figures[0].worst_kind == "linear" else "Every"
    return f"{about} driveline is within {limit} if the {group} are exact to {sizes}{same}."


def _rounded_down(value: float) -> float:
    """A tolerance with three digits: at what is printed the limit is not yet exceeded."""
    if value <= 0.0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.floor(value / step) * step


def with_unit(value: float, unit: str) -> str:
    """Write a value with its unit."""
    text = figure_text(value)
    return f"{text}°" if unit == "deg" else f"{text} {unit}".rstrip()


def limit_text(figure: ToleranceFigure) -> str:
    """Write the limit of a figure, which is a round number in most cases."""
    mark = "°" if figure.unit == "deg" else f" {figure.unit}".rstrip()
    return f"{figure.limit:.4g}{mark}"


def percent(share: float) -> str:
    """Write a share; one that is not all of it never as 100 %."""
    text = f"{100.0 * share:.1f}"
    if text == "100.0" and share < 1.0:
        return "more than 99.9 %"
    if text == "0.0" and share > 0.0:
        return "less than 0.1 %"
    return f"{text} %"


def _rounded(nominal: float, worst: float) -> float:
    """The value as drawn, without what rounding leaves of joints that compensate each other."""
    return 0.0 if nominal < 1e-6 * worst else nominal


def _ends(ends: tuple[float, float], unit: str) -> str:
    low, high = (f"{value:.4g}" for value in ends)
    mark = "°" if unit == "deg" else f" {unit}"
    return f"±{high}{mark}" if low == high else f"±{low}{mark} to ±{high}{mark}"
