"""The arguments of ``Driveline.tolerances``: their rules, and the result that they make."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import as_float64
from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.geometry import Geometry
from cardan.limits import MAX_EQUIVALENT_BEND
from cardan.load import Load
from cardan.outputs import OUTPUTS, nearest
from cardan.quantities import (
    MOTION_QUANTITIES,
    MotionQuantity,
    ReducedQuantity,
    modulus_of_bend,
    nearest_quantity,
    reduced_quantity,
)
from cardan.request import Items, Reduction, item_index
from cardan.tolerances.box import Toleranced, boxes
from cardan.tolerances.case import Case, Quantity
from cardan.tolerances.result import Tolerances

REDUCTIONS: tuple[Reduction, ...] = ("peak", "rms", "max", "mean")
"""The reductions of which the largest value is the worst."""

_LISTED = ", ".join(map(repr, REDUCTIONS))


def tolerances(
    line: Toleranced,
    line_of: Callable[[Geometry], Any],
    *,
    bends: ArrayLike | None,
    twists: ArrayLike | None,
    phases: ArrayLike | None,
    points: ArrayLike | None,
    degrees: bool,
    distribution: str,
    teeth: ArrayLike | None,
    of: str | Iterable[str],
    limit: Any,  # noqa: ANN401 - a number or a mapping
    speed: float | None,
    load: Load | None,
    reduce: Reduction,
    shaft: SupportsIndex,
    shafts: Items,
    joints: Items,
    samples: SupportsIndex,
    seed: int | None,
    workers: int | None,
) -> Tolerances:
    """Check the arguments of ``Driveline.tolerances`` and return its result."""
    names, several = _names(of)
    index = item_index("shaft", shaft, line.n_joints + 1)
    if index == 0:
        raise ArgumentValueError("shaft", "is 0; the drive shaft has no errors of its own")
    given = {"bends": bends, "twists": twists, "phases": phases, "points": points}
    each = boxes(line, given, teeth, distribution, degrees)
    quantities = {
        name: _quantity(name, i, line, reduce, {"shaft": shafts, "joint": joints})
        for i, name in enumerate(names)
    }
    for name, quantity in quantities.items():
        if isinstance(quantity, MotionQuantity) and quantity.needs_speed and speed is None:
            raise ArgumentValueError("speed", f"is missing; {name!r} needs it")
    known_speed = 0.0 if speed is None else _speed(speed)
    geometries = each.geometry.reshaped((len(each.each),))
    cases = [
        Case(box, geometries.taken(i), line_of, index, known_speed, load, workers)
        for i, box in enumerate(each.each)
    ]
    return Tolerances(
        cases,
        each.shape,
        quantities,
        several=several,
        limits=_limits(limit, quantities, several, degrees),
        samples=_samples(samples),
        seed=_seed(seed),
        distribution=distribution,
        workers=workers,
    )


def _names(of: str | Iterable[str]) -> tuple[tuple[str, ...], bool]:
    names = (of,) if isinstance(of, str) else tuple(of)
    if not names:
        raise ArgumentValueError("of", "is empty; name at least one figure")
    for i, name in enumerate(names):
        if not isinstance(name, str):
            raise ArgumentTypeError("of", f"is {name!r}; a figure is asked for by its name", (i,))
        if names.index(name) < i:
            raise ArgumentValueError("of", f"is {name!r} again; name each figure once", (i,))
    return names, not isinstance(of, str)


def _quantity(
    name: str, place: int, line: Toleranced, reduce: Reduction, items: Mapping[str, Items]
) -> Quantity:
    """The quantity of a name; of an output alone, with the reduction and the items given."""
    if name in MOTION_QUANTITIES:
        return MOTION_QUANTITIES[name]
    found = reduced_quantity(name)
    if found is None and name in OUTPUTS:
        output = OUTPUTS[name]
        if reduce not in REDUCTIONS:
            raise ArgumentValueError("reduce", f"is {reduce!r}; it must be one of {_LISTED}")
        found = ReducedQuantity(output, items.get(output.per), reduce)
        if output.vector and reduce != "peak":
            raise ArgumentValueError("reduce", f"is {reduce!r}; the vector {name!r} needs 'peak'")
    elif found is None:
        known = nearest_quantity(name, [*MOTION_QUANTITIES, *OUTPUTS])
        raise ArgumentValueError("of", f"is {name!r}; {known}", (place,))
    elif found.reduction not in REDUCTIONS:
        raise ArgumentValueError(
            "of", f"is {name!r}; its reduction must be one of {_LISTED}", (place,)
        )
    elif found.output.vector and found.reduction != "peak":
        raise ArgumentValueError("of", f"is {name!r}; of a vector it needs the 'peak'", (place,))
    else:
        found.check_item(line)
    return found


def _limits(
    limit: Any,  # noqa: ANN401
    quantities: Mapping[str, Quantity],
    several: bool,
    degrees: bool,
) -> dict[str, float]:
    """The limits by figure, in the units of the figures."""
    largest = modulus_of_bend(MAX_EQUIVALENT_BEND)
    found = {
        name: float(quantity.ratio(largest))
        for name, quantity in quantities.items()
        if isinstance(quantity, MotionQuantity) and quantity.limit == "equivalent_bend_deg"
    }
    if limit is None:
        return found
    if not isinstance(limit, Mapping):
        if several:
            raise ArgumentTypeError(
                "limit", f"is {limit!r}; with several figures it must be a mapping by their names"
            )
        limit = {next(iter(quantities)): limit}
    for name, value in limit.items():
        if name not in quantities:
            raise ArgumentValueError("limit", f"names {name!r}; {nearest(str(name), quantities)}")
        number = as_float64("limit", value)
        if number.ndim or not number > 0.0:
            raise ArgumentValueError(
                "limit", f"is {value!r}; it must be a positive number", (name,)
            )
        in_degrees = degrees and quantities[name].unit == "rad"
        found[name] = math.radians(float(number)) if in_degrees else float(number)
    return found


def _speed(speed: float) -> float:
    value = as_float64("speed", speed)
    if value.ndim or not np.isfinite(value):
        raise ArgumentValueError("speed", f"is {speed!r}; it must be one finite number in rad/s")
    return float(value)


def _samples(samples: SupportsIndex) -> int:
    if not hasattr(samples, "__index__"):
        raise ArgumentTypeError("samples", f"is {samples!r}; it must be an integer")
    count = operator.index(samples)
    if count < 1:
        raise ArgumentValueError("samples", f"is {count}; it must be positive")
    return count


def _seed(seed: int | None) -> int:
    """The seed, a fresh one if none is given."""
    if seed is None:
        return int(np.random.SeedSequence().generate_state(1, np.uint64)[0])
    if not hasattr(seed, "__index__"):
        raise ArgumentTypeError("seed", f"is {seed!r}; it must be an integer")
    value = operator.index(seed)
    if value < 0:
        raise ArgumentValueError("seed", f"is {value}; it must not be negative")
    return value
