"""The JSON Schema of all answers of the command."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.data import schema_of
from cardan.app.answers.identification.figures import IDENTIFY_SCHEMA
from cardan.app.answers.json_schema import Kind, answer_schema
from cardan.app.answers.limits.data import check_schema
from cardan.app.answers.optimise.figures import OPTIMISE_SCHEMA
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import TOLERANCES_SCHEMA
from cardan.app.answers.torsion.figures import TORSION_SCHEMA
from cardan.app.answers.turn.data import run_schema
from cardan.app.answers.yokes.figures import YokeFigures


def _of_rows(kind: Kind, of: type) -> dict[str, Any]:
    """Return the schema of the answer of a command that has the rows of a dataclass."""
    rows = schema_of(of)
    needed = {key: rows["properties"].pop(key) for key in rows["required"]}
    said = f"what cardan {kind} prints with --json"
    schema = answer_schema(kind, said, needed, rows["properties"])
    return schema | {key: rows[key] for key in ("allOf",) if key in rows}


def life_schema() -> dict[str, Any]:
    """Return the JSON Schema of the answer of ``cardan life``."""
    return answer_schema(
        "life",
        "what cardan life prints with --json",
        {"life": PARTS["life"].schema()},
        {"tubes": PARTS["tubes"].schema()},
    )


def answers_schema() -> dict[str, Any]:
    """Return one schema of which each answer is a definition of its name."""
    answers = {
        "run": run_schema(),
        "check": check_schema(),
        "phase": _of_rows("phase", YokeFigures),
        "identify": IDENTIFY_SCHEMA,
        "optimise": OPTIMISE_SCHEMA,
        "tolerances": TOLERANCES_SCHEMA,
        "life": life_schema(),
        "torsion": TORSION_SCHEMA,
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "answers of cardan in JSON",
        "$defs": answers,
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in answers],
    }
