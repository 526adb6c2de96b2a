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
from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel import drawn_slides
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.plots import plot_part, plot_slide_orders, plot_slides, save
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import SceneError
from example_scenes import ANSWERS, SCENES, Answers, example, replaced

PATH = example("axial_travel.toml")
TEXT = PATH.read_text(encoding="utf-8")
SINGLE = """
[driveline]
bends_deg = 20
[offsets]
driving_pin_mm = 0.3
"""


def figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["axial_travel"]
    assert found is not None
    return found


def said(text: str) -> str:
    return " ".join(PARTS["axial_travel"].sentences(figures(text)))


def test_a_pin_that_misses_its_shaft_moves_the_next_shaft_once_per_turn() -> None:
    """Order 1 of 2 g tan(bend/2), and odd orders alone."""
    (shaft,) = figures(SINGLE).shafts
    assert shaft.joint == 0
    assert shaft.order_1 == pytest.approx(0.6e-3 * math.tan(math.radians(10)))
    assert shaft.order_2 == pytest.approx(0.0, abs=1e-15)
    assert shaft.travel.value == pytest.approx(0.6e-3 * math.sin(math.radians(20)))


def test_shafts_that_miss_each_other_move_twice_per_turn() -> None:
    (shaft,) = figures(SINGLE.replace("driving_pin_mm", "shafts_mm")).shafts
    bend = math.radians(20)
    assert shaft.order_1 == pytest.approx(0.0, abs=1e-15)
    assert shaft.order_2 == pytest.approx(0.6e-3 * math.tan(bend / 2) ** 2 / math.sin(bend))


def test_one_distance_per_joint_or_one_for_all() -> None:
    both = figures(TEXT.replace("[0.2, 0] ", "0.2 ").replace("[0.5, 0] ", "[0.5, 0.5] "))
    assert [one.joint for one in both.shafts] == [0, 1]
    assert both.shafts[1].travel.value > 1e-4
    one = figures(TEXT)
    assert [each[1].travel.value for each in (one.shafts, one.crosses, one.yokes)] == [
        0.0,
        0.0,
        0.0,
    ]


def test_the_state_that_moves_most_is_named() -> None:
    text = TEXT + '[states]\nnames = ["laden", "empty"]\n"bends_deg.0" = [4, 14]\n'
    found = figures(text).shafts[0]
    assert found.travel.state == "empty"
    steep = figures(TEXT.replace("[12, 9]", "[14, 9]")).shafts[0]
    flat = figures(TEXT.replace("[12, 9]", "[4, 9]")).shafts[0]
    assert found.travel.value == pytest.approx(steep.travel.value)
    assert found.travel.each == pytest.approx(
        {"laden": flat.travel.value, "empty": steep.travel.value}
    )
    orders = [[each.order_1, each.order_2, each.order_3, each.order_4] for each in (found, steep)]
    assert orders[0] == pytest.approx(orders[1])
    drawn = drawn_slides(Scene.parse(text)).travel()
    assert drawn[0] == pytest.approx(1e3 * steep.travel.value)


def test_words_follow_the_offsets() -> None:
    text = said(SINGLE)
    assert "orders 1 and 3 come from pins" in text
    assert "orders 2 and 4" not in text
    twice = said(SINGLE.replace("driving_pin", "cross"))
    assert "orders 2 and 4 come from shafts" in twice
    assert "orders 1 and 3" not in twice


def test_a_blocked_slide_stays() -> None:
    """Shafts that are parallel and miss each other move the pins alone."""
    text = SINGLE.replace("driving_pin_mm", "shafts_mm").replace("20", "0")
    found = figures(f'{text}blocked = "shaft"\n')
    travels = [each[0].travel.value for each in (found.shafts, found.crosses, found.yokes)]
    assert travels == pytest.approx([0.0, 0.6e-3, 0.6e-3])


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
    table = PARTS["axial_travel"].text(figures(TEXT))
    answer = answered(PATH)
    assert table in answer.run.text
    assert table in answer.check.text
    shaft = figures(TEXT).shafts[0]
    for command in ("run", "check"):
        data: dict[str, Any] = answer.data(command)
        ANSWERS.validate(data)
        first = data["axial_travel"]["shafts"][0]
        assert first["joint"] == 0
        assert first["travel"]["value_mm"] == 1e3 * shaft.travel.value
        assert first["order_1_mm"] == 1e3 * shaft.order_1
    html = answer.page
    assert "Axial travel of offset axes" in html
    assert "Axial travel of the driven shafts" in html
    assert "Driven shafts along their axes" in html


def test_pictures(tmp_path: Path) -> None:
    slides = drawn_slides(Scene.load(PATH))
    curve = plot_slides(slides).get_lines()[0]
    angle = np.radians(np.asarray(curve.get_xdata()))
    assert np.asarray(curve.get_ydata()) == pytest.approx(slides.at(angle)[0])
    bars = [bar for bar in plot_slide_orders(slides).patches if isinstance(bar, Rectangle)]
    heights = slides.amplitudes([1, 2, 3, 4, 5, 6]).ravel()
    assert [bar.get_height() for bar in bars] == pytest.approx(heights)
    for path in (tmp_path / "once.svg", tmp_path / "again.svg"):
        save(plot_part(Scene.load(PATH), "axial_travel"), path)
    assert (tmp_path / "once.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()
    batch = cardan.Driveline.from_bends([[10], [20]], degrees=True).slides(shafts=1.0)
    with pytest.raises(ValueError, match="slides are those of a batch"):
        plot_slides(batch)
    pyplot.close("all")


def test_the_command_draws(tmp_path: Path) -> None:
    path = tmp_path / "slides.svg"
    assert run("plot", PATH, "--what", "axial_travel", "--output", path) == f"wrote {path}\n"
    assert "axial travel" in path.read_text(encoding="utf-8")
    bare = example("foeppl.toml")
    none = CliRunner().invoke(commands(), ["plot", str(bare), "--what", "axial_travel"])
    assert none.exit_code == 2
    assert "slides need a section [offsets]" in none.stderr
