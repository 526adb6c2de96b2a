"""Results over the angle of the last shaft: the drive angle found for it, and what is shown."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from cardan import ArgumentValueError, Driveline, Load, Sweep
from oracle import Exact, ExactTurn, Fold, MpNumber, limits, mp

LINE = Driveline.from_bends([0.4, 0.3], 0.2, 0.7)
BATCH = Driveline.from_bends([[[0.4, 0.3]], [[0.1, 0.9]], [[0.0, 0.0]]], 0.2, 0.7)
LOAD = Load(drive_torque=3.0, speed=2.0, inertias=[0.1, 0.2, 0.3])
ANGLES = np.linspace(-9.0, 30.0, 41)
NAMES = ("angle", "speed_ratio", "torque", "moment")


def chain(random: np.random.Generator, joints: int, largest: float) -> Driveline:
    between = random.uniform(-4.0, 4.0, (2, joints - 1))
    return Driveline.from_bends(random.uniform(0.0, largest, joints), *between)


def ulps(line: Driveline, driven: MpNumber, drive: float) -> float:
    """How far a drive angle is from that of an angle of the last shaft, in ulp.

    The exact chain turns the drive angle forward, and the speed ratio tells how much the difference
    means at the drive.
    """
    fold, at = (
        Fold.of(*(x.tolist() for x in (line.bends, line.twists, line.phases))),
        ExactTurn.by(drive),
    )
    off = (fold.angle(at) - driven) / fold.speed_ratio(at)
    return float(abs(off) / np.spacing(abs(drive)))


def spread(random: np.random.Generator) -> list[float]:
    signs = random.choice([-1.0, 1.0], 12)
    return [*random.uniform(-20.0, 20.0, 20), *(signs * 10.0 ** random.uniform(-9.0, 12.0, 12))]


@pytest.mark.parametrize("joints", [1, 2, 3, 5])
@pytest.mark.parametrize("largest", [0.5, 1.2, 1.5])
def test_drive_angles_are_the_nearest_doubles_or_next_to_them(joints: int, largest: float) -> None:
    random = np.random.default_rng([joints, int(10 * largest)])
    for _ in range(5):
        line = chain(random, joints, largest)
        angles = spread(random)
        found = line.evaluate(angles, "speed_ratio", angle_of="driven").drive_angle
        worst = max(
            ulps(line, mp.mpf(angle), drive) for angle, drive in zip(angles, found, strict=True)
        )
        assert worst <= 1.0, (line.bends, line.twists, line.phases)


@pytest.mark.parametrize(
    ("sweep", "exact"),
    [
        (Sweep.revolutions(3, 77), lambda i: 2 * mp.pi * i / 77),
        (Sweep(-5.0, 1e6, 231), lambda i: -5 + (mp.mpf(1e6) + 5) * i / 230),
    ],
)
def test_sweeps_are_exact(sweep: Sweep, exact: Any) -> None:  # noqa: ANN401
    line = chain(np.random.default_rng(7), 3, 0.8)
    found = line.evaluate(sweep, "speed_ratio", angle_of="driven").drive_angle
    assert max(ulps(line, exact(i), found[i]) for i in range(231)) <= 1.0


def test_a_batch_has_drive_angles_of_its_own() -> None:
    result = BATCH.evaluate(ANGLES, NAMES, angle_of="driven", load=LOAD, shafts=[0, 2])
    assert result.drive_angle.shape == (3, 41)
    assert result.torque.shape == (2, 3, 41)
    for i, line in enumerate(BATCH[:, 0]):
        own = line.evaluate(ANGLES, NAMES, angle_of="driven", load=LOAD, shafts=[0, 2])
        assert np.array_equal(own.drive_angle, result.drive_angle[i])
        for name in NAMES:
            assert np.array_equal(own[name], result[name][:, i])
        pairs = zip(ANGLES, own.drive_angle, strict=True)
        assert max(ulps(line, mp.mpf(angle), drive) for angle, drive in pairs) <= 1.0


STEEP = [
    Driveline.from_bends([math.radians(80.0)]),
    Driveline.from_bends([math.radians(89.9)]),
    Driveline.from_bends([math.radians(89.9999)]),
    Driveline.from_bends([0.4, math.radians(89.9), 0.3], [0.5, -1.0], [0.3, 2.0]),
    *(chain(np.random.default_rng([9, joints]), joints, 1.4) for joints in (2, 3, 5)),
]


@pytest.mark.parametrize("line", STEEP)
def test_outputs_are_as_accurate_as_over_the_drive_angle(line: Driveline) -> None:
    slow = math.pi / 2 - float(line.equivalent().angle_offset)
    angles = [*spread(np.random.default_rng(6)), *(slow + np.linspace(-1e-3, 1e-3, 8)), 0.0]
    parameters = [x.tolist() for x in (line.bends, line.twists, line.phases)]
    bends, *between = parameters
    joints = range(line.n_joints)
    folds = [Fold.of(bends[: j + 1], *(x[:j] for x in between)) for j in joints]
    inverse = Fold(folds[-1].a, -folds[-1].b, folds[-1].complement)
    at = [ExactTurn.by(inverse.angle(ExactTurn.by(angle))) for angle in angles]
    names = ("angle_error", "speed_ratio", "acceleration_ratio")
    exact = {
        name: [Exact.of(getattr(fold, name)(x) for x in at) for fold in folds] for name in names
    }
    # Without a tolerance the limits of a chain have other units.
    columns = {0: "tolerance_0"} | ({None: "worst"} if line.n_joints == 1 else {})
    for tolerance, column in columns.items():
        found = line.evaluate(
            angles, names, angle_of="driven", shafts=slice(1, None), tolerance=tolerance
        )
        for name in names:
            for shaft, wanted in enumerate(exact[name]):
                worst = np.max(wanted.ulps(found[name][shaft]))
                assert worst <= limits(column)[name], (tolerance, name, shaft)


def test_outputs_of_every_kind_belong_to_the_drive_angles() -> None:
    result = LINE.evaluate(ANGLES, NAMES, angle_of="driven", load=LOAD)
    again = LINE.evaluate(result.drive_angle, NAMES, load=LOAD)
    for name in NAMES:
        assert result[name] == pytest.approx(again[name], rel=1e-13, abs=1e-13), name
    assert np.max(np.abs(result.angle - ANGLES) / np.spacing(np.abs(ANGLES))) <= 1.0


@given(
    st.lists(st.floats(0.0, 1.4), min_size=1, max_size=4),
    st.lists(st.floats(-4.0, 4.0), min_size=6, max_size=6),
    st.floats(-100.0, 100.0),
)
@example(bends=[0.0, 1.4e-45], between=[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], angle=1.0)
@example(bends=[1.4e-45, 0.0], between=[0.5 * math.pi, 0.0, 0.0, 0.5, 0.0, 0.0], angle=0.0)
def test_there_and_back(bends: list[float], between: list[float], angle: float) -> None:
    n = len(bends)
    line = Driveline.from_bends(bends, between[: n - 1], between[3 : n + 2])
    driven = line.evaluate(angle, "angle").angle
    result = line.evaluate(driven, "speed_ratio", angle_of="driven")
    # The rounding of the driven angle, as seen from the drive.
    permitted = 8.0 * np.spacing(101.0) / min(1.0, float(result.speed_ratio))
    assert abs(result.drive_angle - angle) <= permitted
    # Turns are counted, however many.
    later = line.evaluate(driven + 20.0 * math.pi, "speed_ratio", angle_of="driven").drive_angle
    assert abs(later - angle - 20.0 * math.pi) <= 2.0 * permitted


def test_no_angle_has_no_drive_angle() -> None:
    result = LINE.evaluate([math.nan, math.inf, 1.0], NAMES, angle_of="driven", load=LOAD)
    for values in (result.drive_angle, result.angle, result.torque, result.moment[0, :, 1]):
        assert np.isnan(values).tolist() == [True, True, False]


def test_one_angle_and_none() -> None:
    one = LINE.evaluate(0.3, angle_of="driven")
    assert one.speed_ratio.shape == one.drive_angle.shape == ()
    assert LINE.evaluate([], angle_of="driven").speed_ratio.shape == (0,)


def test_degrees() -> None:
    radians = LINE.evaluate(np.radians(ANGLES), ("angle", "torque"), angle_of="driven", load=LOAD)
    degrees = LINE.evaluate(ANGLES, ("angle", "torque"), angle_of="driven", load=LOAD, degrees=True)
    assert np.array_equal(degrees.drive_angle, np.degrees(radians.drive_angle))
    assert degrees.units["drive_angle"] == "deg"
    assert np.array_equal(degrees.angle, np.degrees(radians.angle))
    assert np.array_equal(degrees.torque, radians.torque)


def test_reductions_and_types() -> None:
    sweep = Sweep.revolutions(1, 720)
    whole = LINE.evaluate(sweep, "torque", angle_of="driven", load=LOAD).torque
    found = LINE.evaluate(
        sweep, "torque", angle_of="driven", load=LOAD, reduce=["min", "max", "mean", "rms"]
    ).torque
    wanted = [whole.min(), whole.max(), whole.mean(), np.sqrt(np.mean(whole**2))]
    assert found == pytest.approx(wanted, rel=1e-14)
    single = LINE.evaluate(sweep, "torque", angle_of="driven", load=LOAD, dtype=np.float32).torque
    assert single.dtype == np.float32
    assert single == pytest.approx(whole, rel=1e-5)


def test_arrays_to_fill() -> None:
    plan = LINE.plan(("speed_ratio", "moment"), joints=1, load=LOAD, angle_of="driven")
    new = plan(ANGLES)
    # Also the array of the angles itself.
    own = ANGLES.copy()
    out = {"speed_ratio": own, "moment": np.empty((41, 3))}
    filled = plan(own, out=out)
    assert filled.speed_ratio is own
    for name, array in out.items():
        assert np.array_equal(array, new[name])


def test_the_mean_over_the_driven_angle_is_that_over_time_at_the_output() -> None:
    # At constant output speed the power is constant as well: D r is, so the mean of r is that of
    # the reciprocal Poisson kernel.
    bend = 0.6
    k = math.tan(bend / 2) ** 2
    mean = Driveline.from_bends([bend]).evaluate(
        Sweep.revolutions(1, 256), "speed_ratio", angle_of="driven", reduce="mean"
    )
    assert mean.speed_ratio == pytest.approx((1 + k * k) / (1 - k * k), rel=1e-15)


@pytest.mark.parametrize("value", ["input", None, 1, ["driven"], ""])
def test_what_is_no_angle_of_the_line_is_refused(value: Any) -> None:  # noqa: ANN401
    with pytest.raises(ArgumentValueError, match=r"angle_of is .*; it must be 'drive' or 'driven'"):
        LINE.evaluate(ANGLES, angle_of=value)
    with pytest.raises(ArgumentValueError, match="angle_of is"):
        LINE.plan(angle_of=value)


def test_the_plan_explains_both_steps() -> None:
    plan = LINE.plan(angle_of="driven")
    text = plan.explain(Sweep.revolutions(1, 100))
    first, second, *_ = text.splitlines()
    assert first == "drive angles in closed form from angles of the last shaft"
    assert second == "plan for angle, speed_ratio; 2 joints"
    assert BATCH.plan(angle_of="driven").explain(Sweep.revolutions(1, 100)).count("plan for") == 1


# --- other array libraries -------------------------------------------------------------------


def test_labelled_angles() -> None:
    xarray = pytest.importorskip("xarray")
    pandas = pytest.importorskip("pandas")
    expected = LINE.evaluate(ANGLES, angle_of="driven")
    labelled = xarray.DataArray(ANGLES, dims="time", coords={"time": np.arange(41)})
    data: Any = LINE.evaluate(labelled, angle_of="driven")
    assert np.array_equal(data.speed_ratio, expected.speed_ratio)
    assert np.array_equal(data.drive_angle, expected.drive_angle)
    assert data.drive_angle.dims == ("time",)
    frame: Any = LINE.evaluate(pandas.Series(ANGLES, index=np.arange(41) + 3), angle_of="driven")
    assert np.array_equal(frame.speed_ratio, expected.speed_ratio)
    assert frame.index[0] == 3
    for angle in (labelled, pandas.Series(ANGLES)):
        with pytest.raises(ArgumentValueError, match="different drive angles; give its values"):
            BATCH.evaluate(angle, angle_of="driven")
    table = expected.to_pandas()
    assert np.array_equal(table.index, expected.drive_angle)
    both = BATCH.evaluate(ANGLES, angle_of="driven").to_xarray()
    assert both.drive_angle.shape == (3, 41)


def test_angles_computed_later() -> None:
    array = pytest.importorskip("dask.array")
    later = LINE.evaluate(
        array.from_array(ANGLES, chunks=10), NAMES, angle_of="driven", load=LOAD
    ).compute()
    expected = LINE.evaluate(ANGLES, NAMES, angle_of="driven", load=LOAD)
    assert later == expected
    assert np.array_equal(later.drive_angle, expected.drive_angle)
    lines = Driveline.from_bends(array.from_array([[0.1, 0.2]]))
    with pytest.raises(ArgumentValueError, match="drivelines of dask arrays take the drive angle"):
        lines.evaluate(ANGLES, angle_of="driven")
