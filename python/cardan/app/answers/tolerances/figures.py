"""Effect of tolerances on a scene's driveline, for tables, pictures and report."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import over
from cardan.app.answers.printed import capital, given, part_text, place_of, quantity, table_text
from cardan.app.answers.rows import UNITS, Judged, count, figure, flag, item, key_of, parts, word
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.design.quantities import MOTION_QUANTITIES, label
from cardan.tolerances import JOINT_GROUPS, Tolerances

_GROUPS: Mapping[str, Literal["joint", "shaft", "point"]] = {
    "bends": "joint",
    "twists": "shaft",
    "phases": "shaft",
    "points": "point",
    **dict.fromkeys(JOINT_GROUPS, "joint"),
}

GROUP_NAMES = {
    "points": "coordinates of the points",
    "driving_yoke": "driving yokes",
    "cross": "crosses",
    "driven_yoke": "driven yokes",
}
"""Groups of parameters in words, where these differ from their names."""

_UNIT = "unit of the figures beside it"


@dataclass(frozen=True)
class Given:
    """The tolerances of one group of parameters."""

    group: str = item("group")
    unit: str = word("unit", _UNIT, is_detail=True)
    least: float = figure("least tolerance, ±", "own", "above 0", digits="given")
    largest: float = figure("largest tolerance, ±", "own", digits="given")


@dataclass(frozen=True)
class Permitted(Given):
    """How exact one group must be so that the worst driveline is within the limit."""

    factor: float = figure(
        "factor",
        "",
        "by which its tolerances may be multiplied; null if the others alone exceed the limit",
        rounds="down",
    )
    needless: bool = flag("needless", "whether nothing reaches the limit")


@dataclass(frozen=True)
class Share:
    """The part that one joint, shaft or point has in the scatter of a figure."""

    label: str = item("parameter")
    name: str = word("figure", "in whose scatter", is_detail=True)
    group: str = word("group", "of parameters", is_detail=True)
    of: Literal["joint", "shaft", "point"] = word("of", is_detail=True)
    number: int = count("number", "of the joint, shaft or point", is_detail=True)
    share: float = figure(
        "share in the scatter", "percent", "of a point all coordinates together", digits="share"
    )


@dataclass(frozen=True)
class ToleranceFigure:
    """One figure of a toleranced driveline."""

    label: str = item("figure")
    name: str = word("name", "in a scene", is_detail=True)
    unit: str = word("unit", _UNIT, is_detail=True)
    nominal: Judged = figure(
        "in the middle of the tolerances", "own", "as drawn or as measured", apart="limit"
    )
    half: float = figure("half of the drivelines up to", "own", "median", apart="limit")
    most: float = figure(
        "95% up to", "own", "of 100 drivelines, 95 are not above it", apart="limit"
    )
    nearly: float = figure(
        "99% up to", "own", "of 100 drivelines, 99 are not above it", apart="limit"
    )
    worst: Judged = figure(
        "worst with tolerances",
        "own",
        "of any driveline within the tolerances",
        limit="[tolerances] limit",
    )
    worst_kind: Literal["box", "search"] = word(
        "worst found", "box: from all corners of the tolerances; search: from many of them"
    )
    guaranteed: Judged | None = figure(
        "guaranteed bound",
        "own",
        "that no driveline within the tolerances exceeds",
        source="triangle inequality in the hyperbolic plane",
        apart="limit",
    )
    limit: float | None = figure("limit", "own", digits="given", is_detail=True)
    passing: Judged | None = figure(
        "share within the limit",
        "percent",
        "of the drivelines",
        limit="[tolerances] share",
        digits="share",
    )
    measured: bool = flag(
        "measured", "whether joints in the middle have measured deviations", is_detail=True
    )


@dataclass(frozen=True)
class ToleranceFigures:
    """The figures of a scene's tolerances."""

    given: tuple[Given, ...] = parts("Given", "the tolerances of the scene")
    distribution: str = word("distribution", "of the errors within their tolerances")
    samples: int = count("random drivelines", "how many are drawn")
    seed: int = count("seed", "of the random numbers")
    figures: tuple[ToleranceFigure, ...] = parts("Drivelines")
    shares: tuple[Share, ...] = parts("Shares in the scatter", "the largest of each figure first")


@dataclass(frozen=True, kw_only=True)
class AllToleranceFigures(ToleranceFigures):
    """The figures of a scene's tolerances, with how exact each group must be."""

    permitted: tuple[Permitted, ...] = parts(
        "Permitted", "of a single figure with a limit", is_detail=True
    )


def find(answer: Answer) -> ToleranceFigures | None:
    """Return the figures of a scene's tolerances; ``None`` without any."""
    return tolerance_figures(answer.scene)


