"""The section [sweep], and the drive angles of a scene, however they are given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.scene.language.rules import COUNT, POSITIVE, START, shown
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.recording.recorded import MOST_STEPS, Angles
from cardan.app.scene.sections.angles import ANGLES
from cardan.arrays.errors import ArgumentValueError

if TYPE_CHECKING:
    from cardan.app.scene.reading import Reading

DRIVE_ANGLES = ("sweep", "angles")
"""The sections that give the drive angles; a scene has at most one of them."""


def _angles(values: Mapping[str, Any], scene: Reading) -> Angles:
    angles = scene[ANGLES] or _swept(**SWEEP.filled(values))
    if scene.given.get("output", {}).get("angle_of") != "driven":
        return angles
    # Those to reduce over stay as they are: in a study, they belong to other drive angles for each
    # driveline.
    drive = scene.line.evaluate(angles.drive, "angle", shafts=0, angle_of="driven").drive_angle
    return replace(angles, degrees=np.degrees(drive), drive=drive, driven=angles.degrees)


def _swept(turns: float, samples_per_turn: int, start_deg: float) -> Angles:
    # Cut off, because no float holds every whole number of the file.
    held = min(samples_per_turn, 1 << 60)
    if turns * held > MOST_STEPS:
        raise ArgumentValueError(
            "samples_per_turn",
            f"is {shown(samples_per_turn)} over turns = {turns:g}; "
            f"a sweep takes at most {MOST_STEPS} steps",
        )
    return Angles.uniform(turns, held, start_deg)


SWEEP: Section[Angles] = Section(
    "sweep",
    "drive angles at equal steps, both ends included",
    {
        "turns": Key(POSITIVE, "turns of the drive", default=1),
        "samples_per_turn": Key(COUNT, "steps per turn", default=720),
        "start_deg": Key(START, "first drive angle", default=0),
    },
    _angles,
    always=True,
)
"""The section [sweep]."""
