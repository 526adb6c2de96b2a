"""The examples as texts with parts replaced, and the schemas of scenes and answers."""

from __future__ import annotations

from pathlib import Path

import jsonschema

from cardan.figures.schema import answers_schema
from cardan.scene import Scene

ANSWERS = jsonschema.Draft202012Validator(answers_schema())
SCENES = jsonschema.Draft202012Validator(Scene.schema())


def example(name: str) -> Path:
    """Return the path of an example."""
    return Path(__file__).parents[1] / "examples" / name


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    """Return a text with parts replaced, each of which stands in it once."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text
