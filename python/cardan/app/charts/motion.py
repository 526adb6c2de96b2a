"""What the motion of the shafts reaches over a turn, with joints as built if a scene has them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cardan.app.answers.rounding import is_cancelled
from cardan.app.answers.turn.extremes import peaks
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.motion.equivalent import EquivalentJoint


class TurnMotion(NamedTuple):
    """The extremes of a shaft's motion over a turn, ``(...)`` of a batch of drivelines."""

    angle_error: FloatArray  # largest magnitude in rad
    slowest: FloatArray  # least speed ratio
    fastest: FloatArray  # largest speed ratio
    acceleration: FloatArray  # largest magnitude of the acceleration ratio


def equivalent(line: Driveline, shaft: int = -1) -> EquivalentJoint:
    """Return the joint that moves a shaft as the chain does, straight if rounding alone is left."""
    joint = line.equivalent(shaft)
    if not line.shape and is_cancelled(line, joint):
        return Driveline.from_bends([0.0]).equivalent()
    return joint


def as_built(scene: Scene, line: Driveline) -> Driveline:
    """Return a driveline of a scene with the deviations of its joints, if the scene gives any."""
    return line if scene.deviations is None else line.with_deviations(*scene.deviations.T)


def deviates(scene: Scene) -> bool:
    """Return whether a joint of a scene deviates from its drawing."""
    return scene.deviations is not None and bool(np.any(scene.deviations))


def turn_motion(scene: Scene, line: Driveline, shaft: int) -> TurnMotion:
    """Return the extremes of a shaft of one driveline of a scene or of those of its states.

    Of ideal joints they have closed forms; with deviations they are searched over the turn.
    """
    if not deviates(scene):
        joint = equivalent(line, shaft)
        return TurnMotion(
            *map(np.asarray, (joint.max_angle_error, joint.min_speed_ratio)),
            *map(np.asarray, (joint.max_speed_ratio, joint.max_acceleration_ratio)),
        )
    built = as_built(scene, line)
    return TurnMotion(
        peaks(built, "angle_error", [shaft])[0],
        peaks(built, "speed_ratio", [shaft], is_least=True)[0],
        peaks(built, "speed_ratio", [shaft])[0],
        peaks(built, "acceleration_ratio", [shaft])[0],
    )
