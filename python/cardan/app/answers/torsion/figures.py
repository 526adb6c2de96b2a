"""Torsional vibration of a scene: modes, critical speeds, response over speed, what it means."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.torsion.modes import TorsionBasics, torsion_basics
from cardan.app.answers.torsion.orbits import SideBySide, side_by_side
from cardan.app.answers.torsion.stability import SpeedRange, UnstableRange, ranges, unstable_regions
from cardan.app.scene.scene import Scene
from cardan.app.scene.torsion import TorsionCase
from cardan.arrays import FloatArray
from cardan.torsion import SteadyState

TorsionVerdict = Literal["unstable", "reversing", "resonant", "clear"]
"""The worst of what happens in the speed range, from the worst to the best.

``reversing``: the torque of a shaft changes its sign though its mean is not 0. ``resonant``: a
critical speed lies in the range.
"""

# Speeds on each side of a critical speed that are added to those of the scene, and how far they
# reach in shares of it.
_NEAR, _REACH = 20, 0.1

# Rounds in which the largest torque is located, each with so many speeds.
_ROUNDS, _EACH = 5, 9


@dataclass(frozen=True)
class CriticalSpeed:
    """A drive speed at which an order meets a natural frequency.

    Attributes:
        mode: number of the natural frequency, the lowest being 0.
        order: of the drive's rotation.
        speed: of the drive in rad/s.
        shaft: the shaft that is twisted most.
        inside: whether it lies in the speed range of the scene.
        amplitude: of this order of the shaft's torque at this speed in N m; NaN where there is no
            periodic motion.
    """

    mode: int
    order: int
    speed: float
    shaft: int
    inside: bool
    amplitude: float


@dataclass(frozen=True)
class LargestTorque:
    """The largest torque of one shaft over the speed range.

    Attributes:
        shaft: which shaft.
        speed: of the drive in rad/s at which it occurs.
        least: least torque over the turn at that speed in N m; minus infinity in a resonance
            without damping, where there is no periodic motion.
        most: largest torque, or infinity.
        mean: mean torque, or NaN.
        reversals: the speeds between which the torque changes its sign; none if its mean is 0.
    """

    shaft: int
    speed: float
    least: float
    most: float
    mean: float
    reversals: tuple[SpeedRange, ...]

    @property
    def size(self) -> float:
        """The largest magnitude in N m."""
        return max(abs(self.least), abs(self.most))


@dataclass(frozen=True, eq=False)
class TorsionFigures(TorsionBasics):
    """The torsional vibration of a scene.

    Attributes:
        critical_speeds: of every order and natural frequency.
        speed: drive speeds in rad/s of the response: those of the scene, and more near resonances.
        response: the periodic motion at them.
        largest: of each compliant shaft.
        unstable: where small deviations grow.
        missing: speeds without a periodic motion, and why.
        motions: the periodic motions at the worst critical speed, at the speed of the largest
            torque and amid the most unstable range; ``response`` has one at each speed.
    """

    critical_speeds: tuple[CriticalSpeed, ...]
    speed: FloatArray
    response: SteadyState
    largest: tuple[LargestTorque, ...]
    unstable: tuple[UnstableRange, ...]
    missing: tuple[tuple[SpeedRange, str], ...]
    motions: tuple[SideBySide, ...]

    @property
    def verdict(self) -> TorsionVerdict:
        """The worst of what happens in the speed range."""
        if self.unstable:
            return "unstable"
        if any(found.reversals for found in self.largest):
            return "reversing"
        return "resonant" if any(found.inside for found in self.critical_speeds) else "clear"


def torsion_figures(scene: Scene) -> TorsionFigures | None:
    """Return the torsional vibration of a scene over its speeds, if it has [torsion]."""
    basics = torsion_basics(scene)
    if basics is None:
        return None
    given, system = basics.torsion, basics.torsion.system
    speed = _speeds(basics)
    response = system.steady(speed, given.orders)
    regions = unstable_regions(system, speed, [mode.frequency for mode in basics.modes])
    critical_speeds = tuple(_critical_speeds(basics))
    reasons = response.reasons
    missing = [
        (SpeedRange(float(speed[first]), float(speed[last])), str(reasons[first]))
        for first, last in ranges(~response.found)
    ]
    largest = tuple(_largest(basics, critical_speeds, speed, response))
    return TorsionFigures(
        given,
        basics.modes,
        basics.rules,
        critical_speeds,
        speed,
        response,
        largest,
        regions,
        tuple(missing),
        tuple(side_by_side(system, _worst(critical_speeds, largest, regions))),
    )


def _worst(
    critical_speeds: Sequence[CriticalSpeed],
    largest: Sequence[LargestTorque],
    regions: Sequence[UnstableRange],
) -> Iterator[float]:
    """The worst critical speed, that of the largest torque, and amid the most unstable range.

    There are no more than these, because a search takes seconds with eight compliant shafts.
    """
    inside = [part for part in critical_speeds if part.inside and part.order % 2 == 0]
    if inside:
        yield max(inside, key=lambda part: float(np.nan_to_num(part.amplitude))).speed
    if largest:
        yield max(largest, key=lambda part: part.size).speed
    if regions:
        region = max(regions, key=lambda part: part.multiplier)
        yield 0.5 * (region.start + region.stop)


def find(answer: Answer) -> TorsionBasics | None:
    """Return what a check says of a scene's torsional vibration."""
    return torsion_basics(answer.scene)


