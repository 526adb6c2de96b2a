"""Values for the keys of scenes at random: what a schema takes, what is near it, and any other."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Mapping
from typing import Any

from hypothesis import strategies as st

from cardan.app.scene import Scene

DEFINITIONS = Scene.schema()["$defs"]


def fitting(schema: Mapping[str, Any]) -> st.SearchStrategy[Any]:
    """Values that a schema takes; of the part of JSON Schema that scenes use."""
    if "$ref" in schema:
        return fitting(DEFINITIONS[schema["$ref"].rsplit("/", 1)[1]])
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    for several in ("oneOf", "anyOf"):
        if several in schema and "type" not in schema:
            return st.one_of(*map(fitting, schema[several]))
    made: Mapping[str, Callable[[Mapping[str, Any]], st.SearchStrategy[Any]]] = {
        "string": lambda s: _matching(s["pattern"]) if "pattern" in s else st.text(max_size=3),
        "number": _numbers,
        "integer": lambda s: st.integers(s.get("minimum", 1), 9),
        "array": lambda s: st.lists(
            fitting(s["items"]),
            min_size=s.get("minItems", 0),
            max_size=s.get("maxItems", 3),
            unique=s.get("uniqueItems", False),
        ),
        "object": _objects,
    }
    return made[schema["type"]](schema)


def _matching(pattern: str) -> st.SearchStrategy[str]:
    return st.from_regex(pattern, alphabet=st.characters(max_codepoint=0x17F))


def _numbers(schema: Mapping[str, Any]) -> st.SearchStrategy[Any]:
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    above, below = "minimum" not in schema, "maximum" not in schema
    within = st.floats(low, high, exclude_min=above, exclude_max=below)
    ends = [schema[end] for end in ("minimum", "maximum") if end in schema]
    small = st.integers(0, 40).filter(lambda number: low < number < high)
    return st.one_of(within, small, *map(st.just, ends))


def _objects(schema: Mapping[str, Any]) -> st.SearchStrategy[Any]:
    places = schema.get("patternProperties")
    if places and "properties" not in schema:
        return st.sampled_from(sorted(places)).flatmap(
            lambda pattern: st.dictionaries(
                st.from_regex(pattern, alphabet=st.characters(max_codepoint=0x17F)).map(str.strip),
                fitting(places[pattern]),
                min_size=1,
                max_size=2,
            )
        )
    parts = {key: fitting(part) for key, part in schema["properties"].items()}
    needed = {key: parts.pop(key) for key in schema.get("required", ())}
    made = st.fixed_dictionaries(needed, optional=parts)
    return made.filter(lambda given: len(given) >= schema.get("minProperties", 0))


def nearly(value: Any) -> st.SearchStrategy[Any]:  # noqa: ANN401 - any value of TOML
    """Values with something about them changed: an entry more or less, the next number."""
    if isinstance(value, dict):
        keys = st.sampled_from(["", "x", "0", "0-", "1-2", "from", "w", "0000000001"])
        changed = [keys.map(lambda key: {**value, key: [1]})]
        for own, entry in value.items():
            changed.append(st.just({key: value[key] for key in value if key != own}))
            changed.append(nearly(entry).map(functools.partial(_replaced, value, own)))
        return st.one_of(changed)
    if isinstance(value, list):
        lists = [st.just(value[:-1]), st.just(value + value[:1]), st.just([value])]
        lists += [nearly(value[0]).map(lambda new: [new, *value[1:]])] if value else []
        return st.one_of(*lists)
    if isinstance(value, str):
        ends = ["", " ", "/", "\\", ".csv", "..", "a/b.csv", ".svg", "/.csv", "a\n.csv", ".csv\n"]
        return st.sampled_from(ends).flatmap(
            lambda end: st.sampled_from([value + end, end + value, end, value[1:], value.upper()])
        )
    if isinstance(value, bool):
        return st.integers(0, 1)
    near = [-value, value - 1, float(value), str(value), True, 2 * value, [value], {"from": value}]
    others = [0, -1, 0.5, 1, 89.5, 90, -90, 1e12, 1e40, -1e41, math.inf, math.nan]
    beside = [math.nextafter(end, math.inf) for end in (1e12, 1e40)]
    return st.sampled_from([*near, *others, *beside])


def _replaced(section: dict[str, Any], key: str, value: Any) -> dict[str, Any]:  # noqa: ANN401
    return {**section, key: value}


VALUES = st.recursive(
    st.one_of(
        st.booleans(),
        st.integers(-3, 100),
        st.integers(-(2**70), 2**70),
        st.floats(),
        st.lists(st.floats(-89, 89), min_size=1, max_size=4),
        st.text(max_size=5),
        st.sampled_from(["peak", "k", "angle", "a.csv", "a_run.csv", "crank_deg"]),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(["from", "to", "steps", "0", "1", "y"]), inner, max_size=3),
    ),
    max_leaves=6,
)


def as_toml(value: Any) -> str:  # noqa: ANN401 - any value of TOML
    if isinstance(value, dict):
        return "{" + ", ".join(f"{as_toml(key)} = {as_toml(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    # JSON writes text and booleans as TOML does, and numbers as well but for these.
    if isinstance(value, float):
        return str(value)
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
