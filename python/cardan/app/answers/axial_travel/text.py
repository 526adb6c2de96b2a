"""How far pins and shafts slide because their axes do not meet, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.axial_travel.figures import AxialTravel

# A tenth of a micrometre is less than any measurement of a driveline shows.
_SHOWN = 0.5e-7


def sentences(found: AxialTravel) -> Iterator[str]:
    """Say what the figures are, and which offsets cause which orders."""
    yield (
        "The travel is from peak to peak, the orders are amplitudes, with the driving shaft of the "
        "joint held in place. The angles, speeds and torques do not change."
    )
    if any(max(each.order_1, each.order_3) > _SHOWN for each in found.shafts):
        yield (
            "In the travel of a shaft, orders 1 and 3 come from pins that miss the axes of their "
            "shafts."
        )
    if any(max(each.order_2, each.order_4) > _SHOWN for each in found.shafts):
        yield (
            "In the travel of a shaft, orders 2 and 4 come from shafts that miss each other, and "
            "from pins of a cross that miss each other."
        )
