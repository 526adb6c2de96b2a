"""Largest magnitudes over a turn of the drive, found between samples.

At a constant load every magnitude repeats after half a turn, because each joint and each shaft has
then made half a turn too; with deviations of the joints, after a whole turn. This period is sampled
at equal steps of the drive and, where a shaft turns steeply, also at equal steps of that shaft: as
functions of the angles of the two shafts of a joint, torques, moments and tilts are smooth, however
narrow they are over the drive angle. Every peak of the samples is then searched between its
neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output

# Steps of half a turn. The quantities have at most some four periods in it, so a peak and the
# sample next to it differ by less than a hundredth, and no peak below _NEAR is the largest.
_STEPS = 180
_NEAR = 0.9

# Shafts that never turn faster than this share of the drive's speed need no smaller steps.
_STEEP = 2.0

# Each round of a search leaves an eighth of the interval: from 2 degrees to 2e-9 rad. Off the peak
# by that much, a magnitude is less by a part of 1e-17.
_ROUNDS = 8
_POINTS = 17

# A place of the first samples stays if the search finds only roundings more.
_ROUNDING = 1e-15

_ALIKE = 1e-9


@dataclass(frozen=True)
class Peak:
    """The largest magnitude of a quantity over a turn.

    Attributes:
        value: the magnitude in SI units; its relative error is that of ``evaluate``, and below
            1e-12 in any case where the drive angle as a double resolves the peak.
        places: drive angles in rad within the period at which it occurs, each again a period
            later; none where it is the same at every angle.
    """

    value: float
    places: tuple[float, ...]


def peak(line: Driveline, name: str, item: int, load: Load | None = None) -> Peak:
    """Find the largest magnitude of an output over a turn; of a vector, the largest length.

    Args:
        line: one driveline.
        name: an output that repeats, which ``angle`` does not.
        item: shaft, joint or bearing.
        load: a constant load, if the output needs one.
    """
    output = OUTPUTS[name]

    def sizes(angles: FloatArray) -> FloatArray:
        return magnitudes(output, values_of(line, name, item, angles, load))

    return _over_period(line, sizes)


def slowest(line: Driveline, shaft: int) -> Peak:
    """Find the least speed ratio of a shaft over a turn, and where it occurs."""

    def slowness(angles: FloatArray) -> FloatArray:
        return 1.0 / values_of(line, "speed_ratio", shaft, angles, None)

    found = _over_period(line, slowness)
    return Peak(1.0 / found.value, found.places)


def period_of(line: Driveline) -> float:
    """Return the drive angle in rad after which magnitudes repeat."""
    return math.tau if line.has_deviations else math.pi


def _over_period(line: Driveline, sizes: Callable[[FloatArray], FloatArray]) -> Peak:
    period, angles = period_of(line), _half_turn(line.with_deviations())
    if line.has_deviations:
        angles = np.concatenate([angles, angles + math.pi])
    return _largest(sizes, angles, sizes(angles), period)


def values_of(
    line: Driveline, name: str, item: int, angles: ArrayLike, load: Load | None
) -> FloatArray:
    """Return the values of an output of one shaft, joint or bearing."""
    per = OUTPUTS[name].per
    if per == "bearing":
        values: FloatArray = line.evaluate(angles, name, load=load)[name][item]
    else:
        which: dict[str, Any] = {f"{per}s": item}
        values = line.evaluate(angles, name, load=load, **which)[name]
    return values


def magnitudes(output: Output, values: FloatArray) -> FloatArray:
    """Return the magnitudes of an output's values; of vectors, which are rows, the lengths."""
    if not output.vector:
        return np.abs(values)
    x, y, z = np.moveaxis(values, -1, 0)
    # Unlike the root of a sum of squares this is infinite only where the length is.
    with np.errstate(over="ignore"):
        found: FloatArray = np.hypot(np.hypot(x, y), z)
    return found


def _half_turn(line: Driveline) -> FloatArray:
    """Drive angles of half a turn in order, from 0 on, between which nothing is narrow."""
    steps = np.arange(_STEPS) * math.pi / _STEPS
    parts = [steps]
    for shaft in range(1, line.n_joints + 1):
        joint = line.equivalent(shaft)
        if joint.max_speed_ratio > _STEEP:
            # From equal steps of this shaft to its equivalent joint's driving angle.
            driving = np.arctan2(joint.min_speed_ratio * np.sin(steps), np.cos(steps))
            parts.append(driving - joint.angle_offset)
    return np.unique(np.concatenate(parts) % math.pi)


def _largest(
    sizes: Callable[[FloatArray], FloatArray],
    angles: FloatArray,
    values: FloatArray,
    period: float,
) -> Peak:
    """Search every peak of the samples that may be the largest."""
    low, top = float(np.min(values)), float(np.max(values))
    if top - low <= _ALIKE * top or not math.isfinite(top):
        return Peak(top, ())
    is_peak = (values >= np.roll(values, 1)) & (values >= np.roll(values, -1))
    found = np.flatnonzero(is_peak & (values >= _NEAR * top))
    around = np.concatenate([angles[-1:] - period, angles, angles[:1] + period])
    left, right = around[found], around[found + 2]
    places, peaks = angles[found], values[found]
    rows = np.arange(len(found))
    for _ in range(_ROUNDS):
        between = np.linspace(left, right, _POINTS, axis=-1)
        tried = sizes(between)
        best = np.argmax(tried, axis=-1)
        higher = tried[rows, best] > (1.0 + _ROUNDING) * peaks
        places = np.where(higher, between[rows, best], places)
        peaks = np.where(higher, tried[rows, best], peaks)
        left = between[rows, np.maximum(best - 1, 0)]
        right = between[rows, np.minimum(best + 1, _POINTS - 1)]
    top = float(np.max(peaks))
    places = np.unique(places[peaks >= (1.0 - _ALIKE) * top] % period)
    return Peak(top, tuple(places.tolist()))
