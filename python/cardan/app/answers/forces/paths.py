"""The paths of force vectors over the turn, seen along the shafts of joints and bearings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan.app.answers.forces.figures import FORCES, ForceSource, force_source, unknown
from cardan.app.answers.rounding import first_peak
from cardan.app.answers.turn.extremes import period_of
from cardan.app.answers.turn.figures import noise
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep

PER_DEGREE = 2
"""Samples of a path per degree of drive angle."""


@dataclass(frozen=True, eq=False)
class ForcePath:
    """The force of one joint or bearing over the period after which it repeats.

    That is half a turn, and with deviations of the joints a whole one.

    It is seen along a shaft, looking from the drive towards the output. The force of a joint is
    seen along the shaft that the joint supports: it has no part along that shaft.
    """

    per: ForceSource  # what it is a force of
    item: int  # number of the joint or bearing
    shaft: int  # the shaft along which it is seen
    # The axis that points up in the view, as near as the shaft allows: ``"y"``, or ``"z"`` for a
    # shaft that runs along y.
    up: Literal["y", "z"]
    angle_deg: FloatArray  # drive angles in degrees from 0 to the period, ``(samples,)``
    across: FloatArray  # part of the force to the right in N, ``(samples,)``
    upwards: FloatArray  # part of the force upwards in N, ``(samples,)``
    state: str = ""  # over states, the name of the one in which the force is largest

    @property
    def label(self) -> str:
        """What it is a force of, in words."""
        return f"{self.per} {self.item}{self.state and f', in {self.state}'}"

    @property
    def part_of_turn(self) -> str:
        """Over which part of a turn it goes, in words."""
        return "a turn" if self.angle_deg[-1] > 180.0 else "half a turn"

    @property
    def largest(self) -> int:
        """Index of the first sample at which the force is largest, except for rounding."""
        return first_peak(np.hypot(self.across, self.upwards))[0]

    @property
    def size(self) -> float:
        """The largest force of its samples in N."""
        return float(np.hypot(self.across[self.largest], self.upwards[self.largest]))


def force_path(line: Driveline, per: ForceSource, item: int, load: Load) -> ForcePath:
    """Return the path of one force of one driveline at a constant load.

    A ``ValueError`` says that the force is not determinate, or that lengths are missing.
    """
    per_turn = 360 * PER_DEGREE
    count = round(period_of(line) / math.tau * per_turn) + 1
    name = f"{per}_force"
    period = Sweep.revolutions(count / per_turn, per_turn)
    force = line.evaluate(period, name, load=load)[name][item]
    if per == "bearing":
        shaft = line.bearings[item][0]
    else:
        driving, driven = (
            float(np.max(np.abs(force @ line.directions[item + side]))) for side in (0, 1)
        )
        shaft = item + (driven <= driving)
    along = line.directions[shaft]
    up, across, upwards = _view(along)
    angle_deg = np.arange(count) / PER_DEGREE
    return ForcePath(per, item, shaft, up, angle_deg, force @ across, force @ upwards)


def force_paths(line: Driveline, load: Load, outputs: Iterable[str] = FORCES) -> list[ForcePath]:
    """Return the paths of the forces of every joint, then of every bearing.

    Takes the arguments of ``force_figures`` and raises its errors.
    """
    paths = []
    for name in outputs:
        per = force_source(name)
        count = line.n_joints if per == "joint" else line.n_bearings
        paths += [force_path(line, per, item, load) for item in range(count)]
    return paths


def _view(along: FloatArray) -> tuple[Literal["y", "z"], FloatArray, FloatArray]:
    """The axis that points up, and unit vectors to the right and upwards, across a shaft."""
    up: Literal["y", "z"] = "z" if abs(along[1]) > 0.9 else "y"
    across = np.cross(along, np.eye(3)["xyz".index(up)])
    across /= np.linalg.norm(across)
    return up, across, np.cross(across, along)


def scene_force_paths(scene: Scene) -> list[ForcePath]:
    """Return the paths of the forces of a scene's joints and bearings that are determinate.

    Those that bear no force have none. Over states, each is that of the state in which the force is
    largest. If there are none, a ``ValueError`` says why.
    """
    if scene.states:
        return _largest_paths(scene, scene.states.names)
    line, load = scene.line_as_built, scene.load_case
    if reason := unknown(scene):
        raise ValueError(f"{scene.name}: forces have no path over a turn: {reason}")
    assert load is not None
    found: list[ForcePath] = []
    problems = []
    for name in FORCES[: 1 + (line.n_bearings > 0)]:
        try:
            paths = force_paths(line, load, [name])
        except ArgumentValueError as error:
            problems.append(error.problem.partition("; ")[2])
        else:
            least = noise(scene, "N")
            found += [path for path in paths if path.size > least]
    if not found:
        reason = f"not determinate: {problems[0]}" if problems else "all 0"
        raise ValueError(f"{scene.name}: forces are {reason}")
    return found


def _largest_paths(scene: Scene, names: Sequence[str]) -> list[ForcePath]:
    found: dict[tuple[str, int], ForcePath] = {}
    reason: ValueError | None = None
    for i, name in enumerate(names):
        try:
            paths = scene_force_paths(scene.in_state(i))
        except ValueError as error:
            reason = error
            continue
        for path in paths:
            key = (path.per, path.item)
            if key not in found or path.size > found[key].size:
                found[key] = replace(path, state=name)
    if not found and reason:
        raise reason
    return list(found.values())
