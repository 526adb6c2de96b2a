"""Units: of the keys of a scene, by their endings, and of the columns that are written."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from cardan.arrays import FloatArray

RPM = math.tau / 60.0
"""One revolution per minute in rad/s."""

LengthUnit = Literal["mm", "m"]
"""Unit in which a scene gives points or lengths."""


System = Literal["si", "us"]
"""Units in which an answer is printed, drawn and written; angles and times are the same in both."""

_POUND = 0.45359237  # kg
_INCH = 25.4  # mm
_FOOT = 12e-3 * _INCH  # m
_FORCE = _POUND * 9.80665  # N
_PSI = _FORCE / _INCH**2  # MPa


class Unit(NamedTuple):
    """A unit as labels show it and as sentences name it.

    A US unit stands for one of the SI, by its ending, and is so many of it.
    """

    symbol: str
    name: str
    si: str = ""
    size: float = 1.0


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
        "GPa": Unit("GPa", "gigapascals"),
        "um_per_MPa": Unit("µm/MPa", "micrometres per megapascal"),
        "deg_per_kNm": Unit("°/kN m", "degrees per kN m"),
        "mm_per_kNm": Unit("mm/kN m", "millimetres per kN m"),
        "N_per_mm": Unit("N/mm", "newtons per millimetre"),
        "Ns_per_m": Unit("N s/m", "N s/m"),
        "gmm": Unit("g mm", "gram-millimetres"),
        "kg": Unit("kg", "kilograms"),
        "kg_m3": Unit("kg/m³", "kilograms per cubic metre"),
        "in": Unit("in", "inches", "mm", _INCH),
        "ft": Unit("ft", "feet", "m", _FOOT),
        "lbf": Unit("lbf", "pounds of force", "N", _FORCE),
        "lbft": Unit("lb·ft", "lb·ft", "Nm", _FOOT * _FORCE),
        "lbin": Unit("lb·in", "lb·in", "Nm", _FOOT * _FORCE / 12.0),
        "lbin2": Unit("lb·in²", "lb·in²", "kgm2", 1e-6 * _POUND * _INCH**2),
        "lbft_per_rad": Unit("lb·ft/rad", "lb·ft/rad", "Nm_per_rad", _FOOT * _FORCE),
        "lbfts_per_rad": Unit("lb·ft·s/rad", "lb·ft·s/rad", "Nms_per_rad", _FOOT * _FORCE),
        "psi": Unit("psi", "pounds per square inch", "MPa", _PSI),
        "Mpsi": Unit("Mpsi", "million pounds per square inch", "GPa", 1e3 * _PSI),
        "uin_per_psi": Unit("µin/psi", "microinches per psi", "um_per_MPa", 1e-3 * _INCH / _PSI),
        "deg_per_klbft": Unit(
            "°/1000 lb·ft", "degrees per 1000 lb·ft", "deg_per_kNm", 1.0 / (_FOOT * _FORCE)
        ),
        "in_per_klbft": Unit(
            "in/1000 lb·ft", "inches per 1000 lb·ft", "mm_per_kNm", _INCH / (_FOOT * _FORCE)
        ),
        "lbf_per_in": Unit("lbf/in", "pounds per inch", "N_per_mm", _FORCE / _INCH),
        "lbfs_per_in": Unit("lbf·s/in", "lbf·s/in", "Ns_per_m", 1e3 * _FORCE / _INCH),
        "ozin": Unit("oz·in", "ounce-inches", "gmm", 1e3 * _POUND / 16.0 * _INCH),
        "lb": Unit("lb", "pounds", "kg", _POUND),
        "lb_in3": Unit("lb/in³", "pounds per cubic inch", "kg_m3", 1e9 * _POUND / _INCH**3),
    }
)
"""The units of a scene's keys, by what stands behind the last underscore of the quantity.

