"""What a recording holds besides angles: times, speeds, torques, and what was derived from them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan.arrays import FloatArray

# A step of time that is this many times the lesser of its neighbours is a gap. Times that are
# rounded to the resolution of a clock differ by a factor of 2.
_GAP = 2.5


@dataclass(frozen=True)
class Sampling:
    """How many samples per second a recording has without its gaps, and the longest gap in s.

    Fewer than two times have no rate. ``longest_after`` is the time of the sample before that gap.
    """

    rate: float | None = None
    gaps: int = 0
    longest: float = 0.0
    longest_after: float = 0.0


class Timing:
    """Finds the sampling of times that arrive in pieces; the pieces do not change its bits.

    A row without a time is no gap: its neighbours are two rows apart.
    """

    def __init__(self) -> None:
        """Begin before the first time."""
        self._count = 0
        # Of the steps between the times that are held, the first so many are judged.
        self._times, self._rows, self._judged = np.empty(0), np.empty(0), 0
        self._first: tuple[float, float] | None = None
        # Each gap with the time before it and the rows that it spans.
        self._gaps: list[tuple[float, float, float]] = []

    def add(self, time: FloatArray) -> None:
        """Go on to times in s, ``(rows,)``; NaN where they are missing."""
        rows = self._count + np.arange(time.size, dtype=np.float64)
        self._count += time.size
        if np.isnan(np.min(time, initial=np.inf)):
            known = ~np.isnan(time)
            time, rows = time[known], rows[known]
        self._times = np.concatenate([self._times, time])
        self._rows = np.concatenate([self._rows, rows])
        if self._first is None and self._times.size:
            self._first = float(self._times[0]), float(self._rows[0])
        # The last step is judged when the one after it is known.
        steps = self._times.size - 1
        if steps > 1:
            self._gaps += self._found(steps - 1)
            self._times, self._rows, self._judged = self._times[-3:], self._rows[-3:], 1

    def sampling(self) -> Sampling:
        """Return what is known of the times so far."""
        if self._first is None or self._times[-1] == self._first[0]:
            return Sampling()
        gaps = [*self._gaps, *self._found(self._times.size - 1)]
        seconds, rows = self._times[-1] - self._first[0], self._rows[-1] - self._first[1]
        for gap, _, own_rows in gaps:
            seconds, rows = seconds - gap, rows - own_rows
        longest, after, _ = max(gaps, key=lambda gap: gap[0], default=(0.0, 0.0, 0.0))
        return Sampling(float(rows / seconds), len(gaps), longest, after)

    def _found(self, end: int) -> list[tuple[float, float, float]]:
        """Find the gaps among the steps that are not judged, up to one."""
        if end <= self._judged:
            return []
        seconds = each = np.diff(self._times)
        rows = np.broadcast_to(1.0, seconds.shape)
        if self._rows[-1] - self._rows[0] != seconds.size:
            rows = np.diff(self._rows)
            each = seconds / rows
        # Even steps have no gaps, which is soon seen.
        if float(np.max(each)) <= _GAP * float(np.min(each)):
            return []
        around = np.minimum(
            np.concatenate([[np.inf], each[:-1]]), np.concatenate([each[1:], [np.inf]])
        )
        is_gap = each > _GAP * around
        is_gap[: self._judged] = is_gap[end:] = False
        found = np.stack([seconds, self._times[:-1], rows], axis=-1)[is_gap]
        return [(gap, after, own_rows) for gap, after, own_rows in found.tolist()]


Measured = Literal["time", "speed", "acceleration", "drive_torque"]
"""A signal of the drive."""


@dataclass(frozen=True)
class Signal:
    """The extent of a signal, by which a wrong unit is seen, in the unit that the scene gives it.

    What was derived from others has no column, but the reach of the filter: samples on each side.
    Times have the sampling of the whole recording so far. Missing samples do not count.
    """

    signal: Measured
    column: str | None
    unit: str
    first: float
    last: float
    min: float
    max: float
    reach: int = 0
    sampling: Sampling | None = None

    @classmethod
    def of(
        cls, signal: Measured, column: str | None, unit: str, values: FloatArray, reach: int = 0
    ) -> Signal | None:
        """Return the extent of values, ``(samples,)``; ``None`` where all are missing."""
        known = values
        # With numbers at both ends, gaps between them do not matter here.
        if not values.size or np.isnan(values[[0, -1]]).any():
            known = values[~np.isnan(values)]
            if not known.size:
                return None
        ends = float(known[0]), float(known[-1])
        extent = float(np.fmin.reduce(known)), float(np.fmax.reduce(known))
        return cls(signal, column, unit, *ends, *extent, reach)

    def followed_by(self, later: Signal) -> Signal:
        """Return the extent of this signal and what comes after it."""
        return replace(
            self,
            last=later.last,
            min=min(self.min, later.min),
            max=max(self.max, later.max),
            sampling=later.sampling,
        )


def joined(before: Sequence[Signal], later: Iterable[Signal]) -> tuple[Signal, ...]:
    """Return the signals of two pieces of a recording that follow each other."""
    found = {signal.signal: signal for signal in before}
    for signal in later:
        earlier = found.get(signal.signal)
        found[signal.signal] = earlier.followed_by(signal) if earlier else signal
    return tuple(found.values())


# A way that is longer than from the first angle to the last by more than this share turns back.
_NOISE = 0.01


class Way:
    """The way of a drive, forward and back, from drive angles in pieces.

    Angles that stay within one turn and leap by more than half a turn are those of a counter that
    starts anew at each turn: the leap is no way.
    """

    def __init__(self) -> None:
        """Begin before the first angle."""
        self._first = self._last = np.empty(0)
        self._low, self._high = math.inf, -math.inf
        self._steps = self._without_leaps = 0.0

    def add(self, degrees: FloatArray) -> None:
        """Go on to drive angles in degrees, ``(samples,)``, none missing."""
        if not degrees.size:
            return
        steps = np.diff(np.concatenate([self._last, degrees]))
        np.abs(steps, out=steps)
        way = float(np.sum(steps))
        self._steps += way
        if np.max(steps, initial=0.0) > 180.0:
            way = float(np.sum(np.minimum(steps, np.abs(steps - 360.0))))
        self._without_leaps += way
        self._low = min(self._low, float(np.min(degrees)))
        self._high = max(self._high, float(np.max(degrees)))
        self._first = self._first if self._first.size else degrees[:1]
        self._last = degrees[-1:]

    @property
    def turns(self) -> float:
        """The way in turns."""
        return (self._without_leaps if self._starts_anew else self._steps) / 360.0

    @property
    def extent(self) -> tuple[float, float] | None:
        """The least and the largest angle in degrees of a drive that turns back, else ``None``.

        Less than a hundredth of the way back is the noise of an encoder.
        """
        straight = float(np.sum(np.abs(self._last - self._first)))
        if self._starts_anew or self._steps <= (1.0 + _NOISE) * straight:
            return None
        return self._low, self._high

    @property
    def _starts_anew(self) -> bool:
        return self._high - self._low <= 360.0 and self._without_leaps < self._steps
