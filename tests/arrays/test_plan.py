"""Plans, sweeps, reductions, dtypes and tolerances: every way to the same results."""

from __future__ import annotations

import math
import pickle
import re
from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, Driveline, Load, Sweep
from oracle import Exact, ExactTurn, Fold, mp

MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
CHAIN = Driveline.from_bends([0.5, 0.0, 0.9], [0.3, -1.0], [0.7, 0.2])
STEEP = Driveline.from_bends([1.55])
LOAD_OF_TWO = Load(drive_torque=1.0, speed=1.0, inertias=[0.0, 1.0])
LOAD = Load(drive_torque=7.0, speed=30.0, inertias=[0.1, 0.0, 0.3, 0.2])
ANGLE = np.linspace(-7.0, 20.0, 3000)


# --- plans -----------------------------------------------------------------------------------


def test_a_plan_gives_what_evaluate_gives() -> None:
    options: dict[str, Any] = {"shafts": [1, 3], "joints": 0, "load": LOAD}
    names = (*MOTION, "torque", "support_moment", "moment", "tilt_driven")
    plan = CHAIN.plan(names, **options)
    for angle in (ANGLE, ANGLE.reshape(3, -1), 0.3, ANGLE[::-7]):
        want = CHAIN.evaluate(angle, names, **options)
        for name in names:
            assert np.array_equal(plan(angle)[name], want[name]), name


def test_moments_of_zero_have_no_error() -> None:
    quarters = Sweep.revolutions(1, 4)
    got = STEEP.evaluate(quarters, "bending_driven", load=Load(drive_torque=1.0), tolerance=0)
    assert np.all(np.abs(got.bending_driven[0, 1::2]) < 1e-15)


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
        (
            CHAIN,
            tuple(name for name, output in OUTPUTS.items() if output.ideal),
            {"joints": 2, "load": LOAD},
            [
                "shaft 2: speed ratio",
                "joint 2: rates of the cross from the speed ratio",
                "joint 2: pins in space",
                "joint 2: pin moment from the torsion",
            ],
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


def test_loads_follow_the_tolerance() -> None:
    exact = CHAIN.evaluate(ANGLE, ("torque", "support_moment"), shafts=[1, 2], load=LOAD)
    for tolerance, limit in ((0, 1e-14), (1e-9, 1e-14), (1e-6, 1e-6)):
        got = CHAIN.evaluate(
            ANGLE, ("torque", "support_moment"), shafts=[1, 2], load=LOAD, tolerance=tolerance
        )
        for name in got:
            scale = np.abs(exact[name]).max()
            assert np.max(np.abs(got[name] - exact[name])) < limit * scale


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


def test_steep_chains_keep_their_tolerance() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 20_001)
    for degrees in (60.0, 84.27, 89.0, 89.99):
        line = Driveline.from_bends([0.0, math.radians(degrees)], 0.3, 0.7)
        names = ("acceleration_ratio", "jerk_ratio")
        exact = line.evaluate(angle, names, tolerance=0)
        for tolerance in (1e-6, 1e-9, 1e-14):
            got = line.evaluate(angle, names, tolerance=tolerance)
            for name in names:
                error = np.abs(got[name] - exact[name]).max() / np.abs(exact[name]).max()
                assert error <= tolerance, name


def test_bending_beside_its_zero_keeps_its_digits() -> None:
    line = Driveline.from_bends([1.57])
    got = line.evaluate(6.1e-190, "bending_driving", load=Load(drive_torque=1.0), joints=0)
    assert got.bending_driving == pytest.approx(math.tan(1.57) * 6.1e-190, rel=1e-14)


def test_compensated_chains_have_no_negative_bend() -> None:
    directions = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 0]]
    points = [[0, 0, 0], [600, 0, 0], [1900, -140, 60], [3100, -180, 0], [3500, -180, -40]]
    string = Driveline.from_points(points)
    string = string.with_phases(string.optimal_phases())
    for line in (Driveline.from_directions(directions), string):
        found = line.equivalent()
        assert 0.0 <= found.k < 1e-15
        assert found.bend >= 0.0
        assert found.max_angle_error >= 0.0
        assert found.non_uniformity >= 0.0


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


def test_a_batch_of_none_has_nothing_to_explain() -> None:
    with pytest.raises(ValueError, match="no driveline"):
        Driveline.from_bends(np.zeros((0, 2))).plan("speed_ratio").explain()


def test_vectors_fill_arrays_that_lie_plane_by_plane() -> None:
    line, load = Driveline.from_bends([0.3, 0.4], 0.1, 0.2), Load(drive_torque=10.0)
    angle = np.linspace(0.0, 7.0, 1001)
    plan = line.plan("moment", load=load)
    planes = np.zeros((2, 3, 1001))
    out = np.moveaxis(planes, 1, -1)
    result = plan(angle, out={"moment": out})
    assert result.moment is out
    np.testing.assert_array_equal(out, plan(angle).moment)


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
