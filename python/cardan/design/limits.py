"""How unevenly a driveline may run: limits with their sources, and presets for machines."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from types import MappingProxyType
from typing import TypeAlias

from cardan.arrays import keep
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
    """Limit that a figure should not exceed, and maximum that it must not.

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

UNKNOWN = "unknown"


@dataclass(frozen=True)
class Publication:
    """Publication of a limit; whatever is not noted about it is ``"unknown"``."""

    title: str
    pages: str = UNKNOWN
    year: str = UNKNOWN
    edition: str = UNKNOWN

    def __str__(self) -> str:
        """Return title, year, edition and pages, as far as they are known."""
        year = "" if self.year == UNKNOWN else f" ({self.year})"
        edition = "" if self.edition == UNKNOWN else f", {self.edition}"
        several = "s" if not self.pages.isdigit() else ""
        pages = "" if self.pages == UNKNOWN else f", page{several} {self.pages}"
        return f"{self.title}{year}{edition}{pages}"


@dataclass(frozen=True)
class Rule:
    """One limit as a source has it.

    Attributes:
        figure: what it limits: a key of ``FIGURES`` for a figure of the motion; ``"bend_deg"`` for
            the most that each joint may be bent and ``"least_bend_deg"`` for the least;
            ``"difference_deg"`` for the bends of two joints; ``"two_piece_deg"`` for the odd one of
            three joints, of which the two others are equal; ``"bend_by_length_deg"`` for both
            joints of a shaft.
        limit: in the unit of the figure; of ``"bend_by_length_deg"`` the inches per degree with
            parallel axes.
        source: where it is published.
        own: the rule in the words of the source, or what is known of them.
        exact: how it differs from what is exact.
        maximum: what must be kept, if not the limit; of ``"bend_by_length_deg"`` the inches per
            degree with intersecting axes.
        more: what else there is to say of its source.
        over_speed: the most that a joint may be bent, in degrees, by the speed in rpm, rising; the
            limit is then kept up to it.
        is_exact: whether the source says "equal" and no tolerance.
    """

    figure: str
    limit: float
    source: Publication
    own: str
    exact: str
    maximum: float | None = None
    more: str = ""
    over_speed: tuple[tuple[float, float], ...] = ()
    is_exact: bool = False

    @property
    def holds_always(self) -> bool:
        """Whether it is one number for each joint, or for two, which no speed or length changes."""
        plain = self.figure in ("bend_deg", "difference_deg")
        return plain and not self.over_speed and not self.is_exact

    @property
    def cited(self) -> str:
        """The source as it is printed beside a figure."""
        return f"{self.source}{self.more}"


@dataclass(frozen=True)
class Preset:
    """The limits of a kind of machine, or of a maker.

    Attributes:
        title: what to call it in words.
        rules: each of them.
    """

    title: str
    rules: tuple[Rule, ...]

    @property
    def figures(self) -> Mapping[str, Limit]:
        """The limits of the motion by figure."""
        return {
            rule.figure: Limit(rule.limit, rule.maximum or rule.limit, rule.cited)
            for rule in self.rules
            if rule.figure in FIGURES
        }

    @property
    def on_bends(self) -> tuple[Rule, ...]:
        """The limits of bends, which are judged joint by joint."""
        return tuple(rule for rule in self.rules if rule.figure not in FIGURES)


_US_MAKERS = (
    "; for the maximum practice of driveshaft makers in the United States, no publication known"
)
_DANA_AXLES = Publication(
    "Dana, Spicer Drive Axles Application Guidelines AXAG-0200", "16, 19 and 44", "2009"
)
_DANA_SHAFTS = Publication("Dana, Cardan Shafts for Industrial Applications", "38 and 39")
_PARKER = Publication("Parker/Chelsea, bulletin HY25-1890-M1/US", "5")
_SPICER = Publication("Spicer, driveline operating angle calculator, spicerparts.com")
_TREMEC = Publication("TREMEC, instructions for the angles of a driveline")
_GM = Publication(
    'General Motors, "Driveline Working Angles Measurement" in the service manual of the Hummer H3',
    year="2006",
)
_MERITOR = Publication("Meritor, maintenance manual MM-96147", "87", edition="revised 03-21")
_DEERE = Publication("John Deere, equal angle hitch")
_CAMARO = Publication("Chevrolet Camaro of 2000, two-piece shaft; publication unknown")
_HOMBRE = Publication("Isuzu Hombre, two-piece shaft; publication unknown")
_DRIVETRAIN = Publication("drivetrain.com")

