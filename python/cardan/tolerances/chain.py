"""The complex number ``q`` of a chain whose parameters deviate, and how far it can move at most.

A chain takes the pin's direction ``w = exp(i a)`` to ``A w + B conj(w)``; all motion depends on ``q
= B/A``. As maps of the unit disc, a joint is ``x -> (x + k)/(1 + k x)`` with ``k = tan(b/2)**2``
and a shaft ``x -> exp(-2 i p) x`` with ``p = phase - twist + 90°``. Applied to 0 from the last
joint to the first they give ``-q`` (derived here from Thoma 4).

The core computes one driveline with error terms. Here a rounding error of 1e-15 in ``q`` suffices,
and NumPy's loops over whole chunks are ten times as fast.

Upper bounds that no driveline within its tolerances exceeds follow from another picture of ``q``.
With ``L = ln sec(bend)`` a chain is a polygon in the hyperbolic plane: a joint is a side of length
``L_j``, a shaft a corner, and ``q`` the end of the polygon at the distance ``L_E`` from its start
(the Poincaré disc, ``|q| = tanh(L_E/2)``). If one element changes, the end moves by at most

* ``2 asinh(sinh(c/2) cosh(s))`` for a side that becomes longer or shorter by up to ``c = L(b + t) -
  L(b)``, the shift of a point at the distance ``s`` from the axis of a translation by ``c``, and
* ``2 asinh(sinh(s) |sin d|)`` for a corner turned by ``2 d``,

with ``s`` the distance from the element to the end; if only the distance of start and end matters,
to the nearer of the two. ``s`` is at most the sum of the sides between. By the triangle inequality
the changes add up, in any order (derived here). The corners are turned first, while the sides are
as drawn, then the sides change, with all others at their longest.

The simple form takes all sides at their longest for the corners and leaves out ``cosh``. It is
no bound: two long sides on the same side of a third move apart by more than that becomes
longer. It is larger in nearly all cases, and the larger of both is the bound.

Points change the direction of each shaft by up to a cone ``e``. Write a joint as ``z = tan(b/2)
exp(i phi)``, the stereographic picture of the next direction in a frame of its shaft. The side ends
at ``z**2``, and a step ``ds`` on the sphere moves it by ``tan(b) ds`` in the hyperbolic plane. So
two cones together move it by at most ``c = L(b + e) - L(b)`` with ``e = e_j + e_{j+1}``, whatever
the bend plane does; this holds through a straight joint. What turns in addition are the frame of
the next shaft, by the area of the spherical quadrilateral of the old and new directions, and the
plane behind the side, by the area of a hyperbolic triangle. Half the area of a triangle with two
sides ``p`` and ``r`` is at most ``asin(tan(p/2) tan(r/2))`` on the sphere and ``asin(tanh(p/2)
tanh(r/2))`` in the hyperbolic plane. A turn of a frame counts twice, since a side is ``z**2``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from cardan.arrays import ComplexArray, FloatArray
from cardan.design.quantities import Amplitude

if TYPE_CHECKING:
    from cardan.tolerances.box import Box

ParameterPlace: TypeAlias = tuple[str, tuple[int, ...]]
"""One parameter: its group, such as ``"bends"``, and its place there."""

# A number for all samples, or one for each.
_Values: TypeAlias = Any


@dataclass(frozen=True, eq=False)
class Nominal:
    """One driveline as drawn, with angles in rad; ``q`` is that of ideal joints."""

    bends: FloatArray
    twists: FloatArray
    phases: FloatArray
    points: FloatArray | None = None  # (n + 2, 3), if they and not bends and twists deviate
    deviations: FloatArray | None = None  # of the joints as built, (n, 3)

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.bends)

    def reversed(self) -> Nominal:
        """Return the driveline driven from its other end."""
        points = None if self.points is None else self.points[::-1]
        return Nominal(self.bends[::-1], self.twists[::-1], self.phases[::-1], points)


Deviations: TypeAlias = Mapping[ParameterPlace, FloatArray]
"""By how much parameters deviate in each sample, ``(samples,)``; those left out do not."""


def reversed_deviations(nominal: Nominal, deviations: Deviations) -> Deviations:
    """Return the deviations of the layout of the driveline driven from its other end."""
    n = nominal.n_joints
    last = {"bends": n - 1, "twists": n - 2, "phases": n - 2, "points": n + 1}
    return {
        (group, (last[group] - place[0], *place[1:])): values
        for (group, place), values in deviations.items()
        if group in last
    }


def joints_and_turns(
    nominal: Nominal, deviations: Deviations
) -> tuple[list[_Values], list[_Values]]:
    """Return ``k`` of each joint and ``exp(-2 i p)`` of the shaft before it.

    Each is a number or an array over the samples. Of shaft 0 it is the turn of the plane of joint
    0, which points can change. Without that turn ``q`` would rotate with the plane, which a small
    deviation can turn far where joint 0 is nearly straight.
    """

    def at(group: str, array: FloatArray, *place: int) -> _Values:
        own = float(array[place])
        deviation = deviations.get((group, place))
        return own if deviation is None else own + deviation

    n = nominal.n_joints
    phases = [at("phases", nominal.phases, i) for i in range(n - 1)]
    if nominal.points is not None:
        points = [
            [at("points", nominal.points, i, axis) for axis in range(3)] for i in range(n + 2)
        ]
        joints, twisted = _from_spans(
            [_difference(b, a) for a, b in pairwise(points)], nominal.points[1] - nominal.points[0]
        )
        turned = [
            -turn * _turn(-2.0 * phase) for turn, phase in zip(twisted[1:], phases, strict=True)
        ]
        return joints, [twisted[0], *turned]
    bends = [at("bends", nominal.bends, j) for j in range(n)]
    twists = [at("twists", nominal.twists, i) for i in range(n - 1)]
    joints = [np.square(np.tan(0.5 * bend)) for bend in bends]
    return joints, [1.0, *(-_turn(2.0 * (t - p)) for t, p in zip(twists, phases, strict=True))]


def q_of(joints: Sequence[_Values], turns: Sequence[_Values]) -> ComplexArray:
    """Return ``q`` behind the last of these joints, each with the turn before it."""
    x: _Values = turns[-1] * (joints[-1] + 0j)
    for k, turn in zip(reversed(joints[:-1]), reversed(turns[:-1]), strict=True):
        x = turn * ((x + k) / (1.0 + k * x))
    return np.asarray(-x)


def amplitude(
    kind: Amplitude, nominal: Nominal, deviations: Deviations, shaft: int
) -> ComplexArray:
    """Return one of the complex numbers that ``MotionQuantity.amplitudes`` names."""
    if kind == "coasting":
        deviations, nominal = reversed_deviations(nominal, deviations), nominal.reversed()
    joints, turns = joints_and_turns(nominal, deviations)
    if kind == "last":
        return q_of(joints[:shaft], turns[:shaft])
    total: Any = 0j
    for behind in range(1, nominal.n_joints):
        total = total + q_of(joints[:behind], turns[:behind])
    return np.asarray(total)


def _turn(angle: _Values) -> _Values:
    """``exp(i angle)``."""
    if isinstance(angle, float):
        return complex(math.cos(angle), math.sin(angle))
    turn = np.empty(angle.shape, dtype=np.complex128)
    np.cos(angle, out=turn.real)
    np.sin(angle, out=turn.imag)
    return turn


_Vector: TypeAlias = list[_Values]


def _from_spans(spans: list[_Vector], first: FloatArray) -> tuple[list[_Values], list[_Values]]:
    """``k`` of each joint and ``exp(2 i twist)`` of the shaft before it, from the shafts.

    With the cross product ``c`` of two shafts ``a`` and ``b``, ``k = (|c|/(|a| |b| + a·b))**2``. A
    joint that is straight to the last bit takes the normal of the previous one. The turn of joint
    0 is that from a vector across shaft 0 as drawn, to first order without rotation about the
    shaft; a straight joint 0 has that vector as its normal.
    """
    lengths = [np.sqrt(_dot(span, span)) for span in spans]
    joints, twists = [], []
    normal = _across(_perpendicular(first), spans[0], lengths[0])
    for j, (a, b) in enumerate(pairwise(spans)):
        cross = _cross(a, b)
        square = _dot(cross, cross)
        product = lengths[j] * lengths[j + 1]
        joints.append(square / np.square(product + _dot(a, b)))
        # The limit of the core, below which the direction of the cross product is rounding.
        straight = square <= (4.0 * np.finfo(float).eps * product) ** 2
        if np.any(straight):
            kept = _across(normal, a, lengths[j])
            cross = [np.where(straight, old, new) for old, new in zip(kept, cross, strict=True)]
        turn = _dot(normal, cross) + 1j * (_dot(_cross(normal, cross), a) / lengths[j])
        squared = turn * turn
        twists.append(squared / np.abs(squared))
        normal = cross
    return joints, twists


def _difference(b: _Vector, a: _Vector) -> _Vector:
    return [x - y for x, y in zip(b, a, strict=True)]


def _dot(a: _Vector, b: _Vector) -> _Values:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: _Vector, b: _Vector) -> _Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _perpendicular(shaft: FloatArray) -> _Vector:
    """A vector across a shaft."""
    across: _Vector = np.cross(shaft, np.eye(3)[np.argmin(np.abs(shaft))]).tolist()
    return across


def _across(vector: _Vector, a: _Vector, length: _Values) -> _Vector:
    """The part of a vector across a shaft."""
    along = _dot(vector, a) / np.square(length)
    return [x - along * y for x, y in zip(vector, a, strict=True)]


# --- upper bounds ---------------------------------------------------------------------------------


def largest_modulus(kind: Amplitude, box: Box, shaft: int) -> float:
    """Return a bound of the magnitude of an amplitude over the box."""
    grown, changes, corners, turned = bound_parts(box)
    if kind == "last":
        k = float(np.abs(amplitude(kind, box.nominal, {}, shaft)))
        # The distance of start and end: each corner may be seen from the nearer of them.
        moved = _moved(grown[:shaft], changes, corners, turned, nearer=True)
        return float(np.tanh(0.5 * min(2.0 * np.arctanh(k) + moved, np.sum(grown[:shaft]))))
    if kind == "coasting":
        grown, changes, corners, turned = grown[::-1], changes[::-1], corners[::-1], turned[::-1]
    nominal = box.nominal.reversed() if kind == "coasting" else box.nominal
    total = sum(
        _displacement(nominal, s, grown, changes, corners, turned) for s in _between(nominal)
    )
    own = float(np.abs(amplitude("driving", nominal, {}, shaft)))
    most = sum(float(np.tanh(0.5 * np.sum(grown[:s]))) for s in _between(nominal))
    return min(own + total, most)


def _between(nominal: Nominal) -> range:
    return range(1, nominal.n_joints)


def _displacement(nominal: Nominal, shaft: int, *parts: FloatArray) -> float:
    """By how much ``q`` of a shaft can move in the disc."""
    grown, changes, corners, turned = parts
    q = float(np.abs(amplitude("last", nominal, {}, shaft)))
    r = float(np.tanh(0.5 * _moved(grown[:shaft], changes, corners, turned, nearer=False)))
    # A disc about q of hyperbolic radius artanh(r) reaches so far.
    return r * (1.0 - q * q) / (1.0 - q * r)


def bound_parts(box: Box) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return each side ``(n,)`` at its longest, its change ``(n,)``, and half of the turns in rad.

    These are of each corner ``(n - 1,)`` by phases and twists, and of the polygon behind each joint
    ``(n,)`` by points.
    """
    bends, sizes = box.nominal.bends, box.by_group(box.sizes)
    least = _length(bends)
    grown = _length(bends + box.bend_changes)
    changes = grown - least
    between = np.zeros(len(bends) - 1)
    corners = sizes.get("phases", between) + sizes.get("twists", between)
    before, behind = box.cones[:-1], box.cones[1:]
    # Either diagonal divides the quadrilateral into two triangles.
    frames = np.minimum(
        _two_triangles(before, behind, bends), _two_triangles(behind, before, bends)
    )
    plane = _half_area(np.tanh(0.5 * least) * np.tanh(0.5 * changes))
    # The area of the quadrilateral turns the frame, and twice of it the plane; half turns here.
    turned = 2.0 * frames + np.where(before + behind > 0.0, plane, 0.0)
    return grown, changes, corners, turned


