"""What follows from the equations of one system: modes, unstable speeds, motions side by side."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.torsion.results import SteadyState

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# Relative step in stiffness by which the shares of the shafts are found.
_STEP = 1e-4

# Speeds around each one at which instability can begin, and halvings of the edges' intervals.
_NEAR, _HALVINGS = 81, 16

_PARTS = (1, 2)

# A search for motions side by side takes some hundred times as long as one steady state: speeds
# that lie closer to each other than this share are searched once, with a coarser tolerance.
_CLOSE, _TOLERANCE = 2e-3, 1e-6

_MOST = 8  # motions whose torques are compared

# Speeds on each side of a critical speed that are added to a response, and how far they reach in
# shares of it.
_AROUND, _REACH = 20, 0.1

# Rounds in which the largest torque is located, each with so many speeds.
_ROUNDS, _EACH = 5, 9


@dataclass(frozen=True)
class Mode:
    """A natural frequency of the mean system.

    Attributes:
        frequency: in rad/s.
        shares: of each compliant shaft in the energy of twist; they sum to 1.
        shaft: the shaft with the largest share.
        damping_ratio: by the dampings of the shafts.
    """

    frequency: float
    shares: tuple[float, ...]
    shaft: int
    damping_ratio: float


@dataclass(frozen=True)
class BendRule:
    """Whether a bend permits the instability of a compliant shaft: ``tan²(bend/2) > zeta``.

    Attributes:
        shaft: the compliant shaft.
        bend: equivalent bend in rad of the joints behind it, up to the next compliant shaft.
        damping_ratio: of the mode in which the shaft is twisted most.
        speed: around which the motion can be unstable, in rad/s: the natural frequency.
    """

    shaft: int
    bend: float
    damping_ratio: float
    speed: float

    @property
    def factor(self) -> float:
        """``tan²(bend/2)``."""
        return math.tan(0.5 * self.bend) ** 2

    @property
    def exceeded(self) -> bool:
        """Whether the motion can be unstable."""
        return self.factor > self.damping_ratio

    @property
    def edges(self) -> tuple[float, float]:
        """Drive speeds in rad/s between which it can be, without damping and to leading order."""
        half = 0.25 * self.bend**2
        return self.speed * (1.0 - half), self.speed * (1.0 + half)


def modes(self: TorsionalSystem) -> tuple[Mode, ...]:
    """Return the natural frequencies of one system with what is twisted in them, lowest first.

    By Rayleigh's quotient a shaft's share in the energy of twist is the derivative of ``ln w²`` by
    the logarithm of its stiffness ``c``, and the damping ratio is ``w/2 sum(share d/c)`` with the
    dampings ``d``.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([0, 0])
    >>> ends, springs = [[0, 0.02], [0.01, 0.03], [0, 0.05]], [5000, 3000, float("inf")]
    >>> chain = cardan.TorsionalSystem(line, inertias=ends, stiffnesses=springs)
    >>> [(round(mode.frequency), mode.shaft) for mode in chain.modes()]
    [(149, 1), (531, 0)]
    >>> [round(share, 3) for share in chain.modes()[0].shares]
    [0.444, 0.556]
    """
    check_single(self)
    compliant = list(self.compliant)
    steps = np.ones((2, len(compliant), self.line.n_joints + 1))
    for place, shaft in enumerate(compliant):
        steps[:, place, shaft] = np.exp([_STEP, -_STEP])
    varied = self.changed(stiffnesses=self.stiffnesses * steps).natural_frequencies()
    shares = np.log(varied[0] / varied[1]) / _STEP
    ratio = self.dampings[compliant] / self.stiffnesses[compliant]
    return tuple(
        Mode(
            float(frequency),
            tuple(shares[:, number].tolist()),
            compliant[int(np.argmax(shares[:, number]))],
            float(0.5 * frequency * (shares[:, number] @ ratio)),
        )
        for number, frequency in enumerate(self.natural_frequencies())
    )


def bend_rules(self: TorsionalSystem) -> tuple[BendRule, ...]:
    """Return the rule ``tan²(bend/2) > zeta`` for each compliant shaft with a joint behind it.

    The rule is that of one compliant shaft before massless joints and a flywheel, to leading order
    (first region of the Whittaker-Hill equation). With several compliant shafts it is a guide;
    ``stability`` decides.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([20], degrees=True)
    >>> own = {"inertias": [[0, 0], [0, 0.05]], "stiffnesses": [8000, float("inf")]}
    >>> system = cardan.TorsionalSystem(line, damping_ratios=0.02, **own)
    >>> (rule,) = system.bend_rules()
    >>> round(rule.factor, 4), rule.exceeded
    (0.0311, True)
    """
    found, line, compliant = self.modes(), self.line, self.compliant
    rules = []
    for place, shaft in enumerate(compliant):
        end = compliant[place + 1] if place + 1 < len(compliant) else line.n_joints
        if end == shaft:
            continue
        mode = max(found, key=lambda mode: mode.shares[place])
        part = Driveline.from_bends(
            line.bends[shaft:end], line.twists[shaft : end - 1], line.phases[shaft : end - 1]
        )
        bend = float(part.equivalent().bend)
        rules.append(BendRule(shaft, bend, mode.damping_ratio, mode.frequency))
    return tuple(rules)


def check_single(system: TorsionalSystem) -> None:
    """Refuse a batch of systems."""
    if system.shape:
        raise ValueError(f"the system is a batch of shape {system.shape}; ask one of them")


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
        ValueError: speeds that do not rise.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([20], degrees=True)
    >>> ends, springs = [[0, 0], [0, 0.05]], [8000, float("inf")]
    >>> system = cardan.TorsionalSystem(line, inertias=ends, stiffnesses=springs)
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
    self: TorsionalSystem, speed: ArrayLike, bend: ArrayLike, joint: SupportsIndex | None = None
) -> StabilityMap:
    """Return the stability of one system over the drive speed and the bend of one joint.

    Args:
        speed: drive speeds in rad/s, ``(speeds,)``.
        bend: bends of the joint in rad, ``(bends,)``.
        joint: which joint, counted from 0; by default the one with the largest bend.

    Raises:
        ValueError: a joint that does not exist, bends out of range.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([20], degrees=True)
    >>> ends, springs = [[0, 0], [0, 0.05]], [8000, float("inf")]
    >>> system = cardan.TorsionalSystem(line, inertias=ends, stiffnesses=springs)
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


