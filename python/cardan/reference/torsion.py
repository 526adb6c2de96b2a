"""Torsional vibration again: every shaft end in turn, and the equations of motion integrated.

A compliant shaft is a spring and a damper between its ends. What is rigidly connected behind it
turns with its output end, through joints whose pins are vectors; by the power of all torques and
inertias this makes one equation per compliant shaft, and one of the drive if its speed is free. The
equations are integrated by the method of Runge and Kutta, from kink to kink of the springs. A
periodic motion is one that a period brings back: half a turn of the drive, or more where torques
have other orders. A spring with a constant loss factor has no equation in time: its motion is found
from the equations at samples of a period, with derivatives from the Fourier series through them.

Angles of both ends of a shaft are those of its input-side yoke, as the drive angle counts: the turn
from there to the other yoke, ``phase - twist + 90 degrees``, is added where the next joint begins.
States are the angles of the drive and of the output ends of the compliant shafts, then their speeds
in rad/s. All states of a call may be columns of an array, which are then integrated side by side.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.reference.evaluation import integrated
from cardan.reference.vectors import Shafts, Vector, _cross, _dot, _plus, _scaled, mean_offset

Array: TypeAlias = NDArray[np.floating[Any]]

# A number, or one for each state.
Value: TypeAlias = Any


@dataclass(frozen=True)
class TorqueHarmonic:
    """A torque ``cos * cos(order * angle) + sin * sin(order * angle)`` that drives a shaft end.

    Attributes are as of ``cardan.TorqueHarmonic``.
    """

    shaft: int
    end: str
    order: float
    cos: float = 0.0
    sin: float = 0.0


@dataclass(frozen=True)
class Coupling:
    """The spring of a shaft, by one of three laws, with the attributes of ``cardan.Coupling``."""

    stiffness: float | None = None
    twist: Sequence[float] | None = None
    torque: Sequence[float] | None = None
    play: float = 0.0
    contact_damping: bool = False
    loss_factor: float = 0.0
    mean_torque: Sequence[float] | None = None
    stiffness_by_mean: Sequence[float] | None = None


class _Law:
    """A piecewise linear spring: from kink to kink ``slope * twist + offset``."""

    def __init__(self, coupling: Coupling) -> None:
        if coupling.twist is not None and coupling.torque is not None:
            twist, torque = np.array(coupling.twist), np.array(coupling.torque)
            if twist[0] == 0.0:
                twist = np.concatenate([-twist[:0:-1], twist])
                torque = np.concatenate([-torque[:0:-1], torque])
            self.slopes = np.diff(torque) / np.diff(twist)
            self.offsets = torque[1:] - self.slopes * twist[1:]
            self.kinks = twist[1:-1]
        else:
            stiffness, flank = coupling.stiffness, 0.5 * coupling.play
            if stiffness is None:
                raise ValueError("the stiffness by the mean torque is that of an orbit")
            self.slopes = np.array([stiffness, 0.0, stiffness] if flank else [stiffness])
            offset = stiffness * flank
            self.offsets = np.array([offset, 0.0, -offset] if flank else [0.0])
            self.kinks = np.array([-flank, flank] if flank else [])
        acting = self.slopes / np.max(self.slopes)
        self.damper = acting if coupling.contact_damping else np.ones(len(self.slopes))

    def piece(self, twist: Value) -> Value:
        """Return the piece on which a twist lies."""
        return np.searchsorted(self.kinks, twist)

    def twist(self, torque: float) -> float:
        """Return a twist of the torque."""
        at_kinks = self.slopes[1:] * self.kinks + self.offsets[1:]
        piece = int(np.searchsorted(at_kinks, torque))
        # Within the play any twist will do.
        slope = self.slopes[piece]
        return float((torque - self.offsets[piece]) / slope) if slope else 0.0


@dataclass(frozen=True)
class System:
    """A driveline of ideal joints with compliant shafts.

    Attributes are as of ``cardan.TorsionalSystem``; inertias are pairs, and the stiffness of a
    shaft with a coupling is infinite.
    """

    shafts: Shafts
    inertias: Sequence[tuple[float, float]]
    stiffnesses: Sequence[float]
    dampings: Sequence[float]
    load_torque: float = 0.0
    load_damping: float = 0.0
    drive: str = "held"
    drive_slope: float = 0.0
    harmonics: Sequence[TorqueHarmonic] = ()
    couplings: Mapping[int, Coupling] = field(default_factory=dict)
    loss_factors: Sequence[float] | None = None

    @property
    def free(self) -> bool:
        """Whether the speed of the drive varies."""
        return self.drive == "free"

    @property
    def compliant(self) -> list[int]:
        """The compliant shafts."""
        finite = [math.isfinite(stiffness) for stiffness in self.stiffnesses]
        return [i for i, own in enumerate(finite) if own or i in self.couplings]

    @cached_property
    def springs(self) -> list[Coupling]:
        """Springs of the compliant shafts."""
        losses = self.loss_factors or [0.0] * len(self.stiffnesses)
        return [
            self.couplings.get(i, Coupling(self.stiffnesses[i], loss_factor=losses[i]))
            for i in self.compliant
        ]

    @cached_property
    def laws(self) -> list[_Law]:
        """Laws of the compliant shafts."""
        return [_Law(spring) for spring in self.springs]

    @cached_property
    def yoke_turns(self) -> list[float]:
        """The angle of the output-side yoke of each shaft less that of its input-side one."""
        pairs = zip(self.shafts.phases, self.shafts.twists, strict=True)
        return [0.0, *(phase - twist + math.pi / 2 for phase, twist in pairs), 0.0]

    @property
    def period_turns(self) -> float:
        """Turns of the drive after which all torques repeat; those of joints do after a half."""
        common = Fraction(2)
        for harmonic in self.harmonics:
            order = Fraction(harmonic.order).limit_denominator(1000)
            whole = math.gcd(
                common.numerator * order.denominator, order.numerator * common.denominator
            )
            common = Fraction(whole, common.denominator * order.denominator)
        return float(1 / common)


@dataclass(frozen=True)
class Motion:
    """Motion of a system at drive angles; states come last.

    Attributes are as of ``cardan.torsion.Orbit``, the torque of the drive with the harmonics at its
    end, and the acceleration while a held drive keeps its speed.
    """

    angle_error: Array
    speed: Array
    acceleration: Array
    torque: Array
    drive_torque: Array


class _End(NamedTuple):
    """A shaft end that turns with another one: its angle and two derivatives in that one's."""

    shaft: int
    side: int
    angle: Value
    ratio: Value
    slope: Value


