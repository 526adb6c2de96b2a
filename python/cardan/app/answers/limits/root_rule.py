"""The catalogues' root rule for a driveline: its fork signs, its figure, what it neglects."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.driveline import Driveline

CATALOGUE_SCHEMA = {
    "type": "object",
    "properties": {
        "fork_signs": {
            "description": "of each joint, for Driveline.catalogue_bend",
            "type": "array",
            "items": {"enum": [-1, 1]},
        },
        "equivalent_bend_deg": {"type": "number", "minimum": 0},
        "off_deg": {
            "description": "how far the yokes are at most from the position, aligned or crossed, "
            "for which the rule is meant",
            "type": "number",
            "minimum": 0,
            "maximum": 45,
        },
    },
    "required": ["fork_signs", "equivalent_bend_deg", "off_deg"],
    "additionalProperties": False,
}
"""JSON Schema of ``root_rule``."""


def root_rule(line: Driveline) -> dict[str, Any]:
    """Return what the root rule makes of one driveline with two or more joints, as plain data."""
    signs, off = fork_signs(line)
    return {
        "fork_signs": signs.tolist(),
        "equivalent_bend_deg": float(np.degrees(line.catalogue_bend(signs))),
        "off_deg": float(np.degrees(np.max(off))),
    }


def fork_signs(line: Driveline) -> tuple[NDArray[np.int64], FloatArray]:
    """Return the signs that describe the yokes, and how far these are from what the signs say.

    Parallel yokes change the sign and crossed ones keep it, once the turn of the bend planes is
    taken off. Yokes in between count as what they are nearer to.

    Returns:
        +1 or -1 per joint, ``(..., n)``, for ``Driveline.catalogue_bend``; the angle of each shaft
        between two joints in rad, within [0, pi/4], ``(..., n - 1)``.
    """
    turned = line.phases - line.twists
    crossed = np.cos(2.0 * turned) < 0.0
    signs = np.cumprod(np.where(crossed, 1, -1), axis=-1)
    first = np.ones((*line.shape, 1), dtype=np.int64)
    off = turned - np.where(crossed, np.pi / 2.0, 0.0)
    return np.concatenate([first, signs], axis=-1), np.abs(off - np.pi * np.round(off / np.pi))
