"""Studies: every row is what its driveline gives by itself; what is refused, and in which words."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load
from cardan.app.answers.data import data_of
from cardan.app.answers.study import End, extremes, study_figures, study_text
from cardan.app.answers.turn.figures import drive_angles
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.study import study
from cardan.app.scene.study.study import Axis, Column, StudyResult
from refusals import cases

TWO = "[driveline]\nbends_deg = [10, 20]\nphases_deg = [30]\n"


SWEEP = "[sweep]\nsamples_per_turn = 24\n"


TURN = np.radians(np.arange(24) * 15.0)


def run(text: str) -> StudyResult:
    result = Scene.parse(text).run().study
    assert result is not None
    return result


def test_grid_of_bends_phases_and_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each row against a driveline of its own, and the same in blocks of any size."""
    text = (
        TWO
        + "[load]\nspeed_rpm = 7\ninertias_kgm2 = [0, 0.1, 0.3]\n"
        + SWEEP
        + "[study]\nbends_deg.1 = {from = 0, to = 30, steps = 4}\nphases_deg = [0, 45, 90]\n"
        + "speed_rpm = [1000, 2000]\n"
        + '[output]\nquantities = ["angle_error", "torque", "moment", "bending_driven"]\n'
        + 'shafts = [1, 2]\nreduce = ["peak", "min", "max", "mean", "rms"]\n'
    )
    result = run(text)
    assert result.shape == (4, 3, 2)
    assert [axis.key for axis in result.axes] == ["bends_deg.1", "phases_deg", "speed_rpm"]
    assert result.axes[0].values.tolist() == [0, 10, 20, 30]
    for place in itertools.product(*map(range, result.shape)):
        bend, phase, rpm = (axis.values[i] for axis, i in zip(result.axes, place, strict=True))
        line = Driveline.from_bends([10, bend], phases=[phase], degrees=True)
        load = Load(speed=rpm * math.tau / 60, inertias=[0, 0.1, 0.3])
        want: dict[str, Any] = {}
        for shaft in (1, 2):
            whole = line.equivalent(shaft)
            want[f"equivalent_bend_{shaft}"] = whole.bend
            want[f"non_uniformity_{shaft}"] = whole.non_uniformity
            want[f"max_angle_error_{shaft}"] = whole.max_angle_error
        curves = line.evaluate(
            TURN, ("angle_error", "torque", "moment", "bending_driven"), shafts=[1, 2], load=load
        )
        scalars = {
            f"{name}_{item}": curves[name][i]
            for name, items in (
                ("angle_error", (1, 2)),
                ("torque", (1, 2)),
                ("bending_driven", (0, 1)),
            )
            for i, item in enumerate(items)
        }
        for joint in (0, 1):
            moment = curves.moment[joint]
            want[f"moment_{joint}_peak"] = np.max(np.linalg.norm(moment, axis=-1))
            scalars |= {f"moment_{joint}_{axis}": moment[:, i] for i, axis in enumerate("xyz")}
        for name, curve in scalars.items():
            if not name.startswith("moment"):
                want[f"{name}_peak"] = np.max(np.abs(curve))
            want[f"{name}_min"], want[f"{name}_max"] = np.min(curve), np.max(curve)
            want[f"{name}_mean"] = np.mean(curve)
            want[f"{name}_rms"] = math.sqrt(np.mean(curve**2))
        assert set(want) == set(result.values)
        for name, value in want.items():
            scale = 1e-12 * (1 + abs(value))
            assert result.values[name][place] == pytest.approx(value, rel=1e-12, abs=scale), name

    monkeypatch.setattr(study, "_BLOCK", 24 * 7 * 20)
    blocks: list[tuple[int, int]] = []
    again = Scene.parse(text).run(lambda done, rows: blocks.append((done, rows))).study
    assert again is not None
    assert len(blocks) > 1
    assert blocks[-1] == (24, 24)
    for name, values in result.values.items():
        np.testing.assert_allclose(again.values[name], values, rtol=1e-13, atol=1e-13)


POINTS = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]


def moved(entries: slice, axis: int, value: float) -> Driveline:
    points = np.array(POINTS, dtype=float)
    points[entries, axis] = value
    return Driveline.from_points(points)


