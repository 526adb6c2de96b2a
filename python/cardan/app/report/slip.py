"""The section of a spline: figures and what follows from them."""

from __future__ import annotations

from typing import Any

from cardan.app.figures.slip import SlipFigures
from cardan.app.report.limits import shown
from cardan.app.report.tables import Table
from cardan.app.words.slip import slip_lines, slip_sentences


def slip(found: SlipFigures) -> dict[str, Any]:
    """Return a spline as plain data for the page."""
    return {
        "class": shown(found.verdict),
        "sentences": list(slip_sentences(found)),
        "tables": [
            Table(f"Spline of shaft {found.slip.shaft}", ("Figure", "Value"), slip_lines(found))
        ],
    }
