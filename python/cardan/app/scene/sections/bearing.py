"""The sections [[bearing]]: the bearings of a driveline, and the driveline in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from cardan.app.scene.language.rules import INDEX, NOT_NEGATIVE, VECTOR, Number, each
from cardan.app.scene.language.section import Key, Reading, Section, check_exists
from cardan.app.scene.sections.driveline import DRIVELINE, LENGTHS_NEEDED, has_lengths
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.geometry.geometry import same_place

if TYPE_CHECKING:
    from cardan.app.scene.study.axes import Axis


POSITIONS = ("position_mm", "position_m", "from_end_mm", "from_end_m")
"""The keys that say where on its shaft a bearing is; it has one of them."""

STIFFNESS = "stiffness_N_per_mm"
"""The key that makes a bearing elastic."""

RUBBER = (0.05, 0.2)
"""The least and the largest usual loss factor of rubber."""

OF_RUBBER = "{:g} to {:g} for rubber".format(*RUBBER)
"""The range in words."""

SUPPORT = (STIFFNESS, "axis", "loss_factor", "damping_Ns_per_m")
"""The keys that describe an elastic bearing."""


@dataclass(frozen=True)
class Bearing:
    """A bearing, or what else is on a shaft, as the file gives it: the key of its position, values.

    ``support`` has the arguments of ``ElasticBearing`` but the place; it is empty of a rigid one.
    """

    shaft: int
    key: str
    value: float | FloatArray
    support: Mapping[str, Any] = field(default_factory=dict)

    @property
    def unit(self) -> str:
        """The unit of the position: ``"mm"`` or ``"m"``."""
        return self.key.rpartition("_")[2]

    @property
    def factor(self) -> float:
        """The unit in m."""
        return BEARING.keys[self.key].factor

    @property
    def from_end(self) -> bool:
        """Whether the position is from the downstream end of the shaft."""
        return self.key.startswith("from_end")

    @property
    def distance(self) -> float | FloatArray:
        """The distance from that end in m."""
        return self.value * self.factor

    def position(self, lengths: FloatArray) -> float | FloatArray:
        """The distance from the upstream end of its shaft, of lengths ``(..., n + 1)``, in m."""
        return lengths[..., self.shaft] - self.distance if self.from_end else self.distance


@dataclass(frozen=True)
class Mounting:
    """The bearings of a scene, and lengths of shafts in m that no points give, ``(..., n + 1)``."""

    bearings: tuple[Bearing, ...] = ()
    lengths: tuple[float, ...] | FloatArray | None = None

    @property
    def given(self) -> list[dict[str, Any]]:
        """The values of each bearing by key."""
        return [{"shaft": each.shaft, each.key: each.value} for each in self.bearings]

    def varied(self, axis: Axis, column: FloatArray) -> Self:
        """Return the mounting with the values of an axis of a study, ``(rows,)``."""
        assert axis.place is not None
        column = axis.size * column
        if axis.section == "bearing":
            return self.moved(axis, column[:, np.newaxis])
        own = np.asarray(self.lengths, np.float64)
        lengths = np.array(np.broadcast_to(own, (len(column), 1, own.shape[-1])))
        lengths[..., axis.place] = DRIVELINE.keys[axis.name].factor * column[:, None, None]
        return replace(self, lengths=lengths)

    def moved(self, axis: Axis, column: FloatArray) -> Self:
        """Return the mounting with other positions of one bearing, in the unit of its key."""
        assert axis.place is not None
        number = axis.place.start
        own = replace(self.bearings[number], value=column)
        return replace(self, bearings=(*self.bearings[:number], own, *self.bearings[number + 1 :]))

    def on(self, line: Driveline) -> Driveline:
        """Return drivelines with these lengths and bearings.

        Errors are about the key of the first position without a place, in the unit of that key.
        """
        if not self.bearings and self.lengths is None:
            return line
        lengths = line.lengths().each if self.lengths is None else np.array(self.lengths)
        pairs = [(bearing.shaft, bearing.position(lengths)) for bearing in self.bearings]
        try:
            return line.with_bearings(pairs, self.lengths)
        except ArgumentValueError as error:
            if error.argument == "lengths":
                raise
            number, *place = map(int, error.place)
            bearing = self.bearings[number]
            # Of a study, the first driveline that is wrong; it is asked for one by one.
            values = np.asarray(bearing.value)
            own_value = values[tuple(place[1:])] if values.ndim and place else values.flat[0]
            at = f"is {own_value:.10g} {bearing.unit} on shaft {bearing.shaft}"
            if not place:
                other = next(
                    i
                    for i, (shaft, position) in enumerate(pairs[:number])
                    if shaft == bearing.shaft
                    and np.any(same_place(position, pairs[number][1], lengths[..., shaft]))
                )
                problem = f"{at}, the place of bearing {other}"
            else:
                # Behind the numbers of the bearing and of its position is that of the driveline.
                shape = np.broadcast_shapes(line.shape, lengths.shape[:-1], values.shape)
                length = np.broadcast_to(lengths, (*shape, lengths.shape[-1]))
                own = float(length[(*place[1:], bearing.shaft)]) / bearing.factor
                inner = 0 < bearing.shaft < line.n_joints
                ends = "the joints" if inner else "the end and the joint"
                problem = (
                    f"{at} of length {own:.10g} {bearing.unit}; a bearing must lie between {ends} "
                    "of its shaft"
                )
            raise ArgumentValueError(bearing.key, problem) from None


def check_across(key: str, direction: list[float], along: FloatArray) -> None:
    """Refuse a direction along a shaft, of the directions ``(..., 3)`` of shafts."""
    across = np.min(np.linalg.norm(np.cross(along, direction), axis=-1))
    if across <= 1e-6 * float(np.linalg.norm(direction)):
        text = ", ".join(f"{component:g}" for component in direction)
        problem = f"is [{text}], along the shaft; it must point across it"
        raise ArgumentValueError(key, problem)


def _support(values: Mapping[str, Any], directions: FloatArray) -> dict[str, Any]:
    """Return what makes a bearing elastic; nothing of a rigid one."""
    support = BEARING.arguments(values)
    if not support:
        return {}
    if "axis" in support:
        check_across("axis", support["axis"], directions)
    else:
        for key, value in values.items():
            if key in SUPPORT and isinstance(value, list) and value[0] != value[1]:
                problem = f"is missing; {key} differs in two directions, and axis is the first"
                raise ArgumentValueError("axis", problem)
    return support


class Mounted(NamedTuple):
    """The bearings of a scene, and its driveline in them."""

    mounting: Mounting
    line: Driveline


def _mounted(_: Mapping[str, Any], scene: Reading) -> Mounted:
    described, line = scene[DRIVELINE], scene[DRIVELINE].line
    mounting = Mounting(lengths=described.lengths)
    for i, values in enumerate(scene.document.tables.get(BEARING.name, ())):
        with scene.document.within(f"{BEARING.name}.{i}"):
            if STIFFNESS in values and "lateral" not in scene.given:
                raise ArgumentValueError(
                    STIFFNESS, "needs a section [lateral], which gives the speeds"
                )
            shaft = values["shaft"]
            check_exists("shaft", shaft, line.n_joints + 1)
            if described.lengths is None and not has_lengths(line):
                problem = f"has no length; a bearing needs {LENGTHS_NEEDED}"
                raise ArgumentValueError("shaft", problem)
            key = next(key for key in values if key in POSITIONS)
            support = _support(values, line.directions[..., shaft, :])
            bearing = Bearing(shaft, key, values[key], support)
            mounting = replace(mounting, bearings=(*mounting.bearings, bearing))
            mounting.on(line)
    return Mounted(mounting, mounting.on(line))


BEARING: Section[Mounted] = Section(
    "bearing",
    "a bearing; give one section for each, in any order. They are counted from 0 in that order",
    {
        "shaft": Key(INDEX, "its shaft, counted from 0"),
        "position_mm": Key(
            NOT_NEGATIVE,
            "distance from the upstream end of the shaft in the direction of power flow: from its "
            "input-side joint, on shaft 0 from the driving end",
            factor=1e-3,
        ),
        "position_m": Key(NOT_NEGATIVE, "or: the same in metres"),
        "from_end_mm": Key(
            NOT_NEGATIVE,
            "or: distance from the downstream end of the shaft, that is from its output-side "
            "joint, on the last shaft from the driven end",
            factor=1e-3,
        ),
        "from_end_m": Key(NOT_NEGATIVE, "or: the same in metres"),
        STIFFNESS: Key(
            each(Number(1e-3, 1e9, what="a stiffness"), "two numbers", 2),
            "for [lateral]: dynamic stiffness across the shaft, under preload and with its bracket "
            "in series; one number, or two: along axis, and across both axis and shaft; default: "
            "the bearing is rigid",
            "stiffness",
            1e3,
        ),
        "axis": Key(
            VECTOR,
            "direction of the first of two stiffnesses; the component along the shaft is ignored",
            "axis",
        ),
        "loss_factor": Key(
            each(Number(0, 1, what="a loss factor"), "two numbers", 2),
            f"tangent of the loss angle of the bearing, {OF_RUBBER}; without damping the force in "
            "resonance is not known, and limits are not judged there",
            "loss_factor",
        ),
        "damping_Ns_per_m": Key(
            each(Number(0, 1e9, what="a damping"), "two numbers", 2),
            "viscous damping of the bearing",
            "damping",
        ),
    },
    _mounted,
    together=(*combinations(POSITIONS, 2),),
    needed=(("shaft",), POSITIONS),
    with_key=tuple((key, STIFFNESS) for key in SUPPORT[1:]),
    repeated=True,
    always=True,
)
