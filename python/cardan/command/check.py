"""The command ``cardan check``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cardan.command import ball_joint, in_service
from cardan.command.terminal import (
    as_json_text,
    progress_bar,
    say,
)
from cardan.figures.advice import scene_advice
from cardan.figures.as_built import as_built_orders
from cardan.figures.backlash import scene_backlash
from cardan.figures.drive_speed import drive_speed
from cardan.figures.limits import check_data, check_scene, parts_beyond, passes
from cardan.figures.slides import scene_slides
from cardan.figures.slip import slip_figures
from cardan.figures.states import forces_of, verdicts
from cardan.figures.steering import steering_figures
from cardan.figures.tolerances import tolerance_figures
from cardan.figures.torsion_modes import torsion_basics
from cardan.scene import load_scene
from cardan.scene.ball_joint_scene import BallJointScene
from cardan.scene.scene import Scene
from cardan.words.advice import remedies
from cardan.words.as_built import as_built_text
from cardan.words.backlash import backlash_text
from cardan.words.ball_joint import ball_joint_text
from cardan.words.drive_speed import drive_speed_text
from cardan.words.forces import forces_text
from cardan.words.limits import check_text
from cardan.words.slides import slides_text
from cardan.words.slip import slip_text
from cardan.words.states import verdicts_text
from cardan.words.steering import steering_text
from cardan.words.tolerances import tolerance_verdicts_text
from cardan.words.torsion import torsion_check_text


def run(path: Path, *, as_json: bool) -> int:
    """Check a scene against its limits, print the findings and return the exit status.

    Args:
        path: the scene.
        as_json: whether to print JSON.
    """
    loaded = load_scene(path)
    if isinstance(loaded, BallJointScene):
        return ball_joint.check(loaded, as_json=as_json)
    with progress_bar() as progress:
        found = check_scene(loaded, progress)
    advised = scene_advice(loaded)
    sentences = [*(remedies(advised) if advised else []), *in_service.remedies(loaded)]
    say(
        as_json_text(check_data(loaded, found, sentences))
        if as_json
        else check_text(found, sentences, parts_beyond(loaded))
    )
    if loaded.states and not as_json:
        say(f"\n{verdicts_text(verdicts(loaded, found))}")
    for words in () if as_json else _further(loaded):
        say(f"\n{words}")
    return 0 if np.all(found.passes) and passes(loaded) else 1


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
    yield from in_service.verdicts(scene)
    if (compliant := torsion_basics(scene)) and (advised := torsion_check_text(compliant)):
        yield advised
    if scene.ball_joint:
        yield ball_joint_text(scene.ball_joint)
