"""One local search: SciPy's sequential quadratic programming on squared lengths.

The largest of several values has kinks; a further variable ``t`` that bounds them all has none:
minimise ``t`` with every ``|z|**2 <= t``. If limits are exceeded, their largest share is minimised
first in the same way.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray, import_optional
from cardan.arrays.errors import ArgumentValueError
from cardan.optimisation.problem import Problem

TOLERANCE = 1e-9
"""How far, relatively, a kept quantity may exceed its limit by rounding."""

# So much below its limit, relatively, a quantity is kept, so that the solver's own error and a
# result that is rounded for a drawing do not exceed it.
MARGIN = 1e-6

_Rows = list[FloatArray]


class _Program:
    """A problem around a start, in changes of the free variables over their scale.

    Its unknowns ``y`` are these changes and, if values are to be bounded, ``t``. This bounds the
    squared lengths of the measures ``bounded``; those of ``limited`` stay below 1.
    """

    def __init__(
        self, problem: Problem, x: FloatArray, size: float, excess: float, free: NDArray[np.bool_]
    ) -> None:
        self.problem, self.x, self.free = problem, x, free
        self.scale = problem.scale[free]
        self.count = len(self.scale)
        repair = excess > TOLERANCE
        self.rms = problem.rms and not repair
        self.top = (1.0 + excess) ** 2 if repair else 1.0
        self.bounded = slice(1, None) if repair else slice(0, 0 if self.rms else 1)
        self.limited = slice(0, 0) if repair else slice(1, None)
        self.squares = (size**2 or 1.0, *(((1.0 - MARGIN) * each) ** 2 for each in problem.lengths))
        self._terms: tuple[bytes, _Rows, _Rows] = (b"", [], [])

    def moved(self, y: FloatArray) -> FloatArray:
        """The variables, within their bounds."""
        x, free = self.x.copy(), self.free
        low, high = self.problem.low[free], self.problem.high[free]
        x[free] = np.clip(x[free] + np.nan_to_num(y[: self.count]) * self.scale, low, high)
        return x

    def terms(self, y: FloatArray) -> tuple[_Rows, _Rows]:
        """Squared lengths over their scale, and their derivatives, of all measures."""
        key = y[: self.count].tobytes()
        if self._terms[0] != key:
            x = self.moved(y)
            values, slopes = [], []
            vectors = [own[0] for own in self.problem.vectors_at(x[np.newaxis])]
            triples = zip(vectors, self.problem.derivatives(x), self.squares, strict=True)
            for vector, derivative, square in triples:
                values.append((np.abs(vector) ** 2 / square).ravel())
                slope = 2.0 * np.real(np.conj(vector)[..., np.newaxis] * derivative) / square
                slopes.append(slope.reshape(vector.size, -1)[:, self.free] * self.scale)
            self._terms = (key, values, slopes)
        return self._terms[1:]

    def margins(self, y: FloatArray) -> FloatArray:
        """What must not be negative."""
        values, t = self.terms(y)[0], 0.0 if self.rms else y[self.count]
        bounded = [t - own for own in values[self.bounded]]
        return np.concatenate([np.zeros(0), *bounded, *(1.0 - own for own in values[self.limited])])

    def margin_slopes(self, y: FloatArray) -> FloatArray:
        """The derivatives of the margins by ``y``."""
        slopes, of_t = self.terms(y)[1], 0 if self.rms else 1
        rows = [np.hstack([-own, np.ones((len(own), of_t))]) for own in slopes[self.bounded]]
        rows += [np.hstack([-own, np.zeros((len(own), of_t))]) for own in slopes[self.limited]]
        return np.vstack([np.zeros((0, self.count + of_t)), *rows])

    def goal(self, y: FloatArray) -> float:
        """What is minimised: ``t``, or the weighted mean of the squared lengths."""
        if self.rms:
            values = self.terms(y)[0][0]
            return float(self._weights(values) @ values)
        return float(y[self.count])

    def goal_slope(self, y: FloatArray) -> FloatArray:
        """The derivatives of the goal."""
        if self.rms:
            slopes = self.terms(y)[1][0]
            return np.asarray(self._weights(slopes) @ slopes)
        return np.append(np.zeros(self.count), 1.0)

    def _weights(self, rows: FloatArray) -> FloatArray:
        """Of each squared length in the mean: those of the states, in equal parts."""
        parts = len(rows) // len(self.problem.weights)
        return np.repeat(self.problem.weights / parts, parts)

    def solve(self) -> FloatArray:
        """Return the best ``y`` that the solver finds."""
        low, high = (
            (ends[self.free] - self.x[self.free]) / self.scale
            for ends in (self.problem.low, self.problem.high)
        )
        bounds: list[Any] = list(zip(low, high, strict=True))
        begin = np.zeros(self.count)
        if not self.rms:
            begin, bounds = np.append(begin, self.top), [*bounds, (0.0, None)]
        constraint = {"type": "ineq", "fun": self.margins, "jac": self.margin_slopes}
        with warnings.catch_warnings():
            # A trial step beyond the bounds is clipped, here as well as there.
            warnings.simplefilter("ignore", RuntimeWarning)
            done = import_optional("scipy", "optimise").optimize.minimize(
                self.goal,
                begin,
                jac=self.goal_slope,
                method="SLSQP",
                bounds=bounds,
                constraints=[constraint] if len(self.margins(begin)) else [],
                options={"ftol": 1e-10, "maxiter": 100},
            )
        return np.asarray(done.x)


def local_best(
    problem: Problem, x: FloatArray, size: float, excess: float, free: NDArray[np.bool_]
) -> FloatArray:
    """Return the variables at the end of one run of the solver, which starts at ``x``.

    There the goal has the length ``size``, and the worst limit is exceeded by the factor ``1 +
    excess``.
    """
    program = _Program(problem, x, size, excess, free)
    # Errors of the start, as of a wrong Jacobian, are those of the caller.
    program.terms(np.zeros(program.count))
    try:
        return program.moved(program.solve())
    except ArgumentValueError:
        # A trial step made no driveline.
        return x
