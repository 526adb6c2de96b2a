"""A steering column as numbers: of [driveline], of every state, or over the study."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import drivelines, over
from cardan.app.answers.rows import Judged, figure, word
from cardan.arrays import FloatArray


@dataclass(frozen=True)
class SteeringFigures:
    """A steering column; ratio, slope and turns are those where it is farthest from symmetry."""

    centre: float = figure("straight ahead", "deg", "drive angle at which the wheels are straight")
    ratio: Judged = figure(
        "ratio", meaning="speed of the last shaft over that of the column, straight ahead"
    )
    slope: Judged = figure(
        "slope of the ratio",
        "per_rad",
        "derivative of the ratio by the angle of the column; 0 if left and right are alike",
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
    )
