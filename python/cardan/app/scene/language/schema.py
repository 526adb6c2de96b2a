"""The format of a scene file: its JSON Schema, and as plain text."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

from cardan.app.scene.language.rules import given_as, in_one_unit, not_both
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.language.units import US, si_key, us_keys
from cardan.app.scene.recording.recorded import BEND_COLUMNS
from cardan.app.scene.sections.driveline import FORMS, LENGTHS, TEETH, only
from cardan.app.scene.sections.load import DRIVE_ANGLES
from cardan.app.scene.study.axes import DEFINITIONS, ENTRIES, AxisValues, NestedAxes


def scene_schema(sections: Mapping[str, Section[Any]]) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scene file of these sections.

    It covers single values, and keys that need or exclude each other. Matching lengths and files
    are checked by ``Scene.parse``.
    """
    top = sections[""]
    described = {name: _section_schema(section) for name, section in sections.items() if name}
    recorded = {"anyOf": [{"required": [key]} for key in BEND_COLUMNS]}
    columns = {"properties": {"angles": recorded}, "required": ["angles"]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scene of a driveline or a ball joint",
        **_section_schema(top),
        "properties": {**_properties(top), **described},
        "$defs": DEFINITIONS,
        "allOf": [
            not_both(*DRIVE_ANGLES),
            {
                "if": columns,
                "then": {"properties": {"driveline": only(*FORMS[0].optional, TEETH, *LENGTHS)}},
                "else": {
                    "if": {"required": ["driveline"]},
                    "then": {
                        "properties": {"driveline": {"oneOf": [form.schema for form in FORMS]}}
                    },
                    "else": {"required": ["ball_joint"], **only(*top.keys, "ball_joint")},
                },
            },
        ],
    }


def _section_schema(section: Section[Any]) -> dict[str, Any]:
    inner = {key: _section_schema(own) for key, own in section.inner.items()}
    described: dict[str, Any] = {
        "type": "object",
        "properties": _properties(section) | inner,
        "additionalProperties": False,
    }
    if section.paths:
        described["patternProperties"] = _pattern_schemas(section)
    if section.fewest:
        described["minProperties"] = section.fewest
    rules = [not_both(*keys) for keys in section.together]
    rules += in_one_unit(key for key in section.keys if us_keys(key))
    rules += [{"anyOf": [given_as(key) for key in keys]} for keys in section.needed]
    if rules:
        described["allOf"] = rules
    if section.with_key:
        described["dependentSchemas"] = {
            way: given_as(part) for key, part in section.with_key for way in (key, *us_keys(key))
        }
    if section.repeated:
        several = {"type": "array", "items": described}
        described = {"oneOf": [described, several]} if "." in section.name else several
    return {"description": section.meaning, **described}


def _properties(section: Section[Any]) -> dict[str, Any]:
    return {
        name: {"description": key.meaning, **key.rule.schema}
        | ({} if key.default is None else {"default": key.default})
        for name, key in section.keys.items()
    }


# What follows a key in a path: an entry, or some; of a vector its component as well.
_PATH_ENTRY = rf"\.{ENTRIES}"


def _pattern_schemas(section: Section[Any]) -> dict[str, Any]:
    """Return JSON Schemas of the paths in quotes that a section may have, by their pattern."""
    found: dict[str, Any] = {}
    for name, key in section.keys.items():
        choices = key.rule.schema.get("anyOf", [key.rule.schema])
        for choice in choices:
            for of_entries in choice.get("patternProperties", {}).values():
                found |= _by_depth(name, key, of_entries)
    return found


def _by_depth(name: str, key: Key, of_entries: Mapping[str, Any]) -> dict[str, Any]:
    described = {"description": key.meaning}
    # Of several ways to vary an entry the first has its components alone.
    components = of_entries.get("oneOf", [of_entries])[0].get("properties")
    if components is None:
        return {f"^{name}{_PATH_ENTRY}$": {**described, **of_entries}}
    values = next(iter(components.values()))
    return {
        f"^{name}{_PATH_ENTRY}$": {**described, **of_entries},
        rf"^{name}{_PATH_ENTRY}\.[xyz]$": {**described, **values},
    }


def describe(sections: Mapping[str, Section[Any]]) -> str:
    """Return the format of a scene file as plain text, at most 77 characters wide."""
    pairs = (f"_{' or _'.join(us)} for _{si}" for si, us in US.items() if si in _GIVEN)
    lines = [*_filled(f"{_UNITS} {', '.join(pairs)}.", "", "  "), ""]
    for section in (each for own in sections.values() for each in (own, *own.inner.values())):
        heading = f"{section.heading}  " if section.name else ""
        lines += _filled(f"{heading}{section.meaning}", "", "  ")
        if section.help_on_paths:
            lines += _filled(section.help_on_paths, "  ", "  ")
        for key, entry in section.keys.items():
            if isinstance(entry.rule, AxisValues | NestedAxes) or si_key(key) != key:
                continue
            default = "" if entry.default is None else f"; default {entry.default}"
            text = f"{entry.kind or entry.rule.name}: {entry.meaning}{default}"
            lines += _filled(text, f"  {key:32}", " " * 36)
        lines.append("")
    return "\n".join(lines)


# Weights are in answers only.
_GIVEN = [si for si in US if si != "kg"]

_UNITS = (
    "The end of a key is its unit. Each key may have a US unit instead, and its value is "
    "then in that:"
)


def _filled(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(
        text, width=77, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False
    )
