"""What the deviations of a scene's joints add: the orders of its shafts, and their extremes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.figures.answers import record
from cardan.figures.extremes import finite_or_none
from cardan.scene.scene import Scene

ORDERS = (1, 2, 3, 4)
"""The orders that are told."""

_LEAST = 1e-12
"""Amplitudes of the angle error in rad that are rounding."""


@dataclass(frozen=True)
class ShaftOrders:
    """Amplitudes of a shaft by ``ORDERS``, each ``(2, orders)``: as built, and of the drawing.

    Attributes:
        shaft: of which.
        angle_error: in rad.
        acceleration: in rad/s² at the speed of the drive; ``None`` without one.
    """

    shaft: int
    angle_error: FloatArray
    acceleration: FloatArray | None


def as_built_orders(scene: Scene) -> list[ShaftOrders]:
    """Return the orders of the shafts of a scene; none if it gives no deviations."""
    if scene.deviations is None or scene.line.shape:
        return []
    shafts = (scene.line.n_joints,) if scene.shafts is None else scene.shafts
    return [_orders(scene, shaft) for shaft in shafts if shaft > 0]


def _orders(scene: Scene, shaft: int) -> ShaftOrders:
    names = ("angle_error", "acceleration_ratio")
    lines: tuple[Driveline, ...] = (scene.line_as_built, scene.line)
    found = [line.harmonics(ORDERS, shaft, outputs=names) for line in lines]
    errors = np.stack([each.angle_error for each in found])
    ratios = np.stack([each.acceleration_ratio for each in found])
    still = errors <= _LEAST
    speed = scene.speed
    acceleration = np.where(still, 0.0, ratios * speed**2) if speed else None
    return ShaftOrders(shaft, np.where(still, 0.0, errors), acceleration)


def as_built_data(found: list[ShaftOrders], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the orders as plain data for JSON, as ``AS_BUILT_SCHEMA`` describes it."""
    angle, turned = ("rad", float) if radians else ("deg", math.degrees)
    entries = []
    for each in found:
        for i, order in enumerate(ORDERS):
            entry: dict[str, Any] = {"shaft": each.shaft, "order": order}
            for place, state in enumerate(("as_built", "drawing")):
                entry[state] = {f"angle_error_{angle}": turned(each.angle_error[place, i])}
                if each.acceleration is not None:
                    size = finite_or_none(float(each.acceleration[place, i]))
                    entry[state]["acceleration_rad_s2"] = size
            entries.append(entry)
    return entries


_NUMBER = {"type": ["number", "null"], "description": "null if it is not finite"}
_AMPLITUDES = record(
    {},
    {
        "angle_error_deg": {"type": "number"},
        "angle_error_rad": {"type": "number"},
        "acceleration_rad_s2": {**_NUMBER, "description": "at the speed of the drive"},
    },
)

AS_BUILT_SCHEMA: Mapping[str, Any] = {
    "type": "array",
    "description": "amplitudes by order of joints as built, if the scene gives deviations",
    "items": record(
        {
            "shaft": {"type": "integer", "minimum": 0},
            "order": {"enum": [*ORDERS]},
            "as_built": _AMPLITUDES,
            "drawing": _AMPLITUDES,
        }
    ),
}
"""JSON Schema of ``as_built_data``."""
