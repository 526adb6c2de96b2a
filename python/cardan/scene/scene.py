"""Scene files: a driveline, its load, the drive angles, a study and what to write, in TOML."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

import cardan.scene.format as scene_format
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.files.progress import Progress
from cardan.limits import Limits
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output
from cardan.result import Result
from cardan.scene.angles import Angles
from cardan.scene.axes import grid_of
from cardan.scene.ball_joint import BallJointCase, ball_joint_case
from cardan.scene.ball_joint_scene import BallJointScene, is_alone
from cardan.scene.bearings import LENGTHS, Mounting, lengths_of
from cardan.scene.document import Document, read_text
from cardan.scene.driven import ANGLE_OF, at_drive, check_driven
from cardan.scene.errors import SceneError
from cardan.scene.format import TEETH, describe
from cardan.scene.layout import Layout
from cardan.scene.optimise import Optimisation, optimisation_of
from cardan.scene.parts import (
    at_samples,
    check_load,
    check_not_recorded,
    filled,
    largest_speed,
    make_driveline,
    make_load,
    teeth_of,
)
from cardan.scene.recorded import Recording
from cardan.scene.reductions import LENGTH
from cardan.scene.requested import check_forces, check_sections, items, requested, to_reduce
from cardan.scene.signals import Signal
from cardan.scene.slip import Slip, slip_of
from cardan.scene.states import States, states_of, table_of, with_states
from cardan.scene.steering import SteeringColumn, steering_of
from cardan.scene.study import Study, StudyResult
from cardan.scene.tolerances import tolerances_of
from cardan.sweep import Sweep
from cardan.tolerances import Tolerances

_OPTIONS = ("axes", "tolerance", "dtype", "workers")

_CLOSED_FORMS = ("equivalent_bend", "non_uniformity", "max_angle_error")


@dataclass(frozen=True, eq=False)
class Scene:
    """A driveline, its load, the drive angles to evaluate and the files to write.

    Make one with ``load`` or ``parse``.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        line: the driveline; if its bends were recorded, a batch ``(samples,)``.
        load_case: its load, if any; what was recorded of it is ``(samples,)``.
        limits: what a check compares it with.
        drive_angle_deg: drive angles in degrees, ``(samples,)``.
        angle: the same to evaluate at: a sweep, or recorded angles in rad.
        quantities: outputs to evaluate.
        shafts: the shafts that the scene names; ``None`` for the last one only.
        joints: the joints that the scene names; ``None`` for all.
        teeth: of the spline of each intermediate shaft; empty if the scene gives none.
        options: further arguments of ``Driveline.evaluate``.
        study: what to vary and the figures wanted, if any; with [states] the figures of each.
        recording: file that the drive angles come from, if any.
        curves_file: name of the file for the curves, if any.
        table_file: name of the file for the table of the study, if any.
        picture_file: name of the file for the picture, if any.
        points: ends and joint centres as the scene gives them, ``(n + 2, 3)``, if it does.
        ball_joint: its ball joint, if any.
        slip: the spline of a shaft that changes its length, if the scene gives one.
        time: recorded times in s, ``(samples,)``, if any.
        signals: the extents of what was recorded besides angles and bends.
        layout: the keys that describe the driveline; ``None`` if its bends were recorded.
        states: the states that the scene lists, if it does. ``line`` is the driveline of
            [driveline], whether that is one of them or not.
        steering: what the scene says of its driveline as a steering column, if it is one.
        optimisation: what may change for the better, if the scene says so.
        tolerances: what errors of manufacture make of the driveline, if the scene gives any.
        driven_angle_deg: angles of the last shaft in degrees, ``(samples,)``, if the scene gives
            those in place of drive angles.
    """

    name: str
    title: str
    line: Driveline
    load_case: Load | None
    limits: Limits
    drive_angle_deg: FloatArray
    angle: FloatArray | Sweep
    quantities: tuple[str, ...]
    shafts: tuple[int, ...] | None
    joints: tuple[int, ...] | None
    teeth: tuple[int, ...]
    options: Mapping[str, Any]
    study: Study | None
    recording: Path | None
    curves_file: str | None
    table_file: str | None
    picture_file: str | None
    points: FloatArray | None = None
    ball_joint: BallJointCase | None = None
    slip: Slip | None = None
    time: FloatArray | None = None
    signals: tuple[Signal, ...] = ()
    layout: Layout | None = None
    states: States | None = None
    steering: SteeringColumn | None = None
    optimisation: Optimisation | None = None
    tolerances: Tolerances | None = None
    driven_angle_deg: FloatArray | None = None

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a scene file; paths in it are relative to its folder.

        Raises:
            ImportError: it names a file whose library is missing.
            OSError: the file cannot be read.
            ValueError: it is not a scene, or its recording cannot be read; one line with file, line
                where that is certain, section, key, rule and value.
        """
        return cls.parse(read_text(path), fspath(path), Path(path).parent)

    @classmethod
    def parse(cls, text: str, name: str = "scene", folder: str | PathLike[str] = ".") -> Self:
        """Make a scene from the text of a scene file.

        Args:
            text: TOML.
            name: its name in messages.
            folder: the folder to which paths in it are relative.

        Raises:
            ImportError: it names a file whose library is missing.
            ValueError: it is not a scene, or its recording cannot be read; one line with name, line
                where that is certain, section, key, rule and value.
        """
        return cls._of(Document(text, name), Path(folder))

    @classmethod
    def parts(cls, path: str | PathLike[str], rows: int) -> Iterator[tuple[Self, int]]:
        """Read a scene file whose recorded angles may not fit in memory.

        Args:
            path: the scene file.
            rows: largest number of angles at a time.

        Yields:
            the scene with the next angles, and the number of all.

        Raises:
            ImportError: pyarrow or the library for the recording is missing.
            OSError: the file cannot be read.
            ValueError: as for ``load``; no recording, no curves in a Parquet file; a key of which
                the value needs all angles.
        """
        document, folder = Document(read_text(path), fspath(path)), Path(path).parent
        recorded, output = (document.sections.get(key, {}) for key in ("angles", "output"))
        with document.within(""):
            if not recorded or document.sections.keys() & {"study", "states"}:
                raise ValueError(
                    "it must have a section [angles], no [study] and no [states] to be streamed"
                )
        with document.within("output"):
            if not str(output.get("curves", "")).endswith(".parquet"):
                raise ArgumentValueError(
                    "curves", "must name a .parquet file for a scene to be streamed"
                )
            for key in ("reduce", "closed_forms", "table", "picture"):
                if key in output:
                    raise ArgumentValueError(key, "does not go with streaming; it needs all angles")
        pieces = Recording(recorded, folder).pieces(rows)
        while True:
            with document.within("angles"):
                piece = next(pieces, None)
            if piece is None:
                return
            angle, total = piece
            yield cls._of(document, folder, angle), total

    @classmethod
    def validate(cls, path: str | PathLike[str]) -> list[str]:
        """Return the errors in a scene file, one line each; nothing if it is valid.

        All unknown keys and values of the wrong kind are found at once. Only if there are none,
        values that do not fit together are found.

        Raises:
            ImportError: it names a file whose library is missing.
            OSError: the file cannot be read.
        """
        try:
            document = Document(read_text(path), fspath(path), gather=True)
            if not document.problems:
                # Not gathered: values that do not fit together are found one by one.
                whole = Document(read_text(path), fspath(path))
                _ = BallJointScene.of(whole) if is_alone(whole) else cls.load(path)
        except ValueError as error:
            return [str(error)]
        return document.problems

    @staticmethod
    def schema() -> dict[str, Any]:
        """Return the JSON Schema of a scene file, for editors and other tools."""
        return scene_format.schema()

    @classmethod
    def _of(cls, document: Document, folder: Path, angle: Angles | None = None) -> Self:
        given = document.sections
        output, recorded = given.get("output", {}), given.get("angles", {})
        driveline, loaded = given.get("driveline", {}), given.get("load")
        with document.within(""):
            check_sections(document, alone=is_alone(document))
        with document.within("angles"):
            if recorded and angle is None:
                angle = Recording(recorded, folder).whole()
        with document.within("sweep"):
            angle = angle or Angles.swept(given.get("sweep", {}))
        with document.within("driveline"):
            own = (TEETH, *LENGTHS)
            described = {key: value for key, value in driveline.items() if key not in own}
            form, driveline = filled(described, angle.bends)
            line = make_driveline(form, driveline)
            teeth = teeth_of(given.get("driveline", {}), line.n_joints)
            mounting = Mounting(lengths=lengths_of(given.get("driveline", {}), line))
        for i, bearing in enumerate(document.tables.get("bearing", ())):
            with document.within(f"bearing.{i}"):
                mounting = mounting.and_bearing(bearing, line)
        line = mounting.on(line)
        for section in ("load", "study", "states"):
            with document.within(section):
                check_not_recorded(given.get(section, {}), angle.load)
        with document.within("load"):
            load, reduced_load = None, loaded
            if angle.load:
                loaded, reduced_load = (
                    {**(loaded or {}), **recorded_load}
                    for recorded_load in (angle.load, angle.load_to_reduce)
                )
            if loaded is not None:
                check_load(loaded, line.n_joints)
                load = make_load(loaded, {**given.get("study", {}), **given.get("states", {})})
        with document.within("output"):
            quantities = requested(output, loaded)
            shafts = items(output, "shafts", line.n_joints + 1)
            joints = items(output, "joints", line.n_joints)
            check_forces(quantities, line, load, joints)
            options = {key: output[key] for key in _OPTIONS if key in output}
            of_driven, driven_angle_deg = {}, None
            if output.get(ANGLE_OF) == "driven":
                check_driven(recorded)
                of_driven, driven_angle_deg = {ANGLE_OF: "driven"}, angle.degrees
                angle = at_drive(angle, line)
            if angle.bends is not None and "closed_forms" in output:
                raise ArgumentValueError("closed_forms", "do not go with recorded bends")
            wanted = given.keys() & {"study", "states"} | output.keys() & {"reduce", "closed_forms"}
            if LENGTH in output.get("closed_forms", ()) and "points" not in form.keys[0]:
                raise ArgumentValueError("closed_forms", "'length' needs points_mm or points_m")
            if "table" in output and output["table"] == output.get("curves"):
                raise ArgumentValueError(
                    "table", f"is {output['table']!r}; that is the file of the curves"
                )
            if "table" in output and not wanted:
                raise ArgumentValueError(
                    "table", "needs a section [study] or [states], reduce or closed_forms"
                )
        with document.within("slip"):
            slip = slip_of(given["slip"], line, driveline) if "slip" in given else None
        with document.within("steering"):
            if "steering" in given and angle.bends is not None:
                raise ValueError("it does not go with recorded bends, which differ by sample")
            column = steering_of(given["steering"]) if "steering" in given else None
        limits, tolerances = Limits(**given.get("limits", {})), None
        with document.within("tolerances"):
            if "tolerances" in given:
                speed = largest_speed(load)
                tolerances = tolerances_of(given["tolerances"], line, limits, load, speed)
        with document.within("ball_joint"):
            ball_joint = ball_joint_case(given["ball_joint"]) if "ball_joint" in given else None
        layout = None if angle.bends is not None else Layout(form, driveline, loaded, mounting)
        states = None
        with document.within("states"):
            if "states" in given:
                if layout is None:
                    raise ValueError("it does not go with recorded bends, which differ by sample")
                states = states_of(given["states"], layout)
        with document.within("optimise"):
            optimisation = optimisation_of(given.get("optimise"), layout, states, load, teeth)
        study = None
        with document.within("study"):
            varied = given.get("study", {})
            if varied and angle.bends is not None:
                raise ArgumentValueError(next(iter(varied)), "does not go with recorded bends")
            if wanted:
                default = () if angle.bends is not None else _CLOSED_FORMS
                reduced, caused = driveline, with_states(loaded, given.get("states", {}))
                if angle.bends_to_reduce is not None:
                    reduced = {**driveline, form.keys[0]: angle.bends_to_reduce}
                study = Study(
                    grid_of(
                        varied,
                        {**driveline, **_lengths(given)},
                        loaded,
                        document.tables.get("bearing", ()),
                    ),
                    form,
                    reduced,
                    reduced_load,
                    angle.to_reduce,
                    to_reduce(output, quantities, caused),
                    tuple(output.get("reduce", ("peak",))),
                    tuple(output.get("closed_forms", default)),
                    shafts,
                    tuple(range(line.n_joints)) if joints is None else joints,
                    {**options, **of_driven},
                    mounting,
                )
                # The ends of the grid, so that a value out of range shows before a long run.
                study.check_ends()
        return cls(
            name=document.name,
            title=given[""].get("title", ""),
            line=line,
            load_case=load,
            limits=limits,
            drive_angle_deg=angle.degrees,
            angle=angle.drive,
            quantities=quantities,
            shafts=shafts,
            joints=joints,
            teeth=teeth,
            options=options,
            study=study,
            recording=folder / recorded["file"] if recorded else None,
            curves_file=output.get("curves"),
            table_file=output.get("table"),
            picture_file=output.get("picture"),
            points=next(
                (np.array(value, float) for key, value in driveline.items() if "points" in key),
                None,
            ),
            ball_joint=ball_joint,
            slip=slip,
            time=angle.time,
            signals=angle.signals,
            layout=layout,
            states=states,
            steering=column,
            optimisation=optimisation,
            tolerances=tolerances,
            driven_angle_deg=driven_angle_deg,
        )

    @property
    def drive_angle(self) -> FloatArray:
        """Drive angles in rad, ``(samples,)``."""
        return np.asarray(self.angle)

    @property
    def missing(self) -> int:
        """Number of recorded samples that are missing; their results are NaN."""
        return 0 if self.recording is None else int(np.count_nonzero(np.isnan(self.drive_angle)))

    def without_missing(self) -> Self:
        """Return the scene without the recorded samples that are missing."""
        if not self.missing:
            return self
        known = ~np.isnan(self.drive_angle)
        line = self.line[known] if self.line.shape else self.line
        degrees, radians = self.drive_angle_deg[known], self.drive_angle[known]
        load = self.load_case and at_samples(self.load_case, known)
        time = None if self.time is None else self.time[known]
        driven = None if self.driven_angle_deg is None else self.driven_angle_deg[known]
        return replace(
            self,
            line=line,
            drive_angle_deg=degrees,
            angle=radians,
            load_case=load,
            time=time,
            driven_angle_deg=driven,
        )

    @property
    def speed(self) -> float:
        """Speed of the drive in rad/s, the largest one of a recording; 0 if it is not given."""
        return largest_speed(self.load_case)

    @property
    def speed_recorded(self) -> bool:
        """Whether the speed of the drive was recorded, or follows from what was."""
        return self.time is not None

    @property
    def accelerates(self) -> bool:
        """Whether the speed of the drive changes."""
        return self.load_case is not None and bool(np.any(self.load_case.acceleration != 0.0))

    def drivelines(self, changes: Mapping[str, ArrayLike] | None = None) -> Driveline:
        """Return the driveline in every state of the scene, or as a batch of one without [states].

        Args:
            changes: values by path, as for ``States.drivelines``.

        Raises:
            ValueError: as for ``States.drivelines``; bends that were recorded.
        """
        if self.states:
            return self.states.drivelines(changes)
        if self.layout is None:
            raise ValueError(f"{self.name}: the bends were recorded; they have no keys to change")
        return self.layout.drivelines(changes=changes)

    def in_state(self, state: int) -> Self:
        """Return the scene of one of its states alone, without [states]."""
        if self.states is None:
            raise ValueError(f"{self.name}: it has no section [states]")
        return replace(
            self,
            line=self.states.driveline(state),
            load_case=self.states.load(state),
            points=self.states.points(state),
            study=self.study and self.states.study(self.study, state),
            layout=None,
            states=None,
        )

    def run(self, progress: Progress | None = None) -> SceneResult:
        """Evaluate the scene and its study; writes nothing.

        Args:
            progress: called after each block of the study with the rows done and all rows.

        Raises:
            ValueError: a point of the study that makes no driveline; the message names it.
        """
        values = self.evaluate()
        try:
            study = table_of(self.states, self.study, progress)
        except ValueError as error:
            raise SceneError.of(error, self.name, "study") from None
        return SceneResult(self, values, study)

    def evaluate(self) -> Result:
        """Return the quantities over the drive angles, in the shapes of ``SceneResult.values``."""
        return self.line.evaluate(self.angle, self.quantities, **self._arguments())

    def plan(self) -> Any:  # noqa: ANN401 - what Driveline.plan returns
        """Return the plan of the scene's evaluation, as ``Driveline.plan`` does."""
        line: Any = self.line
        return line.plan(self.quantities, **self._arguments())

    def explain(self) -> str:
        """Describe how the curves over the drive angle and the study are evaluated."""
        curves: str = self.plan().explain(self.angle)
        if self.states and self.study:
            return f"{curves}\n\neach of {self.states.count} states:\n{self.study.explain()}"
        return f"{curves}\n\n{self.study.explain()}" if self.study else curves

    def _arguments(self) -> dict[str, Any]:
        return {
            "load": self.load_case,
            "shafts": None if self.shafts is None else list(self.shafts),
            "joints": None if self.joints is None else list(self.joints),
            **self.options,
        }


