"""The pressure of a ball joint: on the seat in section, and over the angle from the load."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.ball_joint.figures import (
    BallJointFigures,
    ball_joint_figures,
    pressure_curve,
)
from cardan.app.answers.page import Curve, Panel, chart
from cardan.app.answers.printed import given, quantity, with_unit
from cardan.app.answers.rows import UNITS
from cardan.app.pictures.style import THIN, arrow, check_kind, drawing, finish, line_style, page
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.arrays import FloatArray
from cardan.ball_joint import BallJoint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# In ball radii: how far the peak pressure stands out, how thick the seat is drawn.
_PEAK, _SEAT = 0.5, 0.7
_ARROWS = 15

_ANGLE = "angle from the line of the load [deg]"

# Pixels of a ball radius on the page.
_SCALE = 100.0


class _Outlines(NamedTuple):
    """Ball, seat, pressure and its arrows in section, ``(points, 2)`` in ball radii."""

    ball: FloatArray
    seat: FloatArray
    pressure: FloatArray
    arrows: list[FloatArray]


def _outlines(case: BallJointCase, found: BallJointFigures) -> _Outlines:
    """The section with the load pointing down; the pressure stands on the ball."""
    theta, pressure = pressure_curve(case)
    touches = np.abs(theta) <= found.contact_angle
    arrows = zip(*pressure_curve(case, _ARROWS), strict=True)
    return _Outlines(
        _section(np.linspace(-np.pi, np.pi, 361), 0.0),
        _ring(theta, np.full_like(theta, _SEAT)),
        _ring(theta[touches], _PEAK * pressure[touches] / found.peak),
        [
            _section(np.full(2, angle), np.array([0.0, _PEAK * size / found.peak]))
            for angle, size in arrows
            if size > 0.05 * found.peak
        ],
    )


def _section(theta: FloatArray, height: FloatArray | float) -> FloatArray:
    """Points at angles from the load and heights over the surface of the ball."""
    return np.stack([(1.0 + height) * np.sin(theta), -(1.0 + height) * np.cos(theta)], axis=-1)


def _ring(theta: FloatArray, height: FloatArray) -> FloatArray:
    """The outline of what lies between the surface of the ball and a height over it."""
    return np.concatenate([_section(theta, 0.0), _section(theta[::-1], height[::-1])])


def _curves(case: BallJointCase, found: BallJointFigures) -> tuple[FloatArray, dict[str, Any]]:
    """Angles from the load in degrees, and the pressures that are compared there.

    Without clearance the pressure is Marcus's cosine.
    """
    theta, pressure = pressure_curve(case)
    curves = {"pressure on the seat": pressure}
    if case.joint.clearance:
        fit = BallJoint(case.joint.radius, case.joint.half_angle)
        curves["without clearance"] = np.asarray(fit.pressure(theta, case.load))
    if found.weaker is not None and case.allowable_pressure is not None:
        curves[f"allowable for the {found.weaker}"] = np.full_like(theta, case.allowable_pressure)
    factor = UNITS[shown_unit("MPa")].factor
    return np.degrees(theta), {label: factor * values for label, values in curves.items()}


def drawn(answer: Answer, found: BallJointFigures) -> dict[str, Any]:
    """Return the section and the curves of the pressure as plain data for ``ball_joint.html``."""
    case = answer.of.ball_joint
    assert case
    degrees, curves = _curves(case, found)
    unit = UNITS[shown_unit("MPa")].symbol
    panel = Panel("Pressure on the seat", unit, tuple(Curve(*each) for each in curves.items()))
    shapes = _outlines(case, found)
    peak = quantity(found.peak, "MPa")
    return {
        "charts": [chart(panel, degrees, _ANGLE)],
        "drawing": {
            "ball": f"{_path(shapes.ball)}Z",
            "seat": f"{_path(shapes.seat)}Z",
            "pressure": f"{_path(shapes.pressure)}Z",
            "arrows": [_path(arrow) for arrow in shapes.arrows],
            "load": given(case.load, "N"),
            "peak": peak,
            "spoken": f"Ball and seat in section: the pressure is largest in line with the load, "
            f"{peak}",
        },
    }


def _path(points: FloatArray) -> str:
    return "M" + "L".join(f"{_SCALE * x:.1f} {-_SCALE * y:.1f}" for x, y in points)


def plot_ball_joint(case: BallJointCase, title: str = "") -> Figure:
    """Return a picture of a ball joint, 170 mm wide: the pressure in section and as a curve.

    Args:
        case: the ball joint of a scene.
        title: heading.
    """
    check_kind("case", case, BallJointCase)
    with page(170.0, 78.0, title, 90) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
        plot_seat_section(case, ax=left)
        plot_seat_pressure(case, ax=right)
    return figure


def _whole(answer: Answer) -> Figure:
    """Pressure on the seat of a ball joint: section and curve."""
    case = answer.of.ball_joint
    if case is None:
        raise ValueError(f"{answer.of.name}: section [ball_joint] is missing")
    return plot_ball_joint(case, answer.of.title)


PICTURES = {"ball_joint": _whole}


def plot_seat_section(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw ball and seat in section, with the pressure at right angles to the surface.

    The pressure is drawn outwards from the surface of the ball, where it acts on the seat; the
    longest arrow is the peak pressure.

    Args:
        case: the ball joint of a scene.
    """
    check_kind("case", case, BallJointCase)
    found = ball_joint_figures(case)
    shapes, blue = _outlines(case, found), line_style(0)["color"]
    body: dict[str, Any] = {"edgecolor": "0.35", "linewidth": 0.8}
    with drawing(ax, height_mm=78.0) as axes:
        axes.fill(*shapes.ball.T, facecolor="0.92", **body)
        axes.fill(*shapes.seat.T, facecolor="white", hatch="////", alpha=0.3, **body)
        axes.fill(*shapes.pressure.T, facecolor=blue, alpha=0.25)
        axes.plot(*shapes.pressure[len(shapes.pressure) // 2 :].T, color=blue)
        for foot, head in shapes.arrows:
            arrow(axes, tuple(foot), tuple(head), "-|>,head_length=0.25,head_width=0.12", blue, 0.7)
        for side in (-1.0, 1.0):
            edge = np.full(2, side * found.contact_angle)
            axes.plot(*_section(edge, np.array([-1.0, _SEAT])).T, **THIN)
        arrow(axes, (0.0, 0.75), (0.0, -0.15), "-|>", "black", 1.2)
        axes.text(0.07, 0.35, given(case.load, "N"), parse_math=False)
        peak = quantity(found.peak, "MPa")
        axes.text(0.0, -1.04 - _SEAT, peak, ha="center", va="top", parse_math=False)
        axes.text(0.0, 1.06, f"ball radius {quantity(float(case.joint.radius), 'mm')}", ha="center")
        axes.set_aspect("equal")
        axes.set_axis_off()
    return axes


def plot_seat_pressure(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw the pressure on the seat over the angle from the load, beside what is allowable.

    Arguments are those of ``plot_seat_section``.
    """
    check_kind("case", case, BallJointCase)
    found = ball_joint_figures(case)
    degrees, curves = _curves(case, found)
    with drawing(ax, height_mm=60.0) as axes:
        for (label, values), style in zip(curves.items(), (0, 1, 3), strict=False):
            axes.plot(degrees, values, label=label, **line_style(style))
        top = 1.05 * max(float(np.max(values)) for values in curves.values())
        ends = (degrees[0], degrees[-1]), (0.0, top)
        finish(axes, _ANGLE, with_unit("pressure", "MPa"), *ends, ncols=2)
    return axes
