"""Design computations again: layouts, steering, excitations, splines, slides, play and tubes.

Motion comes from the turning yokes of ``cardan.reference``, forces from the equilibrium of every
body at once, and what is round or bends is divided into rings and short beams. Loads are as for
``reference.loads``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.reference.evaluation import falling, harmonics, largest, slopes
from cardan.reference.forces import loads
from cardan.reference.vectors import (
    Shafts,
    Vector,
    _across,
    _cross,
    _dot,
    _joints,
    _lead,
    _plus,
    _scaled,
    _turned,
    from_bends,
    from_directions,
    motion,
)

Array: TypeAlias = NDArray[np.floating[Any]]

# --- limits ---------------------------------------------------------------------------------------


def ranked(
    value: float, limit: float, maximum: float, *, most: bool = True, size: float = 0.0
) -> int:
    """Return the rank of a figure by exact fractions.

    It is 0 where nothing is judged, 1 within, 2 tolerable and 3 beyond. Limit and maximum are the
    most that the figure may be, or the least. Rounding is a billionth of the size of what is judged
    or of the limit.
    """
    if math.isnan(value) or math.isnan(limit):
        return 0

    def kept(bound: float) -> bool:
        if math.isinf(value) or math.isinf(bound):
            return value <= bound if most else value >= bound
        past = (Fraction(value) - Fraction(bound)) * (1 if most else -1)
        return past <= max(abs(Fraction(bound)), Fraction(size)) / 10**9

    return 1 if kept(limit) else 2 if kept(maximum) else 3


def smallest_change(
    suffices: Callable[[float], bool], reach: float, steps: int = 400
) -> float | None:
    """Return the smallest change of one variable that suffices; ``None`` if none does.

    It reaches so far to either side; between the steps of the search nothing is found.
    """
    for i in range(1, steps + 1):
        ends = [sign * reach * i / steps for sign in (1.0, -1.0)]
        found = [_boundary(suffices, end, 1.0 - 1.0 / i) for end in ends if suffices(end)]
        if found:
            return min(found, key=abs)
    return None


def _boundary(suffices: Callable[[float], bool], enough: float, share: float) -> float:
    return enough * falling(lambda part: not suffices(part * enough), share, 1.0)


# --- layouts -------------------------------------------------------------------------------------


def from_slopes(
    vertical: Sequence[float], horizontal: Sequence[float], phases: Sequence[float] | None = None
) -> Shafts:
    """Lay out a driveline as ``Driveline.from_slopes`` does, by tangents of the slopes."""
    pairs = zip(vertical, horizontal, strict=True)
    return from_directions([(1.0, math.tan(v), math.tan(h)) for v, h in pairs], phases)


def from_readings(
    readings: Sequence[float],
    lengths: Sequence[float],
    offsets: Sequence[float],
    phases: Sequence[float] | None = None,
) -> Shafts:
    """Lay out a driveline as ``Driveline.from_readings`` does, by the heading of each shaft."""
    along = []
    for up, length, start, end in zip(readings, lengths, offsets, offsets[1:], strict=False):
        # The heading of the shaft in plan, where it has the length L cos r.
        heading = math.asin((end - start) / (length * math.cos(up)))
        level = math.cos(up)
        along.append((level * math.cos(heading), math.sin(up), level * math.sin(heading)))
    return from_directions(along, phases)


def under_torque(
    points: Sequence[Vector],
    moved: Sequence[int],
    angle: float,
    about: Vector,
    axis: Vector,
    shift: Vector,
) -> list[Vector]:
    """Return points of which some, by number, have turned about an axis of length 1 and moved."""
    found = []
    for number, place in enumerate(points):
        if number in moved:
            arm = _plus(place, _scaled(-1.0, about))
            along = _plus(_scaled(_dot(arm, axis), axis), shift)
            place = _plus(about, _plus(along, _turned(_across(arm, axis), axis, angle)))
        found.append(place)
    return found


def from_projected_bends(
    vertical: Sequence[float],
    horizontal: Sequence[float],
    phases: Sequence[float] | None = None,
    *,
    level: int = 1,
) -> Shafts:
    """Lay out a driveline as ``Driveline.from_projected_bends`` does.

    ``level`` is the shaft along x, from which the drawing measures.
    """

    def view(bends: Sequence[float]) -> list[float]:
        sums = [math.fsum(bends[:i]) for i in range(len(bends) + 1)]
        return [x - sums[level] for x in sums]

    return from_slopes(view(vertical), view(horizontal), phases)


def from_double_joint(total: float, length: float, pivot: float) -> Shafts:
    """Lay out a centred double joint: the link turns until its end is on the driven shaft.

    Arguments are as of ``Driveline.from_double_joint``.
    """

    def short(first: float) -> float:
        """How far the end of the link is from the driven shaft, which leaves the pivot."""
        x, y = length * math.cos(first) - pivot, length * math.sin(first)
        return math.sin(total) * x - math.cos(total) * y

    first = falling(short, 0.0, total)
    return from_bends([first, total - first])


def turned_round(shafts: Shafts) -> Shafts:
    """Return a driveline of ideal joints driven from its other end."""
    directions, normals = (
        tuple(_scaled(-1.0, v) for v in vectors[::-1])
        for vectors in (shafts.directions, shafts.normals)
    )
    return Shafts(directions, normals, shafts.phases[::-1])


def lengths(points: Sequence[Sequence[float]]) -> list[float]:
    """Return the length of each shaft between its points, in their unit."""
    return [math.dist(p, q) for p, q in pairwise(points)]


# --- motion --------------------------------------------------------------------------------------


def steering(shafts: Shafts, centre: float) -> tuple[float, float, float, float]:
    """Return what a steering column does straight ahead: its speed ratio and the slope of that.

    Behind them come the least turns of the drive to where the ratio is largest and smallest. The
    centre is the drive angle straight ahead, as in the next function.
    """

    ratio = _ratio(shafts)
    (slope,) = slopes(lambda x: ratio(*x), [centre])
    quick, slow = largest(ratio)[0], largest(lambda angle: -ratio(angle))[0]
    to_quick, to_slow = (math.remainder(place - centre, math.pi) for place in (quick, slow))
    return ratio(centre), float(slope), to_quick, to_slow


def left_and_right(shafts: Shafts, centre: float) -> float:
    """Return the largest difference of the ratio after equal turns to the left and to the right."""

    ratio = _ratio(shafts)
    return largest(lambda turn: abs(ratio(centre + turn) - ratio(centre - turn)))[1]


def _ratio(shafts: Shafts) -> Callable[[float], float]:
    """Return the speed ratio of the last shaft by the drive angle."""
    return lambda angle: motion(shafts, angle, offset=0.0).speed_ratio


def excitations(shafts: Shafts) -> tuple[float, float, float]:
    """Return the excitations of a check, over the square of the drive's speed.

    They are the largest acceleration ratio of the last shaft, and the second order of the summed
    acceleration ratios of all intermediate shafts: as driven, and driven from the other end.
    """
    peak = largest(lambda angle: motion(shafts, angle, offset=0.0).acceleration_ratio)[1]

    def summed(own: Shafts) -> Callable[[float], float]:
        inner = range(1, len(own.bends))
        return lambda angle: sum(
            motion(own, angle, shaft, offset=0.0).acceleration_ratio for shaft in inner
        )

    ways = (shafts, turned_round(shafts))
    driving, coasting = (harmonics(summed(way), [2], steps=256)[0] for way in ways)
    return peak, float(abs(driving)), float(abs(coasting))


# --- offsets, play and compliance ----------------------------------------------------------------


def slides(
    shafts: Shafts, angle: float, offsets: Sequence[Sequence[float]]
) -> list[tuple[float, float, float]]:
    """Return how far each joint slides: along its driving pin, its driven pin and its driven shaft.

    The vectors from the axis of the driving shaft over both pins to that of the driven shaft close
    to a loop, whose three components give the three slides.

    Args:
        offsets: of each joint, in any one unit: from the driving shaft to its pin along ``u x p``,
            between the pins along ``p x q``, from the driven pin to its shaft along ``q x v``, and
            between the shafts along the bend-plane normal.
    """
    found = []
    for at, (driving, between, driven, apart) in zip(_joints(shafts, angle), offsets, strict=True):
        known = apart * np.array(at.m) - driving * np.array(_cross(at.u, at.a))
        known -= between * np.array(at.n) + driven * np.array(_cross(at.b, at.v))
        along, behind, shaft = np.linalg.solve(np.array([at.a, at.b, at.v]).T, known).tolist()
        found.append((along, behind, shaft))
    return found


def with_skews(shafts: Shafts, skews: Sequence[float]) -> Shafts:
    """Return a driveline whose pins are closer than built by an angle in each joint."""
    built = shafts.deviations or ((0.0, 0.0, 0.0),) * len(skews)
    changed = ((e1, e2 + skew, e3) for (e1, e2, e3), skew in zip(built, skews, strict=True))
    return replace(shafts, deviations=tuple(changed))


def lash(shafts: Shafts, angle: float, play: Sequence[float], shaft: int = -1) -> float:
    """Return by how much a shaft turns between the flanks of the play, with the drive held.

    Args:
        play: for each joint, the radial play of a pin over the arm of its bearing. Both yokes turn
            by it about the normal of the cross, one way or the other.
    """
    driven, coasting = (
        _lead_at(with_skews(shafts, [2.0 * sign * x for x in play]), angle, shaft)
        for sign in (1.0, -1.0)
    )
    return coasting - driven


def wind_up(
    shafts: Shafts, angle: float, stiffnesses: Sequence[float], load: Mapping[str, Any]
) -> float:
    """Return by how much the last shaft lags because its crosses give way, to first order.

    The moment of each joint brings its pins closer by the moment over the stiffness.

    Args:
        stiffnesses: of each cross against its moment [N m/rad].
    """
    at = loads(shafts, angle, **load)
    each = zip(at.pin_moment, at.torque[1:], stiffnesses, strict=True)
    closed = [math.copysign(moment, torque) / stiffness for moment, torque, stiffness in each]
    size = max(map(abs, closed))

    def lead(part: list[float]) -> float:
        return _lead_at(with_skews(shafts, [part[0] / size * skew for skew in closed]), angle)

    return -size * float(slopes(lead, [0.0])[0])


def _lead_at(shafts: Shafts, angle: float, shaft: int = -1) -> float:
    joints = _joints(shafts, angle)
    return _lead(joints[: shaft % (len(joints) + 1)])


# --- splines -------------------------------------------------------------------------------------


def spline(
    points: Sequence[Sequence[float]],
    shaft: int,
    axial: float,
    bearings: Sequence[tuple[int, float]] = (),
) -> tuple[Array, Array, Array]:
    """Return the forces of a loaded spline that slides while its shaft becomes longer [N].

    They are that on what holds the shaft upstream, that on what holds it downstream, and that of
    each bearing on its shaft, by the equilibrium of all bodies in space.

    Bodies are the two halves of the shaft, which stay in line, and the shafts before and behind.
    Each of these has two bearings, which give forces across it, and a thrust. The friction pulls
    the halves towards each other. All forces and moments of all bodies are solved at once.

    Points are in m, and the friction in the spline is its coefficient times the torque over its
    radius [N]. Bearings have a shaft and a distance from its upstream end [m]; without them the
    next shafts have two anywhere.
    """
    corners = np.array(points, float)
    steps = np.diff(corners, axis=0)
    along = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    across = [np.linalg.svd(u[np.newaxis])[2][1:] for u in along]
    start, end, middle = *corners[shaft : shaft + 2], corners[shaft : shaft + 2].mean(axis=0)
    any_way = np.eye(3)
    # Where a force is, in which directions, on which body and from which; a world needs no balance.
    places: list[tuple[Array, Array, str, str]] = [
        (start, any_way, "upper", f"shaft {shaft - 1}"),
        (end, any_way, "lower", f"shaft {shaft + 1}"),
        (middle, across[shaft], "upper", "lower"),
        (middle + along[shaft], across[shaft], "upper", "lower"),
    ]
    bodies = {"upper", "lower"}
    given = {}
    for own in {shaft - 1, shaft + 1} & set(range(len(along))):
        bodies.add(f"shaft {own}")
        places.append((corners[own], along[own : own + 1], f"shaft {own}", "world"))
        held = {i: at for i, (of, at) in enumerate(bearings) if of == own} or {-1: 0.0, -2: 1.0}
        for number, at in held.items():
            given[number] = len(places)
            places.append((corners[own] + at * along[own], across[own], f"shaft {own}", "world"))
    in_order = sorted(bodies)

    def acting(on: str, force: Array, at: Array) -> Array:
        """A force as forces and moments of all bodies."""
        wrench = np.concatenate([force, np.cross(at, force)])
        return np.concatenate([wrench * (on == body) for body in in_order])

    columns = [acting(on, v, at) - acting(off, v, at) for at, vs, on, off in places for v in vs]
    friction = axial * along[shaft]
    known = acting("upper", friction, middle) - acting("lower", friction, middle)
    found, _, rank, _ = np.linalg.lstsq(np.array(columns).T, -known, rcond=None)
    if rank < len(columns):
        raise ValueError("the bearings leave some forces open")
    parts = np.split(found, np.cumsum([len(vs) for _, vs, _, _ in places])[:-1])
    forces = [part @ vs for part, (_, vs, _, _) in zip(parts, places, strict=True)]
    rest = [forces[given[i]] if i in given else np.zeros(3) for i in range(len(bearings))]
    return -forces[0], -forces[1], np.array(rest).reshape(-1, 3)


# --- tubes ---------------------------------------------------------------------------------------


def tube(
    outer_diameter: float,
    wall: float,
    length: float,
    shear_modulus: float,
    elastic_modulus: float,
    density: float,
) -> dict[str, float]:
    """Return the figures of a round shaft that is divided into rings and into pieces of its length.

    They are those of ``cardan.tube`` by name, and the largest shear stress over the torque [1/m³].

    Source: the shear coefficient is ``2 (1 + nu) I / (nu (I - I) / 2 - (A / I) integral of
    x (chi + x y²))`` of G. R. Cowper 1966, with the function ``chi`` of A. E. H. Love for the
    bending of a hollow round bar by a force at its end.
    """
    rings, pieces = 4000, 600
    step = wall / rings
    radii = outer_diameter / 2.0 - wall + (np.arange(rings) + 0.5) * step
    areas = 2.0 * math.pi * radii * step
    polar, section = float(np.sum(areas * radii**2)), float(np.sum(areas))
    # A twist of 1 shears a ring by its radius over the length.
    torque = shear_modulus * polar / length
    # A beam that is pinned at both ends bends back with E I times the fourth differences of its
    # deflection, of which half the polar moment is the I, and its mass resists.
    size = pieces - 1
    curvature = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    least = float(np.linalg.eigvalsh(curvature)[0]) * (pieces / length) ** 2
    # Across a ring, sums over the angle of the squares and products of sine and cosine are these.
    ratio = elastic_modulus / (2.0 * shear_modulus) - 1.0
    outer, inner = outer_diameter / 2.0, outer_diameter / 2.0 - wall
    of_cosine = (outer**2 + inner**2) * radii + (outer * inner) ** 2 / radii
    chi = -(3.0 + 2.0 * ratio) / 4.0 * of_cosine * radii / 2.0
    integral = float(np.sum(areas * (chi + radii**4 / 8.0)))
    bending = polar / 2.0
    coefficient = -2.0 * (1.0 + ratio) * bending**2 / (section * integral)
    return {
        "bending_stiffness": elastic_modulus * bending,
        "line_mass": density * section,
        "shear_stiffness": coefficient * shear_modulus * section,
        "rotary_inertia": density * bending,
        "stiffness": torque,
        "inertia": density * length * polar,
        "mass": density * length * section,
        "critical_speed": least * math.sqrt(elastic_modulus * polar / 2.0 / (density * section)),
        "shear_per_torque": shear_modulus * outer_diameter / 2.0 / length / torque,
    }
