"""Variables of a scene, and their best values over the scene's states."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.scene.language.document import nested
from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.quantities import kept_quantity
from cardan.app.scene.language.section import Reading
from cardan.app.scene.language.units import si_key, size_of, split
from cardan.app.scene.sections.bearing import BEARING
from cardan.app.scene.sections.driveline import (
    DRIVELINE,
    SINGLE_BEND,
    SINGLE_PHASE,
    SYNCHRONOUS,
    make_driveline,
)
from cardan.app.scene.sections.load import largest_speed
from cardan.app.scene.sections.study import STATES, STUDY
from cardan.app.scene.study.axes import BEARING_AXES, Axis, axes_of
from cardan.app.scene.study.states import States
from cardan.app.scene.study.study import SceneLayout
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.design.quantities import MOTION_QUANTITIES
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.optimisation import NotKeptError, Optimum, optimise
from cardan.optimisation.problem import Measure, measure_of, over_states
from cardan.optimisation.search import TOLERANCE

DECIMALS = 6
"""Decimal places of the values that are found, in the unit of their keys."""

# The kind of parameter of each key by which q is differentiated, and its unit there.
_DERIVATIVES: Mapping[str, tuple[Literal["bends", "twists", "phases", "points"], float]] = {
    "bends_deg": ("bends", math.pi / 180.0),
    "twists_deg": ("twists", math.pi / 180.0),
    "phases_deg": ("phases", math.pi / 180.0),
    "points_m": ("points", 1.0),
    # Drivelines of scenes have lengths in metres.
    "points_mm": ("points", 1e-3),
}


@dataclass(frozen=True, eq=False)
class Variable:
    """A key of a scene, with the entries that change together, and its least and largest change.

    All are in the unit of the key. The base is the value of the first of its entries in
    [driveline], and ``last_entry`` the number of the last one of its key. A phase that is free has
    the least change ``-inf``; teeth are those of its spline, 0 without one.
    """

    axis: Axis
    base: float
    low: float
    high: float
    teeth: int = 0
    last_entry: int = 0

    @property
    def unit(self) -> str:
        """The ending of its key: ``"mm"``; "" for a ratio."""
        return split(self.key)[1]

    @property
    def key(self) -> str:
        """Its key as the file has it, without a place in it."""
        name, *places = self.axis.key.split(".")
        return places[1] if name == BEARING.name else name

    @property
    def is_phase(self) -> bool:
        """Whether it is a phase, which repeats after half a turn."""
        return self.axis.name in ("phases_deg", SINGLE_PHASE)


@dataclass(frozen=True, eq=False)
class Optimisation:
    """Contents of a scene's section [optimise]; limits to keep are in the unit of their key."""

    variables: tuple[Variable, ...]
    minimise: str
    over: Literal["largest", "rms"]
    keep: Mapping[str, float]
    starts: int
    layout: SceneLayout
    states: States | None
    load: Load | None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the states; of one driveline alone an empty one."""
        return self.states.names if self.states else ("",)

    @property
    def speed(self) -> FloatArray | None:
        """The speed of the drive in rad/s, one for all states or ``(states,)``, if it is known."""
        if self.load is None:
            return None
        # Of a recorded speed the largest counts.
        by_state = self.load.speed.shape == (len(self.names),) and self.states is not None
        speed = self.load.speed if by_state else np.asarray(largest_speed(self.load))
        return np.abs(speed) if np.all(speed) else None

    def measure(self, argument: str, quantity: str) -> Measure:
        """Return the measure of a quantity that is minimised or kept."""
        n_joints = self.drivelines(np.zeros(len(self.variables))).n_joints
        return measure_of(argument, quantity, n_joints, self.load, self.speed)

    @functools.cached_property
    def _unchanged(self) -> dict[str, FloatArray]:
        axes = [axis for axis in self._of_states if not axis.rotation]
        return self.layout.values(axes, len(self.names))

    @property
    def _of_states(self) -> tuple[Axis, ...]:
        return self.states.axes if self.states else ()

    def drivelines(self, changes: FloatArray) -> Driveline:
        """Return the drivelines, ``(..., states)``, after changes in units of the keys."""
        values = dict(self._unchanged)
        turns = [axis for axis in self._of_states if axis.rotation]
        own_axes = [each.axis for each in self.variables if each.axis.section == "driveline"]
        for name in {axis.name for axis in (*turns, *own_axes)}:
            shape = changes.shape[:-1] + values[name].shape
            values[name] = np.array(np.broadcast_to(values[name], shape))
        mounting = self.layout.mounting
        for i, variable in enumerate(self.variables):
            if variable.axis.section == "bearing":
                positions = variable.base + changes[..., i]
                positions = (variable.axis.size * positions)[..., np.newaxis]
                mounting = mounting.moved(variable.axis, positions)
                continue
            own = values[variable.axis.name][variable.axis.where]
            # A view of the copy above.
            own += (variable.axis.size * changes[..., i]).reshape((*changes.shape[:-1], 1, 1))
        for axis in turns:
            axis.change(np.moveaxis(values[axis.name], -3, 0), axis.values)
        return mounting.on(make_driveline(self.layout.form, values))

    def values_at(self, points: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the quantity to minimise over all states, and whether all limits are kept.

        For changes ``(p, m)``: values in SI units, ``(p,)``, NaN where there is no driveline, and
        whether no kept quantity is above its limit in any state, ``(p,)``.
        """
        values, kept = np.full(len(points), np.nan), np.zeros(len(points), dtype=bool)
        measure = self.measure("minimise", self.minimise)
        weights = self.weights if self.over == "rms" else None
        limits = [(self.measure("keep", name), limit) for name, limit in self._kept.items()]
        for i, x in enumerate(points):
            try:
                line = self.drivelines(x)
            except ArgumentValueError:
                continue
            values[i] = float(measure.figure(over_states(measure.vectors(line), weights)))
            kept[i] = all(
                np.all(own.per_state(own.vectors(line)) <= limit * (1.0 + TOLERANCE))
                for own, limit in limits
            )
        return values, kept

    @property
    def _kept(self) -> dict[str, float]:
        """The limits in SI units, by the names of the quantities."""
        return {
            kept_quantity(key): size_of(key) * math.radians(limit)
            if key.endswith("_deg")
            else size_of(key) * limit
            for key, limit in self.keep.items()
        }

    @property
    def weights(self) -> FloatArray:
        """How much each state counts in a root mean square, with sum 1."""
        own = self.states.weights if self.states else np.ones(1)
        return own / np.sum(own)

    def values_after(self, changes: FloatArray) -> dict[str, Any]:
        """Return the values of the scene's keys that change, as plain data by path.

        The path begins with the section: ``"driveline.points_mm"``, ``"states.points_mm.3.y"``.
        Ranges of changes end at the same values as before.
        """
        found: dict[str, Any] = {}
        for variable, change in zip(self.variables, changes, strict=True):
            axis = variable.axis
            if math.isfinite(variable.low):
                ends = [variable.low - change, variable.high - change]
                found[f"optimise.vary.{axis.key}"] = ends
            if axis.section == "bearing":
                found[axis.key] = variable.base + change
                continue
            path = f"driveline.{variable.key}"
            own = np.array(self.layout.driveline[axis.name], dtype=np.float64) / axis.size
            values = np.array(found.get(path, own))
            values[axis.where] += change
            found[path] = values.tolist()
            for other in self._of_states:
                if other.turn == 0 and _overlap(axis, other, len(values)):
                    found[f"states.{other.key}"] = (other.values + change).tolist()
        return found

    def run(self) -> Optimum:
        """Return the best changes, rounded to ``DECIMALS``, with what they bring, in SI units."""
        phases = [i for i, variable in enumerate(self.variables) if variable.is_phase]
        teeth = [self.variables[i].teeth for i in phases]
        try:
            return optimise(
                self.drivelines,
                np.zeros(len(self.variables)),
                [(variable.low, variable.high) for variable in self.variables],
                minimise=self.minimise,
                over=self.over,
                states=self.names,
                weights=self.weights if self.over == "rms" else None,
                keep=self._kept,
                parameters=self._parameters,
                load=self.load,
                speed=self.speed,
                phases=phases,
                teeth=teeth if any(teeth) else None,
                degrees=True,
                starts=self.starts,
                decimals=DECIMALS,
                vectorised=True,
            )
        except NotKeptError as error:
            reached = {kept_quantity(key): key for key in self.keep}
            key = reached[error.quantity]
            limit, found = self.keep[key], error.reached
            found = math.degrees(found) if key.endswith("_deg") else found / size_of(key)
            best = ", ".join(
                f"{variable.axis.key} = {variable.base + change:.6g}"
                for variable, change in zip(self.variables, error.x, strict=True)
            )
            raise Location("keep", (key,)).error(
                f"is {limit:g}; no changes within the ranges keep it: at best it reaches "
                f"{found:.4g}, {found - limit:.3g} above, with {best}"
            ) from None

    @property
    def _parameters(self) -> list[tuple[Any, ...]] | None:
        """Parameters that each variable changes; ``None`` if one changes anything else."""
        found = []
        for variable in self.variables:
            axis, count = variable.axis, variable.last_entry + 1
            turned = (each for each in self._of_states if each.rotation)
            if axis.name not in _DERIVATIVES or any(_overlap(axis, one, count) for one in turned):
                return None
            kind, factor = _DERIVATIVES[axis.name]
            found.append((kind, axis.where[1:], factor * axis.size))
        return found


