"""The command ``cardan explain``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.command.options import scene_argument
from cardan.app.command.terminal import say
from cardan.app.scene import load_scene
from cardan.app.scene.scene import Scene
from cardan.arrays.errors import ArgumentValueError


@click.command()
@scene_argument
@click.argument("key", required=False)
def command(scene: Path, key: str | None) -> None:
    """Explain a figure of a scene: its meaning, formula, source, inputs and limit.

    Keys are those of "cardan check SCENE --json", such as spline.travel or tubes.1.stress.

    Without KEY, describe how the scene and its study are evaluated: the steps, what is skipped and
    why, and the memory that each sample needs.

    \b
    Examples:
      cardan explain shaft.toml
      cardan explain shaft.toml limits.equivalent_bend
    """
    if key is None:
        say(Scene.load(scene).explain())
        return
    # Without a key the answer is not needed.
    from cardan.app.answers.answer import Answer
    from cardan.app.answers.explain import explain_text

    try:
        say(explain_text(Answer(load_scene(scene)), key, scene))
    except ArgumentValueError as error:
        raise ValueError(f"KEY {error.problem}") from None
