"""Scene files: a driveline, its load, the drive angles, a study and what to write, in TOML."""

from __future__ import annotations

import functools
import textwrap
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field, fields, replace
from importlib import import_module
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self, cast, get_args

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.files.recording import read_ahead
from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.document import Document, read_text
from cardan.app.scene.language.errors import Location, SceneError, as_file_has_it
from cardan.app.scene.language.rules import OneOf, Text
from cardan.app.scene.language.schema import describe, scene_schema
from cardan.app.scene.language.section import Key, Made, Section, made_of
from cardan.app.scene.language.units import ENDINGS, LengthUnit, System, si_key, split
from cardan.app.scene.recording.recorded import BEND_COLUMNS, Angles, Recording
from cardan.app.scene.recording.signals import Signal
from cardan.app.scene.sections.ball_joint import BALL_JOINT, BallJointCase, ball_joint_case
from cardan.app.scene.sections.bearing import BEARING
from cardan.app.scene.sections.driveline import DOUBLE_JOINT, DRIVELINE, READINGS
from cardan.app.scene.sections.joints import JOINTS, JointPlay, Joints
from cardan.app.scene.sections.lateral import LATERAL, LateralCase
from cardan.app.scene.sections.life import LIFE, DutyCycle
from cardan.app.scene.sections.limits import LIMITS, STEERING, SteeringColumn
from cardan.app.scene.sections.load import (
    ANGLES,
    DRIVE_ANGLES,
    LOAD,
    SWEEP,
    at_samples,
    largest_speed,
)
from cardan.app.scene.sections.optimise import OPTIMISE
from cardan.app.scene.sections.output import OUTPUT
from cardan.app.scene.sections.slip import OFFSETS, SLIP, AxisOffsets, Slip
from cardan.app.scene.sections.study import STATES, STUDY, with_columns
from cardan.app.scene.sections.tolerances import TOLERANCES
from cardan.app.scene.sections.torsion import TORSION, TorsionCase
from cardan.app.scene.sections.tubes import TUBES, Tubes
from cardan.app.scene.sections.wind_up import WIND_UP, WindUp
from cardan.app.scene.study.states import States, states_result
from cardan.app.scene.study.study import SceneLayout, Study, StudyResult
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.design.limits import Limit, Limits
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.evaluation.plan import Plan
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep
from cardan.tolerances import Tolerances

if TYPE_CHECKING:
    from cardan.app.scene.study.optimisation import Optimisation


@dataclass(frozen=True)
class Heading:
    """Keys before all sections."""

    title: str
    units: System


TOP: Section[Heading] = Section(
    "",
    "keys at the top level, before all sections",
    {
        "title": Key(Text(), "heading of the table and the picture"),
        "units": Key(
            OneOf(get_args(System)),
            "in which units answers are printed, drawn and written: si, or us for inches, pounds, "
            "lb·ft and psi. JSON is in SI units, which its keys name",
            default="si",
        ),
    },
    lambda values, _: heading_of(values),
    always=True,
)
"""The keys before all sections."""


def heading_of(values: Mapping[str, Any]) -> Heading:
    """Return what the keys before all sections say."""
    return Heading(values.get("title", ""), values.get("units", TOP.keys["units"].default))


