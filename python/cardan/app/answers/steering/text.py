"""A steering column in words: symmetry of left and right, and the yoke to turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.printed import place_of, quantity
from cardan.app.answers.rows import Judged
from cardan.app.answers.steering.figures import SteeringFigures

# A workshop sets no yoke more finely than to a tenth of a degree.
_SETTABLE = math.radians(0.1)


def sentences(found: SteeringFigures) -> Iterator[str]:
    """Say whether left and right are symmetric, and how to turn the yoke if not."""
    offset, ratio = found.offset, found.difference
    assert offset.value is not None
    assert ratio.value is not None
    if offset.value == 0.0:
        yield f"Left and right are symmetric{' in all states' if offset.each else ''}."
        return
    yield (
        f"Left and right differ: straight ahead is {quantity(offset.value, 'deg')} from the "
        f"nearest symmetric angle{place_of(offset)}{_judged(offset, 'deg')}, and the ratio differs "
        f"by up to {quantity(ratio.value, 'percent')}{place_of(ratio)}{_judged(ratio, 'percent')}."
    )
    yield _turning(found)


def _judged(value: Judged, unit: str) -> str:
    if value.limit is None:
        return ""
    return f", {value.verdict} the limit of {quantity(value.limit, unit)}"


def _turning(found: SteeringFigures) -> str:
    """How to turn the yoke: for one driveline to symmetry, for several to the middle."""
    if found.best_turn is None or found.left is None:
        return (
            f"For symmetry{place_of(found.offset)}, turn the driving yoke of joint 0 on the column "
            f"by {_turn(found.turn_to_quick.value)} (ratio largest straight ahead) or by "
            f"{_turn(found.turn_to_slow.value)} (ratio least), looking from the column towards the "
            "output."
        )
    if abs(found.best_turn) < _SETTABLE:
        return (
            "The driving yoke of joint 0 has its best place on the column: a turn improves the "
            f"worst case by less than {quantity(_SETTABLE, 'deg')}."
        )
    return (
        f"Turn the driving yoke of joint 0 on the column by {_turn(found.best_turn)}, looking from "
        f"the column towards the output; that leaves at most {quantity(found.left, 'deg')}."
    )


def _turn(angle: float | None) -> str:
    assert angle is not None
    sense = "clockwise" if angle > 0.0 else "counter-clockwise"
    return f"{quantity(abs(angle), 'deg')} {sense}"
