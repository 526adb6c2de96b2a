"""The kinds of values in a scene file: what each is called, and its rule."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from cardan import tolerances
from cardan.app.files import columns, recording
from cardan.app.scene.language.rules import (
    FileName,
    ListOf,
    Number,
    OneOf,
    OneOrEach,
    OneOrMore,
    Rule,
    Text,
    Whole,
)
from cardan.app.scene.sections.limits import LimitRule, Preset, QuantityName, Source
from cardan.app.scene.sections.material_rules import MaterialRule
from cardan.app.scene.sections.optimise_rules import Keep, Vary
from cardan.app.scene.sections.torsion_rules import EndInertias, ShaftStiffness, SpeedValues
from cardan.app.scene.study.axis_rules import AxisValues, BearingAxes, ListAxes, VectorAxes
from cardan.app.scene.study.reductions import CLOSED_FORMS, REDUCTIONS
from cardan.evaluation.outputs import OUTPUTS
from cardan.wear.axial_travel import NAMES as SLIDE_NAMES


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of value.

    Attributes:
        name: what to call it.
        rule: reads a value and describes itself as JSON Schema.
    """

    name: str
    rule: Rule


def _names(known: Iterable[str]) -> ListOf:
    return ListOf(OneOf(tuple(known)), "names", distinct=True)


_BEND = Number(0, 90, below=True, what="a bend", unit="deg")
_SLOPE = Number(-90, 90, above=True, below=True)
_INERTIA = Number(0, what="an inertia")
_VECTOR = ListOf(Number(), "three numbers", count=3)

