"""From the sections of a scene file to the attributes of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cardan.app.scene.language.document import Document
from cardan.app.scene.recording.angles import ANGLE_OF, Angles, at_drive, check_driven
from cardan.app.scene.recording.recorded import Recording
from cardan.app.scene.sections.ball_joint import ball_joint_case
from cardan.app.scene.sections.bearing import Mounting, lengths_of
from cardan.app.scene.sections.bearing_section import LENGTHS
from cardan.app.scene.sections.driveline import TEETH, Form
from cardan.app.scene.sections.joint_deviations import (
    arms_of,
    arms_of_lengths,
    check_as_built,
    deviations_of,
)
from cardan.app.scene.sections.output import (
    check_forces,
    check_sections,
    is_alone,
    items,
    requested,
    to_reduce,
)
from cardan.app.scene.sections.parts import (
    check_load,
    check_not_recorded,
    filled,
    make_driveline,
    make_load,
    teeth_of,
)
from cardan.app.scene.sections.service import known_arms, service_of
from cardan.app.scene.sections.slip import slip_of
from cardan.app.scene.sections.steering import steering_of
from cardan.app.scene.sections.table import OF_PARTS
from cardan.app.scene.sections.tolerances import ToleratedLine, tolerances_of
from cardan.app.scene.sections.torsion import torsion_of
from cardan.app.scene.study.axes import grid_of
from cardan.app.scene.study.layout import SceneLayout
from cardan.app.scene.study.reductions import LENGTH
from cardan.app.scene.study.states import states_of, with_states
from cardan.app.scene.study.study import Study
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.design.limits import OWN, Limit, Limits
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

_OPTIONS = ("axes", "tolerance", "dtype", "workers")

_CLOSED_FORMS = ("equivalent_bend", "non_uniformity", "max_angle_error")


@dataclass(frozen=True, eq=False)
class _Described:
    """A driveline with its bearings, and what the file says of it.

    Attributes:
        form: the form of the description.
        keys: values by key as the file has them, twists and phases that it leaves out as zeros.
        line: the driveline.
        teeth: of the spline of each intermediate shaft; empty if the file gives none.
        mounting: the bearings and the lengths of the shafts.
    """

    form: Form
    keys: dict[str, Any]
    line: Driveline
    teeth: tuple[int, ...]
    mounting: Mounting


@dataclass(frozen=True, eq=False)
class _Loaded:
    """The load, and the values of its keys for curves and to reduce; ``None`` without one."""

    load: Load | None
    keys: Mapping[str, Any] | None
    to_reduce: Mapping[str, Any] | None


@dataclass(frozen=True, eq=False)
class _Asked:
    """What the section [output] asks for.

    Attributes:
        angle: the drive angles, found from those of the driven shaft if the file gives these.
        quantities: outputs to evaluate.
        shafts: the shafts that the file names.
        joints: the joints that it names.
        options: further arguments of ``Driveline.evaluate``.
        of_driven: the argument that says so if angles are those of the driven shaft.
        driven_angle_deg: these angles in degrees.
    """

    angle: Angles
    quantities: tuple[str, ...]
    shafts: tuple[int, ...] | None
    joints: tuple[int, ...] | None
    options: dict[str, Any]
    of_driven: dict[str, Any]
    driven_angle_deg: FloatArray | None


def attributes_of(document: Document, folder: Path, angle: Angles | None) -> dict[str, Any]:
    """Return the attributes of the scene that a document describes, by name.

    Args:
        document: the file.
        folder: to which its paths are relative.
        angle: the next angles of a recording that is read in parts.

    Raises:
        ImportError: it names a file whose library is missing.
        ValueError: as of ``Scene.parse``.
    """
    given = document.sections
    with document.within(""):
        check_sections(document, alone=is_alone(document))
    angle = _angles(document, folder, angle)
    described = _described(document, angle)
    line = described.line
    for section in ("load", "study", "states"):
        with document.within(section):
            check_not_recorded(given.get(section, {}), angle.load)
    loaded = _loaded(document, angle, line)
    asked = _asked(document, angle, described, loaded)
    angle = asked.angle
    with document.within("slip"):
        slip = slip_of(given["slip"], line, described.keys) if "slip" in given else None
    with document.within("steering"):
        if "steering" in given and angle.bends is not None:
            raise ValueError("it does not go with recorded bends, which differ by sample")
        column = steering_of(given["steering"]) if "steering" in given else None
    own_limits = given.get("limits", {})
    limits = Limits(**{key: value for key, value in own_limits.items() if key not in OF_PARTS})
    with document.within("limits"):
        if "bearing_force_N" in own_limits and not line.n_bearings:
            raise ArgumentValueError("bearing_force_N", "needs a section [[bearing]]")
    with document.within("ball_joint"):
        ball_joint = ball_joint_case(given["ball_joint"]) if "ball_joint" in given else None
    layout = None
    if angle.bends is None:
        layout = SceneLayout(described.form, described.keys, loaded.keys, described.mounting)
    states = None
    with document.within("states"):
        if "states" in given:
            if layout is None:
                raise ValueError("it does not go with recorded bends, which differ by sample")
            states = states_of(given["states"], layout)
    service = service_of(document, folder, line, loaded.load, layout, states)
    joints, arms = given.get("joints", {}), known_arms(service.joints)
    with document.within("joints"):
        deviations = deviations_of(joints, line, given, arms_of(joints, line.n_joints, arms))
    if deviations is not None:
        with document.within("output"):
            check_as_built({**asked.options, **asked.of_driven})
    tolerances, tolerance_arms = None, {}
    with document.within("tolerances"):
        if "tolerances" in given:
            own = {"arm_mm": joints["arm_mm"]} if "arm_mm" in joints else {}
            values = {**own, **given["tolerances"]}
            built = ToleratedLine(line, deviations, arms_of(values, line.n_joints, arms))
            tolerances = tolerances_of(values, built, limits, loaded.load, states)
            tolerance_arms = arms_of_lengths(values, built.arms)
    torsion = None
    with document.within("torsion"):
        if "torsion" in given:
            torsion = torsion_of(given["torsion"], line, loaded.load, service.tubes)
    optimisation = None
    with document.within("optimise"):
        if "optimise" in given:
            from cardan.app.scene.sections.optimise import optimisation_of

            optimisation = optimisation_of(
                given["optimise"], layout, states, loaded.load, described.teeth
            )
    output, recorded = given.get("output", {}), given.get("angles", {})
    described_in = given.get("driveline", {})
    return {
        "name": document.name,
        "title": given[""].get("title", ""),
        "line": line,
        "load_case": loaded.load,
        "limits": limits,
        "part_limits": {
            key: Limit.given(value, own_limits.get("source", OWN))
            for key, value in own_limits.items()
            if key in OF_PARTS
        },
        "drive_angle_deg": angle.degrees,
        "angle": angle.drive,
        "quantities": asked.quantities,
        "shafts": asked.shafts,
        "joints": asked.joints,
        "teeth": described.teeth,
        "options": asked.options,
        "study": _study(document, described, loaded, asked, deviations),
        "recording": folder / recorded["file"] if recorded else None,
        "curves_file": output.get("curves"),
        "table_file": output.get("table"),
        "picture_file": output.get("picture"),
        "points": next(
            (np.array(value, float) for key, value in described.keys.items() if "points" in key),
            None,
        ),
        "ball_joint": ball_joint,
        "slip": slip,
        "time": angle.time,
        "signals": angle.signals,
        "layout": layout,
        "states": states,
        "steering": column,
        "optimisation": optimisation,
        "tolerances": tolerances,
        "driven_angle_deg": asked.driven_angle_deg,
        "service": service,
        "torsion": torsion,
        "deviations": deviations,
        "tolerance_arms": tolerance_arms,
        "tolerance_share": given.get("tolerances", {}).get("share"),
        "length_unit": "m" if {"points_m", "lengths_m"} & described_in.keys() else "mm",
    }


def _angles(document: Document, folder: Path, angle: Angles | None) -> Angles:
    recorded = document.sections.get("angles", {})
    with document.within("angles"):
        if recorded and angle is None:
            angle = Recording(recorded, folder).whole()
    with document.within("sweep"):
        return angle or Angles.swept(document.sections.get("sweep", {}))


def _described(document: Document, angle: Angles) -> _Described:
    given = document.sections.get("driveline", {})
    with document.within("driveline"):
        own = (TEETH, *LENGTHS)
        described = {key: value for key, value in given.items() if key not in own}
        form, keys = filled(described, angle.bends)
        line = make_driveline(form, keys)
        teeth = teeth_of(given, line.n_joints)
        mounting = Mounting(lengths=lengths_of(given, line))
    for i, bearing in enumerate(document.tables.get("bearing", ())):
        with document.within(f"bearing.{i}"):
            mounting = mounting.and_bearing(bearing, line)
    return _Described(form, keys, mounting.on(line), teeth, mounting)


def _loaded(document: Document, angle: Angles, line: Driveline) -> _Loaded:
    given = document.sections
    with document.within("load"):
        keys: Mapping[str, Any] | None = given.get("load")
        to_reduce = keys
        if angle.load:
            keys, to_reduce = (
                {**(keys or {}), **recorded} for recorded in (angle.load, angle.load_to_reduce)
            )
        if keys is None:
            return _Loaded(None, keys, to_reduce)
        check_load(keys, line.n_joints)
        load = make_load(keys, {**given.get("study", {}), **given.get("states", {})})
    return _Loaded(load, keys, to_reduce)


def _asked(document: Document, angle: Angles, described: _Described, loaded: _Loaded) -> _Asked:
    given, line = document.sections, described.line
    output = given.get("output", {})
    with document.within("output"):
        quantities = requested(output, loaded.keys)
        shafts = items(output, "shafts", line.n_joints + 1)
        joints = items(output, "joints", line.n_joints)
        check_forces(quantities, line, loaded.load, joints)
        options = {key: output[key] for key in _OPTIONS if key in output}
        of_driven, driven_angle_deg = {}, None
        if output.get(ANGLE_OF) == "driven":
            check_driven(given.get("angles", {}))
            of_driven, driven_angle_deg = {ANGLE_OF: "driven"}, angle.degrees
            angle = at_drive(angle, line)
        if angle.bends is not None and "closed_forms" in output:
            raise ArgumentValueError("closed_forms", "do not go with recorded bends")
        if LENGTH in output.get("closed_forms", ()) and "points" not in described.form.keys[0]:
            raise ArgumentValueError("closed_forms", "'length' needs points_mm or points_m")
        if "table" in output and output["table"] == output.get("curves"):
            raise ArgumentValueError(
                "table", f"is {output['table']!r}; that is the file of the curves"
            )
        if "table" in output and not _has_table(document):
            raise ArgumentValueError(
                "table", "needs a section [study] or [states], reduce or closed_forms"
            )
    return _Asked(angle, quantities, shafts, joints, options, of_driven, driven_angle_deg)


def _has_table(document: Document) -> bool:
    given = document.sections
    output = given.get("output", {})
    return bool(given.keys() & {"study", "states"} or output.keys() & {"reduce", "closed_forms"})


def _study(
    document: Document,
    described: _Described,
    loaded: _Loaded,
    asked: _Asked,
    deviations: FloatArray | None,
) -> Study | None:
    given, angle = document.sections, asked.angle
    output, varied = given.get("output", {}), given.get("study", {})
    with document.within("study"):
        if varied and angle.bends is not None:
            raise ArgumentValueError(next(iter(varied)), "does not go with recorded bends")
        if not _has_table(document):
            return None
        default = () if angle.bends is not None else _CLOSED_FORMS
        keys, caused = described.keys, with_states(loaded.keys, given.get("states", {}))
        if angle.bends_to_reduce is not None:
            keys = {**keys, described.form.keys[0]: angle.bends_to_reduce}
        driveline = given.get("driveline", {})
        lengths = {key: driveline[key] for key in LENGTHS if key in driveline}
        bearings = document.tables.get("bearing", ())
        all_joints = tuple(range(described.line.n_joints))
        study = Study(
            grid_of(varied, {**described.keys, **lengths}, loaded.keys, bearings),
            described.form,
            keys,
            loaded.to_reduce,
            angle.to_reduce,
            to_reduce(output, asked.quantities, caused),
            tuple(output.get("reduce", ("peak",))),
            tuple(output.get("closed_forms", default)),
            asked.shafts,
            all_joints if asked.joints is None else asked.joints,
            {**asked.options, **asked.of_driven},
            described.mounting,
            deviations,
        )
        # The ends of the grid, so that a value out of range shows before a long run.
        study.check_ends()
    return study