class Reading:
    """A scene file being read: ``reading[TUBES]`` is what is made of its section [tubes].

    Each section is made once, when it is first asked for; errors name it.

    Attributes:
        document: the file.
        folder: to which its paths are relative.
        given: values by section and key, those from tables among them.
    """

    def __init__(self, document: Document, folder: Path, recorded: Angles | None = None) -> None:
        """Take a file, and the next angles of a recording that is read in parts."""
        self.document, self.folder, self.given = document, folder, dict(document.sections)
        self._made: dict[str, Any] = {} if recorded is None else {ANGLES.name: recorded}
        with document.within(""):
            self._check_sections()
        for section in (STUDY, STATES):
            if "file" in (values := self.given.get(section.name, {})):
                with document.within(section.name, "file"):
                    self.given[section.name] = with_columns(section, values, folder)

    def __getitem__(self, section: Section[Made]) -> Made:
        """Return what is made of a section."""
        if section.name not in self._made:
            made = None
            with self.document.within(section.name):
                if section.always or section.name in self.given:
                    made = self._make(section)
            self._made[section.name] = made
        return cast("Made", self._made[section.name])

    def _make(self, section: Section[Made]) -> Made:
        values = self.given.get(section.name, {})
        if not section.recorded_bends and self.line.shape:
            raise ValueError("it does not go with recorded bends, which differ by sample")
        return section.make(values, self)

    @property
    def line(self) -> Driveline:
        """The driveline of the drawing in its bearings, a batch if its bends were recorded."""
        return self[BEARING].line

    @property
    def load(self) -> Load | None:
        """The load, if there is one."""
        return self[LOAD].load

    @functools.cached_property
    def layout(self) -> SceneLayout | None:
        """How the file describes its driveline; ``None`` if its bends were recorded."""
        if self.line.shape:
            return None
        described = self[DRIVELINE]
        return SceneLayout(described.form, described.keys, self[LOAD].keys, self[BEARING].mounting)

    def check_unit(self, path: str, where: Location) -> None:
        """Refuse a path that changes a value in another unit than that in which it is given.

        The path is one of [study], [states] or [optimise], such as ``"points_mm.2.y"``.
        """
        key, *places = path.split(".")
        owners: list[tuple[Section[Any], str]] = [(own, own.name) for own in (DRIVELINE, LOAD)]
        if key == BEARING.name and len(places) == 2:
            key, owners = places[1], [(BEARING, f"{key}.{places[0]}")]
        for section, name in owners:
            given = self.document.given.get(name, {}).get(si_key(key), key)
            if given != key:
                unit = ENDINGS[split(key)[1]].name
                problem = f"is in {unit}, but {section.heading} gives {given}"
                raise where.error(f"{problem}; give both in the same unit")

    def _check_sections(self) -> None:
        """Refuse sections that are missing or do not go together."""
        given: Mapping[str, Mapping[str, Any]] = self.given
        if "driveline" not in given and not given.get("angles", {}).keys() & set(BEND_COLUMNS):
            instead = (
                "; a ball joint alone can be run, checked, plotted and reported "
                "(in Python: cardan.scene.load_scene)"
            )
            raise ValueError(
                "section [driveline] is missing; it describes the joints and shafts"
                + (instead if is_alone(self.document) else "")
            )
        if given.keys() >= {"study", "states"}:
            raise ValueError(
                "sections [study] and [states] are both given; a study varies the design, states "
                "are positions of one design: give one of them"
            )
        if given.keys() >= set(DRIVE_ANGLES):
            both = " and ".join(f"[{section}]" for section in DRIVE_ANGLES)
            raise ValueError(f"sections {both} are both given; give one of them")


def is_alone(document: Document) -> bool:
    """Whether a document describes a ball joint and no driveline."""
    given = document.sections
    return "ball_joint" in given and not given.keys() & {"driveline", "angles"}


