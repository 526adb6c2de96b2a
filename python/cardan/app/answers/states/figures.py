"""A scene over its states as numbers: figures and verdict of each, and the worst of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.answers.limits.figures import FIGURES
from cardan.app.answers.rows import figure, item, numbers, word, worst_of
from cardan.app.answers.study.extremes import End, extremes, finite_or_none
from cardan.app.scene.study.states import STATE, StatesResult


@dataclass(frozen=True)
class StateFigures:
    """The motion of the driveline in one state; ``None`` of what is not known or has no meaning."""

    state: str = item("state")
    equivalent_bend: float | None = figure("equivalent bend", "deg")
    bend_difference: float | None = figure("bend difference", "deg", is_detail=True)
    torsional_excitation: float | None = figure("torsional excitation", "rad_s2", is_detail=True)
    inertia_excitation_driving: float | None = figure(
        "inertia excitation, driving", "rad_s2", is_detail=True
    )
    inertia_excitation_coasting: float | None = figure(
        "inertia excitation, coasting", "rad_s2", is_detail=True
    )
    verdict: str = word("verdict", "on the motion")
    beyond: str = word("beyond", "what is beyond its limit in this state, besides the bend")
    bends: tuple[float, ...] = numbers("bends", "deg", "of the joints")
    lengths: tuple[float, ...] = numbers("lengths", "mm", "of the shafts, where they are known")


def find(answer: Answer) -> tuple[StateFigures, ...]:
    """Return the motion of a scene in each of its states."""
    states = answer.scene.states
    if states is None:
        return ()
    motion, lines = answer["limits"], states.drivelines()
    lengths = lines._geometry.lengths
    found = []
    for i, name in enumerate(states.names):
        judged = {
            figure: replace(whole, value=whole.each[name])
            for figure in FIGURES
            if (whole := getattr(motion, figure)) is not None and name in whole.each
        }
        values = {figure: judged[figure].value if figure in judged else None for figure in FIGURES}
        found.append(
            StateFigures(
                name,
                **values,
                verdict=worst_of(each.verdict for each in judged.values()),
                beyond=", ".join(
                    figure.replace("_", " ")
                    for figure, each in judged.items()
                    if each.verdict == "beyond" and figure != "equivalent_bend"
                ),
                bends=tuple(lines.bends[i].tolist()),
                lengths=tuple(lengths[i].tolist()) if lengths.ndim > 1 else (),
            )
        )
    return tuple(found)


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


# --- plain data --------------------------------------------------------------------------------


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
