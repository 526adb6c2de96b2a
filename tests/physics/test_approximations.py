"""Thoma's equations by number, his small-angle forms and the workshop rules, with their errors.

D. Thoma, "Das Kräftespiel im Kreuzgelenk", Schweizerische Bauzeitung 75/76 (1920).
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import pytest

from cardan import Driveline, Load, approximations
from cardan.reference.approximations import (
    ThomaMoments,
    catalogue_bend,
    inertia_bend,
    inertia_excitation,
    thoma_moment_ratios,
    thoma_small_angle,
    torsional_excitation,
)
from oracle import EPS, Doubles, distinct, mp, radians, read
from refusals import refusals

RIGHT = math.pi / 2
RPM = 2 * math.pi / 60
CASES = read("thoma_small_angle.json")["cases"]
SINGLE = read("single_moments.json")["cases"]

# --- Thoma by equation -----------------------------------------------------------------------

TURN = np.linspace(-math.pi, math.pi, 721)
BENDS = [1e-4, math.radians(8.5), math.radians(30), math.radians(60), 1.5]
bends = pytest.mark.parametrize("bend", BENDS)


def close(got: Doubles, want: Doubles, scale: float = 1.0) -> None:
    assert np.max(np.abs(got - want)) <= 1e-14 * scale


def driven(bend: float) -> Doubles:
    """Return his psi over his phi: the library's angle."""
    angle: Doubles = Driveline.from_bends([bend]).evaluate(TURN, "angle").angle
    return angle


def arms(bend: float) -> tuple[Doubles, Doubles]:
    """Return the arms of the cross as (1) and (2) give their direction cosines."""
    phi, psi = TURN, driven(bend)
    first = [np.cos(phi) * math.cos(bend), -np.cos(phi) * math.sin(bend), np.sin(phi)]
    second = [-np.sin(psi), np.zeros_like(psi), np.cos(psi)]
    return np.stack(first, axis=-1), np.stack(second, axis=-1)


def his_axes(bend: float) -> Doubles:
    """Return the library's x, y and z as rows in Thoma's axes, read as right-handed ones.

    x is along the driving shaft, z across both shafts as his, y where his driving arm starts.
    """
    s, c = math.sin(bend), math.cos(bend)
    return np.array([[-s, -c, 0.0], [c, -s, 0.0], [0.0, 0.0, 1.0]])


def exact(bend: float, angle: Doubles, inertia: float = 1.0, speed: float = 1.0) -> ThomaMoments:
    """Return Mt, Mx and Mz of a flywheel on the driven shaft: ``-(Mx, Mt, Mz)`` is the vector."""
    load = Load(speed=speed, inertias=[0.0, inertia])
    result = Driveline.from_bends([bend]).evaluate(angle, "moment", joints=0, load=load)
    x, y, z = (-result.moment @ his_axes(bend)).T
    return ThomaMoments(y, x, z)


@bends
def test_thoma_1_and_2_arms_of_the_cross(bend: float) -> None:
    first, second = arms(bend)
    # Unit vectors, across their shafts and, because the library's angle is his psi, each other.
    driving, driven_shaft = his_axes(bend)[0], np.array([0.0, -1.0, 0.0])
    one = np.ones_like(TURN)
    for arm, shaft in ((first, driving), (second, driven_shaft)):
        close((arm**2).sum(axis=1), one)
        close(arm @ shaft, 0 * one)
    close((first * second).sum(axis=1), 0 * one, 1 / math.cos(bend))
    # Both turn right-handed about the direction of the power flow, which is -y.
    for arm, shaft in ((first, driving), (second, driven_shaft)):
        step = np.cross(arm[:-1], arm[1:]) @ shaft
        assert np.all(step > 0)


@bends
def test_thoma_3_driven_angle(bend: float) -> None:
    square = np.sin(TURN) ** 2
    want = square / (math.cos(bend) ** 2 + (1 - math.cos(bend) ** 2) * square)
    close(np.sin(driven(bend)) ** 2, want, 1 / math.cos(bend) ** 2)


