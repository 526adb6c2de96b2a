"""Ball joints, steering columns and the constant speed of the drive: figures and what is said."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cardan
import scripts
from cardan import BallJoint
from cardan.app.answers.answer import Answer
from cardan.app.answers.ball_joint import (
    ball_joint_figures,
    pressure_curve,
)
from cardan.app.answers.drive_speed import SHARE, DriveSpeed
from cardan.app.answers.table import PARTS
from cardan.app.plots import plot_ball_joint
from cardan.app.scene import BallJointScene, Scene, load_scene
from cardan.app.scene.language.errors import SceneError
from cardan.ball_joint import layer_compliance
from example_scenes import ANSWERS, Answers, example, replaced
from pages import three

TEXT = example("ball_joint.toml").read_text(encoding="utf-8")


DRIVELINE = "[driveline]\nbends_deg = [10]\n[load]\nspeed_rpm = 60\noutput_torque_Nm = 5\n"


PART = PARTS["ball_joint"]


def test_figures_are_those_of_the_library() -> None:
    case = BallJointScene.parse(TEXT).ball_joint
    found = ball_joint_figures(case)
    compliance = layer_compliance(1e-3, 2.5e9, 0.4)
    joint = BallJoint(0.016, math.radians(60)).with_clearance(1e-5, compliance=compliance)
    assert found.peak == pytest.approx(joint.peak_pressure(20e3), rel=1e-14)
    assert found.contact_angle == pytest.approx(joint.contact_angle(20e3), rel=1e-14)
    assert found.turning_friction == pytest.approx(joint.friction_moment(20e3, 0.12), rel=1e-14)
    assert found.swivelling_friction == pytest.approx(
        joint.tilting_friction_moment(20e3, 0.12), rel=1e-14
    )
    assert found.seat_approach == pytest.approx(joint.approach(20e3), rel=1e-14)
    assert found.ball_approach == 0.0
    assert found.projected_pressure == pytest.approx(
        20e3 / (math.pi * (0.016 * math.sqrt(0.75)) ** 2)
    )
    assert found.seat_pressure.verdict == "within"
    words = PART.text(found)
    for moment in (found.turning_friction, found.swivelling_friction):
        assert moment
        assert three(float(moment)) in words


def test_a_hemisphere_reaches_one_and_a_half_times_the_projected_pressure() -> None:
    """Marcus (10)."""
    scene = BallJointScene.parse("[ball_joint]\nload_N = 1000\nradius_mm = 10\n")
    found = ball_joint_figures(scene.ball_joint)
    assert found.peak == pytest.approx(1.5 * found.projected_pressure, rel=1e-13)
    assert found.peak == pytest.approx(3 * 1000 / (2 * math.pi * 0.01**2), rel=1e-13)
    assert found.edge_pressure == 0.0
    assert found.seat_pressure.verdict == "not judged"
    assert (found.allowable_load, found.turning_friction) == (None, None)
    assert Answer(scene).verdict == "not judged"


def test_the_weaker_material_judges_and_sizes() -> None:
    found = ball_joint_figures(BallJointScene.parse(TEXT).ball_joint)
    assert (found.weaker, found.seat_pressure.limit) == ("seat", 60e6)
    soft = replaced(TEXT, ("allowable_pressure_MPa = 400", "allowable_pressure_MPa = 40"))
    found = ball_joint_figures(BallJointScene.parse(soft).ball_joint)
    assert (found.weaker, found.ball_pressure.limit) == ("ball", 40e6)
    assert (found.ball_pressure.verdict, found.seat_pressure.verdict) == ("beyond", "within")
    sized_scene = BallJointScene.parse(soft.replace("radius_mm = 16", ""))
    sized = sized_scene.ball_joint
    assert sized.sized
    assert sized.joint.radius == pytest.approx(found.smallest_radius, rel=1e-14)
    assert ball_joint_figures(sized).peak == pytest.approx(40e6, rel=1e-13)
    assert Answer(sized_scene).verdict == "within"


def test_compliances_of_both_materials_add_up() -> None:
    """Marcus (8): the approach is shared in proportion to his coefficients."""
    text = replaced(
        TEXT,
        ("allowable_pressure_MPa = 400", "compliance_um_per_MPa = 0.1"),
        ("layer_mm = 1.0\nmodulus_MPa = 2500\npoisson = 0.4", "compliance_um_per_MPa = 0.3"),
    )
    case = BallJointScene.parse(text).ball_joint
    found = ball_joint_figures(case)
    assert case.joint.compliance == pytest.approx(4e-13, rel=1e-14)
    ball, seat = found.ball_approach, found.seat_approach
    assert ball is not None
    assert seat is not None
    assert seat == pytest.approx(3 * ball, rel=1e-14)
    assert ball + seat == pytest.approx(case.joint.approach(20e3), rel=1e-14)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("load_N = 20000", "", "line 6: [ball_joint] load_N is missing"),
        ("load_N = 20000", "load_N = 0", "line 7: [ball_joint] load_N is 0; it must lie in"),
        ("load_N = 20000", "load_kN = 20", "the name includes the unit: load_N holds newtons"),
        (
            "half_angle_deg = 60",
            "half_angle_deg = 91",
            "line 9: [ball_joint] half_angle_deg is 91 deg; it must lie in [0.1, 90] deg",
        ),
        (
            "modulus_MPa = 2500",
            "",
            "line 21: [ball_joint] seat.layer_mm needs modulus_MPa; "
            "layer_mm and modulus_MPa go together",
        ),
        (
            "modulus_MPa = 2500",
            "modulus_GPa = 2.5",
            "line 18: [ball_joint] seat has an unknown key 'modulus_GPa'; "
            "the name includes the unit: modulus_MPa holds megapascals",
        ),
        (
            "layer_mm = 1.0",
            "compliance_um_per_MPa = 1",
            "line 22: [ball_joint] seat.modulus_MPa and compliance_um_per_MPa are both given; "
            "give one of them",
        ),
        ("poisson = 0.4", "poisson = 0.5", "line 23: [ball_joint] seat.poisson is 0.5; it must"),
        (
            "layer_mm = 1.0\nmodulus_MPa = 2500\npoisson = 0.4\n",
            "",
            "line 10: [ball_joint] clearance_mm needs the compliance of ball or seat",
        ),
        (
            "[ball_joint.seat]",
            "[load]\nspeed_rpm = 1\n[ball_joint.seat]",
            "line 18: section [load]",
        ),
        ("[ball_joint.seat]", "[ball_joint.socket]", "[ball_joint] unknown key 'socket'"),
    ],
)
def test_errors_name_the_line(old: str, new: str, message: str) -> None:
    with pytest.raises(SceneError) as caught:
        BallJointScene.parse(replaced(TEXT, (old, new)), "ball.toml")
    assert str(caught.value).startswith("ball.toml, line ")
    assert message in str(caught.value)


def test_neither_radius_nor_pressure() -> None:
    with pytest.raises(SceneError, match=r"radius_mm is missing; or give allowable_pressure_MPa"):
        BallJointScene.parse("[ball_joint]\nload_N = 5\n")


def test_load_scene_tells_them_apart(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(TEXT)
    assert isinstance(load_scene(path), BallJointScene)
    assert Scene.validate(path) == []
    with pytest.raises(SceneError, match=r"\[driveline\] is missing; .* cardan.scene.load_scene"):
        Scene.load(path)
    path.write_text(replaced(TEXT, ("clearance_mm = 0.01", "clearance_mm = -1")))
    assert len(Scene.validate(path)) == 1
    path.write_text(TEXT + DRIVELINE)
    both = load_scene(path)
    assert isinstance(both, Scene)
    assert both.ball_joint is not None
    with pytest.raises(SceneError, match=r"section \[ball_joint\] is missing"):
        BallJointScene.parse(DRIVELINE)


def test_run_check_plot_and_report(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(TEXT)
    done = scripts.run("run", path, "--into", tmp_path)
    assert done.exit_code == 0, done.output
    assert "uses 97% of what" in " ".join(done.output.split())
    assert (tmp_path / "ball_joint.svg").exists()
    assert scripts.run("check", path).exit_code == 0
    for line in ("plot", "report"):
        out = tmp_path / {"plot": "a.png", "report": "a.html"}[line]
        assert scripts.run(line, path, "--output", out).exit_code == 0
        assert out.exists()
    page = (tmp_path / "a.html").read_text()
    assert "lined with PTFE fabric" in page
    assert "live-module" not in page
    assert "nan" not in page.partition("</style>")[2]
    path.write_text(replaced(TEXT, ("radius_mm = 16", "radius_mm = 12")))
    done = scripts.run("check", path)
    assert done.exit_code == 1
    assert "A ball of 15.7 mm radius is within it" in " ".join(done.output.split())
    for line in ("phase", "explain", "stream"):
        done = scripts.run(line, path)
        assert done.exit_code == 2
        assert done.output.count("\n") == 1


def test_a_joint_beyond_fails_the_check_of_a_good_driveline(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    good = DRIVELINE.replace("10", "1")
    path.write_text(TEXT + good)
    assert scripts.run("check", path).exit_code == 0
    path.write_text(replaced(TEXT, ("radius_mm = 16", "radius_mm = 12")) + good)
    assert scripts.run("check", path).exit_code == 1
    data = json.loads(scripts.run("check", path, "--json").stdout)
    assert (data["verdict"], data["passes"]) == ("beyond", False)
    assert [each["figure"].split(".")[0] for each in data["beyond"]] == ["ball_joint"]


def test_the_picture_shows_the_pressure() -> None:
    case = BallJointScene.parse(TEXT).ball_joint
    figure = plot_ball_joint(case, "Ball")
    section, curve = figure.axes
    theta, pressure = pressure_curve(case)
    drawn = curve.get_lines()[0]
    assert np.allclose(drawn.get_xdata(), np.degrees(theta))
    assert np.allclose(drawn.get_ydata(), 1e-6 * pressure)
    assert pressure.max() == pytest.approx(case.joint.peak_pressure(20e3))
    assert curve.get_ylim()[0] == 0.0
    # What is shaded stands on the ball, whose radius is 1.
    (shade,) = (patch for patch in section.patches if patch.get_alpha() == 0.25)
    across, up = np.asarray(shade.get_path().vertices, dtype=float).T
    radii = np.hypot(across, up)
    assert radii.min() == pytest.approx(1.0, abs=1e-9)
    heights = (
        np.interp(np.arctan2(across, -up), theta, pressure) / pressure.max() * (radii.max() - 1.0)
    )
    assert np.min(np.abs(radii - 1.0 - [[0.0], [1.0]] * heights), axis=0).max() < 1e-3
    legend = curve.get_legend()
    assert legend is not None
    names = [text.get_text() for text in legend.get_texts()]
    assert names == ["pressure on the seat", "without clearance", "allowable for the seat"]
    assert any("20000 N" in text.get_text() for text in section.texts)


def test_the_section_of_the_page_shows_the_pressure() -> None:
    """Over the ball, the outline stands as high as the pressure, and nowhere else."""
    loose = replaced(TEXT, ("clearance_mm = 0.01", "clearance_mm = 0.1"))
    alone = BallJointScene.parse(loose)
    case = alone.ball_joint
    found = ball_joint_figures(case)
    drawing = PART.section(Answer(alone), found)["drawing"]
    outline = np.array([pair.split() for pair in drawing["pressure"][1:-1].split("L")], float)
    inner, outer = outline[: len(outline) // 2], outline[len(outline) // 2 :][::-1]
    # 100 units are the radius of the ball, the load points down.
    theta = np.arctan2(inner[:, 0], inner[:, 1])
    np.testing.assert_allclose(np.hypot(*inner.T), 100.0, atol=0.1)
    assert np.max(np.abs(theta)) == pytest.approx(found.contact_angle, abs=0.02)
    assert found.contact_angle < case.joint.half_angle - 0.05
    pressure = case.joint.pressure(theta, case.load) / found.peak
    np.testing.assert_allclose(np.hypot(*outer.T), 100.0 + 50.0 * pressure, atol=0.2)
    seat = np.array([pair.split() for pair in drawing["seat"][1:-1].split("L")], float)
    widest = np.max(np.abs(np.arctan2(seat[:, 0], seat[:, 1])))
    assert widest == pytest.approx(case.joint.half_angle, abs=1e-3)


@pytest.mark.parametrize(
    ("modulus", "words"),
    [
        (2500, None),
        (100, "is compressed by 20.2% of the thickness of its layer"),
        (10, "exceeds the thickness of its layer, which no layer can do"),
    ],
)
def test_a_layer_that_yields_too_much(modulus: float, words: str | None) -> None:
    text = "[ball_joint]\nload_N = 20000\nradius_mm = 16\nhalf_angle_deg = 60\n"
    text += "clearance_mm = 0.01\n[ball_joint.seat]\nlayer_mm = 1\npoisson = 0.4\n"
    case = BallJointScene.parse(f"{text}modulus_MPa = {modulus}\n").ball_joint
    said = " ".join(PART.sentences(ball_joint_figures(case)))
    assert (words in said) if words else ("layer" not in said)


STEERING_TEXT = """\
[driveline]
bends_deg = [20, 30]
twists_deg = [40]
phases_deg = [10]
[steering]
centre_deg = 25
"""


def figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["steering"]
    assert found is not None
    return found


def test_a_turn_of_the_yoke_leads_to_the_largest_and_to_the_least_ratio() -> None:
    line, one = Scene.parse(STEERING_TEXT).line, figures(STEERING_TEXT)
    ratio = line.evaluate(np.linspace(0.0, np.pi, 721), "speed_ratio").speed_ratio
    ends = {one.turn_to_quick.value: ratio.max(), one.turn_to_slow.value: ratio.min()}
    assert len(ends) == 2
    for turn, extreme in ends.items():
        # Clockwise, looking towards the output, is the sense in which drive angles count.
        there = line.evaluate(np.radians(25.0) + turn, "speed_ratio").speed_ratio
        assert there == pytest.approx(extreme, abs=1e-5)


def test_both_turns_are_named() -> None:
    found = figures(STEERING_TEXT)
    *_, said = PARTS["steering"].sentences(found)
    for turn, ratio in (
        (found.turn_to_quick, "largest straight ahead"),
        (found.turn_to_slow, "least"),
    ):
        sense = "clockwise" if turn.value > 0.0 else "counter-clockwise"
        assert f"by {abs(np.degrees(turn.value)):.2f}° {sense} (ratio {ratio})" in said


def test_the_ratio_to_the_left_and_to_the_right_is_judged() -> None:
    away = np.linspace(0.0, np.pi / 2.0, 9001)
    left, right = (
        Scene.parse(STEERING_TEXT)
        .line.evaluate(np.radians(25.0) + side * away, "speed_ratio")
        .speed_ratio
        for side in (-1.0, 1.0)
    )
    worst = float(np.max(np.abs(left - right)))
    for percent, verdict in ((101.0 * worst, "within"), (99.0 * worst, "beyond")):
        found = figures(f"{STEERING_TEXT}ratio_percent = {percent}\n")
        assert found.difference.value == pytest.approx(worst, rel=1e-6)
        assert found.difference.verdict == verdict
        assert (
            Answer(Scene.parse(f"{STEERING_TEXT}ratio_percent = {percent}\n")).verdict == "beyond"
        )
    assert figures(STEERING_TEXT).difference.verdict == "not judged"


def test_a_perfect_column_is_symmetric_wherever_its_angle_is() -> None:
    """Its equivalent bend is rounding, so an angle of symmetry says nothing."""
    perfect = """
