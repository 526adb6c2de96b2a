"""Double joints with a centring pivot: the bends of their two joints at every total bend.

The two joints of the steering drive of an axle, or of a wide-angle shaft, are a short distance
apart, and a pivot between them centres the piece that connects them. The law of sines in the
triangle of joint 0, pivot and joint 1 gives their bends.

Both bends are equal, and the drive is synchronous, where ``p = a/(2 cos(t/2))`` with the distances
from joint 0 ``a`` of joint 1 and ``p`` of the pivot and the total bend ``t``. One pivot cannot do
that at every bend: one that is to be synchronous at a bend lies a little farther than the middle of
the joints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape, positive
from cardan.arrays.errors import ArgumentValueError, check_elements, exclusive

if TYPE_CHECKING:
    from cardan.driveline import Driveline


def from_double_joint(
    cls: type[Driveline],
    total: ArrayLike,
    length: ArrayLike,
    pivot: ArrayLike | None = None,
    synchronous: ArrayLike | None = None,
    *,
    degrees: bool = False,
) -> Driveline:
    """Make centred double joints: two joints with yokes in line, bent in the same sense.

    The pivot is fixed to the driving shaft, at the distance ``p`` from joint 0, and slides
    along the driven one: ``sin b_1 = (p/length) sin(total)`` and ``b_0 = total - b_1`` (derived
    here). All arguments broadcast against each other; their shape is the batch.

    Args:
        total: bend between the driving and the driven shaft.
        length: distance between the joint centres, in any unit.
        pivot: distance of the pivot from the centre of joint 0, in the same unit; by default
            half the length.
        synchronous: or the total bend at which both joints have the same bend, so that the
            pivot is at ``length/(2 cos(synchronous/2))``. Give one of the two at most.
        degrees: whether the bends are in degrees.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a total bend outside [0, 180°) or one that bends a joint by 90° or more, a
            length that is not positive, a pivot that is not between the joints, both a pivot
            and a synchronous bend, shapes that do not broadcast.

    >>> import cardan
    >>> joint = cardan.Driveline.from_double_joint([20, 35], 0.06, synchronous=35, degrees=True)
    >>> joint.bends_deg.round(4)
    array([[ 9.6705, 10.3295],
           [17.5   , 17.5   ]])
    """
    exclusive(pivot=pivot, synchronous=synchronous)
    bend, apart = as_float64("total", total), positive("length", length)
    turn = 180.0 if degrees else np.pi
    unit = " deg; it must lie in [0, 180) deg" if degrees else " rad; it must lie in [0, pi) rad"
    check_elements("total", bend, (bend >= 0.0) & (bend < turn), unit)
    share = _share(apart, pivot, synchronous, degrees)
    shape = common_shape(total=bend.shape, length=apart.shape, pivot=share.shape)
    angle = np.broadcast_to(np.radians(bend) if degrees else bend, shape)
    driven = np.arcsin(share * np.sin(angle))
    bends = np.stack([angle - driven, driven], axis=-1)
    if np.any(bends >= 0.5 * np.pi):
        *place, joint = (int(i) for i in np.argwhere(bends >= 0.5 * np.pi)[0])
        given = np.broadcast_to(bend, shape)[*place]
        raise ArgumentValueError(
            "total",
            f"is {given}{' deg' if degrees else ' rad'}, which bends joint {joint} by "
            f"{np.degrees(bends[*place, joint]):.6g} deg; a bend must lie in [0, 90) deg",
            tuple(place) if bend.ndim else (),
        )
    return cls.from_bends(bends)


def _share(
    apart: FloatArray, pivot: ArrayLike | None, synchronous: ArrayLike | None, degrees: bool
) -> FloatArray:
    """The distance of the pivot from joint 0 over that of the joints."""
    if synchronous is not None:
        bend = as_float64("synchronous", synchronous)
        most = 120.0 if degrees else 2.0 * np.pi / 3.0
        unit = "deg" if degrees else "rad"
        rule = f" {unit}; it must lie in [0, {most:.6g}) {unit}, which puts the pivot between them"
        check_elements("synchronous", bend, (bend >= 0.0) & (bend < most), rule)
        half = 0.5 * (np.radians(bend) if degrees else bend)
        return np.asarray(0.5 / np.cos(half))
    if pivot is None:
        return np.asarray(0.5)
    place = as_float64("pivot", pivot)
    common_shape(pivot=place.shape, length=apart.shape)
    share = place / apart
    right = (share > 0.0) & (share < 1.0)
    whole = np.broadcast_to(place, share.shape)
    check_elements("pivot", whole, right, "; it must lie between the joints")
    return np.asarray(share)
