"""Scenes that give angles of the driven shaft."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner

from cardan import Driveline, Load
from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands
from cardan.app.files.columns import write_columns
from cardan.app.plots import plot_scene
from cardan.app.report.results import inputs
from cardan.app.scene import Scene, SceneError
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
