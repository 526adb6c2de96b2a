"""Several periodic motions at one speed: beside the folds of a resonance of little damping."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import cardan

INF = float("inf")


def system_of(damping_ratio: float) -> cardan.TorsionalSystem:
    """Two joints of 30 degrees in line; the shaft between them is compliant."""
    return cardan.TorsionalSystem(
        cardan.Driveline.from_bends([30.0, 30.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, 0.004], [0.1, 0.0]],
        stiffnesses=[INF, 9000.0, INF],
        damping_ratios=damping_ratio,
        load_torque=20.0,
    )


LIGHT = system_of(0.013)
NATURAL = float(LIGHT.natural_frequencies()[0])


def test_three_orbits_exist_beside_the_folds() -> None:
    # The small orbit ends at 0.49 and begins again at 0.515 of the natural frequency; there it
    # meets the unstable one. Far from the resonance there is one orbit only.
    speeds = np.array([0.4, 0.489, 0.495, 0.52, 0.6]) * NATURAL
    found = LIGHT.coexisting(speeds)
    assert found.count[[0, 1, 3, 4]].tolist() == [1, 3, 3, 1]
    assert found.stable[[1, 3]].tolist() == 2 * [[True, False, True, False]]
    small, middle, large = found.torque_max[0, [1, 3], :3].T
    assert np.all(small < 700.0)
    assert np.all((middle > 1.5 * small) & (middle < 0.5 * large))
    # Between the folds no orbit is small.
    assert np.nanmin(found.torque_max[0, 2]) > 10_000.0
    assert np.isnan(found.torque_max[0, 0, 1:]).all()


def test_the_first_is_that_of_the_steady_state() -> None:
    speeds = np.array([[0.4], [0.489]]) * NATURAL
    found, steady, stability = (
        LIGHT.coexisting(speeds, most=2),
        LIGHT.steady(speeds),
        LIGHT.stability(speeds),
    )
    assert found.torque_max.shape == (1, 2, 1, 2)
    assert found.multipliers.shape == (2, 1, 2, 2)
    assert found.torque_max[..., 0] == pytest.approx(steady.torque_max, rel=1e-8)
    assert found.torque_min[..., 0] == pytest.approx(steady.torque_min, rel=1e-8)
    assert found.torque_mean[..., 0] == pytest.approx(steady.torque_mean, rel=1e-8)
    assert found.multipliers[..., 0, :] == pytest.approx(stability.multipliers, abs=1e-8)
    # The count is that of all, however few are returned.
    assert found.count.tolist() == [[1], [3]]


def test_the_others_follow_by_their_largest_torque_of_either_sign() -> None:
    """Under a load that drives, the orbit with the larger torque has the smaller positive one."""
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([30.0, 35.0, 17.0], [12.0, 122.0], [78.0, 73.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, 0.004], [0.1, 0.01], [0.05, 0.0]],
        stiffnesses=[INF, 9000.0, 20_000.0, INF],
        damping_ratios=0.02,
        load_torque=-5800.0,
    )
    found = system.coexisting(0.505 * float(system.natural_frequencies()[0]))
    assert found.count == 3
    negative, positive = -found.torque_min[:, 1:3].min(axis=0), found.torque_max[:, 1:3].max(axis=0)
    assert positive[1] < positive[0] < negative[0] < negative[1]


def test_damping_leaves_one_orbit() -> None:
    found = system_of(0.1).coexisting(np.linspace(0.4, 0.6, 5) * NATURAL)
    assert found.count.tolist() == 5 * [1]
    assert found.stable[:, 0].all()


def test_a_motion_keeps_to_the_large_orbit_of_its_past() -> None:
    pytest.importorskip("scipy")
    # At 0.5 only large orbits exist; from there the speed rises to where a small one exists too.
    low, high, rise, end = 0.5 * NATURAL, 0.52 * NATURAL, 1.0, 2.5

    def speed(time: float) -> float:
        return low + (high - low) * min(time / rise, 1.0)

    times = np.concatenate([[0.0], np.linspace(end - np.pi / high, end, 400)])
    swept = LIGHT.transient(times, speed=speed, start="steady", breaks=[rise], tolerance=1e-8)
    found = LIGHT.coexisting(high)
    assert swept.torque[0, 1:].max() == pytest.approx(found.torque_max[0, 2], rel=1e-3)
    # From rest the same speed leads to the small orbit.
    rest = LIGHT.transient(times, speed=high, tolerance=1e-8)
    assert rest.torque[0, 1:].max() == pytest.approx(found.torque_max[0, 0], rel=1e-2)


def test_what_is_missing_is_said_for_its_speed_alone() -> None:
    found = LIGHT.coexisting([NATURAL, np.nan, 0.6 * NATURAL], workers=1)
    assert found.count.tolist() == [1, 0, 1]
    assert found.found.tolist() == [True, False, True]
    assert found.reasons[1] == "the speed is not a positive finite number"
    assert found.stable[1].tolist() == 4 * [False]
    assert np.isnan(found.multipliers[1]).all()
    again = pickle.loads(pickle.dumps(found))
    assert again.count.tolist() == found.count.tolist()
    with pytest.raises(cardan.ArgumentValueError, match="most is 0; it must be at least 1"):
        LIGHT.coexisting(NATURAL, 0)