_ANY_SPEED = "at every speed the same, while the exact excitation grows with (bend times speed)²"
_NEEDLES = "needles that never roll wear; the motion has no such limit"
_NEVER = Rule(
    "least_bend_deg",
    0.005,
    _GM,
    "never 0; judged as at least 0.005°, because less reads as 0.00°",
    _NEEDLES,
)


def _difference(limit: float, source: Publication, *, left: str) -> Rule:
    return Rule(
        "difference_deg",
        limit,
        source,
        f"bends at both ends of a shaft equal within {limit:g}°",
        f"yokes and bend planes do not count; {left}",
    )


def _two_piece(source: Publication) -> tuple[Rule, ...]:
    return (
        Rule(
            "two_piece_deg",
            0.5,
            source,
            "the odd joint of a two-piece shaft at most 0.5°, the bends of the other two equal, "
            "with an unknown tolerance",
            "0.5° alone leave an equivalent bend of 0.5°, and equal bends cancel each other only "
            "with the yokes set for it",
            is_exact=True,
        ),
    )


PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        "truck": Preset(
            "truck",
            (
                Rule(
                    "torsional_excitation_rad_s2",
                    TORSIONAL_LIMIT,
                    _DANA_AXLES,
                    "ω² |Σ ± bend²|",
                    "judged is the exact peak, which is 0.1 % more at an equivalent bend of 6°",
                    TORSIONAL_MAXIMUM,
                    _US_MAKERS,
                ),
                Rule(
                    "inertia_excitation_rad_s2",
                    INERTIA_LIMIT,
                    _PARKER,
                    "largest bend over the speed, which has this basis",
                    "judged is the exact second-order amplitude of all shafts between two joints",
                    INERTIA_MAXIMUM,
                    f", and Spicer's angles over the speed{_US_MAKERS}",
                ),
            ),
        ),
        "industrial": Preset(
            "industrial",
            (
                Rule(
                    "bend_difference_deg",
                    1.5,
                    _DANA_SHAFTS,
                    "equal bends at high torque and high speed, else a difference of 1° to 1.5°; "
                    "3° to 5° at low speed",
                    "yokes and bend planes do not count; 10° and 8.5° leave an equivalent bend of "
                    "5.29°",
                    5.0,
                    "; above the limit at low speed only",
                ),
            ),
        ),
        "spicer": Preset(
            "Spicer",
            (
                Rule(
                    "bend_deg",
                    3.0,
                    _SPICER,
                    "at most 3° for vibration-free performance, above that the angles over the "
                    "speed, from 11.5° at 1500 rpm to 3.2° at 5000 rpm",
                    "one joint reaches 1000 rad/s² at 0.09° less than the table (2500 rpm) to "
                    "0.26° more (5000 rpm)",
                    over_speed=(
                        *((1500, 11.5), (2000, 8.7), (2500, 7.0), (3000, 5.8)),
                        *((3500, 5.0), (4000, 4.2), (4500, 3.7), (5000, 3.2)),
                    ),
                ),
                Rule("least_bend_deg", 0.5, _SPICER, "each joint at least 0.5°", _NEEDLES),
                _difference(1.0, _SPICER, left="3° and 2° leave an equivalent bend of 2.24°"),
            ),
        ),
        "tremec": Preset(
            "TREMEC",
            (
                Rule("bend_deg", 3.0, _TREMEC, "each joint at most 3°", _ANY_SPEED),
                replace(_NEVER, source=_TREMEC),
                _difference(2.0, _TREMEC, left="3° and 1° leave an equivalent bend of 2.83°"),
            ),
        ),
        "gm": Preset(
            "General Motors",
            (
                Rule("bend_deg", 4.0, _GM, "each joint at most 4°", _ANY_SPEED),
                _NEVER,
                _difference(0.5, _GM, left="4° and 3.5° leave an equivalent bend of 1.94°"),
            ),
        ),
        "meritor": Preset(
            "Meritor",
            (
                Rule(
                    "bend_deg",
                    5.0,
                    _MERITOR,
                    "compound angle √(side² + plan²) at most 5°",
                    "judged is the exact bend: 4° and 3° give 4.994°, 15° and 10° give 17.78° "
                    "where the rule has 18.03°",
                ),
                _difference(1.5, _MERITOR, left="5° and 3.5° leave an equivalent bend of 3.57°"),
            ),
        ),
        "parker": Preset(
            "Parker/Chelsea",
            (
                Rule(
                    "bend_deg",
                    math.inf,
                    _PARKER,
                    "largest angle over the speed, from 11.5° at 1500 rpm to 5° 50' at "
                    "3000 rpm, based on 1000 rad/s² (printed as 100)",
                    "one joint reaches 1000 rad/s² at 0.01° (1500 rpm) to 0.09° (2500 rpm) less",
                    over_speed=(
                        *((1500, 11.5), (2000, 8.0 + 40.0 / 60.0)),
                        *((2500, 7.0), (3000, 5.0 + 50.0 / 60.0)),
                    ),
                ),
            ),
        ),
        "john_deere": Preset(
            "John Deere",
            (
                Rule(
                    "difference_deg",
                    0.0,
                    _DEERE,
                    "as far from shaft end to hitch pin as from there to the implement, so that "
                    "the bends are equal, with an unknown tolerance",
                    "exact: the equivalent bend is 0 in every turn; with 14 and 24 in a turn of "
                    "15° leaves 7.73°",
                    is_exact=True,
                ),
            ),
        ),
        "camaro": Preset("Camaro of 2000", _two_piece(_CAMARO)),
        "hombre": Preset("Isuzu Hombre", _two_piece(_HOMBRE)),
        "drivetrain": Preset(
            "drivetrain.com",
            (
                Rule(
                    "bend_by_length_deg",
                    5.0,
                    _DRIVETRAIN,
                    "angle at most length/5 with parallel axes, length/10 with intersecting ones; "
                    "units unknown, read as degrees for inches between the joints",
                    f"the motion does not depend on the length; {_ANY_SPEED}",
                    10.0,
                ),
            ),
        ),
    }
)
"""Limits beyond the catalogue's, by kind of machine or maker; only those whose source is known."""

