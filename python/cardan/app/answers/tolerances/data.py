"""The tolerances of a scene as plain data, and its JSON Schema."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.tolerances.figures import (
    SHARES,
    ToleranceFigure,
    ToleranceFigures,
    needed_tolerances,
    permitted_tolerances,
)
from cardan.app.scene.scene import Scene


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
        for part in permitted_tolerances(scene.tolerances, scene.tolerance_arms)
    ]
    return answer("tolerances", scene.title, **data(found), permitted=permitted)


def data(found: ToleranceFigures, *, radians: bool = False) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes them."""
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
        **_states(figure),
        "shares": [
            {"group": part.group, "of": part.of, "number": part.number, "share": part.share}
            for part in figure.shares
        ],
    }


def _states(figure: ToleranceFigure) -> dict[str, Any]:
    if not figure.states:
        return {}
    return {
        "worst_in": figure.worst_in,
        "states": [
            {
                "state": state.name,
                "nominal": state.nominal,
                "worst": state.worst,
                "guaranteed": state.guaranteed,
                "passing": state.passing,
            }
            for state in figure.states
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
            },
            {
                "worst_in": {**_TEXT, "description": "the state with the worst driveline"},
                "states": {
                    **_LIST,
                    "description": "the figure in each state; above it is the largest of them",
                    "items": record(
                        {
                            "state": _TEXT,
                            "nominal": _NUMBER,
                            "worst": _NUMBER,
                            "guaranteed": _MAYBE,
                            "passing": _MAYBE,
                        }
                    ),
                },
            },
        ),
    },
}

SCHEMA = record(_PART)
"""JSON Schema of what ``data`` returns."""

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
