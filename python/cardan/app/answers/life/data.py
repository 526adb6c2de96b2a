"""The life of a scene's joints as plain data for JSON, and its schema."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.answers.life.figures import (
    AgainstLimit,
    JointLife,
    LifeFigures,
    SizeLife,
    needed_life,
    round_off,
)
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.table import PARTS


def life_data(found: Answer) -> dict[str, Any]:
    """Return the life of a scene's joints as plain data for JSON, as ``LIFE_SCHEMA`` describes it.

    Raises:
        ValueError: as ``needed_life``.
    """
    tubes = {"tubes": PARTS["tubes"].data(found["tubes"])} if found["tubes"] else {}
    return answer("life", found.of.title, **data(needed_life(found.scene)), **tubes)


def data(found: LifeFigures, *, radians: bool = False) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes them."""
    duty, first = found.duty, found.decisive
    return {
        "L10_h": None if first is None else _maybe(first.hours),
        "decisive_joint": None if first is None else first.joint,
        "target_h": duty.target,
        "passes": found.passes,
        "chosen_size": None if found.chosen is None else found.chosen.size.name,
        "heat_W": found.heat,
        "efficiency": found.efficiency,
        "steps": [
            {
                "step": name,
                "share": float(duty.shares[i]),
                "speed_rpm": round_off(duty.speed_rpm[i]),
                "torque_Nm": float(duty.load.torque[i]),
                "bends_deg": [*map(round_off, duty.line.bends_deg[i])],
            }
            for i, name in enumerate(duty.names)
        ],
        "joints": [_joint(joint, duty.names) for joint in found.joints],
        "sizes": [_size(size) for size in found.sizes],
    }


def _joint(joint: JointLife, names: tuple[str, ...]) -> dict[str, Any]:
    heat = joint.heat
    return {
        "joint": joint.joint,
        "size": joint.size.name,
        "bearing": joint.size.bearing,
        "L10_h": _maybe(joint.hours),
        "catalogue_L10_h": _maybe(joint.catalogue),
        "damage": list(joint.damage),
        "false_brinelling": joint.small_swing,
        "bend_deg": _judged(joint.bend),
        "speed_bend_rpm_deg": _judged(joint.speed_bend),
        "heat_W": None if heat is None else heat.mean,
        "largest_heat_W": None if heat is None else heat.largest,
        "largest_heat_in": None if heat is None else names[heat.step],
    }


def _judged(figure: AgainstLimit) -> dict[str, Any]:
    return {"value": figure.value, "limit": figure.limit, "passes": figure.passes}


def _size(one: SizeLife) -> dict[str, Any]:
    return {
        "size": one.size.name,
        "rating_Nm": one.size.rating,
        "L10_h": _maybe(one.hours),
        "decisive_joint": None if one.hours is None else one.decisive,
        "fits": one.fits,
        "heat_W": one.heat,
    }


def _maybe(value: float | None) -> float | None:
    return None if value is None else finite_or_none(value)


_NUMBER, _TEXT, _FLAG = {"type": "number"}, {"type": "string"}, {"type": "boolean"}
_MAYBE = {"type": ["number", "null"]}
_COUNT = {"type": "integer", "minimum": 0}
_NUMBERS = {"type": "array", "items": _NUMBER}
_JUDGED = record({"value": _NUMBER, "limit": _MAYBE, "passes": _FLAG})

_PART: Mapping[str, Any] = {
    "L10_h": {
        "description": "hours that 90 % of the joints reach, of the joint that fails first; null "
        "if no life is known or nothing wears",
        **_MAYBE,
    },
    "decisive_joint": {"type": ["integer", "null"], "minimum": 0},
    "target_h": _MAYBE,
    "passes": {"description": "whether target and limits are kept", **_FLAG},
    "chosen_size": {
        "description": "the smallest size that reaches the target, or the next larger one; null if "
        "none is needed or none suffices",
        "type": ["string", "null"],
    },
    "heat_W": {"description": "mean of all joints over the duty cycle", **_MAYBE},
    "efficiency": {"description": "of the energy over the duty cycle", **_MAYBE},
    "steps": {
        "type": "array",
        "items": record(
            {
                "step": _TEXT,
                "share": _NUMBER,
                "speed_rpm": _NUMBER,
                "torque_Nm": _NUMBER,
                "bends_deg": _NUMBERS,
            }
        ),
    },
    "joints": {
        "type": "array",
        "items": record(
            {
                "joint": _COUNT,
                "size": _TEXT,
                "bearing": {"enum": ["needle", "plain"]},
                "L10_h": _MAYBE,
                "catalogue_L10_h": _MAYBE,
                "damage": {"description": "share of each step", **_NUMBERS},
                "false_brinelling": {
                    "description": "whether its needles swing by less than 3 deg in a step",
                    **_FLAG,
                },
                "bend_deg": _JUDGED,
                "speed_bend_rpm_deg": _JUDGED,
                "heat_W": _MAYBE,
                "largest_heat_W": _MAYBE,
                "largest_heat_in": {"type": ["string", "null"]},
            }
        ),
    },
    "sizes": {
        "type": "array",
        "items": record(
            {
                "size": _TEXT,
                "rating_Nm": _MAYBE,
                "L10_h": _MAYBE,
                "decisive_joint": {"type": ["integer", "null"], "minimum": 0},
                "fits": {
                    "description": "whether bends and speeds are within its limits",
                    **_FLAG,
                },
                "heat_W": _MAYBE,
            }
        ),
    },
}

SCHEMA = record(_PART)
"""JSON Schema of what ``data`` returns."""

LIFE_SCHEMA = answer_schema(
    "life", "what cardan life prints with --json", _PART, {"tubes": PARTS["tubes"].schema()}
)
"""JSON Schema of what ``life_data`` returns."""
