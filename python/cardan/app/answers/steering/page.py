"""The section of a steering column: figures of each state and what follows from them."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits.page import shown
from cardan.app.answers.steering.figures import SteeringFigures
from cardan.app.answers.steering.text import HEADINGS, steering_rows, steering_sentences
from cardan.app.charts.tables import Table


def section(_: Answer, found: SteeringFigures) -> dict[str, Any]:
    """Return a steering column as plain data for the page."""
    caption = f"Straight ahead, at a drive angle of {found.centre_deg:.6g} deg"
    return {
        "class": shown(found.verdict),
        "sentences": list(steering_sentences(found)),
        "tables": [Table(caption, ("State", *HEADINGS), steering_rows(found))],
    }
