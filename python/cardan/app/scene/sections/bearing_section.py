"""The sections of a scene that say where its bearings are, and the keys of lengths."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section

BEARING = Section(
    "a bearing; give one section for each, in any order. They are counted from 0 in that order",
    {
        "shaft": Key(kinds.SHAFT, "its shaft, counted from 0"),
        "position_mm": Key(
            kinds.POSITION,
            "distance from the upstream end of the shaft in the direction of power flow: from its "
            "input-side joint, on shaft 0 from the driving end",
        ),
        "position_m": Key(kinds.POSITION, "or: the same in metres"),
    },
    together=(("position_mm", "position_m"),),
    needed=(("shaft",), ("position_mm", "position_m")),
    repeated=True,
)
"""The sections [[bearing]]."""

LENGTHS = ("lengths_mm", "lengths_m")
"""The keys of a driveline without points for the lengths of its shafts; it has at most one."""