def tolerance_figures(scene: Scene) -> ToleranceFigures | None:
    """Return the figures of a scene's tolerances; ``None`` without any."""
    found = scene.tolerances
    if found is None:
        return None
    given = [Given(*each) for each in _given(found, scene.tolerance_arms)]
    tooth = found.half_tooth.get("phases", np.zeros(0))
    if np.any(tooth > 0.0):
        given.append(Given("half a tooth", "deg", float(tooth[tooth > 0.0].min()), tooth.max()))
    return ToleranceFigures(
        tuple(given),
        found.distribution,
        found.samples,
        found.seed,
        tuple(figure_of(found, name, scene) for name in found.of),
        tuple(share for name in found.of for share in shares_of(found, name)),
    )


def whole(answer: Answer, found: ToleranceFigures) -> AllToleranceFigures:
    """Return the figures with how exact each group must be."""
    of, arms = answer.scene.tolerances, answer.scene.tolerance_arms
    assert of
    return AllToleranceFigures(**vars(found), permitted=permitted_tolerances(of, arms))


def _given(
    found: Tolerances, arms: Mapping[str, FloatArray]
) -> Iterator[tuple[str, str, float, float]]:
    """The groups with tolerances above 0: name, unit, the least and the largest.

    Some are given as lengths at an arm of each joint in m.
    """
    for group, sizes in found.given.items():
        length = group == "points" or group in arms
        values = sizes * arms.get(group, 1.0)
        if np.any(values > 0.0):
            least = float(values[values > 0.0].min())
            yield group, "mm" if length else "deg", least, float(values.max())


def permitted_tolerances(
    found: Tolerances, arms: Mapping[str, FloatArray] | None = None
) -> tuple[Permitted, ...]:
    """Return how exact each group must be, for a single figure with a limit; ``arms`` as above."""
    if len(found.of) > 1 or math.isnan(float(found.limit)):
        return ()
    factors = ((each, float(found.permitted(each[0]))) for each in _given(found, arms or {}))
    return tuple(Permitted(*each, factor, math.isinf(factor)) for each, factor in factors)


def figure_of(found: Tolerances, name: str, scene: Scene) -> ToleranceFigure:
    """Return one figure of the tolerances of a scene."""
    alone = [found.in_state(i) for i in range(found.n_states or 0)] or [found]
    known = float(one(found.limit, name))
    limit = None if math.isnan(known) else known
    passing: Judged | None = None
    if limit is not None:
        passing = Judged(float(one(found.passing, name)), scene.tolerance_share, sense="least")
        if scene.states:
            each = found.passing_by_state[name].tolist()
            passing = replace(passing, each=dict(zip(scene.states.names, each, strict=True)))

    def worst_of(values: Literal["nominal", "worst", "guaranteed"], limit: float | None) -> Judged:
        return over(scene, np.array([one(getattr(each, values), name) for each in alone]), limit)

    half, most, nearly = map(float, one(found.quantile((0.5, 0.95, 0.99)), name))
    return ToleranceFigure(
        called(found, name),
        name,
        key_of(found.unit(name)),
        worst_of("nominal", None),
        half,
        most,
        nearly,
        worst_of("worst", limit if scene.tolerance_share is None else None),
        one(found.worst_kind, name),
        worst_of("guaranteed", None) if name in MOTION_QUANTITIES else None,
        limit,
        passing,
        found.measured and name not in MOTION_QUANTITIES,
    )


def called(found: Tolerances, name: str) -> str:
    """Return what a figure is called; those of the motion leave deviations of the joints out."""
    of_ideal = found.as_built and name in MOTION_QUANTITIES
    return f"{label(name)}{' of ideal joints' if of_ideal else ''}"


def in_its_unit(found: Tolerances, name: str, value: Any) -> Any:  # noqa: ANN401
    """Return a result of one figure in the unit in which it is shown."""
    return UNITS[shown_unit(key_of(found.unit(name)))].factor * np.asarray(one(value, name))


def one(value: Any, name: str) -> Any:  # noqa: ANN401
    """Return the result of one figure."""
    return value[name] if isinstance(value, Mapping) else value


def shares_of(found: Tolerances, name: str) -> list[Share]:
    """Return the shares of each joint, shaft or point in the scatter of a figure, largest first."""
    groups = found.shares if found.shares.keys().isdisjoint(found.of) else found.shares[name]
    made = []
    for group, values in groups.items():
        if group in JOINT_GROUPS and name in MOTION_QUANTITIES:
            continue
        of = _GROUPS[group]
        about = group.replace("_", " ") if group in JOINT_GROUPS else group[:-1]
        about = "" if of == "point" else f"{about} of "
        each = values.sum(axis=-1) if group == "points" else values
        for number, share in enumerate(each.tolist(), 1 if group in ("twists", "phases") else 0):
            made.append(Share(f"{about}{of} {number}", name, group, of, number, share))
    # What differs by rounding alone keeps its order.
    return sorted(made, key=lambda share: -round(share.share, 9))


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
    for own in found.figures:
        shares = [each for each in found.shares if each.name == own.name]
        yield _verdict(own, shares, named=several or own.limit is None)
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