MAX_EQUIVALENT_BEND = math.radians(CATALOGUE.limit)
"""Largest equivalent bend that the catalogues permit (003, section 6.4), in rad."""


@dataclass(frozen=True, init=False)
class Limits:
    """Limits that a check compares a driveline with.

    Without arguments it is the limit of the catalogues alone: an equivalent bend of 3°. A preset
    adds the limits of a kind of machine, and a figure of your own replaces the one of the preset.
    Each is a number, or a limit and a maximum: up to the limit a driveline is *within*, up to the
    maximum *tolerable*, above it *beyond*.

    Attributes:
        presets: names of the presets; a check judges by each of them.
        figures: limits of the motion by figure; where presets share one, that of the last.

    >>> from cardan import Limits
    >>> Limits("truck", torsional_excitation_rad_s2=(400, 600)).figures["equivalent_bend_deg"].limit
    3.0
    >>> Limits(["spicer", "gm"]).presets
    ('spicer', 'gm')
    """

    presets: tuple[str, ...]
    figures: Mapping[str, Limit]

    def __init__(
        self,
        preset: str | Sequence[str] | None = None,
        *,
        equivalent_bend_deg: Bound | None = None,
        bend_difference_deg: Bound | None = None,
        torsional_excitation_rad_s2: Bound | None = None,
        inertia_excitation_rad_s2: Bound | None = None,
        source: str = OWN,
    ) -> None:
        """Make limits of a preset and figures of your own.

        Args:
            preset: a name of ``PRESETS``, such as ``"truck"`` or ``"spicer"``, or several.
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
        presets = _names("preset", preset)
        own = {
            "equivalent_bend_deg": equivalent_bend_deg,
            "bend_difference_deg": bend_difference_deg,
            "torsional_excitation_rad_s2": torsional_excitation_rad_s2,
            "inertia_excitation_rad_s2": inertia_excitation_rad_s2,
        }
        figures = {"equivalent_bend_deg": CATALOGUE}
        for name in presets:
            figures |= PRESETS[name].figures
        figures |= {
            key: _own(key, given, source) for key, given in own.items() if given is not None
        }
        keep(self, presets=presets, figures=figures)


def unknown_preset(name: object) -> str:
    """Return what is wrong with a preset that does not exist, and what to do."""
    *others, last = map(repr, PRESETS)
    return (
        f"is {name!r}; limits with a known source exist for {', '.join(others)} and {last}; "
        f"for other machines give your own figures: {', '.join(FIGURES)}"
    )


Limiting: TypeAlias = "str | Sequence[str] | Limits"
"""Limits, the name of a preset, or the names of several."""


def limits_of(limits: Limiting | None) -> Limits:
    """Return limits given as such, by the names of presets, or not at all."""
    if isinstance(limits, Limits):
        return limits
    return _of_presets(_names("limits", limits))


_of_presets = functools.cache(Limits)


def _names(argument: str, given: object) -> tuple[str, ...]:
    """The names of presets, each once."""
    names = () if given is None else (given,) if isinstance(given, str) else given
    if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        problem = f"is a {type(given).__name__}; it must be a cardan.Limits or its presets"
        raise ArgumentTypeError(argument, problem)
    for name in names:
        if name not in PRESETS:
            raise ArgumentValueError(argument, unknown_preset(name))
    return tuple(dict.fromkeys(names))


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
