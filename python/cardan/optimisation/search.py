"""The search for the best variables: from several starts, with a local solver, on teeth."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.optimisation.local import MARGIN, TOLERANCE, local_best
from cardan.optimisation.measures import Vectors
from cardan.optimisation.problem import Problem

# Points that are evaluated at once.
_BLOCK = 4096

# So many random points are compared for each start that is followed.
_SCREENED = 8

# A goal so much smaller than at the start is rounding, and no start can do better.
_NOTHING = 1e-10

# After a search, the goal has another size; it is searched again until it shrinks by less.
_SHRINKS, _ROUNDS = 0.99, 6

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
        """What to compare: first the limits, then the goal."""
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
        if found[-1].rank <= (0.0, _NOTHING * first.size):
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
        if settled or best.rank <= (0.0, _NOTHING * start.size):
            break
    return best


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
