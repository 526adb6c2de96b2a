"""Joints as built, against loops of hinges with 40 digits and against vectors with 60."""

from __future__ import annotations

import copy
import itertools
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cardan import ArgumentValueError, Driveline, Load, Sweep, TorsionalSystem, _core
from deviation_oracle import LeaningChain, LeaningJoint
from oracle import EPS, Doubles, limits, mp, plan_at, read
from refusals import refusals

ORACLE = read("deviations.json")
KEPT = read("worst_as_built.json")["cases"]
MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
VECTORS = ("moment", "support_moment")
SCALARS = ("torque", "bending_driving", "bending_driven", "tilt_driving", "tilt_driven")
BENDS, TWISTS, PHASES = [0.35, 0.2, 0.5], [0.4, -1.0], [0.3, 1.2]
LINE = Driveline.from_bends(BENDS, TWISTS, PHASES).with_deviations(
    driving_yoke=[0.02, -0.001, 0.003], cross=[-0.01, 0.015, 0.0], driven_yoke=[0.004, 0.0, -0.02]
)
IDEAL = Driveline.from_bends(BENDS, TWISTS, PHASES)
CHAIN = LeaningChain(
    [LeaningJoint(b, e) for b, e in zip(BENDS, LINE.deviations.tolist(), strict=True)],
    TWISTS,
    PHASES,
)
LOAD = Load(drive_torque=3.0, speed=20.0, acceleration=5.0, inertias=[0.1, 0.02, 0.03, 0.04])
TURN = np.linspace(-2.0, 5.0, 37)


def single(row: dict[str, Any]) -> Driveline:
    line = Driveline.from_bends([row["bend"]])
    return line.with_deviations(row["driving_yoke"], row["cross"], row["driven_yoke"])


def chain(case: dict[str, Any]) -> Driveline:
    line = Driveline.from_bends(case["bends"], case["twists"], case["phases"])
    return line.with_deviations(*np.transpose(case["deviations"]))


@pytest.mark.parametrize("tolerance", [None, 0])
def test_single_joints_are_those_of_the_loop_of_hinges(tolerance: float | None) -> None:
    names = ("speed_ratio", "acceleration_ratio")
    turn = Sweep.revolutions(1, 256)
    for row in ORACLE["single"]:
        line = single(row)
        found = line.evaluate(row["angle"], names, tolerance=tolerance)
        for name in names:
            exact = mp.mpf(row[name])
            largest = line.evaluate(turn, name, reduce="peak")[name]
            error = abs(mp.mpf(float(found[name])) - exact) / mp.mpf(np.spacing(float(largest)))
            assert error <= (6 if tolerance is None else 1.01), (row, name, float(error))


def test_chains_are_those_of_the_loop_of_hinges() -> None:
    for case in ORACLE["chains"]:
        line = chain(case)
        angles = np.array([row["angle"] for row in case["rows"]])
        found = line.evaluate(angles, ("angle", "speed_ratio", "acceleration_ratio"))
        for name in ("speed_ratio", "acceleration_ratio"):
            exact = np.array([float(row[name]) for row in case["rows"]])
            np.testing.assert_allclose(found[name], exact, rtol=1e-14, atol=2e-14)
        # Without the constant that `angle` leaves out.
        driven = np.array([float(row["driven_mod_2pi"]) for row in case["rows"]])
        apart = np.exp(1j * (found.angle - driven))
        np.testing.assert_allclose(apart, apart[0], rtol=0, atol=4e-15)


