"""The one joint that moves a shaft as its whole chain does, and its harmonics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import scalar_or_array
from cardan.errors import ArgumentTypeError, wrong_element
from cardan.geometry import Geometry
from cardan.request import item_index


@dataclass(frozen=True, eq=False)
class EquivalentJoint:
    """Closed forms of one shaft's motion; each field has the shape of the driveline batch.

    Every shaft of every chain turns exactly as the driven shaft of one joint does, whose driving
    angle is the drive angle plus an offset. Near full compensation compare ``k`` or
    ``non_uniformity``, not ``bend``: a rounding of 1e-16 in ``k`` is 2e-8 rad in ``bend``.

    Source: a joint takes the pin's direction ``w = exp(i a)`` to ``w - tan(b/2)**2 conj(w)`` (from
    Thoma 4), a chain to ``A w + B conj(w)``, and ``k = |B/A|``. For one joint these are the
    catalogues' Bilder 12 (``max_angle_error``) and 13 (``non_uniformity``).

    Attributes:
        bend: equivalent bend in rad.
        angle_offset: what to add to the drive angle to get this joint's driving angle, in rad,
            within (-pi/2, pi/2]; 0 where the shaft turns uniformly.
        k: ``tan(bend/2)**2``, the sine of the largest angle error.
        non_uniformity: largest less smallest speed ratio (catalogue, single joint:
            ``U = tan(bend) sin(bend)``).
        max_angle_error: in rad, at ``tan**2 = cos(bend)`` of the driving angle.
        min_speed_ratio: ``cos(bend)``.
        max_speed_ratio: ``1/cos(bend)``.
        max_acceleration_ratio: largest magnitude of the acceleration ratio.
    """

    bend: NDArray[np.float64]
    angle_offset: NDArray[np.float64]
    k: NDArray[np.float64]
    non_uniformity: NDArray[np.float64]
    max_angle_error: NDArray[np.float64]
    min_speed_ratio: NDArray[np.float64]
    max_speed_ratio: NDArray[np.float64]
    max_acceleration_ratio: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Amplitudes of one shaft's motion by order of the drive's rotation.

    With the equivalent joint's ``k`` and driving angle ``a`` the motion is exactly the series
    ``angle_error = sum k**n sin(2 n a) / n``, ``speed_ratio = 1 + sum 2 k**n cos(2 n a)``: only
    even orders ``2 n`` occur.

    Source: the angle error by Thoma's (4) is ``arg(1 - k exp(-2 i a))``; its series and derivative.

    Attributes:
        orders: the orders asked for, ``(m,)``.
        angle_error: amplitude in rad, ``(..., m)``.
        speed_ratio: amplitude, ``(..., m)``.
    """

    orders: NDArray[np.int64]
    angle_error: NDArray[np.float64]
    speed_ratio: NDArray[np.float64]


def equivalent(geometry: Geometry, shaft: int) -> EquivalentJoint:
    """Find the equivalent joint as ``Driveline.equivalent`` does."""
    *shape, n_joints = geometry.bends.shape
    index = item_index("shaft", shaft, n_joints + 1)
    bends, twists, phases, *_ = geometry.flat()
    columns = _core.equivalent(n_joints, index, bends, twists, phases)
    return EquivalentJoint(*(scalar_or_array(c.reshape(shape)) for c in columns))


def harmonics(geometry: Geometry, orders: ArrayLike, shaft: int) -> Harmonics:
    """Find the amplitudes as ``Driveline.harmonics`` does."""
    order = np.atleast_1d(np.asarray(orders))
    if order.dtype.kind not in "iu":
        raise ArgumentTypeError("orders", f"has dtype {order.dtype}; an order is an integer")
    if np.any(order < 1):
        raise wrong_element("orders", order, order < 1, "; an order is at least 1")
    n = order / 2
    k = np.asarray(equivalent(geometry, shaft).k)[..., np.newaxis]
    power = np.where(order % 2 == 0, k**n, 0.0)
    return Harmonics(order.astype(np.int64), power / n, 2.0 * power)
