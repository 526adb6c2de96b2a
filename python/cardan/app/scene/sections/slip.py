"""The section [slip]: the spline of a shaft that changes its length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cardan.app.scene.language.rules import FRICTION, INDEX, POSITIVE, SIZE
from cardan.app.scene.language.section import Key, Reading, Section, check_exists
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.arrays.errors import ArgumentValueError


@dataclass(frozen=True)
class Slip:
    """The spline of a shaft: lengths in mm from the points of the scene, but its radius in m."""

    shaft: int
    engaged: float | None = None
    least_engaged: float | None = None
    push_in: float | None = None
    travel: float | None = None
    friction: float | None = None
    radius: float | None = None


def _slip(values: Mapping[str, Any], scene: Reading) -> Slip:
    if scene[DRIVELINE].points is None:
        raise ArgumentValueError(
            "shaft",
            "has no length that could change; [slip] needs points_mm or points_m in [driveline], "
            "which a study moves",
        )
    check_exists("shaft", values["shaft"], scene.line.n_joints + 1)
    return Slip(**SLIP.arguments(values))


SLIP: Section[Slip | None] = Section(
    "slip",
    "spline of a shaft that changes its length; needs a driveline of points, and a study of points "
    "for the travel",
    {
        "shaft": Key(INDEX, "the shaft with the spline, counted from 0", "shaft"),
        "engaged_mm": Key(
            POSITIVE, "engaged length of the spline at the points of [driveline]", "engaged"
        ),
        "least_engaged_mm": Key(
            POSITIVE, "least engaged length that is permitted", "least_engaged"
        ),
        "push_in_mm": Key(
            POSITIVE,
            "how far the spline can be pushed in from the points of [driveline] until it bottoms",
            "push_in",
        ),
        "travel_mm": Key(POSITIVE, "largest travel that is permitted", "travel"),
        "friction": Key(FRICTION, "coefficient of friction in the spline under load", "friction"),
        "radius_mm": Key(SIZE, "pitch radius of the spline", "radius", 1e-3),
    },
    _slip,
    needed=(("shaft",),),
    with_key=(
        ("least_engaged_mm", "engaged_mm"),
        ("friction", "radius_mm"),
        ("radius_mm", "friction"),
    ),
)
