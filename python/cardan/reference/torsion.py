"""Torsional vibration again: every shaft end in turn, and the equations of motion integrated.

A compliant shaft is a spring and a damper between its ends. What is rigidly connected behind it
turns with its output end, through joints whose pins are vectors; by the power of all torques and
inertias this makes one equation per compliant shaft. The equations are integrated by the method of
Runge and Kutta. A periodic motion is one that half a turn of the drive brings back.

Angles of states are those of the yoke at the output side of a shaft, as the drive angle counts. All
states of a call may be columns of an array, which are then integrated side by side.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.reference.evaluation import integrated
from cardan.reference.vectors import Shafts, Vector, _cross, _dot, _plus, _scaled, mean_offset

Array: TypeAlias = NDArray[np.floating[Any]]

# A number, or one for each state.
Value: TypeAlias = Any


@dataclass(frozen=True)
class System:
    """A driveline with compliant shafts, whose drive turns at a given speed.

    Attributes:
        shafts: the driveline, of ideal joints.
        inertias: of each shaft at its input end and at its output end [kg m²].
        stiffnesses: of each shaft [N m/rad], infinite of a rigid one.
        dampings: of each shaft [N m s/rad].
        load_torque: that brakes the last shaft [N m].
        load_damping: of the load [N m s/rad].
    """

    shafts: Shafts
    inertias: Sequence[tuple[float, float]]
    stiffnesses: Sequence[float]
    dampings: Sequence[float]
    load_torque: float = 0.0
    load_damping: float = 0.0

    @property
    def compliant(self) -> list[int]:
        """The compliant shafts."""
        return [i for i, stiffness in enumerate(self.stiffnesses) if math.isfinite(stiffness)]


@dataclass(frozen=True)
class Motion:
    """What a system does at drive angles, of each end or compliant shaft; states come last.

    Attributes:
        angle_error: of each shaft end ahead of the drive, ``(n + 1, 2, ...)``; of rigid shafts its
            mean is 0.
        speed: in rad/s, likewise.
        acceleration: in rad/s², likewise, while the drive keeps its speed.
        torque: of each compliant shaft in N m.
        drive_torque: that keeps the speed of the drive.
    """

    angle_error: Array
    speed: Array
    acceleration: Array
    torque: Array
    drive_torque: Array


@dataclass(frozen=True)
class _End:
    """A shaft end that turns with another one: its angle, and two derivatives by that one's."""

    shaft: int
    side: int
    angle: Value
    ratio: Value
    slope: Value


def _passed(u: Vector, v: Vector, m: Vector, angle: Value) -> tuple[Value, Value, Value]:
    """Return the driven angle from the bend-plane normal, and two derivatives by the driving one.

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


def _step(shafts: Shafts, shaft: int) -> float:
    """Return the angle of a shaft's output-side yoke less that of its input-side one."""
    if not 0 < shaft < len(shafts.normals):
        return 0.0
    v, m = shafts.directions[shaft], shafts.normals[shaft - 1]
    zero = _cross(shafts.normals[shaft], v)
    return shafts.phases[shaft - 1] - math.atan2(_dot(v, _cross(m, zero)), _dot(m, zero))


def _carried(system: System, shaft: int, side: int, angle: Value) -> list[_End]:
    """Return an end and those that turn with it, up to the input end of the next spring."""
    shafts, ends = system.shafts, [_End(shaft, side, angle, 1.0, 0.0)]
    while True:
        at = ends[-1]
        if at.side == 0 and math.isfinite(system.stiffnesses[at.shaft]):
            return ends
        if at.side == 0:
            ends.append(_End(at.shaft, 1, at.angle, at.ratio, at.slope))
        elif at.shaft == len(shafts.normals):
            return ends
        else:
            u, v = shafts.directions[at.shaft : at.shaft + 2]
            driven, ratio, slope = _passed(u, v, shafts.normals[at.shaft], at.angle)
            slope = slope * at.ratio**2 + ratio * at.slope
            behind = driven + _step(shafts, at.shaft + 1)
            ends.append(_End(at.shaft + 1, 0, behind, ratio * at.ratio, slope))


