"""D. Thoma's example (1920): the moments that a flywheel costs, exact and for small bends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.pictures.style import drawing, legend_above
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.reference.approximations import thoma_small_angle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
        axes.set_xlabel("drive angle [deg]")
        axes.set_ylabel(rf"${_SYMBOLS[component]}\,/\,Θω^2$")
        legend_above(axes)
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
