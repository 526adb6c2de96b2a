"""What tolerances make of a scene's driveline, for tables, pictures and report."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.scene.scene import Scene
from cardan.app.scene.units import in_degrees
from cardan.arrays import FloatArray
from cardan.design.quantities import MOTION_QUANTITIES, label
from cardan.tolerances import JOINT_GROUPS, Tolerances

SHARES = (0.5, 0.95, 0.99)
"""Shares of the drivelines of which the largest figure is listed."""

_GROUPS = {
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


@dataclass(frozen=True)
class Share:
    """The part that one joint, shaft or point has in the scatter of a figure.

    Attributes:
        group: ``"bends"``, ``"twists"``, ``"phases"``, ``"points"``, ``"driving_yoke"``,
            ``"cross"`` or ``"driven_yoke"``.
        of: ``"joint"``, ``"shaft"`` or ``"point"``.
        number: which one, counted from 0.
        share: of 1; of a point all its coordinates together.
    """

    group: str
    of: str
    number: int
    share: float

    @property
    def label(self) -> str:
        """What it is: ``phase of shaft 1``."""
        if self.of == "point":
            return f"point {self.number}"
        if self.group in JOINT_GROUPS:
            return f"{self.group.replace('_', ' ')} of joint {self.number}"
        return f"{self.group[:-1]} of {self.of} {self.number}"


@dataclass(frozen=True)
class Permitted:
    """How exact one group must be so that the worst driveline is within the limit.

    Attributes:
        group: of parameters.
        given: its tolerances in deg or mm, least and largest.
        factor: by which they may be multiplied; NaN if the others alone exceed the limit, infinite
            if nothing reaches it.
        unit: ``"deg"`` or ``"mm"``.
    """

    group: str
    given: tuple[float, float]
    factor: float
    unit: str


@dataclass(frozen=True)
class ToleranceState:
    """One figure of a toleranced driveline in one state; attributes as of ``ToleranceFigure``."""

    name: str
    nominal: float
    worst: float
    guaranteed: float | None
    passing: float | None


@dataclass(frozen=True)
class ToleranceFigure:
    """One figure of a toleranced driveline; angles in degrees.

    Attributes:
        name: for programs.
        label: in words.
        unit: of the values.
        nominal: of the driveline as drawn.
        quantiles: at ``SHARES``.
        worst: of any driveline within the tolerances.
        worst_kind: how it was found.
        guaranteed: bound, ``None`` where none is known.
        limit: ``None`` without one.
        passing: share of the drivelines within the limit, ``None`` without one.
        shares: of each joint, shaft or point, the largest first.
        measured: whether the nominal driveline has deviations that were measured.
        worst_in: name of the state of the worst driveline; "" without states.
        nominal_in: name of the state in which the driveline as drawn has its value.
        states: the figure in each state.
    """

    name: str
    label: str
    unit: str
    nominal: float
    quantiles: tuple[float, ...]
    worst: float
    worst_kind: str
    guaranteed: float | None
    limit: float | None
    passing: float | None
    shares: tuple[Share, ...]
    measured: bool = False
    worst_in: str = ""
    nominal_in: str = ""
    states: tuple[ToleranceState, ...] = ()


@dataclass(frozen=True)
class ToleranceFigures:
    """The figures of a scene's tolerances.

    Attributes:
        given: tolerance of each group: least, largest and unit.
        half_tooth: half a tooth of the splines in deg: least and largest; ``None`` without teeth.
        distribution: of the tolerances.
        samples: random drivelines.
        seed: of their numbers.
        figures: what was asked for.
    """

    given: Mapping[str, tuple[float, float, str]]
    half_tooth: tuple[float, float] | None
    distribution: str
    samples: int
    seed: int
    figures: tuple[ToleranceFigure, ...]


def tolerance_figures(scene: Scene) -> ToleranceFigures | None:
    """Return the figures of a scene's tolerances, if it has any."""
    found = scene.tolerances
    if found is None:
        return None
    given = _given(found, scene.tolerance_arms)
    half_tooth = _ends(found.half_tooth.get("phases", np.zeros(0)), math.degrees(1.0))
    names = scene.states.names if scene.states else ()
    figures = tuple(figure_of(found, name, names) for name in found.of)
    return ToleranceFigures(
        given, half_tooth, found.distribution, found.samples, found.seed, figures
    )


def _given(
    found: Tolerances, arms: Mapping[str, FloatArray]
) -> dict[str, tuple[float, float, str]]:
    """The tolerances above 0 by group: the least, the largest and the unit.

    Args:
        found: the tolerances.
        arms: arm of each joint in m by the groups that are given as lengths.
    """
    given = {}
    for group, sizes in found.given.items():
        length = group == "points" or group in arms
        factor = 1e3 * arms.get(group, 1.0) if length else math.degrees(1.0)
        if ends := _ends(sizes, factor):
            given[group] = (*ends, "mm" if length else "deg")
    return given


