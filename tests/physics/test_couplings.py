"""Couplings with kinks against an independent model, integrations in time and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import cardan
from cardan.arrays import FloatArray
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


class OneJoint:
    """A drive, one joint, a coupling with play whose damper acts in contact, and an inertia.

    Written from Newton's law of both inertias, and integrated in time from kink to kink.
    """

    bend, damping, stiffness, play = np.deg2rad(15.0), 6.0, 8000.0, 0.02
    inertias, slope, load, parts = (0.08, 0.05), 0.5, 20.0, (120.0, 60.0)

    def __init__(self, free: bool) -> None:
        self.free = free
        line = cardan.Driveline.from_bends([self.bend])
        harmonic = (
            cardan.TorqueHarmonic(0, "input", 2.0, *self.parts)
            if free
            else cardan.TorqueHarmonic(1, "output", 2.0, *self.parts)
        )
        self.system = cardan.TorsionalSystem(
            line,
            inertias=[[self.inertias[0] if free else 0.0, 0.0], [0.0, self.inertias[1]]],
            stiffnesses=[INF, INF],
            dampings=[0.0, self.damping],
            load_torque=self.load,
            drive="free" if free else "held",
            drive_slope=self.slope if free else 0.0,
            harmonics=[harmonic],
            couplings={1: cardan.Coupling(self.stiffness, play=self.play, contact_damping=True)},
        )

    def twist(self, state: FloatArray) -> tuple[float, float, float]:
        """The twist, its rate and the ratio of the joint."""
        drive, last, drive_speed, last_speed = state[:4]
        turn = np.arctan2(np.sin(drive), np.cos(self.bend) * np.cos(drive))
        turn += 2.0 * np.pi * np.round((drive - turn) / (2.0 * np.pi))
        divisor = np.sin(drive) ** 2 + (np.cos(self.bend) * np.cos(drive)) ** 2
        ratio = np.cos(self.bend) / divisor
        return turn - last, ratio * drive_speed - last_speed, ratio

    def torque(self, state: FloatArray, side: int) -> float:
        """The torque on a side of the play, or within it for 0."""
        twist, rate, _ = self.twist(state)
        if side == 0:
            return 0.0
        return self.stiffness * (twist - 0.5 * side * self.play) + self.damping * rate

    def slopes(self, state: FloatArray, side: int, speed: float, mean: float) -> FloatArray:
        """Of angles, speeds and the integral of the torque."""
        drive, last, drive_speed, last_speed = state[:4]
        torque = self.torque(state, side)
        *_, ratio = self.twist(state)
        angle = drive if self.free else last
        varying = self.parts[0] * np.cos(2.0 * angle) + self.parts[1] * np.sin(2.0 * angle)
        of_drive, on_last = 0.0, torque - self.load
        if self.free:
            of_drive = mean - self.slope * (drive_speed - speed) + varying - ratio * torque
        else:
            on_last += varying
        return np.array(
            [
                drive_speed,
                last_speed,
                of_drive / self.inertias[0],
                on_last / self.inertias[1],
                torque,
            ]
        )

    def run(
        self, state: FloatArray, time: float, speed: float, mean: float, tolerance: float = 1e-12
    ) -> tuple[FloatArray, FloatArray]:
        """The state after a time, and the torques on the way."""
        state, now, torques = np.append(state, 0.0), 0.0, []
        twist, *_ = self.twist(state)
        side = int(np.sign(twist)) if abs(twist) > 0.5 * self.play else 0
        while now < time:
            events = []
            for bound in {0: (-1, 1), 1: (1,), -1: (-1,)}[side]:

                def meets(_: float, at: FloatArray, bound: int = bound) -> float:
                    return self.twist(at)[0] - 0.5 * bound * self.play

                meets.terminal = True  # type: ignore[attr-defined]
                # Only outwards: the motion begins on a kink.
                meets.direction = float(bound if side == 0 else -bound)  # type: ignore[attr-defined]
                events.append(meets)
            done = solve_ivp(
                lambda _, at, side=side: self.slopes(at, side, speed, mean),
                (now, time),
                state,
                method="DOP853",
                rtol=tolerance,
                atol=tolerance,
                events=events,
                dense_output=True,
            )
            times = np.linspace(now, done.t[-1], 400)
            torques.append([self.torque(at, side) for at in done.sol(times).T])
            state, now = done.y[:, -1], done.t[-1]
            if done.status == 1:
                hit = next(i for i, found in enumerate(done.t_events) if found.size)
                side = ((-1, 1)[hit]) if side == 0 else 0
        return state, np.array(torques)


def peak(values: FloatArray) -> float:
    """The largest value between equally spaced ones, by parabolas."""
    i = int(np.argmax(values))
    if i in (0, len(values) - 1):
        return float(values[i])
    before, here, after = values[i - 1 : i + 2]
    return float(here - (after - before) ** 2 / (8.0 * (before - 2.0 * here + after)))


@pytest.mark.parametrize("free", [True, False])
def test_orbit_with_damping_in_contact_is_that_of_an_integration(free: bool) -> None:
    model, speed = OneJoint(free), 80.0
    found = model.system.steady(speed, tolerance=1e-11)
    mean = float(found.drive_torque_mean)
    orbit = model.system.orbit(speed, 1, tolerance=1e-11)
    last = (-1, 1, 0)
    start = np.array(
        [
            orbit.angle_error[0, 0, 0],
            orbit.angle_error[last],
            orbit.speed[0, 0, 0],
            orbit.speed[last],
        ]
    )
    period = np.pi / speed
    end, torques = model.run(start, period, speed, mean)
    assert len(torques) > 2, "the coupling rattles"
    moved = np.array([np.pi, np.pi, 0.0, 0.0])
    assert np.max(np.abs(end[:4] - start - moved) / [1.0, 1.0, speed, speed]) < 1e-9
    largest = max(peak(piece) for piece in torques)
    least = -max(peak(-piece) for piece in torques)
    assert largest == pytest.approx(found.torque_max[0], rel=1e-7)
    assert abs(least - found.torque_min[0]) < 1e-7 * largest
    assert abs(end[4] / period - found.torque_mean[0]) < 1e-8 * largest
    # The maps of neighbouring motions, whose torque jumps at other times.
    columns = range(0 if free else 1, 4, 1 if free else 2)
    aside = 1e-6 * np.array([1.0, 1.0, speed, speed])
    changes = []
    for column in columns:
        ends = []
        for side in (aside, -aside):
            begun = start.copy()
            begun[column] += side[column]
            ends.append(model.run(begun, period, speed, mean)[0][:4])
        changes.append((ends[0] - ends[1]) / (2.0 * aside[column]))
    chosen = list(columns)
    multipliers = list(np.linalg.eigvals(np.array(changes).T[chosen]))
    if free:
        multipliers.remove(min(multipliers, key=lambda x: abs(x - 1.0)))
    stability = model.system.stability(speed, tolerance=1e-11)
    assert distance(stability.multipliers, multipliers) < 1e-6


@pytest.mark.long
def test_motion_from_a_disturbed_start_settles_on_the_orbit() -> None:
    model, speed = OneJoint(free=True), 80.0
    found = model.system.steady(speed, tolerance=1e-11)
    mean = float(found.drive_torque_mean)
    state = np.array([0.0, -0.015, speed + 0.1, speed - 0.1])
    for _ in range(100):
        end, torques = model.run(state, np.pi / speed, speed, mean, 1e-11)
        state = end[:4]
    assert max(peak(piece) for piece in torques) == pytest.approx(found.torque_max[0], rel=1e-6)


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
