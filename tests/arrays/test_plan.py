"""Plans, sweeps, reductions, dtypes and tolerances: every way to the same results."""

from __future__ import annotations

import math
import pickle
import re
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load, Sweep
from cardan.evaluation.request import REDUCTIONS, Reduction
from oracle import Exact, ExactTurn, Fold, limits, mp
from refusals import refusals

MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
CHAIN = Driveline.from_bends([0.5, 0.0, 0.9], [0.3, -1.0], [0.7, 0.2])
STEEP = Driveline.from_bends([1.55])
LOAD_OF_TWO = Load(drive_torque=1.0, speed=1.0, inertias=[0.0, 1.0])
LOAD = Load(drive_torque=7.0, speed=30.0, inertias=[0.1, 0.0, 0.3, 0.2])
ANGLE = np.linspace(-7.0, 20.0, 3000)


def peak(line: Driveline, name: str, shaft: int = -1) -> Any:  # noqa: ANN401 - a number or array
    joint = line.equivalent(shaft)
    return {
        "angle": 2 * np.pi,
        "angle_error": joint.max_angle_error,
        "speed_ratio": joint.max_speed_ratio,
        "acceleration_ratio": joint.max_acceleration_ratio,
        "jerk_ratio": 2 * joint.non_uniformity * joint.max_speed_ratio**2,
    }[name]


# --- plans -----------------------------------------------------------------------------------


def test_a_plan_gives_what_evaluate_gives() -> None:
    options: dict[str, Any] = {"shafts": [1, 3], "joints": 0, "load": LOAD}
    names = (*MOTION, "torque", "support_moment", "moment", "tilt_driven")
    plan = CHAIN.plan(names, **options)
    for angle in (ANGLE, ANGLE.reshape(3, -1), 0.3, ANGLE[::-7]):
        want = CHAIN.evaluate(angle, names, **options)
        for name in names:
            assert np.array_equal(plan(angle)[name], want[name]), name


def test_the_short_way_sees_layout_and_type() -> None:
    plan = STEEP.plan("speed_ratio")
    want = plan(ANGLE[:60]).speed_ratio.reshape(6, 10)
    square = ANGLE[:60].reshape(6, 10)
    for angle in (square, np.asfortranarray(square), square.tolist(), square.astype(object)):
        if isinstance(angle, np.ndarray) and angle.dtype == object:
            with pytest.raises(TypeError, match="angle has dtype object"):
                plan(angle)
        else:
            assert np.array_equal(plan(angle).speed_ratio, want)
    assert plan(np.empty((0, 3))).speed_ratio.shape == (0, 3)


@pytest.mark.parametrize("shape", [(0,), (0, 4), (4, 0)])
def test_some_arrays_to_fill_without_samples(shape: tuple[int, ...]) -> None:
    plan = CHAIN.plan(("moment", "angle"), load=LOAD)
    want = plan(np.empty(shape))
    for name in ("moment", "angle"):
        out = {name: np.empty(want[name].shape)}
        got = plan(np.empty(shape), out)
        assert got[name] is out[name]
        assert got == want


def test_a_pickled_plan_keeps_every_option() -> None:
    options: dict[str, Any] = {"shafts": [1, 2], "joints": 1, "load": LOAD, "workers": 1}
    names = ("angle", "torque", "moment")
    for more in ({"reduce": "rms"}, {"dtype": np.float32}, {"tolerance": 0}):
        plan = CHAIN.plan(names, **options, **more)
        again = pickle.loads(pickle.dumps(plan))
        assert again._workers == 1
        assert repr(again) == repr(plan) == f"<Plan of angle, torque, moment for {CHAIN!r}>"
        for name, want in plan(ANGLE).items():
            got = again(ANGLE)[name]
            assert got.dtype == want.dtype
            assert np.array_equal(got, want), (name, more)


def test_explain_begins_with_what_it_is_of() -> None:
    def first(line: Driveline) -> str:
        return line.plan(("angle", "speed_ratio")).explain().splitlines()[0]

    assert first(STEEP) == "plan for angle, speed_ratio; 1 joint"
    assert first(CHAIN) == "plan for angle, speed_ratio; 3 joints"
    batch = Driveline.from_bends(np.full((2, 5, 2), 0.1))
    assert first(batch) == "plan for angle, speed_ratio; 2 joints of 10 drivelines"


