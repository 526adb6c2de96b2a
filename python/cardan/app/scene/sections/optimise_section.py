"""The section of a scene that says what may change for the better."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.sections.optimise_rules import KEPT
from cardan.design.quantities import MOTION_QUANTITIES

OPTIMISE = Section(
    'what may change so that the driveline runs better over all states; "cardan optimise" finds '
    "the best values",
    {
        "vary": Key(
            kinds.RANGES,
            'keys of [driveline] and how far each may change from its value, as {"points_mm.2.y" = '
            '[-40, 40], "phases_deg.0" = "free"}',
        ),
        "minimise": Key(
            kinds.MINIMISED,
            f"{', '.join(MOTION_QUANTITIES)}, or an output with the number of its shaft, joint or "
            "bearing and its reduction over the turn, as support_moment_1_peak",
            default="equivalent_bend",
        ),
        "over": Key(
            kinds.OVER,
            "of the states, the largest value or the root mean square with the weights of [states]",
            default="largest",
        ),
        "keep": Key(
            kinds.KEPT,
            f"largest permitted values in every state: {', '.join(KEPT)}, or outputs as above "
            "with their unit, as support_moment_1_peak_Nm",
        ),
        "starts": Key(
            kinds.NATURAL,
            "number of local searches; more find the best of many local optima more surely",
            default=8,
        ),
    },
    needed=(("vary",),),
)
"""The section [optimise]."""
