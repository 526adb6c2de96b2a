"""The section of tolerances: verdict, figures, how the drivelines scatter and what makes them."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.tolerances.figures import (
    Share,
    ToleranceFigure,
    ToleranceFigures,
    in_figure_units,
    permitted_tolerances,
)
from cardan.app.answers.tolerances.text import (
    figure_lines,
    given_lines,
    limit_text,
    percent,
    permitted_texts,
    state_rows,
    verdict_texts,
)
from cardan.app.charts.charts import chart
from cardan.app.charts.samples import Curve, Panel
from cardan.app.charts.tables import Table
from cardan.tolerances import Tolerances

_POINTS, _MOST_BARS = 200, 10


def section(answer: Answer, found: ToleranceFigures) -> dict[str, Any]:
    """Return tolerances as plain data for ``page.html``."""
    of, arms = answer.scene.tolerances, answer.scene.tolerance_arms
    assert of
    return {
        "given": Table("Tolerances", ("What", "How much"), given_lines(found)),
        "sentences": [
            {"class": _class(figure), "words": words}
            for figure, words in zip(found.figures, verdict_texts(found), strict=True)
        ],
        "permitted": permitted_texts(found, permitted_tolerances(of, arms)),
        "figures": [
            {
                "table": Table(
                    figure.label.capitalize(), ("Drivelines", "Value"), figure_lines(figure)
                ),
                "states": _states(figure),
                "chart": _scatter(figure, of),
                "shares": _bars(figure),
                "label": figure.label,
            }
            for figure in found.figures
        ],
    }


def _states(figure: ToleranceFigure) -> Table | None:
    """A row for each state; ``None`` without states."""
    if not figure.states:
        return None
    heads, *rows = state_rows(figure)
    title = f"{figure.label.capitalize()} in each state"
    return Table(title, tuple(head.capitalize() for head in heads), rows)


def _class(figure: ToleranceFigure) -> str:
    if figure.limit is None:
        return "open"
    if figure.worst <= figure.limit:
        return "good"
    return "fair" if figure.nominal <= figure.limit else "bad"


def _scatter(figure: ToleranceFigure, of: Tolerances) -> dict[str, Any]:
    """The share of the drivelines up to each value, with the limit as a step."""
    sampled = np.asarray(in_figure_units(of, figure.name, of.ascending), dtype=float)
    high = max(float(sampled[-1]), figure.worst, figure.limit or 0.0)
    x = np.linspace(float(sampled[0]), high if high > sampled[0] else sampled[0] + 1.0, _POINTS)
    if figure.limit is not None:
        x = np.sort(np.append(x, [figure.limit, figure.limit]))
    shares = 100.0 * np.searchsorted(sampled, x, side="right") / len(sampled)
    curves = [Curve("share up to this value", shares)]
    if figure.limit is not None:
        step = np.where(x > figure.limit, 100.0, 0.0)
        step[np.searchsorted(x, figure.limit, side="left") + 1] = 100.0
        curves.append(Curve(f"limit {limit_text(figure)}", step))
    panel = Panel(f"Random drivelines up to this {figure.label}", "%", tuple(curves), 100.0)
    heading = f"{figure.label} [{figure.unit}]" if figure.unit else figure.label
    return chart(panel, x, heading)


def _bars(figure: ToleranceFigure) -> list[dict[str, Any]]:
    """Shares as bars: the width of the longest is 100."""
    shown = [*figure.shares[:_MOST_BARS]]
    rest = sum(share.share for share in figure.shares[_MOST_BARS:])
    bars = [(_words(share), share.share) for share in shown]
    if rest > 0.0:
        bars.append((f"the other {len(figure.shares) - len(shown)}", rest))
    most = max((share for _, share in bars), default=0.0) or 1.0
    return [
        {"label": label, "text": percent(share), "width": f"{100.0 * share / most:.2f}"}
        for label, share in bars
    ]


def _words(share: Share) -> str:
    return share.label[0].upper() + share.label[1:]
