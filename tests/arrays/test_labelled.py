"""Labels in and out: Datasets of xarray, frames of pandas, tables of Arrow."""

from __future__ import annotations

import pickle
import sys
from typing import Any

import numpy as np
import pytest

xarray = pytest.importorskip("xarray")
pytest.importorskip("pandas")
pytest.importorskip("pyarrow")

from cardan import OUTPUTS, Driveline, Load, Result, Sweep  # noqa: E402
from cardan.app.scene import Scene  # noqa: E402

ANGLE = np.linspace(-3.0, 9.0, 8)
LINE = Driveline.from_bends([0.5, 0.4], 0.1, 0.3).with_bearings(
    [(2, 0.1), (0, 0.1), (0, 0.2), (2, 0.3)], lengths=[0.3, 1.0, 0.4]
)
BATCH = Driveline.from_bends(np.linspace(0.1, 0.6, 6).reshape(3, 2))
LOAD = Load(drive_torque=2.0, speed=3.0, inertias=[0.0, 0.1, 0.2])


def test_a_dataset_of_everything() -> None:
    result = LINE.evaluate(ANGLE, OUTPUTS, load=LOAD, shafts=[0, 2], joints=[1, 0])
    dataset = result.to_xarray()
    assert set(dataset.data_vars) == set(OUTPUTS)
    assert dataset.shaft.values.tolist() == [0, 2]
    assert dataset.joint.values.tolist() == [1, 0]
    assert dataset.bearing.values.tolist() == [0, 1, 2, 3]
    assert dataset.component.values.tolist() == ["x", "y", "z"]
    assert np.array_equal(dataset.drive_angle, ANGLE)
    assert dataset.drive_angle.attrs["units"] == "rad"
    for name, output in OUTPUTS.items():
        variable = dataset[name]
        vector = ("component",) if output.vector else ()
        assert variable.dims == (output.per, "drive_angle", *vector)
        assert np.shares_memory(variable.values, result[name])
        assert variable.attrs == {
            "units": output.unit,
            "long_name": name.replace("_", " "),
            "comment": output.meaning,
        }
    one = dataset.moment.sel(joint=0, component="y", drive_angle=ANGLE[3])
    assert float(one) == result.moment[1, 3, 1]


@pytest.mark.parametrize(
    ("line", "angle", "options", "dims", "coordinates"),
    [
        (LINE, 0.3, {}, (), {"drive_angle": ()}),
        (LINE, ANGLE, {}, ("drive_angle",), {"drive_angle": ("drive_angle",)}),
        (LINE, Sweep(0, 1, 5), {}, ("drive_angle",), {"drive_angle": ("drive_angle",)}),
        (
            LINE,
            ANGLE.reshape(2, 4),
            {},
            ("sample_0", "sample_1"),
            {"drive_angle": ("sample_0", "sample_1")},
        ),
        (
            BATCH[:, None],
            ANGLE,
            {},
            ("driveline", "drive_angle"),
            {"drive_angle": ("drive_angle",)},
        ),
        (BATCH, ANGLE[:3], {}, ("sample",), {"drive_angle": ("sample",)}),
        (BATCH, 0.3, {}, ("driveline",), {"drive_angle": ()}),
        (BATCH, [0.3], {}, ("driveline",), {"drive_angle": ()}),
        (
            BATCH[:, None],
            ANGLE.reshape(2, 1, 4),
            {},
            ("sample_0", "driveline", "sample_1"),
            {"drive_angle": ("sample_0", "sample_1")},
        ),
        (BATCH[:, None], ANGLE, {"reduce": "max"}, ("driveline",), {}),
        (BATCH[None], ANGLE[:, None], {"reduce": "max"}, ("drive_angle",), {"drive_angle": None}),
        (LINE, ANGLE, {"reduce": "peak"}, (), {}),
    ],
)
def test_dimensions(
    line: Driveline,
    angle: Any,  # noqa: ANN401
    options: Any,  # noqa: ANN401
    dims: tuple[str, ...],
    coordinates: Any,  # noqa: ANN401
) -> None:
    arguments = {"load": LOAD, **options}
    dataset = line.evaluate(angle, ("angle", "moment"), **arguments).to_xarray()
    assert dataset.angle.dims == dims
    assert dataset.shaft.ndim == 0
    vector = () if options.get("reduce") == "peak" else ("component",)
    assert dataset.moment.dims == ("joint", *dims, *vector)
    assert set(dataset.coords) - {"shaft", "joint", "component"} == set(coordinates)
    for name, along in coordinates.items():
        assert along is None or dataset[name].dims == along
    methods = dataset.angle.attrs.get("cell_methods")
    if options:
        over = "driveline" if dims == ("drive_angle",) else "drive_angle"
        method = {"max": "maximum", "peak": "maximum_absolute_value"}[options["reduce"]]
        assert methods == f"{over}: {method}"
    else:
        assert methods is None
    spread = np.broadcast_to(angle, np.broadcast_shapes(line.shape, np.shape(angle)))
    if "drive_angle" in dataset.coords and not options:
        shown = dataset.drive_angle.broadcast_like(dataset.angle).transpose(*dims)
        assert np.array_equal(shown, spread)


