"""The arguments of ``cardan.optimise`` and their rules; each names itself in its errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError, check_elements, check_shape
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.geometry.parameters import LAYOUT_VARIABLES, checked_kind, parameter_shape
from cardan.optimisation.measures import Measure, measure_of
from cardan.optimisation.problem import Parameter


def checked_bounds(bounds: ArrayLike | None, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return lower and upper bounds, which must contain the start."""
    if bounds is None:
        return np.full(start.shape, -np.inf), np.full(start.shape, np.inf)
    array = as_float64("bounds", bounds)
    wanted = (len(start), 2)
    rule = f"it must be {wanted}, a pair per variable"
    check_shape("bounds", array, array.shape == wanted, rule)
    for i, (low, high) in enumerate(array):
        if not low < high:
            raise ArgumentValueError(
                "bounds", f"is [{low:g}, {high:g}]; the first must be below the second", (i,)
            )
        if not low <= start[i] <= high:
            raise ArgumentValueError(
                "start", f"is {start[i]:g}; it must lie within its bounds [{low:g}, {high:g}]", (i,)
            )
    return array[:, 0].copy(), array[:, 1].copy()


def checked_phases(phases: Sequence[int], count: int) -> list[int]:
    """Return the numbers of the variables that are phases."""
    numbers = []
    for i, given in enumerate(phases):
        number = integer("phases", given, place=(i,))
        if not 0 <= number < count:
            raise ArgumentValueError(
                "phases", f"is {number}; there are {count} variables, counted from 0", (i,)
            )
        if number in numbers:
            raise ArgumentValueError("phases", f"is {number} again; name each once", (i,))
        numbers.append(number)
    return numbers


def steps_of(teeth: int | Sequence[int] | None, phases: Sequence[int]) -> dict[int, float]:
    """Return the teeth by the number of their variable."""
    if teeth is None:
        return {}
    listed: Sequence[Any] = [teeth] * len(phases) if not isinstance(teeth, Sequence) else teeth
    if len(listed) != len(phases):
        raise ArgumentValueError(
            "teeth", f"has length {len(listed)}; there are {len(phases)} phases"
        )
    for i, count in enumerate(listed):
        integer("teeth", count, 1, (i,) if isinstance(teeth, Sequence) else ())
    return dict(zip(phases, listed, strict=True))


def kept_of(
    keep: Mapping[str, float], n_joints: int, load: Load | None, speed: FloatArray | None
) -> tuple[tuple[Measure, ...], FloatArray]:
    """Return the measures of the kept quantities and the lengths that they may have."""
    measures, lengths = [], []
    for name, limit in keep.items():
        argument = f"keep[{name!r}]"
        measure = measure_of(argument, name, n_joints, load, speed)
        value = float(as_float64(argument, limit))
        if not 0.0 < value < measure.largest:
            below = f" below {measure.largest:.6g}" if math.isfinite(measure.largest) else ""
            raise ArgumentValueError(
                "keep", f"is {limit!r}; a limit must be a positive number{below}", (name,)
            )
        measures.append(measure)
        lengths.append(measure.length(value))
    return tuple(measures), np.array(lengths)


def parameters_of(
    parameters: Sequence[tuple[Any, ...]] | None, line: Driveline, count: int
) -> tuple[Parameter, ...]:
    """Return what each variable changes; nothing if that is not known."""
    if parameters is None:
        return ()
    if len(parameters) != count:
        raise ArgumentValueError(
            "parameters", f"has length {len(parameters)}; there are {count} variables"
        )
    found = []
    for i, (kind, place, *factor) in enumerate(parameters):
        try:
            of = checked_kind(line, kind, LAYOUT_VARIABLES)
        except ArgumentValueError as error:
            raise ArgumentValueError("parameters", error.problem, (i, 0)) from None
        shape = parameter_shape(of, line.n_joints, line.n_bearings)
        own = place if isinstance(place, tuple) else (place,)
        try:
            np.empty(shape)[own]
        except IndexError as error:
            raise ArgumentValueError("parameters", f"is {place!r}; {error}", (i, 1)) from None
        found.append(Parameter(of, own, *map(float, factor)))
    return tuple(found)


def speeds_of(speed: ArrayLike | None, n_states: int) -> FloatArray | None:
    """Return the speed of the drive, one or one per state, if it is known."""
    if speed is None:
        return None
    array = as_float64("speed", speed)
    right = array.shape in ((), (n_states,))
    check_shape("speed", array, right, f"there are {n_states} states")
    right = (array != 0.0) & np.isfinite(array)
    check_elements("speed", array, right, "; it must be finite and not 0")
    return array
