"""The life of joints against the catalogue's law, integrals over a swing, and sums of vectors."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import cardan
from refusals import refusals

STEPS = cardan.Load(output_torque=[400, 700, 250], speed_rpm=[1500, 1000, 2500])
CYCLE = cardan.Driveline.from_bends([[5.0], [8.0], [3.0]], degrees=True)


def law(bend_deg: float, rpm: float, torque: float, rating: float) -> float:
    return 1.5e6 / (max(bend_deg, 3.0) * rpm) * math.pow(rating / torque, 10.0 / 3.0)


def test_a_duty_cycle_adds_its_damages() -> None:
    found = CYCLE.life(STEPS, rating=1000.0, shares=[0.5, 0.3, 0.2])
    assert found.catalogue[0] == pytest.approx(1625.98, abs=0.005)
    each = [law(5, 1500, 400, 1000), law(8, 1000, 700, 1000), law(3, 2500, 250, 1000)]
    damage = sum(share / hours for share, hours in zip((0.5, 0.3, 0.2), each, strict=True))
    assert found.catalogue[0] == pytest.approx(1.0 / damage, rel=1e-12)
    assert found.steps.shape == (1, 3)
    assert found.hours[0] == pytest.approx(1.0 / np.sum([0.5, 0.3, 0.2] / found.steps[0]))
    assert found.mean_hours[0] == pytest.approx(5.0 * found.hours[0])


@pytest.mark.parametrize("bend", [3.0, 10.0, 20.0, 30.0, 45.0, 75.0])
def test_one_joint_is_as_the_integrals_over_its_swing(bend: float) -> None:
    """The driving yoke's pins bear ``D sec t1`` and the driven yoke's ``D sec b cos t2``."""
    beta, p, e = mpmath.radians(bend), mpmath.mpf(10) / 3, mpmath.mpf(9) / 8
    driving = mpmath.quad(lambda t: mpmath.sec(t) ** p, [0, beta]) / beta
    driven = mpmath.quad(lambda t: mpmath.cos(t) ** p, [0, beta]) / beta / mpmath.cos(beta) ** p
    factor = ((driving**e + driven**e) / 2) ** (-1 / e)
    line = cardan.Driveline.from_bends([bend], degrees=True)
    load = cardan.Load(drive_torque=-300.0, speed_rpm=600.0)
    found = line.life(load, rating=2000.0)
    assert found.catalogue[0] == pytest.approx(law(bend, 600.0, 300.0, 2000.0), rel=1e-12)
    assert found.hours[0] / found.catalogue[0] == pytest.approx(float(factor), rel=1e-10)


@pytest.mark.parametrize(
    ("bend", "driving", "driven"),
    [
        (10, 1.005140461, 1.010303595),
        (20, 1.021363413, 1.043106454),
        (30, 1.051405694, 1.104892123),
        (45, 1.137008846, 1.286891148),
    ],
)
def test_equivalent_torques(bend: float, driving: float, driven: float) -> None:
    line = cardan.Driveline.from_bends([bend], degrees=True)
    found = line.life(cardan.Load(drive_torque=1.0, speed=1.0), rating=1.0)
    both = np.mean(np.array([driving, driven]) ** (10.0 / 3.0 * 9.0 / 8.0)) ** (-8.0 / 9.0)
    assert found.hours[0] / found.catalogue[0] == pytest.approx(both, rel=1e-8)


def test_chains_with_inertias_are_as_sums_of_vectors() -> None:
    line = cardan.Driveline.from_bends([10, 35, 2], [20, -40], [50, 10], degrees=True)
    load = cardan.Load(output_torque=90.0, speed=25.0, inertias=[0.0, 0.3, 0.2, 0.5])
    angles = np.linspace(0.0, math.pi, 60_000, endpoint=False) + 1e-3
    step, ways = 1e-5, []
    moment = np.linalg.norm(line.evaluate(angles, "moment", load=load).moment, axis=-1)
    for name in ("tilt_driving", "tilt_driven"):
        high, low = (line.evaluate(angles + by, name)[name] for by in (step, -step))
        ways.append(np.abs(high - low))
    harm = [np.sum(moment ** (10 / 3) * way, -1) / np.sum(way, -1) for way in ways]
    both = np.mean(np.array(harm) ** (9 / 8), axis=0) ** (8 / 9)
    swing = np.array([10.0, 35.0, 3.0]) * 25.0 * 30.0 / math.pi
    found = line.life(load, rating=[1000.0, 2000.0, 500.0])
    rating = np.array([1000.0, 2000.0, 500.0]) ** (10 / 3)
    assert found.hours == pytest.approx(1.5e6 / swing * rating / both, rel=1e-6)
    assert found.small_swing.tolist() == [False, False, True]
    assert found.decisive == int(np.argmin(found.hours))


def test_the_inertia_of_a_driving_shaft_does_not_load_the_joint_behind_it() -> None:
    line = cardan.Driveline.from_bends([25.0, 25.0], phases=[30.0], degrees=True)
    of: dict[str, Any] = {"output_torque": 100.0, "speed_rpm": 1500.0}
    light = line.life(cardan.Load(**of), rating=1000.0)
    heavy = line.life(cardan.Load(**of, inertias=[0.0, 0.2, 0.0]), rating=1000.0)
    assert heavy.catalogue[1] == pytest.approx(light.catalogue[1], rel=1e-9)
    assert heavy.hours[1] == pytest.approx(light.hours[1], rel=1e-9)
    # The joint before it accelerates it.
    assert heavy.catalogue[0] < 0.1 * light.catalogue[0]
    angle = np.linspace(0.0, 2.0 * math.pi, 20_001)
    run = line.life(cardan.Load(**of, inertias=[0.0, 0.2, 0.0]), rating=1000.0, angle=angle)
    assert run.catalogue == pytest.approx(heavy.catalogue, rel=1e-5)
    # The mean of one joint's speed ratio is 1.
    alone = cardan.Driveline.from_bends([25.0], degrees=True)
    for inertias in (None, [0.3, 0.0]):
        found = alone.life(cardan.Load(**of, inertias=inertias), rating=1000.0)
        assert found.catalogue[0] == pytest.approx(law(25.0, 1500.0, 100.0, 1000.0), rel=1e-9)


def test_inertias_of_their_own_have_lives_of_their_own() -> None:
    line = cardan.Driveline.from_bends([12.0, 8.0], degrees=True)
    of: dict[str, Any] = {"output_torque": 60.0, "speed_rpm": 900.0}
    inertias = np.array([[0.1, 0.02, 0.1], [0.0, 0.3, 0.2]])
    both = line.life(cardan.Load(**of, inertias=inertias), rating=400.0)
    assert both.hours.shape == (2, 2)
    for i, own in enumerate(inertias):
        alone = line.life(cardan.Load(**of, inertias=own), rating=400.0)
        assert both.hours[:, i] == pytest.approx(alone.hours, rel=1e-9)


def test_the_way_round_does_not_matter() -> None:
    line = cardan.Driveline.from_bends([12.0, 8.0], degrees=True)
    hours = [
        line.life(cardan.Load(drive_torque=60.0, speed=speed), rating=400.0).hours.tolist()
        for speed in (90.0, -90.0)
    ]
    assert hours[0] == hours[1]


def test_a_straight_joint_has_the_life_of_the_law() -> None:
    line = cardan.Driveline.from_bends([[0.0], [1e-9]], degrees=True)
    found = line.life(cardan.Load(drive_torque=100.0, speed_rpm=1000.0), rating=1000.0)
    assert found.hours[0] == pytest.approx([law(0, 1000, 100, 1000)] * 2, rel=1e-9)
    assert found.small_swing.all()


def test_no_torque_lasts_for_ever() -> None:
    line = cardan.Driveline.from_bends([10.0], degrees=True)
    found = line.life(cardan.Load(speed=1.0), rating=1.0)
    assert found.hours[0] == found.catalogue[0] == math.inf


def test_speed_in_place_of_the_loads() -> None:
    line = cardan.Driveline.from_bends([10.0], degrees=True)
    one = line.life(cardan.Load(drive_torque=5.0), rating=100.0, speed=[10.0, 20.0])
    assert one.hours.shape == (1, 2)
    assert one.hours[0, 0] == pytest.approx(2.0 * one.hours[0, 1])


test_what_is_refused = refusals(
    {
        "rating is 0.0; it must be positive and finite": {"rating": 0.0},
        "rating has shape (2,); it is one number or one per joint": {"rating": [1.0, 2.0]},
        "speed is -1.0; it must be positive and finite": {"speed": -1.0},
        "load has no speed": {"load": cardan.Load(drive_torque=1.0)},
        "TypeError: load is 1.0; it must be a cardan.Load": {"load": 1.0},
        "shares has shape (2,); it needs one share for each step": {"shares": [0.5, 0.5]},
        "shares add up to 1.1; the sum must be 1": {"shares": [0.5, 0.3, 0.3]},
        "shares[2] is 0.0; it must be positive and finite": {"shares": [0.5, 0.5, 0.0]},
        "load and batch of shape (3,) have these": {"shares": 1.0},
    },
    lambda **changes: CYCLE.life(**{"load": STEPS, "rating": 1000.0, **changes}),
)


def test_a_run_at_a_constant_load_is_as_its_turn() -> None:
    line = cardan.Driveline.from_bends([10, 35], [20], [50], degrees=True)
    load = cardan.Load(output_torque=90.0, speed=25.0)
    angles = np.linspace(0.0, 2.0 * math.pi, 20_001)
    whole, run = (line.life(load, rating=[1e3, 2e3], angle=at) for at in (None, angles))
    assert run.hours == pytest.approx(whole.hours, rel=1e-6)
    assert run.catalogue == pytest.approx(whole.catalogue, rel=1e-6)
    back = line.life(load, rating=[1e3, 2e3], angle=angles[::-1])
    assert back.hours == pytest.approx(run.hours, rel=1e-12)


def test_part_of_a_turn_swings_the_pins_of_both_yokes_by_their_tilts() -> None:
    beta, turned = math.radians(40.0), 0.6
    driving = math.atan(math.tan(beta) * math.sin(turned))
    driven = beta - math.asin(math.sin(beta) * math.cos(turned))
    assert driving > 3.0 * driven
    line = cardan.Driveline.from_bends([beta])
    load = cardan.Load(drive_torque=300.0, speed_rpm=900.0)
    found = line.life(load, rating=2000.0, angle=np.linspace(0.0, turned, 20_001))
    # Pins that go on at this rate swing four times by this bend in a turn.
    bend = math.degrees(0.5 * math.pi * 0.5 * (driving + driven) / turned)
    assert found.catalogue[0] == pytest.approx(law(bend, 900.0, 300.0, 2000.0), rel=1e-7)


def test_a_torque_that_varies_within_the_turn() -> None:
    """The vibration of a compliant shaft, as an integral over the tilts of the cross."""
    beta, p, e = mpmath.radians(25), mpmath.mpf(10) / 3, mpmath.mpf(9) / 8

    def tilts(a: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
        return mpmath.atan(mpmath.tan(beta) * mpmath.sin(a)), mpmath.asin(
            mpmath.sin(beta) * mpmath.cos(a)
        )

    harms = []
    quarters = [mpmath.pi * i / 2 for i in range(5)]
    for yoke in (0, 1):

        def rate(a: mpmath.mpf, yoke: int = yoke) -> mpmath.mpf:
            return abs(mpmath.diff(lambda x: tilts(x)[yoke], a))

        def harm(a: mpmath.mpf) -> mpmath.mpf:
            torque = 300 * (1 + mpmath.mpf("0.4") * mpmath.cos(2 * a - 1))
            return (torque / mpmath.cos(tilts(a)[0])) ** p * rate(a)

        harms.append(mpmath.quad(harm, quarters) / mpmath.quad(rate, quarters))
    both = ((harms[0] ** e + harms[1] ** e) / 2) ** (1 / e)
    angles = np.linspace(0.0, 2.0 * math.pi, 40_001)
    load = cardan.Load(drive_torque=300.0 * (1.0 + 0.4 * np.cos(2.0 * angles - 1.0)), speed_rpm=900)
    line = cardan.Driveline.from_bends([25], degrees=True)
    found = line.life(load, rating=2000.0, angle=angles)
    expected = 1.5e6 / (25.0 * 900.0) * 2000.0 ** (10.0 / 3.0) / float(both)
    assert found.hours[0] == pytest.approx(expected, rel=1e-7)
    assert found.catalogue[0] == pytest.approx(law(25.0, 900.0, 300.0, 2000.0), rel=1e-7)


def test_a_run_counts_its_hours_by_its_time() -> None:
    """Half of the angle at 10 rad/s and half at 30 rad/s take as long as all at 15 rad/s."""
    line = cardan.Driveline.from_bends([20], degrees=True)
    angles = np.linspace(0.0, 200.0 * math.pi, 40_001)
    speed = np.where(angles < 100.0 * math.pi, 10.0, 30.0)
    run = line.life(cardan.Load(output_torque=50.0, speed=speed), rating=500.0, angle=angles)
    steady = line.life(cardan.Load(output_torque=50.0, speed=15.0), rating=500.0)
    assert run.hours == pytest.approx(steady.hours, rel=1e-4)


@pytest.mark.parametrize(
    ("angle", "message"),
    [
        (0.0, r"angle has shape \(\); of a run it is \(samples,\)"),
        ([1.0], r"angle has shape \(1,\); of a run it is \(samples,\), at least two"),
        ([1.0, 1.0], "angle does not change, or is not finite"),
        ([0.0, np.nan], "angle does not change, or is not finite"),
    ],
)
def test_runs_that_are_refused(angle: Any, message: str) -> None:  # noqa: ANN401
    line = cardan.Driveline.from_bends([20], degrees=True)
    load = cardan.Load(output_torque=50.0, speed=15.0)
    with pytest.raises(ValueError, match=message):
        line.life(load, rating=500.0, angle=angle)
    with pytest.raises(ValueError, match="shares and angle are both given"):
        line.life(load, rating=500.0, shares=[1.0], angle=[0.0, 1.0])
