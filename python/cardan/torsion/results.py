"""Results of torsional systems: what a search found, orbit, steady state and stability.

Moments and forces of joints and bearings follow from the torques of the periodic motion. At each
instant the joints are in the position of a rigid driveline whose phases contain the twists of the
compliant shafts. The balance of torques along the shafts, from the load to the drive, gives the
torque that enters each shaft: the dynamic torque. What a shaft takes of it, its inertias accelerate
and its spring stores. The rigid driveline is evaluated under these torques, so moments and forces
are those of the same equations as without vibration.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import ComplexArray, FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import Items
from cardan.evaluation.load import absorbing
from cardan.evaluation.outputs import OUTPUTS, checked
from cardan.evaluation.reductions import Reduction
from cardan.evaluation.request import Axes
from cardan.evaluation.result import Result

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# The position of the crosses is that of rigid shafts with these twists; their rates are not.
_POSITIONS = ("tilt_driving", "tilt_driven", "driving_pin", "driven_pin")

# The numbers by which the native module counts failures.
_REASONS = (
    "",
    "the speed is not a positive finite number",
    "no periodic orbit was found from rigid shafts, even rotation or growing bends",
    "the orbit needs more points than are allowed",
)


@dataclass(frozen=True, eq=False)
class Searched:
    """Result of a search for periodic orbits; ``...`` is the shape of systems and speeds.

    Attributes:
        found: whether there is an orbit, ``(...)``. Where there is none, the results are NaN.
    """

    found: NDArray[np.bool_]
    _failures: NDArray[np.uint8]

    @property
    def reasons(self) -> NDArray[np.str_]:
        """Why there is no orbit, ``(...)``; empty where there is one."""
        return np.array(_REASONS)[self._failures]


def small(multipliers: NDArray[Any]) -> NDArray[np.bool_]:
    """Return whether no multiplier of the last axis is larger than 1 by more than rounding."""
    return np.asarray((np.abs(multipliers) <= 1.0 + 1e-9).all(axis=-1))


@dataclass(frozen=True, eq=False)
class Orbit(Searched):
    """One period at equally spaced mean angles of the drive.

    Attributes:
        drive_angle: mean speed times time in rad, ``(samples,)``, from 0 up to but not including
            the period.
        angle_error: angle of every shaft end relative to that in rad, input end before output
            end, ``(n + 1, 2, ..., samples)``. Without load and vibration its mean is 0.
        speed: speed of every shaft end in rad/s, ``(n + 1, 2, ..., samples)``.
        acceleration: acceleration of every shaft end in rad/s², ``(n + 1, 2, ..., samples)``.
        drive_torque: torque of the drive in N m beside harmonic torques, ``(..., samples)``.
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
        multipliers: Floquet multipliers of a period, largest modulus first, ``(..., 2 *
            compliant)``; one more of a free drive, without the multiplier 1 of a shift in time.
        drive_torque_slope: derivative of mean torque of a free drive with respect to mean speed in
            N m s/rad, ``(...)``; NaN of a held one.
        speed_multiplier: the multiplier with which the speed of the whole driveline returns,
            ``(...)``; NaN of a held drive.
        drive_slope: of the system.
        period_turns: of the system.
    """

    multipliers: ComplexArray
    drive_torque_slope: FloatArray
    speed_multiplier: FloatArray
    drive_slope: float
    period_turns: float

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether no multiplier is larger than 1 + 1e-9, ``(...)``; false without an orbit.

        A free drive whose torque is not said to fall with its speed is governed: its
        ``speed_multiplier`` does not count.
        """
        return np.asarray(self.found & _returns(self))

    @property
    def needed_slope(self) -> FloatArray:
        """How much the torque of the drive must at least lose with its speed in N m s/rad.

        ``(...)``; 0 where a constant torque will do. NaN of a held drive.
        """
        return np.maximum(-self.drive_torque_slope, 0.0)


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
        multipliers: Floquet multipliers, ``(..., orbits, 2 * compliant)``; one more of a free
            drive.
        speed_multiplier: the one with which the speed of the whole driveline returns, ``(...,
            orbits)``; NaN of a held drive.
        drive_slope: of the system.
    """

    count: NDArray[np.int64]
    torque_mean: FloatArray
    torque_min: FloatArray
    torque_max: FloatArray
    multipliers: ComplexArray
    speed_multiplier: FloatArray
    drive_slope: float

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether it is stable, as in ``Stability``, ``(..., orbits)``; false where missing."""
        return _returns(self)


def _returns(found: Stability | Coexisting) -> NDArray[np.bool_]:
    """Whether no multiplier that counts is larger than 1 + 1e-9."""
    sizes = np.abs(found.multipliers)
    if found.drive_slope == 0.0:
        of_speed = found.multipliers == found.speed_multiplier[..., np.newaxis]
        sizes = np.where(of_speed, 0.0, sizes)
    return small(sizes)


