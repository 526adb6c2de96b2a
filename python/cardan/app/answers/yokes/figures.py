"""How to set the yokes of a scene, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.answers.limits.check import check_states
from cardan.app.answers.limits.remedies import (
    ADVICE_KEYS,
    STATES_ADVICE_SCHEMA,
    advice,
    limit_of,
    listed,
    on_teeth,
    states_advice,
)
from cardan.app.answers.limits.root_rule import CATALOGUE_SCHEMA, root_rule
from cardan.app.answers.rounding import equivalent_bend_deg
from cardan.app.scene.scene import Scene
from cardan.design.check import Check
from cardan.driveline import Driveline
from cardan.motion.workshop import VIEW

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
_CATALOGUE = {"present": CATALOGUE_SCHEMA, "best": CATALOGUE_SCHEMA}
_KEYS: dict[str, Any] = {
    "view": {"description": "from where senses of rotation are seen", "const": VIEW},
    **ADVICE_KEYS,
    "teeth": {"description": "the best setting on the splines, if known", **listed(_TOOTH)},
    "catalogue": {
        "description": "what the catalogues' root rule makes of the same settings",
        **record(_CATALOGUE, {"on_teeth": CATALOGUE_SCHEMA}),
    },
    "above_limits": {
        "description": "what the check finds beyond its limits at the best setting, on the "
        "teeth where these are known",
        "type": "array",
        "items": {"type": "string"},
    },
}

PHASE_SCHEMA = answer_schema(
    "phase", "what cardan phase prints with --json", _KEYS, {"states": STATES_ADVICE_SCHEMA}
)
"""JSON Schema of ``yoke_settings``."""


def yoke_settings(scene: Scene) -> dict[str, Any]:
    """Return the best yoke settings of a scene as plain data; one setting for all of its states.

    Raises:
        ValueError: one joint alone, bends that were recorded, states that set the phases.
    """
    line = scene.line
    if line.n_joints == 1:
        raise ValueError(f"{scene.name}: one joint has no yokes to set against each other")
    if line.shape:
        raise ValueError(f"{scene.name}: the bends were recorded; yokes are set for fixed bends")
    if scene.states:
        return _over_states(scene)
    best = line.optimal_phases()
    found = advice(line, limit_of(scene), best)
    settings = {"present": line.phases, "best": best}
    teeth: list[dict[str, Any]] = []
    if scene.teeth:
        settings["on_teeth"] = line.optimal_phases(teeth=scene.teeth)
        teeth = on_teeth(line, settings["on_teeth"], scene.teeth)
        found["equivalent_bend_deg"]["on_teeth"] = equivalent_bend_deg(
            line.with_phases(settings["on_teeth"])
        )
    # On splines, what can be set.
    set_best = line.with_phases(settings.get("on_teeth", best))
    check = set_best.check(scene.speed or None, scene.limits)
    set_ = {key: scene.line.with_phases(phases) for key, phases in settings.items()}
    return _answer(scene, found, teeth, set_, check)


def _over_states(scene: Scene) -> dict[str, Any]:
    """The setting that serves all states; the root rule is that of the worst state of each."""
    assert scene.states
    if scene.states.set_phases:
        raise ValueError(
            f"{scene.name}: [states] gives phases_deg; one setting can serve all states only if "
            "none of them sets the yokes"
        )
    found = states_advice(scene)
    teeth = found.pop("teeth", [])
    settings = {
        key: np.radians([shaft["phase_deg"] for shaft in shafts])
        for key, shafts in (("best", found["shafts"]), ("on_teeth", teeth))
        if shafts
    }
    lines = scene.drivelines()
    set_best = lines.with_phases(settings.get("on_teeth", settings["best"]))
    settings = {"present": scene.line.phases, **settings}
    check = check_states(scene, set_best)
    worst = {key: _worst(lines.with_phases(phases)) for key, phases in settings.items()}
    return _answer(scene, found, teeth, worst, check)


def _worst(lines: Driveline) -> Driveline:
    """The driveline of a batch with the largest equivalent bend."""
    return lines[int(np.argmax(lines.equivalent().k))]


def _answer(
    scene: Scene,
    found: dict[str, Any],
    teeth: list[dict[str, Any]],
    lines: Mapping[str, Driveline],
    check: Check,
) -> dict[str, Any]:
    return answer(
        "phase",
        scene.title,
        view=VIEW,
        **found,
        teeth=teeth,
        catalogue={key: root_rule(line) for key, line in lines.items()},
        above_limits=[str(finding) for finding in check.findings if not np.all(finding.passes)],
    )
