"""The short tables of a scene and its study as printed text."""

from __future__ import annotations

import math
import sys
import textwrap
from collections.abc import Sequence

import numpy as np

from cardan.figures.extremes import study_data
from cardan.figures.rounding import alike
from cardan.figures.summary import Row
from cardan.scene.study import StudyResult


def summary_text(rows: Sequence[Row], *, radians: bool = False) -> str:
    """Return the table as aligned plain text, at most 79 characters wide."""
    text = _aligned([(row.label, row_text(row, radians)) for row in rows])
    if any(row.at_deg is not None for row in rows):
        text += (
            f'\n\nAfter "at": drive angle; 0 {"rad" if radians else "deg"} has the driving pin in '
            "the plane of shafts 0, 1."
        )
    return text


def study_text(result: StudyResult, *, radians: bool = False) -> str:
    """Return the extent of a study and the extremes of its figures, as plain text."""
    lines = []
    if result.axes:
        steps = " x ".join(map(str, result.shape))
        count = f"{steps} = {result.rows}" if len(result.axes) > 1 else steps
        lines.append(("study", f"{count} driveline{'s' if result.rows > 1 else ''}"))
        for axis in result.axes:
            low, high = np.min(axis.values), np.max(axis.values)
            lines.append((axis.key, f"{low:.6g} to {high:.6g}"))
    placed = False
    for name, found in study_data(result, radians=radians)["figures"].items():
        low, high = found["least"], found["largest"]
        if low is None or high is None or alike(low, high):
            lines.append((name, "not finite" if low is None or high is None else figure_text(low)))
            continue
        placed = True
        ends = zip(range_ends(low, high), ("least", "largest"), strict=True)
        figures = [
            f"{figure} ({', '.join(f'{at:.6g}' for at in found[f'{which}_at'].values())})"
            for figure, which in ends
        ]
        lines.append((name, " to ".join(figures)))
    text = _aligned(lines)
    if placed:
        keys = ", ".join(axis.key for axis in result.axes)
        text += "\n\n" + textwrap.fill(f"In brackets: {keys}.", 79, break_on_hyphens=False)
    return text


def _aligned(lines: Sequence[tuple[str, str]]) -> str:
    width = max(len(label) for label, _ in lines) + 2
    return "\n".join(
        textwrap.fill(
            text,
            width=79,
            initial_indent=f"{label:{width}}",
            subsequent_indent=" " * width,
            break_long_words=False,
            break_on_hyphens=False,
        )
        for label, text in lines
    )


def row_text(row: Row, radians: bool = False) -> str:
    """Return the value of a row with unit and place."""
    values = row.in_unit(radians)
    text = _range(values[0], values[-1]) if row.is_range else ", ".join(map(figure_text, values))
    if row.unit:
        text += " rad" if row.unit == "deg" and radians else f" {row.unit}"
    if row.at_deg is not None:
        at = f"{math.radians(row.at_deg):.4f} rad" if radians else f"{row.at_deg:.2f} deg"
        text += f" at {at}"
    return text


def _range(low: float, high: float) -> str:
    return " to ".join(range_ends(low, high)) if 0.0 < high - low < math.inf else figure_text(low)


def range_ends(low: float, high: float) -> tuple[str, str]:
    """Write both ends of a range with enough decimals for three digits of the difference."""
    decimals = 2 - math.floor(math.log10(min(high - low, sys.float_info.max)))
    if decimals > 9 or high - low >= 1e7:
        return figure_text(low), figure_text(high)
    return f"{low:.{max(0, decimals)}f}", f"{high:.{max(0, decimals)}f}"


def figure_text(value: float) -> str:
    """Four significant digits, without an exponent where that is readable."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 < exponent < 7:
        return f"{value:.3e}"
    return f"{value:.{max(0, 3 - exponent)}f}"
