"""Natural frequencies with what is twisted in them, and the rule for bends behind a shaft."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cardan.driveline import Driveline

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# Relative step in stiffness by which the shares of the shafts are found.
_STEP = 1e-4


@dataclass(frozen=True)
class Mode:
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

    Attributes:
        shaft: the compliant shaft.
        bend: equivalent bend in rad of the joints behind it, up to the next compliant shaft.
        damping_ratio: of the mode in which the shaft is twisted most.
        speed: around which the motion can be unstable, in rad/s: the natural frequency.
    """

    shaft: int
    bend: float
    damping_ratio: float
    speed: float

    @property
    def factor(self) -> float:
        """``tan²(bend/2)``."""
        return math.tan(0.5 * self.bend) ** 2

    @property
    def exceeded(self) -> bool:
        """Whether the motion can be unstable."""
        return self.factor > self.damping_ratio

    @property
    def edges(self) -> tuple[float, float]:
        """Drive speeds in rad/s between which it can be, without damping and to leading order."""
        half = 0.25 * self.bend**2
        return self.speed * (1.0 - half), self.speed * (1.0 + half)


def modes(self: TorsionalSystem) -> tuple[Mode, ...]:
    """Return the natural frequencies of one system with what is twisted in them, lowest first.

    By Rayleigh's quotient a shaft's share in the energy of twist is the derivative of ``ln w²`` by
    the logarithm of its stiffness ``c``, and the damping ratio is ``w/2 sum(share d/c)`` with the
    dampings ``d``.

    Raises:
        ValueError: a batch of systems.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([0, 0])
    >>> chain = cardan.TorsionalSystem(
    ...     line,
    ...     inertias=[[0, 0.02], [0.01, 0.03], [0, 0.05]],
    ...     stiffnesses=[5000, 3000, float("inf")],
    ... )
    >>> [(round(mode.frequency), mode.shaft) for mode in chain.modes()]
    [(149, 1), (531, 0)]
    >>> [round(share, 3) for share in chain.modes()[0].shares]
    [0.444, 0.556]
    """
    check_single(self)
    compliant = list(self.compliant)
    steps = np.ones((2, len(compliant), self.line.n_joints + 1))
    for place, shaft in enumerate(compliant):
        steps[:, place, shaft] = np.exp([_STEP, -_STEP])
    varied = self.changed(stiffnesses=self.stiffnesses * steps).natural_frequencies()
    shares = np.log(varied[0] / varied[1]) / _STEP
    ratio = self.dampings[compliant] / self.stiffnesses[compliant]
    return tuple(
        Mode(
            float(frequency),
            tuple(shares[:, number].tolist()),
            compliant[int(np.argmax(shares[:, number]))],
            float(0.5 * frequency * (shares[:, number] @ ratio)),
        )
        for number, frequency in enumerate(self.natural_frequencies())
    )


def bend_rules(self: TorsionalSystem) -> tuple[BendRule, ...]:
    """Return the rule ``tan²(bend/2) > zeta`` for each compliant shaft with a joint behind it.

    The rule is that of one compliant shaft before massless joints and a flywheel, to leading order
    (first region of the Whittaker-Hill equation). With several compliant shafts it is a guide;
    ``stability`` decides.

    Raises:
        ValueError: a batch of systems.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0, 0], [0, 0.05]],
    ...     stiffnesses=[8000, float("inf")],
    ...     damping_ratios=0.02,
    ... )
    >>> (rule,) = system.bend_rules()
    >>> round(rule.factor, 4), rule.exceeded
    (0.0311, True)
    """
    found, line, compliant = self.modes(), self.line, self.compliant
    rules = []
    for place, shaft in enumerate(compliant):
        end = compliant[place + 1] if place + 1 < len(compliant) else line.n_joints
        if end == shaft:
            continue
        mode = max(found, key=lambda mode: mode.shares[place])
        part = Driveline.from_bends(
            line.bends[shaft:end], line.twists[shaft : end - 1], line.phases[shaft : end - 1]
        )
        bend = float(part.equivalent().bend)
        rules.append(BendRule(shaft, bend, mode.damping_ratio, mode.frequency))
    return tuple(rules)


def check_single(system: TorsionalSystem) -> None:
    """Refuse a batch of systems."""
    if system.shape:
        raise ValueError(f"the system is a batch of shape {system.shape}; ask one of them")
