"""The axes of a joint in space: both shafts and both pins of its cross."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.rows import chain_before


class CrossAxes(NamedTuple):
    """Unit vectors of one joint at some drive angles, each ``(..., 3)``.

    Attributes:
        driving: along the driving shaft.
        driven: along the driven shaft.
        driving_pin: along the pin in the driving yoke.
        driven_pin: along the pin in the driven yoke.
        across: across both pins, along the moment of a positive torque.
        normal: of the bend plane.
    """

    driving: FloatArray
    driven: FloatArray
    driving_pin: FloatArray
    driven_pin: FloatArray
    across: FloatArray
    normal: FloatArray


def cross_axes(line: Any, joint: int, angle: ArrayLike) -> CrossAxes:  # noqa: ANN401 - a driveline
    """Return the axes of a joint.

    The driving pin is ``cos a e + sin a m`` with the joint's input angle ``a``, the normal ``m`` of
    the bend plane and ``e = m x u``. The driven pin is perpendicular to it and to the driven shaft.

    Args:
        line: the driveline.
        joint: which joint.
        angle: drive angle in rad; broadcasts against the batch.

    Raises:
        TypeError: angles that are not real numbers.
        ValueError: shapes that do not broadcast.
    """
    angles = as_float64("angle", angle)
    shape = common_shape(driveline=line.shape, angle=angles.shape)
    a, b = chain_before(line, joint)
    pin = np.exp(1j * angles)
    turned = a * pin + b * np.conj(pin)
    turned = np.broadcast_to(turned / np.abs(turned), shape)[..., np.newaxis]
    driving, driven, normal = (
        np.broadcast_to(axis, (*shape, 3))
        for axis in (
            line.directions[..., joint, :],
            line.directions[..., joint + 1, :],
            line.normals[..., joint, :],
        )
    )
    driving_pin = turned.real * np.cross(normal, driving) + turned.imag * normal
    driven_pin = np.cross(driven, driving_pin)
    driven_pin /= np.linalg.norm(driven_pin, axis=-1, keepdims=True)
    across = np.cross(driving_pin, driven_pin)
    return CrossAxes(driving, driven, driving_pin, driven_pin, across, normal)


def dot(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the scalar products of rows of vectors."""
    return np.asarray(np.sum(one * other, axis=-1))
