"""The section [load]: speed, torque and inertias."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.scene.language.rules import ListOf, Number
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.language.units import RPM, si_key
from cardan.app.scene.sections.sweep import ANGLES
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.load import Load

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
        keys, to_reduce = {**values, **recorded.load}, {**values, **recorded.load_to_reduce}
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
        ),
    },
    _loaded,
    together=(("speed_rpm", "speed_rad_s"), TORQUES),
    always=True,
)
