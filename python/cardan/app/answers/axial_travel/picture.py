"""How far shafts slide over the turn because their axes do not meet."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel.figures import AxialTravel, drawn_slides
from cardan.app.answers.charts import Curve, Panel, chart
from cardan.app.answers.printed import with_unit
from cardan.app.pictures.style import check_kind, drawing, finish, legend_above, line_style, stacked
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.wear.axial_travel import SlideName, Slides

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ORDERS = range(1, 7)
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
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

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
    sizes = slides.amplitudes(list(_ORDERS), of)
    width = 0.8 / len(sizes)
    with drawing(ax, height_mm=45.0) as axes:
        for joint, (name, heights) in enumerate(zip(_names(sizes), sizes, strict=True)):
            places = np.asarray(_ORDERS) + (joint - (len(sizes) - 1) / 2.0) * width
            axes.bar(places, heights, 0.9 * width, label=name, color=line_style(joint)["color"])
        axes.set_xticks(list(_ORDERS))
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
"""The pictures of the part by name."""


def _names(rows: FloatArray) -> list[str]:
    return [f"joint {joint}" for joint in range(len(rows))]


def _check_single(slides: Slides, of: SlideName) -> None:
    check_kind("slides", slides, Slides)
    if slides.travel(of).ndim != 1:
        raise ArgumentValueError("slides", "are those of a batch; a picture shows one driveline")
