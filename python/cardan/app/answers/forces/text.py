"""The forces of a scene's joints and bearings, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.forces.figures import Forces, OverTurn
from cardan.app.answers.printed import place_of, quantity


def sentences(found: Forces) -> Iterator[str]:
    """Say why forces are missing."""
    each: tuple[tuple[str, tuple[OverTurn, ...]], ...]
    each = (("joints", found.joints), ("bearings", found.bearings))
    for name, forces in each:
        if forces and (why := forces[0].largest.why):
            yield f"The forces of the {name} are not known: {why}."


def largest_text(found: Forces) -> str:
    """Say which bearing bears the largest force; nothing without bearings."""
    force = max(found.bearings, key=lambda force: force.largest.value or 0.0, default=None)
    if force is None or not force.largest.value:
        return ""
    at = "" if force.at is None else f", at {quantity(force.at, 'deg')} of drive angle"
    return (
        f"Largest bearing force: bearing {force.number}, shaft {force.shaft}, "
        f"{quantity(force.largest.value, 'N')}{place_of(force.largest)}{at}."
    )
