"""The sections of a scene that describe the driveline and its load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.language.units import RPM
from cardan.app.scene.sections.bearing_section import LENGTHS
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.geometry.bearings import in_metres

TEETH = "teeth"
"""The key of a driveline that says in which steps its yokes can be set."""


@dataclass(frozen=True)
class Form:
    """One way to describe a driveline: the keys that it needs and those that may go with it.

    Attributes:
        make: the constructor that the keys' arguments belong to.
        keys: required, all of one length.
        optional: may go with them.
        ends: how many entries the needed keys have beyond one per joint.
        joints: how many joints it describes, if only so many.
        views: whether the needed keys are views, of which one suffices: in the other all is level.
    """

    make: Callable[..., Driveline]
    keys: tuple[str, ...]
    optional: tuple[str, ...]
    ends: int
    joints: int | None = None
    views: bool = False

    @property
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the section of a driveline that is described in this way."""
        fewest = (self.joints or 1) + self.ends
        most = {} if self.joints is None else {"maxItems": fewest}
        lengths = {key: {"minItems": fewest} | most for key in self.keys}
        lengths_too = () if self.keys[0].startswith("points") else LENGTHS
        allowed = only(*self.keys, *self.optional, TEETH, *lengths_too)
        needed: dict[str, Any] = {"required": list(self.keys)}
        if self.views:
            needed = {"anyOf": [{"required": [key]} for key in self.keys]}
        return {**needed, "properties": lengths, **allowed}


_BENDS, _TWISTS, _PHASES = "bends_deg", "twists_deg", "phases_deg"
_SLOPES = ("slopes_vertical_deg", "slopes_horizontal_deg")
_DOUBLE_JOINT = ("double_joint_deg", "joint_distance_mm", "synchronous_deg")
_PROJECTED = ("projected_bends_vertical_deg", "projected_bends_horizontal_deg")


def _from_points_in_mm(
    points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
) -> Driveline:
    """A driveline from points in mm; its lengths are in metres, so that forces are in newtons."""
    return in_metres(Driveline.from_points(points, phases, degrees=degrees), 1e-3)


def _from_double_joint(
    total: ArrayLike,
    length: ArrayLike,
    synchronous: ArrayLike,
    wear: ArrayLike = 0.0,
    *,
    degrees: bool = False,
) -> Driveline:
    """A centred double joint whose pivot is off by ``wear``; each value is a list of one."""
    bend, distance, even, off = (
        np.asarray(value, dtype=np.float64)[..., 0] for value in (total, length, synchronous, wear)
    )
    half = 0.5 * (np.radians(even) if degrees else even)
    pivot = 0.5 * distance / np.cos(half) + off
    if np.any((pivot <= 0.0) | (pivot >= distance)):
        raise ArgumentValueError("wear", "puts the pivot beyond the joints, between which it lies")
    return Driveline.from_double_joint(bend, distance, pivot, degrees=degrees)


FORMS = (
    Form(Driveline.from_bends, (_BENDS,), (_TWISTS, _PHASES), 0),
    Form(Driveline.from_points, ("points_m",), (_PHASES,), 2),
    Form(_from_points_in_mm, ("points_mm",), (_PHASES,), 2),
    Form(Driveline.from_directions, ("directions",), (_PHASES,), 1),
    Form(Driveline.from_slopes, _SLOPES, (_PHASES,), 1, views=True),
    Form(Driveline.from_projected_bends, _PROJECTED, (_PHASES,), 0, 2, views=True),
    # Values of a double joint are lists of one entry.
    Form(_from_double_joint, _DOUBLE_JOINT, ("pivot_wear_mm",), -1, 2),
)
"""The ways to describe a driveline; a scene uses exactly one of them."""


def only(*keys: str) -> dict[str, Any]:
    """Return the JSON Schema of an object without keys other than these."""
    return {"propertyNames": {"enum": list(keys)}}


DRIVELINE = Section(
    "joints and shafts, required; give exactly one description",
    {
        "bends_deg": Key(kinds.BENDS, "bend of each joint, in [0, 90)", "bends"),
        "twists_deg": Key(
            kinds.NUMBERS,
            "with bends_deg: angle from one bend plane to the next about each intermediate "
            "shaft, clockwise looking from the drive towards the output; default 0",
            "twists",
        ),
        "points_m": Key(
            kinds.VECTORS, "driving end, joint centres, driven end, in right-handed axes", "points"
        ),
        "points_mm": Key(kinds.VECTORS, "the same in mm", "points"),
        "directions": Key(
            kinds.VECTORS,
            "a vector of any length along each shaft, in right-handed axes",
            "directions",
        ),
        "slopes_vertical_deg": Key(
            kinds.SLOPES, "slope of each shaft in side view, positive upwards", "vertical"
        ),
        "slopes_horizontal_deg": Key(
            kinds.SLOPES,
            "slope of each shaft in top view, positive to the right, looking from the drive "
            "towards the output: towards the vehicle's left if its drive is in front",
            "horizontal",
        ),
        "projected_bends_vertical_deg": Key(
            kinds.SLOPES,
            "bends of two joints in side view, from the common shaft, positive upwards",
            "vertical",
        ),
        "projected_bends_horizontal_deg": Key(
            kinds.SLOPES,
            "bends of two joints in top view, from the common shaft, positive as "
            "slopes_horizontal_deg",
            "horizontal",
        ),
        "double_joint_deg": Key(
            kinds.TOTAL_BEND, "total bend of a centred double joint, in [0, 180)", "total"
        ),
        "joint_distance_mm": Key(
            kinds.DISTANCE, "of a double joint: distance of its joint centres", "length"
        ),
        "synchronous_deg": Key(
            kinds.SYNCHRONOUS,
            "of a double joint: total bend at which both joints have the same bend",
            "synchronous",
        ),
        "pivot_wear_mm": Key(
            kinds.NUMBERS,
            "of a double joint: how far its pivot is off, away from joint 0; default 0",
            "wear",
        ),
        "phases_deg": Key(
            kinds.NUMBERS,
            "angle from the input-side to the output-side yoke of each intermediate shaft, "
            "clockwise looking from the drive towards the output; default 0",
            "phases",
        ),
        TEETH: Key(
            kinds.TEETH,
            "teeth of the spline that carries the output-side yoke of each shaft between two "
            "joints: one number for all shafts or one per shaft, 1 where no yoke can be turned; "
            "default: any angle can be set",
        ),
        "lengths_mm": Key(
            kinds.LENGTHS,
            "without points: length of each shaft between its joints or ends, for forces",
        ),
        "lengths_m": Key(kinds.LENGTHS, "or: the same in metres"),
    },
    together=(LENGTHS,),
)

LOAD = Section(
    "speed, torque and inertias",
    {
        "speed_rpm": Key(kinds.NUMBER, "speed of the drive", "speed", RPM),
        "speed_rad_s": Key(kinds.NUMBER, "the same in rad/s", "speed"),
        "acceleration_rad_s2": Key(kinds.NUMBER, "acceleration of the drive", "acceleration"),
        "drive_torque_Nm": Key(kinds.NUMBER, "torque put into shaft 0", "drive_torque"),
        "output_torque_Nm": Key(
            kinds.NUMBER, "or: torque delivered by the last shaft", "output_torque"
        ),
        "inertias_kgm2": Key(
            kinds.INERTIAS, "moment of inertia of each shaft about its axis", "inertias"
        ),
    },
    together=(("speed_rpm", "speed_rad_s"), ("drive_torque_Nm", "output_torque_Nm")),
)
