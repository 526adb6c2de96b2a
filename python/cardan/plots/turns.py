"""Many turns of a curve as a band: the extremes and the mean of each turn."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray

_MOST_CURVES = 3.0  # turns of which curves can still be told apart
_MOST_BANDS = 400


@dataclass(frozen=True, eq=False)
class Turns:
    """Which samples of a recording or a long sweep belong to which turn of the drive.

    Attributes:
        edges: where the turns begin and end, in turns from the first sample, ``(turns + 1,)``.
            Of very many turns some are taken together.
        turn: to which of them each sample belongs, ``(samples,)``; -1 for one without an angle.
    """

    edges: FloatArray
    turn: NDArray[np.intp]

    @classmethod
    def of(cls, angle_deg: FloatArray) -> Turns | None:
        """Return the turns of drive angles, or ``None`` where these are few enough for curves."""
        known = ~np.isnan(angle_deg)
        place = np.full(angle_deg.shape, np.nan)
        place[known] = _continued(angle_deg[known]) / 360.0
        place -= place[known][:1]
        low, high = float(np.nanmin(place)), float(np.nanmax(place))
        if high - low <= _MOST_CURVES + 1e-9:
            return None
        together = math.ceil((high - low) / _MOST_BANDS)
        # Less than half a turn has not all of a joint's motion: it belongs to the turn before.
        bands = math.floor((high - low) / together + 0.5)
        turn = np.full(angle_deg.shape, -1)
        turn[known] = np.clip(np.floor((place[known] - low + 1e-9) / together), 0, bands - 1)
        edges = np.asarray(low + together * np.arange(bands + 1.0), np.float64)
        edges[-1] = high
        return cls(edges, turn)

    def extremes(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the least, the largest and the mean sample of each turn, NaN without samples."""
        known = (self.turn >= 0) & ~np.isnan(values)
        turn, given = self.turn[known], values[known]
        count = len(self.edges) - 1
        least, largest = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(least, turn, given)
        np.maximum.at(largest, turn, given)
        held = np.bincount(turn, minlength=count)
        sums = np.bincount(turn, weights=given, minlength=count)
        empty = held == 0
        least[empty] = largest[empty] = np.nan
        sums[empty] = np.nan
        return least, largest, sums / np.maximum(held, 1)


def _continued(angle_deg: FloatArray) -> FloatArray:
    """Angles that a logger wrote within one turn, each turn added to those before."""
    steps = np.diff(angle_deg)
    within = np.ptp(angle_deg) <= 360.0 if angle_deg.size else False
    if within and np.any(np.abs(steps) > 180.0):
        return np.unwrap(angle_deg, period=360.0)
    return angle_deg