@bends
def test_thoma_4_driven_angle(bend: float) -> None:
    phi = np.linspace(-1.5, 1.5, 301)
    psi = Driveline.from_bends([bend]).evaluate(phi, "angle").angle
    close(psi, np.arctan(np.tan(phi) / math.cos(bend)), 1 / math.cos(bend))


@bends
def test_thoma_5_to_7_bending_moments(bend: float) -> None:
    first, second = arms(bend)
    ratios = thoma_moment_ratios(TURN, bend)
    # (5): the moment is normal to both arms, so its components are as the direction cosines.
    normal = np.cross(first, second)
    scale = 1 / math.cos(bend) ** 2
    close(ratios.x * normal[:, 1], normal[:, 0], scale)
    close(ratios.z * normal[:, 1], normal[:, 2], scale)
    # (6) and (7) as they are printed, away from the poles of the tangent.
    phi = np.linspace(-1.5, 1.5, 301)
    under = math.cos(bend) ** 2 + np.tan(phi) ** 2
    ratios = thoma_moment_ratios(phi, bend)
    close(ratios.x, math.sin(bend) * math.cos(bend) / under, scale)
    close(ratios.z, math.sin(bend) * np.tan(phi) / under, scale)
    # They hold for any torque: here that of a drive which puts 1 N m into shaft I.
    load = Load(drive_torque=1.0)
    result = Driveline.from_bends([bend]).evaluate(phi, "moment", joints=0, load=load)
    x, y, z = (result.moment @ his_axes(bend)).T
    close(ratios.x * y, x, scale)
    close(ratios.z * y, z, scale)


@pytest.mark.parametrize("beta", distinct(SINGLE, "beta_deg"))
def test_thoma_6_and_7_against_the_vector_model(beta: str) -> None:
    bend = radians(beta)
    for row in SINGLE:
        if row["beta_deg"] == beta:
            x, y, z = (float(v) for v in row["static"]["M_on_shaft2_xyz"])
            ratios = thoma_moment_ratios(radians(row["phi_deg"]), bend)
            # Conditioning, as the pins turn up to 1/cos times as fast as the drive.
            slack = 4 * EPS / math.cos(bend) ** 2
            assert abs(ratios.x - x / y) <= slack
            assert abs(ratios.z - z / y) <= slack


@bends
def test_thoma_6_and_7_keep_their_digits(bend: float) -> None:
    angles = [0.0, 1e-300, 1e-9, 0.3, RIGHT - 1e-9, RIGHT, 2.0, math.pi, 1e4]
    got = thoma_moment_ratios(angles, bend)
    for i, angle in enumerate(angles):
        s, c, beta = mp.sin(angle), mp.cos(angle), mp.mpf(bend)
        under = (c * mp.cos(beta)) ** 2 + s**2
        for value, want in (
            (got.x[i], mp.sin(beta) * mp.cos(beta) * c * c / under),
            (got.z[i], mp.sin(beta) * s * c / under),
        ):
            assert abs(value - want) <= 8 * EPS * abs(want)


@bends
def test_thoma_8_torque_of_the_flywheel(bend: float) -> None:
    # Printed as (3): inertia times the square of the speed times the second derivative of psi.
    inertia, speed = 0.7, 30.0
    line = Driveline.from_bends([bend])
    rate = line.evaluate(TURN, "acceleration_ratio").acceleration_ratio
    unit = inertia * speed**2
    got = exact(bend, TURN, inertia, speed)
    largest = float(line.equivalent().max_acceleration_ratio)
    close(got.torque / unit, rate, largest / math.cos(bend))
    # It is positive about the driven shaft as that points along the power flow, -y.
    ratios = thoma_moment_ratios(TURN, bend)
    close(got.moment_x / unit, ratios.x * rate, 10 * largest / math.cos(bend) ** 2)
    close(got.moment_z / unit, ratios.z * rate, 10 * largest / math.cos(bend) ** 2)


