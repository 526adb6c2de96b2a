"""The figures of the sources: a single joint, its moments, the moments that a flywheel costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.turn.panel import TURN
from cardan.app.pictures.style import (
    LINES,
    THIN,
    degree_ticks,
    drawing,
    finish,
    legend_above,
    line_style,
    number,
    value_ticks,
)
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep
from cardan.reference.approximations import thoma_small_angle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HALF_TURN_DEG = np.arange(721) / 4.0
_HALF_TURN = Sweep.revolutions(721 / 1440, 1440)


def plot_driven_angle(bend_deg: float = 60.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 10: the driven angle over the drive angle, compared with a straight joint.

    At bends that are in use the two could hardly be told apart.

    Args:
        bend_deg: bend in degrees.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    line = Driveline.from_bends([bend_deg], degrees=True)
    driven = np.degrees(line.evaluate(_HALF_TURN, "angle").angle)
    with drawing(ax) as axes:
        axes.plot(_HALF_TURN_DEG, driven, label=f"bend {number(bend_deg)}°", **LINES[0])
        axes.plot(_HALF_TURN_DEG, _HALF_TURN_DEG, label="bend 0°", **LINES[1])
        axes.set(xlim=(0.0, 180.0), ylim=(0.0, 180.0))
        finish(axes, "drive angle [deg]", "driven angle [deg]")
        degree_ticks(axes.yaxis, 0.0, 180.0)
    return axes


def plot_angle_error(
    bends_deg: Sequence[float] = (10.0, 20.0, 30.0), *, ax: Axes | None = None
) -> Axes:
    """Draw Bild 11: the angle error over the drive angle, with the locus of its extremes.

    Args:
        bends_deg: bends in degrees, a curve for each.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a bend outside [0, 90°), more bends than can be told apart.
    """
    lines = Driveline.from_bends(np.reshape(bends_deg, (-1, 1)), degrees=True)
    errors = lines[:, np.newaxis].evaluate(_HALF_TURN, "angle_error").angle_error
    places, largest = _extremes(lines)
    to = float(np.max(np.degrees(lines.bends)))
    locus = _extremes(_joints(to))
    with drawing(ax, height_mm=55.0) as axes:
        for i, (bend, curve) in enumerate(zip(bends_deg, np.degrees(errors), strict=True)):
            label = f"bend {number(bend)}°: {largest[i]:.3f}° at {places[i]:.1f}°"
            axes.plot(_HALF_TURN_DEG, curve, label=label, **line_style(i))
        # One line through both halves would run along the axis between them.
        for sign, label in ((1.0, "locus of the extremes"), (-1.0, "")):
            where = locus[0] if sign > 0.0 else 180.0 - locus[0]
            axes.plot(where, sign * locus[1], label=label, **THIN)
            where = places if sign > 0.0 else 180.0 - places
            axes.plot(where, sign * largest, "o", color=THIN["color"])
        finish(axes, "drive angle [deg]", "angle error [deg]", (0.0, 180.0), ncols=2)
    return axes


def plot_largest_angle_error(to_deg: float = 45.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 12: the largest angle error over the bend.

    Args:
        to_deg: largest bend in degrees.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    return _over_bend("max_angle_error", "largest angle error [deg]", to_deg, ax)


def plot_non_uniformity(to_deg: float = 45.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 13: the non-uniformity over the bend.

    Arguments and errors are those of ``plot_largest_angle_error``.
    """
    return _over_bend("non_uniformity", "non-uniformity U", to_deg, ax)


def _joints(to_deg: float) -> Driveline:
    """A joint at every bend up to one."""
    return Driveline.from_bends(np.linspace(0.0, to_deg, 181)[:, np.newaxis], degrees=True)


def _extremes(lines: Driveline) -> tuple[FloatArray, FloatArray]:
    """Drive angle of the largest angle error of single joints, and its size, both in degrees."""
    joint = lines.equivalent()
    return (
        np.degrees(np.arctan(np.sqrt(joint.min_speed_ratio))),
        np.degrees(joint.max_angle_error),
    )


