"""How to set the yokes of a scene, as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.figures.rounding import equivalent_bend_deg
from cardan.scene.scene import Scene
from cardan.workshop import VIEW, turn


def yoke_settings(scene: Scene) -> dict[str, Any]:
    """Return the best yoke settings of a scene as plain data.

    Raises:
        ValueError: one joint alone, or bends that were recorded.
    """
    line = scene.line
    if line.n_joints == 1:
        raise ValueError(f"{scene.name}: one joint has no yokes to set against each other")
    if line.shape:
        raise ValueError(f"{scene.name}: the bends were recorded; yokes are set for fixed bends")
    best = line.optimal_phases()
    settings, turns = turn(best), turn(best - line.phases)
    # A yoke turned by 180 deg is the same yoke: the figure of the scene is that of the bench.
    phases = np.where(settings.sense == "counter-clockwise", -settings.angle, settings.angle)
    set_so = line.with_phases(best)
    check = set_so.check(scene.speed or None, scene.limits)
    return {
        "title": scene.title,
        "view": VIEW,
        "shafts": [
            {
                "shaft": i + 1,
                "phase_deg": float(np.degrees(phases[i])),
                "setting_deg": float(np.degrees(settings.angle[i])),
                "sense": str(settings.sense[i]),
                "turn_deg": float(np.degrees(turns.angle[i])),
                "turn_sense": str(turns.sense[i]),
            }
            for i in range(line.n_joints - 1)
        ],
        "equivalent_bend_deg": {
            "present": equivalent_bend_deg(line),
            "best": equivalent_bend_deg(set_so),
        },
        "above_limits": [str(found) for found in check.findings if not found.passes],
    }
