"""The periodic motion at constant drive speed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.arrays.indices import Items
from cardan.evaluation.request import Axes, Reduction
from cardan.evaluation.result import Result
from cardan.torsion.joint_loads import evaluated
from cardan.torsion.results import ComplexArray, Searched


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
    _system: Any = field(repr=False)  # the TorsionalSystem
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
            samples: number of equally spaced drive angles over half a turn, at least 1.
            outputs: names from ``cardan.OUTPUTS`` that need a load, tilts or pins.
            shafts: shafts for the outputs per shaft: an index, a slice or a list; default: the last
                shaft.
            joints: joints for the outputs per joint; default: all.
            reduce: as of ``Driveline.evaluate``, over the samples.
            workers: largest number of threads.
            axes: axes of vectors, as of ``Driveline.evaluate``.

        Returns:
            each output as ``([items,] ..., samples [, 3])``; NaN where there is no orbit.

        Raises:
            IndexError: a shaft or joint that does not exist.
            TypeError: samples or indices that are not integers.
            ValueError: no samples, an unknown output or one of motion, forces of a driveline that
                is not determinate.

        >>> import cardan
        >>> system = cardan.TorsionalSystem(
        ...     cardan.Driveline.from_bends([20], degrees=True),
        ...     inertias=[[0, 0], [0, 0.05]],
        ...     stiffnesses=[float("inf"), 8000],
        ...     damping_ratios=0.02,
        ... )
        >>> steady = system.steady([50.0, 200.0])
        >>> steady.evaluate(256, "bending_driven", reduce="max").bending_driven.round(1)
        array([[   4.8, 2264.7]])
        """
        system = self._system
        orbit = system.orbit(self._speed, samples, tolerance=self._tolerance, workers=workers)
        items: dict[str, Any] = {"shafts": shafts, "joints": joints, "axes": axes}
        return evaluated(system, orbit, outputs, reduce, workers, **items)
