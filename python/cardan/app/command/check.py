"""The command ``cardan check``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click

from cardan.app.answers.as_built.figures import as_built_orders
from cardan.app.answers.as_built.text import as_built_text
from cardan.app.answers.axial_travel.figures import scene_slides
from cardan.app.answers.axial_travel.text import slides_text
from cardan.app.answers.backlash.figures import scene_backlash
from cardan.app.answers.backlash.text import backlash_text
from cardan.app.answers.ball_joint.text import ball_joint_text
from cardan.app.answers.drive_speed.figures import drive_speed
from cardan.app.answers.drive_speed.text import drive_speed_text
from cardan.app.answers.forces.text import forces_text
from cardan.app.answers.life.figures import life_figures
from cardan.app.answers.life.text import life_remedies, life_verdict_text, tubes_text
from cardan.app.answers.limits.data import ball_joint_check_data, check_data
from cardan.app.answers.limits.remedies import scene_advice
from cardan.app.answers.limits.remedies_text import remedies
from cardan.app.answers.limits.text import check_text, verdict_lines
from cardan.app.answers.spline.figures import slip_figures
from cardan.app.answers.spline.text import slip_text
from cardan.app.answers.states.figures import forces_of, verdicts
from cardan.app.answers.states.text import verdicts_text
from cardan.app.answers.steering.figures import steering_figures
from cardan.app.answers.steering.text import steering_text
from cardan.app.answers.tolerances.figures import tolerance_figures
from cardan.app.answers.tolerances.text import tolerance_verdicts_text
from cardan.app.answers.torsion.modes import torsion_basics
from cardan.app.answers.torsion.text import torsion_check_text
from cardan.app.answers.tubes.figures import tube_figures
from cardan.app.answers.verdict import verdict
from cardan.app.command.options import json_option, scene_argument
from cardan.app.command.terminal import (
    as_json_text,
    progress_bar,
    say,
)
from cardan.app.scene import load_scene
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@json_option
def command(scene: Path, as_json: bool) -> int:
    """Compare a scene with the limits of driveshaft catalogues and of practice.

    By default the only limit is that of the catalogues: an equivalent bend of 3 deg. The section
    [limits] of the scene adds the limits of a kind of machine (preset = "truck" or "industrial") or
    your own figures, and each limit is printed with its source. With a speed given, the excitation
    by the last shaft and by the shafts between two joints is printed as well.

    A figure is within its limit, tolerable (above the limit but not above the maximum) or beyond.
    The first line is the verdict on everything together, and the exit status is 0 for within and
    tolerable, and 1 for beyond. Splines, steering, joints, tubes and ball joints that exceed what
    the scene permits count as beyond; the verdict names them. In a study every driveline counts,
    and each figure is the worst of them, with its place.

    \b
    Examples:
      cardan check shaft.toml
      cardan check shaft.toml --json
    """
    loaded = load_scene(scene)
    if isinstance(loaded, BallJointScene):
        alone = verdict(loaded)
        lines = [*verdict_lines(alone), "", ball_joint_text(loaded.ball_joint)]
        say(as_json_text(ball_joint_check_data(loaded)) if as_json else "\n".join(lines))
        return 0 if alone.passes else 1
    with progress_bar() as progress:
        judged = verdict(loaded, progress)
    advised = scene_advice(loaded)
    sentences = [*(remedies(advised) if advised else []), *_life_remedies(loaded)]
    say(
        as_json_text(check_data(loaded, judged, sentences))
        if as_json
        else check_text(judged, sentences)
    )
    if loaded.states and judged.motion is not None and not as_json:
        say(f"\n{verdicts_text(verdicts(loaded, judged.motion))}")
    for words in () if as_json else _further(loaded):
        say(f"\n{words}")
    return 0 if judged.passes else 1


def _life_remedies(scene: Scene) -> list[str]:
    life = life_figures(scene)
    return life_remedies(life) if life and not life.passes else []


def _further(scene: Scene) -> Iterator[str]:
    """What a check says in addition to the limits of the driveline."""
    if speed := drive_speed(scene):
        yield drive_speed_text(speed)
    if built := as_built_orders(scene):
        yield as_built_text(built)
    if loose := scene_backlash(scene):
        yield backlash_text(loose)
    if forces := forces_of(scene):
        yield forces_text(forces)
    if slip := slip_figures(scene):
        yield slip_text(slip)
    if moved := scene_slides(scene):
        yield slides_text(moved)
    if steered := steering_figures(scene):
        yield steering_text(steered)
    if toleranced := tolerance_figures(scene):
        yield f"Tolerances\n{tolerance_verdicts_text(toleranced)}"
    if life := life_figures(scene):
        yield life_verdict_text(life)
    if tubes := tube_figures(scene):
        yield tubes_text(tubes)
    if (compliant := torsion_basics(scene)) and (advised := torsion_check_text(compliant)):
        yield advised
    if scene.ball_joint:
        yield ball_joint_text(scene.ball_joint)
