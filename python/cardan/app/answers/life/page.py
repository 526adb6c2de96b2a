"""The section of life: verdict, figures of the joints, sizes, load of the pins, tubes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures
from cardan.app.answers.life.text import (
    SIZE_HEADS,
    STEP_HEADS,
    hours_text,
    joint_lines,
    life_sentences,
    size_rows,
    step_rows,
)
from cardan.app.charts.charts import chart
from cardan.app.charts.samples import Curve, Panel
from cardan.app.charts.tables import Table
from cardan.wear.pin_loads import pins_at

_SAMPLES = 181


def section(_: Answer, found: LifeFigures) -> dict[str, Any]:
    """Return the joints in service as plain data for ``page.html``."""
    return {
        "class": "good" if found.passes else "bad",
        "sentences": list(life_sentences(found)),
        "tables": [
            Table("Duty cycle", STEP_HEADS, step_rows(found)),
            *(
                Table(f"Joint {joint.joint}", ("Figure", "Value"), joint_lines(joint, found))
                for joint in found.joints
            ),
            *([Table("Sizes", SIZE_HEADS, size_rows(found))] if found.sizes else []),
        ],
        "charts": [_pin_load(found)],
        "bars": _bars(found),
    }


def _pin_load(found: LifeFigures) -> dict[str, Any]:
    """The moment of the pins over the turn, in the step that wears the deciding joint most."""
    duty, first = found.duty, found.decisive
    step = 0 if first is None else int(np.argmax(first.damage))
    angle = np.linspace(0.0, 360.0, _SAMPLES)
    line, load = duty.line[step], duty.load_of(step)
    curves = tuple(
        Curve(f"joint {joint}", pins_at(line, load, joint, np.radians(angle)).moment)
        for joint in range(line.n_joints)
    )
    heading = f"Moment of the pins, {duty.names[step]}"
    panel = Panel(heading, "N m", curves, float(np.max(np.abs(load.torque))))
    return chart(panel, angle, "drive angle [deg]")


def _bars(found: LifeFigures) -> list[dict[str, Any]]:
    """The life with each size as bars: the width of the longest is 100."""
    known = [(one.size.name, one.hours) for one in found.sizes if one.hours is not None]
    most = max((hours for _, hours in known), default=0.0)
    return [
        {"label": name, "text": hours_text(hours), "width": f"{100.0 * hours / most:.2f}"}
        for name, hours in known
    ]