@pytest.mark.parametrize("tolerance", [None, 0])
def test_the_motion_is_that_of_the_pins(tolerance: float | None) -> None:
    angles = np.array([0.3, 2.5, -1.1])
    mean = CHAIN.mean_lag()
    found = LINE.evaluate(angles, MOTION, tolerance=tolerance)
    sizes = LINE.evaluate(Sweep.revolutions(1, 64), MOTION, reduce="peak")
    limit = (8 if tolerance is None else 1.01) * EPS
    for i, angle in enumerate(angles.tolist()):
        error = CHAIN.lag(angle) - mean
        exact = [angle + error, error, *CHAIN.rates(angle)]
        for name, wanted in zip(MOTION, exact, strict=True):
            apart = abs(mp.mpf(float(found[name][i])) - wanted)
            size = abs(angle) + 1.0 if name == "angle" else sizes[name]
            assert apart <= limit * size, (name, angle, float(apart / size))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("bend", "driving_yoke", "cross", "driven_yoke"),
    [(69.7, 0.02, -7.3, -0.02), (66.5, -1.1, -6.8, -0.2), (20.0, -5.0, 3.0, -4.0)],
)
def test_large_deviations_of_either_sign(
    bend: float, driving_yoke: float, cross: float, driven_yoke: float, sign: float
) -> None:
    # The bound of the error, which chooses the inverse tangent, counts their magnitudes.
    leans = np.radians([driving_yoke, cross, driven_yoke]) * sign
    line = Driveline.from_bends([bend], degrees=True).with_deviations(*leans)
    model = LeaningChain([LeaningJoint(line.bends[0], leans.tolist())], [], [])
    angles = np.linspace(0.0, 2 * np.pi, 25)
    found = line.evaluate(angles, "angle_error").angle_error
    exact = np.array([float(model.lag(angle) - model.lag(0.0)) for angle in angles.tolist()])
    np.testing.assert_allclose(found - found[0], exact, rtol=0, atol=1e-14)


@pytest.mark.parametrize("case", KEPT, ids=lambda case: f"{case['tier']} {case['output']}")
def test_the_worst_samples_keep_the_limits(case: dict[str, Any]) -> None:
    """Of ``cardan-stress``: one with a bend near 0, one near 90 deg, and chains."""
    name, tier, angle = case["output"], case["tier"], case["angle"]
    own = np.reshape(case["deviations"], (-1, 3))
    line = Driveline.from_bends(case["bends"], case["twists"], case["phases"])
    line = line.with_deviations(*own.T)
    joints = [LeaningJoint(b, e) for b, e in zip(case["bends"], own.tolist(), strict=True)]
    model = LeaningChain(joints, case["twists"], case["phases"])
    if name == "angle_error":
        exact = model.lag(angle) - model.mean_lag(2048 if case["bends"][0] > 1.0 else 64)
    else:
        exact = model.rates(angle)[MOTION.index(name) - 2]
    tolerance = 0 if tier == "tolerance=0" else None
    got = line.evaluate(angle, name, tolerance=tolerance)[name]
    peaks = line.evaluate(Sweep.revolutions(1, 4096), name, shafts=slice(1, None), reduce="peak")
    largest = np.max(peaks[name])
    off = abs(mp.mpf(float(got)) - exact) / mp.mpf(np.spacing(float(largest)))
    assert off <= limits("worst" if tolerance is None else "tolerance_0", "as_built")[name]


def test_moments_are_normal_to_both_pins() -> None:
    found = LINE.evaluate(TURN[:4], ("moment", "torque"), load=LOAD, shafts=slice(None))
    for i, angle in enumerate(TURN[:4].tolist()):
        inputs = CHAIN.inputs(angle)
        for j, joint in enumerate(CHAIN.joints):
            u, m = LINE.directions[j], LINE.normals[j]
            axes = np.array([u, np.cross(m, u), m])
            got = axes @ found.moment[j, i]
            torsion = got[0]
            exact = [float(x) * torsion for x in joint.moment(inputs[j])]
            np.testing.assert_allclose(got, exact, rtol=0, atol=1e-14 * abs(torsion))
            # Along the driven shaft it is the torque that enters it.
            along = found.moment[j, i] @ LINE.directions[j + 1]
            assert along == pytest.approx(found.torque[j + 1, i], rel=1e-13)


def test_power_and_balance_hold() -> None:
    load = Load(drive_torque=3.0)
    names = ("torque", "speed_ratio", "support_moment")
    at = LINE.evaluate(TURN, names, load=load, shafts=slice(None))
    moment = LINE.evaluate(TURN, "moment", load=load).moment
    np.testing.assert_allclose(at.torque * at.speed_ratio, 3.0, rtol=1e-14)
    for shaft, u in enumerate(LINE.directions):
        given = np.zeros((len(TURN), 3))
        if shaft > 0:
            given += moment[shaft - 1]
        if shaft < 3:
            given -= moment[shaft]
        across = given - np.outer(given @ u, u)
        np.testing.assert_allclose(at.support_moment[shaft], -across, rtol=0, atol=1e-14)