# --- Thoma's small-angle forms ---------------------------------------------------------------


def test_thoma_small_angle_forms_as_printed() -> None:
    inertia, speed, bend = 0.02, 150.0, math.radians(8.5)
    got = thoma_small_angle(TURN, bend, inertia, speed)
    unit = inertia * speed**2 * (1 - math.cos(bend))
    sine = math.sin(bend)
    four = 0.5 * np.sin(4 * TURN)
    close(got.torque, -2 * unit * np.sin(2 * TURN), unit)
    close(got.moment_x, -unit * sine * (np.sin(2 * TURN) + four), unit)
    close(got.moment_z, -0.5 * unit * sine * (1 - np.cos(4 * TURN)), unit)


def test_thoma_small_angle_forms_keep_their_digits() -> None:
    bend = 1e-9
    got = thoma_small_angle([1e-100, 0.3, 2.0], bend, 1.0, 1.0)
    for i, angle in enumerate([1e-100, 0.3, 2.0]):
        with mp.workdps(60):
            s, c, beta = mp.sin(angle), mp.cos(angle), mp.mpf(bend)
            torque = -4 * (1 - mp.cos(beta)) * s * c
            wants = torque, torque * mp.sin(beta) * c * c, torque * mp.sin(beta) * s * c
        for value, want in zip((g[i] for g in got), wants, strict=True):
            assert abs(value - want) <= 8 * EPS * abs(want)


def test_his_signs_as_a_vector_in_right_handed_axes() -> None:
    # The trap: the moment on shaft II is -(Mx, Mt, Mz). At 0.01 rad the forms are good to 1e-4.
    bend, inertia, speed = 0.01, 3.0, 40.0
    load = Load(speed=speed, inertias=[0.0, inertia])
    line = Driveline.from_bends([bend])
    moment = line.evaluate(TURN, "moment", joints=0, load=load).moment @ his_axes(bend)
    mt, mx, mz = thoma_small_angle(TURN, bend, inertia, speed)
    for i, component in enumerate((mx, mt, mz)):
        largest = np.max(np.abs(component))
        assert np.max(np.abs(moment[:, i] + component)) <= 2e-4 * largest
        assert np.max(np.abs(moment[:, i] - component)) >= 1.9 * largest
    # Along the driven shaft the vector has +Mt.
    along = line.evaluate(TURN, "moment", joints=0, load=load).moment @ line.directions[1]
    assert np.max(np.abs(along - mt)) <= 2e-4 * np.max(np.abs(mt))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["bend_deg"])
def test_errors_of_the_small_angle_forms(case: dict[str, Any]) -> None:
    bend = radians(case["bend_deg"])
    angle = np.linspace(0, 2 * math.pi, 20_001)
    right, approximate = exact(bend, angle), thoma_small_angle(angle, bend, 1.0, 1.0)
    for name, e, a in zip(("Mt", "Mx", "Mz"), right, approximate, strict=True):
        row = case[name]
        peak, peak_small = np.max(np.abs(e)), np.max(np.abs(a))
        # The grid misses a peak by half a step.
        assert peak == pytest.approx(float(row["peak"]), rel=1e-6)
        assert peak_small == pytest.approx(float(row["peak_small_angle"]), rel=1e-6)
        assert peak_small / peak - 1 == pytest.approx(float(row["error_of_peak"]), abs=2e-6)
        largest = np.max(np.abs(a - e)) / peak
        assert largest == pytest.approx(float(row["largest_error"]), rel=1e-5)
    mean = np.mean(approximate.moment_z[:-1])
    assert mean == pytest.approx(float(case["mean_Mz_small_angle"]), rel=1e-12)