def optimisation_of(values: Mapping[str, Any], scene: Reading) -> Optimisation:
    """Return what the section [optimise] asks for, each value given or its default."""
    layout, states, load = scene.layout, scene[STATES], scene.load
    if layout is None:
        raise ValueError("it does not go with recorded bends, which nothing can change")
    ranges: Mapping[str, tuple[float, float] | None] = values["vary"]
    for path in ranges:
        scene.check_unit(path, Location("vary", (path,)))
    axes = _axes(ranges, layout)
    teeth = scene[DRIVELINE].teeth
    variables = tuple(_variable(axis, ranges[axis.key], layout, teeth) for axis in axes)
    if states:
        load = states.loads(load)
        for axis in axes:
            _check_states(axis, states.axes, len(layout.driveline.get(axis.name, ())))
    found = Optimisation(
        variables,
        values["minimise"],
        values["over"],
        values["keep"] or {},
        values["starts"],
        layout,
        states,
        load,
    )
    _check_ranges(found)
    _check_quantities(found)
    return found


def proposed(
    layout: SceneLayout, states: States | None, teeth: Sequence[int], given: Mapping[str, str]
) -> dict[str, tuple[float, float] | None]:
    """Return what a section [optimise] could vary of a layout, each path with its range.

    These are the joints across the shafts, slopes, bends or directions of shafts, and all yokes,
    as far as states set none of them in part. ``given`` is how the file names its keys.
    """
    found: dict[str, tuple[float, float] | None] = {}
    for path, ends in _candidates(layout, given):
        try:
            (axis,) = _axes({path: ends}, layout)
            variable = _variable(axis, ends, layout, teeth)
            if states:
                _check_states(axis, states.axes, len(layout.driveline[axis.name]))
            only = Optimisation((variable,), "", "largest", {}, 1, layout, states, None)
            _check_ranges(only)
        except ValueError:
            continue
        found[path] = ends
    return found


