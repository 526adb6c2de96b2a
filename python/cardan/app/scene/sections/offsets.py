"""The section [offsets]: by how much axes of the joints that should meet miss each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cardan.app.scene.language.rules import DISTANCE, each, names
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.sections.study import STATES
from cardan.driveline import Driveline
from cardan.wear.axial_travel import NAMES, SlideName, Slides


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
            "what cannot slide: driving_pin for the cross along the driving pin, driven_pin for "
            "the driven yoke along its pin, shaft for the driven shaft along its axis",
        ),
    },
    _offsets,
    needed=(("driving_pin_mm", "cross_mm", "driven_pin_mm", "shafts_mm"),),
    recorded_bends=False,
)