def test_bending_moments_are_the_parts_across_the_shafts() -> None:
    at = LINE.evaluate(TURN, ("moment", "bending_driving", "bending_driven"), load=LOAD)
    for j in range(3):
        for u, size in zip(
            LINE.directions[j : j + 2], (at.bending_driving[j], at.bending_driven[j]), strict=True
        ):
            across = at.moment[j] - np.outer(at.moment[j] @ u, u)
            np.testing.assert_allclose(np.linalg.norm(across, axis=-1), size, rtol=1e-12)


def test_tilts_are_the_angles_about_the_pins() -> None:
    """From one angle to another the cross turns about each pin by the difference of its tilts."""
    found = LINE.evaluate(TURN[:5], ("tilt_driving", "tilt_driven"))
    for i, angle in enumerate(TURN[:5].tolist()):
        for j, (joint, own) in enumerate(zip(CHAIN.joints, CHAIN.inputs(angle), strict=True)):
            driven = joint.driven_pin(joint.driven_angle(own))
            exact = joint.driving_pin(own), driven, [1, 0, 0], joint.driven_shaft
            p, q, u, v = (np.array([float(x) for x in w]) for w in exact)

            def about(axis: Doubles, shaft: Doubles, pin: Doubles) -> float:
                level = np.cross(shaft, axis)
                return float(np.arctan2(pin @ np.cross(axis, level), pin @ level))

            assert found.tilt_driving[j, i] == pytest.approx(about(p, u, q), abs=1e-14)
            assert found.tilt_driven[j, i] == pytest.approx(-about(q, v, -p), abs=1e-14)


def test_small_deviations_approach_the_ideal_joint() -> None:
    near = IDEAL.with_deviations(cross=[1e-13, 0.0, 0.0])
    one, other = (
        line.evaluate(TURN, (*MOTION, *SCALARS, *VECTORS), load=LOAD) for line in (near, IDEAL)
    )
    for name, array in one.items():
        np.testing.assert_allclose(array, other[name], rtol=0, atol=2e-11, err_msg=name)


def test_without_deviations_the_driveline_is_ideal() -> None:
    ideal = LINE.with_deviations()
    assert not ideal.has_deviations
    assert LINE.has_deviations
    assert np.array_equal(ideal.deviations, np.zeros((3, 3)))
    assert np.array_equal(ideal.evaluate(TURN).angle, IDEAL.evaluate(TURN).angle)


def test_steep_joints() -> None:
    row = {"bend": 1.5, "driving_yoke": 0.01, "cross": 0.02, "driven_yoke": -0.015}
    line, joint = single(row), LeaningJoint(1.5, [0.01, 0.02, -0.015])
    own = LeaningChain([joint])
    for angle in (0.1, 1.5, -2.9):
        found = line.evaluate(angle, ("speed_ratio", "acceleration_ratio"))
        exact = own.rates(angle)
        assert float(found.speed_ratio) == pytest.approx(float(exact[0]), rel=1e-12)
        assert float(found.acceleration_ratio) == pytest.approx(float(exact[1]), rel=1e-11)
    error = line.evaluate(Sweep.revolutions(1, 4096), "angle_error").angle_error
    assert abs(error.mean()) < 1e-13


def batch() -> Driveline:
    deviations = np.linspace(-0.02, 0.02, 7)[:, np.newaxis] * [1.0, 0.5, -1.0]
    return IDEAL.with_deviations(deviations, 0.01 + 0.0 * deviations, deviations[::-1])


def test_batches_are_their_drivelines() -> None:
    lines, names = batch(), (*MOTION, *SCALARS, *VECTORS)
    assert lines.shape == (7,)
    rows = lines[:, np.newaxis].evaluate(TURN, names, load=LOAD, shafts=slice(None))
    by_sample = lines.evaluate(0.7, names, load=LOAD, shafts=slice(None))
    for i, line in enumerate(lines):
        own = line.evaluate(TURN, names, load=LOAD, shafts=slice(None))
        at = line.evaluate(0.7, names, load=LOAD, shafts=slice(None))
        for name in names:
            assert np.array_equal(rows[name][:, i], own[name]), name
            assert np.array_equal(by_sample[name][:, i], at[name]), name


