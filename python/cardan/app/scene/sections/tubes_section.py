"""The section of a scene that describes the round sections of shafts: its keys."""

from __future__ import annotations

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section

TUBES = Section(
    "round sections of shafts, for stiffness, stress and critical bending speed; each value is one "
    "for all listed shafts or a list with one per listed shaft",
    {
        "shafts": Key(
            kinds.INDICES,
            "which shafts, counted from 0; default: those between joints, or all of one joint",
        ),
        "outer_diameter_mm": Key(kinds.RADII, "outer diameter", "outer_diameter", 1e-3),
        "wall_mm": Key(
            kinds.RADII, "thickness of the wall; default: the shafts are solid", "wall", 1e-3
        ),
        "length_mm": Key(
            kinds.POSITIVES,
            "free length of the tube; default: the length of the shaft in [driveline]",
            "length",
            1e-3,
        ),
        "shear_modulus_GPa": Key(
            kinds.POSITIVES, "shear modulus", "shear_modulus", 1e9, default=79.3
        ),
        "elastic_modulus_GPa": Key(
            kinds.POSITIVES, "elastic modulus", "elastic_modulus", 1e9, default=206
        ),
        "density_kg_m3": Key(kinds.POSITIVES, "density", "density", default=7850),
        "permitted_stress_MPa": Key(
            kinds.POSITIVE, "largest permitted shear stress of the tubes by the torque"
        ),
        "least_margin": Key(
            kinds.POSITIVE,
            "least permitted ratio of the critical bending speed to the largest speed",
        ),
    },
    needed=(("outer_diameter_mm",),),
)
"""The section [tubes]."""