@pytest.mark.parametrize(
    "loads",
    [
        {"drive_torque": np.array([[1.0], [2], [3]])},
        {"speed": np.array([[10.0], [20], [30]]), "inertias": [0.1, 0, 0.3, 0.2]},
        {"acceleration": np.array([[5.0], [6], [7]]), "inertias": [0.1, 0, 0.3, 0.2]},
        {"speed": 30.0, "inertias": np.arange(12.0).reshape(3, 1, 4)},
        {"speed": 30.0, "inertias": np.arange(40.0).reshape(10, 4)},
    ],
)
def test_a_load_per_row_of_angles(loads: dict[str, Any]) -> None:
    angles = ANGLE[:30].reshape(3, 10)
    got = CHAIN.evaluate(angles, ("torque", "moment"), joints=2, load=Load(**loads))
    for i, row in enumerate(angles):
        own = {name: x[i, 0] if np.shape(x)[:2] == (3, 1) else x for name, x in loads.items()}
        want = CHAIN.evaluate(row, ("torque", "moment"), joints=2, load=Load(**own))
        assert np.array_equal(got.torque[i], want.torque)
        assert np.array_equal(got.moment[i], want.moment)


@pytest.mark.parametrize(
    ("line", "names", "options", "words"),
    [
        (CHAIN, "speed_ratio", {}, ["joint 1: straight", "the 3 before shaft 3 act as one"]),
        (CHAIN, "speed_ratio", {"shafts": 1}, ["joint 1 to 2: beyond everything asked for"]),
        (CHAIN, "speed_ratio", {}, ["torques and moments: not asked for"]),
        (
            Driveline.from_bends([0.2]),
            "moment",
            {"load": Load(drive_torque=1.0)},
            ["4 of the moment's 9 terms, zero because its shafts lie along the xy plane"],
        ),
        (
            Driveline.from_bends([0.2]),
            "support_moment",
            {"load": Load(drive_torque=1.0), "shafts": 0},
            ["3 of 6 terms of its part of shaft 0's support, zero because"],
        ),
        (Driveline.from_bends([0.0]), MOTION, {}, ["sine and cosine: everything turns with"]),
        (
            STEEP,
            "speed_ratio",
            {"reduce": "peak"},
            ["no sample is stored", "8 bytes read, 0 bytes written"],
        ),
        (STEEP, "speed_ratio", {"dtype": np.float32}, ["single precision", "4 bytes written"]),
        (STEEP, "angle", {"tolerance": 0}, ["double precision with error terms"]),
        (STEEP, "angle", {}, ["shaft 1: angle (inverse tangent of"]),
        (CHAIN, "torque", {"load": LOAD}, ["shaft 2: speed ratio, acceleration ratio\n"]),
        (
            STEEP,
            "support_moment",
            {"load": LOAD_OF_TWO, "shafts": 1},
            ["part of shaft 1's support"],
        ),
    ],
)
def test_explain_says_what_is_skipped_and_why(
    line: Driveline,
    names: Any,  # noqa: ANN401
    options: Any,  # noqa: ANN401
    words: list[str],
) -> None:
    text = line.plan(names, **options).explain()
    for part in words:
        assert part in text, text


def test_explain_leaves_nothing_out_that_runs() -> None:
    text = STEEP.plan("speed_ratio").explain()
    assert "angle to unnormalised sine and cosine" in text
    assert "everything turns with" not in text


def test_what_vanishes_is_zero_and_nan_stays_nan() -> None:
    line = Driveline.from_bends([0.4])
    got = line.evaluate([0.3, np.nan], "support_moment", shafts=0, load=LOAD_OF_ONE).support_moment
    assert got[0, 0] == 0.0
    assert abs(got[0, 1]) > 0.1
    assert np.isnan(got[1]).all()


LOAD_OF_ONE = Load(drive_torque=7.0)


# --- sweeps ----------------------------------------------------------------------------------


@pytest.mark.parametrize("line", [CHAIN, STEEP], ids=["chain", "steep"])
@pytest.mark.parametrize("tolerance", [None, 0, 1e-6])
@pytest.mark.parametrize(
    "sweep",
    [
        Sweep(-2.0, 5.0, 1),
        Sweep(-2.0, 5.0, 777),
        Sweep(0.0, 1e4, 3000),
        Sweep(-3.0, 40.0, 20_011),
        Sweep(11.0, -30.0, 9001),
        Sweep.revolutions(1, 720),
        Sweep.revolutions(7.5, 90),
        Sweep.revolutions(4, 721),
        Sweep.revolutions(1, 20_000),
    ],
    ids=repr,
)
def test_sweeps_are_their_arrays(line: Driveline, sweep: Sweep, tolerance: float | None) -> None:
    angle = np.asarray(sweep)
    assert angle.shape == sweep.shape
    names = (*MOTION, "tilt_driving")
    got = line.evaluate(sweep, names, joints=0, tolerance=tolerance)
    want = line.evaluate(angle, names, joints=0, tolerance=0)
    relative = 1e-6 if tolerance else 1e-14
    # The array's angles are rounded, and near 90 deg the shaft turns many times as far.
    rounding = np.spacing(np.abs(angle).max()) * peak(line, "speed_ratio") ** 3
    for name in names:
        size = peak(line, name) if name in MOTION else 1.6
        off = np.max(np.abs(got[name] - want[name]))
        assert off <= relative * size + rounding * (1 + size), name


