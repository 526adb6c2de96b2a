"""Effect of the deviations of a scene's joints: orders of its shafts, and their extremes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import over
from cardan.app.answers.rows import Judged, count, figure, item
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.tolerances import JOINT_GROUPS

ORDERS = (1, 2, 3, 4)
"""The orders that are told."""

_LEAST = 1e-12
"""Amplitudes of the angle error in rad that are rounding."""


@dataclass(frozen=True)
class OrderFigures:
    """Amplitudes of one order of the drive in the motion of one shaft."""

    order: int = item("order")
    shaft: int = count("shaft")
    angle_error: Judged = figure(
        "angle error", "deg", "amplitude, with the deviations", digits="angle_error"
    )
    angle_error_drawn: Judged | None = figure(
        "drawn angle error", "deg", "ideal joints", digits="angle_error"
    )
    angle_error_worst: Judged | None = figure(
        "worst angle error",
        "deg",
        "largest within the tolerances of the joints",
        digits="angle_error",
    )
    acceleration: Judged | None = figure(
        "acceleration", "rad_s2", "amplitude at the speed of the drive, with the deviations"
    )
    acceleration_drawn: Judged | None = figure("drawn acceleration", "rad_s2", "ideal joints")
    acceleration_worst: Judged | None = figure(
        "worst acceleration", "rad_s2", "largest within the tolerances of the joints"
    )


def find(answer: Answer) -> tuple[OrderFigures, ...]:
    """Return the orders of the shafts of a scene; none without deviations or their tolerances."""
    scene = answer.scene
    halves = _joint_tolerances(scene)
    if scene.line.shape or (scene.deviations is None and halves is None):
        return ()
    shafts = (scene.line.n_joints,) if scene.shafts is None else scene.shafts
    each = [scene.in_state(i) for i in range(scene.states.count)] if scene.states else [scene]
    return tuple(
        found for shaft in shafts if shaft > 0 for found in _of_shaft(scene, each, shaft, halves)
    )


def _of_shaft(
    scene: Scene, each: list[Scene], shaft: int, halves: FloatArray | None
) -> Iterator[OrderFigures]:
    errors = np.stack([_amplitudes(one, shaft, halves) for one in each])
    speeds = np.array([one.speed for one in each])
    for i, order in enumerate(ORDERS):
        own = [over(scene, amplitudes) for amplitudes in errors[:, :, i].T]
        squares = (order * speeds) ** 2
        faster: list[Judged] = []
        if speeds.all():
            faster = [over(scene, amplitudes * squares) for amplitudes in errors[:, :, i].T]
        yield OrderFigures(order, shaft, *_named(scene, own), *_named(scene, faster))


def _named(scene: Scene, found: list[Judged]) -> tuple[Any, Any, Any]:
    """Return the value as built, that of the drawing if it differs, and the worst, if any."""
    if not found:
        return None, None, None
    built, drawn, *worst = found
    return built, drawn if scene.deviations is not None else None, next(iter(worst), None)


def _joint_tolerances(scene: Scene) -> FloatArray | None:
    """Tolerances of the deviations of the joints in rad, ``(3, n)``; ``None`` if there are none."""
    given = scene.tolerances.given if scene.tolerances else {}
    if given.keys().isdisjoint(JOINT_GROUPS):
        return None
    return np.stack([given.get(group, np.zeros(scene.line.n_joints)) for group in JOINT_GROUPS])


def _amplitudes(scene: Scene, shaft: int, halves: FloatArray | None) -> FloatArray:
    """Amplitudes of the angle error by ``ORDERS``: as built, of the drawing, worst if any."""
    lines = (scene.line_as_built, scene.line)
    errors = [line.harmonics(ORDERS, shaft, outputs="angle_error").angle_error for line in lines]
    if halves is not None:
        worst = [
            scene.line_as_built.order_tolerances(*halves, order=order, shaft=shaft).worst
            for order in ORDERS
        ]
        errors.append(np.array(worst))
    found = np.stack(errors)
    return np.where(found <= _LEAST, 0.0, found)


BY_DRAWING = (
    "Curves, extremes, forces and play are those as built. Equivalent bend, closed forms, limits, "
    "slides, life, torsional vibration and steering are those of the drawing."
)


def heading(_: tuple[OrderFigures, ...]) -> str:
    """Say what the figures are."""
    return "Joints as built: amplitudes by order of the drive"


def sentences(_: tuple[OrderFigures, ...]) -> list[str]:
    """Say which figures of the answer have the deviations."""
    return [BY_DRAWING]