@pytest.mark.parametrize(
    ("degrees", "low", "largest"),
    [("8.5", (0.6, 2.2, 1.7), (1.5, 2.7, 2.5)), ("30", (9, 26, 21), (20, 31, 30))],
)
def test_errors_that_the_documentation_states(
    degrees: str, low: tuple[float, ...], largest: tuple[float, ...]
) -> None:
    (case,) = (case for case in CASES if case["bend_deg"] == degrees)
    digits = 1 if degrees == "8.5" else 0
    rows = [case[name] for name in ("Mt", "Mx", "Mz")]
    assert tuple(round(-100 * float(row["error_of_peak"]), digits) for row in rows) == low
    assert tuple(round(100 * float(row["largest_error"]), digits) for row in rows) == largest
    text = thoma_small_angle.__doc__ or ""
    for numbers in (low, largest):
        assert f"{', '.join(map(str, numbers))} %" in text


def test_the_relative_error_is_of_the_order_of_one_less_the_cosine() -> None:
    # Not of its square, as Thoma's wording suggests.
    angle: Doubles = np.linspace(0, math.pi, 2001)
    for bend in (1e-3, 1e-2, 1e-1):
        right, approximate = exact(bend, angle), thoma_small_angle(angle, bend, 1.0, 1.0)
        for e, a, constant in zip(right, approximate, (1.37, 2.45, 2.27), strict=True):
            error = np.max(np.abs(a - e)) / np.max(np.abs(e))
            assert error / (1 - math.cos(bend)) == pytest.approx(constant, rel=0.02)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["bend_deg"])
def test_mean_of_the_bending_moment_across_the_shafts(case: dict[str, Any]) -> None:
    bend, inertia, speed = radians(case["bend_deg"]), 0.4, 60.0
    unit = inertia * speed**2
    # Equal steps over a turn integrate a trigonometric polynomial exactly.
    angle: Doubles = np.linspace(0, 2 * math.pi, 256, endpoint=False)
    mean = np.mean(exact(bend, angle, inertia, speed).moment_z)
    assert mean == pytest.approx(-0.25 * unit * math.sin(bend) * math.tan(bend) ** 2, rel=1e-12)
    assert mean / unit == pytest.approx(float(case["mean_Mz"]), rel=1e-12)
    small = np.mean(thoma_small_angle(angle, bend, inertia, speed).moment_z)
    versine = 2 * math.sin(bend / 2) ** 2
    assert small == pytest.approx(-0.5 * unit * math.sin(bend) * versine, rel=1e-12)


# --- catalogue and workshop rules ------------------------------------------------------------


@pytest.mark.parametrize("case", read("aligned_bends.json")["cases"], ids=lambda c: str(c["betas"]))
def test_the_root_rule(case: dict[str, Any]) -> None:
    betas = np.array(case["betas"], dtype=float)
    got = math.degrees(catalogue_bend(np.radians(np.abs(betas)), np.sign(betas)))
    # The root of a difference that cancels has half its digits.
    squares = math.sqrt(float((betas**2).sum()))
    assert got == pytest.approx(float(case["rule_deg"]), rel=1e-12, abs=4e-8 * squares)
    line = Driveline.from_bends(np.abs(betas), degrees=True)
    assert line.catalogue_bend(np.sign(betas)) == pytest.approx(math.radians(got), abs=1e-8)


@pytest.mark.parametrize(("limit", "worst"), [(10, 0.04), (20, 0.29), (30, 1.02)])
def test_the_root_rule_for_two_joints_is_off_by_at_most(limit: int, worst: float) -> None:
    each = np.radians(np.linspace(0, limit, 61))
    pair = np.stack(np.meshgrid(each, each), axis=-1)
    errors = []
    for sign in (1.0, -1.0):
        crossed = RIGHT if sign > 0 else 0.0
        right = Driveline.from_bends(pair, phases=crossed).equivalent().bend
        errors.append(np.abs(np.degrees(catalogue_bend(pair, [1.0, sign]) - right)).max())
    assert round(max(errors), 2) == worst


