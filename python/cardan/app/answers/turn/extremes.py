"""Largest magnitudes over a turn of the drive, found between samples by the core."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, threads
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output


@dataclass(frozen=True)
class Peak:
    """The largest magnitude of a quantity over a turn.

    Attributes:
        value: the magnitude in SI units; its relative error is that of ``evaluate``, and below
            1e-12 in any case where the drive angle as a double resolves the peak.
        places: drive angles in rad within the period at which it occurs, each again a period
            later; none where it is the same at every angle.
    """

    value: float
    places: tuple[float, ...]


def peak(line: Driveline, name: str, item: int, load: Load | None = None) -> Peak:
    """Find the largest magnitude of an output over a turn; of a vector, the largest length.

    Args:
        line: one driveline.
        name: an output that repeats, which ``angle`` does not.
        item: shaft, joint or bearing.
        load: a constant load, if the output needs one.
    """
    return _peak(line, name, item, load, least=False)


def slowest(line: Driveline, shaft: int) -> Peak:
    """Find the least speed ratio of a shaft over a turn, and where it occurs."""
    return _peak(line, "speed_ratio", shaft, None, least=True)


def _peak(line: Driveline, name: str, item: int, load: Load | None, *, least: bool) -> Peak:
    plan = line.plan(name, **_items(name, item), load=load)
    shape = () if load is None else np.broadcast_shapes(*load.shapes().values())
    found = plan._core.peaks(shape, least, threads.at_most(None))
    # A plan has all bearings.
    value, places = found[item if OUTPUTS[name].per == "bearing" else 0]
    return Peak(value, tuple(places))


def period_of(line: Driveline) -> float:
    """Return the drive angle in rad after which magnitudes repeat."""
    return math.tau if line.has_deviations else math.pi


def values_of(
    line: Driveline, name: str, item: int, angles: ArrayLike, load: Load | None
) -> FloatArray:
    """Return the values of an output of one shaft, joint or bearing."""
    values: FloatArray = line.evaluate(angles, name, load=load, **_items(name, item))[name]
    return values[item] if OUTPUTS[name].per == "bearing" else values


def _items(name: str, item: int) -> dict[str, Any]:
    """The argument that chooses a shaft or a joint; there is none for bearings."""
    per = OUTPUTS[name].per
    return {} if per == "bearing" else {f"{per}s": item}


def magnitudes(output: Output, values: FloatArray) -> FloatArray:
    """Return the magnitudes of an output's values; of vectors, which are rows, the lengths."""
    if not output.vector:
        return np.abs(values)
    x, y, z = np.moveaxis(values, -1, 0)
    # Unlike the root of a sum of squares this is infinite only where the length is.
    with np.errstate(over="ignore"):
        found: FloatArray = np.hypot(np.hypot(x, y), z)
    return found


def shortest_arm(line: Driveline) -> float:
    """Return the shortest distance between two joints, bearings or ends of a shaft, in m."""
    lengths = line.lengths().each
    shortest = float(np.min(lengths))
    for shaft in range(line.n_joints + 1):
        own = [position for number, position in line.bearings if number == shaft]
        marks = [np.zeros(lengths.shape[:-1]), *own, lengths[..., shaft]]
        apart = np.diff(np.sort(np.stack(marks, axis=-1), axis=-1), axis=-1)
        shortest = float(np.min(apart, where=apart > 0.0, initial=shortest))
    return shortest