def _behind(system: System, angle: Value, state: Array) -> list[list[_End]]:
    """Return what turns with the drive, and what turns with each compliant shaft."""
    starts = [(0, 0, angle), *((i, 1, x) for i, x in zip(system.compliant, state, strict=False))]
    return [_carried(system, *start) for start in starts]


def _torques(
    system: System, groups: Sequence[Sequence[_End]], speed: Value, state: Array
) -> tuple[Array, Array, Value]:
    """Return the torques of the springs, the accelerations behind them, and the drive's torque."""
    compliant = system.compliant
    speeds = [speed, *state[len(compliant) :]]
    torques = []
    for k, shaft in enumerate(compliant):
        before, behind = groups[k][-1], groups[k + 1][0]
        slip = before.ratio * speeds[k] - speeds[k + 1]
        spring = system.stiffnesses[shaft] * (before.angle - behind.angle)
        torques.append(spring + system.dampings[shaft] * slip)
    # By power: what the inertias of a group need at a constant speed, and pass on.
    needed = []
    for k, (group, w) in enumerate(zip(groups, speeds, strict=True)):
        last = group[-1]
        if k < len(torques):
            passed = torques[k] * last.ratio
        else:
            passed = (system.load_torque + system.load_damping * last.ratio * w) * last.ratio
        kept = (_inertia(system, end) * end.ratio * end.slope * w**2 for end in group)
        needed.append(passed + sum(kept))
    accelerations = [
        (torque - need) / sum(_inertia(system, end) * end.ratio**2 for end in group)
        for torque, need, group in zip(torques, needed[1:], groups[1:], strict=True)
    ]
    return np.array(torques), np.array(accelerations), needed[0]


def _inertia(system: System, end: _End) -> float:
    return system.inertias[end.shaft][end.side]


def _slopes(system: System, angle: Value, speed: Value, state: Array) -> Array:
    """Return the derivatives of a state by time."""
    _, accelerations, _ = _torques(system, _behind(system, angle, state), speed, state)
    return np.concatenate([state[len(system.compliant) :], accelerations])


def motion(system: System, angle: Value, speed: Value, state: Array) -> Motion:
    """Return what a system does in states.

    Args:
        angle: drive angle of each state.
        speed: of the drive [rad/s].
        state: the angles of the output ends of the compliant shafts, then their speeds [rad/s].
    """
    groups = _behind(system, angle, state)
    torques, accelerations, needed = _torques(system, groups, speed, state)
    speeds = [speed, *state[len(system.compliant) :]]
    starts = zip(groups, speeds, [0.0, *accelerations], strict=True)
    each = {
        (end.shaft, end.side): (
            end.angle - angle - zero_of(system, end.shaft),
            end.ratio * w,
            end.ratio * acceleration + end.slope * w**2,
        )
        for group, w, acceleration in starts
        for end in group
    }
    shape = np.shape(angle)
    ends = [[np.broadcast_to(x, shape) for x in each[place]] for place in sorted(each)]
    errors, rates, curves = np.moveaxis(np.array(ends), 1, 0).reshape(3, -1, 2, *shape)
    return Motion(errors, rates, curves, torques, needed)


def zero_of(system: System, shaft: int) -> float:
    """Return the mean of the angle by which a shaft is ahead of the drive, if all are rigid."""
    steps = sum(_step(system.shafts, i) for i in range(shaft + 1))
    return mean_offset(system.shafts, shaft) + steps


def rigid(system: System, speed: float) -> Array:
    """Return the state of rigid shafts at the drive angle 0."""
    stiff = replace(system, stiffnesses=[math.inf] * len(system.stiffnesses))
    ends = {(end.shaft, end.side): end for end in _carried(stiff, 0, 0, 0.0)}
    own = [ends[shaft, 1] for shaft in system.compliant]
    return np.array([*(end.angle for end in own), *(end.ratio * speed for end in own)])


