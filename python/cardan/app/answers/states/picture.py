"""A figure of every state as a bar, beside its limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cardan.app.answers.names import column_name
from cardan.app.pictures.style import (
    LINES,
    THIN,
    check_kind,
    drawing,
    legend_above,
    number,
    value_ticks,
)
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.study.states import StatesResult
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.design.limits import MAX_EQUIVALENT_BEND

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Millimetres for each state and for what is around all of them.
_EACH, _AROUND = 5.0, 24.0


def height_mm(count: int) -> float:
    """Return how high a picture of so many states is, in mm."""
    return _AROUND + _EACH * max(count, 4)


def plot_states(
    states: StatesResult,
    column: str = "equivalent_bend",
    *,
    limit: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a figure of every state as a bar, the first state on top.

    Args:
        states: the ``study`` of an evaluated scene with states.
        column: name of one of its columns.
        limit: a value to mark, in SI units; bars beyond it are hatched. By default that of the
            catalogues for the equivalent bend, none for other columns.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Returns:
        the axes, with angles in degrees.

    Raises:
        ValueError: an unknown column.
    """
    check_kind("states", states, StatesResult)
    if column not in states.values:
        raise ArgumentValueError("column", f"is {column!r}; {nearest(column, states.values)}")
    of = next(known for known in states.columns if known.name == column)
    if limit is None and column == "equivalent_bend":
        limit = MAX_EQUIVALENT_BEND
    values, unit = as_shown(states.values[column], of.unit)
    names = states.states.names
    with drawing(ax, height_mm=height_mm(len(names))) as axes:
        places = np.arange(len(names))
        bars = axes.barh(places, values, height=0.62, color=LINES[0]["color"])
        if limit is not None:
            bound = float(as_shown(np.array(limit), of.unit)[0])
            for bar, value in zip(bars, values, strict=True):
                if value > bound * (1.0 + 1e-9):
                    bar.set(facecolor="white", edgecolor=LINES[1]["color"], hatch="/////")
            axes.axvline(bound, label=f"limit {number(round(bound, 9))} {unit}".strip(), **THIN)
            legend_above(axes)
        axes.set_yticks(places, names, parse_math=False)
        axes.invert_yaxis()
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel(column_name(of))
        value_ticks(axes.xaxis)
        axes.grid(visible=True, axis="x")
        axes.set_axisbelow(True)
    return axes
