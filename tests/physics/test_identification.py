"""Joints found in recordings, against drivelines whose motion the pure-Python reference makes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import tiers
from cardan import Driveline, Identification, identify, identify_two_joints, reference
from cardan.arrays import FloatArray
from refusals import refusals

TWO = Driveline.from_bends([14, 9], twists=30, phases=20, degrees=True)
ANGLES = np.sort(np.random.default_rng(13).uniform(0.0, 40.0, 3000))
MOTION = TWO.evaluate(ANGLES, ("angle", "speed_ratio"), shafts=[1, 2])


def test_a_joint_is_found_by_the_reference_alone() -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 200, endpoint=False)
    bend = math.radians(25.0)
    joint = reference.from_bends([bend])
    motion = [reference.motion(joint, angle, offset=0.0) for angle in angles]
    driven = [sample.angle for sample in motion]
    found = identify(angles, angle=driven)
    assert found.bend == pytest.approx(bend, abs=1e-14)
    assert found.angle_offset == pytest.approx(0.0, abs=1e-14)
    ratio = [sample.speed_ratio for sample in motion]
    assert identify(angles, speed_ratio=ratio).bend == pytest.approx(bend, abs=1e-14)
    assert found.purity == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("bend_deg", [1.0, 20.0, 60.0, 80.0])
@pytest.mark.parametrize("offset", [-1.2, 0.0, 0.4, 1.5])
def test_bend_and_offset_of_any_joint(bend_deg: float, offset: float) -> None:
    line = Driveline.from_bends([bend_deg], degrees=True)
    angles = np.linspace(0.0, 21.0, 4001)
    motion = line.evaluate(angles + offset, ("angle", "speed_ratio"))
    for given in ({"angle": motion.angle - offset}, {"speed_ratio": motion.speed_ratio}):
        found = identify(angles, **given)
        assert found.bend_deg == pytest.approx(bend_deg, abs=1e-9)
        assert found.angle_offset == pytest.approx(offset, abs=1e-9)


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
@pytest.mark.parametrize("samples", [20, 24, 40, 400])
def test_steep_joints_are_found_in_few_samples(of: str, samples: int) -> None:
    # Narrow peaks of the speed ratio, which hardly any sample meets.
    angles = np.arange(samples) * math.tau / samples
    for bend in (75.0, 82.0, 84.0, 86.0, 89.0):
        line = Driveline.from_bends([bend], degrees=True)
        for offset in (0.0, 0.3, 1.1):
            recorded = line.evaluate(angles + offset, of)[of] - (offset if of == "angle" else 0.0)
            given: dict[str, Any] = {of: recorded}
            found = identify(angles, **given)
            assert found.bend_deg == pytest.approx(bend, abs=1e-6)
            assert found.angle_offset == pytest.approx(offset, abs=1e-6)


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
@pytest.mark.parametrize(
    ("times", "message"),
    [
        (-1.0, "-1 times .* it seems to count backwards; change the sign"),
        (0.0, "0 times .* it seems to stand still"),
        (3.0, "3 times .* divide it by the ratio of the gear"),
        (0.51, "0.51 times .* divide it by the ratio of the gear"),
        (60 / 61, "0.9836 times .* 60 pulses per turn seems to be taken for one of 61"),
        (61 / 60, "1.017 times .* 61 pulses per turn seems to be taken for one of 60"),
        (math.pi / 180.0, "0.0175 times .* in degrees and the other one in radians"),
        (1.008, "1.008 times as fast as the drive"),
    ],
)
def test_a_driven_shaft_of_another_mean_speed_is_refused(
    of: str, times: float, message: str
) -> None:
    given: dict[str, Any] = {of: times * MOTION[of][1]}
    with pytest.raises(ValueError, match=f"{of} belongs to a shaft that turns {message}"):
        identify(ANGLES, **given)


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
@pytest.mark.parametrize("times", [0.997, 1.001, 1.004])
def test_the_interval_covers_a_small_error_of_scale(of: str, times: float) -> None:
    given: dict[str, Any] = {of: times * MOTION[of][1]}
    found, bend = identify(ANGLES, **given), float(TWO.equivalent().bend)
    assert found.mean_ratio == pytest.approx(times, abs=1e-5)
    assert 0.4 * found.std < abs(found.bend - bend) < 1.5 * found.std
    assert found.interval[0] < bend < found.interval[1]


@pytest.mark.parametrize(
    ("step", "count"),
    [(math.pi / 2, 4), (math.pi, 2), (math.tau, 1), (math.pi + 1e-4, 2), (math.tau / 5, 5)],
)
def test_samples_that_do_not_determine_a_bend_are_refused(step: float, count: int) -> None:
    angles = np.arange(400) * step
    noise = np.random.default_rng(1).normal(0.0, 1e-4, angles.size)
    motion = TWO.evaluate(angles + 0.4, ("angle_error", "speed_ratio"))
    message = f"drive_angle has samples at only {count} angles of a turn; a bend shows in samples"
    for values in ({"angle": angles + motion.angle_error}, {"speed_ratio": motion.speed_ratio}):
        for added in (0.0, noise):
            given: dict[str, Any] = {name: value + added for name, value in values.items()}
            with pytest.raises(ValueError, match=message):
                identify(angles, **given)


def test_samples_in_a_part_of_the_turn_are_refused() -> None:
    part = np.linspace(0.0, 2.0, 300)
    angles = np.concatenate([part, part + math.tau])
    with pytest.raises(ValueError, match="drive_angle has no samples in 245° of the turn"):
        identify(angles, angle=TWO.evaluate(angles, "angle").angle)


@pytest.mark.parametrize("step", [math.tau / 12, math.tau / 18, 2.4, math.tau / 60])
def test_samples_that_determine_a_bend(step: float) -> None:
    angles = np.arange(400) * step
    found = identify(angles, angle=TWO.evaluate(angles, "angle").angle)
    assert found.bend == pytest.approx(float(TWO.equivalent().bend), abs=1e-9)


def test_straight_joints_behind_a_coarse_counter() -> None:
    """Counts that never differ hide bends up to some; the interval does not say 0."""
    angles = np.arange(600) * math.tau / 30
    found = identify(angles, angle=angles)
    assert found.bend == 0.0
    step = math.tau / 30
    assert 0.3 * step < math.tan(found.interval[1] / 2.0) ** 2 < step


def test_parts_in_the_order_of_the_speed() -> None:
    """A bend that grows with the speed, whatever the order of the turns."""
    rng = np.random.default_rng(3)
    angles = np.linspace(0.0, 60.0 * math.tau, 6000)
    speed = rng.uniform(500.0, 2000.0, 61)[(angles / math.tau).astype(int)]
    k = 0.01 * (1.0 + speed / 4000.0)
    motion = angles - k * np.sin(2.0 * angles) + rng.normal(0.0, 1e-3, angles.size)
    found = identify(angles, angle=motion, drive_speed=speed)
    assert found.changes
    speeds = np.array([part.speed for part in found.parts])
    assert speeds.size == 6
    assert np.all(np.diff(speeds) > 0.0)
    for part in found.parts:
        bend = 2.0 * math.atan(math.sqrt(0.01 * (1.0 + part.speed / 4000.0)))
        assert abs(part.bend - bend) < 4.0 * part.std
    # Without the speeds, the turns are mixed.
    without = identify(angles, angle=motion)
    turns = [part.turn for part in without.parts]
    assert turns == pytest.approx([5.0, 14.5, 24.5, 34.5, 44.5, 54.5], abs=0.6)
    assert all(math.isnan(part.speed) for part in without.parts)
    assert np.std([part.bend for part in found.parts]) > 2.0 * np.std(
        [part.bend for part in without.parts]
    )


def test_a_steady_bend_does_not_change() -> None:
    angles = np.linspace(0.0, 60.0 * math.tau, 6000)
    noise = np.random.default_rng(3).normal(0.0, 1e-3, angles.size)
    found = identify(angles, angle=TWO.evaluate(angles, "angle").angle + noise)
    assert not found.changes
    assert len(found.parts) == 6


@pytest.mark.parametrize(
    ("drive", "driven"),
    [
        (ANGLES, MOTION.angle[1]),
        (ANGLES % math.tau, MOTION.angle[1]),
        (ANGLES, MOTION.angle[1] % math.tau),
        (ANGLES % math.tau, (MOTION.angle[1] + 2.0) % math.tau),
        (ANGLES, MOTION.angle[1] + 1.0 + 1e-3 * ANGLES),
        (ANGLES + 40.0 * math.tau, MOTION.angle[1]),
    ],
    ids=["plain", "drive modulo", "driven modulo", "both and offset", "drift", "turns apart"],
)
def test_counters_offsets_and_drift_do_not_matter(drive: FloatArray, driven: FloatArray) -> None:
    found = identify(drive, angle=driven)
    assert abs(found.q - TWO.transmission().q) < 1e-13
    in_degrees = identify(np.degrees(drive), angle=np.degrees(driven), degrees=True)
    assert abs(in_degrees.q - found.q) < 1e-13


def test_missing_samples_are_left_out() -> None:
    driven = MOTION.angle[1].copy()
    driven[::7] = np.nan
    found = identify(ANGLES, angle=driven)
    assert found.samples == np.count_nonzero(np.isfinite(driven))
    assert abs(found.q - TWO.transmission().q) < 1e-13


def test_three_encoders_tell_both_joints_and_the_phase() -> None:
    found = identify_two_joints(ANGLES, MOTION.angle[0], MOTION.angle[1])
    assert found.bends_deg == pytest.approx([14.0, 9.0], abs=1e-11)
    assert found.std.shape == (2,)
    assert np.all(np.abs(found.intervals - found.bends[:, np.newaxis]) < 1e-9)
    assert found.phase_less_twist_deg == pytest.approx(-10.0, abs=1e-10)
    turned = Driveline.from_bends([14, 9], twists=0, phases=70, degrees=True)
    motion = turned.evaluate(ANGLES, "angle", shafts=[1, 2]).angle
    # Another zero of the drive's encoder.
    found = identify_two_joints(ANGLES + 0.3, motion[0], motion[1])
    assert found.phase_less_twist_deg == pytest.approx(70.0, abs=1e-10)


def test_the_second_bend_has_the_uncertainty_of_the_last_encoder() -> None:
    line = Driveline.from_bends([60, 50], phases=0, degrees=True)
    motion = line.evaluate(ANGLES, "angle", shafts=[1, 2]).angle
    motion[1] += np.random.default_rng(3).normal(0.0, 1e-6, ANGLES.size)
    found = identify_two_joints(ANGLES, motion[0], motion[1])
    one, both = found.first.q, found.whole.q

    def k(change: complex) -> float:
        """``tan(bend/2)**2`` of the second joint with another motion of the last shaft."""
        return abs((both + change - one) / (1.0 - (both + change) * one.conjugate()))

    step = 1e-7
    slopes = [(k(step * way) - k(-step * way)) / (2.0 * step) for way in (1.0, 1j)]
    wanted = math.hypot(*slopes) * found.whole.std_q / (np.sqrt(k(0.0)) * (1.0 + k(0.0)))
    assert found.std[1] == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
def test_the_standard_deviation_is_that_of_many_recordings(of: str) -> None:
    noise, clean, count = 1e-3, MOTION[of][1], tiers.part(100)
    rng = np.random.default_rng(13)
    found = [
        identify(ANGLES, **{of: clean + rng.normal(0.0, noise, clean.size)}) for _ in range(count)
    ]
    bends = np.array([one.bend for one in found])
    spread = float(np.std(bends))
    std = math.sqrt(np.mean([one.std**2 for one in found]))
    # The spread of 100 recordings is itself known to 7 %, that of 25 to 14 %.
    assert spread == pytest.approx(std, rel=2.8 / math.sqrt(2 * count))
    k = float(TWO.equivalent().k)
    by_theory = noise * math.sqrt(2.0 / ANGLES.size) / (math.sqrt(k) * (1.0 + k))
    assert std == pytest.approx(by_theory * (1.0 if of == "angle" else 0.5), rel=0.1)
    assert abs(bends.mean() - TWO.equivalent().bend) < 4.0 * spread / math.sqrt(count)
    assert all(one.detected for one in found)
    assert found[0].residual == pytest.approx(noise, rel=0.05)


def test_noise_alone_is_no_bend() -> None:
    rng = np.random.default_rng(13)
    noise = rng.normal(0.0, 1e-3, (tiers.part(80), ANGLES.size))
    found = [identify(ANGLES, angle=ANGLES + one) for one in noise]
    assert sum(one.detected for one in found) <= 2
    assert found[0].bend > 0.0


def test_what_is_no_joint_shows_in_the_purity() -> None:
    assert identify(ANGLES, angle=MOTION.angle[1]).purity == pytest.approx(1.0, abs=1e-6)
    oval = identify(ANGLES, angle=ANGLES + 0.01 * np.sin(2.0 * ANGLES + 0.3))
    assert oval.purity < 1e-6
    both = MOTION.angle[1] + 0.01 * np.sin(4.0 * ANGLES)
    assert identify(ANGLES, angle=both).purity > 10.0


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
def test_the_noise_of_the_purity_is_known(of: str) -> None:
    noise, motion = 2e-3, Driveline.from_bends([25.0], degrees=True).evaluate(ANGLES, of)[of]

    def found(values: FloatArray) -> Identification:
        recorded: dict[str, Any] = {of: values}
        return identify(ANGLES, **recorded)

    rng, count = np.random.default_rng(13), tiers.part(100)
    noisy = [found(motion + rng.normal(0.0, noise, ANGLES.size)) for _ in range(count)]
    spread = np.std([one.purity for one in noisy])
    std = math.sqrt(np.mean([one.std_purity**2 for one in noisy]))
    assert spread == pytest.approx(std, rel=2.8 / math.sqrt(2 * count))
    assert found(motion).std_purity < 1e-9


def test_eccentric_encoders_do_not_reach_the_bend() -> None:
    eccentric = 0.02 * np.sin(ANGLES + 1.0) + 0.005 * np.cos(3.0 * ANGLES)
    found = identify(ANGLES, angle=MOTION.angle[1] + eccentric)
    assert found.bend == pytest.approx(float(TWO.equivalent().bend), abs=1e-12)
    assert abs(found.orders[1]) == pytest.approx(0.02, rel=1e-6)
    assert abs(found.orders[3]) == pytest.approx(0.005, rel=1e-6)


test_refused = refusals(
    {
        "angle or speed_ratio must be given, and not both": {},
        "angle or speed_ratio must be given, and not": {"angle": ANGLES, "speed_ratio": ANGLES},
        "angle has 2999 samples and drive_angle 3000": {"angle": ANGLES[:-1]},
        "angle has shape (1, 3000); it must be (samples,)": {"angle": [ANGLES]},
        "drive_speed has 2999 samples and drive_": {"angle": ANGLES, "drive_speed": ANGLES[1:]},
        "drive_angle has 0 finite samples over 0.00 turns": {"angle": np.full(3000, np.nan)},
    },
    lambda **arguments: identify(ANGLES, **arguments),
)


def test_less_than_a_turn_is_refused() -> None:
    part = np.linspace(0.0, 5.0, 500)
    with pytest.raises(ValueError, match=r"500 finite samples over 0\.80 turns"):
        identify(part, angle=part)
    with pytest.raises(ValueError, match="it takes at least one turn and 18 samples"):
        identify(ANGLES[::300], angle=ANGLES[::300])


@pytest.mark.parametrize("of", ["angle", "speed_ratio"])
def test_orders_are_those_of_the_closed_forms(of: str) -> None:
    mean = 0.25 if of == "angle" else 0.0
    found = identify(ANGLES, **{of: MOTION[of][1] + mean})
    series = TWO.harmonics(range(1, 9))
    wanted = series.angle_error if of == "angle" else series.speed_ratio
    assert np.abs(found.orders[1:]) == pytest.approx(wanted, abs=1e-13)
    assert found.orders[0] == pytest.approx(0.25 if of == "angle" else 1.0, abs=1e-13)
    waves = np.exp(-1j * np.outer(ANGLES, np.arange(9)))
    shown = MOTION.angle[1] - ANGLES if of == "angle" else MOTION.speed_ratio[1]
    # Order 10 is left out.
    assert (waves @ found.orders).real - mean == pytest.approx(
        shown, abs=3.0 * float(TWO.equivalent().k) ** 5
    )
