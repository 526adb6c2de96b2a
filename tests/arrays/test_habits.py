"""What users of NumPy and notebooks expect: lengths, comparisons, units, degrees, tables."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Driveline, Load, Result, Sweep
from refusals import refusals

ONE = Driveline.from_bends([20, 10], 30, 40, degrees=True)
BATCH = Driveline.from_bends(np.arange(12.0).reshape(6, 2), degrees=True)
TURN = np.linspace(0.0, 360.0, 25)
LOAD = Load(drive_torque=100.0)


# --- batches -----------------------------------------------------------------------------------


def test_a_batch_has_length_and_size() -> None:
    assert (len(BATCH), BATCH.ndim, BATCH.size) == (6, 1, 6)
    assert (ONE.ndim, ONE.size) == (0, 1)
    assert len(list(BATCH)) == 6
    with pytest.raises(TypeError, match="a single driveline has no length; n_joints is"):
        len(ONE)
    assert ONE
    assert BATCH
    assert not BATCH[:0]


def test_a_batch_is_reshaped() -> None:
    table = BATCH.reshape(2, 3)
    assert table.shape == BATCH.reshape((2, -1)).shape == (2, 3)
    assert np.array_equal(table.bends, BATCH.bends.reshape(2, 3, 2))
    assert np.array_equal(table.normals, BATCH.normals.reshape(2, 3, 2, 3))
    assert ONE.reshape(1, 1).shape == (1, 1)
    assert ONE.reshape(1).reshape(()).approx_equal(ONE)
    assert BATCH[:0].reshape(0, 5).shape == (0, 5)
    with pytest.raises(ValueError, match=r"shape is \(4, 2\), which has no room for just 6"):
        BATCH.reshape(4, 2)
    with pytest.raises(TypeError):
        BATCH.reshape(2.0, 3)  # type: ignore[arg-type]


def test_drivelines_are_concatenated() -> None:
    both = Driveline.concatenate([ONE, BATCH, BATCH[1]])
    assert both.shape == (8,)
    assert both[0].approx_equal(ONE)
    assert both[-1].approx_equal(BATCH[1])
    want = [line.evaluate(0.3).angle for line in both]
    assert np.array_equal(both.evaluate(0.3).angle, want)
    table = BATCH.reshape(2, 3)
    assert Driveline.concatenate([table, table[:, :1]], axis=-1).shape == (2, 4)


test_drivelines_that_do_not_go_together = refusals(
    {
        "lines is empty; there must be at least one driveline": [[], 0],
        "TypeError: lines[1] is 3; it must be a driveline": [[ONE, 3], 0],
        "lines[1] has 1 joints and lines": [[ONE, Driveline.from_bends([0.1])], 0],
        "axis is 1; the batches have 1 axes": [[ONE, BATCH], 1],
        "lines[1] has shape (6,) and lines": [[BATCH.reshape(2, 3), BATCH], 0],
        "may differ along axis 0 only": [[BATCH.reshape(2, 3), BATCH.reshape(3, 2)], 0],
    },
    Driveline.concatenate,
)


def test_approximately_equal() -> None:
    nearly = Driveline.from_bends([20 + 1e-9, 10], 390, -140, degrees=True)
    assert ONE.approx_equal(nearly)
    assert not ONE.approx_equal(nearly, 1e-12)
    assert not ONE.approx_equal(ONE.with_phases(41, degrees=True))
    assert not ONE.approx_equal(ONE.reshape(1))
    assert not ONE.approx_equal(Driveline.from_bends([0.1]))
    # The same angles on shafts that point elsewhere.
    turned = Driveline.from_directions(-ONE.directions, ONE.phases)
    assert turned.bends == pytest.approx(ONE.bends, abs=1e-12)
    assert not ONE.approx_equal(turned)
    with pytest.raises(TypeError, match="other is 3; it must be a driveline"):
        ONE.approx_equal(3)  # type: ignore[arg-type]


# --- results -----------------------------------------------------------------------------------


def test_results_are_compared_as_a_whole() -> None:
    angles = np.array([0.0, 1.0, np.nan])
    one, again = ONE.evaluate(angles), ONE.evaluate(angles)
    assert one == again
    assert one == pickle.loads(pickle.dumps(one))
    assert one != ONE.evaluate(angles, "angle")
    assert one != ONE.evaluate(angles + 1e-12)
    assert one != ONE.evaluate(angles, degrees=True)
    assert one != 3


def test_a_sample_is_no_output() -> None:
    with pytest.raises(KeyError, match=r"0 is no output; the result holds angle, speed_ratio; "):
        ONE.evaluate(TURN)[0]  # type: ignore[index]
    with pytest.raises(KeyError, match=r"result\.angle\[slice\(None, 3, None\)\]"):
        ONE.evaluate(TURN)[:3]  # type: ignore[index]
    with pytest.raises(KeyError, match="'torque' is no output; the result holds angle, speed_rati"):
        ONE.evaluate(TURN)["torque"]
    assert "torque" not in ONE.evaluate(TURN)
    assert ONE.evaluate(TURN).get("torque") is None


def test_a_result_knows_its_angles_and_units() -> None:
    result = ONE.evaluate(TURN, ("angle", "torque", "speed_ratio"), load=LOAD)
    assert result.drive_angle is TURN
    assert dict(result.units) == {
        "angle": "rad",
        "torque": "N m",
        "speed_ratio": "1",
        "drive_angle": "rad",
    }
    sweep = Sweep(0.0, 1.0, 5)
    assert np.array_equal(ONE.evaluate(sweep).drive_angle, np.asarray(sweep))
    with pytest.raises(ValueError, match="the result has no drive angles"):
        _ = Result({"angle": TURN}).drive_angle


def test_tables_of_notebooks() -> None:
    html = ONE._repr_html_()
    assert "<td>0</td><td>20</td><td>30</td><td>40</td>" in html
    assert "<td>1</td><td>10</td><td></td><td></td>" in html
    assert "&lt;Driveline of 2 joints" in html
    assert "<td>0 to 10</td>" in BATCH._repr_html_()
    assert BATCH[:0]._repr_html_()
    html = ONE.evaluate(TURN, "torque", load=LOAD)._repr_html_()
    assert "<td>torque</td><td>N m</td><td>(25,)</td>" in html
    assert "<td>no numbers</td>" in ONE.evaluate(np.nan)._repr_html_()
    html = ONE.check(100.0)._repr_html_()
    assert "<caption>The driveline is beyond the limits.</caption>" in html
    assert "<td>equivalent bend</td>" in html


# --- degrees -----------------------------------------------------------------------------------


def test_angles_of_drivelines_in_degrees() -> None:
    assert ONE.bends_deg == pytest.approx([20, 10])
    assert ONE.twists_deg == pytest.approx([30])
    assert ONE.phases_deg == pytest.approx([40])
    best = ONE.optimal_phases(degrees=True)
    assert np.radians(best) == pytest.approx(ONE.optimal_phases())
    assert ONE.with_phases(best, degrees=True).equivalent().k == pytest.approx(
        ONE.with_phases(ONE.optimal_phases()).equivalent().k
    )


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_evaluation_in_degrees(dtype: type) -> None:
    names = tuple(cardan.OUTPUTS)
    line = ONE.with_bearings([(0, 0.1), (0, 0.2)], lengths=[0.3, 1.0, 0.4])
    want = line.evaluate(np.radians(TURN), names, load=LOAD, dtype=dtype)
    got = line.evaluate(TURN, names, load=LOAD, degrees=True, dtype=dtype)
    for name in names:
        angle = name in {"angle", "angle_error", "tilt_driving", "tilt_driven"}
        assert got.units[name] == ("deg" if angle else want.units[name])
        assert got[name].dtype == dtype
        assert np.array_equal(got[name], np.degrees(want[name]) if angle else want[name]), name
    assert got.drive_angle is TURN
    assert ONE.evaluate(90.0, "angle", degrees=True).angle == pytest.approx(
        np.degrees(ONE.evaluate(np.pi / 2, "angle").angle)
    )
    frame = got.compute()
    assert frame.units["drive_angle"] == "deg"


def test_degrees_into_arrays() -> None:
    want = ONE.evaluate(TURN, "angle", degrees=True).angle
    both = TURN.copy()
    got = ONE.evaluate(both, "angle", out={"angle": both}, degrees=True)
    assert got.angle is both
    assert np.array_equal(both, want)
    assert np.array_equal(got.drive_angle, TURN)


def test_sweeps_in_degrees() -> None:
    sweep = Sweep(0, 360, 25, degrees=True)
    assert repr(sweep) == "Sweep(0.0, 360.0, 25, degrees=True)"
    assert sweep == pickle.loads(pickle.dumps(sweep)) != Sweep(0, 360, 25)
    assert np.asarray(sweep) == pytest.approx(np.radians(TURN))
    got = ONE.evaluate(sweep, "angle", degrees=True)
    assert got.angle == pytest.approx(ONE.evaluate(TURN, "angle", degrees=True).angle)
    assert np.array_equal(got.drive_angle, TURN)
    turns = ONE.evaluate(Sweep.revolutions(1, 24), "angle", degrees=True)
    assert np.array_equal(turns.drive_angle, TURN[:-1])
    with pytest.raises(ValueError, match=r"angle is Sweep\(0.0, 360.0, 25\) in rad; for degrees"):
        ONE.evaluate(Sweep(0, 360, 25), degrees=True)


# --- what is wrong -----------------------------------------------------------------------------


def test_a_number_is_no_load() -> None:
    with pytest.raises(TypeError, match=r"load is 100\.0; it must be a cardan\.Load"):
        ONE.evaluate(TURN, "torque", load=100.0)  # type: ignore[arg-type]


def test_completion_shows_public_names() -> None:
    modules = {"files", "jax", "scene", "scipy", "torch"}
    assert set(dir(cardan)) - set(vars(cardan)["__all__"]) == modules


# --- several reductions ------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [False, True])
def test_several_reductions_are_stacked(degrees: bool) -> None:
    line = BATCH[:, np.newaxis]
    names = ("speed_ratio", "moment")
    options: dict[str, Any] = {"load": LOAD, "shafts": [1, 2], "degrees": degrees}
    both = line.evaluate(TURN, names, reduce=["min", "rms"], **options)
    assert both.speed_ratio.shape == (2, 2, 6)
    assert both.moment.shape == (2, 2, 6, 3)
    for i, how in enumerate(("min", "rms")):
        alone = line.evaluate(TURN, names, reduce=how, **options)  # type: ignore[arg-type]
        for name in names:
            assert np.array_equal(both[name][:, i], alone[name])
    low, high = ONE.evaluate(TURN, "speed_ratio", reduce=("min", "max")).speed_ratio
    assert low < 1.0 < high


def test_several_reductions_have_labels() -> None:
    found = BATCH[:, np.newaxis].evaluate(TURN, "moment", reduce=["min", "max"], load=LOAD)
    labelled = found.to_xarray().moment
    assert labelled.dims == ("joint", "reduction", "driveline", "component")
    assert [*labelled.reduction.values] == ["min", "max"]
    frame = found.to_pandas()
    assert frame.index.names == ["reduction", "driveline"]
    assert frame.loc[("max", 3), "moment_1_y"] == found.moment[1, 1, 3, 1]
    assert found.to_arrow()["reduction"].to_pylist() == ["min"] * 6 + ["max"] * 6


@pytest.mark.parametrize(
    ("reduce", "message"),
    [
        ([], "reduce is empty; name at least one reduction"),
        (["min", "least"], "reduce is 'least'; known are min"),
        (["min", "peak"], r"reduce is \['min', 'peak'\]; the peak of moment is the length"),
    ],
)
def test_reductions_that_do_not_go_together(reduce: list[Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ONE.evaluate(TURN, ("moment",), load=LOAD, reduce=reduce)
    with pytest.raises(TypeError, match="out does not go with several reductions"):
        ONE.evaluate(TURN, "angle", reduce=["min"], out={"angle": np.empty(1)})


# --- closed forms and pictures -----------------------------------------------------------------


def test_closed_forms_in_degrees() -> None:
    joint = BATCH.equivalent()
    assert np.array_equal(joint.bend_deg, np.degrees(joint.bend))
    assert np.array_equal(joint.angle_offset_deg, np.degrees(joint.angle_offset))
    assert np.array_equal(joint.max_angle_error_deg, np.degrees(joint.max_angle_error))
    assert np.array_equal(
        joint.max_angle_error_at_deg, np.degrees(joint.max_angle_error_at), equal_nan=True
    )
    series = BATCH.harmonics()
    assert [*series.orders] == [2, 4, 6, 8]
    assert np.array_equal(series.angle_error_deg, np.degrees(series.angle_error))


def test_a_result_is_plotted() -> None:
    result = ONE.evaluate(Sweep.revolutions(1, 360), ("angle_error", "moment"), load=LOAD, joints=1)
    figure = result.plot()
    error, moment = figure.axes
    assert error.get_ylabel() == "angle error\n[deg]"
    assert moment.get_xlabel() == "drive angle [deg]"
    (curve,) = error.get_lines()
    assert np.allclose(curve.get_ydata(), np.degrees(result.angle_error), atol=1e-12)
    assert np.allclose(curve.get_xdata(), np.arange(360.0))
    assert [line.get_label() for line in moment.get_lines()] == [f"joint 1, {i}" for i in "xyz"]
    assert np.array_equal(moment.get_lines()[1].get_ydata(), result.moment[:, 1])
    # Each curve of a batch is that of its own driveline.
    batch = BATCH[:3, np.newaxis].evaluate(TURN, "angle_error", shafts=[1, 2], degrees=True)
    curves = {line.get_label(): line.get_ydata() for line in batch.plot().axes[0].get_lines()}
    assert np.array_equal(curves["shaft 2, driveline 1"], batch.angle_error[1, 1])
    with pytest.raises(ValueError, match="has 12 curves of angle_error; a picture shows at most 6"):
        BATCH[:, np.newaxis].evaluate(TURN, "angle_error", shafts=[1, 2]).plot()
    for other in (ONE.evaluate(TURN, reduce="max"), ONE.evaluate(0.5), ONE.evaluate([TURN])):
        with pytest.raises(ValueError, match="result is not over a row of drive angles"):
            other.plot()


@pytest.mark.parametrize("mask", [[True, False], np.array([True, False]), True, np.False_])
def test_masks_are_no_indices(mask: Any) -> None:  # noqa: ANN401
    for name in ("shafts", "joints"):
        with pytest.raises(TypeError, match=rf"{name}.* is (True|False), which is no index; for"):
            ONE.evaluate(TURN, ("speed_ratio", "tilt_driven"), **{name: mask})
    got = ONE.evaluate(TURN, "tilt_driven", joints=np.flatnonzero([True, False]).tolist())
    assert got.tilt_driven.shape == (1, *TURN.shape)


def test_integers_beyond_the_largest_double() -> None:
    for angle in (10**400, [0, -(10**400)]):
        with pytest.raises(
            TypeError, match=r"angle has an integer of magnitude above 1\.798e\+308"
        ):
            ONE.evaluate(angle)
    with pytest.raises(TypeError, match="tolerance is an integer above the largest double"):
        ONE.evaluate(1.0, tolerance=10**400)


def test_bearings_in_an_array_are_refused() -> None:
    line = Driveline.from_points([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.1, 0.0]])
    with pytest.raises(
        TypeError, match=r"bearings is an array of shape \(2, 2\); it must be a list"
    ):
        line.with_bearings(np.array([[0, 0.2], [0, 0.5]]))
