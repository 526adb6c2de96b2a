"""What must hold for every driveline, whatever the formulas."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
from hypothesis import given

from cardan import Driveline, Load

EPS = 2.0**-52
TURN = np.linspace(0, 2 * math.pi, 512, endpoint=False)
MOTION = ("angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")


@st.composite
def lines(draw: st.DrawFn, most: int = 5) -> Driveline:
    """Random drivelines with straight joints among them."""
    n = draw(st.integers(1, most))
    bend = st.one_of(st.just(0.0), st.floats(1e-6, 1.2))
    bends = draw(st.lists(bend, min_size=n, max_size=n))
    angles = draw(st.lists(st.floats(-4, 4), min_size=2 * (n - 1), max_size=2 * (n - 1)))
    return Driveline.from_bends(bends, angles[: n - 1], angles[n - 1 :])


def unit(line: Driveline) -> float:
    """Rounding of a few operations per joint, stretched as the joints stretch it."""
    return 64 * line.n_joints * EPS / float(np.prod(np.cos(line.bends))) ** 3


def unit_of(line: Driveline, name: str) -> float:
    """Return the same of an output: the third derivative is stretched once more."""
    return unit(line) * (8 / float(np.prod(np.cos(line.bends))) if name == "jerk_ratio" else 1)


@given(lines())
def test_the_mean_speed_ratio_is_one(line: Driveline) -> None:
    ratio = line.evaluate(np.linspace(0, math.pi, 4096, endpoint=False), "speed_ratio").speed_ratio
    # The trapezoid rule leaves k**4096.
    assert abs(float(np.mean(ratio)) - 1) < unit(line)


@given(lines())
def test_half_a_turn_repeats(line: Driveline) -> None:
    first, second = line.evaluate(TURN, MOTION), line.evaluate(TURN + math.pi, MOTION)
    for name in MOTION:
        assert np.max(np.abs(first[name] - second[name])) < 4 * unit_of(line, name), name


@given(lines())
def test_the_mean_angle_error_is_zero(line: Driveline) -> None:
    grid = np.linspace(0, math.pi, 4096, endpoint=False)
    error = line.evaluate(grid, "angle_error").angle_error
    assert abs(float(np.mean(error))) < unit(line)


@given(lines())
def test_the_mean_of_acceleration_and_jerk_is_zero(line: Driveline) -> None:
    grid = np.linspace(0, math.pi, 4096, endpoint=False)
    names = ("acceleration_ratio", "jerk_ratio")
    got = line.evaluate(grid, names)
    for name in names:
        assert abs(float(np.mean(got[name]))) < unit_of(line, name), name


@given(lines())
def test_rates_are_derivatives(line: Driveline) -> None:
    # Central differences of sixth order, step 1e-3.
    h, weights = 1e-3, np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    grid = TURN[:, np.newaxis] + h * np.arange(-3, 4)
    got = line.evaluate(grid, MOTION)
    stiff = float(np.prod(np.cos(line.bends))) ** -7
    ratio = 1 + got.angle_error @ weights / h
    assert np.max(np.abs(ratio - got.speed_ratio[:, 3])) < 1e-10 * stiff
    acceleration = got.speed_ratio @ weights / h
    assert np.max(np.abs(acceleration - got.acceleration_ratio[:, 3])) < 1e-10 * stiff
    jerk = got.acceleration_ratio @ weights / h
    assert np.max(np.abs(jerk - got.jerk_ratio[:, 3])) < 1e-9 * stiff / np.prod(np.cos(line.bends))


@given(st.floats(0, 1.2), st.floats(0, 1.2), st.floats(-4, 4), st.floats(-4, 4))
def test_a_second_joint_follows_the_chain_rule(
    first: float, second: float, twist: float, phase: float
) -> None:
    line = Driveline.from_bends([first, second], twist, phase)
    before = line.evaluate(TURN, ("angle", *MOTION), shafts=1)
    # Behind one joint the mean-synchronous angle is that of the pin.
    drive = before.angle + phase - twist + math.pi / 2
    own = Driveline.from_bends([second]).evaluate(drive, MOTION)
    r, a, j = (before[name] for name in MOTION[1:])
    want = own.jerk_ratio * r**3 + 3 * own.acceleration_ratio * r * a + own.speed_ratio * j
    got = line.evaluate(TURN, "jerk_ratio").jerk_ratio
    assert np.max(np.abs(got - want)) < unit_of(line, "jerk_ratio")


@given(lines())
def test_jerk_vanishes_where_acceleration_is_extreme(line: Driveline) -> None:
    joint = line.equivalent()
    if joint.bend < 1e-3:
        return
    # cos 2a = (sqrt(p^2 + 8) - p)/2 of the equivalent joint's angle.
    p = 2 / math.sin(float(joint.bend)) ** 2 - 1
    steepest = 0.5 * math.acos(4 / (p + math.sqrt(p * p + 8)))
    angle = np.array([-steepest, steepest]) - float(joint.angle_offset)
    got = line.evaluate(angle, "jerk_ratio").jerk_ratio
    assert np.max(np.abs(got)) < unit_of(line, "jerk_ratio")


@given(lines())
def test_reversing_inverts(line: Driveline) -> None:
    # The reversed driveline at the drive angle at which its shafts stand as those of the first.
    back = line.reversed()
    bend = float(line.bends[-1])
    if bend < 1e-3:
        return
    got = line.evaluate(TURN, ("speed_ratio", "tilt_driving", "tilt_driven"), joints=-1)
    # sin psi_2 = sin b cos a and tan psi_1 = tan b sin a of the last joint; reversed, the two tilts
    # change places, which gives the driving angle at the other end.
    cosine = np.sin(got.tilt_driving) / math.sin(bend)
    sine = np.tan(got.tilt_driven) / math.tan(bend)
    drive = np.arctan2(sine, cosine)
    inverse = back.evaluate(drive, "speed_ratio").speed_ratio
    assert np.max(np.abs(inverse * got.speed_ratio - 1)) < unit(line) / math.sin(bend) ** 2


def test_far_angles_of_either_sign_keep_the_sense_of_the_pins() -> None:
    """Half a turn, after which the motion repeats, changes the sign of the tilts."""
    bend, angle = 0.4, np.multiply.outer([1.0, -1.0], 10.0 ** np.arange(12, 309))
    got = Driveline.from_bends([bend]).evaluate(angle, ("tilt_driving", "tilt_driven"), joints=0)
    sine = np.tan(got.tilt_driving) / math.tan(bend)
    cosine = np.sin(got.tilt_driven) / math.sin(bend)
    assert np.max(np.abs([cosine - np.cos(angle), sine - np.sin(angle)])) < 16 * EPS


@given(st.floats(1e-6, 1.5), st.floats(-4, 4))
def test_two_equal_joints_in_phase_cancel(bend: float, twist: float) -> None:
    line = Driveline.from_bends([bend, bend], twist, twist)
    assert float(line.equivalent().k) <= 4 * EPS / math.cos(bend)
    got = line.evaluate(TURN, MOTION)
    assert np.max(np.abs(got.angle_error)) <= 8 * EPS / math.cos(bend)


@given(lines(), st.floats(-5, 5))
def test_loads_add_up(line: Driveline, factor: float) -> None:
    inertias = np.linspace(0.1, 1.0, line.n_joints + 1)
    names = ("torque", "moment", "support_moment")
    still = line.evaluate(TURN, names, load=Load(output_torque=factor))
    moving = line.evaluate(TURN, names, load=Load(speed=3.0, inertias=inertias))
    both = line.evaluate(TURN, names, load=Load(output_torque=factor, speed=3.0, inertias=inertias))
    for name in names:
        total = still[name] + moving[name]
        scale = np.max(np.abs(still[name])) + np.max(np.abs(moving[name])) + 1
        assert np.max(np.abs(both[name] - total)) < unit(line) * scale, name
