"""Load of a driveline: torques, motion and inertias."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, per_shaft
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_elements, exclusive

_RAD_S_PER_RPM = np.pi / 30.0


@dataclass(frozen=True, eq=False, init=False)
class Load:
    """Torque at one end of a driveline, the motion of its drive and the inertias of its shafts.

    Every value may be an array that broadcasts to the shape of the samples.

    Args:
        drive_torque: torque in N m put into shaft 0.
        output_torque: torque in N m delivered by the last shaft; the default, with 0. Give one of
            the two.
        speed: speed of the drive in rad/s; 0 by default.
        speed_rpm: the same in revolutions per minute. Give one of the two.
        acceleration: acceleration of the drive in rad/s²; 0 by default.
        inertias: one moment of inertia in kg m² per shaft, each about its own axis (the shafts
            are the last axis if this is an array); none by default. Inertias need a speed or an
            acceleration, which may be 0: without either they would count for nothing.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a torque on both ends, a speed in both units, a negative inertia, inertias
            without a speed or an acceleration.

    >>> float(Load(speed_rpm=1500.0).speed.round(3))
    157.08
    """

    end: Literal["drive", "output"]
    torque: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    inertias: FloatArray | None

    def __init__(
        self,
        *,
        drive_torque: ArrayLike | None = None,
        output_torque: ArrayLike | None = None,
        speed: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        inertias: ArrayLike | None = None,
        speed_rpm: ArrayLike | None = None,
    ) -> None:
        """Check the values and keep copies of their arrays."""
        exclusive(drive_torque=drive_torque, output_torque=output_torque)
        exclusive(speed=speed, speed_rpm=speed_rpm)
        end = "output" if drive_torque is None else "drive"
        torque = output_torque if drive_torque is None else drive_torque
        given_motion = (speed, speed_rpm, acceleration)
        if speed_rpm is not None:
            speed = as_float64("speed_rpm", speed_rpm) * _RAD_S_PER_RPM
        given = {"speed": speed, "acceleration": acceleration}
        values = {name: as_float64(name, x) for name, x in given.items() if x is not None}
        values["torque"] = as_float64(f"{end}_torque", 0.0 if torque is None else torque)
        inertial = None if inertias is None else _checked_inertias(inertias)
        if inertial is not None and not any(x is not None for x in given_motion):
            problem = "are given without a speed or an acceleration; inertias need one of them"
            raise ArgumentValueError("inertias", problem)
        zero = np.zeros(())
        self.__setstate__(
            {"end": end, "inertias": inertial, "speed": zero, "acceleration": zero, **values}
        )

    def inertias_by_shaft(self, joints: int) -> dict[int, FloatArray]:
        """Return the inertia of each shaft that has one, as a contiguous array."""
        if self.inertias is None:
            return {}
        per_shaft("inertias", self.inertias, joints + 1)
        columns = (np.array(self.inertias[..., shaft], order="C") for shaft in range(joints + 1))
        return {shaft: column for shaft, column in enumerate(columns) if np.any(column != 0.0)}

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Return the shape of each value, of the inertias without their last axis."""
        shapes = {name: getattr(self, name).shape for name in ("torque", "speed", "acceleration")}
        if self.inertias is not None:
            shapes["inertias"] = self.inertias.shape[:-1]
        return shapes

    def changed(self, change: Callable[[FloatArray, int], FloatArray]) -> Load:
        """Return the load with each array changed, which is given with how many axes are shafts."""
        values = {"speed": change(self.speed, 0), "acceleration": change(self.acceleration, 0)}
        if self.inertias is not None:
            values["inertias"] = change(self.inertias, 1)
        return Load(**values, **{f"{self.end}_torque": change(self.torque, 0)})

    def at_any_angle(self) -> Load:
        """Return the load of a batch of drivelines with an axis for the drive angles behind it."""
        return self.changed(lambda x, own: np.expand_dims(x, -1 - own) if x.ndim > own else x)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Keep copies of the arrays: what came in a message lies anywhere in it."""
        for name, value in state.items():
            kept = np.array(value) if isinstance(value, np.ndarray) else value
            object.__setattr__(self, name, kept)


def require_load(load: object) -> None:
    """Raise an error unless ``load`` is a ``Load``."""
    if not isinstance(load, Load):
        problem = f"is {load!r}; it must be a cardan.Load, as cardan.Load(output_torque=100)"
        raise ArgumentTypeError("load", problem)


def absorbing(drive_torque: FloatArray, torques: FloatArray, ratios: FloatArray) -> Load:
    """Return a load whose shafts absorb torques of either sign, ``(..., n + 1)``.

    Shafts at rest that are accelerated absorb the power ``I a r**2`` with their speed ratios ``r``.
    An acceleration of 1 rad/s² and inertias ``torque / r`` of either sign absorb what is given,
    whatever absorbs it in fact.
    """
    load = Load(drive_torque=drive_torque, acceleration=1.0)
    object.__setattr__(load, "inertias", np.asarray(torques / ratios))
    return load


def _checked_inertias(inertias: ArrayLike) -> FloatArray:
    array = as_float64("inertias", inertias)
    if array.ndim == 0:
        raise ArgumentValueError("inertias", "is one number; it needs one per shaft")
    check_elements("inertias", array, ~(array < 0.0), "; an inertia must not be negative")
    return array
