"""The answer of ``cardan run`` as plain data, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of, schema_of
from cardan.app.answers.json_schema import answer, answers_with, record
from cardan.app.answers.states.figures import StatesFigures, states_figures
from cardan.app.answers.study.figures import StudyFigures, StudyTable, study_figures
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import TurnFigures
from cardan.app.scene.study.states import StatesResult


def run_data(
    found: Answer,
    turn: TurnFigures | None,
    study: StudyTable | None,
    files: Iterable[Mapping[str, Any]],
    *,
    radians: bool = False,
) -> dict[str, Any]:
    """Return what ``cardan run`` found, as plain data for JSON; of a ball joint without a turn."""
    data = {} if turn is None else data_of(turn, radians=radians)
    if isinstance(study, StatesResult):
        data["states"] = data_of(states_figures(study, radians=radians), radians=radians)
    elif study and found.scene.study:
        samples = len(found.scene.study.angle)
        data["study"] = data_of(study_figures(study, samples, radians=radians), radians=radians)
    data |= {part.name: part.data(each, radians=radians) for part, each in found.parts("run")}
    return answer("run", found.of.title, **data, files=list(files))


def run_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``run_data``."""
    count = {"type": "integer", "minimum": 0}
    file = record({"file": {"type": "string"}}, dict.fromkeys(("rows", "parts", "found"), count))
    return answers_with(
        "run",
        "what cardan run prints with --json",
        schema_of(TurnFigures)["properties"],
        {"ball_joint": PARTS["ball_joint"].schema()},
        needed={"files": {"type": "array", "items": file}},
        optional={
            **{name: part.schema() for name, part in PARTS.items() if "run" in part.shown},
            "states": schema_of(StatesFigures),
            "study": schema_of(StudyFigures),
        },
    )
