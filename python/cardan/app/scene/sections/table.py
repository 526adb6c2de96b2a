"""The format of a scene file, written down once: sections, keys, and the meaning of each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import cardan.app.scene.language.values as kinds
from cardan.app.files import columns, recording
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.sections.ball_joint import BALL_JOINT
from cardan.app.scene.sections.bearing_section import BEARING, LENGTHS
from cardan.app.scene.sections.driveline import DRIVELINE, LOAD, TEETH
from cardan.app.scene.sections.joints import JOINTS
from cardan.app.scene.sections.life_section import LIFE
from cardan.app.scene.sections.offsets import OFFSETS
from cardan.app.scene.sections.optimise_section import OPTIMISE
from cardan.app.scene.sections.slip import SLIP
from cardan.app.scene.sections.steering import STEERING
from cardan.app.scene.sections.tolerances_section import TOLERANCES
from cardan.app.scene.sections.torsion_section import TORSION
from cardan.app.scene.sections.tubes_section import TUBES
from cardan.app.scene.study.reductions import CLOSED_FORMS, REDUCTIONS
from cardan.design.limits import OWN, PRESETS
from cardan.evaluation.outputs import OUTPUTS

BEND_COLUMNS = ("bend_columns_deg", "bend_columns_rad")
"""The keys for recorded bends; a scene uses at most one of them."""

ANGLE_COLUMNS = ("angle_column_deg", "angle_column_rad")
"""The keys for recorded drive angles; a scene uses at most one of them."""

SPEED_COLUMNS = ("speed_column_rpm", "speed_column_rad_s")
"""The keys for a recorded speed of the drive; a scene uses at most one of them."""

DRIVE_ANGLES = ("sweep", "angles")
"""The sections that give the drive angles; a scene has at most one of them."""


def _axis_of(kind: kinds.Kind) -> kinds.Kind:
    return {kinds.NUMBER: kinds.AXIS, kinds.VECTORS: kinds.COMPONENT_AXES}.get(kind, kinds.AXES)


def _varied(meaning: str, without: tuple[str, ...] = (TEETH, *LENGTHS)) -> dict[str, Key]:
    """The keys that a study or states may vary."""
    return {
        name: Key(_axis_of(key.kind), f"{meaning} this key of [{section}]")
        for section, part in (("driveline", DRIVELINE), ("load", LOAD))
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

OF_PARTS: Mapping[str, Key] = {
    "bearing_force_N": Key(kinds.LIMIT, "largest force of a bearing over the turn"),
    "joint_force_N": Key(kinds.LIMIT, "largest force of a joint over the turn"),
    "lash_deg": Key(
        kinds.BEND_LIMIT, "angle by which the last shaft is loose while the drive is held"
    ),
}
"""The keys of [limits] on figures that a check of the motion does not have."""

FORMAT: Mapping[str, Section] = MappingProxyType(
    {
        "": Section(
            "keys at the top level, before all sections",
            {"title": Key(kinds.TEXT, "heading of the table and the picture")},
        ),
        "driveline": DRIVELINE,
        "bearing": BEARING,
        "load": LOAD,
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
                    + " or ".join(recording.SUFFIXES),
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
                **OF_PARTS,
                "source": Key(kinds.SOURCE, "where your own figures come from", default=OWN),
            },
            fewest=1,
        ),
        "tolerances": TOLERANCES,
        "slip": SLIP,
        "steering": STEERING,
        "joints": JOINTS,
        "offsets": OFFSETS,
        "life": LIFE,
        "tubes": TUBES,
        "torsion": TORSION,
        "ball_joint": BALL_JOINT,
        "study": Section(
            "keys to vary; several keys make a grid, with one driveline per row of the table",
            _varied("values for", without=(TEETH,))
            | {
                "bearing": Key(
                    kinds.BEARING_AXES, "values for the position of a [[bearing]], by its number"
                )
            },
            together=(*LOAD.together, LENGTHS),
            fewest=1,
        ),
        "states": Section(
            "positions in which the same driveline runs, such as ride heights: one value per state "
            "for each key",
            {**OF_STATES, **_varied("one value per state for")},
            together=LOAD.together,
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
                    + " or ".join(columns.SUFFIXES),
                ),
                "table": Key(kinds.TABLE_FILE, "file for the table of the study; same endings"),
                "picture": Key(
                    kinds.PICTURE_FILE,
                    f"file for the picture; its name ends in {' or '.join(columns.PICTURES)}",
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
