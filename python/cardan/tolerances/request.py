"""The arguments of ``Driveline.tolerances``: their rules, and the result that they make."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    check_choice,
    check_elements,
    check_shape,
    nearest,
    require,
)
from cardan.arrays.indices import Items, integer, item_index
from cardan.design.limits import MAX_EQUIVALENT_BEND
from cardan.design.quantities import (
    FIRST_ORDERS,
    MOTION_QUANTITIES,
    MotionQuantity,
    ReducedQuantity,
    modulus_of_bend,
    nearest_quantity,
    order_quantity,
    reduced_quantity,
)
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.reductions import Reduction
from cardan.tolerances.box import JOINT_GROUPS, Sizes, boxes
from cardan.tolerances.case import Case, Design, Quantity
from cardan.tolerances.result import Tolerances

if TYPE_CHECKING:
    from cardan.driveline import Driveline

REDUCTIONS: tuple[Reduction, ...] = ("peak", "rms", "max", "mean")
"""The reductions of which the largest value is the worst."""


def tolerances(
    line: Driveline,
    *,
    bends: ArrayLike | None = None,
    twists: ArrayLike | None = None,
    phases: ArrayLike | None = None,
    points: ArrayLike | None = None,
    driving_yoke: ArrayLike | None = None,
    cross: ArrayLike | None = None,
    driven_yoke: ArrayLike | None = None,
    degrees: bool = False,
    distribution: Literal["uniform", "normal"] = "uniform",
    teeth: ArrayLike | None = None,
    of: str | Iterable[str] = "equivalent_bend",
    limit: ArrayLike | Mapping[str, ArrayLike] | None = None,
    speed: ArrayLike | None = None,
    load: Load | None = None,
    states: SupportsIndex | None = None,
    reduce: Literal["peak", "rms", "max", "mean"] = "peak",
    shaft: SupportsIndex = -1,
    shafts: Items = None,
    joints: Items = None,
    samples: SupportsIndex = 100_000,
    seed: int | None = None,
    workers: int | None = None,
) -> Tolerances:
    """Return how manufacturing and assembly errors affect the driveline.

    Near constant velocity the equivalent bend grows with the square root of an error: 5° of
    phase spoil a shaft with two bends of 10° to 4.2°. The result is lazy: random drivelines
    are drawn when a quantile or the passing share is asked for.

    Args:
        bends: tolerance of the bends, ± each, one number or ``(..., n)``.
        twists: of the twists, one number or ``(..., n - 1)``.
        phases: of the phases, one number or ``(..., n - 1)``.
        points: of every coordinate of the points, in their unit: one number, ``(..., n + 2,
            1)`` or ``(..., n + 2, 3)``. Bends and twists follow from the points; only phases
            can have tolerances besides.
        driving_yoke: of the deviations of the joints, as ``with_deviations`` has them, one
            number or ``(..., n)`` like the following two. ``0.1 mm`` at an arm of ``40 mm`` are
            ``0.1 / 40`` rad. Deviations that the driveline has are the middle.
        cross: of the crosses.
        driven_yoke: of the driven yokes.
        degrees: whether tolerances and limits that are angles are in degrees.
        distribution: ``"uniform"`` within ± the tolerance, or ``"normal"`` with the tolerance
            as three standard deviations.
        teeth: of the spline that carries the output-side yoke of each intermediate shaft, one
            number or ``(..., n - 1)``. The yoke can only be set by teeth, so that its phase is
            off by up to half a tooth, uniformly, in addition to its tolerance.
        of: one name or several: ``"equivalent_bend"``, ``"non_uniformity"``,
            ``"max_angle_error"``, ``"torsional_excitation"``, ``"inertia_excitation_driving"``,
            ``"inertia_excitation_coasting"``, ``"inertia_excitation"`` for the larger of both,
            an order of the motion, such as ``"angle_error_order_1"`` or, at ``speed``,
            ``"acceleration_order_1"``, an output reduced over a turn of 360 samples, such as
            ``"support_moment_1_peak"``, or an output from ``cardan.OUTPUTS`` alone, with
            ``reduce``, ``shafts`` and ``joints``.
        limit: what must not be exceeded, in the unit of the figure; with several figures a
            mapping by name. Default: the 3° of the catalogues for the first three figures.
        speed: drive speed in rad/s, for the excitations; broadcasts to the batch.
        load: for the outputs that need one; its values broadcast to the batch.
        states: the axis of the batch along which one driveline takes several positions, such
            as ride heights, with the same deviations in all of them. Each figure is then the
            largest of the states, and the results have the shape without this axis.
        reduce: of the outputs that are named without it; of a vector, the length of what it
            makes of the components.
        shaft: the shaft of the figures, by default the last.
        shafts: for the outputs per shaft, by default the last; the largest value counts.
        joints: for the outputs per joint, by default all; the largest value counts.
        samples: number of random drivelines.
        seed: of the random numbers; default: a new one, which is the ``seed`` of the result.
        workers: largest number of threads, as for ``evaluate``; results do not depend on it.

    Returns:
        worst case, guaranteed bound, quantiles, passing share and shares of the parameters.
        Angles are in radians; names with ``_deg`` are in degrees.

    Raises:
        IndexError: a shaft, joint or bearing, or an axis of states, that does not exist.
        ValueError: no tolerances, a negative one, one that permits a bend of 90°, points of a
            driveline that was not made from points, an unknown figure, shapes that do not fit,
            states with different tolerances; deviations with which a joint could not turn, and
            with them the first six figures and forces, which are those of ideal joints.

    >>> import cardan
    >>> shaft = cardan.Driveline.from_bends([10, 10], degrees=True)
    >>> print(shaft.tolerances(phases=5.0, degrees=True).worst_deg.round(4))
    4.184

    What 0.1 mm at 40 mm on every yoke does to order 1 at 3000 rpm:

    >>> yokes = dict(driving_yoke=0.0025, driven_yoke=0.0025)
    >>> speed = 3000 * 3.14159265 / 30
    >>> found = shaft.tolerances(**yokes, of="acceleration_order_1", speed=speed)
    >>> print(found.worst.round(1))
    122.4
    """
    sizes = {
        "bends": bends,
        "twists": twists,
        "phases": phases,
        "points": points,
        "driving_yoke": driving_yoke,
        "cross": cross,
        "driven_yoke": driven_yoke,
    }
    return toleranced(
        line,
        Sizes(sizes, teeth, distribution, degrees),
        Figures(of, limit, speed, load, states, reduce, shaft, shafts, joints),
        Drawn(samples, seed, workers),
    )


@dataclass(frozen=True, eq=False)
class Figures:
    """The figures that are asked for, as the arguments of ``tolerances`` have them."""

    of: str | Iterable[str] = "equivalent_bend"
    limit: ArrayLike | Mapping[str, ArrayLike] | None = None
    speed: ArrayLike | None = None
    load: Load | None = None
    states: SupportsIndex | None = None
    reduce: Reduction = "peak"
    shaft: SupportsIndex = -1
    shafts: Items = None
    joints: Items = None
    # Whether figures of the motion are those of ideal joints, and not refused for joints as built.
    motion_as_drawn: bool = False


@dataclass(frozen=True)
class Drawn:
    """The random drivelines, as the arguments of ``tolerances`` have them.

    Without a number, as many as the share within the limits needs are drawn.
    """

    samples: SupportsIndex | None = None
    seed: int | None = None
    workers: int | None = None


def toleranced(line: Driveline, sizes: Sizes, figures: Figures, drawn: Drawn) -> Tolerances:
    """Check what ``tolerances`` is asked and return its result."""
    names, several = _names(figures.of)
    index = item_index("shaft", figures.shaft, line.n_joints + 1)
    require("shaft", index != 0, "is 0; the drive shaft turns without errors")
    batch, lines, each = boxes(line, sizes)
    quantities = {name: _quantity(name, i, line, figures) for i, name in enumerate(names)}
    joints = [group for group in JOINT_GROUPS if sizes.each[group] is not None]
    if line.has_deviations or joints:
        others = [size for group, size in sizes.each.items() if group not in JOINT_GROUPS]
        layout = any(size is not None for size in (*others, sizes.teeth))
        _check_as_built(quantities, several, figures.motion_as_drawn and layout)
    for name, quantity in quantities.items():
        needs_speed = not isinstance(quantity, ReducedQuantity) and quantity.needs_speed
        if needs_speed and figures.speed is None:
            raise ArgumentValueError("speed", f"is missing; {name!r} needs it")
    speed = np.zeros(batch) if figures.speed is None else _speeds(figures.speed, batch)
    own = zip(each, speed.ravel().tolist(), _loads(figures.load, batch), strict=True)
    cases = [
        Case(box, lines[i], index, own_speed, own_load, drawn.workers)
        for i, (box, own_speed, own_load) in enumerate(own)
    ]
    seed = drawn.seed
    if seed is None:
        seed = int(np.random.SeedSequence().generate_state(1, np.uint64)[0])
    shape, designs, n_states = _designs(cases, batch, line, figures.states)
    return Tolerances(
        designs,
        shape,
        quantities,
        several=several,
        limits=_limits(figures.limit, quantities, several, sizes.degrees),
        samples=None if drawn.samples is None else integer("samples", drawn.samples, 1),
        seed=integer("seed", seed, 0),
        distribution=sizes.distribution,
        workers=drawn.workers,
        n_states=n_states,
    )


def _check_as_built(quantities: Mapping[str, Quantity], several: bool, as_drawn: bool) -> None:
    """Refuse figures of ideal joints, unless those of the drawing are meant."""
    for i, (name, quantity) in enumerate(quantities.items()):
        if isinstance(quantity, MotionQuantity) and not as_drawn:
            instead = "joints with deviations have orders, such as 'angle_error_order_1' and "
            instead += "'acceleration_order_1', and outputs, such as 'angle_error_peak'"
            problem = f"is {name!r}, a figure of ideal joints; {instead}"
            raise ArgumentValueError("of", problem, (i,) if several else ())


def _designs(
    cases: Sequence[Case], shape: tuple[int, ...], line: Driveline, states: SupportsIndex | None
) -> tuple[tuple[int, ...], list[Design], int | None]:
    """The shape of the batch without the states, its drivelines, and the number of states."""
    if states is None:
        return shape, [Design((case,)) for case in cases], None
    require("states", line.shape, "is given, but the driveline has no batch axis")
    # Tolerances may put more axes in front.
    axis = item_index("states", states, len(line.shape)) - len(line.shape)
    order = np.moveaxis(np.arange(len(cases)).reshape(shape), axis, -1)
    designs = []
    for numbers in order.reshape(-1, shape[axis]):
        design = Design(tuple(cases[i] for i in numbers))
        sizes = [(case.box.halves, case.box.teeth) for case in design.cases]
        problem = "have different tolerances; they are positions of one driveline"
        require("states", not any(one != sizes[0] for one in sizes), problem)
        designs.append(design)
    return order.shape[:-1], designs, shape[axis]


def _names(of: str | Iterable[str]) -> tuple[tuple[str, ...], bool]:
    names = (of,) if isinstance(of, str) else tuple(of)
    require("of", names, "is empty; name at least one figure")
    for i, name in enumerate(names):
        if not isinstance(name, str):
            raise ArgumentTypeError("of", f"is {name!r}; a figure is asked for by its name", (i,))
        if names.index(name) < i:
            raise ArgumentValueError("of", f"is {name!r} again; name each figure once", (i,))
    return names, not isinstance(of, str)


def _quantity(name: str, place: int, line: Driveline, figures: Figures) -> Quantity:
    """The quantity of a name; of an output alone, with the reduction and the items given."""
    if name in MOTION_QUANTITIES:
        return MOTION_QUANTITIES[name]
    if ordered := order_quantity(name):
        return ordered
    found = reduced_quantity(name)
    if found is None and name in OUTPUTS:
        output = OUTPUTS[name]
        check_choice("reduce", figures.reduce, REDUCTIONS)
        items = {"shaft": figures.shafts, "joint": figures.joints}.get(output.per)
        found = ReducedQuantity(output, items, figures.reduce)
    elif found is None:
        known = nearest_quantity(name, [*MOTION_QUANTITIES, *OUTPUTS, *FIRST_ORDERS])
        raise ArgumentValueError("of", f"is {name!r}; {known}", (place,))
    elif found.reduction not in REDUCTIONS:
        known = ", ".join(map(repr, REDUCTIONS))
        problem = f"is {name!r}; its reduction must be one of {known}"
        raise ArgumentValueError("of", problem, (place,))
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
            problem = f"is {limit!r}; with several figures it must be a mapping by their names"
            raise ArgumentTypeError("limit", problem)
        limit = {next(iter(quantities)): limit}
    for name, value in limit.items():
        if name not in quantities:
            raise ArgumentValueError("limit", f"names {name!r}; {nearest(str(name), quantities)}")
        number = as_float64("limit", value)
        if number.ndim or not number > 0.0:
            problem = f"is {value!r}; it must be a positive number"
            raise ArgumentValueError("limit", problem, (name,))
        in_degrees = degrees and quantities[name].unit == "rad"
        found[name] = math.radians(float(number)) if in_degrees else float(number)
    return found


def _speeds(speed: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """The speed of each driveline of the batch."""
    value = as_float64("speed", speed)
    check_elements("speed", value, np.isfinite(value), "; it must be finite, in rad/s")
    right = common_shape(driveline=shape, speed=value.shape) == shape
    check_shape("speed", value, right, f"the drivelines have {shape}")
    return np.broadcast_to(value, shape)


def _loads(load: Load | None, shape: tuple[int, ...]) -> list[Load | None]:
    """The load of each driveline of the batch."""
    if load is None or not any(load.shapes().values()):
        return [load] * math.prod(shape)
    if common_shape(driveline=shape, **load.shapes()) != shape:
        raise ArgumentValueError("load", f"has values for more drivelines than {shape}")

    def at(place: tuple[int, ...]) -> Load:
        return load.changed(
            lambda x, own: np.broadcast_to(x, (*shape, *x.shape[x.ndim - own :]))[place]
        )

    return [at(place) for place in np.ndindex(shape)]
