"""Where the periodic motion of a torsional system is unstable: ranges of speed, and a map."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cardan.app.scene.torsion import TorsionCase
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.torsion import TorsionalSystem

# Speeds around each one at which instability can begin, and halvings of the edges' intervals.
_NEAR, _HALVINGS = 81, 16

_PARTS = (1, 2)


@dataclass(frozen=True)
class SpeedRange:
    """A range of drive speeds in rad/s."""

    start: float
    stop: float


@dataclass(frozen=True)
class UnstableRange(SpeedRange):
    """A range of speeds in which small deviations from the periodic motion grow.

    Attributes:
        multiplier: by how much at most in half a turn of the drive.
    """

    multiplier: float


def ranges(which: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield the first and the last place of each run of true values."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(np.int8)))
    yield from ((int(first), int(last) - 1) for first, last in ends.reshape(-1, 2))


def unstable_regions(
    system: TorsionalSystem, speed: FloatArray, frequencies: Sequence[float]
) -> tuple[UnstableRange, ...]:
    """Return where in a range of speeds the periodic motion is unstable.

    Besides the speeds given, those around ``(w_i + w_j)/(2 n)`` with ``n = 1, 2`` are examined: the
    joints vary the equations at twice the speed of the drive, which excites a sum of two natural
    frequencies parametrically. Regions of higher ``n`` are found if they contain a given speed.

    Args:
        system: one system.
        speed: drive speeds in rad/s, rising; the range is from the first to the last.
        frequencies: natural frequencies in rad/s.
    """
    speeds = _with_candidates(system, speed, frequencies)
    found = system.stability(speeds)
    unstable = found.found & ~found.stable
    runs = list(ranges(unstable))
    sizes = np.abs(found.multipliers[..., 0])
    edges = []
    for first, last in runs:
        for inner, outer in ((first, first - 1), (last, last + 1)):
            known = 0 <= outer < len(speeds) and bool(found.stable[outer])
            edges.append((speeds[inner], speeds[outer] if known else speeds[inner]))
    ends = _edges(system, np.array(edges).reshape(-1, 2)).reshape(-1, 2)
    return tuple(
        UnstableRange(float(start), float(stop), float(sizes[first : last + 1].max()))
        for (first, last), (start, stop) in zip(runs, ends, strict=True)
    )


def _with_candidates(
    system: TorsionalSystem, speed: FloatArray, frequencies: Sequence[float]
) -> FloatArray:
    # The first region is as wide as a quarter of the squared equivalent bend on either side, and
    # that bend is at most the sum of all.
    width = min(0.5, 0.01 + 0.5 * float(np.sum(system.line.bends)) ** 2)
    near = 1.0 + width * np.linspace(-1.0, 1.0, _NEAR)
    sums = {
        (one + other) / (2.0 * n) for one in frequencies for other in frequencies for n in _PARTS
    }
    speeds = np.unique(np.concatenate([speed, *(centre * near for centre in sorted(sums))]))
    inside = (speeds >= speed[0]) & (speeds <= speed[-1])
    return np.asarray(speeds[inside], dtype=np.float64)


def _edges(system: TorsionalSystem, edges: FloatArray) -> FloatArray:
    """Halve the intervals from an unstable speed to a stable one; return the unstable ends."""
    inner, outer = edges[:, 0].copy(), edges[:, 1].copy()
    for _ in range(_HALVINGS if len(inner) else 0):
        middle = 0.5 * (inner + outer)
        stable = system.stability(middle).stable
        inner, outer = np.where(stable, inner, middle), np.where(stable, middle, outer)
    return np.asarray(inner)


@dataclass(frozen=True, eq=False)
class StabilityMap:
    """Stability over the drive speed and the bend of one joint.

    Attributes:
        joint: the joint; the others have the bends of the scene.
        speed: in rad/s, ``(speeds,)``.
        bend: in rad, ``(bends,)``.
        largest: modulus of the largest multiplier, ``(bends, speeds)``; NaN without an orbit.
        stable: whether the motion is stable, ``(bends, speeds)``.
        found: whether there is a periodic motion, ``(bends, speeds)``.
    """

    joint: int
    speed: FloatArray
    bend: FloatArray
    largest: FloatArray
    stable: NDArray[np.bool_]
    found: NDArray[np.bool_]


def stability_map(
    given: TorsionCase, speed: FloatArray, bend: FloatArray, joint: int | None = None
) -> StabilityMap:
    """Return the stability of a scene's system over speed and the bend of one joint.

    Args:
        given: the system of the scene.
        speed: drive speeds in rad/s, ``(speeds,)``.
        bend: bends in rad, ``(bends,)``.
        joint: which joint; by default the one with the largest bend.

    Raises:
        ValueError: a joint that does not exist, bends out of range.
    """
    line = given.system.line
    chosen = int(np.argmax(line.bends)) if joint is None else joint
    if not 0 <= chosen < line.n_joints:
        raise ArgumentValueError("joint", f"is {chosen}; there are {line.n_joints}, counted from 0")
    bends = np.repeat(line.bends[np.newaxis], len(bend), axis=0)
    bends[:, chosen] = bend
    lines = Driveline.from_bends(bends, line.twists, line.phases)
    found = given.changed(lines[:, np.newaxis]).stability(speed)
    largest = np.abs(found.multipliers[..., 0])
    return StabilityMap(chosen, speed, bend, largest, found.stable, found.found)
