"""A machine in all of its states beside all of its limits, and single changes that mend it."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64, not_negative, per_joint, positive, threads
from cardan.arrays.errors import ArgumentValueError, check_shape
from cardan.arrays.indices import item_index
from cardan.design.limits import Bound
from cardan.evaluation.load import Load, require_load
from cardan.geometry.geometry import require_driveline
from cardan.geometry.parameters import has_lengths

if TYPE_CHECKING:
    from cardan.driveline import Driveline

MachineVerdict: TypeAlias = Literal["not judged", "within", "tolerable", "beyond"]
"""A rank in words."""

RANKS: tuple[MachineVerdict, ...] = ("not judged", "within", "tolerable", "beyond")
"""The verdicts by their rank."""


@dataclass(frozen=True)
class Kind:
    """What a figure of a machine is.

    Attributes:
        name: for programs, as in ``limits``.
        unit: of its values; ``"1"`` for a ratio.
        per: of what each is; ``None`` if it is of the whole driveline.
        most: whether a limit is the most that it may be, or the least.
        scope: whether it has a value in each of the ``"states"``, in states and then steps of the
            duty cycle (``"cases"``), or ``"once"``.
    """

    name: str
    unit: str
    per: Literal["shaft", "joint", "bearing"] | None
    most: bool
    scope: Literal["states", "cases", "once"]


# What the core is told of a machine without parts.
_NOTHING: Mapping[str, Any] = {
    **dict.fromkeys(("shares", "ratings", "friction", "tubes", "centres", "play"), ()),
    **dict.fromkeys(("steps", "spline")),
}

KINDS: Mapping[str, Kind] = MappingProxyType({row[0]: Kind(*row) for row in _core.kinds()})
"""The kinds of figures by their name."""


@dataclass(frozen=True, eq=False)
class MachineFigure:
    """One figure of a machine.

    Attributes:
        kind: what it is.
        item: of which shaft, joint or bearing; ``None`` if it is of the whole driveline.
        values: in every state, and for some kinds then in every step of the duty cycle, in SI
            units, lives in h; NaN where the machine does not determine it.
        ranks: the rank of each value, a position in ``RANKS``.
        limit: what it should keep; NaN if there is no limit.
        maximum: what it must keep.
        worst: the place in ``values`` of the one that is nearest to the limit or farthest past it;
            ``None`` if none is a number.
    """

    kind: Kind
    item: int | None
    values: FloatArray
    ranks: NDArray[np.int64]
    limit: float
    maximum: float
    worst: int | None

    @property
    def verdict(self) -> MachineVerdict:
        """The worst of its ranks."""
        return RANKS[int(np.max(self.ranks))]


@dataclass(frozen=True, eq=False)
class Change:
    """A single change of a machine.

    Attributes:
        variable: what changes: ``"point"``, ``"phase"``, ``"bearing"``, the ``"engaged"`` length of
            the spline in the drawing, or a ``"rating"``.
        item: which point from the upstream end, shaft, bearing or joint.
        axis: of a point, 0 for x, 1 for y, 2 for z.
        start: what it is in the first state, in rad, m or N m; points count from the upstream end.
        end: what it becomes.
        share: size of the change as a part of what was tried.
        verdict: of the machine after it; everything is then within if this is.
        worst: the figure that is then nearest to its limit or farthest past it.
    """

    variable: Literal["point", "phase", "bearing", "engaged", "rating"]
    item: int
    axis: int | None
    start: float
    end: float
    share: float
    verdict: MachineVerdict
    worst: MachineFigure | None

    @property
    def change(self) -> float:
        """By how much it changes."""
        return self.end - self.start


@dataclass(frozen=True, eq=False, init=False)
class Machine:
    """A driveline in all of its states with its parts, loads and limits.

    The methods ``with_...`` add what else the machine has. Whatever it does not have is left out.
    Values that break a rule raise an error there or with the first figures.

    Attributes:
        states: the driveline in each state, a batch ``(states,)``.

    >>> import cardan
    >>> lines = cardan.Driveline.from_bends([[5.0, 4.0], [8.0, 4.0]], degrees=True)
    >>> machine = cardan.Machine(lines, limits={"equivalent_bend": 0.0524, "bend": {0: 0.1}})
    >>> [(f.kind.name, f.item, f.verdict) for f in machine.figures() if f.verdict != "not judged"]
    [('equivalent_bend', None, 'beyond'), ('bend', 0, 'beyond')]
    """

    states: Driveline
    _parts: dict[str, Any] = field(repr=False)

    def __init__(
        self,
        states: Driveline,
        load: Load | None = None,
        *,
        limits: Mapping[str, Bound | Mapping[int, Bound]] | None = None,
        speed: ArrayLike | None = None,
        drawn: Driveline | None = None,
    ) -> None:
        """Make a machine without further parts.

        Args:
            states: one driveline, or a batch with one for each state.
            load: one for all states, or with arrays ``(states,)``. Without torque and inertias
                nothing is loaded.
            limits: by name of ``KINDS``: a number, or a limit and a maximum, or these by the number
                of a shaft, joint or bearing.
            speed: of the drive in rad/s, by default that of the load; 0 is not known.
            drawn: one driveline, for which engaged length and push-in of a spline and the angle
                straight ahead of a steering column hold; by default that of the first state.

        Raises:
            TypeError: a driveline or a load that is none, values that are not real numbers.
            ValueError: shapes that do not fit.
        """
        own = _states_of("states", states)
        given = []
        for name, bounds in (limits or {}).items():
            each = bounds.items() if isinstance(bounds, Mapping) else [(None, bounds)]
            given += [(name, item, *_pair(name, bound)) for item, bound in each]
        parts = {**_NOTHING, "states": _cases(own, load, speed), "limits": given}
        drawing = own[0] if drawn is None else drawn
        require_driveline("drawn", drawing)
        if drawing.shape:
            raise ArgumentValueError("drawn", f"has shape {drawing.shape}; it is one driveline")
        parts["drawn"] = _cases(drawing.reshape(1), None, None)
        object.__setattr__(self, "states", own)
        object.__setattr__(self, "_parts", parts)

    def with_duty(self, steps: Driveline, load: Load, shares: ArrayLike) -> Machine:
        """Add a duty cycle, over which lives are judged, and loads beside those of the states.

        Args:
            steps: the driveline in each step, one or a batch ``(steps,)``.
            load: the load in each step, likewise.
            shares: of each step in the time, ``(steps,)``, with sum 1.

        Raises:
            ValueError: shares that are not positive or do not add up to 1.
        """
        own, part = _states_of("steps", steps), np.atleast_1d(positive("shares", shares))
        own = own if own.size == len(part) or own.size > 1 else own[np.zeros(len(part), dtype=int)]
        if abs(float(np.sum(part)) - 1.0) > 1e-9 or part.shape != own.shape:
            problem = f"are {part.tolist()}; they must add up to 1, with one per step"
            raise ArgumentValueError("shares", problem)
        return self._with(steps=_cases(own, load, None), shares=part.tolist())

    def with_ratings(self, rating: ArrayLike) -> Machine:
        """Add ratings of the joints, whose lives are then judged over the duty cycle.

        Args:
            rating: torque in N m for 5000 h at 3 degrees and 100 rpm: one number, or one per joint;
                NaN for a joint whose life is not known, such as one with plain bearings.
        """
        return self._with(ratings=self._per_joint("rating", as_float64("rating", rating)))

    def with_friction(
        self,
        friction: ArrayLike,
        pin_radius: ArrayLike,
        arm: ArrayLike,
        seal_torque: ArrayLike = 0.0,
    ) -> Machine:
        """Add the friction of the pins, whose heat is then judged, as of ``Driveline.losses``."""
        given = {"friction": friction, "pin_radius": pin_radius, "arm": arm}
        given["seal_torque"] = seal_torque
        columns = [self._per_joint(name, as_float64(name, x)) for name, x in given.items()]
        return self._with(friction=list(zip(*columns, strict=True)))

    def with_tubes(
        self,
        shafts: Sequence[int],
        outer_diameter: ArrayLike,
        wall: ArrayLike | None = None,
        *,
        length: ArrayLike | None = None,
        elastic_modulus: ArrayLike = 2.06e11,
        density: ArrayLike = 7850.0,
    ) -> Machine:
        """Add shafts of round section, whose stress and critical speed are then judged.

        Args:
            shafts: which ones.
            outer_diameter: as of ``cardan.tube``, like the following arguments and the errors: one
                number, or one per listed shaft.
            wall: in m.
            length: in m; by default as long as the shaft is in each state.
            elastic_modulus: in Pa.
            density: in kg/m³.
        """
        outer = positive("outer_diameter", outer_diameter)
        unknown = np.asarray(math.nan)
        columns = {
            "outer_diameter": outer,
            "wall": 0.5 * outer if wall is None else positive("wall", wall),
            "length": unknown if length is None else positive("length", length),
            "shear_modulus": unknown,  # stiffness is not judged
            "elastic_modulus": positive("elastic_modulus", elastic_modulus),
            "density": positive("density", density),
        }
        count = self.states.n_joints + 1
        numbers = [item_index("shafts", shaft, count, (i,)) for i, shaft in enumerate(shafts)]
        full = [_spread(name, array, len(numbers)) for name, array in columns.items()]
        for i, (diameter, thickness) in enumerate(zip(*full[:2], strict=True)):
            if thickness > 0.5 * diameter:
                problem = f"is {thickness} m; a wall is at most half the outer diameter"
                raise ArgumentValueError("wall", problem, (i,))
        return self._with(tubes=list(zip(numbers, zip(*full, strict=True), strict=True)))

    def with_spline(
        self,
        shaft: int,
        *,
        engaged: float = math.nan,
        push_in: float = math.nan,
        friction: float = math.nan,
        radius: float = math.nan,
    ) -> Machine:
        """Add the spline of a shaft, whose lengths and axial force are then judged.

        Args:
            shaft: which one.
            engaged: engaged length in the drawing in m; not known by default, like the following
                arguments.
            push_in: how far it can be pushed in there until it bottoms, in m.
            friction: coefficient of friction.
            radius: pitch radius in m.
        """
        index = item_index("shaft", shaft, self.states.n_joints + 1)
        return self._with(spline=(index, (engaged, push_in, friction, radius)))

    def with_steering(self, centre: ArrayLike) -> Machine:
        """Add a steering column.

        Args:
            centre: drive angle straight ahead in rad: that of the drawing, from which the column
                carries its yoke along, or one per state.
        """
        angles, count = np.atleast_1d(as_float64("centre", centre)), self.states.size
        return self._with(centres=_spread("centre", angles, count)[: max(1, angles.size)])

    def with_play(self, radial: ArrayLike, arm: ArrayLike) -> Machine:
        """Add play of the pins, whose lash is then judged; arguments as of ``Driveline.lash``."""
        play = not_negative("radial", radial) / positive("arm", arm)
        return self._with(play=self._per_joint("play", play))

    def figures(self) -> tuple[MachineFigure, ...]:
        """Return every figure that the machine has, with its rank in every state.

        Raises:
            ValueError: joints with deviations, limits or parts of what does not exist, a maximum on
                the wrong side of its limit, values that break a rule.
        """
        return tuple(_figure(row) for row in self._core.figures(threads.at_most(None)))

    def verdict(self) -> MachineVerdict:
        """Return the worst verdict of all figures."""
        return RANKS[max(int(np.max(figure.ranks)) for figure in self.figures())]

    def suggest(
        self, reach: float = 0.0, *, teeth: Sequence[int] = (), ratings: ArrayLike = ()
    ) -> tuple[Change, ...]:
        """Return the smallest single changes that bring everything within its limits.

        Tried are every point along every axis, every phase, the place of every bearing, the engaged
        length of the spline and the rating of every joint. A point moves alike in all states.

        Args:
            reach: by how much points, bearings and the engaged length may change, in m; by default
                not at all.
            teeth: of the spline of each shaft between two joints, by which its phase can change; 0
                for one that can be set at will, as all can by default.
            ratings: of the joints that there are, in N m.

        Returns:
            the changes, smallest first, compared as parts of what was tried. If none suffices, the
            one after which the worst figure is least past its limit, as a part of this limit; none
            if everything is within, or if nothing makes it better.

        Raises:
            ValueError: as for ``figures``.
        """
        known = np.atleast_1d(positive("ratings", ratings)).tolist()
        found = self._core.suggest(float(reach), list(teeth), known, threads.at_most(None))
        return tuple(_change(row) for row in found)

    def to_dict(self) -> dict[str, Any]:
        """Return the machine as plain data, which JSON can hold and ``cardan.js`` reads.

        The names are those of the arguments of its function ``figures``, in SI units. Besides
        them ``points`` are the ends and joint centres of every state from the upstream end, if the
        shafts have lengths. What is not known is ``None``.

        >>> import cardan
        >>> line = cardan.Driveline.from_bends([5.0, 4.0], degrees=True)
        >>> data = cardan.Machine(line, limits={"bend": {0: 0.1}}).to_dict()
        >>> data["joints"], data["limit_kinds"], data["limit_items"], data["limits"]
        (2, ['bend'], [0], [0.1])
        """
        parts = self._parts
        columns = _of_cases("", *parts["states"])
        columns["bearings"] = self.states._geometry.bearings
        if parts["steps"] is not None:
            columns |= _of_cases("step_", *parts["steps"])
        if parts["spline"] is not None:
            columns["spline"], own = parts["spline"]
            columns |= dict(zip(_SPLINE, own, strict=True))
        for name in ("shares", "ratings", "centres", "play"):
            columns[name] = parts[name]
        columns |= _of_cases("drawn_", *parts["drawn"])
        columns["tubes"] = [shaft for shaft, _ in parts["tubes"]]
        for names, records in (
            (_FRICTION, parts["friction"]),
            (_TUBES, [own for _, own in parts["tubes"]]),
            (_LIMITS, [(k, -1 if i is None else i, *rest) for k, i, *rest in parts["limits"]]),
        ):
            for i, name in enumerate(names):
                columns[name] = [record[i] for record in records]
        for name in ("shear_modulus", "step_end", "step_inertia_shafts", "drawn_speed"):
            columns.pop(name, None)
        return {"joints": self.states.n_joints, **{k: _plain(v) for k, v in columns.items()}}

    @property
    def _core(self) -> _core.Machine:
        parts = dict(self._parts)
        for name in ("states", "steps", "drawn"):
            if parts[name] is not None:
                line, *rest = parts[name]
                parts[name] = (line._lines, *rest)
        return _core.Machine(**parts)

    def _with(self, **parts: Any) -> Machine:  # noqa: ANN401 - what the core takes
        other = copy.copy(self)
        object.__setattr__(other, "_parts", {**self._parts, **parts})
        return other

    def _per_joint(self, name: str, array: FloatArray) -> list[float]:
        found: list[float] = per_joint(name, array, self.states.n_joints).tolist()
        return found


_FRICTION = ("friction", "pin_radius", "arm", "seal_torque")
_TUBES = ("outer_diameter", "wall", "tube_length", "shear_modulus", "elastic_modulus", "density")
_SPLINE = ("engaged", "push_in", "spline_friction", "spline_radius")
_LIMITS = ("limit_kinds", "limit_items", "limits", "maxima")


def _of_cases(
    prefix: str, line: Driveline, speed: list[float], load: tuple[Any, ...] | None
) -> dict[str, Any]:
    """Drivelines with their points, and their speeds and loads, by name with a prefix."""
    own = line._geometry
    names = ("bends", "twists", "phases", "directions", "normals", "lengths", "positions")
    columns: dict[str, Any] = dict(zip(names, own.arrays, strict=False))
    columns["speed"] = speed
    if load is not None:
        columns["end"], columns["torque"], columns["acceleration"], inertias = load
        columns["inertia_shafts"] = [shaft for shaft, _ in inertias]
        columns["inertias"] = [each for _, each in inertias]
    if has_lengths(line):
        ends = np.cumsum(own.lengths[..., np.newaxis] * own.directions, axis=-2)
        columns["points"] = np.concatenate([np.zeros_like(ends[..., :1, :]), ends], axis=-2)
    return {prefix + name: column for name, column in columns.items()}


def _plain(values: Any) -> Any:  # noqa: ANN401 - of any depth
    """Numbers and names in lists, with ``None`` for NaN."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, (list, tuple)):
        return [_plain(value) for value in values]
    return None if isinstance(values, float) and math.isnan(values) else values