# Changes that are tried: a share of the length of the driveline or of a unit vector, and degrees.
_REACH, _TILT, _MORE_SYNCHRONOUS = 0.05, 3.0, 30.0
_LISTS = ("bends", "slopes", "projected_bends")


def _candidates(
    layout: SceneLayout, given: Mapping[str, str]
) -> Iterator[tuple[str, tuple[float, float] | None]]:
    own = layout.driveline
    for si in layout.form.keys:
        key, values = given.get(si, si), np.asarray(own[si], dtype=np.float64)
        if si.startswith("points") or si == "directions":
            reach = _REACH
            if si != "directions":
                long = float(np.sum(np.linalg.norm(np.diff(values, axis=0), axis=1)))
                # Of points in mm or m the length is in their unit.
                reach *= long * size_of(si) / size_of(key)
            reach = float(f"{reach:.1g}")
            # Of a driveline in one plane the joints stay in it.
            axes = [
                axis for axis, size in zip("yz", np.ptp(values, axis=0)[1:], strict=True) if size
            ]
            for place in range(1, len(values) - 1):
                for axis in axes or ["y"]:
                    yield f"{key}.{place}.{axis}", (-reach, reach)
        elif si.startswith(_LISTS) and (values.any() or si == layout.form.keys[0]):
            ends = layout.form.ends
            for place in range(ends, len(values) - ends):  # of shafts those between two joints
                low = max(-_TILT, -float(values[place])) if si.startswith("bends") else -_TILT
                yield f"{key}.{place}", (low, _TILT)
        elif si == SYNCHRONOUS:
            value = float(values[0])
            yield si, (0.0 - value, min(_MORE_SYNCHRONOUS, 0.5 * (120.0 - value)))
    for place in range(len(own.get("phases_deg", ()))):
        yield f"phases_deg.{place}", None
    if SINGLE_PHASE in own:
        yield SINGLE_PHASE, None
        # All of it may be what remains.
        yield SINGLE_BEND, (0.0 - float(own[SINGLE_BEND][0]), _TILT)


