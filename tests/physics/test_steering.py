"""Steering columns: the ratio straight ahead, against its derivative and by mirrored angles."""

from __future__ import annotations

import numpy as np
import pytest

from cardan import Driveline

POINTS = np.array([[0, 0, 0], [0.55, 0, -0.28], [0.78, 0.09, -0.52], [0.90, 0.10, -0.60]])


def column() -> Driveline:
    line = Driveline.from_points(POINTS)
    return line.with_phases(line.optimal_phases())


def test_a_column_computed_elsewhere() -> None:
    """Numbers of an independent computation, with the best phase of these points."""
    line = column()
    np.testing.assert_allclose(np.degrees(line.bends), [24.30841215, 16.64808719], atol=5e-9)
    np.testing.assert_allclose(np.degrees(line.twists), [-175.8855785], atol=5e-8)
    np.testing.assert_allclose(np.degrees(line.phases), [4.1144215], atol=5e-8)
    quick = line.steering(line.steering().turn_to_quick)
    slow = line.steering(line.steering().turn_to_slow)
    assert abs(quick.ratio - 1.051286534) < 5e-10
    assert abs(slow.ratio - 0.951215456) < 5e-10
    assert quick.quick
    assert not slow.quick
    np.testing.assert_allclose([quick.slope, slow.slope, quick.offset, slow.offset], 0, atol=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_ratio_and_slope_are_those_of_the_evaluation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    line = Driveline.from_bends(rng.uniform(0.1, 0.6, 3), rng.uniform(-3, 3, 2), [0.3, -0.2])
    centre, step = rng.uniform(-4.0, 4.0), 1e-4
    found = line.steering(centre)
    ratio = line.evaluate(centre + step * np.arange(-1, 2), "speed_ratio").speed_ratio
    np.testing.assert_allclose(found.ratio, ratio[1], rtol=1e-13)
    np.testing.assert_allclose(found.slope, (ratio[2] - ratio[0]) / (2 * step), atol=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_turned_to_symmetry_the_ratio_is_the_same_on_both_sides(seed: int) -> None:
    rng = np.random.default_rng(seed)
    line = Driveline.from_bends(rng.uniform(0.1, 0.6, 3), rng.uniform(-3, 3, 2), [0.3, -0.2])
    centre = rng.uniform(-4.0, 4.0)
    found = line.steering(centre)
    away = np.linspace(0.0, 3.0, 61)
    for turn, quick in ((found.turn_to_quick, True), (found.turn_to_slow, False)):
        left, right = (
            line.evaluate(centre + turn + sign * away, "speed_ratio").speed_ratio
            for sign in (-1.0, 1.0)
        )
        np.testing.assert_allclose(left, right, rtol=1e-12)
        np.testing.assert_allclose(left[0], np.max(left) if quick else np.min(left), rtol=1e-12)
    # Nowhere else are both sides alike.
    ratios = [line.evaluate(centre + sign * away, "speed_ratio").speed_ratio for sign in (-1, 1)]
    assert np.max(np.abs(ratios[0] - ratios[1])) > 1e-3 * abs(found.offset)
    assert abs(found.offset) <= np.pi / 4.0
    nearest = found.turn_to_quick if found.quick else found.turn_to_slow
    np.testing.assert_allclose(found.offset, -nearest, atol=1e-12)


def test_batches_and_degrees() -> None:
    lines = Driveline.from_bends([[0.1], [0.2]])
    found = lines.steering([[0.0], [30.0], [90.0]], degrees=True)
    assert found.ratio.shape == found.quick.shape == (3, 2)
    np.testing.assert_allclose(found.ratio[0], 1.0 / np.cos([0.1, 0.2]), rtol=1e-13)
    np.testing.assert_allclose(found.ratio[2], np.cos([0.1, 0.2]), rtol=1e-13)
    np.testing.assert_allclose(np.degrees(found.offset), [[0, 0], [30, 30], [0, 0]], atol=1e-12)
    assert found.quick.tolist() == [[True, True], [True, True], [False, False]]
    with pytest.raises(TypeError, match="centre"):
        lines.steering("a")
