"""The section of a scene that describes the spline of a shaft that changes its length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline

SLIP = Section(
    "spline of a shaft that changes its length; needs a driveline of points, and a study of points "
    "for the travel",
    {
        "shaft": Key(kinds.SHAFT, "the shaft with the spline, counted from 0"),
        "engaged_mm": Key(
            kinds.POSITIVE, "engaged length of the spline at the points of [driveline]"
        ),
        "least_engaged_mm": Key(kinds.POSITIVE, "least engaged length that is permitted"),
        "push_in_mm": Key(
            kinds.POSITIVE,
            "how far the spline can be pushed in from the points of [driveline] until it bottoms",
        ),
        "travel_mm": Key(kinds.POSITIVE, "largest travel that is permitted"),
        "friction": Key(kinds.FRICTION, "coefficient of friction in the spline under load"),
        "radius_mm": Key(kinds.BALL_RADIUS, "pitch radius of the spline"),
    },
    needed=(("shaft",),),
    with_key=(
        ("least_engaged_mm", "engaged_mm"),
        ("friction", "radius_mm"),
        ("radius_mm", "friction"),
    ),
)
"""The section [slip]."""


@dataclass(frozen=True)
class Slip:
    """The spline of a shaft; lengths in mm, ``None`` for what the scene does not give.

    Attributes:
        shaft: which shaft.
        engaged: engaged length at the points of the scene.
        least_engaged: least engaged length that is permitted.
        push_in: how far it can be pushed in from there.
        travel: largest travel that is permitted.
        friction: coefficient of friction.
        radius: pitch radius in m.
    """

    shaft: int
    engaged: float | None = None
    least_engaged: float | None = None
    push_in: float | None = None
    travel: float | None = None
    friction: float | None = None
    radius: float | None = None


def slip_of(values: Mapping[str, Any], line: Driveline, driveline: Mapping[str, Any]) -> Slip:
    """Return the spline that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline.
        driveline: the keys that describe it.

    Raises:
        ValueError: a driveline that is not described by points, a shaft that does not exist.
    """
    if not {"points_mm", "points_m"} & driveline.keys():
        raise ArgumentValueError(
            "shaft",
            "has no length that could change; [slip] needs points_mm or points_m in [driveline], "
            "which a study moves",
        )
    if values["shaft"] > line.n_joints:
        raise ArgumentValueError(
            "shaft", f"is {values['shaft']}; there are {line.n_joints + 1}, counted from 0"
        )
    return Slip(
        values["shaft"],
        values.get("engaged_mm"),
        values.get("least_engaged_mm"),
        values.get("push_in_mm"),
        values.get("travel_mm"),
        values.get("friction"),
        1e-3 * values["radius_mm"] if "radius_mm" in values else None,
    )
