"""Answers as plain data for JSON, and the schema of it, from the rows of their parts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from cardan.app.answers.rows import SI_UNITS, Judged, Row, element_of, rows_of


def record(needed: Mapping[str, Any], optional: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the schema of an object with these keys and no others."""
    return {
        "type": "object",
        "properties": {**needed, **(optional or {})},
        "required": list(needed),
        "additionalProperties": False,
    }


_NUMBER = {"type": ["number", "null"]}
_PLACE = {
    "type": "array",
    "items": record({"key": {"type": "string"}, "value": {"type": "number"}}),
}
_SCHEMAS: Mapping[str, Any] = {
    "numbers": {"type": "array", "items": _NUMBER},
    "place": _PLACE,
    "item": {"type": ["integer", "string"], "minimum": 0},
    "count": {"type": "integer", "minimum": 0},
    "flag": {"type": "boolean"},
}


def data_of(found: Any, *, radians: bool = False) -> Any:  # noqa: ANN401 - plain data
    """Return a part, or a tuple of them, as plain data; what is not a number is null."""
    if isinstance(found, tuple):
        return [data_of(each, radians=radians) for each in found]
    data: dict[str, Any] = {}
    for name, of, hint in rows_of(type(found)):
        row, value = of.beside(found), getattr(found, name)
        if row.is_optional and value in (None, "", ()):
            continue
        if row.kind == "figure" and _is_judged(hint):
            data[name] = None if value is None else _judged(value, row, radians=radians)
        elif row.kind == "figure":
            data[name + row.ending(radians=radians)] = _number(value, row, radians=radians)
        elif row.kind == "numbers":
            key = name + row.ending(radians=radians)
            data[key] = [_number(each, row, radians=radians) for each in value]
        elif row.kind == "parts":
            data[name] = None if value is None else data_of(value, radians=radians)
        elif row.kind == "place":
            data[name] = _place(value)
        else:
            key = row.label.replace(" ", "_") if row.kind == "item" else name
            data[key] = list(value) if isinstance(value, tuple) else value
    return data


def _place(at: Mapping[str, float]) -> list[dict[str, Any]]:
    return [{"key": key, "value": value} for key, value in at.items()]


def _is_judged(hint: Any) -> bool:  # noqa: ANN401 - any annotation
    return Judged in (hint, *get_args(hint))


def _number(value: float | None, row: Row, *, radians: bool) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    return float(row.shown(value, radians=radians))


def _judged(value: Judged, row: Row, *, radians: bool) -> dict[str, Any]:
    ending = row.ending(radians=radians)
    numbers = {"value": value.value, "limit": value.limit, "maximum": value.maximum}
    data: dict[str, Any] = {"verdict": value.verdict} if row.limit else {}
    for name, number in numbers.items():
        if name == "value" or (row.limit and (name == "limit" or number is not None)):
            data[name + ending] = _number(number, row, radians=radians)
    if value.limit is not None:
        data["source"] = value.source
    if value.state:
        data["state"] = value.state
    if value.at:
        data["at"] = _place(value.at)
    if value.each:
        data["states"] = [
            {"state": name, f"value{ending}": _number(each, row, radians=radians)}
            for name, each in value.each.items()
        ]
    if value.why:
        data["why"] = value.why
    return data


def schema_of(of: type) -> dict[str, Any]:
    """Return the JSON Schema of a part, with angles in either unit."""
    needed: dict[str, Any] = {}
    choices: list[dict[str, Any]] = []
    optional: dict[str, Any] = {}
    for name, row, hint in rows_of(of):
        described = {"title": row.label, "description": row.meaning} if row.meaning else {}
        whole = {**_schema(row, hint), **described}
        keys = dict.fromkeys(_keys(name, row, hint), whole)
        if row.is_optional:
            optional |= keys
        elif len(keys) > 1:
            choices.append(keys)
        else:
            needed |= keys
    chosen = {key: value for choice in choices for key, value in choice.items()}
    schema = record(needed, {**chosen, **optional})
    if choices:
        schema["allOf"] = [{"oneOf": [{"required": [key]} for key in keys]} for keys in choices]
    return schema


def _keys(name: str, row: Row, hint: Any) -> list[str]:  # noqa: ANN401 - any annotation
    """The keys of which JSON has one: of an angle, of a figure with its own unit, of an item."""
    if row.kind == "item":
        return ["shaft", "joint", "bearing"] if row.own else [row.label.replace(" ", "_")]
    if row.kind not in ("figure", "numbers") or _is_judged(hint):
        return [name]
    units = SI_UNITS if row.own == "each" else [row.unit]
    every = (
        replace(row, unit=unit).ending(radians=radians)
        for unit in units
        for radians in (False, True)
    )
    return [f"{name}{ending}" for ending in dict.fromkeys(every)]


def _schema(row: Row, hint: Any) -> dict[str, Any]:  # noqa: ANN401 - any annotation
    if row.kind == "figure":
        return _or_null(_judged_schema(row), hint) if _is_judged(hint) else _NUMBER
    if row.kind == "parts":
        items = schema_of(element_of(hint))
        several = get_origin(hint) is tuple
        return _or_null({"type": "array", "items": items} if several else items, hint)
    return dict(_SCHEMAS.get(row.kind) or _word(hint))


def _or_null(schema: dict[str, Any], hint: Any) -> dict[str, Any]:  # noqa: ANN401 - annotation
    return {"oneOf": [schema, {"type": "null"}]} if NoneType in get_args(hint) else schema


def _word(hint: Any) -> dict[str, Any]:  # noqa: ANN401 - any annotation
    if get_origin(hint) is Literal:
        return {"enum": list(get_args(hint))}
    if get_origin(hint) is tuple:
        return {
            "type": "array",
            "items": {"type": "integer" if int in get_args(hint) else "string"},
        }
    return {"type": ["string", "null"] if NoneType in get_args(hint) else "string"}


def _judged_schema(row: Row) -> dict[str, Any]:
    endings = dict.fromkeys((row.ending(), row.ending(radians=True)))
    values = {f"value{ending}": _NUMBER for ending in endings}
    limits = {f"{name}{ending}": _NUMBER for name in ("limit", "maximum") for ending in endings}
    state = {"type": "string", "description": "state, step or driveline in which it is worst"}
    more = {
        "state": state,
        "at": _PLACE,
        "states": {"type": "array", "items": record({"state": {"type": "string"}}, values)},
    }
    if not row.limit:
        return record({}, values | more)
    verdict = {"enum": ["not judged", "within", "tolerable", "beyond"]}
    text = {"type": "string"}
    return record({"verdict": verdict}, values | limits | more | {"source": text, "why": text})
