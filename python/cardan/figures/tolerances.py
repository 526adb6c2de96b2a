"""What tolerances make of a scene's driveline, for tables, pictures, report and programs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.figures.answers import answer, answer_schema, record
from cardan.figures.extremes import finite_or_none
from cardan.quantities import MOTION_QUANTITIES, label
from cardan.scene.scene import Scene
from cardan.tolerances import Tolerances

SHARES = (0.5, 0.95, 0.99)
"""Shares of the drivelines of which the largest figure is listed."""

_GROUPS = {"bends": "joint", "twists": "shaft", "phases": "shaft", "points": "point"}
_UNITS = {"bends": "deg", "twists": "deg", "phases": "deg", "points": "mm"}


@dataclass(frozen=True)
class Share:
    """The part that one joint, shaft or point has in the scatter of a figure.

    Attributes:
        group: ``"bends"``, ``"twists"``, ``"phases"`` or ``"points"``.
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
        return (
            f"point {self.number}"
            if self.of == "point"
            else f"{self.group[:-1]} of {self.of} {self.number}"
        )


@dataclass(frozen=True)
class Permitted:
    """How exact one group must be so that the worst driveline is within the limit.

    Attributes:
        group: of parameters.
        given: its tolerances in deg or mm, least and largest.
        factor: by which they may be multiplied; NaN if the others alone exceed the limit, infinite
            if nothing reaches it.
    """

    group: str
    given: tuple[float, float]
    factor: float

    @property
    def unit(self) -> str:
        """``"deg"`` or ``"mm"``."""
        return _UNITS[self.group]


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


@dataclass(frozen=True)
class ToleranceFigures:
    """The figures of a scene's tolerances.

    Attributes:
        given: tolerance of each group in deg or mm: least and largest.
        half_tooth: half a tooth of the splines in deg: least and largest; ``None`` without teeth.
        distribution: of the tolerances.
        samples: random drivelines.
        seed: of their numbers.
        figures: what was asked for.
    """

    given: Mapping[str, tuple[float, float]]
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
    given = {group: ends for group, sizes in found.given.items() if (ends := _ends(group, sizes))}
    half_tooth = _ends("phases", found.half_tooth.get("phases", np.zeros(0)))
    figures = tuple(figure_of(found, name) for name in found.of)
    return ToleranceFigures(
        given, half_tooth, found.distribution, found.samples, found.seed, figures
    )


def _ends(group: str, sizes: FloatArray) -> tuple[float, float] | None:
    """The least and the largest tolerance above 0, in deg or mm."""
    known = sizes[sizes > 0.0] * (1e3 if group == "points" else math.degrees(1.0))
    return (float(known.min()), float(known.max())) if known.size else None


def needed_tolerances(scene: Scene) -> ToleranceFigures:
    """Return the figures of a scene's tolerances.

    Raises:
        ValueError: it has none.
    """
    found = tolerance_figures(scene)
    if found is None:
        raise ValueError(f"{scene.name}: section [tolerances] is missing; it says how exact all is")
    return found


def permitted_tolerances(found: Tolerances) -> tuple[Permitted, ...]:
    """Return how exact each group must be, for a single figure with a limit."""
    if len(found.of) > 1 or math.isnan(float(found.limit)):
        return ()
    given = {group: _ends(group, sizes) for group, sizes in found.given.items()}
    return tuple(
        Permitted(group, ends, float(found.permitted(group)))
        for group, ends in given.items()
        if ends
    )


def in_figure_units(found: Tolerances, name: str, value: Any) -> Any:  # noqa: ANN401
    """Return a result of one figure, with angles in degrees."""
    one = value[name] if isinstance(value, Mapping) else value
    return np.degrees(one) if found.unit(name) == "rad" else one


def unit_of(found: Tolerances, name: str) -> str:
    """Return the unit of a figure as it is shown: degrees for angles, nothing for a ratio."""
    return {"rad": "deg", "1": ""}.get(found.unit(name), found.unit(name))


