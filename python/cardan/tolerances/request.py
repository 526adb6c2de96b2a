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
from cardan.load import Load
from cardan.outputs import OUTPUTS, nearest
from cardan.request import Items, item_index
from cardan.tolerances.box import Toleranced, boxes
from cardan.tolerances.case import Case, Quantity
from cardan.tolerances.quantities import FIGURES, Figure
from cardan.tolerances.reduced import ReducedOutput
from cardan.tolerances.result import Tolerances


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
    reduce: str,
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
    quantities: dict[str, Quantity] = {}
    for name in names:
        if name in FIGURES:
            quantities[name] = FIGURES[name]
            if FIGURES[name].needs_speed and speed is None:
                raise ArgumentValueError("speed", f"is missing; {name!r} needs it")
        else:
            reduced = ReducedOutput(name, reduce, load, shafts, joints, workers)
            reduced.check()
            quantities[name] = reduced
    known_speed = 0.0 if speed is None else _speed(speed)
    geometries = each.geometry.reshaped((len(each.each),))
    cases = [
        Case(box, geometries.taken(i), line_of, index, known_speed)
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
        if name not in FIGURES and name not in OUTPUTS:
            raise ArgumentValueError(
                "of", f"is {name!r}; {nearest(name, [*FIGURES, *OUTPUTS])}", (i,)
            )
        if names.index(name) < i:
            raise ArgumentValueError("of", f"is {name!r} again; name each figure once", (i,))
    return names, not isinstance(of, str)


def _limits(
    limit: Any,  # noqa: ANN401
    quantities: Mapping[str, Quantity],
    several: bool,
    degrees: bool,
) -> dict[str, float]:
    """The limits by figure, in the units of the figures."""
    found = {
        name: figure.default_limit
        for name, figure in quantities.items()
        if isinstance(figure, Figure) and figure.default_limit is not None
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
