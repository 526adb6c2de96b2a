"""How far pins and shafts slide because their axes do not meet, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cardan.app.answers.axial_travel.figures import ORDERS, SceneSlides, SlideFigures
from cardan.app.answers.printed import table_text
from cardan.design.wrapping import fill

HEADINGS = ("travel", *(f"order {order}" for order in ORDERS))
"""What the figures of a row are."""

# A tenth of a micrometre is less than any measurement of a driveline shows.
_SHOWN = 0.5e-4

_ALONG = {
    "shaft": "shaft {} axially",
    "driving_pin": "cross on driving pin",
    "driven_pin": "yoke on driven pin",
}


def words(found: SceneSlides, *, radians: bool = False) -> str:
    """Return the slides as a table and what they come from, as plain text, 79 wide."""
    over = "states and turn" if found.each[0].state else "a turn"
    moving = slide_rows(found)
    if not moving:
        return f"Slides over {over}: none."
    rows = [(f"Slides over {over} [mm]", *HEADINGS)]
    rows += [(f"  {label}", *figures) for label, *figures in moving]
    words = [fill(text, 79) for text in slide_sentences(found)]
    return "\n".join([table_text(rows), "", *words])


def slide_rows(found: SceneSlides) -> list[tuple[str, ...]]:
    """Return a row for each slide that moves: what slides and its figures in mm."""
    return [
        (_label(one), *(f"{size:.4f}" for size in (one.travel, *one.amplitudes)))
        for one in found.each
        if one.travel >= _SHOWN
    ]


def slide_sentences(found: SceneSlides) -> Iterator[str]:
    """Say what the figures are, which offsets cause which orders, and what is blocked."""
    yield (
        "The travel is from peak to peak, the orders are amplitudes, with the driving shaft of the "
        "joint held in place. The angles, speeds and torques do not change."
    )
    if any(one.travel < _SHOWN for one in found.each):
        yield "What is not listed does not slide."
    given = {name for name, value in found.offsets.distances.items() if np.any(value)}
    if given & {"driving_pin", "driven_pin"}:
        yield (
            "In the travel of a shaft, orders 1 and 3 come from pins that miss the axes of their "
            "shafts."
        )
    if given & {"cross", "shafts"}:
        yield (
            "In the travel of a shaft, orders 2 and 4 come from shafts that miss each other, and "
            "from pins of a cross that miss each other."
        )
    if found.offsets.blocked:
        names = " and ".join(found.offsets.blocked)
        yield f"What is blocked does not move: {names}."


def _label(one: SlideFigures) -> str:
    label = f"joint {one.joint}, {_ALONG[one.slide].format(one.joint + 1)}"
    return f"{label}, in {one.state}" if one.state else label
