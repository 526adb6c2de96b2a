"""The format of a scene file, written down once: sections, keys, help text and JSON Schema."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from numpy.typing import ArrayLike

import cardan.scene.values as kinds
from cardan.bearings import in_metres
from cardan.driveline import Driveline
from cardan.files import columns, pictures, recording
from cardan.limits import OWN, PRESETS
from cardan.outputs import OUTPUTS
from cardan.scene.axis_rules import Values
from cardan.scene.ball_joint import BALL_JOINT
from cardan.scene.bearing_section import BEARING, LENGTHS
from cardan.scene.joints import JOINTS
from cardan.scene.life_section import LIFE
from cardan.scene.optimise_section import OPTIMISE
from cardan.scene.paths import pattern_schemas
from cardan.scene.reductions import CLOSED_FORMS, REDUCTIONS
from cardan.scene.sections import Key, Section
from cardan.scene.slip import SLIP
from cardan.scene.steering import STEERING
from cardan.scene.tolerances import TOLERANCES
from cardan.scene.tubes_section import TUBES
from cardan.scene.units import RPM


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
        allowed = _only(*self.keys, *self.optional, TEETH, *lengths_too)
        needed: dict[str, Any] = {"required": list(self.keys)}
        if self.views:
            needed = {"anyOf": [{"required": [key]} for key in self.keys]}
        return {**needed, "properties": lengths, **allowed}


_BENDS, _TWISTS, _PHASES = "bends_deg", "twists_deg", "phases_deg"
TEETH = "teeth"
"""The key of a driveline that says in which steps its yokes can be set."""

BEND_COLUMNS = ("bend_columns_deg", "bend_columns_rad")
"""The keys for recorded bends; a scene uses at most one of them."""

ANGLE_COLUMNS = ("angle_column_deg", "angle_column_rad")
"""The keys for recorded drive angles; a scene uses at most one of them."""

SPEED_COLUMNS = ("speed_column_rpm", "speed_column_rad_s")
"""The keys for a recorded speed of the drive; a scene uses at most one of them."""

DRIVE_ANGLES = ("sweep", "angles")
"""The sections that give the drive angles; a scene has at most one of them."""

_SLOPES = ("slopes_vertical_deg", "slopes_horizontal_deg")
_PROJECTED = ("projected_bends_vertical_deg", "projected_bends_horizontal_deg")


def _from_points_in_mm(
    points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
) -> Driveline:
    """A driveline from points in mm; its lengths are in metres, so that forces are in newtons."""
    return in_metres(Driveline.from_points(points, phases, degrees=degrees), 1e-3)


FORMS = (
    Form(Driveline.from_bends, (_BENDS,), (_TWISTS, _PHASES), 0),
    Form(Driveline.from_points, ("points_m",), (_PHASES,), 2),
    Form(_from_points_in_mm, ("points_mm",), (_PHASES,), 2),
    Form(Driveline.from_directions, ("directions",), (_PHASES,), 1),
    Form(Driveline.from_slopes, _SLOPES, (_PHASES,), 1, views=True),
    Form(Driveline.from_projected_bends, _PROJECTED, (_PHASES,), 0, 2, views=True),
)
"""The ways to describe a driveline; a scene uses exactly one of them."""

_DRIVELINE = Section(
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

_LOAD = Section(
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


def _axis_of(kind: kinds.Kind) -> kinds.Kind:
    return {kinds.NUMBER: kinds.AXIS, kinds.VECTORS: kinds.COMPONENT_AXES}.get(kind, kinds.AXES)


def _varied(meaning: str, without: tuple[str, ...] = (TEETH, *LENGTHS)) -> dict[str, Key]:
    """The keys that a study or states may vary."""
    return {
        name: Key(_axis_of(key.kind), f"{meaning} this key of [{section}]")
        for section, part in (("driveline", _DRIVELINE), ("load", _LOAD))
        for name, key in part.keys.items()
        if name not in without
    }


OF_STATES: Mapping[str, Key] = {
    "names": Key(
        kinds.NAMES, "what each state is called; default: the value of the key, or state 0"
    ),
    "weights": Key(
        kinds.WEIGHTS, "how much each state counts when one setting must serve all; default 1"
    ),
}
"""The keys of [states] that do not vary the driveline."""

FORMAT: Mapping[str, Section] = MappingProxyType(
    {
        "": Section(
            "keys at the top level, before all sections",
            {"title": Key(kinds.TEXT, "heading of the table and the picture")},
        ),
        "driveline": _DRIVELINE,
        "bearing": BEARING,
        "load": _LOAD,
        "sweep": Section(
            "drive angles at equal steps, both ends included",
            {
                "turns": Key(kinds.POSITIVE, "turns of the drive", default=1),
                "samples_per_turn": Key(kinds.NATURAL, "steps per turn", default=720),
                "start_deg": Key(kinds.START, "first drive angle", default=0),
            },
        ),
        "angles": Section(
            "instead of [sweep]: recorded drive angles or speeds, one sample per row of a file",
            {
                "file": Key(
                    kinds.RECORDING,
                    "path from the folder of the scene; its name ends in "
                    + ", ".join(recording.SUFFIXES),
                ),
                "angle_column_deg": Key(kinds.TEXT, "name of the column in degrees"),
                "angle_column_rad": Key(kinds.TEXT, "or: of the column in radians"),
                "time_column_s": Key(
                    kinds.TEXT,
                    "name of the column of times; angles or speeds then make speed and "
                    "acceleration of the drive",
                ),
                "speed_column_rpm": Key(
                    kinds.TEXT, "name of the column of the drive's speed, integrated to the angle"
                ),
                "speed_column_rad_s": Key(kinds.TEXT, "or: the same in rad/s"),
                "torque_column_Nm": Key(
                    kinds.TEXT, "name of the column of the torque put into shaft 0"
                ),
                "start_deg": Key(
                    kinds.START, "with a speed: drive angle of the first sample", default=0
                ),
                "filter_reach": Key(
                    kinds.REACH,
                    "with times: samples on each side of the parabola that differentiates",
                    default=5,
                ),
                "raster_s": Key(
                    kinds.POSITIVE,
                    "of an MDF file with a speed: interpolate all channels at steps of so many "
                    "seconds; default: the channels have common times",
                ),
                "bend_columns_deg": Key(
                    kinds.COLUMNS,
                    "instead of bends_deg: one column per joint with its bend at each sample",
                ),
                "bend_columns_rad": Key(kinds.COLUMNS, "or: the same in radians"),
            },
            together=(
                ANGLE_COLUMNS,
                SPEED_COLUMNS,
                BEND_COLUMNS,
                *((key, angle) for key in ("start_deg", "raster_s") for angle in ANGLE_COLUMNS),
            ),
            needed=(("file",), (*ANGLE_COLUMNS, *SPEED_COLUMNS)),
            with_key=tuple((key, "time_column_s") for key in (*SPEED_COLUMNS, "filter_reach")),
        ),
        "limits": Section(
            "what check compares with; a figure is a number or [limit, maximum]: within up to the "
            "limit, tolerable up to the maximum, beyond above it",
            {
                "preset": Key(
                    kinds.PRESET,
                    f"limits of a kind of machine: {' or '.join(PRESETS)}; default: the limit of "
                    "the catalogues alone, an equivalent bend of 3 deg",
                ),
                "equivalent_bend_deg": Key(
                    kinds.BEND_LIMIT,
                    "bend of the joint that moves the last shaft as the driveline does",
                ),
                "bend_difference_deg": Key(
                    kinds.BEND_LIMIT, "difference of the bends of a driveline of two joints"
                ),
                "torsional_excitation_rad_s2": Key(
                    kinds.LIMIT, "largest acceleration of the last shaft"
                ),
                "inertia_excitation_rad_s2": Key(
                    kinds.LIMIT,
                    "second-order acceleration of all shafts between two joints together",
                ),
                "source": Key(kinds.SOURCE, "where your own figures come from", default=OWN),
            },
            fewest=1,
        ),
        "tolerances": TOLERANCES,
        "slip": SLIP,
        "steering": STEERING,
        "joints": JOINTS,
        "life": LIFE,
        "tubes": TUBES,
        "ball_joint": BALL_JOINT,
        "study": Section(
            "keys to vary; several keys make a grid, with one driveline per row of the table",
            _varied("values for", without=(TEETH,))
            | {
                "bearing": Key(
                    kinds.BEARING_AXES, "values for the position of a [[bearing]], by its number"
                )
            },
            together=(*_LOAD.together, LENGTHS),
            fewest=1,
        ),
        "states": Section(
            "positions in which the same driveline runs, such as ride heights: one value per state "
            "for each key",
            {**OF_STATES, **_varied("one value per state for")},
            together=_LOAD.together,
            fewest=1,
            paths=True,
        ),
        "optimise": OPTIMISE,
        "output": Section(
            "what to evaluate and which files to write",
            {
                "quantities": Key(
                    kinds.QUANTITIES,
                    f"from {', '.join(OUTPUTS)}; default: errors, ratios, and loads if any",
                ),
                "shafts": Key(kinds.INDICES, "shafts, counted from 0; default: the last"),
                "joints": Key(kinds.INDICES, "joints, counted from 0; default: all"),
                "reduce": Key(
                    kinds.REDUCED,
                    "for the table: each quantity over the drive angle reduced to "
                    f"{', '.join(REDUCTIONS)}; peak is the largest magnitude",
                ),
                "closed_forms": Key(
                    kinds.CLOSED,
                    "for the table: figures of the motion that need no samples, from "
                    + ", ".join(CLOSED_FORMS),
                ),
                "curves": Key(
                    kinds.CURVES_FILE,
                    "file for the quantities over the drive angle; its name ends in "
                    + ", ".join(columns.SUFFIXES),
                ),
                "table": Key(kinds.TABLE_FILE, "file for the table of the study; same endings"),
                "picture": Key(
                    kinds.PICTURE_FILE,
                    f"file for the picture; its name ends in {', '.join(pictures.SUFFIXES)}",
                ),
                "axes": Key(
                    kinds.VECTOR_AXES,
                    "of vectors: space, or shaft for axes that turn with the shaft on which they "
                    "act (x along it, y along its input-side pin); default: space",
                ),
                "angle_of": Key(
                    kinds.ANGLE_OF,
                    "the shaft whose angle [sweep] or [angles] gives: drive, or driven for the "
                    "last shaft, as an encoder at the output measures it; default: drive",
                ),
                "tolerance": Key(
                    kinds.TOLERANCE,
                    "permitted error, relative to the largest magnitude of each quantity; 0 for "
                    "every result within 1 ulp, for loads within 2; default: fast double precision",
                ),
                "dtype": Key(kinds.DTYPE, "float64 or float32; default: float64"),
                "workers": Key(
                    kinds.WORKERS,
                    "most threads to use, -1 for all cores; default: as many as are useful",
                ),
            },
        ),
    }
)
"""The format of a scene file: sections, their keys, and the meaning of each."""

_STUDY_HELP = """\
Give a key of [driveline], [load] or a [[bearing]] the value {from = …, to = …, steps = …} (both \
ends included) or a list of numbers. bends_deg varies all entries of a list alike, bends_deg.0 the \
first, and bends_deg.0-1 the first two. points_mm.2.y varies one coordinate of a point. The \
key bearing moves bearings: bearing.0.position_mm.\
"""

_PATHS_HELP = {
    "study": _STUDY_HELP,
    "states": "Give keys of [driveline] or [load] their values in each state, as in [study]; all "
    "lists have one entry per state. Paths may stand in quotes.",
}


def describe() -> str:
    """Return the format of a scene file as plain text, at most 77 characters wide."""
    lines = []
    for name, section in FORMAT.items():
        heading = f"{section.heading(name)}  " if name else ""
        lines += _filled(f"{heading}{section.meaning}", "", "  ")
        if name in _PATHS_HELP:
            lines += _filled(_PATHS_HELP[name], "  ", "  ")
            listed = OF_STATES if name == "states" else {}
        else:
            listed = section.keys
        for key, entry in listed.items():
            default = "" if entry.default is None else f"; default {entry.default}"
            text = f"{entry.kind.name}: {entry.meaning}{default}"
            lines += _filled(text, f"  {key:32}", " " * 36)
        lines.append("")
    return "\n".join(lines)


def _filled(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(
        text, width=77, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False
    )


def schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scene file, for editors and other tools.

    It covers single values, and keys that need or exclude each other. Matching lengths and files
    are checked by ``Scene.parse``.
    """
    top, *names = FORMAT
    sections = {name: _section_schema(FORMAT[name]) for name in names}
    recorded = {"anyOf": [{"required": [key]} for key in BEND_COLUMNS]}
    columns = {"properties": {"angles": recorded}, "required": ["angles"]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scene of a driveline or a ball joint",
        **_section_schema(FORMAT[top]),
        "properties": {**_properties(FORMAT[top]), **sections},
        "$defs": {"values": Values().definition},
        "allOf": [
            _not_both(*DRIVE_ANGLES),
            {
                "if": columns,
                "then": {"properties": {"driveline": _only(*FORMS[0].optional, TEETH, *LENGTHS)}},
                "else": {
                    "if": {"required": ["driveline"]},
                    "then": {
                        "properties": {"driveline": {"oneOf": [form.schema for form in FORMS]}}
                    },
                    "else": {"required": ["ball_joint"], **_only(*FORMAT[top].keys, "ball_joint")},
                },
            },
        ],
    }


def _section_schema(section: Section) -> dict[str, Any]:
    described: dict[str, Any] = {
        "type": "object",
        "properties": _properties(section),
        "additionalProperties": False,
    }
    if section.paths:
        described["patternProperties"] = pattern_schemas(section)
    if section.fewest:
        described["minProperties"] = section.fewest
    rules = [_not_both(*keys) for keys in section.together]
    rules += [{"anyOf": [{"required": [key]} for key in keys]} for keys in section.needed]
    if rules:
        described["allOf"] = rules
    if section.with_key:
        described["dependentRequired"] = {key: [part] for key, part in section.with_key}
    if section.repeated:
        described = {"type": "array", "items": described}
    return {"description": section.meaning, **described}


def _properties(section: Section) -> dict[str, Any]:
    return {
        name: {"description": key.meaning, **key.kind.rule.schema}
        | ({} if key.default is None else {"default": key.default})
        for name, key in section.keys.items()
    }


def _not_both(*keys: str) -> dict[str, Any]:
    return {"not": {"required": list(keys)}}


def _only(*keys: str) -> dict[str, Any]:
    return {"propertyNames": {"enum": list(keys)}}
