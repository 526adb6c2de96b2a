"""The command ``cardan check``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.lateral.text import lateral_remedies
from cardan.app.answers.life.text import life_remedies
from cardan.app.answers.limits import check_text
from cardan.app.answers.moves import is_tried, several_at_once, untried_of
from cardan.app.answers.schema import check_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import scene_advice
from cardan.app.answers.yokes.text import improvement, keeps_limit, remedies
from cardan.app.command import options, terminal
from cardan.app.scene import load_scene
from cardan.app.scene.scene import Scene

_VIBRATIONS = ("tubes", "torsion", "lateral")
"""The parts whose figures that no change is tried for are those of vibration."""


@click.command()
@options.scene_argument
@options.output_options()
def check(scene: Path, output: options.Output) -> int:
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
    loaded = options.in_units(load_scene(scene))
    output.check(loaded)
    with terminal.progress_bar() as progress:
        answer = Answer(loaded, progress)
        passes = answer.passes
    advice = _advice(answer)
    data = check_data(answer, advice) if output.as_json or output.workbook else {}
    output.say_whole(lambda: check_text(answer, advice), data)
    return 0 if passes else 1


def _advice(answer: Answer) -> list[str]:
    """Return the changes that bring a driveline within its limits, a sentence each.

    Those that concern the worst exceedance come first, or the part of the answer that is about it.
    """
    if not isinstance(answer.of, Scene) or answer.verdict == "within":
        return []
    moves, advised, life = answer["moves"], scene_advice(answer.scene), answer["life"]
    sentences = PARTS["moves"].sentences(moves)
    # Where no single change suffices, the yokes of all shafts may do.
    if not any(move.verdict == "within" for move in moves):
        several = several_at_once(answer)
        sentences = [*(remedies(advised) if advised else []), *sentences, *several]
    elif advised and (better := improvement(advised)):
        sentences.insert(0 if keeps_limit(advised) else len(sentences), better)
    sentences += life_remedies(life) if life else []
    shudder = lateral_remedies(answer["lateral"]) if answer["lateral"] else []
    limited = (each for each in answer.judged if each.value.limit is not None)
    most = max((each.value.share_of_limit for each in limited if is_tried(each)), default=0.0)
    worse = [
        each
        for each in untried_of(answer)
        if each.part.name in _VIBRATIONS and each.value.share_of_limit > most
    ]
    is_shudder = any(each.part.name == "lateral" for each in worse)
    others = [
        each
        for each in worse
        if each.value.verdict == "beyond" and not (shudder and each.part.name == "lateral")
    ]
    if sentences and others:
        worst = max(others, key=lambda each: each.value.share_of_limit)
        where = f'further from its limit: see "{worst.part.title}"'
        sentences.insert(0, f"No change below is tried for the {worst.name}, which is {where}.")
    return [*shudder, *sentences] if is_shudder else [*sentences, *shudder]
