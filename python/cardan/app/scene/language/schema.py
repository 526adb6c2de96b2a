"""The JSON Schema of a scene file."""

from __future__ import annotations

import textwrap
from typing import Any

from cardan.app.scene.language.paths import pattern_schemas
from cardan.app.scene.language.section import Section
from cardan.app.scene.sections.bearing_section import LENGTHS
from cardan.app.scene.sections.driveline import FORMS, TEETH, only
from cardan.app.scene.sections.table import BEND_COLUMNS, DRIVE_ANGLES, FORMAT, OF_STATES
from cardan.app.scene.study.axis_rules import Values


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


_STUDY_HELP = """\
Give a key of [driveline], [load] or a [[bearing]] the value {from = …, to = …, steps = …} (both \
ends included) or a list of numbers. bends_deg varies all entries of a list alike, bends_deg.0 the \
first, and bends_deg.0-1 the first two. points_mm.2.y varies one coordinate of a point. The \
key bearing moves bearings: bearing.0.position_mm.\
"""

_PATHS_HELP = {
    "study": _STUDY_HELP,
    "states": "Give keys of [driveline] or [load] their values in each state, as in [study]; all "
    "lists have one entry per state. Paths may be in quotes.",
}


def describe() -> str:
    """Return the format of a scene file as plain text, at most 77 characters wide."""
    lines = []
    for name, section in FORMAT.items():
        heading = f"{section.heading(name)}  " if name else ""
        lines += _filled(f"{heading}{section.meaning}", "", "  ")
        if name in _PATHS_HELP:
            lines += _filled(_PATHS_HELP[name], "  ", "  ")
            listed = OF_STATES if name == "states" else {}
        else:
            listed = section.keys
        for key, entry in listed.items():
            default = "" if entry.default is None else f"; default {entry.default}"
            text = f"{entry.kind.name}: {entry.meaning}{default}"
            lines += _filled(text, f"  {key:32}", " " * 36)
        lines.append("")
    return "\n".join(lines)


def _filled(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(
        text, width=77, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False
    )
