"""The forces of a scene's joints and bearings, in words."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator

from cardan.figures.scene_forces import Force, SceneForces
from cardan.words.summary import angle_text, figure_text

_HEADINGS = ("largest", "at", "mean", "order 2", "order 4")


def forces_text(found: SceneForces, *, radians: bool = False) -> str:
    """Return the forces as a table of plain text, and the reason for those that are missing."""
    lines = []
    if found.forces:
        heading = "Forces over a turn [N]"
        rows = [(_label(force), *_figures(force, radians)) for force in found.forces]
        columns = list(zip((heading, *_HEADINGS), *rows, strict=True))
        widths = [max(map(len, column)) for column in columns]
        for label, *figures in ((heading, *_HEADINGS), *rows):
            right = (figure.rjust(width) for figure, width in zip(figures, widths[1:], strict=True))
            lines.append("  ".join((label.ljust(widths[0]), *right)).rstrip())
    if found.forces and found.refused:
        lines.append("")
    for name, reason in found.refused.items():
        words = f"{name.replace('_', ' ').capitalize()} is not determinate: {reason}."
        lines += textwrap.wrap(words, 79)
    return "\n".join(lines)


def _label(force: Force) -> str:
    row = force.figures
    label = f"  {row.per} {row.item}"
    return label if force.shaft is None else f"{label}, shaft {force.shaft}"


def _figures(force: Force, radians: bool) -> Iterator[str]:
    row, at = force.figures, force.at_deg
    yield figure_text(row.largest)
    yield "-" if at is None else angle_text(math.radians(at) if radians else at, radians)
    yield from map(figure_text, (row.mean, row.order_2, row.order_4))
