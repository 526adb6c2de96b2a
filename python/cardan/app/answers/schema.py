"""The JSON Schema of all answers of the command."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.answers.identification.figures import IDENTIFY_SCHEMA
from cardan.app.answers.json_schema import answer_schema
from cardan.app.answers.limits.data import CHECK_SCHEMA
from cardan.app.answers.optimise.figures import OPTIMISE_SCHEMA
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.data import TOLERANCES_SCHEMA
from cardan.app.answers.torsion.data import TORSION_SCHEMA
from cardan.app.answers.turn.data import RUN_SCHEMA
from cardan.app.answers.yokes.figures import PHASE_SCHEMA

LIFE_SCHEMA = answer_schema(
    "life",
    "what cardan life prints with --json",
    {"life": PARTS["life"].schema()},
    {"tubes": PARTS["tubes"].schema()},
)
"""JSON Schema of the answer of ``cardan life``."""

_ANSWERS: Mapping[str, Any] = {
    "run": RUN_SCHEMA,
    "check": CHECK_SCHEMA,
    "phase": PHASE_SCHEMA,
    "identify": IDENTIFY_SCHEMA,
    "optimise": OPTIMISE_SCHEMA,
    "tolerances": TOLERANCES_SCHEMA,
    "life": LIFE_SCHEMA,
    "torsion": TORSION_SCHEMA,
}


def answers_schema() -> dict[str, Any]:
    """Return one schema of which each answer is a definition of its name."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "answers of cardan in JSON",
        "$defs": dict(_ANSWERS),
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in _ANSWERS],
    }