def test_the_root_rule_can_miss_altogether() -> None:
    bend = np.radians([20.0, 25.0, 15.0])
    assert catalogue_bend(bend, [1, -1, 1]) == pytest.approx(0.0, abs=1e-8)
    right = Driveline.from_bends(bend).equivalent().bend
    assert math.degrees(right) == pytest.approx(3.143, abs=5e-4)


# Four joints; the yokes of the shafts between them are crossed, parallel, parallel.
STRING = np.radians([5.0, 4.0, 3.0, 2.0])
SIGNS = [1, 1, -1, 1]


def test_what_crossed_and_parallel_mean_for_the_signs() -> None:
    # The exact equivalent bend tells: any other choice of signs gives another one.
    line = Driveline.from_bends(STRING, phases=np.radians([90.0, 0.0, 0.0]))
    right = math.degrees(line.equivalent().bend)
    assert math.degrees(catalogue_bend(STRING, SIGNS)) == pytest.approx(right, rel=2e-3)
    others = np.stack(np.meshgrid([1], [1, -1], [1, -1], [1, -1]), axis=-1).reshape(-1, 4)
    others = others[(others != SIGNS).any(axis=1)]
    assert np.min(np.abs(np.degrees(catalogue_bend(STRING, others)) / right - 1)) > 0.05
    # So it is for what reaches the single shafts.
    for shaft in (1, 2, 3):
        part = math.degrees(line.equivalent(shaft).bend)
        got = math.degrees(catalogue_bend(STRING[:shaft], SIGNS[:shaft]))
        assert got == pytest.approx(part, rel=2e-3)


def printed(bend: float, excitation: float) -> tuple[str, str]:
    return f"{math.degrees(bend):.2f}", f"{excitation:.0f}"


def test_workshop_figures_of_four_joints_at_2500_rpm() -> None:
    speed = 2500 * RPM
    torsional = printed(catalogue_bend(STRING, SIGNS), torsional_excitation(STRING, SIGNS, speed))
    assert torsional == ("6.00", "749")
    wants: dict[Literal["drive", "coast"], tuple[str, str]] = {
        "drive": ("9.90", "2026"),
        "coast": ("3.16", "209"),
    }
    for direction, want in wants.items():
        bend = inertia_bend(STRING, SIGNS, direction)
        assert printed(bend, inertia_excitation(STRING, SIGNS, speed, direction)) == want
    # The bend in place of its sine would print 752 and 2046.
    assert f"{(speed * catalogue_bend(STRING, SIGNS)) ** 2:.0f}" == "752"
    assert f"{(speed * inertia_bend(STRING, SIGNS)) ** 2:.0f}" == "2046"
    limits = (
        approximations.TORSIONAL_LIMIT,
        approximations.TORSIONAL_MAXIMUM,
        approximations.INERTIA_LIMIT,
        approximations.INERTIA_MAXIMUM,
    )
    assert limits == (300.0, 500.0, 1000.0, 2000.0)


@pytest.mark.parametrize(
    ("rpm", "bend", "peak"),
    # Parker/Chelsea, bulletin HY25-1890-M1/US, page 5, "100 RAD/SEC2"; Spicer at higher speeds.
    [
        *((3000, 5 + 50 / 60, 1025), (2500, 7.0, 1026), (2000, 8 + 40 / 60, 1008)),
        *((1500, 11.5, 1001), (3500, 5.0, 1024), (4000, 4.2, 944), (5000, 3.2, 856)),
    ],
)
def test_published_angles_over_the_speed(rpm: float, bend: float, peak: float) -> None:
    """They accelerate the driven shaft of one joint by 1000 rad/s² at most, not by 100."""
    speed, angle = rpm * math.pi / 30.0, np.linspace(0.0, math.pi, 20_001)
    line = Driveline.from_bends([bend], degrees=True)
    exact = np.max(np.abs(line.evaluate(angle, "acceleration_ratio").acceleration_ratio))
    assert exact * speed**2 == pytest.approx(peak, abs=1.0)
    # The square of the angle times the speed is the share of the second order.
    assert (math.radians(bend) * speed) ** 2 == pytest.approx(exact * speed**2, rel=0.01)
    assert 0.85 < peak / approximations.INERTIA_LIMIT < 1.03


