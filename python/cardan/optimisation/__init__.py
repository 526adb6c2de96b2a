"""The best layout of a driveline over its states, within bounds and limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64, finite, import_optional, shares_of
from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    Place,
    check_choice,
    check_elements,
    check_shape,
    require,
)
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.geometry.parameters import LAYOUT_VARIABLES, checked_kind, parameter_shape
from cardan.optimisation.problem import (
    Measure,
    Parameter,
    Problem,
    QuantityLike,
    many_of,
    measure_of,
    states_of,
)
from cardan.optimisation.search import MARGIN, NOTHING, TOLERANCE, Candidate, candidates, search

__all__ = ["ActiveLimit", "NotKeptError", "Optimum", "optimise"]

# As near to its bound, as a share of the range, a variable is at it.
_AT_BOUND = 1e-6

# A value so near the largest, relatively, counts as well as it.
_ALIKE = 1e-4

# The share by which the squared length would shrink with a bound moved by the whole range, above
# which the bound holds the optimum.
_HOLDS = 1e-4


class NotKeptError(ArgumentValueError):
    """A limit that no variables keep.

    Attributes:
        quantity: the kept quantity.
        limit: the limit.
        reached: the least of the quantity that was found, with all limits in view.
        x: the variables that reach it, ``(m,)``.
    """

    def __init__(
        self,
        argument: str,
        problem: str,
        place: Place,
        limit: float,
        reached: float,
        x: FloatArray,
    ) -> None:
        """Make an error of its fields."""
        super().__init__(argument, problem, place)
        self.args = (argument, problem, place, limit, reached, x)
        self.quantity, self.limit, self.reached, self.x = str(place[0]), limit, reached, x


@dataclass(frozen=True)
class ActiveLimit:
    """Limit that keeps an optimum from being better.

    Attributes:
        kind: ``"low"`` or ``"high"`` for the bound of a variable, ``"keep"`` for a kept quantity.
        variable: number of the variable; ``None`` for a kept quantity.
        quantity: the kept quantity; ``""`` for a bound.
        limit: the bound or the limit.
        states: the states in which the kept quantity is at its limit.
    """

    kind: Literal["low", "high", "keep"]
    variable: int | None
    quantity: str
    limit: float
    states: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best variables that were found, and what they bring.

    Attributes:
        x: the variables, ``(m,)``.
        value: the quantity over all states, the largest or the root mean square.
        before: the same at the start.
        per_state: the quantity in each state, ``(states,)``.
        per_state_before: the same at the start.
        kept: the quantities with limits in each state, by name.
        kept_before: the same at the start.
        active: the bounds and limits that keep it from being better.
        message: one sentence that says so.
        unit: SI unit of the quantity; ``"1"`` for a ratio, ``""`` if it is a function.
    """

    x: FloatArray
    value: float
    before: float
    per_state: FloatArray
    per_state_before: FloatArray
    kept: Mapping[str, FloatArray]
    kept_before: Mapping[str, FloatArray]
    active: tuple[ActiveLimit, ...]
    message: str
    unit: str


