"""The section [angles] of a scene: columns of a file as drive angles, at once or in pieces."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import EllipsisType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cardan._core import Integral, derivatives_at
from cardan.app.files.delimited import short
from cardan.app.files.recording import Chunk, place_of, read_ahead, read_chunks
from cardan.app.scene.language.units import ENDINGS, RPM, size_of, split, us_keys
from cardan.app.scene.recording.signals import Noise, Signal, Timing
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.sweep import Sweep

# The keys for recorded bends, drive angles and speeds; a scene uses at most one of each.
BEND_COLUMNS = ("bend_columns_deg", "bend_columns_rad")
ANGLE_COLUMNS = ("angle_column_deg", "angle_column_rad")
SPEED_COLUMNS = ("speed_column_rpm", "speed_column_rad_s")
_TORQUE = "torque_column_Nm"

REACH = 5
"""Samples on each side of the parabola that differentiates, if the scene gives no number."""

# Beyond any machine, and small enough for what the filter makes of times and speeds.
_LARGEST = 1e30

# The signal that angles follow from or that speeds follow from, continued over the turns.
_SIGNAL = "signal"

_Rows = dict[str, FloatArray]

MOST_STEPS = 10_000_000
"""Steps that a sweep takes at most."""


@dataclass(frozen=True, eq=False)
class Angles:
    """Drive angles, and what was recorded with them.

    A sample of which a recorded number is missing has a drive angle of NaN, and so have its time
    and its load. Figures are taken over what is to reduce: known samples, and whole turns.

    Attributes:
        degrees: the angles in degrees, for tables and pictures.
        drive: the same for evaluating: a sweep, or recorded angles in rad.
        bends: recorded bends in degrees.
        time: recorded times in s.
        load: recorded values of the keys of [load], ``(samples,)`` each.
        driven: angles of the last shaft in degrees, if the file gives those.
        known: which samples are to reduce, of bends and loads.
    """

    degrees: FloatArray
    drive: FloatArray | Sweep
    to_reduce: FloatArray | Sweep
    bends: FloatArray | None = None
    time: FloatArray | None = None
    load: Mapping[str, FloatArray] = field(default_factory=dict)
    signals: tuple[Signal, ...] = ()
    driven: FloatArray | None = None
    file: Path | None = None
    known: NDArray[np.bool_] | EllipsisType = ...

    @classmethod
    def uniform(cls, turns: float, per_turn: int, start_deg: float) -> Self:
        """Take equal steps over some turns, both ends included."""
        steps = max(1, round(turns * per_turn))
        # Dividing last keeps round degrees round.
        degrees: FloatArray = start_deg + 360.0 * turns * np.arange(steps + 1) / steps
        # Whole turns of samples at exact parts of a turn repeat and are computed once.
        exact = start_deg == 0.0 and per_turn <= MOST_STEPS and steps / per_turn == turns

        def sweep(count: int) -> Sweep:
            if exact:
                return Sweep.revolutions(count / per_turn, per_turn)
            return Sweep(math.radians(degrees[0]), math.radians(degrees[count - 1]), count)

        # The last angle of whole turns is the first one again: in a mean it would count twice.
        whole = float(turns).is_integer()
        return cls(degrees, sweep(steps + 1), sweep(steps if whole else steps + 1))


class Recording:
    """The recorded columns of a scene, with what is carried from one piece of them to the next.

    The columns are known by the keys of the section, those of bends by their number.
    """

    def __init__(self, values: Mapping[str, Any], folder: Path) -> None:
        self._file = folder / values["file"]
        self._raster = values.get("raster_s")
        self._columns: dict[str, str] = {}
        for group in (ANGLE_COLUMNS, ("time_column_s",), SPEED_COLUMNS):
            self._columns |= {key: values[key] for key in group if key in values}
        torque = next((key for key in (_TORQUE, *us_keys(_TORQUE)) if key in values), "")
        self._columns |= {_TORQUE: values[torque]} if torque else {}
        self._torque_size = size_of(torque)
        bends = next((key for key in BEND_COLUMNS if key in values), "")
        self._bend_unit = split(bends)[1]
        self._bends = {f"bend {i}": name for i, name in enumerate(values.get(bends, ()))}
        self._names = [*self._columns.values(), *self._bends.values()]
        self._speed = next((key for key in SPEED_COLUMNS if key in values), "")
        self._angle = next((key for key in ANGLE_COLUMNS if key in values), "")
        self._timed = "time_column_s" in values
        self._reach = values.get("filter_reach", REACH)
        self._integral = Integral(math.radians(values.get("start_deg", 0.0)))
        self._last_time = -math.inf
        self._timing = Timing()
        self._noise = Noise(1 if self._speed else 2, self._reach)
        self._last_angle, self._turns = math.nan, 0.0
        self._found = self._found_numbers = False

    def whole(self) -> Angles:
        """Read all samples."""
        pieces = list(self.pieces(None))
        assert len(pieces) == 1
        return pieces[0][0]

    def pieces(self, rows: int | None) -> Generator[tuple[Angles, int]]:
        """Yield the samples in pieces of so many, each with the number of all samples.

        The samples do not depend on the pieces, to the last bit.
        """
        reach = self._reach if self._timed else 0
        held: _Rows = {}
        # Rows that have been delivered, at the beginning of those held.
        before = first = 0
        with closing(self._chunks(rows)) as chunks:
            for chunk in chunks:
                arrived = self._arrived(chunk)
                held = {key: np.concatenate([held[key], arrived[key]]) for key in held} or arrived
                count = len(next(iter(held.values())))
                whole = rows is None or chunk.first + len(chunk.columns[0]) == chunk.total
                # The filter needs the rows after a sample as well.
                end = count if whole else count - reach
                if end <= before:
                    continue
                for begin in range(before, end, rows or count):
                    part = slice(begin, min(end, begin + (rows or count)))
                    yield self._angles(held, part, first + begin - before), chunk.total
                first += end - before
                kept = max(0, end - reach)
                held = {key: column[kept:] for key, column in held.items()}
                before = end - kept
        if not self._found:
            names = ", ".join(map(repr, self._names))
            if self._found_numbers:
                raise ValueError(
                    f"{self._file}: no row has two others within filter_reach = {self._reach} rows "
                    f"that have numbers in the columns {names}; the acceleration needs them"
                )
            raise ValueError(f"{self._file}: no row has a number in each of the columns {names}")

    def _chunks(self, rows: int | None) -> Generator[Chunk]:
        try:
            chunks = read_chunks(self._file, self._names, rows, self._raster)
            yield from chunks if rows is None else read_ahead(chunks)
        except OSError as error:
            reason = error.strerror or str(error)
            problem = f"is {short(repr(str(self._file)))}; it cannot be read: {reason}"
            raise ArgumentValueError("file", problem) from None

    def _arrived(self, chunk: Chunk) -> _Rows:
        """The columns of a chunk, and what follows from all rows before it."""
        rows = dict(zip((*self._columns, *self._bends), chunk.columns, strict=True))
        self._check(rows, chunk.first)
        if self._torque_size != 1.0:
            rows[_TORQUE] = self._torque_size * rows[_TORQUE]
        if not self._timed:
            return rows
        time = rows["time_column_s"]
        if self._speed:
            speed = rows[self._speed]
            rows[_SIGNAL] = speed * RPM if self._speed.endswith("rpm") else speed
        else:
            angle = rows[self._angle]
            rows[_SIGNAL] = self._continued(
                np.radians(angle) if self._angle.endswith("deg") else angle
            )
        self._noise.add(time, rows[_SIGNAL])
        if not self._angle:
            rows[ANGLE_COLUMNS[1]] = self._integral.at(time, rows[_SIGNAL])
        return rows

    def _continued(self, angle: FloatArray) -> FloatArray:
        """Angles in rad that a logger wrote within one turn, with the turns before added."""
        known = ~np.isnan(angle)
        steps = np.diff(angle[known], prepend=self._last_angle)
        turns = np.zeros(angle.size)
        if steps.size:
            # The first sample of all follows none.
            steps = np.where(np.isnan(steps), 0.0, steps)
            turns[known] = self._turns - np.cumsum(np.rint(steps / math.tau))
            self._turns = float(turns[known][-1])
            self._last_angle = float(angle[known][-1])
        return np.asarray(angle + math.tau * turns, np.float64)

    def _check(self, rows: _Rows, first: int) -> None:
        end, unit = (math.pi / 2, "pi/2) rad") if self._bend_unit == "rad" else (90.0, "90) deg")
        size, bend = f"it must lie within ±{_LARGEST:g}", f"a bend must lie in [0, {unit}"
        ranges = {key: (name, -_LARGEST, _LARGEST, size) for key, name in self._columns.items()}
        below = math.nextafter(end, 0.0)
        ranges |= {key: (name, 0.0, below, bend) for key, name in self._bends.items()}
        for key, (name, low, high, rule) in ranges.items():
            least, most = _extent(rows[key])
            if least < low or most > high:
                row = int(np.argmax((rows[key] < low) | (rows[key] > high)))
                raise self._error(first + row, name, f"is {rows[key][row]}; {rule}")
        if self._timed:
            time = rows["time_column_s"]
            # No comparison with NaN is true.
            if time[0] > self._last_time and (time[1:] > time[:-1]).all():
                self._last_time = float(time[-1])
                return
            known = np.flatnonzero(~np.isnan(time))
            behind = np.flatnonzero(np.diff(time[known], prepend=self._last_time) <= 0.0)
            if behind.size:
                place = int(behind[0])
                earlier = time[known[place - 1]] if place else self._last_time
                value = f"is {time[known[place]]} after {earlier}; times must increase"
                name = self._columns["time_column_s"]
                raise self._error(first + int(known[place]), name, value)
            if known.size:
                self._last_time = float(time[known[-1]])

    def _error(self, row: int, name: str, problem: str) -> ValueError:
        where = place_of(self._file, row)
        return ValueError(f"{self._file}: {where}, column {name!r} {problem}")

    def _angles(self, held: _Rows, rows: slice, first: int) -> Angles:
        """The samples of some of the rows held."""
        part = {key: column[rows] for key, column in held.items()}
        known: NDArray[np.bool_] = np.ones(rows.stop - rows.start, np.bool_)
        for key in (*self._columns, *self._bends):
            _leave_out_missing(known, part[key])
        load: dict[str, FloatArray] = {}
        if self._timed:
            slope, curvature = derivatives(held["time_column_s"], held[_SIGNAL], self._reach, rows)
            speed, acceleration = (part[_SIGNAL], slope) if self._speed else (slope, curvature)
            self._found_numbers |= bool(known.any())
            # Too few samples around one leave its acceleration unknown.
            _leave_out_missing(known, acceleration)
            load = {"speed_rad_s": speed, "acceleration_rad_s2": acceleration}
            # At the ends of the recording, filters have samples on one side only.
            count = held[_SIGNAL].size
            inner = slice(
                max(0, self._reach - rows.start), max(0, count - self._reach - rows.start)
            )
            self._noise.add_derived(speed[inner], acceleration[inner])
        if _TORQUE in part:
            load["drive_torque_Nm"] = part[_TORQUE]
        self._found |= bool(known.any())
        all_known = bool(known.all())

        def with_gaps(values: FloatArray) -> FloatArray:
            return values if all_known else np.where(known, values, np.nan)

        load = {key: with_gaps(values) for key, values in load.items()}
        part |= {key: with_gaps(part[key]) for key in self._columns}
        in_degrees = self._angle.endswith("deg")
        column = with_gaps(part[self._angle or ANGLE_COLUMNS[1]])
        bends = [_filled(part[key], known) for key in self._bends]
        stacked = np.stack(bends, -1) if bends else None
        if stacked is not None and self._bend_unit == "rad":
            stacked = np.degrees(stacked)
        return Angles(
            column if in_degrees else np.degrees(column),
            radians := np.radians(column) if in_degrees else column,
            radians if all_known else radians[known],
            stacked,
            part.get("time_column_s"),
            load,
            tuple(self._signals(part, load)),
            file=self._file,
            known=... if all_known else known,
        )

    def _signals(self, part: _Rows, load: Mapping[str, FloatArray]) -> Iterator[Signal]:
        """The extents of what is recorded besides angles, and of what is derived."""
        reach = self._reach
        found: list[Signal | None] = []
        for key, signal in _MEASURED.items():
            if key in self._columns:
                unit = ENDINGS[split(key)[1]].symbol
                measured = Signal.of(signal, self._columns[key], unit, part[key])
                if signal == "time":
                    self._timing.add(part[key])
                    measured = measured and replace(measured, sampling=self._timing.sampling())
                found.append(measured)
            elif key == SPEED_COLUMNS[0] and self._timed and not self._speed:
                found.append(Signal.of("speed", None, "rpm", load["speed_rad_s"] / RPM, reach))
        if self._timed:
            acceleration = load["acceleration_rad_s2"]
            signal = Signal.of("acceleration", None, "rad/s²", acceleration, reach)
            rate = self._timing.sampling().rate
            if signal and rate:
                signal = replace(signal, scatter=self._noise.scatter(rate))
            found.append(signal)
        yield from filter(None, found)


_MEASURED: Mapping[str, Any] = {
    "time_column_s": "time",
    **dict.fromkeys(SPEED_COLUMNS, "speed"),
    _TORQUE: "drive_torque",
}


def _leave_out_missing(known: NDArray[np.bool_], values: FloatArray) -> None:
    # NaN anywhere is the least: most recordings have none, and one pass says so.
    if np.isnan(np.min(values, initial=np.inf)):
        known &= ~np.isnan(values)


def _extent(values: FloatArray) -> tuple[float, float]:
    """The least and the largest number, or NaN twice."""
    return float(np.fmin.reduce(values)), float(np.fmax.reduce(values))


def _filled(bend: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """Bends of which those at missing samples are replaced by the last known ones.

    A driveline needs all its bends; that the sample is missing shows in its drive angle.
    """
    if not known.any():
        return np.zeros_like(bend)
    places = np.where(known, np.arange(bend.size), int(np.argmax(known)))
    return bend[np.maximum.accumulate(places)]


def derivatives(
    time: FloatArray, values: FloatArray, reach: int, rows: slice | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return first and second derivative of a signal over time, from a parabola at each sample.

    The parabola of a sample fits the known ones of the ``2 reach + 1`` rows around it, and fewer at
    the ends of the signal. For equal steps ``d``, a part ``sin(w t)`` of the signal keeps in its
    first derivative the share ``1 - (3 reach**2 + 3 reach - 1) (w d)**2/30``, for small ``w d``.

    The filter is that of Savitzky and Golay, Analytical Chemistry 36 (1964) 1627, with unequal
    steps and missing samples allowed: the derivatives are NaN where the sample is missing, and
    where less than three are known around it.
    """
    begin, end, _ = (rows or slice(None)).indices(time.size)
    return derivatives_at(time, values, reach, begin, end)
