"""The JSON Schema of all answers of the command."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.identification.figures import IDENTIFY_SCHEMA
from cardan.app.answers.json_schema import answer_schema
from cardan.app.answers.limits.data import check_schema
from cardan.app.answers.optimise.figures import OPTIMISE_SCHEMA
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import TOLERANCES_SCHEMA
from cardan.app.answers.torsion.figures import TORSION_SCHEMA
from cardan.app.answers.turn.data import run_schema
from cardan.app.answers.yokes.figures import PHASE_SCHEMA


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
        "phase": PHASE_SCHEMA,
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
