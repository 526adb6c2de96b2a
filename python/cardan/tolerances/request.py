"""The arguments of ``Driveline.tolerances``: their rules, and the result that they make."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.errors import ArgumentTypeError, ArgumentValueError, wrong_element
from cardan.geometry import Geometry
from cardan.limits import MAX_EQUIVALENT_BEND
from cardan.load import Load
from cardan.order_quantities import FIRST, order_quantity
from cardan.outputs import OUTPUTS, nearest
from cardan.quantities import MOTION_QUANTITIES, MotionQuantity, modulus_of_bend, nearest_quantity
from cardan.reduced_quantities import ReducedQuantity, reduced_quantity
from cardan.request import Items, Reduction, item_index
from cardan.tolerances.box import JOINT_GROUPS, Toleranced, boxes
from cardan.tolerances.case import Case, Quantity
from cardan.tolerances.design import Design
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
    driving_yoke: ArrayLike | None,
    cross: ArrayLike | None,
    driven_yoke: ArrayLike | None,
    degrees: bool,
    distribution: str,
    teeth: ArrayLike | None,
    of: str | Iterable[str],
    limit: Any,  # noqa: ANN401 - a number or a mapping
    speed: ArrayLike | None,
    load: Load | None,
    states: SupportsIndex | None,
    reduce: Reduction,
    shaft: SupportsIndex,
    shafts: Items,
    joints: Items,
    samples: SupportsIndex,
    seed: int | None,
    workers: int | None,
    motion_as_drawn: bool = False,
) -> Tolerances:
    """Check the arguments of ``Driveline.tolerances`` and return its result.

    With ``motion_as_drawn``, figures of the motion are those of ideal joints, and are not refused
    where the joints deviate or have tolerances.
    """
    names, several = _names(of)
    index = item_index("shaft", shaft, line.n_joints + 1)
    if index == 0:
        raise ArgumentValueError("shaft", "is 0; the drive shaft turns without errors")
    layout = {"bends": bends, "twists": twists, "phases": phases, "points": points}
    joint_sizes = dict(zip(JOINT_GROUPS, (driving_yoke, cross, driven_yoke), strict=True))
    given = {**layout, **joint_sizes}
    each = boxes(line, given, teeth, distribution, degrees)
    quantities = {
        name: _quantity(name, i, line, reduce, {"shaft": shafts, "joint": joints})
        for i, name in enumerate(names)
    }
    as_built = line._geometry.is_as_built
    as_built |= any(size is not None for size in joint_sizes.values())
    if as_built:
        drawn = motion_as_drawn and any(size is not None for size in (*layout.values(), teeth))
        _check_as_built(quantities, several, drawn)
    for name, quantity in quantities.items():
        if isinstance(quantity, ReducedQuantity):
            continue
        if quantity.needs_speed and speed is None:
            raise ArgumentValueError("speed", f"is missing; {name!r} needs it")
    speeds = np.zeros(each.shape) if speed is None else _speeds(speed, each.shape)
    loads = _loads(load, each.shape)
    geometries = each.geometry.reshaped((len(each.each),))
    cases = [
        Case(box, geometries.taken(i), line_of, index, own_speed, own_load, workers)
        for i, (box, own_speed, own_load) in enumerate(
            zip(each.each, speeds.ravel().tolist(), loads, strict=True)
        )
    ]
    shape, designs, n_states = _designs(cases, each.shape, line, states)
    return Tolerances(
        designs,
        shape,
        quantities,
        several=several,
        limits=_limits(limit, quantities, several, degrees),
        samples=_whole("samples", samples, 1, "must be positive"),
        seed=_seed(seed),
        distribution=distribution,
        workers=workers,
        n_states=n_states,
    )


def _check_as_built(quantities: Mapping[str, Quantity], several: bool, as_drawn: bool) -> None:
    """Refuse figures of ideal joints, unless those of the drawing are meant.

    Raises:
        ValueError: such a figure.
    """
    for i, (name, quantity) in enumerate(quantities.items()):
        if isinstance(quantity, MotionQuantity) and not as_drawn:
            raise ArgumentValueError(
                "of",
                f"is {name!r}, a figure of ideal joints; joints with deviations have orders, such "
                "as 'angle_error_order_1' and 'acceleration_order_1', and outputs, such as "
                "'angle_error_peak'",
                (i,) if several else (),
            )


def _designs(
    cases: Sequence[Case], shape: tuple[int, ...], line: Toleranced, states: SupportsIndex | None
) -> tuple[tuple[int, ...], list[Design], int | None]:
    """The shape of the batch without the states, its drivelines, and the number of states."""
    if states is None:
        return shape, [Design((case,)) for case in cases], None
    if not line.shape:
        raise ArgumentValueError("states", "is given, but the driveline has no batch axis")
    # Tolerances may put more axes in front.
    axis = item_index("states", states, len(line.shape)) - len(line.shape)
    order = np.moveaxis(np.arange(len(cases)).reshape(shape), axis, -1)
    designs = []
    for numbers in order.reshape(-1, shape[axis]):
        design = Design(tuple(cases[i] for i in numbers))
        sizes = [(case.box.halves, case.box.teeth) for case in design.cases]
        if any(one != sizes[0] for one in sizes):
            raise ArgumentValueError(
                "states", "have different tolerances; they are positions of one driveline"
            )
        designs.append(design)
    return order.shape[:-1], designs, shape[axis]


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
    if ordered := order_quantity(name):
        return ordered
    found = reduced_quantity(name)
    if found is None and name in OUTPUTS:
        output = OUTPUTS[name]
        if reduce not in REDUCTIONS:
            raise ArgumentValueError("reduce", f"is {reduce!r}; it must be one of {_LISTED}")
        found = ReducedQuantity(output, items.get(output.per), reduce)
    elif found is None:
        known = nearest_quantity(name, [*MOTION_QUANTITIES, *OUTPUTS, *FIRST])
        raise ArgumentValueError("of", f"is {name!r}; {known}", (place,))
    elif found.reduction not in REDUCTIONS:
        raise ArgumentValueError(
            "of", f"is {name!r}; its reduction must be one of {_LISTED}", (place,)
        )
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


def _speeds(speed: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """The speed of each driveline of the batch."""
    value = as_float64("speed", speed)
    wrong = ~np.isfinite(value)
    if wrong.any():
        raise wrong_element("speed", value, wrong, "; it must be finite, in rad/s")
    if common_shape(driveline=shape, speed=value.shape) != shape:
        raise ArgumentValueError("speed", f"has shape {value.shape}; the drivelines have {shape}")
    return np.broadcast_to(value, shape)


def _loads(load: Load | None, shape: tuple[int, ...]) -> list[Load | None]:
    """The load of each driveline of the batch."""
    count = math.prod(shape)
    if load is None:
        return [None] * count
    shapes = {"torque": load.torque.shape, "speed": load.speed.shape}
    shapes["acceleration"] = load.acceleration.shape
    if load.inertias is not None:
        shapes["inertias"] = load.inertias.shape[:-1]
    if not any(shapes.values()):
        return [load] * count
    if common_shape(driveline=shape, **shapes) != shape:
        raise ArgumentValueError("load", f"has values for more drivelines than {shape}")

    def each(values: FloatArray, *core: int) -> FloatArray:
        return np.broadcast_to(values, (*shape, *core)).reshape(count, *core)

    columns = {
        f"{load.end}_torque": each(load.torque),
        "speed": each(load.speed),
        "acceleration": each(load.acceleration),
    }
    if load.inertias is not None:
        columns["inertias"] = each(load.inertias, load.inertias.shape[-1])
    return [Load(**{name: column[i] for name, column in columns.items()}) for i in range(count)]


def _seed(seed: int | None) -> int:
    """The seed, a fresh one if none is given."""
    if seed is None:
        return int(np.random.SeedSequence().generate_state(1, np.uint64)[0])
    return _whole("seed", seed, 0, "must not be negative")


def _whole(argument: str, value: SupportsIndex, least: int, rule: str) -> int:
    if not hasattr(value, "__index__"):
        raise ArgumentTypeError(argument, f"is {value!r}; it must be an integer")
    number = operator.index(value)
    if number < least:
        raise ArgumentValueError(argument, f"is {number}; it {rule}")
    return number
