"""The section of the states: verdict and figures of each, and charts over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.charts import Curve, Panel, Table, chart
from cardan.app.answers.names import column_name, key_name
from cardan.app.answers.page import CLASSES, tables_of
from cardan.app.answers.printed import quantity
from cardan.app.answers.states.figures import (
    StateFigures,
    StatesFigures,
    states_figures,
    without_common,
)
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import YokeFigures
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.scene import Scene
from cardan.app.scene.study.states import StatesResult
from cardan.arrays import FloatArray

_MOST_DRAWN = 8


def states(answer: Answer, table: StatesResult, yokes: YokeFigures | None) -> dict[str, Any]:
    """Return verdicts, tables and charts of the states as plain data for ``page.html``."""
    each: tuple[StateFigures, ...] = answer["states"]
    heading, found = PARTS["states"].heading(each), states_figures(table)
    return {
        "verdicts": [
            {
                "class": CLASSES[state.verdict],
                "state": state.state,
                "words": f"{_bend(state)}, {state.verdict}",
            }
            for state in each
        ],
        "tables": [*tables_of(heading, each), _values(found), _worst(found)],
        "charts": _charts(answer.scene, table, yokes),
    }


def _bend(state: StateFigures) -> str:
    return quantity(
        state.equivalent_bend or 0.0, "deg", bounds=[] if state.limit is None else [state.limit]
    )


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
    for column in table.columns[:_MOST_DRAWN]:
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
