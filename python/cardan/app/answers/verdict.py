"""The one verdict on a scene, which the first printed line, exit status, JSON and page show."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cardan.app.answers.ball_joint.figures import ball_joint_figures
from cardan.app.answers.life.figures import life_figures
from cardan.app.answers.rounding import alike
from cardan.app.answers.spline.figures import slip_figures
from cardan.app.answers.steering.figures import steering_figures
from cardan.app.answers.tubes.figures import tube_figures
from cardan.app.files.progress import Progress
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.scene import Scene
from cardan.app.scene.study import Study
from cardan.arrays import FloatArray
from cardan.design.check import Check
from cardan.design.judged import VERDICTS
from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class Verdict:
    """The worst of all that a scene has with a limit.

    Attributes:
        motion: the check of its driveline; a ball joint alone has none.
        parts: what else it has with a limit, in words, and the verdict on each, of ``VERDICTS``.
    """

    motion: Check | None
    parts: Mapping[str, str]

    @property
    def beyond(self) -> list[str]:
        """The parts that are beyond what the scene allows."""
        return [name for name, word in self.parts.items() if word == "beyond"]

    @property
    def word(self) -> str:
        """The worst of all, one of ``VERDICTS``."""
        ranks = [VERDICTS.index(word) for word in self.parts.values()]
        motion = 0 if self.motion is None else int(np.max(self.motion.ranks, initial=0))
        return VERDICTS[max([motion, *ranks])]

    @property
    def passes(self) -> bool:
        """Whether nothing is beyond its limits or cannot be judged for its value."""
        return VERDICTS.index(self.word) <= VERDICTS.index("tolerable")


def verdict(scene: Scene | BallJointScene, progress: Progress | None = None) -> Verdict:
    """Return the verdict on a scene; ``progress`` as of ``check_scene``."""
    motion, parts = None, {}
    if isinstance(scene, Scene):
        motion = check_scene(scene, progress)
        slip, steered, life = slip_figures(scene), steering_figures(scene), life_figures(scene)
        passes = {
            "the spline": slip is None or slip.passes,
            "the symmetry of the steering": steered is None or steered.passes,
            "the life of the joints": life is None or life.reaches_target,
            "a bend for the type of its joint": life is None
            or all(joint.passes for joint in life.joints),
            **{f"the tube of shaft {tube.shaft}": tube.passes for tube in tube_figures(scene)},
        }
        parts = {name: "within" if within else "beyond" for name, within in passes.items()}
    if scene.ball_joint:
        parts["the ball joint"] = ball_joint_figures(scene.ball_joint).verdict
    return Verdict(motion, parts)


def check_scene(scene: Scene, progress: Progress | None = None) -> Check:
    """Check the driveline of a scene, or all of its study or states, and say where the worst lies.

    ``progress`` is called after each block of the study with the rows done and all rows.
    """
    if scene.states:
        return check_states(scene, scene.drivelines())
    if scene.study is None or not scene.study.axes:
        known = scene.without_missing()
        # Bends that were recorded go with the speeds of their samples; of fixed ones the largest
        # speed is the worst.
        if known.line.shape and known.speed_recorded and known.load_case is not None:
            return known.line.check(known.load_case.speed, scene.limits)
        return known.line.check(scene.speed or None, scene.limits)
    turns = scene.speed != 0.0 or any(axis.key.startswith("speed_") for axis in scene.study.axes)
    blocks = []
    rows = math.prod(scene.study.shape)
    for first, line, load in scene.study.blocks():
        # Of a recorded speed the largest counts.
        speed = scene.speed if scene.speed_recorded else load.speed if load and turns else None
        blocks.append(line.check(speed, scene.limits).findings)
        if progress:
            progress(first + line.shape[0], rows)
    findings = []
    for parts in zip(*blocks, strict=True):
        value = _joined([part.value for part in parts])
        at_unit_speed = None
        if parts[0].at_unit_speed is not None:
            at_unit_speed = _joined([part.at_unit_speed for part in parts])
        worst_at = {} if parts[0].needs_speed else _worst_at(scene.study, value)
        findings.append(
            replace(parts[0], value=value, at_unit_speed=at_unit_speed, worst_at=worst_at)
        )
    return Check(tuple(findings), scene.limits)


def check_states(scene: Scene, lines: Driveline) -> Check:
    """Check the drivelines ``(states,)`` of the states of a scene, each at its own speed."""
    states = scene.states
    assert states
    loads = [states.load(i) for i in range(states.count)]
    speeds = np.array([scene.speed if load is None else load.speed for load in loads])
    # Of a recorded speed the largest counts.
    speed = scene.speed if scene.speed_recorded else speeds
    found = lines.check(speed if np.any(speed) else None, scene.limits)
    findings = []
    for finding in found.findings:
        value = np.broadcast_to(finding.value, (states.count,))
        worst = "" if finding.needs_speed else states.names[int(np.argmax(value))]
        findings.append(replace(finding, value=value, worst_in=worst))
    return Check(tuple(findings), scene.limits)


def _joined(parts: Sequence[FloatArray | None]) -> FloatArray:
    return np.concatenate([np.ravel(np.asarray(part)) for part in parts])


def _worst_at(study: Study, value: FloatArray) -> dict[str, float]:
    """The keys of a study on which its largest value depends, and their values there."""
    grid = value.reshape(study.shape)
    place: tuple[Any, ...] = np.unravel_index(np.argmax(grid), grid.shape)
    found = {}
    for number, axis in enumerate(study.axes):
        along = grid[(*place[:number], slice(None), *place[number + 1 :])]
        if not alike(float(np.min(along)), float(np.max(along))):
            found[axis.key] = float(axis.values[place[number]])
    return found
