"""Rules for the values of [optimise]: what may change, how far, and what must be kept.

A schema cannot say that a range contains 0; only the reader checks that.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import ListOf, Number, Rule, Schema, refused
from cardan.app.scene.language.units import ending_of
from cardan.arrays.errors import nearest
from cardan.design.quantities import MOTION_QUANTITIES, pattern
from cardan.evaluation.outputs import OUTPUTS

FREE = "free"
"""The range of a phase that may take any value."""

_RANGE = ListOf(Number(), "two numbers, least and largest change", count=2)


def _ending(unit: str) -> str:
    """The ending of a key for a quantity with this SI unit; angles are in degrees."""
    return ending_of({"rad": "deg", "1": ""}.get(unit, unit))


_BEND = Number(0, 90, above=True, below=True, unit="deg")

KEPT: Mapping[str, Number] = MappingProxyType(
    {
        f"{quantity.name}{_ending(quantity.unit)}": _BEND
        if quantity.unit == "rad"
        else Number(0, above=True)
        for quantity in MOTION_QUANTITIES.values()
    }
)
"""Limits of the motion, by key with its unit."""

_PLACE = "[0-9]{1,9}(-[0-9]{1,9})?"
_PHASES = "phases_deg"
_VECTORS = "(points_m|points_mm|directions)"
_LISTS = (
    "(bends_deg|twists_deg|slopes_vertical_deg|slopes_horizontal_deg"
    "|projected_bends_vertical_deg|projected_bends_horizontal_deg)"
)


@dataclass(frozen=True)
class Vary(Rule):
    """The keys that may change, each with the range of its change."""

    def read(self, where: Location, value: object) -> dict[str, tuple[float, float] | None]:
        """Return the ranges by path; ``None`` for a key that is free."""
        if not isinstance(value, dict) or not value:
            raise refused(where, value, 'name keys and ranges, as {"points_mm.2.y" = [-40, 40]}')
        found: dict[str, tuple[float, float] | None] = {}
        for path, given in _flat(value):
            own = where.at(path if path.isprintable() else ascii(path))
            if path in found:
                raise own.error("is given twice, with quotes and without")
            if re.fullmatch(rf"{_VECTORS}(\.{_PLACE})?", path):
                raise own.error("needs place and axis, as in points_mm.2.y")
            if path.startswith("inertias_kgm2"):
                raise own.error(
                    "is a key of [load]; what may change is the layout in [driveline], and [study] "
                    "compares inertias"
                )
            if not re.fullmatch(_PATH, path):
                raise own.error(
                    "is no path of a key of [driveline], as points_mm.2.y, phases_deg.0 or "
                    "bends_deg.0-1"
                )
            found[path] = self._range(own, path, given)
        return found

    @staticmethod
    def _range(where: Location, path: str, given: object) -> tuple[float, float] | None:
        if given == FREE:
            if not path.startswith(_PHASES):
                raise where.error("is 'free'; only phases may be, others need [least, largest]")
            return None
        if not isinstance(given, list):
            raise refused(where, given, "be [least change, largest change], or 'free' for a phase")
        low, high = _RANGE.read(where, given)
        if not low < high:
            raise where.error(f"is [{low:g}, {high:g}]; the first must be below the second")
        if not low <= 0.0 <= high:
            raise where.error(
                f"is [{low:g}, {high:g}]; it is the range of the change, which must contain 0"
            )
        return low, high

    @property
    def schema(self) -> Schema:
        """An object of ranges, by path in quotes or within tables."""
        ends = _RANGE.schema
        phase: Schema = {"anyOf": [ends, {"enum": [FREE]}]}
        by_axis = _tables("^[xyz]$", ends)
        by_place = f"^{_PLACE}$"
        return {
            "type": "object",
            "minProperties": 1,
            "patternProperties": {
                rf"^{_VECTORS}\.{_PLACE}\.[xyz]$": ends,
                rf"^{_VECTORS}\.{_PLACE}$": by_axis,
                f"^{_VECTORS}$": _tables(by_place, by_axis),
                rf"^{_PHASES}\.{_PLACE}$": phase,
                f"^{_PHASES}$": {"anyOf": [phase, _tables(by_place, phase)]},
                rf"^{_LISTS}\.{_PLACE}$": ends,
                f"^{_LISTS}$": {"anyOf": [ends, _tables(by_place, ends)]},
            },
            "additionalProperties": False,
        }


_PATH = rf"{_VECTORS}\.{_PLACE}\.[xyz]|({_PHASES}|{_LISTS})(\.{_PLACE})?"


def _tables(pattern: str, entry: Schema) -> Schema:
    return {
        "type": "object",
        "minProperties": 1,
        "patternProperties": {pattern: entry},
        "additionalProperties": False,
    }


def _flat(value: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """The values of tables within tables by their whole path."""
    for key, entry in value.items():
        path = f"{above}.{key}" if above else key
        if isinstance(entry, dict) and entry:
            yield from _flat(entry, path)
        else:
            yield path, entry


def kept_quantity(key: str) -> str:
    """Return the quantity of a key of ``keep``, without its unit; ``""`` if there is none."""
    for quantity in MOTION_QUANTITIES.values():
        if key == f"{quantity.name}{_ending(quantity.unit)}":
            return quantity.name
    for output in OUTPUTS.values():
        ending = _ending(output.unit)
        if re.fullmatch(pattern(output) + ending, key):
            return key.removesuffix(ending)
    return ""


@dataclass(frozen=True)
class Keep(Rule):
    """Limits of other quantities."""

    def read(self, where: Location, value: object) -> dict[str, float]:
        """Return the limits by key."""
        if not isinstance(value, dict) or not value:
            raise refused(where, value, "name quantities and limits, as {non_uniformity = 0.01}")
        limits = {}
        for key, given in value.items():
            own = where.at(key)
            if not kept_quantity(key):
                hint = nearest(key, KEPT)
                raise own.error(
                    f"is no quantity; {hint} (an output has its number, reduction and unit, as "
                    "support_moment_1_peak_Nm)"
                )
            limits[key] = KEPT.get(key, Number(0, above=True)).read(own, given)
        return limits

    @property
    def schema(self) -> Schema:
        """An object of positive numbers."""
        positive = Number(0, above=True).schema
        outputs = "|".join(pattern(output) + _ending(output.unit) for output in OUTPUTS.values())
        return {
            "type": "object",
            "minProperties": 1,
            "properties": {key: rule.schema for key, rule in KEPT.items()},
            "patternProperties": {f"^({outputs})$": positive},
            "additionalProperties": False,
        }
