"""Scenes with angles of the driven shaft, and with centred double joints."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner

import cardan
from cardan import Driveline, Load
from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands
from cardan.app.files.columns import write_columns
from cardan.app.plots import plot_scene
from cardan.app.report.results import inputs
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study.curves import columns

TEXT = """
[driveline]
bends_deg = [20, 35]
phases_deg = [40]
[load]
speed_rpm = 600
drive_torque_Nm = 10
{extra}
[output]
angle_of = "driven"
quantities = ["angle", "speed_ratio", "torque"]
"""


LINE = Driveline.from_bends([20, 35], phases=40, degrees=True)


LOAD = Load(drive_torque=10.0, speed=20.0 * np.pi)


NAMES = ("angle", "speed_ratio", "torque")


def test_the_sweep_is_of_the_driven_angle() -> None:
    table = columns(Scene.parse(TEXT.format(extra="")).run())
    driven = np.arange(721) / 2.0
    np.testing.assert_array_equal(table["driven_angle_deg"], driven)
    np.testing.assert_allclose(table["angle_deg"], driven, atol=1e-11)
    assert np.ptp(table["drive_angle_deg"] - driven) > 5.0
    want = LINE.evaluate(np.radians(table["drive_angle_deg"]), NAMES, load=LOAD)
    np.testing.assert_allclose(table["speed_ratio"], want.speed_ratio, rtol=1e-12)
    np.testing.assert_allclose(table["torque_Nm"], want.torque, rtol=1e-12)
    in_radians = columns(Scene.parse(TEXT.format(extra="")).run(), radians=True)
    np.testing.assert_allclose(in_radians["driven_angle_rad"], np.radians(driven), rtol=1e-15)


def test_a_study_reduces_over_the_driven_angle_of_each_driveline() -> None:
    text = TEXT.format(extra="[study]\nbends_deg.1 = [10, 35, 50]\n") + "reduce = ['mean']\n"
    study = Scene.parse(text).run().study
    assert study is not None
    turn = np.radians(np.arange(720) / 2.0)
    for bend, mean in zip((10, 35, 50), study.values["speed_ratio_mean"], strict=True):
        line = Driveline.from_bends([20, bend], phases=40, degrees=True)
        want = line.evaluate(turn, "speed_ratio", angle_of="driven").speed_ratio.mean()
        assert mean == pytest.approx(want, rel=1e-12)
        # Over equal steps of the drive angle it is 1.
        assert mean > 1.001


def test_recorded_angles_of_the_driven_shaft(tmp_path: Path) -> None:
    write_columns(tmp_path / "r.csv", {"a": np.array([0.0, 10.0, np.nan, 400.0])})
    text = TEXT.format(extra='[angles]\nfile = "r.csv"\nangle_column_deg = "a"\n')
    scene = Scene.parse(text, folder=tmp_path)
    assert scene.missing == 1
    table = columns(scene.run())
    np.testing.assert_array_equal(table["driven_angle_deg"], [0.0, 10.0, np.nan, 400.0])
    np.testing.assert_allclose(table["angle_deg"], [0.0, 10.0, np.nan, 400.0], atol=1e-12)
    table_of_drive = inputs(scene)["drive"]
    assert table_of_drive is not None
    assert ("Given as angles of the driven shaft", "0 to 400 deg") in table_of_drive.rows


def test_recorded_times_do_not_go_with_them(tmp_path: Path) -> None:
    write_columns(tmp_path / "r.csv", {"t": np.arange(5.0), "a": np.arange(5.0)})
    recorded = '[angles]\nfile = "r.csv"\nangle_column_deg = "a"\ntime_column_s = "t"\n'
    text = TEXT.format(extra=recorded).replace("speed_rpm = 600", "")
    with pytest.raises(SceneError, match=r"\[output\] angle_of is 'driven'; with time_column_s"):
        Scene.parse(text, folder=tmp_path)
    with pytest.raises(SceneError, match="angle_of is 'input'; known are drive, driven"):
        Scene.parse(TEXT.format(extra="").replace('"driven"', '"input"'))


def test_words_answers_and_pictures_name_the_driven_angle(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(TEXT.format(extra=""), encoding="utf-8")
    runner = CliRunner()
    said = " ".join(runner.invoke(commands(), ["run", str(path)]).stdout.split())
    assert "The scene gives angles of the driven shaft; the drive angles follow from them" in said
    answer = json.loads(runner.invoke(commands(), ["run", str(path), "--json"]).stdout)
    jsonschema.Draft202012Validator(answers_schema()).validate(answer)
    assert answer["drive_angles"]["angle_of"] == "driven"
    figure = plot_scene(Scene.load(path).run())
    assert {axes.get_xlabel() for axes in figure.axes} == {"", "driven angle [deg]"}
    assert any("driven angle 0° to 360°" in text.get_text() for text in figure.texts)


def test_drive_is_the_default() -> None:
    plain = TEXT.format(extra="").replace('angle_of = "driven"', "")
    said = TEXT.format(extra="").replace('"driven"', '"drive"')
    one, other = (columns(Scene.parse(text).run()) for text in (plain, said))
    assert list(one) == list(other)
    assert "driven_angle_deg" not in one
    np.testing.assert_array_equal(one["speed_ratio"], other["speed_ratio"])


DOUBLE_TEXT = """\
[driveline]
double_joint_deg = 30
joint_distance_mm = 60
synchronous_deg = 35
"""


PLACE = 30.0 / np.cos(np.radians(17.5))


def bends(total: float, pivot: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return cardan.Driveline.from_double_joint(total, 60.0, pivot, degrees=True).bends


def test_a_scene_is_the_driveline_of_the_library() -> None:
    line = Scene.parse(DOUBLE_TEXT).line
    own = cardan.Driveline.from_double_joint(30.0, 60.0, synchronous=35.0, degrees=True)
    assert line.shape == ()
    assert line.bends == pytest.approx(own.bends, rel=1e-14)
    worn = Scene.parse(f"{DOUBLE_TEXT}pivot_wear_mm = -0.3\n").line
    assert worn.bends == pytest.approx(bends(30.0, PLACE - 0.3), rel=1e-14)


def test_a_study_varies_bend_and_wear() -> None:
    text = f"{DOUBLE_TEXT}[study]\ndouble_joint_deg = [0, 20, 50]\npivot_wear_mm = [-0.2, 0.1]\n"
    study = Scene.parse(text).run().study
    assert study is not None
    (name,) = (column.name for column in study.columns if column.quantity == "equivalent_bend")
    grid = study.values[name]
    assert grid.shape == (3, 2)
    for i, total in enumerate((0.0, 20.0, 50.0)):
        for j, wear in enumerate((-0.2, 0.1)):
            own = cardan.Driveline.from_bends(bends(total, PLACE + wear)).equivalent()
            assert grid[i, j] == pytest.approx(own.bend, rel=1e-9)


def test_states_are_steering_angles() -> None:
    states = "[states]\ndouble_joint_deg = [5, 35]\nnames = ['ahead', 'turn']\n"
    lines = Scene.parse(f"{DOUBLE_TEXT}{states}").drivelines()
    assert lines.bends[1] == pytest.approx(np.radians([17.5, 17.5]))
    assert lines.bends[0] == pytest.approx(bends(5.0, PLACE))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("= 30", "= 185"), "double_joint_deg is 185 deg; a total bend must lie in [0, 180) deg"),
        (("= 30", "= [30, 31]"), "double_joint_deg is [30, 31]; it must be a list of one number"),
        (("= 60", "= 0"), "joint_distance_mm is 0; it must lie in [0.001, 1e+06]"),
        (("= 35", "= 120"), "synchronous_deg is 120 deg; it must lie in [0, 120) deg"),
        (("joint_distance_mm = 60\n", ""), "joint_distance_mm is missing"),
        (
            ("= 35\n", "= 35\npivot_wear_mm = 40\n"),
            "pivot_wear_mm puts the pivot beyond the joints",
        ),
        (("= 35\n", "= 35\nbends_deg = 3\n"), "bends_deg and double_joint_deg are both given"),
        (("= 35\n", "= 35\nphases_deg = 3\n"), "phases_deg does not go with double_joint_deg"),
        (("= 30", "= 170"), "double_joint_deg is 170.0 deg, which bends joint 0 by"),
    ],
)
def test_what_is_refused(change: tuple[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        Scene.parse(DOUBLE_TEXT.replace(*change))
    assert re.match(r"scene, line \d: \[driveline\]", str(caught.value)), caught.value


def test_a_single_joint_behind() -> None:
    text = """\
