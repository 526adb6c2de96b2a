"""The JSON Schema of a scene file."""

from __future__ import annotations

from typing import Any

from cardan.app.scene.axis_rules import Values
from cardan.app.scene.bearing_section import LENGTHS
from cardan.app.scene.format import BEND_COLUMNS, DRIVE_ANGLES, FORMAT
from cardan.app.scene.forms import FORMS, TEETH, only
from cardan.app.scene.paths import pattern_schemas
from cardan.app.scene.sections import Section


def scene_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scene file, for editors and other tools.

    It covers single values, and keys that need or exclude each other. Matching lengths and files
    are checked by ``Scene.parse``.
    """
    top, *names = FORMAT
    sections = {name: _section_schema(FORMAT[name]) for name in names}
    recorded = {"anyOf": [{"required": [key]} for key in BEND_COLUMNS]}
    columns = {"properties": {"angles": recorded}, "required": ["angles"]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scene of a driveline or a ball joint",
        **_section_schema(FORMAT[top]),
        "properties": {**_properties(FORMAT[top]), **sections},
        "$defs": {"values": Values().definition},
        "allOf": [
            _not_both(*DRIVE_ANGLES),
            {
                "if": columns,
                "then": {"properties": {"driveline": only(*FORMS[0].optional, TEETH, *LENGTHS)}},
                "else": {
                    "if": {"required": ["driveline"]},
                    "then": {
                        "properties": {"driveline": {"oneOf": [form.schema for form in FORMS]}}
                    },
                    "else": {"required": ["ball_joint"], **only(*FORMAT[top].keys, "ball_joint")},
                },
            },
        ],
    }


def _section_schema(section: Section) -> dict[str, Any]:
    described: dict[str, Any] = {
        "type": "object",
        "properties": _properties(section),
        "additionalProperties": False,
    }
    if section.paths:
        described["patternProperties"] = pattern_schemas(section)
    if section.fewest:
        described["minProperties"] = section.fewest
    rules = [_not_both(*keys) for keys in section.together]
    rules += [{"anyOf": [{"required": [key]} for key in keys]} for keys in section.needed]
    if rules:
        described["allOf"] = rules
    if section.with_key:
        described["dependentRequired"] = {key: [part] for key, part in section.with_key}
    if section.repeated:
        described = {"type": "array", "items": described}
    return {"description": section.meaning, **described}


def _properties(section: Section) -> dict[str, Any]:
    return {
        name: {"description": key.meaning, **key.kind.rule.schema}
        | ({} if key.default is None else {"default": key.default})
        for name, key in section.keys.items()
    }


def _not_both(*keys: str) -> dict[str, Any]:
    return {"not": {"required": list(keys)}}
