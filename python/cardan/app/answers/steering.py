"""A steering column as numbers: of [driveline], of every state, or over the study."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import drivelines, over
from cardan.app.answers.printed import given, place_of, quantity
from cardan.app.answers.rows import Judged, figure, word
from cardan.arrays import FloatArray


@dataclass(frozen=True)
class SteeringFigures:
    """A steering column; ratio, slope and turns are those where it is farthest from symmetry."""

    centre: float = figure(
        "straight ahead", "deg", "drive angle at which the wheels are straight", digits="given"
    )
    ratio: Judged = figure(
        "ratio",
        meaning="speed of the last shaft over that of the column, straight ahead",
        digits="speed_ratio",
    )
    slope: Judged = figure(
        "slope of the ratio",
        "per_rad",
        "derivative of the ratio with respect to the column angle; 0 if left and right are alike",
    )
    difference: Judged = figure(
        "asymmetry of the ratio",
        "percent",
        "largest difference of the ratio between equal angles to the left and to the right",
        source="the extreme of r(t + x) - r(t - x) over x, with r(t) = (1 - k²)/(1 - 2k cos 2t + "
        "k²) of the equivalent joint (Thoma 4)",
        limit="[steering] ratio_percent",
    )
    offset: Judged = figure(
        "angle off symmetry",
        "deg",
        "from straight ahead to the nearest angle at which left and right are symmetric; 0 where "
        "the ratio differs by less than 0.1 %",
        limit="[steering] offset_deg",
    )
    nearest: Literal["quick", "slow"] = word("nearest", "largest (quick) or least ratio (slow)")
    turn_to_quick: Judged = figure(
        "turn to the largest ratio",
        "deg",
        "of the driving yoke of joint 0 on the column; positive is clockwise, looking towards the "
        "output",
    )
    turn_to_slow: Judged = figure("turn to the least ratio", "deg", "of the same yoke")
    best_turn: float | None = figure(
        "best turn", "deg", "of the same yoke, which brings all nearest to symmetry"
    )
    left: float | None = figure("left after the best turn", "deg", "largest angle off symmetry")
    # Whether the scene leaves open where straight ahead is.
    is_assumed: bool = field(kw_only=True)


def find(answer: Answer) -> SteeringFigures | None:
    """Return what a scene's driveline does as a steering column; ``None`` if it is none."""
    scene, column = answer.scene, answer.scene.steering
    if column is None:
        return None
    centre = float(np.radians(column.centre_deg))
    each = [lines[:, 0].steering(centre, drawn=scene.line) for lines, *_ in drivelines(scene)]

    def values(name: str) -> FloatArray:
        return np.concatenate([getattr(found, name) for found in each])

    signed, quick = values("noticed"), values("quick")
    sizes, permitted = np.abs(signed), column.offset_deg
    offset = over(scene, sizes, None if permitted is None else float(np.radians(permitted)))
    worst = int(np.argmax(sizes))

    def there(name: str) -> Judged:
        own = values(name)
        return replace(over(scene, own), value=float(own[worst]), state=offset.state, at=offset.at)

    best: tuple[float | None, float | None] = (None, None)
    if len(signed) > 1 and np.any(signed) and (quick.all() or not quick.any()):
        best = (
            float(-(np.min(signed) + np.max(signed)) / 2.0),
            float(np.max(signed) - np.min(signed)) / 2.0,
        )
    return SteeringFigures(
        centre,
        there("ratio"),
        there("slope"),
        over(scene, values("difference"), column.ratio_percent and 1e-2 * column.ratio_percent),
        offset,
        "quick" if quick[worst] else "slow",
        there("turn_to_quick"),
        there("turn_to_slow"),
        *best,
        is_assumed="centre_deg" not in scene.given.get("steering", {}),
    )


# A workshop sets no yoke more finely than to a tenth of a degree.
_SETTABLE = math.radians(0.1)


def sentences(found: SteeringFigures) -> Iterator[str]:
    """Say whether left and right are symmetric, and how to turn the yoke if not."""
    offset, ratio = found.offset, found.difference
    assert offset.value is not None
    assert ratio.value is not None
    if found.is_assumed:
        yield (
            f"Straight ahead is assumed at a drive angle of {given(found.centre, 'deg')}, because "
            "[steering] has no centre_deg."
        )
    if offset.value == 0.0:
        yield f"Left and right are symmetric{' in all states' if offset.each else ''}."
        return
    yield (
        f"Left and right differ: straight ahead is {quantity(offset, 'deg')} from the "
        f"nearest symmetric angle{place_of(offset)}{_judged(offset, 'deg')}, and the ratio differs "
        f"by up to {quantity(ratio, 'percent')}{place_of(ratio)}{_judged(ratio, 'percent')}."
    )
    yield _turning(found)


def _judged(value: Judged, unit: str) -> str:
    if value.limit is None:
        return ""
    return f", {value.verdict} the limit of {given(value.limit, unit)}"


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
            f"worst case by less than {given(_SETTABLE, 'deg')}."
        )
    return (
        f"Turn the driving yoke of joint 0 on the column by {_turn(found.best_turn)}, looking from "
        f"the column towards the output; that leaves at most {quantity(found.left, 'deg')}."
    )


def _turn(angle: float | None) -> str:
    assert angle is not None
    sense = "clockwise" if angle > 0.0 else "counter-clockwise"
    return f"{quantity(abs(angle), 'deg')} {sense}"