[driveline]
bends_deg = [30, 30]
twists_deg = [180]
phases_deg = [0.0001]
[steering]
centre_deg = 20
offset_deg = 2
ratio_percent = 0.1
"""
    found = figures(perfect)
    assert found.difference.value < 1e-5
    assert (found.offset.value, found.offset.verdict) == (0.0, "within")
    assert list(PARTS["steering"].sentences(found)) == ["Left and right are symmetric."]
    assert figures(perfect.replace("0.0001", "30")).offset.verdict == "beyond"


def test_every_driveline_of_a_study_is_judged() -> None:
    text = """
[driveline]
bends_deg = [30, 12]
phases_deg = [90]
[steering]
offset_deg = 2
[study]
phases_deg.0 = [90, 45, 0]
"""
    found = figures(text)
    assert found.offset.verdict == "beyond"
    assert np.degrees(found.offset.value) == pytest.approx(4.35, abs=0.005)
    assert found.offset.at == {"phases_deg.0": 45.0}
    assert Answer(Scene.parse(text)).verdict == "beyond"


def test_ratio_and_turns_are_those_where_the_column_is_farthest_from_symmetry() -> None:
    text = """[driveline]
    points_mm = [[0, 0, 0], [550, 0, -280], [780, 90, -520], [900, 100, -600]]
    [steering]
    centre_deg = 10
    [states]
    names = ["high", "low"]
    "points_mm.0.z" = [30, -30]
    """
    scene, found = Scene.parse(text), figures(text)
    own = scene.drivelines().steering(np.radians(10.0), drawn=scene.line)
    far = int(np.argmax(np.abs(own.offset)))
    assert (found.offset.state, found.ratio.state) == ("low", "low")
    assert far == 1
    for name in ("ratio", "slope", "turn_to_quick", "turn_to_slow"):
        assert getattr(found, name).value == getattr(own, name)[far]


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
    done = scripts.run("check", tmp_path / "weak.toml")
    assert "not a fair assumption" in done.output
    assert done.exit_code == 0
