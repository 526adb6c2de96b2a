"""The complex number ``q`` of a chain whose parameters deviate, for many deviations at once.

A chain takes the pin's direction ``w = exp(i a)`` to ``A w + B conj(w)``; all motion depends on ``q
= B/A``. As maps of the unit disc, a joint is ``x -> (x + k)/(1 + k x)`` with ``k = tan(b/2)**2``
and a shaft ``x -> exp(-2 i p) x`` with ``p = phase - twist + 90°``. Applied to 0 from the last
joint to the first they give ``-q`` (derived here from Thoma 4).

The core computes one driveline with error terms. Here a rounding error of 1e-15 in ``q`` suffices,
and NumPy's loops over whole chunks are ten times as fast.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from cardan.arrays import ComplexArray, FloatArray
from cardan.design.quantities import Amplitude

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
