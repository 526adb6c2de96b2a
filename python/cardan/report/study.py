"""The section of a study: extent, extremes, and curves of its figures."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.figures.extremes import study_data
from cardan.figures.rounding import alike
from cardan.report.charts import chart, number
from cardan.report.samples import Curve, Panel
from cardan.report.tables import table
from cardan.scene.study import StudyResult
from cardan.scene.units import converted
from cardan.words.summary import figure_text, range_ends

_MOST_CHARTS, _MOST_CURVES, _MOST_POINTS = 12, 5, 1000


def study_section(result: StudyResult) -> str:
    """Return tables and charts of a study as HTML."""
    data = study_data(result)
    varied = [
        (axis.key, str(len(axis.values)), f"{np.min(axis.values):.6g} to {np.max(axis.values):.6g}")
        for axis in result.axes
    ]
    rows = []
    for name, found in data["figures"].items():
        cells = [name]
        low, high = found["least"], found["largest"]
        ends, same = ("not finite", "not finite"), False
        if low is not None and high is not None:
            same = alike(low, high)
            ends = (figure_text(low), figure_text(high)) if same else range_ends(low, high)
        for which, end in zip(("least", "largest"), ends, strict=True):
            cells.append(end)
            at = found.get(f"{which}_at", {})
            placed = at and not same
            cells += [f"{at[axis.key]:.6g}" if placed else "" for axis in result.axes]
        rows.append(cells)
    keys = [f"at {axis.key}" for axis in result.axes]
    parts = []
    if varied:
        caption = f"What varies: {result.rows} drivelines"
        parts.append(table(caption, ("Key", "Values", "Range"), varied))
    parts.append(table("Extremes", ("Figure", "Least", *keys, "Largest", *keys), rows))
    if any(len(axis.values) > 1 for axis in result.axes):
        parts.append(_charts(result))
    return "".join(parts)


def _charts(result: StudyResult) -> str:
    """Figures over the axis with most values, a curve for each of some values of the next one."""
    order = sorted(range(len(result.axes)), key=lambda i: -len(result.axes[i].values))
    along = result.axes[order[0]]
    points = _some(len(along.values), _MOST_POINTS)
    points = points[np.argsort(along.values[points], kind="stable")]
    family = result.axes[order[1]] if len(order) > 1 else None
    members = _some(len(family.values), _MOST_CURVES) if family else np.array([0])
    place = [len(axis.values) // 2 for axis in result.axes]
    figures = []
    for column in result.columns[:_MOST_CHARTS]:
        suffix, values = converted(result.values[column.name], column.unit, False)
        curves = []
        for member in members:
            index: list[Any] = list(place)
            index[order[0]] = points
            label = along.key
            if family:
                index[order[1]] = member
                label = f"{family.key} = {number(family.values[member])}"
            curves.append(Curve(label, np.asarray(values[tuple(index)])))
        if all(np.isfinite(curve.values).all() for curve in curves):
            panel = Panel(f"{column.name}{suffix}", "", tuple(curves))
            figures.append(chart(panel, along.values[points], along.key))
    held = ", ".join(
        f"{result.axes[i].key} = {number(result.axes[i].values[place[i]])}" for i in order[2:]
    )
    note = f'<p class="note">With {escape(held)}.</p>' if held else ""
    return f'{note}<div class="charts">{"".join(figures)}</div>'


def _some(count: int, most: int) -> NDArray[np.intp]:
    """Places from the first to the last of ``count``, evenly spread, at most ``most``."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))
