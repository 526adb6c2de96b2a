"""One figure from many samples: reductions over the drive angle and closed forms without any."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.request import Reduction
from cardan.evaluation.sweep import Sweep

REDUCTIONS = ("peak", "min", "max", "mean", "rms")
"""Reductions that ``Driveline.evaluate`` knows; ``peak`` is the largest magnitude."""

CLOSED_FORMS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "equivalent_bend": ("bend", "rad"),
        "angle_offset": ("angle_offset", "rad"),
        "k": ("k", "1"),
        "non_uniformity": ("non_uniformity", "1"),
        "max_angle_error": ("max_angle_error", "rad"),
        "min_speed_ratio": ("min_speed_ratio", "1"),
        "max_speed_ratio": ("max_speed_ratio", "1"),
        "max_acceleration_ratio": ("max_acceleration_ratio", "1"),
        "length": ("", "m"),
    }
)
"""Figures of a shaft that need no samples: field of ``EquivalentJoint`` and SI unit.

The length is none of its motion; it has the unit of the points.
"""

LENGTH = "length"


def reduced(
    line: Driveline,
    angle: FloatArray | Sweep,
    names: tuple[str, ...],
    reductions: tuple[Reduction, ...],
    *,
    load: Load | None,
    shafts: list[int],
    joints: list[int],
    options: Mapping[str, Any],
) -> dict[tuple[str, str], FloatArray]:
    """Return every reduction of every output over the last axis of the samples.

    The arrays are ``(items, *batch)``, and ``(items, *batch, 3)`` for a vector by components; the
    ``peak`` of a vector is its largest length and has no components.
    """
    arguments = {"load": load, "shafts": shafts, "joints": joints, **options}
    found = {how: line.evaluate(angle, names, reduce=how, **arguments) for how in reductions}
    return {(name, how): found[how][name] for name in names for how in reductions}
