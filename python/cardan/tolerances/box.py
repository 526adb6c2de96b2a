"""The tolerances of a driveline as a box around its drawing: which parameters, and by how much."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, together
from cardan.arrays.errors import (
    ArgumentValueError,
    check_choice,
    check_elements,
    check_shape,
    require,
)
from cardan.geometry.as_built import DEVIATIONS
from cardan.geometry.parameters import PARAMETERS, parameter_shape
from cardan.tolerances.chain import Deviations, Nominal, ParameterPlace

if TYPE_CHECKING:
    from cardan.driveline import Driveline

JOINT_GROUPS = DEVIATIONS
"""The groups of deviations of the joints, in the order of ``Driveline.deviations``."""

GROUPS = (*PARAMETERS, *JOINT_GROUPS)
"""The groups of parameters that can have tolerances."""

# A normal deviation beyond so many tolerances, six standard deviations, does not occur.
_FARTHEST = {"uniform": 1.0, "normal": 2.0}


@dataclass(frozen=True, eq=False)
class Box:
    """One driveline as drawn and the tolerances of its parameters, in rad or the points' unit.

    With teeth the tolerance of a phase includes half a tooth. That is uniform even if tolerances
    are three standard deviations of a normal distribution.
    """

    nominal: Nominal
    halves: Mapping[ParameterPlace, float]  # of each parameter that has one, by group and place
    teeth: Mapping[ParameterPlace, float]  # the half tooth of each phase that is set by teeth
    normal: bool

    @cached_property
    def places(self) -> tuple[ParameterPlace, ...]:
        """The parameters, in the order of ``sizes``."""
        return tuple(self.halves)

    @cached_property
    def sizes(self) -> FloatArray:
        """Their tolerances, ``(parameters,)``."""
        return np.array(list(self.halves.values()), dtype=float)

    @cached_property
    def tooth_sizes(self) -> FloatArray:
        """The half tooth in each of them, 0 for most."""
        return np.array([self.teeth.get(place, 0.0) for place in self.places], dtype=float)

    @cached_property
    def sigmas(self) -> FloatArray:
        """Their standard deviations."""
        tooth = self.tooth_sizes
        own = (self.sizes - tooth) / (3.0 if self.normal else np.sqrt(3.0))
        return np.asarray(np.hypot(own, tooth / np.sqrt(3.0)))

    def deviations(self, values: FloatArray) -> Deviations:
        """Return the rows of ``(parameters, samples)`` by parameter."""
        return dict(zip(self.places, values, strict=True))

    def drawn(self, random: np.random.Generator, samples: int) -> FloatArray:
        """Draw deviations of the parameters, ``(parameters, samples)``."""
        shape = (len(self.places), samples)
        tooth = self.tooth_sizes
        own = (self.sizes - tooth)[:, np.newaxis]
        if self.normal:
            values = random.standard_normal(shape)
            values *= own / 3.0
        else:
            values = random.random(shape)
            values -= 0.5
            values *= 2.0 * own
        for row in np.flatnonzero(tooth):
            values[row] += tooth[row] * (2.0 * random.random(samples) - 1.0)
        return values

    def scaled(self, group: str, factor: float) -> Box:
        """Return the box with the tolerances of one group multiplied; half a tooth stays."""

        def size(place: ParameterPlace, half: float) -> float:
            tooth = self.teeth.get(place, 0.0)
            return tooth + factor * (half - tooth) if place[0] == group else half

        halves = {place: size(place, half) for place, half in self.halves.items()}
        # A parameter without a tolerance has no steps for differences.
        halves = {place: half for place, half in halves.items() if half > 0.0}
        return Box(self.nominal, halves, self.teeth, self.normal)

    def by_group(self, values: FloatArray) -> dict[str, FloatArray]:
        """Return one number per parameter as arrays per group; 0 without a tolerance."""
        shapes = _shapes(self.nominal.n_joints)
        found: dict[str, FloatArray] = {}
        for (group, place), value in zip(self.places, values, strict=True):
            found.setdefault(group, np.zeros(shapes[group]))[place] = value
        return found

    @cached_property
    def cones(self) -> FloatArray:
        """Largest change in direction of each shaft that the points permit, in rad, ``(n + 1,)``.

        The directions of at most some angle to a shaft make a convex cone, so the corners of the
        box around the span of two points decide.
        """
        points = self.nominal.points
        if points is None:
            return np.zeros(self.nominal.n_joints + 1)
        sizes = self.by_group(self.sizes).get("points", np.zeros(points.shape))
        spans, reach = np.diff(points, axis=0), sizes[1:] + sizes[:-1]
        signs = np.array(list(product((-1.0, 1.0), repeat=3)))
        moved = spans[:, np.newaxis] + signs * reach[:, np.newaxis]
        across = np.linalg.norm(np.cross(spans[:, np.newaxis], moved), axis=-1)
        along = np.einsum("ij,ikj->ik", spans, moved)
        return np.asarray(np.max(np.arctan2(across, along), axis=-1))

    @cached_property
    def bend_changes(self) -> FloatArray:
        """Largest change of each bend in rad, ``(n,)``."""
        return self.cones[1:] + self.cones[:-1] + self.by_group(self.sizes).get("bends", 0.0)

    def check(self) -> None:
        """Check that no driveline within the box has a bend of 90° or a joint that cannot turn."""
        times = _FARTHEST["normal" if self.normal else "uniform"]
        halves = {place: times * half for place, half in self.halves.items()}
        wide = self if times == 1.0 else Box(self.nominal, halves, {}, self.normal)
        most = self.nominal.bends + wide.bend_changes
        # It contains the changes of direction of both shafts, which stay below 90 deg with it.
        where = " at six standard deviations" if self.normal else ""
        wrong = np.flatnonzero(~(most < np.pi / 2))
        layout = "bends" if self.nominal.points is None else "points"
        if wrong.size:
            joint = int(wrong[0])
            bend, rule = f"{np.degrees(most[joint]):.6g} deg", "every bend must stay below 90 deg"
            problem = f"permit a bend of {bend} at joint {joint}{where}; {rule}"
            raise ArgumentValueError(layout, problem)
        given = [group for group in JOINT_GROUPS if any(place[0] == group for place in halves)]
        own = self.nominal.deviations
        if not given and (own is None or not wide.bend_changes.any()):
            return
        sizes = wide.by_group(wide.sizes)
        turned = sum((sizes[group] for group in given), np.zeros(self.nominal.n_joints))
        if own is not None:
            turned += np.abs(own).sum(axis=-1)
        # Enough for any joint to turn; without tolerances the exact condition is checked.
        wrong = np.flatnonzero(~(turned + most < np.pi / 2))
        if wrong.size:
            joint = int(wrong[0])
            raise ArgumentValueError(
                given[0] if given else layout,
                f"and the others permit deviations of {np.degrees(turned[joint]):.6g} deg "
                f"and a bend of {np.degrees(most[joint]):.6g} deg together at joint {joint}"
                f"{where}; their sum must stay below 90 deg so that the joint can turn",
            )


@dataclass(frozen=True, eq=False)
class Sizes:
    """The tolerances by group, and the arguments of ``tolerances`` of the same names."""

    each: Mapping[str, ArrayLike | None]
    teeth: ArrayLike | None = None
    distribution: str = "uniform"
    degrees: bool = False


def boxes(line: Driveline, sizes: Sizes) -> tuple[tuple[int, ...], Driveline, list[Box]]:
    """Return the boxes of ``Driveline.tolerances``, with all arguments checked.

    The shape of the tolerances may extend that of the batch; drivelines and boxes are flat.
    """
    own = _shapes(line.n_joints)
    check_choice("distribution", sizes.distribution, ("uniform", "normal"))
    arrays = {
        group: _tolerance(group, value, own[group], sizes.degrees and group != "points")
        for group, value in sizes.each.items()
        if value is not None
    }
    if sizes.teeth is not None:
        own["teeth"] = own["phases"]
        arrays["teeth"] = _half_tooth(sizes.teeth, own["teeth"])
    problem = f"are missing; give at least one of {', '.join(GROUPS)} and teeth"
    require("tolerances", arrays, problem)
    _check_points(line, arrays)
    given = {group: (array, len(own[group])) for group, array in arrays.items()}
    shape, full = together(given, driveline=line.shape)
    count = math.prod(shape)
    spread = {
        group: array.reshape(count, *own[group]) for group, array in zip(arrays, full, strict=True)
    }
    geometry = line._geometry.batched(shape).reshaped((count,))
    none = [None] * count
    points = geometry.points if "points" in arrays else none
    deviations = geometry.deviations if geometry.is_as_built else none
    each = []
    for i, drawn in enumerate(zip(*geometry[:3], points, deviations, strict=True)):
        tooth = _positive("phases", spread["teeth"][i]) if "teeth" in spread else {}
        halves: dict[ParameterPlace, float] = {}
        for group in GROUPS:
            halves |= _positive(group, spread[group][i]) if group in spread else {}
        halves |= {place: halves.get(place, 0.0) + half for place, half in tooth.items()}
        box = Box(Nominal(*drawn), halves, tooth, sizes.distribution == "normal")
        box.check()
        each.append(box)
    return shape, line._of(geometry), each


def _shapes(n: int) -> dict[str, tuple[int, ...]]:
    """The shapes of the parameters of one driveline by group."""
    layout: dict[str, tuple[int, ...]] = {group: parameter_shape(group, n) for group in PARAMETERS}
    return {**layout, **dict.fromkeys(JOINT_GROUPS, (n,))}


def _tolerance(name: str, value: ArrayLike, own: tuple[int, ...], degrees: bool) -> FloatArray:
    array = as_float64(name, value)
    right = (array >= 0.0) & np.isfinite(array)
    check_elements(name, array, right, "; a tolerance must be finite and not negative")
    if name == "points" and array.shape[-2:] == (own[0], 1):
        array = np.repeat(array, 3, axis=-1)
    return _of_each(name, np.radians(array) if degrees else array, own)


def _half_tooth(teeth: ArrayLike, own: tuple[int, ...]) -> FloatArray:
    """Half the pitch of each spline in rad."""
    array = as_float64("teeth", teeth)
    right = (array >= 1.0) & (array == np.floor(array)) & np.isfinite(array)
    check_elements("teeth", array, right, "; it must be a whole number, at least 1")
    return _of_each("teeth", np.asarray(np.pi / array), own)


def _of_each(name: str, array: FloatArray, own: tuple[int, ...]) -> FloatArray:
    """One number for all parameters of a group, or one for each on the last axes."""
    if array.ndim == 0:
        return np.full(own, array)
    wanted = ", ".join(map(str, own))
    right = array.shape[-len(own) :] == own
    check_shape(name, array, right, f"it must be one number or (..., {wanted})")
    return array


def _check_points(line: Driveline, arrays: Mapping[str, Any]) -> None:
    if "points" not in arrays:
        return
    problem = "have tolerances, but the driveline was not made from points"
    require("points", line._geometry.lengths.shape[-1], problem)
    for group in ("bends", "twists"):
        problem = "do not go with points: the points determine bends and twists"
        require(group, group not in arrays, problem)


def _positive(group: str, array: FloatArray) -> dict[ParameterPlace, float]:
    """The tolerances above 0 by place."""
    return {
        (group, tuple(map(int, place))): float(array[tuple(place)])
        for place in np.argwhere(array > 0.0)
    }
