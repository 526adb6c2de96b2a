"""What a recording holds besides angles: times, speeds, torques, and what was derived from them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan.app.scene.timing import Sampling
from cardan.arrays import FloatArray

Measured = Literal["time", "speed", "acceleration", "drive_torque"]
"""A signal of the drive."""


@dataclass(frozen=True)
class Signal:
    """The extent of a signal, by which a wrong unit is seen.

    Attributes:
        signal: what it is.
        column: the recorded column; ``None`` for what was derived from others.
        unit: unit of the values; of a column, as the scene gives it.
        first: the value of the first sample that is not missing.
        last: that of the last one.
        min: the least.
        max: the largest.
        reach: samples on each side of the filter that derived it; 0 for a column.
        sampling: rate and gaps of the whole recording so far; of times only.
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
