"""A drive of finite inertia: Thoma's question, energy against the equations of motion, shapes."""

from __future__ import annotations

import math
import pickle
from typing import Any

import mpmath
import numpy as np
import pytest

import cardan
from cardan import reference
from refusals import refusals

THOMA = cardan.Driveline.from_bends([8.5], degrees=True)


def chain() -> tuple[cardan.Driveline, list[float]]:
    line = cardan.Driveline.from_bends([35, 20, 50], [70, -30], [15, 40], degrees=True)
    return line, [0.05, 0.02, 0.03, 0.1]


def test_thoma_ten_times_the_inertia_leaves_two_thousandths_from_peak_to_peak() -> None:
    """Thoma's rig: the driving pulley is to be so heavy that its speed counts as constant.

    The speed ratio of the flywheel lies between cos(8.5°) and its reciprocal (Thoma 4).
    """
    mpmath.mp.dps = 30
    cosine = mpmath.cos(mpmath.radians(8.5))

    def root(angle: Any) -> Any:  # noqa: ANN401 - numbers of mpmath
        ratio = cosine / (mpmath.cos(angle) ** 2 * cosine**2 + mpmath.sin(angle) ** 2)
        return mpmath.sqrt(10 + ratio**2)

    mean = mpmath.quad(root, [0, mpmath.pi / 2]) / (mpmath.pi / 2)
    least, largest = (mean / mpmath.sqrt(10 + end**2) for end in (1 / cosine, cosine))
    free = THOMA.free_running([10.0, 1.0])
    assert free.min_speed_ratio == pytest.approx(float(least), rel=1e-15)
    assert free.max_speed_ratio == pytest.approx(float(largest), rel=1e-15)
    assert free.variation == pytest.approx(float(largest - least), rel=1e-12)
    assert f"{100 * free.variation:.2f} %" == "0.20 %"
    # The share of the driven shaft's own non-uniformity is the share of its inertia, nearly.
    share = free.variation / THOMA.equivalent().non_uniformity
    assert share == pytest.approx(1 / 11, rel=1e-3)