def _passed(u: Vector, v: Vector, m: Vector, angle: Value) -> tuple[Value, Value, Value]:
    """Return the driven angle from the bend-plane normal, and two derivatives in the driving one.

    The driving pin is turned; the driven one is perpendicular to it and to its shaft.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    a: Value = _plus(_scaled(cosine, _cross(m, u)), _scaled(sine, m))
    b: Value = _cross(v, a)
    b = _scaled(1.0 / np.sqrt(_dot(b, b)), b)
    # As in ``vectors``: ``a . b = 0`` once and twice differentiated, with ``n = a x b``.
    n: Value = _cross(a, b)
    ratio = _dot(u, n) / _dot(v, n)
    n_rate: Value = _plus(_cross(_cross(u, a), b), _scaled(ratio, _cross(a, _cross(v, b))))
    slope = (_dot(u, n_rate) - ratio * _dot(v, n_rate)) / _dot(v, n)
    x, y = _dot(b, m), -_dot(b, _cross(m, v))
    return angle + np.arctan2(y * cosine - x * sine, x * cosine + y * sine), ratio, slope


def _carried(system: System, shaft: int, side: int, angle: Value) -> list[_End]:
    """Return an end and those that turn with it, up to the input end of the next spring."""
    shafts, ends = system.shafts, [_End(shaft, side, angle, 1.0, 0.0)]
    while True:
        at = ends[-1]
        if at.side == 0 and at.shaft in system.compliant:
            return ends
        if at.side == 0:
            ends.append(_End(at.shaft, 1, at.angle, at.ratio, at.slope))
        elif at.shaft == len(shafts.normals):
            return ends
        else:
            u, v = shafts.directions[at.shaft : at.shaft + 2]
            driving = at.angle + system.yoke_turns[at.shaft]
            driven, ratio, slope = _passed(u, v, shafts.normals[at.shaft], driving)
            slope = slope * at.ratio**2 + ratio * at.slope
            ends.append(_End(at.shaft + 1, 0, driven, ratio * at.ratio, slope))


def _behind(system: System, angles: Sequence[Value] | Array) -> list[list[_End]]:
    """Return what turns with the drive, and what turns with each compliant shaft."""
    places = [(0, 0), *((i, 1) for i in system.compliant)]
    return [_carried(system, *at, angle) for at, angle in zip(places, angles, strict=True)]


class _Balance(NamedTuple):
    """Torques in states by spring, accelerations by the drive and the springs."""

    groups: list[list[_End]]  # ends that turn with each of the latter
    torques: list[Value]  # of the springs
    accelerations: list[Value]  # of those who turn
    drive_torque: Value


def _balance(
    system: System,
    speed: float,
    mean_torque: Value,
    state: Array,
    pieces: Sequence[Value] | None = None,
    losses: Sequence[Value] | None = None,
) -> _Balance:
    """Return what acts in states, which are angles and speeds.

    The torque is the mean one of a free drive at this speed. Pieces are those of the springs' laws,
    by default of the twists, and losses are torques of the springs beside their laws.
    """
    angles, speeds = np.split(state, 2)
    groups = _behind(system, angles)
    torques = []
    for k, (twist, law) in enumerate(zip(_twists(groups), system.laws, strict=True)):
        piece = law.piece(twist) if pieces is None else pieces[k]
        slip = groups[k][-1].ratio * speeds[k] - speeds[k + 1]
        damping = system.dampings[system.compliant[k]] * law.damper[piece]
        torque = law.slopes[piece] * twist + law.offsets[piece] + damping * slip
        torques.append(torque if losses is None else torque + losses[k])
    # By power: what a group passes on, and what its inertias need at a constant speed.
    needed = []
    for k, (group, w) in enumerate(zip(groups, speeds, strict=True)):
        last = group[-1]
        if k < len(torques):
            passed = torques[k] * last.ratio
        else:
            passed = (system.load_torque + system.load_damping * last.ratio * w) * last.ratio
        kept = (_inertia(system, end) * end.ratio * end.slope * w**2 for end in group)
        driven = (end.ratio * _driving(system, end) for end in group)
        needed.append(passed + sum(kept) - sum(driven))
    inertias = [sum(_inertia(system, end) * end.ratio**2 for end in group) for group in groups]
    accelerations = [
        (torque - need) / inertia
        for torque, need, inertia in zip(torques, needed[1:], inertias[1:], strict=True)
    ]
    falling = system.drive_slope * (speeds[0] - speed)
    first = (mean_torque - falling - needed[0]) / inertias[0] if system.free else 0.0 * speeds[0]
    accelerations = [first, *accelerations]
    own = _driving(system, groups[0][0])
    drive_torque = needed[0] + own + inertias[0] * accelerations[0]
    return _Balance(groups, torques, accelerations, drive_torque)


def _twists(groups: Sequence[Sequence[_End]]) -> list[Value]:
    """Return the twists of the springs."""
    return [before[-1].angle - behind[0].angle for before, behind in pairwise(groups)]


def _inertia(system: System, end: _End) -> float:
    return system.inertias[end.shaft][end.side]


def _driving(system: System, end: _End) -> Value:
    """Return the torque that drives an end."""
    place = (end.shaft, ("input", "output")[end.side])
    return sum(
        own.cos * np.cos(own.order * end.angle) + own.sin * np.sin(own.order * end.angle)
        for own in system.harmonics
        if (own.shaft, own.end) == place
    )


def _rates(
    system: System, speed: float, torque: Value, state: Array, pieces: Sequence[Value] | None = None
) -> Array:
    """Return the time derivatives of states."""
    accelerations = _balance(system, speed, torque, state, pieces).accelerations
    return np.concatenate([np.split(state, 2)[1], accelerations])


def _step(
    system: System, speed: float, torque: Value, state: Array, pieces: Sequence[Value], width: float
) -> Array:
    """Return the states after a step of time on some pieces of the springs' laws."""
    return integrated(lambda _, now: _rates(system, speed, torque, now, pieces), state, width, 1)[0]


