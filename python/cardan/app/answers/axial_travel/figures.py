"""How far pins and shafts slide over a turn because their axes do not meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import over
from cardan.app.answers.rows import Judged, figure, item, parts
from cardan.app.scene.scene import Scene
from cardan.wear.axial_travel import SlideName, Slides

_ORDERS = (1, 2, 3, 4)


@dataclass(frozen=True)
class Slide:
    """What slides at one joint, with its driving shaft held in place."""

    joint: int = item("joint")
    travel: Judged = figure("travel", "mm", "from peak to peak over a turn", digits="small")
    order_1: float = figure(
        "order 1", "mm", "amplitude of what changes once per turn of the drive", digits="small"
    )
    order_2: float = figure(
        "order 2", "mm", "amplitude of what changes twice per turn", digits="small"
    )
    order_3: float = figure(
        "order 3", "mm", "amplitude of what changes three times per turn", digits="small"
    )
    order_4: float = figure(
        "order 4", "mm", "amplitude of what changes four times per turn", digits="small"
    )


@dataclass(frozen=True)
class AxialTravel:
    """The slides of a scene's joints; orders are those of the state with the largest travel."""

    shafts: tuple[Slide, ...] = parts("Driven shafts along their axes")
    crosses: tuple[Slide, ...] = parts("Crosses along the driving pins")
    yokes: tuple[Slide, ...] = parts("Driven yokes along the driven pins")


def find(answer: Answer) -> AxialTravel | None:
    """Return the slides of a scene; ``None`` if it has no section [offsets]."""
    scene = answer.scene
    if scene.offsets is None:
        return None
    slides = scene.offsets.slides(scene.drivelines())
    names: tuple[SlideName, ...] = ("shaft", "driving_pin", "driven_pin")
    return AxialTravel(*(_of_joints(scene, slides, name) for name in names))


def _of_joints(scene: Scene, slides: Slides, name: SlideName) -> tuple[Slide, ...]:
    # Scenes give offsets in mm.
    travels, amplitudes = 1e-3 * slides.travel(name), 1e-3 * slides.amplitudes(_ORDERS, name)
    return tuple(
        Slide(joint, over(scene, travel), *amplitudes[joint, np.argmax(travel)].tolist())
        for joint, travel in enumerate(travels)
    )


def drawn_slides(scene: Scene) -> Slides:
    """Return the slides in mm to draw: over states where a shaft slides farthest."""
    offsets = scene.offsets
    if offsets is None:
        raise ValueError(f"{scene.name}: slides need a section [offsets]")
    lines = scene.drivelines()
    return offsets.slides(lines[int(np.argmax(offsets.slides(lines).travel().max(axis=0)))])


# A tenth of a micrometre is less than any measurement of a driveline shows.
_SHOWN = 0.5e-7


def sentences(found: AxialTravel) -> Iterator[str]:
    """Say what the figures are, and which offsets cause which orders."""
    yield (
        "The travel is from peak to peak, the orders are amplitudes, with the driving shaft of the "
        "joint held in place. The angles, speeds and torques do not change."
    )
    if any(max(each.order_1, each.order_3) > _SHOWN for each in found.shafts):
        yield (
            "In the travel of a shaft, orders 1 and 3 come from pins that miss the axes of their "
            "shafts."
        )
    if any(max(each.order_2, each.order_4) > _SHOWN for each in found.shafts):
        yield (
            "In the travel of a shaft, orders 2 and 4 come from shafts that miss each other, and "
            "from pins of a cross that miss each other."
        )