@dataclass(frozen=True)
class SideBySide:
    """The periodic motions that a search found at one drive speed.

    Attributes:
        speed: of the drive in rad/s.
        count: how many motions were found.
        stable: how many of them are stable.
        shaft: the compliant shaft with the largest torque.
        smallest: the largest magnitude of its torque in N m in the motion in which that is least;
            NaN without a motion.
        largest: the same in the motion in which it is largest.
    """

    speed: float
    count: int
    stable: int
    shaft: int
    smallest: float
    largest: float


def side_by_side(self: TorsionalSystem, speed: ArrayLike) -> tuple[SideBySide, ...]:
    """Search for the periodic motions of one system that exist beside each other.

    ``coexisting`` has all their figures; this says how far their torques differ. The search has no
    proof that it finds all. Speeds closer to each other than 0.2 % are searched once; there is one
    entry for each that was, rising.

    Args:
        speed: drive speeds in rad/s, ``(m,)``, in any order.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([20], degrees=True)
    >>> own = {"inertias": [[0, 0], [0, 0.05]], "stiffnesses": [float("inf"), 8000]}
    >>> system = cardan.TorsionalSystem(line, damping_ratios=0.1, **own)
    >>> (found,) = system.side_by_side([150.0])
    >>> found.count, found.stable
    (1, 1)
    """
    check_single(self)
    searched: list[float] = []
    for each in np.sort(as_float64("speed", speed)).tolist():
        if not searched or each > searched[-1] * (1.0 + _CLOSE):
            searched.append(each)
    found = self.coexisting(np.array(searched), _MOST, tolerance=_TOLERANCE)
    sizes = np.fmax(np.abs(found.torque_min), np.abs(found.torque_max))
    motions = []
    for place, each in enumerate(searched):
        shafts = np.nan_to_num(sizes[:, place]).max(axis=-1)
        chosen = int(shafts.argmax())
        known = sizes[chosen, place][: int(found.count[place])]
        motions.append(
            SideBySide(
                each,
                int(found.count[place]),
                int(np.count_nonzero(found.stable[place])),
                self.compliant[chosen],
                float(known.min()) if known.size else math.nan,
                float(known.max()) if known.size else math.nan,
            )
        )
    return tuple(motions)


@dataclass(frozen=True)
class LargestTorque:
    """The largest torque of one compliant shaft over a range of drive speeds.

    Attributes:
        shaft: the shaft.
        speed: drive speed in rad/s at which its torque is largest.
        least: least torque in N m over the turn at that speed; ``-inf`` in a resonance that nothing
            damps, where there is no periodic motion.
        most: largest torque, likewise.
        mean: mean torque, NaN there.
        reversals: lowest and highest speed of each range in which the torque changes its sign
            though its mean is not 0.
    """

    shaft: int
    speed: float
    least: float
    most: float
    mean: float
    reversals: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class SpeedResponse:
    """The periodic motion of one system over a range of drive speeds.

    Attributes:
        speed: those asked for in rad/s and more near resonances, rising, ``(speeds,)``.
        steady: the motion at them.
        largest: the largest torque of each compliant shaft.
    """

    speed: FloatArray
    steady: SteadyState
    largest: tuple[LargestTorque, ...]


