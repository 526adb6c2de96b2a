"""The figures of a study: their extremes and where they lie."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from cardan.app.answers.over import at_keys
from cardan.app.answers.printed import kind_of, range_ends
from cardan.app.answers.rounding import CANCELLED, ROUNDING, alike
from cardan.app.answers.rows import as_shown, count, figure, item, optional, parts, place, word
from cardan.app.scene.language.units import in_shown, shown_unit
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.cluster import StudyFolder
from cardan.app.scene.study.study import Column, StudyResult
from cardan.arrays import FloatArray

# Closed forms and statistics by which the driveline with the least figure is the best one. Mean
# values and ends with a sign say nothing, and whole angles and speed ratios lie about their mean.
_BEST_CLOSED_FORMS = (
    *("equivalent_bend", "k", "non_uniformity", "max_angle_error"),
    *("max_speed_ratio", "max_acceleration_ratio"),
)
_BEST_STATISTICS = ("peak", "rms")
_ABOUT_THEIR_MEAN = ("angle", "speed_ratio")

StudyTable: TypeAlias = StudyResult | StudyFolder
"""A study that was evaluated: in memory, or in the files of a cluster."""


@dataclass(frozen=True)
class End:
    """The least or the largest value of a figure; NaN where the figure has no numbers."""

    unit: str
    value: float = as_shown(figure("value", "each", "null if it is not finite"))
    at: Mapping[str, float] = place("at", "the keys on which the figure depends there")


@dataclass(frozen=True)
class Extremes:
    """The extremes of one figure of a study, in its SI unit; its column is in that shown."""

    source: Column
    per: Literal["shaft", "joint", "bearing"]
    column: str = word("column", "its heading in the table")
    quantity: str = word("quantity", "an output or a closed form")
    item: int = item("own")
    statistic: str = word("statistic", "how the output is reduced; value for a closed form")
    of: Literal["turn", "samples"] = word("of", "over what the statistic is")
    component: str = optional(word("component", "of a vector: x, y or z"))
    least: End = parts("least")
    largest: End = parts("largest")

    @property
    def texts(self) -> tuple[str, str]:
        """Both ends as they are shown, without their unit, with as many decimals."""
        unit = self.least.unit
        least, largest = (in_shown(end.value, unit) for end in (self.least, self.largest))
        return range_ends(least, largest, kind_of(self.quantity, shown_unit(unit)))

    @property
    def is_finite(self) -> bool:
        """Whether all values are numbers."""
        return math.isfinite(self.least.value) and math.isfinite(self.largest.value)

    @property
    def varies(self) -> bool:
        """Whether it depends on what the study varies."""
        return bool(self.least.at) and not alike(self.least.value, self.largest.value)

    @property
    def less_is_better(self) -> bool:
        """Whether the driveline with the least value is the best one by this figure."""
        if self.statistic == "value":
            return self.quantity in _BEST_CLOSED_FORMS
        return self.statistic in _BEST_STATISTICS and self.quantity not in _ABOUT_THEIR_MEAN


@dataclass(frozen=True)
class Varied:
    """A key that a study varies."""

    key: str = word("key")
    values: int = count("values")
    min: float = figure("least")
    max: float = figure("largest")


@dataclass(frozen=True)
class StudyFigures:
    """The extent of a study and the extremes of its figures."""

    drivelines: int = count("drivelines")
    samples: int = count("samples", "drive angles over which figures are reduced")
    axes: tuple[Varied, ...] = parts("varied keys")
    figures: tuple[Extremes, ...] = parts("figures")


def study_figures(table: StudyTable, samples: int, *, radians: bool = False) -> StudyFigures:
    """Return the figures of a study whose reductions are over so many samples."""
    return StudyFigures(
        math.prod(len(axis.values) for axis in table.axes),
        samples,
        tuple(
            Varied(
                axis.key, len(axis.values), float(np.min(axis.values)), float(np.max(axis.values))
            )
            for axis in table.axes
        ),
        tuple(extremes(table, radians=radians)),
    )


def extremes(table: StudyTable, *, radians: bool = False) -> Iterator[Extremes]:
    """Yield the extremes of every figure of a study.

    Of values that differ by rounding only, the first counts. A point that is not a number is none.
    """
    for column in table.columns:
        ending, values = table.figure(column, radians=radians)
        # A bend goes with the root of what joints leave of each other.
        share = math.sqrt(CANCELLED) if column.quantity == "equivalent_bend" else ROUNDING
        size = np.max(np.abs(values), where=np.isfinite(values), initial=0.0)
        least, largest = (
            _end(table.axes, values, sign, share * size, ending[1:]) for sign in (1.0, -1.0)
        )
        yield Extremes(
            column,
            column.per,
            f"{column.name}{ending and '_'}{shown_unit(ending[1:])}",
            column.quantity,
            column.item,
            column.statistic,
            "turn" if column.statistic == "value" else "samples",
            column.component,
            least,
            largest,
        )


def _end(
    axes: tuple[Axis, ...], values: FloatArray, sign: float, rounding: float, unit: str
) -> End:
    """The least value, or with a sign of -1 the largest."""
    if np.isnan(values).all():
        return End(unit, math.nan, {})
    signed = sign * values
    first = int(np.argmax(signed <= np.nanmin(signed) + rounding))
    return End(unit, float(values.flat[first]), at_keys(axes, values, first, rounding))
