"""The figures of the catalogues' chapter on the single joint: angles, their error and its size."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cardan.app.pictures.style import (
    LINES,
    THIN,
    degree_ticks,
    drawing,
    legend_above,
    line_style,
    number,
    value_ticks,
)
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.sweep import Sweep

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
        axes.set_ylim(0.0, 180.0)
        degree_ticks(axes.yaxis, 0.0, 180.0)
        _over_half_turn(axes, "driven angle [deg]")
        legend_above(axes)
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
        _over_half_turn(axes, "angle error [deg]")
        value_ticks(axes.yaxis)
        legend_above(axes, ncols=2)
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

    Args:
        to_deg: largest bend in degrees.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    return _over_bend("non_uniformity", "non-uniformity U", to_deg, ax)


def _over_half_turn(axes: Axes, label: str) -> None:
    axes.set_xlim(0.0, 180.0)
    degree_ticks(axes.xaxis, 0.0, 180.0)
    axes.set_xlabel("drive angle [deg]")
    axes.set_ylabel(label)
    axes.grid(visible=True)


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
        axes.set_xlim(0.0, to_deg)
        axes.set_ylim(bottom=0.0)
        degree_ticks(axes.xaxis, 0.0, to_deg)
        value_ticks(axes.yaxis)
        axes.set_xlabel("bend [deg]")
        axes.set_ylabel(label)
        axes.grid(visible=True)
    return axes
