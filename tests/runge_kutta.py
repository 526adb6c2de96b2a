"""Integration of equations of motion over half a turn of the drive, by fixed steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Slopes = Callable[[float, NDArray[Any]], NDArray[Any]]


def half_turn(
    slopes: Slopes, start: NDArray[Any], steps: int
) -> Iterator[tuple[float, NDArray[Any]]]:
    """Yield drive angle and state after each step of the classical method of fourth order."""
    state, step = start, np.pi / steps
    for i in range(steps):
        angle = i * step
        first = slopes(angle, state)
        second = slopes(angle + step / 2, state + step / 2 * first)
        third = slopes(angle + step / 2, state + step / 2 * second)
        fourth = slopes(angle + step, state + step * third)
        state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
        yield angle + step, state
