"""One order of the motion of a shaft as a quantity: of its angle error, or of its acceleration.

With the complex amplitude ``c`` of order ``m`` of the angle error, a part of the shaft's rotation
is ``Re c exp(i m a)``. At a steady speed of the drive its acceleration has the amplitude ``(m
speed)**2 |c|``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from cardan.arrays import ComplexArray, FloatArray

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Ordered: TypeAlias = Literal["angle_error", "acceleration"]
ORDERED: tuple[Ordered, ...] = get_args(Ordered)
"""What has orders as quantities."""

PATTERN = f"({'|'.join(ORDERED)})_order_([1-9][0-9]?)"
"""Regular expression of their names."""

FIRST = tuple(f"{of}_order_1" for of in ORDERED)
"""The names of order 1."""


@dataclass(frozen=True)
class OrderQuantity:
    """The amplitude of one order of the motion of a shaft, of angles in rad."""

    of: Ordered  # the second in rad/s² at the speed of the drive
    order: int  # of the drive's rotation

    @property
    def unit(self) -> str:
        """SI unit."""
        return "rad" if self.of == "angle_error" else "rad/s²"

    @property
    def label(self) -> str:
        """What to call it in words: ``order 1 of the acceleration``."""
        return f"order {self.order} of the {self.of.replace('_', ' ')}"

    @property
    def needs_speed(self) -> bool:
        """Whether it is an acceleration, which grows with the square of the drive speed."""
        return self.of == "acceleration"

    def at(self, modulus: Any, speed: float) -> Any:  # noqa: ANN401 - a number or an array
        """Return the quantity of an amplitude of the angle error, at a drive speed in rad/s."""
        return modulus * (self.order * speed) ** 2 if self.needs_speed else modulus


def order_quantity(name: str) -> OrderQuantity | None:
    """Return the order of a name; ``None`` if it is not one.

    >>> order_quantity("acceleration_order_1").order
    1
    """
    found = re.fullmatch(PATTERN, name)
    if found is None:
        return None
    of = next(known for known in ORDERED if known == found[1])
    return OrderQuantity(of, int(found[2]))


def order_amplitude(line: Driveline, order: int, shaft: int) -> ComplexArray:
    """Return the complex amplitude of an order of the angle error in rad, one per driveline.

    The speed ratio is 1 and the derivative of the angle error. Its samples do not need the mean
    over the turn, which takes longest of joints as built.
    """
    found = line.harmonics([order], shaft, outputs="speed_ratio")
    return np.asarray(found.complex_amplitude["speed_ratio"][..., 0] / (1j * order))


def farthest_signs(middle: complex, vectors: ComplexArray) -> FloatArray:
    """Return the signs of the vectors whose sum with the middle is farthest from zero.

    Seen from a direction, the farthest corner adds each vector with the sign of its part along the
    direction. Signs change only where a direction is at a right angle to a vector.
    """
    known = vectors[vectors != 0.0]
    if not len(known):
        return np.ones(len(vectors))
    turned = np.unique((np.angle(known) + 0.5 * np.pi) % np.pi)
    between = turned + 0.5 * (np.roll(turned, -1) - turned + np.pi * (turned == turned[-1]))
    directions = np.exp(1j * np.concatenate([between, between + np.pi]))
    signs = np.where(np.outer(directions.conj(), vectors).real < 0.0, -1.0, 1.0)
    return np.asarray(signs[np.argmax(np.abs(middle + signs @ vectors))])
