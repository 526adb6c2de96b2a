"""The optimum found: the quantity over each variable, and each state before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.names import key_name
from cardan.app.answers.optimise.figures import Optimised, by_state
from cardan.app.answers.page import Curve, Panel, Table, chart
from cardan.app.answers.printed import plain_text, symbol_of, table_of, with_unit
from cardan.app.answers.rows import NotFound
from cardan.app.answers.states import without_common
from cardan.app.scene.language.units import shown_unit
from cardan.arrays.errors import ArgumentValueError
from cardan.design.quantities import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Wider than this, in letters, names of states are written aslant.
_SHORT = 30

_GREY = "0.75"

_BEYOND: dict[str, Any] = {
    **style.THIN,
    "color": style.line_style(0)["color"],
    "linestyle": (0, (1, 1.2)),
}
_TEETH: dict[str, Any] = {"linestyle": "none", "marker": "|", "markersize": 6.0, "color": "0.35"}

_HEIGHT = 58.0  # mm


def drawn(_: Answer, found: Optimised | NotFound) -> dict[str, Any]:
    """Return tables of the states and a chart over each variable, the others at their best."""
    if isinstance(found, NotFound):
        return {}
    tables = []
    for caption, states in by_state(found):
        head, rows = table_of(states)
        first, *others = zip(head, *rows, strict=True)
        tables.append(Table(caption, first, others))
    return {"tables": tables, "charts": [_chart(found, i) for i in range(len(found.variables))]}


def _chart(found: Optimised, number: int) -> dict[str, Any]:
    variable, over = found.asked.variables[number], found.over(number)
    known = np.isfinite(over.values)
    best = variable.base + float(found.best.x[number])
    curves = [
        Curve(
            f"best at {plain_text(best, variable.unit)} {symbol_of(variable.unit)}".strip(),
            over.within[known],
        )
    ]
    if np.any(np.isfinite(over.beyond)):
        curves.append(Curve("beyond a limit", over.beyond[known]))
    panel = Panel(found.goal_words, symbol_of(shown_unit(found.minimised.unit)), tuple(curves), 1.0)
    return chart(panel, over.x[known], _name(found, number))


def _name(found: Optimised, number: int) -> str:
    """A variable in words, with its unit."""
    return key_name(found.asked.variables[number].axis.key, found.scene.line.n_joints)


def plot_optimise(found: Optimised) -> Figure:
    """Draw the figures of each state, and the quantity over each variable.

    Args:
        found: the optimum of a scene, from ``cardan.app.answers.optimise.figures.optimised``.

    Returns:
        a figure of 170 mm width with a panel for the states and one for each variable.
    """
    style.check_kind("found", found, Optimised)
    count = len(found.variables)
    rows = count // 2 + 1
    with style.page(170.0, _HEIGHT * rows, found.scene.title, 90) as figure:
        plot_optimised_states(found, ax=figure.add_subplot(rows, 2, 1))
        for i in range(count):
            plot_over_variable(found, i, ax=figure.add_subplot(rows, 2, i + 2))
    return figure


def _whole(answer: Answer) -> Figure:
    """Best values: curves over variables, states before and after."""
    found = answer.needed("optimise")
    if isinstance(found, NotFound):
        raise ValueError(found.reason)
    return plot_optimise(found)


PICTURES = {"optimise": _whole}


def plot_over_variable(found: Optimised, variable: int, *, ax: Axes | None = None) -> Axes:
    """Draw the quantity over one variable, with its range, the start and the optimum.

    The other variables have their best values. A free phase is drawn over half a turn. The curve is
    dotted where a quantity is above the limit that it has to keep.

    Args:
        found: the optimum of a scene.
        variable: number of the variable.

    Raises:
        ValueError: a variable that does not exist.
    """
    style.check_kind("found", found, Optimised)
    count = len(found.variables)
    if not 0 <= variable < count:
        raise ArgumentValueError("variable", f"is {variable}; there are {count}, counted from 0")
    own, curve = found.asked.variables[variable], found.over(variable)
    best = own.base + float(found.best.x[variable])
    with style.drawing(ax, height_mm=_HEIGHT) as axes:
        axes.plot(curve.x, curve.within, **style.line_style(0))
        if np.any(np.isfinite(curve.beyond)):
            axes.plot(curve.x, curve.beyond, label="beyond a limit", **_BEYOND)
        if own.teeth:
            pitch = 360.0 / own.teeth
            first, last = (curve.x[[0, -1]] - own.base) / pitch
            turned = own.base + pitch * np.arange(np.ceil(first), np.floor(last) + 1.0)
            heights = np.interp(turned, curve.x, curve.values)
            axes.plot(turned, heights, label="teeth", **_TEETH)
        axes.axvline(own.base, label="scene", **{**style.THIN, "linestyle": (0, (4, 1.5))})
        dot: dict[str, Any] = {"markersize": 4.0, "color": style.line_style(1)["color"]}
        axes.plot([best], [float(found.goal(found.best.value))], "o", label="best", **dot)
        axes.set_xlim(curve.x[0], curve.x[-1])
        if np.isfinite(own.high - own.low):
            ends, room = own.base + np.array([own.low, own.high]), 0.06 * (own.high - own.low)
            for end, outside in zip(ends, (-room, room), strict=True):
                axes.axvspan(end + outside, end, color=_GREY, linewidth=0.0)
            axes.set_xlim(ends[0] - room, ends[1] + room)
        axes.set_ylim(bottom=0.0)
        goal = with_unit(found.goal_words, found.minimised.unit)
        style.finish(axes, _name(found, variable), ",\n".join(goal.rsplit(", ", 1)))
    return axes


def plot_optimised_states(found: Optimised, *, ax: Axes | None = None) -> Axes:
    """Draw the quantity in each state as bars, before and after."""
    style.check_kind("found", found, Optimised)
    names = found.asked.names
    before, after = found.goal(found.best.per_state_before), found.goal(found.best.per_state)
    with style.drawing(ax, height_mm=_HEIGHT) as axes:
        at = np.arange(len(names), dtype=np.float64)
        axes.bar(at - 0.2, before, 0.4, color=_GREY, label="before")
        axes.bar(at + 0.2, after, 0.4, color=style.line_style(0)["color"], label="after")
        heading, ticks = without_common(names)
        # As many names as can be read.
        step = -(-len(names) // 12)
        axes.set_xticks(at[::step], ticks[::step], parse_math=False)
        if max(map(len, ticks)) * len(ticks[::step]) > 2 * _SHORT:
            axes.tick_params(axis="x", labelrotation=60.0)
        axes.set_xlabel(heading)
        axes.set_ylabel(with_unit(label(found.asked.minimise), found.minimised.unit))
        axes.grid(visible=True, axis="y")
        axes.set_axisbelow(True)
        style.value_ticks(axes.yaxis)
        style.legend_above(axes)
    return axes
