"""How far a recorded drive goes."""

from __future__ import annotations

import math

import numpy as np

from cardan.arrays import FloatArray

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
