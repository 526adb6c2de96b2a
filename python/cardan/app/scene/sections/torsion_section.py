"""The section of a scene that makes its shafts torsion springs: its keys."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section

TORSION = Section(
    "torsional vibration: shafts as springs with inertias at their ends",
    {
        "inertias_kgm2": Key(
            kinds.END_INERTIAS,
            "of each shaft: a number, half of it at each end, or [input end, output end]; the "
            "inertia of a shaft in [tubes] is added",
        ),
        "stiffnesses_Nm_per_rad": Key(
            kinds.STIFFNESSES,
            'of each shaft: a number, "rigid", or "tube" for the stiffness by [tubes]; default: '
            "the shafts of [tubes] are springs, all others rigid",
        ),
        "damping_ratio": Key(
            kinds.DAMPING_RATIOS,
            "damping ratio of the lowest vibration: one number, or one per shaft; default 0",
        ),
        "dampings_Nms_per_rad": Key(kinds.DAMPINGS, "or: damping of each shaft"),
        "load_torque_Nm": Key(
            kinds.LOAD_TORQUE, "torque that brakes the last shaft; default: the torque of [load]"
        ),
        "load_damping_Nms_per_rad": Key(
            kinds.LOAD_DAMPING, "viscous load on the last shaft", default=0
        ),
        "speed_rpm": Key(
            kinds.SPEEDS,
            "drive speeds at which the driveline runs: {from = …, to = …, steps = …} or a list",
        ),
        "orders": Key(
            kinds.ORDERS,
            "orders of the drive's rotation to list; joints excite even orders; default: 2 and 4",
        ),
        "resonance_margin": Key(
            kinds.POSITIVE,
            "least distance of the critical speeds of even orders from speed_rpm, in shares of the "
            "critical speed, such as 0.15",
        ),
    },
    together=(("damping_ratio", "dampings_Nms_per_rad"),),
    needed=(("inertias_kgm2",), ("speed_rpm",)),
)
"""The section [torsion]."""
