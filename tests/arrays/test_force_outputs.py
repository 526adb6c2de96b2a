"""Forces as outputs like all others: arrays, batches, reductions, arrays to fill, refusals."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cardan import Driveline, Load, Plan, Sweep
from cardan.evaluation.reductions import Reduction
from refusals import refusals

Doubles = NDArray[np.float64]

POINTS = np.array([[0.0, 0, 0], [0.3, 0.05, 0], [1.5, -0.1, 0.1], [3.0, -0.4, 0], [3.3, -0.4, 0.1]])
BEARINGS = [(3, 0.05), (0, 0.05), (1, 1.0), (0, 0.2), (3, 0.2)]
LINE = Driveline.from_points(POINTS, phases=[0.4, -1.0]).with_bearings(BEARINGS)
BATCH = Driveline.from_points(POINTS * np.array([1.0, 1.1, 1.2])[:, None, None]).with_bearings(
    BEARINGS
)
ANGLE = np.linspace(-3.0, 9.0, 600)
LOAD = Load(output_torque=100.0, speed=50.0, inertias=[0.1, 0.2, 0.1, 0.3])
NAMES = ("joint_force", "bearing_force")


def test_shapes() -> None:
    result = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    assert result.joint_force.shape == (3, 600, 3)
    assert result.bearing_force.shape == (5, 600, 3)
    assert result.units["bearing_force"] == "N"
    one = LINE.evaluate(0.3, NAMES, load=LOAD, joints=1)
    assert one.joint_force.shape == (3,)
    assert one.bearing_force.shape == (5, 3)
    many = BATCH[:, None].evaluate(ANGLE, NAMES, load=LOAD, joints=[2, 0])
    assert many.joint_force.shape == (2, 3, 600, 3)
    assert many.bearing_force.shape == (5, 3, 600, 3)


def test_joints_can_be_chosen_in_any_order() -> None:
    every = LINE.evaluate(ANGLE, "joint_force", load=LOAD).joint_force
    some = LINE.evaluate(ANGLE, "joint_force", load=LOAD, joints=[2, 0]).joint_force
    np.testing.assert_array_equal(some, every[[2, 0]])


def test_each_alone_is_as_in_company() -> None:
    others = ("support_moment", "moment", "torque", "angle", "tilt_driven")
    together = LINE.evaluate(ANGLE, (*NAMES, *others), load=LOAD, shafts=[1, 0, 3])
    for name in (*NAMES, *others):
        alone = LINE.evaluate(ANGLE, name, load=LOAD, shafts=[1, 0, 3])[name]
        np.testing.assert_array_equal(together[name], alone)


def test_a_batch_is_its_drivelines() -> None:
    rows = BATCH[:, None].evaluate(ANGLE, NAMES, load=LOAD)
    each = BATCH.evaluate(ANGLE.reshape(200, 3), NAMES, load=LOAD)
    for i, line in enumerate(BATCH):
        alone = line.evaluate(ANGLE, NAMES, load=LOAD)
        paired = line.evaluate(ANGLE[i::3], NAMES, load=LOAD)
        for name in NAMES:
            np.testing.assert_array_equal(rows[name][:, i], alone[name])
            size = np.abs(paired[name]).max()
            np.testing.assert_allclose(each[name][:, :, i], paired[name], atol=1e-13 * size)


def test_steep_drivelines() -> None:
    # Forces of moderate drivelines without inertias between the joints are sums over the parts of
    # the drive shaft, others sums over joints.
    steep = Driveline.from_points(POINTS * np.array([1.0, 6.0, 4.0])).with_bearings(BEARINGS)
    load = Load(output_torque=100.0, speed=50.0, inertias=[0.1, 0, 0, 0.3])
    for line, given, joints in (
        (LINE, load, [2]),
        (LINE, LOAD, [0, 1, 2]),
        (steep, load, [0, 1, 2]),
    ):
        text = line.plan(NAMES, load=given).explain()
        parts = "parts for the forces from the power"
        assert [joint for joint in range(3) if f"joint {joint}: {parts}" in text] == joints, text
        got, want = (line.evaluate(ANGLE, NAMES, load=given, tolerance=tol) for tol in (None, 0.0))
        for name in NAMES:
            atol = 1e-14 * np.abs(want[name]).max()
            np.testing.assert_allclose(got[name], want[name], rtol=0, atol=atol)
    together = Driveline.concatenate([LINE, steep])[:, None].evaluate(ANGLE, NAMES, load=load)
    for name in NAMES:
        for i, line in enumerate((LINE, steep)):
            alone = line.evaluate(ANGLE, name, load=load)[name]
            atol = 1e-13 * np.abs(alone).max()
            np.testing.assert_allclose(together[name][:, i], alone, rtol=0, atol=atol)


def test_both_forces_of_a_shaft_past_the_caches() -> None:
    # Within the caches the second force is a copy of the first, with the sign reversed.
    line = Driveline.from_points(POINTS[:3]).with_bearings(
        [(0, 0.05), (0, 0.2), (1, 0.05), (1, 0.2)]
    )
    load = Load(drive_torque=30.0)
    angle = np.linspace(-40.0, 90.0, 500_000)
    out = {name: np.empty_like(line.evaluate(angle, name, load=load)[name]) for name in NAMES}
    line.evaluate(angle, NAMES, load=load, out=out)
    assert sum(array.nbytes for array in out.values()) > 48_000_000
    part = slice(123_450, 124_450)
    few = line.evaluate(angle[part], NAMES, load=load)
    for name in NAMES:
        np.testing.assert_array_equal(out[name][:, part], few[name])
    assert np.any(few.bearing_force[0])


def test_threads_change_nothing() -> None:
    angle = np.linspace(0.0, 50.0, 300_000)
    one = LINE.evaluate(angle, NAMES, load=LOAD, workers=1)
    assert one == LINE.evaluate(angle, NAMES, load=LOAD, workers=2)


@pytest.mark.parametrize("angle", [ANGLE, Sweep.revolutions(3, 360)], ids=["array", "sweep"])
def test_reductions(angle: Any) -> None:  # noqa: ANN401
    samples = BATCH[:, None].evaluate(angle, NAMES, load=LOAD)
    reductions: dict[Reduction, Callable[[Doubles], Doubles]] = {
        "min": lambda x: x.min(axis=2),
        "max": lambda x: x.max(axis=2),
        "mean": lambda x: x.mean(axis=2),
        "rms": lambda x: np.sqrt((x**2).mean(axis=2)),
        "peak": lambda x: np.asarray(np.linalg.norm(x, axis=-1).max(axis=2)),
    }
    for how, of in reductions.items():
        got = BATCH[:, None].evaluate(angle, NAMES, load=LOAD, reduce=how)
        for name in NAMES:
            want = of(samples[name])
            np.testing.assert_allclose(got[name], want, atol=1e-12 * np.abs(samples[name]).max())


@pytest.mark.parametrize("tolerance", [0.0, 1e-9, 1e-6])
def test_tiers(tolerance: float) -> None:
    want = LINE.evaluate(ANGLE, NAMES, load=LOAD, tolerance=0)
    got = LINE.evaluate(ANGLE, NAMES, load=LOAD, tolerance=tolerance)
    single = LINE.evaluate(ANGLE, NAMES, load=LOAD, dtype=np.float32)
    for name in NAMES:
        size = np.abs(want[name]).max()
        assert np.abs(got[name] - want[name]).max() <= tolerance * size
        assert single[name].dtype == np.float32
        assert np.abs(single[name] - want[name]).max() <= 1e-6 * size


def test_arrays_to_fill() -> None:
    want = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    out = {"joint_force": np.empty((3, 600, 3)), "bearing_force": np.empty((5, 600, 3))}
    got = LINE.evaluate(ANGLE, NAMES, load=LOAD, out=out)
    assert got.bearing_force is out["bearing_force"]
    assert got == want
    planes = {"bearing_force": np.moveaxis(np.empty((5, 3, 600)), 1, -1)}
    LINE.evaluate(ANGLE, NAMES, load=LOAD, out=planes)
    np.testing.assert_array_equal(planes["bearing_force"], want.bearing_force)
    with pytest.raises(ValueError, match=r"must be \(5, 600, 3\)"):
        LINE.evaluate(ANGLE, NAMES, load=LOAD, out={"bearing_force": np.empty((4, 600, 3))})


def test_labels() -> None:
    pytest.importorskip("xarray")
    result = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    dataset = result.to_xarray()
    assert dataset.bearing_force.dims == ("bearing", "drive_angle", "component")
    assert dataset.bearing_force.attrs["units"] == "N"
    assert {"bearing_force_4_z", "joint_force_2_x"} <= set(result.to_pandas().columns)


def test_pieces() -> None:
    dask = pytest.importorskip("dask.array")
    angle = dask.from_array(ANGLE, chunks=250)
    got = LINE.evaluate(angle, NAMES, load=LOAD).compute()
    want = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    for name in NAMES:
        np.testing.assert_array_equal(got[name], want[name])
    whole = BATCH[:, None].evaluate(angle, NAMES, load=LOAD).compute()
    np.testing.assert_array_equal(
        whole.bearing_force, BATCH[:, None].evaluate(ANGLE, NAMES, load=LOAD).bearing_force
    )


def test_drivelines_that_are_computed_later() -> None:
    dask = pytest.importorskip("dask.array")
    points = POINTS * np.array([1.0, 1.1, 1.2])[:, None, None]
    lazy: Any = Driveline.from_points(dask.from_array(points[:, None], chunks=(2, -1, -1, -1)))
    got = lazy.with_bearings(BEARINGS).evaluate(ANGLE, NAMES, load=LOAD).compute()
    want = BATCH[:, None].evaluate(ANGLE, NAMES, load=LOAD)
    for name in NAMES:
        np.testing.assert_array_equal(got[name], want[name])
    with pytest.raises(ValueError, match="must have the same places on all drivelines"):
        lazy.with_bearings([(0, [0.1, 0.2, 0.1])])
    with pytest.raises(ValueError, match=r"is 1.3 on shaft 1 of length 1.2"):
        lazy.with_bearings([(1, 1.3)]).compute()


def test_the_plan_says_what_it_does() -> None:
    text = LINE.plan(NAMES, load=LOAD).explain()
    assert "joint 2: parts for the forces from the power" in text, text
    held = Driveline.from_points(POINTS[:3]).plan("joint_force", load=LOAD_OF_TWO).explain()
    assert "joint 0: force, zero because both its shafts have other supports" in held
    few = LINE.plan("joint_force", joints=2, load=Load(drive_torque=1.0)).explain()
    assert "joint 0" not in few.partition("skipped")[0]


LOAD_OF_TWO = Load(drive_torque=3.0)


def test_a_joint_without_force_gives_zero_and_nan_where_the_angle_is() -> None:
    line = Driveline.from_points(POINTS[:3])
    force = line.evaluate([0.3, np.nan, 1.0], "joint_force", load=LOAD_OF_TWO).joint_force[0]
    np.testing.assert_array_equal(force, [[0.0] * 3, [np.nan] * 3, [0.0] * 3])
    assert not np.signbit(force[[0, 2]]).any()


def test_drivelines_keep_their_bearings() -> None:
    want = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    for same in (
        LINE.with_phases(LINE.phases),
        LINE.reshape(1)[0],
        Driveline.concatenate([LINE, LINE])[1],
        LINE.with_bearings(LINE.bearings),
        pickle.loads(pickle.dumps(LINE)),
    ):
        assert same.evaluate(ANGLE, NAMES, load=LOAD) == want


def test_bearings_of_a_reversed_driveline() -> None:
    back = LINE.reversed()
    assert [shaft for shaft, _ in back.bearings] == [0, 3, 2, 3, 0]
    np.testing.assert_allclose(
        [position for _, position in back.bearings],
        [LINE._geometry.lengths[s] - p for s, p in BEARINGS],
    )


test_bad_bearings = refusals(
    {
        "lengths are missing; only drivelines from points": [[(1, 0.1)], None],
        "lengths has shape (2,); 3 shafts need": [[(1, 0.1)], [1.0, 1.0]],
        "lengths[1] is 0.0; a length must be pos": [[(1, 0.1)], [1.0, 0.0, 1.0]],
        "lengths[1] is inf": [[(1, 0.1)], [1.0, np.inf, 1.0]],
        "IndexError: bearings[0, 0] is 3; there are 3": [[(3, 0.1)], [1.0] * 3],
        "TypeError: bearings[0, 0] is 1.5; it must be an integer": [[(1.5, 0.1)], [1.0] * 3],
        "bearings[0, 1] is 1.5 on shaft 1 of length 1.0": [[(1, 1.5)], [1.0] * 3],
        "must lie between the joints of its shaft": [[(1, 0.0)], [1.0] * 3],
        "is 1.0 on shaft 0 of length 1.0; a bearing must lie between the end and the joint": [
            [(0, 1.0)],
            [1.0] * 3,
        ],
        "is 0.0 on shaft 2 of length 1.0; a bearing must lie between the end and the joint": [
            [(2, 0.0)],
            [1.0] * 3,
        ],
        "bearings[0, 1] is nan": [[(1, np.nan)], [1.0] * 3],
        "TypeError: bearings[0, 1] has dtype": [[(1, "a")], [1.0] * 3],
        "bearings[2] is in the place": [[(1, 0.1), (0, 0.2), (1, 0.1)], [1.0] * 3],
        "TypeError: bearings[0] is 1; it must be a pair": [[1, 2], [1.0] * 3],
        "TypeError: bearings[0] is (1, 2, 3); it must be a pair": [[(1, 2, 3)], [1.0] * 3],
        "TypeError: bearings is 3; it must be a list of pairs": [3, [1.0] * 3],
        "shapes do not broadcast: driveline": [[(1, [0.1, 0.2])], np.ones((3, 3))],
    },
    Driveline.from_bends([0.2, 0.3]).with_bearings,
)


def test_bearings_at_the_outer_ends_are_allowed() -> None:
    line = Driveline.from_bends([0.2]).with_bearings([(0, 0.0), (1, 1.0)], [0.5, 1.0])
    assert line.n_bearings == 2
    assert line.with_bearings([]).bearings == ()


def test_what_forces_need() -> None:
    bare, load = Driveline.from_bends([0.2, 0.3]), Load(drive_torque=1.0)
    with pytest.raises(ValueError, match=r'outputs\[0\] is "joint_force", which needs a load'):
        LINE.plan("joint_force")
    with pytest.raises(ValueError, match=r'outputs\[1\] is "joint_force", which needs the lengths'):
        bare.plan(("torque", "joint_force"), load=load)
    with pytest.raises(ValueError, match=r'"bearing_force"; the driveline has no bearings'):
        Driveline.from_points(POINTS).plan("bearing_force", load=load)
    assert isinstance(bare.with_bearings([], [1, 1, 1]).plan("joint_force", load=load), Plan)


@pytest.mark.parametrize(
    ("bearings", "output", "words"),
    [
        ([], "joint_force", "shafts 1 and 2 both float, and joint 1 cannot support both"),
        ([(0, 0.1), (2, 0.5)], "joint_force", "joint 0 cannot support both its shafts, 0 and 1$"),
        (
            [(1, 0.5), (2, 0.5), (2, 0.6)],
            "joint_force",
            "shaft 1 has three supports, bearing 0 and joints 0 and 1;",
        ),
        ([(3, 0.1), (3, 0.15), (2, 0.5), (3, 0.2)], "bearing_force", "shaft 3 has 3 bearings"),
    ],
)
def test_what_is_not_determinate(bearings: Any, output: str, words: str) -> None:  # noqa: ANN401
    line = Driveline.from_points(POINTS).with_bearings(bearings)
    with pytest.raises(ValueError, match=rf'outputs\[0\] is "{output}"; {words}'):
        line.plan(output, load=LOAD)


def test_joints_that_are_determinate_are_not_refused() -> None:
    """Shaft 1 has three supports; joint 2 supports shaft 3, whose bearings need no shaft 1."""
    line = Driveline.from_points(POINTS).with_bearings([(1, 0.5), (2, 0.5), (2, 0.6), (3, 0.1)])
    assert line.evaluate(ANGLE, "joint_force", load=LOAD, joints=2).joint_force.any()
    with pytest.raises(ValueError, match="shaft 1 has three supports"):
        line.evaluate(ANGLE, "joint_force", load=LOAD, joints=[1, 2])


def test_joined_drivelines_have_their_bearings_on_the_same_shafts() -> None:
    other = LINE.with_bearings(BEARINGS[:2])
    with pytest.raises(ValueError, match=r"lines\[1\] has bearings on shafts \(3, 0\) and lines"):
        Driveline.concatenate([LINE, other])
