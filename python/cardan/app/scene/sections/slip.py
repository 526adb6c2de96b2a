"""The sections [slip] and [offsets]: splines of shafts, and axes that miss each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cardan.app.scene.language.rules import DISTANCE, FRICTION, INDEX, POSITIVE, SIZE, each, names
from cardan.app.scene.language.section import Key, Reading, Section, check_exists
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.app.scene.sections.study import STATES
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.wear.axial_travel import NAMES, SlideName, Slides


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
        "least_engaged_mm": Key(POSITIVE, "least permitted engaged length", "least_engaged"),
        "push_in_mm": Key(
            POSITIVE,
            "how far the spline can be pushed in from the points of [driveline] until it bottoms",
            "push_in",
        ),
        "travel_mm": Key(POSITIVE, "largest permitted travel", "travel"),
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


@dataclass(frozen=True)
class AxisOffsets:
    """Distances of axes that should meet, for ``Driveline.slides`` in mm, and what cannot slide."""

    distances: Mapping[str, float | list[float]]
    blocked: tuple[SlideName, ...]

    def slides(self, line: Driveline) -> Slides:
        """Return the slides of a driveline, or of a batch of drivelines, in mm."""
        distances: Any = self.distances
        found = line.slides(**distances)
        found.check_free(self.blocked, " mm")
        return found


def _offsets(values: Mapping[str, Any], scene: Reading) -> AxisOffsets:
    states = scene[STATES]
    lines = states.drivelines() if states else scene.line
    OFFSETS.check_counts(values, lines.n_joints)
    found = AxisOffsets(OFFSETS.arguments(values), tuple(values.get("blocked", ())))
    # What the offsets would move must not be blocked.
    found.slides(lines)
    return found


def _distance(meaning: str, argument: str) -> Key:
    return Key(each(DISTANCE), meaning, argument, per="joint")


OFFSETS: Section[AxisOffsets | None] = Section(
    "offsets",
    "distances of axes that should meet, for the axial travel; each value is one for all joints or "
    "a list with one per joint",
    {
        "driving_pin_mm": _distance(
            "from the axis of the driving shaft to that of its pin", "driving_pin"
        ),
        "cross_mm": _distance("from the driving pin to the driven pin", "cross"),
        "driven_pin_mm": _distance("from the driven pin to the axis of its shaft", "driven_pin"),
        "shafts_mm": _distance(
            "from the axis of the driving shaft to that of the driven one", "shafts"
        ),
        "blocked": Key(
            names(NAMES),
            "parts that cannot slide: driving_pin for the cross along the driving pin, "
            "driven_pin for the driven yoke along its pin, shaft for the driven shaft along its "
            "axis",
        ),
    },
    _offsets,
    needed=(("driving_pin_mm", "cross_mm", "driven_pin_mm", "shafts_mm"),),
    recorded_bends=False,
)
