"""The section [output]: what to evaluate and which files to write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from cardan.app.files import columns
from cardan.app.scene.language.rules import INDICES, FileName, Number, OneOf, Whole, names
from cardan.app.scene.language.section import Key, Reading, Section, check_exists
from cardan.app.scene.sections.driveline import DRIVELINE, LENGTHS_NEEDED, has_lengths
from cardan.app.scene.sections.joints import JOINTS
from cardan.app.scene.sections.load import LOAD
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.reductions import REDUCTIONS

CLOSED_FORMS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "equivalent_bend": ("bend", "rad"),
        "angle_offset": ("angle_offset", "rad"),
        "k": ("k", "1"),
        "non_uniformity": ("non_uniformity", "1"),
        "max_angle_error": ("max_angle_error", "rad"),
        "min_speed_ratio": ("min_speed_ratio", "1"),
        "max_speed_ratio": ("max_speed_ratio", "1"),
        "max_acceleration_ratio": ("max_acceleration_ratio", "1"),
        "length": ("", "m"),
    }
)
"""Figures of a shaft that need no samples: field of ``EquivalentJoint`` and SI unit.

The length is none of its motion; it has the unit of the points.
"""

LENGTH = "length"

_OPTIONS = ("axes", "tolerance", "dtype", "workers")


@dataclass(frozen=True, eq=False)
class Asked:
    """What to evaluate, with further arguments for it, and which files to write, if any.

    Without shafts it is of the last one only, without joints of all.
    """

    quantities: tuple[str, ...]
    shafts: tuple[int, ...] | None
    joints: tuple[int, ...] | None
    options: dict[str, Any]
    curves: str | None
    table: str | None
    picture: str | None


def _asked(values: Mapping[str, Any], scene: Reading) -> Asked:
    n = scene.line.n_joints
    asked = Asked(
        _quantities(values, scene),
        _items(values, "shafts", n + 1),
        _items(values, "joints", n),
        {key: values[key] for key in _OPTIONS if key in values},
        values.get("curves"),
        values.get("table"),
        values.get("picture"),
    )
    _check_forces(asked, scene)
    if values.get("angle_of") == "driven" and "time_column_s" in scene.given.get("angles", {}):
        raise ArgumentValueError(
            "angle_of",
            "is 'driven'; with time_column_s, speed and acceleration of the drive follow from "
            "angles of the drive",
        )
    closed_forms = values.get("closed_forms", ())
    if closed_forms and scene.line.shape:
        raise ArgumentValueError("closed_forms", "do not go with recorded bends")
    if LENGTH in closed_forms and scene[DRIVELINE].points is None:
        raise ArgumentValueError("closed_forms", "'length' needs points_mm or points_m")
    if asked.table and asked.table == asked.curves:
        raise ArgumentValueError("table", f"is {asked.table!r}; that is the file of the curves")
    if asked.table and not has_table(scene):
        raise ArgumentValueError(
            "table", "needs a section [study] or [states], reduce or closed_forms"
        )
    if scene[JOINTS].deviations is not None:
        for key, ideal in (("axes", "space"), ("angle_of", "drive")):
            if values.get(key, ideal) != ideal:
                problem = f"is {values[key]!r}; joints with deviations have {ideal!r} only"
                raise ArgumentValueError(key, problem)
    return asked


def has_table(scene: Reading) -> bool:
    """Whether a scene asks for the table of a study, if only of one driveline."""
    output = scene.given.get(OUTPUT.name, {})
    sections = scene.given.keys() & {"study", "states"}
    return bool(sections or output.keys() & {"reduce", "closed_forms"})


def caused(load: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Return the quantities that the keys of a load cause."""
    loaded = load is not None and any("torque" in key or "inertia" in key for key in load)
    return ("torque", "moment") if loaded else ()


def _quantities(values: Mapping[str, Any], scene: Reading) -> tuple[str, ...]:
    load = scene[LOAD].keys
    if "quantities" not in values:
        return ("angle_error", "speed_ratio", "acceleration_ratio", *caused(load))
    for i, name in enumerate(values["quantities"]):
        if load is None and OUTPUTS[name].needs_load:
            raise ArgumentValueError("quantities", f"is {name!r}; it needs a section [load]", (i,))
    return tuple(values["quantities"])


def _items(values: Mapping[str, Any], key: str, count: int) -> tuple[int, ...] | None:
    """The shafts or joints that a scene names, ``None`` where it names none."""
    for i, item in enumerate(values.get(key, ())):
        check_exists(key, item, count, (i,))
    return tuple(values[key]) if key in values else None


def _check_forces(asked: Asked, scene: Reading) -> None:
    """Refuse forces that the driveline does not determine."""
    joints = None if asked.joints is None else list(asked.joints)
    for i, name in enumerate(asked.quantities):
        if OUTPUTS[name].unit != "N":
            continue
        if not has_lengths(scene.line):
            raise ArgumentValueError("quantities", f"is {name!r}; it needs {LENGTHS_NEEDED}", (i,))
        try:
            scene.line.plan(name, load=scene.load, joints=joints)
        except ArgumentValueError as error:
            raise ArgumentValueError("quantities", error.problem, (i,)) from None


OUTPUT: Section[Asked] = Section(
    "output",
    "what to evaluate and which files to write",
    {
        "quantities": Key(
            names(OUTPUTS), f"from {', '.join(OUTPUTS)}; default: errors, ratios, and loads if any"
        ),
        "shafts": Key(INDICES, "shafts, counted from 0; default: the last"),
        "joints": Key(INDICES, "joints, counted from 0; default: all"),
        "reduce": Key(
            names(REDUCTIONS),
            "for the table: each quantity over the drive angle reduced to "
            f"{', '.join(REDUCTIONS)}; peak is the largest magnitude",
        ),
        "closed_forms": Key(
            names(CLOSED_FORMS),
            "for the table: figures of the motion that need no samples, from "
            + ", ".join(CLOSED_FORMS),
        ),
        "curves": Key(
            FileName(columns.SUFFIXES),
            "file for the quantities over the drive angle; its name ends in "
            + " or ".join(columns.SUFFIXES),
            kind="curves file",
        ),
        "table": Key(
            FileName(columns.SUFFIXES),
            "file for the table of the study; same endings",
            kind="table file",
        ),
        "picture": Key(
            FileName(columns.PICTURES),
            f"file for the picture; its name ends in {' or '.join(columns.PICTURES)}",
            kind="picture file",
        ),
        "axes": Key(
            OneOf(("space", "shaft")),
            "of vectors: space, or shaft for axes that turn with the shaft on which they "
            "act (x along it, y along its input-side pin); default: space",
        ),
        "angle_of": Key(
            OneOf(("drive", "driven")),
            "the shaft whose angle [sweep] or [angles] gives: drive, or driven for the "
            "last shaft, as an encoder at the output measures it; default: drive",
        ),
        "tolerance": Key(
            Number(0, 1, below=True),
            "permitted error, relative to the largest magnitude of each quantity; 0 for "
            "every result within 1 ulp, for loads within 2; default: fast double precision",
        ),
        "dtype": Key(OneOf(("float64", "float32")), "float64 or float32; default: float64"),
        "workers": Key(
            Whole(1, also=-1),
            "most threads to use, -1 for all cores; default: as many as are useful",
        ),
    },
    _asked,
    always=True,
)