@pytest.mark.parametrize(
    ("driveline", "key", "make"),
    [
        (TWO, "bends_deg", lambda v: ([v, v], [0], [30])),
        (TWO, "bends_deg.0", lambda v: ([v, 20], [0], [30])),
        (TWO, "bends_deg.0-1", lambda v: ([v, v], [0], [30])),
        (TWO, "twists_deg", lambda v: ([10, 20], [v], [30])),
        (TWO, "phases_deg.0", lambda v: ([10, 20], [0], [v])),
        (
            f"[driveline]\npoints_mm = {POINTS}\n",
            "points_mm.2.y",
            lambda v: moved(slice(2, 3), 1, v),
        ),
        (
            f"[driveline]\npoints_mm = {POINTS}\n",
            "points_mm.3-4.z",
            lambda v: moved(slice(3, 5), 2, v),
        ),
        (
            "[driveline]\ndirections = [[1, 0, 0], [1, 0.1, 0], [1, 0, 0.2]]\n",
            "directions.1.z",
            lambda v: Driveline.from_directions([[1, 0, 0], [1, 0.1, v], [1, 0, 0.2]]),
        ),
        (
            "[driveline]\nslopes_vertical_deg = [0, 5, 1]\nslopes_horizontal_deg = [1, 2, 9]\n",
            "slopes_horizontal_deg.1",
            lambda v: Driveline.from_slopes([0, 5, 1], [1, v, 9], degrees=True),
        ),
        (
            "[driveline]\nprojected_bends_vertical_deg = [15, -11.5]\n"
            "projected_bends_horizontal_deg = [7, 12]\nphases_deg = [-70]\n",
            "projected_bends_vertical_deg.0",
            lambda v: Driveline.from_projected_bends([v, -11.5], [7, 12], -70, degrees=True),
        ),
    ],
)
def test_every_key_of_a_driveline(driveline: str, key: str, make: Any) -> None:  # noqa: ANN401
    values = [0.0, 3.0, 11.0]
    result = run(f"{driveline}[study]\n{key} = {values}\n[output]\nclosed_forms = ['k']")
    for value, found in zip(values, result.values["k"], strict=True):
        line = make(value)
        if isinstance(line, tuple):
            bends, twists, phases = line
            line = Driveline.from_bends(bends, twists, phases, degrees=True)
        assert found == pytest.approx(line.equivalent().k, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "key", "values", "make"),
    [
        ("drive_torque_Nm = 5", "drive_torque_Nm", [1, -2], lambda v: Load(drive_torque=v)),
        ("speed_rpm = 5", "output_torque_Nm", [1, -2], lambda v: Load(output_torque=v)),
        (
            "inertias_kgm2 = [0, 1]",
            "speed_rad_s",
            [1, -2],
            lambda v: Load(speed=v, inertias=[0, 1]),
        ),
        (
            "inertias_kgm2 = [0, 1]\nspeed_rad_s = 10",
            "inertias_kgm2.1",
            [1, 2],
            lambda v: Load(speed=10, inertias=[0, v]),
        ),
        (
            "inertias_kgm2 = [0, 1]",
            "acceleration_rad_s2",
            [1, -2],
            lambda v: Load(acceleration=v, inertias=[0, 1]),
        ),
    ],
)
def test_every_key_of_a_load(load: str, key: str, values: list[float], make: Any) -> None:  # noqa: ANN401
    text = f"[driveline]\nbends_deg = [25]\n[load]\n{load}\n{SWEEP}[study]\n{key} = {values}\n"
    result = run(f"{text}[output]\nquantities = ['torque']")
    line = Driveline.from_bends([25], degrees=True)
    for value, found in zip(values, result.values["torque_peak"], strict=True):
        torque = line.evaluate(TURN, "torque", load=make(value)).torque
        assert found == pytest.approx(np.max(np.abs(torque)), rel=1e-12)


