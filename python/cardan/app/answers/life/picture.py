"""The load, the heat and the life of joints as pictures."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures, friction_of, needed
from cardan.app.answers.life.text import hours_text
from cardan.app.pictures.style import (
    LINES,
    drawing,
    finish,
    legend_above,
    line_style,
    stacked,
    value_ticks,
)
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.wear.pin_loads import pins_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SPEEDS = 41
_RPM = np.pi / 30.0


def plot_pin_load(line: Driveline, load: Load, *, ax: Axes | None = None) -> Axes:
    """Draw the moment that the pins of each joint bear over the turn.

    Args:
        line: one driveline.
        load: one load.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a batch.
    """
    _check_single(line)
    turn = np.asarray(panel.TURN)
    moments = [pins_at(line, load, joint, turn).moment for joint in range(line.n_joints)]
    with drawing(ax) as axes:
        drawn = [(f"joint {joint}", moment) for joint, moment in enumerate(moments)]
        panel.draw(axes, np.degrees(turn), drawn)
        finish(axes, "drive angle [deg]", "moment of the pins [N m]")
    return axes


def plot_heat(
    line: Driveline,
    load: Load,
    *,
    friction: ArrayLike,
    pin_radius: ArrayLike,
    arm: ArrayLike,
    seal_torque: ArrayLike = 0.0,
    ax: Axes | None = None,
) -> Axes:
    """Draw the heat of each joint over the speed of the drive, up to that of the load.

    Args:
        line: one driveline.
        load: one load with a speed.
        friction: as for ``Driveline.losses``, like the following arguments.
        pin_radius: radius in m at which the friction acts.
        arm: of the pins in m.
        seal_torque: about the pins of each yoke in N m.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a batch, a load without a speed, and as for ``Driveline.losses``.
    """
    _check_single(line)
    if not np.all(load.speed != 0.0):
        raise ArgumentValueError("load", "has no speed; heat is drawn up to it")
    speeds = np.linspace(0.0, 1.0, _SPEEDS)[1:] * np.abs(load.speed)
    values: dict[str, Any] = {f"{load.end}_torque": load.torque, "inertias": load.inertias}
    given = {"friction": friction, "pin_radius": pin_radius, "arm": arm}
    heat = line.losses(Load(speed=speeds, **values), **given, seal_torque=seal_torque).power
    with drawing(ax) as axes:
        for joint, watts in enumerate(heat):
            style = line_style(joint)
            # At rest there is no heat.
            rpm = np.append(0.0, speeds / _RPM)
            axes.plot(rpm, np.append(0.0, watts), label=f"joint {joint}", **style)
        axes.set_xlim(0.0, float(speeds[-1] / _RPM))
        axes.set_ylim(0.0, None)
        finish(axes, "speed of the drive [rpm]", "heat [W]")
    return axes


def plot_sizes(found: LifeFigures, *, ax: Axes | None = None) -> Axes:
    """Draw the life with each size of the table at every joint, as bars.

    Sizes with bends or speeds beyond their limits are hatched. The required life is a line.

    Args:
        found: the figures of a scene, from ``cardan.app.answers.life.figures.needed``.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a scene without sizes whose life is known.
    """
    known = [(one, one.hours) for one in found.sizes if one.hours is not None]
    if not known:
        raise ValueError("the scene has no table of sizes whose life is known")
    with drawing(ax, height_mm=_height(len(known))) as axes:
        rows = range(len(known))
        bars = axes.barh(rows, [hours for _, hours in known], 0.62, color="#0072B2")
        for row, (one, hours) in enumerate(known):
            if not one.fits:
                bars[row].set(facecolor="#BFD9EA", hatch="////", edgecolor="white")
            axes.annotate(
                hours_text(hours),
                (hours, row),
                xytext=(2.0, 0.0),
                textcoords="offset points",
                va="center",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
                zorder=4.0,
            )
        axes.set_yticks(list(rows), [one.size for one, _ in known], parse_math=False)
        axes.invert_yaxis()
        axes.tick_params(axis="y", length=0)
        axes.set_xlim(0.0, 1.2 * max(hours for _, hours in known))
        value_ticks(axes.xaxis)
        axes.set_xlabel("L10 life [h]")
        target = found.target
        if target is not None:
            style: dict[str, Any] = {**LINES[1], "linewidth": 1.4}
            axes.axvline(target, label=f"required {target:g} h", **style)
            legend_above(axes)
    return axes


def _whole(answer: Answer) -> Figure:
    """Life with each size of joint, load of the pins, and heat.

    The pins are those of the step that wears the deciding joint most, the heat that of the hottest
    step. What the scene does not give is left out.
    """
    found = needed(answer)
    line, load, *_ = found.hardest()
    panels: list[tuple[float, Callable[[Axes], object]]]
    panels = [(50.0, lambda axes: plot_pin_load(line, load, ax=axes))]
    if count := sum(one.hours is not None for one in found.sizes):
        panels.insert(0, (_height(count), lambda axes: plot_sizes(found, ax=axes)))
    hot = [joint.largest_heat or joint.heat for joint in found.joints]
    if known := [heat for heat in hot if heat and heat.value is not None]:
        hottest = found.step_of(max(known, key=lambda heat: heat.value or 0.0))
        bearings = friction_of(found.types)
        panels.append((50.0, lambda axes: plot_heat(*hottest[:2], **bearings, ax=axes)))
    return stacked(panels)


PICTURES = {"life": _whole}
"""The pictures of the part by name."""


def _height(bars: int) -> float:
    return 14.0 + 6.0 * bars


def _check_single(line: Driveline) -> None:
    if line.shape:
        raise ValueError(f"the drivelines are a batch of shape {line.shape}; draw one of them")