@dataclass(frozen=True, eq=False)
class Scene:
    """A driveline, its load, the drive angles to evaluate and the files to write.

    Make one with ``load`` or ``parse``.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        units: in which its answers are printed, drawn and written.
        line: the driveline; if its bends were recorded, a batch ``(samples,)``.
        load_case: its load, if any; what was recorded of it is ``(samples,)``.
        limits: what a check compares its motion with.
        part_limits: limits of [limits] on other figures, by key and in its unit.
        drive_angle_deg: drive angles in degrees, ``(samples,)``.
        angle: the same to evaluate at: a sweep, or recorded angles in rad.
        quantities: outputs to evaluate.
        shafts: the shafts that the scene names; ``None`` for the last one only.
        joints: the joints that the scene names; ``None`` for all.
        teeth: of the spline of each intermediate shaft; empty if the scene gives none.
        options: further arguments of ``Driveline.evaluate``.
        study: what to vary and the figures wanted, if any; with [states] the figures of each.
        recording: file that the drive angles come from, if any.
        files: the files that it reads, by the section that names each.
        curves_file: name of the file for the curves, if any.
        table_file: name of the file for the table of the study, if any.
        picture_file: name of the file for the picture, if any.
        points: ends and joint centres as the scene gives them, ``(n + 2, 3)``, if it does.
        ball_joint: its ball joint, if any.
        slip: the spline of a shaft that changes its length, if the scene gives one.
        time: recorded times in s, ``(samples,)``, if any.
        signals: the extents of what was recorded besides angles and bends.
        layout: the keys that describe the driveline; ``None`` if its bends were recorded.
        states: the states that the scene lists, if any; ``line`` need not be one of them.
        wind_ups: parts that turn or move with the torque of the states.
        steering: what the scene says of its driveline as a steering column, if it is one.
        optimisation: keys that may change for the better, if the scene has any.
        tolerances: how manufacturing errors affect the driveline in its states, if any are given.
        driven_angle_deg: likewise of the last shaft, if the scene gives those instead.
        sizes: sizes and bearings of its joints, if the scene gives any.
        play: of the pins in their bearings, if the scene gives any.
        offsets: distances of axes that should meet, if the scene gives any.
        duty: the duty cycle: that of [life], or the load as its only step.
        tubes: the round sections of shafts, if the scene gives any.
        torsion: its shafts as torsion springs, if the scene says so.
        lateral: its shafts as beams on elastic bearings, if the scene says so.
        deviations: of the joints in rad, ``(n, 3)``, if any; ``line_as_built`` has them.
        tolerance_arms: arms of the joints in m by the groups whose tolerances are lengths.
        tolerance_share: share of drivelines that must be within the limit; ``None`` for all.
        gauge_deg: how far each reading of an inclinometer may be off, if the scene says so.
        feet_apart: distances in m between the feet at the drive's end and at the other, likewise.
        length_unit: ``"mm"`` or ``"m"``, in which the scene gives points or lengths.
        decimal_commas: line and text of lists that may have decimal commas.
        text: what the file says.
        given: by section, how the file names each key, in US units or not, by that in SI units.
    """

    name: str
    layout: SceneLayout | None
    title: str = made_of(TOP, "title")
    units: System = made_of(TOP, "units")
    teeth: tuple[int, ...] = made_of(DRIVELINE, "teeth")
    points: FloatArray | None = made_of(DRIVELINE, "points")
    length_unit: LengthUnit = made_of(DRIVELINE, "length_unit")
    gauge_deg: float | None = made_of(DRIVELINE, "gauge")
    feet_apart: tuple[float, ...] | None = made_of(DRIVELINE, "feet")
    line: Driveline = made_of(BEARING, "line")
    load_case: Load | None = made_of(LOAD, "load")
    angle: FloatArray | Sweep = made_of(SWEEP, "drive")
    drive_angle_deg: FloatArray = made_of(SWEEP, "degrees")
    driven_angle_deg: FloatArray | None = made_of(SWEEP, "driven")
    time: FloatArray | None = made_of(SWEEP, "time")
    signals: tuple[Signal, ...] = made_of(SWEEP, "signals")
    recording: Path | None = made_of(ANGLES, "file")
    limits: Limits = made_of(LIMITS, "motion")
    part_limits: Mapping[str, Limit] = made_of(LIMITS, "parts")
    tolerances: Tolerances | None = made_of(TOLERANCES, "tolerances")
    tolerance_arms: Mapping[str, FloatArray] = made_of(TOLERANCES, "arms")
    tolerance_share: float | None = made_of(TOLERANCES, "share")
    slip: Slip | None = made_of(SLIP)
    steering: SteeringColumn | None = made_of(STEERING)
    sizes: Joints | None = made_of(JOINTS, "sizes")
    play: JointPlay | None = made_of(JOINTS, "play")
    deviations: FloatArray | None = made_of(JOINTS, "deviations")
    offsets: AxisOffsets | None = made_of(OFFSETS)
    duty: DutyCycle | None = made_of(LIFE)
    tubes: Tubes | None = made_of(TUBES)
    torsion: TorsionCase | None = made_of(TORSION)
    lateral: LateralCase | None = made_of(LATERAL)
    ball_joint: BallJointCase | None = made_of(BALL_JOINT)
    study: Study | None = made_of(STUDY)
    states: States | None = made_of(STATES)
    wind_ups: tuple[WindUp, ...] = made_of(WIND_UP)
    optimisation: Optimisation | None = made_of(OPTIMISE)
    quantities: tuple[str, ...] = made_of(OUTPUT, "quantities")
    shafts: tuple[int, ...] | None = made_of(OUTPUT, "shafts")
    joints: tuple[int, ...] | None = made_of(OUTPUT, "joints")
    options: Mapping[str, Any] = made_of(OUTPUT, "options")
    curves_file: str | None = made_of(OUTPUT, "curves")
    table_file: str | None = made_of(OUTPUT, "table")
    picture_file: str | None = made_of(OUTPUT, "picture")
    files: Mapping[str, Path] = field(default_factory=dict)
    decimal_commas: tuple[tuple[int, str], ...] = ()
    text: str = field(default="", repr=False)
    given: Mapping[str, Mapping[str, str]] = field(default_factory=dict, repr=False)

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
            ImportError: as for ``load``.
            ValueError: as for ``load``; name stands for the file.
        """
        return cls._of(Document(text, name, FORMAT), Path(folder))

    @classmethod
    def parts(cls, path: str | PathLike[str], rows: int) -> Generator[tuple[Self, int]]:
        """Yield a scene with the next recorded angles, at most so many, and the number of all.

        Raises:
            ImportError: pyarrow or the library for the recording is missing.
            OSError: the file cannot be read.
            ValueError: as for ``load``; no recording, no curves in a Parquet file; a key of which
                the value needs all angles.
        """
        document, folder = Document(read_text(path), fspath(path), FORMAT), Path(path).parent
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
        with closing(read_ahead(Recording(recorded, folder).pieces(rows))) as pieces:
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
            ImportError: as for ``load``.
            OSError: the file cannot be read.
        """
        try:
            text, name = read_text(path), fspath(path)
            document = Document(text, name, FORMAT, gather=True)
            if not document.problems:
                # Not gathered: values that do not fit together are found one by one.
                whole = Document(text, name, FORMAT)
                _ = BallJointScene.of(whole) if is_alone(whole) else cls.load(path)
        except ValueError as error:
            return [str(error)]
        return document.problems

    @staticmethod
    def schema() -> dict[str, Any]:
        """Return the JSON Schema of a scene file, for editors and other tools."""
        return scene_schema(FORMAT)

    @classmethod
    def _of(cls, document: Document, folder: Path, angle: Angles | None = None) -> Self:
        reading = Reading(document, folder, angle)
        made: dict[str, Any] = {}
        for own in fields(cls):
            if section := own.metadata.get("section"):
                whole, attribute = reading[section], own.metadata["attribute"]
                made[own.name] = getattr(whole, attribute, None) if attribute else whole
        made |= {"decimal_commas": document.decimal_commas(), "text": document.text}
        made["files"] = {name: folder / file for name, file in document.files.items()}
        made["given"] = document.given
        return cls(document.name, reading.layout, **made)

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
        names = ("drive_angle_deg", "time", "driven_angle_deg")
        samples = {name: getattr(self, name) for name in names}
        return replace(
            self,
            line=self.line[known] if self.line.shape else self.line,
            angle=self.drive_angle[known],
            load_case=self.load_case and at_samples(self.load_case, known),
            **{name: own[known] for name, own in samples.items() if own is not None},
        )

    @property
    def is_measured(self) -> bool:
        """Whether the driveline is as an inclinometer has shown it."""
        return self.layout is not None and READINGS in self.layout.driveline

    @property
    def is_double(self) -> bool:
        """Whether joints 0 and 1 are a centred double joint, whose middle piece has no spline."""
        return self.layout is not None and DOUBLE_JOINT in self.layout.driveline

    @property
    def line_as_built(self) -> Driveline:
        """The driveline with the deviations of [joints]; that of the drawing if there are none."""
        if self.deviations is None:
            return self.line
        return self.line.with_deviations(*self.deviations.T)

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

        Changes and errors are those of ``States.drivelines``; recorded bends are a ``ValueError``.
        """
        if self.states:
            return self.states.drivelines(changes)
        if self.layout is None:
            raise ValueError(f"{self.name}: the bends were recorded; they have no keys to change")
        return self.layout.of(self.layout.values(changes=changes))

    def in_state(self, state: int) -> Self:
        """Return the scene of one of its states, counted from 0, without [states].

        Raises:
            IndexError: a state that does not exist.
            ValueError: the scene has no section [states].
        """
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
            tolerances=self.tolerances and self.tolerances.in_state(state),
        )

    def run(self, progress: Progress | None = None) -> SceneResult:
        """Evaluate the scene and its study; writes nothing.

        Args:
            progress: called after each block of the study with the rows done and all rows.

        Raises:
            ValueError: a point of the study that makes no driveline; the message names it.
        """
        values = self.evaluate()
        study: StudyResult | None = None
        try:
            if self.study and self.states:
                study = states_result(self.states, self.study, progress)
            elif self.study:
                study = self.study.run(progress)
        except ValueError as error:
            given = as_file_has_it(error, "study", self.given)
            raise SceneError(given, self.name, "study") from None
        return SceneResult(self, values, study)

    def evaluate(self) -> Result:
        """Return the quantities over the drive angles, in the shapes of ``SceneResult.values``."""
        return self.line_as_built.evaluate(self.angle, self.quantities, **self._arguments())

    def plan(self) -> Plan:
        """Return the plan of the scene's evaluation, as ``Driveline.plan`` does."""
        return self.line_as_built.plan(self.quantities, **self._arguments())

    def explain(self) -> str:
        """Describe how the curves over the drive angle and the study are evaluated."""
        curves = self.plan().explain(self.angle)
        if self.states and self.study:
            return f"{curves}\n\neach of {self.states.count} states:\n{self.study.explain()}"
        return f"{curves}\n\n{self.study.explain()}" if self.study else curves

    def _repr_html_(self) -> str | None:
        """Show a notebook the machine of the scene, which can be moved; ``None`` without one."""
        # Answers and pages are built upon scenes.
        answer = import_module("cardan.app.answers.answer").Answer(self)
        shown: str | None = answer._repr_html_()
        return shown

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


