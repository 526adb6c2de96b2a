"""The summary of a study as printed text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cardan.app.answers.printed import aligned, figure_text, range_ends
from cardan.app.answers.rounding import alike
from cardan.app.answers.study.extremes import End, Extremes, StudyTable, extremes
from cardan.app.answers.turn.text import angles_text
from cardan.design.wrapping import fill, wrap


def study_text(table: StudyTable, drive_angles: Mapping[str, Any], *, radians: bool = False) -> str:
    """Return the extent of a study, its extremes and its best drivelines, as plain text.

    Args:
        table: the study.
        drive_angles: over what it reduces, as ``figures.summary.drive_angles`` returns it.
        radians: whether angles are in radians.
    """
    found = list(extremes(table, radians=radians))
    parts = [_extent(table), _figures(found), _best(found) if table.axes else ""]
    statistics = {each.column.statistic: None for each in found if each.column.statistic != "value"}
    if statistics:
        text = f"Figures that end in {' or '.join(statistics)} are of samples"
        if drive_angles.get("angle_of") == "driven":
            # Their drive angles are others for each driveline.
            text += " at the driven angles of the scene."
        else:
            text += f", drive angles {angles_text(drive_angles, radians=radians)}."
        parts.append(fill(text, 79))
    return "\n\n".join(part for part in parts if part)


def _extent(table: StudyTable) -> str:
    if not table.axes:
        return ""
    steps = [len(axis.values) for axis in table.axes]
    count = math.prod(steps)
    text = f"Study of {count} driveline{'s' if count > 1 else ''}"
    text += f", {' x '.join(map(str, steps))}" if len(steps) > 1 else ""
    varied = [
        (axis.key, f"{np.min(axis.values):.6g} to {np.max(axis.values):.6g}") for axis in table.axes
    ]
    return f"{text}\n{aligned(varied, indent='  ')}"


def _figures(found: Sequence[Extremes]) -> str:
    width = max((len(each.name) for each in found), default=0) + 2
    return "\n".join(line for each in found for line in _figure(each, width))


def _figure(found: Extremes, width: int) -> Iterator[str]:
    low, high = found.least.value, found.largest.value
    if not (math.isfinite(low) and math.isfinite(high)):
        yield aligned([(found.name, "not finite")], width)
    elif alike(low, high) or not found.least.at:
        yield aligned([(found.name, figure_text(low))], width)
    else:
        yield found.name
        ends = zip(range_ends(low, high), (found.least, found.largest), strict=True)
        texts = [f"{figure} at {place_text(end)}" for figure, end in ends]
        yield aligned(zip(("least", "largest"), texts, strict=True), 11, "  ")


def place_text(end: End) -> str:
    """Say where in a study a value is: ``bends_deg.0 = 14, phases_deg = 0``."""
    return ", ".join(f"{key} = {value:.6g}" for key, value in end.at.items())


def _best(found: Sequence[Extremes]) -> str:
    """The drivelines with the least of the figures of which less is better."""
    places: dict[str, list[str]] = {}
    for each in found:
        if each.less_is_better and math.isfinite(each.least.value) and each.least.at:
            places.setdefault(place_text(each.least), []).append(each.name)
    lines = []
    for place, names in places.items():
        lines += wrap(f"by {', '.join(names)}:", 77, **_WRAPPED)
        lines += wrap(place, 75, **_WRAPPED, initial_indent="  ", subsequent_indent="  ")
    heading = f"Best driveline{'s' if len(places) > 1 else ''}"
    return "\n".join([heading, *(f"  {line}" for line in lines)]) if lines else ""


_WRAPPED: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False}
