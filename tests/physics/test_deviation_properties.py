"""What must hold for any driveline as built: deviations, play, lash, wind-up, tolerances."""

from __future__ import annotations

from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

import tiers
from cardan import Driveline, Load, Sweep

few = settings(max_examples=tiers.part(25))
turn = 2.0 * np.pi * np.arange(48) / 48
powers = st.integers(-6, 6).map(lambda n: 2.0**n)
same = np.testing.assert_array_equal


@st.composite
def lines(draw: st.DrawFn) -> Driveline:
    """Drivelines of moderate bends with ideal joints."""
    n = draw(st.integers(1, 4))
    bends = draw(st.lists(st.floats(0.0, 0.7), min_size=n, max_size=n))
    turns = draw(st.lists(st.floats(-3.0, 3.0), min_size=2 * n - 2, max_size=2 * n - 2))
    return Driveline.from_bends(bends, turns[: n - 1], turns[n - 1 :])


@st.composite
def built(draw: st.DrawFn) -> Driveline:
    """Drivelines with deviations that leave every joint free to turn."""
    line = draw(lines())
    size = 3 * line.n_joints
    values = draw(st.lists(st.floats(-0.2, 0.2), min_size=size, max_size=size))
    return line.with_deviations(*np.reshape(values, (3, line.n_joints)))


def errors(line: Driveline, angles: NDArray[np.float64] = turn) -> NDArray[np.float64]:
    return np.asarray(line.evaluate(angles, "angle_error").angle_error)


@few
@given(built())
def test_yokes_that_lean_the_other_way_move_alike_half_a_turn_later(line: Driveline) -> None:
    driving, cross, driven = line.deviations.T
    other = line.with_deviations(-driving, cross, -driven)
    np.testing.assert_allclose(errors(other, turn + np.pi), errors(line), rtol=0, atol=1e-13)


@few
@given(built())
def test_motion_has_the_mean_of_the_drive(line: Driveline) -> None:
    whole = Sweep.revolutions(1, 2048)
    at = line.evaluate(whole, ("angle_error", "speed_ratio", "acceleration_ratio"), reduce="mean")
    assert at.angle_error == pytest.approx(0.0, abs=1e-13)
    assert at.speed_ratio == pytest.approx(1.0, abs=1e-12)
    assert at.acceleration_ratio == pytest.approx(0.0, abs=1e-11)


@few
@given(built(), st.integers(1, 5))
def test_a_batch_is_its_drivelines(line: Driveline, count: int) -> None:
    scale = np.linspace(-1.0, 1.0, count)[:, np.newaxis]
    batch = line.with_deviations(*(scale * each for each in line.deviations.T))
    at = errors(batch[:, np.newaxis])
    for i in range(count):
        alone = line.with_deviations(*(scale[i] * line.deviations.T))
        np.testing.assert_allclose(at[i], errors(alone), rtol=0, atol=4e-15)


@few
@given(lines())
def test_no_deviations_are_ideal_joints(line: Driveline) -> None:
    n = line.n_joints
    near = line.with_deviations(driving_yoke=np.full(n, 1e-14))
    np.testing.assert_allclose(errors(near), errors(line), rtol=0, atol=1e-12)
    assert not line.with_deviations(0.0, 0.0, 0.0).has_deviations
    same(errors(near.with_deviations()), errors(line))


@few
@given(built(), st.floats(1e-6, 2e-3), st.floats(1.01, 3.0))
def test_lash_grows_with_the_play(line: Driveline, play: float, times: float) -> None:
    arm = 0.04
    little, more = (line.lash(turn, size * arm, arm) for size in (play, times * play))
    assert np.all(little > 0.0)
    assert np.all(more > little)
    assert np.all(np.abs(line.lash(turn, 0.0, arm)) < 1e-13)
    # Units of the lengths do not matter.
    np.testing.assert_allclose(
        line.lash(turn, play * 40.0, 40.0), line.lash(turn, play * arm, arm), rtol=1e-9
    )


@few
@given(built(), st.floats(1e-5, 2e-3))
def test_lash_adds_up_along_the_driveline(line: Driveline, play: float) -> None:
    each = play * np.eye(line.n_joints)
    alone = line.lash(turn, each[:, np.newaxis], 1.0)
    together = line.lash(turn, play, 1.0)
    np.testing.assert_allclose(np.sum(alone, axis=0), together, rtol=0.03)


@few
@given(lines(), powers, powers, st.booleans())
def test_wind_up_is_torque_over_stiffness(
    line: Driveline, torque: float, stiffness: float, at_drive: bool
) -> None:
    def load(size: float) -> Load:
        return Load(drive_torque=size) if at_drive else Load(output_torque=size)

    one = line.wind_up(turn, load(3.0), 1e4)
    other = line.wind_up(turn, load(3.0 * torque), 1e4 * stiffness)
    np.testing.assert_allclose(other, torque / stiffness * one, rtol=1e-14)
    assert np.all(one > 0.0)


@settings(max_examples=tiers.part(10))
@given(lines(), st.lists(st.floats(0.0, 0.02), min_size=3, max_size=3), st.integers(0, 99))
def test_no_random_driveline_is_worse_than_the_worst(
    line: Driveline, halves: list[float], seed: int
) -> None:
    sizes: dict[str, Any] = dict(zip(("driving_yoke", "cross", "driven_yoke"), halves, strict=True))
    of = ["angle_error_order_1", "angle_error_order_2", "angle_error_peak"]
    few_parameters = line.n_joints <= 2
    found = line.tolerances(
        **sizes, bends=0.01, of=of if few_parameters else of[:2], samples=40, seed=seed
    )
    for name in found.of:
        most = found.worst[name] * (1.0 + 1e-9) + 1e-12
        assert found.worst_kind[name] == "box" or not few_parameters
        if few_parameters:
            assert found.sampled[name].max() <= most
        assert found.nominal[name] <= most
        total = sum(float(part.sum()) for part in found.shares[name].values())
        assert total == pytest.approx(1.0) or total == 0.0
