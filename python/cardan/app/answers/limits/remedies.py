"""What the arrangement is, what the yokes can do for it, and what would fix the rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cardan.app.answers.json_schema import record
from cardan.app.answers.rounding import ROUNDING, equivalent_bend_deg
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.design.limits import MAX_EQUIVALENT_BEND
from cardan.driveline import Driveline
from cardan.motion.workshop import turn

ARRANGEMENTS = ("straight", "single bend", "W", "Z", "planar", "spatial")
"""No bent joint, one, two whose outer shafts meet, two with a Z between them; in general."""

# Angles below this, in rad, are rounding of the points of a drawing.
_STRAIGHT = 1e-6

_DEG = {"type": "number", "minimum": 0}
_TURN = {"type": "number", "minimum": 0, "maximum": 180}
_SENSE = {"enum": ["clockwise", "counter-clockwise", "none"]}
_SHAFT = {
    "shaft": {"description": "number of the shaft, counted from 0", "type": "integer"},
    "phase_deg": {"description": "the best phase, within ±90", "type": "number"},
    "setting_deg": {"description": "the same without its sign", **_TURN},
    "sense": _SENSE,
    "setting_other_sense_deg": {"description": "the same setting the other way round", **_TURN},
    "turn_deg": {"description": "how far to turn the yoke from where it is", **_TURN},
    "turn_sense": _SENSE,
    "turn_other_sense_deg": {"description": "the same turn the other way round", **_TURN},
}
_RANGE = {
    "joint": {"description": "number of the joint, counted from 0", "type": "integer"},
    "bend_deg": {"description": "as it is", **_DEG},
    "from_deg": {"description": "least bend with which the limit can be kept", **_DEG},
    "to_deg": {"description": "largest bend with which it can", **_DEG},
}


def listed(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON Schema of a list of objects that have just these keys."""
    return {"type": "array", "items": record(keys)}


ADVICE_KEYS: dict[str, Any] = {
    "arrangement": {"enum": list(ARRANGEMENTS)},
    "cause": {
        "description": "why the equivalent bend is beyond its limit: none if it is not, phases if "
        "the best setting is within it, bends if no setting is",
        "enum": ["none", "phases", "bends"],
    },
    "limit_deg": {"description": "of the equivalent bend", **_DEG},
    "equivalent_bend_deg": record({"present": _DEG, "best": _DEG}, {"on_teeth": _DEG}),
    "shafts": listed(_SHAFT),
    "bend_ranges": {
        "description": "for each joint the bends with which the best setting is within the limit, "
        "all other bends as they are",
        **listed(_RANGE),
    },
}
"""JSON Schemas of the keys that ``advice`` returns."""

_NAME, _BENDS = {"type": "string"}, {"type": "array", "items": _DEG}
STATES_ADVICE_SCHEMA: dict[str, Any] = {
    "description": "the equivalent bend in each state, and the states in which it is largest; "
    "equivalent_bend_deg and cause are then of these worst states, arrangement is that of the "
    "worst state at present",
    **record(
        {
            "names": {"type": "array", "items": _NAME},
            "weights": _BENDS,
            "equivalent_bend_deg": record(
                {"present": _BENDS, "best": _BENDS}, {"on_teeth": _BENDS}
            ),
            "worst": record({"present": _NAME, "best": _NAME}, {"on_teeth": _NAME}),
        }
    ),
}
"""JSON Schema of what ``states_advice`` adds to them."""


def advice(
    line: Driveline, limit: float = MAX_EQUIVALENT_BEND, best: FloatArray | None = None
) -> dict[str, Any]:
    """Return what the yokes can do for one driveline, and what would fix the rest, as plain data.

    Args:
        line: one driveline.
        limit: of the equivalent bend, in rad.
        best: its best phases, if they are known.
    """
    best = line.optimal_phases() if best is None else best
    # To and from radians, 3 would become 3.0000000000000004.
    limit_deg = round(float(np.degrees(limit)), 12)
    bends = {
        "present": equivalent_bend_deg(line),
        "best": equivalent_bend_deg(line.with_phases(best)),
    }
    within = {key: bend <= limit_deg * (1.0 + ROUNDING) for key, bend in bends.items()}
    return {
        "arrangement": arrangement(line),
        "cause": "none" if within["present"] else "phases" if within["best"] else "bends",
        "limit_deg": limit_deg,
        "equivalent_bend_deg": bends,
        "shafts": [
            {"shaft": i + 1, **setting(best[i]), **_turned(best[i] - line.phases[i])}
            for i in range(line.n_joints - 1)
        ],
        "bend_ranges": _bend_ranges(np.asarray(line.bends), limit),
    }


def scene_advice(scene: Scene) -> dict[str, Any] | None:
    """Return ``advice`` for a scene; ``None`` where a study or a recording varies the bends.

    With teeth in the scene, ``"teeth"`` are the best of them, as in ``yoke_settings``. With states
    it is ``states_advice``.
    """
    line = scene.line
    if scene.states:
        return None if scene.states.set_phases else states_advice(scene)
    if line.shape or (scene.study is not None and scene.study.axes):
        return None
    best = line.optimal_phases()
    found = advice(line, limit_of(scene), best)
    if scene.teeth:
        phases = line.optimal_phases(teeth=scene.teeth)
        found["teeth"] = on_teeth(line, phases, scene.teeth)
        found["equivalent_bend_deg"]["on_teeth"] = equivalent_bend_deg(line.with_phases(phases))
    return found


