"""The search for the best variables: from several starts, with a local solver, on teeth.

The local solver is SciPy's sequential quadratic programming on squared lengths. The largest of
several values has kinks; a further variable ``t`` that bounds them all has none: minimise ``t``
with every ``|z|**2 <= t``. If limits are exceeded, their largest share is minimised first in the
same way.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray, import_optional
from cardan.arrays.errors import ArgumentValueError
from cardan.optimisation.problem import Problem, Vectors

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
        """Return the values that must not be negative."""
        values, t = self.terms(y)[0], 0.0 if self.rms else y[self.count]
        bounded = [t - own for own in values[self.bounded]]
        return np.concatenate([np.zeros(0), *bounded, *(1.0 - own for own in values[self.limited])])

    def margin_slopes(self, y: FloatArray) -> FloatArray:
        """Return the derivatives of the margins with respect to ``y``."""
        slopes, of_t = self.terms(y)[1], 0 if self.rms else 1
        rows = [np.hstack([-own, np.ones((len(own), of_t))]) for own in slopes[self.bounded]]
        rows += [np.hstack([-own, np.zeros((len(own), of_t))]) for own in slopes[self.limited]]
        return np.vstack([np.zeros((0, self.count + of_t)), *rows])

    def goal(self, y: FloatArray) -> float:
        """Return the value minimised: ``t``, or the weighted mean of the squared lengths."""
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
        """Return the weight of each squared length: those of the states, in equal parts."""
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


# Points that are evaluated at once.
_BLOCK = 4096

# So many random points are compared for each start that is followed.
_SCREENED = 8

NOTHING = 1e-10
"""A goal so much smaller than at the start is rounding, and no start can do better."""

# After a search, the goal has another size; it is searched again until it shrinks by less.
_SHRINKS, _ROUNDS = 0.99, 6

# A goal so much smaller than at the start may be 0; so many steps lead there.
_NEAR_ZERO, _ZERO_STEPS = 1e-3, 30

# So many settings of splines are compared at once, and so many followed with other variables.
_SETTINGS, _FOLLOWED = 1024, 6


@dataclass(frozen=True, eq=False)
class Candidate:
    """Variables, the vectors of all measures, the length to minimise and the worst excess."""

    x: FloatArray
    vectors: Sequence[Vectors]
    size: float
    excess: float

    @property
    def rank(self) -> tuple[float, float]:
        """Sort key: first the limits, then the goal."""
        return (self.excess if self.excess > TOLERANCE else 0.0, self.size)


def candidates(problem: Problem, points: FloatArray) -> list[Candidate]:
    """Return points ``(p, m)`` as candidates, without those that make no driveline."""
    found: list[Candidate] = []
    for first in range(0, len(points), _BLOCK):
        found += _block(problem, points[first : first + _BLOCK])
    return found


def _block(problem: Problem, points: FloatArray) -> list[Candidate]:
    try:
        every = problem.vectors_at(points)
    except ArgumentValueError:
        # One of the points makes no driveline; the others are found one by one.
        if len(points) < 2:
            return []
        half = len(points) // 2
        return _block(problem, points[:half]) + _block(problem, points[half:])
    found = []
    for i, x in enumerate(points):
        vectors = [own[i] for own in every]
        if all(np.all(np.isfinite(own)) for own in vectors):
            one = Candidate(x, vectors, problem.size(vectors), problem.excess(vectors))
            found.append(one)
    return found


def search(
    problem: Problem,
    first: Candidate,
    spans: FloatArray,
    starts: int,
    steps: Mapping[int, float],
    half_turn: float,
    seed: int,
) -> Candidate:
    """Return the best candidate of searches from ``first`` and from points drawn from the spans.

    Variables with teeth, by number in ``steps``, change by whole ones and repeat after half a turn.
    """
    everywhere = np.ones(len(first.x), dtype=bool)
    found = [first]
    for start in _starts(problem, first, spans, starts, seed):
        found.append(_settled(problem, start, everywhere))
        if found[-1].rank <= (0.0, NOTHING * first.size):
            break
    if steps:
        return _on_teeth(problem, first, found, steps, half_turn)
    return min(found, key=lambda one: one.rank)


def _starts(
    problem: Problem, first: Candidate, spans: FloatArray, starts: int, seed: int
) -> list[Candidate]:
    """The start, and the best of many points that are spread evenly in each variable."""
    generator = np.random.default_rng(seed)
    count, m = _SCREENED * (starts - 1), len(first.x)
    cells = generator.permuted(np.tile(np.arange(count), (m, 1)), axis=-1).T
    shares = (cells + generator.random((count, m))) / max(count, 1)
    points = spans[0] + shares * (spans[1] - spans[0])
    drawn = sorted(candidates(problem, points), key=lambda one: one.rank)
    return [first, *drawn[: starts - 1]]


def _settled(problem: Problem, start: Candidate, free: NDArray[np.bool_]) -> Candidate:
    """The local best from a start, changing the free variables only."""
    best = start
    for _ in range(_ROUNDS):
        x = local_best(problem, best.x, best.size, best.excess, free)
        moved = candidates(problem, x[np.newaxis])
        if not moved or not moved[0].rank < best.rank:
            return best
        tried = moved[0]
        settled = tried.rank[0] == best.rank[0] and tried.size > _SHRINKS * best.size
        best = tried
        if settled or best.rank <= (0.0, NOTHING * start.size):
            break
    return _at_zero(problem, best, free) if best.size < _NEAR_ZERO * start.size else best


def _at_zero(problem: Problem, near: Candidate, free: NDArray[np.bool_]) -> Candidate:
    """The best near a goal of 0 by least squares within the bounds.

    Squared lengths are so flat there that the solver ends before.
    """

    def moved(y: FloatArray) -> FloatArray:
        x = near.x.copy()
        x[free] = y * problem.scale[free]
        return x

    def parts(values: NDArray[Any]) -> FloatArray:
        return np.concatenate([values.real, values.imag])

    def missed(y: FloatArray) -> FloatArray:
        return parts(problem.vectors_at(moved(y)[np.newaxis])[0].ravel())

    def slopes(y: FloatArray) -> FloatArray:
        by = problem.derivatives(moved(y))[0]
        return parts(by.reshape(-1, by.shape[-1])[:, free] * problem.scale[free])

    ends = [own[free] / problem.scale[free] for own in (near.x, problem.low, problem.high)]
    least = import_optional("scipy", "optimise").optimize.least_squares
    exact = dict.fromkeys(("ftol", "xtol", "gtol"), 1e-15)
    try:
        found = least(missed, ends[0], slopes, ends[1:], "dogbox", max_nfev=_ZERO_STEPS, **exact)
    except ArgumentValueError:
        # A trial step made no driveline.
        return near
    return min([near, *candidates(problem, moved(found.x)[np.newaxis])], key=lambda one: one.rank)


def _on_teeth(
    problem: Problem,
    first: Candidate,
    found: Sequence[Candidate],
    steps: Mapping[int, float],
    half_turn: float,
) -> Candidate:
    """The best candidate of which some variables differ from the start by whole teeth.

    All settings are compared if they are not too many, otherwise those next to the local bests.
    The best settings are followed with the other variables free.
    """
    phases = list(steps)
    free = np.ones(len(first.x), dtype=bool)
    free[phases] = False
    best = first
    allowed = _allowed(problem, first.x, steps, half_turn)
    settings = np.array(_settings(allowed, [one.x[phases] for one in found], half_turn))
    bases = sorted(found, key=lambda one: one.rank)[: _FOLLOWED if np.any(free) else 1]
    points = np.repeat([one.x for one in bases], len(settings), axis=0)
    points[:, phases] = np.tile(settings, (len(bases), 1))
    tried = sorted(candidates(problem, points), key=lambda one: one.rank)
    for one in tried[: _FOLLOWED if np.any(free) else 1]:
        settled = _settled(problem, one, free) if np.any(free) else one
        best = min(best, settled, key=lambda known: known.rank)
    return best


def _allowed(
    problem: Problem, start: FloatArray, steps: Mapping[int, float], half_turn: float
) -> list[FloatArray]:
    """The values of each variable with teeth, over half a turn or within its bounds."""
    allowed = []
    for i, teeth in steps.items():
        pitch = 2.0 * half_turn / teeth
        # With an odd number of teeth half a turn is no whole number of them.
        count = teeth if teeth % 2 else max(teeth // 2, 1)
        values = start[i] + pitch * (np.arange(count) - (count - 1) // 2)
        room = MARGIN * pitch
        inside = (values >= problem.low[i] - room) & (values <= problem.high[i] + room)
        allowed.append(np.clip(values[inside], problem.low[i], problem.high[i]))
    return allowed


def _settings(
    allowed: Sequence[FloatArray], near: Sequence[FloatArray], half_turn: float
) -> list[tuple[float, ...]]:
    """Settings of the variables with teeth: all, or those next to some values of them."""
    if math.prod(len(values) for values in allowed) <= _SETTINGS:
        return list(itertools.product(*allowed))
    found: set[tuple[float, ...]] = set()
    for at in near:
        own = []
        for place, values in zip(at, allowed, strict=True):
            off = values - place
            off = np.abs(off - half_turn * np.round(off / half_turn))
            own.append(values[np.argsort(off)[:3]])
        found.update(itertools.islice(itertools.product(*own), _SETTINGS))
    return sorted(found)
