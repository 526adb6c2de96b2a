"""Torsional vibration against integrated equations, exact series and balances."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

import cardan
from cardan import reference
from cardan.reference import torsion
from oracle import read
from refusals import refusals

CASES: list[dict[str, Any]] = read("torsion.json")["cases"]
NAMES = [f"{case['case']} at {case['speed']:.4g}" for case in CASES]
INF = float("inf")


def system_of(case: dict[str, Any]) -> cardan.TorsionalSystem:
    # The data have the turn of every intermediate shaft, p = phase - twist + 90 degrees.
    turns = np.array(case["p"][: len(case["bends"]) - 1])
    line = cardan.Driveline.from_bends(case["bends"], 0.0, turns - np.pi / 2 if turns.size else 0.0)
    return cardan.TorsionalSystem(
        line,
        inertias=case["J"],
        drive="held",
        stiffnesses=[INF if k is None else k for k in case["k"]],
        dampings=case["d"],
        load_torque=case["TL"],
        load_damping=case["bL"],
    )


def one_joint(
    bend: float,
    stiffnesses: list[float],
    **options: Any,  # noqa: ANN401
) -> cardan.TorsionalSystem:
    """One joint before a flywheel of 0.05 kg m2."""
    line = cardan.Driveline.from_bends([bend], degrees=True)
    inertias = [[0.0, 0.0], [0.0, 0.05]]
    return cardan.TorsionalSystem(line, inertias=inertias, stiffnesses=stiffnesses, **options)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_steady_state_is_that_of_the_integrated_equations(case: dict[str, Any]) -> None:
    found = system_of(case).steady(case["speed"])
    largest = np.maximum(np.abs(case["torque_min"]), np.abs(case["torque_max"]))
    assert found.found
    assert np.all(np.abs(found.torque_mean - case["torque_mean"]) < 1e-8 * largest)
    for i, order in enumerate((2, 4)):
        amplitudes = np.abs(found.torque_orders[..., i])
        assert np.all(np.abs(amplitudes - case[f"torque_order{order}"]) < 1e-8 * largest)
    angle = np.abs(found.angle_orders[-1, 1])
    assert angle[0] == pytest.approx(case["last_angle_order2"], rel=1e-8)
    assert abs(angle[1] - case["last_angle_order4"]) < 1e-8 * angle[0]
    speed = np.abs(found.speed_orders[-1, 1, 0])
    assert speed == pytest.approx(case["last_speed_order2"], rel=1e-8)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_orbits_have_the_sampled_extremes(case: dict[str, Any]) -> None:
    system = system_of(case)
    orbit = system.orbit(case["speed"], 256)
    largest = np.maximum(np.abs(case["torque_min"]), np.abs(case["torque_max"]))
    assert np.all(np.abs(orbit.torque.min(axis=-1) - case["torque_min"]) < 1e-8 * largest)
    assert np.all(np.abs(orbit.torque.max(axis=-1) - case["torque_max"]) < 1e-8 * largest)
    # The true extremes lie beyond those of any samples, and dense samples come near them.
    steady = system.steady(case["speed"])
    dense = system.orbit(case["speed"], 20_000).torque
    assert np.all(steady.torque_max >= dense.max(axis=-1) - 1e-12 * largest)
    assert np.all(steady.torque_max <= dense.max(axis=-1) + 1e-6 * largest)
    assert np.all(steady.torque_min <= dense.min(axis=-1) + 1e-12 * largest)
    assert np.all(steady.torque_min >= dense.min(axis=-1) - 1e-6 * largest)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_multipliers_are_those_of_the_integrated_variation(case: dict[str, Any]) -> None:
    found = system_of(case).stability(case["speed"])
    moduli = np.abs(found.multipliers)
    # The accuracy of the integration: 6e-8 for the strongly damped pairs.
    assert moduli == pytest.approx(sorted(case["multipliers_abs"], reverse=True), abs=1e-7)
    assert found.stable == (max(case["multipliers_abs"]) < 1.0)


@pytest.mark.parametrize("case", [0, 5, 6])
def test_multipliers_have_the_product_of_liouville(case: int) -> None:
    # One unknown of constant inertia: the state's volume shrinks by exp(-d/J) per second.
    for data in (data for data in CASES if data["case"] == case):
        inertia = data["J"][1][1]
        damping = data["d"][1] + data["bL"]
        expected = np.exp(-damping / inertia * np.pi / data["speed"])
        product = np.prod(system_of(data).stability(data["speed"]).multipliers)
        assert product == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("speed", [0.25, 0.5, 0.9])
def test_a_joint_before_the_only_spring_is_the_exact_series(speed: float) -> None:
    system = one_joint(20.0, [INF, 8000.0], damping_ratios=0.02)
    stiffness, inertia, natural = 8000.0, 0.05, 400.0
    damping = 2 * 0.02 * np.sqrt(stiffness * inertia)
    assert system.dampings[1] == pytest.approx(damping, rel=1e-14)
    drive = speed * natural
    orbit = system.orbit(drive, 4096)
    twist = orbit.angle_error[1, 1] - orbit.angle_error[1, 0]
    expected = {0.25: 0.022458264, 0.5: 0.777298573, 0.9: 0.044977174}[speed]
    assert np.abs(twist).max() == pytest.approx(expected, rel=2e-6)
    # theta - F is the sum of Im(X exp(2 i n (angle + offset))); the offset of one joint is 0.
    steady = system.steady(drive, orders=[2, 4, 6])
    for i, n in enumerate((1, 2, 3)):
        rate, k = 2 * n * drive, np.tan(np.radians(10.0)) ** 2
        spring = stiffness + rate * damping * 1j
        x = k**n / n * rate**2 * inertia / (spring - rate**2 * inertia)
        # -Im(z) is Re(i z).
        expected_order = 1j * spring * x
        error = abs(steady.torque_orders[0, i] - expected_order)
        # The default tolerance.
        assert error < 1e-9 * np.abs(steady.torque_max[0])


@pytest.mark.parametrize("damping_ratio", [0.01, 0.5])
def test_stiff_shafts_follow_slow_drives(damping_ratio: float) -> None:
    # From 30 to 30 000 free vibrations within a turn, between resonances; the largest torque is
    # that of the inertia of the rigid shaft, J dr/dt.
    natural, bend = 400.0, np.radians(20.0)
    system = one_joint(20.0, [INF, 8000.0], damping_ratios=damping_ratio)
    speeds = natural / np.array([31.0, 301.0, 3001.0, 30001.0])
    found = system.steady(speeds)
    assert found.found.all()
    angle = np.linspace(0.0, np.pi, 100_001)
    below = np.cos(bend) ** 2 * np.cos(angle) ** 2 + np.sin(angle) ** 2
    slope = np.cos(bend) * np.sin(bend) ** 2 * np.sin(2 * angle) / below**2
    rigid = 0.05 * speeds**2 * np.abs(slope).max()
    assert found.torque_max[0] == pytest.approx(rigid, rel=0.02)
    assert found.torque_max[0, 1:] == pytest.approx(rigid[1:], rel=3e-4)


def test_edges_of_the_first_region_of_instability() -> None:
    # A compliant driving shaft, 20 degrees, a flywheel, no damping: Whittaker-Hill's equation.
    system = one_joint(20.0, [8000.0, INF])
    edges = np.array([[0.96761, 0.96763], [1.02996, 1.02994]]) * 400.0
    assert system.stability(edges).stable.tolist() == [[True, False], [True, False]]
    # Linearised about rigid rotation the region would lie at 0.97157 to 1.03375.
    assert not system.stability(0.9700 * 400.0).stable
    assert system.stability(1.0320 * 400.0).stable


def test_instability_needs_more_bend_than_damping() -> None:
    ratio = np.tan(np.radians(10.0)) ** 2
    speeds = np.linspace(0.95, 1.05, 201) * 400.0
    for factor, stable in ((0.9, False), (1.1, True)):
        system = one_joint(20.0, [8000.0, INF], dampings=[2 * factor * ratio * 20.0, 0.0])
        assert system.stability(speeds).stable.all() == stable


@pytest.mark.parametrize("case", [c for c in CASES if c["case"] in (2, 3, 5)], ids=str)
def test_power_is_balanced_over_a_period(case: dict[str, Any]) -> None:
    system = system_of(case)
    orbit = system.orbit(case["speed"], 256)
    power = 0.0
    for torque, shaft in zip(orbit.torque, system.compliant, strict=True):
        slip = orbit.speed[shaft, 0] - orbit.speed[shaft, 1]
        power += case["d"][shaft] * np.mean(slip**2)
        scale = np.abs(torque).max() * case["speed"]
    last = orbit.speed[-1, 1]
    power += np.mean((case["TL"] + case["bL"] * last) * last)
    # The first compliant shaft takes in all power that is not needed before it.
    given = np.mean(orbit.torque[0] * orbit.speed[system.compliant[0], 0])
    assert given == pytest.approx(power, abs=1e-10 * scale)


def test_fast_vibrations_need_finer_intervals_than_the_angles() -> None:
    # The last shaft vibrates a hundred times faster than the drive turns, and damping couples it to
    # the slopes. Intervals that suit the angles alone leave errors of 1e-7.
    line = cardan.Driveline.from_bends([20.5, 16.1, 27.7], phases=[80.0, 96.5], degrees=True)
    system = cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.019], [0.031, 0.0035], [0.009, 0.0244], [0.003, 0.055]],
        stiffnesses=[2200.0, 13_400.0, INF, 92_800.0],
        damping_ratios=0.49,
        load_torque=-49.0,
        load_damping=0.3,
    )
    speeds = np.array([40.0, 88.0, 430.0, 510.0])
    found, exact = (system.steady(speeds, tolerance=x) for x in (1e-9, 1e-12))
    largest = np.maximum(np.abs(exact.torque_min), np.abs(exact.torque_max))
    for name in ("torque_min", "torque_max", "torque_mean"):
        assert np.all(np.abs(getattr(found, name) - getattr(exact, name)) < 5e-9 * largest)


def test_natural_frequencies_do_not_depend_on_the_unit_of_inertia() -> None:
    # Within the steep joint the inertia varies in many orders.
    line = cardan.Driveline.from_bends([80.0], degrees=True)
    inertias, stiffnesses = np.array([[0.0, 0.01], [0.05, 0.0]]), np.array([8000.0, INF])
    found = [
        cardan.TorsionalSystem(line, inertias=unit * inertias, stiffnesses=unit * stiffnesses)
        for unit in (1.0, 2.0**-30)
    ]
    one, other = (system.natural_frequencies()[0] for system in found)
    assert one == pytest.approx(other, rel=1e-12)


def test_natural_frequencies_of_two_masses() -> None:
    # Straight joints: two springs in series with two flywheels, by the quadratic equation.
    line = cardan.Driveline.from_bends([0.0, 0.0])
    system = cardan.TorsionalSystem(
        line, inertias=[[0.0, 0.0], [0.0, 0.2], [0.1, 0.3]], stiffnesses=[INF, 5000.0, 9000.0]
    )
    j1, j2, c1, c2 = 0.3, 0.3, 5000.0, 9000.0
    sum_, product = (c1 + c2) / j1 + c2 / j2, c1 * c2 / (j1 * j2)
    root = np.sqrt(sum_**2 - 4 * product)
    expected = np.sqrt([(sum_ - root) / 2, (sum_ + root) / 2])
    assert system.natural_frequencies() == pytest.approx(expected, rel=1e-12)
    assert system.critical_speeds([2, 6]) == pytest.approx(expected[:, None] / [2, 6], rel=1e-12)
    assert system.critical_speeds(1)[:, 0] == pytest.approx(expected, rel=1e-12)


def test_inertias_of_shafts_are_split_in_half() -> None:
    line = cardan.Driveline.from_bends([0.3])
    of: dict[str, Any] = {"stiffnesses": [INF, 4000.0], "dampings": 0.5, "drive": "held"}
    halves = cardan.TorsionalSystem(line, inertias=[[0.1, 0.1], [0.2, 0.2]], **of)
    whole = cardan.TorsionalSystem(line, inertias=[0.2, 0.4], **of)
    assert whole.steady(90.0).torque_max.tolist() == halves.steady(90.0).torque_max.tolist()


def test_a_batch_is_its_members() -> None:
    bends = np.array([[0.1, 0.2], [0.3, 0.05], [0.2, 0.2]])
    stiffnesses = np.array([[INF, 9000.0, 7000.0], [INF, 5000.0, 8000.0]])[:, None]
    inertias = [[0.0, 0.0], [0.01, 0.02], [0.0, 0.1]]
    speeds = np.array([40.0, 130.0, 400.0])[:, None, None]
    of: dict[str, Any] = {"dampings": [0.0, 0.8, 0.4], "load_torque": 50.0}
    line = cardan.Driveline.from_bends(bends)
    system = cardan.TorsionalSystem(line, inertias=inertias, stiffnesses=stiffnesses, **of)
    assert system.shape == (2, 3)
    found = system.steady(speeds, orders=[2, 3, 4, 8])
    assert found.torque_mean.shape == (2, 3, 2, 3)
    assert found.torque_orders.shape == (2, 3, 2, 3, 4)
    assert found.angle_orders.shape == (3, 2, 3, 2, 3, 4)
    orbit = system.orbit(speeds, 5)
    assert orbit.torque.shape == (2, 3, 2, 3, 5)
    multipliers = system.stability(speeds).multipliers
    assert multipliers.shape == (3, 2, 3, 4)
    assert system.natural_frequencies().shape == (2, 3, 2)
    alone = cardan.TorsionalSystem(
        cardan.Driveline.from_bends(bends[2]),
        inertias=inertias,
        stiffnesses=stiffnesses[1, 0],
        **of,
    )
    one = alone.steady(130.0, orders=[2, 3, 4, 8])
    place = (1, 1, 2)
    assert one.torque_min.tolist() == found.torque_min[:, *place].tolist()
    assert one.torque_orders.tolist() == found.torque_orders[:, *place].tolist()
    assert one.angle_orders.tolist() == found.angle_orders[:, :, *place].tolist()
    assert not np.any(one.torque_orders[:, 1])
    assert alone.orbit(130.0, 5).speed.tolist() == orbit.speed[:, :, *place].tolist()
    assert alone.stability(130.0).multipliers.tolist() == multipliers[place].tolist()
    single = system.steady(speeds, orders=[2, 3, 4, 8], workers=1)
    assert single.torque_orders.tolist() == found.torque_orders.tolist()


@pytest.mark.parametrize("before", [True, False])
def test_rigid_shafts_and_joints_fold_to_one_joint(before: bool) -> None:
    # Massless shafts before or behind the compliant one act as their equivalent joint; the turn of
    # that joint shifts the phases of all orders and nothing else.
    chain = cardan.Driveline.from_bends([12, 9, 15, 7], phases=[40, -23, 10], degrees=True)
    single = cardan.Driveline.from_bends([float(chain.equivalent().bend)])
    found = []
    for line in (chain, single):
        shafts = line.n_joints + 1
        inertias, stiffnesses = np.zeros((shafts, 2)), np.full(shafts, INF)
        inertias[-1, 1] = 0.05
        stiffnesses[-1 if before else 0] = 8000.0
        system = cardan.TorsionalSystem(
            line, inertias=inertias, stiffnesses=stiffnesses, damping_ratios=0.02, load_torque=40.0
        )
        assert len(system.compliant) == 1
        speeds = np.array([60.0, 190.0, 400.0])
        steady = system.steady(speeds, [2, 4, 6])
        moduli = np.abs(system.stability(speeds).multipliers)
        found.append((steady.torque_min, steady.torque_max, np.abs(steady.torque_orders), moduli))
    for mine, theirs in zip(*found, strict=True):
        assert mine == pytest.approx(theirs, rel=1e-8, abs=1e-8 * np.abs(theirs).max())


def test_an_empty_batch_has_empty_results() -> None:
    system = system_of(CASES[12])
    assert system.steady(np.zeros((0,))).torque_orders.shape == (2, 0, 2)
    assert system.stability(np.zeros((0, 3))).multipliers.shape == (0, 3, 4)


def test_speeds_without_an_orbit_are_named() -> None:
    # No damping at the resonance of a linear system: the amplitude grows without bound.
    system = one_joint(20.0, [INF, 8000.0])
    speeds = [100.5, 200.0, np.nan, -3.0, 0.0, INF]
    found = system.steady(speeds)
    assert found.found.tolist() == [True, False, False, False, False, False]
    assert np.isfinite(found.torque_max[0]).tolist() == found.found.tolist()
    assert np.isfinite(found.angle_orders).all(axis=(0, 1, 3)).tolist() == found.found.tolist()
    no_speed = "the speed is not a positive finite number"
    none = "no periodic orbit was found from rigid shafts, even rotation or growing bends"
    reasons = ["", none, *4 * [no_speed]]
    assert found.reasons.tolist() == reasons
    stability = system.stability(speeds)
    assert stability.reasons.tolist() == reasons
    assert stability.stable.tolist() == [True, *5 * [False]]


LINE = cardan.Driveline.from_bends([0.2, 0.1])
GOOD: dict[str, Any] = {
    "inertias": np.full((3, 2), 0.1),
    "stiffnesses": [INF, 4000.0, INF],
    "drive": "held",
}


test_wrong_systems_are_refused = refusals(
    {
        "inertias[1] is -0.1; it must be finite and not": {"inertias": [0.1, -0.1, 0.1]},
        "inertias has shape (2,); it needs one per shaft, ": {"inertias": [0.1, 0.1]},
        "inertias[1, 1] is 0.0, and so is every inertia that is rigidly connected": {
            "inertias": [[0.1, 0.1], [0.1, 0.0], [0.0, 0.0]]
        },
        "stiffnesses[1] is 0.0; a stiffness must be": {"stiffnesses": [INF, 0.0, INF]},
        "stiffnesses[1] is nan; a stiffness must be": {"stiffnesses": [INF, np.nan, INF]},
        "stiffnesses are all infinite; at least one shaft must be": {"stiffnesses": INF},
        "stiffnesses[1, 2] is 5000.0; the same shafts must be compliant": {
            "stiffnesses": [[INF, 4000.0, INF], [INF, 4000.0, 5000.0]]
        },
        "stiffnesses has shape (2,); 3 shafts need": {"stiffnesses": [4000.0, 1.0]},
        "dampings[1] is -1.0; it must be finite and not neg": {"dampings": [0.0, -1.0, 0.0]},
        "damping_ratios[1] is inf; it must be finite": {"damping_ratios": [0.0, INF, 0.0]},
        "dampings and damping_ratios are both given": {"dampings": 1.0, "damping_ratios": 0.1},
        "damping_ratios has the batch (2,), the system ()": {
            "damping_ratios": np.full((2, 3), 0.1)
        },
        "load_torque[1] is nan; it must be finite": {"load_torque": [1.0, np.nan]},
        "load_damping is -0.5; it must be finite and not negative": {"load_damping": -0.5},
    },
    lambda **wrong: cardan.TorsionalSystem(LINE, **(GOOD | wrong)),
)


def test_the_batch_of_a_missing_inertia_is_named() -> None:
    inertias = np.full((4, 3, 2), 0.1)
    inertias[2, 1, 1] = inertias[2, 2] = 0.0
    with pytest.raises(cardan.ArgumentValueError, match=r"inertias\[2, 1, 1\] is 0\.0"):
        cardan.TorsionalSystem(LINE, **(GOOD | {"inertias": inertias}))


SYSTEM = cardan.TorsionalSystem(LINE, **GOOD)

test_wrong_calls_are_refused = refusals(
    {
        "orders[1] is 0.0; an order must": lambda: SYSTEM.steady(100.0, orders=[2, 0]),
        "TypeError: speed has dtype": lambda: SYSTEM.steady("fast"),
        "tolerance is 0.0; it must be from": lambda: SYSTEM.steady(100.0, tolerance=0.0),
        "samples is 0; it must be at least 1": lambda: SYSTEM.orbit(100.0, 0),
        "TypeError: samples is 2.0; it must be an integer": lambda: SYSTEM.orbit(100.0, 2.0),  # type: ignore[arg-type]
        "workers is 0": lambda: SYSTEM.stability(100.0, workers=0),
        "workers is 0; it must be positive": lambda: SYSTEM.steady(100.0, workers=0),
        "TypeError: line is 3; it must be a drivel": lambda: cardan.TorsionalSystem(
            cast("Any", 3), **GOOD
        ),
    }
)


def test_a_large_orbit_within_a_resonance_is_periodic() -> None:
    # Between the folds of the resonance only an orbit of some 2 rad is left. Integrated from its
    # start by the reference, it closes after half a turn.
    bends, drive = np.radians([30.0, 30.0]), 147.0
    own: dict[str, Any] = {
        "inertias": [(0.0, 0.0), (0.0, 0.004), (0.1, 0.0)],
        "stiffnesses": [INF, 9000.0, INF],
        "dampings": [0.0, 0.8, 0.0],
        "load_torque": 20.0,
    }
    system = cardan.TorsionalSystem(cardan.Driveline.from_bends(bends), **own)
    orbit = system.orbit(drive, 4)
    assert orbit.found
    slow = torsion.System(reference.from_bends(bends.tolist()), **own)
    zero = torsion.zero_of(slow, 1)
    start = np.array([0.0, orbit.angle_error[1, 1, 0] + zero, drive, orbit.speed[1, 1, 0]])
    states = torsion.period(slow, drive, start, 1000)
    angles = np.arange(1, 1001) * np.pi / 1000
    assert np.max([abs(state[1] - a - zero) for a, state in zip(angles, states, strict=True)]) > 1.5
    assert states[-1] - [np.pi, np.pi, 0.0, 0.0] == pytest.approx(start, abs=1e-7 * drive)
    assert system.stability(drive).stable


def test_a_flywheel_is_accelerated_by_the_torque_of_its_shaft() -> None:
    line = cardan.Driveline.from_bends([20.0], degrees=True)
    inertia, speed = 0.05, 150.0
    system = cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.0, inertia]],
        stiffnesses=[np.inf, 8000.0],
        dampings=[0.0, 2.0],
    )
    found = system.steady(speed)
    assert found.found
    rates = 1j * found.orders * speed
    wanted = np.max(np.abs(found.torque_orders[0]))
    residual = inertia * rates * found.speed_orders[-1, 1] - found.torque_orders[0]
    assert np.max(np.abs(residual)) < 1e-8 * wanted


def slow_and_stiff(seed: int) -> cardan.TorsionalSystem:
    """The driveline of 30 and 35 degrees of seed 0, others at random, with compliant shafts."""
    if seed == 0:
        line = cardan.Driveline.from_bends([30.0, 35.0], [20.0], [70.0], degrees=True)
        return cardan.TorsionalSystem(
            line,
            inertias=np.full((3, 2), 0.01),
            drive="held",
            stiffnesses=[INF, 1e4, INF],
            damping_ratios=0.5,
        )
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 6))
    bends, turns = random.uniform(5.0, 60.0, n), random.uniform(-180.0, 180.0, (2, n - 1))
    stiffnesses = np.where(random.random(n + 1) < 0.6, 1e5, INF)
    stiffnesses[random.integers(n + 1)] = 1e5
    return cardan.TorsionalSystem(
        cardan.Driveline.from_bends(bends, *turns, degrees=True),
        inertias=np.full((n + 1, 2), 0.01),
        drive="held",
        stiffnesses=stiffnesses,
        damping_ratios=0.5,
    )


@pytest.mark.parametrize("seed", [0, *range(2, 12)])
def test_without_load_and_vibration_angles_are_those_of_rigid_shafts(seed: int) -> None:
    """Also behind compliant shafts between joints, where means of parts do not add up."""
    system = slow_and_stiff(seed)
    line, speed = system.line, 3e-3 * float(system.natural_frequencies()[0])
    orbit = system.orbit(speed, 64)
    start = system.transient([0.0, 1e-3 / speed], speed=speed).angle_error[..., 0]
    for shaft in range(line.n_joints + 1):
        known: Any = np.zeros(64)
        if shaft:
            part = slice(shaft - 1)
            own = cardan.Driveline.from_bends(
                line.bends[:shaft], line.twists[part], line.phases[part]
            )
            known = own.evaluate(orbit.drive_angle, "angle_error").angle_error
        for side in (0, 1):
            assert orbit.angle_error[shaft, side] == pytest.approx(known, abs=1e-4)
            assert start[shaft, side] == pytest.approx(known[0], abs=1e-12)
        assert abs(np.mean(orbit.angle_error[shaft])) < 2e-5
