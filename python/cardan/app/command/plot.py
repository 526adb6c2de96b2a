"""The command ``cardan plot``."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import click

from cardan.app.answers.axial_travel.figures import drawn_slides
from cardan.app.answers.backlash.figures import drawn_backlash
from cardan.app.answers.ball_joint.picture import write_ball_joint_picture
from cardan.app.answers.forces.paths import scene_force_paths
from cardan.app.answers.turn.abscissa import Over
from cardan.app.command.files import check_output, check_picture
from cardan.app.command.options import file_option, scene_argument
from cardan.app.command.terminal import progress_bar, say
from cardan.app.files.pictures import SUFFIXES
from cardan.app.plots import plot_forces, save, write_backlash, write_picture, write_slides
from cardan.app.scene import load_scene
from cardan.app.scene.scene import BallJointScene
from cardan.arrays.errors import ArgumentValueError

_ENDINGS = " or ".join((", ".join([*SUFFIXES][:-1]), [*SUFFIXES][-1]))


@click.command()
@scene_argument
@file_option(
    "--output",
    f"Picture to write; it ends in {_ENDINGS}. Default: the scene's name with .svg.",
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
@click.option(
    "--forces",
    is_flag=True,
    help="Draw the paths of the force vectors of joints and bearings over a turn, seen along "
    "their shafts.",
)
@click.option(
    "--slides",
    is_flag=True,
    help="Draw the axial travel of shafts whose axes do not meet, over the turn and by order; "
    "the scene needs [offsets].",
)
@click.option(
    "--backlash",
    is_flag=True,
    help="Draw the torque over the angle of the last shaft, through the play and the wind-up "
    "of the joints, while the drive is held.",
)
def command(
    scene: Path,
    output: Path | None,
    study: str | None,
    over: Over | None,
    forces: bool,
    slides: bool,
    backlash: bool,
) -> None:
    """Draw a scene and write the picture to a file.

    By default the picture shows the driveline, its key figures and its curves over the turn. The
    options draw something else.

    \b
    Examples:
      cardan plot shaft.toml
      cardan plot shaft.toml --output shaft.png
      cardan plot shaft.toml --over orders
    """
    if study is not None and over is not None:
        raise click.UsageError("--over does not go with --study")
    if forces and (study is not None or over is not None):
        raise click.UsageError("--forces does not go with --study or --over")
    if slides and (forces or study is not None or over is not None):
        raise click.UsageError("--slides does not go with --forces, --study or --over")
    if backlash and (slides or forces or study is not None or over is not None):
        raise click.UsageError("--backlash does not go with --slides, --forces, --study or --over")
    path = output or Path(f"{scene.stem}.svg")
    loaded = load_scene(scene)
    if isinstance(loaded, BallJointScene):
        if forces or slides or backlash:
            what = "forces" if forces else "slides" if slides else "backlash"
            raise ValueError(f"{loaded.name}: a ball joint alone has no {what} over a turn")
        if study is not None:
            raise ValueError("--study needs a scene with sections [driveline] and [study]")
        check_picture(path)
        write_ball_joint_picture(loaded.ball_joint, path, loaded.title)
        say(f"wrote {path}")
        return
    check_output(loaded, path)
    if forces:
        save(plot_forces(scene_force_paths(loaded), loaded.title), path)
        say(f"wrote {path}")
        return
    if slides:
        write_slides(drawn_slides(loaded), path, loaded.title)
        say(f"wrote {path}")
        return
    if backlash:
        write_backlash(drawn_backlash(loaded), path, loaded.title)
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
