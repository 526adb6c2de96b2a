"""What tolerances are asked for: figures of the complex number ``q``, and reduced outputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from cardan.arrays import FloatArray
from cardan.tolerances.chain import (
    ComplexArray,
    Deviations,
    Nominal,
    joints_and_turns,
    q_of,
    reversed_deviations,
)

Amplitude: TypeAlias = Literal["last", "driving", "coasting"]
"""``q`` of the shaft; the sum of ``q`` over the intermediate shafts, driven from either end."""


def amplitude(
    kind: Amplitude, nominal: Nominal, deviations: Deviations, shaft: int
) -> ComplexArray:
    """Return the complex number of which a figure is a function of the magnitude.

    Args:
        kind: which one.
        nominal: the driveline as drawn.
        deviations: by how much it deviates in each sample.
        shaft: the shaft of ``"last"``, at least 1.
    """
    if kind == "coasting":
        deviations, nominal = reversed_deviations(nominal, deviations), nominal.reversed()
    joints, turns = joints_and_turns(nominal, deviations)
    if kind == "last":
        return q_of(joints[:shaft], turns[:shaft])
    total: Any = 0j
    for behind in range(1, nominal.n_joints):
        total = total + q_of(joints[:behind], turns[:behind])
    return np.asarray(total)


@dataclass(frozen=True)
class Figure:
    """A figure that grows with the magnitude of an amplitude.

    Attributes:
        name: what it is.
        unit: its SI unit.
        amplitude: of which complex number.
        of_modulus: the figure, from the magnitude and the speed of the drive in rad/s.
        needs_speed: whether the speed matters.
        default_limit: what the catalogues permit, if they do.
    """

    name: str
    unit: str
    amplitude: Amplitude
    of_modulus: Callable[[FloatArray, float], FloatArray]
    needs_speed: bool = False
    default_limit: float | None = None


def _bend(k: FloatArray, _speed: float = 0.0) -> FloatArray:
    return 2.0 * np.arctan(np.sqrt(k))


def _non_uniformity(k: FloatArray, _speed: float = 0.0) -> FloatArray:
    return 4.0 * k / ((1.0 - k) * (1.0 + k))


def _max_angle_error(k: FloatArray, _speed: float = 0.0) -> FloatArray:
    return np.arcsin(k)


def _torsional(k: FloatArray, speed: float) -> FloatArray:
    """Largest acceleration of a shaft: ``(1 - k²) 4 k sin x/(1 - 2 k cos x + k²)²`` at its peak."""
    square = 1.0 + k * k
    cosine = 8.0 * k / (square + np.sqrt(square * square + 32.0 * k * k))
    sine = np.sqrt(1.0 - cosine * cosine)
    peak = (1.0 - k * k) * 4.0 * k * sine / np.square(square - 2.0 * k * cosine)
    return np.asarray(speed**2 * peak)


def _inertia(total: FloatArray, speed: float) -> FloatArray:
    return 4.0 * speed**2 * total


# The limit of 3° of the catalogues (double joint, 6.4) in each figure that the bend determines.
_K_LIMIT = np.asarray(math.tan(math.radians(1.5)) ** 2)

FIGURES: Mapping[str, Figure] = {
    figure.name: figure
    for figure in (
        Figure("equivalent_bend", "rad", "last", _bend, default_limit=math.radians(3.0)),
        Figure(
            "non_uniformity",
            "1",
            "last",
            _non_uniformity,
            default_limit=float(_non_uniformity(_K_LIMIT)),
        ),
        Figure(
            "max_angle_error",
            "rad",
            "last",
            _max_angle_error,
            default_limit=float(_max_angle_error(_K_LIMIT)),
        ),
        Figure("torsional_excitation", "rad/s²", "last", _torsional, needs_speed=True),
        Figure("inertia_excitation_driving", "rad/s²", "driving", _inertia, needs_speed=True),
        Figure("inertia_excitation_coasting", "rad/s²", "coasting", _inertia, needs_speed=True),
    )
}
"""The figures that a check of a driveline knows, by name."""
