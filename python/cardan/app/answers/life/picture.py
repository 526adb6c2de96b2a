"""The load, the heat and the life of joints as pictures."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.answers.turn.panel as panel
import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures, friction_of, needed
from cardan.app.answers.page import Curve, Panel, bars, chart
from cardan.app.answers.printed import curves_text, given, quantity, with_unit
from cardan.app.answers.rounding import is_steady, signed
from cardan.app.scene.language.units import RPM, as_shown
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.wear.pin_loads import pins_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SPEEDS = 41


def drawn(_: Answer, found: LifeFigures) -> dict[str, Any]:
    """Return the pins over the turn in the step that wears most, and the life with each size."""
    data: dict[str, Any] = {}
    if found.duty:
        angle = np.linspace(0.0, 360.0, 181)
        line, load, name = found.hardest()
        curves = (Curve(*each) for each in _moments(line, load, np.radians(angle)))
        scale = abs(float(load.torque))
        moment = Panel(f"Moment of the pins, {name}", "N m", tuple(curves), scale)
        data["charts"] = [chart(moment, angle, "drive angle [deg]")]
    if known := _bars(found):
        data["bars"] = [bars("L10 life with each size at every joint", known)]
    return data


def _moments(line: Driveline, load: Load, angle: FloatArray) -> list[tuple[str, FloatArray]]:
    """The moments by joint, with the sign of the torque where it reverses: they have no cusps."""
    found = []
    for joint in range(line.n_joints):
        pins = pins_at(line, load, joint, angle)
        found.append((f"joint {joint}", signed(pins.moment, pins.entering_torque)))
    return found


def plot_pin_load(line: Driveline, load: Load, *, ax: Axes | None = None) -> Axes:
    """Draw the moment that the pins of each joint bear over the turn.

    It is a magnitude; where the torque of the joint reverses, it has the sign of the torque.

    Args:
        line: one driveline.
        load: one load.

    Raises:
        ValueError: a batch.
    """
    style.check_single(line)
    style.check_kind("load", load, Load)
    turn = np.asarray(panel.TURN)
    with style.drawing(ax) as axes:
        moments = [(name, as_shown(each, "N m")[0]) for name, each in _moments(line, load, turn)]
        panel.draw(axes, np.degrees(turn), moments)
        style.finish(axes, "drive angle [deg]", with_unit("moment of the pins", "Nm"))
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

    Raises:
        ValueError: a batch, a load without a speed, and as for ``Driveline.losses``.
    """
    style.check_single(line)
    style.check_kind("load", load, Load)
    if not np.all(load.speed != 0.0):
        raise ArgumentValueError("load", "has no speed; heat is drawn up to it")
    speeds = np.linspace(0.0, 1.0, _SPEEDS)[1:] * np.abs(load.speed)
    values: dict[str, Any] = {f"{load.end}_torque": load.torque, "inertias": load.inertias}
    given = {"friction": friction, "pin_radius": pin_radius, "arm": arm}
    heat = line.losses(Load(speed=speeds, **values), **given, seal_torque=seal_torque).power
    # At rest there is no heat.
    rpm = np.append(0.0, speeds / RPM)
    with style.drawing(ax) as axes:
        for joint, watts in enumerate(heat):
            axes.plot(rpm, np.append(0.0, watts), label=f"joint {joint}", **style.line_style(joint))
        style.finish(axes, "speed of the drive [rpm]", "heat [W]", (0.0, rpm[-1]), (0.0, None))
    return axes


def plot_sizes(found: LifeFigures, *, ax: Axes | None = None) -> Axes:
    """Draw the life with each size of the table at every joint, as bars.

    Sizes with bends or speeds beyond their limits are hatched. The required life is a line.

    Args:
        found: the figures of a scene, from ``cardan.app.answers.life.figures.needed``.

    Raises:
        ValueError: a scene without sizes whose life is known.
    """
    style.check_kind("found", found, LifeFigures)
    known = _bars(found)
    if not known:
        raise ValueError("the scene has no table of sizes whose life is known")
    fits = [one.fits for one in found.sizes if one.hours is not None]
    with style.drawing(ax, height_mm=_height(len(known))) as axes:
        for bar, within in zip(style.draw_bars(axes, known), fits, strict=True):
            if not within:
                bar.set(facecolor="#BFD9EA", hatch="////", edgecolor="white")
        style.value_ticks(axes.xaxis)
        axes.set_xlabel("L10 life [h]")
        if found.target is not None:
            look: dict[str, Any] = {**style.LINES[1], "linewidth": 1.4}
            axes.axvline(found.target, label=f"required {given(found.target, 'h')}", **look)
            style.legend_above(axes)
    return axes


def _bars(found: LifeFigures) -> list[tuple[str, float, str]]:
    """The sizes whose life is known."""
    known = ((one.size, one.hours) for one in found.sizes)
    return [(size, hours, quantity(hours, "h")) for size, hours in known if hours is not None]


def _whole(answer: Answer) -> Figure:
    """Life with each size of joint, load of the pins, and heat.

    The pins are those of the step that wears the deciding joint most, the heat that of the hottest
    step. What the scene does not give is left out.
    """
    found = needed(answer)
    line, load, *_ = found.hardest()
    panels: list[tuple[float, Callable[[Axes], object]]]
    panels = [_pin_panel(line, load)]
    if sizes := _bars(found):
        panels.insert(0, (_height(len(sizes)), lambda axes: plot_sizes(found, ax=axes)))
    hot = [joint.largest_heat or joint.heat for joint in found.joints]
    if known := [heat for heat in hot if heat and heat.value is not None]:
        hottest = found.step_of(max(known, key=lambda heat: heat.value or 0.0))
        bearings = friction_of(found.types)
        panels.append((50.0, lambda axes: plot_heat(*hottest[:2], **bearings, ax=axes)))
    return style.stacked(panels, answer.of.title)


def _pin_panel(line: Driveline, load: Load) -> tuple[float, Callable[[Axes], object]]:
    """Height and drawing of the load of the pins: curves, or a line of text if they are steady."""
    moments, scale = _moments(line, load, np.asarray(panel.TURN)), abs(float(load.torque))
    if not all(is_steady(curve, scale) for _, curve in moments):
        return 50.0, lambda axes: plot_pin_load(line, load, ax=axes)

    lines = ["moment of the pins", *curves_text(moments, "N m", scale).split(", ")]

    def write(axes: Axes) -> None:
        axes.set_axis_off()
        place: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "va": "center"}
        axes.text(0.5, 0.5, "\n".join(lines), **place)

    return 5.0 + 3.5 * len(lines), write


PICTURES = {"life": _whole}


def _height(bars: int) -> float:
    return 14.0 + 6.0 * bars