_SECTIONS = [own.metadata["section"] for own in fields(Scene) if "section" in own.metadata]

FORMAT: Mapping[str, Section[Any]] = MappingProxyType({own.name: own for own in _SECTIONS})
"""The sections of a scene file by name, in the order of the fields that are made of them."""

Scene.__doc__ = f"{Scene.__doc__}\n    The format of a scene file::\n\n" + textwrap.indent(
    describe(FORMAT), " " * 8
)


@dataclass(frozen=True, eq=False)
class BallJointScene:
    """A ball joint, its load and its materials.

    Make one with ``cardan.scene.load_scene`` or ``parse``.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        units: in which its answers are printed, drawn and written.
        ball_joint: the case.
    """

    name: str
    title: str
    units: System
    ball_joint: BallJointCase

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Self:
        """Make a scene from the text of a scene file.

        Args:
            text: TOML.
            name: its name in messages.

        Raises:
            ValueError: it is no scene of a ball joint alone; one line, as of ``Scene.load``.
        """
        return cls.of(Document(text, name, FORMAT))

    @classmethod
    def of(cls, document: Document) -> Self:
        """Make a scene from a document."""
        given = document.sections
        with document.within(""):
            if BALL_JOINT.name not in given:
                raise ValueError("section [ball_joint] is missing")
        for name in (*given, *document.tables):
            if name not in (TOP.name, BALL_JOINT.name):
                with document.within("", name):
                    raise ValueError(f"section {FORMAT[name].heading} needs a section [driveline]")
        with document.within(BALL_JOINT.name):
            case = ball_joint_case(given[BALL_JOINT.name])
        heading = heading_of(given[TOP.name])
        return cls(document.name, heading.title, heading.units, case)

    @property
    def picture_file(self) -> str | None:
        """Name of the file for the picture, if any."""
        return self.ball_joint.picture_file


def load_scene(path: str | PathLike[str]) -> Scene | BallJointScene:
    """Read a scene file of a driveline, with a ball joint or without, or of a ball joint alone.

    Raises:
        ImportError, OSError, ValueError: as for ``Scene.load``.
    """
    document = Document(read_text(path), fspath(path), FORMAT)
    if is_alone(document):
        return BallJointScene.of(document)
    return Scene._of(document, Path(path).parent)
