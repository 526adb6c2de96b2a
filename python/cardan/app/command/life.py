"""The command ``cardan life``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import answer as answer_of
from cardan.app.answers.life.figures import needed
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
    answer = Answer(Scene.load(scene))
    title = answer.scene.title
    needed(answer)
    if output is not None:
        check_output(answer.scene, output)
        save(plot_part(answer.scene, "life"), output)
    parts = list(answer.parts("life"))
    say_answer(
        title,
        lambda: "\n\n".join(part.text(each) for part, each in parts),
        lambda: answer_of("life", title, **{part.name: part.data(each) for part, each in parts}),
        output,
        as_json=as_json,
    )
