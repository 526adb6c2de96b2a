"""The forces of a scene's joints and bearings, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.forces.figures import Force, SceneForces
from cardan.app.answers.printed import angle_text, figure_text, table_text
from cardan.design.wrapping import wrap


def headings(found: SceneForces) -> tuple[str, ...]:
    """Return what the figures of a row are."""
    first = ("order 1",) if found.has_order_1 else ()
    return ("largest", "at", "mean", *first, "order 2", "order 4")


def words(found: SceneForces, *, radians: bool = False) -> str:
    """Return the forces as a table of plain text, and the reason for those that are missing."""
    lines = []
    if found.forces:
        over = "states and turn" if found.forces[0].state else "a turn"
        table: list[tuple[str, ...]] = [(f"Forces over {over} [N]", *headings(found))]
        table += [(f"  {label}", *figures) for label, *figures in force_rows(found, radians)]
        lines.append(table_text(table))
    if found.forces and found.refused:
        lines.append("")
    for words in reasons(found):
        lines += wrap(words, 79)
    return "\n".join(lines)


def force_rows(found: SceneForces, radians: bool = False) -> list[tuple[str, ...]]:
    """Return a row for each joint and bearing: what it is and its figures in N."""
    return [(_label(force), *_figures(force, found.has_order_1, radians)) for force in found.forces]


def reasons(found: SceneForces) -> Iterator[str]:
    """Say why forces are missing, a sentence each."""
    for name, reason in found.refused.items():
        yield f"{name.replace('_', ' ').capitalize()} is not determinate: {reason}."


def largest_text(found: SceneForces) -> str:
    """Say which bearing bears the largest force; nothing without bearings."""
    bearings = [force for force in found.forces if force.shaft is not None]
    if not bearings:
        return ""
    largest = max(bearings, key=lambda force: force.figures.largest)
    at = ""
    if largest.at_deg is not None:
        at = f", at {angle_text(largest.at_deg, False)} of drive angle"
    size = figure_text(largest.figures.largest)
    return f"Largest bearing force: {_label(largest)}, {size} N{at}."


def _label(force: Force) -> str:
    row = force.figures
    label = f"{row.per} {row.item}"
    label = label if force.shaft is None else f"{label}, shaft {force.shaft}"
    return f"{label}, in {force.state}" if force.state else label


def _figures(force: Force, has_order_1: bool, radians: bool) -> Iterator[str]:
    row, at = force.figures, force.at_deg
    yield figure_text(row.largest)
    yield "-" if at is None else angle_text(math.radians(at) if radians else at, radians)
    first = (row.order_1,) if has_order_1 else ()
    yield from map(figure_text, (row.mean, *first, row.order_2, row.order_4))