def _motion(
    system: System,
    mean_angle: Value,
    speed: float,
    torque: Value,
    state: Array,
    losses: Sequence[Value] | None = None,
) -> Motion:
    """Return what a system does in states, ahead of the mean angles of the drive."""
    own = _balance(system, speed, torque, state, losses=losses)
    speeds = np.split(state, 2)[1]
    each = {
        (end.shaft, end.side): (
            end.angle - mean_angle - zero_of(system, end.shaft),
            end.ratio * w,
            end.ratio * acceleration + end.slope * w**2,
        )
        for group, w, acceleration in zip(own.groups, speeds, own.accelerations, strict=True)
        for end in group
    }
    shape = np.shape(mean_angle)
    ends = [[np.broadcast_to(x, shape) for x in each[place]] for place in sorted(each)]
    errors, rates, curves = np.moveaxis(np.array(ends), 1, 0).reshape(3, -1, 2, *shape)
    torques = np.array(own.torques).reshape(-1, *shape)
    return Motion(errors, rates, curves, torques, own.drive_torque)


def zero_of(system: System, shaft: int) -> float:
    """Return the mean of the angle by which a shaft is ahead of the drive, if all are rigid."""
    return mean_offset(system.shafts, shaft) + sum(system.yoke_turns[:shaft])


