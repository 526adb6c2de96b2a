"""The section of life: its rows, the load of the pins, the life with each size."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures
from cardan.app.answers.life.text import hours_text
from cardan.app.answers.page import section_of
from cardan.app.answers.table import PARTS
from cardan.app.charts.charts import Curve, Panel, chart
from cardan.wear.pin_loads import pins_at

_SAMPLES = 181


def section(_: Answer, found: LifeFigures) -> dict[str, Any]:
    """Return the joints in service as plain data for ``page.html``."""
    charts = [_pin_load(found)] if found.duty else []
    return {**section_of(PARTS["life"], found), "charts": charts, "bars": _bars(found)}


def _pin_load(found: LifeFigures) -> dict[str, Any]:
    """The moment of the pins over the turn, in the step that wears the deciding joint most."""
    angle = np.linspace(0.0, 360.0, _SAMPLES)
    line, load, name = found.hardest()
    curves = tuple(
        Curve(f"joint {joint}", pins_at(line, load, joint, np.radians(angle)).moment)
        for joint in range(line.n_joints)
    )
    panel = Panel(f"Moment of the pins, {name}", "N m", curves, abs(float(load.torque)))
    return chart(panel, angle, "drive angle [deg]")


def _bars(found: LifeFigures) -> list[dict[str, Any]]:
    """The life with each size as bars: the width of the longest is 100."""
    known = [(one.size, one.hours) for one in found.sizes if one.hours is not None]
    most = max((hours for _, hours in known), default=0.0)
    return [
        {"label": name, "text": hours_text(hours), "width": f"{100.0 * hours / most:.2f}"}
        for name, hours in known
    ]
