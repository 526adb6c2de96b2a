"""One figure from many samples: reductions over the drive angle and closed forms without any."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.load import Load
from cardan.outputs import OUTPUTS

REDUCTIONS: Mapping[str, Callable[[FloatArray], Any]] = MappingProxyType(
    {
        "peak": lambda samples: np.max(np.abs(samples), axis=-1),
        "min": lambda samples: np.min(samples, axis=-1),
        "max": lambda samples: np.max(samples, axis=-1),
        "mean": lambda samples: np.mean(samples, axis=-1),
        "rms": lambda samples: np.sqrt(np.mean(np.square(samples), axis=-1)),
    }
)
"""Reductions over the last axis; ``peak`` is the largest magnitude."""

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
    }
)
"""Closed forms of a shaft's motion: field of ``EquivalentJoint`` and SI unit."""


def reduced(
    line: Driveline,
    angle: ArrayLike,
    names: tuple[str, ...],
    reductions: tuple[str, ...],
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
    samples = line.evaluate(angle, names, load=load, shafts=shafts, joints=joints, **options)
    figures = {}
    for name, values in samples.items():
        for reduction in reductions:
            if not OUTPUTS[name].vector:
                figure = REDUCTIONS[reduction](values)
            elif reduction == "peak":
                figure = np.max(np.linalg.norm(values, axis=-1), axis=-1)
            else:
                figure = np.moveaxis(REDUCTIONS[reduction](np.moveaxis(values, -1, 0)), 0, -1)
            figures[name, reduction] = figure
    return figures
