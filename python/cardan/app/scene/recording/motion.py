"""The motion of a measured drive: angles from its speed, speed and acceleration from a filter.

The filter is a parabola, fitted by least squares to the samples around each one: Savitzky and
Golay, Analytical Chemistry 36 (1964) 1627, with unequal steps and missing samples allowed.
"""

from __future__ import annotations

from cardan._core import Integral, derivatives_at
from cardan.arrays import FloatArray

__all__ = ["Integral", "derivatives"]


def derivatives(
    time: FloatArray, values: FloatArray, reach: int, rows: slice | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return first and second derivative of a signal over time, from a parabola at each sample.

    The parabola of a sample fits the known ones of the ``2 reach + 1`` rows around it, and fewer at
    the ends of the signal. For equal steps ``d``, a part ``sin(w t)`` of the signal keeps in its
    first derivative the share ``1 - (3 reach**2 + 3 reach - 1) (w d)**2/30``, for small ``w d``.

    Args:
        time: times, ``(rows,)``; they increase; NaN where missing.
        values: the signal, ``(rows,)``; NaN where missing.
        reach: rows on each side, at least 1.
        rows: the rows whose derivatives are wanted; by default all.

    Returns:
        two arrays, a number per row wanted: NaN where the sample is missing, and where less than
        three are known around it.
    """
    begin, end, _ = (rows or slice(None)).indices(time.size)
    return derivatives_at(time, values, reach, begin, end)
