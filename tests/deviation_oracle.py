"""Joints as built with mpmath, from the vectors of their pins and nothing else.

The driven angle is the root of ``p . q = sin e2``; its derivatives are differences of that root
with 60 digits. Moments come from the three equations that the frictionless cross imposes on them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cardan import Driveline
from oracle import ExactTurn, MpNumber, mp
from vectors import Frames, MpVector, cross, plus, scaled

Wide = list[MpNumber]


def _dot(a: Wide, b: Wide) -> MpNumber:
    return mp.fsum(x * y for x, y in zip(a, b, strict=True))


@dataclass(frozen=True)
class LeaningJoint:
    """One joint in the axes ``u``, ``e_in`` and ``m`` of its driving shaft."""

    bend: float
    deviations: Sequence[float]

    @property
    def driven_shaft(self) -> Wide:
        return [mp.cos(self.bend), mp.sin(self.bend), mp.mpf(0)]

    def driving_pin(self, angle: MpNumber) -> Wide:
        lean = mp.mpf(self.deviations[0])
        return [mp.sin(lean), mp.cos(lean) * mp.cos(angle), mp.cos(lean) * mp.sin(angle)]

    def driven_pin(self, angle: MpNumber) -> Wide:
        lean = mp.mpf(self.deviations[2])
        across = [-mp.sin(self.bend), mp.cos(self.bend), mp.mpf(0)]
        return [
            mp.cos(lean) * -mp.sin(angle) * e + mp.sin(lean) * v + mp.cos(lean) * mp.cos(angle) * m
            for e, v, m in zip(across, self.driven_shaft, [0, 0, 1], strict=True)
        ]

    def driven_angle(self, angle: MpNumber) -> MpNumber:
        """The driven angle next to that of an ideal joint."""
        sine, cosine = mp.sin(angle), mp.cos(angle)
        near = angle + mp.atan2(
            (1 - mp.cos(self.bend)) * sine * cosine, mp.cos(self.bend) * cosine**2 + sine**2
        )
        pin, skew = self.driving_pin(angle), mp.sin(self.deviations[1])
        return mp.findroot(lambda x: _dot(pin, self.driven_pin(x)) - skew, near)

    def moment(self, angle: MpNumber) -> Wide:
        """The moment on the driven shaft for a torsion of 1: normal to both pins."""
        driven = self.driven_pin(self.driven_angle(angle))
        rows = mp.matrix([[1, 0, 0], self.driving_pin(angle), driven])
        return list(mp.lu_solve(rows, mp.matrix([1, 0, 0])))


@dataclass(frozen=True)
class LeaningChain:
    """The angle of the last shaft, joint by joint."""

    joints: Sequence[LeaningJoint]
    twists: Sequence[float] = ()
    phases: Sequence[float] = ()

    def inputs(self, angle: MpNumber) -> list[MpNumber]:
        """The input angle of each joint."""
        found = [mp.mpf(angle)]
        for joint, twist, phase in zip(self.joints, self.twists, self.phases, strict=False):
            behind = joint.driven_angle(found[-1])
            found.append(behind + mp.mpf(phase) - mp.mpf(twist) + mp.pi / 2)
        return found

    def lag(self, angle: MpNumber) -> MpNumber:
        """The sum of the joints' own driven angles less their input angles."""
        pairs = zip(self.joints, self.inputs(angle), strict=True)
        return mp.fsum(joint.driven_angle(x) - x for joint, x in pairs)

    def mean_lag(self, samples: int = 64) -> MpNumber:
        return mp.fsum(self.lag(2 * mp.pi * i / samples) for i in range(samples)) / samples

    def rates(self, angle: float) -> list[MpNumber]:
        """First to third derivative of the last shaft's angle."""

        def turn(x: MpNumber) -> MpNumber:
            return x + self.lag(x)

        return [mp.diff(turn, angle, order, h=mp.mpf(10) ** -15) for order in (1, 2, 3)]


@dataclass(frozen=True)
class LeaningShaft:
    """The motion of a shaft behind joints as built."""

    chain: LeaningChain

    def speed_ratio(self, at: ExactTurn) -> MpNumber:
        return self._rate(at, 1)

    def acceleration_ratio(self, at: ExactTurn) -> MpNumber:
        return self._rate(at, 2)

    def _rate(self, at: ExactTurn, order: int) -> MpNumber:
        if not self.chain.joints:
            return mp.mpf(order == 1)
        turn = mp.diff(self.chain.lag, at.angle, order, h=mp.mpf(10) ** -15)
        return turn + 1 if order == 1 else turn


@dataclass(frozen=True)
class LeaningFrames(Frames):
    """Shafts and pins of joints as built in space."""

    folds: list[Any]
    chain: LeaningChain

    @classmethod
    def of(cls, line: Driveline) -> LeaningFrames:
        ideal = Frames.of(line.with_deviations())
        each = zip(ideal.bends, line.deviations.tolist(), strict=True)
        joints, twists = [LeaningJoint(bend, own) for bend, own in each], line.twists.tolist()
        chains = []
        for i in range(len(joints) + 1):
            between = slice(max(i - 1, 0))
            chains.append(LeaningChain(joints[:i], twists[between], ideal.phases[between]))
        shafts = [LeaningShaft(chain) for chain in chains]
        return cls(ideal.bends, ideal.phases, ideal.directions, ideal.normals, shafts, chains[-1])

    def pins(self, at: ExactTurn) -> list[tuple[MpVector, MpVector]]:
        found = []
        inputs = zip(self.chain.joints, self.chain.inputs(at.angle), strict=True)
        for (joint, own), u, m in zip(inputs, self.directions, self.normals, strict=False):
            axes = (u, cross(m, u), m)
            driving, driven = joint.driving_pin(own), joint.driven_pin(joint.driven_angle(own))
            found.append((_in_space(driving, axes), _in_space(driven, axes)))
        return found


def _in_space(components: Wide, axes: Sequence[MpVector]) -> MpVector:
    x, y, z = (scaled(size, axis) for size, axis in zip(components, axes, strict=True))
    return plus(plus(x, y), z)