def half_turn(system: System, speed: float, state: Array, steps: int) -> list[Array]:
    """Return the states after each step of half a turn of the drive, from the drive angle 0."""
    return integrated(
        lambda angle, now: _slopes(system, angle, speed, now) / speed, state, math.pi / steps, steps
    )


def orbit(
    system: System, speed: float, start: Array | None = None, *, steps: int = 240
) -> tuple[Array, NDArray[np.complexfloating[Any]], Motion]:
    """Return the periodic motion near a start, by Newton's method.

    It is the state at the drive angle 0, the multipliers, and the motion after each step.

    The start is moved until half a turn of the drive brings the state back. Motions from nearby
    starts show how the end depends on the start. The eigenvalues of this dependence are the
    multipliers by which deviations grow. Other starts may lead to other periodic motions.

    Args:
        speed: of the drive [rad/s].
        start: a state at the drive angle 0; by default that of rigid shafts.
        steps: of half a turn; the error falls with their fourth power.

    Raises:
        ArithmeticError: no periodic motion is found.
    """
    at = rigid(system, speed) if start is None else start
    m = len(system.compliant)
    scale, turn = np.repeat([1.0, speed], m), np.repeat([math.pi, 0.0], m)
    h = 1e-5
    for _ in range(40):
        aside = h * np.diag(scale)
        beside = at[:, np.newaxis] + np.hstack([np.zeros((2 * m, 1)), aside, -aside])
        states = np.array(half_turn(system, speed, beside, steps))
        missed = (states[-1, :, 0] - turn - at) / scale
        above, below = np.split(states[-1, :, 1:] / scale[:, np.newaxis], 2, axis=1)
        matrix = (above - below) / (2.0 * h)
        if np.max(np.abs(missed)) < 1e-10:
            angles = np.arange(1, steps + 1) * math.pi / steps
            own = motion(system, angles, speed, states[..., 0].T)
            return at, np.linalg.eigvals(matrix), own
        step = np.linalg.solve(np.eye(2 * m) - matrix, missed)
        at = at + scale * step / max(1.0, float(np.max(np.abs(step))))
    raise ArithmeticError("no periodic motion is found")


def transient(
    system: System, speed: Callable[[float], float], start: Array, end: float, *, steps: int
) -> Motion:
    """Return the motion in time from the drive angle 0, after each step.

    Args:
        speed: of the drive by time [rad/s].
        start: a state.
        end: time of the last step [s].
        steps: until then.
    """

    def slopes(time: float, now: Array) -> Array:
        rate = speed(time)
        return np.concatenate([[rate], _slopes(system, now[0], rate, now[1:])])

    width = end / steps
    states = np.array(integrated(slopes, np.array([0.0, *start]), width, steps)).T
    speeds = np.array([speed(width * (i + 1)) for i in range(steps)])
    return motion(system, states[0], speeds, states[1:])


def natural_frequencies(system: System) -> Array:
    """Return the natural frequencies of the mean system in rad/s, lowest first.

    Its inertias are the means over a turn of what turns with each compliant shaft; joints transmit
    one to one, and the drive is held.
    """
    angles = np.arange(720) * math.tau / 720
    means = [
        sum(float(np.mean(_inertia(system, end) * end.ratio**2)) for end in group)
        for group in _behind(system, 0.0, np.array([angles] * len(system.compliant)))[1:]
    ]
    # The twist of each shaft from the angles of the ends.
    twists = np.eye(len(means), k=-1) - np.eye(len(means))
    springs = twists.T @ np.diag([system.stiffnesses[i] for i in system.compliant]) @ twists
    squares = np.linalg.eigvals(springs / np.array(means)[:, np.newaxis])
    return np.asarray(np.sqrt(np.sort(squares.real)))
