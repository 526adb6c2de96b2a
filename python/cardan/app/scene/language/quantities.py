"""Rules for quantities of the motion and outputs over a turn: their names, and limits of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cardan.app.scene.language import errors, rules
from cardan.app.scene.language.units import ending_of, si_key, us_keys
from cardan.arrays.errors import nearest
from cardan.design.quantities import (
    FIRST_ORDERS,
    MOTION_QUANTITIES,
    ORDER_PATTERN,
    nearest_quantity,
    order_quantity,
    pattern,
    reduced_quantity,
)
from cardan.evaluation.outputs import OUTPUTS


@dataclass(frozen=True)
class QuantityName(rules.Rule):
    """The name of a quantity, or also of an output without item and reduction or of an order."""

    outputs: bool = False
    name = "name"

    @property
    def _names(self) -> list[str]:
        return [*MOTION_QUANTITIES, *(OUTPUTS if self.outputs else ())]

    def read(self, where: errors.Location, value: object) -> str:
        name = rules.Text().read(where, value)
        other = reduced_quantity(name) or (self.outputs and order_quantity(name))
        if name not in self._names and not other:
            known = [*self._names, *(FIRST_ORDERS if self.outputs and "order" in name else ())]
            raise where.error(f"is {rules.shown(name)}; {nearest_quantity(name, known)}")
        return name

    @property
    def schema(self) -> rules.Schema:
        # Python's end of a text may have a line end behind it; that of JSON Schema may not.
        forms = [*map(pattern, OUTPUTS.values()), *([ORDER_PATTERN] if self.outputs else [])]
        outputs = f"^({'|'.join(forms)})$(?!\\n)"
        return {"anyOf": [{"enum": self._names}, {"type": "string", "pattern": outputs}]}


def _ending(unit: str) -> str:
    """The ending of a key for a quantity with this SI unit; angles are in degrees."""
    return ending_of({"rad": "deg", "1": ""}.get(unit, unit))


KEPT: Mapping[str, rules.Number] = MappingProxyType(
    {
        f"{quantity.name}{_ending(quantity.unit)}": rules.ACUTE
        if quantity.unit == "rad"
        else rules.POSITIVE
        for quantity in MOTION_QUANTITIES.values()
    }
)
"""Limits of the motion, by key with its unit."""


def kept_quantity(key: str) -> str:
    """Return the quantity of a key of ``keep``, without its unit; ``""`` if there is none."""
    key = si_key(key)
    for quantity in MOTION_QUANTITIES.values():
        if key == f"{quantity.name}{_ending(quantity.unit)}":
            return quantity.name
    for output in OUTPUTS.values():
        ending = _ending(output.unit)
        if re.fullmatch(pattern(output) + ending, key):
            return key.removesuffix(ending)
    return ""


@dataclass(frozen=True)
class Keep(rules.Rule):
    """Limits of other quantities."""

    name = "limits"

    def read(self, where: errors.Location, value: object) -> dict[str, float]:
        if not isinstance(value, dict) or not value:
            raise rules.refused(
                where, value, "name quantities and limits, as {non_uniformity = 0.01}"
            )
        limits: dict[str, float] = {}
        for key, given in value.items():
            own = where.at(key)
            if not kept_quantity(key):
                hint = nearest(key, KEPT)
                raise own.error(
                    f"is no quantity; {hint} (an output has its number, reduction and unit, as "
                    "support_moment_1_peak_Nm)"
                )
            if other := next((each for each in limits if si_key(each) == si_key(key)), ""):
                raise own.error(f"and {other} are both given; give one of them")
            limits[key] = KEPT.get(key, rules.POSITIVE).read(own, given)
        return limits

    @property
    def schema(self) -> rules.Schema:
        outputs = "|".join(
            pattern(output) + key
            for output in OUTPUTS.values()
            for ending in [_ending(output.unit)]
            for key in (ending, *us_keys(ending))
        )
        return {
            "type": "object",
            "minProperties": 1,
            "properties": {key: rule.schema for key, rule in KEPT.items()},
            "patternProperties": {f"^({outputs})$": rules.POSITIVE.schema},
            "additionalProperties": False,
        }
