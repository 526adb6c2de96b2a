"""What all JSON answers of the command have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

VERSION = 2
"""Version of the answers. It grows when a key changes its name or meaning, not for a new key."""

ANGLE = ("deg", "rad")
"""Endings of keys that hold angles: degrees, or with ``--radians`` radians."""

Kind = Literal[
    "run", "check", "phase", "identify", "optimise", "tolerances", "life", "torsion", "lateral"
]
_Schemas = Mapping[str, Any]


def answer(kind: Kind, title: str, **fields: Any) -> dict[str, Any]:  # noqa: ANN401 - plain data
    """Return an answer as plain data for JSON, with what every answer begins with."""
    return {"answer": kind, "version": VERSION, "title": title, **fields}


def answer_schema(
    kind: Kind, description: str, needed: _Schemas, optional: _Schemas | None = None
) -> dict[str, Any]:
    """Return the JSON Schema of an answer.

    Args:
        kind: which answer.
        description: what it is.
        needed: schemas of the keys that it always has beside those of every answer.
        optional: schemas of the keys that it may have.
    """
    head = {
        "answer": {"const": kind},
        "version": {"const": VERSION},
        "title": {"type": "string", "description": "heading of the scene, or empty"},
    }
    return {"description": description, **record({**head, **needed}, optional)}


def answers_with(
    kind: Kind,
    description: str,
    of_driveline: _Schemas,
    of_ball_joint: _Schemas,
    *,
    needed: _Schemas | None = None,
    optional: _Schemas | None = None,
) -> dict[str, Any]:
    """Return the schema of an answer for a driveline, a ball joint or both.

    Args:
        kind: which answer.
        description: what it is.
        of_driveline: schemas of the keys of a driveline, all or none of which it has.
        of_ball_joint: the same of a ball joint.
        needed: schemas of the keys that it has in every case.
        optional: schemas of the keys that it may have.
    """
    more = {**of_driveline, **of_ball_joint, **(optional or {})}
    schema = answer_schema(kind, description, needed or {}, more)
    schema["anyOf"] = [{"required": list(keys)} for keys in (of_driveline, of_ball_joint)]
    schema["dependentRequired"] = {key: list(of_driveline) for key in of_driveline}
    return schema


def record(needed: _Schemas, optional: _Schemas | None = None) -> dict[str, Any]:
    """Return the schema of an object with these keys and no others."""
    return {
        "type": "object",
        "properties": {**needed, **(optional or {})},
        "required": list(needed),
        "additionalProperties": False,
    }


def one_of(
    needed: _Schemas, *choices: _Schemas, optional: _Schemas | None = None
) -> dict[str, Any]:
    """Return the schema of an object that also has exactly one key of each choice."""
    chosen = {key: value for choice in choices for key, value in choice.items()}
    schema = record(needed, {**chosen, **(optional or {})})
    if choices:
        schema["allOf"] = [{"oneOf": [{"required": [key]} for key in choice]} for choice in choices]
    return schema