def test_what_is_reduced_by_default() -> None:
    closed = ["equivalent_bend", "non_uniformity", "max_angle_error"]
    axis = "[study]\nbends_deg = [1]\n"
    assert list(run(TWO + axis).values) == closed
    loaded = run(TWO + axis + "[load]\noutput_torque_Nm = 1\n")
    assert list(loaded.values) == [*closed, "torque_peak", "moment_0_peak", "moment_1_peak"]
    asked = run(TWO + axis + '[output]\nquantities = ["speed_ratio"]\nclosed_forms = ["k"]')
    assert list(asked.values) == ["k", "speed_ratio_peak"]
    reduced = run(TWO + '[output]\nreduce = "rms"\njoints = [1]\nquantities = ["tilt_driven"]')
    assert list(reduced.values) == [*closed, "tilt_driven_1_rms"]
    assert (reduced.shape, reduced.rows) == ((), 1)
    assert Scene.parse(TWO).run().study is None


def test_means_count_no_angle_twice() -> None:
    """The mean of an angle error over whole turns is exactly zero, over other sweeps it is not."""
    text = (
        '[driveline]\nbends_deg = [40]\n[output]\nquantities = ["speed_ratio"]\nreduce = "mean"\n'
    )
    mean = run(f"{text}[sweep]\nsamples_per_turn = 60\nturns = 2").values["speed_ratio_mean"]
    assert mean == pytest.approx(1.0, abs=1e-14)
    part = run(f"{text}[sweep]\nsamples_per_turn = 60\nturns = 0.25").values["speed_ratio_mean"]
    line = Driveline.from_bends([40], degrees=True)
    want = np.mean(line.evaluate(np.radians(np.arange(16) * 6.0), "speed_ratio").speed_ratio)
    assert part == pytest.approx(want, rel=1e-12)


def test_recorded_bends_are_reduced_over_their_samples(tmp_path: Path) -> None:
    angle, bend = np.linspace(0, 9, 40), np.linspace(1, 30, 40)
    np.savez(tmp_path / "a.npz", angle=angle, front=bend, rear=bend + 1)
    text = (
        '[angles]\nfile = "a.npz"\nangle_column_rad = "angle"\nbend_columns_deg = ["front", "rear"]'
        '\n[output]\nquantities = ["angle_error"]\nreduce = ["peak", "mean"]'
    )
    result = Scene.parse(text, folder=tmp_path).run()
    line = Driveline.from_bends(np.stack([bend, bend + 1], -1), degrees=True)
    want = line.evaluate(angle, "angle_error").angle_error
    np.testing.assert_array_equal(result.values.angle_error, want)
    assert result.study is not None
    assert set(result.study.values) == {"angle_error_peak", "angle_error_mean"}
    assert result.study.values["angle_error_peak"] == np.max(np.abs(want))
    assert result.study.values["angle_error_mean"] == pytest.approx(np.mean(want), rel=1e-12)


def test_extremes_leave_out_what_is_not_a_number() -> None:
    axis = Axis("bends_deg", "driveline", "bends_deg", slice(None), None, np.array([1.0, 2, 3, 4]))
    values = {
        "some": np.array([np.nan, 5.0, 0.5, 7.0]),
        "none": np.full(4, np.nan),
        "endless": np.array([1.0, np.inf, 2.0, 3.0]),
        "same": np.full(4, 2.0),
        "alike": np.array([2.0, 2.0 - 1e-15, 2.0 + 1e-15, 2.0]),
        "apart": np.array([2.0, 2.0 - 1e-8, 2.0 + 1e-8, 2.0]),
    }
    columns = tuple(Column(name, "1", "k", "shaft", 1, "value") for name in values)
    result = StudyResult((axis,), columns, values)
    figures = {each.column: each for each in extremes(result)}
    assert figures["some"].least == End("", 0.5, {"bends_deg": 3.0})
    assert figures["some"].largest == End("", 7.0, {"bends_deg": 4.0})
    assert math.isnan(figures["none"].least.value)
    assert figures["endless"].least == End("", 1.0, {"bends_deg": 1.0})
    assert figures["endless"].largest == End("", math.inf, {"bends_deg": 2.0})
    assert figures["alike"].least.at == {}
    found = study_figures(result, 1)
    entries = {entry["column"]: entry for entry in data_of(found)["figures"]}
    assert entries["none"]["least"] == {"value": None, "at": []}
    assert entries["endless"]["largest"]["value"] is None
    assert study_text(found, drive_angles(Scene.parse(TWO))).split("\n\n")[1].splitlines() == [
        "some",
        "  least    0.50 at bends_deg = 3",
        "  largest  7.00 at bends_deg = 4",
        "none     not finite",
        "endless  not finite",
        "same     2",
        "alike    2",
        "apart",
        "  least    2 at bends_deg = 2",
        "  largest  2 at bends_deg = 3",
    ]


