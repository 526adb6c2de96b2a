"""The pressure of a ball joint: on the seat in section, and over the angle from the load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.ball_joint.figures import (
    ball_joint_figures,
    cross_section,
    fitting_curve,
    pressure_curve,
)
from cardan.app.answers.printed import quantity
from cardan.app.pictures.style import (
    THIN,
    drawing,
    finish,
    line_style,
    page,
)
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# In ball radii: how far the peak pressure stands out, how thick the seat is drawn, the arrows.
_PEAK, _SEAT = 0.55, 0.75
_ARROWS = 15
_PAGE = (170.0, 78.0)


def plot_ball_joint(case: BallJointCase, title: str = "") -> Figure:
    """Return a picture of a ball joint, 170 mm wide: the pressure in section and as a curve.

    Args:
        case: the ball joint of a scene.
        title: heading.
    """
    with page(*_PAGE, title, 90) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
        plot_seat_section(case, ax=left)
        plot_seat_pressure(case, ax=right)
    return figure


def _whole(answer: Answer) -> Figure:
    """Pressure on the seat of a ball joint, in section and as a curve."""
    case = answer.of.ball_joint
    if case is None:
        raise ValueError(f"{answer.of.name}: section [ball_joint] is missing")
    return plot_ball_joint(case, answer.of.title)


PICTURES = {"ball_joint": _whole}
"""The pictures of the part by name."""


def plot_seat_section(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw ball and seat in section, with the pressure at right angles to the surface.

    The pressure is drawn outwards from the surface of the ball, where it acts on the seat; the
    longest arrow is the peak pressure.

    Args:
        case: the ball joint of a scene.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.
    """
    theta, pressure = pressure_curve(case)
    found = ball_joint_figures(case)
    with drawing(ax, height_mm=78.0) as axes:
        around = np.linspace(-np.pi, np.pi, 361)
        axes.fill(*cross_section(around, 0.0), facecolor="0.92", edgecolor="0.35", linewidth=0.8)
        seat = _ring(theta, np.zeros_like(theta), np.full_like(theta, _SEAT))
        axes.fill(
            *seat, facecolor="white", edgecolor="0.35", linewidth=0.8, hatch="////", alpha=0.3
        )
        height = _PEAK * pressure / found.peak
        blue = line_style(0)["color"]
        axes.fill(*_ring(theta, np.zeros_like(theta), height), facecolor=blue, alpha=0.25)
        axes.plot(*cross_section(theta, height), color=blue)
        _arrows(axes, case, found.peak)
        for side in (-1.0, 1.0):
            edge = np.full(2, side * found.contact_angle)
            axes.plot(*cross_section(edge, np.array([-1.0, _SEAT])), **THIN)
        axes.annotate(
            "",
            (0.0, -0.15),
            (0.0, 0.75),
            arrowprops={"arrowstyle": "-|>", "color": "black", "linewidth": 1.2},
        )
        axes.text(0.07, 0.35, quantity(case.load, "N"), parse_math=False)
        across, down = cross_section(np.array(0.0), _SEAT + 0.04)
        axes.text(
            float(across),
            float(down),
            quantity(found.peak, "MPa"),
            ha="center",
            va="top",
            parse_math=False,
        )
        axes.text(0.0, 1.06, f"ball radius {quantity(float(case.joint.radius), 'mm')}", ha="center")
        axes.set_aspect("equal")
        axes.set_axis_off()
    return axes


def plot_seat_pressure(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw the pressure on the seat over the angle from the load, beside what is allowable.

    Args:
        case: the ball joint of a scene.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.
    """
    theta, pressure = pressure_curve(case)
    fit = fitting_curve(case, theta)
    found = ball_joint_figures(case)
    degrees = np.degrees(theta)
    with drawing(ax, height_mm=60.0) as axes:
        axes.plot(degrees, 1e-6 * pressure, label="pressure", **line_style(0))
        top = found.peak
        if fit is not None:
            axes.plot(degrees, 1e-6 * fit, label="without clearance", **line_style(1))
        if found.weaker is not None and case.allowable_pressure is not None:
            label = f"allowable, {found.weaker}"
            axes.axhline(1e-6 * case.allowable_pressure, label=label, **line_style(3))
            top = max(top, case.allowable_pressure)
        axes.set_xlim(degrees[0], degrees[-1])
        axes.set_ylim(0.0, 1.05e-6 * top)
        finish(axes, "angle from the line of the load [deg]", "pressure [MPa]")
    return axes


def _ring(theta: FloatArray, inner: FloatArray, outer: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The outline of what lies between two heights over the ball."""
    inside, outside = cross_section(theta, inner), cross_section(theta, outer)
    return (
        np.concatenate([inside[0], outside[0][::-1]]),
        np.concatenate([inside[1], outside[1][::-1]]),
    )


def _arrows(axes: Axes, case: BallJointCase, peak: float) -> None:
    """Arrows of the pressure, from the surface of the ball into the seat."""
    theta, pressure = pressure_curve(case, _ARROWS)
    for angle, height in zip(theta, _PEAK * pressure / peak, strict=True):
        if height < 0.05 * _PEAK:
            continue
        (x0, x1), (y0, y1) = cross_section(np.full(2, angle), np.array([0.0, height]))
        axes.annotate(
            "",
            (x1, y1),
            (x0, y0),
            arrowprops={
                "arrowstyle": "-|>,head_length=0.25,head_width=0.12",
                "color": line_style(0)["color"],
                "linewidth": 0.7,
                "shrinkA": 0.0,
                "shrinkB": 0.0,
            },
        )
