"""What a check says of the speed of the drive."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.drive_speed import SHARE, DriveSpeed
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.plots import plot_drive_speed
from cardan.app.scene import Scene
from example_scenes import ANSWERS, Answers, example

ROOT = Path(__file__).parents[2]


def scene(inertias: str, bends: str = "[8.5]", speed: str = "speed_rpm = 3000") -> Scene:
    load = f"[load]\n{speed}\ninertias_kgm2 = {inertias}\n" if inertias else ""
    return Scene.parse(f"[driveline]\nbends_deg = {bends}\n{load}")


def drive_speed(of: Scene) -> DriveSpeed | None:
    found = Answer(of)["drive_speed"]
    assert found is None or isinstance(found, DriveSpeed)
    return found


def said(found: Scene) -> str:
    return " ".join(PARTS["drive_speed"].sentences(drive_speed(found)))


def test_thoma_is_just_within_the_rule() -> None:
    found = drive_speed(scene("[10, 1]"))
    assert found is not None
    assert (found.verdict, found.shaft) == ("fair", 1)
    assert found.share == pytest.approx(1 / 11, rel=1e-3)
    words = said(scene("[10, 1]"))
    assert "the drive varies by 0.201% from peak to peak" in words
    assert "Shaft 1 varies by 2.21%, so the share is 9.09%; the limit is 10%" in words
    assert "smaller than computed" in said(scene("[8, 1]"))


def test_the_inertia_that_it_names_is_enough() -> None:
    for inertias in ("[8, 1]", "[0, 1]"):
        words = said(scene(inertias))
        needed = float(words.partition(" kg m²")[0].rpartition(" ")[2])
        again = drive_speed(scene(f"[{needed}, 1]"))
        assert again is not None
        assert again.verdict == "fair"
        assert again.share == pytest.approx(SHARE, rel=0.01)
        less = drive_speed(scene(f"[{0.99 * needed}, 1]"))
        assert less is not None
        assert less.verdict == "not fair"


def test_a_light_shaft_before_a_heavy_output_needs_no_inertia_of_the_drive() -> None:
    light = scene("[0, 0.001, 9]", "[14, 14]")
    found = drive_speed(light)
    assert found is not None
    assert found.needed == 0.0
    assert "a reasonable assumption if shaft 0 has any inertia (motor, pulley, flywheel)" in said(
        light
    )


def test_the_shaft_is_that_whose_energy_varies_most() -> None:
    found = drive_speed(scene("[5, 0.001, 2]", "[20, 14]"))
    assert found is not None
    assert found.shaft == 2
    assert found.shaft_variation == pytest.approx(
        cardan.Driveline.from_bends([20, 14], degrees=True).equivalent(2).non_uniformity
    )
    light = drive_speed(scene("[5, 1, 0.001]", "[20, 14]"))
    assert light is not None
    assert light.shaft == 1


@pytest.mark.parametrize(
    "given",
    [
        scene(""),
        scene("[1, 1]", speed="acceleration_rad_s2 = 5"),
        scene("[1, 0]"),
        scene("[1, 1]", "[0]"),
        scene("[1, 0, 3]", "[10, 10]\ntwists_deg = [180]"),
    ],
    ids=["no load", "no speed", "no driven inertia", "straight", "only behind cancelled joints"],
)
def test_where_nothing_depends_on_it(given: Scene) -> None:
    assert drive_speed(given) is None


def test_a_measured_drive_is_not_assumed_to_be_constant(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("t,n\n" + "".join(f"{0.01 * i},600\n" for i in range(40)))
    text = (
        "[angles]\nfile = 'run.csv'\ntime_column_s = 't'\nspeed_column_rpm = 'n'\n"
        "[driveline]\nbends_deg = [10]\n[load]\ninertias_kgm2 = [0, 1]\n"
    )
    measured = Scene.parse(text, folder=tmp_path)
    assert measured.speed == pytest.approx(20.0 * np.pi)
    assert drive_speed(measured) is None


def test_check_and_report_say_it(tmp_path: Path, answered: Answers) -> None:
    path = example("drive_inertia.toml")
    answer = answered(path)
    _, text = answer.check
    assert "\n\nConstant drive speed: a fair assumption\n" in text
    assert max(map(len, text.splitlines())) <= 79
    data = answer.data("check")
    ANSWERS.validate(data)
    assert data["drive_speed"]["share_percent"] == pytest.approx(100 / 11, rel=1e-3)
    assert data["drive_speed"]["needed_kgm2"] == pytest.approx(0.18, rel=0.01)
    assert "<strong>Constant drive speed: a fair assumption.</strong>" in answer.page
    # It is advice and no limit.
    weak = path.read_text().replace("[8.5]", "[2]").replace("[0.2,", "[0.01,")
    (tmp_path / "weak.toml").write_text(weak)
    done = CliRunner().invoke(commands(), ["check", str(tmp_path / "weak.toml")])
    assert "not a fair assumption" in done.output
    assert done.exit_code == 0


def test_the_picture() -> None:
    line = cardan.Driveline.from_bends([8.5], degrees=True)
    axes = plot_drive_speed(line, [[1.0, 1.0], [10.0, 1.0]])
    first, second = axes.get_lines()
    free = line.free_running([10.0, 1.0])
    angles = np.radians(np.asarray(second.get_xdata(), dtype=float))
    drawn = np.asarray(second.get_ydata(), dtype=float)
    assert drawn == pytest.approx(100 * (free.speed_ratio(angles) - 1), abs=1e-9)
    assert first.get_label() == "1 kg m²"
    with pytest.raises(ValueError, match="labels has 2 entries; there are 1 curves"):
        plot_drive_speed(line, [1.0, 1.0], labels=["a", "b"])
