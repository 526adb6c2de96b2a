"""Signals of a recording besides angles: times, speeds, torques, and values derived from them."""

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


# Parts of each octave that squares are counted in.
_PARTS = 16
# Exponents of 2 of the smallest numbers that count and of the largest.
_LEAST_EXPONENT, _LARGEST_EXPONENT = -120, 120


class MeanSquare:
    """The mean square of numbers that arrive in pieces; the pieces do not change its bits.

    Numbers are counted by size in sixteenths of an octave, so it is good to some percent.
    """

    def __init__(self) -> None:
        self._counts = np.zeros((_LARGEST_EXPONENT - _LEAST_EXPONENT) * _PARTS, np.int64)

    def add(self, values: FloatArray) -> None:
        """Go on to further numbers; those missing, NaN, do not count."""
        shares, exponents = np.frexp(np.abs(values[np.isfinite(values)]))
        places = np.floor((shares - 0.5) * (2 * _PARTS)) + (exponents - _LEAST_EXPONENT) * _PARTS
        # 0 counts as the smallest number.
        places = np.where(shares > 0.0, np.clip(places, 0, self._counts.size - 1), 0)
        self._counts += np.bincount(places.astype(np.int64), minlength=self._counts.size)

    @property
    def root(self) -> float:
        """The root of the mean square; 0 before the first number."""
        if not self._counts.any():
            return 0.0
        exponents, parts = np.divmod(np.arange(self._counts.size), _PARTS)
        sizes = np.ldexp(0.5 + (parts + 0.5) / (2 * _PARTS), exponents + _LEAST_EXPONENT)
        return math.sqrt(float(self._counts @ sizes**2) / float(np.sum(self._counts)))


@dataclass(frozen=True)
class Scatter:
    """The noise in an acceleration in rad/s², and with how large a filter it is a tenth.

    ``reach`` is 0 if the noise matters little: less than half of the acceleration, or little beside
    what joints cause at the speed.
    """

    noise: float
    reach: int = 0


# Noise that is more than this share of an acceleration makes it useless, and that at which the
# noise does not matter; of the square of the speed, what straight joints may leave as well.
_USELESS = 0.5
_HARMLESS = 0.1
_SLIGHT = 1e-4
_LARGEST_REACH = 1000


class Noise:
    """Finds the noise of a signal over time, in pieces, and that of its derivatives.

    What a sample differs from the line between its neighbours is noise, if the signal bends little
    from sample to sample. Neighbours are taken for independent.
    """

    def __init__(self, order: int, reach: int) -> None:
        """Begin before the first sample of a signal whose derivative of some order is needed."""
        self._order, self._reach = order, reach
        self._time, self._values = np.empty(0), np.empty(0)
        self._apart, self._speed, self._acceleration = MeanSquare(), MeanSquare(), MeanSquare()

    def add(self, time: FloatArray, values: FloatArray) -> None:
        """Go on to samples of the signal, ``(rows,)``; NaN where they are missing."""
        time = np.concatenate([self._time, time])
        values = np.concatenate([self._values, values])
        self._time, self._values = time[-2:], values[-2:]
        if time.size > 2:
            share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
            apart = values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:]
            self._apart.add(apart / np.sqrt(1.0 + (1.0 - share) ** 2 + share**2))

    def add_derived(self, speed: FloatArray, acceleration: FloatArray) -> None:
        """Go on to speeds and accelerations with whole filters."""
        self._speed.add(speed)
        self._acceleration.add(acceleration)

    def scatter(self, rate: float) -> Scatter:
        """Return the noise of the acceleration with so many samples per second."""
        each = self._apart.root
        noise = each * self._gain(self._reach, rate)
        whole, slight = self._acceleration.root, _SLIGHT * self._speed.root**2
        if noise <= max(_USELESS * whole, slight):
            return Scatter(noise)
        wanted = max(_HARMLESS * math.sqrt(max(0.0, whole**2 - noise**2)), slight)
        reach = self._reach
        while reach < _LARGEST_REACH and each * self._gain(reach, rate) > wanted:
            reach += 1
        return Scatter(noise, reach)

    def _gain(self, reach: int, rate: float) -> float:
        """How large the noise of a derivative is for that of a sample, by the parabola's sums."""
        second = reach * (reach + 1.0) * (2.0 * reach + 1.0) / 3.0
        if self._order == 1:
            return rate / math.sqrt(second)
        fourth = second * (2.0 * reach - 1.0) * (2.0 * reach + 3.0) / 15.0
        return 2.0 * rate**2 / math.sqrt(fourth)


Measured = Literal["time", "speed", "acceleration", "drive_torque"]
"""A signal of the drive."""


@dataclass(frozen=True)
class Signal:
    """The extent of a signal, by which a wrong unit is seen, in the unit that the scene gives it.

    What was derived from others has no column, but the reach of the filter: samples on each side.
    Times have the sampling of the whole recording so far, and accelerations their scatter. Missing
    samples do not count.
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
    scatter: Scatter | None = None

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
            scatter=later.scatter,
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
