"""The residual bend of a centred double joint over its total bend."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cardan.app.pictures.style import (
    drawing,
    finish,
    line_style,
)
from cardan.driveline import Driveline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STEPS = 400


def plot_double_joint(
    length: float,
    synchronous_deg: float,
    *,
    wear: float = 0.0,
    largest_deg: float = 50.0,
    ax: Axes | None = None,
) -> Axes:
    """Draw the equivalent bend of a centred double joint over its total bend.

    Args:
        length: distance between the joint centres.
        synchronous_deg: total bend in degrees at which the double joint is synchronous.
        wear: by how much a worn pivot is off along the driving shaft, in the unit of the length;
            0 for the joint without wear alone, else both directions are drawn as well.
        largest_deg: total bend in degrees up to which it is drawn.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: as for ``Driveline.from_double_joint``.
    """
    total = np.linspace(0.0, largest_deg, _STEPS + 1)
    place = 0.5 * length / np.cos(0.5 * np.radians(synchronous_deg))
    pivots = [("as drawn", place)]
    if wear:
        away, near = "pivot %g farther", "pivot %g nearer"
        pivots += [(away % abs(wear), place + abs(wear)), (near % abs(wear), place - abs(wear))]
    with drawing(ax) as axes:
        for i, (label, pivot) in enumerate(pivots):
            # Where both bends are equal the curve has a corner, which samples would miss.
            corner = 2.0 * np.degrees(np.arccos(min(1.0, 0.5 * length / pivot)))
            drawn = np.sort(np.append(total, min(corner, largest_deg)))
            line = Driveline.from_double_joint(drawn, length, pivot, degrees=True)
            bend = np.degrees(line.equivalent().bend)
            axes.plot(drawn, bend, label=label, **line_style(i))
        axes.set_xlim(0.0, largest_deg)
        axes.set_ylim(0.0, None)
        finish(axes, "total bend [deg]", "equivalent bend [deg]")
    return axes
