"""Natural frequencies and critical speeds of a scene, and the rule for its bends."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.scene.scene import Scene
from cardan.app.scene.torsion import TorsionCase
from cardan.driveline import Driveline

# Relative step in stiffness by which the shares of the shafts are found.
_STEP = 1e-4


@dataclass(frozen=True)
class VibrationMode:
    """A natural frequency of the mean system.

    Attributes:
        frequency: in rad/s.
        shares: of each compliant shaft in the energy of twist; they sum to 1.
        shaft: the shaft with the largest share.
        damping_ratio: by the dampings of the shafts.
    """

    frequency: float
    shares: tuple[float, ...]
    shaft: int
    damping_ratio: float


@dataclass(frozen=True)
class BendRule:
    """Whether a bend permits the instability of a compliant shaft: ``tan²(bend/2) > zeta``.

    The rule is that of one compliant shaft before massless joints and a flywheel, to leading order
    (first region of the Whittaker-Hill equation).

    Attributes:
        shaft: the compliant shaft.
        bend: equivalent bend in rad of the joints behind it, up to the next compliant shaft.
        damping_ratio: of the mode in which the shaft is twisted most.
        speed: around which the motion can be unstable, in rad/s: the natural frequency.
        inside: whether the region around it overlaps the speed range.
    """

    shaft: int
    bend: float
    damping_ratio: float
    speed: float
    inside: bool

    @property
    def factor(self) -> float:
        """``tan²(bend/2)``."""
        return math.tan(0.5 * self.bend) ** 2

    @property
    def exceeded(self) -> bool:
        """Whether the motion can be unstable."""
        return self.factor > self.damping_ratio


@dataclass(frozen=True, eq=False)
class TorsionBasics:
    """What needs no search for periodic motions.

    Attributes:
        torsion: the system.
        modes: its natural frequencies, lowest first.
        rules: one per compliant shaft with a joint behind it.
    """

    torsion: TorsionCase
    modes: tuple[VibrationMode, ...]
    rules: tuple[BendRule, ...]

    def criticals(self) -> Iterator[tuple[int, int, float]]:
        """Yield mode, order and speed in rad/s, lowest order first."""
        for order in self.torsion.orders:
            for number, mode in enumerate(self.modes):
                yield number, order, mode.frequency / order

    def is_inside(self, speed: float) -> bool:
        """Whether a speed lies in the range of the scene."""
        return bool(self.torsion.speed[0] <= speed <= self.torsion.speed[-1])


def torsion_basics(scene: Scene) -> TorsionBasics | None:
    """Return natural frequencies and the rule of the bends of a scene, if it has [torsion]."""
    given = scene.torsion
    if given is None:
        return None
    modes = _modes(given)
    return TorsionBasics(given, modes, tuple(_rules(given, modes)))


def _modes(given: TorsionCase) -> tuple[VibrationMode, ...]:
    """Frequencies, shares and damping ratios.

    By Rayleigh's quotient a shaft's share in the energy of twist is the derivative of ln w² by the
    logarithm of its stiffness, and the damping ratio is ``w/2 sum(share d/c)``.
    """
    system = given.system
    compliant = list(system.compliant)
    count = len(compliant)
    steps = np.ones((2, count, len(given.stiffnesses)))
    for place, shaft in enumerate(compliant):
        steps[:, place, shaft] = np.exp([_STEP, -_STEP])
    varied = given.changed(stiffnesses=given.stiffnesses * steps).natural_frequencies()
    shares = np.log(varied[0] / varied[1]) / _STEP
    ratio = system.dampings[compliant] / given.stiffnesses[compliant]
    return tuple(
        VibrationMode(
            float(frequency),
            tuple(float(share) for share in shares[:, number]),
            compliant[int(np.argmax(shares[:, number]))],
            float(0.5 * frequency * (shares[:, number] @ ratio)),
        )
        for number, frequency in enumerate(system.natural_frequencies())
    )


def _rules(given: TorsionCase, modes: tuple[VibrationMode, ...]) -> Iterator[BendRule]:
    line, compliant = given.system.line, given.system.compliant
    for place, shaft in enumerate(compliant):
        end = compliant[place + 1] if place + 1 < len(compliant) else line.n_joints
        if end == shaft:
            continue
        bend = _equivalent_bend(line, shaft, end)
        mode = max(modes, key=lambda mode: mode.shares[place])
        # The first region of instability, to leading order.
        edges = mode.frequency * (1.0 + 0.25 * bend**2 * np.array([-1.0, 1.0]))
        inside = bool(edges[0] <= given.speed[-1] and edges[1] >= given.speed[0])
        yield BendRule(shaft, bend, mode.damping_ratio, mode.frequency, inside)


def _equivalent_bend(line: Driveline, first: int, end: int) -> float:
    """The equivalent bend in rad of the joints from ``first`` up to but not including ``end``."""
    part = Driveline.from_bends(
        line.bends[first:end], line.twists[first : end - 1], line.phases[first : end - 1]
    )
    return float(part.equivalent().bend)
