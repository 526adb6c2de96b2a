"""The sections [[wind_up]]: points and shafts that turn or move in proportion to the torque."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import VECTOR, Number
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.language.units import size_of, split
from cardan.app.scene.sections.driveline import DRIVELINE, READINGS
from cardan.app.scene.study.axes import DIRECTION, ENTRY, Varied, Varying, entries_of
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError

_SLOPES = "slopes_vertical_deg"


class WindUp(NamedTuple):
    """Turn or shift of entries of a key, in units of the file, by place and per kN m of torque."""

    key: str
    rates: Mapping[str, Varying]

    def at(self, torque: FloatArray) -> Varied:
        """Return what varies with these mean torques in N m, one per state."""
        by = 1e-3 * torque
        each = self.rates.items()
        return {
            self.key: {at: rate._replace(steps=(by * rate.steps[0]).tolist()) for at, rate in each}
        }


def _wind_ups(_: Mapping[str, Any], scene: Reading) -> tuple[WindUp, ...]:
    tables = scene.document.tables.get(WIND_UP.name, ())
    if tables and "states" not in scene.given:
        raise ValueError(
            "needs the torques that it follows: give [states] output_torque_Nm = [-300, 200, 1500]"
        )
    found = []
    for i, values in enumerate(tables):
        with scene.document.within(f"{WIND_UP.name}.{i}"):
            found.append(_wind_up(values, scene))
    return tuple(found)


def _wind_up(values: Mapping[str, Any], scene: Reading) -> WindUp:
    keys, given = scene[DRIVELINE].keys, scene.document.given.get(DRIVELINE.name, {})
    rate, shift = values.get("deg_per_kNm"), values.get("mm_per_kNm")
    if "shafts" in values:
        name = next((key for key in (READINGS, _SLOPES) if key in keys), None)
        if name is None:
            raise ArgumentValueError(
                "shafts", f"need {READINGS} or {_SLOPES} in [driveline]; of points give points"
            )
        for key in ("mm_per_kNm", "about_mm", "axis"):
            if key in values:
                raise ArgumentValueError(key, "does not go with shafts, which tilt by deg_per_kNm")
        place = values["shafts"]
        entries_of(Location("shafts"), place, len(keys[name]))
        return WindUp(name, {place: Varying([values["deg_per_kNm"]], "add")})
    name = next((key for key in keys if key.startswith("points")), None)
    if name is None:
        raise ArgumentValueError("points", "need points_mm or points_m in [driveline]")
    own, place = given.get(name, name), values["points"]
    # Rates and places are in mm, and what varies is in the unit of the key.
    unit = (1.0 if name.endswith("_mm") else 1e-3) / size_of(own)
    rates: dict[str, Varying] = {}
    if rate is not None:
        if "about_mm" not in values:
            raise ArgumentValueError("deg_per_kNm", "needs about_mm, a point of the axis")
        about, axis = unit * np.array(values["about_mm"]), values.get("axis", [0.0, 0.0, 1.0])
        rates[place] = Varying([rate], "turn_deg", about.tolist(), axis, split(own)[1])
    for component, each in zip("xyz", shift or (), strict=False):
        if each:
            rates[f"{place}.{component}"] = Varying([unit * each], "add")
    entries_of(Location("points"), place, len(keys[name]))
    return WindUp(own, rates)


WIND_UP: Section[tuple[WindUp, ...]] = Section(
    "wind_up",
    "parts that turn or move with the torque: an axle on its springs, an engine on its mounts; "
    "give one section for each, and the torques in [states]",
    {
        "points": Key(ENTRY, 'the points that move, counted from 0: "3-4"'),
        "shafts": Key(
            ENTRY,
            f"or, with {READINGS} or {_SLOPES}: the shafts that tilt, counted from 0: "
            '"2", upwards to the output',
        ),
        "about_mm": Key(VECTOR, "for points: a point on the axis about which they turn"),
        "axis": Key(
            DIRECTION, 'its direction: "x", "y", "z" or three numbers', default="z", kind="axis"
        ),
        "deg_per_kNm": Key(
            Number(), "angle per kN m of mean torque, right-handed about the axis or upwards"
        ),
        "mm_per_kNm": Key(VECTOR, "instead, or in addition: displacement of the points per kN m"),
    },
    _wind_ups,
    together=(("points", "shafts"),),
    needed=(("points", "shafts"), ("deg_per_kNm", "mm_per_kNm")),
    with_key=(("about_mm", "deg_per_kNm"),),
    repeated=True,
    always=True,
)
