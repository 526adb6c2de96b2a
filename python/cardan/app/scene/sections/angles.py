"""The section [angles]: recorded drive angles or speeds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from cardan.app.files import recording
from cardan.app.scene.language.rules import POSITIVE, START, TEXTS, FileName, Text, Whole
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.recording.recorded import (
    ANGLE_COLUMNS,
    BEND_COLUMNS,
    REACH,
    SPEED_COLUMNS,
    Angles,
    Recording,
)

if TYPE_CHECKING:
    from cardan.app.scene.reading import Reading


def _recorded(values: Mapping[str, Any], scene: Reading) -> Angles:
    return Recording(values, scene.folder).whole()


ANGLES: Section[Angles | None] = Section(
    "angles",
    "instead of [sweep]: recorded drive angles or speeds, one sample per row of a file",
    {
        "file": Key(
            FileName(recording.SUFFIXES, folders=True),
            "path from the folder of the scene; its name ends in "
            + " or ".join(recording.SUFFIXES),
        ),
        "angle_column_deg": Key(Text(), "name of the column in degrees"),
        "angle_column_rad": Key(Text(), "or: of the column in radians"),
        "time_column_s": Key(
            Text(),
            "name of the column of times; angles or speeds then make speed and "
            "acceleration of the drive",
        ),
        "speed_column_rpm": Key(
            Text(), "name of the column of the drive's speed, integrated to the angle"
        ),
        "speed_column_rad_s": Key(Text(), "or: the same in rad/s"),
        "torque_column_Nm": Key(Text(), "name of the column of the torque put into shaft 0"),
        "start_deg": Key(START, "with a speed: drive angle of the first sample", default=0),
        "filter_reach": Key(
            Whole(2, most=1000),
            "with times: samples on each side of the parabola that differentiates",
            default=REACH,
        ),
        "raster_s": Key(
            POSITIVE,
            "of an MDF file with a speed: interpolate all channels at steps of so many "
            "seconds; default: the channels have common times",
        ),
        "bend_columns_deg": Key(
            TEXTS, "instead of bends_deg: one column per joint with its bend at each sample"
        ),
        "bend_columns_rad": Key(TEXTS, "or: the same in radians"),
    },
    _recorded,
    together=(
        ANGLE_COLUMNS,
        SPEED_COLUMNS,
        BEND_COLUMNS,
        *((key, angle) for key in ("start_deg", "raster_s") for angle in ANGLE_COLUMNS),
    ),
    needed=(("file",), (*ANGLE_COLUMNS, *SPEED_COLUMNS)),
    with_key=tuple((key, "time_column_s") for key in (*SPEED_COLUMNS, "filter_reach")),
)
"""The section [angles]."""
