"""The examples as texts with parts replaced, and the schemas of scenes and answers."""

from __future__ import annotations

from pathlib import Path

import jsonschema

from cardan.figures.schema import answers_schema
from cardan.scene import Scene

_ROOT = Path(__file__).parents[1]
_MACHINES = _ROOT / "python" / "cardan" / "scene" / "machines"
EXAMPLES = sorted([*(_ROOT / "examples").glob("*.toml"), *_MACHINES.glob("*.toml")])
"""The scenes of the folder of examples and those of the machines."""

ANSWERS = jsonschema.Draft202012Validator(answers_schema())
SCENES = jsonschema.Draft202012Validator(Scene.schema())


def example(name: str) -> Path:
    """Return the path of an example or of the scene of a machine."""
    machine = _MACHINES / name
    return machine if machine.exists() else _ROOT / "examples" / name


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    """Return a text with parts replaced, each of which stands in it once."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text
