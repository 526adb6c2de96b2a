"""The JSON Schema of all answers of the command."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.figures.identification import IDENTIFY_SCHEMA
from cardan.app.figures.life_answer import LIFE_SCHEMA
from cardan.app.figures.limits import CHECK_SCHEMA
from cardan.app.figures.optimise import OPTIMISE_SCHEMA
from cardan.app.figures.run import RUN_SCHEMA
from cardan.app.figures.tolerance_answers import TOLERANCES_SCHEMA
from cardan.app.figures.torsion_answer import TORSION_SCHEMA
from cardan.app.figures.yokes import PHASE_SCHEMA

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
