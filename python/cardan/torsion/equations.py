"""The equations of a torsional system in time, as an integrator takes them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

OfTime: TypeAlias = float | Callable[[float], float]
OfTimeAndSpeed: TypeAlias = float | Callable[[float, float], float]


@dataclass(frozen=True, eq=False)
class TorsionalMotion:
    """What a system does at some times; ``...`` is their shape.

    Attributes:
        time: in s.
        drive_angle: in rad, ``(...)``.
        drive_speed: in rad/s, ``(...)``.
        angle_error: angle of every shaft end relative to the drive in rad, input end before output
            end, ``(n + 1, 2, ...)``.
        speed: speed of every shaft end in rad/s, ``(n + 1, 2, ...)``.
        torque: torque of every compliant shaft in N m, ``(compliant, ...)``.
        compliant: the compliant shafts.
    """

    time: FloatArray
    drive_angle: FloatArray
    drive_speed: FloatArray
    angle_error: FloatArray
    speed: FloatArray
    torque: FloatArray
    compliant: tuple[int, ...]


class Equations:
    """The equations of one system with its drive and its load.

    The state is the drive angle, the speed of the drive if its inertia is finite, the angles of the
    output ends of the compliant shafts relative to the drive, and their speeds.
    """

    def __init__(
        self,
        system: TorsionalSystem,
        speed: OfTime,
        torque: OfTime | None,
        drive_torque: OfTimeAndSpeed | None,
        drive_inertia: float,
    ) -> None:
        """Check the drive and the load."""
        if system.shape:
            problem = f"has the batch {system.shape}; a transient is that of one system"
            raise ArgumentValueError("system", problem)
        if not drive_inertia >= 0.0:
            problem = f"is {drive_inertia!r}; it must not be negative"
            raise ArgumentValueError("drive_inertia", problem)
        self.free = math.isfinite(drive_inertia)
        if drive_torque is not None and not self.free:
            problem = "is given, but the speed of a drive of infinite inertia does not follow it"
            raise ArgumentValueError("drive_torque", problem)
        if self.free and callable(speed):
            problem = "is a function, but a drive of finite inertia only begins with a speed"
            raise ArgumentValueError("speed", problem)
        self.system = system
        self.compliant = system.compliant
        self.drive_inertia = drive_inertia
        self.first = 2 if self.free else 1
        self.size = self.first + 2 * len(self.compliant)
        self._speed = _checked("speed", speed)
        load = float(system.load_torque) if torque is None else torque
        self._load = _checked("torque", load)
        self._driven = _checked("drive_torque", 0.0 if drive_torque is None else drive_torque)

    def speed(self, time: float) -> float:
        """The speed of the drive where it is given, or with which it begins."""
        return _value("speed", self._speed, time)

    def load_torque(self, time: float) -> float:
        """The torque that brakes the last shaft."""
        return _value("torque", self._load, time)

    def __call__(self, time: float, state: FloatArray) -> FloatArray:
        """Return the time derivative of the state."""
        speed = state[1] if self.free else self.speed(time)
        given = [state[0], speed, self.load_torque(time)]
        # Implicit integrators pass columns of a matrix.
        ends = np.ascontiguousarray(state[self.first :])
        found = self.system._core.slopes(given, ends)
        slopes = np.empty(self.size)
        slopes[0] = speed
        slopes[self.first :] = found[:-2]
        if self.free:
            torque, inertia = found[-2:]
            driven = _value("drive_torque", self._driven, time, speed)
            slopes[1] = (driven - torque) / (self.drive_inertia + inertia)
        return slopes

    def motion(self, times: FloatArray, states: FloatArray) -> TorsionalMotion:
        """Return the motion in states ``(variables, ...)``."""
        shape, shafts = times.shape, self.system.line.n_joints + 1
        if self.free:
            speeds = states[1]
        else:
            speeds = np.array([self.speed(time) for time in times.flat]).reshape(shape)
        rows = np.stack([states[0], speeds, *states[self.first :]], axis=-1)
        found = self.system._core.motion(np.ascontiguousarray(rows.ravel()))
        records = np.moveaxis(found.reshape(*shape, 4 * shafts + len(self.compliant)), -1, 0)
        return TorsionalMotion(
            time=times,
            drive_angle=states[0],
            drive_speed=speeds,
            angle_error=records[: 2 * shafts].reshape(shafts, 2, *shape),
            speed=records[2 * shafts : 4 * shafts].reshape(shafts, 2, *shape),
            torque=records[4 * shafts :],
            compliant=self.compliant,
        )

    def rigid(self, time: float) -> FloatArray:
        """Return the state of rigid shafts that are twisted by their static torques."""
        speed = self.speed(time)
        ends = self.system._core.rigid([speed, self.load_torque(time)])
        return np.concatenate([[0.0, speed][: self.first], ends])

    def steady(self, time: float) -> FloatArray:
        """Return the state on the periodic orbit, which must exist."""
        speed = self.speed(time)
        orbit = self.system.orbit(speed, 1)
        if not orbit.found:
            raise ArgumentValueError("start", f"is 'steady', but at {speed} rad/s {orbit.reasons}")
        ends = list(self.compliant)
        angles, speeds = orbit.angle_error[ends, 1, 0], orbit.speed[ends, 1, 0]
        return np.concatenate([[0.0, speed][: self.first], angles, speeds])


def _checked(name: str, value: Any) -> Any:  # noqa: ANN401 - a number or a function
    if callable(value):
        return value
    try:
        number = float(value)
    except (TypeError, ValueError):
        problem = f"is {value!r}; it must be a number or a function"
        raise ArgumentTypeError(name, problem) from None
    if not math.isfinite(number):
        raise ArgumentValueError(name, f"is {number!r}; it must be finite")
    return number


def _value(name: str, of: Any, time: float, *speed: float) -> float:  # noqa: ANN401
    if not callable(of):
        return float(of)
    value = float(of(time, *speed))
    if not math.isfinite(value):
        raise ArgumentValueError(name, f"is {value!r} at {time} s; it must be finite")
    return value
