"""How far pins and shafts slide over a turn because their axes do not meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.scene.offsets import AxisOffsets
from cardan.app.scene.scene import Scene
from cardan.wear.axial_travel import NAMES, SlideName, Slides

ORDERS = (1, 2, 3, 4)
"""The orders of a slide that answers have."""


@dataclass(frozen=True)
class SlideFigures:
    """One slide of one joint over a turn, lengths in mm.

    Attributes:
        joint: number of the joint.
        slide: what slides.
        travel: the largest less the smallest slide.
        amplitudes: by order of the drive's rotation, as ``ORDERS``.
        state: over states, the name of the one in which the travel is largest.
    """

    joint: int
    slide: SlideName
    travel: float
    amplitudes: tuple[float, ...]
    state: str = ""


@dataclass(frozen=True)
class SceneSlides:
    """The slides of a scene's joints; those of the shafts first.

    Attributes:
        offsets: the distances that cause them.
        slides: the slides at any angle; over states with an axis for these.
        each: figures of every slide of every joint.
    """

    offsets: AxisOffsets
    slides: Slides
    each: tuple[SlideFigures, ...]


def scene_slides(scene: Scene) -> SceneSlides | None:
    """Return the slides of a scene; ``None`` if it has no section [offsets]."""
    offsets = scene.service.offsets
    if offsets is None:
        return None
    lines = scene.drivelines() if scene.states else scene.line.reshape(1)
    names = scene.states.names if scene.states else ("",)
    slides = offsets.slides(lines)
    found = []
    for name in reversed(NAMES):
        travel, amplitudes = slides.travel(name), slides.amplitudes(ORDERS, name)
        for joint in range(lines.n_joints):
            worst = int(np.argmax(travel[joint]))
            sizes = tuple(amplitudes[joint, worst].tolist())
            found.append(
                SlideFigures(joint, name, float(travel[joint, worst]), sizes, names[worst])
            )
    return SceneSlides(offsets, slides, tuple(found))


def drawn_slides(scene: Scene) -> Slides:
    """Return the slides of one driveline to draw: over states where a shaft slides farthest.

    Raises:
        ValueError: a scene without the section [offsets].
    """
    found = scene_slides(scene)
    if found is None:
        raise ValueError(f"{scene.name}: slides need a section [offsets]")
    shafts = (one for one in found.each if one.slide == "shaft")
    farthest = max(shafts, key=lambda one: one.travel)
    if scene.states:
        scene = scene.in_state(scene.states.names.index(farthest.state))
    return found.offsets.slides(scene.line)


def data(found: SceneSlides, *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes it."""
    return [
        {
            "joint": one.joint,
            "slide": one.slide,
            "travel_mm": one.travel,
            "orders": [
                {"order": order, "amplitude_mm": size}
                for order, size in zip(ORDERS, one.amplitudes, strict=True)
            ],
            **({"state": one.state} if one.state else {}),
        }
        for one in found.each
    ]


_NUMBER = {"type": "number"}
_COUNT = {"type": "integer", "minimum": 0}

SCHEMA: Mapping[str, Any] = {
    "type": "array",
    "items": record(
        {
            "joint": _COUNT,
            "slide": {"enum": [*NAMES]},
            "travel_mm": {**_NUMBER, "description": "from peak to peak over a turn"},
            "orders": {
                "type": "array",
                "items": record({"order": _COUNT, "amplitude_mm": _NUMBER}),
            },
        },
        optional={"state": {"type": "string"}},
    ),
}
"""JSON Schema of ``data``."""


def find(answer: Answer) -> SceneSlides | None:
    """Return the figures of an answer's scene."""
    return scene_slides(answer.scene)
