"""Starter scenes: commented files that run unchanged, to begin with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType

from cardan.arrays.errors import ArgumentValueError


@dataclass(frozen=True)
class Starter:
    """A scene to begin with, in whose text ``{name}`` stands for the name of its file.

    The command is the one that it is made for. It may have a sample recording with it, or be a
    whole machine, from its points to its limits.
    """

    meaning: str
    text: str
    recorded: bool = False
    machine: bool = False
    command: str = "run"


def _shown(kind: str, *folder: str) -> str:
    """Return the text of a scene that a page shows under the name of its kind."""
    file = resources.files("cardan.app.scene").joinpath(*folder, f"{kind}.toml")
    return file.read_text(encoding="utf-8").replace(f"{kind}.", "{name}.")


def _machine(kind: str, meaning: str) -> Starter:
    """Return the scene of a machine as a starter."""
    return Starter(meaning, _shown(kind, "machines"), machine=True, command="check")


_FILES = """\
# quantities = ["angle_error", "speed_ratio", "bending_driving", "bending_driven"]
# Curves over the drive angle as .csv, .parquet or .npz; the picture as .svg, .png or .pdf.
curves = "{name}.csv"
picture = "{name}.svg"
"""

STARTERS: Mapping[str, Starter] = MappingProxyType(
    {
        "joint": Starter(
            "one joint",
            """\
# One universal joint. Try another bend and run it again: cardan run {name}.toml

title = "One joint at 20 deg"

[driveline]
bends_deg = [20]               # the angle between the two shafts

[load]                         # may be left out: then only the motion is computed
speed_rpm = 1500
output_torque_Nm = 100         # delivered by the driven shaft
inertias_kgm2 = [0, 0.02]      # driving shaft, driven shaft with what it carries

[output]
"""
            + _FILES,
        ),
        "z-shaft": Starter(
            "two joints with parallel ends, which cancel each other",
            """\
# A Z shaft: two joints with equal bends in one plane, input and output shaft parallel. If the yokes
# of the common shaft lie in one plane (phase 0), the joints cancel each other, and only the shaft
# between them turns unevenly. Set phases_deg to 5 and see what a small error of assembly costs.
# Then "cardan phase {name}.toml" says how to correct it.

title = "Z shaft, twice 15 deg"

[driveline]
bends_deg = [15, 15]
twists_deg = [180]             # 180: Z arrangement, 0: W arrangement
phases_deg = [0]               # 0: yokes of the common shaft in one plane
# teeth = 24                   # of its spline: cardan phase then finds the best tooth

[load]
speed_rpm = 1000
output_torque_Nm = 200
inertias_kgm2 = [0, 0.01, 0.05]

[output]
# shafts = [1, 2]              # the common shaft and the driven one
"""
            + _FILES,
        ),
        "multi-joint": Starter(
            "three joints by their points from a drawing",
            """\
# A multi-joint driveline by the points of a drawing: the driving end, the centre of each joint, the
# driven end. "cardan phase {name}.toml" says how to set the yokes.
#
# Axes of the points, right-handed, in mm:
#
#   axis  direction
#   x     rearwards, from the gearbox to the axle
#   y     up
#   z     to the vehicle's left
#
# If z points to the right in your drawing, change the sign of every z. Otherwise the driveline is
# mirrored and each yoke is set in the wrong sense: this one would get an equivalent bend of 4.2 deg
# in place of 2.0.

title = "Driveline with three joints"

[driveline]
points_mm = [
    [0, 0, 0],                 # gearbox
    [350, -24, 0],             # joint 0
    [1650, -46, 0],            # joint 1, behind the centre bearing
    [3150, -180, 45],          # joint 2
    [3450, -196, 45],          # pinion of the axle
]
phases_deg = [0, 0]            # the yokes of each shaft between two joints lie in one plane
# teeth = 24                   # of their splines: cardan phase then finds the best teeth

