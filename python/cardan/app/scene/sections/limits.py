"""The sections [limits] and [steering]: what a check compares with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cardan.app.scene.language import errors, rules
from cardan.app.scene.language.rules import POSITIVE, START, Number
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.sections.bearing import BEARING, STIFFNESS
from cardan.arrays.errors import ArgumentValueError
from cardan.design.limits import OWN, PRESETS, Limit, Limits, unknown_preset
from cardan.design.quantities import MOTION_QUANTITIES, modulus_of_bend


@dataclass(frozen=True)
class LimitRule(rules.OneOrEach):
    """A limit, or a list of a limit and a maximum that is not below it.

    A schema cannot compare the two; only the reader does.
    """

    name = "limit"

    def read(self, where: errors.Location, value: object) -> float | list[float]:
        found: float | list[float] = super().read(where, value)
        if isinstance(found, list) and found[0] > found[1]:
            raise rules.refused(where, value, "have a maximum that is not below the limit")
        return found


def _limit(number: rules.Number) -> LimitRule:
    return LimitRule(rules.ListOf(number, "two numbers, limit and maximum", count=2))


_BEND_LIMIT, _LIMIT = _limit(rules.ACUTE), _limit(rules.POSITIVE)

OF_PARTS: Mapping[str, Key] = {
    "bearing_force_N": Key(_LIMIT, "largest force of a bearing over the turn"),
    "bearing_displacement_mm": Key(
        _LIMIT, "largest displacement of a shaft in an elastic bearing over the turn"
    ),
    "joint_force_N": Key(_LIMIT, "largest force of a joint over the turn"),
    "lash_deg": Key(_BEND_LIMIT, "angle by which the last shaft is loose while the drive is held"),
}
"""The keys of [limits] on figures that a check of the motion does not have."""


@dataclass(frozen=True, eq=False)
class GivenLimits:
    """Limits of a check: of the motion, and of other figures by key and in its unit."""

    motion: Limits
    parts: Mapping[str, Limit]


def _limits(values: Mapping[str, Any], scene: Reading) -> GivenLimits:
    for key in ("bearing_force_N", "bearing_displacement_mm"):
        if key in values and not scene.line.n_bearings:
            raise ArgumentValueError(key, "needs a section [[bearing]]")
    bearings = scene[BEARING].mounting.bearings
    if "bearing_displacement_mm" in values and not any(each.support for each in bearings):
        raise ArgumentValueError("bearing_displacement_mm", f"needs {STIFFNESS} in [[bearing]]")
    source = values.get("source", OWN)
    return GivenLimits(
        Limits(**{key: value for key, value in values.items() if key not in OF_PARTS}),
        {key: Limit.given(values[key], source) for key in values if key in OF_PARTS},
    )


def _meant(key: str, value: Any) -> str:  # noqa: ANN401 - whatever the file has
    """Say how to limit a quantity that follows from the equivalent bend."""
    name = key.removesuffix("_deg")
    quantity = MOTION_QUANTITIES.get(name)
    if name == "equivalent_bend" or quantity is None or quantity.limit != "equivalent_bend_deg":
        return ""
    other = f'[tolerances] of = "{name}" and limit'
    factor = math.pi / 180.0 if quantity.unit == "rad" else 1.0
    limit = factor * value if isinstance(value, (int, float)) else math.nan
    if not 0.0 < limit < quantity.largest:
        return f"give equivalent_bend_deg, from which it follows, or {other}"
    low, high = 0.0, 0.5 * math.pi
    for _ in range(50):
        middle = 0.5 * (low + high)
        is_less = quantity.ratio(modulus_of_bend(middle)) < limit
        low, high = (middle, high) if is_less else (low, middle)
    return f"give equivalent_bend_deg = {math.degrees(low):.4g}, which is the same, or {other}"


_JUDGED_BY_PRESETS = {
    "torsional_excitation_rad_s2": "excitations",
    "inertia_excitation_rad_s2": "excitations",
    "bend_difference_deg": "difference of bends",
    "difference_deg": "difference of bends",
    "bend_deg": "bends",
    "least_bend_deg": "bends",
    "two_piece_deg": "two-piece shaft",
    "bend_by_length_deg": "bends by length",
}


def _presets() -> str:
    """The names of the presets by what they limit."""
    names: dict[str, list[str]] = {}
    for name, preset in PRESETS.items():
        figures = dict.fromkeys(_JUDGED_BY_PRESETS[rule.figure] for rule in preset.rules)
        names.setdefault(" and ".join(figures), []).append(name)
    return "; ".join(f"{', '.join(each)} ({figures})" for figures, each in names.items())


LIMITS: Section[GivenLimits] = Section(
    "limits",
    "limits of check; a figure is a number or [limit, maximum]: within up to the limit, "
    "tolerable up to the maximum, beyond above it",
    {
        "preset": Key(
            rules.OneOrMore(
                rules.ListOf(rules.OneOf(tuple(PRESETS), unknown_preset), "names", distinct=True)
            ),
            f"limits of a kind of machine or of a maker, or of several: {_presets()}; "
            "default: the limit of the catalogues alone, an equivalent bend of 3 deg",
        ),
        "equivalent_bend_deg": Key(
            _BEND_LIMIT, "bend of the joint that moves the last shaft as the driveline does"
        ),
        "bend_difference_deg": Key(
            _BEND_LIMIT, "difference of the bends of a driveline of two joints"
        ),
        "torsional_excitation_rad_s2": Key(_LIMIT, "largest acceleration of the last shaft"),
        "inertia_excitation_rad_s2": Key(
            _LIMIT, "second-order acceleration of all shafts between two joints together"
        ),
        **OF_PARTS,
        "source": Key(rules.Text(printable=True), "where your own figures come from", default=OWN),
    },
    _limits,
    fewest=1,
    always=True,
    meant=_meant,
)


@dataclass(frozen=True)
class SteeringColumn:
    """Drive angle straight ahead, and what is permitted: distance from symmetry, left to right."""

    centre_deg: float = 0.0
    offset_deg: float | None = None
    ratio_percent: float | None = None


STEERING: Section[SteeringColumn | None] = Section(
    "steering",
    "the driveline is a steering column: ratio straight ahead, its slope, symmetry left to right",
    {
        "centre_deg": Key(
            START,
            "drive angle of shaft 0 straight ahead, with the points of [driveline]; "
            "in other states the yoke is carried along as the column tilts",
            default=0,
        ),
        "offset_deg": Key(
            Number(0, 45, above=True, unit="deg"),
            "how far straight ahead may be from the nearest angle at which left and right are "
            "symmetric; default: not judged",
        ),
        "ratio_percent": Key(
            POSITIVE,
            "largest difference of the ratio between equal angles to the left and to the right, in "
            "percent; default: not judged",
        ),
    },
    lambda values, _: SteeringColumn(**values),
    recorded_bends=False,
)
