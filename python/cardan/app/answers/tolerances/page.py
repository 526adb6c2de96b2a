"""The section of tolerances: its rows, how the drivelines scatter and what makes them."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.page import section_of
from cardan.app.answers.printed import quantity
from cardan.app.answers.rows import UNITS
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import (
    Share,
    ToleranceFigure,
    ToleranceFigures,
    in_its_unit,
    permitted_tolerances,
    with_symbol,
)
from cardan.app.answers.tolerances.text import percent, permitted_texts, state_rows
from cardan.app.charts.charts import Curve, Panel, Table, chart
from cardan.tolerances import Tolerances

_POINTS, _MOST_BARS = 200, 10


def section(answer: Answer, found: ToleranceFigures) -> dict[str, Any]:
    """Return tolerances as plain data for ``page.html``."""
    of, arms = answer.scene.tolerances, answer.scene.tolerance_arms
    assert of
    plain = section_of(PARTS["tolerances"], found)
    plain["sentences"] += permitted_texts(found, permitted_tolerances(of, arms))
    for figure in found.figures:
        if states := state_rows(figure):
            title = f"{figure.label.capitalize()} in each state"
            plain["tables"].append(Table(title, tuple(map(str.capitalize, states[0])), states[1:]))
    return {
        **plain,
        "figures": [
            {
                "label": figure.label,
                "chart": _scatter(figure, of),
                "shares": _bars([each for each in found.shares if each.name == figure.name]),
            }
            for figure in found.figures
        ],
    }


def _scatter(figure: ToleranceFigure, of: Tolerances) -> dict[str, Any]:
    """The share of the drivelines up to each value, with the limit as a step."""
    sampled, worst = (in_its_unit(of, figure.name, each) for each in (of.ascending, of.worst))
    limit = None if figure.limit is None else UNITS[figure.unit].factor * figure.limit
    high = max(float(sampled[-1]), float(worst), limit or 0.0)
    x = np.linspace(float(sampled[0]), high if high > sampled[0] else sampled[0] + 1.0, _POINTS)
    if limit is not None:
        x = np.sort(np.append(x, [limit, limit]))
    shares = 100.0 * np.searchsorted(sampled, x, side="right") / len(sampled)
    curves = [Curve("share up to this value", shares)]
    if limit is not None and figure.limit is not None:
        step = np.where(x > limit, 100.0, 0.0)
        step[np.searchsorted(x, limit, side="left") + 1] = 100.0
        curves.append(Curve(f"limit {quantity(figure.limit, figure.unit)}", step))
    panel = Panel(f"Random drivelines up to this {figure.label}", "%", tuple(curves), 100.0)
    return chart(panel, x, with_symbol(of, figure.name))


def _bars(shares: list[Share]) -> list[dict[str, Any]]:
    """Shares as bars: the width of the longest is 100."""
    bars = [(f"{each.label[0].upper()}{each.label[1:]}", each.share) for each in shares]
    others = bars[_MOST_BARS:]
    if rest := sum(share for _, share in others):
        bars[_MOST_BARS:] = [(f"the other {len(others)}", rest)]
    most = max((share for _, share in bars), default=0.0) or 1.0
    return [
        {"label": label, "text": percent(share), "width": f"{100.0 * share / most:.2f}"}
        for label, share in bars[: _MOST_BARS + 1]
    ]
