"""Bends at both ends of a shaft as vectors, and the path of a joint's moment vector."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from cardan.app.answers.turn.extremes import period_of
from cardan.app.pictures.style import (
    LINES,
    MARKERS,
    THIN,
    check_single,
    drawing,
    finish,
    write_angle,
)
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep
from cardan.motion import workshop

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_bend_vectors(line: Driveline, shaft: int = 1, *, ax: Axes | None = None) -> Axes:
    """Draw the bends at both ends of a shaft as vectors, the catalogues' Bild 18.

    Looking from the drive towards the output, with y up and z to the right where the shaft lies
    along x. Each vector points
    where its joint bends to, exactly, and is as long as the bend. Rings show where the catalogue's
    drawing puts the ends: it adds the projected bends themselves, instead of their tangents. The
    arrow is the turn by which the output-side yoke must be set against the input-side one.

    Args:
        line: one driveline.
        shaft: a shaft between two bent joints.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        IndexError: a shaft that does not exist.
        ValueError: a batch, a shaft at an end of the driveline or beside a straight joint.
    """
    check_single(line)
    item = item_index("shaft", shaft, line.n_joints + 1)
    if not 0 < item < line.n_joints:
        raise ArgumentValueError("shaft", f"is {shaft}; it must lie between two joints")
    bends, along = line.bends[item - 1 : item + 1], line.directions[item]
    if not np.all(bends > 0.0):
        raise ArgumentValueError(
            "shaft", f"is {shaft}; a straight joint beside it has no bend plane"
        )
    pointing = np.cross(line.normals[item - 1 : item + 1], along) @ _view(along).T
    ends = np.degrees(bends)[:, np.newaxis] * pointing
    as_drawn = np.degrees(np.arctan(np.tan(bends)[:, np.newaxis] * pointing))
    # Seen along the shaft a turn about it is clockwise.
    first = np.degrees(np.arctan2(pointing[0, 1], pointing[0, 0]))
    turn = workshop.turn(line.twists[item - 1])
    sweep = np.degrees(turn.angle) * (1.0 if turn.sense == "counter-clockwise" else -1.0)
    last = np.radians(first + sweep)
    radius = 0.6 * float(np.degrees(np.min(bends)))
    with drawing(ax, height_mm=78.0) as axes:
        for i, (end, bend) in enumerate(zip(ends, np.degrees(bends), strict=True)):
            label = f"joint {item - 1 + i}: {bend:.2f}°"
            axes.plot(*zip((0.0, 0.0), end, strict=True), label=label, **LINES[i])
            axes.plot(*end, marker=MARKERS[i], color=LINES[i]["color"])
        ring = {"markerfacecolor": "none", "markeredgecolor": THIN["color"], "markersize": 5.0}
        axes.plot(*as_drawn.T, "o", label="by the drawing", **ring)
        reach = 1.25 * radius * np.array([np.cos(last), np.sin(last)])
        axes.plot(*zip((0.0, 0.0), reach, strict=True), **THIN)
        curve = np.radians(first + np.linspace(0.0, sweep, 61))
        arc = radius * np.stack([np.cos(curve), np.sin(curve)])
        axes.plot(*arc, **THIN)
        if turn.angle > 0.0:
            head = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, **THIN}
            axes.annotate("", tuple(arc[:, -1]), tuple(arc[:, -4]), arrowprops=head)
        axes.annotate(
            f"{np.degrees(turn.angle):.2f}°",
            tuple(reach),
            xytext=(14.0 * np.cos(last), 6.0 * np.sin(last)),
            textcoords="offset points",
            ha="center",
            va="center",
        )
        axes.set_aspect("equal", adjustable="datalim")
        finish(axes, "bend to the right [deg]", "bend upwards [deg]")
    return axes


def _view(along: FloatArray) -> FloatArray:
    """Right and up across a shaft, seen along it."""
    up = np.array([0.0, 1.0, 0.0]) - along[1] * along
    # Along a shaft that points up, x is up.
    up = up if np.linalg.norm(up) > 1e-6 else np.array([1.0, 0.0, 0.0]) - along[0] * along
    up /= np.linalg.norm(up)
    return np.stack([np.cross(along, up), up])


_PER_DEGREE = 2
_MARKS = np.arange(0, 180, 30) * _PER_DEGREE


def plot_hodograph(
    line: Driveline, joint: int = 0, *, load: Load | None = None, ax: Axes | None = None
) -> Axes:
    """Draw the path of what bends the shafts at a joint: its moment seen along either shaft.

    Both views have the normal of the bend plane upwards and the bend plane across. A single joint
    under a steady drive torque traces a circle on its driving side and an ellipse on its driven
    side (Grossmann's moments (6) and (8)), each twice in a turn, and once if the joint has
    deviations. Drive angles of half a turn are marked.

    Args:
        line: one driveline.
        joint: index of the joint.
        load: the load; by default 1 N m of drive torque, and the axes are per unit of it.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        IndexError: a joint that does not exist.
        ValueError: a batch, a load that does not fit.
    """
    check_single(line)
    item = item_index("joint", joint, line.n_joints)
    # A second time round would fill the gaps of the dashes.
    per_turn = 360 * _PER_DEGREE
    angle_deg = np.arange(round(period_of(line) / math.tau * per_turn) + 1) / _PER_DEGREE
    given = Load(drive_torque=1.0) if load is None else load
    period = Sweep.revolutions(len(angle_deg) / per_turn, per_turn)
    moment = line.evaluate(period, "moment", joints=item, load=given).moment
    normal = line.normals[item]
    with drawing(ax, height_mm=60.0) as axes:
        for i, side in enumerate(("driving", "driven")):
            across = np.cross(normal, line.directions[item + i])
            x, y = moment @ across, moment @ normal
            axes.plot(x, y, label=f"{side} shaft {item + i}", **LINES[i])
            axes.plot(x[_MARKS], y[_MARKS], MARKERS[i], color=LINES[i]["color"])
            middle = np.array([np.ptp(x) / 2.0 + np.min(x), np.ptp(y) / 2.0 + np.min(y)])
            for mark in _MARKS:
                inwards = middle - (x[mark], y[mark])
                inwards /= max(float(np.linalg.norm(inwards)), 1e-300)
                point = np.array([x[mark], y[mark]])
                write_angle(axes, angle_deg[mark], point, np.array([13.0, 10.5]) * inwards)
        unit = " / drive torque" if load is None else " [N m]"
        axes.set_aspect("equal", adjustable="datalim")
        finish(axes, f"moment in the bend plane{unit}", f"moment across it{unit}")
    return axes
