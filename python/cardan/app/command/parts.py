"""The commands that answer with one part alone: ``life``, ``tolerances`` and ``torsion``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import answer as answer_of
from cardan.app.answers.life.figures import needed
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import (
    needed_tolerances,
    permitted_tolerances,
    tolerances_data,
)
from cardan.app.answers.tolerances.text import tolerances_text
from cardan.app.answers.torsion.figures import needed_torsion, torsion_data
from cardan.app.answers.torsion.picture import plot_torsion
from cardan.app.answers.torsion.text import torsion_text
from cardan.app.command.options import check_output, json_option, picture_as_well, scene_argument
from cardan.app.command.terminal import as_json_text, say
from cardan.app.pictures.style import save
from cardan.app.scene.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@click.command()
@scene_argument
@picture_as_well
@json_option
def life(scene: Path, output: Path | None, as_json: bool) -> None:
    """Say how long the joints of a driveline last, how hot they run and which size would suffice.

    The section [joints] of the scene describes the joints or names a table of their sizes. [life]
    gives the steps of the duty cycle. The life is the one that 90 % of the joints reach. It follows
    from the load on the pins over the turn, by the law of the catalogues. With [tubes] the answer
    has stress and critical bending speed of the shafts. The exit status does not depend on the
    verdict.

    \b
    Examples:
      cardan life conveyor.toml
      cardan life conveyor.toml --output life.svg
      cardan life conveyor.toml --json
    """
    answer = Answer(_loaded(scene, output))
    needed(answer)
    parts = list(answer.parts("life"))
    title = answer.scene.title
    _say(
        title,
        lambda: "\n\n".join(part.text(each) for part, each in parts),
        lambda: answer_of("life", title, **{part.name: part.data(each) for part, each in parts}),
        output,
        lambda: PARTS["life"].pictures()["life"](answer),
        as_json=as_json,
    )


@click.command()
@scene_argument
@picture_as_well
@json_option
def tolerances(scene: Path, output: Path | None, as_json: bool) -> None:
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
    loaded = _loaded(scene, output)
    found, of = needed_tolerances(loaded), loaded.tolerances
    assert of
    _say(
        loaded.title,
        lambda: tolerances_text(found, permitted_tolerances(of, loaded.tolerance_arms)),
        lambda: tolerances_data(loaded),
        output,
        lambda: PARTS["tolerances"].pictures()["tolerances"](Answer(loaded)),
        as_json=as_json,
    )


@click.command()
@scene_argument
@picture_as_well
@json_option
def torsion(scene: Path, output: Path | None, as_json: bool) -> None:
    """Find the resonances of compliant shafts, the torques in them and unstable speeds.

    The section [torsion] of the scene gives inertias, stiffnesses or tubes, damping and the range
    of drive speeds. The stiffness of a shaft that does not twist is "rigid".

    The answer has the natural frequencies, each with the shafts that are twisted and their shares
    in the energy of twist, the critical speeds of the orders, the largest torque of each compliant
    shaft and its speed, and the speeds of unstable motion. The exit status does not depend on the
    verdict.

    The picture shows the torques over the drive speed. "cardan plot SCENE --what campbell" draws
    natural frequencies and orders, "--what stability" where the motion is unstable.

    \b
    Examples:
      cardan torsion shaft.toml
      cardan torsion shaft.toml --output response.svg
      cardan torsion shaft.toml --json
    """
    loaded = _loaded(scene, output)
    found = needed_torsion(loaded)
    left_out = "states" if loaded.states else "study" if loaded.study else ""
    note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
    _say(
        loaded.title,
        lambda: torsion_text(found) + (f"\n\n{note}" if left_out else ""),
        lambda: torsion_data(loaded.title, found, [] if output is None else [str(output)]),
        output,
        lambda: plot_torsion(found, loaded.title),
        as_json=as_json,
    )


def _loaded(path: Path, output: Path | None) -> Scene:
    """The scene, after a look whether the picture can be written."""
    scene = Scene.load(path)
    if output is not None:
        check_output(scene, output)
    return scene


def _say(
    title: str,
    text: Callable[[], str],
    data: Callable[[], Any],
    output: Path | None,
    picture: Callable[[], Figure],
    *,
    as_json: bool,
) -> None:
    """Write the picture, and print the answer as JSON or as text under its title."""
    if output is not None:
        save(picture(), output)
    if as_json:
        say(as_json_text(data()))
        return
    if title:
        say(f"{title}\n")
    say(text())
    if output is not None:
        say(f"\nwrote {output}")
