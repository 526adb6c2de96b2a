"""Differences due to rounding alone, and the residue of motions that cancel each other."""

from __future__ import annotations

import numpy as np

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.outputs import OUTPUTS
from cardan.motion.equivalent import EquivalentJoint

ROUNDING = 1e-9
"""Values that differ by less than this share of their size differ by rounding only."""

CANCELLED = 1e-12
"""Share below which the residue of cancelling k or cancelling moments of loads is rounding of the
geometry."""


def alike(low: float, high: float) -> bool:
    """Whether the ends of a range differ by no more than rounding."""
    return high - low <= ROUNDING * max(abs(low), abs(high))


STEADY = 0.01
"""Curves that vary by less than this share of their size are a line of text, no picture."""


def is_steady(curve: FloatArray, scale: float) -> bool:
    """Return whether a curve is a line of text; ``scale`` is what 0 would be measured in."""
    low, high = float(np.nanmin(curve)), float(np.nanmax(curve))
    return high - low <= max(STEADY * max(abs(low), abs(high)), ROUNDING * scale)


MAGNITUDES = frozenset(
    name
    for name, output in OUTPUTS.items()
    if output.per == "joint" and output.unit == "N m" and not output.vector
)
"""Outputs of a joint that are magnitudes in proportion to its torque."""


def signed(size: FloatArray, torque: FloatArray) -> FloatArray:
    """Return a magnitude with the sign of the torque that leaves its joint, if that reverses.

    Without the sign it would have a cusp wherever the torque passes through 0.
    """
    reverses = np.nanmin(torque) < 0.0 < np.nanmax(torque)
    return np.asarray(np.copysign(size, torque)) if reverses else size


def first_peak(sizes: FloatArray) -> tuple[int, bool]:
    """Return the place of the first of equal peaks, however they are rounded, and whether all are.

    Args:
        sizes: magnitudes, ``(samples,)``; NaN is left out.
    """
    largest = np.nanmax(sizes)
    place = int(np.argmax(sizes >= (1.0 - ROUNDING) * largest))
    return place, bool(largest - np.nanmin(sizes) <= ROUNDING * largest)


def flat_limits(low: float, high: float, scale: float) -> tuple[float, float] | None:
    """Return limits for values that only vary by rounding, which would else fill the axes.

    Args:
        low: least value.
        high: largest value.
        scale: what they would be measured in, if they are 0.
    """
    noise = ROUNDING * max(scale, abs(low), abs(high))
    if not high - low <= noise:
        return None
    middle = (low + high) / 2.0
    room = 0.05 * abs(middle) if abs(middle) > noise else scale
    return middle - room, middle + room


def equivalent_bend_deg(line: Driveline) -> float:
    """Return the equivalent bend of one driveline in degrees; what is mere rounding is 0."""
    joint = line.equivalent()
    return 0.0 if is_cancelled(line, joint) else float(np.degrees(joint.bend))


def is_cancelled(line: Driveline, joint: EquivalentJoint) -> bool:
    """Whether what is left of a shaft's motion is rounding of joints that cancel each other."""
    return bool(joint.k <= CANCELLED * np.max(np.tan(line.bends / 2.0) ** 2))
