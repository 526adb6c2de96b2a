"""Largest values over a turn: closed forms, exact numbers, and a million samples."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

import tiers
from cardan import OUTPUTS, Driveline, Load, Sweep
from cardan.app.answers.turn.extremes import peak, peaks
from cardan.arrays import FloatArray

SEARCHED = (
    *("torque", "support_moment", "moment", "bending_driving", "bending_driven"),
    *("tilt_driving", "tilt_driven", "jerk_ratio"),
)


def sizes(line: Driveline, name: str, item: int, load: Load, angle: FloatArray) -> FloatArray:
    values = line.evaluate(angle, [name], load=load)[name]
    if OUTPUTS[name].per == "shaft":
        values = line.evaluate(angle, [name], load=load, shafts=[item])[name][0]
    else:
        values = values[item]
    found: FloatArray = np.linalg.norm(values, axis=-1) if OUTPUTS[name].vector else np.abs(values)
    return found


@pytest.mark.parametrize("degrees", [1, 30, 44.9, 45.1, 60, 80, 89, 89.9, 89.99999, 90 - 1e-9])
def test_one_joint_has_closed_forms(degrees: float) -> None:
    """Drive and output torque of 1 N m; each form is the largest of Grossmann's over a turn."""
    bend = math.radians(degrees)
    line, driven, driving = (
        Driveline.from_bends([bend]),
        Load(drive_torque=1),
        Load(output_torque=1),
    )
    c, s, t = (float(f(bend)) for f in (mpmath.cos, mpmath.sin, mpmath.tan))
    c2, s2 = c * c, s * s
    # With 1 N m at the drive the bending moment of the driven shaft is s cos a sqrt(1 + t² sin² a),
    # which is largest at sin² a = (t² - 1)/(2 t²) from 45 degrees on.
    bending = s if t <= 1.0 else 1.0 / (2.0 * c)
    # With 1 N m delivered the torques and moments are those times the speed ratio.
    forms = [
        ("torque", 1, driven, 1 / c),
        ("moment", 0, driven, 1 / c),
        ("bending_driving", 0, driven, t),
        ("support_moment", 0, driven, t),
        ("bending_driven", 0, driven, bending),
        ("support_moment", 1, driven, bending),
        ("torque", 0, driving, 1 / c),
        ("moment", 0, driving, 1 / c),
        ("bending_driven", 0, driving, t),
        ("bending_driving", 0, driving, s if t <= 1.0 else 1 / (2 * c)),
        ("tilt_driving", 0, driven, bend),
        ("tilt_driven", 0, driven, bend),
        ("jerk_ratio", 1, driven, 2 * s2 / (c2 * c)),
    ]
    for name, item, load, value in forms:
        found = peak(line, name, item, load)
        # The ulp of the angle that is left below 90 degrees bounds what a cosine can be.
        assert found.value == pytest.approx(value, rel=1e-12), (name, item, load.end)
        assert all(0.0 <= place < math.pi for place in found.places)
        at_place = sizes(line, name, item, load, np.array(found.places))
        # As exact as the place is as a double, beside a peak that is narrow.
        np.testing.assert_allclose(at_place, found.value, rtol=1e-12 + (4e-16 / c) ** 2)


def test_flywheel_has_a_closed_form() -> None:
    """Thoma's (8): the torque is the inertia times the largest acceleration."""
    for degrees in (3.0, 30.0, 85.0, 89.9):
        line = Driveline.from_bends([degrees], degrees=True)
        found = peak(line, "torque", 1, Load(speed=10.0, inertias=[0.0, 0.3]))
        acceleration = float(line.equivalent().max_acceleration_ratio)
        assert found.value == pytest.approx(0.3 * 100.0 * acceleration, rel=1e-12)


def test_exactly_in_forty_digits() -> None:
    """The bending moment between two joints, searched by mpmath where it is largest."""
    bends, twist, phase = (0.5, 1.2), 0.7, 0.3
    line = Driveline.from_bends(bends, [twist], [phase])
    found = peak(line, "bending_driven", 1, Load(drive_torque=1.0))
    with mpmath.workdps(40):
        first, second = (mpmath.mpf(bend) for bend in bends)

        def bending(angle: mpmath.mpf) -> mpmath.mpf:
            c, s = mpmath.cos(angle), mpmath.sin(angle)
            torque = (c**2 * mpmath.cos(first) ** 2 + s**2) / mpmath.cos(first)
            # The driven pin, counted from its bend plane, and the shaft between the joints.
            w = mpmath.expj(angle) - mpmath.tan(first / 2) ** 2 * mpmath.expj(-angle)
            own = mpmath.arg(w) + phase - mpmath.mpf(twist) + mpmath.pi / 2
            slope = mpmath.sqrt(1 + mpmath.tan(second) ** 2 * mpmath.sin(own) ** 2)
            return torque * mpmath.sin(second) * abs(mpmath.cos(own)) * slope

        steps = [mpmath.pi * i / 2000 for i in range(2000)]
        start = max(steps, key=bending)
        place = mpmath.findroot(lambda a: mpmath.diff(bending, a), start)
        assert found.value == pytest.approx(float(bending(place)), rel=1e-14)
        assert min(abs(at - float(place)) for at in found.places) < 1e-7


