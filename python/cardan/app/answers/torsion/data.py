"""Torsional vibration of a scene as plain data for JSON, and what describes it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.torsion.figures import TorsionFigures
from cardan.app.answers.torsion.modes import BendRule, TorsionBasics, VibrationMode
from cardan.app.answers.torsion.stability import SpeedRange
from cardan.app.scene.units import RPM
from cardan.arrays import FloatArray


def torsion_data(title: str, found: TorsionFigures, files: Sequence[str] = ()) -> dict[str, Any]:
    """Return the torsional vibration of a scene as plain data for JSON.

    Args:
        title: of the scene.
        found: its figures.
        files: what was written.
    """
    system = found.torsion.system
    return answer(
        "torsion",
        title,
        verdict=found.verdict,
        speed_range=_range(SpeedRange(*(float(found.speed[end]) for end in (0, -1)))),
        natural_frequencies=[_mode(mode, system.compliant) for mode in found.modes],
        critical_speeds=[
            {
                "order": critical.order,
                "speed_rpm": critical.speed / RPM,
                "natural_frequency": critical.mode,
                "shaft": critical.shaft,
                "inside": critical.inside,
                "amplitude_Nm": finite_or_none(critical.amplitude),
            }
            for critical in found.critical_speeds
        ],
        torques=[
            {
                "shaft": largest.shaft,
                "speed_rpm": largest.speed / RPM,
                "least_Nm": finite_or_none(largest.least),
                "largest_Nm": finite_or_none(largest.most),
                "mean_Nm": finite_or_none(largest.mean),
                "reversals": [_range(part) for part in largest.reversals],
            }
            for largest in found.largest
        ],
        unstable=[
            {**_range(region), "multiplier": finite_or_none(region.multiplier)}
            for region in found.unstable
        ],
        missing=[{**_range(part), "reason": reason} for part, reason in found.missing],
        periodic_motions=[
            {
                "speed_rpm": motions.speed / RPM,
                "count": motions.count,
                "stable": motions.stable,
                "shaft": motions.shaft,
                "smallest_Nm": finite_or_none(motions.smallest),
                "largest_Nm": finite_or_none(motions.largest),
            }
            for motions in found.motions
        ],
        bend_rules=[_rule(rule) for rule in found.rules],
        response=_response(found),
        files=list(files),
    )


def data(found: TorsionBasics, *, radians: bool = False) -> dict[str, Any]:
    """Return what a check says of torsional vibration as plain data for JSON."""
    return {
        "critical_speeds": [
            {
                "order": order,
                "speed_rpm": speed / RPM,
                "shaft": found.modes[mode].shaft,
                "inside": found.is_inside(speed),
            }
            for mode, order, speed in found.criticals()
        ],
        "bend_rules": [_rule(rule) for rule in found.rules],
    }


def _range(part: SpeedRange) -> dict[str, float]:
    return {"from_rpm": part.start / RPM, "to_rpm": part.stop / RPM}


def _mode(mode: VibrationMode, compliant: Sequence[int]) -> dict[str, Any]:
    return {
        "frequency_Hz": mode.frequency / math.tau,
        "damping_ratio": mode.damping_ratio,
        "shaft": mode.shaft,
        "shares": [
            {"shaft": shaft, "share": share}
            for shaft, share in zip(compliant, mode.shares, strict=True)
        ],
    }


def _rule(rule: BendRule) -> dict[str, Any]:
    return {
        "shaft": rule.shaft,
        "equivalent_bend_deg": math.degrees(rule.bend),
        "factor": rule.factor,
        "damping_ratio": rule.damping_ratio,
        "exceeded": rule.exceeded,
        "speed_rpm": rule.speed / RPM,
        "inside": rule.inside,
    }


def _response(found: TorsionFigures) -> dict[str, Any]:
    response = found.response
    return {
        "speed_rpm": (found.speed / RPM).tolist(),
        "shafts": [
            {
                "shaft": shaft,
                "mean_Nm": _numbers(response.torque_mean[place]),
                "least_Nm": _numbers(response.torque_min[place]),
                "largest_Nm": _numbers(response.torque_max[place]),
                "orders": [
                    {
                        "order": int(order),
                        "amplitude_Nm": _numbers(np.abs(response.torque_orders[place, :, i])),
                    }
                    for i, order in enumerate(response.orders)
                ],
            }
            for place, shaft in enumerate(response.compliant)
        ],
    }


def _numbers(values: FloatArray) -> list[float | None]:
    return [finite_or_none(float(value)) for value in values]


_NUMBER = {"type": "number"}
_MAYBE = {"type": ["number", "null"]}
_COUNT = {"type": "integer", "minimum": 0}
_ORDER = {"type": "integer", "minimum": 1}
_FLAG = {"type": "boolean"}
_TEXT = {"type": "string"}
_ENDS: Mapping[str, Any] = {"from_rpm": _NUMBER, "to_rpm": _NUMBER}


def _list(item: Mapping[str, Any], description: str = "") -> dict[str, Any]:
    return {
        "type": "array",
        **({"description": description} if description else {}),
        "items": item,
    }


_SAMPLES = _list(_MAYBE)

_RULES = _list(
    record(
        {
            "shaft": _COUNT,
            "equivalent_bend_deg": _NUMBER,
            "factor": {**_NUMBER, "description": "tan² of half the equivalent bend"},
            "damping_ratio": _NUMBER,
            "exceeded": _FLAG,
            "speed_rpm": _NUMBER,
            "inside": {**_FLAG, "description": "whether the speeds concerned are in the range"},
        }
    ),
    "per compliant shaft with joints behind it: whether their bend permits instability",
)

TORSION_SCHEMA = answer_schema(
    "torsion",
    "what cardan torsion prints with --json",
    {
        "verdict": {"enum": ["unstable", "reversing", "resonant", "clear"]},
        "speed_range": record(_ENDS),
        "natural_frequencies": _list(
            record(
                {
                    "frequency_Hz": _NUMBER,
                    "damping_ratio": _NUMBER,
                    "shaft": _COUNT,
                    "shares": _list(record({"shaft": _COUNT, "share": _NUMBER})),
                }
            ),
            "lowest first; a share is that of a shaft in the energy of twist",
        ),
        "critical_speeds": _list(
            record(
                {
                    "order": _ORDER,
                    "speed_rpm": _NUMBER,
                    "natural_frequency": {**_COUNT, "description": "its number, counted from 0"},
                    "shaft": _COUNT,
                    "inside": {**_FLAG, "description": "whether it lies in the speed range"},
                    "amplitude_Nm": {
                        **_MAYBE,
                        "description": "of this order of the shaft's torque at this speed; null "
                        "without a periodic motion",
                    },
                }
            )
        ),
        "torques": _list(
            record(
                {
                    "shaft": _COUNT,
                    "speed_rpm": _NUMBER,
                    "least_Nm": _MAYBE,
                    "largest_Nm": _MAYBE,
                    "mean_Nm": _MAYBE,
                    "reversals": _list(record(_ENDS)),
                }
            ),
            "per compliant shaft: the largest torque over the speed range; null in a resonance "
            "without damping, where it is not limited",
        ),
        "unstable": _list(
            record({**_ENDS, "multiplier": _MAYBE}),
            "where small deviations grow; the multiplier is that of half a turn",
        ),
        "missing": _list(record({**_ENDS, "reason": _TEXT}), "speeds without a periodic motion"),
        "periodic_motions": _list(
            record(
                {
                    "speed_rpm": _NUMBER,
                    "count": _COUNT,
                    "stable": {**_COUNT, "description": "how many of them are stable"},
                    "shaft": {**_COUNT, "description": "the shaft with the largest torque"},
                    "smallest_Nm": {
                        **_MAYBE,
                        "description": "its largest torque in the motion in which that is least",
                    },
                    "largest_Nm": _MAYBE,
                }
            ),
            "how many periodic motions a search found at the worst critical speed, at the speed of "
            "the largest torque and amid the most unstable range; the other parts have one at each "
            "speed",
        ),
        "bend_rules": _RULES,
        "response": record(
            {
                "speed_rpm": _list(_NUMBER),
                "shafts": _list(
                    record(
                        {
                            "shaft": _COUNT,
                            "mean_Nm": _SAMPLES,
                            "least_Nm": _SAMPLES,
                            "largest_Nm": _SAMPLES,
                            "orders": _list(record({"order": _ORDER, "amplitude_Nm": _SAMPLES})),
                        }
                    )
                ),
            }
        ),
        "files": _list(_TEXT, "what was written"),
    },
)
"""JSON Schema of what ``torsion_data`` returns."""

SCHEMA = record(
    {
        "critical_speeds": _list(
            record({"order": _ORDER, "speed_rpm": _NUMBER, "shaft": _COUNT, "inside": _FLAG})
        ),
        "bend_rules": _RULES,
    }
)
"""JSON Schema of what ``data`` returns."""
