"""A scene over its states as numbers: figures and verdict of each, and the worst of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.answers.study.extremes import End, extremes, finite_or_none
from cardan.app.scene.scene import Scene
from cardan.app.scene.states import STATE, StatesResult
from cardan.design.check import Check
from cardan.design.judged import VERDICTS


def state_name(table: StatesResult, end: End) -> str:
    """Return the name of the state in which a figure is least or largest; "" if in all."""
    return table.states.names[int(end.at[STATE])] if STATE in end.at else ""


def without_common(names: Sequence[str]) -> tuple[str, list[str]]:
    """Return what the names of states have in common, and the rest of each with a true minus sign.

    >>> without_common(["points_mm.3.y = 20", "points_mm.3.y = 0"])
    ('points_mm.3.y', ['20', '0'])
    >>> without_common(["state 0", "state 1"])
    ('state', ['0', '1'])
    >>> without_common(["laden", "empty"])
    ('', ['laden', 'empty'])
    """
    parts = [name.partition(" = ") for name in names]
    common = {part[0] for part in parts}
    if len(common) == 1 and all(part[1] for part in parts):
        return common.pop(), [part[2].replace("-", "\N{MINUS SIGN}") for part in parts]
    if all(name.startswith("state ") for name in names):
        return "state", [name.removeprefix("state ") for name in names]
    return "", list(names)


def state_verdicts(scene: Scene, found: Check) -> list[dict[str, Any]]:
    """Return name, equivalent bend, verdict and what is beyond its maximum of each state.

    Args:
        scene: a scene with states.
        found: its check, as ``check_scene`` makes it.
    """
    assert scene.states
    bends = next(f.value for f in found.findings if f.figure == "equivalent_bend")
    # What rounding leaves of joints that cancel each other is 0.
    bends = np.where(np.asarray(bends) < 3e-6, 0.0, bends)
    return [
        {
            "state": name,
            "equivalent_bend_deg": finite_or_none(float(bends[i])),
            "verdict": VERDICTS[int(found.ranks[i])],
            "beyond": [f.figure for f in found.findings if not f.passes[i]],
        }
        for i, name in enumerate(scene.states.names)
    ]


# --- plain data --------------------------------------------------------------------------------


def data(found: list[dict[str, Any]], *, radians: bool = False) -> dict[str, Any]:
    """Return the verdicts over the states as plain data, as ``SCHEMA`` describes them."""
    return {"verdicts": found}


def states_data(table: StatesResult, *, radians: bool = False) -> dict[str, Any]:
    """Return the states and their figures as plain data, as ``STATES_SCHEMA`` describes them."""
    states = table.states
    figures = []
    for each in extremes(table, radians=radians):
        column = each.column
        _, values = table.figure(column, radians=radians)
        ends = {"least": each.least, "largest": each.largest}
        figures.append(
            {
                "column": each.name,
                "quantity": column.quantity,
                column.per: column.item,
                "statistic": column.statistic,
                "values": [finite_or_none(float(value)) for value in values],
                **{
                    which: {"value": finite_or_none(end.value), "state": state_name(table, end)}
                    for which, end in ends.items()
                },
            }
        )
    return {
        "names": list(states.names),
        "weights": states.weights.tolist(),
        "keys": [{"key": axis.key, "values": axis.values.tolist()} for axis in states.axes],
        "figures": figures,
    }


_NUMBER = {"type": ["number", "null"]}
_NAMES = {"type": "array", "items": {"type": "string"}}
_COUNT = {"type": "integer", "minimum": 0}
_END = record(
    {
        "value": _NUMBER,
        "state": {"type": "string", "description": "empty if it is the same in all states"},
    }
)
_VALUES = {"type": "array", "description": "one per state", "items": _NUMBER}

SCHEMA: Mapping[str, Any] = record(
    {
        "verdicts": {
            "type": "array",
            "items": record(
                {
                    "state": {"type": "string"},
                    "equivalent_bend_deg": _NUMBER,
                    "verdict": {"enum": list(VERDICTS)},
                    "beyond": {
                        "type": "array",
                        "description": "figures beyond their maximum",
                        "items": {"type": "string"},
                    },
                }
            ),
        }
    }
)
"""JSON Schema of ``data``."""

STATES_SCHEMA: Mapping[str, Any] = record(
    {
        "names": _NAMES,
        "weights": {"type": "array", "items": {"type": "number"}},
        "keys": {
            "type": "array",
            "items": record(
                {"key": {"type": "string"}, "values": {**_VALUES, "items": {"type": "number"}}}
            ),
        },
        "figures": {
            "type": "array",
            "items": record(
                {
                    "column": {"type": "string", "description": "its heading in the table"},
                    "quantity": {"type": "string"},
                    "statistic": {"type": "string"},
                    "values": {
                        **_VALUES,
                        "description": "one per state, in the unit of the column",
                    },
                    "least": _END,
                    "largest": _END,
                },
                dict.fromkeys(("shaft", "joint", "bearing"), _COUNT),
            ),
        },
    }
)
"""JSON Schema of ``states_data``."""


def find(answer: Answer) -> list[dict[str, Any]]:
    """Return the figures of an answer's scene."""
    if answer.scene.states is None:
        return []
    assert answer.motion is not None
    return state_verdicts(answer.scene, answer.motion)