def test_the_best_driveline_is_named_by_what_it_depends_on() -> None:
    """Two joints that cancel do so at any speed, however their roundings differ."""
    scene = Scene.parse(
        "[driveline]\nbends_deg = [14, 9]\n[load]\nspeed_rpm = 1\ndrive_torque_Nm = 10\n"
        "[study]\nbends_deg.0-1 = {from = 5, to = 15, steps = 3}\nspeed_rpm = [1, 2]\n"
        "phases_deg = {from = -20, to = 0, steps = 3}\n"
        "[output]\nquantities = ['torque', 'speed_ratio']\nreduce = ['peak', 'mean']\n"
    )
    result = scene.run().study
    assert result
    text = study_text(study_figures(result, 1), drive_angles(scene))
    assert text.split("\n\n")[2].splitlines() == [
        "Best driveline",
        "  by equivalent_bend_deg, non_uniformity, max_angle_error_deg, torque_peak_Nm:",
        "    phases_deg = 0",
    ]


STUDY = TWO + "[load]\nspeed_rpm = 100\n[study]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    cases("""
bends_deg.0 = {from = 0, to = 30, steps = 1000000000}
    line 7: [study] bends_deg.0 makes the study 1000000000 rows; it takes at most 10000000: give
    fewer steps or vary fewer keys
bends_deg = {from = 0, to = 1, steps = 900}
phases_deg = {from = 0, to = 1, steps = 1000}
speed_rpm = {from = 0, to = 1, steps = 100}
    line 8: [study] phases_deg makes the study 900 x 1000 x 100 = 90000000 rows; it takes at most
    10000000: give fewer steps or vary fewer keys
[study]
    line 4: [study] is empty; give at least one key
"bends_deg.1" = [1, 2]
    line 7: [study] unknown key 'bends_deg.1'; write it without quotes
bends_deg = 3
    line 7: [study] bends_deg is 3; it must be {from = …, to = …, steps = …} or a list of numbers
bends_deg = {from = 0, to = 3}
    line 7: [study] bends_deg has no 'steps'; it must be {from = …, to = …, steps = …}
bends_deg = {from = 0, to = 3, step = 4}
    line 7: [study] bends_deg has an unknown key 'step'; did you mean 'steps'?
bends_deg.1 = {from = 0, to = 3, steps = 1}
    line 7: [study] bends_deg.1.steps is 1; from 0 to 3 takes at least 2
bends_deg.1 = {from = 0, to = '3', steps = 4}
    line 7: [study] bends_deg.1.to is '3'; it must be a number
speed_rpm = {from = -1e308, to = 1e308, steps = 4}
    line 7: [study] speed_rpm.from is -1e+308; it must lie within ±1e+40
phases_deg = []
    line 7: [study] phases_deg is []; a study needs at least one
bends_deg.2 = [1]
    line 7: [study] bends_deg.2 does not exist; there are 2, counted from 0
bends_deg.1-0 = [1]
    line 7: [study] bends_deg.1-0 does not exist; there are 2, counted from 0
bends_deg.x = [1]
    line 7: [study] bends_deg.x does not exist; write 0 for the first entry
bends_deg.1 = [1]
bends_deg.0-1 = [2]
    line 8: [study] bends_deg.0-1 varies bends_deg[1], which varies already
bends_deg.1 = [30, 95]
    line 6: [study] at bends_deg.1 = 95: bends_deg[1] is 95.0 deg; a bend must lie in
bends_deg = {from = -5, to = 9, steps = 15}
phases_deg = [7, 8]
    line 6: [study] at bends_deg = -5, phases_deg = 7: bends_deg[0] is -5.0 deg; a
phases_deg = [7, 8]
bends_deg.0 = [5, -1, 9]
    line 6: [study] at phases_deg = 7, bends_deg.0 = -1: bends_deg[0] is -1.0 deg; a bend
