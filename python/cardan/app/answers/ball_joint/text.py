"""What a ball joint carries, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.ball_joint.figures import BallJointFigures
from cardan.app.answers.printed import quantity

# The law of a layer holds for strains that are small beside 1.
_SMALL_STRAIN = 0.1

_SMALL_CLEARANCE = 0.1


def sentences(found: BallJointFigures) -> Iterator[str]:
    """Say whether the pressure is allowable, what to change if not, and what limits the model."""
    yield _verdict(found)
    for part, strain in (("ball", found.ball_strain), ("seat", found.seat_strain)):
        if strain is None or strain <= _SMALL_STRAIN:
            continue
        if strain >= 1.0:
            yield (
                f"The approach of the {_named(found, part)} exceeds the thickness of its layer, "
                "which no layer can do. Check load, modulus_MPa and layer_mm."
            )
        else:
            yield (
                f"The {_named(found, part)} is compressed by {quantity(strain, 'percent')} of the "
                "thickness of its layer. The model assumes less than 10%; treat the pressure as a "
                "rough estimate."
            )
    if found.clearance > _SMALL_CLEARANCE * found.radius:
        yield (
            "The clearance exceeds a tenth of the radius. The model assumes a small clearance; "
            "treat the pressure as a rough estimate."
        )


def _verdict(found: BallJointFigures) -> str:
    weaker = found.weaker
    if weaker is None:
        return (
            "The pressure is not judged: the scene gives no allowable pressure of ball or seat. "
            "Take it from the supplier of the seat as a peak pressure; a limit for the load over "
            "the projected area compares with that figure."
        )
    if found.radius_from == "allowable pressure":
        return (
            f"This is the smallest ball; the {_named(found, weaker)} is at its allowable pressure. "
            "Round the radius up and enter it as radius_mm."
        )
    judged = found.ball_pressure if weaker == "ball" else found.seat_pressure
    assert judged.limit is not None
    if judged.verdict == "within":
        return (
            "The ball joint is within the allowable pressure: the peak uses "
            f"{quantity(found.peak / judged.limit, 'percent')} of what the scene allows the "
            f"{_named(found, weaker)}."
        )
    assert found.smallest_radius is not None
    assert found.allowable_load is not None
    radius = math.ceil(1e4 * found.smallest_radius) / 1e4
    return (
        f"The ball joint is beyond the allowable pressure that the scene gives the "
        f"{_named(found, weaker)}. A ball of {quantity(radius, 'mm')} radius is within it; this "
        f"one carries up to {quantity(found.allowable_load, 'N')}."
    )


def _named(found: BallJointFigures, part: str) -> str:
    """Ball or seat with its material."""
    name = found.ball if part == "ball" else found.seat
    return f"{part} ({name})" if name else part