def test_equations_of_motion_integrated_without_torque() -> None:
    """Lagrange's equation with the slow reference's ratios, by Runge and Kutta over a turn."""
    line, inertias = chain()
    shafts = reference.from_bends(*(a.tolist() for a in (line.bends, line.twists, line.phases)))

    def rate(state: np.ndarray) -> np.ndarray:
        ratios, slopes = zip(*_reference_motion(shafts, state[0]), strict=True)
        inertia = sum(i * r * r for i, r in zip(inertias, ratios, strict=True))
        slope = sum(2 * i * r * s for i, r, s in zip(inertias, ratios, slopes, strict=True))
        return np.array([state[1], -slope * state[1] ** 2 / (2 * inertia)])

    steps, speed = 500, 40.0
    free = line.free_running(inertias)
    period = free.time_per_turn(speed, angle=0.3)
    state, step = np.array([0.3, speed]), period / steps
    path = [state]
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(state + step / 2 * k1)
        k3 = rate(state + step / 2 * k2)
        k4 = rate(state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        path.append(state)
    angles, speeds = np.array(path).T
    assert angles[-1] - 0.3 == pytest.approx(math.tau, abs=1e-7)
    assert speeds * period / math.tau == pytest.approx(free.speed_ratio(angles), rel=1e-7)
    assert speeds.max() * period / math.tau == pytest.approx(free.max_speed_ratio, rel=1e-4)
    assert speeds.min() * period / math.tau == pytest.approx(free.min_speed_ratio, rel=1e-4)


def _reference_motion(shafts: reference.Shafts, angle: float) -> list[tuple[float, float]]:
    """Speed and acceleration ratio of every shaft by the slow reference."""
    found = [(1.0, 0.0)]
    for shaft in range(1, len(shafts.directions)):
        motion = reference.motion(shafts, angle, shaft, offset=0.0)
        found.append((motion.speed_ratio, motion.acceleration_ratio))
    return found


def test_the_torque_at_the_drive_is_zero() -> None:
    """The loads of the core, at the speed and acceleration that this drive has."""
    line, inertias = chain()
    free = line.free_running(inertias)
    angles, mean = np.linspace(0.0, math.tau, 181), 120.0
    load = cardan.Load(
        output_torque=0.0,
        speed=mean * free.speed_ratio(angles),
        acceleration=mean**2 * free.acceleration_ratio(angles),
        inertias=inertias,
    )
    torque = line.evaluate(angles, "torque", shafts=slice(None), load=load).torque
    assert np.abs(torque[1:]).max() > 100.0
    assert np.abs(torque[0]).max() < 1e-12 * np.abs(torque[1:]).max()


@pytest.mark.parametrize(("bends", "own"), [([8.5], 1.0), ([8.5], 10.0), ([20.0, 14.0], 10.0)])
def test_the_share_is_the_error_of_inertia_torques(bends: list[float], own: float) -> None:
    """What a constant drive speed overestimates; the rule of the check rests on it."""
    line = cardan.Driveline.from_bends(bends, degrees=True)
    inertias = [own, *[0.05] * (len(bends) - 1), 1.0]
    free, angles = line.free_running(inertias), np.linspace(0.0, math.pi, 2001)
    steady = cardan.Load(speed=1.0, inertias=inertias)
    yielding = cardan.Load(
        speed=free.speed_ratio(angles),
        acceleration=free.acceleration_ratio(angles),
        inertias=inertias,
    )
    largest = [
        np.abs(line.evaluate(angles, "torque", load=load).torque).max()
        for load in (steady, yielding)
    ]
    share = free.variation / line.equivalent().non_uniformity
    assert 1.0 - largest[1] / largest[0] == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize("bend", [0.5, 20.0, 60.0, 88.0])
def test_the_ends_are_extremes(bend: float) -> None:
    line = cardan.Driveline.from_bends([bend, 0.7 * bend], 25, 10, degrees=True)
    free = line.free_running([0.4, 0.01, 1.0])
    angles = np.concatenate([np.linspace(0, math.pi, 200_001)])
    speeds = free.speed_ratio(angles)
    assert speeds.max() <= free.max_speed_ratio * (1 + 1e-15)
    assert speeds.min() >= free.min_speed_ratio * (1 - 1e-15)
    assert speeds.max() == pytest.approx(free.max_speed_ratio, rel=1e-6)
    assert speeds.min() == pytest.approx(free.min_speed_ratio, rel=1e-6)
    # The mean over time of the speed is 1: so is the harmonic mean over the angle.
    if bend < 80.0:
        assert np.mean(1.0 / speeds[:-1]) == pytest.approx(1.0, rel=1e-12)


def test_a_drive_without_inertia_varies_as_the_flywheel_would() -> None:
    free = THOMA.free_running([0.0, 3.0])
    assert free.variation == pytest.approx(THOMA.equivalent().non_uniformity, rel=1e-12)
    angles = np.linspace(0, 3, 7)
    ratio = THOMA.evaluate(angles, "speed_ratio").speed_ratio
    assert free.speed_ratio(angles) == pytest.approx(1.0 / ratio, rel=1e-14)


def test_a_drive_alone_and_a_straight_joint_run_steadily() -> None:
    assert THOMA.free_running([1.0, 0.0]).variation == 0.0
    straight = cardan.Driveline.from_bends([0.0]).free_running([1.0, 1.0])
    assert straight.variation == 0.0
    assert straight.min_speed_ratio == pytest.approx(1.0, rel=1e-15)
    assert straight.drive_inertia_for(1e-3) == 0.0
    assert straight.time_per_turn(math.tau) == pytest.approx(1.0)


def test_the_inertia_that_a_variation_needs() -> None:
    for wanted in (1e-2, 1e-3, 1e-5):
        needed = THOMA.free_running([5.0, 1.0]).drive_inertia_for(wanted)
        assert needed > 0.0
        assert THOMA.free_running([needed, 1.0]).variation == pytest.approx(wanted, rel=1e-9)
    assert THOMA.free_running([0.0, 1.0]).drive_inertia_for(0.5) == 0.0
    found = THOMA.free_running([[0.0, 1.0], [1.0, 2.0]]).drive_inertia_for([[1e-3], [1e-2]])
    assert found.shape == (2, 2)
    assert found[:, 1] == pytest.approx(2 * found[:, 0], rel=1e-9)


def test_everything_broadcasts() -> None:
    lines = cardan.Driveline.from_bends([[5.0], [20.0], [40.0]], degrees=True)
    free = lines[:, None].free_running([[1.0, 1.0], [10.0, 1.0]])
    assert free.variation.shape == free.min_speed_ratio.shape == (3, 2)
    for i in range(3):
        for j, inertias in enumerate(([1.0, 1.0], [10.0, 1.0])):
            one = lines[i].free_running(inertias)
            assert free.variation[i, j] == pytest.approx(one.variation, rel=1e-14)
    angles = np.linspace(0, 1, 5)
    assert free.speed_ratio(angles[:, None, None]).shape == (5, 3, 2)
    assert pickle.loads(pickle.dumps(free)).variation.tolist() == free.variation.tolist()
    many = cardan.Driveline.from_bends(np.linspace(1, 80, 3_000)[:, None], degrees=True)
    varied = many.free_running([1.0, 1.0]).variation
    assert np.all(np.diff(varied) > 0.0)
    assert varied[-1] == many[-1].free_running([1.0, 1.0]).variation


test_refusals = refusals(
    {
        "inertias has shape (); 2 shafts need (..., 2)": lambda: THOMA.free_running(1.0),
        "inertias has shape (1,); 2 shafts": lambda: THOMA.free_running([1.0]),
        "inertias[1] is -1.0; it must be finite": lambda: THOMA.free_running([1.0, -1.0]),
        "inertias[1] is nan; it must be finite": lambda: THOMA.free_running([1.0, math.nan]),
        "TypeError: inertias has dtype": lambda: THOMA.free_running(["a", "b"]),
        "inertias are all 0; at least one shaft": lambda: THOMA.free_running([0.0, 0.0]),
        "variation is 0.0; it": lambda: THOMA.free_running([1.0, 1.0]).drive_inertia_for(0.0),
    }
)


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e200, 1e307])
def test_only_ratios_of_inertias_matter(size: float) -> None:
    want = THOMA.free_running([10.0, 1.0])
    found = THOMA.free_running([10.0 * size, size])
    for name in ("min_speed_ratio", "max_speed_ratio", "variation"):
        assert getattr(found, name) == pytest.approx(getattr(want, name), rel=1e-11)
    for name in ("speed_ratio", "acceleration_ratio"):
        assert getattr(found, name)(0.3) == pytest.approx(getattr(want, name)(0.3), rel=1e-11)
    needed = want.drive_inertia_for(0.002)
    assert found.drive_inertia_for(0.002) / size == pytest.approx(needed, rel=1e-11)


def test_far_apart_inertias() -> None:
    found = THOMA.free_running([[1e300, 1e-300], [1e-300, 1e300]])
    assert found.variation[0] == 0.0
    assert found.variation[1] == pytest.approx(THOMA.free_running([0.0, 1.0]).variation, rel=1e-12)
    needed = THOMA.free_running([0.0, 1.0]).drive_inertia_for(0.002)
    scaled = found.drive_inertia_for(0.002) / [1e-300, 1e300]
    np.testing.assert_allclose(scaled, needed, rtol=1e-11)
    assert math.isinf(THOMA.free_running([1.0, 1.0]).drive_inertia_for(1e-320))
