"""What tolerances make of a scene's driveline, for tables, pictures and report."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import over
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
"""What groups of parameters are called in words, where that is not their name."""

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
    return sorted(made, key=lambda share: -share.share)
