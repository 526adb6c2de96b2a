"""The section of a spline: figures and what follows from them."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.limits.page import shown
from cardan.app.answers.spline.figures import SlipFigures
from cardan.app.answers.spline.text import slip_lines, slip_sentences
from cardan.app.charts.tables import Table


def slip(found: SlipFigures) -> dict[str, Any]:
    """Return a spline as plain data for the page."""
    return {
        "class": shown(found.verdict),
        "sentences": list(slip_sentences(found)),
        "tables": [
            Table(f"Spline of shaft {found.slip.shaft}", ("Figure", "Value"), slip_lines(found))
        ],
    }
