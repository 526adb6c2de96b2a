"""The sections [sweep], [angles] and [load]: the angles, the speed and the torque of the drive."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.files import recording
from cardan.app.scene.language import rules
from cardan.app.scene.language.rules import ListOf, Number
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.language.units import RPM, si_key
from cardan.app.scene.recording import recorded
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.load import Load


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


TORQUES = ("drive_torque_Nm", "output_torque_Nm")
"""The keys for a torque; a scene gives at most one of them."""

_MOTION = ("speed_rpm", "speed_rad_s", "acceleration_rad_s2")


@dataclass(frozen=True, eq=False)
class Loaded:
    """The load, and the values of its keys for curves and to reduce; ``None`` without one."""

    load: Load | None
    keys: Mapping[str, Any] | None
    to_reduce: Mapping[str, Any] | None


def _loaded(values: Mapping[str, Any], scene: Reading) -> Loaded:
    check_not_recorded(values, scene)
    keys: Mapping[str, Any] | None = values if LOAD.name in scene.given else None
    to_reduce, recorded = keys, scene[ANGLES]
    if recorded and recorded.load:
        known = {key: own[recorded.known] for key, own in recorded.load.items()}
        keys, to_reduce = {**values, **recorded.load}, {**values, **known}
    if keys is None:
        return Loaded(None, None, None)
    LOAD.check_counts(keys, scene.line.n_joints)
    varied = {**scene.given.get("study", {}), **scene.given.get("states", {})}
    return Loaded(make_load(keys, varied), keys, to_reduce)


def make_load(values: Mapping[str, Any], varied: Container[str] = ()) -> Load:
    """Return the load that keys describe, of arrays if the values are.

    The speed or acceleration that only a study gives, of the keys varied, is 0 here.
    """
    given = {LOAD.keys[key].argument for key in values}
    still = {k: 0.0 for k in _MOTION if k in varied and LOAD.keys[k].argument not in given}
    values = still | dict(values)
    with LOAD.named(values):
        return Load(**LOAD.arguments(values))


def check_not_recorded(values: Mapping[str, Any], scene: Reading) -> None:
    """Refuse keys of a load, or of a study, for what was recorded."""
    recorded = scene[ANGLES]
    for keys, signal, said in (
        (_MOTION, "speed_rad_s", "times, from which speed and acceleration follow"),
        (TORQUES, "drive_torque_Nm", "a torque"),
    ):
        for key in values if recorded and signal in recorded.load else ():
            if si_key(key) in keys:
                raise ArgumentValueError(key, f"does not go with [angles], which gives {said}")


def at_samples(load: Load, which: NDArray[np.bool_]) -> Load:
    """Return the load at some of the samples of a recording."""
    return load.changed(lambda values, own: values[which] if values.ndim > own else values)


def largest_speed(load: Load | None) -> float:
    """Return the speed of the drive in rad/s, the largest of a recording; 0 if it is not given."""
    speeds = np.atleast_1d(0.0 if load is None else load.speed)
    known = speeds[~np.isnan(speeds)]
    return float(known[np.argmax(np.abs(known))]) if known.size else 0.0


LOAD: Section[Loaded] = Section(
    "load",
    "speed, torque and inertias",
    {
        "speed_rpm": Key(Number(), "speed of the drive", "speed", RPM),
        "speed_rad_s": Key(Number(), "the same in rad/s", "speed"),
        "acceleration_rad_s2": Key(Number(), "acceleration of the drive", "acceleration"),
        "drive_torque_Nm": Key(Number(), "torque put into shaft 0", "drive_torque"),
        "output_torque_Nm": Key(
            Number(), "or: torque delivered by the last shaft", "output_torque"
        ),
        "inertias_kgm2": Key(
            ListOf(Number(0, what="an inertia"), "numbers"),
            "moment of inertia of each shaft about its axis",
            "inertias",
            per="shaft",
            entry=("inertia", "shaft", 0),
        ),
    },
    _loaded,
    together=(("speed_rpm", "speed_rad_s"), TORQUES),
    always=True,
)
