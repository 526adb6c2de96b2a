"""Orders of a recording: amplitudes by multiples of the drive's rotation, at any speed."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cardan.arrays import FloatArray

MOST = 12.0
"""The largest order that is looked for."""

# Turns of a segment: the orders are then told apart in steps of a twentieth or less.
_TURNS = 20

_LEAST_PER_TURN, _MOST_PER_TURN = 64, 4096


class Orders(NamedTuple):
    """The orders of signals, in steps of one over the turns of a segment."""

    # Multiples of the drive's rotation, ``(orders,)``.
    orders: FloatArray
    # Root mean squares of the segments, ``(signals, orders)``; of order 0 the mean.
    amplitudes: FloatArray
    turns: int
    segments: int


def continued(angle: FloatArray, turn: float = math.tau) -> FloatArray:
    """Return angles that a logger wrote within one turn, each turn added to those before."""
    within = np.ptp(angle) <= turn if angle.size else False
    if within and np.any(np.abs(np.diff(angle)) > turn / 2.0):
        return np.unwrap(angle, period=turn)
    return angle


def orders(angle: FloatArray, signals: FloatArray) -> Orders:
    """Return the orders of signals, resampled by the angle of the drive.

    Samples at equal steps of the angle are interpolated by cubics through the four samples around
    them. The signals are divided into segments of whole turns, up to 20, and an order that is a
    whole multiple of one over these turns does not leak into others. The linear trend of a segment
    is taken out: a run-up is no order. Orders go up to 12, or to half the samples per turn.

    Drive angles are in rad, NaN where a sample is missing; the signals are ``(signals, samples)``.
    """
    known = ~(np.isnan(angle) | np.any(np.isnan(signals), axis=0))
    place, values = continued(angle[known]), signals[:, known]
    if place.size:
        # Of samples at rest, as before a run-up, the last one.
        moves = np.append(np.diff(place) != 0.0, True)
        place, values = place[moves], values[:, moves]
    steps = np.diff(place)
    if steps.size and steps[0] < 0.0:
        place, steps = -place, -steps
    if not np.all(steps > 0.0):
        raise ValueError("orders need a drive that turns one way; its angle goes back")
    turns = (place[-1] - place[0]) / math.tau if place.size else 0.0
    # Rounding may leave a whole turn just below one.
    if turns + 1e-9 < 1.0 or place.size < 8:
        raise ValueError(
            f"orders need at least one turn and 8 samples; there are {turns:.3g} turns"
        )
    turns += 1e-9
    per_turn = place.size / turns
    if per_turn < 2.0:
        raise ValueError(
            f"orders need at least two samples per turn; there are {per_turn:.3g} over "
            f"{turns:.4g} turns"
        )
    segments = math.ceil(math.floor(turns) / _TURNS)
    length = math.floor(turns) // segments
    # Half orders, of engines with four strokes, need an even number.
    length -= length % 2 if length > 1 else 0
    grid = 2 ** math.ceil(math.log2(min(max(2.0 * per_turn, _LEAST_PER_TURN), _MOST_PER_TURN)))
    count = 1 + math.floor(length * min(MOST, per_turn / 2.0, grid / 2.0))
    power = np.zeros((len(values), count))
    at = math.tau * np.arange(length * grid) / grid
    for segment in range(segments):
        resampled = _cubic(place[0] + math.tau * length * segment + at, place, values)
        resampled -= _trend(resampled, length, grid)
        found = np.abs(np.fft.rfft(resampled, axis=1)[:, :count]) / at.size
        found[:, 1:] *= 2.0
        power += found**2
    amplitudes = np.asarray(np.sqrt(power / segments), np.float64)
    return Orders(np.arange(count) / length, amplitudes, length, segments)


def _trend(values: FloatArray, turns: int, grid: int) -> FloatArray:
    """The linear trend of signals, through the means of turns at both ends; 0 in the middle.

    Whole orders have no mean over these turns, and thus no trend.
    """
    if turns == 1:
        return np.zeros_like(values)
    ends = max(1, 2 * (turns // 4))
    first, last = values[:, : ends * grid], values[:, -ends * grid :]
    slope = (last.mean(axis=1) - first.mean(axis=1)) / (turns - ends)
    along = (np.arange(turns * grid) - 0.5 * (turns * grid - 1)) / grid
    return np.asarray(slope[:, np.newaxis] * along, np.float64)


def _cubic(at: FloatArray, place: FloatArray, values: FloatArray) -> FloatArray:
    """Values at other places, by Lagrange's cubic through the four samples around each."""
    first = np.clip(np.searchsorted(place, at) - 2, 0, place.size - 4)
    nodes = [place[first + i] for i in range(4)]
    result = np.zeros((len(values), at.size))
    for i, node in enumerate(nodes):
        weight = np.ones(at.size)
        for other in (*nodes[:i], *nodes[i + 1 :]):
            weight *= (at - other) / (node - other)
        result += weight * values[:, first + i]
    return result
