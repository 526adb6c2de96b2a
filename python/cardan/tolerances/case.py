"""A driveline with its tolerances, in one state or several: worst cases, bounds and shares."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import ComplexArray, FloatArray
from cardan.design.quantities import (
    Amplitude,
    MotionQuantity,
    OrderQuantity,
    ReducedQuantity,
    farthest_signs,
    order_amplitude,
)
from cardan.evaluation.load import Load
from cardan.geometry.parameters import PARAMETERS, LayoutVariables
from cardan.tolerances.box import JOINT_GROUPS, Box
from cardan.tolerances.chain import Deviations, Nominal, amplitude, deviated, largest_modulus

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Quantity: TypeAlias = MotionQuantity | OrderQuantity | ReducedQuantity

# Differences by this part of a tolerance: 9 digits remain, and a tolerance is a small change.
_STEP = 1e-4

# Every trial of an order or a reduced output is an evaluation over a turn.
_MOST_OVER_A_TURN = 10

# Deviating drivelines at a time: each has its geometry with directions and normals.
_BLOCK = 2048

# Up to this factor, and until the limit is met this closely.
_LARGEST_FACTOR, _CLOSE, _TRIALS = 1e6, 1e-11, 100
# Until the factor with which a joint blocks is met this closely, where the limit is not reached
# before. Orders of joints that nearly block need very many samples.
_CLOSE_TO_BLOCKED = 1e-3


@dataclass(frozen=True, eq=False)
class Case:
    """One driveline as drawn, the box of its tolerances, and what else its figures depend on."""

    box: Box
    line: Driveline
    shaft: int
    speed: float  # of the drive, in rad/s
    load: Load | None  # of outputs, like the threads
    workers: int | None

    @property
    def is_as_built(self) -> bool:
        """Whether the joints deviate or have tolerances."""
        toleranced = any(group in JOINT_GROUPS for group, _ in self.box.places)
        return toleranced or self.line.has_deviations

    def scaled(self, group: str, factor: float) -> Case:
        """Return the case with the tolerances of one group multiplied."""
        return replace(self, box=self.box.scaled(group, factor))

    def values(
        self, quantities: Mapping[str, Quantity], deviations: FloatArray
    ) -> dict[str, FloatArray]:
        """Return figures by name for deviations ``(parameters, samples)``.

        Each amplitude is found once.
        """
        by_place, samples = self.box.deviations(deviations), deviations.shape[1]
        moduli: dict[Amplitude | int, FloatArray] = {}
        found = {}
        for name, quantity in quantities.items():
            if isinstance(quantity, ReducedQuantity):
                found[name] = self._outputs(quantity, by_place, samples)
                continue
            for kind in quantity.amplitudes:
                if kind not in moduli:
                    moduli[kind] = np.abs(self._amplitude(kind, by_place, samples))
            largest = np.max([moduli[kind] for kind in quantity.amplitudes], axis=0)
            found[name] = np.asarray(quantity.at(largest, self.speed))
        return found

    def _outputs(
        self, quantity: ReducedQuantity, deviations: Deviations, samples: int
    ) -> FloatArray:
        """A reduced output of each sample."""
        of = partial(quantity.of, load=self.load, workers=self.workers)
        return _in_blocks(of, self.line, self.box.nominal, deviations, samples)

    def _amplitude(
        self, kind: Amplitude | int, deviations: Deviations, samples: int
    ) -> ComplexArray:
        """A complex number of each sample: ``q`` or a sum, or the amplitude of an order.

        Drive angles of an order count from the plane of joint 0. Where deviations turn that plane,
        the amplitude is referred to the plane as drawn, so that it changes evenly with them.
        """
        line, nominal = self.line, self.box.nominal
        if isinstance(kind, str):
            return amplitude(kind, nominal, self.shaft, deviations, samples)

        def of(made: Driveline) -> ComplexArray:
            amplitudes = order_amplitude(made, kind, self.shaft)
            if nominal.points is None:
                return amplitudes
            normal, axis = line.normals[0], line.directions[0]
            turned = np.arctan2(
                np.cross(normal, made.normals[:, 0]) @ axis, made.normals[:, 0] @ normal
            )
            return np.asarray(amplitudes * np.exp(-1j * kind * turned))

        found = _in_blocks(of, line, nominal, deviations, samples, np.complex128)
        bend = deviations.get(("bends", (0,)))
        if bend is not None and kind % 2:
            # Beyond straight the plane has turned by half a turn.
            found[nominal.bends[0] + bend < 0.0] *= -1.0
        return found

    def nominal(self, quantity: Quantity) -> float:
        """Return the figure of the driveline as drawn."""
        return float(self._of_units(quantity)(np.zeros((len(self._acting(quantity)), 1)))[0])

    def from_all_corners(self, quantity: Quantity) -> bool:
        """Whether the search for the worst case compares all corners of the box."""
        most = MOST_CORNERS if isinstance(quantity, MotionQuantity) else _MOST_OVER_A_TURN
        return len(self._acting(quantity)) <= most

    def worst(self, quantity: Quantity) -> float:
        """Return the worst figure that is found."""
        return self._search(quantity)[0]

    def worst_at(self, quantity: Quantity) -> FloatArray:
        """Return the deviations of the worst driveline, ``(parameters,)``."""
        found = np.zeros(len(self.box.places))
        acting = self._acting(quantity)
        found[acting] = self._search(quantity)[1] * self.box.sizes[acting]
        return found

    def linear(self, quantity: Quantity) -> float:
        """Return the worst figure to first order."""
        if isinstance(quantity, ReducedQuantity):
            changes = self._slopes_of_output(quantity) * self.box.sizes
            return self.nominal(quantity) + float(np.sum(np.abs(changes)))
        largest = max(map(self._linear_modulus, quantity.amplitudes))
        return float(quantity.at(largest, self.speed))

    def guaranteed(self, quantity: MotionQuantity) -> float:
        """Return a bound of the figure over the box."""
        moduli = (largest_modulus(kind, self.box, self.shaft) for kind in quantity.amplitudes)
        return float(quantity.at(max(moduli), self.speed))

    def shares(self, quantity: Quantity) -> FloatArray:
        """Return the share of each parameter in the scatter, ``(parameters,)``.

        Of several amplitudes, in the scatter of the one that is largest in the worst case.
        """
        if isinstance(quantity, ReducedQuantity):
            changes = np.abs(self._slopes_of_output(quantity) * self.box.sizes)
        else:
            changes = np.abs(self._vectors(max(quantity.amplitudes, key=self._linear_modulus)))
        parts = np.square(changes * (self.box.sigmas / self.box.sizes))
        total = np.sum(parts)
        return np.asarray(parts / total if total > 0.0 else parts)

    def _drawn(self, kind: Amplitude | int) -> complex:
        """An amplitude as drawn."""
        return complex(self._amplitude(kind, {}, 1)[0])

    def _vectors(self, kind: Amplitude | int) -> ComplexArray:
        """Return the effect of each tolerance on an amplitude, to first order."""
        return np.asarray(self._differences(partial(self._amplitude, kind)))

    def _differences(self, of: Callable[[Deviations, int], Any]) -> Any:  # noqa: ANN401
        """Return the first-order effect of each tolerance on a function of many samples."""
        steps = np.diag(np.full(len(self.box.places), _STEP))
        units = np.concatenate([steps, -steps], axis=1)
        by_place = self.box.deviations(units * self.box.sizes[:, np.newaxis])
        plus, minus = np.split(of(by_place, units.shape[1]), 2)
        return np.asarray((plus - minus) / (2.0 * _STEP))

    def _slopes_of_output(self, quantity: ReducedQuantity) -> FloatArray:
        """Return the derivatives of a reduced output with respect to each parameter."""
        used = {group for group, _ in self.box.places}
        joints = not used.isdisjoint(JOINT_GROUPS)
        if "points" in used and self.is_as_built:
            # Outputs of joints as built have no derivatives with respect to points.
            changes = self._differences(partial(self._outputs, quantity))
            return np.asarray(changes / self.box.sizes)
        line = _as_drawn(self.line, self.box.nominal, joints=joints)
        wanted: list[LayoutVariables | Literal["deviations"]] = [
            group for group in PARAMETERS if group in used
        ]
        if joints:
            wanted.append("deviations")
        found = quantity.derivatives(line, self.load, wanted)
        by: dict[str, FloatArray] = {group: own[0] for group, own in found.items()}
        if joints:
            by |= dict(zip(JOINT_GROUPS, by["deviations"].T, strict=True))
        return np.array([by[group][place] for group, place in self.box.places])

    def _linear_modulus(self, kind: Amplitude | int) -> float:
        """The largest magnitude of an amplitude to first order."""
        modulus = zonotope_radius(self._drawn(kind), self._vectors(kind))
        # Large tolerances leave the linear range; a joint has |q| < 1.
        return min(modulus, float(np.nextafter(1.0, 0.0))) if kind == "last" else modulus

    def _acting(self, quantity: Quantity) -> NDArray[np.intp]:
        """Numbers of the parameters on which a figure depends: those of ``q`` on the layout."""
        layout_alone = isinstance(quantity, MotionQuantity)
        acts = [not (layout_alone and group in JOINT_GROUPS) for group, _ in self.box.places]
        return np.flatnonzero(acts)

    def _of_units(self, quantity: Quantity) -> Callable[[FloatArray], FloatArray]:
        """The figure as a function of the acting deviations in units of the tolerances."""
        acting = self._acting(quantity)
        sizes = self.box.sizes[acting, np.newaxis]

        def of(units: FloatArray) -> FloatArray:
            deviations = np.zeros((len(self.box.places), units.shape[1]))
            deviations[acting] = units * sizes
            return self.values({"": quantity}, deviations)[""]

        return of

    def _search(self, quantity: Quantity) -> tuple[float, FloatArray]:
        """The worst driveline: its figure, and the acting deviations in units of the tolerances."""
        # Figures of the same amplitudes have their maximum in one place.
        key: Any = quantity if isinstance(quantity, ReducedQuantity) else quantity.amplitudes
        if key not in self._searches:
            self._searches[key] = self._found(quantity)
        at = self._searches[key]
        return float(self._of_units(quantity)(at[:, np.newaxis])[0]), at

    def _found(self, quantity: Quantity) -> FloatArray:
        """Return the place of the worst driveline, in units of the tolerances."""
        of, count = self._of_units(quantity), len(self._acting(quantity))
        if self.from_all_corners(quantity):
            return largest_in_box(of, all_corners(count))[1]
        drawn = np.random.default_rng(0).choice([-1.0, 1.0], (count, _CORNERS))
        corners = np.concatenate([self._worst_corners(quantity), drawn], axis=1)
        if isinstance(quantity, MotionQuantity):
            return largest_in_box(of, corners)[1]
        # Over a turn, moves within the box take longer than what they add is worth.
        best = corners[:, np.argsort(-of(corners), kind="stable")[:_TURNED]]
        return max((largest_of_corners(of, corner) for corner in best.T), key=lambda one: one[0])[1]

    def _worst_corners(self, quantity: Quantity) -> FloatArray:
        """The corners of the acting parameters that are worst to first order, as columns."""
        if isinstance(quantity, ReducedQuantity):
            signs = [np.where(self._slopes_of_output(quantity) < 0.0, -1.0, 1.0)]
        else:
            signs = [
                farthest_signs(self._drawn(kind), self._vectors(kind))
                for kind in quantity.amplitudes
            ]
        return np.array(signs).T[self._acting(quantity)]

    @cached_property
    def _searches(self) -> dict[Any, FloatArray]:
        return {}


def _in_blocks(
    of: Callable[[Driveline], Any],
    line: Driveline,
    nominal: Nominal,
    deviations: Deviations,
    samples: int,
    dtype: type = np.float64,
) -> NDArray[Any]:
    """Return one number for each sample, found of batches of deviating drivelines."""
    found: NDArray[Any] = np.empty(samples, dtype)
    for first in range(0, samples, _BLOCK):
        some = slice(first, min(first + _BLOCK, samples))
        part = {place: values[some] for place, values in deviations.items()}
        found[some] = of(_deviating(line, nominal, part, some.stop - first))
    return found


def _as_drawn(line: Driveline, nominal: Nominal, *, joints: bool) -> Driveline:
    """Return a batch of one driveline as drawn; from points if they have tolerances.

    With ``joints`` it has deviations, which may be 0.
    """
    made = _deviating(line, nominal, {}, 1)
    return line._of(made._geometry.as_built()) if joints else made


def _deviating(
    line: Driveline, nominal: Nominal, deviations: Deviations, samples: int
) -> Driveline:
    """The drivelines of the samples, with the bearings of the one as drawn."""

    def of(group: str, array: FloatArray) -> FloatArray:
        return deviated(group, array, deviations, samples)

    own, phases = line._geometry, of("phases", nominal.phases)
    if nominal.points is not None:
        made = line.from_points(of("points", nominal.points), phases)._geometry
        lengths = made.lengths
    else:
        bends, twists = of("bends", nominal.bends), of("twists", nominal.twists)
        # Beyond straight a joint bends to the other side: its plane has turned by half a turn.
        flipped = bends < 0.0
        twists += np.pi * (flipped[:, 1:].astype(float) - flipped[:, :-1])
        made = line.from_bends(np.abs(bends), twists, phases)._geometry
        lengths = np.repeat(own.lengths[np.newaxis], samples, axis=0)
    positions = np.repeat(own.positions[np.newaxis], samples, axis=0)
    joints = [place for place in deviations if place[0] in JOINT_GROUPS]
    if joints or own.is_as_built:
        built = np.repeat(own.as_built().deviations[np.newaxis], samples, axis=0)
        for group, (joint,) in joints:
            built[:, joint, JOINT_GROUPS.index(group)] += deviations[group, (joint,)]
        made = made._replace(deviations=built)
    made = made._replace(lengths=lengths, positions=positions, bearings=own.bearings)
    return line._of(made)


@dataclass(frozen=True, eq=False)
class Design:
    """A driveline with its tolerances, in one state or several.

    Its figures are those of the state in which they are largest. The tolerances are the same in all
    states, and so are the deviations of one driveline from its drawing.
    """

    cases: tuple[Case, ...]  # the driveline in each state

    @property
    def box(self) -> Box:
        """The tolerances; the parameters as drawn are those of the first state."""
        return self.cases[0].box

    def scaled(self, group: str, factor: float) -> Design:
        """Return the design with the tolerances of one group multiplied."""
        return replace(self, cases=tuple(case.scaled(group, factor) for case in self.cases))

    def sampled(
        self,
        quantities: Mapping[str, Quantity],
        limits: Mapping[str, float],
        deviations: FloatArray,
    ) -> dict[Any, Any]:
        """Return the largest figure of all states by name, as ``Case.values``.

        By name and state there is also whether the figure is within its limit, if it has one.
        """
        found: dict[Any, Any] = {}
        for state, case in enumerate(self.cases):
            for name, values in case.values(quantities, deviations).items():
                found[name] = np.maximum(found[name], values) if state else values
                if name in limits:
                    found[name, state] = values <= limits[name]
        return found

    def from_all_corners(self, quantity: Quantity) -> bool:
        """Whether the search for the worst case compares all corners of the box."""
        return all(case.from_all_corners(quantity) for case in self.cases)

    def largest(self, of: Callable[[Case, Any], float], quantity: Quantity) -> float:
        """Return the largest of the states of a figure: ``Case.worst`` or another method."""
        return max(of(case, quantity) for case in self.cases)

    def worst_state(self, quantity: Quantity) -> int:
        """Return the number of the state with the worst figure."""
        return int(np.argmax([case.worst(quantity) for case in self.cases]))

    def worst_case(self, quantity: Quantity) -> Case:
        """Return the driveline in that state."""
        return self.cases[self.worst_state(quantity)]


def permitted_factor(
    design: Design, quantity: Quantity, limit: float, group: str, bound: str
) -> float:
    """Return the factor of the tolerances of one group at which a bound reaches the limit.

    It is NaN if the other tolerances alone exceed the limit, infinite without a factor. If joints
    block before the limit is reached, it is the largest factor with which they turn, or up to 0.1 %
    less.
    """

    def excess(factor: float) -> float:
        scaled = design.scaled(group, factor)
        try:
            for case in scaled.cases:
                case.box.check()
        except ValueError:
            return math.inf
        return scaled.largest(getattr(Case, bound), quantity) / limit - 1.0

    return _root(excess)


def _root(excess: Callable[[float], float]) -> float:
    """The zero above 0 of a function that grows; NaN if it is positive at 0, infinite without one.

    By the Illinois form of the rule of false position, and by halves where the function is
    infinite.
    """
    low, below = 0.0, excess(0.0)
    if below > 0.0:
        return math.nan
    high, above = 1.0, excess(1.0)
    while above <= 0.0:
        low, below, high = high, above, 2.0 * high
        if high > _LARGEST_FACTOR:
            return math.inf
        above = excess(high)
    side = 0
    for _ in range(_TRIALS):
        middle = 0.5 * (low + high)
        if math.isfinite(above) and above > below:
            middle = (low * above - high * below) / (above - below)
        if math.isinf(above) and high - low <= _CLOSE_TO_BLOCKED * high:
            return low
        value = excess(middle)
        if abs(value) <= _CLOSE or high - low <= _CLOSE * high:
            return middle
        if value > 0.0:
            high, above = middle, value
            below *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            low, below = middle, value
            above *= 0.5 if side < 0 else 1.0
            side = -1
    return low


# --- the worst within a box -----------------------------------------------------------------------


Value: TypeAlias = Callable[[FloatArray], FloatArray]
"""Figure of deviations in units of the tolerances, ``(parameters, samples)``."""

# So many parameters have all their corners compared; fewer also the middles of edges and faces.
MOST_CORNERS = 16
_MOST_MIDDLES = 8

# So many corners are compared of more parameters, and so many followed if each is a turn.
_CORNERS, _TURNED = 1024, 4

_STARTS = 12
_ROUNDS = 60
_STEPS = np.linspace(-1.0, 1.0, 9)
_ZOOMS = 14


def zonotope_radius(centre: complex, generators: ComplexArray) -> float:
    """Return the largest ``|centre + sum of ± generators|``.

    The sums fill a polygon with two parallel edges per generator. Its vertices follow each other
    when the generators, all pointing upwards, are sorted by their direction; one of the vertices
    is farthest.
    """
    below = (generators.imag < 0.0) | ((generators.imag == 0.0) & (generators.real < 0.0))
    upwards = np.where(below, -generators, generators)
    steps = 2.0 * np.cumsum(upwards[np.argsort(np.angle(upwards))])
    half = np.sum(upwards)
    vertices = np.concatenate(
        [[centre - half, centre + half], centre - half + steps, centre + half - steps]
    )
    return float(np.max(np.abs(vertices)))


def all_corners(parameters: int) -> FloatArray:
    """Return all corners of a box as columns; with few parameters also all middles."""
    levels = (-1.0, 0.0, 1.0) if parameters <= _MOST_MIDDLES else (-1.0, 1.0)
    return np.array(list(product(levels, repeat=parameters)), dtype=float).T


def largest_in_box(value: Value, corners: FloatArray) -> tuple[float, FloatArray]:
    """Return the largest value that is found in a box, and where.

    From the best of the corners ``(parameters, m)`` and the middle one parameter after another
    moves to its best value until none improves. From all corners the result is the maximum over
    the box, unless that is inside and apart from all these starts.
    """
    parameters = len(corners)
    grid = np.concatenate([corners, np.zeros((parameters, 1))], axis=1)
    values = value(grid)
    best = np.argsort(-values, kind="stable")[:_STARTS]
    at, found = grid[:, best].copy(), values[best]
    for _ in range(_ROUNDS):
        before = found.copy()
        for row in range(parameters):
            found = _along(value, at, found, row)
        if np.all(found - before <= 1e-13 * np.abs(before)):
            break
        # Starts that have met go on as one.
        apart = np.sort(np.unique(at, axis=1, return_index=True)[1])
        at, found = at[:, apart].copy(), found[apart]
    top = int(np.argmax(found))
    return float(found[top]), at[:, top]


def largest_of_corners(value: Value, corner: FloatArray) -> tuple[float, FloatArray]:
    """Return the largest value of corners, and the corner.

    They are reached from one by turning one parameter at a time.
    """
    at, best = corner[:, np.newaxis], float(value(corner[:, np.newaxis])[0])
    turned = 1.0 - 2.0 * np.eye(len(corner))
    for _ in range(_ROUNDS):
        values = value(at * turned)
        top = int(np.argmax(values))
        if values[top] <= best:
            break
        at, best = at * turned[:, [top]], float(values[top])
    return best, at[:, 0]


def _along(value: Value, at: FloatArray, found: FloatArray, row: int) -> FloatArray:
    """Move one parameter of every start to where the value is largest; changes ``at``."""
    width = 1.0
    starts = at.shape[1]
    for zoom in range(_ZOOMS):
        centre = at[row] if zoom else np.zeros(starts)
        trials = np.clip(centre + width * _STEPS[:, np.newaxis], -1.0, 1.0)
        moved = np.repeat(at[:, np.newaxis], len(_STEPS), axis=1)
        moved[row] = trials
        values = value(moved.reshape(len(at), -1)).reshape(len(_STEPS), starts)
        top = np.argmax(values, axis=0)
        better = values[top, range(starts)] > found
        at[row] = np.where(better, trials[top, range(starts)], at[row])
        found = np.where(better, values[top, range(starts)], found)
        if zoom and not better.any() and np.all(np.abs(at[row]) == 1.0):
            break
        width *= 0.3
    return found
