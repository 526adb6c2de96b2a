"""The section of a scene that says how exactly a driveline is made and assembled."""

from __future__ import annotations

import cardan.scene.values as kinds
from cardan.quantities import MOTION_QUANTITIES
from cardan.scene.sections import Key, Section
from cardan.tolerances import REDUCTIONS

TOLERANCES = Section(
    "how exactly the driveline is made and assembled: each figure is ± that much",
    {
        "bends_deg": Key(kinds.TOLERANCES, "of the bends: one number, or one per joint"),
        "twists_deg": Key(
            kinds.TOLERANCES, "of the twists: one number, or one per intermediate shaft"
        ),
        "phases_deg": Key(
            kinds.TOLERANCES, "of the yokes: one number, or one per intermediate shaft"
        ),
        "points_mm": Key(
            kinds.TOLERANCES,
            "of every coordinate of the points: one number, or one per point; in place of "
            "bends_deg and twists_deg",
        ),
        "teeth": Key(
            kinds.TEETH,
            "teeth of the spline of each intermediate shaft, on which a yoke can only be set to "
            "within half a tooth: one number, or one per shaft",
        ),
        "distribution": Key(
            kinds.DISTRIBUTION,
            "uniform, or normal with the tolerance as three standard deviations",
            default="uniform",
        ),
        "of": Key(
            kinds.TOLERANCED,
            f"figures, from {', '.join(MOTION_QUANTITIES)}, or outputs over a turn, as "
            "support_moment_1_peak; default: equivalent_bend",
        ),
        "reduce": Key(
            kinds.WORST_REDUCED,
            "of outputs that are named without it, of the last shaft or of all joints: "
            f"{', '.join(REDUCTIONS)}",
            default="peak",
        ),
        "limit": Key(
            kinds.POSITIVE,
            "of the only figure: degrees for an angle, else SI units; default: that of [limits]",
        ),
        "samples": Key(kinds.SAMPLES, "random drivelines", default=100_000),
        "seed": Key(kinds.SEED, "of their random numbers", default=0),
    },
    needed=(("bends_deg", "twists_deg", "phases_deg", "points_mm", "teeth"),),
    together=(("bends_deg", "points_mm"), ("twists_deg", "points_mm")),
)
"""The section [tolerances]."""
