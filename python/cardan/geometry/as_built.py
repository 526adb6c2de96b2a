"""Joints as built: yokes that lean and crosses that are not square (``docs/theory/as-built.md``).

With unit vectors ``u`` and ``v`` along driving and driven shaft, ``p`` along the driving pin and
``q`` along the driven one, a driving yoke deviates by ``p . u = sin e1``, so that it leans towards
the driven shaft, a cross by ``p . q = sin e2`` and a driven yoke by ``q . v = sin e3``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, as_float64, not_negative, per_joint, positive, together
from cardan.arrays.errors import check_elements

if TYPE_CHECKING:
    from cardan.driveline import Driveline

DEVIATIONS = ("driving_yoke", "cross", "driven_yoke")
"""The deviations of a joint, in the order of ``Driveline.deviations``."""


def with_deviations(
    line: Driveline,
    driving_yoke: ArrayLike = 0.0,
    cross: ArrayLike = 0.0,
    driven_yoke: ArrayLike = 0.0,
    *,
    degrees: bool = False,
) -> Driveline:
    """Return the driveline with joints as built, in place of any other deviations.

    ``evaluate``, ``plan`` and ``harmonics`` take it like any other driveline and compute it
    joint by joint, with the forces of its joints and bearings. What needs one equivalent joint,
    such as ``equivalent`` and ``optimal_phases``, refuses it; without arguments,
    ``with_deviations()`` returns the ideal driveline for these. A joint turns if ``abs(C) < R``
    at every angle (the four-bar linkage of ``docs/theory/as-built.md``), for which
    ``abs(driving_yoke) + abs(cross) + abs(driven_yoke) < 90° - bend`` is enough.

    Args:
        driving_yoke: angle by which the driving pin leans from the normal of the driving shaft
            towards the driven one: one number, or one per joint ``(..., n)``, like the
            following arguments. A pin bearing that sits ``0.1 mm`` off at an arm of ``40 mm``
            leans by ``0.1 / 40`` rad.
        cross: angle by which the two pins of the cross are closer than 90°.
        driven_yoke: angle by which the driven pin leans from the normal of the driven shaft
            towards its driven end.
        degrees: whether the three are in degrees.

    Raises:
        ValueError: values that are not finite or not within 90°, a joint that cannot turn,
            shapes that do not fit.

    >>> import cardan
    >>> joint = cardan.Driveline.from_bends([10.0], degrees=True)
    >>> leaning = joint.with_deviations(driving_yoke=0.001)
    >>> leaning.harmonics([1, 2], outputs="angle_error").angle_error.round(6)
    array([0.000175, 0.007654])
    """
    own, n = line._geometry, line.n_joints
    given = dict(zip(DEVIATIONS, (driving_yoke, cross, driven_yoke), strict=True))
    arrays = {name: (angles_of_joints(name, x, n, degrees), 1) for name, x in given.items()}
    shape, full = together(arrays, driveline=own.shape)
    ideal = own._replace(deviations=np.empty((*own.shape, 0, 3))).batched(shape)
    deviations = np.stack(full, axis=-1)
    if not np.any(deviations != 0.0):
        return line._of(ideal)
    _core.check_deviations(n, shape, ideal.bends.reshape(-1), deviations.reshape(-1))
    return line._of(ideal._replace(deviations=deviations))


def with_play(line: Driveline, radial: ArrayLike, arm: ArrayLike) -> Driveline:
    """Return the driveline with its joints on either flank of the play in their pin bearings.

    Torque one way moves the pins of each yoke to one side by the angle ``radial / arm``. Both
    yokes of a joint together make this a deviation of the cross of twice that angle, one way or
    the other (derived here).

    Args:
        radial: radial play of a pin in its bearing, from the middle to either side: one number,
            or one per joint ``(..., n)``, like the following argument.
        arm: distance of the middle of a pin's bearing from the centre of the joint, in the same
            unit.

    Returns:
        a batch with a new first axis of 2: the flank under a positive torque, on which driven
        shafts lag, and the flank of coasting.

    Raises:
        ValueError: a negative play, an arm that is not positive, a joint that cannot turn,
            shapes that do not fit.

    >>> import cardan
    >>> joint = cardan.Driveline.from_bends([10.0], degrees=True).with_play(0.02e-3, 0.03)
    >>> joint.deviations[:, 0, 1].round(6)
    array([ 0.001333, -0.001333])
    """
    n = line.n_joints
    play = per_joint("radial", not_negative("radial", radial), n)
    play = play / per_joint("arm", positive("arm", arm), n)
    _, (own, skew) = together({"driveline": (line.deviations, 2), "play": (2.0 * play, 1)})
    driving, cross, driven = np.moveaxis(own, -1, 0)
    return line.with_deviations(driving, np.stack([cross + skew, cross - skew]), driven)


def angles_of_joints(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Return deviations in rad: one for all joints, or one for each on the last axis."""
    array = as_float64(name, value)
    right_angle, unit = (90.0, " deg") if degrees else (0.5 * np.pi, " rad")
    rule = f"{unit}; a deviation must lie within 90 deg"
    check_elements(name, array, np.abs(array) < right_angle, rule)
    array = per_joint(name, array, n)
    return np.radians(array) if degrees else array