def test_labels_of_angles_are_kept() -> None:
    angle = xarray.DataArray(
        ANGLE.reshape(2, 4),
        dims=("run", "time"),
        coords={
            "time": ("time", [0.0, 0.1, 0.2, 0.3], {"units": "s"}),
            "run": ["cold", "warm"],
            "speed": ("run", [100.0, 200.0]),
            "gearbox": "A",
        },
        attrs={"units": "rad"},
        name="turn",
    )
    dataset: Any = LINE.evaluate(angle, ("angle", "moment"), load=LOAD)
    assert isinstance(dataset, xarray.Dataset)
    assert dataset.angle.dims == ("run", "time")
    assert dataset.moment.dims == ("joint", "run", "time", "component")
    for name, coordinate in angle.coords.items():
        assert dataset.coords[name].variable.identical(coordinate.variable)
    assert dataset.drive_angle.dims == ("run", "time")
    assert np.array_equal(dataset.drive_angle, angle)
    assert np.array_equal(dataset.moment, LINE.evaluate(angle.values, "moment", load=LOAD).moment)
    assert np.array_equal(LINE.plan("angle")(angle).angle, dataset.angle)

    reduced: Any = LINE.evaluate(angle, "angle", reduce="rms")
    assert reduced.angle.dims == ("run",)
    assert set(reduced.coords) == {"run", "speed", "gearbox", "shaft"}
    cell_methods = reduced.angle.attrs["cell_methods"]
    assert cell_methods == "time: root_mean_square"

    batch: Any = BATCH[:, None, None].evaluate(angle, "angle")
    assert batch.angle.dims == ("driveline", "run", "time")
    single: Any = BATCH.evaluate(angle[:, :1], "angle")
    # The one time stands for three drivelines now.
    assert single.angle.dims == ("run", "driveline")
    assert "time" not in single.coords


def test_angles_along_themselves() -> None:
    angle = xarray.DataArray(ANGLE, dims="drive_angle", coords={"drive_angle": ANGLE})
    dataset: Any = LINE.evaluate(angle)
    assert dataset.angle.dims == ("drive_angle",)
    assert dataset.drive_angle.variable.identical(angle.drive_angle.variable)


@pytest.mark.parametrize(
    ("angle", "options", "error", "message"),
    [
        (
            xarray.DataArray(ANGLE, attrs={"units": "degrees"}),
            {},
            ValueError,
            "angle has units 'degrees'; make it rad and say so in attrs['units']",
        ),
        (
            xarray.DataArray(ANGLE, dims="angle"),
            {},
            ValueError,
            "angle has a dimension or coordinate 'angle', as the result; rename it",
        ),
        (
            xarray.DataArray(ANGLE, dims="t", coords={"shaft": 3}),
            {},
            ValueError,
            "angle has a dimension or coordinate 'shaft', as the result",
        ),
        (
            xarray.DataArray(ANGLE[:2, None], dims=("driveline", "b")),
            {"line": BATCH},
            ValueError,
            "angle has a dimension or coordinate 'driveline', as the result",
        ),
        (xarray.DataArray(ANGLE), {"out": {}}, TypeError, "out does not go with an angle that is"),
        (xarray.DataArray(["a"]), {}, TypeError, "angle has dtype <U1"),
        (xarray.Dataset({"a": 1.0}), {}, TypeError, "cannot directly convert an xarray.Dataset"),
    ],
)
def test_labels_that_do_not_go(
    angle: Any,  # noqa: ANN401
    options: dict[str, Any],
    error: type[Exception],
    message: str,
) -> None:
    line = options.pop("line", LINE)
    with pytest.raises(error) as caught:
        line.evaluate(angle, **options)
    assert str(caught.value).startswith(message)