[driveline]
double_joint_deg = 40
joint_distance_mm = 70
synchronous_deg = 50
single_bend_deg = 12
single_twist_deg = 25
single_phase_deg = 90
"""
    line = Scene.parse(text).line
    double = cardan.Driveline.from_double_joint(40.0, 0.07, synchronous=50.0, degrees=True)
    expected = cardan.Driveline.from_bends(
        [*np.degrees(double.bends), 12.0], [0.0, 25.0], [0.0, 90.0], degrees=True
    )
    assert line.approx_equal(expected, 1e-14)
    varied = text + "[study]\nsingle_bend_deg = [0, 12]\ndouble_joint_deg = [20, 40, 60]\n"
    study = Scene.parse(varied).study
    assert study
    _, lines, _ = next(study.blocks())
    assert lines.shape == (6, 1)
    assert lines[4, 0].approx_equal(expected, 1e-14)
    assert np.all(lines.bends[:3, 0, 2] == 0.0)
    with pytest.raises(SceneError, match="single_twist_deg needs single_bend_deg"):
        Scene.parse(text.replace("single_bend_deg = 12\n", ""))


def test_the_wide_angle_scene_has_the_angles_of_its_turns() -> None:
    """A baler 60 mm higher and 1000 mm behind the pin turns with its shaft about the pin."""
    scene = cardan.Scene.parse(STARTERS["wide-angle"].text.replace("{name}", "a"))
    turns = np.radians([0.0, 20.0, 35.0, 50.0])
    states = scene.states
    assert states
    for state, turn in enumerate(turns):
        along = np.array([np.cos(turn), 0.0, np.sin(turn)])
        joint = 1000.0 * along + [0.0, 60.0, 0.0]
        drawn = cardan.Driveline.from_points([[-150, 0, 0], [0, 0, 0], joint, joint + 300 * along])
        line = states.driveline(state)
        total = np.degrees(line.bends[0] + line.bends[1])
        assert total == pytest.approx(np.degrees(drawn.bends[0]), abs=0.01)
        assert np.degrees(line.bends[2]) == pytest.approx(np.degrees(drawn.bends[1]), abs=0.01)
        twist = np.degrees(line.twists[-1] - drawn.twists[0])
        assert (twist + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.06)
        # The formulas of docs/howto/double-joint.md.
        rise = np.arctan(60.0 / 1000.0)
        assert np.cos(drawn.bends[0]) == pytest.approx(np.cos(rise) * np.cos(turn), rel=1e-14)
        if turn:
            own = 0.5 * np.pi + np.arctan(np.sin(rise) / np.tan(turn))
            assert drawn.twists[0] == pytest.approx(own, rel=1e-12)