def rigid(system: System, speed: float) -> Array:
    """Return the state of rigid shafts at the drive angle 0, wound up by the mean load."""
    load = system.load_torque + system.load_damping * speed
    stiff = replace(system, stiffnesses=[math.inf] * len(system.stiffnesses), couplings={})
    ends = {(end.shaft, end.side): end for end in _carried(stiff, 0, 0, 0.0)}
    own = [ends[0, 0], *(ends[shaft, 1] for shaft in system.compliant)]
    wound = np.cumsum([0.0, *(law.twist(load) for law in system.laws)])
    angles, ratios = np.array([(end.angle, end.ratio) for end in own]).T
    return np.concatenate([angles - wound, ratios * speed])


# How near to a kink a spring's twist is at it [rad].
_NEAR = 1e-13


def _crossed(
    system: System, speed: float, torque: float, state: Array, pieces: list[int], width: float
) -> Array:
    """Return the state after a step in which springs come to kinks: from one to the next."""

    def after(time: float) -> Array:
        return _step(system, speed, torque, state, pieces, time)

    def beyond(spring: int, side: int, now: Array) -> float:
        """Return how far a spring has left its piece."""
        kinks = system.laws[spring].kinks
        kink = pieces[spring] - (side < 0)
        if not 0 <= kink < len(kinks):
            return -math.inf
        twist = float(_twists(_behind(system, np.split(now, 2)[0]))[spring])
        return side * (twist - float(kinks[kink]))

    def meeting(spring: int, side: int) -> float:
        """Return when a spring leaves its piece: regula falsi; an end that stays counts half."""
        low, high, at_high = 0.0, width, beyond(spring, side, end)
        at_low = min(beyond(spring, side, state), -_NEAR)
        for _ in range(100):
            if abs(at_high) <= _NEAR:
                return high
            time = (low * at_high - high * at_low) / (at_high - at_low)
            now = beyond(spring, side, after(time))
            low, at_low = (high, at_high) if now * at_high < 0.0 else (low, 0.5 * at_low)
            high, at_high = time, now
        raise ArithmeticError("a kink is not met")

    for _ in range(100):
        end = after(width)
        left = [(k, side) for k in range(len(pieces)) for side in (-1, 1)]
        left = [place for place in left if beyond(*place, end) > _NEAR]
        if not left:
            return end
        time, spring, side = min((meeting(*place), *place) for place in left)
        state, width = after(time), width - time
        pieces[spring] += side
    raise ArithmeticError("a spring stays at a kink")