def test_sweeps_are_exact() -> None:
    line = Driveline.from_bends([math.radians(89.9)])
    got = line.evaluate(Sweep.revolutions(3, 8), ("angle", "angle_error", "speed_ratio"))
    # At every quarter of a turn the error is exactly zero, the ratio an extreme.
    assert not got.angle_error[::2].any()
    joint = line.equivalent()
    assert np.array_equal(got.speed_ratio[::4], np.full(6, joint.max_speed_ratio))
    assert np.allclose(got.speed_ratio[2::4], joint.min_speed_ratio, rtol=4e-16, atol=0)
    assert got.angle[::2].tolist() == [float(quarter * mp.pi / 2) for quarter in range(12)]


def test_a_sweep_broadcasts_against_a_batch() -> None:
    batch = Driveline.from_bends([[0.1], [0.5], [1.2]])
    sweep = Sweep.revolutions(2, 360)
    got = batch[:, None].evaluate(sweep, MOTION)
    assert got.angle.shape == (3, 720)
    for i in range(3):
        alone = batch[i].evaluate(sweep, MOTION)
        for name in MOTION:
            assert np.array_equal(got[name][i], alone[name])


@pytest.mark.parametrize("reduce", [None, "min", "mean"])
def test_sweeps_beside_what_changes_from_sample_to_sample(reduce: Reduction | None) -> None:
    sweep = Sweep.revolutions(2, 5000)
    change = np.linspace(0.1, 1.0, sweep.num)
    for line, name, load in (
        (Driveline.from_bends(change[:, None]), "speed_ratio", None),
        (STEEP, "torque", Load(drive_torque=change)),
        (STEEP, "torque", Load(drive_torque=change, speed=change, acceleration=change)),
    ):
        samples = line.evaluate(np.asarray(sweep), name, load=load)[name]
        got = line.evaluate(sweep, name, load=load, reduce=reduce)[name]
        want = PLAIN[reduce](samples) if reduce else samples
        np.testing.assert_allclose(got, want, rtol=0, atol=1e-12 * np.abs(samples).max())


def test_sweeps_as_values() -> None:
    sweep = Sweep(0.0, 1.0, 5)
    assert np.allclose(np.asarray(sweep), np.linspace(0, 1, 5), rtol=1e-16)
    assert pickle.loads(pickle.dumps(sweep)) == sweep
    turns = Sweep.revolutions(2, 36)
    assert pickle.loads(pickle.dumps(turns)) == turns
    assert len({sweep, Sweep(0.0, 1.0, 5), turns}) == 2
    assert repr(turns) == "Sweep.revolutions(2, 36)"
    assert repr(sweep) == "Sweep(0.0, 1.0, 5)"
    assert np.asarray(Sweep(0.25, 1.0, 1)).tolist() == [0.25]
    assert np.asarray(Sweep.revolutions(1, 1)).tolist() == [0.0]
    assert sweep.__array__(np.float32).dtype == np.float32
    assert hash(sweep) == hash(Sweep(0.0, 1.0, 5)) != hash(turns)
    assert sweep != "Sweep(0.0, 1.0, 5)"
    with pytest.raises(ValueError, match=r"^a sweep holds no array; one must be made$"):
        sweep.__array__(copy=False)
    assert len(turns) == turns.num == 72
    assert all(len(Sweep.revolutions(num / 720, 720)) == num for num in range(1, 1440))
    with pytest.raises(AttributeError, match="cannot change"):
        sweep.num = 3