def test_bits_depend_on_neither_threads_nor_instruction_set() -> None:
    angles = np.linspace(-30.0, 40.0, 100_001)
    names = (*MOTION, *SCALARS, *VECTORS)
    one = LINE.evaluate(angles, names, load=LOAD, workers=1)
    two = LINE.evaluate(angles, names, load=LOAD, workers=2)
    levels = [
        plan_at(LINE, names, load=LOAD, workers=1, level=level)(angles[:3000])
        for level in _core.levels()
    ]
    for name in names:
        assert one[name].tobytes() == two[name].tobytes(), name
        for found in levels:
            first = one[name][..., :3000, :] if name in VECTORS else one[name][..., :3000]
            assert found[name].tobytes() == first.tobytes(), name


def test_sweeps_and_reductions() -> None:
    sweep = Sweep.revolutions(3, 720)
    names = (*MOTION[1:], "tilt_driven")
    at_sweep, at_array = LINE.evaluate(sweep, names), LINE.evaluate(np.asarray(sweep), names)
    for name in names:
        size = np.max(np.abs(at_array[name]))
        np.testing.assert_allclose(at_sweep[name], at_array[name], rtol=0, atol=40 * EPS * size)
        found = LINE.evaluate(sweep, name, reduce=["min", "max", "mean"])[name]
        wanted = [of(at_sweep[name], axis=-1) for of in (np.min, np.max, np.mean)]
        np.testing.assert_allclose(found.T, wanted, rtol=0, atol=1e-14)
    angle = LINE.evaluate(sweep, "angle").angle
    np.testing.assert_allclose(angle, LINE.evaluate(np.asarray(sweep), "angle").angle, rtol=1e-14)


def test_single_precision_results_are_rounded_doubles() -> None:
    found = LINE.evaluate(TURN, MOTION, dtype="float32")
    for name, array in LINE.evaluate(TURN, MOTION).items():
        assert found[name].dtype == np.float32
        assert np.array_equal(found[name], array.astype(np.float32))


def test_nan_and_infinity_stay_with_their_sample() -> None:
    found = LINE.evaluate([0.3, np.nan, np.inf, 0.3], (*MOTION, "tilt_driving"), joints=2)
    for name, array in found.items():
        assert np.array_equal(np.isnan(array), [False, True, True, False]), name
        assert array[0] == array[3], name


def test_yokes_make_order_1_and_a_cross_none() -> None:
    """To first order a yoke makes order 1 of the amplitude e tan(bend)."""
    bend, e = np.radians(10.0), 1e-3
    joint = Driveline.from_bends([bend])
    for leaning in (joint.with_deviations(driving_yoke=e), joint.with_deviations(driven_yoke=e)):
        found = leaning.harmonics([1, 2, 3])
        assert found.angle_error[0] == pytest.approx(e * np.tan(bend), rel=0.02)
        # 17 rad/s² at 3000 rpm.
        assert found.angle_error[0] * (100.0 * np.pi) ** 2 == pytest.approx(17.4, abs=0.4)
    cross = joint.with_deviations(cross=e).harmonics([1, 2, 3], outputs=MOTION[1:])
    for name in MOTION[1:]:
        odd = cross.amplitude[name][[0, 2]]
        assert np.all(odd <= cross.error[name]), name
        assert cross.amplitude[name][1] > 1e-3, name


def test_harmonics_are_those_of_exact_samples() -> None:
    count, orders = 64, [1, 2, 3, 4]
    exact = [CHAIN.lag(2 * mp.pi * i / count) for i in range(count)]
    found = LINE.harmonics(orders, outputs="angle_error")
    for order, amplitude in zip(orders, found.complex_amplitude["angle_error"], strict=True):
        turns = [mp.expj(-2 * mp.pi * order * i / count) for i in range(count)]
        wanted = 2 * mp.fsum(x * y for x, y in zip(exact, turns, strict=True)) / count
        assert abs(mp.mpmathify(complex(amplitude)) - wanted) <= found.error["angle_error"] + 1e-16
    assert np.all(found.angle_error[::2] > 1e-4)