def period(
    system: System, speed: float, state: Array, steps: int, torque: Value = 0.0
) -> list[Array]:
    """Return the states after each step of a period, from the drive angle 0.

    A spring that passes a kink and comes back within one step is taken to stay. Stiffnesses of the
    system depend on no mean torque, and it has no loss factor. The speed is the mean one of the
    drive [rad/s], as in all functions. With columns of states, each may have its own mean torque of
    a free drive [N m].
    """
    width = system.period_turns * math.tau / speed / steps
    kinked = any(len(law.kinks) for law in system.laws)

    def pieces_of(now: Array) -> list[Value]:
        if not kinked:
            return [0] * len(system.laws)
        twists = _twists(_behind(system, np.split(now, 2)[0]))
        return [law.piece(twist) for law, twist in zip(system.laws, twists, strict=True)]

    states = []
    for _ in range(steps):
        pieces = pieces_of(state)
        after = _step(system, speed, torque, state, pieces, width)
        left = [a != b for a, b in zip(pieces, pieces_of(after), strict=True)]
        for place in np.argwhere(np.any(left, axis=0)) if left else ():
            column = tuple(place)
            own = float(np.broadcast_to(torque, state.shape[1:])[column])
            before = [int(piece[column]) for piece in pieces]
            at = (slice(None), *column)
            after[at] = _crossed(system, speed, own, state[at], before, width)
        state = after
        states.append(state)
    return states


@dataclass(frozen=True)
class Orbit:
    """A periodic motion. Time begins at the drive angle 0.

    Attributes:
        system: whose.
        speed: mean speed of the drive [rad/s].
        state: at the beginning.
        drive_torque_mean: of the drive at its mean speed, without its harmonics [N m].
        lead: mean of the drive's angle less ``speed * time``.
        motion: after each step of the period, ahead of the mean angle of the drive.
        multipliers: by which deviations grow in a period; a free drive's is without the 1 of a
            shift in time, whose error is ``shift_error``. None of collocated ones.
        shift_error: relative.
    """

    system: System
    speed: float
    state: Array
    drive_torque_mean: float
    lead: float
    motion: Motion
    multipliers: NDArray[np.complexfloating[Any]]
    shift_error: float = math.nan

    def orders(self, values: Array, orders: Sequence[float]) -> NDArray[np.complexfloating[Any]]:
        """Return ``X`` of ``Re X exp(i order angle)`` in values of the motion.

        The angle is the mean one of the drive, ``speed * time + lead``.
        """
        count = values.shape[-1]
        angles = self.system.period_turns * math.tau * np.arange(1, count + 1) / count + self.lead
        turned = np.exp(-1j * np.outer(orders, angles))
        return np.asarray(2.0 * np.mean(values[..., np.newaxis, :] * turned, axis=-1))

    @property
    def power(self) -> tuple[float, float]:
        """Mean power of the drive, and that of the load and of all losses [W]."""
        motion, ends = self.motion, self.system.compliant
        slips = motion.speed[ends, 0] - motion.speed[ends, 1]
        last = motion.speed[-1, 1]
        lost = np.sum(np.mean(motion.torque * slips, axis=-1))
        load = self.system.load_torque * self.speed + self.system.load_damping * np.mean(last**2)
        drive = self.system.drive_slope * np.var(motion.speed[0, 0])
        return self.drive_torque_mean * self.speed, float(lost + load + drive)

    @property
    def speed_multiplier(self) -> float:
        """The real multiplier next to 1: by it a free drive comes back to its speed, or leaves."""
        real = self.multipliers[np.abs(self.multipliers.imag) < 1e-9].real
        return float(real[np.argmin(np.abs(real - 1.0))])


