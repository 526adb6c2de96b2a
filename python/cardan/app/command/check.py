"""The command ``cardan check``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.life.text import life_remedies
from cardan.app.answers.limits import check_text
from cardan.app.answers.schema import check_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import scene_advice
from cardan.app.answers.yokes.text import remedies
from cardan.app.command.options import (
    check_workbook,
    in_units,
    json_option,
    scene_argument,
    workbook_as_well,
    write_workbook,
)
from cardan.app.command.terminal import as_json_text, progress_bar, say
from cardan.app.scene import load_scene
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@workbook_as_well
@json_option
def check(scene: Path, workbook: Path | None, as_json: bool) -> int:
    """Compare a scene with the limits of driveshaft catalogues and of practice.

    By default the only limit is that of the catalogues: an equivalent bend of 3 deg. The section
    [limits] of the scene adds limits of kinds of machines or of makers (preset = "truck", or
    ["spicer", "gm"]) or your own figures, and each limit is printed with its source. With a speed
    given, the excitation by the last shaft and by the shafts between two joints is printed as well.

    A figure is within its limit, tolerable (above the limit but not above the maximum) or beyond.
    The first line is the verdict on everything together, and the exit status is 0 for within and
    tolerable, and 1 for beyond. Splines, steering, joints, tubes and ball joints that exceed what
    the scene permits count as beyond; the verdict names them. In a study every driveline counts,
    and each figure is the worst of them, with its place.

    \b
    Examples:
      cardan check shaft.toml
      cardan check shaft.toml --workbook answer.xlsx
      cardan check shaft.toml --json
    """
    loaded = in_units(load_scene(scene))
    check_workbook(workbook, loaded)
    with progress_bar() as progress:
        answer = Answer(loaded, progress)
        passes = answer.passes
    advice = _advice(answer)
    data = check_data(answer, advice) if as_json or workbook else {}
    wrote = write_workbook(data, workbook)
    if as_json:
        say(as_json_text(data))
    else:
        say("\n\n".join(filter(None, (check_text(answer, advice), wrote))))
    return 0 if passes else 1


def _advice(answer: Answer) -> list[str]:
    """What would bring a driveline within its limits, a sentence each."""
    if not isinstance(answer.of, Scene) or answer.verdict == "within":
        return []
    moves, advised, life = answer["moves"], scene_advice(answer.scene), answer["life"]
    sentences = PARTS["moves"].sentences(moves)
    # Where no single change suffices, the yokes of all shafts may do.
    if not any(move.verdict == "within" for move in moves):
        sentences = [*(remedies(advised) if advised else []), *sentences]
    return [*sentences, *(life_remedies(life) if life else [])]