test_wrong_sweeps = refusals(
    {
        "num is 0; it must be at least 1": lambda: Sweep(0, 1, 0),
        "TypeError: num is 2.5; it must be an integer": lambda: Sweep(0, 1, 2.5),  # type: ignore[arg-type]
        "stop is nan rad": lambda: Sweep(0, math.nan, 3),
        "within 1e12 rad": lambda: Sweep(-2e12, 0, 3),
        "TypeError: start is 'a'; it must be a number": lambda: Sweep("a", 0, 3),  # type: ignore[arg-type]
        "TypeError: stop is 'b'; it must be a number": lambda: Sweep(0, "b", 3),  # type: ignore[arg-type]
        "samples is 0; it must be at least 1": lambda: Sweep.revolutions(1, 0),
        "turns is inf of 7 samples each; … must be a whole number of at least 1": lambda: (
            Sweep.revolutions(math.inf, 7)
        ),
        "turns is 0.3 of 7 samples each; … must be a whole number of at least 1": lambda: (
            Sweep.revolutions(0.3, 7)
        ),
        "at most 1125899906842624 samples": lambda: Sweep.revolutions(1, 1 << 60),
    }
)


# --- reductions ------------------------------------------------------------------------------

PLAIN = {
    "min": lambda x: x.min(axis=-1),
    "max": lambda x: x.max(axis=-1),
    "mean": lambda x: x.mean(axis=-1),
    "rms": lambda x: np.sqrt((x * x).mean(axis=-1)),
    "peak": lambda x: np.abs(x).max(axis=-1),
}


@pytest.mark.parametrize("how", REDUCTIONS)
@pytest.mark.parametrize(
    "angle",
    [ANGLE, ANGLE[:1], np.linspace(0, 99, 40_001), Sweep.revolutions(5, 720), Sweep(1, 9, 333)],
    ids=["array", "one", "long", "turns", "sweep"],
)
def test_reductions_are_those_of_the_samples(how: Any, angle: Any) -> None:  # noqa: ANN401
    names = (*MOTION, "torque", "bending_driven")
    options: dict[str, Any] = {"shafts": [1, 3], "load": LOAD}
    samples = CHAIN.evaluate(angle, names, **options)
    got = CHAIN.evaluate(angle, names, reduce=how, **options)
    for name in names:
        want = PLAIN[how](samples[name])
        assert got[name].shape == want.shape
        scale = np.abs(samples[name]).max()
        exact = how in ("min", "max", "peak")
        assert np.all(np.abs(got[name] - want) <= (0.0 if exact else 4e-15 * scale)), name


def test_one_sample_is_the_same_for_a_whole_batch() -> None:
    lines = Driveline.from_bends([[0.3], [0.5], [0.7]])
    for sweep in (Sweep(1.0, 2.0, 1), Sweep.revolutions(1, 1)):
        for batch in (lines, lines[:, np.newaxis], lines[np.newaxis]):
            for names, load in ((MOTION, None), (("torque", "tilt_driven"), LOAD_OF_TWO)):
                got = batch.evaluate(sweep, names, load=load)
                want = batch.evaluate(np.asarray(sweep), names, load=load)
                for name in names:
                    assert np.array_equal(got[name], want[name]), name


def test_reductions_of_vectors() -> None:
    samples = CHAIN.evaluate(ANGLE, "moment", load=LOAD).moment
    got = {how: CHAIN.evaluate(ANGLE, "moment", load=LOAD, reduce=how).moment for how in REDUCTIONS}
    assert np.array_equal(got["max"], samples.max(axis=1))
    assert got["mean"].shape == (3, 3)
    assert np.allclose(got["peak"], np.linalg.norm(samples, axis=-1).max(axis=1), rtol=1e-15)
    assert got["peak"].shape == (3,)


def test_rows_of_one_driveline_are_reduced_each() -> None:
    angles = ANGLE.reshape(2, 3, -1)
    for load in (None, LOAD):
        names = MOTION if load is None else (*MOTION, "torque", "moment")
        got = CHAIN.evaluate(angles, names, joints=1, load=load, reduce="max")
        for place in np.ndindex(2, 3):
            want = CHAIN.evaluate(angles[place], names, joints=1, load=load, reduce="max")
            for name in names:
                assert np.array_equal(got[name][place], want[name]), name


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_reductions_of_any_type_fill_out(dtype: Any) -> None:  # noqa: ANN401
    plan = CHAIN.plan(("angle", "moment"), joints=1, load=LOAD, dtype=dtype, reduce="max")
    want = plan(ANGLE)
    out = {"moment": np.empty(3, dtype), "angle": np.empty((), dtype)}
    got = plan(ANGLE, out=out)
    for name, array in out.items():
        assert want[name].dtype == dtype
        assert got[name] is array
        assert np.array_equal(array, want[name])
    double = CHAIN.evaluate(ANGLE, ("angle", "moment"), joints=1, load=LOAD, reduce="max")
    assert np.allclose(want.moment, double.moment, rtol=2e-6)
    assert np.allclose(want.angle, double.angle, rtol=2e-6)


