"""The extremes of a study's figures and where they lie."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from cardan.app.answers.rounding import CANCELLED, ROUNDING
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.study import Column
from cardan.arrays import FloatArray

# Closed forms and statistics by which the driveline with the least figure is the best one. Mean
# values and ends with a sign say nothing, and whole angles and speed ratios lie about their mean.
_BEST_CLOSED_FORMS = (
    *("equivalent_bend", "k", "non_uniformity", "max_angle_error"),
    *("max_speed_ratio", "max_acceleration_ratio"),
)
_BEST_STATISTICS = ("peak", "rms")
_ABOUT_THEIR_MEAN = ("angle", "speed_ratio")


class StudyTable(Protocol):
    """A study that was evaluated: in memory, or in the files of a cluster."""

    @property
    def axes(self) -> tuple[Axis, ...]:
        """What is varied."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """What the figures are."""

    def figure(self, column: Column, *, radians: bool) -> tuple[str, FloatArray]:
        """Return the ending of a column's unit and its values over the grid."""


@dataclass(frozen=True)
class End:
    """The least or the largest value of a figure.

    Attributes:
        value: the value; NaN where the figure has no numbers.
        at: the values of the keys on which it depends there, by key.
        state: over states, the name of the one in which it is so.
    """

    value: float
    at: Mapping[str, float]
    state: str = ""


@dataclass(frozen=True)
class Extremes:
    """The extremes of one figure of a study.

    Attributes:
        column: what the figure is.
        ending: ending of its unit, ``_deg``.
        least: its least value.
        largest: its largest value.
    """

    column: Column
    ending: str
    least: End
    largest: End

    @property
    def name(self) -> str:
        """The heading of its column in a file."""
        return f"{self.column.name}{self.ending}"

    @property
    def less_is_better(self) -> bool:
        """Whether the driveline with the least value is the best one by this figure."""
        quantity, statistic = self.column.quantity, self.column.statistic
        if statistic == "value":
            return quantity in _BEST_CLOSED_FORMS
        return statistic in _BEST_STATISTICS and quantity not in _ABOUT_THEIR_MEAN


def extremes(table: StudyTable, *, radians: bool = False) -> Iterator[Extremes]:
    """Yield the extremes of every figure of a study.

    Of values that differ by rounding only, the first counts. A point that is not a number is none.
    """
    for column in table.columns:
        ending, values = table.figure(column, radians=radians)
        # A bend goes with the root of what joints leave of each other.
        share = math.sqrt(CANCELLED) if column.quantity == "equivalent_bend" else ROUNDING
        size = np.max(np.abs(values), where=np.isfinite(values), initial=0.0)
        least, largest = (_end(table.axes, values, sign, share * size) for sign in (1.0, -1.0))
        yield Extremes(column, ending, least, largest)


def _end(axes: tuple[Axis, ...], values: FloatArray, sign: float, rounding: float) -> End:
    """The least value, or with a sign of -1 the largest."""
    if np.isnan(values).all():
        return End(math.nan, {})
    signed = sign * values
    first = int(np.argmax(signed <= np.nanmin(signed) + rounding))
    place: tuple[Any, ...] = np.unravel_index(first, values.shape)
    at = {}
    for number, axis in enumerate(axes):
        along = values[(*place[:number], slice(None), *place[number + 1 :])]
        # A key on which it does not depend is no part of the place.
        if not float(np.nanmax(along)) - float(np.nanmin(along)) <= rounding:
            at[axis.key] = float(axis.values[place[number]])
    return End(float(values[place]), at)


def study_data(table: StudyTable, samples: int, *, radians: bool = False) -> dict[str, Any]:
    """Return the extent of a study and the extremes of its figures, as plain data for JSON.

    Args:
        table: the study.
        samples: over how many drive angles its reductions are.
        radians: whether angles are in radians.
    """
    axes = [
        {
            "key": axis.key,
            "values": len(axis.values),
            "min": float(np.min(axis.values)),
            "max": float(np.max(axis.values)),
        }
        for axis in table.axes
    ]
    return {
        "drivelines": math.prod(len(axis.values) for axis in table.axes),
        "samples": samples,
        "axes": axes,
        "figures": [_figure(each) for each in extremes(table, radians=radians)],
    }


def _figure(found: Extremes) -> dict[str, Any]:
    column = found.column
    entry: dict[str, Any] = {
        "column": found.name,
        "quantity": column.quantity,
        column.per: column.item,
        "statistic": column.statistic,
        "of": "turn" if column.statistic == "value" else "samples",
    }
    if column.component:
        entry["component"] = column.component
    for name, end in (("least", found.least), ("largest", found.largest)):
        at = [{"key": key, "value": value} for key, value in end.at.items()]
        entry[name] = {f"value{found.ending}": finite_or_none(end.value), "at": at}
    return entry


def finite_or_none(value: float) -> float | None:
    """Return a number for JSON, which knows none that is not finite."""
    return float(value) if math.isfinite(value) else None
