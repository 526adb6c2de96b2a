"""Couplings with kinks against an independent model, integrations in time and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import cardan
from engine_cases import CASES, INF, KINKED, arguments_of, complexes, phases_of
from refusals import refusals

# Of two orbits at one speed, ``steady`` returns the lower one.
UPPER, LOWER = 35, 36


def system_of(case: dict[str, Any]) -> cardan.TorsionalSystem:
    line = cardan.Driveline.from_bends(case["bends"], 0.0, phases_of(case))
    return cardan.TorsionalSystem(line, **arguments_of(case))


def expected_multipliers(case: dict[str, Any]) -> list[complex]:
    """Without the one of a shift in time of a free drive."""
    found = [complex(*multiplier) for multiplier in case["multipliers"]]
    if case.get("free", True):
        found.remove(min(found, key=lambda x: abs(x - 1.0)))
    return found


def distance(found: NDArray[np.complex128] | list[complex], expected: list[complex]) -> float:
    """The largest distance of multipliers, each from its nearest one."""
    left = [complex(x) for x in found]
    assert len(left) == len(expected)
    largest = 0.0
    for one in expected:
        nearest = min(left, key=lambda x: abs(x - one))
        left.remove(nearest)
        largest = max(largest, abs(nearest - one))
    return largest


@pytest.mark.parametrize("number", [number for number in KINKED if number != UPPER])
def test_steady_state_is_that_of_the_independent_model(number: int) -> None:
    case = CASES[number]
    orders = [float(order) for order in case["torque_orders"][0]]
    system = system_of(case)
    found = system.steady(case["speed"], orders, tolerance=1e-11)
    assert found.found
    largest = np.max(np.abs([case["torque_min"], case["torque_max"]]))
    for value, name in (
        (found.torque_mean, "torque_mean"),
        (found.torque_min, "torque_min"),
        (found.torque_max, "torque_max"),
        (found.drive_torque_mean, "drive_torque_mean"),
    ):
        assert np.max(np.abs(value - case[name])) < 1e-9 * largest, name
    # The data begin where the drive's angle is 0.
    turned = np.exp(-1j * np.array(orders) * (case.get("drive_angle_mean") or 0.0))
    of_torque = np.array([complexes(of) for of in case["torque_orders"]])
    assert np.max(np.abs(found.torque_orders - of_torque * turned)) < 1e-9 * largest
    of_angle = np.array(complexes(case["last_angle_orders"]))
    assert np.max(np.abs(found.angle_orders[-1, 1] - of_angle * turned)) < 1e-10
    if system.drive == "free":
        of_drive = np.array(complexes(case["drive_angle_orders"]))
        assert np.max(np.abs(found.angle_orders[0, 0] - of_drive * turned)) < 1e-10
        for value, name in (
            (found.drive_speed_min, "drive_speed_min"),
            (found.drive_speed_max, "drive_speed_max"),
        ):
            assert value == pytest.approx(case[name], rel=1e-10)


@pytest.mark.parametrize("number", [number for number in KINKED if number != UPPER])
def test_multipliers_are_those_of_the_independent_model(number: int) -> None:
    case = CASES[number]
    stability = system_of(case).stability(case["speed"], tolerance=1e-11)
    assert distance(stability.multipliers, expected_multipliers(case)) < 1e-7
    assert stability.stable == case["stable"]


def test_both_orbits_of_a_progressive_coupling_are_found() -> None:
    """The two stable ones and, between them, the one that separates them."""
    lower, upper = CASES[LOWER], CASES[UPPER]
    found = system_of(upper).coexisting(upper["speed"], 3, tolerance=1e-10)
    assert found.count == 3
    for place, case in ((0, lower), (2, upper)):
        largest = case["torque_max"][0]
        assert found.torque_max[0, place] == pytest.approx(largest, rel=1e-9)
        assert abs(found.torque_min[0, place] - case["torque_min"][0]) < 1e-9 * largest
        assert distance(found.multipliers[place], expected_multipliers(case)) < 1e-7
    assert np.abs(found.multipliers[1]).max() > 1.5


def test_slope_of_the_drive_torque_is_that_between_speeds() -> None:
    case = CASES[30]
    system, speed = system_of(case), case["speed"]
    torques = system.steady([speed - 0.01, speed + 0.01], tolerance=1e-12).drive_torque_mean
    slope = system.stability(speed).drive_torque_slope
    assert slope == pytest.approx((torques[1] - torques[0]) / 0.02, rel=1e-5)


def test_play_that_is_not_crossed_shifts_the_linear_orbit() -> None:
    case = CASES[32]
    found = system_of(case).steady(case["speed"])
    linear = system_of({**case, "curves": {}}).steady(case["speed"])
    assert found.torque_max == pytest.approx(linear.torque_max, rel=1e-9)
    assert found.torque_orders == pytest.approx(linear.torque_orders, rel=1e-9)


def test_samples_of_an_orbit_follow_its_kinks() -> None:
    case = CASES[30]
    system = system_of(case)
    found = system.steady(case["speed"])
    orbit = system.orbit(case["speed"], 4096)
    torque = orbit.torque[0]
    assert np.max(torque) == pytest.approx(found.torque_max[0], rel=1e-5)
    assert np.mean(torque) == pytest.approx(found.torque_mean[0], rel=1e-5)
    few = system.orbit(case["speed"], 64).torque[0]
    assert np.allclose(few, torque[::64], rtol=0.0, atol=1e-7 * np.max(torque))


def test_orbits_depend_neither_on_neighbours_nor_on_threads() -> None:
    system = system_of(CASES[28])
    speeds = np.linspace(120.0, 180.0, 24)
    together = system.steady(speeds, workers=2)
    for i in (0, 11, 23):
        alone = system.steady(speeds[i])
        assert np.array_equal(alone.torque_max, together.torque_max[:, i])
        assert np.array_equal(alone.torque_orders, together.torque_orders[:, i])


def coupled(**options: Any) -> cardan.TorsionalSystem:  # noqa: ANN401
    return cardan.TorsionalSystem(
        cardan.Driveline.from_bends([0.1]),
        inertias=[[0.1, 0.0], [0.0, 0.1]],
        stiffnesses=[INF, INF],
        dampings=[0.0, 1.0],
        drive="free",
        couplings={1: cardan.Coupling(**options)},
    )


test_bad_couplings_are_refused = refusals(
    {
        "both must rise": {"twist": [0.0, 0.02, 0.01], "torque": [0.0, 50.0, 80.0]},
        "and both must rise from point to point": {
            "twist": [0.0, 0.01, 0.02],
            "torque": [0.0, 50.0, 50.0],
        },
        "rise": {"twist": [-0.1, 0.0, 0.1], "torque": [-9.0, 0.0, np.nextafter(0.0, -1.0)]},
        "give one of": {"stiffness": 9e3, "twist": [0.0, 0.1], "torque": [0.0, 50.0]},
        "play and a table": {"twist": [0.0, 0.1], "torque": [0.0, 50.0], "play": 0.01},
        "neither may be negative": {"stiffness": 9e3, "play": -0.01},
        "a loss factor": {"stiffness": 9e3, "play": 0.01, "loss_factor": 0.1},
        "loss factor": {"twist": [0, 0.1, 0.2], "torque": [0, 50, 200], "loss_factor": 0.1},
        "must be positive": {"stiffness": -9e3},
    },
    coupled,
)


def test_loss_factors_are_refused_beside_kinks() -> None:
    with pytest.raises(cardan.ArgumentError, match="beside"):
        cardan.TorsionalSystem(
            cardan.Driveline.from_bends([0.1, 0.1], 0.0, 0.0),
            inertias=[[0.0, 0.0], [0.0, 0.1], [0.0, 0.1]],
            stiffnesses=[INF, INF, INF],
            dampings=[0.0, 1.0, 1.0],
            couplings={
                1: cardan.Coupling(5e3, loss_factor=0.1),
                2: cardan.Coupling(8e3, play=0.01),
            },
        )


def test_damping_in_contact_is_that_of_an_integration() -> None:
    """A flywheel behind a held drive and a coupling that rattles, until its motion repeats."""
    damping, stiffness, play, inertia, load, speed = 6.0, 8000.0, 0.02, 0.05, 20.0, 80.0
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([0.0]),
        inertias=[[0.0, 0.0], [0.0, inertia]],
        stiffnesses=[INF, INF],
        dampings=[0.0, damping],
        load_torque=load,
        drive="held",
        harmonics=[cardan.TorqueHarmonic(1, "output", 2.0, 120.0, 60.0)],
        couplings={1: cardan.Coupling(stiffness, play=play, contact_damping=True)},
    )

    def torque(state: NDArray[np.float64]) -> NDArray[np.float64]:
        beyond = state[0] - np.clip(state[0], -0.5 * play, 0.5 * play)
        return np.where(beyond == 0.0, 0.0, stiffness * beyond + damping * state[1])

    def slopes(time: float, state: NDArray[np.float64]) -> list[float]:
        angle = 2.0 * (speed * time - state[0])
        driven = 120.0 * np.cos(angle) + 60.0 * np.sin(angle)
        return [
            state[1],
            (load - driven - float(torque(state[:2]))) / inertia,
            float(torque(state)),
        ]

    period, state = np.pi / speed, np.array([0.0125, 0.0, 0.0])
    for _ in range(60):
        begun = state * [1.0, 1.0, 0.0]
        done = solve_ivp(
            slopes, (0.0, period), begun, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True
        )
        state = done.y[:, -1]
    assert np.max(np.abs(state - begun)[:2] / [1.0, speed]) < 1e-9
    torques = torque(done.sol(np.linspace(0.0, period, 100_001)))
    assert 0.05 < np.mean(torques == 0.0) < 0.95, "the coupling rattles"
    found = system.steady(speed, tolerance=1e-11)
    largest = np.max(torques)
    assert abs(found.torque_max[0] - largest) < 1e-6 * largest
    # Leaving contact, the torque jumps.
    assert abs(found.torque_min[0] - np.min(torques)) < 1e-3 * largest
    assert abs(found.torque_mean[0] - state[2] / period) < 1e-7 * largest
