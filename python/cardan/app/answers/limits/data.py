"""The answer of ``cardan check`` as plain data, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.answers.limits.text import not_judged
from cardan.app.answers.table import PARTS


def check_data(found: Answer, advice: Sequence[str] = ()) -> dict[str, Any]:
    """Return a check as plain data for JSON, as ``check_schema`` describes it."""
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
        moves=PARTS["moves"].data(found["moves"] or ()),
        **{part.name: part.data(each) for part, each in found.parts("check")},
    )


def _figures(description: str) -> dict[str, Any]:
    text = {"type": "string"}
    items = record({"figure": {**text, "description": "its key in the parts below"}, "name": text})
    return {"type": "array", "description": description, "items": items}


def check_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``check_data``."""
    return answer_schema(
        "check",
        "what cardan check prints with --json",
        {
            "verdict": {
                "enum": ["beyond", "not judged", "tolerable", "within"],
                "description": "on everything that has a limit",
            },
            "passes": {"type": "boolean", "description": "whether nothing is beyond its limits"},
            "beyond": _figures("what is beyond its limit, or its maximum where it has one"),
            "tolerable": _figures("what is above its limit but not above its maximum"),
            "not_judged": {
                "type": "array",
                "description": "what is not judged, and why",
                "items": {"type": "string"},
            },
            "advice": {"type": "array", "items": {"type": "string"}},
            "moves": PARTS["moves"].schema(),
        },
        {name: part.schema() for name, part in PARTS.items() if "check" in part.shown},
    )
