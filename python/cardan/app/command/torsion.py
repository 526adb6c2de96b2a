"""The command ``cardan torsion``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.torsion.figures import needed_torsion, torsion_data
from cardan.app.answers.torsion.picture import plot_torsion
from cardan.app.answers.torsion.text import torsion_text
from cardan.app.command.files import check_output
from cardan.app.command.options import json_option, picture_as_well, scene_argument
from cardan.app.command.terminal import say_answer
from cardan.app.pictures.style import save
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@picture_as_well
@json_option
def command(scene: Path, output: Path | None, as_json: bool) -> None:
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
    loaded = Scene.load(scene)
    if output is not None:
        check_output(loaded, output)
    found = needed_torsion(loaded)
    if output is not None:
        save(plot_torsion(found, loaded.title), output)
    files = [] if output is None else [str(output)]
    left_out = "states" if loaded.states else "study" if loaded.study else ""

    def text() -> str:
        note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
        return torsion_text(found) + (f"\n\n{note}" if left_out else "")

    say_answer(
        loaded.title,
        text,
        lambda: torsion_data(loaded.title, found, files),
        output,
        as_json=as_json,
    )
