"""The commands that draw: ``plot`` and ``report``."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import get_args

import click

from cardan.app.answers.table import pictures
from cardan.app.answers.turn.panel import Over
from cardan.app.command.options import check_output, file_option, in_units, scene_argument
from cardan.app.command.terminal import progress_bar, say
from cardan.app.files.columns import PICTURES as SUFFIXES
from cardan.app.plots import plot_part, save, write_picture
from cardan.app.report import write_report
from cardan.app.scene import load_scene
from cardan.app.scene.scene import BallJointScene
from cardan.arrays import import_optional
from cardan.arrays.errors import ArgumentValueError

_ENDINGS = " or ".join((", ".join([*SUFFIXES][:-1]), [*SUFFIXES][-1]))

_PICTURES = pictures()

_EPILOG = "\b\nNAME is one of\n" + "\n".join(
    f"  {name:14}{(draw.__doc__ or '').partition('.')[0]}" for name, draw in _PICTURES.items()
)


@click.command(epilog=_EPILOG)
@scene_argument
@file_option(
    "--output", f"Picture to write; it ends in {_ENDINGS}. Default: the scene's name with .svg."
)
@click.option(
    "--what",
    type=click.Choice(list(_PICTURES)),
    metavar="NAME",
    help="Draw this picture of a part of the answer; they are listed below.",
)
@click.option(
    "--study",
    metavar="FIGURE",
    help="Draw this figure of the study or of the states: curves over one key, a map over two.",
)
@click.option(
    "--over",
    type=click.Choice(get_args(Over)),
    help="Draw over this; default: the time where it was recorded, else the turns. Orders "
    "are multiples of the drive's rotation.",
)
def plot(
    scene: Path, output: Path | None, what: str | None, study: str | None, over: Over | None
) -> None:
    """Draw a scene and write the picture to a file.

    By default the picture shows the driveline, its key figures and its curves over the turn. The
    options draw something else.

    \b
    Examples:
      cardan plot shaft.toml
      cardan plot shaft.toml --output shaft.png
      cardan plot shaft.toml --over orders
      cardan plot conveyor.toml --what life
    """
    options = {"--what": what, "--over": over, "--study": study}
    given = [name for name, value in options.items() if value is not None]
    if len(given) > 1:
        raise click.UsageError(f"{given[0]} does not go with {given[1]}")
    path = output or Path(f"{scene.stem}.svg")
    loaded = in_units(load_scene(scene))
    if isinstance(loaded, BallJointScene) and study is not None:
        raise ValueError("--study needs a scene with sections [driveline] and [study]")
    check_output(loaded, path)
    if isinstance(loaded, BallJointScene) or what is not None:
        save(plot_part(loaded, what or "ball_joint"), path)
        say(f"wrote {path}")
        return
    with progress_bar() as progress:
        result = loaded.run(progress)
    try:
        write_picture(result, path, study, over=over)
    except ArgumentValueError as error:
        option = {"column": "--study", "over": "--over"}.get(error.argument)
        if option is None:
            raise
        raise ValueError(f"{option} {error.problem}") from None
    say(f"wrote {path}")


@click.command()
@scene_argument
@file_option("--output", "Page to write; default: the scene's name with .html.")
@click.option("--open", "shown", is_flag=True, help="Open the page in the browser as well.")
def report(scene: Path, output: Path | None, shown: bool) -> None:
    """Write a page to share, in which the driveline can be moved and turned.

    The page says whether the driveline runs smoothly, which loads its bearings carry and how to set
    its yokes. It shows inputs, tables and curves. Move a joint in its drawing, and the verdict
    follows. It is a single HTML file that needs no network.

    \b
    Examples:
      cardan report shaft.toml
      cardan report shaft.toml --output shaft.html
      cardan report shaft.toml --open
    """
    path = output or Path(f"{scene.stem}.html")
    loaded = in_units(load_scene(scene))
    check_output(loaded, path)
    import_optional("jinja2", "app")
    with progress_bar() as progress:
        write_report(loaded, path, progress)
    say(f"wrote {path}")
    if shown and not webbrowser.open(path.absolute().as_uri()):
        raise ValueError(f"--open has found no browser; open {path} yourself")
