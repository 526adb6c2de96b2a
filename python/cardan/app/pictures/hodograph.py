"""The path of a joint's moment vector over the turn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from cardan.app.answers.turn.extremes import period_of
from cardan.app.pictures.style import LINES, MARKERS, drawing, legend_above, value_ticks
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PER_DEGREE = 2
_MARKS = np.arange(0, 180, 30) * _PER_DEGREE


def plot_hodograph(
    line: Driveline,
    joint: int = 0,
    *,
    load: Load | None = None,
    ax: Axes | None = None,
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
        ImportError: matplotlib is missing.
        IndexError: a joint that does not exist.
        ValueError: a batch, a load that does not fit.
    """
    if line.shape:
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; this picture shows one driveline"
        )
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
                axes.annotate(
                    f"{angle_deg[mark]:g}°",
                    (x[mark], y[mark]),
                    xytext=(13.0 * inwards[0], 10.5 * inwards[1]),
                    textcoords="offset points",
                    ha="center",
                    va="center",
                    fontsize="small",
                    bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 0.0},
                )
        unit = " / drive torque" if load is None else " [N m]"
        axes.set_aspect("equal", adjustable="datalim")
        value_ticks(axes.xaxis)
        value_ticks(axes.yaxis)
        axes.set_xlabel(f"moment in the bend plane{unit}")
        axes.set_ylabel(f"moment across it{unit}")
        axes.grid(visible=True)
        legend_above(axes)
    return axes
