"""The complex number ``q`` of a chain whose parameters deviate, and how far it can move at most.

The core finds ``q``. Upper bounds that no driveline within its tolerances exceeds follow from its
picture in the hyperbolic plane, a polygon with sides ``L = ln sec(bend)``: page Tolerances of the
theory (``docs/theory/tolerances.md``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from cardan import _core
from cardan.arrays import ComplexArray, FloatArray
from cardan.design.quantities import Amplitude

if TYPE_CHECKING:
    from cardan.tolerances.box import Box

ParameterPlace: TypeAlias = tuple[str, tuple[int, ...]]
"""One parameter: its group, such as ``"bends"``, and its place there."""


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
"""Deviations of parameters in each sample, ``(samples,)``; those left out are 0."""


def deviated(group: str, own: FloatArray, deviations: Deviations, samples: int) -> FloatArray:
    """Return the parameters of one group, as drawn and deviating, for each sample."""
    values = np.repeat(own[np.newaxis], samples, axis=0)
    for (name, place), deviation in deviations.items():
        if name == group:
            np.moveaxis(values, 0, -1)[place] += deviation
    return values


def amplitude(
    kind: Amplitude, nominal: Nominal, shaft: int, deviations: Deviations, samples: int
) -> ComplexArray:
    """Return one of the complex numbers that ``MotionQuantity.amplitudes`` names, ``(samples,)``.

    The drive angle counts from the plane of joint 0. Points can turn that plane, far where the
    joint is nearly straight; with them it counts from a vector across shaft 0 as drawn.
    """
    n = nominal.n_joints
    if kind == "coasting":
        last = {"bends": n - 1, "twists": n - 2, "phases": n - 2, "points": n + 1}
        deviations = {
            (group, (last[group] - place[0], *place[1:])): values
            for (group, place), values in deviations.items()
            if group in last
        }
        nominal = nominal.reversed()
    phases = deviated("phases", nominal.phases, deviations, samples).ravel()
    turned: Any = 0.0
    if nominal.points is None:
        # ``q`` is even in each bend.
        bends = np.abs(deviated("bends", nominal.bends, deviations, samples)).ravel()
        twists = deviated("twists", nominal.twists, deviations, samples).ravel()
    else:
        points = deviated("points", nominal.points, deviations, samples).ravel()
        bends, twists, along, across, _ = _core.from_points(n, [samples], points, phases)
        first = nominal.points[1] - nominal.points[0]
        zero = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
        axis, normal = along.reshape(samples, -1)[:, :3], across.reshape(samples, -1)[:, :3]
        turned = np.arctan2(np.sum(np.cross(zero, normal) * axis, axis=-1), normal @ zero)
    total: Any = 0.0
    for behind in [shaft] if kind == "last" else range(1, n):
        _, offset, k, *_ = _core.equivalent(n, behind, bends, twists, phases)
        total = total - k * np.exp(2j * (turned - offset))
    return np.broadcast_to(np.asarray(total, np.complex128), samples)


def as_drawn(kind: Amplitude, nominal: Nominal, shaft: int) -> complex:
    """Return that number of the driveline as drawn."""
    return complex(amplitude(kind, nominal, shaft, {}, 1)[0])


# --- upper bounds ---------------------------------------------------------------------------------


def largest_modulus(kind: Amplitude, box: Box, shaft: int) -> float:
    """Return a bound of the magnitude of an amplitude over the box."""
    grown, changes, corners, turned = bound_parts(box)
    if kind == "last":
        k = abs(as_drawn(kind, box.nominal, shaft))
        # The distance of start and end: each corner may be seen from the nearer of them.
        moved = _moved(grown[:shaft], changes, corners, turned, nearer=True)
        return float(np.tanh(0.5 * min(2.0 * np.arctanh(k) + moved, np.sum(grown[:shaft]))))
    if kind == "coasting":
        grown, changes, corners, turned = grown[::-1], changes[::-1], corners[::-1], turned[::-1]
    nominal = box.nominal.reversed() if kind == "coasting" else box.nominal
    total = sum(
        _displacement(nominal, s, grown, changes, corners, turned) for s in _between(nominal)
    )
    own = abs(as_drawn("driving", nominal, shaft))
    most = sum(float(np.tanh(0.5 * np.sum(grown[:s]))) for s in _between(nominal))
    return min(own + total, most)


def _between(nominal: Nominal) -> range:
    return range(1, nominal.n_joints)


def _displacement(nominal: Nominal, shaft: int, *parts: FloatArray) -> float:
    """Return the largest move of ``q`` of a shaft in the disc."""
    grown, changes, corners, turned = parts
    q = abs(as_drawn("last", nominal, shaft))
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