def test_harmonics_of_loads() -> None:
    # Driven yokes that lean round off the kinks of bending moments.
    driving, cross, _ = LINE.deviations.T
    line = LINE.with_deviations(driving, cross, [0.02, -0.03, 0.02])
    turn = np.arange(8192) * 2 * np.pi / 8192
    names = ("moment", "bending_driven", "torque")
    samples = line.evaluate(turn, names, load=LOAD)
    found = line.harmonics([1, 2, 3], outputs=names, load=LOAD)
    for name in names:
        axis = -2 if name == "moment" else -1
        spectrum = np.fft.rfft(samples[name], axis=axis) * 2 / 8192
        wanted = np.moveaxis(spectrum, axis, -1)[..., 1:4]
        np.testing.assert_allclose(found.complex_amplitude[name], wanted, rtol=0, atol=1e-12)


def test_reversing_inverts_the_motion() -> None:
    """The reversed driveline takes the driven pin of each joint as its driving pin."""
    back = LINE.reversed()
    assert back.reversed().approx_equal(LINE)
    for angle in (0.3, 2.0):
        last, own = CHAIN.joints[-1], CHAIN.inputs(angle)[-1]
        drive = -(float(last.driven_angle(own)) + 0.5 * np.pi)
        forth = LINE.evaluate(angle, "speed_ratio").speed_ratio
        assert back.evaluate(drive, "speed_ratio").speed_ratio == pytest.approx(
            1 / forth, rel=1e-12
        )


def test_copies_and_pickles_keep_deviations() -> None:
    for other in (pickle.loads(pickle.dumps(LINE)), copy.deepcopy(LINE), LINE.reshape(1)[0]):
        assert np.array_equal(other.deviations, LINE.deviations)
        assert np.array_equal(other.evaluate(TURN).angle, LINE.evaluate(TURN).angle)
    both = Driveline.concatenate([LINE, IDEAL])
    assert np.array_equal(both.deviations[1], np.zeros((3, 3)))
    assert not LINE.approx_equal(IDEAL)
    turned = LINE.with_phases([0.1, 0.2])
    assert np.array_equal(turned.deviations, LINE.deviations)
    np.testing.assert_allclose(LINE.deviations_deg, np.degrees(LINE.deviations))


def test_explanations_say_how_it_is_computed() -> None:
    text = LINE.plan(("angle", "moment"), load=LOAD).explain()
    assert "joint 2: as built, from its own input angle" in text
    assert "one equivalent joint: chains of joints with deviations have none" in text
    assert "as built" not in IDEAL.plan("angle").explain()
    held = LINE.with_bearings([(0, 0.1), (0, 0.4), (1, 0.5), (3, 0.1), (3, 0.4)], [1.0] * 4)
    text = held.plan("bearing_force", load=LOAD).explain()
    assert "joint 2: forces from the torsion" in text
    assert "bearing 4: force, a sum of 6 terms" in text


@pytest.mark.parametrize("which", range(3))
def test_a_joint_turns_up_to_its_limit(which: int) -> None:
    given = [0.0] * 3
    for size, turns in ((0.29, True), (0.31, False)):
        given[which] = size
        line = Driveline.from_bends([[0.2, 0.5 * np.pi - 0.3]])
        if turns:
            assert np.isfinite(line.with_deviations(*given).evaluate(TURN).angle).all()
            continue
        with pytest.raises(
            ArgumentValueError, match=r"deviations\[0, 1\].*cannot turn.*< 90 deg - bend"
        ):
            line.with_deviations(*given)


def test_a_blocked_joint_is_told_in_the_digits_given() -> None:
    line = Driveline.from_bends([15.0], degrees=True)
    with pytest.raises(ArgumentValueError, match=r"80\.1 deg \(cross\).* at a bend of 15 deg,"):
        line.with_deviations(cross=80.1, degrees=True)


def test_signs_that_help_each_other_may_be_larger() -> None:
    """The sum of the magnitudes is enough but not necessary."""
    rows = itertools.product((-0.2, 0.2), repeat=3)
    blocked = 0
    for deviations in rows:
        line = Driveline.from_bends([0.5 * np.pi - 0.3])
        try:
            line = line.with_deviations(*deviations)
        except ArgumentValueError:
            blocked += 1
            continue
        assert np.isfinite(line.evaluate(np.linspace(0, 7, 1000)).angle).all()
    assert blocked == 4


