"""Drivelines whose points move with the torque: an axle on its springs, an engine on its mounts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape, finite, one_number
from cardan.arrays.errors import check_shape, require
from cardan.arrays.indices import item_indices
from cardan.geometry.parameters import has_lengths

if TYPE_CHECKING:
    from cardan.driveline import Driveline


def wound_up(
    line: Driveline,
    torque: ArrayLike,
    points: int | slice | Sequence[int],
    *,
    turn: float = 0.0,
    about: ArrayLike = (0.0, 0.0, 0.0),
    axis: ArrayLike = (0.0, 0.0, 1.0),
    shift: ArrayLike = (0.0, 0.0, 0.0),
) -> Driveline:
    """Return the driveline under torque, some of whose points turn or move in proportion to it.

    A live axle turns on its springs and an engine rolls on its mounts. What turns them is the mean
    torque, which without friction is the same in every shaft: over a turn of a shaft the ratios of
    the joints have the mean 1, and inertias take as much as they give. Lengths follow the points;
    phases, and positions of bearings from the upstream ends of their shafts, stay.

    Args:
        torque: mean torque in N m, any shape; it broadcasts against the batch. Negative coasts.
        points: those that move, counted from 0, the driving end: ``slice(3, 5)`` or ``[3, 4]``.
        turn: by which angle they turn, in rad per N m, right-handed about the axis.
        about: a point of the axis in m from the driving end, ``(3,)``, in the axes of the points.
        axis: its direction, ``(3,)``, of any length.
        shift: by how much the points move besides, in m per N m, ``(3,)``.

    Raises:
        IndexError: a point that does not exist.
        ValueError: a driveline without lengths or with deviations, an axis without direction, a
            bend of 90° or more under torque, shapes that do not fit.

    >>> import cardan
    >>> line = cardan.Driveline.from_points([[0, 0, 0], [0.3, 0, 0], [1.7, -0.2, 0], [2, -0.2, 0]])
    >>> axle = {"about": [1.9, -0.2, 0.0], "turn": 5e-5}
    >>> line.wound_up([0.0, 1000.0], [2, 3], **axle).bends_deg.round(3)
    array([[ 8.13 ,  8.13 ],
           [ 8.529, 11.394]])
    """
    line._geometry.check_ideal("what follows the torque is")
    require("driveline", has_lengths(line), "has no lengths; make it of points, or with lengths")
    size = finite("torque", torque)
    moved = item_indices("points", points, line.n_joints + 2)
    middle, along, move = (
        _vector(name, value) for name, value in (("about", about), ("axis", axis), ("shift", shift))
    )
    rate, length = one_number("turn", turn), float(np.linalg.norm(along))
    require("axis", length != 0.0, "is [0, 0, 0]; an axis needs a direction")
    shape = common_shape(torque=size.shape, driveline=line.shape)
    own = line._of(line._geometry.batched(shape))
    if rate == 0.0 and not np.any(move):
        return own
    places = own._geometry.points
    by = np.broadcast_to(size, shape)[..., np.newaxis, np.newaxis]
    places[..., moved, :] = (
        turned(places[..., moved, :], middle, along / length, rate * by) + move * by
    )
    found = type(line).from_points(places, own.phases)
    positions = own._geometry.positions
    pairs = [(shaft, positions[..., i]) for i, shaft in enumerate(own._geometry.bearings)]
    return found.with_bearings(pairs) if pairs else found


def turned(
    points: FloatArray, about: FloatArray, axis: FloatArray, angle: FloatArray
) -> FloatArray:
    """Return points ``(..., 3)`` turned about a point and a unit vector.

    Angles in rad have the shape of the points, with one number in place of a vector. Those of 0
    leave points as they are.
    """
    matrix, arms = rotation(axis, angle[..., 0]), points - about
    first, second, third = (matrix[..., i] * arms[..., i : i + 1] for i in range(3))
    return np.where(angle == 0.0, points, about + (first + second + third))


def rotation(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Return matrices ``(..., 3, 3)`` of turns about a unit vector by angles in rad (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = (np.asarray(of(angle))[..., np.newaxis, np.newaxis] for of in (np.sin, np.cos))
    return np.asarray(cosine * np.eye(3) + (1.0 - cosine) * np.outer(axis, axis) + sine * cross)


def _vector(name: str, value: ArrayLike) -> FloatArray:
    array = as_float64(name, value)
    check_shape(name, array, array.shape == (3,), "it must be (3,)")
    require(name, np.all(np.isfinite(array)), f"is {array.tolist()}; it must be finite")
    return array
