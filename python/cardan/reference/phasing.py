"""Spatial phasing again: the equivalent joint, its number ``q``, the best phases.

Everything is found from the turning yokes of ``cardan.reference``, by looking: where a shaft is
fastest is where its acceleration changes its sign, the equivalent bend is that of the one joint
whose speed varies as much, and the best phases come from a search in which the yokes of every trial
are turned. Derivatives are differences. All angles are in radians; ``shaft`` is by default the
last one.

The searches rest on one property of the angle error of a shaft, which the tests check: it has one
largest and one smallest value in half a turn, as for one joint.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays.errors import ArgumentValueError, require
from cardan.reference.evaluation import falling, slopes
from cardan.reference.vectors import (
    ShaftMotion,
    Shafts,
    _index,
    _joints,
    _lead,
    enough,
    from_bends,
    motion,
)

# Angles of half a turn among which the fastest and the slowest are looked for.
_LOOKS = 64

# Angles at which the yokes of a trial are turned until the phases are nearly right.
_FEW = 12

# Settings that are tried for each phase, by the number of phases; beyond that two.
_TRIED = {1: 24, 2: 24, 3: 6, 4: 4}

# The weight of a turn of the yokes beside the error of the worst setting, from one refinement to
# the next. The last moves the least turn by its square.
_TURNING: tuple[float, ...] = (0.01, 0.001, 1e-4)

# Errors that differ by less, as parts of the worst setting's, are as good.
_AS_GOOD = 1e-9

# Smaller errors of the worst setting are rounding.
_STRAIGHT = 1e-13

# The part of the root of a sum of squares that its rounding may make.
_ROUNDING = 1e-15

# Steps of a refinement at most.
_STEPS = 40


@dataclass(frozen=True)
class EquivalentJoint:
    """The one joint as whose driven shaft a shaft turns, as ``cardan.EquivalentJoint`` has it."""

    bend: float
    angle_offset: float
    max_angle_error: float
    max_angle_error_at: float
    min_speed_ratio: float
    max_speed_ratio: float
    max_acceleration_ratio: float

    @property
    def k(self) -> float:
        """The sine of the largest angle error."""
        return math.sin(self.max_angle_error)

    @property
    def non_uniformity(self) -> float:
        """Largest less smallest speed ratio."""
        return self.max_speed_ratio - self.min_speed_ratio


def equivalent(shafts: Shafts, shaft: int = -1) -> EquivalentJoint:
    """Return the joint as whose driven shaft a shaft turns.

    Errors: those of :func:`cardan.reference.motion`. ``bend`` has that of ``non_uniformity``
    divided by the bend, so that 1e-16 is 1e-8 rad where the shaft turns uniformly. There the
    places, and with them ``angle_offset``, mean nothing.
    """
    stop = _index(shafts, shaft)

    def at(angle: float) -> ShaftMotion:
        return motion(shafts, angle, stop, offset=0.0)

    step = math.pi / _LOOKS
    places = [step * i for i in range(_LOOKS)]
    ratios = [at(angle).speed_ratio for angle in places]
    fastest, slowest = (places[ratios.index(of(ratios))] for of in (max, min))
    fastest = falling(lambda x: at(x).acceleration_ratio, fastest - step, fastest + step)
    slowest = falling(lambda x: -at(x).acceleration_ratio, slowest - step, slowest + step)
    slowest += math.pi * math.ceil((fastest - slowest) / math.pi)
    # From the fastest place to the slowest the shaft gains until its speed is the drive's, and
    # from there to the next fastest place it loses.
    first = falling(lambda x: at(x).speed_ratio - 1.0, fastest, slowest)
    last = falling(lambda x: 1.0 - at(x).speed_ratio, slowest, fastest + math.pi)
    steepest = falling(lambda x: -at(x).jerk_ratio, fastest, slowest)
    least, most = at(slowest).speed_ratio, at(fastest).speed_ratio
    return EquivalentJoint(
        bend=_bend(lambda one: _spread(one) - (most - least)),
        angle_offset=-_turn(fastest),
        max_angle_error=(at(first).angle_error - at(last).angle_error) / 2.0,
        max_angle_error_at=first % math.pi,
        min_speed_ratio=least,
        max_speed_ratio=most,
        max_acceleration_ratio=abs(at(steepest).acceleration_ratio),
    )


def _spread(one: Shafts) -> float:
    """Return the largest less the smallest speed ratio of one joint (Thoma 1920, Hauptlagen)."""
    most, least = (motion(one, x, offset=0.0).speed_ratio for x in (0.0, math.pi / 2))
    return most - least


def _bend(excess: Callable[[Shafts], float]) -> float:
    """Return the bend of the one joint at which a value that grows with the bend is zero."""
    return falling(lambda bend: -excess(from_bends([bend])), 0.0, math.nextafter(math.pi / 2, 0))


def _turn(angle: float) -> float:
    """Return an angle within a quarter turn of 0: after half a turn a yoke looks the same."""
    return math.remainder(angle, math.pi)


# --- transmission -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Transmission:
    """How one shaft follows the drive.

    Attributes:
        q: twice the drive's speed in the angle error of the shaft, which is the imaginary part of
            ``q exp(-2 i angle)`` and of higher orders; ``abs(q)`` is the sine of the largest error.
    """

    q: complex

    def motion(self, angle: float) -> ShaftMotion:
        """Return the motion at a drive angle: that of the one joint whose number is ``q``.

        Errors: as of :func:`cardan.reference.motion` for that joint.
        """
        size = abs(self.q)
        one = from_bends([_bend(lambda joint: abs(_q_of_one(joint)) - size)])
        ahead = (cmath.phase(_q_of_one(one)) - cmath.phase(self.q)) / 2.0
        return motion(one, angle + ahead, offset=0.0)

    def gradient(self, angle: float) -> tuple[complex, complex, complex, complex]:
        """Return the ``q`` derivatives of angle error, speed, acceleration and jerk ratio.

        A change ``dq`` changes each by ``(derivative * dq).real``.

        Errors: 1e-11, relative to the largest of each quantity over ``1 - abs(q)``.
        """

        def at(dq: list[float]) -> tuple[float, ...]:
            there = Transmission(self.q + complex(*dq)).motion(angle)
            rates = (there.speed_ratio, there.acceleration_ratio, there.jerk_ratio)
            return (there.angle_error, *rates)

        by_real, by_imaginary = slopes(at, [0.0, 0.0], step=1e-3 * (1.0 - abs(self.q)))
        error, speed, acceleration, jerk = (by_real - 1j * by_imaginary).tolist()
        return error, speed, acceleration, jerk


def transmission(shafts: Shafts, shaft: int = -1) -> Transmission:
    """Return how a shaft follows the drive, by a plain Fourier sum of its angle error.

    Errors: those of the angle error.
    """
    stop = _index(shafts, shaft)
    return Transmission(_q(shafts, stop, enough(equivalent(shafts, stop).min_speed_ratio)))


def dq(
    laid_out: Callable[[list[float]], Shafts], parameters: Sequence[float], shaft: int = -1
) -> tuple[complex, ...]:
    """Return the derivatives of ``q`` in parameters of a driveline, such as its bends.

    The parameters are at least 0.002 inside the range of each.

    Errors: 1e-11, relative to the smallest speed ratio.
    """
    at = list(parameters)
    stop = _index(laid_out(at), shaft)
    least = equivalent(laid_out(at), stop).min_speed_ratio

    found = slopes(lambda x: _q(laid_out(x), stop, enough(least)), at, step=1e-3 * least)
    return tuple(map(complex, found))


def _q(shafts: Shafts, stop: int, count: int) -> complex:
    """Return ``q`` by so many angles of half a turn, after which everything repeats."""
    angles = [math.pi * i / count for i in range(count)]
    leads = [_lead(_joints(shafts, angle)[:stop]) for angle in angles]
    terms = [lead * cmath.exp(2j * angle) for lead, angle in zip(leads, angles, strict=True)]
    return 2j / count * complex(math.fsum(t.real for t in terms), math.fsum(t.imag for t in terms))


def _q_of_one(joint: Shafts) -> complex:
    """Return ``q`` of one joint, which is slowest with its driving pin across its plane."""
    return _q(joint, 1, enough(motion(joint, math.pi / 2, offset=0.0).speed_ratio))


# --- phases -------------------------------------------------------------------------------------


def optimal_phases(
    states: Shafts | Sequence[Shafts],
    weights: Sequence[float] | None = None,
    starts: Sequence[Sequence[float]] | None = None,
) -> tuple[float, ...]:
    """Return the phases that bring the last shaft closest to constant velocity.

    They minimise the weighted mean of ``abs(q)**2`` over the states of a driveline. Of settings
    that are as good they are those to which the yokes turn least from their present phases (least
    sum of squares, a yoke being the same after half a turn). All states have the phases of the
    first and count alike by default. Starts are settings to search from, by default the best of a
    grid.

    Errors: some 1e-7, as ``abs(q)`` grows with the square of a turn; where constant velocity is
    reached it grows with the turn, which then has the errors of the angle error over ``abs(q)`` of
    the worst setting. With four or more bent joints, whose best settings lie beside one another,
    1e-5 along them, and the turn is the least in the neighbourhood of a start. Of two settings that
    are as good but share a valley of the grid the farther one may be returned.

    Raises:
        ValueError: no state, states with different numbers of joints, not one weight per state.
    """
    search = _search(states, weights)
    grid = search.grid()
    worst = max(grid.values())
    if not search.present or worst < _STRAIGHT:
        return search.present
    if starts is None:
        settings, turnings = [search.present, *_valleys(grid)], _TURNING
    else:
        settings, turnings = [tuple(start) for start in starts], _TURNING[-1:]
    for turning in turnings:
        refined = [search.refined(setting, _FEW, turning * worst) for setting in settings]
        settings = list({tuple(round(x, 3) for x in found): found for found in refined}.values())
    # The few angles serve to tell what is hopeless, and then give way to enough of them.
    rough = [search.size(setting, _FEW) for setting in settings]
    sizes = {}
    for setting, size in zip(settings, rough, strict=True):
        if size <= min(rough) + 0.1 * worst:
            least = min(equivalent(state).min_speed_ratio for state in search.set_to(setting))
            best = search.refined(setting, enough(least), 0.0)
            sizes[best] = search.size(best, enough(least))
    good = [best for best, size in sizes.items() if size <= min(sizes.values()) + _AS_GOOD * worst]
    return min(good, key=lambda best: math.dist(best, search.present))


def best_teeth(
    states: Shafts | Sequence[Shafts], teeth: Sequence[int], weights: Sequence[float] | None = None
) -> tuple[int, ...]:
    """Return by how many teeth to turn the output-side yokes from their present phases.

    Every combination is tried. Of those that are as good the yokes turn least. Arguments and
    exceptions are as for ``optimal_phases``; ``teeth`` are those of the spline of each shaft
    between two joints.

    Errors: those of the angle error, by which combinations are compared.
    """
    search = _search(states, weights)
    count = enough(min(math.prod(map(math.cos, state.bends)) for state in search.states))
    sizes, turned = {}, {}
    for turns in product(*(range(-of // 2, of // 2 + 1) for of in teeth)):
        angles = [2.0 * math.pi * turn / of for turn, of in zip(turns, teeth, strict=True)]
        setting = tuple(map(sum, zip(search.present, angles, strict=True)))
        sizes[turns], turned[turns] = search.size(setting, count), math.hypot(*angles)
    as_good = min(sizes.values()) + _AS_GOOD * max(sizes.values()) + _STRAIGHT
    return min((turns for turns in sizes if sizes[turns] <= as_good), key=turned.__getitem__)


def _search(states: Shafts | Sequence[Shafts], weights: Sequence[float] | None) -> _Search:
    states = [states] if isinstance(states, Shafts) else list(states)
    weights = [1.0] * len(states) if weights is None else weights
    if len({len(state.phases) for state in states}) != 1:
        raise ArgumentValueError("states", "must be drivelines with the same number of joints")
    problem = f"has {len(weights)} values; there are {len(states)} states"
    require("weights", len(weights) == len(states), problem)
    return _Search(states, [math.sqrt(weight / math.fsum(weights)) for weight in weights])


@dataclass(frozen=True)
class _Search:
    """The drivelines whose common setting is looked for, and the root of the weight of each."""

    states: Sequence[Shafts]
    roots: Sequence[float]

    @property
    def present(self) -> tuple[float, ...]:
        """The phases from which turns count."""
        return self.states[0].phases

    def grid(self) -> dict[tuple[float, ...], float]:
        """Return settings over the half turn of each yoke with their sizes, in order."""
        tried = _TRIED.get(len(self.present), 2)
        turns = [math.pi * ((i + 0.5) / tried - 0.5) for i in range(tried)]
        every = product(turns, repeat=len(self.present))
        settings = [tuple(map(sum, zip(self.present, turned, strict=True))) for turned in every]
        return {setting: self.size(setting, _FEW) for setting in settings}

    def set_to(self, setting: Sequence[float]) -> list[Shafts]:
        """Return the drivelines with a setting."""
        return [replace(state, phases=tuple(setting)) for state in self.states]

    def errors(self, setting: Sequence[float], count: int) -> list[float]:
        """Return both parts of ``q`` of each state, with its weight."""
        last = len(setting) + 1
        own = [
            root * _q(state, last, count)
            for root, state in zip(self.roots, self.set_to(setting), strict=True)
        ]
        return [part for q in own for part in (q.real, q.imag)]

    def size(self, setting: Sequence[float], count: int) -> float:
        """Return the root of the weighted mean of ``abs(q)**2``."""
        return math.hypot(*self.errors(setting, count))

    def residuals(self, setting: Sequence[float], count: int, turning: float) -> list[float]:
        """Return the errors and, with a weight, the turn of each yoke."""
        turns = [turning * (x - now) for x, now in zip(setting, self.present, strict=True)]
        return [*self.errors(setting, count), *turns]

    def refined(self, start: Sequence[float], count: int, turning: float) -> tuple[float, ...]:
        """Return the best setting near another one."""
        at = _least(lambda setting: self.residuals(setting, count, turning), start)
        return tuple(now + _turn(x - now) for x, now in zip(at, self.present, strict=True))


def _valleys(grid: dict[tuple[float, ...], float]) -> list[tuple[float, ...]]:
    """Return the settings of a grid that are as good as their neighbours in each phase."""
    settings, axes = list(grid), range(len(next(iter(grid))))
    tried = len({setting[0] for setting in settings})
    sizes = np.array(list(grid.values())).reshape([tried] * len(axes))
    # One step of one phase, from the last value to the first.
    beside = [np.roll(sizes, step, axis) for axis in axes for step in (-1, 1)]
    lowest = np.all(sizes <= beside, axis=0).ravel()
    return [setting for setting, is_lowest in zip(settings, lowest, strict=True) if is_lowest]


def _least(residuals: Callable[[list[float]], list[float]], start: Sequence[float]) -> list[float]:
    """Return where the sum of squares is least near a start.

    Newton's method with differences; a step is damped until it makes the sum less.
    """
    at, n, h, damping = np.array(start, float), len(start), 1e-4, 1e-3
    steps = h * np.eye(n)

    def beside(*steps: NDArray[Any]) -> NDArray[Any]:
        return np.array(residuals(sum(steps, at).tolist()))

    for _ in range(_STEPS):
        here = beside()
        ahead, behind = (np.array([beside(sign * step) for step in steps]) for sign in (1.0, -1.0))
        slopes = (ahead - behind) / (2.0 * h)
        gradient, hessian = slopes @ here, slopes @ slopes.T
        if (scale := float(np.trace(hessian))) == 0.0:
            break
        for i, j in combinations_with_replacement(range(n), 2):
            curve = here @ (beside(steps[i], steps[j]) - ahead[i] - ahead[j] + here) / h**2
            hessian[i, j] = hessian[j, i] = hessian[i, j] + curve
        size, better = math.inf, False
        while size > 1e-12 and not better:
            step = np.linalg.solve(hessian + damping * scale * np.eye(n), gradient)
            better = math.hypot(*beside(-step)) < (1.0 - _ROUNDING) * math.hypot(*here)
            size = math.hypot(*step)
            damping = max(1e-10, 0.01 * damping) if better else 10.0 * damping
        if not better:
            break
        at = at - step
    return list(map(float, at))
