"""The command ``cardan phase``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.data import data_of
from cardan.app.answers.json_schema import answer
from cardan.app.answers.yokes.figures import yoke_settings
from cardan.app.answers.yokes.text import yoke_text
from cardan.app.command.options import json_option, scene_argument
from cardan.app.command.terminal import as_json_text, say
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@json_option
def phase(scene: Path, as_json: bool) -> None:
    """Say how to set the yokes so that the last shaft turns as evenly as possible.

    Each setting is an angle and a sense, looking from the drive towards the output. If the scene
    gives the teeth of the splines, the best teeth are found as well. The answer names the
    arrangement, what is left at the best setting and what would bring it within the limit. It
    compares the exact figure with the catalogues' root rule.

    \b
    Examples:
      cardan phase shaft.toml
      cardan phase shaft.toml --json
    """
    loaded = Scene.load(scene)
    found = yoke_settings(loaded)
    if as_json:
        say(as_json_text(answer("phase", loaded.title, **data_of(found))))
        return
    say(yoke_text(loaded.title, found))
