"""What slides: the spline of a scene, and shafts with offset joints."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import cardan
import scripts
from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel import drawn_slides
from cardan.app.answers.rows import worst_of
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import SceneError
from example_scenes import SCENES, example, replaced

TEXT = example("slip.toml").read_text(encoding="utf-8")


SPLINE = PARTS["spline"]


HEIGHTS = np.linspace(-180, 60, 49)


def figures(text: str = TEXT) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["spline"]
    assert found is not None
    return found


def length(height: float) -> float:
    return 1e-3 * math.dist((300, 0, 0), (1500, height, 40))


def verdict_of(found: Any) -> str:  # noqa: ANN401 - of figures
    judged = (found.travel, found.engaged, found.push_in)
    return worst_of(each.verdict for each in judged if each)


def test_lengths_over_the_study() -> None:
    found = figures()
    lengths = [length(height) for height in HEIGHTS.tolist()]
    assert found.drivelines == 49
    assert found.length == pytest.approx(length(-110))
    assert found.shortest.value == pytest.approx(min(lengths))
    assert found.longest.value == pytest.approx(max(lengths))
    assert found.longest.at == {"points_mm.2-3.y": -180.0}
    assert found.shortest.at == {"points_mm.2-3.y": 0.0}
    assert found.travel.value == pytest.approx(max(lengths) - min(lengths))
    assert found.engaged.value == pytest.approx(0.080 - (max(lengths) - length(-110)))
    assert found.push_in.value == pytest.approx(0.025 - (length(-110) - min(lengths)))
    assert (verdict_of(found), found.others) == ("within", ())


def test_a_spline_that_comes_apart_is_beyond_whatever_limit_is_given() -> None:
    apart = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, 0, 0], [2000, 0, 0]]
[slip]
shaft = 1
engaged_mm = 40
[states]
points_mm.2.x = [1500, 1550]
"""
    found = Answer(Scene.parse(apart))["spline"]
    assert found is not None
    assert found.engaged.value == pytest.approx(-0.010)
    assert found.engaged.verdict == "beyond"


def test_the_force_is_that_of_the_library_at_the_worst_of_the_study() -> None:
    found = figures()
    points = np.zeros((49, 1, 4, 3))
    points[..., 1, :] = 300, 0, 0
    points[..., 2, :] = 1500, 0, 40
    points[..., 3, :] = 1800, 0, 40
    points[..., 2:, 1] = HEIGHTS[:, None, None]
    lines = cardan.Driveline.from_points(points)
    # Two equal joints: the middle shaft carries most where it is slowest.
    torque = 400.0 / np.cos(lines.bends[:, 0, 0])
    assert found.torque is not None
    assert found.torque.value == pytest.approx(torque.max(), rel=1e-9)
    force = lines[:, 0].spline_force(1, torque, 0.12, 0.02)
    assert found.force == pytest.approx(force.axial.max(), rel=1e-9)
    up, down = found.supports
    assert (up.side, up.shaft, down.side, down.shaft) == ("upstream", 0, "downstream", 2)
    assert up.axial == pytest.approx(force.upstream_axial.max(), rel=1e-9)
    assert up.transverse == pytest.approx(force.upstream_transverse.max(), rel=1e-9)
    assert down.transverse == pytest.approx(force.downstream_transverse.max(), rel=1e-9)


def test_bearings_bear_the_force_of_the_worst_state() -> None:
    bearings = "".join(
        f"[[bearing]]\nshaft = {shaft}\nposition_mm = {position}\n"
        for shaft, position in ((0, 100), (0, 250), (2, 60), (2, 160))
    )
    alone = TEXT[: TEXT.index("[study]")] + bearings
    forces = []
    for height in (-110, 0, -180):
        found = figures(alone.replace("-110", str(height)))
        forces.append([load.force for load in found.bearings])
    assert len(forces[0]) == 4
    several = figures(f"{alone}[states]\npoints_mm.2-3.y = [-110, 0, -180]\n")
    assert [load.force for load in several.bearings] == pytest.approx(np.max(forces, axis=0))
    assert max(forces[0]) < max(forces[2])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("travel_mm = 40", "travel_mm = 10", "its travel exceeds the permitted one by 3.4 mm"),
        (
            "least_engaged_mm = 65",
            "least_engaged_mm = 75",
            "mm of engaged length are missing at points_mm.2-3.y = -180",
        ),
        ("push_in_mm = 25", "push_in_mm = 2", "mm too early at points_mm.2-3.y = 0"),
        ("engaged_mm = 80 ", "engaged_mm = 5 ", "it comes apart at points_mm.2-3.y = -180"),
        ("engaged_mm = 80 ", "engaged_mm = 9 ", "64.4 mm of engaged length are missing at"),
    ],
)
def test_what_does_not_suffice(old: str, new: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "slip.toml"
    path.write_text(replaced(TEXT, (old, new)))
    found = figures(path.read_text())
    assert verdict_of(found) == "beyond"
    assert words in " ".join(SPLINE.text(found).split())
    assert scripts.run("check", path).exit_code == 1


def test_one_position_has_no_travel() -> None:
    text = TEXT[: TEXT.index("[study]")]
    found = figures(text)
    assert found.drivelines == 1
    assert "These are figures of one position" in SPLINE.text(found)
    for several in ("", "[study]\nspeed_rpm = [100, 200]\n"):
        own = figures(text + several)
        assert own.travel is not None
        assert (own.travel.verdict, own.travel.value) == ("not judged", None)
        assert own.travel.why == "needs [states] or a [study] of points"
    assert found.torque is not None
    bend = math.atan(math.hypot(110, 40) / 1200)
    assert found.torque.value == pytest.approx(400 / math.cos(bend), rel=1e-9)


def test_without_friction_load_or_limits() -> None:
    for part in ("friction = 0.12", "output_torque_Nm = 400"):
        text = replaced(TEXT, (part, ""))
        text = text.replace("radius_mm = 20", "") if part.startswith("friction") else text
        text = text.replace('quantities = ["torque"]', "")
        found = figures(text)
        assert (found.torque, found.force, found.supports) == (None, None, ())
        # Not silently: with a friction a force is expected.
        unknown = "The axial force is not computed" in " ".join(SPLINE.text(found).split())
        assert unknown == part.startswith("output_torque")
    limits = ("travel_mm = 40", "least_engaged_mm = 65", "push_in_mm = 25")
    bare = replaced(TEXT, *((limit, "") for limit in limits))
    assert verdict_of(figures(bare)) == "not judged"
    assert "is not judged" in SPLINE.text(figures(bare))


def test_other_shafts_that_change_their_length() -> None:
    found = figures(replaced(TEXT, ("points_mm.2-3.y", "points_mm.2.y")))
    assert [other.shaft for other in found.others] == [2]
    assert "Shaft 2 changes its length by" in SPLINE.text(found)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("shaft = 1 ", "shaft = 3 ", "line 26: [slip] shaft is 3; there are 3, counted from 0"),
        ("shaft = 1 ", "", "[slip] shaft is missing"),
        ("engaged_mm = 80 ", "", "[slip] least_engaged_mm needs engaged_mm, which is missing"),
        ("friction = 0.12 ", "", "[slip] radius_mm needs friction, which is missing"),
        ("radius_mm = 20 ", "", "[slip] friction needs radius_mm, which is missing"),
        ("travel_mm = 40", "travel_mm = -1", "[slip] travel_mm is -1; it must be positive"),
        ("travel_mm = 40", "travel_m = 1", "travel_mm holds millimetres"),
    ],
)
def test_errors(old: str, new: str, message: str) -> None:
    text = replaced(TEXT, (old, new))
    with pytest.raises(SceneError) as caught:
        Scene.parse(text, "slip.toml")
    assert message in str(caught.value)
    assert str(caught.value).startswith("slip.toml, line ")
    valid = SCENES.is_valid(tomllib.loads(text))
    assert valid == ("there are 3" in message)


