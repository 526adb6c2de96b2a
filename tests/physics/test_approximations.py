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
from oracle import EPS, Doubles, mp, radians, read
from refusals import refusals

RIGHT = math.pi / 2
RPM = 2 * math.pi / 60
CASES = read("thoma_small_angle.json")["cases"]

# --- Thoma by equation -----------------------------------------------------------------------

TURN = np.linspace(-math.pi, math.pi, 721)
BENDS = [1e-4, math.radians(8.5), math.radians(30), math.radians(60), 1.5]
bends = pytest.mark.parametrize("bend", BENDS)


def close(got: Doubles, want: Doubles, scale: float = 1.0) -> None:
    assert np.max(np.abs(got - want)) <= 1e-14 * scale


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


# --- Thoma's small-angle forms ---------------------------------------------------------------


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


# --- catalogue and workshop rules ------------------------------------------------------------


@pytest.mark.parametrize("case", read("aligned_bends.json")["cases"], ids=lambda c: str(c["betas"]))
def test_the_root_rule(case: dict[str, Any]) -> None:
    betas = np.array(case["betas"], dtype=float)
    got = math.degrees(catalogue_bend(np.radians(np.abs(betas)), np.sign(betas)))
    # The root of a difference that cancels has half its digits.
    squares = math.sqrt(float((betas**2).sum()))
    assert got == pytest.approx(float(case["rule_deg"]), rel=1e-12, abs=4e-8 * squares)
    line = Driveline.from_bends(np.abs(betas), degrees=True)
    signs = np.sign(betas)
    # Joints whose errors add have crossed yokes between them.
    crossed = line.with_phases(np.where(signs[1:] == signs[:-1], RIGHT, 0.0))
    exact_bend = float(case["exact_deg"])
    assert math.degrees(crossed.equivalent().bend) == pytest.approx(exact_bend, rel=1e-12, abs=3e-6)
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
