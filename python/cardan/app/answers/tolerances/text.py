"""What tolerances make of a driveline, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cardan.app.answers.printed import (
    capital,
    given,
    part_text,
    place_of,
    quantity,
    table_text,
)
from cardan.app.answers.rows import Judged
from cardan.app.answers.tolerances.figures import (
    GROUP_NAMES,
    AllToleranceFigures,
    Permitted,
    Share,
    ToleranceFigure,
    ToleranceFigures,
)


def words(found: ToleranceFigures, *, radians: bool = False) -> str:
    """Return all about tolerances as plain text, 79 wide, the figures in each state first."""
    tables = [
        "\n".join([caption, table_text([[f"  {first}", *others] for first, *others in rows])])
        for caption, rows in by_state(found)
    ]
    return "\n\n".join([*tables, part_text("Tolerances", found, sentences(found), radians=radians)])


def by_state(found: ToleranceFigures) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield caption and rows of texts of each figure that is known by state."""
    for each in found.figures:
        if rows := _state_rows(each):
            yield f"{each.label.capitalize()} in each state", rows


def _state_rows(figure: ToleranceFigure) -> list[list[str]]:
    """The figure in each state as rows of texts, the heads first; none without states."""
    columns: dict[str, Judged | None] = {
        "as measured" if figure.measured else "as drawn": figure.nominal,
        "worst": figure.worst,
        "bound": figure.guaranteed,
    }
    known = {head: each for head, each in columns.items() if each is not None}
    rows = [
        [state, *(_value(figure, each.each[state]) for each in known.values())]
        for state in figure.worst.each
    ]
    heads = ["state", *known]
    if figure.passing:
        heads.append("within the limit")
        for row in rows:
            row.append(percent(figure.passing.each[row[0]]))
    return [heads, *rows] if rows else []


def sentences(found: ToleranceFigures) -> Iterator[str]:
    """Say of each figure: as drawn, then with the tolerances."""
    several = len(found.figures) > 1
    for figure in found.figures:
        shares = [each for each in found.shares if each.name == figure.name]
        yield _verdict(figure, shares, named=several or figure.limit is None)
    if isinstance(found, AllToleranceFigures):
        yield from permitted_texts(found, found.permitted)


def _verdict(figure: ToleranceFigure, shares: Sequence[Share], *, named: bool) -> str:
    start = "as measured" if figure.measured else "as drawn"
    name = f"{capital(figure.label)}: " if named else ""
    assert figure.worst.value is not None
    assert figure.nominal.value is not None
    worst = f"the worst has {_value(figure, figure.worst.value)}{place_of(figure.worst)}"
    if shares and shares[0].share > 0.0:
        most = "mostly" if shares[0].share > 0.5 else "the largest share"
        worst += f", {most} from {'' if shares[0].of == 'point' else 'the '}{shares[0].label}"
    if figure.limit is None or figure.passing is None or figure.passing.value is None:
        # Joints that compensate each other leave rounding.
        rounding = figure.nominal.value < 1e-6 * figure.worst.value
        drawn = _value(figure, 0.0 if rounding else figure.nominal.value)
        return f"{name}{drawn} {start}{place_of(figure.nominal)}; with these tolerances {worst}."
    limit = f"the {_limit(figure)} limit"
    every = " in every state" if figure.worst.each else ""
    if Judged(figure.nominal.value, figure.limit).verdict == "within":
        drawn = f"within {limit}{every}"
    else:
        drawn = f"beyond {limit}{place_of(figure.nominal)}"
    needed = ""
    if figure.passing.limit is not None:
        needed = f"; the scene requires {given(figure.passing.limit, 'percent')}"
    return (
        f"{name}{start if named else start.capitalize()}, the driveline is {drawn}. With these "
        f"tolerances, {percent(figure.passing.value)} of all drivelines are within it{every}"
        f"{needed}; {worst}."
    )


def permitted_texts(found: ToleranceFigures, permitted: Sequence[Permitted]) -> list[str]:
    """Say how exact the driveline must be made, a sentence for each group."""
    return [_permitted(part, found) for part in permitted]


def _permitted(part: Permitted, found: ToleranceFigures) -> str:
    limit = _limit(found.figures[0])
    group = GROUP_NAMES.get(part.group, part.group)
    several = sum(each.group != "half a tooth" for each in found.given) > 1
    same = ", with the other tolerances unchanged" if several else ""
    if math.isnan(part.factor):
        return f"No accuracy of the {group} brings every driveline within {limit}{same}."
    if math.isinf(part.factor):
        return f"With any error of the {group} every driveline is within {limit}{same}."
    ends = [
        quantity(part.factor * end, part.unit, digits="small", rounds="down")
        for end in (part.least, part.largest)
    ]
    sizes = " to ".join(f"±{end}" for end in dict.fromkeys(ends))
    searched = found.figures[0].worst_kind == "search"
    every = "As far as a search finds, every" if searched else "Every"
    return f"{every} driveline is within {limit} if the {group} are exact to {sizes}{same}."


def _value(figure: ToleranceFigure, value: float) -> str:
    bounds = [] if figure.limit is None else [figure.limit]
    return quantity(value, figure.unit, bounds=bounds)


def _limit(figure: ToleranceFigure) -> str:
    assert figure.limit is not None
    return given(figure.limit, figure.unit)


def percent(share: float) -> str:
    """Write a share of the drivelines."""
    return quantity(share, "percent", digits="share")