def optimise(
    lines_of: Callable[[FloatArray], Driveline],
    start: ArrayLike,
    bounds: ArrayLike | None = None,
    *,
    minimise: QuantityLike = "equivalent_bend",
    over: Literal["largest", "rms"] = "largest",
    states: Sequence[str] | None = None,
    weights: ArrayLike | None = None,
    keep: Mapping[str, float] | None = None,
    jac: Callable[[FloatArray], NDArray[np.complex128]] | None = None,
    parameters: Sequence[tuple[Any, ...]] | None = None,
    load: Load | None = None,
    speed: ArrayLike | None = None,
    phases: Sequence[int] = (),
    teeth: int | Sequence[int] | None = None,
    degrees: bool = False,
    starts: int = 8,
    seed: int = 0,
    decimals: int | None = None,
    vectorised: bool = False,
) -> Optimum:
    """Find the variables that make a quantity of a driveline least over its states.

    The quantities are those of ``Driveline.tolerances``: ``equivalent_bend``, ``non_uniformity``,
    ``max_angle_error`` and ``torsional_excitation`` of the last shaft;
    ``inertia_excitation_driving``, ``inertia_excitation_coasting``, and ``inertia_excitation``,
    the larger of both; and an output over a turn of the drive with the number of its shaft, joint
    or bearing and its reduction, such as ``support_moment_1_peak`` or ``bearing_force_0_rms``, of
    which the magnitude counts. A function that returns one value for each state of a driveline is
    possible as well.

    Each local search is SciPy's sequential quadratic programming. The largest of the states is
    minimised by one more variable that bounds them all. The first four quantities grow with
    ``|q|`` of the transmission; the search uses ``|q|**2``, which is smooth where the equivalent
    bend is not (``Driveline.transmission``). Their root mean square is that of ``|q|``, and
    ``value`` the figure that belongs to it.

    Args:
        lines_of: returns the driveline of variables ``(m,)``; its batch axis is the states.
        start: the variables to begin with, ``(m,)``, in any unit.
        bounds: least and largest value of each variable, ``(m, 2)``; infinite where there is none.
            By default there are none.
        minimise: the quantity.
        over: of the states, the largest value or the root mean square.
        states: names of the states, for ``message``; by default their numbers.
        weights: of the states in the root mean square, ``(states,)``; by default all alike.
        keep: the largest value that other quantities may have in any state, by name, in SI units.
        jac: returns the derivatives of ``lines_of(x).transmission().q`` by the variables,
            ``(states, m)``. By default, and for quantities that do not follow from this ``q``, they
            come from differences.
        parameters: what each variable changes, if it changes parameters of the driveline in every
            state alike: ``("phases", 0)``, ``("points", (2, 1))`` or ``("bends", slice(0, 2),
            factor)`` with the change per unit of the variable, by default 1, in radians or the unit
            of the points. ``"twists"``, ``"lengths"`` of shafts and ``"positions"`` of bearings are
            possible as well. Derivatives are then exact for all quantities except functions.
        load: for outputs that need one.
        speed: of the drive in rad/s for the excitations, one for all states or ``(states,)``. By
            default they are over the square of the speed, so that they have no unit.
        phases: numbers of the variables that are phases. They repeat after half a turn, which the
            starts cover; without bounds the result is the value nearest to the start.
        teeth: of the splines of these phases: one number for all or one for each. They then differ
            from the start by whole teeth.
        degrees: whether phases are in degrees.
        starts: number of local searches: from the start, and from the best of random points within
            the bounds.
        seed: of the random points. The same seed gives the same result.
        decimals: decimal places to which to round the variables found, before their figures are
            computed; by default they are not rounded.
        vectorised: whether ``lines_of`` takes several sets of variables at once, ``(p, m)``, and
            returns a batch ``(p, states)``. The search is then faster.

    Returns:
        the best variables. They are never worse than the start, if that keeps all limits.

    Raises:
        ImportError: SciPy is missing.
        IndexError: a quantity of a shaft, joint or bearing that does not exist.
        TypeError: arguments of a wrong type.
        ValueError: bounds that exclude the start, an unknown quantity, a limit that no variables
            keep (the message says how near they come), shapes that do not fit.

    >>> import cardan
    >>> heights = np.linspace(-0.08, 0.08, 9)
    >>> def lines_of(x):
    ...     points = np.zeros((9, 5, 3))
    ...     points[:, :, 0] = 0.0, 0.35, 1.65, 3.15, 3.45
    ...     points[:, 1:3, 1] = -0.02, x[0]
    ...     points[:, 3:, 1] = heights[:, None] + (-0.18, -0.19)
    ...     return cardan.Driveline.from_points(points, x[1:])
    >>> bounds = [(-0.09, -0.01), (-np.inf, np.inf), (-np.inf, np.inf)]
    >>> best = cardan.optimise(lines_of, [-0.05, 0.0, 0.0], bounds, phases=[1, 2])
    >>> print(f"{np.degrees(best.before):.2f} -> {np.degrees(best.value):.2f} deg")
    1.92 -> 1.21 deg
    """
    first = as_float64("start", start)
    right = first.ndim == 1 and first.size > 0
    check_shape("start", first, right, "it must be one number per variable")
    finite("start", first)
    low, high = _checked_bounds(bounds, first)
    half_turn = 180.0 if degrees else math.pi
    numbers = _checked_phases(phases, len(first))
    steps = _steps_of(teeth, numbers)
    check_choice("over", over, ("largest", "rms"))
    integer("starts", starts, 1)
    line = many_of(lines_of(first[np.newaxis]), 1) if vectorised else states_of(lines_of(first))
    n_states = line.shape[-1]
    speeds = _speeds_of(speed, n_states)
    goal = measure_of("minimise", minimise, line.n_joints, load, speeds)
    kept, lengths = _kept_of(keep or {}, line.n_joints, load, speeds)
    names = [str(i) for i in range(n_states)] if states is None else list(states)
    if len(names) != n_states:
        raise ArgumentValueError("states", f"has {len(names)} names; there are {n_states} states")
    if weights is not None and over != "rms":
        raise ArgumentValueError("weights", "go with over='rms'; the largest needs none")
    weight = shares_of(weights, n_states)
    spans = np.array([low, high])
    scale = np.where(np.isfinite(high - low), high - low, np.maximum(np.abs(first), 1.0))
    unbounded = [i for i in numbers if not np.isfinite(high[i] - low[i])]
    scale[unbounded] = half_turn
    rms = over == "rms"
    known = parameters_of(parameters, line, len(first))
    if known and jac is not None:
        raise ArgumentValueError("jac", "does not go with parameters, which say the same")
    problem = Problem(
        lines_of, low, high, scale, goal, kept, lengths, rms, weight, jac, vectorised, known
    )
    # Errors of the start are those of the caller.
    problem.vectors_at(first[np.newaxis])
    begin = next(iter(candidates(problem, first[np.newaxis])), None)
    if begin is None:
        raise ArgumentValueError("start", "gives a quantity that is not finite")
    spans[0] = np.where(np.isfinite(low), low, np.minimum(first, high) - scale / 2.0)
    spans[1] = np.where(np.isfinite(high), high, np.maximum(first, low) + scale / 2.0)
    best = search(problem, begin, spans, starts, steps, half_turn, seed)
    if best.excess > TOLERANCE:
        raise _not_kept(problem, best)
    active = _active(problem, begin, best)
    x = best.x.copy()
    # Half a turn need not be whole teeth.
    for i in set(unbounded) - set(steps):
        off = x[i] - first[i]
        near = first[i] + off - half_turn * np.round(off / half_turn)
        x[i] = near if low[i] <= near <= high[i] else x[i]
    if decimals is not None:
        x = np.clip(np.round(x, integer("decimals", decimals)) + 0.0, low, high)
    best = next(iter(candidates(problem, x[np.newaxis])), best)
    return _optimum(problem, begin, best, active, names)


