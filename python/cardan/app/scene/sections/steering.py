"""The section [steering]: the driveline is a steering column."""

from __future__ import annotations

from dataclasses import dataclass

from cardan.app.scene.language.rules import POSITIVE, START, Number
from cardan.app.scene.language.section import Key, Section


@dataclass(frozen=True)
class SteeringColumn:
    """Drive angle straight ahead, and what is permitted: distance from symmetry, left to right."""

    centre_deg: float = 0.0
    offset_deg: float | None = None
    ratio_percent: float | None = None


STEERING: Section[SteeringColumn | None] = Section(
    "steering",
    "the driveline is a steering column: ratio straight ahead, its slope, symmetry left to right",
    {
        "centre_deg": Key(
            START,
            "drive angle of shaft 0 straight ahead, with the points of [driveline]; "
            "in other states the yoke is carried along as the column tilts",
            default=0,
        ),
        "offset_deg": Key(
            Number(0, 45, above=True, unit="deg"),
            "how far straight ahead may be from the nearest angle at which left and right are "
            "symmetric; default: not judged",
        ),
        "ratio_percent": Key(
            POSITIVE,
            "largest difference of the ratio between equal angles to the left and to the right, in "
            "percent; default: not judged",
        ),
    },
    lambda values, _: SteeringColumn(**values),
    recorded_bends=False,
)
