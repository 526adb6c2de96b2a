"""Moments and forces of joints and bearings: the balance of one shaft after the other.

A frictionless, massless cross can transmit only a moment perpendicular to both pins; the torsion of
the driving shaft fixes its size, and the moment equilibrium of each shaft gives what its bearings
must add. A shaft is balanced when the forces of its supports, and those of the joints that support
its neighbours, cancel across it and give it the moment that it needs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from cardan.arrays.errors import ArgumentValueError, require
from cardan.reference.vectors import (
    Shafts,
    Vector,
    _across,
    _cross,
    _dot,
    _joints,
    _length,
    _plus,
    _rates,
    _scaled,
)

_ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Loads:
    """Moments in a driveline at one drive angle, all in N m.

    Attributes:
        torque: per shaft, the torsion entering it; for shaft 0 the drive torque.
        moment: per joint, the vector that it exerts on its driven shaft (reversed: on the driving).
        support_moment: per shaft, the vector that its bearings must give it.
        bending_driving: per joint, the size of the bending moment in its driving shaft.
        bending_driven: per joint, the size of the bending moment in its driven shaft.
        pin_moment: per joint, the size of its moment.
    """

    torque: tuple[float, ...]
    moment: tuple[Vector, ...]
    support_moment: tuple[Vector, ...]
    bending_driving: tuple[float, ...]
    bending_driven: tuple[float, ...]
    pin_moment: tuple[float, ...]


@dataclass(frozen=True)
class Forces:
    """Forces in a driveline at one drive angle, all in N.

    Attributes:
        joint_force: per joint, the vector that it exerts on its driven shaft (reversed: on the
            driving one).
        bearing_force: per bearing, the vector that it exerts on its shaft.
    """

    joint_force: tuple[Vector, ...]
    bearing_force: tuple[Vector, ...]


def loads(
    shafts: Shafts,
    angle: float,
    *,
    drive_torque: float | None = None,
    output_torque: float | None = None,
    speed: float = 0.0,
    acceleration: float = 0.0,
    inertias: Sequence[float] | None = None,
) -> Loads:
    """Return the moments in the driveline when the drive stands at ``angle``.

    Args:
        angle: drive angle, as for ``reference.motion``; the others are as of ``cardan.Load``.

    Errors: at most ``2 * 2**-52 / c`` per joint, of the largest moment; and with inertias what the
    errors of ``reference.motion`` make of the torque that they take.

    Source: the moment is normal to both pins (Thoma 1920, before (5); Grossmann 1939, before (1));
    a shaft keeps ``I dw/dt`` of the torsion that enters it (Thoma's flywheel, after (7)).

    Raises:
        ValueError: both torques given, or not one inertia per shaft.
    """
    if drive_torque is not None and output_torque is not None:
        problem = "and output_torque exclude one another; give one of them"
        raise ArgumentValueError("drive_torque", problem)
    count = len(shafts.directions)
    inertias = (0.0,) * count if inertias is None else inertias
    problem = f"has {len(inertias)} values; there are {count} shafts"
    require("inertias", len(inertias) == count, problem)
    joints = _joints(shafts, angle)
    moving = zip(inertias, _rates(joints), strict=True)
    kept = [
        inertia * (speed**2 * acceleration_ratio + acceleration * speed_ratio)
        for inertia, (speed_ratio, acceleration_ratio, _) in moving
    ]
    # The moment s n has the components s u.n and s v.n along the two shafts.
    if drive_torque is not None:
        torque = [drive_torque]
        for at, taken in zip(joints, kept, strict=False):
            torque.append((torque[-1] - taken) / _dot(at.u, at.n) * _dot(at.v, at.n))
    else:
        torque = [(output_torque or 0.0) + kept[-1]]
        for at, taken in zip(reversed(joints), reversed(kept[:-1]), strict=True):
            torque.insert(0, torque[0] / _dot(at.v, at.n) * _dot(at.u, at.n) + taken)
    entering = zip(joints, torque[1:], strict=True)
    moment = [_scaled(into / _dot(at.v, at.n), at.n) for at, into in entering]
    # Shaft i feels moment i - 1 and, reversed, moment i. Along the shaft they make it accelerate;
    # what they leave across it the bearings have to balance.
    felt = zip(shafts.directions, pairwise([_ZERO, *moment, _ZERO]), strict=True)
    support = [
        _across(_plus(passed_on, _scaled(-1.0, received)), u) for u, (received, passed_on) in felt
    ]
    pairs = list(zip(joints, moment, strict=True))
    return Loads(
        torque=tuple(torque),
        moment=tuple(moment),
        support_moment=tuple(support),
        bending_driving=tuple(_length(_cross(at.u, m)) for at, m in pairs),
        bending_driven=tuple(_length(_cross(at.v, m)) for at, m in pairs),
        pin_moment=tuple(map(_length, moment)),
    )


def forces(
    shafts: Shafts,
    loads: Loads,
    lengths: Sequence[float],
    bearings: Sequence[tuple[int, float]] = (),
) -> Forces:
    """Return the forces that go with the moments of a driveline.

    Args:
        loads: its moments at a drive angle.
        lengths: of each shaft [m].
        bearings: shaft of each, and its distance from the upstream end of the shaft [m].

    Errors: rounding, times the ratio of the longest lever arm to the shortest for each shaft that
    loads the next.

    Source: equilibrium of every shaft (documentation, Theory, Forces).

    Raises:
        ValueError: not one length per shaft; supports that are too many or too few for statics.
    """
    count = len(shafts.directions)
    if len(lengths) != count:
        raise ArgumentValueError("lengths", f"has {len(lengths)} values; there are {count} shafts")
    supported = _supported(count, [shaft for shaft, _ in bearings])
    joint_force: dict[int, Vector] = {j: _ZERO for j, held in enumerate(supported) if held is None}
    bearing_force: dict[int, Vector] = {}
    waiting = [shaft for shaft in range(count) if _needed(shaft, count, bearings)]
    while waiting:
        for shaft in waiting:
            ends = [j for j in (shaft - 1, shaft) if 0 <= j < count - 1]
            own = [j for j in ends if supported[j] == shaft]
            others = [j for j in ends if supported[j] != shaft]
            # The joints that support its neighbours must be known.
            if not all(j in joint_force for j in others):
                continue
            along = shafts.directions[shaft]
            at = {j: 0.0 if j < shaft else lengths[shaft] for j in ends}
            sign = {j: 1.0 if j < shaft else -1.0 for j in ends}
            acting = [(at[j], _across(_scaled(sign[j], joint_force[j]), along)) for j in others]
            held = [i for i, (place, _) in enumerate(bearings) if place == shaft]
            places = [bearings[i][1] for i in held] + [at[j] for j in own]
            found = iter(_balance(along, loads.support_moment[shaft], places, acting))
            bearing_force |= {i: next(found) for i in held}
            joint_force |= {j: _scaled(sign[j], next(found)) for j in own}
            waiting.remove(shaft)
            break
    return Forces(
        tuple(joint_force[j] for j in range(count - 1)),
        tuple(bearing_force[i] for i in range(len(bearings))),
    )


def _balance(
    along: Vector, moment: Vector, places: Sequence[float], acting: Sequence[tuple[float, Vector]]
) -> tuple[Vector, Vector]:
    """The forces at two places that give a shaft a moment, beside forces that act on it.

    Moments about the first place: ``u x ((x2 - x1) F2 + sum (x - x1) R)`` is the moment, and its
    cross product with ``u`` is the bracket.
    """
    first, second = places
    bracket = _cross(moment, along)
    total = _ZERO
    for place, force in acting:
        bracket = _plus(bracket, _scaled(first - place, force))
        total = _plus(total, force)
    there = _scaled(1.0 / (second - first), bracket)
    return _scaled(-1.0, _plus(there, total)), there


def _needed(shaft: int, count: int, bearings: Sequence[tuple[int, float]]) -> bool:
    """Whether a shaft must be balanced; an end without bearings is part of a machine."""
    return 0 < shaft < count - 1 or any(own == shaft for own, _ in bearings)


def _supported(count: int, bearings: Sequence[int]) -> list[int | None]:
    """The shaft that each joint supports, if it supports one."""
    supported: list[int | None] = [None] * (count - 1)
    missing = {}
    for shaft in range(count):
        own = bearings.count(shaft)
        if own > 2:
            problem = f"are {own} on shaft {shaft}; forces are determinate with two"
            raise ArgumentValueError("bearings", problem)
        if own or 0 < shaft < count - 1:
            missing[shaft] = 2 - own
    while any(missing.values()):
        before = dict(missing)
        for shaft, lacking in before.items():
            free = [j for j in (shaft - 1, shaft) if 0 <= j < count - 1 and supported[j] is None]
            if lacking and lacking == len(free):
                for j in free:
                    supported[j] = shaft
                missing[shaft] = 0
            elif lacking > len(free):
                raise ArgumentValueError("bearings", f"leave shaft {shaft} without two supports")
        if missing == before:
            shaft = next(shaft for shaft, lacking in missing.items() if lacking)
            raise ArgumentValueError("bearings", f"leave shaft {shaft} with three supports")
    return supported
