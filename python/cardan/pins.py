"""The pins of a joint in their bearings: moment and rates at an angle, and means over a turn.

A pin changes the sense in which it turns where it is in the bend plane or normal to it. Between
these angles everything is smooth, so that Gauss's sums over quarter turns of the joint's own input
angle converge to the last digits. The drive angles that belong to them follow from the inverse of
the chain before the joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray
from cardan.load import Load
from cardan.request import Request
from cardan.rows import blocks, chain_before, of_rows

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# Panels of a quarter turn of the joint, and when they are enough.
_FEWEST, _MOST = 2, 64
_SETTLED = 1e-11
# Samples at a time.
_BLOCK = 1 << 18


@dataclass(frozen=True, eq=False)
class Pins:
    """The pins of one joint at some angles.

    Attributes:
        moment: magnitude of the joint's moment in N m.
        rate_driving: rate at which the pins turn in the driving yoke, per radian of the drive.
        rate_driven: the same in the driven yoke.
        entering_torque: torque in N m that the driving shaft puts into the joint, without what the
            shaft's inertia takes.
        drive_torque: torque of the drive in N m.
        speed_ratio: of the driving shaft.
    """

    moment: FloatArray
    rate_driving: FloatArray
    rate_driven: FloatArray
    entering_torque: FloatArray
    drive_torque: FloatArray
    speed_ratio: FloatArray


def pins_at(line: Any, load: Load, joint: int, angle: ArrayLike) -> Pins:  # noqa: ANN401
    """Return the pins of a joint at drive angles in rad."""
    names = ("torque", "speed_ratio", "pin_moment", "swing_driving", "swing_driven")
    shafts = sorted({0, joint, joint + 1})
    at = line.evaluate(angle, names, shafts=shafts, joints=joint, load=load)
    torque = dict(zip(shafts, at.torque, strict=True))
    ratios = dict(zip(shafts, at.speed_ratio, strict=True))
    return Pins(
        moment=at.pin_moment,
        rate_driving=at.swing_driving,
        rate_driven=at.swing_driven,
        # From the power behind the joint.
        entering_torque=torque[joint + 1] * ratios[joint + 1] / ratios[joint],
        drive_torque=torque[0],
        speed_ratio=ratios[joint],
    )


def means_over_turn(
    line: Any,  # noqa: ANN401 - a driveline
    load: Load,
    rows: tuple[int, ...],
    integrands: Callable[[Pins, int, slice], FloatArray],
) -> FloatArray:
    """Return means over a turn of the drive, of every joint.

    They are exact to some 1e-11, and to some 1e-6 where inertias reverse the torque within a turn.

    Args:
        line: the driveline.
        load: constant over the turn; broadcasts against the batch.
        rows: shape of both together.
        integrands: of the pins of a joint, with its number and the rows that they are of, counted
            flat: quantities ``(m, rows, samples)``.

    Returns:
        of each joint and quantity ``(n, m, *rows)``.
    """
    request = Request(line, ("torque",), load=load)
    size = max(1, _BLOCK // (4 * _FEWEST * len(_NODES)))
    means = [
        np.stack([_of_joint(request, rows, block, joint, integrands) for joint in _joints(line)])
        for block in blocks(math.prod(rows), size)
    ]
    found = np.concatenate(means, axis=-1)
    return found.reshape(*found.shape[:-1], *rows)


def _joints(line: Any) -> range:  # noqa: ANN401 - a driveline
    return range(line.n_joints)


def _of_joint(
    request: Request,
    rows: tuple[int, ...],
    block: slice,
    joint: int,
    integrands: Callable[[Pins, int, slice], FloatArray],
) -> FloatArray:
    part = of_rows(request, rows, block)
    load = part.load
    assert load is not None

    def over(panels: int) -> FloatArray:
        """Sums over half a turn of the joint's own input angle, after which all repeats."""
        width = 0.5 * math.pi / panels
        own = (np.arange(2 * panels)[:, np.newaxis] + 0.5 * (1.0 + _NODES)).ravel() * width
        weights = np.tile(_WEIGHTS, 2 * panels) * (0.5 * width / math.pi)
        # The drive's pin for the joint's: the inverse of w -> A w + B conj(w).
        a, b = chain_before(part.line, joint)
        pin = np.exp(1j * own)
        pins = pins_at(part.line, load, joint, np.angle(np.conj(a) * pin - b * np.conj(pin)))
        # The drive turns by 1/r of what the joint's driving shaft turns.
        return np.asarray(np.sum(integrands(pins, joint, block) * (weights / pins.speed_ratio), -1))

    panels, before = _FEWEST, over(_FEWEST)
    while True:
        panels *= 2
        means = over(panels)
        apart = np.abs(means - before)
        if panels >= _MOST or not np.any(apart > _SETTLED * np.abs(means)):
            return means
        before = means