points_mm.1.y = [1]
    line 7: [study] points_mm is not in [driveline]; a study can vary bends_deg, phases_deg,
    twists_deg
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
[study]
points_mm = [1]
    line 4: [study] points_mm is [1]; name place and axis, as in points_mm.2.y
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
[study]
points_mm.1 = [1]
    line 4: [study] points_mm is a section; name place and axis, as in points_mm.2.y
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
[study]
points_mm.1.up = [1]
    line 4: [study] points_mm.1 has no 'up'; known are x, y, z
[driveline]
bends_deg = [8]
[study]
phases_deg = [1]
    line 4: [study] phases_deg has no entries; one joint has no shaft between two joints
speed_rad_s = [1]
    line 7: [study] speed_rad_s does not go with speed_rpm of [load]; vary that
[load]
[study]
speed_rpm = [1]
speed_rad_s = [1]
    line 6: [study] speed_rpm and speed_rad_s are both given; give one of them
[study]
speed_rpm = [1]
    line 5: [study] speed_rpm needs a section [load]
inertias_kgm2 = [1]
    line 7: [study] inertias_kgm2 is not in [load]; a study can vary speed_rpm
bend_deg = [1]
    line 7: [study] unknown key 'bend_deg'; did you mean 'bends_deg'?
bends_rad = [1]
    line 7: [study] unknown key 'bends_rad'; the name includes the unit: bends_deg holds degrees
[output]
table = 'a.csv'
    line 5: [output] table needs a section [study] or [states], reduce or closed_forms
[output]
reduce = 'rms'
curves = 'a.csv'
table = 'a.csv'
    line 7: [output] table is 'a.csv'; that is the file of the curves
[output]
reduce = ['peek']
    line 5: [output] reduce[0] is 'peek'; did you mean 'peak'?
[output]
closed_forms = ['equivalent_bend_deg']
    line 5: [output] closed_forms[0] is 'equivalent_bend_deg'; did you mean 'equivalent_bend'?
[output]
shafts = [1, 3]
    line 5: [output] shafts[1] is 3; there are 3, counted from 0
[output]
joints = [-1]
    line 5: [output] joints[0] is -1; it must be a whole number, counted from 0
[study]
bends_deg.0 = [1, 'a']
    line 5: [study] bends_deg.0[1] is 'a'; it must be a number
[driveline]
points_m = [[0, 0, 0], [1, 0, 0], [2, 0.1, 0]]
[study]
points_m.1.y = []
    line 4: [study] points_m.1.y is []; a study needs at least one value
[output]
joints = []
    line 5: [output] joints is []; name at least one
[output]
workers = 0
    line 5: [output] workers is 0; it must be a whole number
"""),
)
def test_messages(text: str, message: str) -> None:
    """Of a whole scene, of a section below two joints, or of keys of their study."""
    whole = "" if text.startswith("[driveline]") else TWO if text.startswith("[") else STUDY
    with pytest.raises(ValueError, match=r"^scene, line ") as caught:
        Scene.parse(whole + text)
    assert str(caught.value).startswith(f"scene, {message}")


def test_the_end_of_any_axis_is_tried_before_the_run() -> None:
    points = "[driveline]\npoints_m = [[0, 0, 0], [0, 1, 0], [0, 2, 0.1], [0, 3, 0]]\n[study]\n"
    for wrong in range(3):
        axes = ["points_m.0.x", "points_m.1.x", "points_m.2.x"]
        values = [[0.0, 0.1, 0.2] for _ in axes]
        values[wrong][wrong] = 9.0
        text = "".join(f"{axis} = {given}\n" for axis, given in zip(axes, values, strict=True))
        with pytest.raises(ValueError, match="points_m give joint ") as caught:
            Scene.parse(points + text)
        assert f"{axes[wrong]} = 9" in str(caught.value)


def test_a_point_inside_the_grid_that_makes_no_driveline(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ends of both axes are fine, a corner is not: only the run comes there."""
    scene = Scene.parse(
        "[driveline]\npoints_m = [[0, 0, 0], [0, 1, 0], [0, 5, 0]]\n"
        "[study]\npoints_m.1.x = [0, 1, 1.9]\npoints_m.1.y = [2, 0.8, 4.1]\n"
    )
    for block in (1, 4, 1000):
        monkeypatch.setattr(study, "_BLOCK", block)
        with pytest.raises(ValueError, match="study") as caught:
            scene.run()
        assert str(caught.value).startswith(
            "scene: [study] at points_m.1.x = 1.9, points_m.1.y = 0.8: points_m give joint 0"
        )


