"""What was found to be best: the quantity over each variable, and each state before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.answers.optimise.figures import Optimised, unit_of
from cardan.app.answers.states.figures import without_common
from cardan.app.pictures.style import (
    THIN,
    drawing,
    finish,
    legend_above,
    line_style,
    page,
    value_ticks,
)
from cardan.arrays.errors import ArgumentValueError
from cardan.design.quantities import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Wider than this, in letters, names of states are written aslant.
_SHORT = 30

_GREY = "0.75"

_BEYOND: dict[str, Any] = {**THIN, "color": line_style(0)["color"], "linestyle": (0, (1, 1.2))}


def plot_optimise(found: Optimised) -> Figure:
    """Draw the figures of each state, and the quantity over each variable.

    Args:
        found: the optimum of a scene, from ``cardan.app.answers.optimise.figures.optimised``.

    Returns:
        a figure of 170 mm width with a panel for the states and one for each variable.
    """
    panels = len(found.asked.variables) + 1
    rows = (panels + 1) // 2
    with page(170.0, 58.0 * rows, found.scene.title, 90) as figure:
        plot_optimised_states(found, ax=figure.add_subplot(rows, 2, 1))
        for i in range(panels - 1):
            plot_over_variable(found, i, ax=figure.add_subplot(rows, 2, i + 2))
    return figure


def plot_over_variable(found: Optimised, variable: int, *, ax: Axes | None = None) -> Axes:
    """Draw the quantity over one variable, with its range, the start and the optimum.

    The other variables have their best values. A free phase is drawn over half a turn. The curve is
    dotted where a quantity is above the limit that it has to keep.

    Args:
        found: the optimum of a scene.
        variable: number of the variable.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a variable that does not exist.
    """
    if not 0 <= variable < len(found.asked.variables):
        count = len(found.asked.variables)
        raise ArgumentValueError("variable", f"is {variable}; there are {count}, counted from 0")
    own = found.asked.variables[variable]
    curve = found.over(variable)
    best = own.base + float(found.best.x[variable])
    unit = unit_of(own)
    with drawing(ax, height_mm=58.0) as axes:
        x = own.base + curve.changes
        axes.plot(x, curve.within, **line_style(0))
        if np.any(np.isfinite(curve.beyond)):
            axes.plot(x, curve.beyond, label="beyond a limit", **_BEYOND)
        if own.teeth:
            pitch = 360.0 / own.teeth
            first, last = curve.changes[0] / pitch, curve.changes[-1] / pitch
            turns = np.arange(np.ceil(first), np.floor(last) + 1.0)
            heights = np.interp(pitch * turns, curve.changes, curve.values)
            teeth: dict[str, Any] = {
                "linestyle": "none",
                "marker": "|",
                "markersize": 6.0,
                "color": "0.35",
            }
            axes.plot(own.base + pitch * turns, heights, label="teeth", **teeth)
        axes.axvline(own.base, label="scene", **{**THIN, "linestyle": (0, (4, 1.5))})
        axes.plot(
            [best],
            [float(found.goal(found.best.value))],
            linestyle="none",
            marker="o",
            markersize=4.0,
            color=line_style(1)["color"],
            label="best",
        )
        if np.isfinite(own.high - own.low):
            room = 0.06 * (own.high - own.low)
            for end, beyond in ((own.low, own.low - room), (own.high, own.high + room)):
                axes.axvspan(own.base + beyond, own.base + end, color=_GREY, linewidth=0.0)
            axes.set_xlim(own.base + own.low - room, own.base + own.high + room)
        else:
            axes.set_xlim(x[0], x[-1])
        axes.set_ylim(bottom=0.0)
        goal = ",\n".join(_with_unit(found, found.goal_words).rsplit(", ", 1))
        finish(axes, f"{own.axis.key}{unit and f' [{unit}]'}", goal)
    return axes


def plot_optimised_states(found: Optimised, *, ax: Axes | None = None) -> Axes:
    """Draw the quantity in each state as bars, before and after.

    Args:
        found: the optimum of a scene.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.
    """
    names = found.asked.names
    before, after = found.goal(found.best.per_state_before), found.goal(found.best.per_state)
    with drawing(ax, height_mm=58.0) as axes:
        at = np.arange(len(names), dtype=np.float64)
        axes.bar(at - 0.2, before, 0.4, color=_GREY, label="before")
        axes.bar(at + 0.2, after, 0.4, color=line_style(0)["color"], label="after")
        heading, ticks = without_common(names)
        # As many names as can be read.
        step = -(-len(names) // 12)
        axes.set_xticks(at[::step], ticks[::step], parse_math=False)
        if max(map(len, ticks)) * len(ticks[::step]) > 2 * _SHORT:
            axes.tick_params(axis="x", labelrotation=60.0)
        axes.set_xlabel(heading)
        axes.set_ylabel(_with_unit(found, label(found.asked.minimise)))
        axes.grid(visible=True, axis="y")
        axes.set_axisbelow(True)
        value_ticks(axes.yaxis)
        legend_above(axes)
    return axes


def _with_unit(found: Optimised, words: str) -> str:
    return f"{words}{found.goal_unit and f' [{found.goal_unit}]'}"
