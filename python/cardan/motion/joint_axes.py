"""The axes of a joint in space: both shafts and both pins of its cross."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from cardan.driveline import Driveline


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
