"""A scene's driveline in service: its joints, its duty cycle, its tubes and what is out of line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cardan.app.scene.language.document import Document
from cardan.app.scene.sections.backlash import OF_PLAY, JointPlay, play_of
from cardan.app.scene.sections.joint_deviations import OF_DEVIATIONS, arms_of, in_mm
from cardan.app.scene.sections.joints import Joints, joints_of
from cardan.app.scene.sections.life import DutyCycle, duty_cycle, gives, stands
from cardan.app.scene.sections.offsets import AxisOffsets, offsets_of
from cardan.app.scene.sections.tubes import Tubes, tubes_of
from cardan.app.scene.study.layout import SceneLayout
from cardan.app.scene.study.states import States
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


@dataclass(frozen=True, eq=False)
class Service:
    """What a scene says of its driveline in service; ``None`` for what it does not say.

    Attributes:
        joints: sizes and bearings.
        duty: the duty cycle: that of [life], or the load as its only step.
        tubes: the round sections of shafts.
        offsets: distances of axes that should meet.
        play: of the pins in their bearings.
    """

    joints: Joints | None = None
    duty: DutyCycle | None = None
    tubes: Tubes | None = None
    offsets: AxisOffsets | None = None
    play: JointPlay | None = None


def service_of(
    document: Document,
    folder: Path,
    line: Driveline,
    load: Load | None,
    layout: SceneLayout | None,
    states: States | None,
) -> Service:
    """Return what a scene says of its driveline in service.

    Args:
        document: the scene file.
        folder: from which paths in it begin.
        line: its driveline.
        load: its load, if any.
        layout: how it describes its driveline; ``None`` if its bends were recorded.
        states: its states, if any.

    Raises:
        OSError: the table of sizes cannot be read.
        ValueError: what ``joints_of``, ``play_of``, ``duty_cycle``, ``tubes_of`` and ``offsets_of``
            refuse.
    """
    given = document.sections
    joints = duty = tubes = offsets = None
    with document.within("joints", "sizes"):
        own = given.get("joints", {})
        sizes = {k: v for k, v in own.items() if k not in {**OF_DEVIATIONS, **OF_PLAY}}
        if in_mm(given) and sizes.keys().isdisjoint({"sizes", "friction", "pin_radius_mm"}):
            # Then it is there for the deviations alone.
            sizes.pop("arm_mm", None)
        if sizes:
            joints = joints_of(sizes, line.n_joints, folder)
        n = line.n_joints
        play = play_of(own, n, arms_of(own, n, known_arms(joints)))
    with document.within("life"):
        if "life" in given or joints or "tubes" in given:
            duty = _duty(given, line, load, layout, states)
    with document.within("tubes"):
        if "tubes" in given:
            tubes = tubes_of(given["tubes"], line)
    with document.within("offsets"):
        if "offsets" in given:
            if layout is None:
                raise ValueError("it does not go with recorded bends, which differ by sample")
            offsets = offsets_of(given["offsets"], states.drivelines() if states else line)
    return Service(joints, duty, tubes, offsets, play)


def known_arms(joints: Joints | None) -> list[float | None]:
    """Return the arm of each joint in m where its size says it; nothing without sizes."""
    return [size.arm for size in joints.each] if joints else []


def _duty(
    given: Mapping[str, Any],
    line: Driveline,
    load: Load | None,
    layout: SceneLayout | None,
    states: States | None,
) -> DutyCycle | None:
    """The duty cycle: that of [life], or the load as its only step if it turns and has a torque."""
    values, varied = given.get("life", {}), given.get("study", {})
    if load is not None and np.ndim(load.speed + load.torque):
        layout = None
    lines = line.reshape(-1, 1)
    if states and not stands(values):
        lines, load = states.drivelines().reshape(-1, 1), states.loads(load)
        load = load and load.at_any_angle()
    if not values:
        known = load is not None and layout is not None
        for what in ("speed", "torque"):
            known = known and (bool(np.any(getattr(load, what))) or gives(varied, what))
        if not known:
            return None
    return duty_cycle(values, lines, load, layout, states, varied)
