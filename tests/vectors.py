"""The loads of chains from the vector picture, exact for the doubles that make a driveline.

A driveline is its bends, twists and phases, laid out from the direction of its first shaft and its
first bend-plane normal. Each yoke is a unit vector along its pin, turned about its shaft. The cross
keeps the two pins of a joint perpendicular and passes on only a moment normal to both. No formula
for a joint's moments appears; the power that inertias absorb is that of ``oracle.Fold``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from cardan import Driveline
from oracle import Doubles, Exact, ExactTurn, Fold, MpNumber, mp

MpVector: TypeAlias = tuple[MpNumber, MpNumber, MpNumber]


def dot(v: MpVector, w: MpVector) -> MpNumber:
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]


def cross(v: MpVector, w: MpVector) -> MpVector:
    return (v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0])


def scaled(s: MpNumber, v: MpVector) -> MpVector:
    return (s * v[0], s * v[1], s * v[2])


def plus(v: MpVector, w: MpVector) -> MpVector:
    return (v[0] + w[0], v[1] + w[1], v[2] + w[2])


def length(v: MpVector) -> MpNumber:
    return mp.sqrt(dot(v, v))


def across(v: MpVector, u: MpVector) -> MpVector:
    """Return the part of ``v`` perpendicular to the unit vector ``u``."""
    return plus(v, scaled(-dot(v, u), u))


def unit(v: MpVector) -> MpVector:
    return scaled(1 / length(v), v)


def turned(v: MpVector, axis: MpVector, at: ExactTurn) -> MpVector:
    """Turn a vector about a unit vector perpendicular to it."""
    return plus(scaled(at.cosine, v), scaled(at.sine, cross(axis, v)))


@dataclass(frozen=True)
class Frames:
    """Unit vectors along the shafts, normals of the bend planes, and the motion of each shaft."""

    bends: list[float]
    phases: list[float]
    directions: list[MpVector]
    normals: list[MpVector]
    folds: list[Fold]

    @classmethod
    def of(cls, line: Driveline) -> Frames:
        bends, twists, phases = (x.tolist() for x in (line.bends, line.twists, line.phases))
        first, normal = (
            tuple(mp.mpf(x) for x in vector.tolist())
            for vector in (line.directions[0], line.normals[0])
        )
        directions = [unit(first)]
        normals = [unit(across(normal, directions[0]))]
        for j, bend in enumerate(bends):
            if j > 0:
                normals.append(turned(normals[-1], directions[-1], ExactTurn.by(twists[j - 1])))
            directions.append(turned(directions[-1], normals[-1], ExactTurn.by(bend)))
        n = range(len(bends) + 1)
        folds = [Fold.of(bends[:i], twists[: max(i - 1, 0)], phases[: max(i - 1, 0)]) for i in n]
        return cls(bends, phases, directions, normals, folds)

    def pins(self, at: ExactTurn) -> list[tuple[MpVector, MpVector]]:
        """Return the driving and the driven pin of each joint."""
        driving = turned(cross(self.normals[0], self.directions[0]), self.directions[0], at)
        pins = []
        for j, (before, after) in enumerate(pairwise(self.directions)):
            driven = unit(cross(after, driving))
            assert abs(dot(driving, before)) < 1e-40
            pins.append((driving, driven))
            if j < len(self.phases):
                driving = turned(driven, after, ExactTurn.by(self.phases[j]))
        return pins


@dataclass(frozen=True)
class ExactLoads:
    """Loads and crosses of a driveline at one drive angle, by the names of the outputs."""

    torque: list[MpNumber]
    moment: list[MpVector]
    support_moment: list[MpVector]
    bending_driving: list[MpNumber]
    bending_driven: list[MpNumber]
    pin_moment: list[MpNumber]
    tilt_driving: list[MpNumber]
    tilt_driven: list[MpNumber]
    swing_driving: list[MpNumber]
    swing_driven: list[MpNumber]
    driving_pin: list[MpVector]
    driven_pin: list[MpVector]

    @classmethod
    def of(
        cls,
        frames: Frames,
        at: ExactTurn,
        *,
        drive_torque: float | None = None,
        output_torque: float | None = None,
        inertias: Sequence[float] = (),
        speed: float = 0.0,
        acceleration: float = 0.0,
    ) -> ExactLoads:
        ratios = [fold.speed_ratio(at) for fold in frames.folds]
        absorbed = [
            mp.mpf(inertia)
            * (mp.mpf(speed) ** 2 * fold.acceleration_ratio(at) + acceleration * r)
            * r
            for inertia, fold, r in zip(
                inertias or [0.0] * len(ratios), frames.folds, ratios, strict=True
            )
        ]
        # Power over the drive's speed, on its way into each shaft.
        if output_torque is None:
            power = [mp.mpf(drive_torque or 0.0)]
            for taken in absorbed:
                power.append(power[-1] - taken)
        else:
            power = [mp.mpf(output_torque) * ratios[-1]]
            for taken in reversed(absorbed):
                power.insert(0, power[0] + taken)
        moments, pins, axes = [], frames.pins(at), frames.directions
        for j, (a, b) in enumerate(pins):
            along = cross(a, b)
            torsion = power[j + 1] / ratios[j]
            moments.append(scaled(torsion / dot(along, frames.directions[j]), along))
        none: MpVector = (mp.mpf(0), mp.mpf(0), mp.mpf(0))
        return cls(
            [p / r for p, r in zip(power, ratios, strict=False)],
            moments,
            [
                across(plus(after, scaled(-1, before)), u)
                for u, (before, after) in zip(
                    frames.directions, pairwise([none, *moments, none]), strict=True
                )
            ],
            [length(across(m, u)) for m, u in zip(moments, frames.directions, strict=False)],
            [length(across(m, u)) for m, u in zip(moments, frames.directions[1:], strict=True)],
            [length(m) for m in moments],
            # Of each pin out of the plane across the other shaft.
            [mp.asin(dot(u, b)) for u, (_, b) in zip(axes, pins, strict=False)],
            [mp.asin(dot(u, a)) for u, (a, _) in zip(axes[1:], pins, strict=True)],
            # The rotation of one shaft relative to the other has only parts along the pins.
            [r * dot(u, a) for r, u, (a, _) in zip(ratios[1:], axes[1:], pins, strict=True)],
            [-r * dot(u, b) for r, u, (_, b) in zip(ratios, axes, pins, strict=False)],
            [a for a, _ in pins],
            [b for _, b in pins],
        )


def load_errors(
    line: Driveline, got: Mapping[str, Doubles], at: Iterable[ExactTurn], load: dict[str, Any]
) -> Doubles:
    """Return the largest errors over all shafts or joints in ulp, by sample and output.

    That of a vector is in ulp of its largest component.
    """
    frames, rows = Frames.of(line), []
    # Below this the exact number is zero.
    least = mp.mpf(10) ** (15 - mp.dps)
    for sample, turn in enumerate(at):
        exact = ExactLoads.of(frames, turn, **load)
        row = []
        for name in got:
            worst = 0.0
            for found, want in zip(got[name][:, sample], getattr(exact, name), strict=True):
                parts = want if isinstance(want, tuple) else (want,)
                wanted = Exact.of(x if abs(x) > least else mp.mpf(0) for x in parts)
                unit = wanted.ulp[np.abs(wanted.high).argmax()]
                worst = max(worst, float(wanted.distance(np.atleast_1d(found)).max() / unit))
            row.append(worst)
        rows.append(row)
    return np.array(rows)
