"""A steering column as numbers: of [driveline], or of every state."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import ANGLE, one_of
from cardan.arrays import FloatArray
from cardan.design.judged import LimitVerdict, is_within
from cardan.driveline import Driveline


@dataclass(frozen=True)
class OnCentre:
    """One driveline straight ahead.

    Attributes:
        state: name of the state, "" without states.
        ratio: speed of the last shaft over that of the column.
        slope: derivative of the ratio by the angle of the column, per rad.
        offset_deg: how far straight ahead is beyond the nearest symmetric angle.
        nearest: whether the ratio is largest (``quick``) or least (``slow``) there.
        turn_to_quick_deg: how to turn the driving yoke of joint 0 on the column to have the largest
            ratio straight ahead; positive is clockwise, looking towards the output.
        turn_to_slow_deg: the same for the least ratio.
    """

    state: str
    ratio: float
    slope: float
    offset_deg: float
    nearest: Literal["quick", "slow"]
    turn_to_quick_deg: float
    turn_to_slow_deg: float


@dataclass(frozen=True)
class SteeringFigures:
    """A steering column in all of its states.

    Attributes:
        centre_deg: drive angle straight ahead.
        limit_deg: permitted distance from symmetry, if the scene gives one.
        each: of every state, or of the only driveline.
    """

    centre_deg: float
    limit_deg: float | None
    each: tuple[OnCentre, ...]

    @property
    def worst(self) -> OnCentre:
        """The one farthest from symmetry."""
        return max(self.each, key=lambda one: abs(one.offset_deg))

    @property
    def verdict(self) -> LimitVerdict:
        """Whether the worst is within the limit."""
        if self.limit_deg is None:
            return "not judged"
        within = is_within(abs(self.worst.offset_deg), self.limit_deg, size=90.0)
        return "within" if within else "beyond"

    @property
    def passes(self) -> bool:
        """Whether no limit is exceeded."""
        return self.verdict != "beyond"


def find(answer: Answer) -> SteeringFigures | None:
    """Return what a scene's driveline does as a steering column; ``None`` if it is none."""
    scene = answer.scene
    column = scene.steering
    if column is None:
        return None
    lines = scene.drivelines()
    names = scene.states.names if scene.states else ("",)
    found = lines.steering(_carried(scene.line, lines, np.radians(column.centre_deg)))
    each = tuple(
        OnCentre(
            name,
            float(found.ratio[i]),
            float(found.slope[i]),
            float(np.degrees(found.offset[i])),
            "quick" if found.quick[i] else "slow",
            float(np.degrees(found.turn_to_quick[i])),
            float(np.degrees(found.turn_to_slow[i])),
        )
        for i, name in enumerate(names)
    )
    return SteeringFigures(column.centre_deg, column.offset_deg, each)


def _carried(drawn: Driveline, lines: Driveline, centre: float) -> FloatArray:
    """The drive angle of each state with the yoke where it is straight ahead in [driveline].

    Drive angles count from the plane of shafts 0 and 1, which a state may turn about the column.
    A column that tilts carries its yoke along by the smallest rotation from one direction to the
    other, ``x - (a + b)·x (a + b)/(1 + a·b) + 2 a·x b``.
    """
    a, b = drawn.directions[0], lines.directions[:, 0]
    normal = drawn.normals[0]
    pin = np.cos(centre) * np.cross(normal, a) + np.sin(centre) * normal
    both = a + b
    share = np.sum(both * pin, axis=-1) / (1.0 + np.sum(a * b, axis=-1))
    # The pin is square to a, so the last term vanishes.
    carried = pin - share[:, None] * both
    normals = lines.normals[:, 0]
    along = np.sum(carried * np.cross(normals, b), axis=-1)
    return np.asarray(np.arctan2(np.sum(carried * normals, axis=-1), along))


def data(found: SteeringFigures, *, radians: bool = False) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes it."""
    unit, turned = ("rad", math.radians) if radians else ("deg", float)
    return {
        f"centre_{unit}": turned(found.centre_deg),
        f"limit_{unit}": None if found.limit_deg is None else turned(found.limit_deg),
        "verdict": found.verdict,
        "on_centre": [
            {
                **({"state": one.state} if one.state else {}),
                "ratio": one.ratio,
                "slope": one.slope,
                f"offset_{unit}": turned(one.offset_deg),
                "nearest": one.nearest,
                f"turn_to_quick_{unit}": turned(one.turn_to_quick_deg),
                f"turn_to_slow_{unit}": turned(one.turn_to_slow_deg),
            }
            for one in found.each
        ],
    }


def _angle(name: str, description: str, kind: Any = "number") -> dict[str, Any]:  # noqa: ANN401
    return {f"{name}_{unit}": {"type": kind, "description": description} for unit in ANGLE}


_TURN = "of the driving yoke; positive is clockwise, looking from the column to the output"

SCHEMA: Mapping[str, Any] = one_of(
    {
        "verdict": {"enum": ["within", "beyond", "not judged"]},
        "on_centre": {
            "type": "array",
            "items": one_of(
                {
                    "ratio": {"type": "number"},
                    "slope": {"type": "number", "description": "of the ratio, per rad"},
                    "nearest": {"enum": ["quick", "slow"]},
                },
                _angle("offset", "how far straight ahead is beyond the nearest symmetry"),
                _angle("turn_to_quick", _TURN),
                _angle("turn_to_slow", _TURN),
                optional={"state": {"type": "string"}},
            ),
        },
    },
    _angle("centre", "drive angle straight ahead"),
    _angle("limit", "of the offset", ["number", "null"]),
)
"""JSON Schema of ``data``."""


def verdicts(found: SteeringFigures) -> dict[str, str]:
    """Return the verdicts on what the scene limits."""
    return {"symmetry": found.verdict}
