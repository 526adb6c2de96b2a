"""The section of a ball joint: verdict, figures, the pressure in section and as a curve."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.ball_joint.figures import (
    BallJointFigures,
    cross_section,
    fitting_curve,
    pressure_curve,
)
from cardan.app.answers.page import section_of
from cardan.app.answers.printed import quantity
from cardan.app.answers.table import PARTS
from cardan.app.charts.charts import Curve, Panel, chart
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.arrays import FloatArray

# Of the drawing: pixels of a ball radius, ball radii of the peak pressure and of the seat.
_SCALE, _PEAK, _SEAT = 100.0, 0.5, 0.7
_ARROWS = 13


def section(answer: Answer, found: BallJointFigures) -> dict[str, Any]:
    """Return a ball joint as plain data for ``page.html``."""
    case = answer.of.ball_joint
    assert case
    theta, pressure = pressure_curve(case)
    curves = [Curve("pressure on the seat", 1e-6 * pressure)]
    fit = fitting_curve(case, theta)
    if fit is not None:
        curves += [Curve("without clearance", 1e-6 * fit)]
    if found.weaker is not None and case.allowable_pressure is not None:
        level = np.full_like(theta, 1e-6 * case.allowable_pressure)
        curves += [Curve(f"allowable for the {found.weaker}", level)]
    panel = Panel("Pressure on the seat", "MPa", tuple(curves))
    return {
        **section_of(PARTS["ball_joint"], found),
        "chart": chart(panel, np.degrees(theta), "angle from the line of the load [deg]"),
        "drawing": _drawing(case, found),
    }


def _drawing(case: BallJointCase, found: BallJointFigures) -> dict[str, Any]:
    """Paths of ball, seat and pressure, the load pointing down."""
    theta, pressure = pressure_curve(case)
    touches = np.abs(theta) <= found.contact_angle
    height = _PEAK * pressure[touches] / found.peak
    around = np.linspace(0.0, 2.0 * np.pi, 181)
    arrows, arrow_pressure = pressure_curve(case, _ARROWS)
    return {
        "ball": _path(around, np.zeros_like(around)),
        "seat": _ring(theta, np.full_like(theta, _SEAT)),
        "pressure": _ring(theta[touches], height),
        "arrows": [
            _path(np.full(2, angle), np.array([0.0, _PEAK * size / found.peak]))
            for angle, size in zip(arrows, arrow_pressure, strict=True)
            if size > 0.0
        ],
        "load": quantity(case.load, "N"),
        "peak": quantity(found.peak, "MPa"),
        "spoken": (
            f"Ball and seat in section: the pressure is largest in line with the load, "
            f"{quantity(found.peak, 'MPa')}"
        ),
    }


def _ring(theta: FloatArray, height: FloatArray) -> str:
    """The outline of what lies between the surface of the ball and a height over it."""
    back = theta[::-1]
    return _path(np.concatenate([theta, back]), np.concatenate([0.0 * theta, height[::-1]])) + "Z"


def _path(theta: FloatArray, height: FloatArray) -> str:
    across, up = cross_section(theta, height)
    points = zip(_SCALE * across, -_SCALE * up, strict=True)
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
