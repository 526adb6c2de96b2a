"""Scenes that give angles of the driven shaft in place of drive angles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.app.scene.angles import Angles
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline

ANGLE_OF = "angle_of"
"""The key of [output] that says of which shaft the angles are."""


def check_driven(recorded: Mapping[str, Any]) -> None:
    """Refuse recorded times with angles of the driven shaft.

    Raises:
        ValueError: there are some: the speed of the drive would follow from them.
    """
    if "time_column_s" in recorded:
        raise ArgumentValueError(
            ANGLE_OF,
            "is 'driven'; with time_column_s, speed and acceleration of the drive follow from "
            "angles of the drive",
        )


def at_drive(angle: Angles, line: Driveline) -> Angles:
    """Return the drive angles of a scene whose angles are those of the last shaft.

    Those to reduce over stay as they are: in a study, they belong to other drive angles for each
    driveline.
    """
    drive = line.evaluate(angle.drive, "angle", shafts=0, angle_of="driven").drive_angle
    return replace(angle, degrees=np.degrees(drive), drive=drive)
