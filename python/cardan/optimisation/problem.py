"""A layout problem: the driveline that variables make, its quantities, and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.driveline import Driveline
from cardan.geometry.parameters import LayoutVariables
from cardan.optimisation.measures import Measure, Vectors, over_states

# Steps of central differences, as a share of the scale of a variable: the third root of the
# rounding error balances it against the error of the formula.
_STEP = 6e-6


@dataclass(frozen=True)
class Parameter:
    """What a variable changes: parameters of the driveline, in every state alike."""

    kind: LayoutVariables
    place: tuple[Any, ...]  # an index behind the batch axes: ``(slice(0, 2),)``, ``(2, 1)``
    factor: float = 1.0  # by how much each changes per unit of the variable


@dataclass(frozen=True, eq=False)
class Problem:
    """What to minimise over which ``m`` variables."""

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
        """Return the derivatives of the vectors by the variables, ``(states, r, m)`` each."""
        found: list[Vectors | None] = [None] * len(self.measures)
        if self.jac is not None:
            by_q = np.asarray(self.jac(x))
            wanted = (len(self.weights), len(x))
            if by_q.shape != wanted:
                raise ArgumentValueError(
                    "jac", f"returned shape {by_q.shape}; it must be states by variables, {wanted}"
                )
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
        """The derivatives of the measures of which those by parameters are known."""
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


def _no_driveline(found: object) -> ArgumentTypeError:
    problem = f"returned {type(found).__name__}; it must return a Driveline"
    return ArgumentTypeError("lines_of", problem)


def many_of(lines: object, count: int) -> Driveline:
    """Return drivelines of several sets of variables, ``(count, states)``, or say what they are."""
    if not isinstance(lines, Driveline):
        raise _no_driveline(lines)
    if len(lines.shape) != 2 or lines.shape[0] != count or 0 in lines.shape:
        raise ArgumentValueError(
            "lines_of", f"returned a batch {lines.shape}; vectorised, it must be ({count}, states)"
        )
    return lines


def states_of(line: object) -> Driveline:
    """Return a driveline with one batch axis, or say what it is."""
    if not isinstance(line, Driveline):
        raise _no_driveline(line)
    if len(line.shape) > 1 or 0 in line.shape:
        raise ArgumentValueError(
            "lines_of", f"returned a batch {line.shape}; its one axis must be the states"
        )
    return line if line.shape else Driveline._of(line._geometry.batched((1,)))