def _active(problem: Problem, begin: Candidate, best: Candidate) -> tuple[ActiveLimit, ...]:
    """Return the limits that keep an optimum from being better.

    There the slopes of the largest values and of what is at a limit add up to nothing, with
    factors that are not negative (Karush, Kuhn, Tucker). A limit without such a factor is reached
    and holds nothing.
    """
    if best.size <= NOTHING * begin.size:
        return ()
    reached: list[ActiveLimit] = []
    slopes: list[FloatArray] = []  # of each of them, one or several
    sides: tuple[tuple[Literal["low", "high"], FloatArray, float], ...] = (
        ("low", problem.low, -1.0),
        ("high", problem.high, 1.0),
    )
    for i, axis in enumerate(np.eye(len(best.x))):
        for kind, bound, sign in sides:
            if abs(best.x[i] - bound[i]) <= _AT_BOUND * problem.scale[i]:
                reached.append(ActiveLimit(kind, i, "", float(bound[i])))
                slopes.append(sign * axis[np.newaxis])
    goal_by, *keep_by = problem.derivatives(best.x)
    of_keep = zip(problem.keep, best.vectors[1:], keep_by, problem.lengths, strict=True)
    for measure, vectors, by, length in of_keep:
        at_limit = np.abs(vectors) / length > 1.0 - 10.0 * MARGIN
        if np.any(at_limit):
            there = tuple(map(int, np.flatnonzero(np.any(at_limit, axis=-1))))
            limit = float(measure.figure(length))
            reached.append(ActiveLimit("keep", None, measure.name, limit, there))
            slopes.append(_slopes(problem, vectors, by, length)[at_limit])
    if not reached:
        return ()
    squares = _slopes(problem, best.vectors[0], goal_by, best.size)
    if problem.rms:
        goal = (problem.weights @ np.mean(squares, axis=1))[np.newaxis]
    else:
        goal = squares[np.abs(best.vectors[0]) >= (1.0 - _ALIKE) * best.size]
    rows = np.concatenate([goal, *slopes])
    # The factors of the goal add up to 1, which counts far more than what the slopes leave.
    sum_of_goal = 1e3 * np.max(np.abs(rows)) * (np.arange(len(rows)) < len(goal))
    matrix = np.vstack([rows.T, sum_of_goal])
    right = np.append(np.zeros(len(best.x)), sum_of_goal[0])
    factors = import_optional("scipy", "optimise").optimize.nnls(matrix, right)[0][len(goal) :]
    owners = np.repeat(np.arange(len(reached)), [len(own) for own in slopes])
    held = np.bincount(owners, factors, minlength=len(reached)) > _HOLDS
    return tuple(limit for limit, holds in zip(reached, held, strict=True) if holds)


