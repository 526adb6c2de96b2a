"""The section of a scene that says how exactly a driveline is made and assembled."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.sections.joint_deviations import IN_DEGREES_OR_MM
from cardan.design.quantities import MOTION_QUANTITIES
from cardan.tolerances import REDUCTIONS

_OF_JOINTS = tuple(key for pair in IN_DEGREES_OR_MM for key in pair)

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
        "driving_yoke_deg": Key(
            kinds.TOLERANCES,
            "of the angle by which driving yokes lean, which [joints] gives as measured; one "
            "number, or one per joint",
        ),
        "cross_deg": Key(kinds.TOLERANCES, "of the crosses"),
        "driven_yoke_deg": Key(kinds.TOLERANCES, "of the driven yokes"),
        "driving_yoke_mm": Key(
            kinds.TOLERANCES,
            "in place of driving_yoke_deg: how far the ends of the pin may be off along the shaft, "
            "in opposite directions, at arm_mm",
        ),
        "cross_mm": Key(kinds.TOLERANCES, "likewise in place of cross_deg"),
        "driven_yoke_mm": Key(kinds.TOLERANCES, "likewise in place of driven_yoke_deg"),
        "arm_mm": Key(
            kinds.RADII,
            "distance of the middle of a pin's bearing from the centre of the joint: one number, "
            "or one per joint; default: that of [joints]",
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
            f"figures, from {', '.join(MOTION_QUANTITIES)}; orders of the last shaft, as "
            "angle_error_order_1 or acceleration_order_1; or outputs over a turn, as "
            "support_moment_1_peak. Default: equivalent_bend, and with tolerances of joints order "
            "1 of the acceleration, or of the angle error without a speed",
        ),
        "reduce": Key(
            kinds.WORST_REDUCED,
            "of outputs that are named without a reduction, of the last shaft or of all joints: "
            f"{', '.join(REDUCTIONS)}",
            default="peak",
        ),
        "limit": Key(
            kinds.POSITIVE,
            "of a single figure, in degrees for an angle, else in SI units; default: that of "
            "[limits]. Every driveline within the tolerances must keep it",
        ),
        "share": Key(
            kinds.SHARE, "share of the drivelines that must keep the limit, in place of all"
        ),
        "samples": Key(
            kinds.SAMPLES,
            "random drivelines; default: 100 000, or 16 384 where almost all of these keep the "
            "limit, or almost none",
        ),
        "seed": Key(kinds.SEED, "of their random numbers", default=0),
    },
    needed=(("bends_deg", "twists_deg", "phases_deg", "points_mm", "teeth", *_OF_JOINTS),),
    together=(("bends_deg", "points_mm"), ("twists_deg", "points_mm"), *IN_DEGREES_OR_MM),
)
"""The section [tolerances]."""