def _over_bend(field: str, label: str, to_deg: float, ax: Axes | None) -> Axes:
    lines = _joints(to_deg)
    values = getattr(lines.equivalent(), field)
    with drawing(ax, height_mm=45.0) as axes:
        in_unit = np.degrees(values) if field == "max_angle_error" else values
        axes.plot(np.degrees(lines.bends[:, 0]), in_unit, **LINES[0])
        finish(axes, "bend [deg]", label, (0.0, to_deg), (0.0, None))
    return axes


def plot_torque_ratio(bend_deg: float = 50.0, *, ax: Axes | None = None) -> Axes:
    """Draw Abb. 3: the torque of the driven shaft over the drive angle, per unit drive torque.

    Arguments and errors are those of ``plot_driven_angle``.
    """
    line = Driveline.from_bends([bend_deg], degrees=True)
    torque = line.evaluate(TURN, "torque", load=Load(drive_torque=1.0)).torque
    with drawing(ax, height_mm=45.0) as axes:
        axes.plot(np.degrees(TURN), torque, label=f"bend {number(bend_deg)}°", **LINES[0])
        x = r"drive angle $\alpha_1$ [deg]"
        finish(axes, x, "torque $D_2/D_1$", (0.0, 360.0), (0.0, None))
    return axes


def plot_bending_moments(bend_deg: float = 50.0, *, ax: Axes | None = None) -> Axes:
    """Draw Abb. 4: the bending moments as a polar diagram, per unit drive torque.

    That of the driving shaft is drawn over the drive angle, that of the driven shaft over the
    driven angle.

    Args:
        bend_deg: bend in degrees.
        ax: polar axes; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: axes that are not polar, a bend outside [0, 90°).
    """
    line = Driveline.from_bends([bend_deg], degrees=True)
    found = line.evaluate(
        TURN, ("angle", "bending_driving", "bending_driven"), joints=0, load=Load(drive_torque=1.0)
    )
    with drawing(ax, "polar", height_mm=78.0) as axes:
        polar: Any = axes
        driving, driven = (rf"$B_{i}/D_1$ over $\alpha_{i}$" for i in (1, 2))
        axes.plot(np.asarray(TURN), found.bending_driving, label=f"driving {driving}", **LINES[0])
        axes.plot(found.angle, found.bending_driven, label=f"driven {driven}", **LINES[1])
        value_ticks(axes.yaxis, 4)
        polar.set_rlabel_position(0.0)
        legend_above(axes, loc="lower center", bbox_to_anchor=(0.5, 1.12), ncols=2)
    return axes


_SYMBOLS = {"torque": "M_t", "moment_x": "M_x", "moment_z": "M_z"}


def plot_small_angle(
    component: Literal["torque", "moment_x", "moment_z"] = "torque",
    bend_deg: float = 30.0,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Draw a moment on the driven shaft over the turn, exact and by Thoma's form for small bends.

    The drive turns steadily, the flywheel sits on the driven shaft, and the moments are over
    ``inertia * speed**2``, with Thoma's signs (``cardan.approximations.thoma_small_angle``).

    Args:
        component: his ``Mt``, ``Mx`` or ``Mz``.
        bend_deg: bend in degrees; his own example has 8.5.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: an unknown component, a bend outside [0, 90°).
    """
    if component not in _SYMBOLS:
        raise ArgumentValueError("component", f"is {component!r}; known are {', '.join(_SYMBOLS)}")
    exact, small = _moments(component, bend_deg)
    curves = [(f"exact, bend {bend_deg:g}°", exact), ("for small bends", small)]
    with drawing(ax, height_mm=45.0) as axes:
        panel.draw(axes, np.degrees(panel.TURN), curves)
        finish(axes, "drive angle [deg]", rf"${_SYMBOLS[component]}\,/\,Θω^2$")
    return axes


def _moments(component: str, bend_deg: float) -> tuple[FloatArray, FloatArray]:
    line = Driveline.from_bends([bend_deg], degrees=True)
    load = Load(speed=1.0, inertias=[0.0, 1.0])
    moment = line.evaluate(panel.TURN, "moment", joints=0, load=load).moment
    along, across = line.directions[1], line.normals[0]
    # Thoma's axes point against the power flow, hence the signs.
    axis = {"torque": along, "moment_x": -np.cross(across, along), "moment_z": -across}[component]
    small = thoma_small_angle(np.asarray(panel.TURN), line.bends[0], 1.0, 1.0)
    return moment @ axis, getattr(small, component)