def _axes(ranges: Mapping[str, Any], layout: SceneLayout) -> tuple[Axis, ...]:
    paths, there = dict[str, Any](), ", ".join(layout.driveline)
    for name, places in nested({path: [0.0] for path in ranges}).items():
        where = Location("vary", (name,))
        if name == BEARING.name:
            paths[name] = BEARING_AXES.read(Location(name), places)
            continue
        if name not in STUDY.keys or name not in DRIVELINE.keys:
            raise where.error(f"is no key that can change; those of the scene are {there}")
        if si_key(name) not in layout.driveline:
            raise where.error(f"is not in [driveline]; what can change is {there}")
        paths[name] = STUDY.keys[name].rule.read(Location(name), places)
    return axes_of(paths, layout.driveline, None, "an optimisation", layout.mounting.given)


def _variable(
    axis: Axis, ends: tuple[float, float] | None, layout: SceneLayout, teeth: Sequence[int]
) -> Variable:
    low, high = (-math.inf, math.inf) if ends is None else ends
    if axis.section == "bearing" and axis.place is not None:
        position = float(layout.mounting.bearings[axis.place.start].value)
        return Variable(axis, position / axis.size, low, high)
    values = np.asarray(layout.driveline[axis.name], dtype=np.float64)
    base = float(np.ravel(values[axis.where])[0]) / axis.size
    counts = set(teeth[axis.place or slice(None)]) if axis.name == "phases_deg" else set()
    if axis.name == SINGLE_PHASE:
        counts = set(teeth[-1:])
    if len(counts) > 1:
        raise Location("vary", (axis.key,)).error(
            "turns yokes on splines of different teeth together; vary one phase at a time"
        )
    return Variable(axis, base, low, high, counts.pop() if counts else 0, len(values) - 1)


def _check_states(axis: Axis, varied: Sequence[Axis], count: int) -> None:
    """Refuse a variable that moves only a part of what one value of a state sets."""
    for other in varied:
        if (
            other.turn == 0
            and _overlap(axis, other, count)
            and not other.entries(count) <= axis.entries(count)
        ):
            raise Location("vary", (axis.key,)).error(
                f"changes only a part of {other.key}, which [states] sets; vary all of it"
            )


def _overlap(axis: Axis, other: Axis, count: int) -> bool:
    """Whether two axes vary the same entries of a list of so many; a turn varies all components."""
    if other.name != axis.name:
        return False
    own, theirs = axis.entries(count), other.entries(count)
    if other.rotation:
        own = {(place, None) for place, _ in own}
    return bool(own & theirs)


def _check_ranges(found: Optimisation) -> None:
    """Refuse ranges at an end of which there is no driveline."""
    for i, variable in enumerate(found.variables):
        for end in (variable.low, variable.high):
            changes = np.zeros(len(found.variables))
            changes[i] = end if math.isfinite(end) else 0.0
            try:
                found.drivelines(changes)
            except ArgumentValueError as error:
                raise Location("vary", (variable.axis.key,)).error(
                    f"reaches {end:g}, where {error}"
                ) from None


def _check_quantities(found: Optimisation) -> None:
    line = found.drivelines(np.zeros(len(found.variables)))
    named: list[tuple[str, tuple[str, ...], str]] = [("minimise", (), found.minimise)]
    named += [("keep", (key,), kept_quantity(key)) for key in found.keep]
    for argument, place, quantity in named:
        try:
            found.measure(argument, quantity).vectors(line)
        except (IndexError, ArgumentValueError) as error:
            problem = error.problem if isinstance(error, ArgumentValueError) else str(error)
            problem = problem if problem.startswith("is ") else f"is {quantity!r}; {problem}"
            raise Location(argument, place).error(problem) from None
        motion = MOTION_QUANTITIES.get(quantity)
        if place and motion and motion.needs_speed and found.speed is None:
            raise Location(argument, place).error("needs the speed of the drive in [load]")
