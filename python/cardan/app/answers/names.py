"""Names of a scene's keys and of a study's figures in words, with their units."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from cardan.app.scene.language.units import ENDINGS, as_shown, split
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.app.scene.sections.load import LOAD
from cardan.app.scene.study.study import Column
from cardan.evaluation.outputs import OUTPUTS

_ENTRIES: Mapping[str, tuple[str, str, int]] = MappingProxyType(
    {
        split(name)[0]: key.entry
        for section in (DRIVELINE, LOAD)
        for name, key in section.keys.items()
        if key.entry
    }
)
"""What an entry of a list is, of what, and the number of the first one; without units."""

_REDUCED = MappingProxyType({"peak": "largest", "min": "minimum", "max": "maximum"})


def key_name(key: str, joints: int | None = None) -> str:
    """Return what a scene's key is, points by the joints whose number is given.

    >>> key_name("points_mm.2.y", 3)
    'height of joint 1 [mm]'
    >>> key_name("phases_deg.0")
    'phase, shaft 1 [deg]'
    >>> key_name("points_mm.2-3.y")
    'points 2 to 3, y [mm]'
    >>> key_name("bearing.0.position_mm")
    'position, bearing 0 [mm]'
    """
    name, *places = key.split(".")
    if name == "bearing":
        number, of_bearing = places
        quantity, ending = split(of_bearing)
        return f"{quantity}, bearing {number}" + _bracketed(ENDINGS[ending].symbol)
    quantity, ending = split(name)
    if joints is not None and quantity == "points" and len(places) == 2:
        ends = [point_name(int(end), joints) for end in places[0].split("-")]
        what = {"y": "height"}.get(places[1], f"{places[1]} coordinate")
        return f"{what} of {' to '.join(ends)}" + _bracketed(ENDINGS[ending].symbol)
    entry, of, first = _ENTRIES.get(quantity, (quantity, "", 0))
    words = [entry if places else quantity.replace("_", " ")]
    for place in places:
        ends = place.split("-")
        numbered = all(end.isdecimal() for end in ends)
        numbers = " to ".join(str(first + int(end)) for end in ends) if numbered else place
        several = "s" if len(ends) > 1 else ""
        words.append(f"{of}{several} {numbers}" if numbered else place)
    return ", ".join(filter(None, words)) + _bracketed(ENDINGS[ending].symbol if ending else "")


def point_name(point: int, joints: int) -> str:
    """Return what is at a point of a driveline, counted from upstream."""
    ends = {0: "the upstream end", joints + 1: "the downstream end"}
    return ends.get(point, f"joint {point - 1}")


_KINDS = MappingProxyType(
    {
        "steering_offset": "angle off symmetry of the steering",
        "steering_ratio": "asymmetry of the ratio of the steering",
    }
)


def kind_name(kind: str) -> str:
    """Return what the figure of a machine is called, of ``KINDS``.

    >>> kind_name("equivalent_bend")
    'equivalent bend'
    """
    return _KINDS.get(kind, kind.replace("_", " "))


def column_name(column: Column) -> str:
    """Return what a figure of a study is, with the unit in which it is shown.

    >>> column_name(Column("moment_0_x_mean", "N m", "moment", "joint", 0, "mean", "x"))
    'mean moment, joint 0, x [N m]'
    """
    if column.statistic == "value":
        words = column.quantity.replace("min_", "smallest ").replace("max_", "largest ")
        words = words.replace("non_uniformity", "non-uniformity U").replace("_", " ")
    else:
        statistic = _REDUCED.get(column.statistic, column.statistic)
        words = f"{statistic} {OUTPUTS[column.quantity].label}"
    words += f", {column.per} {column.item}"
    words += f", {column.component}" if column.component else ""
    return words + _bracketed(as_shown(np.empty(0), column.unit)[1])


def _bracketed(unit: str) -> str:
    return f" [{unit}]" if unit else ""