[load]
speed_rpm = 1500
output_torque_Nm = 4000

[output]
"""
            + _FILES,
            command="phase",
        ),
        "wide-angle": Starter(
            "a wide-angle PTO shaft: a double joint and a single one",
            """\
# A wide-angle PTO shaft (homokinetic, CV), as of a baler or a mower: a double joint centred by a
# pivot over the hitch pin of the tractor, a single joint at the implement.
# "cardan check {name}.toml" says how evenly it runs in each turn, and "cardan optimise {name}.toml"
# which pivot would suit.
#
# The implement's input shaft lies 60 mm higher, and the joint centres are 1000 mm apart: the single
# joint is bent by atan(60/1000) in every turn, the double joint by what the turn asks. The plane of
# the single joint stays upright, and that of the double joint lies down in a turn.

title = "Wide-angle PTO shaft"

[driveline]
double_joint_deg = 3.43        # total bend of the wide-angle joint, here straight ahead
joint_distance_mm = 80         # from one of its two crosses to the other
synchronous_deg = 40           # total bend at which both have the same bend, from the maker
single_bend_deg = 3.43         # of the joint at the implement
single_twist_deg = 180         # from the plane of the double joint to its own
single_phase_deg = 0           # yokes of the shaft between them in one plane

[load]
speed_rpm = 540
output_torque_Nm = 500

[states]                       # how far the tractor turns
names = ["straight", "turn 20 deg", "turn 35 deg", "turn 50 deg"]
weights = [8, 3, 2, 1]
double_joint_deg = [3.43, 20.28, 35.15, 50.09]
single_twist_deg = [180, 99.3, 94.9, 92.9]  # changes with the turn: about 90 if bent up or down

[limits]                       # put your own in their place
equivalent_bend_deg = [6, 8]
source = "our own trials"

[optimise]
# Least and largest change of each value.
vary = {synchronous_deg = [-30, 40], single_phase_deg = "free"}

[output]
"""
            + _FILES,
            command="check",
        ),
        "readings": Starter(
            "what an inclinometer shows on each shaft",
            """\
# A driveline as a workshop or a boatyard measures it: an inclinometer on each shaft, a tape measure
# in plan.
# "cardan check {name}.toml" says which angles the joints work at, whether that is good, how certain
# this is, and which shim, spacer or turn of a yoke would help.
#
# Hold the gauge along each shaft or square to its flange, with the vehicle level and the axle at
# ride height; in a boat, hold it along the gearbox, the shaft and the propeller shaft, afloat or
# laid level. From the front: output shaft of the gearbox, shafts, pinion of the axle.

title = "Readings of a driveline"

[driveline]
readings_deg = ["3.0 down", "6.8 down", "1.9 down"]   # or "87.0 from vertical down", "5.2 % down"
gauge_deg = 0.25               # how far each reading may be off
# feet_apart_mm = [350, 120]   # from the front to the rear feet of the gearbox or engine, and of
#                              # what bears the last shaft, 0 where there are none, as in a boat:
#                              # shims then have their thickness
teeth = 24                     # of the spline of the shaft; leave it out if there is none
# From one line along the vehicle to the gearbox end, the centre of each joint and the pinion end,
# and how long each shaft is. Both may be left out: then the driveline lies straight in plan.
offsets_mm = [0, 0, "40 left", "40 left"]
lengths_mm = [400, 1450, 300]

[load]
speed_rpm = 3000
output_torque_Nm = 400

[limits]
equivalent_bend_deg = 3
bend_difference_deg = 1
torsional_excitation_rad_s2 = 500

[output]
"""
            + _FILES,
            command="check",
        ),
        "shudder": Starter(
            "a light truck whose centre bearing in rubber shakes",
            _shown("shudder"),
            command="lateral",
        ),
        "recorded": Starter(
            "recorded drive angles and bends from a file",
            """\
