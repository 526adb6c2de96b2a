"""The JSON Schema of all answers of the command."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.answers.data import schema_of
from cardan.app.answers.identification.figures import Identified
from cardan.app.answers.json_schema import Kind, answer_schema
from cardan.app.answers.lateral.figures import LateralFigures
from cardan.app.answers.limits.data import check_schema
from cardan.app.answers.optimise.figures import Optimised
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import AllToleranceFigures
from cardan.app.answers.torsion.figures import TorsionFigures
from cardan.app.answers.turn.data import run_schema
from cardan.app.answers.yokes.figures import YokeFigures

_FILES = {
    "files": {"type": "array", "items": {"type": "string"}, "description": "what was written"}
}


def _of_rows(kind: Kind, of: type, more: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the schema of the answer of a command that has the rows of a dataclass."""
    rows = schema_of(of)
    needed = {key: rows["properties"].pop(key) for key in rows["required"]}
    schema = answer_schema(
        kind,
        f"what cardan {kind} prints with --json",
        {**needed, **(more or {})},
        rows["properties"],
    )
    return schema | {key: rows[key] for key in ("allOf",) if key in rows}


def answers_schema() -> dict[str, Any]:
    """Return one schema of which each answer is a definition of its name."""
    of_life = ({"life": PARTS["life"].schema()}, {"tubes": PARTS["tubes"].schema()})
    answers = {
        "run": run_schema(),
        "check": check_schema(),
        "phase": _of_rows("phase", YokeFigures),
        "identify": _of_rows("identify", Identified),
        "optimise": _of_rows("optimise", Optimised, _FILES),
        "tolerances": _of_rows("tolerances", AllToleranceFigures),
        "life": answer_schema("life", "what cardan life prints with --json", *of_life),
        "torsion": _of_rows("torsion", TorsionFigures, _FILES),
        "lateral": _of_rows("lateral", LateralFigures, _FILES),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "answers of cardan in JSON",
        "$defs": answers,
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in answers],
    }