def test_geometry_and_loads_may_be_labelled() -> None:
    bends = xarray.DataArray([[0.5, 0.4]], dims=("rig", "joint"))
    assert np.array_equal(Driveline.from_bends(bends).bends, [[0.5, 0.4]])
    assert Load(speed=xarray.DataArray(3.0)).speed == 3.0


def test_a_frame() -> None:
    result = LINE.evaluate(ANGLE, ("speed_ratio", "torque", "moment"), load=LOAD, joints=[1])
    frame = result.to_pandas()
    assert frame.index.name == "drive_angle"
    assert np.array_equal(frame.index, ANGLE)
    columns = ["speed_ratio", "torque", "moment_1_x", "moment_1_y", "moment_1_z"]
    assert list(frame.columns) == columns
    assert np.array_equal(frame["moment_1_y"], result.moment[0, :, 1])
    assert frame.attrs["units"]["moment_1_y"] == "N m"
    assert frame.attrs["units"]["drive_angle"] == "rad"


def test_a_frame_of_a_batch() -> None:
    result = BATCH[:, None].evaluate(ANGLE, "angle", shafts=[1, 2])
    frame = result.to_pandas()
    assert frame.index.names == ["driveline", "drive_angle"]
    assert frame.loc[(2, ANGLE[5]), "angle_1"] == result.angle[0, 2, 5]
    peaks = BATCH[:, None].evaluate(ANGLE, "moment", load=LOAD, reduce="peak")
    assert list(peaks.to_pandas().columns) == ["moment_0", "moment_1"]
    assert peaks.to_pandas().index.names == ["driveline"]
    # One row without anything that tells it apart.
    assert LINE.evaluate(ANGLE, reduce="max").to_pandas().shape == (1, 2)


def test_a_table() -> None:
    result = BATCH[:, None].evaluate(ANGLE, ("angle", "moment"), load=LOAD, dtype=np.float32)
    table = result.to_arrow()
    assert table.schema.names[:4] == ["driveline", "drive_angle", "angle", "moment_0_x"]
    assert str(table.schema.field("angle").type) == "float"
    assert table.schema.field("moment_0_x").metadata[b"units"] == b"N m"
    assert np.array_equal(table["moment_1_z"], result.moment[1, ..., 2].reshape(-1))
    assert np.array_equal(table["drive_angle"], np.tile(ANGLE, 3))
    assert np.array_equal(table["driveline"], np.repeat([0, 1, 2], 8))


def test_angles_that_gave_way_to_results_are_still_shown() -> None:
    for view in (slice(None), slice(None, None, 2)):
        angle = ANGLE.copy()[view]
        result = LINE.evaluate(angle, "angle", out={"angle": angle})
        assert np.array_equal(result.to_xarray().drive_angle, ANGLE[view])
        assert np.array_equal(result.angle, angle)


def test_labels_outlive_a_pickle() -> None:
    result = BATCH[:, None].evaluate(ANGLE, ("angle", "moment"), load=LOAD, joints=1)
    again: Result = pickle.loads(pickle.dumps(result))
    assert again.to_xarray().identical(result.to_xarray())


def test_the_curves_of_a_scene_have_labels() -> None:
    scene = Scene.parse("[driveline]\nbends_deg = [8]\n[sweep]\nsamples_per_turn = 4")
    dataset = scene.run().values.to_xarray()
    assert np.array_equal(dataset.drive_angle, scene.drive_angle)


def test_a_study_is_a_grid_with_labels() -> None:
    text = "[driveline]\nbends_deg = [8, 9]\n[study]\nbends_deg.1 = [0, 5, 8]\nphases_deg = [0, 90]"
    study = Scene.parse(text).run().study
    assert study
    dataset = study.to_xarray()
    assert dataset.equivalent_bend.dims == ("bends_deg.1", "phases_deg")
    assert dataset.equivalent_bend.attrs == {"units": "rad"}
    place = {"bends_deg.1": 8.0, "phases_deg": 90.0}
    want = Driveline.from_bends([8, 8], phases=90, degrees=True).equivalent().bend
    assert float(dataset.equivalent_bend.sel(place)) == want


def test_a_result_put_together_has_none() -> None:
    with pytest.raises(ValueError, match="the result has no labels; only one that was evaluated"):
        Result({"angle": ANGLE}).to_xarray()


