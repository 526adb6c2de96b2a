"""Paths of a scene's keys in quotes, such as ``"points_mm.2.y"``, as the tables they stand for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.scene.language.section import Key, Section
from cardan.arrays.errors import ArgumentValueError

# What follows a key in a path: an entry, or some; of a vector its component as well.
_ENTRY = r"\.[0-9]{1,9}(-[0-9]{1,9})?"


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section with its quoted paths as TOML reads bare ones: tables within tables.

    >>> nested({"points_mm.2.y": [1, 2]})
    {'points_mm': {'2': {'y': [1, 2]}}}

    Raises:
        ValueError: a path that is given twice, or is given together with its beginning.
    """
    made: dict[str, Any] = {}
    for path, value in values.items():
        *tables, last = path.split(".")
        _merge(made, _within(tables, {last: value}), path, "")
    return made


def _within(tables: list[str], value: dict[str, Any]) -> dict[str, Any]:
    for name in reversed(tables):
        value = {name: value}
    return value


def _merge(made: dict[str, Any], more: Mapping[str, Any], path: str, above: str) -> None:
    for key, value in more.items():
        here = f"{above}.{key}" if above else key
        if isinstance(value, dict):
            inner = made.setdefault(key, {})
            if isinstance(inner, dict):
                _merge(inner, value, path, here)
                continue
        elif key not in made:
            made[key] = value
            continue
        if here.startswith(path):
            raise ArgumentValueError(here, "is given twice, with quotes and without")
        raise ArgumentValueError(path, f"and {here} are both given; give one of them")


def pattern_schemas(section: Section) -> dict[str, Any]:
    """Return JSON Schemas of the paths in quotes that a section may have, by their pattern."""
    found: dict[str, Any] = {}
    for name, key in section.keys.items():
        choices = key.kind.rule.schema.get("anyOf", [key.kind.rule.schema])
        for choice in choices:
            for of_entries in choice.get("patternProperties", {}).values():
                found |= _by_depth(name, key, of_entries)
    return found


def _by_depth(name: str, key: Key, of_entries: Mapping[str, Any]) -> dict[str, Any]:
    described = {"description": key.meaning}
    components = of_entries.get("properties")
    if components is None:
        return {f"^{name}{_ENTRY}$": {**described, **of_entries}}
    values = next(iter(components.values()))
    return {
        f"^{name}{_ENTRY}$": {**described, **of_entries},
        rf"^{name}{_ENTRY}\.[xyz]$": {**described, **values},
    }
