"""The section of a scene that says by how much the axes of its joints miss each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.wear.axial_travel import SlideName, Slides

OFFSETS = Section(
    "distances of axes that should meet, for the axial travel; each value is one for all joints or "
    "a list with one per joint",
    {
        "driving_pin_mm": Key(
            kinds.DISTANCES, "from the axis of the driving shaft to that of its pin", "driving_pin"
        ),
        "cross_mm": Key(kinds.DISTANCES, "from the driving pin to the driven pin", "cross"),
        "driven_pin_mm": Key(
            kinds.DISTANCES, "from the driven pin to the axis of its shaft", "driven_pin"
        ),
        "shafts_mm": Key(
            kinds.DISTANCES,
            "from the axis of the driving shaft to that of the driven one",
            "shafts",
        ),
        "blocked": Key(
            kinds.SLIDES,
            "what cannot slide: driving_pin for the cross along the driving pin, driven_pin for "
            "the driven yoke along its pin, shaft for the driven shaft along its axis",
        ),
    },
    needed=(("driving_pin_mm", "cross_mm", "driven_pin_mm", "shafts_mm"),),
)
"""The section [offsets]."""


@dataclass(frozen=True)
class AxisOffsets:
    """Distances of axes that should meet, and what cannot slide.

    Attributes:
        distances: arguments of ``Driveline.slides`` in mm.
        blocked: slides that are not free.
    """

    distances: Mapping[str, float | list[float]]
    blocked: tuple[SlideName, ...]

    def slides(self, line: Driveline) -> Slides:
        """Return the slides of a driveline, or of a batch of drivelines, in mm."""
        distances: Any = self.distances
        found = line.slides(**distances)
        found.check_free(self.blocked, " mm")
        return found


def offsets_of(values: Mapping[str, Any], lines: Driveline) -> AxisOffsets:
    """Return the offsets that the keys of the section describe.

    Args:
        values: values by key.
        lines: the driveline, or a batch of it in all its states.

    Raises:
        ValueError: a list that does not have one value per joint, a blocked slide that the offsets
            would move.
    """
    keys = OFFSETS.keys
    for key, value in values.items():
        if keys[key].argument and isinstance(value, list) and len(value) != lines.n_joints:
            raise ArgumentValueError(
                key, f"has length {len(value)}; it needs {lines.n_joints}, one per joint"
            )
    blocked: Any = values.get("blocked", ())
    names: Any = [blocked] if isinstance(blocked, str) else blocked
    distances = {keys[key].argument: value for key, value in values.items() if keys[key].argument}
    found = AxisOffsets(distances, tuple(names))
    found.slides(lines)
    return found
