"""Joints as built with mpmath, from the vectors of their pins and nothing else.

The driven angle is the root of ``p . q = sin e2``; its derivatives are differences of that root
with 60 digits. Moments come from the three equations that the frictionless cross imposes on them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
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
        cosine, sine = mp.cos_sin(angle)
        return [a + cosine * b + sine * c for a, b, c in zip(*self._parts, strict=True)]

    @cached_property
    def _parts(self) -> tuple[Wide, Wide, Wide]:
        """Parts of the driven pin: constant, and that go with the cosine and sine of its angle."""
        lean = mp.mpf(self.deviations[2])
        cosine, sine = mp.cos_sin(lean)
        across = [-mp.sin(self.bend), mp.cos(self.bend), mp.mpf(0)]
        return (
            [sine * v for v in self.driven_shaft],
            [mp.mpf(0), mp.mpf(0), cosine],
            [-cosine * e for e in across],
        )

    def driven_angle(self, angle: MpNumber) -> MpNumber:
        """The driven angle next to that of an ideal joint."""
        sine, cosine = mp.sin(angle), mp.cos(angle)
        near = angle + mp.atan2(
            (1 - mp.cos(self.bend)) * sine * cosine, mp.cos(self.bend) * cosine**2 + sine**2
        )
        pin = self.driving_pin(angle)
        constant, by_cosine, by_sine = (_dot(pin, part) for part in self._parts)
        constant -= mp.sin(self.deviations[1])

        def gap(x: MpNumber) -> MpNumber:
            cosine, sine = mp.cos_sin(x)
            return constant + by_cosine * cosine + by_sine * sine

        return mp.findroot(gap, near)

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

    def turned(self, angle: MpNumber) -> Iterator[tuple[MpNumber, MpNumber]]:
        """The input angle and the driven angle of each joint."""
        before = mp.mpf(angle)
        for joint, twist, phase in zip(
            self.joints, [*self.twists, 0], [*self.phases, 0], strict=False
        ):
            behind = joint.driven_angle(before)
            yield before, behind
            before = behind + mp.mpf(phase) - mp.mpf(twist) + mp.pi / 2

    def inputs(self, angle: MpNumber) -> list[MpNumber]:
        """The input angle of each joint."""
        return [before for before, _ in self.turned(angle)]

    def lag(self, angle: MpNumber) -> MpNumber:
        """The sum of the joints' own driven angles less their input angles."""
        return mp.fsum(behind - before for before, behind in self.turned(angle))

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
        turned = zip(self.chain.joints, self.chain.turned(at.angle), strict=True)
        for (joint, (before, behind)), u, m in zip(
            turned, self.directions, self.normals, strict=False
        ):
            axes = (u, cross(m, u), m)
            driving, driven = joint.driving_pin(before), joint.driven_pin(behind)
            found.append((_in_space(driving, axes), _in_space(driven, axes)))
        return found


def _in_space(components: Wide, axes: Sequence[MpVector]) -> MpVector:
    x, y, z = (scaled(size, axis) for size, axis in zip(components, axes, strict=True))
    return plus(plus(x, y), z)
