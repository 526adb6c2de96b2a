"""The section of the states: verdict and figures of each, and charts over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits import motion_of
from cardan.app.answers.names import column_name, key_name
from cardan.app.answers.over import check_row
from cardan.app.answers.page import (
    CLASSES,
    Curve,
    Panel,
    Table,
    chart,
    judged_lines,
    plain,
    some,
    tables_of,
)
from cardan.app.answers.printed import quantity
from cardan.app.answers.rounding import ROUNDING
from cardan.app.answers.states import StateFigures, StatesFigures, states_figures, without_common
from cardan.app.answers.study import extremes
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import YokeFigures
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.scene import Scene
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.states import StatesResult
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray
from cardan.design.check import Check

_MOST_OVER_STATES = 8


def states(answer: Answer, table: StatesResult, yokes: YokeFigures | None) -> dict[str, Any]:
    """Return verdicts, tables and charts of the states as plain data for ``states.html``."""
    each: tuple[StateFigures, ...] = answer["states"]
    heading, found = PARTS["states"].heading(each), states_figures(table)
    verdicts = []
    for state in each:
        bounds = [] if state.limit is None else [state.limit]
        bend = quantity(state.equivalent_bend or 0.0, "deg", bounds=bounds)
        words = f"{bend}, {state.verdict}"
        verdicts.append({"class": CLASSES[state.verdict], "state": state.state, "words": words})
    return {
        "verdicts": verdicts,
        "tables": [*tables_of(heading, each), _values(found), _worst(found)],
        "charts": _charts(answer.scene, table, yokes),
    }


def _values(found: StatesFigures) -> Table:
    """A row for each state: the values of its keys and its figures."""
    columns = [[f"{value:.6g}" for value in key.values] for key in found.keys]
    columns += [[each.text(value) for value in each.values] for each in found.figures]
    heads = [key_name(key.key) for key in found.keys]
    heads += [column_name(each.source.source) for each in found.figures]
    rows = list(zip(found.names, *columns, strict=True))
    return Table(f"Figures of {len(found.names)} states", ("State", *heads), rows)


def _worst(found: StatesFigures) -> Table:
    rows = []
    for each in found.figures:
        cells = [column_name(each.source.source)]
        for end in (each.least, each.largest):
            cells += [each.text(end.value), end.state or "all"]
        rows.append(cells)
    return Table("Least and largest", ("Figure", "Least", "in state", "Largest", "in state"), rows)


def _charts(scene: Scene, table: StatesResult, yokes: YokeFigures | None) -> list[dict[str, Any]]:
    axes, count = table.states.axes, table.states.count
    if count < 2:
        return []
    x, label = np.arange(float(count)), "state, counted from 0"
    named: tuple[str, Sequence[str]] | None = None
    if len(axes) == 1 and np.all(np.diff(axes[0].values) > 0.0):
        x, label = axes[0].values, key_name(axes[0].key)
    else:
        common, names = without_common(table.states.names)
        named = key_name(common or "state"), names
    made = []
    for column in table.columns[:_MOST_OVER_STATES]:
        values, unit = as_shown(table.values[column.name], column.unit)
        if not np.isfinite(values).all():
            continue
        curves = [Curve("as the yokes are", values)]
        if column.name == "equivalent_bend":
            curves += _compared(scene, yokes, count)
        heading = column_name(column).partition(" [")[0]
        made.append(chart(Panel(heading, unit, tuple(curves)), x, label, named))
    return made


def _compared(scene: Scene, yokes: YokeFigures | None, count: int) -> list[Curve]:
    """Curves beside the equivalent bend: with the best common setting, and the limit."""
    limit = scene.limits.figures["equivalent_bend_deg"].limit
    curves = []
    if yokes and yokes.states:
        bends = yokes.states.equivalent_bend_deg
        best: FloatArray = np.array(bends.on_teeth or bends.best)
        curves.append(Curve("with the best common setting", best))
    return [*curves, Curve(f"limit {limit:g} deg", np.full(count, limit))]


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
        return {"tables": tables, "best": None, "charts": [], "notes": []}
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
                # A figure does not depend on every key.
                at = [f"{end.at[a.key]:.6g}" if a.key in end.at else "any" for a in result.axes]
                rows.append([name, which, text, *at])
    keys = [f"at {key_name(axis.key)}" for axis in result.axes]
    return Table("Extremes", ("Figure", "", "Value", *keys), rows)


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
        value = f"{axis.values[i]:.10g}".replace("-", "\N{MINUS SIGN}")
        said.append(f"{name}: {value} {unit.removesuffix(']')}".rstrip())
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
    drawn: dict[str, Any] = {"charts": [], "notes": []}
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
        values, unit = as_shown(result.values[column.name][tuple(index)], column.unit)
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
            drawn["charts"].append(heat_map(Panel(heading, unit, ()), x, y, values.T, labels))
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
    """Return a quantity over two keys as plain data for the macro ``drawing``.

    The values, ``(rows, columns)``, are finite, and those of both keys, x across, rise.
    """
    rows, columns = some(len(y), _MOST_UP), some(len(x), _MOST_ACROSS)
    place = np.unravel_index(int(np.argmin(values)), values.shape)
    return {
        "kind": "map",
        "heading": panel.heading,
        "unit": panel.unit,
        "over": labels[0],
        "beside": labels[1],
        "x": plain(x[columns], x, digits=7),
        "y": plain(y[rows], y, digits=7),
        "values": [plain(row, values) for row in values[np.ix_(rows, columns)]],
        "scale": panel.scale,
        "least": [float(x[place[1]]), float(y[place[0]])],
        "thinned": f"{len(columns)} of {len(x)} by {len(rows)} of {len(y)} values are drawn"
        if len(rows) < len(y) or len(columns) < len(x)
        else "",
    }