def _states_of(name: str, line: Driveline) -> Driveline:
    require_driveline(name, line)
    right = len(line.shape) <= 1
    check_shape(name, line, right, "it is one driveline or a batch of one axis")
    return line.reshape(-1)


def _cases(line: Driveline, load: Load | None, speed: ArrayLike | None) -> tuple[Any, ...]:
    """Drivelines, and speeds and load as the core takes them."""
    count = line.size
    if load is None:
        speeds = as_float64("speed", 0.0 if speed is None else speed)
        return line, _spread("speed", speeds, count), None
    require_load(load)
    speeds = load.speed if speed is None else as_float64("speed", speed)
    inertias = load.inertias_by_shaft(line.n_joints).items()
    arrays = (
        load.end,
        _spread(f"{load.end}_torque", load.torque, count),
        _spread("acceleration", load.acceleration, count),
        [(shaft, _spread("inertias", each, count)) for shaft, each in inertias],
    )
    return line, _spread("speed", speeds, count), arrays


def _spread(name: str, array: FloatArray, count: int) -> list[float]:
    """One number, or one for each of so many."""
    right = array.shape in ((), (1,), (count,))
    check_shape(name, array, right, f"it must be one or ({count},)")
    found: list[float] = np.broadcast_to(array, count).tolist()
    return found


def _pair(name: str, bound: Bound) -> tuple[float, float]:
    """A limit and its maximum, which may be the same."""
    values = np.atleast_1d(as_float64(name, bound))
    if values.shape not in ((1,), (2,)):
        raise ArgumentValueError(name, f"is {bound!r}; it must be a number or [limit, maximum]")
    return float(values[0]), float(values[-1])


def _figure(row: Any) -> MachineFigure:  # noqa: ANN401 - of the core
    name, item, values, ranks, (limit, maximum), worst = row
    return MachineFigure(KINDS[name], item, values, ranks, limit, maximum, worst)


def _change(row: Any) -> Change:  # noqa: ANN401 - of the core
    variable, item, axis, (start, end), share, rank, worst = row
    left = None if worst is None else _figure(worst)
    return Change(variable, item, axis, start, end, share, RANKS[rank], left)
