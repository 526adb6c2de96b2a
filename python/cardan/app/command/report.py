"""The command ``cardan report``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.command.files import check_output
from cardan.app.command.options import file_option, scene_argument
from cardan.app.command.terminal import progress_bar, say
from cardan.app.report import write_report
from cardan.app.scene import load_scene
from cardan.arrays import import_optional


@click.command()
@scene_argument
@file_option("--output", "Page to write; default: the scene's name with .html.")
def command(scene: Path, output: Path | None) -> None:
    """Write a page to share, with a slider that turns the driveline.

    The page says whether the driveline runs smoothly, which loads the bearings carry and how to set
    the yokes. It shows the inputs, tables and curves. It is a single HTML file that needs no
    network.

    \b
    Examples:
      cardan report shaft.toml
      cardan report shaft.toml --output shaft.html
    """
    path = output or Path(f"{scene.stem}.html")
    loaded = load_scene(scene)
    check_output(loaded, path)
    import_optional("jinja2", "app")
    with progress_bar() as progress:
        write_report(loaded, path, progress)
    say(f"wrote {path}")
