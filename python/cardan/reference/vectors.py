"""The library's quantities again, in pure Python and from the vector picture.

Each yoke is a unit vector along its pin, turned about its shaft. The cross keeps the two pins of a
joint perpendicular, and that one condition, ``a . b = 0``, carries everything: the driven pin is
perpendicular to the driven shaft and to the driving pin, speeds come from differentiating the
condition once, accelerations from differentiating it twice, jerks from differentiating it three
times. Of joints as built, the driven pin is turned about its shaft until it has its angle to the
driving one.

No closed formula for the transmission appears, neither for one joint nor for a chain, so that
agreement with the compiled core means something. It is slow and takes one driveline and one angle
at a time. Angles are in radians, everything else in SI units. Errors are quoted for double
precision, with ``c`` for the product of the cosines of the bends.

Joints and shafts are counted from 0; joint ``j`` joins shaft ``j`` to shaft ``j + 1``. Rotations
are right-handed about the directions of the shafts, which point along the power flow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from cardan.arrays.errors import ArgumentValueError, require

Vector = tuple[float, float, float]

# Unit vectors carry rounding of about one ulp per component: a cross product no longer than this
# says nothing about the plane of the two shafts.
_STRAIGHT = 4.0 * 2.0**-52


def _dot(v: Vector, w: Vector) -> float:
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]


def _cross(v: Vector, w: Vector) -> Vector:
    return (v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0])


def _scaled(s: float, v: Vector) -> Vector:
    return (s * v[0], s * v[1], s * v[2])


def _plus(v: Vector, w: Vector) -> Vector:
    return (v[0] + w[0], v[1] + w[1], v[2] + w[2])


def _length(v: Vector) -> float:
    return math.hypot(*v)


def _unit(v: Vector) -> Vector:
    length = _length(v)
    return (v[0] / length, v[1] / length, v[2] / length)


def _across(v: Vector, u: Vector) -> Vector:
    """Return the part of ``v`` perpendicular to the unit vector ``u``."""
    return _plus(v, _scaled(-_dot(v, u), u))


def _turned(v: Vector, u: Vector, angle: float) -> Vector:
    """Return ``v``, which is perpendicular to the unit vector ``u``, turned about ``u``."""
    return _plus(_scaled(math.cos(angle), v), _scaled(math.sin(angle), _cross(u, v)))


@dataclass(frozen=True)
class Shafts:
    """A driveline at rest: where its shafts point and how its yokes are set.

    Attributes:
        directions: unit vector along each shaft.
        normals: unit normal of each joint's bend plane, ``unit(u_j x u_{j+1})``.
        phases: for each intermediate shaft the angle from its input-side to its output-side pin.
        deviations: of joints as built, for each joint how far the driving pin leans towards the
            driven shaft, how much closer than a right angle the pins are, and how far the driven
            pin leans along the driven shaft; none for ideal joints.
    """

    directions: tuple[Vector, ...]
    normals: tuple[Vector, ...]
    phases: tuple[float, ...]
    deviations: tuple[tuple[float, float, float], ...] = ()

    @property
    def bends(self) -> tuple[float, ...]:
        """Angle between the two shafts of each joint, error about 3e-16."""
        pairs = pairwise(self.directions)
        return tuple(math.atan2(_length(_cross(u, v)), _dot(u, v)) for u, v in pairs)

    @property
    def twists(self) -> tuple[float, ...]:
        """Angle about each intermediate shaft from one bend-plane normal to the next, within +-pi.

        The error is about 5e-16; where the normals had to be found from the shafts (directions,
        points) it is that over the smaller of the two bends.
        """
        shared = zip(self.directions[1:], pairwise(self.normals), strict=False)
        return tuple(math.atan2(_dot(u, _cross(m, n)), _dot(m, n)) for u, (m, n) in shared)


@dataclass(frozen=True)
class ShaftMotion:
    """How one shaft turns at one drive angle.

    Attributes:
        angle: continuous rotation, ``drive angle + angle_error``.
        angle_error: lead over the drive, with mean zero over a turn.
        speed_ratio: speed over that of the drive.
        acceleration_ratio: second derivative of ``angle`` with respect to the drive angle.
        jerk_ratio: third derivative.
    """

    angle: float
    angle_error: float
    speed_ratio: float
    acceleration_ratio: float
    jerk_ratio: float


@dataclass(frozen=True)
class Cross:
    """The position of the cross of one joint at one drive angle, and its rates in both yokes.

    Attributes:
        driving_pin: unit vector along the pin of the driving yoke.
        driven_pin: unit vector along the pin of the driven yoke.
        swing_driving: rate of the cross in the driving yoke, per radian of the drive.
        swing_driven: rate of the cross in the driven yoke, likewise.
    """

    driving_pin: Vector
    driven_pin: Vector
    swing_driving: float
    swing_driven: float


def from_bends(
    bends: Sequence[float],
    twists: Sequence[float] | None = None,
    phases: Sequence[float] | None = None,
) -> Shafts:
    """Lay out a driveline from its angles.

    Shaft 0 points along +x and the first bend plane has the normal +z, so shaft 1 points along
    ``(cos b, sin b, 0)``. Each twist turns the normal about the common shaft, even where the
    adjacent joints are straight. ``twists`` and ``phases`` have one value for each intermediate
    shaft and are 0 by default. Error about 2e-16 per joint.

    Raises:
        ValueError: a bend outside [0, pi/2), no bend, or a wrong number of twists or phases.
    """
    twists = _between("twists", twists, len(bends))
    phases = _between("phases", phases, len(bends))
    u, m = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    directions, normals = [u], []
    for j, bend in enumerate(bends):
        if not 0.0 <= bend < math.pi / 2:
            raise ArgumentValueError("bends", f"is {bend} rad; a bend must lie in [0, pi/2)", (j,))
        if j > 0:
            m = _turned(m, u, twists[j - 1])
        m = _unit(_across(m, u))
        u = _unit(_turned(u, m, bend))
        normals.append(m)
        directions.append(u)
    return Shafts(tuple(directions), tuple(normals), phases)


def from_directions(
    directions: Sequence[Sequence[float]], phases: Sequence[float] | None = None
) -> Shafts:
    """Lay out a driveline from vectors of any length along its shafts.

    A straight joint (``|u x v| <= 4 * 2**-52``) takes the bend-plane normal of the previous joint;
    with no bent joint before it that of the next bent one; and in a driveline that is straight
    throughout the perpendicular nearest to +z, or nearest to +x for shafts along z. Phases are as
    for :func:`from_bends`.

    Raises:
        ValueError: fewer than two directions, one without length or without three finite
            components, a bend of a right angle or more, or a wrong number of phases.
    """
    for i, vector in enumerate(directions):
        if len(vector) != 3 or not 0.0 < math.hypot(*vector) < math.inf:
            problem = f"is {vector}; it must be finite and have a length"
            raise ArgumentValueError("directions", problem, (i,))
    shafts = tuple(_unit((x, y, z)) for x, y, z in directions)
    phases = _between("phases", phases, len(shafts) - 1)
    for j, (u, v) in enumerate(pairwise(shafts)):
        if _dot(u, v) <= 0.0:
            bend = math.atan2(_length(_cross(u, v)), _dot(u, v))
            raise ValueError(f"joint {j} is bent by {bend} rad; a bend must lie in [0, pi/2)")
    planes = [_cross(u, v) for u, v in pairwise(shafts)]
    normal: Vector = (0.0, 0.0, 1.0)
    if _length(_cross(shafts[0], normal)) <= _STRAIGHT:
        normal = (1.0, 0.0, 0.0)
    normal = next((plane for plane in planes if _length(plane) > _STRAIGHT), normal)
    normals = []
    for u, plane in zip(shafts, planes, strict=False):
        if _length(plane) > _STRAIGHT:
            normal = plane
        # Across the shaft once more: a carried normal belongs to a shaft that differs by rounding,
        # and the normal of two nearly parallel shafts is itself largely rounding.
        normal = _unit(_across(_unit(normal), u))
        normals.append(normal)
    return Shafts(shafts, tuple(normals), phases)


def from_points(points: Sequence[Sequence[float]], phases: Sequence[float] | None = None) -> Shafts:
    """Lay out a driveline from its start, joint centres and end, in any one unit of length.

    Phases and errors are as for :func:`from_directions`.
    """
    steps = [[b - a for a, b in zip(p, q, strict=True)] for p, q in pairwise(points)]
    return from_directions(steps, phases)


def _between(name: str, values: Sequence[float] | None, n_joints: int) -> tuple[float, ...]:
    if n_joints < 1:
        raise ArgumentValueError("a driveline", "needs at least one joint and two shafts")
    if values is None:
        return (0.0,) * (n_joints - 1)
    problem = f"has {len(values)} values; {n_joints} joints need {n_joints - 1}"
    require(name, len(values) == n_joints - 1, problem)
    return tuple(values)


@dataclass(frozen=True)
class _Joint:
    """One joint at one drive angle."""

    u: Vector  # along the driving shaft
    v: Vector  # along the driven shaft
    m: Vector  # normal of the bend plane
    a: Vector  # pin of the driving yoke
    b: Vector  # pin of the driven yoke
    n: Vector  # normal of the cross, a x b


def _joints(shafts: Shafts, angle: float) -> list[_Joint]:
    """Turn the drive to ``angle`` and let each cross find its place, one joint after the other."""
    u, m = shafts.directions[0], shafts.normals[0]
    level = _turned(_cross(m, u), u, angle if math.isfinite(angle) else math.nan)
    joints = []
    count = len(shafts.normals)
    each = (*shafts.phases, 0.0), shafts.deviations or ((0.0, 0.0, 0.0),) * count
    for v, m, phase, (lean, skew, lean_driven) in zip(
        shafts.directions[1:], shafts.normals, *each, strict=True
    ):
        a = _leaning(level, u, lean)
        driven = _unit(_cross(v, a))
        if shafts.deviations:
            driven = _turned(driven, v, _closing(a, driven, v, skew, lean_driven))
        b = _leaning(driven, v, lean_driven)
        joints.append(_Joint(u, v, m, a, b, _cross(a, b)))
        u, level = v, _turned(driven, v, phase)
    return joints


def _leaning(level: Vector, u: Vector, lean: float) -> Vector:
    """Return the pin that leans from the normal of a shaft towards its end."""
    return _plus(_scaled(math.cos(lean), level), _scaled(math.sin(lean), u)) if lean else level


def _closing(a: Vector, driven: Vector, v: Vector, skew: float, lean: float) -> float:
    """Return by how much the driven pin turns until it is closer than 90 degrees by ``skew``.

    Newton's method from the place of the ideal joint: over the quarter turn on either side the
    product of the pins curves one way only, so that it comes nearer from one side.
    """
    turn, step = 0.0, math.inf
    while abs(step) > 1e-15:
        pin = _leaning(_turned(driven, v, turn), v, lean)
        step = (math.sin(skew) - _dot(a, pin)) / _dot(a, _cross(v, pin))
        turn += step
    return turn


def _turning(v: Vector, u: Vector, w: float, w_rate: float) -> tuple[Vector, Vector]:
    """Return the first two derivatives of ``v``, which turns about the unit vector ``u``."""
    aside = _cross(u, v)
    return _scaled(w, aside), _plus(_scaled(w_rate, aside), _scaled(w * w, _cross(u, aside)))


def _rates(joints: Sequence[_Joint]) -> list[tuple[float, float, float]]:
    """Return each shaft's speed, acceleration and jerk ratio, from ``a . b`` differentiated.

    It is constant, and 0 for an ideal joint. With ``a' = w (u x a)``, ``b' = z (v x b)`` and
    ``n = a x b``, once gives ``w u.n = z v.n``, twice ``w' u.n + w u.n' = z' v.n + z v.n'`` and
    three times ``w'' u.n + 2 w' u.n' + w u.n'' = z'' v.n + 2 z' v.n' + z v.n''``.
    """
    w, w_rate, w_jerk = 1.0, 0.0, 0.0
    rates = [(w, w_rate, w_jerk)]
    for at in joints:
        z = w * _dot(at.u, at.n) / _dot(at.v, at.n)
        a_rate, a_curve = _turning(at.a, at.u, w, w_rate)
        b_rate, _ = _turning(at.b, at.v, z, 0.0)
        n_rate = _plus(_cross(a_rate, at.b), _cross(at.a, b_rate))
        relative = _plus(_scaled(w, at.u), _scaled(-z, at.v))
        z_rate = (w_rate * _dot(at.u, at.n) + _dot(relative, n_rate)) / _dot(at.v, at.n)
        _, b_curve = _turning(at.b, at.v, z, z_rate)
        n_curve = _plus(
            _plus(_cross(a_curve, at.b), _cross(at.a, b_curve)),
            _scaled(2.0, _cross(a_rate, b_rate)),
        )
        faster = _plus(_scaled(w_rate, at.u), _scaled(-z_rate, at.v))
        change = w_jerk * _dot(at.u, at.n) + 2.0 * _dot(faster, n_rate) + _dot(relative, n_curve)
        w, w_rate, w_jerk = z, z_rate, change / _dot(at.v, at.n)
        rates.append((w, w_rate, w_jerk))
    return rates


def _lead(joints: Sequence[_Joint]) -> float:
    """Return how far the shaft after these joints is turned ahead of the drive, up to a constant.

    In each joint the driven pin's angle from the bend-plane normal is compared with the driving
    pin's angle from the bend plane. The difference never reaches a right angle, so its principal
    value is the continuous one, and the sum over any number of joints stays continuous.
    """
    lead = 0.0
    for at in joints:
        c, s = _dot(at.a, _cross(at.m, at.u)), _dot(at.a, at.m)
        driven_c, driven_s = _dot(at.b, at.m), -_dot(at.b, _cross(at.m, at.v))
        lead += math.atan2(driven_s * c - driven_c * s, driven_c * c + driven_s * s)
    return lead


def _index(shafts: Shafts, shaft: int) -> int:
    count = len(shafts.directions)
    if not -count <= shaft < count:
        raise IndexError(f"shaft is {shaft}; the driveline has {count} shafts, counted from 0")
    return shaft % count


def enough(least_ratio: float) -> int:
    """Return how many angles of half a turn leave less than 1e-17 of its mean or its ``q``.

    The speed ratio stays between ``c`` and ``1/c``, so harmonic ``n`` of the half turn falls at
    least like ``((1 - c)/(1 + c))**n < exp(-2 c n)``. There are 36 when straight, 246 for one joint
    bent by 85 degrees, and from there on like ``1/c``.
    """
    return 16 + math.ceil(20.0 / least_ratio)


def mean_offset(shafts: Shafts, shaft: int = -1) -> float:
    """Return the constant angle that :func:`motion` takes off the raw turn of a shaft.

    It is the mean of the raw turn over half a revolution, after which everything repeats (over a
    whole one with joints as built), by the trapezoid rule, which converges geometrically for a
    smooth periodic function (``enough``).

    Raises:
        ValueError: ``c < 2e-4`` (one joint beyond 89.988 degrees), too many points.
    """
    stop = _index(shafts, shaft)
    c = math.prod(_dot(u, v) for u, v in pairwise(shafts.directions[: stop + 1]))
    if c < 2e-4:
        raise ValueError(f"the cosines of the bends multiply to {c}; the mean needs at least 2e-4")
    count = enough(c)
    angles = [math.pi * i / count for i in range(2 * count if shafts.deviations else count)]
    return math.fsum(_lead(_joints(shafts, angle)[:stop]) for angle in angles) / len(angles)


def motion(
    shafts: Shafts, angle: float, shaft: int = -1, *, offset: float | None = None
) -> ShaftMotion:
    """Return how a shaft turns when the drive stands at ``angle``.

    Args:
        angle: drive angle, of the driving pin of joint 0 from ``m_0 x u_0``; zero when that pin
            lies in the plane of the two shafts (Thoma 1920, Hauptlage A). NaN or infinity give NaN.
        offset: ``mean_offset(shafts, shaft)`` if at hand; it does not depend on the angle.

    Errors: absolute, at most ``2 * 2**-52`` per joint, over ``c`` for ``angle_error`` (at bends
    below 3e-8 no digit of it is right), over ``c**2`` for ``speed_ratio``, over ``c**3`` for
    ``acceleration_ratio`` and, times 4, over ``c**4`` for ``jerk_ratio``.

    Source: ``a . b = 0``, the condition from which Thoma 1920 derives his (3) and (4).

    Raises:
        ValueError: bends too close to a right angle, see :func:`mean_offset`.
    """
    stop = _index(shafts, shaft)
    joints = _joints(shafts, angle)[:stop]
    error = _lead(joints) - (mean_offset(shafts, stop) if offset is None else offset)
    return ShaftMotion(angle + error, error, *_rates(joints)[stop])


def tilts(shafts: Shafts, angle: float) -> tuple[tuple[float, float], ...]:
    """Return for each joint how far the cross leans from its driving and from its driven shaft.

    Each is the angle from the shaft to the normal of the cross, counted towards the pin of the
    other shaft. With the bend ``beta`` and the joint's input angle ``alpha`` this makes
    ``tan psi_1 = tan beta sin alpha`` and ``sin psi_2 = sin beta cos alpha`` (Grossmann 1939, (3)
    and (5)). Error as for :func:`motion`'s ``angle_error``.
    """
    return tuple(
        (
            math.atan2(_dot(at.u, _across(at.b, at.a)), _dot(at.u, at.n)),
            math.atan2(_dot(at.v, _across(at.a, at.b)), _dot(at.v, at.n)),
        )
        for at in _joints(shafts, angle)
    )


def crosses(shafts: Shafts, angle: float) -> tuple[Cross, ...]:
    """Return where the cross of each joint stands, and the rates at which its tilts change.

    The driven shaft turns relative to the driving one by ``z v - w u`` with the speed ratios ``w``
    and ``z``. The cross allows only turns about its pins, of which this is the sum. So the part
    along the driving pin and across the driven one is the rate in the driving yoke, and the other
    way round that in the driven yoke. Error as for the speed ratio of :func:`motion`.
    """
    joints = _joints(shafts, angle)
    found = []
    for at, (w, z) in zip(joints, pairwise(w for w, *_ in _rates(joints)), strict=True):
        relative = _plus(_scaled(z, at.v), _scaled(-w, at.u))
        square = _dot(at.n, at.n)
        swings = (
            _dot(relative, _across(at.a, at.b)) / square,
            _dot(relative, _across(at.b, at.a)) / square,
        )
        found.append(Cross(at.a, at.b, *swings))
    return tuple(found)


def turning_axes(shafts: Shafts, angle: float) -> tuple[tuple[Vector, Vector, Vector], ...]:
    """Return for each shaft three unit vectors that turn with it.

    The first points along the shaft, the second along the pin at its input side (of shaft 0, at its
    output side), and the third is their cross product. The dot products of a vector with these are
    its components with ``axes="shaft"``.
    """
    joints = _joints(shafts, angle)
    pins = [joints[0].a, *(at.b for at in joints)]
    return tuple((u, pin, _cross(u, pin)) for u, pin in zip(shafts.directions, pins, strict=True))
