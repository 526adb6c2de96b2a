"""The arrays that make drivelines, and how they are rearranged."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, finite
from cardan.arrays.errors import ArgumentValueError, Place, check_shape


class Geometry(NamedTuple):
    """What makes a batch of drivelines: angles in rad and unit vectors, as of ``Driveline``."""

    bends: FloatArray
    twists: FloatArray
    phases: FloatArray
    directions: FloatArray
    normals: FloatArray
    lengths: FloatArray  # (..., n + 1), or (..., 0) if unknown
    positions: FloatArray  # of each bearing along its shaft, (..., m), in the lengths' unit
    deviations: FloatArray  # (..., n, 3), or (..., 0, 3) if all joints are ideal
    bearings: tuple[int, ...] = ()  # the shaft of each
    has_points: bool = False  # whether they were made from points, with these lengths between them

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""
        return self.bends.shape[:-1]

    @property
    def n_joints(self) -> int:
        """Number of joints of each driveline."""
        n: int = self.bends.shape[-1]
        return n

    @property
    def is_as_built(self) -> bool:
        """Whether the joints deviate from their drawing."""
        return bool(self.deviations.shape[-2])

    def as_built(self) -> Geometry:
        """Give ideal joints deviations of 0."""
        if self.is_as_built:
            return self
        return self._replace(deviations=np.zeros((*self.bends.shape, 3)))

    def check_ideal(self, what: str, instead: str = "") -> None:
        """Raise a ``ValueError`` if the joints deviate; ``what`` has its verb."""
        if self.is_as_built:
            hint = f"; {instead}" if instead else ""
            problem = f"has joints with deviations; {what} for ideal joints only{hint} "
            problem += "(with_deviations() without arguments makes them ideal)"
            raise ArgumentValueError("driveline", problem)

    @property
    def arrays(self) -> tuple[FloatArray, ...]:
        """The arrays, each with the axes of the batch first."""
        return self[:-2]

    def flat(self) -> list[FloatArray]:
        """Return each array as one run of elements, which the native module takes."""
        return [array.reshape(-1) for array in self.arrays]

    def each(self, change: Callable[[FloatArray], FloatArray]) -> Geometry:
        """Return the geometry with every array changed."""
        return Geometry._make([*map(change, self.arrays), self.bearings, self.has_points])

    def batched(self, shape: tuple[int, ...]) -> Geometry:
        """Broadcast to a batch of that shape."""
        batch = len(self.shape)
        return self.each(lambda array: spread(array, shape, array.ndim - batch))

    def reshaped(self, shape: tuple[int, ...]) -> Geometry:
        """Give the batch another shape as ``Driveline.reshape`` does."""
        batch, size = len(self.shape), math.prod(self.shape)
        try:
            # One of the sizes may be left open.
            full = np.broadcast_to(np.empty(()), size).reshape(shape).shape
        except ValueError:
            problem = f"is {shape}, which has no room for just {size} drivelines"
            raise ArgumentValueError("shape", problem) from None
        return self.each(lambda array: np.array(array).reshape(*full, *array.shape[batch:]))


def place_in(own: tuple[int, ...], shape: tuple[int, ...], place: Place) -> Place:
    """Return the place in an array with the batch ``own``, which was spread to another batch."""
    before = len(shape) - len(own)
    batch = (0 if size == 1 else i for size, i in zip(own, place[before:], strict=False))
    return (*batch, *place[len(shape) :])


def spread(array: FloatArray, shape: tuple[int, ...], own: int) -> FloatArray:
    """The array for a batch of that shape; its last ``own`` axes belong to one driveline."""
    full = (*shape, *array.shape[array.ndim - own :])
    return array if full == array.shape else np.ascontiguousarray(np.broadcast_to(array, full))


def between_joints(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Twists or phases as ``(..., n - 1)``; one number stands for all shafts."""
    array = as_float64(name, value)
    between = max(n - 1, 0)
    if array.ndim == 0:
        array = np.full(between, array)
    check_shape(name, array, array.shape[-1] == between, f"{n} joints need (..., {between})")
    finite(name, array)
    return np.radians(array) if degrees else array