# A recorded run: drive angle and bends of each sample from a file. {name}_run.csv is a made-up
# sample of a shaft whose driven end rises and falls; put your own in its place, as .csv, .parquet,
# .npz or .mf4, in the folder of this scene.

title = "Recorded run"

[angles]
file = "{name}_run.csv"
angle_column_deg = "crank_deg" # or angle_column_rad
# A column per joint, or bend_columns_rad; leave it out where the bends are fixed: bends_deg below.
bend_columns_deg = ["front_deg", "rear_deg"]

[driveline]
twists_deg = [180]             # input and output shaft stay parallel
phases_deg = [0]

[load]
speed_rpm = 1500
output_torque_Nm = 300

[output]
"""
            + _FILES,
            recorded=True,
        ),
        "ball-joint": Starter(
            "a ball in its seat under a load",
            """\
# A ball joint: how large must the ball be, and how is the pressure spread over the seat? Without
# radius_mm the smallest ball is found; round it up, enter it and run again: cardan run {name}.toml

title = "Ball joint under 20 kN"

[ball_joint]
load_N = 20000                 # towards the middle of the seat
# radius_mm = 16
half_angle_deg = 60            # from the middle of the seat to its edge; 90 is a hemisphere
clearance_mm = 0.01            # radius of the seat less that of the ball; 0 is a perfect fit
friction = 0.12
picture = "{name}.svg"

[ball_joint.ball]
name = "hardened steel"
allowable_pressure_MPa = 400   # take these pressures from your suppliers

[ball_joint.seat]
name = "lined with PTFE fabric"
allowable_pressure_MPa = 60
# How far the seat yields: by its layer, or measured as compliance_um_per_MPa.
layer_mm = 1.0
modulus_MPa = 2500
poisson = 0.4
""",
        ),
        **{
            kind: _machine(kind, meaning)
            for kind, meaning in (
                ("truck-shaft", "a truck's shaft with a centre bearing"),
                ("steering-column", "a steering column over its tilt"),
                ("pto-shaft", "the PTO shaft of a baler, straight and in a turn"),
                ("mill-spindle", "the spindle of a rolling mill"),
                ("test-rig", "the shaft between a motor and a dynamometer"),
                ("ship-shaft", "the shaft of a boat with its engine on soft mounts"),
            )
        },
    }
)
"""Starter scenes by the name of their kind."""


def write_starter(kind: str, path: str | PathLike[str]) -> list[Path]:
    """Write a starter scene, and beside it the recording that it reads; return the files.

    Nothing is overwritten, and nothing is left behind if a file cannot be written.
    """
    if kind not in STARTERS:
        raise ArgumentValueError("kind", f"is {kind!r}; known are {', '.join(STARTERS)}")
    target, starter = Path(path), STARTERS[kind]
    if target.suffix != ".toml" or '"' in target.name or not target.name.isprintable():
        raise ValueError(f"{fspath(path)} must be a file name that ends in .toml")
    texts = {target: starter.text.replace("{name}", target.stem)}
    if starter.recorded:
        texts[target.with_name(f"{target.stem}_run.csv")] = _recording()
    written: list[Path] = []
    try:
        for file, text in texts.items():
            # Mode x makes the file, or fails if there is one.
            with open(file, "x", encoding="utf-8") as opened:
                written.append(file)
                opened.write(text)
    except BaseException as error:
        for made in written:
            made.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            # A full disk shows when the text is written, where Python names no file.
            raise OSError(error.errno, error.strerror, fspath(file)) from error
        raise
    return written


def _recording() -> str:
    """Four turns in steps of 4 deg, the axle once up and down; equal bends, as in a Z shaft."""
    lines = ["crank_deg,front_deg,rear_deg"]
    for step in range(361):
        bend = 8.0 + 5.0 * math.sin(math.tau * step / 360.0)
        lines.append(f"{4 * step},{bend:.3f},{bend + 0.8:.3f}")
    return "\n".join(lines) + "\n"