@dataclass(frozen=True, eq=False)
class SceneResult:
    """The results of a scene.

    Attributes:
        scene: the scene.
        values: its quantities in SI units by name, over the drive angles: ``(samples,)`` for the
            last shaft, ``(shafts, samples)`` for shafts that the scene names, ``(joints, samples,
            3)`` for the moments of the joints.
        study: the table of its study, if it has one; with [states] a ``StatesResult``.
    """

    scene: Scene
    values: Result
    study: StudyResult | None = None

    @property
    def drive_angle(self) -> FloatArray:
        """Drive angles in rad."""
        return self.scene.drive_angle

    def curves(self) -> Iterator[tuple[Output, int, FloatArray]]:
        """Yield every quantity of every shaft or joint: what, of which, ``(samples, [3])``."""
        joints = self.scene.line.n_joints
        shafts = self.scene.shafts
        items = {
            "shaft": (joints,) if shafts is None else shafts,
            "joint": range(joints) if self.scene.joints is None else self.scene.joints,
            "bearing": range(self.scene.line.n_bearings),
        }
        for name, values in self.values.items():
            output = OUTPUTS[name]
            single = output.per == "shaft" and shafts is None
            parts = [values] if single else values
            for item, part in zip(items[output.per], parts, strict=True):
                yield output, item, part


Scene.__doc__ = f"{Scene.__doc__}\n    The format of a scene file::\n\n" + textwrap.indent(
    describe(), " " * 8
)


def _lengths(given: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The lengths that a scene gives its shafts."""
    driveline = given.get("driveline", {})
    return {key: driveline[key] for key in LENGTHS if key in driveline}