The US units follow those of the SI; of several for the same one the first is printed.
"""

US: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        unit.si: tuple(us for us, other in ENDINGS.items() if other.si == unit.si)
        for unit in ENDINGS.values()
        if unit.si
    }
)
"""The endings of US units by that of the SI unit that they stand for."""

# What people write in place of a unit of the format.
_OTHER_ENDINGS = (
    *("degree", "degrees", "radian", "radians", "mrad", "gon", "turns"),
    *("cm", "metre", "metres", "meters", "inch", "inches", "feet"),
    *("ms", "us", "min", "h", "second", "seconds"),
    *("rps", "hz", "1_min", "1_s", "deg_s", "deg_s2", "rpm_s", "m_s2"),
    *("kn", "pa", "kpa", "bar", "n_mm2", "ksi", "um_per_n_mm2", "mm_per_mpa", "klbf"),
    *("knm", "nmm", "n_m", "lbf_ft", "lb_ft", "ftlb", "lb_in", "gm2", "kg_m2", "kgmm2", "kgcm2"),
)


def split(key: str) -> tuple[str, str]:
    """Return the quantity of a scene's key and the ending of its unit, "" where it has none.

    >>> split("acceleration_rad_s2")
    ('acceleration', 'rad_s2')
    """
    return _split(key, ENDINGS)


def _split(key: str, endings: Iterable[str]) -> tuple[str, str]:
    for ending in sorted(endings, key=len, reverse=True):
        if f"_{key}".lower().endswith(f"_{ending.lower()}"):
            return key[: -len(ending) - 1], ending
    return key, ""


def us_keys(key: str) -> list[str]:
    """Return the keys that hold the same in US units, none for an angle or a ratio.

    >>> us_keys("drive_torque_Nm")
    ['drive_torque_lbft', 'drive_torque_lbin']
    """
    quantity, ending = split(key)
    return [f"{quantity}_{us}".lstrip("_") for us in US.get(ending, ())]


def si_key(key: str) -> str:
    """Return the key that holds the same in an SI unit: the key itself if it does.

    >>> si_key("points_in"), si_key("points_mm")
    ('points_mm', 'points_mm')
    """
    quantity, ending = split(key)
    si = ENDINGS[ending].si if ending else ""
    return f"{quantity}_{si}".lstrip("_") if si else key


def alike(key: str, known: Iterable[str]) -> list[str]:
    """Return the known keys in the units of a key, US or SI, and those that are in both.

    >>> alike("point_in", ["points_mm", "points_in", "bends_deg"])
    ['points_in', 'bends_deg']
    """
    is_us = si_key(key) != key
    return [
        name
        for name in known
        if (is_us and not us_keys(name)) or (not is_us and si_key(name) == name)
    ]


def size_of(key: str) -> float:
    """Return the unit of a key in that of ``si_key``."""
    ending = split(key)[1]
    return ENDINGS[ending].size if ending else 1.0


def as_given(text: str, given: Mapping[str, str], about: str) -> str:
    """Return a text about a key and SI units with the keys that were given instead, in their units.

    >>> as_given("is 12.7 mm", {"wall_mm": "wall_in"}, "wall_in")
    'is 0.5 in'
    """
    # What is about a key in SI units stays in them.
    is_converted = si_key(about) != about or not us_keys(about)
    for si, key in given.items():
        text = re.sub(rf"\b{si}\b", key, text)
        if is_converted:
            symbol, unit = ENDINGS[split(si)[1]].symbol, ENDINGS[split(key)[1]]
            number = rf"(-?\d[\d.]*(?:e[-+]\d+)?) {re.escape(symbol)}(?![\w/²])"
            text = re.sub(number, functools.partial(_in_unit, unit), text)
    return text


def _in_unit(unit: Unit, found: re.Match[str]) -> str:
    return f"{float(found[1]) / unit.size:.10g} {unit.symbol}"


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
    return next(found, "") if symbol else ""


_shown: ContextVar[System] = ContextVar("units", default="si")


@contextmanager
def shown_in(units: System) -> Iterator[None]:
    """Let what is printed and drawn meanwhile be in these units."""
    before = _shown.set(units)
    try:
        yield
    finally:
        _shown.reset(before)


def shown_unit(ending: str) -> str:
    """Return the ending of the unit in which something is shown: in US units ``in`` for ``mm``."""
    return US[ending][0] if _shown.get() == "us" and ending in US else ending


def in_degrees(values: FloatArray, unit: str) -> tuple[FloatArray, str]:
    """Return values in an SI unit with angles in degrees, and that unit, "" for a ratio."""
    if unit == "rad":
        return np.degrees(values), "deg"
    return values, "" if unit == "1" else unit


def in_shown(value: float, ending: str) -> float:
    """Return a value in the unit of an ending in that in which it is shown."""
    shown = shown_unit(ending)
    return value if shown == ending else value / ENDINGS[shown].size


def as_shown(values: FloatArray, unit: str) -> tuple[FloatArray, str]:
    """Return values in a unit as labels have it in the unit in which they are shown, and that."""
    values, unit = in_degrees(values, unit)
    shown = ENDINGS.get(shown_unit(ending_of(unit)[1:]))
    return (values / shown.size, shown.symbol) if shown and shown.si else (values, unit)


def converted(
    values: FloatArray, unit: str, radians: bool, units: System = "si"
) -> tuple[str, FloatArray]:
    """Return the ending of a column's name and its values, angles in the unit asked for."""
    if unit == "rad" and not radians:
        return "_deg", np.degrees(values)
    with shown_in(units):
        shown = shown_unit(ending_of("" if unit in ("1", "rad") else unit)[1:])
    if shown and ENDINGS[shown].si:
        return f"_{shown}", values / ENDINGS[shown].size
    return "" if unit == "1" else f"_{unit.replace(' ', '')}", values
