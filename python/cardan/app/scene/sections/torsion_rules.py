"""Rules for the values of [torsion]: inertias of shaft ends, stiffnesses, speeds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import ListOf, Number, Rule, Schema, Whole, refused, shown
from cardan.arrays import FloatArray
from cardan.arrays.errors import nearest

RIGID = "rigid"
"""What a scene writes for the stiffness of a rigid shaft."""

TUBE: Literal["tube"] = "tube"
"""What it writes for the stiffness of a shaft in [tubes]."""

# No shaft of a machine is beyond these ends, and within them the equations can be solved.
_INERTIA = Number(0, 1e6, what="an inertia")
_PAIR = ListOf(_INERTIA, "two numbers", count=2)
_STIFFNESS = Number(1e-3, 1e12, what="a stiffness")

_MOST_SPEEDS = 100_000
_SPEED = Number(1e-3, 1e6, what="a speed")


@dataclass(frozen=True)
class EndInertias(Rule):
    """The inertia of a shaft: one number, half at each end, or one number for each end."""

    def read(self, where: Location, value: object) -> tuple[float, float]:
        """Return the inertias of input end and output end."""
        if isinstance(value, list):
            ends: list[float] = _PAIR.read(where, value)
            return ends[0], ends[1]
        half = 0.5 * _INERTIA.read(where, value)
        return half, half

    @property
    def schema(self) -> Schema:
        """A number or a pair."""
        return {"oneOf": [_INERTIA.schema, _PAIR.schema]}


@dataclass(frozen=True)
class ShaftStiffness(Rule):
    """The stiffness of a shaft: a number, ``"rigid"`` or ``"tube"``."""

    def read(self, where: Location, value: object) -> float | Literal["tube"]:
        """Return the stiffness, infinite for a rigid shaft, or ``"tube"``."""
        if value == RIGID:
            return math.inf
        if value == TUBE:
            return TUBE
        if isinstance(value, str) or value == math.inf:
            raise refused(where, value, f'be a positive number, "{RIGID}" or "{TUBE}"')
        return _STIFFNESS.read(where, value)

    @property
    def schema(self) -> Schema:
        """A number or one of the words."""
        return {"oneOf": [_STIFFNESS.schema, {"enum": [RIGID, TUBE]}]}


_SPREAD: Mapping[str, Rule] = {
    "from": _SPEED,
    "to": _SPEED,
    "steps": Whole(2, most=_MOST_SPEEDS),
}


@dataclass(frozen=True)
class SpeedValues(Rule):
    """The drive speeds at which a driveline runs: evenly spread or listed."""

    def read(self, where: Location, value: object) -> FloatArray:
        """Return the speeds, rising, ``(speeds,)``."""
        if isinstance(value, list):
            speeds: list[float] = ListOf(_SPEED, "speeds", distinct=True).read(where, value)
            if len(speeds) < 2:
                raise where.error(f"is {shown(value)}; name at least two speeds")
            return np.array(sorted(speeds))
        wanted = "{from = …, to = …, steps = …}"
        if not isinstance(value, dict):
            raise refused(where, value, f"be {wanted} or a list of speeds")
        for key in value:
            if key not in _SPREAD:
                raise where.error(f"has an unknown key {shown(key)}; {nearest(key, _SPREAD)}")
        for key in _SPREAD:
            if key not in value:
                raise where.error(f"has no {key!r}; it must be {wanted}")
        start, stop, steps = (rule.read(where.at(key), value[key]) for key, rule in _SPREAD.items())
        if start >= stop:
            raise where.at("to").error(f"is {stop:g}; it must be above 'from', {start:g}")
        return np.asarray(np.linspace(start, stop, steps), dtype=np.float64)

    @property
    def schema(self) -> Schema:
        """An array of speeds or an object."""
        listed = {"type": "array", "items": _SPEED.schema, "minItems": 2, "uniqueItems": True}
        return {
            "oneOf": [
                listed,
                {
                    "type": "object",
                    "properties": {key: rule.schema for key, rule in _SPREAD.items()},
                    "required": list(_SPREAD),
                    "additionalProperties": False,
                },
            ]
        }
