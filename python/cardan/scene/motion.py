"""The motion of a measured drive: angles from its speed, speed and acceleration from a filter.

The filter is a parabola, fitted by least squares to the samples around each one: Savitzky and
Golay, Analytical Chemistry 36 (1964) 1627, with unequal steps and missing samples allowed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray

# Rows whose sums of a parabola are in the cache together.
_ROWS = 1 << 13

# Steps that are added before their sum joins the integral, so that rounding grows within them only.
_STEPS = 1 << 10


class Integral:
    """The integral of a signal over time by the trapezoidal rule, which is exact for a ramp.

    It takes samples in pieces, and its bits are the same for any pieces: the steps are added in
    runs of a fixed length, and the sum of the runs before carries an error term.
    """

    def __init__(self, start: float) -> None:
        """Begin with the integral at the first sample."""
        self._last: tuple[float, float] | None = None
        self._sum, self._rest = start, 0.0
        self._run = np.empty(_STEPS)
        self._length, self._in_run = 0, 0.0

    def at(self, time: FloatArray, values: FloatArray) -> FloatArray:
        """Return the integral at the samples of the next piece, ``(samples,)``; none is NaN."""
        if not time.size:
            return np.empty(0)
        last_time, last_value = self._last or (time[0], values[0])
        self._last = float(time[-1]), float(values[-1])
        steps = 0.5 * np.diff(time, prepend=last_time)
        steps *= values + np.concatenate([[last_value], values[:-1]])
        integral = np.empty(steps.size)
        done = 0
        while done < steps.size:
            taken = steps[done : done + _STEPS - self._length]
            sums = np.cumsum(np.concatenate([[self._in_run], taken]))[1:]
            integral[done : done + taken.size] = self._sum + (self._rest + sums)
            self._run[self._length : self._length + taken.size] = taken
            done += taken.size
            self._length, self._in_run = self._length + taken.size, float(sums[-1])
            if self._length == _STEPS:
                self._end_run()
        return integral

    def _end_run(self) -> None:
        """Add the sum of a run with its rounding error (Knuth's two-sum)."""
        # By pairs, and thus closer than the last of the sums one by one.
        run = float(np.sum(self._run))
        total = self._sum + run
        part = total - self._sum
        self._rest += (self._sum - (total - part)) + (run - part)
        self._sum = total
        self._length, self._in_run = 0, 0.0


def derivatives(
    time: FloatArray, values: FloatArray, known: NDArray[np.bool_], reach: int
) -> tuple[FloatArray, FloatArray]:
    """Return first and second derivative of a signal over time, from a parabola at each sample.

    The parabola of a sample fits the known ones of the ``2 reach + 1`` rows around it, and fewer at
    the ends of the signal. For equal steps ``d``, a part ``sin(w t)`` of the signal keeps in its
    first derivative the share ``1 - (3 reach**2 + 3 reach - 1) (w d)**2/30``, for small ``w d``.

    Args:
        time: times, ``(rows,)``; they increase.
        values: the signal, ``(rows,)``.
        known: where time and signal are numbers.
        reach: rows on each side, at least 1.

    Returns:
        two arrays ``(rows,)``: NaN where a sample is missing, and where less than three are known
        around it.
    """
    first, second = np.full(time.size, np.nan), np.full(time.size, np.nan)
    for begin in range(0, time.size, _ROWS):
        rows = slice(begin, min(begin + _ROWS, time.size))
        _fit(time, values, known, reach, rows, (first[rows], second[rows]))
    first[~known] = second[~known] = np.nan
    return first, second


def _fit(
    time: FloatArray,
    values: FloatArray,
    known: NDArray[np.bool_],
    reach: int,
    rows: slice,
    into: tuple[FloatArray, FloatArray],
) -> None:
    """Fit ``c0 + c1 u + c2 u**2`` around some rows, with times and values taken from each row."""
    count = rows.stop - rows.start
    # Sums of weight times u**n, and of weight times value times u**n.
    s0, s1, s2, s3, s4, y0, y1, y2 = np.zeros((8, count))
    for offset in range(-reach, reach + 1):
        begin, end = max(rows.start, -offset), min(rows.stop, time.size - offset)
        if begin >= end:
            continue
        here, there = slice(begin, end), slice(begin + offset, end + offset)
        to = slice(begin - rows.start, end - rows.start)
        u, y = time[there] - time[here], values[there] - values[here]
        if known[here].all() and known[there].all():
            s0[to] += 1.0
        else:
            fits = known[here] & known[there]
            s0[to] += fits
            # A product with what is missing would be NaN.
            u[~fits] = 0.0
            y[~fits] = 0.0
        power = u * u
        s1[to] += u
        s2[to] += power
        y0[to] += y
        y1[to] += u * y
        y2[to] += power * y
        power *= u
        s3[to] += power
        power *= u
        s4[to] += power
    minor, middle, last = s1 * s4 - s2 * s3, s0 * s4 - s2 * s2, s1 * s3 - s2 * s2
    mixed, spread = s0 * s3 - s1 * s2, s0 * s2 - s1 * s1
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.where(s0 >= 3.0, s0 * (s2 * s4 - s3 * s3) - s1 * minor + s2 * last, np.nan)
        into[0][:] = scale * (y1 * middle - y0 * minor - y2 * mixed)
        into[1][:] = 2.0 * scale * (y0 * last - y1 * mixed + y2 * spread)