def chains() -> list[Driveline]:
    """Chains of ordinary and of steep joints."""
    chance = np.random.default_rng(7)
    made = []
    for joints in (1, 2, 2, 3, 3, 4, 5, 8):
        steep = 90.0 - 10.0 ** chance.uniform(-2.5, 1.5, joints)
        bends = np.where(chance.random(joints) < 0.5, chance.uniform(0, 60, joints), steep)
        turned = chance.uniform(-180, 180, (2, joints - 1))
        made.append(Driveline.from_bends(bends, *turned, degrees=True))
    return made


@pytest.mark.parametrize("line", chains(), ids=lambda line: f"{line.n_joints} joints")
def test_no_sample_of_many_is_larger(line: Driveline) -> None:
    """Nor is the largest of many less by more than samples miss, where peaks are wide."""
    count = tiers.part(200_000) + 1
    sweep = np.asarray(Sweep(0.0, math.tau, count))
    inertias = np.linspace(0.0, 1.0, line.n_joints + 1)
    for load in (Load(drive_torque=2.0), Load(speed=9.0, acceleration=4.0, inertias=inertias)):
        for name in SEARCHED:
            for item in {0, line.n_joints - 1}:
                found = peak(line, name, item, load)
                many = sizes(line, name, item, load, sweep)
                largest = float(np.max(many))
                assert largest <= found.value * (1.0 + 1e-13)
                if not found.places:
                    assert np.ptp(many) <= 2e-9 * found.value
                elif np.max(line.bends) < 1.4:
                    assert found.value == pytest.approx(largest, rel=1e-6)
                # The value is there, and not between what doubles can hold.
                at_place = sizes(line, name, item, load, np.array([0.0, *found.places]))[1:]
                np.testing.assert_allclose(at_place, found.value, rtol=1e-6)


@pytest.mark.parametrize("degrees", [89.0, 89.9, 89.99])
def test_narrow_peaks_are_found(degrees: float) -> None:
    """The drive's torque is narrow by what is left of 90 degrees, and lies between round angles."""
    line = Driveline.from_bends([20.0, degrees], [37.0], [11.0], degrees=True)
    joint = line.equivalent()
    found = peak(line, "torque", 0, Load(output_torque=3.0))
    assert found.value == pytest.approx(3.0 * float(joint.max_speed_ratio), rel=1e-12)
    assert found.places == pytest.approx([-float(joint.angle_offset) % math.pi], abs=1e-9)


def test_what_is_the_same_everywhere_has_no_place() -> None:
    line = Driveline.from_bends([20.0, 20.0], degrees=True)
    assert peak(line, "torque", 2, Load(drive_torque=3.0)).places == ()
    assert peak(line, "torque", 0, Load(drive_torque=0.0)).value == 0.0
    assert peak(Driveline.from_bends([0.0]), "moment", 0, Load(drive_torque=3.0)).places == ()


def test_a_load_too_large_for_doubles_has_no_place() -> None:
    found = peak(Driveline.from_bends([1.5]), "moment", 0, Load(drive_torque=1e308))
    # Its largest length is 14 times as much.
    assert (found.value, found.places) == (math.inf, ())


def test_a_batch_has_the_peaks_of_each_driveline() -> None:
    """Of several items and drivelines, bearings as well, in the order of both."""
    heights = (0.02, 0.05, 0.11)
    points = np.array([[[0, 0, 0], [0.3, y, 0], [1.2, -y, 0.1], [1.6, 0, 0.1]] for y in heights])
    lines = Driveline.from_points(points).with_bearings([(0, 0.1), (0, 0.2), (2, 0.1), (2, 0.3)])
    torques = [1.0, 2.0, 5.0]
    cases = {"torque": [2, 1], "joint_force": [0, 1], "bearing_force": [3, 0, 1]}
    for name, items in cases.items():
        found = peaks(lines, name, items, Load(drive_torque=torques))
        each = [
            peak(lines[i], name, item, Load(drive_torque=torques[i])).value
            for item in items
            for i in range(3)
        ]
        np.testing.assert_allclose(found.ravel(), each, rtol=1e-14)
    least = peaks(lines, "speed_ratio", [2], is_least=True)
    np.testing.assert_allclose(least[0], lines.equivalent().min_speed_ratio, rtol=1e-12)
