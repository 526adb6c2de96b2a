"""The answers of commands as plain data, and the JSON Schema of all of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of, record, schema_of
from cardan.app.answers.identification import Identified
from cardan.app.answers.limits import not_judged
from cardan.app.answers.states import StatesFigures, states_figures
from cardan.app.answers.study import StudyFigures, StudyTable, study_figures
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import TurnFigures
from cardan.app.answers.yokes.figures import YokeFigures
from cardan.app.scene.study.states import StatesResult

VERSION = 2
"""Version of the answers. It grows when a key changes its name or meaning, not for a new key."""

ANGLE = ("deg", "rad")
"""Endings of keys that hold angles: degrees, or with ``--radians`` radians."""

Kind = Literal[
    "run", "check", "phase", "identify", "optimise", "tolerances", "life", "torsion", "lateral"
]
_Schemas = Mapping[str, Any]

_TEXT = {"type": "string"}
_FILES = {"files": {"type": "array", "items": _TEXT, "description": "what was written"}}


def answer(kind: Kind, title: str, **fields: Any) -> dict[str, Any]:  # noqa: ANN401 - plain data
    """Return an answer as plain data for JSON, with what every answer begins with."""
    return {"answer": kind, "version": VERSION, "title": title, **fields}


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
    data |= {part.name: data_of(each, radians=radians) for part, each in found.parts("run")}
    return answer("run", found.of.title, **data, files=list(files))


def check_data(found: Answer, advice: Sequence[str] = ()) -> dict[str, Any]:
    """Return a check as plain data for JSON."""
    return answer(
        "check",
        found.of.title,
        verdict=found.verdict,
        passes=found.passes,
        **{
            verdict: [
                {"figure": each.entry.path, "name": each.name} for each in found.of_verdict(verdict)
            ]
            for verdict in ("beyond", "tolerable")
        },
        not_judged=list(not_judged(found)),
        advice=list(advice),
        moves=data_of(found["moves"] or ()),
        **{part.name: data_of(each) for part, each in found.parts("check")},
    )


def answers_schema() -> dict[str, Any]:
    """Return one schema of which each answer is a definition of its name."""
    of_life = ({"life": PARTS["life"].schema()}, {"tubes": PARTS["tubes"].schema()})
    answers = {
        "run": _run_schema(),
        "check": _check_schema(),
        "phase": _of_rows("phase", YokeFigures),
        "identify": _of_rows("identify", Identified),
        "optimise": _of_rows("optimise", PARTS["optimise"].figures(), _FILES),
        "tolerances": _of_rows("tolerances", PARTS["tolerances"].figures()),
        "life": _answer_schema("life", *of_life),
        "torsion": _of_rows("torsion", PARTS["torsion"].figures(), _FILES),
        "lateral": _of_rows("lateral", PARTS["lateral"].figures(), _FILES),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "answers of cardan in JSON",
        "$defs": answers,
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in answers],
    }


def _answer_schema(
    kind: Kind, needed: _Schemas, optional: _Schemas | None = None
) -> dict[str, Any]:
    """The schema of an answer with keys that it always has and keys that it may have."""
    head = {
        "answer": {"const": kind},
        "version": {"const": VERSION},
        "title": {"type": "string", "description": "heading of the scene, or empty"},
    }
    description = f"what cardan {kind} prints with --json"
    return {"description": description, **record({**head, **needed}, optional)}


def _of_rows(kind: Kind, of: type, more: _Schemas | None = None) -> dict[str, Any]:
    """The schema of the answer of a command that has the rows of a dataclass."""
    rows = schema_of(of)
    needed = {key: rows["properties"].pop(key) for key in rows["required"]}
    schema = _answer_schema(kind, {**needed, **(more or {})}, rows["properties"])
    return schema | {key: rows[key] for key in ("allOf",) if key in rows}


def _parts_of(command: str) -> dict[str, Any]:
    return {name: part.schema() for name, part in PARTS.items() if command in part.shown}


def _run_schema() -> dict[str, Any]:
    """Return the schema of an answer about a driveline, a ball joint or both."""
    count = {"type": "integer", "minimum": 0}
    file = record({"file": _TEXT}, dict.fromkeys(("rows", "parts", "found"), count))
    turn = schema_of(TurnFigures)["properties"]
    more = {"states": schema_of(StatesFigures), "study": schema_of(StudyFigures)}
    needed = {"files": {"type": "array", "items": file}}
    return {
        **_answer_schema("run", needed, {**turn, **_parts_of("run"), **more}),
        "anyOf": [{"required": list(turn)}, {"required": ["ball_joint"]}],
        "dependentRequired": {key: list(turn) for key in turn},
    }


def _check_schema() -> dict[str, Any]:
    def figures(description: str) -> dict[str, Any]:
        key = {**_TEXT, "description": "its key in the parts below"}
        items = record({"figure": key, "name": _TEXT})
        return {"type": "array", "description": description, "items": items}

    needed = {
        "verdict": {
            "enum": ["beyond", "not judged", "tolerable", "within"],
            "description": "on everything that has a limit",
        },
        "passes": {"type": "boolean", "description": "whether nothing is beyond its limits"},
        "beyond": figures("what is beyond its limit, or its maximum where it has one"),
        "tolerable": figures("what is above its limit but not above its maximum"),
        "not_judged": {
            "type": "array",
            "description": "what is not judged, and why",
            "items": _TEXT,
        },
        "advice": {"type": "array", "items": _TEXT},
        "moves": PARTS["moves"].schema(),
    }
    return _answer_schema("check", needed, _parts_of("check"))