def _ends(sizes: FloatArray, factor: Any) -> tuple[float, float] | None:  # noqa: ANN401
    """The least and the largest tolerance above 0, times a factor."""
    known = (sizes * factor)[sizes > 0.0]
    return (float(known.min()), float(known.max())) if known.size else None


def needed_tolerances(scene: Scene) -> ToleranceFigures:
    """Return the figures of a scene's tolerances.

    Raises:
        ValueError: it has none.
    """
    found = tolerance_figures(scene)
    if found is None:
        raise ValueError(f"{scene.name}: section [tolerances] is missing; it gives the tolerances")
    return found


def permitted_tolerances(
    found: Tolerances, arms: Mapping[str, FloatArray] | None = None
) -> tuple[Permitted, ...]:
    """Return how exact each group must be, for a single figure with a limit.

    Args:
        found: the tolerances.
        arms: arm of each joint in m by the groups of deviations that are given as lengths.
    """
    if len(found.of) > 1 or math.isnan(float(found.limit)):
        return ()
    return tuple(
        Permitted(group, (low, high), float(found.permitted(group)), unit)
        for group, (low, high, unit) in _given(found, arms or {}).items()
    )


def in_figure_units(found: Tolerances, name: str, value: Any) -> Any:  # noqa: ANN401
    """Return a result of one figure, with angles in degrees."""
    return in_degrees(_one(value, name), found.unit(name))[0]


def unit_of(found: Tolerances, name: str) -> str:
    """Return the unit of a figure as it is shown: degrees for angles, nothing for a ratio."""
    return in_degrees(np.zeros(0), found.unit(name))[1]


def figure_of(found: Tolerances, name: str, states: Sequence[str] = ()) -> ToleranceFigure:
    """Return one figure of the tolerances of a single driveline.

    Args:
        found: the tolerances.
        name: of the figure.
        states: names of the states, if there are any.
    """

    def value(of: Any) -> float:  # noqa: ANN401
        return float(in_figure_units(found, name, of))

    limit = value(found.limit)
    each = tuple(_in_state(found, name, i, state) for i, state in enumerate(states))
    return ToleranceFigure(
        name,
        f"{label(name)}{_of_ideal_joints(found, name)}",
        unit_of(found, name),
        value(found.nominal),
        tuple(map(float, np.atleast_1d(in_figure_units(found, name, found.quantile(SHARES))))),
        value(found.worst),
        str(_one(found.worst_kind, name)),
        value(found.guaranteed) if name in MOTION_QUANTITIES else None,
        None if math.isnan(limit) else limit,
        _passing(found, name),
        tuple(sorted(_shares(found, name), key=lambda share: -share.share)),
        found.measured and name not in MOTION_QUANTITIES,
        states[int(_one(found.worst_state, name))] if states else "",
        max(each, key=lambda state: state.nominal).name if each else "",
        each,
    )


def _of_ideal_joints(found: Tolerances, name: str) -> str:
    """What to add to a figure of the motion, which leaves deviations of the joints out."""
    return " of ideal joints" if found.as_built and name in MOTION_QUANTITIES else ""


def _in_state(found: Tolerances, name: str, state: int, called: str) -> ToleranceState:
    alone = found.in_state(state)

    def value(of: Any) -> float:  # noqa: ANN401
        return float(in_figure_units(alone, name, of))

    return ToleranceState(
        called,
        value(alone.nominal),
        value(alone.worst),
        value(alone.guaranteed) if name in MOTION_QUANTITIES else None,
        _passing(alone, name),
    )


def _passing(found: Tolerances, name: str) -> float | None:
    """The share of the drivelines within the limit; ``None`` without one."""
    return None if math.isnan(float(_one(found.limit, name))) else float(_one(found.passing, name))


def _one(value: Any, name: str) -> Any:  # noqa: ANN401
    """The result of one figure."""
    return value[name] if isinstance(value, Mapping) else value


def _shares(found: Tolerances, name: str) -> Iterator[Share]:
    groups = found.shares if found.shares.keys().isdisjoint(found.of) else found.shares[name]
    for group, values in groups.items():
        if group in JOINT_GROUPS and name in MOTION_QUANTITIES:
            continue
        first = 1 if group in ("twists", "phases") else 0
        parts = values.sum(axis=-1) if group == "points" else values
        for number, share in enumerate(parts.tolist(), first):
            yield Share(group, _GROUPS[group], number, share)


def find(answer: Answer) -> ToleranceFigures | None:
    """Return the figures of an answer's scene."""
    return tolerance_figures(answer.scene)
