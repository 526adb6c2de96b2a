"""Friction in the joints, against the closed form and against vectors and differences."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import cardan
from refusals import refusals

BEARINGS: dict[str, Any] = {"friction": 0.02, "pin_radius": 0.008, "arm": 0.03}
SHARE = 0.02 * 0.008 / 0.03


def differences(
    line: cardan.Driveline, load: cardan.Load, angles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What a joint loses per radian of the drive over its friction: ``|M|`` times both rates.

    The moment comes from its vector, and the rates from differences of the tilts.
    """
    step = 1e-5
    moment = np.linalg.norm(line.evaluate(angles, "moment", load=load).moment, axis=-1)
    tilts = [line.evaluate(angles + by, ("tilt_driving", "tilt_driven")) for by in (-step, step)]
    names = ("tilt_driving", "tilt_driven")
    rates = [np.abs(tilts[1][name] - tilts[0][name]) / (2.0 * step) for name in names]
    return moment, rates[0] + rates[1]


@pytest.mark.parametrize("end", ["drive_torque", "output_torque"])
@pytest.mark.parametrize("bend", [0.0, 1e-6, 5.0, 10.0, 30.0, 45.0, 80.0, 89.0])
def test_one_joint_has_a_closed_form(bend: float, end: str) -> None:
    beta = mpmath.radians(mpmath.mpf(bend))
    bracket = 2 / mpmath.pi * (mpmath.atanh(mpmath.sin(beta)) + mpmath.tan(beta))
    line = cardan.Driveline.from_bends([bend], degrees=True)
    found = line.losses(cardan.Load(**{end: 250.0}), **BEARINGS)
    assert found.fraction[0] == pytest.approx(float(SHARE * bracket), rel=1e-13, abs=0.0)
    assert found.efficiency == pytest.approx(1.0 - float(SHARE * bracket), rel=1e-13)


@pytest.mark.parametrize(
    ("bend", "bracket"), [(5, 0.111323216450830), (10, 0.223932794061221), (30, 0.717251749513921)]
)
def test_reference_numbers(bend: float, bracket: float) -> None:
    line = cardan.Driveline.from_bends([bend], degrees=True)
    load = cardan.Load(drive_torque=1.0)
    found = line.losses(load, friction=1.0, pin_radius=1.0, arm=1.0)
    assert found.fraction[0] == pytest.approx(bracket, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "rel"),
    [
        (cardan.Load(drive_torque=100.0, speed=50.0), 1e-8),
        (cardan.Load(output_torque=-80.0, speed=50.0), 1e-8),
        # The torque of the middle shafts changes its sign within a turn.
        (cardan.Load(output_torque=80.0, speed=30.0, inertias=[0.0, 0.3, 0.2, 0.5]), 3e-6),
    ],
)
def test_chains_are_as_vectors_and_differences(load: cardan.Load, rel: float) -> None:
    line = cardan.Driveline.from_bends([10, 35, 20], [20, -40], [50, 10], degrees=True)
    friction, seal = np.array([0.01, 0.02, 0.015]), np.array([0.4, 0.0, 0.2])
    found = line.losses(load, friction=friction, pin_radius=0.008, arm=0.03, seal_torque=seal)
    angles = np.linspace(0.0, math.pi, 60_000, endpoint=False) + 1e-3
    moment, rates = differences(line, load, angles)
    lost = ((friction * 0.008 / 0.03)[:, None] * moment + seal[:, None]) * rates
    drive = np.mean(line.evaluate(angles, "torque", shafts=0, load=load).torque)
    assert found.fraction == pytest.approx(np.mean(lost, axis=-1) / abs(drive), rel=rel)
    assert found.power == pytest.approx(np.mean(lost, axis=-1) * load.speed, rel=rel)
    assert found.torque(angles[::997]) == pytest.approx(lost[:, ::997], rel=1e-6, abs=1e-6)


def test_a_seal_takes_four_swings_a_turn() -> None:
    """Each yoke's pins swing over the bend to both sides, whatever the load."""
    line = cardan.Driveline.from_bends([[12.0], [25.0]], degrees=True)
    load = cardan.Load(drive_torque=7.0, speed=100.0)
    found = line.losses(load, friction=0.0, pin_radius=0.01, arm=0.04, seal_torque=0.5)
    swings = 8.0 * np.radians([[12.0, 25.0]])
    assert found.power == pytest.approx(0.5 * swings * 100.0 / (2.0 * math.pi), rel=1e-12)


def test_batches_are_their_drivelines() -> None:
    bends = np.radians([[5.0, 9.0], [20.0, 8.0], [0.0, 3.0]])
    line = cardan.Driveline.from_bends(bends, 0.3, 0.1)
    load = cardan.Load(output_torque=[[100.0], [50.0]], speed=[10.0, 20.0, 30.0])
    found = line.losses(load, **BEARINGS)
    assert found.fraction.shape == (2, 2, 3)
    assert found.efficiency.shape == (2, 3)
    for row, torque in enumerate((100.0, 50.0)):
        for i, speed in enumerate((10.0, 20.0, 30.0)):
            alone = line[i].losses(cardan.Load(output_torque=torque, speed=speed), **BEARINGS)
            assert found.fraction[:, row, i] == pytest.approx(alone.fraction, rel=1e-12)
            assert found.power[:, row, i] == pytest.approx(alone.power, rel=1e-12)


def test_losses_grow_with_the_friction_of_each_row() -> None:
    line, load = cardan.Driveline.from_bends([0.2, 0.3]), cardan.Load(drive_torque=100.0)
    of: dict[str, Any] = {"pin_radius": 0.008, "arm": 0.03}
    rows = line.losses(load, friction=[[0.01, 0.02], [0.03, 0.03]], **of).fraction
    each = line.losses(load, friction=0.01, **of).fraction
    assert rows == pytest.approx(each[:, np.newaxis] * [[1.0, 3.0], [2.0, 3.0]], rel=1e-12)