test_wrong_deviations_are_refused = refusals(
    {
        "cross is nan rad; a deviation must lie within 90 deg": {"cross": np.nan},
        "driven_yoke[1] is 2.0 rad": {"driven_yoke": [0.0, 2.0, 0.0]},
        "driving_yoke is 90.0 deg": {"driving_yoke": 90.0, "degrees": True},
        "cross has shape (2,); it is one number or one per joint": {"cross": [0.1, 0.2]},
    },
    IDEAL.with_deviations,
)


@pytest.mark.parametrize(
    ("use", "instead"),
    [
        (lambda line: line.equivalent(), "evaluate and harmonics give the motion"),
        (lambda line: line.optimal_phases(), "cardan.optimise minimises an output as built"),
        (lambda line: line.transmission(), "Plan.derivatives its derivatives"),
        (lambda line: line.check(), "evaluate and harmonics give the motion"),
        (lambda line: line.steering(), "evaluate and harmonics give the motion"),
        (lambda line: line.free_running([1.0] * 4), "with_deviations() without arguments"),
        (
            lambda line: line.losses(LOAD, friction=0.1, pin_radius=0.01, arm=0.03),
            "losses and lives are computed for ideal joints",
        ),
        (lambda line: line.life(LOAD, rating=100.0), "evaluate gives moments and tilts as built"),
        (
            lambda line: line.evaluate(0.3, "moment", load=LOAD, axes="shaft"),
            "use the axes of space and the drive angle",
        ),
        (
            lambda line: line.evaluate(0.3, angle_of="driven"),
            "use the axes of space and the drive angle",
        ),
        (
            lambda line: TorsionalSystem(
                line, inertias=[1.0] * 4, stiffnesses=[np.inf, 1.0, np.inf, np.inf]
            ),
            "torsional systems are computed for ideal joints only",
        ),
    ],
)
def test_what_needs_ideal_joints_refuses(use: Callable[[Driveline], object], instead: str) -> None:
    with pytest.raises(ArgumentValueError, match="has joints with deviations") as refused:
        use(LINE)
    assert instead in str(refused.value)
    assert "ideal joints only" in str(refused.value)


# --- play and wind-up ------------------------------------------------------------------------


def test_play_is_a_cross_error_on_either_flank() -> None:
    flanks = LINE.with_play([0.02, 0.0, 0.01], 30.0)
    assert flanks.shape == (2,)
    apart = flanks.deviations - LINE.deviations
    np.testing.assert_allclose(apart[0, :, 1], [0.04 / 30.0, 0.0, 0.02 / 30.0], atol=1e-17)
    np.testing.assert_array_equal(apart[1], -apart[0])
    assert np.all(apart[..., [0, 2]] == 0.0)
    assert IDEAL.reshape(1).with_play(0.01, [[10.0], [20.0]]).shape == (2, 2)


def test_the_lash_of_one_joint_has_a_closed_form() -> None:
    bend, play, arm = 0.6, 0.3, 25.0
    angle = np.linspace(0.0, 7.0, 29)
    found = Driveline.from_bends([bend]).lash(angle, play, arm)
    rho = np.sqrt(np.sin(angle) ** 2 + np.cos(bend) ** 2 * np.cos(angle) ** 2)
    exact = 2.0 * np.arcsin(np.sin(2.0 * play / arm) / rho)
    np.testing.assert_allclose(found, exact, rtol=2e-14)


def test_the_lash_of_a_chain_is_that_of_its_vectors() -> None:
    play, arm = 0.2, 30.0
    flanks = LINE.with_play(play, arm)
    angles = np.array([0.2, 1.7])
    found = LINE.lash(angles, play, arm)
    leads = []
    for flank in flanks:
        each = zip(BENDS, flank.deviations.tolist(), strict=True)
        leads.append(LeaningChain([LeaningJoint(b, e) for b, e in each], TWISTS, PHASES))
    for i, angle in enumerate(angles.tolist()):
        exact = leads[1].lag(angle) - leads[0].lag(angle)
        assert float(found[i]) == pytest.approx(float(exact), rel=1e-12)
    assert np.all(found > 0.0)
    batched = batch().lash(angles[:, np.newaxis], play, arm)
    assert batched.shape == (2, 7)
    np.testing.assert_allclose(batched[:, 3], batch()[3].lash(angles, play, arm), rtol=1e-13)


