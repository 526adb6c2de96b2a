"""The section of what may change: what to change, what that brings, and how exact it must be."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.optimise.figures import Optimised, optimised, unit_of
from cardan.app.answers.optimise.text import (
    change_lines,
    limit_lines,
    result_text,
    table_of,
)
from cardan.app.charts.charts import Curve, Panel, Table, chart
from cardan.app.scene.scene import Scene
from cardan.motion.workshop import VIEW


def optimise(scene: Scene) -> dict[str, Any] | None:
    """Return an optimum as plain data for ``optimise.html``; ``None`` without [optimise].

    A limit that cannot be kept, or SciPy that is missing, becomes a sentence of the section.
    """
    try:
        found = optimised(scene)
    except (ImportError, ValueError) as error:
        return {
            "result": f"{error}.",
            "view": "",
            "changes": [],
            "limits": [],
            "table": None,
            "charts": [],
        }
    if found is None:
        return None
    headings, rows = table_of(found)
    return {
        "result": result_text(found),
        "view": f"Senses of rotation are seen {VIEW}.",
        "changes": [_sentence(words) for words in change_lines(found)],
        "limits": limit_lines(found),
        "table": Table("Before and after", tuple(headings), rows),
        "charts": [_chart(found, i) for i in range(len(found.asked.variables))],
    }


def _chart(found: Optimised, number: int) -> dict[str, Any]:
    variable = found.asked.variables[number]
    over = found.over(number)
    known = np.isfinite(over.values)
    unit = unit_of(variable)
    best = variable.base + float(found.best.x[number])
    curves = [Curve(f"best at {best:.6g}{unit and f' {unit}'}", over.within[known])]
    if np.any(np.isfinite(over.beyond)):
        curves.append(Curve("beyond a limit", over.beyond[known]))
    panel = Panel(found.goal_words, found.goal_unit, tuple(curves), 1.0)
    return chart(
        panel, variable.base + over.changes[known], f"{variable.axis.key}{unit and f' [{unit}]'}"
    )


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."
