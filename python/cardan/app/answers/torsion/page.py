"""The section of torsional vibration: what it means, tables, and torques over the speed."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.torsion.figures import TorsionBasics, TorsionFigures, needed_torsion
from cardan.app.answers.torsion.text import (
    critical_lines,
    mode_lines,
    stability_lines,
    torque_lines,
    torsion_sentences,
)
from cardan.app.charts.charts import Curve, Panel, Table, chart
from cardan.app.scene.language.units import RPM

_CLASSES = {"unstable": "bad", "reversing": "fair", "resonant": "fair", "clear": "good"}


def section(answer: Answer, _: TorsionBasics) -> dict[str, Any]:
    """Return torsional vibration as plain data for the page."""
    found = needed_torsion(answer.scene)
    tables = (
        ("Natural frequencies", ("Frequency", "Twisted, with shares in the energy"), mode_lines),
        ("Critical speeds", ("Drive speed", "What meets"), critical_lines),
        ("Largest torque", ("Shaft", "Over a turn"), torque_lines),
        ("Stability", ("Drive speed", "Motion"), stability_lines),
    )
    return {
        "class": _CLASSES[found.verdict],
        "sentences": list(torsion_sentences(found)),
        "tables": [
            Table(caption, head, lines) for caption, head, of in tables if (lines := of(found))
        ],
        "charts": _charts(found),
    }


def _charts(found: TorsionFigures) -> list[dict[str, Any]]:
    """Torques of each compliant shaft; speeds without a periodic motion are left out."""
    known = found.steady.found
    if np.count_nonzero(known) < 2:
        return []
    made = []
    for place, shaft in enumerate(found.steady.compliant):
        curves = tuple(
            Curve(label, getattr(found.steady, f"torque_{name}")[place][known])
            for label, name in (("largest", "max"), ("mean", "mean"), ("least", "min"))
        )
        scale = float(max(np.max(np.abs(curve.values)) for curve in curves))
        panel = Panel(f"Torque of shaft {shaft} over a turn", "N m", curves, scale)
        made.append(chart(panel, found.speed[known] / RPM, "drive speed [rpm]"))
    return made
