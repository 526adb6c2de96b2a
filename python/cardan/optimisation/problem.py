"""A layout problem: the driveline that variables make, its quantities, and their derivatives.

The quantities that are minimised or kept below a limit are vectors that are smooth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray, import_optional
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, require
from cardan.design.quantities import (
    MOTION_QUANTITIES,
    Amplitude,
    MotionQuantity,
    ReducedQuantity,
    nearest_quantity,
    reduced_quantity,
)
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.geometry.parameters import LayoutVariables, Parameters, parameter_shape

Vectors: TypeAlias = NDArray[np.float64] | NDArray[np.complex128]

VectorsBy: TypeAlias = Mapping[LayoutVariables, Vectors]

QuantityLike: TypeAlias = str | Callable[[Driveline], Any]
"""A name of a quantity, or a function of a driveline with one value for each state."""


# That of a bend of 89.99997°, above which no limit counts.
_LARGEST_MODULUS = 1.0 - 1e-6


def _itself(value: Any) -> Any:  # noqa: ANN401 - a number or an array
    return value


@dataclass(frozen=True, eq=False)
class Measure:
    """A quantity whose figure grows with the length of a vector that is smooth.

    The equivalent bend goes as the root of ``|q|`` and has an infinite slope at constant velocity.
    Its vector is ``q``, so that ``|q|**2`` is smooth everywhere. Derivatives of the vectors by some
    kinds of parameters of the drivelines are ``(*batch, r, *parameters)``.
    """

    name: str
    unit: str  # SI, of its figure; "1" for a ratio, "" if unknown
    vectors: Callable[[Driveline], Vectors]  # (*batch, r), the largest of which counts
    figure: Callable[[Any], Any] = _itself  # from the length of a vector
    length: Callable[[float], float] = _itself  # of a vector, from the figure
    derivatives: Callable[[Driveline, Collection[LayoutVariables]], VectorsBy] | None = None
    of_q: bool = False  # whether the vector is ``q`` of the last shaft
    largest: float = math.inf  # what a limit must be below

    def per_state(self, vectors: Vectors) -> FloatArray:
        """Return the figure of each state, ``(states,)``."""
        return np.asarray(self.figure(np.max(np.abs(vectors), axis=-1)))


def over_states(vectors: Vectors, weights: FloatArray | None) -> float:
    """Return the length of vectors ``(states, r)`` that counts: the largest, or a weighted mean."""
    squares = np.abs(vectors) ** 2
    if weights is None:
        return float(np.sqrt(np.max(squares)))
    return float(np.sqrt(weights @ np.mean(squares, axis=-1)))


def measure_of(
    argument: str,
    quantity: QuantityLike,
    n_joints: int,
    load: Load | None,
    speed: FloatArray | None = None,
) -> Measure:
    """Return the measure of a quantity, which ``argument`` names in errors.

    It is a name of ``MOTION_QUANTITIES`` or of a reduced output, or a function of a driveline.
    Without a speed of the drive, one or ``(states,)``, excitations are over its square.
    """
    if callable(quantity):
        return _of_function(argument, quantity)
    if not isinstance(quantity, str):
        problem = f"is {quantity!r}; it must be a name or a function of a driveline"
        raise ArgumentTypeError(argument, problem)
    if quantity in MOTION_QUANTITIES:
        of = MOTION_QUANTITIES[quantity]
        if not of.of_last and n_joints == 1:
            problem = f"is {quantity!r}; one joint has no shaft between two joints"
            raise ArgumentValueError(argument, problem)
        return _of_motion(argument, of, None if speed is None else np.square(speed))
    reduced = reduced_quantity(quantity)
    if reduced is None:
        raise ArgumentValueError(argument, f"is {quantity!r}; {nearest_quantity(quantity)}")
    if reduced.output.needs_load and load is None:
        raise ArgumentValueError(argument, f"is {quantity!r}; it needs a load")
    return _of_output(quantity, reduced, load)


def _of_motion(argument: str, of: MotionQuantity, squared: FloatArray | None) -> Measure:
    """The measure of a quantity of the motion, at the square of the drive speed of each state."""
    unit, common, scale = of.unit, 1.0, np.ones(1)
    if of.needs_speed:
        unit = "1" if squared is None else of.unit
        scale = np.atleast_1d(np.asarray(1.0 if squared is None else squared))
        if of.of_last:
            # It is no multiple of the vector, so the speed cannot be part of that.
            if np.ptp(scale) > 0.0:
                problem = f"is {of.name!r}; it needs the same speed in all states"
                raise ArgumentValueError(argument, problem)
            common, scale = float(scale[0]), np.ones(1)

    def vectors(line: Driveline) -> Vectors:
        found = [_amplitude(line, kind) for kind in of.amplitudes]
        return np.stack(found, axis=-1) * scale[:, np.newaxis]

    def derivatives(line: Driveline, by: Collection[LayoutVariables]) -> VectorsBy:
        found = {kind: _motion_derivatives(of, line, kind) for kind in by}
        return {
            kind: own * scale.reshape(-1, *(1 for _ in range(own.ndim - len(line.shape))))
            for kind, own in found.items()
        }

    def figure(length: Any) -> Any:  # noqa: ANN401 - a number or an array
        return common * of.ratio(length)

    def length(value: float) -> float:
        # The last shaft moves as one joint does, with |q| < 1; a sum of several has no end.
        high = _LARGEST_MODULUS if of.of_last else value
        if figure(high) <= value:
            return high
        root = import_optional("scipy", "optimise").optimize.brentq
        tolerances = {"xtol": 1e-300, "rtol": 4.0 * np.finfo(float).eps, "maxiter": 500}
        return float(root(lambda k: figure(k) - value, 0.0, high, **tolerances))

    return Measure(of.name, unit, vectors, figure, length, derivatives, of.of_last, of.largest)


def _motion_derivatives(of: MotionQuantity, line: Driveline, by: LayoutVariables) -> Vectors:
    """The derivatives of the amplitudes of a quantity, ``(*batch, r, *parameters)``."""
    if by == "lengths" or by == "positions":
        # The motion depends on neither lengths nor bearings.
        own = parameter_shape(by, line.n_joints, line.n_bearings)
        return np.zeros((*line.shape, len(of.amplitudes), *own))
    found = [_amplitude_derivatives(line, kind, by) for kind in of.amplitudes]
    return np.stack(found, axis=len(line.shape))


def _amplitude(line: Driveline, kind: Amplitude) -> NDArray[np.complex128]:
    """A complex number that ``MotionQuantity.amplitudes`` names, in the shape of the batch."""
    if kind == "last":
        return np.asarray(line.transmission().q)
    driven = line if kind == "driving" else line.reversed()
    total = np.zeros(line.shape, dtype=np.complex128)
    for shaft in range(1, line.n_joints):
        total += driven.transmission(shaft).q
    return total


def _amplitude_derivatives(
    line: Driveline, kind: Amplitude, by: Parameters
) -> NDArray[np.complex128]:
    """Return derivatives of ``_amplitude`` in parameters, ``(*batch, *parameters)``."""
    if kind == "last":
        return line.transmission().dq(by)
    driven = line if kind == "driving" else line.reversed()
    total = sum(driven.transmission(shaft).dq(by) for shaft in range(1, line.n_joints))
    # Driven from its other end, a driveline counts its parameters from there.
    return np.asarray(total if kind == "driving" else np.flip(total, axis=len(line.shape)))


def _of_output(name: str, reduced: ReducedQuantity, load: Load | None) -> Measure:
    def vectors(line: Driveline) -> Vectors:
        return reduced.of(line, load)[..., np.newaxis]

    def derivatives(line: Driveline, by: Collection[LayoutVariables]) -> VectorsBy:
        found = reduced.derivatives(line, load, by)
        return {kind: np.expand_dims(own, len(line.shape)) for kind, own in found.items()}

    return Measure(name, reduced.unit, vectors, derivatives=derivatives)


def _of_function(argument: str, function: Callable[[Driveline], Any]) -> Measure:
    name = getattr(function, "__name__", "function")

    def vectors(line: Driveline) -> Vectors:
        values = np.asarray(function(line), dtype=np.float64)
        if values.shape != line.shape:
            rule = f"it must return one value for each state, {line.shape}"
            raise ArgumentValueError(argument, f"returned shape {values.shape}; {rule}")
        return values[..., np.newaxis]

    return Measure(name, "", vectors)


# Steps of central differences, as a share of the scale of a variable: the third root of the
# rounding error balances it against the error of the formula.
_STEP = 6e-6


@dataclass(frozen=True)
class Parameter:
    """Change by a variable: parameters of the driveline, in every state alike."""

    kind: LayoutVariables
    place: tuple[Any, ...]  # an index behind the batch axes: ``(slice(0, 2),)``, ``(2, 1)``
    factor: float = 1.0  # by how much each changes per unit of the variable


@dataclass(frozen=True, eq=False)
class Problem:
    """Quantity to minimise, and the ``m`` variables."""

    lines_of: Callable[[FloatArray], Driveline]  # its batch is the states
    low: FloatArray  # lower bounds, (m,); -inf where there is none
    high: FloatArray
    scale: FloatArray  # what counts as a large change of each variable, (m,)
    goal: Measure
    keep: tuple[Measure, ...]  # with limits
    lengths: FloatArray  # the largest that each of them permits
    rms: bool  # whether to minimise the root mean square over the states and not the largest
    weights: FloatArray  # of the states in the mean, (states,), with sum 1
    jac: Callable[[FloatArray], NDArray[np.complex128]] | None  # of ``q`` of the last shaft
    vectorised: bool  # whether ``lines_of`` takes points (p, m) and returns a batch (p, states)
    parameters: tuple[Parameter, ...] = ()  # of which the variables are changes, if known

    @property
    def measures(self) -> tuple[Measure, ...]:
        """The goal, then the quantities with limits."""
        return (self.goal, *self.keep)

    def vectors_at(self, points: FloatArray) -> list[Vectors]:
        """Return the vectors of all measures at points ``(p, m)``, ``(p, states, r)`` each."""
        return self._of(points, self.measures)

    def _of(self, points: FloatArray, measures: Sequence[Measure]) -> list[Vectors]:
        if self.vectorised:
            line = many_of(self.lines_of(points), len(points))
            return [measure.vectors(line) for measure in measures]
        lines = [states_of(self.lines_of(x)) for x in points]
        found: list[Vectors] = []
        for measure in measures:
            every: Any = [measure.vectors(line) for line in lines]
            found.append(np.stack(every))
        return found

    def derivatives(self, x: FloatArray) -> list[Vectors]:
        """Return the derivatives of the vectors in the variables, ``(states, r, m)`` each."""
        found: list[Vectors | None] = [None] * len(self.measures)
        if self.jac is not None:
            by_q = np.asarray(self.jac(x))
            wanted = (len(self.weights), len(x))
            problem = f"returned shape {by_q.shape}; it must be states by variables, {wanted}"
            require("jac", by_q.shape == wanted, problem)
            for i, measure in enumerate(self.measures):
                found[i] = by_q[:, np.newaxis, :] if measure.of_q else None
        if self.parameters:
            found = self._exact(x)
        missing = [i for i, known in enumerate(found) if known is None]
        if missing:
            measures = [self.measures[i] for i in missing]
            for i, difference in zip(missing, self._differences(x, measures), strict=True):
                found[i] = difference
        return [known for known in found if known is not None]

    def _exact(self, x: FloatArray) -> list[Vectors | None]:
        """Return the vectors with exact derivatives; ``None`` for measures without them."""
        line = states_of(self.lines_of(x))
        found: list[Vectors | None] = []
        for measure in self.measures:
            if measure.derivatives is None:
                found.append(None)
                continue
            by = measure.derivatives(line, {parameter.kind for parameter in self.parameters})
            columns = []
            for one in self.parameters:
                own = by[one.kind][(slice(None), slice(None), *one.place)]
                columns.append(one.factor * np.sum(own, axis=tuple(range(2, own.ndim))))
            found.append(np.stack(columns, axis=-1))
        return found

    def _differences(self, x: FloatArray, measures: Sequence[Measure]) -> list[Vectors]:
        points, factors = [], []
        for i, step in enumerate(_STEP * self.scale):
            # Within the bounds, beyond which there may be no driveline.
            if x[i] + step > self.high[i]:
                stencil: tuple[tuple[float, float], ...] = ((-2.0, 0.5), (-1.0, -2.0), (0.0, 1.5))
            elif x[i] - step < self.low[i]:
                stencil = ((2.0, -0.5), (1.0, 2.0), (0.0, -1.5))
            else:
                stencil = ((1.0, 0.5), (-1.0, -0.5))
            for steps, factor in stencil:
                moved = x.copy()
                moved[i] += steps * step
                points.append(moved)
                row = np.zeros(len(x))
                row[i] = factor / step
                factors.append(row)
        weights = np.array(factors)
        return [
            np.tensordot(found, weights, axes=(0, 0))
            for found in self._of(np.array(points), measures)
        ]

    def size(self, vectors: Sequence[Vectors]) -> float:
        """Return the length that is minimised."""
        return over_states(vectors[0], self.weights if self.rms else None)

    def excess(self, vectors: Sequence[Vectors]) -> float:
        """Return by which factor, less 1, the worst limit is exceeded; 0 if all are kept."""
        shares = [
            float(np.max(np.abs(found))) / length
            for found, length in zip(vectors[1:], self.lengths, strict=True)
        ]
        return max(0.0, max(shares, default=0.0) - 1.0)


def _of_batch(found: object, right: Callable[[tuple[int, ...]], bool], rule: str) -> Driveline:
    """Return what a function of variables returned, a driveline with a batch that is right."""
    if not isinstance(found, Driveline):
        problem = f"returned {type(found).__name__}; it must return a Driveline"
        raise ArgumentTypeError("lines_of", problem)
    is_right = right(found.shape) and 0 not in found.shape
    require("lines_of", is_right, f"returned a batch {found.shape}; {rule}")
    return found


def many_of(lines: object, count: int) -> Driveline:
    """Return drivelines of several sets of variables, ``(count, states)``, or say what they are."""
    rule = f"vectorised, it must be ({count}, states)"
    return _of_batch(lines, lambda shape: len(shape) == 2 and shape[0] == count, rule)


def states_of(line: object) -> Driveline:
    """Return a driveline with one batch axis, or say what it is."""
    found = _of_batch(line, lambda shape: len(shape) <= 1, "its one axis must be the states")
    return found if found.shape else Driveline._of(found._geometry.batched((1,)))