def test_bends_have_no_lengths() -> None:
    bends = "[driveline]\nbends_deg = [3, 3]\n"
    with pytest.raises(SceneError, match=r"shaft has no length that could change; \[slip\] needs"):
        Scene.parse(f"{bends}[slip]\nshaft = 1\n")
    with pytest.raises(SceneError, match=r"closed_forms 'length' needs points_mm or points_m"):
        Scene.parse(f"{bends}[output]\nclosed_forms = ['length']\n")


def test_the_study_has_a_column_of_lengths() -> None:
    study = Scene.parse(TEXT).run().study
    assert study is not None
    (column,) = (column for column in study.columns if column.quantity == "length")
    assert (column.name, column.unit, column.item) == ("length_1", "mm", 1)
    assert study.values["length_1"] == pytest.approx([1e3 * length(y) for y in HEIGHTS.tolist()])


PATH = example("axial_travel.toml")


SLIDES_TEXT = PATH.read_text(encoding="utf-8")


SINGLE = """
[driveline]
bends_deg = 20
[offsets]
driving_pin_mm = 0.3
"""


def slides_figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["axial_travel"]
    assert found is not None
    return found


def said(text: str) -> str:
    return " ".join(PARTS["axial_travel"].sentences(slides_figures(text)))


def test_a_pin_that_misses_its_shaft_moves_the_next_shaft_once_per_turn() -> None:
    """Order 1 of 2 g tan(bend/2), and odd orders alone."""
    (shaft,) = slides_figures(SINGLE).shafts
    assert shaft.joint == 0
    assert shaft.order_1 == pytest.approx(0.6e-3 * math.tan(math.radians(10)))
    assert shaft.order_2 == pytest.approx(0.0, abs=1e-15)
    assert shaft.travel.value == pytest.approx(0.6e-3 * math.sin(math.radians(20)))


def test_shafts_that_miss_each_other_move_twice_per_turn() -> None:
    (shaft,) = slides_figures(SINGLE.replace("driving_pin_mm", "shafts_mm")).shafts
    bend = math.radians(20)
    assert shaft.order_1 == pytest.approx(0.0, abs=1e-15)
    assert shaft.order_2 == pytest.approx(0.6e-3 * math.tan(bend / 2) ** 2 / math.sin(bend))


def test_one_distance_per_joint_or_one_for_all() -> None:
    both = slides_figures(
        SLIDES_TEXT.replace("[0.2, 0] ", "0.2 ").replace("[0.5, 0] ", "[0.5, 0.5] ")
    )
    assert [one.joint for one in both.shafts] == [0, 1]
    assert both.shafts[1].travel.value > 1e-4
    one = slides_figures(SLIDES_TEXT)
    assert [each[1].travel.value for each in (one.shafts, one.crosses, one.yokes)] == [
        0.0,
        0.0,
        0.0,
    ]


def test_the_state_that_moves_most_is_named() -> None:
    text = SLIDES_TEXT + '[states]\nnames = ["laden", "empty"]\n"bends_deg.0" = [4, 14]\n'
    found = slides_figures(text).shafts[0]
    assert found.travel.state == "empty"
    steep = slides_figures(SLIDES_TEXT.replace("[12, 9]", "[14, 9]")).shafts[0]
    flat = slides_figures(SLIDES_TEXT.replace("[12, 9]", "[4, 9]")).shafts[0]
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
    found = slides_figures(f'{text}blocked = "shaft"\n')
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
    text = replaced(SLIDES_TEXT, ("[output]\n", f"{new}\n[output]\n"))
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
