"""The orders of joints as built, in words."""

from __future__ import annotations

from cardan.app.answers.as_built.figures import OrderFigures

BY_DRAWING = (
    "Curves, extremes, forces and play are those as built. Equivalent bend, closed forms, limits, "
    "slides, life, torsional vibration and steering are those of the drawing."
)


def heading(_: tuple[OrderFigures, ...]) -> str:
    """Say what the figures are."""
    return "Joints as built: amplitudes by order of the drive"


def sentences(_: tuple[OrderFigures, ...]) -> list[str]:
    """Say which figures of the answer have the deviations."""
    return [BY_DRAWING]
