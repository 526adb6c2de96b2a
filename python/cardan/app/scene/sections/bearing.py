"""The bearings of a scene, and the lengths of shafts that no points give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from cardan.app.scene.sections.bearing_section import LENGTHS
from cardan.app.scene.study.axes import Axis
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline

_UNITS = {"mm": 1e-3, "m": 1.0}


@dataclass(frozen=True)
class Bearing:
    """A bearing as the file gives it.

    Attributes:
        shaft: its shaft.
        key: the key of its position.
        value: the position in the unit of the key; in a study an array.
    """

    shaft: int
    key: str
    value: float | FloatArray

    @property
    def unit(self) -> str:
        """The unit of the position: ``"mm"`` or ``"m"``."""
        return self.key.rpartition("_")[2]

    @property
    def position(self) -> float | FloatArray:
        """The position in m."""
        return self.value * _UNITS[self.unit]


@dataclass(frozen=True)
class Mounting:
    """The bearings of a scene.

    Attributes:
        bearings: each of them.
        lengths: length of each shaft in m, ``(n + 1,)``, in a study with dimensions before that;
            ``None`` for those of the points.
    """

    bearings: tuple[Bearing, ...] = ()
    lengths: tuple[float, ...] | FloatArray | None = None

    def varied(self, axis: Axis, column: FloatArray) -> Self:
        """Return the mounting with the values of an axis of a study, ``(rows,)``."""
        assert axis.place is not None
        if axis.section == "bearing":
            number = axis.place.start
            moved = replace(self.bearings[number], value=column[:, np.newaxis])
            return replace(
                self, bearings=(*self.bearings[:number], moved, *self.bearings[number + 1 :])
            )
        own = np.asarray(self.lengths, np.float64)
        lengths = np.array(np.broadcast_to(own, (len(column), 1, own.shape[-1])))
        lengths[..., axis.place] = _UNITS[axis.name.rpartition("_")[2]] * column[:, None, None]
        return replace(self, lengths=lengths)

    def and_bearing(self, values: Mapping[str, Any], line: Driveline) -> Self:
        """Return the mounting with one more bearing.

        Args:
            values: values by key of its section.
            line: the driveline.

        Raises:
            ValueError: a shaft that does not exist or whose length is not known, a position where
                no bearing can be.
        """
        shaft = values["shaft"]
        if shaft > line.n_joints:
            raise ArgumentValueError(
                "shaft", f"is {shaft}; there are {line.n_joints + 1}, counted from 0"
            )
        if self.lengths is None and not has_lengths(line):
            raise ArgumentValueError("shaft", f"has no length; a bearing needs {LENGTHS_NEEDED}")
        key = next(key for key in values if key.startswith("position"))
        found = replace(self, bearings=(*self.bearings, Bearing(shaft, key, values[key])))
        found.on(line)
        return found

    def on(self, line: Driveline) -> Driveline:
        """Return drivelines with these lengths and bearings.

        Raises:
            ValueError: a position that is not between the ends of its shaft or is at a joint, two
                bearings in one place; the key of the first such position and its value in the
                unit of the key.
        """
        if not self.bearings and self.lengths is None:
            return line
        pairs = [(bearing.shaft, bearing.position) for bearing in self.bearings]
        try:
            return line.with_bearings(pairs, self.lengths)
        except ArgumentValueError as error:
            if error.argument == "lengths":
                raise
            number, *place = map(int, error.place)
            bearing = self.bearings[number]
            # Of a study, the first driveline that is wrong; it is asked for one by one.
            values = np.asarray(bearing.value)
            own_value = values[tuple(place[1:])] if values.ndim and place else values.flat[0]
            at = f"is {own_value:.10g} {bearing.unit} on shaft {bearing.shaft}"
            if not place:
                other = next(
                    i
                    for i, (shaft, position) in enumerate(pairs[:number])
                    if shaft == pairs[number][0] and np.any(position == pairs[number][1])
                )
                problem = f"{at}, the place of bearing {other}"
            else:
                lengths = line.lengths().each if self.lengths is None else np.array(self.lengths)
                # Behind the numbers of the bearing and of its position is that of the driveline.
                shape = np.broadcast_shapes(line.shape, lengths.shape[:-1], values.shape)
                length = np.broadcast_to(lengths, (*shape, lengths.shape[-1]))
                own = float(length[(*place[1:], bearing.shaft)]) / _UNITS[bearing.unit]
                inner = 0 < bearing.shaft < line.n_joints
                ends = "the joints" if inner else "the end and the joint"
                problem = (
                    f"{at} of length {own:.10g} {bearing.unit}; a bearing must lie between {ends} "
                    "of its shaft"
                )
            raise ArgumentValueError(bearing.key, problem) from None


def lengths_of(driveline: Mapping[str, Any], line: Driveline) -> tuple[float, ...] | None:
    """Return the lengths in m that the keys of a driveline give its shafts, if they do.

    Raises:
        ValueError: not one per shaft, or a driveline whose points give lengths.
    """
    key = next((key for key in LENGTHS if key in driveline), None)
    if key is None:
        return None
    if has_lengths(line):
        points = next(name for name in driveline if name.startswith("points"))
        raise ArgumentValueError(key, f"does not go with {points}, which says it already")
    values, wanted = driveline[key], line.n_joints + 1
    if len(values) != wanted:
        raise ArgumentValueError(key, f"has length {len(values)}; it needs {wanted}, one per shaft")
    unit = _UNITS[key.rpartition("_")[2]]
    return tuple(value * unit for value in values)


def has_lengths(line: Driveline) -> bool:
    """Whether the lengths of the shafts are known."""
    return bool(line._geometry.lengths.shape[-1])


LENGTHS_NEEDED = "points_mm or points_m, or lengths_mm or lengths_m, in [driveline]"
"""What gives a driveline its lengths."""
