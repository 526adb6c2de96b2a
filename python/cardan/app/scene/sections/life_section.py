"""The section of a scene that says how a driveline is used: its keys."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section

LIFE = Section(
    "duty cycle of the driveline, for the life and the heat of its joints; each value is one for "
    "all steps or a list with one per step. Without it [load] is the only step",
    {
        "hours": Key(
            kinds.POSITIVES,
            "time of each step, in hours or any other unit: only the shares count; default: all "
            "alike",
        ),
        "speed_rpm": Key(kinds.POSITIVES, "speed of the drive; default: that of [load]"),
        "drive_torque_Nm": Key(kinds.TORQUES, "torque put into shaft 0; default: that of [load]"),
        "output_torque_Nm": Key(kinds.TORQUES, "or: torque delivered by the last shaft"),
        "bends_deg": Key(
            kinds.STEP_BENDS,
            "bends in each step: of all joints, or a list with one per joint; needs bends_deg in "
            "[driveline]",
        ),
        "states": Key(
            kinds.STATE_NAMES, "or: the state of [states] in which the driveline is in each step"
        ),
        "names": Key(kinds.NAMES, "what each step is called; default: step 0 and so on"),
        "target_h": Key(kinds.POSITIVE, "life that 90 % of the joints must reach"),
    },
    together=(("drive_torque_Nm", "output_torque_Nm"), ("bends_deg", "states")),
    fewest=1,
)
"""The section [life]."""