def needed_torsion(scene: Scene) -> TorsionFigures:
    """Return the torsional vibration of a scene.

    Raises:
        ValueError: it has no section [torsion].
    """
    found = torsion_figures(scene)
    if found is None:
        raise ValueError(
            f"{scene.name}: section [torsion] is missing; it gives stiffnesses and inertias"
        )
    return found


def _speeds(basics: TorsionBasics) -> FloatArray:
    """The speeds of the scene and more around critical speeds, whose peaks may be narrow."""
    given = basics.torsion
    parts = [given.speed]
    for number, order, speed in basics.criticals():
        if order % 2 == 0:
            # The half-width of a resonance is its damping ratio.
            least = min(max(0.25 * basics.modes[number].damping_ratio, 1e-4), 0.5 * _REACH)
            away = np.geomspace(least, _REACH, _NEAR)
            parts.append(speed * (1.0 + np.concatenate([-away, [0.0], away])))
    speeds = np.unique(np.concatenate(parts))
    inside = (speeds >= given.speed[0]) & (speeds <= given.speed[-1])
    return np.asarray(speeds[inside], dtype=np.float64)


def _critical_speeds(basics: TorsionBasics) -> Iterator[CriticalSpeed]:
    given = basics.torsion
    for number, order, speed in basics.criticals():
        shaft = basics.modes[number].shaft
        found = given.system.steady(speed, order)
        amplitude = np.abs(found.torque_orders[given.system.compliant.index(shaft), 0])
        yield CriticalSpeed(number, order, speed, shaft, basics.is_inside(speed), float(amplitude))


def _largest(
    basics: TorsionBasics,
    critical_speeds: Sequence[CriticalSpeed],
    speed: FloatArray,
    response: SteadyState,
) -> Iterator[LargestTorque]:
    given = basics.torsion
    damped = given.load_damping > 0.0 or bool(np.any(given.system.dampings > 0.0))
    for place, shaft in enumerate(given.system.compliant):
        reversals = tuple(_reversals(speed, response, place))
        unlimited = [
            critical.speed
            for critical in critical_speeds
            if critical.inside and math.isnan(critical.amplitude) and not damped
        ]
        if unlimited:
            yield LargestTorque(shaft, unlimited[0], -math.inf, math.inf, math.nan, reversals)
        elif np.any(response.found):
            at, found, best = _located(given, place, speed, response)
            ends = (found.torque_min, found.torque_max, found.torque_mean)
            least, most, mean = (float(end[place, best]) for end in ends)
            yield LargestTorque(shaft, float(at[best]), least, most, mean, reversals)


def _located(
    given: TorsionCase, place: int, speed: FloatArray, response: SteadyState
) -> tuple[FloatArray, SteadyState, int]:
    """Speeds ever closer to the largest torque, the motion at them and the place of the largest."""
    at, found = speed, response
    best = int(np.nanargmax(_sizes(found, place)))
    for _ in range(_ROUNDS):
        low, high = at[max(best - 1, 0)], at[min(best + 1, len(at) - 1)]
        closer = np.union1d(np.linspace(low, high, _EACH), [at[best]])
        at, found = closer, given.system.steady(closer, given.orders)
        best = int(np.nanargmax(_sizes(found, place)))
    return at, found, best


def _sizes(found: SteadyState, place: int) -> FloatArray:
    return np.asarray(np.maximum(np.abs(found.torque_min), np.abs(found.torque_max))[place])


def _reversals(speed: FloatArray, response: SteadyState, place: int) -> Iterator[SpeedRange]:
    """Where the torque changes its sign though it has a mean, the ends interpolated."""
    if not np.any(response.found):
        return
    mean = response.torque_mean[place]
    largest = np.nanmax(_sizes(response, place))
    low = np.where(mean >= 0.0, response.torque_min[place], -response.torque_max[place])
    reverses: NDArray[np.bool_] = response.found & (low < 0.0) & (np.abs(mean) > 1e-9 * largest)
    for first, last in ranges(reverses):
        start, stop = float(speed[first]), float(speed[last])
        if first > 0 and low[first - 1] >= 0.0:
            start = _crossing(speed, low, first - 1)
        if last + 1 < len(speed) and low[last + 1] >= 0.0:
            stop = _crossing(speed, low, last)
        yield SpeedRange(start, stop)


def _crossing(speed: FloatArray, value: FloatArray, place: int) -> float:
    """The speed between two neighbours at which the value is 0, on a straight line."""
    before, after = value[place], value[place + 1]
    return float(speed[place] + (speed[place + 1] - speed[place]) * before / (before - after))
