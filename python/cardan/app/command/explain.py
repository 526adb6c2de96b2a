"""The command ``cardan explain``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.command.options import scene_argument
from cardan.app.command.terminal import say
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
def command(scene: Path) -> None:
    """Describe how a scene and its study are evaluated: the steps, what is skipped and why,
    and the memory that each sample needs.

    \b
    Example:
      cardan explain shaft.toml
    """
    say(Scene.load(scene).explain())