TEXT = """
[driveline]
bends_deg = [10, 12]
twists_deg = [180]
lengths_mm = [300, 1200, 300]
[[bearing]]
shaft = 0
position_mm = 100
[[bearing]]
shaft = 0
position_mm = 250
[[bearing]]
shaft = 2
position_m = 0.05
[[bearing]]
shaft = 2
position_mm = 200
[load]
drive_torque_Nm = 100
[study]
{study}
[output]
quantities = ["joint_force", "bearing_force"]
"""


LINE = Driveline.from_bends([10, 12], 180, degrees=True)


LOAD = Load(drive_torque=100.0)


BEARING_TURN = np.linspace(0.0, 2.0 * np.pi, 721)


def peaks(places: list[float], lengths: list[float]) -> tuple[np.ndarray, np.ndarray]:
    bearings = list(zip((0, 0, 2, 2), places, strict=True))
    line = LINE.with_bearings(bearings, lengths)
    found = line.evaluate(BEARING_TURN, ("joint_force", "bearing_force"), load=LOAD, reduce="peak")
    return found.joint_force, found.bearing_force


def test_positions_and_lengths_make_a_grid() -> None:
    text = TEXT.format(
        study="bearing.1.position_mm = [150, 200, 280]\nlengths_mm.1 = [800, 1600]\n"
        "bearing.2.position_m = [0.02, 0.05]"
    )
    study = Scene.parse(text).run().study
    assert study is not None
    # TOML keeps the keys of bearings together.
    keys = ["bearing.1.position_mm", "bearing.2.position_m", "lengths_mm.1"]
    assert [axis.key for axis in study.axes] == keys
    for i, place in enumerate((0.15, 0.2, 0.28)):
        for j, length in enumerate((0.8, 1.6)):
            for k, other in enumerate((0.02, 0.05)):
                joints, bearings = peaks([0.1, place, other, 0.2], [0.3, length, 0.3])
                for item, want in enumerate(joints):
                    found = study.values[f"joint_force_{item}_peak"][i, k, j]
                    assert found == pytest.approx(want, rel=1e-12)
                for item, want in enumerate(bearings):
                    found = study.values[f"bearing_force_{item}_peak"][i, k, j]
                    assert found == pytest.approx(want, rel=1e-12)
    # Each of the keys matters.
    assert len(set(study.values["bearing_force_1_peak"][:, 0, 0])) == 3
    assert len(set(study.values["joint_force_0_peak"][0, 0])) == 2
    assert len(set(study.values["bearing_force_2_peak"][0, :, 0])) == 2


def test_bends_and_positions_together() -> None:
    text = TEXT.format(study="bends_deg.0 = [5, 10]\nbearing.0.position_mm = [60, 100]")
    study = Scene.parse(text).run().study
    assert study is not None
    _, want = peaks([0.06, 0.25, 0.05, 0.2], [0.3, 1.2, 0.3])
    assert study.values["bearing_force_0_peak"][1, 0] == pytest.approx(want[0], rel=1e-12)


@pytest.mark.parametrize(
    ("study", "message"),
    [
        (
            "bearing.1.position_mm = [400, 500]",
            "position_mm is 400 mm on shaft 0 of length 300 mm; a bearing must lie between",
        ),
        ("bearing.1.position_mm = [50, 100]", "position_mm is 100 mm on shaft 0, the place of"),
        ("bearing.1.position_m = [0.2]", "does not go with position_mm of that bearing; vary"),
        ("bearing.9.position_mm = [2]", "does not exist; there are 4 bearings, counted from 0"),
        ("bearing.x.position_mm = [2]", "bearing.x does not exist; write 0 for the first bearing"),
        ("bearing.0.shaft = [2]", "bearing.0 has no 'shaft'; known are position_mm, position_m"),
        ("bearing = [2]", "bearing is .2.; name number and key, as in bearing.0.position_mm"),
        ("lengths_mm.1 = [-1, 1]", "lengths.1. is -0.001; a length must be positive and finite"),
        ("lengths_m = [1, 2]", "lengths_m is not in .driveline.; a study can vary"),
    ],
)
def test_studies_that_cannot_be(study: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Scene.parse(TEXT.format(study=study))
