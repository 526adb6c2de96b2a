"""The summary of a study as printed text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from cardan.app.answers.printed import aligned, place_text
from cardan.app.answers.study.figures import Extremes, StudyFigures
from cardan.app.answers.turn.figures import DriveAngles
from cardan.app.answers.turn.text import angles_text
from cardan.design.wrapping import fill, wrap

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
    for place, names in places.items():
        lines += wrap(f"by {', '.join(names)}:", 77, **_WHOLE)
        lines += wrap(place, 75, **_WHOLE, initial_indent="  ", subsequent_indent="  ")
    heading = f"Best driveline{'s' if len(places) > 1 else ''}"
    return "\n".join([heading, *(f"  {line}" for line in lines)]) if lines else ""
