"""Where the periodic motion of a torsional system is unstable: ranges of speed, and a map."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.torsion.modes import check_single

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# Speeds around each one at which instability can begin, and halvings of the edges' intervals.
_NEAR, _HALVINGS = 81, 16

_PARTS = (1, 2)


@dataclass(frozen=True)
class UnstableRange:
    """A range of drive speeds in which small deviations from the periodic motion grow.

    Attributes:
        start: lowest speed in rad/s.
        stop: highest speed in rad/s.
        multiplier: by how much at most in half a turn of the drive.
    """

    start: float
    stop: float
    multiplier: float


def ranges(which: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield the first and the last place of each run of true values."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(np.int8)))
    yield from ((int(first), int(last) - 1) for first, last in ends.reshape(-1, 2))


def unstable_ranges(self: TorsionalSystem, speed: ArrayLike) -> tuple[UnstableRange, ...]:
    """Return where in a range of speeds the periodic motion of one system is unstable.

    Besides the speeds given, those around ``(w_i + w_j)/(2 n)`` with ``n = 1, 2`` are examined: the
    joints vary the equations at twice the speed of the drive, which excites a sum of two natural
    frequencies parametrically. Regions of higher ``n`` are found if they contain a given speed.

    Args:
        speed: drive speeds in rad/s, rising, ``(m,)``; the range is from the first to the last.

    Raises:
        TypeError: speeds that are not real numbers.
        ValueError: a batch of systems, speeds that do not rise.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0, 0], [0, 0.05]],
    ...     stiffnesses=[8000, float("inf")],
    ... )
    >>> (found,) = system.unstable_ranges([300, 500])
    >>> round(found.start, 1), round(found.stop, 1)
    (387.0, 412.0)
    """
    check_single(self)
    speeds = _with_candidates(self, _rising(speed))
    found = self.stability(speeds)
    runs = list(ranges(found.found & ~found.stable))
    sizes = np.abs(found.multipliers[..., 0])
    edges = []
    for first, last in runs:
        for inner, outer in ((first, first - 1), (last, last + 1)):
            known = 0 <= outer < len(speeds) and bool(found.stable[outer])
            edges.append((speeds[inner], speeds[outer] if known else speeds[inner]))
    ends = _edges(self, np.array(edges).reshape(-1, 2)).reshape(-1, 2)
    return tuple(
        UnstableRange(float(start), float(stop), float(sizes[first : last + 1].max()))
        for (first, last), (start, stop) in zip(runs, ends, strict=True)
    )


def _rising(speed: ArrayLike) -> FloatArray:
    speeds = as_float64("speed", speed)
    if speeds.ndim != 1 or not speeds.size or not np.all(np.diff(speeds) > 0.0):
        raise ArgumentValueError("speed", f"is {speed!r}; it must be a list of rising speeds")
    return speeds


def _with_candidates(system: TorsionalSystem, speed: FloatArray) -> FloatArray:
    # The first region is as wide as a quarter of the squared equivalent bend on either side, and
    # that bend is at most the sum of all.
    width = min(0.5, 0.01 + 0.5 * float(np.sum(system.line.bends)) ** 2)
    near = 1.0 + width * np.linspace(-1.0, 1.0, _NEAR)
    natural = system.natural_frequencies().tolist()
    sums = {(one + other) / (2.0 * n) for one in natural for other in natural for n in _PARTS}
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
        joint: the joint; the others keep their bends.
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
    self: TorsionalSystem,
    speed: ArrayLike,
    bend: ArrayLike,
    joint: SupportsIndex | None = None,
) -> StabilityMap:
    """Return the stability of one system over the drive speed and the bend of one joint.

    Args:
        speed: drive speeds in rad/s, ``(speeds,)``.
        bend: bends of the joint in rad, ``(bends,)``.
        joint: which joint, counted from 0; by default the one with the largest bend.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a batch of systems, a joint that does not exist, bends out of range.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0, 0], [0, 0.05]],
    ...     stiffnesses=[8000, float("inf")],
    ... )
    >>> system.stability_map([395.0, 500.0], [0.01, 0.35]).stable.tolist()
    [[True, True], [False, True]]
    """
    check_single(self)
    line = self.line
    chosen = int(np.argmax(line.bends)) if joint is None else integer("joint", joint, 0)
    if chosen >= line.n_joints:
        raise ArgumentValueError("joint", f"is {chosen}; there are {line.n_joints}, counted from 0")
    speeds, given = as_float64("speed", speed), as_float64("bend", bend)
    bends = np.repeat(line.bends[np.newaxis], len(given), axis=0)
    bends[:, chosen] = given
    lines = Driveline.from_bends(bends, line.twists, line.phases)
    found = self.changed(lines[:, np.newaxis]).stability(speeds)
    largest = np.abs(found.multipliers[..., 0])
    return StabilityMap(chosen, speeds, given, largest, found.stable, found.found)
