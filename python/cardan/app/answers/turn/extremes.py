"""Largest magnitudes over a turn of the drive, found between samples by the core."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.answers.rounding import is_cancelled
from cardan.arrays import FloatArray, threads
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output


@dataclass(frozen=True)
class Peak:
    """The largest magnitude of a quantity over a turn."""

    # In SI units; its relative error is that of ``evaluate``, and below 1e-12 in any case where the
    # drive angle as a double resolves the peak.
    value: float
    # Drive angles in rad within the period at which it occurs, each again a period later; none
    # where it is the same at every angle.
    places: tuple[float, ...]


def peak(
    line: Driveline, name: str, item: int, load: Load | None = None, *, is_least: bool = False
) -> Peak:
    """Find the largest magnitude of an output over a turn; of a vector, the largest length.

    With ``is_least`` it is the least one. The output must repeat, which ``angle`` does not, and the
    load must be constant.
    """
    return _found(line, name, [item], load, (), is_least)[0]


def peaks(
    line: Driveline,
    name: str,
    items: list[int],
    load: Load | None = None,
    *,
    is_least: bool = False,
) -> FloatArray:
    """Return the values of ``peak`` of items of a batch of drivelines, ``(items, *batch)``."""
    own = () if load is None else np.broadcast_shapes(*load.shapes().values())
    shape = np.broadcast_shapes(line.shape, own)
    found = np.array([each.value for each in _found(line, name, items, load, shape, is_least)])
    return np.asarray(np.moveaxis(found.reshape(*shape, len(items)), -1, 0))


def _found(
    line: Driveline,
    name: str,
    items: list[int],
    load: Load | None,
    shape: tuple[int, ...],
    is_least: bool,
) -> list[Peak]:
    """The peaks of every driveline, and for each of them those of its items."""
    plan = line.plan(name, **_items(name, items), load=load)
    found = plan._core.peaks(shape, is_least, threads.at_most(None))
    if OUTPUTS[name].per == "bearing":
        # A plan has all bearings.
        found = [
            found[row + item] for row in range(0, len(found), line.n_bearings) for item in items
        ]
    return [Peak(value, tuple(places)) for value, places in found]


def torque_ends(line: Driveline, shaft: int, load: Load) -> tuple[float, float]:
    """Return the least and the largest torque of a shaft over a turn, with its sign.

    Both are found between samples, to about 1e-10 of the larger.
    """
    ends = []
    for sign in (-1.0, 1.0):
        middle, reach, values = math.pi, math.pi, np.empty(0)
        for _ in range(4):
            angles = np.linspace(middle - reach, middle + reach, 721)
            values = sign * values_of(line, "torque", shaft, angles, load)
            middle, reach = float(angles[np.argmax(values)]), reach / 180.0
        ends.append(sign * float(np.max(values)))
    return ends[0], ends[1]


def ideal_peak(line: Driveline, name: str, shaft: int, *, is_least: bool = False) -> Peak:
    """Return the largest motion of a shaft behind ideal joints over a turn, in closed form.

    With ``is_least`` it is the least one. It is exact at every bend, as a search is not: what
    rounding leaves of joints that cancel each other counts as none.
    """
    joint = line.equivalent(shaft)
    if is_cancelled(line, joint):
        return Peak(1.0 if name == "speed_ratio" else 0.0, ())
    slowest, s = float(joint.min_speed_ratio), math.sin(float(joint.bend)) ** 2
    # Input angles of the equivalent joint. The error is largest where tan**2 = cos(bend), the
    # acceleration where cos(2 a) = (-p + sqrt(p**2 + 8))/2 with p = (2 - s)/s; multiplied through,
    # s may be 0.
    if name == "angle_error":
        value, place = joint.max_angle_error, math.atan(math.sqrt(slowest))
    elif name == "speed_ratio":
        value, place = joint.max_speed_ratio, 0.0
        if is_least:
            value, place = joint.min_speed_ratio, math.pi / 2.0
    else:
        value = joint.max_acceleration_ratio
        cosine = 4.0 * s / (2.0 - s + math.hypot(2.0 - s, math.sqrt(8.0) * s))
        place = math.acos(min(1.0, cosine)) / 2.0
    ends = (place,) if name == "speed_ratio" else (place, -place)
    return Peak(float(value), tuple(end - float(joint.angle_offset) for end in ends))


def period_of(line: Driveline) -> float:
    """Return the drive angle in rad after which magnitudes repeat."""
    return math.tau if line.has_deviations else math.pi


def values_of(
    line: Driveline, name: str, item: int, angles: ArrayLike, load: Load | None
) -> FloatArray:
    """Return the values of an output of one shaft, joint or bearing."""
    values: FloatArray = line.evaluate(angles, name, load=load, **_items(name, item))[name]
    return values[item] if OUTPUTS[name].per == "bearing" else values


def _items(name: str, items: int | list[int]) -> dict[str, Any]:
    """The argument that chooses shafts or joints; there is none for bearings."""
    per = OUTPUTS[name].per
    return {} if per == "bearing" else {f"{per}s": items}


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
