"""A recording of many turns: its orders at any speed, and its turns as bands."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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


# --- bands ---------------------------------------------------------------------------------------

_MOST_CURVES = 3.0  # turns of which curves can still be told apart
_MOST_BANDS = 400


@dataclass(frozen=True, eq=False)
class Bands:
    """Samples of a recording or a long sweep that belong to each part of the run."""

    # Where the parts begin and end, ``(parts + 1,)``: in turns from the first sample, of which many
    # are taken together, or times in s.
    edges: FloatArray
    # To which of them each sample belongs, ``(samples,)``; -1 for one that is missing.
    part: NDArray[np.intp]
    label: str
    # What a part is.
    each: str

    @classmethod
    def of_turns(cls, angle_deg: FloatArray) -> Bands | None:
        """Return the turns of drive angles, or ``None`` where these are few enough for curves."""
        place, low, high = _turns(angle_deg)
        if high - low <= _MOST_CURVES + 1e-9:
            return None
        together = math.ceil((high - low) / _MOST_BANDS)
        # Less than half a turn has not all of a joint's motion: it belongs to the turn before.
        count = math.floor((high - low) / together + 0.5)
        edges = np.asarray(low + together * np.arange(count + 1.0), np.float64)
        edges[-1] = high
        part = _parts((place - low + 1e-9) / together, count)
        each = "turn" if together == 1 else "group of turns"
        return cls(edges, part, "turns of the drive", each)

    @classmethod
    def of_time(cls, time: FloatArray, angle_deg: FloatArray) -> Bands | None:
        """Return the turns over time, or ``None`` where these are few enough for curves.

        Of a drive that turns back they are equal spans of time, as many as there are turns at most.
        """
        turns = cls.of_turns(angle_deg)
        if turns is None:
            return None
        place, low, high = _turns(angle_deg)
        known = ~(np.isnan(place) | np.isnan(time))
        if np.all(np.diff(place[known]) > 0.0):
            edges = np.interp(turns.edges, place[known], time[known])
            return replace(turns, edges=edges, label="time [s]")
        begin, end = float(np.nanmin(time)), float(np.nanmax(time))
        count = min(_MOST_BANDS, math.floor(high - low))
        edges = np.linspace(begin, end, count + 1)
        part = _parts((time - begin) * (count / (end - begin)), count)
        return cls(edges, part, "time [s]", f"span of {(end - begin) / count:.3g} s")

    def extremes(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the least, the largest and the mean sample of each part, NaN without samples."""
        known = (self.part >= 0) & ~np.isnan(values)
        part, given = self.part[known], values[known]
        count = len(self.edges) - 1
        least, largest = np.full(count, np.inf, float), np.full(count, -np.inf, float)
        np.minimum.at(least, part, given)
        np.maximum.at(largest, part, given)
        held = np.bincount(part, minlength=count)
        sums = np.bincount(part, weights=given, minlength=count)
        empty = held == 0
        least[empty] = largest[empty] = np.nan
        sums[empty] = np.nan
        return least, largest, np.asarray(sums / np.maximum(held, 1), np.float64)


def _turns(angle_deg: FloatArray) -> tuple[FloatArray, float, float]:
    """Turns from the first sample, NaN where missing, with the least and the largest."""
    known = ~np.isnan(angle_deg)
    place = np.full(angle_deg.shape, np.nan)
    place[known] = continued(angle_deg[known], 360.0) / 360.0
    place -= place[known][:1]
    return place, float(np.nanmin(place)), float(np.nanmax(place))


def _parts(place: FloatArray, count: int) -> NDArray[np.intp]:
    """The part in which each place lies, the ends included."""
    known = ~np.isnan(place)
    part = np.full(place.shape, -1, np.intp)
    part[known] = np.clip(np.floor(place[known]), 0, count - 1)
    return part
