"""What the deviations of a scene's joints add: the orders of its shafts, and their extremes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.tolerances import JOINT_GROUPS

ORDERS = (1, 2, 3, 4)
"""The orders that are told."""

_STATES = ("as_built", "drawing", "worst")

_LEAST = 1e-12
"""Amplitudes of the angle error in rad that are rounding."""


@dataclass(frozen=True)
class ShaftOrders:
    """Amplitudes of a shaft by ``ORDERS``, ``(rows, orders)``: as built, of the drawing, and worst.

    Attributes:
        shaft: of which.
        state: name of the state, if there are any: that with the largest order 1.
        angle_error: in rad.
        acceleration: in rad/s² at the speed of the drive; ``None`` without one.
        deviates: whether the scene gives deviations, so that the first two rows differ.
        toleranced: whether there is a third row: the worst within the tolerances of the joints.
    """

    shaft: int
    state: str
    angle_error: FloatArray
    acceleration: FloatArray | None
    deviates: bool
    toleranced: bool


def as_built_orders(scene: Scene) -> list[ShaftOrders]:
    """Return the orders of the shafts of a scene; none without deviations or their tolerances."""
    halves = _joint_tolerances(scene)
    if scene.line.shape or (scene.deviations is None and halves is None):
        return []
    shafts = (scene.line.n_joints,) if scene.shafts is None else scene.shafts
    each = [("", scene)]
    if scene.states:
        each = [(name, scene.in_state(i)) for i, name in enumerate(scene.states.names)]
    return [
        max(
            (_orders(one, shaft, halves, name) for name, one in each),
            # As built, or within the tolerances, which comes last.
            key=lambda found: float(found.angle_error[2 if found.toleranced else 0, 0]),
        )
        for shaft in shafts
        if shaft > 0
    ]


def _joint_tolerances(scene: Scene) -> FloatArray | None:
    """Tolerances of the deviations of the joints in rad, ``(3, n)``; ``None`` if there are none."""
    given = scene.tolerances.given if scene.tolerances else {}
    if given.keys().isdisjoint(JOINT_GROUPS):
        return None
    return np.stack([given.get(group, np.zeros(scene.line.n_joints)) for group in JOINT_GROUPS])


def _orders(scene: Scene, shaft: int, halves: FloatArray | None, state: str) -> ShaftOrders:
    names = ("angle_error", "acceleration_ratio")
    lines: tuple[Driveline, ...] = (scene.line_as_built, scene.line)
    found = [line.harmonics(ORDERS, shaft, outputs=names) for line in lines]
    errors = [each.angle_error for each in found]
    ratios = [each.acceleration_ratio for each in found]
    if halves is not None:
        worst = [
            scene.line_as_built.order_tolerances(*halves, order=order, shaft=shaft).worst
            for order in ORDERS
        ]
        errors.append(np.array(worst))
        ratios.append(np.square(ORDERS) * worst)
    still = np.stack(errors) <= _LEAST
    speed = scene.speed
    acceleration = np.where(still, 0.0, np.stack(ratios) * speed**2) if speed else None
    deviates, toleranced = scene.deviations is not None, halves is not None
    return ShaftOrders(
        shaft, state, np.where(still, 0.0, np.stack(errors)), acceleration, deviates, toleranced
    )


def data(found: list[ShaftOrders], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the orders as plain data for JSON, as ``SCHEMA`` describes it."""
    angle, turned = ("rad", float) if radians else ("deg", math.degrees)
    entries = []
    for each in found:
        for i, order in enumerate(ORDERS):
            entry: dict[str, Any] = {"shaft": each.shaft, "order": order}
            if each.state:
                entry["state"] = each.state
            for place, state in enumerate(_STATES[: len(each.angle_error)]):
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

SCHEMA: Mapping[str, Any] = {
    "type": "array",
    "description": "amplitudes by order of joints as built, if the scene gives deviations or "
    "tolerances of them",
    "items": record(
        {
            "shaft": {"type": "integer", "minimum": 0},
            "order": {"enum": [*ORDERS]},
            "as_built": _AMPLITUDES,
            "drawing": _AMPLITUDES,
        },
        {
            "state": {"type": "string", "description": "the one with the largest order 1"},
            "worst": {
                **_AMPLITUDES,
                "description": "within the tolerances of the joints, if the scene has any",
            },
        },
    ),
}
"""JSON Schema of ``data``."""


def find(answer: Answer) -> list[ShaftOrders]:
    """Return the figures of an answer's scene."""
    return as_built_orders(answer.scene)
