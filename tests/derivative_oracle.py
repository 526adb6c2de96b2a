"""Derivatives of every output by differences in 60 digits, from the pins of the vector picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

import numpy as np

from cardan import OUTPUTS
from equilibrium import assignments, solved, system
from oracle import ExactTurn, Fold, MpNumber, mp
from vectors import (
    ExactLoads,
    Frames,
    MpVector,
    across,
    cross,
    dot,
    length,
    plus,
    scaled,
    turned,
    unit,
)

STEP = mp.mpf(10) ** -20
X_AXIS: MpVector = (mp.mpf(1), mp.mpf(0), mp.mpf(0))
Z_AXIS: MpVector = (mp.mpf(0), mp.mpf(0), mp.mpf(1))


def numbers(values: Any) -> list[MpNumber]:  # noqa: ANN401 - a nested list of numbers
    return [mp.mpf(x) for x in np.asarray(values, float).ravel().tolist()]


def from_angles(
    bends: Sequence[MpNumber],
    twists: Sequence[MpNumber],
    phases: Sequence[MpNumber],
    first: MpVector = X_AXIS,
    normal: MpVector = Z_AXIS,
) -> Frames:
    directions, normals = [unit(first)], [unit(across(normal, unit(first)))]
    for j, bend in enumerate(bends):
        if j > 0:
            normals.append(turned(normals[-1], directions[-1], ExactTurn.by(twists[j - 1])))
        directions.append(turned(directions[-1], normals[-1], ExactTurn.by(bend)))
    folds = [
        Fold.of(bends[:i], twists[: max(i - 1, 0)], phases[: max(i - 1, 0)])
        for i in range(len(bends) + 1)
    ]
    return Frames(list(bends), list(phases), directions, normals, folds)


def from_points(points: Sequence[MpNumber], phases: Sequence[MpNumber]) -> Frames:
    corners: list[MpVector] = [
        (points[i], points[i + 1], points[i + 2]) for i in range(0, len(points), 3)
    ]
    along = [unit(plus(b, scaled(-1, a))) for a, b in pairwise(corners)]
    planes = [cross(u, v) for u, v in pairwise(along)]
    bends = [
        mp.atan2(length(m), dot(u, v)) for m, (u, v) in zip(planes, pairwise(along), strict=True)
    ]
    normal = next(unit(m) for m in planes if length(m) > 0)
    normals = []
    for m, u in zip(planes, along, strict=False):
        normal = unit(across(unit(m) if length(m) > 0 else normal, u))
        normals.append(normal)
    twists = [
        mp.atan2(dot(cross(m, n), u), dot(m, n))
        for u, (m, n) in zip(along[1:], pairwise(normals), strict=False)
    ]
    return from_angles(bends, twists, phases, along[0], normals[0])


@dataclass(frozen=True)
class BearingPlaces:
    """Where bearings carry the shafts: the shaft of each, its position, and the shafts' lengths."""

    shafts: Sequence[int]
    positions: Sequence[MpNumber]
    lengths: Sequence[MpNumber]

    def forces(self, frames: Frames, moments: Sequence[MpVector]) -> dict[str, list[MpNumber]]:
        """Return the forces by solving the equilibrium of all shafts at once."""
        counts = [list(self.shafts).count(shaft) for shaft in range(len(moments) + 1)]
        (way,) = assignments(len(moments), counts)
        bearings = list(zip(self.shafts, self.positions, strict=True))
        both = solved(*system(frames.directions, self.lengths, moments, bearings, way))
        split = 3 * len(bearings)
        return {"bearing_force": both[:split], "joint_force": both[split:]}


def turning(
    frames: Frames, at: ExactTurn, vectors: Sequence[MpVector], first: int
) -> list[MpNumber]:
    """Return vectors on shafts from ``first`` on, along each shaft, its pin and their product."""
    pins = frames.pins(at)
    along = [pins[0][0], *(driven for _, driven in pins)][first:]
    return [
        dot(vector, axis)
        for u, pin, vector in zip(frames.directions[first:], along, vectors, strict=True)
        for axis in (u, pin, cross(u, pin))
    ]


def drive_angle(fold: Fold, angle: MpNumber, start: float) -> MpNumber:
    """Return the drive angle at which a shaft has this angle, by Newton's method."""
    found = mp.mpf(start)
    for _ in range(12):
        at = ExactTurn.by(found)
        found -= (fold.angle(at) - angle) / fold.speed_ratio(at)
    return found


def outputs(
    frames: Frames,
    angle: MpNumber,
    load: Mapping[str, Any] | None,
    mounting: BearingPlaces | None = None,
) -> dict[str, list[MpNumber]]:
    """Return every output of all shafts and joints, item by item and component by component.

    Moments in the axes of their shafts have the names ``turning_moment`` and so on.
    """
    at = ExactTurn.by(angle)
    found: dict[str, list[MpNumber]] = {
        name: [getattr(fold, name)(at) for fold in frames.folds]
        for name in ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
    }
    loads = ExactLoads.of(frames, at, **(load or {}))
    for name in (field.name for field in fields(ExactLoads)):
        if load is not None or not OUTPUTS[name].needs_load:
            found[name] = flat(getattr(loads, name))
    if load is not None:
        found["turning_moment"] = turning(frames, at, loads.moment, 1)
        found["turning_support_moment"] = turning(frames, at, loads.support_moment, 0)
        if mounting is not None:
            found |= mounting.forces(frames, loads.moment)
    return found


def flat(items: Iterable[MpNumber | MpVector]) -> list[MpNumber]:
    """Return numbers, or the components of vectors."""
    return [x for item in items for x in (item if isinstance(item, tuple) else (item,))]


def differences(
    of: Callable[[list[MpNumber]], dict[str, list[MpNumber]]], at: list[MpNumber]
) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Return the derivatives of every output by a list of numbers, on the last axis."""
    columns: list[dict[str, list[MpNumber]]] = []
    for i in range(len(at)):
        ahead, behind = ([*at[:i], at[i] + step, *at[i + 1 :]] for step in (STEP, -STEP))
        ends = of(ahead), of(behind)
        columns.append(
            {
                name: [
                    (x - y) / (2 * STEP) for x, y in zip(ends[0][name], ends[1][name], strict=True)
                ]
                for name in ends[0]
            }
        )
    return {
        name: np.array([[float(x) for x in column[name]] for column in columns]).T
        for name in (columns[0] if columns else {})
    }
