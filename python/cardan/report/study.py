"""The section of a study: extent, extremes, and curves of its figures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.figures.extremes import extremes
from cardan.figures.rounding import alike
from cardan.report.charts import chart, number
from cardan.report.samples import Curve, Panel
from cardan.report.tables import Table
from cardan.scene.study import StudyResult
from cardan.scene.units import converted
from cardan.words.summary import figure_text, range_ends

_MOST_CHARTS, _MOST_CURVES, _MOST_POINTS = 12, 5, 1000


def study(result: StudyResult) -> dict[str, Any]:
    """Return tables and charts of a study as plain data for the page."""
    keys = [f"at {axis.key}" for axis in result.axes]
    rows = []
    for found in extremes(result):
        cells = [found.name]
        low, high = found.least.value, found.largest.value
        ends, same = ("not finite", "not finite"), False
        if math.isfinite(low) and math.isfinite(high):
            same = alike(low, high)
            ends = (figure_text(low), figure_text(high)) if same else range_ends(low, high)
        for text, end in zip(ends, (found.least, found.largest), strict=True):
            cells.append(text)
            places = {} if same else end.at
            cells += [
                f"{places[axis.key]:.6g}" if axis.key in places else "" for axis in result.axes
            ]
        rows.append(cells)
    tables = [Table("Extremes", ("Figure", "Least", *keys, "Largest", *keys), rows)]
    if result.axes:
        varied = [
            (a.key, str(len(a.values)), f"{np.min(a.values):.6g} to {np.max(a.values):.6g}")
            for a in result.axes
        ]
        caption = f"What varies: {result.rows} drivelines"
        tables.insert(0, Table(caption, ("Key", "Values", "Range"), varied))
    varies = any(len(axis.values) > 1 for axis in result.axes)
    charts, held = _charts(result) if varies else ([], "")
    return {"tables": tables, "charts": charts, "held": held}


def _charts(result: StudyResult) -> tuple[list[dict[str, Any]], str]:
    """Charts over the axis with most values, with a curve for each of some values of the next one.

    Also returns the values at which the other axes are held, in words.
    """
    order = sorted(range(len(result.axes)), key=lambda i: -len(result.axes[i].values))
    along = result.axes[order[0]]
    points = _some(len(along.values), _MOST_POINTS)
    points = points[np.argsort(along.values[points], kind="stable")]
    family = result.axes[order[1]] if len(order) > 1 else None
    members = _some(len(family.values), _MOST_CURVES) if family else np.array([0])
    place = [len(axis.values) // 2 for axis in result.axes]
    charts = []
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
            charts.append(chart(panel, along.values[points], along.key))
    held = (f"{result.axes[i].key} = {number(result.axes[i].values[place[i]])}" for i in order[2:])
    return charts, ", ".join(held)


def _some(count: int, most: int) -> NDArray[np.intp]:
    """Places from the first to the last of ``count``, evenly spread, at most ``most``."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))
