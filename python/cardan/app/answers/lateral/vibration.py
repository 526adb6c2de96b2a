"""The vibration of one driveline over its speeds: what figures, remedies and pictures need."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.app.scene.sections.bearing import OF_RUBBER, RUBBER
from cardan.app.scene.sections.lateral import LateralCase
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.lateral import LateralSystem

Complex: TypeAlias = NDArray[np.complex128]

ORDERS = (1, 2, 4)
"""The orders that unbalance and joints excite."""

NEAR = 0.16
"""How near a resonance a speed is in its band, in shares of the resonance."""

KNOWN = 0.05
"""The loss factor of a resonance from which its peak is as good as that; below it is a band.

Where bearings have most of the elastic energy it is their loss factor: tubes then damp little.
"""

ALL = (0, *ORDERS)
"""The orders of the response: the mean first."""

# Natural frequencies that differ by less are those of one shape in two directions.
_ALIKE = 0.02
_MODES, _STEPS = 12, 201
# Speeds around a resonance, in shares of it.
_AROUND = np.linspace(-0.12, 0.12, 97)
_SOFTER = 1e-3
# An order counts as excited from this share of the largest force of any.
_COUNTS = 1e-3
# With this share of the elastic energy in bearings, tubes of a loss factor of about 0.01 change the
# damping by a twentieth at most, and the peak without them is too large rather than too small.
_MOST = 0.8
_ROUNDING = 1e-9


class Group(NamedTuple):
    """Natural frequencies of one shape, nearly alike in two directions."""

    number: int  # the first of the natural frequencies
    frequency: float  # its size in rad/s
    shares: FloatArray  # of each elastic bearing in the elastic energy
    loss: tuple[float, float]  # loss factor of order 1, and of higher ones

    @property
    def known(self) -> tuple[bool, bool]:
        """Whether the damping is known well enough for a peak of order 1, and of higher ones."""
        held = float(np.sum(self.shares))
        least = min(KNOWN, KNOWN * held * (1.0 - _ROUNDING)) if held >= _MOST else KNOWN
        return self.loss[0] >= least, self.loss[1] >= least


class Met(NamedTuple):
    """A resonance: an order that meets a natural frequency."""

    order: int
    speed: float
    group: Group

    @property
    def loss(self) -> float:
        """The loss factor of the order."""
        return self.group.loss[self.order > 1]

    @property
    def is_known(self) -> bool:
        """Whether the damping is known well enough for a peak."""
        return self.group.known[self.order > 1]

    @property
    def lack(self) -> str:
        """What its damping is where it is not known well enough."""
        return "too small" if self.loss else "not known"

    @property
    def needs(self) -> str:
        """The key that would make it known."""
        if self.is_of_tubes:
            return "tube_loss_factor in [lateral]"
        return f"loss_factor in [[bearing]], {OF_RUBBER}"

    @property
    def is_of_tubes(self) -> bool:
        """Whether bearings have so little of its energy that no rubber in them damps enough."""
        return float(np.sum(self.group.shares)) * RUBBER[1] < KNOWN

    @property
    def band(self) -> tuple[float, float]:
        """The ends of its band."""
        return (1.0 - NEAR) * self.speed, (1.0 + NEAR) * self.speed


@dataclass(frozen=True, eq=False)
class Vibration:
    """The vibration of one driveline in elastic bearings at a constant load.

    Attributes:
        case: what the scene says.
        line: the driveline in its bearings.
        load: its load; ``None`` if it is not known.
    """

    case: LateralCase
    line: Driveline
    load: Load | None

    def damped(self, loss: float) -> Vibration:
        """Return the same with one loss factor for all bearings and tubes."""
        return Vibration(self.case.damped(loss), self.line, self.load)

    @cached_property
    def system(self) -> LateralSystem:
        """The lateral system."""
        return self.case.on(self.line)

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """The natural frequencies, those of one shape together."""
        case, frequencies = self.case, self.system.natural_frequencies(_MODES)
        # Rigid shafts have few.
        count = int(np.count_nonzero(np.isfinite(frequencies)))
        frequencies = frequencies[:count]
        slopes = [
            np.log(case.stiffened(b, 1.0 + _SOFTER).on(self.line).natural_frequencies(count))
            for b in case.elastic
        ]
        shares = np.array(
            [2.0 * (own - np.log(frequencies)) / np.log1p(_SOFTER) for own in slopes]
        ).reshape(len(slopes), len(frequencies))
        found: list[Group] = []
        for number, (frequency, own) in enumerate(zip(frequencies, shares.T, strict=True)):
            if found and frequency < (1.0 + _ALIKE) * found[-1].frequency:
                continue
            own = np.clip(own, 0.0, 1.0)
            bearings = sum(
                share * _loss(case.supports[b], float(frequency))
                for b, share in zip(case.elastic, own, strict=True)
            )
            tubes = max(0.0, 1.0 - float(np.sum(own))) * (case.tube_loss or 0.0)
            loss = (float(bearings), float(bearings) + tubes)
            found.append(Group(number, float(frequency), own, loss))
        return tuple(found)

    @cached_property
    def met(self) -> tuple[Met, ...]:
        """The resonances up to half beyond the speeds, by speed."""
        top = 1.5 * self.case.speed[-1]
        found = [
            Met(order, group.frequency / order, group)
            for group in self.groups
            for order in ORDERS
            if group.frequency / order <= top
        ]
        return tuple(sorted(found, key=lambda each: each.speed))

    @cached_property
    def speed(self) -> FloatArray:
        """The speeds of the response in rad/s: those of the scene, and more near resonances."""
        low, high = float(self.case.speed[0]), float(self.case.speed[-1])
        near = [each.speed * (1.0 + _AROUND) for each in self.met]
        every = np.unique(np.concatenate([self.case.speed, np.linspace(low, high, _STEPS), *near]))
        return np.asarray(every[(every >= low) & (every <= high)])

    @cached_property
    def middles(self) -> tuple[tuple[int, float], ...]:
        """The middle of each shaft that bends."""
        lengths = self.line.lengths().each
        return tuple((shaft, 0.5 * float(lengths[shaft])) for shaft in self.case.bending)

    @cached_property
    def response(self) -> Any:  # noqa: ANN401 - a LateralResponse
        """The response of ``ALL`` orders over the speeds."""
        assert self.load is not None
        return self.system.response(self.speed, self.load, orders=ALL, probes=self.middles)

    @cached_property
    def excited(self) -> tuple[int, ...]:
        """The orders that are excited: 1 by unbalance, 2 and 4 by the moments of joints."""
        once = (1,) if self.case.unbalance else ()
        if self.load is None:
            return (*once, 2)
        forces = [self.response.of_order(f"{name}_force") for name in ("bearing", "joint")]
        most = np.max([np.max(own, axis=(0, 1), initial=0.0) for own in forces], axis=0)
        beyond = dict(zip(ALL, most > _COUNTS * np.max(most), strict=True))
        return (*once, *(order for order in (2, 4) if beyond[order]))

    @cached_property
    def unknown(self) -> NDArray[np.bool_]:
        """Whether each speed is in the band of an excited resonance whose damping is not known."""
        found = np.zeros(self.speed.shape, dtype=bool)
        for each in self.bands:
            found |= (self.speed > each.band[0]) & (self.speed < each.band[1])
        return found

    @cached_property
    def bands(self) -> tuple[Met, ...]:
        """The excited resonances whose damping is not known, and whose bands reach the speeds."""
        low, high = self.case.speed[0], self.case.speed[-1]
        return tuple(
            each
            for each in self.met
            if each.order in self.excited
            and not each.is_known
            and each.band[1] > low
            and each.band[0] < high
        )

    @cached_property
    def statics(self) -> Complex | None:
        """Order 2 of the force of each bearing by statics, ``(bearings, 3)``, if it is known."""
        return static_forces(self.line, self.load)

    @cached_property
    def couples(self) -> Complex:
        """The couples at both ends of each shaft that moves, ``(shafts, 2 ends, 2, 3)`` in N m.

        They are their mean and order 2, upstream end first.
        """
        line, load = self.line, self.load
        assert load is not None
        sums = line.harmonics((2,), outputs="moment", load=load)
        moments = np.stack([sums.mean["moment"], sums.complex_amplitude["moment"][..., 0]], axis=1)
        none = np.zeros((1, 2, 3))
        received = np.concatenate([none, moments])
        passed_on = np.concatenate([moments, none])
        moving = list(self.case.moving)
        u = line.directions[moving][:, np.newaxis]
        return np.stack(
            [np.cross(received[moving], u), -np.cross(passed_on[moving], u)], axis=1
        ).astype(np.complex128)

    def peak(self, met: Met) -> tuple[int, float, float, float] | None:
        """Return bearing, speed, force and displacement at the peak of a resonance, if in range.

        It is that of the bearing with the largest force of this order, at the speeds to which no
        other resonance of the order is nearer.
        """
        away = np.abs(self.speed / met.speed - 1.0)
        around = (away <= _AROUND[-1] + 1e-12) & ~self.unknown
        for each in self.met:
            if each.order == met.order and each is not met:
                around &= away < np.abs(self.speed / each.speed - 1.0)
        place = ALL.index(met.order)
        forces = self.response.of_order("bearing_force")[:, around, place]
        is_hidden = any(low < met.speed < high for low, high in (each.band for each in self.bands))
        if not forces.size or is_hidden:
            return None
        bearing, at = np.unravel_index(int(np.argmax(forces)), forces.shape)
        at = np.flatnonzero(around)[at]
        own = self.response.of_order("bearing_force")[bearing, :, place]
        if np.any(own[max(at - 1, 0) : at + 2] > own[at]):
            # The flank of another resonance.
            return None
        moved = self.response.of_order("bearing_displacement")[bearing, at, place]
        return int(bearing), float(self.speed[at]), float(own[at]), float(moved)

    @cached_property
    def redundant(self) -> tuple[int, ...]:
        """The joints that support neither of their shafts, whose force statics takes as 0."""
        moving, count = self.case.moving, self.line.n_joints + 1
        held = [
            shaft not in moving or sum(own == shaft for own, _ in self.line.bearings) > 1
            for shaft in range(count)
        ]
        return tuple(j for j in range(count - 1) if held[j] and held[j + 1])


def static_forces(line: Driveline, load: Load | None) -> Complex | None:
    """Return order 2 of the force of each bearing by statics; ``None`` if it is not determinate."""
    if load is None:
        return None
    try:
        sums = line.harmonics((2,), outputs="bearing_force", load=load)
    except ArgumentValueError:
        return None
    return np.asarray(sums.complex_amplitude["bearing_force"][..., 0])


def _loss(support: Any, frequency: float) -> float:  # noqa: ANN401 - arguments of a bearing
    """Return the mean loss factor of a bearing at a frequency."""
    lost = np.asarray(support.get("loss_factor", 0.0)) + frequency * np.asarray(
        support.get("damping", 0.0)
    ) / np.asarray(support["stiffness"])
    return float(np.mean(lost))