def speed_response(
    self: TorsionalSystem, speed: ArrayLike, orders: ArrayLike = (2, 4)
) -> SpeedResponse:
    """Return the periodic motion of one system over a range of speeds, and its largest torques.

    Resonances may be narrower than the steps between the speeds: more speeds are added around the
    critical speeds of even orders, and the largest torque is searched between the speeds.

    Args:
        speed: drive speeds in rad/s, rising, ``(m,)``; the range is from the first to the last.
        orders: of the drive's rotation, as of ``steady``.

    Raises:
        TypeError: speeds that are not real numbers, orders that are not integers.
        ValueError: a batch of systems, speeds that do not rise, an order out of range.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0, 0], [0, 0.05]],
    ...     stiffnesses=[8000, float("inf")],
    ...     damping_ratios=0.02,
    ... )
    >>> (largest,) = system.speed_response([150, 250]).largest
    >>> round(largest.speed), round(largest.most)
    (200, 3943)
    """
    check_single(self)
    critical = self.critical_speeds(np.atleast_1d(orders))
    even = critical[:, np.atleast_1d(orders) % 2 == 0]
    speeds = _with_resonances(self, _rising(speed), even)
    steady = self.steady(speeds, orders)
    return SpeedResponse(speeds, steady, tuple(_largest(self, speeds, steady, critical)))


def _with_resonances(
    system: TorsionalSystem, speed: FloatArray, critical: FloatArray
) -> FloatArray:
    around = [speed]
    for mode, centres in zip(system.modes(), critical, strict=True):
        # The half-width of a resonance is its damping ratio.
        least = min(max(0.25 * mode.damping_ratio, 1e-4), 0.5 * _REACH)
        away = np.geomspace(least, _REACH, _AROUND)
        around += [centre * (1.0 + np.concatenate([-away, [0.0], away])) for centre in centres]
    speeds = np.unique(np.concatenate(around))
    return np.asarray(speeds[(speeds >= speed[0]) & (speeds <= speed[-1])], dtype=np.float64)


def _largest(
    system: TorsionalSystem, speed: FloatArray, steady: SteadyState, critical: FloatArray
) -> Iterator[LargestTorque]:
    unlimited = np.zeros(0)
    if not (system.load_damping > 0.0 or np.any(system.dampings > 0.0)):
        by_order = critical.T.ravel()
        inside = by_order[(by_order >= speed[0]) & (by_order <= speed[-1])]
        unlimited = inside[~system.steady(inside).found]
    for place, shaft in enumerate(system.compliant):
        reversals = tuple(_reversals(speed, steady, place))
        if unlimited.size:
            yield LargestTorque(shaft, unlimited[0], -math.inf, math.inf, math.nan, reversals)
        elif np.any(steady.found):
            at, found, best = _located(system, place, speed, steady)
            ends = (found.torque_min, found.torque_max, found.torque_mean)
            least, most, mean = (float(end[place, best]) for end in ends)
            yield LargestTorque(shaft, float(at[best]), least, most, mean, reversals)


def _located(
    system: TorsionalSystem, place: int, speed: FloatArray, steady: SteadyState
) -> tuple[FloatArray, SteadyState, int]:
    """Speeds ever closer to the largest torque, the motion at them and the place of the largest."""
    at, found = speed, steady
    best = int(np.nanargmax(_sizes(found, place)))
    for _ in range(_ROUNDS):
        low, high = at[max(best - 1, 0)], at[min(best + 1, len(at) - 1)]
        at = np.union1d(np.linspace(low, high, _EACH), [at[best]])
        found = system.steady(at, steady.orders)
        best = int(np.nanargmax(_sizes(found, place)))
    return at, found, best


def _sizes(found: SteadyState, place: int) -> FloatArray:
    return np.asarray(np.maximum(np.abs(found.torque_min), np.abs(found.torque_max))[place])


def _reversals(speed: FloatArray, steady: SteadyState, place: int) -> Iterator[tuple[float, float]]:
    """Where the torque changes its sign though it has a mean, the ends interpolated."""
    if not np.any(steady.found):
        return
    mean = steady.torque_mean[place]
    noise = 1e-9 * np.nanmax(_sizes(steady, place))
    low = np.where(mean >= 0.0, steady.torque_min[place], -steady.torque_max[place])
    for first, last in ranges(steady.found & (low < 0.0) & (np.abs(mean) > noise)):
        start, stop = float(speed[first]), float(speed[last])
        if first > 0 and low[first - 1] >= 0.0:
            start = _crossing(speed, low, first - 1)
        if last + 1 < len(speed) and low[last + 1] >= 0.0:
            stop = _crossing(speed, low, last)
        yield start, stop


def _crossing(speed: FloatArray, value: FloatArray, place: int) -> float:
    """The speed between two neighbours at which the value is 0, on a straight line."""
    before, after = value[place], value[place + 1]
    return float(speed[place] + (speed[place + 1] - speed[place]) * before / (before - after))
