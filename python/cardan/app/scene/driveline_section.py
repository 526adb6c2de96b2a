"""The sections of a scene that describe the driveline and its load."""

from __future__ import annotations

import cardan.app.scene.values as kinds
from cardan.app.scene.bearing_section import LENGTHS
from cardan.app.scene.forms import TEETH
from cardan.app.scene.sections import Key, Section
from cardan.app.scene.units import RPM

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
