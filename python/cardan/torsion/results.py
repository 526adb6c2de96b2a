"""Results of torsional systems: steady state, orbit and stability."""

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


@dataclass(frozen=True, eq=False)
class SteadyState(Searched):
    """The periodic motion at constant drive speed, over one period, half a turn of the drive.

    A quantity is ``mean + Re(sum(orders * exp(1j * m * angle)))`` with the drive angle and the
    order ``m``, so the modulus of an order is its peak amplitude. Odd orders are 0.

    Attributes:
        torque_mean: mean torque of each compliant shaft in N m, ``(compliant, ...)``.
        torque_min: least torque, the true extremum between samples.
        torque_max: largest torque.
        torque_orders: orders of the torque, ``(compliant, ..., orders)``.
        angle_orders: orders of the angle of every shaft end in rad, input end before output end,
            ``(n + 1, 2, ..., orders)``.
        speed_orders: orders of its speed in rad/s.
        orders: the orders, ``(orders,)``.
        compliant: the compliant shafts.
    """

    torque_mean: FloatArray
    torque_min: FloatArray
    torque_max: FloatArray
    torque_orders: ComplexArray
    angle_orders: ComplexArray
    speed_orders: ComplexArray
    orders: NDArray[np.int64]
    compliant: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Orbit(Searched):
    """One period, half a turn of the drive, at equally spaced drive angles.

    Attributes:
        drive_angle: in rad, ``(samples,)``, from 0 up to but not including pi.
        angle_error: angle of every shaft end relative to the drive in rad, input end before output
            end, ``(n + 1, 2, ..., samples)``. Without load and vibration its mean is 0.
        speed: speed of every shaft end in rad/s, ``(n + 1, 2, ..., samples)``.
        torque: torque of every compliant shaft in N m, ``(compliant, ..., samples)``.
        compliant: the compliant shafts.
    """

    drive_angle: FloatArray
    angle_error: FloatArray
    speed: FloatArray
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
        small = np.abs(self.multipliers) <= 1.0 + 1e-9
        return np.asarray(self.found & small.all(axis=-1))