def test_reductions_row_by_row_whatever_the_threads() -> None:
    bends = np.linspace(0.01, 1.5, 300)
    batch = Driveline.from_bends(bends[:, None])[:, None]
    sweep = Sweep.revolutions(3, 720)
    want = batch.evaluate(sweep, MOTION, reduce="rms", workers=1)
    for workers in (2, 3, -1, None):
        got = batch.evaluate(sweep, MOTION, reduce="rms", workers=workers)
        for name in MOTION:
            assert np.array_equal(got[name], want[name])
    long = CHAIN.evaluate(np.linspace(0, 9, 300_000), "speed_ratio", reduce="mean", workers=1)
    other = CHAIN.evaluate(np.linspace(0, 9, 300_000), "speed_ratio", reduce="mean", workers=3)
    assert long.speed_ratio == other.speed_ratio


def test_a_nan_among_the_samples_stays() -> None:
    angle = ANGLE.copy()
    angle[1234] = np.nan
    for how in REDUCTIONS:
        assert np.isnan(CHAIN.evaluate(angle, "speed_ratio", reduce=how).speed_ratio)


@pytest.mark.parametrize(
    ("options", "angle", "message"),
    [
        ({"reduce": "median"}, ANGLE, "reduce is 'median'; did you mean"),
        ({"reduce": "max"}, 0.3, "one angle has none"),
        ({"reduce": "max"}, np.empty((2, 0)), "no samples in the last axis"),
        ({"dtype": np.int32}, ANGLE, "it must be float64 or float32"),
        ({"dtype": "nonsense"}, ANGLE, "it must be float64 or float32"),
        ({"tolerance": -1.0}, ANGLE, "tolerance is -1.0; it must not be negative"),
        ({"tolerance": math.nan}, ANGLE, "tolerance is nan"),
    ],
)
def test_wrong_options(options: Any, angle: Any, message: str) -> None:  # noqa: ANN401
    with pytest.raises(ValueError, match=re.escape(message)):
        CHAIN.evaluate(angle, "speed_ratio", **options)


# --- dtype and tolerance ---------------------------------------------------------------------


@pytest.mark.parametrize("angle", [ANGLE, Sweep.revolutions(3, 720), ANGLE.reshape(3, -1)])
def test_single_precision(angle: Any) -> None:  # noqa: ANN401
    names = (*MOTION, "torque", "moment", "bending_driving")
    options: dict[str, Any] = {"load": LOAD, "joints": 0}
    want = CHAIN.evaluate(angle, names, **options)
    got = CHAIN.evaluate(angle, names, dtype=np.float32, **options)
    out = {name: np.empty(got[name].shape, np.float32) for name in names}
    CHAIN.evaluate(angle, names, dtype=np.float32, out=out, **options)
    for name in names:
        assert got[name].dtype == np.float32
        assert np.array_equal(out[name], got[name])
        scale = np.abs(want[name]).max()
        assert np.max(np.abs(got[name] - want[name])) < 1e-6 * scale, name
    with pytest.raises(ValueError, match=re.escape("has dtype float64; it must be float32")):
        CHAIN.evaluate(angle, "angle", dtype="f4", out={"angle": np.empty(np.shape(angle))})


def test_single_results_of_double_arithmetic() -> None:
    want = CHAIN.evaluate(ANGLE, MOTION, tolerance=0)
    got = CHAIN.evaluate(ANGLE, MOTION, dtype=np.float32, tolerance=0)
    for name in MOTION:
        assert np.array_equal(got[name], want[name].astype(np.float32))


def test_the_cheapest_kernel_that_keeps_the_tolerance() -> None:
    def arithmetic(tolerance: float | None) -> str:
        told = CHAIN.plan("speed_ratio", tolerance=tolerance).explain()
        return told.split("arithmetic: ")[1].splitlines()[0]

    single, double = "single precision after a reduction in double", "double precision"
    assert {arithmetic(tolerance) for tolerance in (1.0, 1e-6)} == {single}
    assert {arithmetic(tolerance) for tolerance in (0.999e-6, 4e-15, None)} == {double}
    assert {arithmetic(tolerance) for tolerance in (3.99e-15, 0)} == {f"{double} with error terms"}
    with pytest.raises(TypeError, match=r"^tolerance is 'fine'; it must be a number$"):
        arithmetic("fine")  # type: ignore[arg-type]


