"""Many turns of a curve as a band: the extremes and the mean of each turn, or span of time."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.turn.orders import continued
from cardan.arrays import FloatArray

_MOST_CURVES = 3.0  # turns of which curves can still be told apart
_MOST_BANDS = 400


@dataclass(frozen=True, eq=False)
class Bands:
    """Which samples of a recording or a long sweep belong to which part of the run."""

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
