"""Offsets in scenes: the slides they cause, what cannot slide, answers, pictures, the page."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import pyplot
from matplotlib.patches import Rectangle

import cardan
from cardan.app.answers.axial_travel.figures import SceneSlides, drawn_slides, scene_slides
from cardan.app.answers.axial_travel.text import words as slides_text
from cardan.app.command import commands
from cardan.app.plots import plot_slide_orders, plot_slides, write_slides
from cardan.app.scene import Scene
from cardan.app.scene.errors import SceneError
from example_scenes import ANSWERS, SCENES, Answers, example, replaced

PATH = example("axial_travel.toml")
TEXT = PATH.read_text(encoding="utf-8")
SINGLE = """
[driveline]
bends_deg = 20
[offsets]
driving_pin_mm = 0.3
"""


def figures(text: str) -> SceneSlides:
    found = scene_slides(Scene.parse(text))
    assert found is not None
    return found


def test_a_pin_that_misses_its_shaft_moves_the_next_shaft_once_per_turn() -> None:
    """Order 1 of 2 g tan(bend/2), and odd orders alone."""
    shaft = figures(SINGLE).each[0]
    assert (shaft.joint, shaft.slide) == (0, "shaft")
    assert shaft.amplitudes[0] == pytest.approx(0.6 * math.tan(math.radians(10)))
    assert shaft.amplitudes[1] == pytest.approx(0.0, abs=1e-12)
    assert shaft.travel == pytest.approx(2 * 0.3 * math.sin(math.radians(20)))


def test_shafts_that_miss_each_other_move_twice_per_turn() -> None:
    shaft = figures(SINGLE.replace("driving_pin_mm", "shafts_mm")).each[0]
    bend = math.radians(20)
    assert shaft.amplitudes[0] == pytest.approx(0.0, abs=1e-12)
    assert shaft.amplitudes[1] == pytest.approx(0.6 * math.tan(bend / 2) ** 2 / math.sin(bend))


def test_one_distance_per_joint_or_one_for_all() -> None:
    both = figures(TEXT.replace("[0.2, 0] ", "0.2 ").replace("[0.5, 0] ", "[0.5, 0.5] "))
    shafts = [one for one in both.each if one.slide == "shaft"]
    assert [one.joint for one in shafts] == [0, 1]
    assert shafts[1].travel > 0.1
    assert [one.travel for one in figures(TEXT).each if one.joint == 1] == [0.0, 0.0, 0.0]


def test_the_state_that_moves_most_is_named() -> None:
    text = TEXT + '[states]\nnames = ["laden", "empty"]\n"bends_deg.0" = [4, 14]\n'
    found = figures(text)
    assert found.each[0].state == "empty"
    steep = figures(TEXT.replace("[12, 9]", "[14, 9]")).each[0]
    assert found.each[0].travel == pytest.approx(steep.travel)
    assert found.each[0].amplitudes == pytest.approx(steep.amplitudes)
    assert "in empty" in slides_text(found)
    drawn = drawn_slides(Scene.parse(text)).travel()
    assert drawn[0] == pytest.approx(steep.travel)


def test_words_follow_the_offsets() -> None:
    text = slides_text(figures(SINGLE))
    assert "orders 1 and 3 come from pins" in text
    assert "orders 2 and 4" not in text
    twice = " ".join(slides_text(figures(SINGLE.replace("driving_pin", "cross"))).split())
    assert "orders 2 and 4 come from shafts" in twice
    assert "orders 1 and 3" not in twice
    none = slides_text(figures(SINGLE.replace("0.3", "0")))
    assert none == "Slides over a turn: none."


def test_a_blocked_slide_that_stays_is_said() -> None:
    """Shafts that are parallel and miss each other move the pins alone."""
    text = SINGLE.replace("driving_pin_mm", "shafts_mm").replace("20", "0")
    found = figures(f'{text}blocked = "shaft"\n')
    assert "What is blocked does not move: shaft." in slides_text(found)
    assert [one.travel for one in found.each] == pytest.approx([0.0, 0.6, 0.6])


@pytest.mark.parametrize(
    ("new", "message"),
    [
        (
            'blocked = "shaft"',
            r"line 16: \[offsets\] blocked has 'shaft', but the offsets of joint 0 make it slide "
            r"by 0\.1692 mm in a turn; where it cannot slide",
        ),
        ('blocked = "shafts"', r"\[offsets\] blocked is 'shafts'; did you mean 'shaft'"),
        ("cross_mm = [0.1]", r"\[offsets\] cross_mm has length 1; it needs 2, one per joint"),
        ("cross_mm = 2e3", r"\[offsets\] cross_mm is 2000"),
        ("cross_m = 1e-3", r"\[offsets\] unknown key 'cross_m'"),
    ],
)
def test_what_does_not_fit_is_refused(new: str, message: str) -> None:
    text = replaced(TEXT, ("[output]\n", f"{new}\n[output]\n"))
    with pytest.raises(SceneError, match=message):
        Scene.parse(text)


def test_a_section_without_a_distance_is_refused() -> None:
    with pytest.raises(SceneError, match=r"\[offsets\]"):
        Scene.parse(SINGLE.replace("driving_pin_mm = 0.3", 'blocked = "shaft"'))


def test_recorded_bends_are_refused(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("a,b\n0,5\n90,6\n", encoding="utf-8")
    text = (
        '[angles]\nfile = "run.csv"\nangle_column_deg = "a"\nbend_columns_deg = ["b"]\n'
        "[offsets]\nshafts_mm = 0.1\n"
    )
    with pytest.raises(SceneError, match=r"\[offsets\] it does not go with recorded bends"):
        Scene.parse(text, folder=tmp_path)


def run(*arguments: object) -> str:
    done = CliRunner().invoke(commands(), [str(argument) for argument in arguments])
    assert done.exit_code in (0, 1), done.output
    return done.output


def test_answers(answered: Answers) -> None:
    SCENES.validate(tomllib.loads(TEXT))
    SCENES.validate(tomllib.loads(f'{SINGLE}blocked = ["shaft", "driven_pin"]'))
    assert not SCENES.is_valid(tomllib.loads(f'{SINGLE}blocked = "shafts"'))
    table = slides_text(figures(TEXT))
    answer = answered(PATH)
    assert table in answer.run.text
    assert table in answer.check.text
    for command in ("run", "check"):
        data: dict[str, Any] = answer.data(command)
        ANSWERS.validate(data)
        first = data["axial_travel"][0]
        assert (first["joint"], first["slide"]) == (0, "shaft")
        assert first["travel_mm"] == figures(TEXT).each[0].travel
        assert [entry["order"] for entry in first["orders"]] == [1, 2, 3, 4]
    html = answer.page
    assert "Axial travel of offset axes" in html
    assert "Axial travel of the driven shafts" in html
    assert "joint 0, shaft 1 axially" in html


def test_pictures(tmp_path: Path) -> None:
    slides = drawn_slides(Scene.load(PATH))
    curve = plot_slides(slides).get_lines()[0]
    angle = np.radians(np.asarray(curve.get_xdata()))
    assert np.asarray(curve.get_ydata()) == pytest.approx(slides.at(angle)[0])
    bars = [bar for bar in plot_slide_orders(slides).patches if isinstance(bar, Rectangle)]
    heights = slides.amplitudes([1, 2, 3, 4, 5, 6]).ravel()
    assert [bar.get_height() for bar in bars] == pytest.approx(heights)
    for path in (tmp_path / "once.svg", tmp_path / "again.svg"):
        write_slides(slides, path, "A shaft")
    assert (tmp_path / "once.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()
    batch = cardan.Driveline.from_bends([[10], [20]], degrees=True).slides(shafts=1.0)
    with pytest.raises(ValueError, match="slides are those of a batch"):
        plot_slides(batch)
    pyplot.close("all")


def test_the_command_draws(tmp_path: Path) -> None:
    path = tmp_path / "slides.svg"
    assert run("plot", PATH, "--slides", "--output", path) == f"wrote {path}\n"
    assert "axial travel" in path.read_text(encoding="utf-8")
    none = CliRunner().invoke(commands(), ["plot", str(example("foeppl.toml")), "--slides"])
    assert none.exit_code == 2
    assert "slides need a section [offsets]" in none.stderr
    both = CliRunner().invoke(commands(), ["plot", str(PATH), "--slides", "--forces"])
    assert "--slides does not go with --forces" in both.stderr