def _slopes(problem: Problem, vectors: NDArray[Any], by: NDArray[Any], length: float) -> FloatArray:
    """Return slopes of squared lengths in the scaled variables, ``(states, r, m)``."""
    products = np.real(np.conj(vectors)[..., np.newaxis] * by)
    return np.asarray(2.0 / length**2 * products * problem.scale)


def _optimum(
    problem: Problem,
    begin: Candidate,
    best: Candidate,
    active: tuple[ActiveLimit, ...],
    names: list[str],
) -> Optimum:
    def value(found: Candidate) -> float:
        return float(problem.goal.figure(found.size))

    def by_name(found: Candidate) -> dict[str, FloatArray]:
        pairs = zip(problem.keep, found.vectors[1:], strict=True)
        return {measure.name: measure.per_state(vectors) for measure, vectors in pairs}

    return Optimum(
        x=best.x,
        value=value(best),
        before=value(begin),
        per_state=problem.goal.per_state(best.vectors[0]),
        per_state_before=problem.goal.per_state(begin.vectors[0]),
        kept=by_name(best),
        kept_before=by_name(begin),
        active=active,
        message=_message(active, names),
        unit=problem.goal.unit,
    )


def _message(active: Sequence[ActiveLimit], names: Sequence[str]) -> str:
    parts = []
    for found in active:
        if found.kind == "keep":
            where = ", ".join(names[state] for state in found.states)
            place = f" in state {where}" if len(names) > 1 else ""
            parts.append(f"{found.quantity} is at its limit of {found.limit:.6g}{place}")
        else:
            side = "lower" if found.kind == "low" else "upper"
            parts.append(f"x[{found.variable}] is at its {side} bound of {found.limit:.6g}")
    return "; ".join(parts) or "no bound and no limit keeps it from being better"


def _not_kept(problem: Problem, best: Candidate) -> NotKeptError:
    """The error for limits that cannot be kept, with the worst of them."""
    shares = [
        np.max(np.abs(vectors)) / length
        for vectors, length in zip(best.vectors[1:], problem.lengths, strict=True)
    ]
    worst = int(np.argmax(shares))
    measure = problem.keep[worst]
    limit = float(measure.figure(problem.lengths[worst]))
    figure = float(np.max(measure.per_state(best.vectors[1 + worst])))
    others = [problem.keep[i].name for i, share in enumerate(shares) if i != worst and share > 1.0]
    more = f", with {' and '.join(others)} above the limit as well" if others else ""
    return NotKeptError(
        "keep",
        f"is {limit:.6g}; no variables within the bounds keep it: the best found reach "
        f"{figure:.6g}, {figure - limit:.3g} above{more}",
        (measure.name,),
        limit,
        figure,
        best.x,
    )


