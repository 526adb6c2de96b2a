"""The command ``cardan tolerances``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.tolerances.figures import (
    needed_tolerances,
    permitted_tolerances,
    tolerances_data,
)
from cardan.app.answers.tolerances.text import tolerances_text
from cardan.app.command.files import check_output
from cardan.app.command.options import json_option, picture_as_well, scene_argument
from cardan.app.command.terminal import say_answer
from cardan.app.plots import plot_part, save
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@picture_as_well
@json_option
def command(scene: Path, output: Path | None, as_json: bool) -> None:
    """Show how manufacturing and assembly errors affect a driveline.

    The section [tolerances] of the scene says how exact bends, twists, yokes or points are.

    The answer has the worst driveline, a guaranteed bound, quantiles of random drivelines, the
    share within the limit, and the share of each joint, shaft or point in the scatter. It also says
    how exact each group must be for every driveline to be within the limit, if there is one. The
    exit status does not depend on the verdict.

    \b
    Examples:
      cardan tolerances shaft.toml
      cardan tolerances shaft.toml --output tolerances.svg
      cardan tolerances shaft.toml --json
    """
    loaded = Scene.load(scene)
    found = needed_tolerances(loaded)
    tolerances = loaded.tolerances
    assert tolerances
    if output is not None:
        check_output(loaded, output)
        save(plot_part(loaded, "tolerances"), output)
    say_answer(
        loaded.title,
        lambda: tolerances_text(found, permitted_tolerances(tolerances, loaded.tolerance_arms)),
        lambda: tolerances_data(loaded),
        output,
        as_json=as_json,
    )