def figure_of(found: Tolerances, name: str) -> ToleranceFigure:
    """Return one figure of the tolerances of a single driveline."""

    def value(of: Any) -> float:  # noqa: ANN401
        return float(in_figure_units(found, name, of))

    limit = value(found.limit)
    judged = not math.isnan(limit)
    passing = None
    if judged:
        passing = float(
            found.passing[name] if isinstance(found.passing, Mapping) else found.passing
        )
    guaranteed = value(found.guaranteed) if name in MOTION_QUANTITIES else None
    kind = found.worst_kind
    return ToleranceFigure(
        name,
        label(name),
        unit_of(found, name),
        value(found.nominal),
        tuple(map(float, np.atleast_1d(in_figure_units(found, name, found.quantile(SHARES))))),
        value(found.worst),
        kind[name] if isinstance(kind, Mapping) else kind,
        guaranteed,
        limit if judged else None,
        passing,
        tuple(sorted(_shares(found, name), key=lambda share: -share.share)),
    )


def _shares(found: Tolerances, name: str) -> Iterator[Share]:
    groups = found.shares if found.shares.keys().isdisjoint(found.of) else found.shares[name]
    for group, values in groups.items():
        first = 1 if group in ("twists", "phases") else 0
        parts = values.sum(axis=-1) if group == "points" else values
        for number, share in enumerate(parts.tolist(), first):
            yield Share(group, _GROUPS[group], number, share)


def tolerances_data(scene: Scene) -> dict[str, Any]:
    """Return the tolerances of a scene as plain data for JSON.

    Raises:
        ValueError: it has none.
    """
    found = needed_tolerances(scene)
    assert scene.tolerances
    permitted = [
        {
            "group": part.group,
            "unit": part.unit,
            "given": part.given[1],
            "factor": finite_or_none(part.factor),
            "needless": math.isinf(part.factor),
        }
        for part in permitted_tolerances(scene.tolerances)
    ]
    return answer("tolerances", scene.title, **tolerances_part(found), permitted=permitted)


def tolerances_part(found: ToleranceFigures) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``TOLERANCES_PART`` describes them."""
    return {
        "distribution": found.distribution,
        "samples": found.samples,
        "seed": found.seed,
        "figures": [_entry(figure) for figure in found.figures],
    }


def _entry(figure: ToleranceFigure) -> dict[str, Any]:
    return {
        "figure": figure.name,
        "unit": figure.unit,
        "nominal": figure.nominal,
        "quantiles": [
            {"share": share, "value": value}
            for share, value in zip(SHARES, figure.quantiles, strict=True)
        ],
        "worst": figure.worst,
        "worst_kind": figure.worst_kind,
        "guaranteed": figure.guaranteed,
        "limit": figure.limit,
        "passing": figure.passing,
        "shares": [
            {"group": part.group, "of": part.of, "number": part.number, "share": part.share}
            for part in figure.shares
        ],
    }


_NUMBER = {"type": "number"}
_MAYBE = {"type": ["number", "null"]}
_TEXT = {"type": "string"}
_COUNT = {"type": "integer", "minimum": 0}
_LIST: Mapping[str, Any] = {"type": "array"}

_PART: Mapping[str, Any] = {
    "distribution": {"enum": ["uniform", "normal"]},
    "samples": _COUNT,
    "seed": _COUNT,
    "figures": {
        **_LIST,
        "items": record(
            {
                "figure": _TEXT,
                "unit": {"type": "string", "description": "degrees for angles"},
                "nominal": _NUMBER,
                "quantiles": {**_LIST, "items": record({"share": _NUMBER, "value": _NUMBER})},
                "worst": _NUMBER,
                "worst_kind": {"enum": ["box", "linear"]},
                "guaranteed": _MAYBE,
                "limit": _MAYBE,
                "passing": _MAYBE,
                "shares": {
                    **_LIST,
                    "items": record(
                        {"group": _TEXT, "of": _TEXT, "number": _COUNT, "share": _NUMBER}
                    ),
                },
            }
        ),
    },
}

TOLERANCES_PART = record(_PART)
"""JSON Schema of what ``tolerances_part`` returns."""

_PERMITTED: Mapping[str, Any] = {
    "permitted": {
        **_LIST,
        "description": "by which factor the tolerances of one group may change until the worst "
        "driveline reaches the limit; null if no factor suffices, or none is needed (needless)",
        "items": record(
            {
                "group": _TEXT,
                "unit": _TEXT,
                "given": _NUMBER,
                "factor": _MAYBE,
                "needless": {"type": "boolean"},
            }
        ),
    },
}

TOLERANCES_SCHEMA = answer_schema(
    "tolerances", "what cardan tolerances prints with --json", {**_PART, **_PERMITTED}
)
"""JSON Schema of what ``tolerances_data`` returns."""