def test_pins_at_rest_do_not_rub() -> None:
    line = cardan.Driveline.from_bends([0.0, 20.0], degrees=True)
    found = line.losses(cardan.Load(drive_torque=100.0), **BEARINGS)
    moment = found.moment(np.linspace(0.0, 6.0, 7))
    assert np.all(moment[0] == 0.0)
    assert np.all(np.linalg.norm(moment[1], axis=-1) > 0.0)
    assert "_line" not in repr(found)


def test_power_needs_a_speed() -> None:
    line = cardan.Driveline.from_bends([0.2])
    found = line.losses(cardan.Load(drive_torque=10.0), **BEARINGS)
    with pytest.raises(ValueError, match="load has no speed"):
        found.power  # noqa: B018
    forwards, backwards = (
        line.losses(cardan.Load(drive_torque=10.0, speed=speed), **BEARINGS).power
        for speed in (30.0, -30.0)
    )
    assert np.array_equal(forwards, backwards)


TWO = cardan.Driveline.from_bends([0.2, 0.2])

test_what_is_refused = refusals(
    {
        "friction is -0.1; it must be finite and not negative": {"friction": -0.1},
        "friction[1] is nan": {"friction": [0.1, np.nan]},
        "arm is 0.0; it must be positive and finite": {"arm": 0.0},
        "pin_radius has shape (3,)": {"pin_radius": [0.1, 0.1, 0.1]},
        "seal_torque is inf": {"seal_torque": np.inf},
        "TypeError: load is 100.0; it must be a cardan.Load": {"load": 100.0},
    },
    lambda **changes: TWO.losses(**{"load": cardan.Load(drive_torque=1.0), **BEARINGS, **changes}),
)


def test_idling_heats_by_its_seals_alone() -> None:
    line = cardan.Driveline.from_bends([[12.0], [25.0]], degrees=True)
    found = line.losses(cardan.Load(speed=100.0), **BEARINGS, seal_torque=0.5)
    swings = 8.0 * np.radians([[12.0, 25.0]])
    assert found.power == pytest.approx(0.5 * swings * 100.0 / (2.0 * math.pi), rel=1e-12)
    for name in ("fraction", "efficiency"):
        with pytest.raises(ValueError, match="load has no torque over the mean of a turn"):
            getattr(found, name)


@pytest.mark.parametrize("end", ["drive_torque", "output_torque"])
@pytest.mark.parametrize("torque", [150.0, -150.0])
def test_friction_makes_a_moment_that_fits_pins_shafts_and_power(end: str, torque: float) -> None:
    """The moment of a joint with friction solves three equations in pins laid out by hand."""
    beta, angles = math.radians(28.0), np.linspace(0.05, 6.2, 23)
    line = cardan.Driveline.from_bends([beta])
    load = cardan.Load(**{end: torque})
    found = line.losses(load, **BEARINGS, seal_torque=0.4)
    added = found.moment(angles)[0]
    ideal = line.evaluate(angles, "moment", load=load).moment[0]
    torques = line.evaluate(angles, "torque", shafts=[0, 1], load=load).torque
    u, v = np.array([1.0, 0, 0]), np.array([math.cos(beta), math.sin(beta), 0])
    for i, a in enumerate(angles):
        b = math.atan2(math.sin(a), math.cos(beta) * math.cos(a))
        p = np.array([0.0, math.cos(a) * 1.0, math.sin(a)])
        q = math.cos(b) * np.array([0.0, 0, 1]) + math.sin(b) * np.array(
            [math.sin(beta), -math.cos(beta), 0]
        )
        assert ideal[i] @ p == pytest.approx(0.0, abs=1e-12)
        assert ideal[i] @ q == pytest.approx(0.0, abs=1e-12)
        size = SHARE * np.linalg.norm(ideal[i]) + 0.4
        # The driven shaft turns by r: the difference of rotations is the swing about both pins.
        r = math.cos(beta) / (math.sin(a) ** 2 + (math.cos(beta) * math.cos(a)) ** 2)
        swings = r * v - u
        kept, torque_kept = (u, torques[0, i]) if end == "drive_torque" else (v, torques[1, i])
        whole = np.linalg.solve(
            np.stack([p, q, kept]),
            [-size * np.sign(swings @ p), -size * np.sign(swings @ q), torque_kept],
        )
        assert added[i] == pytest.approx(whole - ideal[i], abs=1e-11)
        # What goes in and does not come out is the heat.
        assert whole @ u - r * (whole @ v) == pytest.approx(found.torque(a)[0], rel=1e-10)


def test_efficiency_at_an_angle_is_power_out_over_power_in() -> None:
    line = cardan.Driveline.from_bends([[15, 40], [20, 3]], phases=[30], degrees=True)
    load = cardan.Load(output_torque=80.0)
    found = line.losses(load, **BEARINGS)
    angles = np.linspace(0.0, 2.0 * math.pi, 7200, endpoint=False)[:, None]
    drive = line.evaluate(angles, "torque", shafts=0, load=load).torque
    eta = found.efficiency_at(angles)
    assert eta.shape == drive.shape == (7200, 2)
    # Weighted by the power that goes in, its mean is the efficiency over the turn.
    whole = np.sum(eta * drive, axis=0) / np.sum(drive, axis=0)
    assert whole == pytest.approx(found.efficiency, rel=1e-7)
    assert isinstance(line[0].losses(load, **BEARINGS).efficiency_at(0.1), float)
    assert found.moment(angles).shape == (2, 7200, 2, 3)
