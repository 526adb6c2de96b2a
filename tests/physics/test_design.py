"""Closed forms of design, against recorded figures and against the vector model."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Driveline, reference
from oracle import read

DATA = read("design.json")
STEP = 1e-4


def line_of(case: dict[str, Any]) -> Driveline:
    return Driveline.from_bends(case["bends"], case["twists"], case["phases"])


def agrees(found: object, recorded: dict[str, Any]) -> None:
    """Compare with figures of 12 digits, next to a zero with those of the largest figure."""
    for name, want in recorded.items():
        got = np.ravel(getattr(found, name))
        near = 2e-15 * max(1.0, *np.abs(np.ravel(want)))
        np.testing.assert_allclose(got, np.ravel(want), rtol=1e-11, atol=near, err_msg=name)


@pytest.mark.parametrize("case", DATA["check"])
def test_recorded_excitations(case: dict[str, Any]) -> None:
    found = {f.figure: f.value for f in line_of(case).check(case["speed"]).findings}
    assert found.keys() == case["found"].keys()
    for figure, want in case["found"].items():
        assert found[figure] == pytest.approx(want, rel=1e-11)


@pytest.mark.parametrize("case", DATA["steering"])
def test_recorded_steering(case: dict[str, Any]) -> None:
    agrees(line_of(case).steering(case["centre"]), case["found"])


@pytest.mark.parametrize("case", DATA["spline"])
def test_recorded_splines(case: dict[str, Any]) -> None:
    line = Driveline.from_points(case["points"]).with_bearings(case["bearings"])
    agrees(line.spline_force(case["shaft"], *case["arguments"]), case["found"])


@pytest.mark.parametrize("case", DATA["tube"])
def test_recorded_tubes(case: dict[str, Any]) -> None:
    outer, wall, length = case["arguments"]
    found = cardan.tube(outer, wall, length=length)
    want = dict(case["found"])
    assert found.shear_stress(1500.0) == pytest.approx(want.pop("shear_stress"), rel=1e-11)
    agrees(found, want)


def largest(of: Callable[[float], float]) -> float:
    """The largest value over half a turn: the best of many, then thirds of what is around it."""
    steps = 180
    step = math.pi / steps
    best = max(range(steps), key=lambda i: of(i * step)) * step
    low, high = best - step, best + step
    while high - low > 1e-8:
        left, right = low + (high - low) / 3, high - (high - low) / 3
        low, high = (left, high) if of(left) < of(right) else (low, right)
    return of(low)


def second_order(shafts: reference.Shafts, count: int = 128) -> float:
    """The second order of the summed accelerations of all intermediate shafts."""
    total = 0j
    for i in range(count):
        angle = math.pi * i / count
        for shaft in range(1, len(shafts.bends)):
            ratio = reference.motion(shafts, angle, shaft, offset=0.0).acceleration_ratio
            total += ratio * complex(math.cos(2 * angle), -math.sin(2 * angle))
    return 2 * abs(total) / count


@pytest.mark.parametrize("seed", range(6))
def test_excitations_are_those_of_vectors(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 1 + seed % 4
    line = Driveline.from_bends(
        rng.uniform(0.1, 0.6, n), rng.uniform(-3, 3, n - 1), rng.uniform(-3, 3, n - 1)
    )
    phases = line.phases.tolist()
    shafts = reference.from_directions(line.directions.tolist(), phases)
    turned = reference.from_directions((-line.directions[::-1]).tolist(), phases[::-1])
    speed = 150.0
    found = {f.figure: float(f.value) for f in line.check(speed).findings}

    def motion(angle: float) -> reference.ShaftMotion:
        return reference.motion(shafts, angle, offset=0.0)

    ratio = largest(lambda angle: motion(angle).speed_ratio)
    # The bend is flat where the ratio is largest, and so keeps half of its digits.
    assert found["equivalent_bend"] == pytest.approx(math.degrees(math.acos(1 / ratio)), rel=1e-11)
    peak = largest(lambda angle: motion(angle).acceleration_ratio) * speed**2
    assert found["torsional_excitation"] == pytest.approx(peak, rel=1e-11)
    if n > 1:
        driving, coasting = (second_order(s) * speed**2 for s in (shafts, turned))
        assert found["inertia_excitation_driving"] == pytest.approx(driving, rel=1e-11)
        assert found["inertia_excitation_coasting"] == pytest.approx(coasting, rel=1e-11)


def test_excitations_of_a_batch_are_those_of_its_drivelines() -> None:
    """Many drivelines are shared among threads."""
    bends = np.random.default_rng(3).uniform(0.0, 1.2, (3, 1000, 3))
    lines = Driveline.from_bends(bends, 0.3, -0.4)
    batch = lines.check(2.0).findings
    assert batch[0].value.shape == (3, 1000)
    for place in ((0, 0), (1, 500), (2, 999)):
        for found, alone in zip(batch, lines[place].check(2.0).findings, strict=True):
            assert found.value[place] == alone.value


@pytest.mark.parametrize("seed", range(4))
def test_steering_is_that_of_vectors(seed: int) -> None:
    rng = np.random.default_rng(seed)
    line = Driveline.from_bends(rng.uniform(0.1, 0.6, 2), rng.uniform(-3, 3, 1), [0.3])
    shafts = reference.from_directions(line.directions.tolist(), line.phases.tolist())
    centre = float(rng.uniform(-4.0, 4.0))
    found = line.steering(centre)

    def ratio(angle: float) -> float:
        return reference.motion(shafts, angle, offset=0.0).speed_ratio

    assert found.ratio == pytest.approx(ratio(centre), rel=1e-13)
    slope = (ratio(centre + STEP) - ratio(centre - STEP)) / (2 * STEP)
    assert found.slope == pytest.approx(slope, abs=2e-7)
    extremes = (largest(ratio), -largest(lambda angle: -ratio(angle)))
    turns = (float(found.turn_to_quick), float(found.turn_to_slow))
    for turn, extreme in zip(turns, extremes, strict=True):
        assert abs(turn) <= math.pi / 2
        assert ratio(centre + turn) == pytest.approx(extreme, rel=1e-13)
        left, right = ratio(centre + turn - 0.4), ratio(centre + turn + 0.4)
        assert left == pytest.approx(right, rel=1e-12)
    nearest = min(map(abs, turns))
    assert abs(found.offset) == pytest.approx(nearest, abs=1e-14)
    assert found.quick == (nearest == abs(turns[0]))


def test_steering_broadcasts() -> None:
    lines = Driveline.from_bends([[0.2, 0.3], [0.4, 0.5]], 0.1, 0.2)
    found = lines.steering(np.linspace(-1.0, 1.0, 5)[:, np.newaxis])
    assert found.quick.shape == found.slope.shape == (5, 2)
    assert found.ratio[3, 1] == lines[1].steering(0.5).ratio


def test_joints_as_built_have_no_closed_forms() -> None:
    line = Driveline.from_bends([0.1, 0.2]).with_deviations(cross=0.01)
    for call in (line.check, line.steering):
        with pytest.raises(ValueError, match="has joints with deviations"):
            call()