def test_inertia_weights() -> None:
    # The sum over the shafts between the joints of what reaches each of them.
    for signs in (SIGNS, [1, -1, -1, -1]):
        parts = np.asarray(signs) * STRING**2
        drive = abs(sum(parts[:shaft].sum() for shaft in (1, 2, 3)))
        coast = abs(sum(parts[shaft:].sum() for shaft in (1, 2, 3)))
        assert inertia_bend(STRING, signs) ** 2 == pytest.approx(drive, rel=1e-13)
        assert inertia_bend(STRING, signs, "coast") ** 2 == pytest.approx(coast, rel=1e-13)
        back = inertia_bend(STRING[::-1], signs[::-1], "coast")
        assert inertia_bend(STRING, signs) == pytest.approx(back, rel=1e-14)
    # Two joints: the shaft between them takes what the first makes, or the second on overrun.
    assert inertia_bend([0.1, 0.2], [1, -1]) == pytest.approx(0.1, rel=1e-15)
    assert inertia_bend([0.1, 0.2], [1, -1], "coast") == pytest.approx(0.2, rel=1e-15)
    # One joint has no such shaft.
    assert inertia_excitation([0.1], [1], 100.0) == 0.0


@pytest.mark.parametrize(("degrees", "below"), [(10, 0.015), (30, 0.15)])
def test_the_torsional_figure_of_one_joint_is_low(degrees: float, below: float) -> None:
    bend = math.radians(degrees)
    peak = float(Driveline.from_bends([bend]).equivalent().max_acceleration_ratio)
    figure = torsional_excitation([bend], [1], 1.0)
    assert figure == pytest.approx(math.sin(bend) ** 2, rel=1e-14)
    assert 1 - figure / peak == pytest.approx(below, rel=0.04)


def test_a_hopeless_chain_does_not_pass() -> None:
    many = np.full(40, 0.5)
    assert catalogue_bend(many, np.ones(40)) > math.pi
    assert torsional_excitation(many, np.ones(40), 10.0) == 100.0


# --- arrays and refusals ---------------------------------------------------------------------


def test_everything_broadcasts() -> None:
    angle, bend = np.linspace(0, 1, 5), np.array([[0.1], [0.2]])
    inertia, speed = np.array([1.0, 2.0, 3.0])[:, None, None], 7.0
    got = thoma_small_angle(angle, bend, inertia, speed)
    for values in got:
        assert values.shape == (3, 2, 5)
    one = thoma_small_angle(angle[3], 0.2, 3.0, 7.0)
    assert [values[2, 1, 3] for values in got] == pytest.approx(list(one), rel=4 * EPS)
    assert all(isinstance(value, float) for value in one)
    assert thoma_small_angle(0.3, 0.2, 0.0, 7.0) == (0.0, 0.0, 0.0)
    ratios = thoma_moment_ratios(angle, bend)
    assert ratios.x.shape == ratios.z.shape == (2, 5)

    batch = np.random.default_rng(0).uniform(0, 0.3, (6, 4))
    signs = np.array([SIGNS, [1, 1, 1, 1]])[:, None]
    speeds = np.array([100.0, 200.0])[:, None, None]
    assert catalogue_bend(batch, signs).shape == inertia_bend(batch, signs).shape == (2, 6)
    figures = inertia_excitation(batch, signs, speeds, "coast")
    assert figures.shape == torsional_excitation(batch, signs, speeds).shape == (2, 2, 6)
    want = inertia_excitation(batch[4], SIGNS, 200.0, "coast")
    assert figures[1, 0, 4] == pytest.approx(want, rel=4 * EPS)
    assert isinstance(want, float)
    assert catalogue_bend(0.1, 1) == pytest.approx(0.1, rel=EPS)


