"""A drive of finite inertia: how far its speed varies where no torque holds it.

Unevenly turning shafts take kinetic energy from the drive and give it back twice a turn. Without a
torque the energy ``J w0²/2`` with ``J = I_0 + sum I_i r_i²`` stays the same, where ``r_i`` is the
speed ratio of shaft ``i``. So the speed of the drive goes as ``1/sqrt(J)``, exactly, whatever its
mean. D. Thoma, "Das Kräftespiel im Kreuzgelenk", Schweizerische Bauzeitung 75 (1920), asks that the
drive's inertia be so large that its speed counts as constant; this says how large that is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    not_negative,
    per_shaft,
    scalar_or_array,
    threads,
)
from cardan.arrays.errors import ArgumentValueError, check_elements
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class FreeRunning:
    """The speed of a drive that runs freely with its driveline; see ``Driveline.free_running``.

    Speeds are relative to the mean over time, ``2 pi`` over the time of a turn.

    Attributes:
        inertias: as given, in kg m², ``(..., n + 1)``.
        min_speed_ratio: the least speed of the drive over its mean, in the shape of batch and
            inertias.
        max_speed_ratio: the largest.
        variation: the difference of the two: the peak-to-peak variation of the drive's speed.
    """

    inertias: FloatArray
    min_speed_ratio: Any
    max_speed_ratio: Any
    variation: Any
    _line: Driveline = field(repr=False)
    _scaled: FloatArray = field(repr=False)
    _root: FloatArray = field(repr=False)

    def speed_ratio(self, angle: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the speed of the drive over its mean.

        Args:
            angle: drive angle in rad; broadcasts against batch and inertias.

        Raises:
            ValueError: shapes that do not broadcast.
        """
        return scalar_or_array(self._root / np.sqrt(self._felt(angle, acceleration=1.0)))

    def acceleration_ratio(self, angle: ArrayLike) -> Any:  # noqa: ANN401
        """Return the acceleration of the drive over the square of its mean speed.

        Args:
            angle: as for ``speed_ratio``, like the errors.
        """
        inertia, torque = self._felt(angle, acceleration=1.0), self._felt(angle, speed=1.0)
        return scalar_or_array(-(self._root**2) * torque / inertia**2)

    def time_per_turn(self, speed: ArrayLike, angle: ArrayLike = 0.0) -> Any:  # noqa: ANN401
        """Return the time of one turn in s.

        Args:
            speed: speed of the drive in rad/s at the drive angle.
            angle: as for ``speed_ratio``, like the errors.
        """
        mean = as_float64("speed", speed) / self.speed_ratio(angle)
        return scalar_or_array(np.asarray(math.tau / mean))

    def drive_inertia_for(self, variation: ArrayLike) -> Any:  # noqa: ANN401
        """Return the least inertia of shaft 0 in kg m² that keeps the variation within a figure.

        The other inertias stay as they are.

        Args:
            variation: peak-to-peak variation of the drive's speed over its mean; broadcasts against
                batch and inertias. It must be positive, other errors are as for ``speed_ratio``.
        """
        wanted = as_float64("variation", variation)
        check_elements("variation", wanted, wanted > 0.0, "; it must be positive")
        others = self.inertias.copy()
        others[..., 0] = 0.0
        others, exponents = _scaled(others)
        shape = np.broadcast_shapes(self._line.shape, others.shape[:-1])
        full = common_shape(free_running=shape, variation=wanted.shape)
        flat = np.broadcast_to(others, (*full, others.shape[-1])).ravel()
        each = np.broadcast_to(wanted, full).ravel()
        lines = self._line._lines
        least = _core.least_drive_inertias(lines, full, flat, each, threads.at_most(None))
        # Beyond the largest double it is infinite.
        with np.errstate(over="ignore"):
            return scalar_or_array(np.ldexp(least.reshape(full), exponents))

    def _felt(self, angle: ArrayLike, **motion: float) -> FloatArray:
        """Return the torque at the drive for this speed or acceleration, without any other."""
        angles = as_float64("angle", angle)
        shape = common_shape(driveline=np.shape(self._root), angle=angles.shape)
        load = Load(inertias=self._scaled, **motion)
        at = np.broadcast_to(angles, shape)
        return np.asarray(self._line.evaluate(at, "torque", shafts=0, load=load)["torque"])


def free_running(line: Driveline, inertias: ArrayLike) -> FreeRunning:
    """Return how the speed of the drive varies where no torque holds it.

    The kinetic energy of all shafts stays the same, so the speed of the drive goes as
    ``1/sqrt(I_0 + sum I_i r_i**2)`` with the speed ratios ``r_i``. A motor or a load changes
    this only as far as its torque varies within a turn.

    Args:
        inertias: moment of inertia of each shaft about its axis in kg m², with what turns with
            it, ``(..., n + 1)``; broadcasts against the batch. Shaft 0 is the drive.

    Raises:
        ValueError: not one inertia per shaft, a negative one, all of them 0, shapes that do
            not broadcast.

    >>> import cardan
    >>> rig = cardan.Driveline.from_bends([8.5], degrees=True)
    >>> round(float(rig.free_running([10.0, 1.0]).variation), 5)
    0.00201
    """
    line._geometry.check_ideal("free running is computed")
    array = not_negative("inertias", inertias)
    per_shaft("inertias", array, line.n_joints + 1)
    if not np.all(np.any(array > 0.0, axis=-1)):
        raise ArgumentValueError("inertias", "are all 0; at least one shaft needs an inertia")
    shape = common_shape(driveline=line.shape, inertias=array.shape[:-1])
    scaled, _ = _scaled(array)
    flat = np.broadcast_to(scaled, (*shape, scaled.shape[-1])).ravel()
    found = _core.free_drives(line._lines, shape, flat, threads.at_most(None))
    *speeds, root = (column.reshape(shape) for column in found)
    least, largest, variation = map(scalar_or_array, speeds)
    return FreeRunning(array.copy(), least, largest, variation, line, scaled, root)


def _scaled(inertias: FloatArray) -> tuple[FloatArray, NDArray[np.int32]]:
    """The inertias of each driveline over a power of two, so that the largest is from 0.5 to 1.

    Speeds follow from ratios of inertias; powers of inertias could leave the range of doubles.
    """
    exponents = np.frexp(np.max(inertias, axis=-1))[1]
    return np.ldexp(inertias, -exponents[..., np.newaxis]), exponents
