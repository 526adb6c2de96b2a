"""A figure of every state as a bar, and of a study as a map or as curves, with its limit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.names import column_name, key_name
from cardan.app.answers.rounding import ROUNDING, flat_limits
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.study.states import StatesResult
from cardan.app.scene.study.study import Column, StudyResult
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.design.limits import MAX_EQUIVALENT_BEND

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.contour import QuadContourSet


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

    Returns:
        the axes, with angles in degrees.

    Raises:
        ValueError: an unknown column.
    """
    style.check_kind("states", states, StatesResult)
    of, values, unit, bound = _shown(states, column, limit)
    names = states.states.names
    with style.drawing(ax, height_mm=height_mm(len(names))) as axes:
        places = np.arange(len(names))
        bars = axes.barh(places, values, height=0.62, color=style.LINES[0]["color"])
        if bound is not None:
            for bar, value in zip(bars, values, strict=True):
                if value > bound * (1.0 + 1e-9):
                    bar.set(facecolor="white", edgecolor=style.LINES[1]["color"], hatch="/////")
            axes.axvline(
                bound, label=f"limit {style.number(round(bound, 9))} {unit}".strip(), **style.THIN
            )
            style.legend_above(axes)
        axes.set_yticks(places, names, parse_math=False)
        axes.invert_yaxis()
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel(column_name(of))
        style.value_ticks(axes.xaxis)
        axes.grid(visible=True, axis="x")
        axes.set_axisbelow(True)
    return axes


def _shown(
    study: StudyResult, column: str, limit: float | None
) -> tuple[Column, FloatArray, str, float | None]:
    """A column with its values, their unit as axes have it, and its limit in that unit."""
    if column not in study.values:
        raise ArgumentValueError("column", f"is {column!r}; {nearest(column, study.values)}")
    of = next(known for known in study.columns if known.name == column)
    if limit is None and column == "equivalent_bend":
        limit = MAX_EQUIVALENT_BEND
    values, unit = as_shown(study.values[column], of.unit)
    return of, values, unit, None if limit is None else float(as_shown(np.array(limit), of.unit)[0])


_FEW = 5

_LIMIT: Mapping[str, Any] = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.6}


def plot_study(
    study: StudyResult,
    column: str = "equivalent_bend",
    *,
    limit: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a figure over the one or two keys that a study varies.

    Two keys make a map, the first of them along x, whose lines carry their values; a key of five
    values or fewer makes a curve for each.

    Args:
        study: the ``study`` of an evaluated scene.
        column: name of one of its columns.
        limit: a value to mark, in SI units; by default that of the catalogues for the equivalent
            bend, none for other columns.

    Returns:
        the axes, with angles in degrees.

    Raises:
        ValueError: an unknown column, a study of no key or more than two.
    """
    style.check_kind("study", study, StudyResult)
    _, found, unit, limit = _shown(study, column, limit)
    varied = [axis for axis in study.axes if len(axis.values) > 1]
    if len(varied) not in (1, 2):
        count = f"{len(varied)} keys" if varied else "no key"
        raise ValueError(f"the study varies {count}; a picture shows 1 or 2")
    # A list in a scene need not rise.
    orders = [np.argsort(axis.values) for axis in varied]
    values: Any = np.ma.masked_invalid(found.squeeze()[np.ix_(*orders)])
    marked = "" if limit is None else f"limit {style.number(limit)} {unit}".strip()
    heading = f"{column.replace('_', ' ')}{unit and f' [{unit}]'}"
    keys = [axis.key for axis in varied]
    grid = [axis.values[order] for axis, order in zip(varied, orders, strict=True)]
    if len(grid) == 2 and len(grid[0]) < len(grid[1]) and len(grid[0]) <= _FEW:
        keys, grid, values = keys[::-1], grid[::-1], values.T
    with style.drawing(ax, height_mm=62.0) as axes:
        if len(grid) == 2 and len(grid[1]) > _FEW:
            _map(axes, grid[0], grid[1], values.T, limit)
            # Contours are nothing for a legend.
            axes.plot([], [], label=marked, **_LIMIT)
            axes.set_title(heading, loc="left")
            _label(axes.yaxis, keys[1])
            title = ""
        else:
            rows = np.atleast_2d(values.T)
            names = [style.number(value) for value in grid[1]] if len(grid) == 2 else [""]
            for i, (name, row) in enumerate(zip(names, rows, strict=True)):
                axes.plot(grid[0], row, label=name, **style.LINES[i])
            if limit is not None:
                axes.axhline(limit, label=marked, **style.THIN)
            axes.grid(visible=True)
            axes.set_ylabel(heading)
            style.value_ticks(axes.yaxis)
            title = key_name(keys[1]) if len(grid) == 2 else ""
        _label(axes.xaxis, keys[0])
        if axes.get_legend_handles_labels()[1]:
            style.legend_above(axes, title=title, alignment="right", ncols=4)
    return axes


def _map(axes: Axes, x: FloatArray, y: FloatArray, z: FloatArray, limit: float | None) -> None:
    from matplotlib import colormaps
    from matplotlib.ticker import MaxNLocator

    low, high = float(np.min(z)), float(np.max(z))
    flat = flat_limits(low, high, 1.0)
    levels = flat or MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(low, high)
    # Light enough for black lines and figures, and the lighter the smaller, in grey as well.
    colours = colormaps["Blues"](np.linspace(0.02, 0.55, len(levels) - 1))
    axes.contourf(x, y, z, levels=levels, colors=colours)
    if flat:
        return
    near = ROUNDING * (high - low)
    taken = math.inf if limit is None else limit
    inner = [level for level in levels if low < level < high and abs(level - taken) > near]
    lines = axes.contour(x, y, z, levels=inner, colors="0.15", linewidths=0.5)
    for text in axes.clabel(lines, fmt=style.number, fontsize="small", manual=_middles(lines)):
        # A 6 on its side could be a 9; long figures need the direction of their lines.
        if len(text.get_text()) < 3:
            text.set_rotation(0.0)
    if limit is not None and low < limit < high:
        # Contours have their styles in the plural.
        look: Mapping[str, Any] = {f"{name}s": [value] for name, value in _LIMIT.items()}
        axes.contour(x, y, z, levels=[limit], **look)


def _middles(lines: QuadContourSet) -> list[tuple[float, float]]:
    """The middle of the longest part of each line that is long enough for its figures."""
    longest = [max(parts, key=len) for parts in lines.allsegs if parts]
    whole = np.ptp(np.concatenate(longest), axis=0) if longest else None
    return [
        (float(part[len(part) // 2][0]), float(part[len(part) // 2][1]))
        for part in longest
        if np.max(np.ptp(part, axis=0) / whole) > 0.15
    ]


def _label(axis: Axis, key: str) -> None:
    axis.set_label_text(key_name(key))
    if key_name(key).endswith("[deg]"):
        style.degree_ticks(axis, *axis.get_view_interval())
    else:
        style.value_ticks(axis)
