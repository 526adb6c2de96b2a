"""The commands that answer with one part alone: ``life``, ``tolerances`` and ``torsion``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.json_schema import Kind
from cardan.app.answers.json_schema import answer as answer_of
from cardan.app.answers.life.figures import needed
from cardan.app.answers.table import PARTS
from cardan.app.command.options import check_output, json_option, picture_as_well, scene_argument
from cardan.app.command.terminal import as_json_text, say
from cardan.app.pictures.style import save
from cardan.app.scene.scene import Scene


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
    answer = _answer(scene, output)
    needed(answer)
    parts = list(answer.parts("life"))
    _say(
        answer,
        "life",
        lambda: "\n\n".join(part.text(each) for part, each in parts),
        {part.name: part.data(each) for part, each in parts},
        output,
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
    answer = _answer(scene, output)
    found = answer.needed("tolerances")
    text = PARTS["tolerances"].text
    _say(answer, "tolerances", lambda: text(found), data_of(found), output, as_json=as_json)


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
    answer = _answer(scene, output)
    found, loaded = answer.needed("torsion"), answer.scene
    left_out = "states" if loaded.states else "study" if loaded.study else ""
    note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
    _say(
        answer,
        "torsion",
        lambda: PARTS["torsion"].text(found) + (f"\n\n{note}" if left_out else ""),
        data_of(found) | {"files": [] if output is None else [str(output)]},
        output,
        as_json=as_json,
    )


def _answer(path: Path, output: Path | None) -> Answer:
    """The answer to a scene, after a look whether the picture can be written."""
    scene = Scene.load(path)
    if output is not None:
        check_output(scene, output)
    return Answer(scene)


def _say(
    answer: Answer,
    name: Kind,
    text: Callable[[], str],
    data: Mapping[str, Any],
    output: Path | None,
    *,
    as_json: bool,
) -> None:
    """Write the picture of a part, and print the answer as JSON or as text under its title."""
    title = answer.scene.title
    if output is not None:
        save(PARTS[name].pictures()[name](answer), output)
    if as_json:
        say(as_json_text(answer_of(name, title, **data)))
        return
    if title:
        say(f"{title}\n")
    say(text())
    if output is not None:
        say(f"\nwrote {output}")
