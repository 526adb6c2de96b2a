"""The section [driveline]: the ways to describe one, its teeth, and lengths that no points give."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.scene.language import rules, units
from cardan.app.scene.language.section import Key, Reading, Section, check_count
from cardan.app.scene.sections.load import ANGLES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, check_elements
from cardan.driveline import Driveline
from cardan.geometry.constructors import sloping, surveyed
from cardan.geometry.geometry import in_metres

TEETH = "teeth"
"""The key of a driveline that says in which steps its yokes can be set."""

LENGTHS = ("lengths_mm", "lengths_m")
"""The keys of a driveline without points for the lengths of its shafts; it has at most one."""

LENGTHS_NEEDED = "points_mm or points_m, or lengths_mm or lengths_m, in [driveline]"
"""Keys that give a driveline its lengths."""

DOUBLE_JOINT = "double_joint_deg"
"""The key of a centred double joint."""

SYNCHRONOUS = "synchronous_deg"
"""The key for the place of its pivot."""

SINGLE_BEND, SINGLE_TWIST = "single_bend_deg", "single_twist_deg"
"""The keys of the bend of a single joint behind a double joint, and of its plane."""

SINGLE_PHASE = "single_phase_deg"
"""The key of the yokes of the shaft between a double joint and a single one."""

READINGS, OFFSETS, GAUGE = "readings_deg", "offsets_mm", "gauge_deg"
"""The keys of what an inclinometer and a tape measure show, and of what the former may hide."""

FEET = "feet_apart_mm"
"""The key of how far apart the feet lie under which shims are laid."""


@dataclass(frozen=True)
class Form:
    """One way to describe a driveline: keys of one length for a constructor, and optional ones.

    The keys have one entry per joint and ``ends`` more, or are for so many joints only. Of two
    views one suffices: in the other all is level. Of further keys the first needs none of the
    others, which default to zeros; without it there is nothing of them. Of measures, each of its
    own length, every one may be left out.
    """

    make: Callable[..., Driveline]
    keys: tuple[str, ...]
    optional: tuple[str, ...]
    ends: int
    joints: int | None = None
    views: bool = False
    further: tuple[str, ...] = ()
    measures: tuple[str, ...] = ()

    @property
    def schema(self) -> dict[str, Any]:
        """JSON Schema of the section of a driveline that is described in this way."""
        fewest = (self.joints or 1) + self.ends
        most = {} if self.joints is None else {"maxItems": fewest}
        spelled = [way for key in self.keys for way in (key, *units.us_keys(key))]
        lengths = {key: {"minItems": fewest} | most for key in spelled}
        lengths_too = self.measures or (() if self.keys[0].startswith("points") else LENGTHS)
        allowed = only(*self.keys, *self.optional, *self.further, TEETH, *lengths_too)
        needed: dict[str, Any] = {"allOf": [rules.given_as(key) for key in self.keys]}
        if self.views:
            needed = {"anyOf": [rules.given_as(key) for key in self.keys]}
        if self.further:
            needed["dependentRequired"] = {key: [self.further[0]] for key in self.further[1:]}
        if OFFSETS in self.measures:
            ways = (OFFSETS, *units.us_keys(OFFSETS))
            needed["dependentSchemas"] = dict.fromkeys(ways, rules.given_as(LENGTHS[0]))
        return {**needed, "properties": lengths, **allowed}


_BENDS, _TWISTS, _PHASES = "bends_deg", "twists_deg", "phases_deg"
_SLOPES = ("slopes_vertical_deg", "slopes_horizontal_deg")
_SINGLE = (SINGLE_BEND, SINGLE_TWIST, SINGLE_PHASE)
_DOUBLE_JOINT = (DOUBLE_JOINT, "joint_distance_mm", SYNCHRONOUS)
_PROJECTED = ("projected_bends_vertical_deg", "projected_bends_horizontal_deg")


def _from_points_in_mm(
    points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
) -> Driveline:
    """A driveline from points in mm; its lengths are in metres, so that forces are in newtons."""
    return in_metres(Driveline.from_points(points, phases, degrees=degrees), 1e-3)


def _from_readings(
    readings: ArrayLike,
    lengths: ArrayLike | None = None,
    offsets: ArrayLike | None = None,
    phases: ArrayLike = 0.0,
    *,
    degrees: bool = False,
) -> Driveline:
    """A driveline from readings, with its lengths and offsets in mm if they are known."""
    if lengths is None:
        return Driveline.from_readings(readings, None, offsets, phases, degrees=degrees)
    points = surveyed(np.radians(readings), lengths, offsets)
    return _from_points_in_mm(points, phases, degrees=degrees)


def _from_double_joint(
    total: ArrayLike,
    length: ArrayLike,
    synchronous: ArrayLike,
    wear: ArrayLike = 0.0,
    single: ArrayLike | None = None,
    twist: ArrayLike = (0.0,),
    phase: ArrayLike = (0.0,),
    *,
    degrees: bool = False,
) -> Driveline:
    """A centred double joint whose pivot is off by ``wear``; each value is a list of one.

    A single joint may follow behind a shaft, as in wide-angle shafts of tractors.
    """
    bend, distance, even, off = (
        np.asarray(value, dtype=np.float64)[..., 0] for value in (total, length, synchronous, wear)
    )
    half = 0.5 * (np.radians(even) if degrees else even)
    if np.any((even < 0.0) | (half >= np.pi / 3.0)):
        raise ArgumentValueError("synchronous", "must lie in [0, 120) deg")
    pivot = 0.5 * distance / np.cos(half) + off
    if np.any((pivot <= 0.0) | (pivot >= distance)):
        raise ArgumentValueError("wear", "puts the pivot beyond the joints, between which it lies")
    double = Driveline.from_double_joint(bend, distance, pivot, degrees=degrees)
    if single is None:
        return double
    factor, end, unit = (np.pi / 180.0, 90.0, "deg") if degrees else (1.0, 0.5 * np.pi, "rad")
    bends = np.asarray(single, dtype=np.float64)[..., 0]
    right = (bends >= 0.0) & (bends < end)
    check_elements("single", bends, right, f" {unit}; a bend must lie in [0, {end:g}) {unit}")
    own = (factor * np.asarray(value, dtype=np.float64)[..., 0] for value in (single, twist, phase))
    joints = np.moveaxis(double.bends, -1, 0)
    first, second, third, turn, yoke = np.broadcast_arrays(*joints, *own)
    level = np.zeros_like(third)
    return Driveline.from_bends(
        np.stack([first, second, third], axis=-1),
        np.stack([level, turn], axis=-1),
        np.stack([level, yoke], axis=-1),
    )


FORMS = (
    Form(Driveline.from_bends, (_BENDS,), (_TWISTS, _PHASES), 0),
    Form(Driveline.from_points, ("points_m",), (_PHASES,), 2),
    Form(_from_points_in_mm, ("points_mm",), (_PHASES,), 2),
    Form(Driveline.from_directions, ("directions",), (_PHASES,), 1),
    Form(Driveline.from_slopes, _SLOPES, (_PHASES,), 1, views=True),
    Form(Driveline.from_projected_bends, _PROJECTED, (_PHASES,), 0, 2, views=True),
    Form(_from_readings, (READINGS,), (_PHASES,), 1, measures=(LENGTHS[0], OFFSETS, GAUGE, FEET)),
    # Values of a double joint are lists of one entry.
    Form(_from_double_joint, _DOUBLE_JOINT, ("pivot_wear_mm",), -1, 2, further=_SINGLE),
)
"""The ways to describe a driveline; a scene uses exactly one of them."""


def only(*keys: str) -> dict[str, Any]:
    """Return the JSON Schema of an object without keys other than these, in any units."""
    spelled = [way for key in keys for way in (key, *units.us_keys(key))]
    return {"propertyNames": {"enum": spelled}}


def filled(values: Mapping[str, Any], bends: FloatArray | None) -> tuple[Form, dict[str, Any]]:
    """Return form and keys of the driveline, with twists and phases that are left out as zeros."""
    made = dict(values)
    if bends is not None:
        for key in values:
            if key not in FORMS[0].optional:
                raise ArgumentValueError(key, "does not go with recorded bends")
        made[FORMS[0].keys[0]] = [0.0] * bends.shape[-1]
    for form in FORMS:
        given = [key for key in form.keys if key in made]
        if form.views and given:
            level = [0.0] * len(made[given[0]])
            made = {**dict.fromkeys(form.keys, level), **made}
    form = _form_of(made)
    first = form.keys[0]
    size = len(made[first])
    joints = size - form.ends
    if joints < 1:
        raise ArgumentValueError(first, f"has length {size}; one joint needs {1 + form.ends}")
    if form.joints is not None:
        check_count(first, [None] * joints, form.joints, "one per joint")
    for key in form.keys[1:]:
        check_count(key, made[key], size, f"as many as {first}")
    for key in form.optional:
        check_count(key, made.get(key), joints - 1, "one per shaft between two joints")
        made.setdefault(key, [0.0] * (joints - 1))
    for key in form.further:
        if form.further[0] in made:
            made.setdefault(key, [0.0])
        elif key in made:
            raise ArgumentValueError(key, f"needs {form.further[0]}")
    if bends is not None:
        made[first] = bends
    return form, made


def _form_of(values: Mapping[str, Any]) -> Form:
    """The form in which keys describe a driveline."""
    used = [form for form in FORMS if any(key in values for key in form.keys)]
    if not used:
        ways = "; ".join(" with ".join(form.keys) for form in FORMS)
        raise ValueError(f"no shafts or joints; give one of: {ways}")
    form = used[0]
    if len(used) > 1:
        one, other = (next(key for key in form.keys if key in values) for form in used[:2])
        raise ArgumentValueError(
            one, f"and {other} are both given; describe the driveline in one way"
        )
    for key in form.keys:
        if key not in values:
            raise ArgumentValueError(key, f"is missing; {' and '.join(form.keys)} go together")
    for key in values:
        if key not in form.keys + form.optional + form.further + form.measures:
            if key in (OFFSETS, GAUGE, FEET):
                raise ArgumentValueError(key, f"belongs to {READINGS}, which is not given")
            raise ArgumentValueError(key, f"does not go with {form.keys[0]}, which says it already")
    return form


def make_driveline(form: Form, values: Mapping[str, Any]) -> Driveline:
    """Return the driveline of a form, or a batch if the values have leading dimensions."""
    keys = DRIVELINE.keys
    try:
        # Neither points nor directions are angles: what is in degrees is what can be.
        return form.make(**{keys[key].argument: values[key] for key in values}, degrees=True)
    except ArgumentValueError as error:
        # Slopes and readings become directions or points before their bends are known.
        names = {"directions": form.keys, "points": form.keys}
        names |= {keys[key].argument: (key,) for key in values}
        key, *others = names.get(error.argument, (error.argument,))
        along = None if key in form.measures else _vectors_along_shafts(values)
        problem = error.problem
        # The place is that of a driveline in the batch and not of a vector in it.
        if along is not None and len(error.place) == along.ndim - 2:
            problem = _too_steep(key, along[tuple(map(int, error.place))]) or problem
        problem = " ".join((*(f"and {other}" for other in others), problem))
        raise ArgumentValueError(key, problem, error.place) from None


def points_of(values: Mapping[str, Any]) -> FloatArray | None:
    """Return the points that values by key give, or readings with lengths, in the unit of both."""
    found = next((value for key, value in values.items() if key.startswith("points")), None)
    if found is not None:
        return np.array(found, float)
    if READINGS in values and LENGTHS[0] in values:
        up = np.radians(np.asarray(values[READINGS], float))
        return surveyed(up, values[LENGTHS[0]], values.get(OFFSETS))
    return None


def _vectors_along_shafts(values: Mapping[str, Any]) -> FloatArray | None:
    """Vectors along the shafts that points, directions or slopes give; ``None`` for bends."""
    points = points_of(values)
    if points is not None:
        return np.diff(points, axis=-2)
    if "directions" in values:
        return np.asarray(values["directions"], float)
    if READINGS in values:
        up = np.radians(np.asarray(values[READINGS], float))
        return np.stack([np.cos(up), np.sin(up), np.zeros_like(up)], axis=-1)
    if "slopes_vertical_deg" in values:
        return sloping(
            *(np.radians(values[f"slopes_{view}_deg"]) for view in ("vertical", "horizontal"))
        )
    return None


def _too_steep(key: str, vectors: FloatArray) -> str | None:
    """The first bend that is too large, in degrees and with the numbers of its points or shafts."""
    one, other = vectors[:-1], vectors[1:]
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    bends = np.degrees(np.arctan2(sine, np.sum(one * other, axis=-1)))
    if not np.any(bends >= 90.0):
        return None
    joint = int(np.argmax(bends >= 90.0))
    bend = bends[joint]
    if key.startswith("points"):
        place = f"at point {joint + 1}, between points {joint} and {joint + 2}"
    else:
        place = f"between shafts {joint} and {joint + 1}"
    return f"give joint {joint} a bend of {bend:.8g} deg {place}; a bend must lie in [0, 90) deg"


@dataclass(frozen=True, eq=False)
class Described:
    """A driveline without its bearings, and what the file says of it.

    The keys have zeros for twists and phases that the file leaves out; lengths are in m and of keys
    that give them in place of points.
    """

    form: Form
    keys: dict[str, Any]
    line: Driveline
    teeth: tuple[int, ...]
    lengths: tuple[float, ...] | None
    points: FloatArray | None
    length_unit: units.LengthUnit
    gauge: float | None  # in degrees
    feet: tuple[float, ...] | None  # of the drive's end and of the other, in m


def _described(values: Mapping[str, Any], scene: Reading) -> Described:
    recorded = scene[ANGLES]
    own = {key: value for key, value in values.items() if key not in (TEETH, GAUGE, FEET, *LENGTHS)}
    lengths = next((key for key in LENGTHS if key in values), None)
    if READINGS in values and lengths:
        if lengths != LENGTHS[0]:
            raise ArgumentValueError(lengths, f"is in m; with {READINGS} give {LENGTHS[0]}")
        own[lengths], lengths = values[lengths], None
    for key in (GAUGE, FEET):
        if key in values and READINGS not in values:
            raise ArgumentValueError(key, f"belongs to {READINGS}, which is not given")
    feet = "one per end, 0 where there are no feet; or give one number for both"
    check_count(FEET, values.get(FEET), 2, feet)
    form, keys = filled(own, recorded.bends if recorded else None)
    if form.measures:
        # What is measured must fit before there is a driveline.
        DRIVELINE.check_counts(values, len(keys[READINGS]) - form.ends)
    line = make_driveline(form, keys)
    DRIVELINE.check_counts(values, line.n_joints)
    points = next((key for key in own if key.startswith("points")), None)
    if points and lengths:
        raise ArgumentValueError(lengths, f"does not go with {points}, which says it already")
    teeth = values.get(TEETH, [])
    return Described(
        form,
        keys,
        line,
        tuple(teeth if isinstance(teeth, list) else [teeth] * (line.n_joints - 1)),
        tuple(DRIVELINE.keys[lengths].factor * x for x in values[lengths]) if lengths else None,
        points_of(own),
        "m" if {"points_m", "lengths_m"} & values.keys() else "mm",
        values.get(GAUGE),
        _feet(values[FEET]) if FEET in values else None,
    )


def _feet(value: float | list[float]) -> tuple[float, ...]:
    each = value if isinstance(value, list) else [value] * 2
    return tuple(DRIVELINE.keys[FEET].factor * one for one in each)


def has_lengths(line: Driveline) -> bool:
    """Whether the lengths of the shafts are known."""
    return bool(line._geometry.lengths.shape[-1])


def _vectors(meaning: str, argument: str, entry: tuple[str, str, int]) -> Key:
    rule = rules.ListOf(rules.VECTOR, "vectors [x, y, z]")
    return Key(rule, meaning, argument, kind="vectors", entry=entry)


def _slopes(meaning: str, argument: str, entry: tuple[str, str, int]) -> Key:
    slope = rules.Number(-90, 90, above=True, below=True)
    return Key(rules.ListOf(slope, "numbers"), meaning, argument, kind="slopes", entry=entry)


_READING = rules.Directed(
    rules.Number(
        -60,
        60,
        what='of a gauge that counts from the vertical write "87.0 from vertical down"; a reading',
        unit="deg",
    ),
    ("up", "down"),
    {
        "deg": (float, True),
        "°": (float, True),
        "from vertical": (lambda x: 90.0 - x, True),
        "%": (lambda x: math.degrees(math.atan(1e-2 * x)), True),
    },
    '"3.0 down", "87.0 from vertical down" or "5.2 % up", towards the output',
)
_OFFSET = rules.Directed(
    rules.Number(-1e6, 1e6, what="an offset", unit="mm"),
    ("left", "right"),
    {"mm": (float, True)},
    '"45 left" or "45 right", looking as the driver does',
)

_POINT, _LENGTH = ("", "point", 0), ("length", "shaft", 0)

DRIVELINE: Section[Described] = Section(
    "driveline",
    "joints and shafts, required; give exactly one description",
    {
        "bends_deg": Key(
            rules.numbers(rules.BEND),
            "bend of each joint, in [0, 90)",
            "bends",
            entry=("bend", "joint", 0),
        ),
        "twists_deg": Key(
            rules.numbers(),
            "with bends_deg: angle from one bend plane to the next about each intermediate "
            "shaft, clockwise looking from the drive towards the output; default 0",
            "twists",
            entry=("twist", "shaft", 1),
        ),
        "points_m": _vectors(
            "driving end, joint centres, driven end, in right-handed axes", "points", _POINT
        ),
        "points_mm": _vectors("the same in mm", "points", _POINT),
        "directions": _vectors(
            "a vector of any length along each shaft, in right-handed axes",
            "directions",
            ("direction", "shaft", 0),
        ),
        "slopes_vertical_deg": _slopes(
            "slope of each shaft in side view, positive upwards",
            "vertical",
            ("slope in side view", "shaft", 0),
        ),
        "slopes_horizontal_deg": _slopes(
            "slope of each shaft in top view, positive to the right, looking from the drive "
            "towards the output: towards the vehicle's left if its drive is in front",
            "horizontal",
            ("slope in top view", "shaft", 0),
        ),
        "projected_bends_vertical_deg": _slopes(
            "bends of two joints in side view, from the common shaft, positive upwards",
            "vertical",
            ("bend in side view", "joint", 0),
        ),
        "projected_bends_horizontal_deg": _slopes(
            "bends of two joints in top view, from the common shaft, positive as "
            "slopes_horizontal_deg",
            "horizontal",
            ("bend in top view", "joint", 0),
        ),
        READINGS: Key(
            rules.ListOf(_READING, "readings"),
            'what an inclinometer shows on each shaft, from the drive on: "3.0 down" or "3.0 up" '
            'towards the output, "87.0 from vertical down", "5.2 % up", or a number, positive '
            "upwards",
            "readings",
            kind="readings",
        ),
        OFFSETS: Key(
            rules.ListOf(_OFFSET, "offsets"),
            "with readings_deg: where the driving end, the joint centres and the driven end lie in "
            'plan, "45 left" or "45 right" of a line along the vehicle, looking forwards with the '
            "drive in front; a number is positive to the left; default: all on that line",
            "offsets",
            per="point",
            kind="offsets",
        ),
        GAUGE: Key(
            rules.Number(0, 10, above=True, what="the accuracy of a gauge", unit="deg"),
            "with readings_deg: how far each reading may be off; the answer then says how certain "
            "its verdict is",
        ),
        FEET: Key(
            rules.each(rules.Number(0, 1e6), "numbers"),
            "with readings_deg: distance along the shaft between the feet of what bears the first "
            "shaft, such as an engine, and of what bears the last one, 0 where there are no feet; "
            "or one number for both. The answer then says how thick each shim is",
            factor=1e-3,
        ),
        DOUBLE_JOINT: Key(
            rules.numbers(rules.Number(0, 180, below=True, what="a total bend", unit="deg"), 1),
            "total bend of a centred double joint, in [0, 180)",
            "total",
        ),
        "joint_distance_mm": Key(
            rules.numbers(rules.SIZE, 1),
            "of a double joint: distance of its joint centres",
            "length",
        ),
        SYNCHRONOUS: Key(
            rules.numbers(rules.Number(0, 120, below=True, unit="deg"), 1),
            "of a double joint: total bend at which both joints have the same bend; 0 where the "
            "pivot lies in the middle between them",
            "synchronous",
        ),
        "pivot_wear_mm": Key(
            rules.numbers(),
            "of a double joint: how far its pivot is off, away from joint 0; default 0",
            "wear",
        ),
        SINGLE_BEND: Key(
            rules.numbers(rules.BEND, 1),
            "of a double joint: bend of a single joint behind it",
            "single",
        ),
        SINGLE_TWIST: Key(
            rules.numbers(None, 1),
            "of that joint: angle from the plane of the double joint to its own; default 0",
            "twist",
        ),
        SINGLE_PHASE: Key(
            rules.numbers(None, 1),
            "of the shaft between double and single joint, as phases_deg; default 0",
            "phase",
        ),
        "phases_deg": Key(
            rules.numbers(),
            "angle from the input-side to the output-side yoke of each intermediate shaft, "
            "clockwise looking from the drive towards the output; 0 has both in one plane, and a "
            'yoke 6 deg off has its best phase, as "cardan phase" finds it, plus or minus 6; '
            "default 0",
            "phases",
            entry=("phase", "shaft", 1),
        ),
        TEETH: Key(
            rules.TOOTH_COUNTS,
            "teeth of the spline that carries the output-side yoke of each shaft between two "
            "joints: one number for all shafts or one per shaft, 1 where no yoke can be turned; "
            "default: any angle can be set",
            per="shaft between two joints",
        ),
        "lengths_mm": Key(
            rules.ListOf(rules.POSITIVE, "numbers"),
            "without points: length of each shaft between its joints or ends, for forces",
            "lengths",
            factor=1e-3,
            per="shaft",
            entry=_LENGTH,
        ),
        "lengths_m": Key(
            rules.ListOf(rules.POSITIVE, "numbers"),
            "or: the same in metres",
            per="shaft",
            entry=_LENGTH,
        ),
    },
    _described,
    together=(LENGTHS,),
    always=True,
)
