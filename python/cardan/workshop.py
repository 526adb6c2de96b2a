"""Yoke settings in the words of a workshop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64

VIEW = "looking along the travel"
"""From where a sense of rotation is seen: with the power flow, from the drive to the output."""


_IN_PLACE = {"none": "in one plane", "unknown": "not a number"}


@dataclass(frozen=True, eq=False)
class Turn:
    """A turn of one yoke against another, as set on a bench.

    A yoke turned by 180° is the same yoke, so no turn is larger than 90°.

    Attributes:
        angle: size of the turn in rad, within [0, pi/2].
        sense: ``"clockwise"`` or ``"counter-clockwise"``, looking along the travel; ``"none"``
            for no turn at all, ``"unknown"`` for one that is not finite.
    """

    angle: FloatArray
    sense: NDArray[np.str_]

    def __str__(self) -> str:
        """Say it in words, one line per turn."""
        pairs = zip(np.degrees(self.angle).flat, self.sense.flat, strict=True)
        return "\n".join(
            _IN_PLACE.get(str(sense), f"{angle:.2f}° {sense}, {VIEW}") for angle, sense in pairs
        )


def turn(angle: ArrayLike) -> Turn:
    """Return the turn that a phase or twist means on the bench.

    Args:
        angle: in rad, right-handed about the direction of travel, any shape. Looking along the
            travel a positive angle is clockwise.

    Raises:
        TypeError: values that are not real numbers.
    """
    turned = as_float64("angle", angle)
    finite = np.isfinite(turned)
    turned = np.where(finite, turned, np.nan)
    wrapped = turned - np.pi * np.round(turned / np.pi)
    senses = np.array(["counter-clockwise", "none", "clockwise"])
    sense = senses[np.sign(np.nan_to_num(wrapped)).astype(int) + 1]
    return Turn(np.abs(wrapped), np.where(finite, sense, "unknown"))