TEXT = Kind("text", Text())
NUMBER = Kind("number", Number())
POSITIVE = Kind("positive number", Number(0, above=True))
# As far as sweeps go, and small enough for their steps to be told apart.
OFFSET = Kind("number", Number(0, 45, above=True, unit="deg"))
START = Kind("number", Number(-1e12, 1e12))
# With one on each side, the first and the last sample would be those of no parabola.
REACH = Kind("whole number", Whole(2, most=1000))
NATURAL = Kind("whole number", Whole(1))
POSITION = Kind("number", Number(0))
LENGTHS = Kind("positive numbers", ListOf(Number(0, above=True), "numbers"))
WEIGHTS = Kind("numbers", ListOf(Number(0, what="a weight"), "numbers"))
NAMES = Kind("texts", ListOf(Text(), "texts", distinct=True))
NUMBERS = Kind("number or numbers", OneOrMore(ListOf(Number(), "numbers"), (int, float)))
BENDS = Kind("number or numbers", OneOrMore(ListOf(_BEND, "numbers"), (int, float)))
TOTAL_BEND = Kind(
    "number",
    OneOrMore(
        ListOf(Number(0, 180, below=True, what="a total bend", unit="deg"), "one number", count=1),
        (int, float),
    ),
)
SYNCHRONOUS = Kind(
    "number",
    OneOrMore(ListOf(Number(0, 120, below=True, unit="deg"), "one number", count=1), (int, float)),
)
DISTANCE = Kind(
    "positive number", OneOrMore(ListOf(Number(1e-3, 1e6), "one number", count=1), (int, float))
)
SLOPES = Kind("slopes", ListOf(_SLOPE, "numbers"))
INERTIAS = Kind("numbers", ListOf(_INERTIA, "numbers"))
VECTORS = Kind("vectors", ListOf(_VECTOR, "vectors [x, y, z]"))
QUANTITIES = Kind("name or names", OneOrMore(_names(OUTPUTS)))
CLOSED = Kind("name or names", OneOrMore(_names(CLOSED_FORMS)))
REDUCED = Kind("name or names", OneOrMore(_names(REDUCTIONS)))
TEETH = Kind("whole number(s)", OneOrEach(ListOf(Whole(1, most=1000), "whole numbers")))
TOLERANCES = Kind("number(s)", OneOrEach(ListOf(Number(0), "numbers")))
TOLERANCED = Kind(
    "name or names", OneOrMore(ListOf(QuantityName(outputs=True), "names", distinct=True))
)
WORST_REDUCED = Kind("name", OneOf(tolerances.REDUCTIONS))
DISTRIBUTION = Kind("name", OneOf(("uniform", "normal")))
SAMPLES = Kind("whole number", Whole(1, most=100_000_000))
SEED = Kind("whole number", Whole(0, most=(1 << 32) - 1))
INDICES = Kind("whole numbers", ListOf(Whole(0), "whole numbers", distinct=True))
SHARE = Kind("number", Number(0, 1, above=True))
TOLERANCE = Kind("number", Number(0, 1, below=True))
ANGLE_OF = Kind("name", OneOf(("drive", "driven")))
VECTOR_AXES = Kind("name", OneOf(("space", "shaft")))
DTYPE = Kind("name", OneOf(("float64", "float32")))
WORKERS = Kind("whole number", Whole(1, also=-1))
CURVES_FILE = Kind("curves file", FileName(columns.SUFFIXES))
TABLE_FILE = Kind("table file", FileName(columns.SUFFIXES))
PICTURE_FILE = Kind("picture file", FileName(columns.PICTURES))
RECORDING = Kind("file", FileName(recording.SUFFIXES, folders=True))
COLUMNS = Kind("texts", ListOf(Text(), "texts", distinct=True))
AXIS = Kind("values", AxisValues())
AXES = Kind("values", ListAxes())
SOURCE = Kind("text", Source())
PRESET = Kind("name", Preset())
BEND_LIMIT = Kind("limit", LimitRule(Number(0, 90, above=True, below=True, unit="deg")))
LIMIT = Kind("limit", LimitRule(Number(0, above=True)))
SHAFT = Kind("whole number", Whole(0))
FORCE = Kind("positive number", Number(1e-6, 1e12))
BALL_RADIUS = Kind("positive number", Number(1e-3, 1e6))
CLEARANCE = Kind("number", Number(0, 1e6))
SEAT_ANGLE = Kind("number", Number(0.1, 90, unit="deg"))
FRICTION = Kind("number", Number(0, 10))
MATERIAL = Kind("material", MaterialRule())
COMPONENT_AXES = Kind("values", VectorAxes())
RANGES = Kind("ranges", Vary())
MINIMISED = Kind("name", QuantityName())
OVER = Kind("name", OneOf(("largest", "rms")))
KEPT = Kind("limits", Keep())
POSITIVES = Kind("number(s)", OneOrEach(ListOf(Number(0, above=True), "numbers")))
RADII = Kind("number(s)", OneOrEach(ListOf(Number(1e-3, 1e6), "numbers")))
FRICTIONS = Kind("number(s)", OneOrEach(ListOf(Number(0, 10), "numbers")))
SEALS = Kind("number(s)", OneOrEach(ListOf(Number(0), "numbers")))
MOST_BENDS = Kind(
    "number(s)", OneOrEach(ListOf(Number(0, 90, above=True, below=True, unit="deg"), "numbers"))
)
DEVIATIONS = Kind(
    "number(s)",
    OneOrEach(ListOf(Number(-90, 90, above=True, below=True, unit="deg"), "numbers")),
)
BEARING_TYPES = Kind("name(s)", OneOrEach(ListOf(OneOf(("needle", "plain")), "names")))
TORQUES = Kind("number(s)", OneOrEach(ListOf(Number(), "numbers")))
STEP_BENDS = Kind(
    "numbers", ListOf(OneOrEach(ListOf(_BEND, "numbers")), "bends, one entry per step")
)
DISTANCES = Kind("number(s)", OneOrEach(ListOf(Number(-1e3, 1e3, unit="mm"), "numbers")))
SLIDES = Kind("name or names", OneOrMore(_names(SLIDE_NAMES)))
SIZES_FILE = Kind("file", FileName((".csv",), folders=True))
SIZE_NAMES = Kind("text(s)", OneOrEach(ListOf(Text(), "texts")))
STATE_NAMES = Kind("texts", ListOf(Text(), "texts"))
END_INERTIAS = Kind("inertias", ListOf(EndInertias(), "inertias"))
STIFFNESSES = Kind("stiffnesses", ListOf(ShaftStiffness(), "stiffnesses"))
DAMPING_RATIOS = Kind("number(s)", OneOrEach(ListOf(Number(0, 100, what="a ratio"), "numbers")))
DAMPINGS = Kind("numbers", ListOf(Number(0, 1e9, what="a damping"), "numbers"))
LOAD_TORQUE = Kind("number", Number(-1e12, 1e12))
LOAD_DAMPING = Kind("number", Number(0, 1e9, what="a damping"))
SPEEDS = Kind("speeds", SpeedValues())
ORDERS = Kind(
    "whole number(s)", OneOrMore(ListOf(Whole(1, most=256), "orders", distinct=True), int)
)
BEARING_AXES = Kind("values", BearingAxes(("position_mm", "position_m")))