# --- the rules of the arguments, each of which names itself in its errors ------------------------


def _checked_bounds(bounds: ArrayLike | None, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return lower and upper bounds, which must contain the start."""
    if bounds is None:
        return np.full(start.shape, -np.inf), np.full(start.shape, np.inf)
    array = as_float64("bounds", bounds)
    wanted = (len(start), 2)
    rule = f"it must be {wanted}, a pair per variable"
    check_shape("bounds", array, array.shape == wanted, rule)
    for i, (low, high) in enumerate(array):
        problem = f"is [{low:g}, {high:g}]; the first must be below the second"
        require("bounds", low < high, problem, (i,))
        problem = f"is {start[i]:g}; it must lie within its bounds [{low:g}, {high:g}]"
        require("start", low <= start[i] <= high, problem, (i,))
    return array[:, 0].copy(), array[:, 1].copy()


def _checked_phases(phases: Sequence[int], count: int) -> list[int]:
    """Return the numbers of the variables that are phases."""
    numbers = []
    for i, given in enumerate(phases):
        number = integer("phases", given, place=(i,))
        problem = f"is {number}; there are {count} variables, counted from 0"
        require("phases", 0 <= number < count, problem, (i,))
        require("phases", number not in numbers, f"is {number} again; name each once", (i,))
        numbers.append(number)
    return numbers


def _steps_of(teeth: int | Sequence[int] | None, phases: Sequence[int]) -> dict[int, float]:
    """Return the teeth by the number of their variable."""
    if teeth is None:
        return {}
    listed: Sequence[Any] = [teeth] * len(phases) if not isinstance(teeth, Sequence) else teeth
    problem = f"has length {len(listed)}; there are {len(phases)} phases"
    require("teeth", len(listed) == len(phases), problem)
    for i, count in enumerate(listed):
        integer("teeth", count, 1, (i,) if isinstance(teeth, Sequence) else ())
    return dict(zip(phases, listed, strict=True))


def _kept_of(
    keep: Mapping[str, float], n_joints: int, load: Load | None, speed: FloatArray | None
) -> tuple[tuple[Measure, ...], FloatArray]:
    """Return the measures of the kept quantities and the lengths that they may have."""
    if not isinstance(keep, Mapping):
        raise ArgumentTypeError("keep", f"is {keep!r}; it must map quantities to limits")
    measures, lengths = [], []
    for name, limit in keep.items():
        argument = f"keep[{name!r}]"
        measure = measure_of(argument, name, n_joints, load, speed)
        value = float(as_float64(argument, limit))
        if not 0.0 < value < measure.largest:
            below = f" below {measure.largest:.6g}" if math.isfinite(measure.largest) else ""
            problem = f"is {limit!r}; a limit must be a positive number{below}"
            raise ArgumentValueError("keep", problem, (name,))
        measures.append(measure)
        lengths.append(measure.length(value))
    return tuple(measures), np.array(lengths)


def parameters_of(
    parameters: Sequence[tuple[Any, ...]] | None, line: Driveline, count: int
) -> tuple[Parameter, ...]:
    """Return what each variable changes; nothing if that is not known."""
    if parameters is None:
        return ()
    problem = f"has length {len(parameters)}; there are {count} variables"
    require("parameters", len(parameters) == count, problem)
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


def _speeds_of(speed: ArrayLike | None, n_states: int) -> FloatArray | None:
    """Return the speed of the drive, one or one per state, if it is known."""
    if speed is None:
        return None
    array = as_float64("speed", speed)
    right = array.shape in ((), (n_states,))
    check_shape("speed", array, right, f"there are {n_states} states")
    right = (array != 0.0) & np.isfinite(array)
    check_elements("speed", array, right, "; it must be finite and not 0")
    return array