@pytest.mark.parametrize(
    ("method", "module", "extra"),
    [
        ("to_xarray", "xarray", "xarray"),
        ("to_pandas", "pandas", "xarray"),
        ("to_arrow", "pyarrow", "table"),
    ],
)
def test_without_the_library(
    method: str, module: str, extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = LINE.evaluate(ANGLE)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"this needs {module}: pip install 'cardan\[{extra}\]'"):
        getattr(result, method)()


def test_a_series_keeps_its_index() -> None:
    pandas = pytest.importorskip("pandas")
    index = pandas.Index(np.arange(len(ANGLE)) / 8.0, name="time")
    series = pandas.Series(ANGLE, index)
    names = ("speed_ratio", "moment")
    want = LINE.evaluate(ANGLE, names, load=LOAD)
    got: Any = LINE.evaluate(series, names, load=LOAD)
    assert got.index.equals(index)
    assert got.index.name == "time"
    assert np.array_equal(got.speed_ratio, want.speed_ratio)
    assert np.array_equal(got.moment_1_z, want.moment[1, :, 2])
    assert got.attrs["units"]["moment_1_z"] == "N m"
    with pytest.raises(TypeError, match="out does not go with an angle that is a Series"):
        LINE.evaluate(series, "angle", out={"angle": np.empty(len(ANGLE))})


def test_a_series_beside_a_batch() -> None:
    pandas = pytest.importorskip("pandas")
    series = pandas.Series([0.0, 1.0, 2.0], ["a", "b", "c"])
    lines = Driveline.from_bends([[0.1], [0.5]])
    got: Any = lines[:, None].evaluate(series, "speed_ratio")
    assert got.index.tolist() == [(i, name) for i in range(2) for name in "abc"]
    assert np.array_equal(got.loc[(1, "b")], [lines[1].evaluate(1.0, "speed_ratio").speed_ratio])
    largest: Any = lines[:, None].evaluate(series, "speed_ratio", reduce="max")
    assert largest.index.tolist() == [0, 1]
    assert len(Driveline.from_bends([0.3]).evaluate(series, "speed_ratio", reduce="max")) == 1
    paired: Any = Driveline.from_bends([[0.1], [0.5], [0.9]]).evaluate(series, "speed_ratio")
    assert paired.index.tolist() == ["a", "b", "c"]


def test_labels_in_degrees() -> None:
    pandas = pytest.importorskip("pandas")
    turn = np.linspace(0.0, 360.0, 7)
    want = LINE.evaluate(turn, "angle", degrees=True)
    of_series: Any = LINE.evaluate(pandas.Series(turn), "angle", degrees=True)
    assert np.array_equal(of_series.angle, want.angle)
    assert of_series.attrs["units"] == {"angle": "deg"}
    assert want.to_pandas().attrs["units"] == {"angle": "deg", "drive_angle": "deg"}
    assert np.array_equal(want.to_pandas().index, turn)
    angle = xarray.DataArray(turn, dims="time", attrs={"units": "degree"})
    made: Any = LINE.evaluate(angle, "angle", degrees=True)
    assert np.array_equal(made.angle, want.angle)
    assert made.angle.units == made.drive_angle.units == "degree"
    with pytest.raises(ValueError, match=r"make it rad .* or evaluate with degrees=True"):
        LINE.evaluate(angle)
    with pytest.raises(ValueError, match="has units 'rad'; make it deg and say so"):
        LINE.evaluate(angle.assign_attrs(units="rad"), degrees=True)


def test_drive_angles_that_follow_from_driven_ones_are_told_apart_by_driveline() -> None:
    result = BATCH[:, None].evaluate(ANGLE, "speed_ratio", angle_of="driven")
    frame = result.to_pandas()
    assert frame.index.names == ["driveline", "drive_angle"]
    for i in range(3):
        own = BATCH[i].evaluate(ANGLE, "speed_ratio", angle_of="driven")
        np.testing.assert_array_equal(frame.loc[i].index, own.drive_angle)
        np.testing.assert_array_equal(frame.loc[i].speed_ratio, own.speed_ratio)
    labelled = result.to_xarray()
    assert labelled.speed_ratio.dims == ("driveline", "sample")
    assert labelled.drive_angle.dims == ("driveline", "sample")
    # Angles that are paired with the batch stay samples.
    paired = BATCH.evaluate(ANGLE[:3], "speed_ratio", angle_of="driven").to_xarray()
    assert paired.speed_ratio.dims == ("sample",)
