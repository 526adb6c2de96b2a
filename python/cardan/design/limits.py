"""How unevenly a driveline may run: limits with their sources, and presets for machines."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from types import MappingProxyType
from typing import TypeAlias

from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.reference.approximations import (
    INERTIA_LIMIT,
    INERTIA_MAXIMUM,
    TORSIONAL_LIMIT,
    TORSIONAL_MAXIMUM,
)

Bound: TypeAlias = float | Sequence[float]
"""A limit, or a limit and a maximum."""


@dataclass(frozen=True)
class Limit:
    """What a figure should not exceed, and what it must not.

    Attributes:
        limit: up to here the figure is within.
        maximum: up to here it is tolerable, above it is beyond; the limit itself where the source
            knows nothing between.
        source: where both come from.
    """

    limit: float
    maximum: float
    source: str

    @classmethod
    def given(cls, bound: Bound, source: str) -> Limit:
        """Return a limit given as a number, or as limit and maximum."""
        values = [float(x) for x in (bound if isinstance(bound, Sequence) else (bound,))]
        return cls(values[0], values[-1], source)


FIGURES: Mapping[str, float] = MappingProxyType(
    {
        "equivalent_bend_deg": 90.0,
        "bend_difference_deg": 90.0,
        "torsional_excitation_rad_s2": math.inf,
        "inertia_excitation_rad_s2": math.inf,
    }
)
"""The figures that limits are given for, with their units, and what all limits must be below."""

OWN = "own figure"

CATALOGUE = Limit(3.0, 3.0, "driveshaft catalogues, section 6.4; Elbe, calculation data, section 3")
"""The default limit of the equivalent bend."""

_US_MAKERS = "practice of driveshaft makers in the United States, no publication known"

_PARKER = (
    "Parker/Chelsea, bulletin HY25-1890-M1/US, page 5, and Spicer's angles over the speed; for the "
    f"maximum {_US_MAKERS}"
)

_DANA_AXLES = (
    "Dana, Spicer Drive Axles Application Guidelines AXAG-0200 (2009), pages 16, 19 and 44; for "
    f"the maximum {_US_MAKERS}"
)
_DANA_SHAFTS = (
    "Dana, Cardan Shafts for Industrial Applications, pages 38 and 39; above the limit at low "
    "speed only"
)

_TRUCK = {
    "torsional_excitation_rad_s2": Limit(TORSIONAL_LIMIT, TORSIONAL_MAXIMUM, _DANA_AXLES),
    "inertia_excitation_rad_s2": Limit(INERTIA_LIMIT, INERTIA_MAXIMUM, _PARKER),
}
_INDUSTRIAL = {"bend_difference_deg": Limit(1.5, 5.0, _DANA_SHAFTS)}

PRESETS: Mapping[str, Mapping[str, Limit]] = MappingProxyType(
    {"truck": MappingProxyType(_TRUCK), "industrial": MappingProxyType(_INDUSTRIAL)}
)
"""Limits beyond the catalogue's, by kind of machine; only those for which a source is known."""

MAX_EQUIVALENT_BEND = math.radians(CATALOGUE.limit)
"""Largest equivalent bend that the catalogues permit (003, section 6.4), in rad."""


@dataclass(frozen=True, init=False)
class Limits:
    """What a check compares a driveline with.

    Without arguments it is the limit of the catalogues alone: an equivalent bend of 3°. A preset
    adds the limits of a kind of machine, and a figure of your own replaces the one of the preset.
    Each is a number, or a limit and a maximum: up to the limit a driveline is *within*, up to the
    maximum *tolerable*, above it *beyond*.

    Attributes:
        preset: name of the preset, if any.
        figures: limits by figure.

    >>> from cardan import Limits
    >>> Limits("truck", torsional_excitation_rad_s2=(400, 600)).figures["equivalent_bend_deg"].limit
    3.0
    """

    preset: str | None
    figures: Mapping[str, Limit]

    def __init__(
        self,
        preset: str | None = None,
        *,
        equivalent_bend_deg: Bound | None = None,
        bend_difference_deg: Bound | None = None,
        torsional_excitation_rad_s2: Bound | None = None,
        inertia_excitation_rad_s2: Bound | None = None,
        source: str = OWN,
    ) -> None:
        """Make limits of a preset and figures of your own.

        Args:
            preset: ``"truck"`` or ``"industrial"``.
            equivalent_bend_deg: bend of the joint that moves the last shaft as the driveline does.
            bend_difference_deg: difference of the bends of a driveline of two joints.
            torsional_excitation_rad_s2: largest acceleration of the last shaft.
            inertia_excitation_rad_s2: second-order amplitude of the accelerations of all shafts
                between two joints, driving and coasting.
            source: where your own figures come from.

        Raises:
            TypeError: a limit that is not a number.
            ValueError: an unknown preset, a limit that is not positive, a maximum below its limit.
        """
        if preset is not None and preset not in PRESETS:
            raise ArgumentValueError("preset", unknown_preset(preset))
        own = {
            "equivalent_bend_deg": equivalent_bend_deg,
            "bend_difference_deg": bend_difference_deg,
            "torsional_excitation_rad_s2": torsional_excitation_rad_s2,
            "inertia_excitation_rad_s2": inertia_excitation_rad_s2,
        }
        figures = {"equivalent_bend_deg": CATALOGUE, **PRESETS.get(preset or "", {})}
        figures |= {
            key: _own(key, given, source) for key, given in own.items() if given is not None
        }
        object.__setattr__(self, "preset", preset)
        object.__setattr__(self, "figures", figures)


def unknown_preset(name: object) -> str:
    """Return what is wrong with a preset that does not exist, and what to do."""
    return (
        f"is {name!r}; limits with a known source exist for {' and '.join(map(repr, PRESETS))}; "
        f"for other machines give your own figures: {', '.join(FIGURES)}"
    )


def limits_of(limits: str | Limits | None) -> Limits:
    """Return limits given as such, by the name of a preset, or not at all."""
    if limits is None or isinstance(limits, str):
        if limits is not None and limits not in PRESETS:
            raise ArgumentValueError("limits", unknown_preset(limits))
        return _of_preset(limits)
    if not isinstance(limits, Limits):
        problem = f"is a {type(limits).__name__}; it must be a cardan.Limits or its preset"
        raise ArgumentTypeError("limits", problem)
    return limits


_of_preset = functools.cache(Limits)


def _own(key: str, given: Bound, source: str) -> Limit:
    pair = tuple(given) if isinstance(given, Sequence) and not isinstance(given, str) else (given,)
    if not all(isinstance(value, Real) and not isinstance(value, bool) for value in pair):
        raise ArgumentTypeError(key, f"is {given!r}; it must be a number or [limit, maximum]")
    values = [float(value) for value in pair]
    rising = len(values) in (1, 2) and values[0] <= values[-1]
    if not (rising and values[0] > 0.0 and values[-1] < FIGURES[key]):
        below = f" below {FIGURES[key]:g}" if math.isfinite(FIGURES[key]) else ""
        rule = f"it must be a positive number{below} or a limit and a maximum not below it"
        raise ArgumentValueError(key, f"is {given!r}; {rule}")
    return Limit.given(given, source)