def extremes(values: Array) -> tuple[Array, Array]:
    """Return least and largest values of the Fourier series through samples of a period."""
    count, fine = values.shape[-1], 32
    dense = np.fft.irfft(np.fft.rfft(values), count * fine) * fine

    def largest(of: Array) -> Array:
        place = np.argmax(of, axis=-1)[..., np.newaxis]
        before, at, behind = (
            np.take_along_axis(of, (place + i) % of.shape[-1], -1)[..., 0] for i in (-1, 0, 1)
        )
        curve = 2.0 * at - before - behind
        return at + (behind - before) ** 2 / (8.0 * np.where(curve > 0.0, curve, 1.0))

    return -largest(-dense), largest(dense)


def _found(
    system: System,
    speed: float,
    states: Array,
    torque: float,
    multipliers: NDArray[np.complexfloating[Any]],
    shift_error: float = math.nan,
    losses: Sequence[Array] | None = None,
) -> Orbit:
    """Return the periodic motion whose states after each step are found."""
    count = states.shape[-1]
    turned = system.period_turns * math.tau * np.arange(1, count + 1) / count
    lead = float(np.mean(states[0] - turned))
    motion = _motion(system, turned + lead, speed, torque, states, losses)
    state = states[:, -1].copy()
    state[: len(state) // 2] -= turned[-1]
    mean = torque if system.free else float(np.mean(motion.drive_torque))
    return Orbit(system, speed, state, mean, lead, motion, multipliers, shift_error)


def _by_mean_torque(
    system: System, start: Array | None, find: Callable[[System, Array | None], Orbit]
) -> Orbit:
    """Return a periodic motion whose mean torques have the stiffnesses with which it is found."""
    tables = {
        i: (own, own.mean_torque, own.stiffness_by_mean)
        for i, own in system.couplings.items()
        if own.mean_torque is not None and own.stiffness_by_mean is not None
    }
    means = dict.fromkeys(tables, system.load_torque)
    for _ in range(40):
        own = {
            i: Coupling(
                float(np.interp(abs(means[i]), mean, stiffness)), loss_factor=of.loss_factor
            )
            for i, (of, mean, stiffness) in tables.items()
        }
        found = find(replace(system, couplings={**system.couplings, **own}), start)
        start, before = found.state, means
        means = {i: float(np.mean(found.motion.torque[system.compliant.index(i)])) for i in tables}
        if all(abs(means[i] - before[i]) <= 1e-12 * abs(means[i]) + 1e-12 for i in tables):
            return found
    raise ArithmeticError("no stiffness agrees with its mean torque")


def orbit(system: System, speed: float, start: Array | None = None, *, steps: int = 240) -> Orbit:
    """Return the periodic motion near a start, by integration and Newton's method.

    The start is moved until a period brings the state back. Motions from nearby starts show how the
    end depends on the start. The eigenvalues of this dependence are the multipliers by which
    deviations grow. Other starts may lead to other periodic motions. A free drive begins at the
    angle 0, and its mean torque is sought in place of its angle. The start is a state at the drive
    angle 0, by default that of rigid shafts. The error falls with the fourth power of the steps of
    half a turn.

    Raises:
        ArithmeticError: no periodic motion is found.
        ValueError: a loss factor.
    """
    if any(spring.stiffness_by_mean is not None for spring in system.springs):
        return _by_mean_torque(system, start, lambda own, at: orbit(own, speed, at, steps=steps))
    if any(spring.loss_factor for spring in system.springs):
        raise ValueError("a loss factor has no law in time")
    at = rigid(system, speed) if start is None else start
    count = round(2.0 * system.period_turns * steps)
    time = system.period_turns * math.tau / speed
    m = len(at) // 2
    # The torque of a free drive is unknown too; a held one has no unknown.
    scale = np.array([*[1.0] * m, *[speed] * m, float(np.sum(system.inertias)) * speed / time])
    moving = np.arange(2 * m) if system.free else np.delete(np.arange(2 * m), [0, m])
    turn = np.repeat([system.period_turns * math.tau, 0.0], m)
    at = np.array([*at, system.load_torque + system.load_damping * speed])
    h = 1e-5
    for _ in range(40):
        aside = h * np.diag(scale)[:, [*moving, 2 * m] if system.free else moving]
        columns = at[:, np.newaxis] + np.hstack([np.zeros((2 * m + 1, 1)), aside, -aside])
        states = np.array(period(system, speed, columns[:-1], count, columns[-1]))
        missed = ((states[-1, :, 0] - turn - at[:-1]) / scale[:-1])[moving]
        above, below = np.split(states[-1, moving, 1:] / scale[moving, np.newaxis], 2, axis=1)
        matrix = (above - below) / (2.0 * h)
        own = matrix[:, : len(moving)]
        if np.max(np.abs(missed)) < 1e-10:
            shift = math.nan
            if system.free:
                rates = (_rates(system, speed, at[-1], at[:-1]) / scale[:-1])[:, np.newaxis]
                shift = float(np.max(np.abs(own @ rates - rates)) / np.max(np.abs(rates)))
                aside = np.linalg.qr(rates, mode="complete")[0][:, 1:]
                own = aside.T @ own @ aside
            multipliers = np.linalg.eigvals(own)
            return _found(system, speed, states[..., 0].T, float(at[-1]), multipliers, shift)
        # The end less the start, by the unknowns.
        change = matrix.copy()
        change[:, : len(moving)] -= np.eye(len(moving))
        unknown = [*moving, 2 * m][1:] if system.free else moving
        step = np.linalg.solve(change[:, 1:] if system.free else change, -missed)
        at[unknown] += scale[unknown] * step / max(1.0, float(np.max(np.abs(step))))
    raise ArithmeticError("no periodic motion is found")


def collocated(
    system: System, speed: float, start: Array | None = None, *, samples: int = 32
) -> Orbit:
    """Return the periodic motion near that of rigid shafts, without integration.

    The angles at equal times of a period are moved until the equations of motion hold there, with
    the derivatives of the Fourier series through the angles. A loss factor turns each order of the
    twist by a quarter. The error falls faster than any power of the samples of half a turn if no
    spring has kinks. Of a start, a state at the drive angle 0, the wind-up counts.

    Raises:
        ArithmeticError: no periodic motion is found.
    """
    if any(spring.stiffness_by_mean is not None for spring in system.springs):
        return _by_mean_torque(
            system, start, lambda own, at: collocated(own, speed, at, samples=samples)
        )
    # An odd number has no order that samples meet in its zeros.
    count = round(2.0 * system.period_turns * samples) | 1
    turned = system.period_turns * math.tau * np.arange(count) / count
    first = 0 if system.free else 1
    initial = rigid(system, speed) if start is None else start
    m = len(initial) // 2
    orders = np.fft.fftfreq(count, 1.0 / count)[:, np.newaxis]
    series = np.fft.fft(np.eye(count), axis=0)
    rate = speed / system.period_turns
    derivative = np.fft.ifft(1j * rate * orders * series, axis=0).real
    quarter = np.fft.ifft(1j * np.sign(orders) * series, axis=0).real
    stiffnesses = [float(law.slopes[0]) for law in system.laws]

    def parts(unknown: Array) -> tuple[Array, Array, Value, list[Value]]:
        """Return the accelerations of the series, states, torques of the drive and of losses."""
        leads = np.zeros((m, count, unknown.shape[1]))
        leads[first:] = unknown[: (m - first) * count].reshape(m - first, count, -1)
        angles = turned[:, np.newaxis] + leads
        losses = [
            spring.loss_factor * stiffness * (quarter @ twist)
            for spring, stiffness, twist in zip(
                system.springs, stiffnesses, _twists(_behind(system, angles)), strict=True
            )
        ]
        rates = derivative @ leads
        state = np.concatenate([angles, speed + rates])
        return derivative @ rates, state, unknown[-1] if system.free else 0.0, losses

    def missed(unknown: Array) -> Array:
        """Return what the equations of motion lack, and the lead of the drive at its angle 0."""
        curves, state, torque, losses = parts(unknown)
        wanted = _balance(system, speed, torque, state, losses=losses).accelerations
        off = [(a - b) / speed**2 for a, b in zip(curves, wanted, strict=True)]
        return np.concatenate([*off[first:], state[:1, 0] if system.free else state[:0, 0]])

    at = np.repeat(initial[first:m], count)
    scale = np.ones(len(at))
    if system.free:
        at = np.append(at, system.load_torque + system.load_damping * speed)
        scale = np.append(scale, float(np.sum(system.inertias)) * speed**2)
    h = 1e-6
    for _ in range(40):
        off = missed(at[:, np.newaxis] + np.hstack([np.zeros((len(at), 1)), h * np.diag(scale)]))
        step = np.linalg.solve((off[:, 1:] - off[:, :1]) / h, -off[:, 0])
        at += scale * step / max(1.0, float(np.max(np.abs(step))))
        if np.max(np.abs(step)) < 1e-10:
            _, state, torque, losses = parts(at[:, np.newaxis])
            # From the first step on, as motions that are integrated.
            states = np.roll(state[..., 0], -1, axis=1)
            states[:m, -1] += system.period_turns * math.tau
            own = [np.roll(loss[:, 0], -1) for loss in losses]
            none = np.empty(0, np.complex128)
            mean = float(torque[0]) if system.free else 0.0
            return _found(system, speed, states, mean, none, losses=own)
    raise ArithmeticError("no periodic motion is found")


def drive_torque_slope(
    system: System, speed: float, find: Callable[[System, float], Orbit] = orbit
) -> float:
    """Return by how much the mean torque of the drive grows with its speed [N m s/rad].

    ``find`` finds the periodic motions.
    """
    h = 1e-4 * speed
    above, below = (find(system, at).drive_torque_mean for at in (speed + h, speed - h))
    return (above - below) / (2.0 * h)


def transient(
    system: System, speed: Callable[[float], float], start: Array, end: float, *, steps: int
) -> Motion:
    """Return the motion of a held drive in time from a state, after each of the steps to the end.

    The springs of the system have no kinks. Times are in s.
    """
    drive = len(start) // 2

    def slopes(time: float, now: Array) -> Array:
        now = now.copy()
        now[drive] = speed(time)
        return _rates(system, speed(time), 0.0, now)

    width = end / steps
    states = np.array(integrated(slopes, start, width, steps)).T
    states[drive] = [speed(width * (i + 1)) for i in range(steps)]
    return _motion(system, states[0], math.nan, 0.0, states)


def natural_frequencies(system: System) -> Array:
    """Return the natural frequencies of the mean system in rad/s, lowest first.

    Its inertias are the means over a turn of what turns with the drive and with each compliant
    shaft; joints transmit one to one. A free drive's rigid motion is left out.

    Raises:
        ValueError: a spring has several stiffnesses.
    """
    angles = np.arange(720) * math.tau / 720
    means = [
        sum(float(np.mean(_inertia(system, end) * end.ratio**2)) for end in group)
        for group in _behind(system, [angles] * (len(system.compliant) + 1))
    ]
    stiffnesses = [float(law.slopes.item()) for law in system.laws]
    # The twist of each shaft from the angles of the ends.
    twists = np.eye(len(stiffnesses), len(means)) - np.eye(len(stiffnesses), len(means), 1)
    free = slice(0 if system.free else 1, None)
    springs = (twists.T @ np.diag(stiffnesses) @ twists)[free, free]
    squares = np.sort(np.linalg.eigvals(springs / np.array(means[free])[:, np.newaxis]).real)
    return np.asarray(np.sqrt(squares[1 if system.free else 0 :]))
