"""The sampling of a recording: its rate, and gaps in its times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cardan.arrays import FloatArray

# A step of time that is this many times the lesser of its neighbours is a gap. Times that are
# rounded to the resolution of a clock differ by a factor of 2.
_GAP = 2.5


@dataclass(frozen=True)
class Sampling:
    """How a recording is sampled.

    Attributes:
        rate: samples per second, without gaps; ``None`` of fewer than two times.
        gaps: how many gaps there are in the times.
        longest: the longest gap in s; 0 without any.
        longest_after: the time in s of the sample before it.
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
