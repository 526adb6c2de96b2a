"""The best layout over states, against grids, another optimiser and closed forms."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, Literal, TypedDict

import numpy as np
import pytest
from numpy.typing import NDArray

import cardan
import tiers
from cardan import ArgumentValueError, Driveline, Load
from cardan.optimisation.problem import Problem, QuantityLike, measure_of
from cardan.optimisation.search import _Program, _settings, candidates
from refusals import refusals

HEIGHTS = np.linspace(-80.0, 80.0, 9)
LOW, HIGH = np.array([-90.0, -90.0, -90.0]), np.array([-10.0, 90.0, 90.0])
START = np.array([-46.0, 0.0, 0.0])
BOUNDS = [(-90.0, -10.0), (-np.inf, np.inf), (-np.inf, np.inf)]


class _Phases(TypedDict):
    phases: tuple[int, ...]
    degrees: bool


PHASES: _Phases = {"phases": (1, 2), "degrees": True}


def truck(x: NDArray[np.float64]) -> Driveline:
    """A truck of three joints over nine ride heights, ``(..., 9)``.

    The variables are the height of the centre bearing in mm and both phases in degrees.
    """
    points = np.zeros((*x.shape[:-1], 9, 5, 3))
    points[..., 0] = 0, 350, 1650, 3150, 3450
    points[..., 1, 1] = -24
    points[..., 2, 1] = x[..., np.newaxis, 0]
    points[..., 3, 1] = HEIGHTS - 180
    points[..., 4, 1] = HEIGHTS - 196
    points[..., 3:, 2] = 45
    return Driveline.from_points(points, x[..., np.newaxis, 1:], degrees=True)


def largest(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.max(truck(x).equivalent().bend, axis=-1))


def grid(*counts: int) -> NDArray[np.float64]:
    axes = [np.linspace(a, b, count) for a, b, count in zip(LOW, HIGH, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def test_no_point_of_a_fine_grid_is_better() -> None:
    best = cardan.optimise(truck, START, BOUNDS, **PHASES)
    values = largest(grid(25, 45, 45))
    assert best.value <= np.min(values)
    assert np.min(values) < 1.25 * best.value
    # Nor is any of a grid around the optimum that is finer still.
    around = best.x + grid(9, 9, 9) / 90.0 * [0.01, 0.01, 0.01]
    around[:, 0] = np.clip(around[:, 0] + 50.0 / 9000.0, *BOUNDS[0])
    assert best.value <= np.min(largest(around)) + 1e-9
    np.testing.assert_allclose(best.value, largest(best.x), rtol=1e-12)
    np.testing.assert_allclose(best.before, largest(START), rtol=1e-12)
    np.testing.assert_allclose(best.per_state, truck(best.x).equivalent().bend, rtol=1e-9)
    np.testing.assert_allclose(best.per_state_before, truck(START).equivalent().bend, rtol=1e-9)


@pytest.mark.parametrize("over", ["largest", "rms"])
def test_ten_times_the_work_of_another_optimiser_finds_nothing_better(
    over: Literal["largest", "rms"],
) -> None:
    from scipy.optimize import differential_evolution

    drivelines = 0

    def counted(x: NDArray[np.float64]) -> Driveline:
        nonlocal drivelines
        drivelines += 9
        return truck(x)

    best = cardan.optimise(counted, START, BOUNDS, over=over, **PHASES)

    done = 0

    def other(columns: NDArray[np.float64]) -> NDArray[np.float64]:
        nonlocal done
        done += 9 * columns.shape[1]
        k = truck(columns.T).equivalent().k
        length = np.max(k, axis=-1) if over == "largest" else np.sqrt(np.mean(k**2, axis=-1))
        return np.asarray(2.0 * np.arctan(np.sqrt(length)))

    generations = 10 * drivelines // (9 * 45)
    found = differential_evolution(
        other,
        list(zip(LOW, HIGH, strict=True)),
        seed=3,
        maxiter=generations,
        popsize=15,
        tol=0.0,
        vectorized=True,
        updating="deferred",
        polish=False,
    )
    assert done >= 10 * drivelines
    assert best.value <= found.fun * (1.0 + 1e-7)
    assert found.fun <= best.value * (1.0 + 1e-3)


def test_one_phase_is_that_of_the_closed_form() -> None:
    line = Driveline.from_bends([10, 9], twists=[37], phases=[0], degrees=True)
    best = cardan.optimise(lambda x: line.with_phases(x), [0.0], phases=[0])
    exact = line.optimal_phases()
    np.testing.assert_allclose(best.x, exact, atol=1e-7)
    np.testing.assert_allclose(
        best.value, line.with_phases(exact).equivalent().bend, rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("start", [[-51.0, 141.0], [-231.0, 137.0], [400.0, -600.0]])
def test_a_free_phase_stays_next_to_its_start(start: list[float]) -> None:
    """From the first two starts the search ends more than a quarter turn away."""
    line = Driveline.from_bends([9, 10, 6], [37, -50], degrees=True)

    def phased(x: NDArray[np.float64]) -> Driveline:
        return line.with_phases(np.radians(x))

    best = cardan.optimise(phased, start, phases=[0, 1], degrees=True, starts=1)
    assert np.all(np.abs(best.x - start) <= 90.0)
    np.testing.assert_allclose(phased(best.x).equivalent().bend, best.value, atol=1e-9)
    # A bound is kept even where the value nearest to the start is beyond it.
    low = [start[0] - 10.0, -np.inf]
    bounded = cardan.optimise(
        phased, start, [(low[0], np.inf), (-np.inf, np.inf)], phases=[0, 1], degrees=True
    )
    assert np.all(bounded.x >= low)
    assert np.degrees(bounded.value) < 1e-4


def test_parameters_give_the_derivatives() -> None:
    """Exact ones of all quantities, from far fewer drivelines than differences need."""
    calls = []

    def counted(x: NDArray[np.float64]) -> Driveline:
        calls.append(1)
        return truck(x)

    known = [("points", (2, 1)), *(("phases", i, np.pi / 180.0) for i in range(2))]
    asked: dict[str, Any] = {"minimise": "bending_driven_2_peak", **PHASES}
    asked |= {"load": Load(output_torque=100.0), "keep": {"inertia_excitation": 0.02}}
    plain = cardan.optimise(counted, START, BOUNDS, **asked)
    many = len(calls)
    calls.clear()
    exact = cardan.optimise(counted, START, BOUNDS, parameters=known, **asked)
    assert exact.value <= plain.value * (1.0 + 1e-6)
    assert len(calls) < 0.8 * many


def test_parameters_go_with_a_function_whose_derivatives_are_differences() -> None:
    known = [("points", (2, 1)), *(("phases", i, np.pi / 180.0) for i in range(2))]
    named = cardan.optimise(truck, START, BOUNDS, parameters=known, **PHASES)
    found = cardan.optimise(
        truck,
        START,
        BOUNDS,
        minimise=lambda line: np.asarray(line.equivalent().bend),
        parameters=known,
        keep={"inertia_excitation": 1.0},
        **PHASES,
    )
    assert found.value == pytest.approx(named.value, rel=1e-3)
    # The limit is far away.
    assert not [limit for limit in found.active if limit.kind == "keep"]


def supported(x: NDArray[np.float64]) -> Driveline:
    """A truck at three ride heights with bearings, ``(..., 3)``, in metres.

    The variables are the height of the centre bearing and its distance from the joint before it.
    """
    points = np.zeros((*x.shape[:-1], 3, 5, 3))
    points[..., 0] = 0.0, 0.35, 1.65, 3.15, 3.45
    points[..., 1, 1] = -0.024
    points[..., 2, 1] = x[..., np.newaxis, 0]
    points[..., 3, 1] = np.array([-0.08, 0.0, 0.08]) - 0.18
    points[..., 4, 1] = np.array([-0.08, 0.0, 0.08]) - 0.196
    bearings: list[tuple[int, Any]] = [
        (0, 0.1),
        (0, 0.3),
        (1, x[..., np.newaxis, 1]),
        (3, 0.1),
        (3, 0.25),
    ]
    return Driveline.from_points(points, [0.2, 0.1]).with_bearings(bearings)


BY_POSITION = [("points", (2, 1)), ("positions", 2)]
TORQUE = Load(output_torque=300.0)


@pytest.mark.parametrize("name", ["bearing_force_2_peak", "joint_force_1_rms"])
def test_forces_have_exact_derivatives_by_bearings_too(name: str) -> None:
    x = np.array([-0.07, 1.1])
    measure = measure_of("minimise", name, 3, TORQUE)
    assert measure.derivatives
    by = measure.derivatives(supported(x), ["points", "positions"])
    parts = [by["points"][..., 2, 1], by["positions"][..., 2]]
    for i, step in enumerate(1e-6 * np.eye(2)):
        ends = [measure.vectors(supported(x + sign * step)) for sign in (1.0, -1.0)]
        difference = (ends[0] - ends[1]) / 2e-6
        np.testing.assert_allclose(parts[i], difference, rtol=1e-6, atol=1e-6 * np.max(ends))


@pytest.mark.parametrize("keep", [{}, {"equivalent_bend": 0.056}])
@pytest.mark.parametrize("name", ["bearing_force_2_peak", "bearing_force_2_rms"])
def test_no_place_of_a_bearing_has_a_smaller_force(name: str, keep: dict[str, float]) -> None:
    low, high = np.array([-0.15, 0.6]), np.array([0.0, 1.25])
    bounds = np.stack([low, high], axis=-1)
    best = cardan.optimise(
        supported,
        [-0.05, 0.9],
        bounds,
        minimise=name,
        parameters=BY_POSITION,
        load=TORQUE,
        keep=keep,
        vectorised=True,
    )
    axes = [np.linspace(a, b, 61) for a, b in bounds]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    lines = supported(points)
    plan = lines[..., np.newaxis].plan("bearing_force", load=TORQUE)
    sizes = np.linalg.norm(plan(np.linspace(0.0, np.pi, 181))["bearing_force"][2], axis=-1)
    peaks = np.max(sizes, axis=-1)
    forces = peaks if name.endswith("peak") else np.sqrt(np.mean(sizes[..., :-1] ** 2, axis=-1))
    largest_force = np.max(forces, axis=-1)
    kept = np.max(lines.equivalent().bend, axis=-1) <= keep.get("equivalent_bend", np.inf)
    assert 0 < np.count_nonzero(kept) <= len(points)
    assert bool(keep) == (not np.all(kept))
    assert best.value <= np.min(largest_force[kept]) * (1.0 + 1e-9)
    assert best.value < 0.9 * best.before or keep
    assert best.value == pytest.approx(np.min(largest_force[kept]), rel=0.03)
    for kept_name, limit in keep.items():
        assert np.all(best.kept[kept_name] <= limit * (1.0 + 1e-9))


def test_constant_velocity_is_reached() -> None:
    """There the equivalent bend has an infinite slope, and ``q`` none of that."""
    best = cardan.optimise(
        lambda x: Driveline.from_bends([10.0, x[0]], [180.0], [x[1]], degrees=True),
        [14.0, 8.0],
        [(5.0, 20.0), (-np.inf, np.inf)],
        phases=[1],
        degrees=True,
    )
    assert np.degrees(best.value) < 1e-3
    np.testing.assert_allclose(best.x, [10.0, 0.0], atol=1e-6)
    assert best.active == ()


def test_a_kept_quantity_is_at_its_limit() -> None:
    free = cardan.optimise(truck, START, BOUNDS, **PHASES)
    excitation = cardan.optimise(truck, START, BOUNDS, minimise="inertia_excitation", **PHASES)
    limit = 0.5 * (excitation.value + np.max(excitation_of(truck(free.x))))
    best = cardan.optimise(truck, START, BOUNDS, keep={"inertia_excitation": limit}, **PHASES)
    assert limit * (1.0 - 1e-4) < np.max(best.kept["inertia_excitation"]) <= limit
    assert free.value < best.value < best.before
    (active,) = (found for found in best.active if found.kind == "keep")
    assert (active.quantity, active.variable) == ("inertia_excitation", None)
    assert active.limit == pytest.approx(limit)
    points = grid(tiers.part(33), 36, 36)
    lines = truck(points)
    kept = np.max(excitation_of(lines), axis=-1) <= limit
    assert best.value <= np.min(largest(points)[kept])


def excitation_of(line: Driveline) -> NDArray[np.float64]:
    """By the check, which has its own formula; the larger of driving and coasting."""
    findings = line.check(1.0).findings
    own = [f.value for f in findings if f.figure.startswith("inertia_excitation")]
    return np.asarray(np.max(own, axis=0))


@pytest.mark.long
def test_a_limit_that_cannot_be_kept_is_named_with_how_near_it_comes() -> None:
    least = np.min(largest(grid(21, 40, 40)))
    with pytest.raises(ArgumentValueError, match=r"no variables within the bounds keep it") as hit:
        cardan.optimise(
            truck,
            START,
            BOUNDS,
            minimise="inertia_excitation",
            keep={"equivalent_bend": 0.5 * least},
            **PHASES,
        )
    error: Any = hit.value
    assert (error.argument, error.place) == ("keep", ("equivalent_bend",))
    assert error.limit == pytest.approx(0.5 * least)
    assert 0.7 * least < error.reached <= least
    assert largest(error.x[np.newaxis]) == pytest.approx(error.reached, rel=1e-12)


@pytest.mark.parametrize("teeth", [16, [9, 24]])
def test_no_other_teeth_are_better(teeth: int | list[int]) -> None:
    def phased(x: NDArray[np.float64]) -> Driveline:
        return truck(np.array([-46.0, *x]))

    best = cardan.optimise(phased, [3.0, 5.0], phases=[0, 1], teeth=teeth, degrees=True)
    counts = np.broadcast_to(teeth, 2)
    axes = [
        start + 360.0 / count * np.arange(count)
        for start, count in zip((3, 5), counts, strict=True)
    ]
    first, second = np.meshgrid(*axes, indexing="ij")
    every = largest(np.stack([np.full(first.size, -46.0), first.ravel(), second.ravel()], axis=-1))
    assert best.value == pytest.approx(np.min(every), rel=1e-12)
    turned = (best.x - [3.0, 5.0]) / (360.0 / counts)
    np.testing.assert_allclose(turned, np.round(turned), atol=1e-9)


@pytest.mark.parametrize(("bounds", "end"), [((-20.0, 90.0), -15.0), ((-90.0, -50.0), -60.0)])
def test_teeth_stay_within_bounds_on_whole_teeth(bounds: tuple[float, float], end: float) -> None:
    """The best phase without bounds, -43.3°, lies outside."""

    def phased(x: NDArray[np.float64]) -> Driveline:
        return truck(np.array([-89.6, x[0], -1.2]))

    start = 0.0 if bounds[0] > -30.0 else -75.0
    best = cardan.optimise(phased, [start], [bounds], phases=[0], degrees=True, teeth=24)
    assert best.x == pytest.approx([end], abs=1e-9)


def test_points_that_make_no_driveline_hide_no_others() -> None:
    def lines_of(x: NDArray[np.float64]) -> Driveline:
        return Driveline.from_bends(x[:, :, np.newaxis])

    points = np.array([[0.1], [2.0], [0.3], [1.9], [3.0], [0.2], [0.4]])
    goal, even = measure_of("minimise", "equivalent_bend", 1, None), np.ones(1)
    problem = Problem(
        *(lines_of, np.zeros(1), np.full(1, 9.0), np.ones(1), goal, (), np.empty(0), False, even),
        jac=None,
        vectorised=True,
    )
    found = candidates(problem, points)
    bends = np.array([0.1, 0.3, 0.2, 0.4])
    assert [one.x[0] for one in found] == [*bends]
    assert [one.size for one in found] == pytest.approx(np.tan(bends / 2) ** 2)


def test_the_best_of_all_starts_counts() -> None:
    def wells(line: Driveline) -> NDArray[np.float64]:
        """A narrow one at the start, and a wide one that random starts fall into."""
        narrow, wide = (line.bends[..., 0] - 0.2) / 0.01, (line.bends[..., 0] - 0.8) / 0.2
        return np.asarray(1.0 - 0.9 * np.exp(-(narrow**2)) - 0.5 * np.exp(-(wide**2)))

    best = cardan.optimise(
        lambda x: Driveline.from_bends([x]), [0.205], [(0.0, 1.0)], minimise=wells, starts=2
    )
    assert best.x == pytest.approx([0.2], abs=1e-4)


def test_the_worst_of_several_limits_counts() -> None:
    names = ("non_uniformity", "equivalent_bend")
    goal, *keep = (measure_of("keep", name, 3, None) for name in (names[1], *names))
    lengths, even = np.array([0.5, 0.001]), np.full(9, 1.0 / 9.0)
    problem = Problem(
        *(truck, LOW, HIGH, HIGH - LOW, goal, tuple(keep), lengths, False, even, None, True)
    )
    size = float(np.max(np.abs(truck(START).transmission().q)))
    (found,) = candidates(problem, START[np.newaxis])
    assert found.excess == pytest.approx(size / 0.001 - 1.0)
    assert found.rank == (found.excess, found.size)


def test_of_many_teeth_those_next_to_the_optima_are_compared() -> None:
    """A phase repeats after half a turn: 0° is as near to 175° as 170° is."""
    allowed = [np.arange(0.0, 180.0, 15.0)] * 3
    assert len(allowed[0]) ** 3 > 1024
    found = _settings(allowed, [np.array([175.0, 32.0, 100.0])], 180.0)
    nearest = ((165.0, 0.0, 15.0), (15.0, 30.0, 45.0), (90.0, 105.0, 120.0))
    assert set(found) == set(itertools.product(*nearest))


def test_teeth_with_another_variable() -> None:
    best = cardan.optimise(truck, START, BOUNDS, teeth=16, **PHASES)
    heights = np.linspace(-90.0, -10.0, 321)
    turns = 22.5 * np.arange(8)
    points = np.stack(np.meshgrid(heights, turns, turns, indexing="ij"), axis=-1).reshape(-1, 3)
    every = largest(points)
    assert np.min(every) * (1.0 - 1e-3) < best.value <= np.min(every) * (1.0 + 1e-9)


def test_known_derivatives_find_the_same() -> None:
    calls = 0

    def jac(x: NDArray[np.float64]) -> NDArray[np.complex128]:
        nonlocal calls
        calls += 1
        transmission = truck(x).transmission()
        by_points = transmission.dq(by="points")[:, 2, 1:2]
        return np.hstack([by_points, np.pi / 180.0 * transmission.dq(by="phases")])

    exact = cardan.optimise(truck, START, BOUNDS, jac=jac, **PHASES)
    plain = cardan.optimise(truck, START, BOUNDS, **PHASES)
    assert calls
    assert exact.value == pytest.approx(plain.value, rel=1e-7)
    np.testing.assert_allclose(exact.x, plain.x, atol=1e-3)


@pytest.mark.parametrize("at", [-90.0, -46.0, -10.0])
def test_differences_are_the_derivatives_within_and_at_the_bounds(at: float) -> None:
    x, low, high = np.array([at, 20.0, -7.0]), LOW.copy(), HIGH.copy()
    measure = measure_of("minimise", "equivalent_bend", 3, None)
    asked: dict[str, Any] = {
        "goal": measure,
        "keep": (),
        "lengths": np.empty(0),
        "rms": False,
        "weights": np.full(9, 1.0 / 9.0),
        "jac": None,
        "vectorised": True,
    }

    def inside(points: NDArray[np.float64]) -> Driveline:
        assert np.all((points >= low) & (points <= high))
        return truck(points)

    (found,) = Problem(inside, low, high, high - low, **asked).derivatives(x)
    transmission = truck(x).transmission()
    np.testing.assert_allclose(found[:, 0, 0], transmission.dq(by="points")[:, 2, 1], rtol=1e-6)
    by_phases = np.pi / 180.0 * transmission.dq(by="phases")
    np.testing.assert_allclose(found[:, 0, 1:], by_phases, rtol=1e-6, atol=1e-12)


def test_batches_of_variables_find_the_same() -> None:
    one = cardan.optimise(truck, START, BOUNDS, **PHASES)
    many = cardan.optimise(truck, START, BOUNDS, vectorised=True, **PHASES)
    assert many.value == pytest.approx(one.value, rel=1e-9)


def moment(line: Driveline) -> NDArray[np.float64]:
    angles = np.linspace(0.0, np.pi, 181)
    result = line[:, np.newaxis].evaluate(
        angles, "bending_driven", joints=2, load=Load(output_torque=100.0), reduce="peak"
    )
    return np.asarray(result.bending_driven)


@pytest.mark.parametrize(
    ("quantity", "figure"),
    [
        ("equivalent_bend", lambda line: line.equivalent().bend),
        ("non_uniformity", lambda line: line.equivalent().non_uniformity),
        ("max_angle_error", lambda line: line.equivalent().max_angle_error),
        ("inertia_excitation", excitation_of),
        ("bending_driven_2_peak", moment),
        (moment, moment),
    ],
)
def test_figures_are_those_of_the_driveline(
    quantity: QuantityLike, figure: Callable[[Any], Any]
) -> None:
    load = Load(output_torque=100.0)
    best = cardan.optimise(truck, START, BOUNDS, minimise=quantity, load=load, starts=2, **PHASES)
    np.testing.assert_allclose(best.per_state, figure(truck(best.x)), rtol=1e-9)
    np.testing.assert_allclose(best.per_state_before, figure(truck(START)), rtol=1e-9)
    assert best.value == pytest.approx(np.max(best.per_state))
    assert best.value < best.before


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("torsional_excitation", 1),
        ("inertia_excitation_driving", 2),
        ("inertia_excitation_coasting", 3),
    ],
)
def test_excitations_are_those_of_a_check(name: str, number: int) -> None:
    """At one speed for all states and, of the inertias, at one for each."""
    best = cardan.optimise(
        truck, START, BOUNDS, minimise=name, keep={name: 1e5}, speed=104.7, starts=1, **PHASES
    )
    assert best.unit == "rad/s²"
    for x, figures in ((best.x, best.per_state), (START, best.per_state_before)):
        finding = truck(np.asarray(x)).check(104.7).findings[number]
        assert finding.figure == name
        np.testing.assert_allclose(figures, finding.value, rtol=1e-9)
    np.testing.assert_array_equal(best.kept[name], best.per_state)
    speeds = np.linspace(100.0, 180.0, 9)

    def each() -> cardan.Optimum:
        return cardan.optimise(
            truck, START, BOUNDS, minimise=name, speed=speeds, starts=1, **PHASES
        )

    if name == "torsional_excitation":
        with pytest.raises(ArgumentValueError, match="it needs the same speed in all states"):
            each()
    else:
        found = each()
        wanted = truck(found.x).check(speeds).findings[number].value
        np.testing.assert_allclose(found.per_state, wanted, rtol=1e-9)


def test_a_limit_of_an_excitation_is_exact() -> None:
    speed, bend = 104.7, 0.2
    limit = float(Driveline.from_bends([bend]).check(speed).findings[1].value)
    best = cardan.optimise(
        lambda x: Driveline.from_bends([x]),
        [0.1],
        [(0.0, 1.0)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        keep={"torsional_excitation": limit},
        speed=speed,
    )
    assert best.x[0] == pytest.approx(bend, rel=1e-5)


@pytest.mark.parametrize("name", ["equivalent_bend", "non_uniformity", "max_angle_error"])
def test_limits_of_the_motion_are_exact(name: str) -> None:
    """One joint whose bend may grow up to a limit: the best is at the limit."""
    largest_bend = 0.3
    limit = getattr(
        Driveline.from_bends([largest_bend]).equivalent(),
        {"equivalent_bend": "bend"}.get(name, name),
    )
    best = cardan.optimise(
        lambda x: Driveline.from_bends([x]),
        [0.1],
        [(0.0, 1.0)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        keep={name: float(limit)},
    )
    assert best.x[0] == pytest.approx(largest_bend, rel=1e-5)
    assert best.message.startswith(f"{name} is at its limit of ")


def test_a_start_beyond_a_limit_is_left_for_a_worse_one_within() -> None:
    best = cardan.optimise(
        lambda x: Driveline.from_bends([x]),
        [0.5],
        [(0.0, 1.0)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        keep={"equivalent_bend": 0.3},
    )
    assert best.value > best.before
    assert best.x[0] == pytest.approx(0.3, rel=1e-5)


def test_a_root_mean_square_leaves_a_start_beyond_a_limit() -> None:
    """The goal alone leads farther beyond it."""
    best = cardan.optimise(
        lambda x: Driveline.from_bends([[x[0]], [0.2]]),
        [0.5],
        [(0.0, 1.0)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        over="rms",
        keep={"equivalent_bend": 0.3},
        starts=1,
    )
    assert best.x[0] == pytest.approx(0.3, rel=1e-5)


def test_excitations_at_a_speed_of_each_state_have_exact_derivatives() -> None:
    x, speeds = np.array([-60.0, 20.0, -7.0]), np.linspace(50.0, 90.0, 9)
    measure = measure_of("minimise", "inertia_excitation", 3, None, speeds)
    assert measure.derivatives
    found = measure.derivatives(truck(x), ["phases"])["phases"] * np.pi / 180.0
    for i, step in enumerate(1e-4 * np.eye(3)[1:]):
        ends = [np.abs(measure.vectors(truck(x + sign * step))) ** 2 for sign in (1.0, -1.0)]
        slopes = 2.0 * np.real(np.conj(measure.vectors(truck(x))) * found[..., i])
        scale = np.max(np.abs(slopes))
        np.testing.assert_allclose(slopes, (ends[0] - ends[1]) / 2e-4, atol=1e-6 * scale)


@pytest.mark.parametrize("rms", [False, True])
@pytest.mark.parametrize("excess", [0.0, 0.5])
def test_the_solver_has_the_slopes_of_what_it_gets(rms: bool, excess: float) -> None:
    """Against differences, with two vectors per state and unequal weights."""
    goal, kept = (
        measure_of("minimise", name, 3, None) for name in ("inertia_excitation", "non_uniformity")
    )
    x, weights = np.array([-60.0, 20.0, -7.0]), np.arange(1.0, 10.0) / 45.0
    problem = Problem(
        *(truck, LOW, HIGH, HIGH - LOW, goal, (kept,), np.array([0.01]), rms, weights, None, True)
    )
    program = _Program(problem, x, 0.02, excess, np.array([True, False, True]))
    y = np.array([0.01, -0.02] if program.rms else [0.01, -0.02, 0.7])
    vectors = goal.vectors(truck(program.moved(y)))
    sums = np.abs(vectors) ** 2 / 0.02**2
    squared = float(weights @ np.mean(sums, axis=-1)) if rms else float(np.max(sums))
    assert problem.size([vectors]) == pytest.approx(0.02 * np.sqrt(squared))
    if program.rms:
        assert program.goal(y) == pytest.approx(float(weights @ np.mean(sums, axis=-1)))
    elif excess:
        assert np.min(program.margins(y)) < 0.7 - np.max(program.terms(y)[0][1]) + 1e-12
    else:
        assert np.min(program.margins(y)[: sums.size]) == pytest.approx(0.7 - np.max(sums))
    for i, step in enumerate(1e-6 * np.eye(len(y))):
        ends = [
            (program.goal(y + sign * step), program.margins(y + sign * step)) for sign in (1, -1)
        ]
        slope = (ends[0][0] - ends[1][0]) / 2e-6
        assert program.goal_slope(y)[i] == pytest.approx(slope, rel=1e-5, abs=1e-8)
        slopes = (ends[0][1] - ends[1][1]) / 2e-6
        scale = max(1.0, float(np.max(np.abs(slopes))))
        np.testing.assert_allclose(program.margin_slopes(y)[:, i], slopes, atol=1e-6 * scale)


def test_several_starts_leave_a_local_optimum() -> None:
    def phased(x: NDArray[np.float64]) -> Driveline:
        return truck(np.array([-86.0, x[0], 0.0]))

    one, many = (
        cardan.optimise(phased, [30.0], phases=[0], degrees=True, starts=n) for n in (1, 8)
    )
    assert many.value < 0.9 * one.value


def test_weights_shift_the_mean() -> None:
    weights = np.zeros(9)
    weights[7] = 2.0
    best = cardan.optimise(truck, START, BOUNDS, over="rms", weights=weights, **PHASES)
    alone = cardan.optimise(lambda x: truck(x)[7], START, BOUNDS, **PHASES)
    assert best.per_state[7] <= 1e-3
    assert alone.value <= 1e-3


def test_the_same_seed_finds_the_same() -> None:
    one, other = (cardan.optimise(truck, START, BOUNDS, seed=4, **PHASES) for _ in range(2))
    assert np.array_equal(one.x, other.x)


def test_a_rounded_result_has_the_figures_of_the_rounded_variables() -> None:
    best = cardan.optimise(truck, START, BOUNDS, decimals=0, **PHASES)
    assert np.array_equal(best.x, np.round(best.x))
    assert best.value == pytest.approx(float(largest(best.x)), rel=1e-12)


def test_a_rounded_result_stays_within_its_bounds_and_names_its_states() -> None:
    best = cardan.optimise(
        lambda x: Driveline.from_bends([[x[0]], [0.97 * x[0]]]),
        [0.01],
        [(0.0, 0.1236)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        decimals=3,
    )
    assert best.x == [0.1236]
    kept = cardan.optimise(
        lambda x: Driveline.from_bends([[x[0]], [0.97 * x[0]]]),
        [0.01],
        [(0.0, 0.5)],
        minimise=lambda line: 1.0 - line.bends[..., 0],
        keep={"equivalent_bend": 0.3},
    )
    (active,) = kept.active
    assert active.states == (0,)


def test_what_is_best_already_stays() -> None:
    line = Driveline.from_bends([10, 10], degrees=True)
    best = cardan.optimise(lambda x: line.with_phases(x), [0.0], [(-0.1, 0.1)])
    assert best.x.tolist() == [0.0]
    assert best.value == best.before
    assert best.message == "no bound and no limit keeps it from being better"


def one_phase(x: NDArray[np.float64]) -> Driveline:
    return Driveline.from_bends([0.1, 0.1], [0.0], x)


def asked(**arguments: Any) -> cardan.Optimum:  # noqa: ANN401
    given = {"lines_of": one_phase, "start": [0.5], "bounds": [(-1.0, 1.0)], **arguments}
    return cardan.optimise(**given)


test_bad_input = refusals(
    {
        "start has shape (1, 1); it must be one number per variable": {"start": [[0.0]]},
        "start[0] is nan; it must be finite": {"start": [np.nan]},
        "start[0] is 2; it must lie within its bounds [-1, 1]": {"start": [2.0]},
        "bounds[0] is [1, -1]; the first must be below the second": {"bounds": [(1, -1)]},
        "bounds has shape (2, 2); it must be (1, 2), a pair per": {"bounds": [(0, 1)] * 2},
        "over is 'all'; it must be 'largest' or 'rms'": {"over": "all"},
        "minimise is 'bend'; ": {"minimise": "bend"},
        "minimise is 'torque_1_peak'; it needs a load": {"minimise": "torque_1_peak"},
        "minimise returned shape (2,); it must return": {"minimise": lambda line: [0.0, 1.0]},
        "minimise is 'inertia_excitation'; one joint has no shaft between two joints": {
            "minimise": "inertia_excitation",
            "lines_of": lambda x: Driveline.from_bends(x),
        },
        "speed has shape (2,); there are 1 states": {"speed": [1.0, 2.0]},
        "speed is 0.0; it must be finite and not 0": {"speed": 0.0},
        "states has 2 names; there are 1 states": {"states": ["a", "b"]},
        "weights go with over='rms'; the largest needs none": {"weights": [1.0]},
        "weights[0] is -1.0; it must be finite and not": {"over": "rms", "weights": [-1.0]},
        "weights are all 0; at least one must be positive": {"over": "rms", "weights": [0.0]},
        "weights has shape (2,); it must be (1,)": {"over": "rms", "weights": [1, 1]},
        "keep['non_uniformity'] is 0; a limit must be a pos": {"keep": {"non_uniformity": 0}},
        "keep['equivalent_bend'] is 2; a limit must be a ": {"keep": {"equivalent_bend": 2}},
        "phases[0] is 1; there are 1 variables, counted from 0": {"phases": [1]},
        "phases[1] is 0 again; name each once": {"phases": [0, 0]},
        "teeth has length 2; there are 1 phases": {"phases": [0], "teeth": [3, 4]},
        "teeth is 0; it must be at least 1": {"phases": [0], "teeth": 0},
        "parameters has length 0; there are 1 variables": {"parameters": []},
        "parameters[0, 1] is 1; index 1 is out of bounds": {"parameters": [("phases", 1)]},
        "parameters[0, 0] is 'speed'; ": {"parameters": [("speed", 0)]},
        "jac does not go with parameters, which say the same": {
            "parameters": [("phases", 0)],
            "jac": lambda x: np.zeros((1, 1)),
        },
        "starts is 0; it must be at least 1": {"starts": 0},
        "lines_of returned a batch (1, 1); ": {
            "lines_of": lambda x: Driveline.from_bends([[[0.1]]])
        },
        "jac returned shape (2, 1); it must be states by": {"jac": lambda x: np.zeros((2, 1))},
        "lines_of returned a batch (); ": {
            "vectorised": True,
            "lines_of": lambda x: one_phase(x[0]),
        },
    },
    asked,
)


test_wrong_types = refusals(
    {
        "TypeError: minimise is 3; it must be a name or a function of a driveline": {"minimise": 3},
        "TypeError: starts is 2.5; it must be an integer": {"starts": 2.5},
        "TypeError: lines_of returned ndarray; it must return a Driveline": {
            "lines_of": lambda x: x
        },
    },
    asked,
)


def test_errors_of_the_start_are_those_of_the_driveline() -> None:
    with pytest.raises(ArgumentValueError, match=r"^bends\[0\] is 2\.0 rad; a bend must lie in"):
        cardan.optimise(lambda x: Driveline.from_bends(x), [2.0])


@pytest.mark.parametrize("seed", [16, 20])
def test_a_zero_inside_the_bounds_is_found_and_no_bound_is_blamed(seed: int) -> None:
    """Compensation is a curve in three variables; the solver meets a bound beside it."""
    random = np.random.default_rng(seed)
    n = int(random.integers(3, 5))
    steps = np.c_[random.uniform(0.3, 1.5, n + 1), random.uniform(-0.2, 0.2, (n + 1, 2))]
    points = np.cumsum(np.r_[np.zeros((1, 3)), steps], axis=0)
    phases = np.radians(random.uniform(-90.0, 90.0, n - 1))

    def lines_of(x: NDArray[np.float64]) -> Driveline:
        moved, turned = points.copy(), phases.copy()
        moved[2, 2] += x[0]
        turned[:2] += x[1:]
        return Driveline.from_points(moved[np.newaxis], turned[np.newaxis])

    best = cardan.optimise(
        lines_of,
        np.zeros(3),
        [(-0.1, 0.1), (-2.0, 2.0), (-2.0, 2.0)],
        parameters=[("points", (2, 2)), ("phases", 0), ("phases", 1)],
    )
    # A ``q`` of the order of rounding has an equivalent bend of twice its root.
    assert best.value < 1e-7
    assert best.active == ()
    assert best.message == "no bound and no limit keeps it from being better"


@pytest.mark.parametrize("over", ["largest", "rms"])
def test_a_bound_that_holds_nothing_is_not_a_reason(over: Literal["largest", "rms"]) -> None:
    def lines_of(x: NDArray[np.float64]) -> Driveline:
        return Driveline.from_bends([[0.1, 0.2 + x[0]], [0.12, 0.2 + x[0]]])

    for low, held in ((-0.05, [0]), (-0.15, [])):
        best = cardan.optimise(lines_of, [0.0, 1.0], [(low, 0.3), (0.0, 1.0)], over=over, starts=1)
        # The second variable stands at its upper bound and changes nothing.
        assert best.x[1] == pytest.approx(1.0, abs=1e-9)
        assert [found.variable for found in best.active] == held
