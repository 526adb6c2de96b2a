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
    """The pins of one joint at some angles.

    Attributes:
        moment: magnitude of the joint's moment in N m.
        rate_driving: rate at which the pins turn in the driving yoke, per radian of the drive.
        rate_driven: the same in the driven yoke.
        entering_torque: torque in N m that the driving shaft puts into the joint, without what the
            shaft's inertia takes.
    """

    moment: FloatArray
    rate_driving: FloatArray
    rate_driven: FloatArray
    entering_torque: FloatArray


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

    Args:
        line: the driveline.
        load: constant over the turn; broadcasts against the batch.
        rows: shape to which both broadcast.
        wear: for ``"friction"`` the torque of the drive, and for each joint the magnitude of its
            moment times the ways that its pins turn in both yokes, and these ways; for
            ``"fatigue"`` for each joint the torque that enters it, for either yoke the moment to
            the power of 10/3 times the way, and for either yoke the way. Ways are per radian.

    Returns:
        the means, ``(m, ...)``, which broadcast to ``(m, *rows)``.
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
    """Unit vectors of one joint at some drive angles, each ``(..., 3)``.

    ``across`` is across both pins, along the moment of a positive torque; ``normal`` is that of the
    bend plane.
    """

    driving: FloatArray
    driven: FloatArray
    driving_pin: FloatArray
    driven_pin: FloatArray
    across: FloatArray
    normal: FloatArray


def cross_axes(line: Driveline, joint: int, angle: ArrayLike) -> CrossAxes:
    """Return the axes of a joint at drive angles in rad, which broadcast against the batch."""
    pins = line.evaluate(angle, ("driving_pin", "driven_pin"), joints=joint)
    p, q = pins.driving_pin, pins.driven_pin
    driving, driven, normal = (
        np.broadcast_to(axis, p.shape)
        for axis in (
            line.directions[..., joint, :],
            line.directions[..., joint + 1, :],
            line.normals[..., joint, :],
        )
    )
    return CrossAxes(driving, driven, p, q, np.cross(p, q), normal)


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the scalar products of rows of vectors."""
    return np.asarray(np.sum(one * other, axis=-1))
