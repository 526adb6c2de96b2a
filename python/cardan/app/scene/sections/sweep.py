"""The sections [sweep] and [angles]: drive angles at equal steps, or recorded ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.app.files import recording
from cardan.app.scene.language import rules
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.recording import recorded
from cardan.arrays.errors import ArgumentValueError


def _recorded(values: Mapping[str, Any], scene: Reading) -> recorded.Angles:
    return recorded.Recording(values, scene.folder).whole()


ANGLES: Section[recorded.Angles | None] = Section(
    "angles",
    "instead of [sweep]: recorded drive angles or speeds, one sample per row of a file",
    {
        "file": Key(
            rules.FileName(recording.SUFFIXES, folders=True),
            "path from the folder of the scene; its name ends in "
            + " or ".join(recording.SUFFIXES),
        ),
        "angle_column_deg": Key(rules.Text(), "name of the column in degrees"),
        "angle_column_rad": Key(rules.Text(), "or: of the column in radians"),
        "time_column_s": Key(
            rules.Text(),
            "name of the column of times; angles or speeds then make speed and "
            "acceleration of the drive",
        ),
        "speed_column_rpm": Key(
            rules.Text(), "name of the column of the drive's speed, integrated to the angle"
        ),
        "speed_column_rad_s": Key(rules.Text(), "or: the same in rad/s"),
        "torque_column_Nm": Key(rules.Text(), "name of the column of the torque put into shaft 0"),
        "start_deg": Key(rules.START, "with a speed: drive angle of the first sample", default=0),
        "filter_reach": Key(
            rules.Whole(2, most=1000),
            "with times: samples on each side of the parabola that differentiates",
            default=recorded.REACH,
        ),
        "raster_s": Key(
            rules.POSITIVE,
            "of an MDF file with a speed: interpolate all channels at steps of so many "
            "seconds; default: the channels have common times",
        ),
        "bend_columns_deg": Key(
            rules.TEXTS, "instead of bends_deg: one column per joint with its bend at each sample"
        ),
        "bend_columns_rad": Key(rules.TEXTS, "or: the same in radians"),
    },
    _recorded,
    together=(
        recorded.ANGLE_COLUMNS,
        recorded.SPEED_COLUMNS,
        recorded.BEND_COLUMNS,
        *((key, angle) for key in ("start_deg", "raster_s") for angle in recorded.ANGLE_COLUMNS),
    ),
    needed=(("file",), (*recorded.ANGLE_COLUMNS, *recorded.SPEED_COLUMNS)),
    with_key=tuple((key, "time_column_s") for key in (*recorded.SPEED_COLUMNS, "filter_reach")),
)


DRIVE_ANGLES = ("sweep", "angles")
"""The sections that give the drive angles; a scene has at most one of them."""


def _angles(values: Mapping[str, Any], scene: Reading) -> recorded.Angles:
    angles = scene[ANGLES] or _swept(**SWEEP.filled(values))
    if scene.given.get("output", {}).get("angle_of") != "driven":
        return angles
    # Those to reduce over stay as they are: in a study, they belong to other drive angles for each
    # driveline.
    drive = scene.line.evaluate(angles.drive, "angle", shafts=0, angle_of="driven").drive_angle
    return replace(angles, degrees=np.degrees(drive), drive=drive, driven=angles.degrees)


def _swept(turns: float, samples_per_turn: int, start_deg: float) -> recorded.Angles:
    # Cut off, because no float holds every whole number of the file.
    held = min(samples_per_turn, 1 << 60)
    if turns * held > recorded.MOST_STEPS:
        raise ArgumentValueError(
            "samples_per_turn",
            f"is {rules.shown(samples_per_turn)} over turns = {turns:g}; "
            f"a sweep takes at most {recorded.MOST_STEPS} steps",
        )
    return recorded.Angles.uniform(turns, held, start_deg)


SWEEP: Section[recorded.Angles] = Section(
    "sweep",
    "drive angles at equal steps, both ends included",
    {
        "turns": Key(rules.POSITIVE, "turns of the drive", default=1),
        "samples_per_turn": Key(rules.COUNT, "steps per turn", default=720),
        "start_deg": Key(rules.START, "first drive angle", default=0),
    },
    _angles,
    always=True,
)
