"""The section [optimise]: what may change, how far, and what must be kept.

A schema cannot say that a range contains 0; only the reader checks that.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.quantities import KEPT, Keep, QuantityName
from cardan.app.scene.language.rules import (
    COUNT,
    ListOf,
    Number,
    OneOf,
    Rule,
    Schema,
    refused,
    tables,
)
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.language.units import us_keys
from cardan.app.scene.sections.bearing import POSITIONS
from cardan.app.scene.sections.driveline import (
    DOUBLE_JOINT,
    DRIVELINE,
    SINGLE_BEND,
    SINGLE_PHASE,
    SINGLE_TWIST,
    SYNCHRONOUS,
)
from cardan.app.scene.study.axes import ENTRIES
from cardan.design.quantities import MOTION_QUANTITIES

if TYPE_CHECKING:
    from cardan.app.scene.study.optimisation import Optimisation

FREE = "free"
"""The range of a phase that may take any value."""

_OF_DOUBLE = (DOUBLE_JOINT, SYNCHRONOUS, SINGLE_BEND, SINGLE_TWIST)

_RANGE = ListOf(Number(), "two numbers, least and largest change", count=2)


def _either(*keys: str) -> str:
    """Return the pattern of one of some keys, in SI or US units."""
    return f"({'|'.join(each for key in keys for each in (key, *us_keys(key)))})"


_PHASES = "phases_deg"
_VECTORS = _either("points_m", "points_mm", "directions")
_ANGLES = [name for name, key in DRIVELINE.keys.items() if key.entry and name.endswith("_deg")]
_LISTS = f"({'|'.join(name for name in _ANGLES if name != _PHASES)})"


@dataclass(frozen=True)
class Vary(Rule):
    """The keys that may change, each with the range of its change."""

    name = "ranges"

    def read(self, where: Location, value: object) -> dict[str, tuple[float, float] | None]:
        """Return the ranges by path; ``None`` for a key that is free."""
        if not isinstance(value, dict) or not value:
            raise refused(where, value, 'name keys and ranges, as {"points_mm.2.y" = [-40, 40]}')
        found: dict[str, tuple[float, float] | None] = {}
        for path, given in _flat(value):
            own = where.at(path if path.isprintable() else ascii(path))
            if path in found:
                raise own.error("is given twice, with quotes and without")
            if re.fullmatch(rf"{_VECTORS}(\.{ENTRIES})?", path):
                raise own.error("needs place and axis, as in points_mm.2.y")
            if path.startswith("inertias_kgm2"):
                raise own.error(
                    "is a key of [load]; what may change is the layout in [driveline], and [study] "
                    "compares inertias"
                )
            if path.partition(".")[0] in (*_OF_DOUBLE, SINGLE_PHASE) and "." in path:
                raise own.error("is of one value; write the key alone, without a place")
            if not re.fullmatch(_PATH, path):
                raise own.error(
                    "is no path of a key that may change, as points_mm.2.y, "
                    "phases_deg.0, bends_deg.0-1, synchronous_deg or bearing.0.position_mm; "
                    "[study] compares values of other keys"
                )
            found[path] = self._range(own, path, given)
        return found

    @staticmethod
    def _range(where: Location, path: str, given: object) -> tuple[float, float] | None:
        if given == FREE:
            if not path.startswith((_PHASES, SINGLE_PHASE)):
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
        ends = _RANGE.schema
        phase: Schema = {"anyOf": [ends, {"enum": [FREE]}]}
        by_axis = tables("^[xyz]$", ends)
        by_place = f"^{ENTRIES}$"
        return {
            "type": "object",
            "minProperties": 1,
            "patternProperties": {
                rf"^{_VECTORS}\.{ENTRIES}\.[xyz]$": ends,
                rf"^{_VECTORS}\.{ENTRIES}$": by_axis,
                f"^{_VECTORS}$": tables(by_place, by_axis),
                rf"^{_PHASES}\.{ENTRIES}$": phase,
                f"^{_PHASES}$": {"anyOf": [phase, tables(by_place, phase)]},
                rf"^{_LISTS}\.{ENTRIES}$": ends,
                f"^{_LISTS}$": {"anyOf": [ends, tables(by_place, ends)]},
                f"^({'|'.join(_OF_DOUBLE)})$": ends,
                f"^{SINGLE_PHASE}$": phase,
                f"^{_OF_BEARING}$": ends,
                rf"^bearing\.{_BEARING}$": tables(f"^{_POSITION}$", ends),
                "^bearing$": tables(f"^{_BEARING}$", tables(f"^{_POSITION}$", ends)),
            },
            "additionalProperties": False,
        }


_BEARING, _POSITION = "[0-9]{1,9}", _either(*POSITIONS)
_OF_BEARING = rf"bearing\.{_BEARING}\.{_POSITION}"
_PATH = "|".join(
    (
        *(_OF_BEARING, rf"{_VECTORS}\.{ENTRIES}\.[xyz]", rf"({_PHASES}|{_LISTS})(\.{ENTRIES})?"),
        *(*_OF_DOUBLE, SINGLE_PHASE),
    )
)


def _flat(value: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """The values of tables within tables by their whole path."""
    for key, entry in value.items():
        path = f"{above}.{key}" if above else key
        if isinstance(entry, dict) and entry:
            yield from _flat(entry, path)
        else:
            yield path, entry


def _optimisation(values: Mapping[str, Any], scene: Reading) -> Optimisation:
    # Its search is imported by the scenes that ask for one.
    from cardan.app.scene.study.optimisation import optimisation_of

    return optimisation_of(OPTIMISE.filled(values), scene)


OPTIMISE: Section[Optimisation | None] = Section(
    "optimise",
    'keys that may change so that the driveline runs better over all states; "cardan optimise" '
    "finds the best values",
    {
        "vary": Key(
            Vary(),
            "keys of [driveline] and positions of bearings, and how far each may change from its "
            'value, as {"points_mm.2.y" = [-40, 40], "phases_deg.0" = "free", '
            '"bearing.0.position_mm" = [-50, 50]}',
        ),
        "minimise": Key(
            QuantityName(),
            f"{', '.join(MOTION_QUANTITIES)}, or an output with the number of its shaft, joint or "
            "bearing and its reduction over the turn, as support_moment_1_peak",
            default="equivalent_bend",
        ),
        "over": Key(
            OneOf(("largest", "rms")),
            "how states combine: largest value, or root mean square with the weights of [states]",
            default="largest",
        ),
        "keep": Key(
            Keep(),
            f"largest permitted values in every state: {', '.join(KEPT)}, or outputs as above "
            "with their unit, as support_moment_1_peak_Nm",
        ),
        "starts": Key(
            COUNT,
            "number of local searches; more of them miss the best of many local optima less often",
            default=8,
        ),
    },
    _optimisation,
    needed=(("vary",),),
)
