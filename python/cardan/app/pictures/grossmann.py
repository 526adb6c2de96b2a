"""K. H. Grossmann's figures (1939) of the moments in one joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.answers.turn.panel import TURN
from cardan.app.pictures.style import (
    LINES,
    degree_ticks,
    drawing,
    legend_above,
    number,
    value_ticks,
)
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_torque_ratio(bend_deg: float = 50.0, *, ax: Axes | None = None) -> Axes:
    """Draw Abb. 3: the torque of the driven shaft over the drive angle, per unit drive torque.

    Args:
        bend_deg: bend in degrees.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    line = Driveline.from_bends([bend_deg], degrees=True)
    torque = line.evaluate(TURN, "torque", load=Load(drive_torque=1.0)).torque
    with drawing(ax, height_mm=45.0) as axes:
        axes.plot(np.degrees(TURN), torque, label=f"bend {number(bend_deg)}°", **LINES[0])
        axes.set_xlim(0.0, 360.0)
        axes.set_ylim(bottom=0.0)
        degree_ticks(axes.xaxis, 0.0, 360.0)
        value_ticks(axes.yaxis)
        axes.set_xlabel(r"drive angle $\alpha_1$ [deg]")
        axes.set_ylabel("torque $D_2/D_1$")
        axes.grid(visible=True)
        legend_above(axes)
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
        TURN,
        ("angle", "bending_driving", "bending_driven"),
        joints=0,
        load=Load(drive_torque=1.0),
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
