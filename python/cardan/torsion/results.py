"""Results of torsional systems: what a search found, orbit and stability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray

ComplexArray = NDArray[np.complex128]

# The numbers by which the native module counts failures.
_REASONS = (
    "",
    "the speed is not a positive finite number",
    "no periodic orbit was found",
    "the orbit needs more points than are allowed",
)


@dataclass(frozen=True, eq=False)
class Searched:
    """What a search for periodic orbits found; ``...`` is the shape of systems and speeds.

    Attributes:
        found: whether there is an orbit, ``(...)``. Where there is none, the results are NaN.
    """

    found: NDArray[np.bool_]
    _failures: NDArray[np.uint8]

    @property
    def reasons(self) -> NDArray[np.str_]:
        """Why there is no orbit, ``(...)``; empty where there is one."""
        return np.array(_REASONS)[self._failures]


def small(multipliers: ComplexArray) -> NDArray[np.bool_]:
    """Return whether no multiplier of the last axis is larger than 1 by more than rounding."""
    return np.asarray((np.abs(multipliers) <= 1.0 + 1e-9).all(axis=-1))


@dataclass(frozen=True, eq=False)
class Orbit(Searched):
    """One period, half a turn of the drive, at equally spaced drive angles.

    Attributes:
        drive_angle: in rad, ``(samples,)``, from 0 up to but not including pi.
        angle_error: angle of every shaft end relative to the drive in rad, input end before output
            end, ``(n + 1, 2, ..., samples)``. Without load and vibration its mean is 0.
        speed: speed of every shaft end in rad/s, ``(n + 1, 2, ..., samples)``.
        acceleration: acceleration of every shaft end in rad/s², ``(n + 1, 2, ..., samples)``.
        drive_torque: torque in N m that keeps the speed of the drive constant, ``(..., samples)``.
        torque: torque of every compliant shaft in N m, ``(compliant, ..., samples)``.
        compliant: the compliant shafts.
    """

    drive_angle: FloatArray
    angle_error: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    drive_torque: FloatArray
    torque: FloatArray
    compliant: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Stability(Searched):
    """Whether small deviations from the periodic orbit grow.

    Attributes:
        multipliers: Floquet multipliers of half a turn of the drive, largest modulus first,
            ``(..., 2 * compliant)``.
    """

    multipliers: ComplexArray

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether no multiplier is larger than 1 + 1e-9, ``(...)``; false without an orbit."""
        return np.asarray(self.found & small(self.multipliers))


@dataclass(frozen=True, eq=False)
class Coexisting(Searched):
    """Several periodic motions at one speed; ``orbits`` is the last axis.

    The first is that of ``steady``; the others follow by their largest torque. What is missing is
    NaN.

    Attributes:
        count: how many were found, ``(...)``; 0 where there is none.
        torque_mean: mean torque of each compliant shaft in N m, ``(compliant, ..., orbits)``.
        torque_min: least torque.
        torque_max: largest torque.
        multipliers: Floquet multipliers, ``(..., orbits, 2 * compliant)``.
    """

    count: NDArray[np.int64]
    torque_mean: FloatArray
    torque_min: FloatArray
    torque_max: FloatArray
    multipliers: ComplexArray

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether no multiplier is larger than 1 + 1e-9, ``(..., orbits)``; false where missing."""
        return small(self.multipliers)
