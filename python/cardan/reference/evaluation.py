"""Evaluations again: outputs by name, sweeps, reductions, orders, largest values and slopes.

Whatever changes over a turn is a function of the drive angle here. Sums are plain, largest values
are looked for, and slopes are differences.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.reference.forces import forces, loads
from cardan.reference.vectors import (
    Cross,
    ShaftMotion,
    Shafts,
    Vector,
    _dot,
    crosses,
    mean_offset,
    motion,
    tilts,
    turning_axes,
)

_offset = lru_cache(1024)(mean_offset)


def outputs(
    shafts: Shafts,
    angle: float,
    load: Mapping[str, Any] | None = None,
    lengths: Sequence[float] = (),
    bearings: Sequence[tuple[int, float]] = (),
    *,
    axes: str = "space",
) -> dict[str, NDArray[np.float64]]:
    """Return every output at a drive angle, by its name: of all shafts, joints or bearings.

    Args:
        load: as for ``reference.loads``; without it there are no moments.
        lengths: of each shaft [m]; without them there are no forces.
        bearings: shaft of each, and its distance from the upstream end of the shaft [m].
        axes: ``"space"``, or ``"shaft"`` for the components of each vector along its shaft, along
            the pin at the input side of that shaft, and along their cross product. Of joints it is
            the driven shaft.
    """
    each = [motion(shafts, angle, i, offset=_offset(shafts, i)) for i in _items(shafts.directions)]
    found: dict[str, Sequence[Any]] = {
        field.name: [getattr(one, field.name) for one in items]
        for kind, items in ((ShaftMotion, each), (Cross, crosses(shafts, angle)))
        for field in fields(kind)
    }
    found["tilt_driving"], found["tilt_driven"] = zip(*tilts(shafts, angle), strict=True)
    if load is not None:
        at = loads(shafts, angle, **load)
        triads = turning_axes(shafts, angle)

        def turned(vectors: Sequence[Vector], places: Sequence[int]) -> Sequence[Vector]:
            if axes == "space":
                return vectors
            pairs = zip(vectors, places, strict=True)
            return [tuple(_dot(v, x) for x in triads[shaft]) for v, shaft in pairs]  # type: ignore[misc]

        driven = _items(shafts.directions)[1:]
        found |= vars(at)
        found["moment"] = turned(at.moment, driven)
        found["support_moment"] = turned(at.support_moment, _items(shafts.directions))
        if lengths:
            held = forces(shafts, at, lengths, bearings)
            found["joint_force"] = turned(held.joint_force, driven)
            found["bearing_force"] = turned(held.bearing_force, [shaft for shaft, _ in bearings])
    return {name: np.array(values, float) for name, values in found.items()}


def _items(of: Sequence[object]) -> range:
    return range(len(of))


def sweep(start: float, stop: float, count: int) -> list[float]:
    """Return angles at equal steps, both ends included, each rounded once from its exact value."""
    first, step = Fraction(start), (Fraction(stop) - Fraction(start)) / max(count - 1, 1)
    return [float(first + step * i) for i in range(count)]


def drive_angle(shafts: Shafts, driven: float, shaft: int = -1) -> float:
    """Return the drive angle at which a shaft has this angle."""

    def missing(angle: float) -> float:
        return driven - motion(shafts, angle, shaft, offset=_offset(shafts, shaft)).angle

    return falling(missing, driven - math.pi, driven + math.pi)


def falling(value: Callable[[float], float], low: float, high: float) -> float:
    """Return where a value, positive at first, becomes negative, by halving the range."""
    while low < (middle := (low + high) / 2.0) < high:
        low, high = (middle, high) if value(middle) > 0.0 else (low, middle)
    return middle


def reduced(values: ArrayLike, reduction: str, *, vector: bool = False) -> NDArray[np.float64]:
    """Return what the samples on the last axis are reduced to; of vectors, on the axis before.

    Reductions are those of ``Driveline.evaluate``; the last axis of a vector holds its components.
    """
    array, axis = np.asarray(values, float), -2 if vector else -1
    if reduction == "rms":
        return np.asarray(np.sqrt(np.mean(array**2, axis=axis)))
    if reduction == "peak":
        sizes = np.linalg.norm(array, axis=-1) if vector else np.abs(array)
        return np.asarray(np.max(sizes, axis=-1))
    plain: dict[str, Callable[..., Any]] = {"min": np.min, "max": np.max, "mean": np.mean}
    return np.asarray(plain[reduction](array, axis=axis))


def harmonics(
    of: Callable[[float], ArrayLike], orders: Sequence[int], *, steps: int = 720
) -> list[NDArray[np.complex128]]:
    """Return complex amplitudes by plain Fourier sums; that of order 0 is the mean.

    Orders count periods per turn of the drive. A kink of the quantity ``of`` the drive angle leaves
    an error of the order of the square of the step.
    """
    angles = [math.tau * i / steps for i in range(steps)]
    values = [np.asarray(of(angle), float) for angle in angles]
    found = []
    for order in orders:
        turned = [x * cmath.exp(-1j * order * a) for x, a in zip(values, angles, strict=True)]
        found.append(np.asarray(np.mean(turned, axis=0) * (2.0 if order else 1.0)))
    return found


def largest(
    of: Callable[[float], float], period: float = math.pi, *, steps: int = 180
) -> tuple[float, float]:
    """Return a drive angle at which a value is largest over a period, and the value.

    The best of many angles is refined by thirds of what is around it. A peak that is narrower than
    a step of the period may be missed.
    """
    step = period / steps
    best = max(range(steps), key=lambda i: of(i * step)) * step
    low, high = best - step, best + step
    while high - low > 1e-8:
        left, right = low + (high - low) / 3.0, high - (high - low) / 3.0
        low, high = (left, high) if of(left) < of(right) else (low, right)
    return low, of(low)


def slopes(
    of: Callable[[list[float]], ArrayLike], at: Sequence[float], *, step: float = 1e-3
) -> list[NDArray[Any]]:
    """Return the derivatives of a quantity ``of`` some numbers in each, by differences.

    They may be bends, an angle or a torque; the error grows with the fourth power of the step.
    """
    found = []
    for i, x in enumerate(at):
        near = (of([*at[:i], x + n * step, *at[i + 1 :]]) for n in (-2, -1, 1, 2))
        far_below, below, above, far_above = map(np.asarray, near)
        found.append((8.0 * (above - below) - (far_above - far_below)) / (12.0 * step))
    return found


def integrated(
    of: Callable[[float, NDArray[Any]], NDArray[Any]], state: NDArray[Any], step: float, count: int
) -> list[NDArray[Any]]:
    """Return the states after each step of the classical method of Runge and Kutta.

    The slopes are a function ``of`` the variable, which begins with 0, and the state. Columns of a
    state are integrated side by side. The error falls with the fourth power of the step.
    """
    found = []
    for i in range(count):
        at = i * step
        first = of(at, state)
        second = of(at + step / 2.0, state + step / 2.0 * first)
        third = of(at + step / 2.0, state + step / 2.0 * second)
        fourth = of(at + step, state + step * third)
        state = state + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        found.append(state)
    return found
