"""The quantities by which a driveline is judged, toleranced and optimised, each named once.

Those of the motion are here. An output with its shaft, joint or bearing and a reduction of its
samples is one as well (``cardan.reduced_quantities``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import numpy as np

from cardan.arrays.errors import nearest
from cardan.design.order_quantities import order_quantity
from cardan.design.reduced_quantities import reduced_quantity
from cardan.evaluation.outputs import OUTPUTS

Amplitude: TypeAlias = Literal["last", "driving", "coasting"]
"""``q`` of a shaft; the sum of ``q`` over the intermediate shafts, driven from either end."""


@dataclass(frozen=True)
class MotionQuantity:
    """A quantity of the motion, which grows with the magnitude of an amplitude."""

    name: str  # by which to request it
    label: str  # what to call it in words
    unit: str  # SI; "1" for a ratio
    amplitudes: tuple[Amplitude, ...]  # of which it is a function; the largest magnitude counts
    ratio: Callable[[Any], Any]  # the function; of an excitation at a drive speed of 1 rad/s
    limit: str  # the key of ``Limits.figures`` that limits it
    largest: float = math.inf  # what it stays below

    @property
    def needs_speed(self) -> bool:
        """Whether it is an acceleration, which grows with the square of the drive speed."""
        return self.unit == "rad/s²"

    @property
    def of_last(self) -> bool:
        """Whether it is a function of ``q`` of a single shaft."""
        return self.amplitudes == ("last",)

    def at(self, modulus: Any, speed: float) -> Any:  # noqa: ANN401 - a number or an array
        """Return the quantity of a magnitude, at a speed of the drive in rad/s."""
        return self.ratio(modulus) * speed**2 if self.needs_speed else self.ratio(modulus)


def modulus_of_bend(bend: Any) -> Any:  # noqa: ANN401 - a number or an array
    """Return ``|q|`` of a joint with this bend in rad."""
    return np.tan(0.5 * bend) ** 2


def _bend(k: Any) -> Any:  # noqa: ANN401
    return 2.0 * np.arctan(np.sqrt(k))


def _non_uniformity(k: Any) -> Any:  # noqa: ANN401
    """``(1 + k)/(1 - k) - (1 - k)/(1 + k)``, with ``cos(bend) = (1 - k)/(1 + k)``."""
    return 4.0 * k / ((1.0 - k) * (1.0 + k))


def _torsional(k: Any) -> Any:  # noqa: ANN401
    """Largest acceleration of a shaft: ``(1 - k²) 4 k sin x/(1 - 2 k cos x + k²)²`` at its peak."""
    square = 1.0 + k * k
    cosine = 8.0 * k / (square + np.sqrt(square * square + 32.0 * k * k))
    sine = np.sqrt(1.0 - cosine * cosine)
    return (1.0 - k * k) * 4.0 * k * sine / np.square(square - 2.0 * k * cosine)


def _second_order(k: Any) -> Any:  # noqa: ANN401
    """Second-order amplitude of the acceleration ``Re(4 i q u g²)`` of one or more shafts."""
    return 4.0 * k


_BEND, _TORSIONAL = "equivalent_bend_deg", "torsional_excitation_rad_s2"
_LAST: tuple[Amplitude, ...] = ("last",)
_RIGHT_ANGLE = math.pi / 2.0


def _inertia(name: str, label: str, *amplitudes: Amplitude) -> MotionQuantity:
    limit = "inertia_excitation_rad_s2"
    return MotionQuantity(name, label, "rad/s²", amplitudes, _second_order, limit)


_EVERY = (
    MotionQuantity("equivalent_bend", "equivalent bend", "rad", _LAST, _bend, _BEND, _RIGHT_ANGLE),
    MotionQuantity("non_uniformity", "non-uniformity", "1", _LAST, _non_uniformity, _BEND),
    MotionQuantity(
        "max_angle_error", "largest angle error", "rad", _LAST, np.arcsin, _BEND, _RIGHT_ANGLE
    ),
    MotionQuantity(
        "torsional_excitation", "torsional excitation", "rad/s²", _LAST, _torsional, _TORSIONAL
    ),
    _inertia("inertia_excitation", "inertia excitation", "driving", "coasting"),
    _inertia("inertia_excitation_driving", "inertia excitation, driving", "driving"),
    _inertia("inertia_excitation_coasting", "inertia excitation, coasting", "coasting"),
)

MOTION_QUANTITIES: Mapping[str, MotionQuantity] = MappingProxyType(
    {quantity.name: quantity for quantity in _EVERY}
)
"""The quantities that need neither samples nor a load, by name."""


def nearest_quantity(name: str, known: Iterable[str] = MOTION_QUANTITIES) -> str:
    """Say which quantity is meant by a name, or which there are besides reduced outputs."""
    return (
        f"{nearest(name, known)} (an output has the number of its shaft, joint or bearing and its "
        "reduction, as 'support_moment_1_peak')"
    )


def label(name: str) -> str:
    """Return a quantity or an output in words."""
    if name in MOTION_QUANTITIES:
        return MOTION_QUANTITIES[name].label
    own = reduced_quantity(name) or order_quantity(name)
    if own:
        return own.label
    return OUTPUTS[name].label if name in OUTPUTS else name.replace("_", " ")
