"""Yoke settings in the words of a workshop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64

VIEW = "looking from the drive towards the output"
"""View for senses of rotation: with the power flow, whichever way the vehicle drives."""

ARROW = "drive → output"
"""The direction of view as an arrow."""

SAME_YOKE = "A yoke looks the same every 180°"
"""Why a setting can be given in both senses."""


_IN_PLACE = {"none": "in one plane", "unknown": "not a number"}


@dataclass(frozen=True, eq=False)
class Turn:
    """A turn of one yoke against another, as set on a bench.

    A yoke looks the same every 180°, so no turn is larger than 90°, and each can be made in the
    opposite sense as well: 8° counter-clockwise is 172° clockwise.

    Attributes:
        angle: size of the turn in rad, within [0, pi/2].
        sense: ``"clockwise"`` or ``"counter-clockwise"``, looking from the drive towards the
            output; ``"none"`` for no turn at all, ``"unknown"`` for one that is not finite.
    """

    angle: FloatArray
    sense: NDArray[np.str_]

    def __str__(self) -> str:
        """Return the turn in both senses as text, one line per turn."""
        pairs = zip(np.degrees(self.angle).flat, self.sense.flat, strict=True)
        return "\n".join(
            _IN_PLACE.get(str(sense)) or f"{both_senses(angle, str(sense))}, {VIEW}"
            for angle, sense in pairs
        )


def turn(angle: ArrayLike) -> Turn:
    """Return the turn that a phase or twist means on the bench.

    Args:
        angle: in rad, right-handed about the direction of power flow, any shape. Looking from the
            drive towards the output a positive angle is clockwise.

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


def both_senses(degrees: float, sense: str, *, decimals: int = 2) -> str:
    """Return a turn in degrees as words, and the same turn made in the opposite sense.

    Args:
        degrees: size of the turn, at most 180.
        sense: ``"clockwise"`` or ``"counter-clockwise"``.
        decimals: of both.
    """
    opposite = {"clockwise": "counter-clockwise", "counter-clockwise": "clockwise"}[sense]
    shown = f"{degrees:.{decimals}f}"
    return f"{shown}° {sense} = {180.0 - float(shown):.{decimals}f}° {opposite}"
