"""The rule for a material of a ball joint: what it may carry and how far it yields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import Number, Rule, Schema, refused, shown
from cardan.app.scene.language.units import units_of
from cardan.app.scene.sections.limits import Source
from cardan.arrays.errors import nearest

_COMPLIANCE, _LAYER = "compliance_um_per_MPa", ("layer_mm", "modulus_MPa")
_POISSON = "poisson"

# No material and no lining is beyond these ends, and within them no square overflows.
_KEYS: Mapping[str, Rule] = {
    "name": Source(),
    "allowable_pressure_MPa": Number(1e-3, 1e6),
    _COMPLIANCE: Number(1e-9, 1e9),
    _LAYER[0]: Number(1e-6, 1e6),
    _LAYER[1]: Number(1e-3, 1e9),
    _POISSON: Number(0, 0.5, below=True),
}


@dataclass(frozen=True)
class MaterialRule(Rule):
    """A table: a name, the allowable pressure, and the compliance or the layer that yields."""

    def read(self, where: Location, value: object) -> dict[str, str | float]:
        """Return the entries by key."""
        if not isinstance(value, dict):
            raise refused(where, value, f"be a table with some of {', '.join(_KEYS)}")
        for key in value:
            if key not in _KEYS:
                hint = units_of(key, _KEYS) or nearest(key, tuple(_KEYS))
                raise where.error(f"has an unknown key {shown(key)}; {hint}")
        read = {key: _KEYS[key].read(where.at(key), entry) for key, entry in value.items()}
        layer = [key for key in (*_LAYER, _POISSON) if key in value]
        if _COMPLIANCE in value and layer:
            raise where.at(layer[0]).error(f"and {_COMPLIANCE} are both given; give one of them")
        for key in _LAYER:
            if layer and key not in value:
                raise where.at(layer[0]).error(f"needs {key}; {' and '.join(_LAYER)} go together")
        return read

    @property
    def schema(self) -> Schema:
        """An object of these keys."""
        together = {key: list(_LAYER) for key in (*_LAYER, _POISSON)}
        return {
            "type": "object",
            "properties": {key: rule.schema for key, rule in _KEYS.items()},
            "additionalProperties": False,
            "dependentRequired": together,
            "not": {"required": [_COMPLIANCE, _LAYER[0]]},
        }