def _moved(
    grown: FloatArray, changes: FloatArray, corners: FloatArray, turned: FloatArray, *, nearer: bool
) -> float:
    """How far the end of the polygon can move."""
    n = len(grown)
    reach = np.concatenate([[0.0], np.cumsum(grown)])
    behind, before = reach[-1] - reach, reach
    # A corner lies between two sides. The turn at a joint acts where its side begins or ends.
    at_joint = np.minimum(behind[1:], before[:-1]) if nearer else behind[1:]
    turns = np.sum(_swung(at_joint, turned[:n]))
    shifts = np.sum(2.0 * np.arcsinh(np.sinh(0.5 * changes[:n]) * np.cosh(at_joint)))
    proven = np.sum(_swung(_arms(grown - changes[:n], nearer), corners[: n - 1])) + shifts + turns
    simple = np.sum(_swung(_arms(grown, nearer), corners[: n - 1])) + np.sum(changes[:n]) + turns
    return float(max(proven, simple))


def _arms(sides: FloatArray, nearer: bool) -> FloatArray:
    """Longest distance from each corner to the end, or to the nearer of end and start."""
    before = np.cumsum(sides)[:-1]
    behind = np.sum(sides) - before
    return np.minimum(behind, before) if nearer else behind


def _length(bends: FloatArray) -> FloatArray:
    """``L = ln sec(bend)``."""
    # The cosine of a small bend has lost the digits of its difference from 1.
    small = -np.log1p(-2.0 * np.sin(0.5 * bends) ** 2)
    return np.where(bends < 0.5, small, -np.log(np.cos(bends)))


def _two_triangles(first: FloatArray, second: FloatArray, bends: FloatArray) -> FloatArray:
    """Half the area between old and new directions, divided from the old of the first shaft."""
    moved = bends + first + second
    return _half_area(np.tan(0.5 * first) * np.tan(0.5 * moved)) + _half_area(
        np.tan(0.5 * second) * np.tan(0.5 * bends)
    )


def _half_area(product: FloatArray) -> FloatArray:
    return np.arcsin(np.minimum(product, 1.0))


def _swung(arm: FloatArray, half_turn: FloatArray) -> FloatArray:
    sine = np.sin(np.minimum(half_turn, np.pi / 2))
    return np.asarray(2.0 * np.arcsinh(np.sinh(arm) * sine))