def states_advice(scene: Scene) -> dict[str, Any]:
    """Return what one setting of the yokes can do for all states of a scene, as plain data.

    ``"equivalent_bend_deg"`` are the largest over the states, ``"states"`` has those of each.
    """
    states, line = scene.states, scene.line
    assert states
    lines = scene.drivelines()
    best = lines.optimal_phases(states=0, weights=states.weights)
    settings = {"present": line.phases, "best": best}
    found = advice(line, limit_of(scene), best)
    if scene.teeth:
        phases = lines.optimal_phases(states=0, weights=states.weights, teeth=scene.teeth)
        settings["on_teeth"] = phases
        found["teeth"] = on_teeth(line, phases, scene.teeth)
    each = {
        key: [equivalent_bend_deg(one) for one in lines.with_phases(phases)]
        for key, phases in settings.items()
    }
    largest = {key: max(bends) for key, bends in each.items()}
    worst = {key: int(np.argmax(bends)) for key, bends in each.items()}
    within = {key: bend <= found["limit_deg"] * (1.0 + ROUNDING) for key, bend in largest.items()}
    return {
        **found,
        "arrangement": arrangement(lines[worst["present"]]),
        "equivalent_bend_deg": largest,
        "cause": "none" if within["present"] else "phases" if within["best"] else "bends",
        "bend_ranges": [],
        "states": {
            "names": list(states.names),
            "weights": states.weights.tolist(),
            "equivalent_bend_deg": each,
            "worst": {key: states.names[index] for key, index in worst.items()},
        },
    }


def on_teeth(line: Driveline, phases: FloatArray, teeth: Sequence[int]) -> list[dict[str, Any]]:
    """Return how to set each shaft to phases in rad that its teeth permit, as plain data."""
    turns = np.round((phases - line.phases) * teeth / (2.0 * np.pi)).astype(int)
    return [
        {
            "shaft": i + 1,
            "teeth": count,
            "turn_teeth": abs(int(turns[i])),
            "turn_deg": abs(int(turns[i])) * 360.0 / count,
            "turn_sense": ("counter-clockwise", "none", "clockwise")[int(np.sign(turns[i])) + 1],
            **setting(float(phases[i])),
        }
        for i, count in enumerate(teeth)
    ]


def limit_of(scene: Scene) -> float:
    """Return the limit of the equivalent bend of a scene in rad."""
    return float(np.radians(scene.limits.figures["equivalent_bend_deg"].limit))


def arrangement(line: Driveline) -> str:
    """Return the name of one driveline's arrangement, one of ``ARRANGEMENTS``.

    Straight joints do not count: the twists on both sides of one add up.
    """
    bent = np.flatnonzero(line.bends > _STRAIGHT)
    if len(bent) < 2:
        return ARRANGEMENTS[len(bent)]
    up_to = np.concatenate([[0.0], np.cumsum(line.twists)])
    twists = np.diff(up_to[bent])
    if np.any(np.abs(np.sin(twists)) > _STRAIGHT):
        return "spatial"
    if len(bent) > 2:
        return "planar"
    return "W" if np.cos(twists[0]) > 0.0 else "Z"


def setting(phase: float) -> dict[str, Any]:
    """Return a phase in rad as plain data in degrees: within ±90, and as a turn in both senses."""
    found = turn(phase)
    angle, sense = float(np.degrees(found.angle)), str(found.sense)
    return {
        "phase_deg": -angle if sense == "counter-clockwise" else angle,
        "setting_deg": angle,
        "sense": sense,
        "setting_other_sense_deg": 180.0 - angle,
    }


def _turned(angle: float) -> dict[str, Any]:
    found = setting(angle)
    return {
        "turn_deg": found["setting_deg"],
        "turn_sense": found["sense"],
        "turn_other_sense_deg": found["setting_other_sense_deg"],
    }


def _bend_ranges(bends: FloatArray, limit: float) -> list[dict[str, Any]]:
    """For each joint the bends that let the best setting reach the limit, the others as they are.

    With ``L = ln sec(bend)`` the least equivalent bend has ``L`` equal to that by which the largest
    exceeds all others together. The ends follow from that without any search.
    """
    lengths, reach = -np.log(np.cos(bends)), -np.log(np.cos(limit))
    ranges = []
    for joint, bend in enumerate(bends):
        others = np.delete(lengths, joint)
        total, longest = np.sum(others), np.max(others, initial=0.0)
        ends = np.array([2.0 * longest - total - reach, total + reach])
        low, high = np.degrees(np.arccos(np.exp(-np.maximum(ends, 0.0))))
        ranges.append(
            {
                "joint": joint,
                "bend_deg": float(np.degrees(bend)),
                "from_deg": float(low),
                "to_deg": float(high),
            }
        )
    return ranges
