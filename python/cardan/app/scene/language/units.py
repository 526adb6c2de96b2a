"""Units: of the keys of a scene, by their endings, and of the columns that are written."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from cardan.arrays import FloatArray

RPM = math.tau / 60.0
"""One revolution per minute in rad/s."""

LengthUnit = Literal["mm", "m"]
"""Unit in which a scene gives points or lengths."""


class Unit(NamedTuple):
    """A unit as labels show it and as sentences name it."""

    symbol: str
    name: str


ENDINGS: Mapping[str, Unit] = MappingProxyType(
    {
        "deg": Unit("deg", "degrees"),
        "rad": Unit("rad", "radians"),
        "m": Unit("m", "metres"),
        "mm": Unit("mm", "millimetres"),
        "s": Unit("s", "seconds"),
        "rpm": Unit("rpm", "revolutions per minute"),
        "rad_s": Unit("rad/s", "rad/s"),
        "rad_s2": Unit("rad/s²", "rad/s²"),
        "Nm": Unit("N m", "N m"),
        "kgm2": Unit("kg m²", "kg m²"),
        "Nm_per_rad": Unit("N m/rad", "N m/rad"),
        "Nms_per_rad": Unit("N m s/rad", "N m s/rad"),
        "N": Unit("N", "newtons"),
        "MPa": Unit("MPa", "megapascals"),
        "um_per_MPa": Unit("µm/MPa", "micrometres per megapascal"),
    }
)
"""The units of a scene's keys, by what stands behind the last underscore of the quantity."""

# What people write in place of a unit of the format.
_OTHER_ENDINGS = (
    *("degree", "degrees", "radian", "radians", "mrad", "gon", "turns"),
    *("cm", "metre", "metres", "meters", "in", "inch", "inches", "ft"),
    *("ms", "us", "min", "h", "second", "seconds"),
    *("rps", "hz", "1_min", "1_s", "deg_s", "deg_s2", "rpm_s", "m_s2"),
    *("kn", "pa", "kpa", "gpa", "bar", "n_mm2", "psi", "um_per_n_mm2", "mm_per_mpa"),
    *("knm", "nmm", "n_m", "lbft", "lbf_ft", "gm2", "kg_m2", "kgmm2", "kgcm2"),
)


def split(key: str) -> tuple[str, str]:
    """Return the quantity of a scene's key and the ending of its unit, "" where it has none.

    >>> split("acceleration_rad_s2")
    ('acceleration', 'rad_s2')
    """
    return _split(key, ENDINGS)


def _split(key: str, endings: Iterable[str]) -> tuple[str, str]:
    for ending in sorted(endings, key=len, reverse=True):
        if key.lower().endswith(f"_{ending.lower()}"):
            return key[: -len(ending) - 1], ending
    return key, ""


def units_of(key: str, known: Iterable[str]) -> str:
    """Say which known keys hold the quantity of a key in their own units; "" if there is none.

    >>> units_of("bends_rad", ["bends_deg", "phases_deg"])
    'the name includes the unit: bends_deg holds degrees'
    """
    quantity, _ = _split(key, (*ENDINGS, *_OTHER_ENDINGS))
    endings = {name: split(name)[1] for name in known if name != quantity}
    held = ", ".join(
        f"{name} holds {ENDINGS[ending].name}"
        for name, ending in endings.items()
        if ending and split(name)[0] == quantity
    )
    return f"the name includes the unit: {held}" if held else ""


def ending_of(symbol: str) -> str:
    """Return what follows a name to say its unit: ``_rad_s2`` of ``rad/s²``; "" for a ratio."""
    found = (f"_{ending}" for ending, unit in ENDINGS.items() if unit.symbol == symbol)
    return next(found) if symbol else ""


def in_degrees(values: FloatArray, unit: str) -> tuple[FloatArray, str]:
    """Return values in an SI unit with angles in degrees, and the unit to print, "" for a ratio."""
    if unit == "rad":
        return np.degrees(values), "deg"
    return values, "" if unit == "1" else unit


def converted(values: FloatArray, unit: str, radians: bool) -> tuple[str, FloatArray]:
    """Return the ending of a column's name and its values, angles in the unit asked for."""
    if unit == "rad" and not radians:
        return "_deg", np.degrees(values)
    return "" if unit == "1" else f"_{unit.replace(' ', '')}", values
