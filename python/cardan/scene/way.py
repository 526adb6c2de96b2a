"""How far a recorded drive goes."""

from __future__ import annotations

import math

import numpy as np

from cardan.arrays import FloatArray


class Way:
    """The way of a drive, forward and back, from drive angles in pieces.

    Angles that stay within one turn and leap by more than half a turn are those of a counter that
    starts anew at each turn: the leap is no way.
    """

    def __init__(self) -> None:
        """Begin before the first angle."""
        self._last = np.empty(0)
        self._low, self._high = math.inf, -math.inf
        self._steps = self._without_leaps = 0.0

    def add(self, degrees: FloatArray) -> None:
        """Go on to drive angles in degrees, ``(samples,)``, none missing."""
        if not degrees.size:
            return
        steps = np.abs(np.diff(np.concatenate([self._last, degrees])))
        self._steps += float(np.sum(steps))
        self._without_leaps += float(np.sum(np.minimum(steps, np.abs(steps - 360.0))))
        self._low = min(self._low, float(np.min(degrees)))
        self._high = max(self._high, float(np.max(degrees)))
        self._last = degrees[-1:]

    @property
    def turns(self) -> float:
        """The way in turns."""
        within = self._high - self._low <= 360.0
        return (self._without_leaps if within else self._steps) / 360.0
