"""The figures of a study: their extremes and where they lie."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from cardan.app.answers.over import at_keys
from cardan.app.answers.printed import aligned, kind_of, place_text, range_ends
from cardan.app.answers.rounding import CANCELLED, ROUNDING, alike
from cardan.app.answers.rows import (
    as_shown,
    count,
    figure,
    item,
    optional,
    parts,
    place,
    taken,
    word,
)
from cardan.app.answers.turn.figures import DriveAngles
from cardan.app.answers.turn.text import angles_text
from cardan.app.scene.language.units import in_shown, shown_unit
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.cluster import StudyFolder
from cardan.app.scene.study.study import Column, StudyResult
from cardan.arrays import FloatArray
from cardan.design.wrapping import fill, wrap

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
        yield taken(
            *(Extremes, column),
            source=column,
            column=f"{column.name}{ending and '_'}{shown_unit(ending[1:])}",
            of="turn" if column.statistic == "value" else "samples",
            least=least,
            largest=largest,
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


_WHOLE: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}


def study_text(found: StudyFigures, angles: DriveAngles, *, radians: bool = False) -> str:
    """Return the extent of a study, its extremes and its best drivelines, as plain text.

    The drive angles are those over which it reduces.
    """
    figures = found.figures
    parts = [_extent(found), _figures(figures), _best(figures) if found.axes else ""]
    statistics = dict.fromkeys(each.statistic for each in figures if each.statistic != "value")
    if statistics:
        text = f"Figures that end in {' or '.join(statistics)} are of samples"
        if angles.angle_of == "driven":
            # Their drive angles are others for each driveline.
            text += " at the driven angles of the scene."
        else:
            text += f", drive angles {angles_text(angles, radians=radians)}."
        parts.append(fill(text, 79))
    return "\n\n".join(part for part in parts if part)


def _extent(found: StudyFigures) -> str:
    if not found.axes:
        return ""
    steps = [str(axis.values) for axis in found.axes]
    text = f"Study of {found.drivelines} driveline{'s' if found.drivelines > 1 else ''}"
    text += f", {' x '.join(steps)}" if len(steps) > 1 else ""
    varied = [(axis.key, f"{axis.min:.6g} to {axis.max:.6g}") for axis in found.axes]
    return f"{text}\n{aligned(varied, indent='  ')}"


def _figures(found: Sequence[Extremes]) -> str:
    width = max((len(each.column) for each in found), default=0) + 2
    return "\n".join(line for each in found for line in _figure(each, width))


def _figure(found: Extremes, width: int) -> Iterator[str]:
    if not found.is_finite or not found.varies:
        value = found.texts[0] if found.is_finite else "not finite"
        yield aligned([(found.column, value)], width)
        return
    yield found.column
    ends = (found.least, found.largest)
    texts = [
        f"{figure} at {place_text(end.at)}" for figure, end in zip(found.texts, ends, strict=True)
    ]
    yield aligned(zip(("least", "largest"), texts, strict=True), 11, "  ")


def _best(found: Sequence[Extremes]) -> str:
    """The drivelines with the least of the figures of which less is better."""
    places: dict[str, list[str]] = {}
    for each in found:
        if each.less_is_better and math.isfinite(each.least.value) and each.least.at:
            places.setdefault(place_text(each.least.at), []).append(each.column)
    lines = []
    for at, names in places.items():
        lines += wrap(f"by {', '.join(names)}:", 77, **_WHOLE)
        lines += wrap(at, 75, **_WHOLE, initial_indent="  ", subsequent_indent="  ")
    heading = f"Best driveline{'s' if len(places) > 1 else ''}"
    return "\n".join([heading, *(f"  {line}" for line in lines)]) if lines else ""
