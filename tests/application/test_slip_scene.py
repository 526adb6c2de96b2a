"""The spline of a scene: travel, engagement, axial force, errors, answers, the page."""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.rows import worst_of
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import SceneError
from example_scenes import ANSWERS, SCENES, example, replaced

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


def test_values_at_their_limits_are_within() -> None:
    scene = Scene.parse("""
[driveline]
points_mm = [[0, 0, 0], [0.3, 0, 0], [807.3, 0, 0], [1000, 0, 0]]
[slip]
shaft = 1
travel_mm = 7.3
engaged_mm = 40
least_engaged_mm = 32.7
[states]
points_mm.2.x = [807.3, 814.6]
""")
    found = Answer(scene)["spline"]
    assert found is not None
    assert found.travel.value != 0.0073, "the rounding that a limit forgives"
    assert verdict_of(found) == "within"


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


def test_metres_are_the_same() -> None:
    metres = replaced(
        TEXT,
        ("points_mm = [", "points_m = ["),
        ("[300, 0, 0]", "[0.3, 0, 0]"),
        ("[1500, -110, 40]", "[1.5, -0.11, 0.04]"),
        ("[1800, -110, 40]", "[1.8, -0.11, 0.04]"),
        ("points_mm.2-3.y = {from = -180, to = 60", "points_m.2-3.y = {from = -0.18, to = 0.06"),
    )
    one, other = figures(), figures(metres)
    assert other.length == pytest.approx(one.length)
    assert other.travel.value == pytest.approx(one.travel.value)
    assert other.force == pytest.approx(one.force)


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


def test_what_it_adds_to_bearings() -> None:
    whole = Scene.parse(TEXT[: TEXT.index("[study]")])
    geometry = whole.line._geometry._replace(
        bearings=(0, 0, 2, 2), positions=np.array([100.0, 250.0, 60.0, 160.0])
    )
    found = Answer(replace(whole, line=whole.line._of(geometry)))["spline"]
    assert found is not None
    across = found.supports[1].transverse
    assert [load.on_shaft for load in found.bearings] == [0, 0, 2, 2]
    assert found.bearings[2].force == pytest.approx(1.6 * across)
    assert found.bearings[3].force == pytest.approx(0.6 * across)
    words = SPLINE.text(found)
    assert "bearing 2" in words
    assert "(a + b)/b" not in words
    assert [entry["bearing"] for entry in SPLINE.data(found)["bearings"]] == [0, 1, 2, 3]


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
    assert CliRunner().invoke(commands(), ["check", str(path)]).exit_code == 1


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


def test_answers_and_report(tmp_path: Path) -> None:
    path = tmp_path / "slip.toml"
    path.write_text(TEXT)
    for command in ("run", "check"):
        more = ["--into", str(tmp_path)] if command == "run" else []
        done = CliRunner().invoke(commands(), [command, str(path), "--json", *more])
        data: Any = json.loads(done.stdout)
        ANSWERS.validate(data)
        assert data["spline"] == json.loads(json.dumps(SPLINE.data(figures())))
        assert data["spline"]["shaft"] == 1
    assert data["passes"]
    write_report(Scene.load(path), tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text("utf-8")
    assert '<a href="#spline">Spline</a>' in page
    assert "The spline of shaft 1 adds an axial force of up to 2428 N while it slides." in page
    assert "The spline is within the limits that the scene gives." in page
    assert max(map(len, SPLINE.text(figures()).splitlines())) <= 79


def test_a_study_that_moves_no_point_says_so() -> None:
    text = (
        "[driveline]\npoints_mm = [[0, 0, 0], [300, 0, 0], [1500, -110, 40], [1800, -110, 40]]\n"
        "[slip]\nshaft = 1\ntravel_mm = 40\n"
        "[load]\noutput_torque_Nm = 100\n[study]\noutput_torque_Nm = [100, 200]\n"
    )
    found = Answer(Scene.parse(text))["spline"]
    assert found is not None
    said = " ".join(SPLINE.sentences(found))
    assert "The study does not change the length of shaft 1; a [study] of points finds" in said
    moved = Answer(Scene.parse(TEXT))["spline"]
    assert moved is not None
    assert "does not change" not in " ".join(SPLINE.sentences(moved))
