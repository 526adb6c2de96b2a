"""The section of tubes."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.tubes.figures import TubeFigures
from cardan.app.answers.tubes.text import tube_lines, tube_sentences
from cardan.app.charts.tables import Table


def section(_: Answer, found: tuple[TubeFigures, ...]) -> dict[str, Any]:
    """Return tubes as plain data for the page."""
    within = ["The tubes are within the limits that the scene gives."]
    return {
        "class": "good" if all(tube.passes for tube in found) else "bad",
        "sentences": list(tube_sentences(found)) or within,
        "tables": [
            Table(f"Tube of shaft {tube.shaft}", ("Figure", "Value"), tube_lines(tube))
            for tube in found
        ],
    }
