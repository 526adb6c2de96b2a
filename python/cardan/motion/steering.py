"""Steering columns: the ratio straight ahead, its slope there, and symmetry of left and right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64, threads
from cardan.arrays.errors import ArgumentValueError
from cardan.geometry.batch import broadcast

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class Steering:
    """What a steering column does about straight ahead; fields have the shape of the batch.

    The last shaft follows the column as the driven shaft of one joint. Its ratio is ``(1 -
    k**2)/(1 - 2 k cos 2 t + k**2)`` at the input angle ``t`` of that joint, which is even about
    every multiple of 90° and about no other angle (derived here from Thoma 4). So left and right
    are symmetric if and only if straight ahead is at such a multiple: at an even one the ratio is
    largest there (quick), at an odd one least (slow).

    Attributes:
        ratio: speed of the last shaft over that of the column, straight ahead.
        slope: derivative of the ratio by the angle of the column there, per rad.
        offset: angle in rad by which straight ahead is beyond the nearest symmetric position,
            within [-pi/4, pi/4].
        quick: whether that position is one of the largest ratio.
        turn_to_quick: by how much to turn the driving yoke of joint 0 on the column, in rad within
            [-pi/2, pi/2], so that the ratio is largest straight ahead; positive is clockwise,
            looking from the column towards the output.
        turn_to_slow: the same for the least ratio.
        difference: largest difference of the ratio between equal angles of the column to the left
            and to the right of straight ahead; 0 where they are symmetric.
        noticed: the offset, or 0 where the difference is less than 0.1 %, which no driver feels.
    """

    ratio: FloatArray
    slope: FloatArray
    offset: FloatArray
    quick: NDArray[np.bool_]
    turn_to_quick: FloatArray
    turn_to_slow: FloatArray
    difference: FloatArray
    noticed: FloatArray


def steering(
    line: Driveline,
    centre: ArrayLike = 0.0,
    *,
    drawn: Driveline | None = None,
    degrees: bool = False,
) -> Steering:
    """Return what the driveline does as a steering column about straight ahead.

    Args:
        centre: angle of shaft 0 straight ahead, as drive angles count; broadcasts against the
            batch.
        drawn: one other position of the column, in which the angle counts. A column that tilts
            carries its yoke along by the smallest rotation. By default the angle counts in each
            driveline of the batch.
        degrees: whether it is in degrees.

    Raises:
        ValueError: shapes that do not broadcast, several drawn drivelines.
    """
    line._geometry.check_ideal("steering is judged", "evaluate and harmonics give the motion")
    angle = np.radians(centre) if degrees else as_float64("centre", centre)
    shape, numbers, (angles,) = broadcast(line, centre=angle)
    if drawn is not None and drawn.shape:
        raise ArgumentValueError("drawn", f"has shape {drawn.shape}; it is one driveline")
    own = None if drawn is None else drawn._lines
    flat = _core.steering(line._lines, numbers, angles, own, threads.at_most(None))
    ratio, slope, offset, quick, *others = flat.reshape(8, *shape)
    return Steering(ratio, slope, offset, np.asarray(quick != 0.0)[()], *others)
