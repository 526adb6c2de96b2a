"""Play of joints in scenes: sentences, answers, and the numbers that the backlash loop shows."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import pyplot
from matplotlib.axes import Axes
from numpy.typing import NDArray

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.backlash import Backlash, backlash, drawn_backlash
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.plots import plot_backlash, plot_lash, plot_part, save
from cardan.app.scene import Scene, SceneError
from example_scenes import ANSWERS, SCENES, example

PATH = example("worn_joints.toml")
TEXT = PATH.read_text(encoding="utf-8")
BEND, PLAY, STIFF, TORQUE = np.radians(30.0), 0.05 / 40.0, 1e5, 400.0
SINGLE = TEXT.replace("[30, 12]", "[30]").replace("phases_deg = [0]\n", "")


def command(*arguments: object) -> str:
    done = CliRunner().invoke(commands(), [str(argument) for argument in arguments])
    assert done.exit_code in (0, 1), done.output
    return done.output


def curves(axes: Axes) -> list[NDArray[np.float64]]:
    """The curves with a label, ``(2, points)`` each."""
    lines = [line for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
    return [np.array([line.get_xdata(), line.get_ydata()], dtype=float) for line in lines]


def figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["backlash"]
    assert found is not None
    return found


def single() -> Backlash:
    return drawn_backlash(Scene.parse(SINGLE))


def test_the_loop_of_one_joint_is_the_closed_form() -> None:
    # 2 asin(sin(d)/rho): largest, by 1/cos(bend), where the driving pin is in the bend plane.
    axes = plot_backlash(single())
    wound = TORQUE / (STIFF * np.cos(BEND))
    for (angle, torque), rho in zip(curves(axes), (np.cos(BEND), 1.0), strict=True):
        half = np.arcsin(np.sin(2.0 * PLAY) / rho)
        want = np.degrees([-half - wound, -half, half, half + wound])
        np.testing.assert_allclose(angle, want, rtol=1e-9)
        np.testing.assert_allclose(torque, [TORQUE, 0.0, 0.0, -TORQUE])
    labels = [line.get_label() for line in axes.get_lines()][2:]
    assert [str(label).split(":")[0] for label in labels] == ["at 0°", "at 90.0°"]
    assert axes.get_ylabel() == "torque at the drive [N m]"
    assert axes.get_xlabel() == "angle of the last shaft, drive held [deg]"
    pyplot.close("all")


def test_the_lash_over_the_turn_is_the_closed_form() -> None:
    loose, wound = curves(plot_lash(single()))
    turn = np.radians(loose[0])
    rho = np.hypot(np.sin(turn), np.cos(BEND) * np.cos(turn))
    lash = 2.0 * np.arcsin(np.sin(2.0 * PLAY) / rho)
    np.testing.assert_allclose(loose[1], np.degrees(lash), rtol=1e-9)
    both = lash + 2.0 * TORQUE / (STIFF * np.cos(BEND))
    np.testing.assert_allclose(wound[1], np.degrees(both), rtol=1e-9)
    axes = pyplot.gca()
    assert axes.get_xlim() == pytest.approx((0.0, 360.0))
    assert axes.get_ylim()[0] == 0.0
    pyplot.close("all")


def test_lash_and_wind_up_are_the_closed_forms() -> None:
    """The lash where the driving pin is in the bend plane and across it; the same wind-up."""
    lash = 2.0 * np.arcsin(np.sin(2.0 * PLAY) / np.array([1.0, np.cos(BEND)]))
    found = figures(SINGLE)
    assert [found.least_lash, found.lash.value] == pytest.approx(lash.tolist(), rel=1e-9)
    wound = TORQUE / (STIFF * np.cos(BEND))
    assert [found.least_wind_up, found.wind_up.value] == pytest.approx([wound, wound], rel=1e-9)
    assert (found.torque, found.end) == (TORQUE, "drive")
    free = figures(SINGLE.replace("[load]\ndrive_torque_Nm = 400\n", ""))
    assert (free.lash.value, free.wind_up) == (found.lash.value, None)


def test_loops_that_hardly_differ_are_one() -> None:
    line = cardan.Driveline.from_bends([0.01])
    rigid = backlash(line, 0.05, 40.0, cardan.Load(output_torque=-9.0))
    (loop,) = curves(plot_backlash(rigid))
    assert loop[0][0] == loop[0][1]
    assert loop[1].tolist() == [9.0, 0.0, 0.0, -9.0]
    (loose,) = curves(plot_lash(rigid))
    assert np.degrees(4.0 * 0.05 / 40.0) == pytest.approx(loose[1][0], rel=1e-3)
    pyplot.close("all")


def test_scenes_are_those_of_the_library(tmp_path: Path) -> None:
    scene = Scene.parse(TEXT)
    found = drawn_backlash(scene)
    turn = np.asarray(cardan.Sweep.revolutions(721 / 720, 720))
    np.testing.assert_allclose(found.lash, scene.line.lash(turn, 0.05, 40.0), rtol=1e-12)
    load = cardan.Load(drive_torque=TORQUE)
    np.testing.assert_allclose(found.wind_up, scene.line.wind_up(turn, load, STIFF), rtol=1e-12)
    low, high = np.degrees([found.lash.min(), found.lash.max()])
    text = PARTS["backlash"].text(Answer(scene)["backlash"])
    for name, options in (("run", ("--into", tmp_path)), ("check", ())):
        assert text in command(name, PATH, *options)
    assert f"largest lash     {high:.2f}°" in text
    data = json.loads(command("check", PATH, "--json"))
    ANSWERS.validate(data)
    assert data["backlash"]["least_lash_deg"] == pytest.approx(low, rel=1e-12)
    assert data["backlash"]["lash"]["value_deg"] == pytest.approx(high, rel=1e-12)
    wound = np.degrees(found.wind_up.max())
    assert data["backlash"]["wind_up"]["value_deg"] == pytest.approx(wound, rel=1e-12)
    assert scene.sizes is None
    SCENES.validate(tomllib.loads(TEXT))


def test_a_run_in_radians_tells_the_lash_in_radians(tmp_path: Path) -> None:
    text = PARTS["backlash"].text(figures(TEXT), radians=True)
    assert text in command("run", PATH, "--into", tmp_path, "--radians")


def test_states_have_the_largest_lash() -> None:
    states = Scene.parse(TEXT + '[states]\n"bends_deg.0" = [5, 35]\nnames = ["a", "b"]\n')
    found = drawn_backlash(states)
    alone = drawn_backlash(Scene.parse(TEXT.replace("[30, 12]", "[35, 12]")))
    np.testing.assert_allclose(found.lash, alone.lash, rtol=1e-12)
    lash = Answer(states)["backlash"].lash
    flat = figures(TEXT.replace("[30, 12]", "[5, 12]")).lash.value
    assert lash.state == "b"
    assert lash.each == pytest.approx({"a": flat, "b": alone.lash.max()})


def test_lash_is_judged_in_every_state_and_driveline_of_a_study() -> None:
    largest = float(np.degrees(figures(TEXT.replace("[30, 12]", "[35, 12]")).lash.value))
    for factor, verdict in ((1.0, "within"), (0.999, "beyond")):
        limits = f"[limits]\nequivalent_bend_deg = 89\nlash_deg = {factor * largest!r}\n"
        for kind in ("states", "study"):
            answer = Answer(Scene.parse(f"{TEXT}{limits}[{kind}]\nbends_deg.0 = [5, 35, 20]\n"))
            assert answer["backlash"].lash.value == pytest.approx(np.radians(largest))
            assert answer["backlash"].lash.verdict == verdict
            assert answer.verdict == verdict
    study = Scene.parse(f"{TEXT}[study]\nbends_deg.0 = [5, 35, 20]\ndrive_torque_Nm = [100, 900]\n")
    found = Answer(study)["backlash"]
    assert found.lash.at == {"bends_deg.0": 35.0}
    assert found.wind_up.at == {"bends_deg.0": 35.0, "drive_torque_Nm": 900.0}
    between = Answer(Scene.parse(f"{TEXT}[limits]\nlash_deg = [0.1, 5]\n"))["backlash"]
    assert between.lash.verdict == "tolerable"


def test_a_lash_that_cannot_be_judged_says_why() -> None:
    text = "[driveline]\nbends_deg = [5, 5]\n[limits]\nlash_deg = 1\n"
    lash = figures(text).lash
    assert (lash.verdict, lash.why) == ("not judged", "[joints] gives no play_mm")


def test_play_is_that_of_joints_as_built() -> None:
    scene = Scene.parse(TEXT.replace("play_mm", "driving_yoke_deg = [5, 0]\nplay_mm"))
    found = drawn_backlash(scene)
    turn = np.asarray(cardan.Sweep.revolutions(721 / 720, 720))
    line = scene.line.with_deviations([5.0, 0.0], degrees=True)
    np.testing.assert_allclose(found.lash, line.lash(turn, 0.05, 40.0), rtol=1e-12)
    assert np.max(np.abs(found.lash - scene.line.lash(turn, 0.05, 40.0))) > 1e-4


def test_the_command_draws(tmp_path: Path) -> None:
    path = tmp_path / "loop.svg"
    assert command("plot", PATH, "--what", "backlash", "--output", path) == f"wrote {path}\n"
    again = tmp_path / "again.svg"
    save(plot_part(Scene.load(PATH), "backlash"), again)
    assert path.read_bytes() == again.read_bytes()
    bare = example("foeppl.toml")
    none = CliRunner().invoke(commands(), ["plot", str(bare), "--what", "backlash"])
    assert none.exit_code == 2
    assert "backlash needs play_mm and arm_mm in [joints]" in none.stderr
    ball = example("ball_joint.toml")
    alone = CliRunner().invoke(commands(), ["plot", str(ball), "--what", "backlash"])
    assert "a ball joint alone has no picture 'backlash'" in alone.stderr


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("arm_mm = 40", "", "play_mm needs arm_mm"),
        ("play_mm = 0.05", "play_mm = [0.05]", "play_mm has length 1; it needs 2, one per joint"),
        ("play_mm = 0.05", "play_mm = -1", "play_mm is -1; it must not be negative"),
        ("play_mm = 0.05", "", "stiffness_Nm_per_rad"),
        ("= 1e5", "= [1e5]", "stiffness_Nm_per_rad has length 1; it needs 2, one per joint"),
    ],
)
def test_wrong_play_is_refused(old: str, new: str, said: str) -> None:
    with pytest.raises(SceneError, match=re.escape(said)):
        Scene.parse(TEXT.replace(old, new))


def test_what_has_no_loop_is_refused() -> None:
    line = cardan.Driveline.from_bends([[0.1], [0.2]])
    with pytest.raises(ValueError, match="backlash is that of one driveline"):
        backlash(line, 0.05, 40.0, cardan.Load(drive_torque=1.0))
    with pytest.raises(ValueError, match="one torque that is not 0"):
        backlash(line[0], 0.05, 40.0, cardan.Load(speed=1.0))
