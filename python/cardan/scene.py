"""Scene files: a driveline, its load, a sweep of the drive and what to write, in TOML."""

from __future__ import annotations

import math
import re
import textwrap
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, Self

import numpy as np

from cardan import curves, plots
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.load import Load
from cardan.outputs import OUTPUTS, nearest
from cardan.result import Result

Kind = Literal[
    "text",
    "number",
    "positive number",
    "whole number",
    "numbers",
    "slopes",
    "vectors",
    "quantities",
    "curves file",
    "picture file",
]


@dataclass(frozen=True)
class Key:
    """One key of a scene file.

    Attributes:
        kind: what its value must be.
        meaning: one line.
        argument: the parameter of the constructor that it sets.
        factor: what to multiply the value by to get that parameter's unit.
        default: the value where the key is left out.
    """

    kind: Kind
    meaning: str
    argument: str = ""
    factor: float = 1.0
    default: Any = None


@dataclass(frozen=True)
class Section:
    """One section of a scene file."""

    meaning: str
    keys: Mapping[str, Key]


@dataclass(frozen=True)
class Form:
    """One way to describe a driveline: the keys that it needs and those that may go with it.

    Attributes:
        make: the constructor that the keys' arguments belong to.
        keys: needed, all of one length.
        optional: may go with them.
        ends: how many entries the needed keys have beyond one per joint.
    """

    make: Callable[..., Driveline]
    keys: tuple[str, ...]
    optional: tuple[str, ...]
    ends: int


_BENDS, _TWISTS, _PHASES = "bends_deg", "twists_deg", "phases_deg"
_SLOPES = ("slopes_vertical_deg", "slopes_horizontal_deg")
_PROJECTED = ("projected_bends_vertical_deg", "projected_bends_horizontal_deg")

FORMS = (
    Form(Driveline.from_bends, (_BENDS,), (_TWISTS, _PHASES), 0),
    Form(Driveline.from_points, ("points_m",), (_PHASES,), 2),
    Form(Driveline.from_points, ("points_mm",), (_PHASES,), 2),
    Form(Driveline.from_directions, ("directions",), (_PHASES,), 1),
    Form(Driveline.from_slopes, _SLOPES, (_PHASES,), 1),
    Form(Driveline.from_projected_bends, _PROJECTED, (_PHASES,), 0),
)
"""The ways to describe a driveline, of which a scene uses exactly one."""

FORMAT: Mapping[str, Section] = MappingProxyType(
    {
        "": Section(
            "above all sections",
            {"title": Key("text", "heading of the table and the picture")},
        ),
        "driveline": Section(
            "joints and shafts, described in exactly one way; needed",
            {
                "bends_deg": Key("numbers", "bend of each joint, in [0, 90)", "bends"),
                "twists_deg": Key(
                    "numbers",
                    "with bends_deg: angle from bend plane to bend plane about each shaft between "
                    "two joints; default 0",
                    "twists",
                ),
                "points_m": Key("vectors", "driving end, joint centres, driven end", "points"),
                "points_mm": Key("vectors", "the same in mm", "points"),
                "directions": Key("vectors", "along each shaft, any length", "directions"),
                "slopes_vertical_deg": Key(
                    "slopes", "slope of each shaft in side view, up positive", "vertical"
                ),
                "slopes_horizontal_deg": Key(
                    "slopes", "slope of each shaft in top view, right positive", "horizontal"
                ),
                "projected_bends_vertical_deg": Key(
                    "slopes", "bends of two joints in side view, from the common shaft", "vertical"
                ),
                "projected_bends_horizontal_deg": Key(
                    "slopes", "bends of two joints in top view, from the common shaft", "horizontal"
                ),
                "phases_deg": Key(
                    "numbers",
                    "turn of the output-side fork against the input-side one on each shaft between "
                    "two joints; default 0",
                    "phases",
                ),
            },
        ),
        "load": Section(
            "speed, torque and inertias",
            {
                "speed_rpm": Key("number", "speed of the drive", "speed", math.tau / 60.0),
                "speed_rad_s": Key("number", "the same in rad/s", "speed"),
                "acceleration_rad_s2": Key("number", "acceleration of the drive", "acceleration"),
                "drive_torque_Nm": Key("number", "torque put into shaft 0", "drive_torque"),
                "output_torque_Nm": Key(
                    "number", "or: torque delivered by the last shaft", "output_torque"
                ),
                "inertias_kgm2": Key(
                    "numbers", "moment of inertia of each shaft about its axis", "inertias"
                ),
            },
        ),
        "sweep": Section(
            "drive angles, both ends included",
            {
                "turns": Key("positive number", "turns of the drive; default 1", default=1.0),
                "samples_per_turn": Key("whole number", "steps per turn; default 720", default=720),
                "start_deg": Key("number", "first drive angle; default 0", default=0.0),
            },
        ),
        "output": Section(
            "files to write",
            {
                "curves": Key("curves file", f"name of a {', '.join(curves.SUFFIXES)} file"),
                "picture": Key("picture file", f"name of a {', '.join(plots.SUFFIXES)} file"),
                "quantities": Key(
                    "quantities",
                    f"from {', '.join(OUTPUTS)}; default: errors, ratios and what the load causes",
                ),
            },
        ),
    }
)
"""The format of a scene file: sections, their keys, what these hold and mean."""

MOST_SAMPLES = 10_000_000


@dataclass(frozen=True, eq=False)
class Scene:
    """A driveline, its load, the drive angles to evaluate and the files to write.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        line: the driveline.
        load: its load, if any.
        drive_angle_deg: drive angles in degrees.
        quantities: outputs to evaluate, for the last shaft and all joints.
        curves: name of the file for the curves, if any.
        picture: name of the file for the picture, if any.
    """

    name: str
    title: str
    line: Driveline
    load: Load | None
    drive_angle_deg: FloatArray
    quantities: tuple[str, ...]
    curves: str | None
    picture: str | None

    @classmethod
    def load_file(cls, path: str | PathLike[str]) -> Self:
        raise NotImplementedError
