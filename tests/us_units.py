"""Scenes in US units: the text of a scene with every value in them, made by the table of units."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from cardan.app.scene.language.units import ENDINGS, split, us_keys
from cardan.app.scene.scene import FORMAT
from scene_values import as_toml

# What stands beside a value in a table and has a unit of its own, or none.
_OWN_UNIT = ("turn_deg", "axis", "steps")

_Change = Callable[[str, float], tuple[str, float]]


def us_scene(text: str, units: str = "") -> str:
    """Return a scene with its keys and values in US units, and with units for its answers."""
    return (f'units = "{units}"\n' if units else "") + _changed(text, _to_us)


def si_scene(text: str) -> str:
    """Return a scene with the numbers that its values in US units make, as near as they round."""
    return _changed(text, _there_and_back)


def _to_us(key: str, value: float) -> tuple[str, float]:
    other = us_keys(key)[0]
    return other, value / ENDINGS[split(other)[1]].size


def _there_and_back(key: str, value: float) -> tuple[str, float]:
    other, given = _to_us(key, value)
    return key, given * ENDINGS[split(other)[1]].size


def _changed(text: str, change: _Change) -> str:
    given = tomllib.loads(text)
    lines = [f"{k} = {as_toml(v)}" for k, v in given.items() if not _tables(v)]
    for name, section in given.items():
        for table in _tables(section):
            lines.append(FORMAT[name].heading)
            entries = _table(table, change).items()
            lines += [f"{as_toml(key) if '.' in key else key} = {as_toml(v)}" for key, v in entries]
    return "\n".join(lines) + "\n"


def _tables(value: Any) -> list[dict[str, Any]]:  # noqa: ANN401 - any value of TOML
    tables = value if isinstance(value, list) else [value]
    return tables if all(isinstance(each, dict) for each in tables) else []


def _table(table: Mapping[str, Any], change: _Change) -> dict[str, Any]:
    return dict(_entry(path, value, change) for path, value in table.items())


def _entry(path: str, value: Any, change: _Change) -> tuple[str, Any]:  # noqa: ANN401
    for part in path.split("."):
        if us_keys(part):
            return path.replace(part, change(part, 0.0)[0]), _value(value, part, change)
    if isinstance(value, list) and value and _tables(value):
        return path, [_table(each, change) for each in value]
    return path, _table(value, change) if isinstance(value, dict) else value


def _value(value: Any, key: str, change: _Change) -> Any:  # noqa: ANN401 - any value of TOML
    if isinstance(value, list):
        return [_value(each, key, change) for each in value]
    if isinstance(value, dict):
        inner = partial(_value, key=key, change=change)
        return {
            change(own, 0.0)[0] if us_keys(own) else own: each if own in _OWN_UNIT else inner(each)
            for own, each in value.items()
        }
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return change(key, value)[1] if is_number else value
