"""The section of offset axes: slides of shafts and pins, and the axial travel over the turn."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel.figures import SceneSlides, drawn_slides
from cardan.app.answers.axial_travel.text import HEADINGS, slide_rows, slide_sentences
from cardan.app.charts.charts import chart
from cardan.app.charts.samples import Curve, Panel
from cardan.app.charts.tables import Table

_DEGREES = np.arange(0.0, 361.0, 2.0)


def section(answer: Answer, found: SceneSlides) -> dict[str, Any]:
    """Return the slides of a scene as plain data for the page."""
    travels = drawn_slides(answer.scene).at(np.radians(_DEGREES))
    curves = tuple(Curve(f"joint {joint}", travel) for joint, travel in enumerate(travels))
    panel = Panel("Axial travel of the driven shafts", "mm", curves, float(np.max(np.abs(travels))))
    return {
        "class": "note",
        "tables": [Table("Slides over a turn, in mm", ("Slide", *HEADINGS), slide_rows(found))],
        "sentences": list(slide_sentences(found)),
        "charts": [chart(panel, _DEGREES, "drive angle [deg]")],
    }
