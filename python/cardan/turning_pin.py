"""The axes that turn with a shaft, in space.

A joint takes the direction ``w = exp(i a)`` of its driving pin to ``w - tan(b/2)**2 conj(w)`` (from
Thoma 4), a chain to ``A w + B conj(w)``. The direction counts from the normal of the joint's bend
plane for its driven pin, and from a quarter turn before it for its driving pin.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.geometry import Geometry

_Complex = NDArray[np.complex128]


class TurningPin(NamedTuple):
    """The pins of one shaft of a batch of drivelines, as functions of the drive angle.

    Attributes:
        along: the direction of the shaft, ``(..., 3)``.
        start: the direction of the pin at the angle 0 of ``w``, ``(..., 3)``, across the shaft.
        maps: ``A`` and ``B`` of the pin, each with the shape of the batch.
    """

    along: FloatArray
    start: FloatArray
    maps: tuple[_Complex, _Complex]

    def components(self, vector: NDArray[Any], turn: tuple[FloatArray, FloatArray]) -> list[Any]:
        """Return a vector, ``(..., 3)``, along the shaft, along its pin and across both.

        Args:
            vector: the vector at each sample, along the axes of space.
            turn: cosine and sine of the drive angle at each sample.
        """
        (cosine, sine), (a, b) = turn, self.maps
        re = (a + b).real * cosine - (a - b).imag * sine
        im = (a + b).imag * cosine + (a - b).real * sine
        length = np.hypot(re, im)
        re, im = re / length, im / length
        across = np.cross(self.along, self.start)
        x, y, z = (_dot(vector, axis) for axis in (self.along, self.start, across))
        return [x, re * y + im * z, re * z - im * y]


def pin_of(own: Geometry, shaft: int) -> TurningPin:
    """Return the pins at the input side of a shaft; of shaft 0, at its output side."""
    along, normal = own.directions[..., shaft, :], own.normals[..., max(shaft - 1, 0), :]
    a = np.ones(own.shape, np.complex128)
    b = np.zeros(own.shape, np.complex128)
    if shaft == 0:
        return TurningPin(along, np.cross(normal, along), (a, b))
    for joint in range(shaft):
        if joint:
            between = own.phases[..., joint - 1] - own.twists[..., joint - 1]
            turn = 1j * np.exp(1j * between)
            a, b = turn * a, turn * b
        k = np.tan(0.5 * own.bends[..., joint]) ** 2
        a, b = a - k * np.conj(b), b - k * np.conj(a)
    return TurningPin(along, normal, (a, b))


def _dot(vector: NDArray[Any], axis: FloatArray) -> Any:  # noqa: ANN401 - an array or a scalar
    return sum(vector[..., i] * axis[..., i] for i in range(3))
