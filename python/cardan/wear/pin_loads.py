"""The pins of a joint: their axes, moment and rates at an angle, and means over a turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, threads
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class PinLoads:
    """The pins of one joint at some angles, moments in N m and rates per radian of the drive."""

    moment: FloatArray  # magnitude of the joint's
    rate_driving: FloatArray  # at which the pins turn in the driving yoke
    rate_driven: FloatArray
    entering_torque: FloatArray  # that the driving shaft puts in, without what its inertia takes


def pins_at(line: Driveline, load: Load, joint: int, angle: ArrayLike) -> PinLoads:
    """Return the pins of a joint at drive angles in rad."""
    names = ("torque", "speed_ratio", "pin_moment", "swing_driving", "swing_driven")
    at = line.evaluate(angle, names, shafts=[joint, joint + 1], joints=joint, load=load)
    # From the power behind the joint.
    entering = at.torque[1] * at.speed_ratio[1] / at.speed_ratio[0]
    return PinLoads(at.pin_moment, at.swing_driving, at.swing_driven, entering)


def means_over_turn(
    line: Driveline, load: Load, rows: tuple[int, ...], wear: Literal["friction", "fatigue"]
) -> FloatArray:
    """Return means over a turn of the drive, exact to some 1e-14 of the largest.

    They are ``(m, ...)`` and broadcast to ``(m, *rows)``, as driveline and load do to the rows. For
    ``"friction"``: the torque of the drive, and for each joint the magnitude of its moment times
    the ways that its pins turn in both yokes, and these ways. For ``"fatigue"``: for each joint the
    torque that enters it, for either yoke the moment to the power of 10/3 times the way, and for
    either yoke the way. Ways are per radian.
    """
    line._geometry.check_ideal(
        "losses and lives are computed", "evaluate gives moments and tilts as built"
    )
    own = np.broadcast_shapes(line.shape, *load.shapes().values())
    inertias = [*load.inertias_by_shaft(line.n_joints).items()]
    arrays = (load.end, load.torque, load.speed, load.acceleration, inertias)
    flat = _core.pin_means(line._lines, own, arrays, wear, threads.at_most(None))
    means = np.moveaxis(flat.reshape(*own, -1 if flat.size else 1), -1, 0)
    return means.reshape(len(means), *(1,) * (len(rows) - len(own)), *own)


class CrossAxes(NamedTuple):
    """Unit vectors of one joint at some drive angles, each ``(..., 3)``."""

    driving: FloatArray
    driven: FloatArray
    driving_pin: FloatArray
    driven_pin: FloatArray
    across: FloatArray  # both pins, along the moment of a positive torque
    normal: FloatArray  # of the bend plane


def cross_axes(line: Driveline, joint: int, angle: ArrayLike) -> CrossAxes:
    """Return the axes of a joint at drive angles in rad, which broadcast against the batch."""
    pins = line.evaluate(angle, ("driving_pin", "driven_pin"), joints=joint)
    p, q, shafts = pins.driving_pin, pins.driven_pin, line.directions
    resting = (shafts[..., joint, :], shafts[..., joint + 1, :], line.normals[..., joint, :])
    driving, driven, normal = (np.broadcast_to(axis, p.shape) for axis in resting)
    return CrossAxes(driving, driven, p, q, np.cross(p, q), normal)


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the scalar products of rows of vectors."""
    return np.asarray(np.sum(one * other, axis=-1))
