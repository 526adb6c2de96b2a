"""The section of a study: what varies, its best driveline, extremes, curves and maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.app.answers.limits.check import check_row
from cardan.app.answers.limits.figures import motion_of
from cardan.app.answers.names import column_name, key_name
from cardan.app.answers.page import judged_lines
from cardan.app.answers.printed import kind_of_symbol, range_ends
from cardan.app.answers.rounding import ROUNDING
from cardan.app.answers.study.figures import End, extremes
from cardan.app.answers.table import PARTS
from cardan.app.charts.charts import (
    FRAME,
    Curve,
    Panel,
    Table,
    chart,
    number,
    scale_of,
    scaled,
    some,
    ticks,
    ticks_of,
)
from cardan.app.scene.language.units import in_degrees
from cardan.app.scene.scene import Scene
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray
from cardan.design.check import Check

# Shares of a limit that differ by less are equal.
_EQUAL = 1e-6

# Figures that are drawn, curves that one chart can tell apart, points of a curve.
_MOST_DRAWN, _MOST_CURVES, _MOST_POINTS = 12, 6, 1000


def study(scene: Scene, result: StudyResult, found: Check) -> dict[str, Any]:
    """Return tables, charts and maps of a study as plain data for the page.

    The check is that of its drivelines in the order of its rows, as ``check_scene`` makes it.
    """
    tables = [_extremes(result)]
    if not result.axes:
        return {"tables": tables, "best": None, "charts": [], "maps": [], "notes": []}
    varied = [
        (key_name(a.key), str(len(a.values)), f"{np.min(a.values):.6g} to {np.max(a.values):.6g}")
        for a in result.axes
    ]
    caption = f"What varies: {result.rows} drivelines"
    tables.insert(0, Table(caption, ("Input", "Values", "Range"), varied))
    row, ties = _best(found)
    place = np.unravel_index(row, result.shape)
    figures = judged_lines(PARTS["limits"].entries(motion_of(scene, check_row(scene, row))))
    best = {"at": _at(result.axes, place), "figures": figures, "ties": ties}
    drawn = _drawn(result, place)
    return {"tables": tables, "best": best, **drawn}


def _extremes(result: StudyResult) -> Table:
    rows = []
    for found in extremes(result):
        name, ends = column_name(found.source), (found.least, found.largest)
        if not found.is_finite:
            rows.append([name, "", "not finite", *("" for _ in result.axes)])
        elif not found.varies:
            rows.append([name, "", found.texts[0], *("any" for _ in result.axes)])
        else:
            for which, text, end in zip(("least", "largest"), found.texts, ends, strict=True):
                rows.append([name, which, text, *_places(result, end)])
    keys = [f"at {key_name(axis.key)}" for axis in result.axes]
    return Table("Extremes", ("Figure", "", "Value", *keys), rows)


def _places(result: StudyResult, end: End) -> list[str]:
    """The value of each key there; "any" of one on which the figure does not depend."""
    return [f"{end.at[axis.key]:.6g}" if axis.key in end.at else "any" for axis in result.axes]


def _best(found: Check) -> tuple[int, int]:
    """The row whose largest share of a limit is least, and how many rows are as good.

    Of these it is the one with the least excitation that is not judged, where there is any.
    """
    values = {finding.figure: np.ravel(finding.value) for finding in found.findings}
    shares = [
        values[finding.figure] / finding.limit.limit
        for finding in found.findings
        if finding.limit and not finding.needs_speed
    ]
    worst = np.max(shares, axis=0)
    worst = np.where(np.isnan(worst), np.inf, worst)
    # Bends that cancel leave the root of what is rounding.
    rows = np.flatnonzero(worst <= np.min(worst) + _EQUAL)
    others = [values[finding.figure][rows] for finding in found.findings if not finding.limit]
    excitation = np.sum(others, axis=0) if others else np.zeros(len(rows))
    least = excitation <= np.min(excitation) * (1.0 + ROUNDING) + ROUNDING
    return int(rows[np.argmax(least)]), int(np.count_nonzero(least))


def _at(axes: Sequence[Axis], place: Sequence[Any]) -> str:
    """Keys with their values at a place, in words."""
    said = []
    for axis, i in zip(axes, place, strict=True):
        name, _, unit = key_name(axis.key).partition(" [")
        said.append(f"{name}: {number(axis.values[i])} {unit.removesuffix(']')}".rstrip())
    return "; ".join(said)


def _drawn(result: StudyResult, best: Sequence[Any]) -> dict[str, Any]:
    """Charts over one key with a curve for each value of a second, or maps over both.

    A second key of more values than a chart has curves makes maps. Further keys are held where
    the best driveline has them.
    """
    order = sorted(
        (i for i in range(len(result.axes)) if len(result.axes[i].values) > 1),
        key=lambda i: -len(result.axes[i].values),
    )
    keys, held = order[:2], order[2:]
    drawn: dict[str, Any] = {"charts": [], "maps": [], "notes": []}
    if not keys:
        return drawn
    notes = drawn["notes"]
    if held:
        at = _at([result.axes[i] for i in held], [best[i] for i in held])
        notes.append(f"Drawn for the best driveline's {at}.")
    axes = [result.axes[i] for i in keys]
    # A list in a scene need not rise.
    ascending = [np.argsort(axis.values, kind="stable") for axis in axes]
    infinite = []
    for column in result.columns[:_MOST_DRAWN]:
        index: list[Any] = list(best)
        for i in keys:
            index[i] = slice(None)
        values, unit = in_degrees(result.values[column.name][tuple(index)], column.unit)
        # The longer key comes first.
        values = values.T if keys != sorted(keys) else values
        values = values[np.ix_(*ascending)]
        grids = [axis.values[rising] for axis, rising in zip(axes, ascending, strict=True)]
        name = column_name(column)
        heading = name.partition(" [")[0]
        if not np.isfinite(values).all():
            infinite.append(name)
        elif len(keys) == 2 and len(grids[1]) > _MOST_CURVES:
            labels = [key_name(axis.key) for axis in axes]
            x, y = grids
            drawn["maps"].append(heat_map(Panel(heading, unit, ()), x, y, values.T, labels))
        else:
            drawn["charts"].append(_chart(Panel(heading, unit, ()), axes, grids, values))
    if infinite:
        notes.append(f"Not drawn, because some values are not finite: {'; '.join(infinite)}.")
    count = len(result.columns)
    if count > _MOST_DRAWN:
        notes.append(f"The first {_MOST_DRAWN} of {count} figures are drawn.")
    return drawn


def _chart(
    panel: Panel, axes: list[Axis], grids: list[FloatArray], values: FloatArray
) -> dict[str, Any]:
    points = some(len(grids[0]), _MOST_POINTS)
    labels = [key_name(axes[0].key)]
    if len(grids) == 2:
        labels = [_at([axes[1]], [i]) for i in np.argsort(axes[1].values, kind="stable")]
    curves = tuple(
        Curve(label, values[points, i] if len(grids) == 2 else values[points])
        for i, label in enumerate(labels)
    )
    return chart(replace(panel, curves=curves), grids[0][points], key_name(axes[0].key))


# --- maps: bands of colour over two keys, the least value marked ---------------------------------

# More cells than that are finer than the page shows.
_MOST_ACROSS, _MOST_UP = 96, 64


def heat_map(
    panel: Panel, x: FloatArray, y: FloatArray, values: FloatArray, labels: list[str]
) -> dict[str, Any]:
    """Return heading, ticks, bands and their legend as plain data for the macro ``map``.

    The values, ``(rows, columns)``, are finite, and those of both keys, x across, rise.
    """
    low, high, flat = scale_of(values, panel.scale)
    levels = np.array(ticks(low, high, 7.0))
    rows, columns = some(len(y), _MOST_UP), some(len(x), _MOST_ACROSS)
    across, up = _edges(x[columns]), _edges(y[rows])
    shown = np.full_like(values, np.mean(values)) if flat else values
    bands = np.digitize(shown[np.ix_(rows, columns)], levels[1:-1])
    to_x = scaled(across[0], across[-1], FRAME.left, FRAME.right)
    to_y = scaled(up[0], up[-1], FRAME.bottom, FRAME.top)
    place = np.unravel_index(int(np.argmin(values)), values.shape)
    x_label, y_label = labels
    heading = f"{panel.heading} [{panel.unit}]" if panel.unit else panel.heading
    ends = (float(np.min(values)), float(np.max(values)))
    spoken = " to ".join(range_ends(*ends, kind_of_symbol(panel.unit)))
    return {
        "frame": FRAME,
        "heading": heading,
        "spoken": f"{heading} over {x_label} and {y_label}, from {spoken}",
        "x_label": x_label,
        "y_label": y_label,
        "x_ticks": [(f"{to_x(t):.1f}", number(t)) for t in ticks_of(x_label, x[0], x[-1])],
        "y_ticks": [(f"{to_y(t) + 4:.1f}", number(t)) for t in ticks_of(y_label, y[0], y[-1])],
        "bands": [
            {
                "path": _path(bands == band, to_x(across), to_y(up)),
                "label": f"{number(levels[band])} to {number(levels[band + 1])}",
            }
            for band in range(len(levels) - 1)
        ],
        "least": None if flat else [f"{to_x(x[place[1]]):.1f}", f"{to_y(y[place[0]]):.1f}"],
        "least_at": f"{number(x[place[1]])}, {number(y[place[0]])}",
        "thinned": f"{len(columns)} of {len(x)} by {len(rows)} of {len(y)} values are drawn"
        if len(rows) < len(y) or len(columns) < len(x)
        else "",
    }


def _path(inside: Any, x: FloatArray, y: FloatArray) -> str:  # noqa: ANN401 - booleans
    """Bars over the cells of one band, each as long as its run of columns."""
    bars = []
    for row, cells in enumerate(inside):
        ends = np.flatnonzero(np.diff(np.concatenate([[False], cells, [False]]).astype(int)))
        bars += [
            f"M{x[first]:.1f} {y[row]:.1f}H{x[last]:.1f}V{y[row + 1]:.1f}H{x[first]:.1f}z"
            for first, last in ends.reshape(-1, 2)
        ]
    return "".join(bars)


def _edges(places: FloatArray) -> FloatArray:
    """Borders of cells around places: halfway between neighbours, and as far beyond the ends."""
    middles = (places[1:] + places[:-1]) / 2.0
    first, last = 2.0 * places[0] - middles[0], 2.0 * places[-1] - middles[-1]
    return np.concatenate([[first], middles, [last]])