def test_inertias_wind_up_the_joints_before_them_alone() -> None:
    """Joint by joint: its moment over its stiffness, passed on by the ratio of what follows."""
    angle, stiffness = np.linspace(0.0, 3.0, 13), np.array([1e5, 3e5, 2e5])
    bends = np.cos(IDEAL.bends)
    for shaft in range(4):
        inertias = 0.2 * np.eye(4)[shaft]
        load = Load(output_torque=0.0, speed=100.0, inertias=inertias)
        ratio, acceleration = (
            IDEAL.evaluate(angle, name, shafts=slice(None))[name]
            for name in ("speed_ratio", "acceleration_ratio")
        )
        torque = 0.2 * acceleration[shaft] * 100.0**2
        # By the power that every joint passes on to the shaft.
        each = [
            torque * ratio[shaft] / ratio[joint] / (stiffness[joint] * bends[joint])
            for joint in range(shaft)
        ]
        lag = sum(own * ratio[3] / ratio[joint + 1] for joint, own in enumerate(each))
        found = IDEAL.wind_up(angle, load, stiffness)
        np.testing.assert_allclose(found, lag, rtol=1e-9, atol=1e-17)


test_wrong_play_and_stiffness_are_refused = refusals(
    {
        "radial is -0.1": lambda: LINE.with_play(-0.1, 1.0),
        "arm is 0.0": lambda: LINE.with_play(0.1, 0.0),
        "radial has shape (2,)": lambda: LINE.with_play([0.1, 0.1], 1.0),
        "stiffness[1] is 0.0": lambda: LINE.wind_up(0.0, LOAD, [1.0, 0.0, 1.0]),
        "cannot turn": lambda: LINE.with_play(20.0, 30.0),
    }
)


def test_orders_of_joints_that_compensate_each_other() -> None:
    # What is left of them is smaller than the rounding of each joint.
    lean = np.random.default_rng(1).uniform(-0.0025, 0.0025, (2, 100, 2))
    ideal = Driveline.from_bends([8.0, 8.0], degrees=True)
    line = ideal.with_deviations(driving_yoke=lean[0], driven_yoke=lean[1])
    found = line.harmonics([1, 2], outputs="acceleration_ratio")
    angle = 2.0 * np.pi * np.arange(4096)[:, np.newaxis] / 4096.0
    ratio = line.evaluate(angle, "acceleration_ratio").acceleration_ratio
    orders = np.abs(np.fft.rfft(ratio, axis=0))[1:3].T / 2048.0
    np.testing.assert_allclose(found.acceleration_ratio, orders, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("tolerance", [None, 0.0, 1e-6])
@pytest.mark.parametrize("steep", [False, True])
def test_bits_do_not_depend_on_the_outputs_asked_for(tolerance: float | None, steep: bool) -> None:
    """One loop computes an output alone, another one beside others."""
    rng = np.random.default_rng(5)
    bends = rng.uniform(1.0, 1.4, (6, 3)) if steep else rng.uniform(0.0, 0.6, (6, 3))
    lines = Driveline.from_bends(bends[:, np.newaxis], 0.4, 0.2).with_deviations(
        *rng.uniform(-0.02, 0.02, (3, 6, 1, 3))
    )
    angle = rng.uniform(-7.0, 7.0, 160)
    names = (*MOTION, *SCALARS, *VECTORS)
    pairs = itertools.combinations(MOTION, 2)
    asked = [(name,) for name in names] + [*pairs, MOTION, ("jerk_ratio", "torque"), names]
    for line in (lines, lines[0, 0]):
        every = line.evaluate(angle, names, shafts=slice(None), load=LOAD, tolerance=tolerance)
        for some in asked:
            found = line.evaluate(angle, some, shafts=slice(None), load=LOAD, tolerance=tolerance)
            for name in some:
                np.testing.assert_array_equal(found[name], every[name], err_msg=f"{name}: {some}")