@dataclass(frozen=True, eq=False)
class SteadyState(Searched):
    """The periodic motion at mean drive speed.

    A quantity is ``mean + Re(sum(orders * exp(1j * m * angle)))`` with the mean angle of the drive,
    its mean speed times time, and the order ``m``, so the modulus of an order is its peak
    amplitude. Joints alone excite even orders.

    Attributes:
        torque_mean: mean torque of each compliant shaft in N m, ``(compliant, ...)``.
        torque_min: least torque, the true extremum between samples.
        torque_max: largest torque.
        drive_torque_mean: mean torque of the drive in N m, ``(...)``: the load and what the
            dampings take, by the balance of energy.
        drive_speed_min: least speed of the drive in rad/s, ``(...)``.
        drive_speed_max: largest speed of the drive.
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
    drive_torque_mean: FloatArray
    drive_speed_min: FloatArray
    drive_speed_max: FloatArray
    torque_orders: ComplexArray
    angle_orders: ComplexArray
    speed_orders: ComplexArray
    orders: FloatArray
    compliant: tuple[int, ...]
    _system: TorsionalSystem = field(repr=False)
    _speed: FloatArray = field(repr=False)
    _tolerance: float = field(repr=False)

    def evaluate(
        self,
        samples: SupportsIndex,
        outputs: str | Iterable[str] = ("torque", "support_moment"),
        *,
        shafts: Items = None,
        joints: Items = None,
        reduce: Reduction | None = None,
        workers: SupportsIndex | None = None,
        axes: Axes = "space",
    ) -> Result:
        """Evaluate moments and forces of joints and bearings under the dynamic torque.

        The torques are those of the periodic motion, with all inertias, springs and dampings, so
        supports and bearings show the resonances. The joints are in the positions of this motion.
        The ``torque`` of a shaft is that behind the joint before it.

        Args:
            samples: number of equally spaced mean drive angles over one period, at least 1.
            outputs: names from ``cardan.OUTPUTS`` that need a load, tilts or pins.
            shafts: as of ``Driveline.evaluate``, like all following arguments.

        Returns:
            each output as ``([items,] ..., samples [, 3])``; NaN where there is no orbit.

        Raises:
            TypeError: samples or indices that are not integers.
            ValueError: no samples, an unknown output or one of motion, forces of a driveline that
                is not determinate.

        >>> import cardan
        >>> line = cardan.Driveline.from_bends([20], degrees=True)
        >>> own = {"inertias": [[0, 0], [0, 0.05]], "stiffnesses": [float("inf"), 8000]}
        >>> system = cardan.TorsionalSystem(line, damping_ratios=0.02, **own)
        >>> steady = system.steady([50.0, 200.0])
        >>> steady.evaluate(256, "bending_driven", reduce="max").bending_driven.round(1)
        array([[   4.8, 2264.7]])
        """
        system = self._system
        names = checked(outputs)
        for i, name in enumerate(names):
            if not (OUTPUTS[name].needs_load or name in _POSITIONS):
                has = "orbit() has that of compliant shafts"
                problem = f"is {name!r}, a motion of rigid shafts; {has}"
                raise ArgumentValueError("outputs", problem, (i,))
        orbit = system.orbit(self._speed, samples, tolerance=self._tolerance, workers=workers)
        options: dict[str, Any] = {"workers": workers}
        line, n = system.line, system.line.n_joints
        found = orbit.found[..., np.newaxis]
        error = np.where(found, orbit.angle_error, 0.0)
        twists = np.moveaxis(error[1:n, 1] - error[1:n, 0], 0, -1)
        batch = line.reshape(*line.shape, 1) if line.shape else line
        rigid = batch.with_phases(batch.phases + twists)
        angle = orbit.drive_angle + error[0, 1]
        motion = rigid.evaluate(angle, "speed_ratio", shafts=slice(None), **options)
        ratios = np.moveaxis(motion.speed_ratio, 0, -1)
        entering, absorbed = _torques(system, orbit, ratios)
        result = rigid.evaluate(
            np.where(found, angle, np.nan),
            names,
            shafts=shafts,
            joints=joints,
            load=absorbing(entering, absorbed, ratios),
            reduce=reduce,
            axes=axes,
            **options,
        )
        assert result._labels is not None, "an evaluation has labels"
        own = found.shape if orbit.found.ndim else ()
        labels = (*result._labels[:2], own, reduce, result._labels[4])
        return Result(dict(result), labels, orbit.drive_angle)


def _torques(
    system: TorsionalSystem, orbit: Orbit, ratios: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the torque that enters shaft 0, and what each shaft absorbs, ``(..., n + 1)``."""
    last = ratios.shape[-1] - 1
    # Dimensions of batch and samples, to which the parameters broadcast.
    inertias = system.inertias[..., np.newaxis, :, :]
    inertial = np.moveaxis(orbit.acceleration, (0, 1), (-2, -1)) * inertias
    of_springs = dict(zip(orbit.compliant, orbit.torque, strict=True))
    loss = system.load_damping[..., np.newaxis] * orbit.speed[last, 1]
    entering = leaving = system.load_torque[..., np.newaxis] + loss
    absorbed = np.empty(inertial.shape[:-1])
    for shaft in range(last, -1, -1):
        if shaft in of_springs:
            entering = of_springs[shaft] + inertial[..., shaft, 0]
        else:
            entering = leaving + inertial[..., shaft, :].sum(axis=-1)
        absorbed[..., shaft] = entering - leaving
        if shaft:
            leaving = entering * ratios[..., shaft] / ratios[..., shaft - 1]
    return entering, absorbed
