"""Sweeps and reductions: what their samples give, computed shorter."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load, Sweep
from cardan.evaluation.reductions import REDUCTIONS, Reduction
from oracle import limits, mp
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


@pytest.mark.parametrize("sweep", [Sweep.revolutions(20, 5000), Sweep.revolutions(15, 7001)])
def test_sweeps_of_turns_repeat_in_parts(sweep: Sweep) -> None:
    # The threads' parts of such a sweep begin within a turn, and the last one may be shorter.
    want = CHAIN.evaluate(np.asarray(sweep), MOTION)
    for workers in (3, None):
        got = CHAIN.evaluate(sweep, MOTION, workers=workers)
        for name in MOTION:
            atol = 1e-13 * peak(CHAIN, name)
            np.testing.assert_allclose(got[name], want[name], rtol=0, atol=atol)


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


@pytest.mark.parametrize("options", [{"dtype": np.float32}, {"tolerance": 1e-6}])
@pytest.mark.parametrize("per_turn", [721, 3000])
def test_sweeps_in_single_precision(options: Any, per_turn: int) -> None:  # noqa: ANN401
    sweep = Sweep.revolutions(4, per_turn)
    got = CHAIN.evaluate(sweep, MOTION, **options)
    want = CHAIN.evaluate(np.asarray(sweep), MOTION)
    for name in MOTION:
        atol = 2e-6 * np.abs(want[name]).max()
        np.testing.assert_allclose(got[name], want[name], rtol=0, atol=atol)


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
        "TypeError: turns is 1j": lambda: Sweep.revolutions(1j, 3),  # type: ignore[arg-type]
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


def test_long_runs_of_rows_of_one_driveline() -> None:
    batch = Driveline.from_bends([[0.4], [0.7]])
    angle = ANGLE[:1400].reshape(2, 70, 10)
    got = batch[:, None, None].evaluate(angle, "speed_ratio", reduce="max").speed_ratio
    for i in range(2):
        assert np.array_equal(got[i], batch[i].evaluate(angle[i]).speed_ratio.max(-1))


# --- extremes of sweeps ----------------------------------------------------------------------


@pytest.mark.parametrize("reduce", ["min", "max", "peak"])
@pytest.mark.parametrize("tolerance", [None, 0.0, 1e-6])
@pytest.mark.parametrize(
    "sweep",
    [
        Sweep(0.0, 1.0, 7000),
        Sweep(2.9, -9.3, 20_011),
        Sweep.revolutions(1, 7200),
        Sweep.revolutions(2.5, 20_000),
        Sweep(0.0, 400.0, 1500),
    ],
)
def test_extremes_of_sweeps_are_those_of_all_samples(
    sweep: Sweep, tolerance: float | None, reduce: Reduction
) -> None:
    names = MOTION[1:]
    for line in (
        Driveline.from_bends([[[0.5]], [[0.0]], [[1.5]], [[1e-3]]]),
        Driveline.from_bends([[0.3, 0.0, 0.4], [0.7, 0.9, 1.1]], [0.2, 1.0], [0.4, -2.0])[:, None],
    ):
        settings: dict[str, Any] = {"shafts": sorted({1, line.n_joints}), "tolerance": tolerance}
        samples = line.plan(names, **settings)(np.asarray(sweep))
        found = line.plan(names, reduce=reduce, **settings)(sweep)
        for name in names:
            size = np.abs(samples[name]) if reduce == "peak" else samples[name]
            wanted = size.min(axis=-1) if reduce == "min" else size.max(axis=-1)
            # The array holds rounded angles; single precision has its own rounding.
            scale = np.abs(samples[name]).max(axis=-1)
            bound = 2e-6 if tolerance == 1e-6 else 1e-11
            np.testing.assert_allclose(found[name], wanted, rtol=0, atol=bound * scale.max())


@pytest.mark.parametrize(("name", "load"), [("torque", LOAD_OF_TWO), ("tilt_driving", None)])
def test_extremes_of_what_is_no_motion(name: str, load: Load | None) -> None:
    sweep = Sweep.revolutions(2, 5000)
    samples = STEEP.evaluate(sweep, name, load=load)[name]
    reduced = {how: STEEP.evaluate(sweep, name, load=load, reduce=how)[name] for how in REDUCTIONS}
    assert np.array_equal(reduced["min"], samples.min(axis=-1))
    assert np.array_equal(reduced["max"], samples.max(axis=-1))


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


@pytest.mark.parametrize("start", [1e12 - 7, -1e12])
def test_extremes_of_far_sweeps(start: float) -> None:
    names = MOTION[1:]
    sweep = Sweep(start, start + 6, 100_000)
    samples = CHAIN.evaluate(sweep, names)
    extremes: tuple[Reduction, ...] = ("min", "max", "peak")
    for how in extremes:
        got = CHAIN.evaluate(sweep, names, reduce=how)
        for name in names:
            atol = 1e-14 * np.abs(samples[name]).max()
            np.testing.assert_allclose(got[name], PLAIN[how](samples[name]), rtol=0, atol=atol)


def test_extremes_of_a_turn_are_the_closed_forms() -> None:
    line = Driveline.from_bends(np.radians([[1.0], [20.0], [60.0], [85.0]]))
    joint = line.equivalent()
    fine = Sweep.revolutions(1, 100_000)
    got = line[:, None].evaluate(fine, ("speed_ratio", "angle_error"), reduce="max")
    assert np.allclose(got.speed_ratio, joint.max_speed_ratio, rtol=1e-15)
    assert np.allclose(got.angle_error, joint.max_angle_error, rtol=1e-6)
    assert np.all(got.angle_error <= joint.max_angle_error * (1 + 1e-15))


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


def test_a_straight_driveline_over_a_single_sample_is_reduced() -> None:
    line = Driveline.from_bends([0.0])
    found = line.evaluate(Sweep(1.0, 1.0, 1), "speed_ratio", reduce="max")
    assert found.speed_ratio == 1.0
