"""Analyses of the equations of one system: modes, unstable speeds, motions side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.torsion.results import Stability, SteadyState

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# Speeds around each one at which instability can begin by joints or by other torques, and halvings
# of the edges' intervals.
_NEAR, _BESIDE, _HALVINGS = 81, 9, 16

# A motion of a coupling with kinks takes some fifty times as long as another one: of the speeds
# that are added only one in so many is.
_FEWER = 4

_JOINT_ORDERS = (2.0, 4.0)

# Factors of bends below this are rounding.
_STRAIGHT = 1e-12

# Without damping the speed neither runs away nor returns; its multiplier is then 1 up to this.
_NEUTRAL = 2e-6

# A search for motions side by side takes some hundred times as long as one steady state: speeds
# that lie closer to each other than this share are searched once, with a coarser tolerance.
_CLOSE, _TOLERANCE = 2e-3, 1e-6

_MOST = 8  # motions whose torques are compared

# Speeds on each side of a critical speed that are added to a response, and how far they reach in
# shares of it.
_AROUND, _REACH = 20, 0.1

# Speeds over the curve of a motor, and halvings by which the running speeds between are found.
_OVER_CURVE, _HALVINGS_OF_SPEED = 101, 40

# Rounds in which the largest torque is located, each with so many speeds.
_ROUNDS, _EACH = 5, 9


@dataclass(frozen=True)
class Mode:
    """A natural frequency of the mean system.

    Attributes:
        frequency: in rad/s.
        shares: of each compliant shaft in the energy of twist; they sum to 1.
        shaft: the shaft with the largest share.
        damping_ratio: by the dampings and loss factors of the shafts.
        shape: amplitude of the angle of every shaft end, input end before output end, ``(n + 1,
            2)``; the largest is 1.
    """

    frequency: float
    shares: tuple[float, ...]
    shaft: int
    damping_ratio: float
    shape: tuple[tuple[float, float], ...]


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
        # A straight driveline has a bend of rounding.
        return self.factor > max(self.damping_ratio, _STRAIGHT)

    @property
    def edges(self) -> tuple[float, float]:
        """Drive speeds in rad/s between which it can be, without damping and to leading order."""
        half = 0.25 * self.bend**2
        return self.speed * (1.0 - half), self.speed * (1.0 + half)


def modes(self: TorsionalSystem) -> tuple[Mode, ...]:
    """Return the natural frequencies of one system with what is twisted in them, lowest first.

    The damping ratio is ``sum(share (w d/c + eta))/2`` with the stiffnesses ``c``, the dampings
    ``d`` and the loss factors ``eta`` (Rayleigh's quotient). The stiffness of a coupling is that at
    the load torque.

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
    ratio = self.dampings[compliant] / self.stiffnesses[compliant]
    loss = np.zeros(len(compliant))
    for shaft, coupling in self.couplings.items():
        loss[compliant.index(shaft)] = coupling.loss_factor
    return tuple(
        Mode(
            frequency,
            tuple(shares),
            shaft,
            float(0.5 * (np.array(shares) @ (frequency * ratio + loss))),
            tuple(zip(ends[::2], ends[1::2], strict=True)),
        )
        for frequency, ends, shares, shaft in self._core.modes()
    )


def harmonic_orders(system: TorsionalSystem) -> tuple[float, ...]:
    """Return the orders of the system's harmonic torques that are not 0, rising."""
    return tuple(sorted({own.order for own in system.harmonics if own.amplitude > 0.0}))


def _excited(system: TorsionalSystem, orders: ArrayLike) -> FloatArray:
    """The orders that joints or harmonic torques excite: even ones of those given, and theirs."""
    given = np.atleast_1d(as_float64("orders", orders))
    return np.union1d(given[given % 2.0 == 0.0], harmonic_orders(system))


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
        multiplier: by how much at most in a period.
        needed_slope: of a free drive whose speed runs away: its torque must fall by more than this
            with its speed, in N m s/rad, everywhere in the range. 0 where the shafts vibrate.
    """

    start: float
    stop: float
    multiplier: float
    needed_slope: float = 0.0

    @property
    def runs_away(self) -> bool:
        """Whether it is the speed of the whole driveline that does not return."""
        return self.needed_slope > 0.0


def ranges(which: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield the first and the last place of each run of true values."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], which, [False]]).astype(np.int8)))
    yield from ((int(first), int(last) - 1) for first, last in ends.reshape(-1, 2))


def unstable_ranges(
    self: TorsionalSystem, speed: ArrayLike, *, refined: bool = True
) -> tuple[UnstableRange, ...]:
    """Return where in a range of speeds the periodic motion of one system is unstable.

    Besides the speeds given, those around ``(w_i + w_j)/n`` are examined with ``n = 2, 4`` and the
    orders of harmonic torques: the joints vary the equations at twice the speed of the drive, which
    excites a sum of two natural frequencies parametrically. Regions of other ``n`` are found if
    they contain a given speed.

    With a free drive the speed itself can run away (Sommerfeld), as beyond a resonance, where the
    torque that the driveline needs falls with its speed. Speeds around resonances are examined for
    this, and the ranges follow those of vibration. ``drive_slope`` of the system counts.

    Args:
        speed: drive speeds in rad/s, rising, ``(m,)``; the range is from the first to the last.
        refined: whether other speeds are examined as well and the ends found between speeds.

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
    speeds = _rising(speed)
    if refined:
        speeds = _with_candidates(self, speeds)
    if refined and self.free:
        critical = self.critical_speeds(_excited(self, _JOINT_ORDERS))
        speeds = _with_resonances(self, speeds, critical)
    found, halvings = self.stability(speeds), _HALVINGS if refined else 0
    unstable = [
        UnstableRange(start, stop, float(np.nanmax(growth(found)[places])))
        for start, stop, places in _ranges(self, speeds, found, _vibrates, halvings)
    ]
    for start, stop, places in _ranges(self, speeds, found, _runs_away, halvings):
        multiplier = float(np.nanmax(found.speed_multiplier[places]))
        slope = float(np.nanmax(found.needed_slope[places]))
        unstable.append(UnstableRange(start, stop, multiplier, slope))
    return tuple(unstable)


def growth(found: Stability) -> FloatArray:
    """Return the modulus of the largest multiplier of vibration, ``(...)``; NaN without an orbit.

    The multiplier of the speed of a free drive is not among them.
    """
    of_speed = found.multipliers == found.speed_multiplier[..., np.newaxis]
    return np.asarray(np.max(np.where(of_speed, 0.0, np.abs(found.multipliers)), axis=-1))


def _vibrates(found: Stability) -> NDArray[np.bool_]:
    return np.asarray(growth(found) > 1.0 + 1e-9)


def _runs_away(found: Stability) -> NDArray[np.bool_]:
    falls = found.drive_torque_slope + found.drive_slope < 0.0
    return np.asarray(falls & (found.speed_multiplier > 1.0 + _NEUTRAL))


def _ranges(
    system: TorsionalSystem,
    speed: FloatArray,
    found: Stability,
    grows: Callable[[Stability], NDArray[np.bool_]],
    halvings: int,
) -> Iterator[tuple[float, float, slice]]:
    """Ends of each range in which something grows, and the places of its speeds.

    The intervals from an unstable speed to a stable one are halved so often.
    """
    runs, edges = list(ranges(grows(found))), []
    for first, last in runs:
        for inner, outer in ((first, first - 1), (last, last + 1)):
            known = 0 <= outer < len(speed) and bool(found.found[outer])
            edges.append((speed[inner], speed[outer] if known else speed[inner]))
    inside, outside = np.array(edges).reshape(-1, 2).T
    for _ in range(halvings if edges else 0):
        middle = 0.5 * (inside + outside)
        unstable = grows(system.stability(middle))
        inside, outside = np.where(unstable, middle, inside), np.where(unstable, outside, middle)
    for (first, last), (start, stop) in zip(runs, inside.reshape(-1, 2), strict=True):
        yield float(start), float(stop), slice(first, last + 1)


def _rising(speed: ArrayLike) -> FloatArray:
    speeds = as_float64("speed", speed)
    if speeds.ndim != 1 or not speeds.size or not np.all(np.diff(speeds) > 0.0):
        raise ArgumentValueError("speed", f"is {speed!r}; it must be a list of rising speeds")
    return speeds


def _with_candidates(system: TorsionalSystem, speed: FloatArray) -> FloatArray:
    # The first region is as wide as a quarter of the squared equivalent bend on either side, and
    # that bend is at most the sum of all.
    width = min(0.5, 0.01 + 0.5 * float(np.sum(system.line.bends)) ** 2)
    natural = system.natural_frequencies().tolist()
    sums = np.array(sorted({one + other for one in natural for other in natural}))
    around = [speed]
    for order in sorted({*_JOINT_ORDERS, *harmonic_orders(system)}):
        is_of_joints = order in _JOINT_ORDERS
        near = np.linspace(-1.0, 1.0, _NEAR if is_of_joints else _BESIDE)[:: _every(system)]
        around.append(
            np.outer(sums / order, 1.0 + (width if is_of_joints else 0.01) * near).ravel()
        )
    return _inside(speed, around)


def _inside(speed: FloatArray, around: list[FloatArray]) -> FloatArray:
    """The speeds of some lists that lie within a range of speeds."""
    speeds = np.unique(np.concatenate(around))
    return np.asarray(speeds[(speeds >= speed[0]) & (speeds <= speed[-1])], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class StabilityMap:
    """Stability over the drive speed and the bend of one joint.

    Attributes:
        joint: the joint; the others keep their bends.
        speed: in rad/s, ``(speeds,)``.
        bend: in rad, ``(bends,)``.
        largest: modulus of the largest multiplier of vibration, ``(bends, speeds)``; NaN without
            an orbit.
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
    return StabilityMap(chosen, speeds, given, growth(found), found.stable, found.found)


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
        sizes: the same in each motion.
        stables: whether each motion is stable.
    """

    speed: float
    count: int
    stable: int
    shaft: int
    smallest: float
    largest: float
    sizes: tuple[float, ...] = ()
    stables: tuple[bool, ...] = ()


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
        count = int(found.count[place])
        chosen = int(np.nan_to_num(sizes[:, place]).max(axis=-1).argmax())
        known = sizes[chosen, place][:count].tolist()
        stables = found.stable[place].tolist()
        motions.append(
            SideBySide(
                each,
                count,
                stables.count(True),
                self.compliant[chosen],
                min(known, default=math.nan),
                max(known, default=math.nan),
                tuple(known),
                tuple(stables[:count]),
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
            though its mean is not 0; of a coupling with play, in which its flanks come apart.
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


def has_kinks(system: TorsionalSystem) -> bool:
    """Return whether a coupling has play or a table, of which motions take long to find."""
    return any(own.play > 0.0 or own.twist is not None for own in system.couplings.values())


def _every(system: TorsionalSystem) -> int:
    return _FEWER if has_kinks(system) else 1


def speed_response(
    self: TorsionalSystem, speed: ArrayLike, orders: ArrayLike = (2, 4), *, refined: bool = True
) -> SpeedResponse:
    """Return the periodic motion of one system over a range of speeds, and its largest torques.

    Resonances may be narrower than the steps between the speeds: more speeds are added around the
    critical speeds of even orders and of harmonic torques, and the largest torque is searched
    between the speeds.

    Args:
        speed: drive speeds in rad/s, rising, ``(m,)``; the range is from the first to the last.
        orders: of the drive's rotation, as of ``steady``.
        refined: whether speeds are added and searched between the others.

    Raises:
        ValueError: speeds that do not rise, an order out of range.

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
    excited = _excited(self, orders)
    critical = self.critical_speeds(np.union1d(orders, excited))
    speeds = _rising(speed)
    if refined:
        speeds = _with_resonances(self, speeds, self.critical_speeds(excited))
    steady = self.steady(speeds, orders)
    found = _largest(self, speeds, steady, critical, _ROUNDS if refined else 0)
    return SpeedResponse(speeds, steady, tuple(found))


def _with_resonances(
    system: TorsionalSystem, speed: FloatArray, critical: FloatArray
) -> FloatArray:
    around = [speed]
    for mode, centres in zip(system.modes(), critical, strict=True):
        # The half-width of a resonance is its damping ratio.
        least = min(max(0.25 * mode.damping_ratio, 1e-4), 0.5 * _REACH)
        away = np.geomspace(least, _REACH, _AROUND)[:: _every(system)]
        around += [centre * (1.0 + np.concatenate([-away, [0.0], away])) for centre in centres]
    return _inside(speed, around)


def _largest(
    system: TorsionalSystem,
    speed: FloatArray,
    steady: SteadyState,
    critical: FloatArray,
    rounds: int,
) -> Iterator[LargestTorque]:
    unlimited = np.zeros(0)
    if not is_damped(system):
        by_order = critical.T.ravel()
        inside = by_order[(by_order >= speed[0]) & (by_order <= speed[-1])]
        unlimited = inside[~system.steady(inside).found]
    for place, shaft in enumerate(system.compliant):
        reversals = tuple(_reversals(speed, steady, place))
        if unlimited.size:
            yield LargestTorque(shaft, unlimited[0], -math.inf, math.inf, math.nan, reversals)
        elif np.any(steady.found):

            def value(_: FloatArray, found: SteadyState, of: int = place) -> FloatArray:
                return _sizes(found, of)

            at, found, best = located(system, speed, steady, value, rounds)
            ends = (found.torque_min, found.torque_max, found.torque_mean)
            least, most, mean = (float(end[place, best]) for end in ends)
            yield LargestTorque(shaft, float(at[best]), least, most, mean, reversals)


def is_damped(system: TorsionalSystem) -> bool:
    """Return whether anything takes energy from vibration."""
    losses = (own.loss_factor for own in system.couplings.values())
    viscous = (system.load_damping, system.dampings, system.drive_slope)
    return any(loss > 0.0 for loss in losses) or any(np.any(each > 0.0) for each in viscous)


def located(
    system: TorsionalSystem,
    speed: FloatArray,
    steady: SteadyState,
    value: Callable[[FloatArray, SteadyState], FloatArray],
    rounds: int = _ROUNDS,
) -> tuple[FloatArray, SteadyState, int]:
    """Return speeds ever closer to the largest value, the motion at them, and its place.

    The value is one of speeds and the motion at them, which must be known at one speed at least.
    """
    at, found = speed, steady
    best = int(np.nanargmax(value(at, found)))
    for _ in range(min(rounds, 2) if has_kinks(system) else rounds):
        low, high = at[max(best - 1, 0)], at[min(best + 1, len(at) - 1)]
        at = np.union1d(np.linspace(low, high, _EACH), [at[best]])
        found = system.steady(at, steady.orders)
        best = int(np.nanargmax(value(at, found)))
    return at, found, best


def _sizes(found: SteadyState, place: int) -> FloatArray:
    return np.asarray(np.maximum(np.abs(found.torque_min), np.abs(found.torque_max))[place])


def _reversals(speed: FloatArray, steady: SteadyState, place: int) -> Iterator[tuple[float, float]]:
    """Yield the speed ranges in which a torque with a mean changes its sign, interpolated."""
    if not np.any(steady.found):
        return
    mean = steady.torque_mean[place]
    noise = 1e-9 * np.nanmax(_sizes(steady, place))
    low = np.where(mean >= 0.0, steady.torque_min[place], -steady.torque_max[place])
    coupling = steady._system.couplings.get(steady.compliant[place])
    # Within its play a coupling has no torque: the flanks come apart.
    least = noise if coupling and coupling.play else 0.0
    for first, last in ranges(steady.found & (low < least) & (np.abs(mean) > noise)):
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


@dataclass(frozen=True)
class RunningSpeed:
    """A speed at which a motor gives the torque that a driveline needs.

    Attributes:
        speed: mean speed of the drive in rad/s.
        torque: mean torque in N m.
        slope: how much the torque of the motor falls with rising speed there in N m s/rad.
        torque_slope: by how much the needed torque rises with the speed, in N m s/rad.
        stable: whether vibration and speed return after a disturbance. The speed does where the
            sum of both slopes is positive.
    """

    speed: float
    torque: float
    slope: float
    torque_slope: float
    stable: bool


def running_speeds(
    self: TorsionalSystem, speed: ArrayLike, torque: ArrayLike
) -> tuple[RunningSpeed, ...]:
    """Return the speeds at which a motor drives one system, lowest first.

    The motor's torque is linear between the points of its curve. Where it crosses the mean torque
    that the driveline needs, the speed stays. Near a resonance there can be several such speeds.

    Args:
        speed: speeds of the motor's curve in rad/s, rising, ``(m,)``, two at least.
        torque: its torque in N m at these speeds, ``(m,)``.

    Raises:
        ValueError: a held drive, speeds that do not rise, as many torques as speeds.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0.3, 0], [0, 0.05]],
    ...     stiffnesses=[float("inf"), 8000],
    ...     dampings=[0, 3],
    ...     load_torque=30,
    ...     drive="free",
    ... )
    >>> [(round(at.speed, 1), at.stable) for at in system.running_speeds([150, 350], [64, 30])]
    [(203.1, True), (250.8, False), (312.6, True)]
    """
    check_single(self)
    if not self.free:
        raise ValueError(
            "the drive is held at constant speed; running speeds are those of a free one"
        )
    speeds, torques = _rising(speed), as_float64("torque", torque)
    if torques.shape != speeds.shape or len(speeds) < 2:
        problem = f"has shape {torques.shape}; it needs one per speed, {speeds.shape}, two at least"
        raise ArgumentValueError("torque", problem)
    critical = self.critical_speeds(_excited(self, _JOINT_ORDERS))
    dense = np.linspace(speeds[0], speeds[-1], _OVER_CURVE)
    at = _with_resonances(self, np.union1d(dense, speeds), critical)

    def excess(at: FloatArray) -> FloatArray:
        return np.asarray(np.interp(at, speeds, torques) - self.steady(at).drive_torque_mean)

    over = excess(at)
    before = np.flatnonzero(np.sign(over[:-1]) * np.sign(over[1:]) <= 0.0)
    low, high, sign = at[before], at[before + 1], np.sign(over[before])
    for _ in range(_HALVINGS_OF_SPEED if len(before) else 0):
        middle = 0.5 * (low + high)
        is_before = np.sign(excess(middle)) == sign
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    crossed = np.unique(0.5 * (low + high))
    # Where the driveline jumps to another motion the torque jumps as well.
    meets = np.abs(excess(crossed)) <= 1e-6 * np.max(np.abs(torques))
    return tuple(_running(self, speeds, torques, crossed[meets]))


def _running(
    system: TorsionalSystem, speeds: FloatArray, torques: FloatArray, at: FloatArray
) -> Iterator[RunningSpeed]:
    found = system.stability(at)
    slopes = -np.diff(torques) / np.diff(speeds)
    pieces = np.clip(np.searchsorted(speeds, at) - 1, 0, len(slopes) - 1)
    for place, piece in enumerate(pieces.tolist()):
        slope, needed = float(slopes[piece]), float(found.drive_torque_slope[place])
        vibrates = bool(_vibrates(found)[place])
        torque = float(np.interp(at[place], speeds, torques))
        yield RunningSpeed(
            float(at[place]), torque, slope, needed, slope + needed > 0.0 and not vibrates
        )
