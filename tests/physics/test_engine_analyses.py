"""What follows from a free drive, torques and couplings: modes, runaway, motors, resonances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cardan

INF = float("inf")
# Beyond the resonance near 218 rad/s the torque that is needed falls with the speed.
SOMMERFELD: dict[str, Any] = {
    "inertias": [[0.3, 0.0], [0.0, 0.05]],
    "stiffnesses": [INF, 8000.0],
    "dampings": [0.0, 3.0],
    "load_torque": 30.0,
    "drive": "free",
}
STRAIGHT = cardan.Driveline.from_bends([0.0])


def sommerfeld(**own: Any) -> cardan.TorsionalSystem:  # noqa: ANN401 - of the system
    line = cardan.Driveline.from_bends([20.0], degrees=True)
    return cardan.TorsionalSystem(line, **(SOMMERFELD | own))


def test_shapes_of_two_inertias_are_in_balance() -> None:
    system = cardan.TorsionalSystem(
        STRAIGHT,
        inertias=[[0.8, 0.0], [0.0, 0.2]],
        stiffnesses=[INF, INF],
        dampings=[2.0, 0.0],
        couplings={0: cardan.Coupling(3000.0, loss_factor=0.12)},
        drive="free",
    )
    (mode,) = system.modes()
    natural = np.sqrt(3000.0 * (1.0 / 0.8 + 1.0 / 0.2))
    assert mode.frequency == pytest.approx(natural, rel=1e-12)
    assert np.array(mode.shape) == pytest.approx(np.array([[-0.25, 1.0], [1.0, 1.0]]), abs=1e-12)
    assert mode.damping_ratio == pytest.approx(0.5 * (natural * 2.0 / 3000.0 + 0.12), rel=1e-12)
    assert mode.shares == pytest.approx((1.0,))


def test_the_speed_runs_away_from_where_the_needed_torque_falls() -> None:
    system, speeds = sommerfeld(), np.linspace(100.0, 600.0, 26)
    (region,) = system.unstable_ranges(speeds)
    assert region.runs_away
    # The ends are a maximum and a minimum of the torque, found here on a dense grid.
    dense = np.linspace(100.0, 600.0, 4001)
    torque = system.steady(dense).drive_torque_mean
    peak = int(np.argmax(torque))
    trough = peak + int(np.argmin(torque[peak:]))
    assert region.start == pytest.approx(dense[peak], abs=0.13)
    # Around the flat minimum the speed is neutral, up to rounding.
    assert region.stop == pytest.approx(dense[trough], rel=0.01)
    steepest = -np.min(np.diff(torque) / np.diff(dense))
    assert region.needed_slope == pytest.approx(steepest, rel=2e-3)
    assert system.stability(300.0).stable
    # A slope of the drive holds what needs less; beyond it the drive is not enough.
    some = sommerfeld(drive_slope=0.7).unstable_ranges(speeds)
    assert all(part.runs_away for part in some)
    assert region.start < some[0].start < some[-1].stop < region.stop
    assert sommerfeld(drive_slope=1.5).unstable_ranges(speeds) == ()


# An engine, a damper of constant loss factor, and an axle: two natural frequencies.
DAMPER, LOSS = 900.0, 0.09
ENGINE: dict[str, Any] = {
    "inertias": [[0.18, 0.0], [0.02, 0.0], [0.0, 1.5]],
    "stiffnesses": [DAMPER, 6000.0, INF],
    "load_torque": 150.0,
    "drive": "free",
}


def with_damper(bends: float, **own: Any) -> cardan.TorsionalSystem:  # noqa: ANN401 - of the system
    line = cardan.Driveline.from_bends([bends, bends], degrees=True)
    return cardan.TorsionalSystem(line, **(ENGINE | {"dampings": [0.0, 0.5, 0.0]} | own))


def test_with_a_loss_factor_all_analyses_tell_of_one_motion() -> None:
    pulses = [cardan.TorqueHarmonic(0, "input", 2, 60.0, 20.0)]
    system = with_damper(3.0, loss_factors=[LOSS, 0.0, 0.0], harmonics=pulses)
    resonance = float(system.natural_frequencies()[-1]) / 2.0
    speeds = resonance * np.array([0.6, 0.99, 1.02])
    steady, found = system.steady(speeds), system.coexisting(speeds)
    assert found.count.tolist() == [1, 1, 1]
    np.testing.assert_array_equal(found.torque_max[..., 0], steady.torque_max)
    # A governor holds a drive whose needed torque falls, here beyond the resonance.
    stable = system.stability(speeds)
    assert stable.drive_torque_slope[2] < -1e-3
    np.testing.assert_array_equal(found.stable[:, 0], stable.stable)
    assert stable.stable.all()
    step = 1e-3 * speeds
    up, down = (system.steady(speeds + by).drive_torque_mean for by in (step, -step))
    slopes = (up - down) / (2.0 * step)
    assert stable.drive_torque_slope == pytest.approx(slopes, rel=2e-2)
    np.testing.assert_allclose(
        found.speed_multiplier[:, 0], stable.speed_multiplier, rtol=0.0, atol=1e-3
    )


def test_motions_side_by_side_have_the_damping_of_the_steady_one() -> None:
    """Straight shafts vibrate at the order of the torque alone, with the loss at its frequency."""
    speed, pulses = 120.0, [cardan.TorqueHarmonic(0, "input", 2, 6.0, 2.0)]
    lossy = with_damper(0.0, loss_factors=[LOSS, 0.0, 0.0], harmonics=pulses)
    dampings = [DAMPER * LOSS / (2.0 * speed), 0.5, 0.0]
    viscous = with_damper(0.0, dampings=dampings, harmonics=pulses)
    found, known = lossy.coexisting(speed), viscous.coexisting(speed)
    assert found.multipliers[0] == pytest.approx(known.multipliers[0], abs=1e-8)
    # A little of order 4 comes from the turn of the engine itself.
    np.testing.assert_allclose(found.torque_max[:, 0], known.torque_max[:, 0], rtol=1e-6)


@pytest.mark.parametrize("pair", [(0, 0), (1, 1), (0, 1)])
def test_a_loss_factor_damps_what_joints_make_grow(pair: tuple[int, int]) -> None:
    system = with_damper(25.0, loss_factors=[LOSS, 0.0, 0.0])
    first, second = system.natural_frequencies()[list(pair)]
    speed = 0.5 * (first + second)
    found = system.stability(speed)
    # Loss per cycle as by a viscous damping at the frequency, of two at their geometric mean.
    viscous = DAMPER * LOSS / np.sqrt(first * second)
    known = with_damper(25.0, dampings=[viscous, 0.5, 0.0]).stability(speed)
    assert found.multipliers == pytest.approx(known.multipliers, abs=1e-9)
    assert np.max(np.abs(found.multipliers)) > 0.5


def test_a_motor_runs_where_its_torque_is_needed() -> None:
    system = sommerfeld()
    speeds, torques = [150.0, 400.0], [95.0, 20.0]
    found = system.running_speeds(speeds, torques)
    assert [each.stable for each in found] == [True, False, True]
    for each in found:
        needed = system.steady(each.speed).drive_torque_mean
        assert each.torque == pytest.approx(float(needed), rel=1e-9)
        assert each.torque == pytest.approx(np.interp(each.speed, speeds, torques), rel=1e-12)
        assert each.slope == pytest.approx(75.0 / 250.0)
        # As the system with the slope of the motor says.
        own = sommerfeld(drive_slope=each.slope).stability(each.speed)
        assert bool(own.stable) == each.stable
    assert system.running_speeds([150.0, 400.0], [5.0, 5.0]) == ()


@pytest.mark.parametrize(
    ("speeds", "torques", "said"),
    [
        ([1.0, 2.0], [1.0], "torque has shape"),
        ([2.0, 1.0], [1.0, 1.0], "it must be a list of rising speeds"),
        ([1.0], [1.0], "two at least"),
    ],
)
def test_wrong_curves_are_refused(speeds: Any, torques: Any, said: str) -> None:  # noqa: ANN401
    with pytest.raises(cardan.ArgumentValueError, match=said):
        sommerfeld().running_speeds(speeds, torques)


def test_resonances_of_half_orders_are_found_between_the_speeds() -> None:
    system = cardan.TorsionalSystem(
        STRAIGHT,
        inertias=[[0.1, 0.0], [0.0, 0.05]],
        stiffnesses=[INF, 8000.0],
        dampings=[0.0, 0.5],
        load_torque=30.0,
        drive="free",
        harmonics=[cardan.TorqueHarmonic(0, "input", 1.5, cos=4.0)],
    )
    natural = float(system.natural_frequencies()[0])
    (largest,) = system.speed_response([100.0, 500.0], orders=[2]).largest
    assert largest.speed == pytest.approx(natural / 1.5, rel=1e-3)
    # Closed form of the theory: the amplitude of the twist at resonance.
    reduced, z = 0.1 * 0.05 / 0.15, 8000.0 + 0.5j * natural
    torque = abs(z * 4.0 * reduced / 0.1 / (z - natural**2 * reduced))
    assert largest.most - largest.mean == pytest.approx(torque, rel=1e-3)


def test_rattling_is_a_torque_that_changes_its_sign_or_is_lost() -> None:
    own: dict[str, Any] = {
        "inertias": [[0.1, 0.0], [0.0, 0.05]],
        "load_torque": 3.0,
        "drive": "free",
        "harmonics": [cardan.TorqueHarmonic(0, "input", 1.0, cos=4.0)],
        "dampings": [2.0, 0.0],
    }
    spring = cardan.TorsionalSystem(STRAIGHT, stiffnesses=[8000.0, INF], **own)
    speeds = np.linspace(100.0, 450.0, 36)
    (largest,) = spring.speed_response(speeds).largest
    ((start, stop),) = largest.reversals
    at = spring.steady(np.array([start - 1.0, start + 1.0]))
    assert at.torque_min[0, 0] > 0.0 > at.torque_min[0, 1]
    assert stop == 450.0
    # With play the flanks come apart at the same speed: up to there the motion is the same.
    coupling = cardan.Coupling(8000.0, play=2e-3)
    loose = cardan.TorsionalSystem(STRAIGHT, stiffnesses=[INF, INF], couplings={0: coupling}, **own)
    known = loose.speed_response(speeds[speeds < 400.0])
    assert np.all(known.steady.found)
    (start_of_loose, _), *_ = known.largest[0].reversals
    assert start_of_loose == pytest.approx(start, rel=5e-3)


def test_play_is_free_half_to_either_side() -> None:
    coupling = cardan.Coupling(8000.0, play=2e-3)
    assert coupling.torque_at([-3e-3, -1e-3, 0.0, 5e-4, 2e-3]) == pytest.approx([-16, 0, 0, 0, 8])


def test_coarse_answers_are_at_the_speeds_given() -> None:
    system, speeds = sommerfeld(), np.linspace(100.0, 600.0, 26)
    coarse = system.speed_response(speeds, refined=False)
    assert coarse.speed.tolist() == speeds.tolist()
    assert coarse.largest[0].speed in speeds
    assert coarse.largest[0].most <= system.speed_response(speeds).largest[0].most
    (region,) = system.unstable_ranges(speeds, refined=False)
    assert {region.start, region.stop} <= set(speeds.tolist())


def test_a_heavy_drive_is_as_unstable_as_a_held_one() -> None:
    line = cardan.Driveline.from_bends([20.0], degrees=True)
    kinds: tuple[tuple[Any, float], ...] = (("held", 0.0), ("free", 1e5))
    ends = {
        drive: cardan.TorsionalSystem(
            line,
            inertias=[[inertia, 0.0], [0.0, 0.05]],
            stiffnesses=[8000.0, INF],
            drive=drive,
        ).unstable_ranges([300.0, 500.0])
        for drive, inertia in kinds
    }
    (held,), (free,) = ends["held"], [one for one in ends["free"] if not one.runs_away]
    assert (free.start, free.stop) == pytest.approx((held.start, held.stop), rel=1e-5)
