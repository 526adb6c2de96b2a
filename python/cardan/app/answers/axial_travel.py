"""How far pins and shafts slide over a turn because their axes do not meet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.answer import Answer
from cardan.app.answers.over import over
from cardan.app.answers.page import Curve, Panel, chart
from cardan.app.answers.printed import with_unit
from cardan.app.answers.rows import Judged, figure, item, parts
from cardan.app.pictures.style import check_kind, drawing, finish, legend_above, line_style, stacked
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.wear.axial_travel import SlideName, Slides

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_ORDERS = (1, 2, 3, 4)


@dataclass(frozen=True)
class Slide:
    """Sliding at one joint, with its driving shaft held in place."""

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

    def of_joints(name: SlideName) -> tuple[Slide, ...]:
        # Scenes give offsets in mm.
        travels, sizes = 1e-3 * slides.travel(name), 1e-3 * slides.amplitudes(_ORDERS, name)
        return tuple(
            Slide(joint, over(scene, travel), *sizes[joint, np.argmax(travel)].tolist())
            for joint, travel in enumerate(travels)
        )

    return AxialTravel(of_joints("shaft"), of_joints("driving_pin"), of_joints("driven_pin"))


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


_DRAWN_ORDERS = range(1, 7)
_DEGREES = np.arange(0.0, 361.0, 2.0)


def drawn(answer: Answer, _: AxialTravel) -> dict[str, Any]:
    """Return the axial travel of the shafts over the turn as a chart of the page."""
    travels = drawn_slides(answer.scene).at(np.radians(_DEGREES))
    curves = tuple(Curve(f"joint {joint}", travel) for joint, travel in enumerate(travels))
    travel = Panel(
        "Axial travel of the driven shafts", "mm", curves, float(np.max(np.abs(travels)))
    )
    return {"charts": [chart(travel, _DEGREES, "drive angle [deg]")]}


def plot_slides(slides: Slides, of: SlideName = "shaft", *, ax: Axes | None = None) -> Axes:
    """Draw how far a shaft or a pin of each joint slides over the turn.

    Args:
        slides: the slides of one driveline, as ``Driveline.slides`` returns them.
        of: what slides, as for ``Slides.at``.

    Raises:
        ValueError: the slides of a batch, an unknown slide, more joints than can be told apart.
    """
    _check_single(slides, of)
    turn = np.asarray(panel.TURN)
    curves = slides.at(turn, of)
    with drawing(ax) as axes:
        panel.draw(axes, np.degrees(turn), list(zip(_names(curves), curves, strict=True)))
        finish(axes, "drive angle [deg]", f"slide of the {of.replace('_', ' ')}")
    return axes


def plot_slide_orders(slides: Slides, of: SlideName = "shaft", *, ax: Axes | None = None) -> Axes:
    """Draw the amplitudes of a slide of each joint by orders of the drive's rotation.

    Arguments and errors are those of ``plot_slides``.
    """
    _check_single(slides, of)
    sizes = slides.amplitudes(list(_DRAWN_ORDERS), of)
    width = 0.8 / len(sizes)
    with drawing(ax, height_mm=45.0) as axes:
        for joint, (name, heights) in enumerate(zip(_names(sizes), sizes, strict=True)):
            places = np.asarray(_DRAWN_ORDERS) + (joint - (len(sizes) - 1) / 2.0) * width
            axes.bar(places, heights, 0.9 * width, label=name, color=line_style(joint)["color"])
        axes.set_xticks(list(_DRAWN_ORDERS))
        axes.set_xlabel("order of the drive's rotation")
        axes.set_ylabel(f"amplitude of the {of.replace('_', ' ')}")
        legend_above(axes)
    return axes


def _whole(answer: Answer) -> Figure:
    """Axial travel of shafts whose axes miss each other."""
    slides = drawn_slides(answer.scene)
    travel, amplitude = with_unit("axial travel", "mm"), with_unit("amplitude", "mm")
    panels = (
        (47.5, lambda axes: plot_slides(slides, ax=axes).set_ylabel(travel)),
        (47.5, lambda axes: plot_slide_orders(slides, ax=axes).set_ylabel(amplitude)),
    )
    return stacked(panels, answer.of.title)


PICTURES = {"axial_travel": _whole}


def _names(rows: FloatArray) -> list[str]:
    return [f"joint {joint}" for joint in range(len(rows))]


def _check_single(slides: Slides, of: SlideName) -> None:
    check_kind("slides", slides, Slides)
    if slides.travel(of).ndim != 1:
        raise ArgumentValueError("slides", "are those of a batch; a picture shows one driveline")
