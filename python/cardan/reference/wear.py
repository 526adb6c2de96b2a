"""Losses, lives and a drive of finite inertia again, in pure Python, by adding up small steps.

The yokes of ``cardan.reference`` are turned by one step after another. How far a pin turns in its
bearings is the difference of the tilts of the cross, not a rate; the drive's speed follows from
Newton's law, not from the energy. All angles are in radians; loads are as for ``reference.loads``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.reference.evaluation import integrated
from cardan.reference.forces import Loads, loads
from cardan.reference.vectors import Shafts, tilts

_EXPONENT = 10.0 / 3.0
_SLOPE = 9.0 / 8.0


@dataclass(frozen=True)
class _Step:
    """One step of the drive, at its middle."""

    loads: Loads  # the moments there
    entering: tuple[float, ...]  # of each joint, the torque without what its driving shaft keeps
    ways: tuple[tuple[float, float], ...]  # that the pins turn in the driving and the driven yoke


def _turn(shafts: Shafts, steps: int, **load: float | Sequence[float]) -> Iterator[_Step]:
    """Yield the steps of half a turn, after which everything repeats."""
    ends = [tilts(shafts, math.pi * i / steps) for i in range(steps + 1)]
    for i, (before, after) in enumerate(pairwise(ends)):
        at = loads(shafts, math.pi * (i + 0.5) / steps, **load)  # type: ignore[arg-type]
        entering = tuple(
            sum(a * b for a, b in zip(moment, direction, strict=True))
            for moment, direction in zip(at.moment, shafts.directions, strict=False)
        )
        pairs = zip(before, after, strict=True)
        ways = tuple((abs(new[0] - old[0]), abs(new[1] - old[1])) for old, new in pairs)
        yield _Step(at, entering, ways)


def losses(
    shafts: Shafts,
    friction: float,
    pin_radius: float,
    arm: float,
    seal_torque: float = 0.0,
    *,
    steps: int = 720,
    **load: float | Sequence[float],
) -> tuple[float, ...]:
    """Return the share of the drive's work that each joint takes over a turn.

    The cross turns in a yoke about the pin of that yoke, by which it tilts against the shaft of the
    yoke; so the way in either yoke is the difference of the tilt against its shaft. Arguments are
    as of ``Driveline.losses``; the error is of the order of the square of the steps of half a turn.
    """
    work = [0.0] * len(shafts.bends)
    drive = 0.0
    for step in _turn(shafts, steps, **load):
        drive += step.loads.torque[0] * math.pi / steps
        for joint, (moment, ways) in enumerate(zip(step.loads.pin_moment, step.ways, strict=True)):
            work[joint] += (friction * pin_radius / arm * moment + seal_torque) * sum(ways)
    return tuple(lost / abs(drive) for lost in work)


def life(
    shafts: Shafts,
    rating: float,
    speed: float,
    *,
    steps: int = 720,
    **load: float | Sequence[float],
) -> tuple[tuple[float, float], ...]:
    """Return the life of each joint in h by the load of its pins, and by the catalogue's law.

    Arguments are as of ``Driveline.life``, the speed also that of the load; the error is of the
    order of the square of the steps of half a turn.
    """
    whole = list(_turn(shafts, steps, speed=speed, **load))
    rpm = speed * 60.0 / math.tau
    found = []
    for joint, bend in enumerate(shafts.bends):
        turning = 1.5e6 / (max(math.degrees(bend), 3.0) * rpm)
        torque = sum(abs(step.entering[joint]) for step in whole) / steps
        harms = []
        for yoke in range(2):
            ways = [step.ways[joint][yoke] for step in whole]
            moments = [step.loads.pin_moment[joint] for step in whole]
            harmed = sum(m**_EXPONENT * way for m, way in zip(moments, ways, strict=True))
            harms.append(harmed / sum(ways) if sum(ways) > 0.0 else torque**_EXPONENT)
        both = (sum(harm**_SLOPE for harm in harms) / 2.0) ** (1.0 / _SLOPE)
        found.append((turning * rating**_EXPONENT / both, turning * (rating / torque) ** _EXPONENT))
    return tuple(found)


def free_running(
    shafts: Shafts, inertias: Sequence[float], *, steps: int = 240
) -> tuple[float, float]:
    """Return the least and the largest speed of a drive that no torque holds, over its mean.

    Newton's law gives the acceleration with which the drive needs no torque; the mean is that over
    time. The steps of half a turn are those of Runge and Kutta.
    """

    def slopes(angle: float, state: NDArray[Any]) -> NDArray[Any]:
        """Derivatives of speed and time by the angle: the acceleration over the speed, and 1/it."""
        speed = float(state[0])
        still, faster = (
            loads(shafts, angle, speed=speed, acceleration=acceleration, inertias=inertias)
            for acceleration in (0.0, 1.0)
        )
        acceleration = -still.torque[0] / (faster.torque[0] - still.torque[0])
        return np.array([acceleration, 1.0]) / speed

    states = np.array(integrated(slopes, np.array([1.0, 0.0]), math.pi / steps, steps))
    mean = math.pi / states[-1, 1]
    return float(min(states[:, 0])) / mean, float(max(states[:, 0])) / mean