# --- indexing a batch ------------------------------------------------------------------------


def test_long_runs_of_rows_of_one_driveline() -> None:
    batch = Driveline.from_bends([[0.4], [0.7]])
    angle = ANGLE[:1400].reshape(2, 70, 10)
    got = batch[:, None, None].evaluate(angle, "speed_ratio", reduce="max").speed_ratio
    for i in range(2):
        assert np.array_equal(got[i], batch[i].evaluate(angle[i]).speed_ratio.max(-1))


@pytest.mark.parametrize("tolerance", [None, 0, 1e-6])
def test_straight_joints_among_steep_ones_have_no_error(tolerance: float | None) -> None:
    bends = np.where(np.arange(40) % 2, 0.0, 1.569)
    got = Driveline.from_bends(bends[:, None]).evaluate(
        np.linspace(0.0, 3.0, 40), "angle_error", tolerance=tolerance
    )
    assert not got.angle_error[1::2].any()


def test_moments_in_every_plane_of_the_axes() -> None:
    directions = np.array([[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [1.0, 2.0, 0.0]])
    names = ("moment", "support_moment")
    want = Driveline.from_directions(directions).evaluate(ANGLE, names, load=LOAD_OF_ONE)
    for turn in (1, 2):
        line = Driveline.from_directions(np.roll(directions, turn, axis=1))
        got = line.evaluate(ANGLE, names, load=LOAD_OF_ONE)
        for name in names:
            scale = np.abs(want[name]).max()
            turned = np.roll(want[name], turn, axis=-1)
            np.testing.assert_allclose(got[name], turned, rtol=0, atol=1e-13 * scale)


def test_a_batch_is_indexed() -> None:
    batch = Driveline.from_bends(np.linspace(0.1, 1.2, 24).reshape(4, 3, 2), 0.3, 0.2)
    assert batch[1].shape == (3,)
    assert np.array_equal(batch[1, 2].bends, batch.bends[1, 2])
    assert batch[:, None].shape == (4, 1, 3)
    assert np.array_equal(batch[::2, 1].directions, batch.directions[::2, 1])
    assert batch[np.array([3, 0])].shape == (2, 3)
    with pytest.raises(IndexError):
        batch[4]
    with pytest.raises(TypeError, match="no batch to index"):
        batch[0, 0][0]


# --- extremes of sweeps ----------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [None, 0, 1e-6])
@pytest.mark.parametrize("degrees", [0.1, 20.0, 35.0, 35.26, 35.5, 60.0, 89.0, 89.99])
def test_extremes_of_the_jerk(degrees: float, tolerance: float | None) -> None:
    # Bends with tan b above the root of 1/2 have extremes besides those at quarter turns: of
    # 4 k^2 c^2 + 8 k (1 + k^2) c = 24 k^2 - (1 + k^2)^2 with c = cos 2a.
    bend = math.radians(degrees)
    line = Driveline.from_bends([bend])
    cosine, sine2, k = math.cos(bend), math.sin(bend) ** 2, math.tan(bend / 2) ** 2
    least, most = -2 * sine2 / cosine**3, 2 * cosine * sine2
    roots = np.roots([4 * k * k, 8 * k * (1 + k * k), (1 + k * k) ** 2 - 24 * k * k])
    (inner,) = roots[np.abs(roots) < 1] if math.tan(bend) > math.sqrt(0.5) else [-1.0]
    beside = line.evaluate(0.5 * math.acos(inner), "jerk_ratio", tolerance=0).jerk_ratio
    assert (inner > -1) == (degrees > 35.265)
    sweep = Sweep(-0.1, 3.1, 100_001)
    dense = line.evaluate(np.asarray(sweep), "jerk_ratio", tolerance=0).jerk_ratio
    close = (2e-6 if tolerance else 1e-12) * -least
    for how, value, sampled in (
        ("min", least, dense.min()),
        ("max", max(most, float(beside)), dense.max()),
        ("peak", -least, -dense.min()),
    ):
        got = line.evaluate(sweep, "jerk_ratio", reduce=how, tolerance=tolerance).jerk_ratio  # type: ignore[arg-type]
        assert abs(got - sampled) <= close + 1e-9 * -least * (degrees > 89.5), how
        # Samples lie beside the closed forms.
        narrow = (3.2e-5 / cosine) ** 2
        assert abs(got - value) <= close + 20 * narrow * -least, how


def test_extremes_past_the_end_of_a_sweep_do_not_count() -> None:
    line = Driveline.from_bends([0.5])
    sweep = Sweep(1.6, np.pi - 2e-4, 7001)
    samples = line.evaluate(sweep, "speed_ratio").speed_ratio
    assert line.evaluate(sweep, "speed_ratio", reduce="max").speed_ratio == samples[-1]


def test_extremes_of_sweeps_are_samples() -> None:
    line = Driveline.from_bends([0.5])
    sweep = Sweep.revolutions(1, 9998)
    samples = line.evaluate(sweep, "angle_error").angle_error
    assert line.evaluate(sweep, "angle_error", reduce="max").angle_error == samples.max()
    # The closed form lies between two samples.
    assert samples.max() < line.equivalent().max_angle_error


# --- what a search has found -----------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [None, 0.0])
def test_sweeps_keep_their_digits_beside_quarter_turns(tolerance: float | None) -> None:
    line = Driveline.from_bends([0.5])
    for sweep in (Sweep(5.259807074643486, -9.7, 8192), Sweep(0.1, 3000.0, 1_500_000)):
        got = line.plan("angle_error", tolerance=tolerance)(sweep).angle_error
        angles = np.asarray(sweep)
        beside = np.argsort(np.abs(np.sin(2.0 * angles)))[:20]
        limit = limits("tolerance_0" if tolerance == 0 else "samples")["angle_error"]
        first, last = mp.mpf(float(sweep._given[0])), mp.mpf(float(sweep._given[1]))
        for i in beside:
            angle = first + (last - first) * int(i) / (sweep.num - 1)
            k = mp.tan(mp.mpf(0.5) / 2) ** 2
            exact = mp.atan2(k * mp.sin(2 * angle), 1 - k * mp.cos(2 * angle))
            ulp = np.spacing(abs(float(exact)))
            assert abs(mp.mpf(float(got[i])) - exact) <= limit * ulp


def test_steep_sweeps_keep_their_digits_where_another_formula_takes_over() -> None:
    bend = 1.5682764756065442
    line = Driveline.from_bends([bend])
    cosine = mp.cos(mp.mpf(bend))
    for ends, sample in (
        ((-0.7328297099337939, 0.6954648299268009), 2104),
        ((-0.5423011150334709, 0.5436042182318741), 2041),
    ):
        result = line.evaluate(Sweep(*ends, 4096), ("angle", "angle_error"), tolerance=0)
        first, last = (mp.mpf(end) for end in ends)
        drive = first + (last - first) * sample / 4095
        tangent = mp.tan(drive)
        error = mp.atan((1 - cosine) * tangent / (cosine + tangent**2))
        for got, exact in ((result.angle, drive + error), (result.angle_error, error)):
            assert abs(mp.mpf(float(got[sample])) - exact) <= np.spacing(abs(float(exact)))


def test_bending_beside_its_zero_keeps_its_digits() -> None:
    line = Driveline.from_bends([1.57])
    got = line.evaluate(6.1e-190, "bending_driving", load=Load(drive_torque=1.0), joints=0)
    assert got.bending_driving == pytest.approx(math.tan(1.57) * 6.1e-190, rel=1e-14)


@pytest.mark.parametrize("tolerance", [None, 0, 1e-6])
@pytest.mark.parametrize("bend", [0.3, 1.2])
def test_a_compensated_shaft_turns_with_the_drive(bend: float, tolerance: float | None) -> None:
    names = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
    angle = np.linspace(-9.0, 9.0, 1001)
    plan = Driveline.from_bends([bend, bend]).plan(names, shafts=2, tolerance=tolerance)
    explained = plan.explain(angle)
    assert ", those of the drive" in explained
    assert "shaft 2: turns with the drive, the joints before it compensate each other" in explained
    assert "sine and cosine: everything turns with the drive" in explained
    found = plan(angle)
    wanted = {name: np.zeros(1001) for name in names} | {
        "angle": angle,
        "speed_ratio": np.ones(1001),
    }
    for name in names:
        np.testing.assert_array_equal(found[name], wanted[name], name)


def test_a_shaft_that_is_nearly_compensated_moves() -> None:
    """What rounding leaves of two bends is computed, with all its digits."""
    bends = [0.3, math.nextafter(0.3, 1.0)]
    plan = Driveline.from_bends(bends).plan("angle_error", tolerance=0)
    assert "compensate" not in plan.explain(1.0)
    with mp.workdps(80):
        error = Fold.of(bends, [0.0], [0.0]).angle_error(ExactTurn.by(1.0))
        assert abs(error) < 1e-16
        assert Exact.of([error]).ulps(plan([1.0]).angle_error)[0] <= 0.51


@pytest.mark.parametrize("length", [1, 8, 3000])
def test_arrays_given_are_filled_as_they_are(length: int) -> None:
    plan = Driveline.from_bends([0.3]).plan(("angle", "speed_ratio"))
    angle = np.linspace(0.0, 7.0, length)
    wanted = plan(angle)
    out = {"speed_ratio": np.zeros(length), "angle": np.zeros(length)}
    result = plan(angle, out=out)
    for name, array in out.items():
        assert result[name] is array
        np.testing.assert_array_equal(array, wanted[name])
    # In place, strided and read backwards.
    shared = angle.copy()
    strided = np.zeros(2 * length)[::2]
    plan(shared[::-1], out={"angle": shared, "speed_ratio": strided})
    np.testing.assert_array_equal(shared, wanted.angle[::-1])
    np.testing.assert_array_equal(strided, wanted.speed_ratio[::-1])


@pytest.mark.parametrize("tolerance", [None, 0.0])
def test_a_far_angle_leaves_its_neighbours_alone(tolerance: float | None) -> None:
    line = Driveline.from_bends([1.0088541896755423])
    near = np.array([-800892.1051013289, -800892.0992634589, 0.7, -0.3, 3.0, 1e6])
    alone = line.plan(MOTION, tolerance=tolerance)(near)
    beside = line.plan(MOTION, tolerance=tolerance)(np.append(near, 1e300))
    for name in MOTION:
        ulp = np.spacing(np.abs(alone[name]))
        assert np.all(np.abs(beside[name][:-1] - alone[name]) <= (1 if tolerance == 0 else 4) * ulp)


@pytest.mark.parametrize("far", [3.4e6, -3.4e6, 8e6, -8e6, 2e7])
def test_far_angles_in_single_precision(far: float) -> None:
    line = Driveline.from_bends([0.5])
    angle = far + np.linspace(0.0, 7.0, 100)
    got = line.evaluate(angle, "speed_ratio", dtype=np.float32).speed_ratio
    want = line.evaluate(angle, "speed_ratio").speed_ratio
    np.testing.assert_allclose(got, want, rtol=1e-6)


def test_a_straight_driveline_over_a_single_sample_is_reduced() -> None:
    line = Driveline.from_bends([0.0])
    found = line.evaluate(Sweep(1.0, 1.0, 1), "speed_ratio", reduce="max")
    assert found.speed_ratio == 1.0


def test_outputs_of_no_items_beside_others() -> None:
    angle = np.linspace(0.0, 7.0, 9)
    plan = Driveline.from_bends([0.3]).plan(("angle", "tilt_driving"), joints=[])
    out = {"angle": np.zeros(9)}
    result = plan(angle, out=out)
    assert result.angle is out["angle"]
    assert result.tilt_driving.shape == (0, 9)
    np.testing.assert_array_equal(result.angle, plan(angle).angle)


def test_no_outputs_need_no_memory() -> None:
    assert not Driveline.from_bends([0.3]).plan(())(Sweep(0.0, 1.0, 2**50))


@pytest.mark.parametrize("shape", [(), (7,), (2, 3, 4)])
@pytest.mark.parametrize("items", [None, 0, [0, 1]])
def test_loads_and_vectors_fill_what_is_given(
    shape: tuple[int, ...], items: int | list[int] | None
) -> None:
    load = Load(output_torque=5.0, speed=np.full(shape, 3.0), inertias=[0.1, 0.2, 0.3])
    names = ("moment", "torque", "support_moment", "angle")
    plan = Driveline.from_bends([0.3, 0.4], 0.1).plan(names, shafts=items, joints=items, load=load)
    angle = np.linspace(0.0, 7.0, int(np.prod(shape))).reshape(shape)
    wanted = plan(angle)
    out = {name: np.zeros(np.shape(array)) for name, array in wanted.items()}
    for name, array in plan(angle, out=out).items():
        assert array is out[name]
        np.testing.assert_array_equal(array, wanted[name])
    # What is read is written over.
    torque = np.full(shape, 5.0)
    load = Load(drive_torque=torque, speed=2.0)
    plan = Driveline.from_bends([0.3, 0.4], 0.1).plan("torque", load=load)
    expected = plan(angle).torque
    assert plan(angle, out={"torque": load.torque}).torque is load.torque
    np.testing.assert_array_equal(load.torque, expected)
