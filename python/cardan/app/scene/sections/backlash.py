"""What a scene says of the play in its joints and of the stiffness of their crosses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError

OF_PLAY: Mapping[str, Key] = {
    "play_mm": Key(
        kinds.TOLERANCES,
        "radial play of a pin in its bearing at arm_mm, from the middle to either side",
    ),
    "stiffness_Nm_per_rad": Key(
        kinds.POSITIVES,
        "with play_mm: moment about the normal of the cross per angle between its pins; default: "
        "rigid",
    ),
}
"""The keys of [joints] for play and wind-up."""


@dataclass(frozen=True, eq=False)
class JointPlay:
    """Play of the joints, ``(n,)`` each.

    Attributes:
        radial: play of the pins in m.
        arm: of the joints in m.
        stiffness: of the crosses in N m/rad; ``None`` if they are rigid.
    """

    radial: FloatArray
    arm: FloatArray
    stiffness: FloatArray | None


def play_of(values: Mapping[str, Any], n: int, arms: FloatArray | None) -> JointPlay | None:
    """Return the play that [joints] gives; ``None`` without.

    Args:
        values: of the section, by key.
        n: number of joints.
        arms: of the joints in m, if they are known.

    Raises:
        ValueError: lists that do not have one value per joint, play without an arm.
    """
    if "play_mm" not in values:
        return None
    for key in OF_PLAY:
        given = values.get(key)
        if isinstance(given, list) and len(given) != n:
            raise ArgumentValueError(key, f"has length {len(given)}; it needs {n}, one per joint")
    if arms is None:
        raise ArgumentValueError(
            "play_mm", "needs arm_mm, the distance of a pin's bearing from the centre of the joint"
        )
    stiffness = values.get("stiffness_Nm_per_rad")
    return JointPlay(
        1e-3 * np.broadcast_to(np.asarray(values["play_mm"], dtype=float), n),
        arms,
        None if stiffness is None else np.broadcast_to(np.asarray(stiffness, dtype=float), n),
    )
