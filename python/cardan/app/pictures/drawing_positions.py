"""Where shafts and bearings are, in drawings of a driveline."""

from __future__ import annotations

import numpy as np

from cardan.app.scene.language.units import LengthUnit
from cardan.arrays import FloatArray
from cardan.driveline import Driveline


def shaft_lengths(line: Driveline) -> FloatArray:
    """Return the length of every shaft of one driveline, ``(n + 1,)``; all are 1 if not known."""
    lengths = line._geometry.lengths
    return lengths if lengths.shape[-1] else np.ones(line.n_joints + 1)


def length_text(length: float, unit: LengthUnit) -> str:
    """Return a length in m as a drawing gives it, to four digits.

    >>> length_text(1.30019, "mm"), length_text(12.3456, "m")
    ('1300 mm', '12.35 m')
    """
    value = {"mm": 1e3, "m": 1.0}[unit] * length
    return f"{float(f'{value:.4g}'):.10g} {unit}"


def bearing_places(line: Driveline, points: FloatArray) -> FloatArray:
    """Return the bearings of a driveline that is drawn at these points, ``(..., b, 3)``.

    A bearing keeps its share of the length of its shaft.

    Args:
        line: one driveline.
        points: ends and joint centres, ``(..., n + 2, 3)``, in any unit.
    """
    lengths = shaft_lengths(line)
    places = np.empty((*points.shape[:-2], line.n_bearings, 3))
    for bearing, (shaft, position) in enumerate(line.bearings):
        first, last = points[..., shaft, :], points[..., shaft + 1, :]
        places[..., bearing, :] = first + position / lengths[shaft] * (last - first)
    return places
