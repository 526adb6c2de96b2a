"""How to set the yokes of a scene, as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.figures.advice import ADVICE_KEYS, advice, listed, setting
from cardan.figures.answers import VERSION, answer
from cardan.figures.catalogue import CATALOGUE_SCHEMA, root_rule
from cardan.figures.rounding import equivalent_bend_deg
from cardan.scene.scene import Scene
from cardan.teeth import tooth_turns
from cardan.workshop import VIEW

_NUMBER = {"type": "number"}
_SENSE = {"enum": ["clockwise", "counter-clockwise", "none"]}
_TOOTH = {
    "shaft": {"description": "number of the shaft, counted from 0", "type": "integer"},
    "teeth": {"description": "of its spline", "type": "integer", "minimum": 1},
    "turn_teeth": {
        "description": "by how many teeth to turn the yoke from where it is",
        "type": "integer",
        "minimum": 0,
    },
    "turn_deg": {"description": "the same as an angle", "type": "number", "minimum": 0},
    "turn_sense": _SENSE,
    "phase_deg": {"description": "the phase on that tooth, within ±90", "type": "number"},
    "setting_deg": _NUMBER,
    "sense": _SENSE,
    "setting_other_sense_deg": _NUMBER,
}
_CATALOGUE = {"present": CATALOGUE_SCHEMA, "best": CATALOGUE_SCHEMA, "on_teeth": CATALOGUE_SCHEMA}
_KEYS: dict[str, Any] = {
    "answer": {"const": "phase"},
    "version": {"const": VERSION},
    "title": {"type": "string"},
    "view": {"description": "from where senses of rotation are seen", "const": VIEW},
    **ADVICE_KEYS,
    "teeth": {"description": "the best setting on the splines, if known", **listed(_TOOTH)},
    "catalogue": {
        "description": "what the catalogues' root rule makes of the same settings",
        "type": "object",
        "properties": _CATALOGUE,
        "required": ["present", "best"],
        "additionalProperties": False,
    },
    "above_limits": {
        "description": "what the check finds beyond its limits at the best setting, on the "
        "teeth where these are known",
        "type": "array",
        "items": {"type": "string"},
    },
}

PHASE_SCHEMA = {
    "title": "Answer of cardan phase",
    "type": "object",
    "properties": _KEYS,
    "required": list(_KEYS),
    "additionalProperties": False,
}
"""JSON Schema of ``yoke_settings``."""


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
    limit = np.radians(scene.limits.figures["equivalent_bend_deg"].limit)
    found = advice(line, float(limit), best)
    settings = {"present": line.phases, "best": best}
    teeth: list[dict[str, Any]] = []
    if scene.teeth:
        turns = tooth_turns(line, scene.teeth, best)
        settings["on_teeth"] = line.phases + 2.0 * np.pi * turns / np.asarray(scene.teeth)
        found["equivalent_bend_deg"]["on_teeth"] = equivalent_bend_deg(
            line.with_phases(settings["on_teeth"])
        )
        teeth = [
            _tooth(i + 1, count, int(turns[i]), float(settings["on_teeth"][i]))
            for i, count in enumerate(scene.teeth)
        ]
    # On splines, what can be set.
    set_best = line.with_phases(settings.get("on_teeth", best))
    check = set_best.check(scene.speed or None, scene.limits)
    return answer(
        "phase",
        scene.title,
        view=VIEW,
        **found,
        teeth=teeth,
        catalogue={key: root_rule(line.with_phases(phases)) for key, phases in settings.items()},
        above_limits=[str(finding) for finding in check.findings if not finding.passes],
    )


def _tooth(shaft: int, teeth: int, turned: int, phase: float) -> dict[str, Any]:
    return {
        "shaft": shaft,
        "teeth": teeth,
        "turn_teeth": abs(turned),
        "turn_deg": abs(turned) * 360.0 / teeth,
        "turn_sense": ("counter-clockwise", "none", "clockwise")[int(np.sign(turned)) + 1],
        **setting(phase),
    }