def test_nan_stays_where_it_is() -> None:
    for values in (
        *thoma_small_angle([0.1, math.nan, math.inf], 0.2, 1.0, 1.0),
        *thoma_moment_ratios([0.1, math.nan, -math.inf], 0.2),
    ):
        assert np.isnan(values).tolist() == [False, True, True]
    got = thoma_small_angle(
        0.1, [0.2, math.nan, 0.2, 0.2], [1, 1, math.nan, 1], [1, 1, 1, math.nan]
    )
    for values in got:
        assert np.isnan(values).tolist() == [False, True, True, True]
    batch = [[0.1, 0.2], [0.1, math.nan]]
    for values in (
        catalogue_bend(batch, [1, -1]),
        inertia_bend(batch, [1, -1]),
        torsional_excitation(batch, [1, -1], 1.0),
        inertia_excitation(batch, [1, -1], 1.0),
    ):
        assert np.isnan(values).tolist() == [False, True]
    assert np.isnan(torsional_excitation([0.1], [1], [1.0, math.nan])).tolist() == [False, True]


BEND = "rad; a bend must lie in [0, pi/2)"


test_refusals = refusals(
    {
        f"bend[1] is -0.1 {BEND}": lambda: thoma_small_angle(0.0, [0.1, -0.1], 1.0, 1.0),
        f"bend is 30.0 {BEND}": lambda: thoma_small_angle(0.0, 30.0, 1.0, 1.0),
        "inertia[0, 1] is -2.0; an inertia must not be negative": lambda: thoma_small_angle(
            0.0, 0.1, [[0.0, -2.0]], 1.0
        ),
        "shapes do not broadcast: angle (2,), bend (), inertia (3,), speed ()": lambda: (
            thoma_small_angle([0.0] * 2, 0.1, [1.0] * 3, 1.0)
        ),
        f"bend is 1.5707963267948966 {BEND}": lambda: thoma_moment_ratios(0.0, RIGHT),
        "shapes do not broadcast: angle (2,), bend (3,)": lambda: thoma_moment_ratios(
            [0.0] * 2, [0.1] * 3
        ),
        f"bends[1] is 20.0 {BEND}": lambda: catalogue_bend([0.1, 20.0], [1, 1]),
        f"bends[1] is -0.2 {BEND}": lambda: catalogue_bend([0.1, -0.2], [1, 1]),
        "fork_signs[1] is 2.0; each must be +1 or -1": lambda: catalogue_bend([0.1, 0.2], [1, 2]),
        "fork_signs[1] is nan; each must be +1 or -1": lambda: catalogue_bend(
            [0.1, 0.2], [1, math.nan]
        ),
        "fork_signs has shape (3,); 2 joints need (..., 2)": lambda: catalogue_bend(
            [0.1, 0.2], [1, 1, 1]
        ),
        "shapes do not broadcast: bends (2, 2), fork_signs (3, 2)": lambda: catalogue_bend(
            np.full((2, 2), 0.1), np.ones((3, 2))
        ),
        "direction is 'reverse'; it must be 'drive' or 'coast'": lambda: inertia_bend(
            [0.1],
            [1],
            "reverse",  # type: ignore[arg-type]
        ),
        "direction is 'overrun'; it must be 'drive' or 'coast'": lambda: inertia_excitation(
            [0.1],
            [1],
            1.0,
            "overrun",  # type: ignore[arg-type]
        ),
        "shapes do not broadcast: bends (2,), speed (3,)": lambda: torsional_excitation(
            np.full((2, 2), 0.1), [1, 1], [1.0] * 3
        ),
    }
)
