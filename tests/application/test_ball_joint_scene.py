"""Scenes with a ball joint: figures, verdict, errors with lines, picture, page, answers."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from cardan import BallJoint, Scene
from cardan.app.answers.answer import Answer
from cardan.app.answers.ball_joint import ball_joint_figures, pressure_curve
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.plots import plot_ball_joint
from cardan.app.report import write_report
from cardan.app.scene import BallJointScene, load_scene
from cardan.app.scene.language.errors import SceneError
from cardan.ball_joint import layer_compliance
from example_scenes import ANSWERS, SCENES, example, replaced
from pages import curves, figure, three

TEXT = example("ball_joint.toml").read_text(encoding="utf-8")
DRIVELINE = "[driveline]\nbends_deg = [10]\n[load]\nspeed_rpm = 60\noutput_torque_Nm = 5\n"


PART = PARTS["ball_joint"]


def command(*arguments: str | Path) -> Any:  # noqa: ANN401 - click's result
    return CliRunner().invoke(commands(), list(map(str, arguments)))


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
    text = "[ball_joint]\nload_N = 1000\nradius_mm = 10\n"
    found = ball_joint_figures(BallJointScene.parse(text).ball_joint)
    assert found.peak == pytest.approx(1.5 * found.projected_pressure, rel=1e-13)
    assert found.peak == pytest.approx(3 * 1000 / (2 * math.pi * 0.01**2), rel=1e-13)
    assert found.edge_pressure == 0.0
    assert found.seat_pressure.verdict == "not judged"
    assert (found.allowable_load, found.turning_friction) == (None, None)


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


def test_the_reader_and_the_schema_agree(tmp_path: Path) -> None:
    SCENES.validate(tomllib.loads(TEXT))
    SCENES.validate(tomllib.loads(TEXT + DRIVELINE))
    for wrong in (
        replaced(TEXT, ("load_N = 20000", "")),
        replaced(TEXT, ("modulus_MPa = 2500", "")),
        replaced(TEXT, ("layer_mm = 1.0", "compliance_um_per_MPa = 1")),
        TEXT + "[load]\nspeed_rpm = 3\n",
    ):
        assert not SCENES.is_valid(tomllib.loads(wrong))


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
    done = command("run", path, "--into", tmp_path)
    assert done.exit_code == 0, done.output
    assert "uses 97% of what" in " ".join(done.output.split())
    assert (tmp_path / "ball_joint.svg").exists()
    assert command("check", path).exit_code == 0
    for line in ("plot", "report"):
        out = tmp_path / {"plot": "a.png", "report": "a.html"}[line]
        assert command(line, path, "--output", out).exit_code == 0
        assert out.exists()
    page = (tmp_path / "a.html").read_text()
    assert "lined with PTFE fabric" in page
    assert "live-module" not in page
    assert "nan" not in page.partition("</style>")[2]
    path.write_text(replaced(TEXT, ("radius_mm = 16", "radius_mm = 12")))
    done = command("check", path)
    assert done.exit_code == 1
    assert "A ball of 15.7 mm radius is within it" in " ".join(done.output.split())
    for line in ("phase", "explain", "stream"):
        done = command(line, path)
        assert done.exit_code == 2
        assert done.output.count("\n") == 1


def test_answers(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    for text, keys in (
        (TEXT, {"answer", "version", "title", "ball_joint", "files"}),
        (TEXT + DRIVELINE, {"rows", "drive_angles", "ball_joint", "files"}),
    ):
        path.write_text(text)
        for options in ([], ["--radians"]):
            data = json.loads(command("run", path, "--into", tmp_path, "--json", *options).stdout)
            ANSWERS.validate(data)
            assert keys <= data.keys()
            angle = "half_angle_rad" if options else "half_angle_deg"
            expected = math.radians(60) if options else 60
            assert data["ball_joint"][angle] == pytest.approx(expected)
        checked = json.loads(command("check", path, "--json").stdout)
        ANSWERS.validate(checked)
        assert checked["verdict"] == "within" or "driveline" in text
        pressure = checked["ball_joint"]["seat_pressure"]
        assert pressure["value_MPa"] == pytest.approx(60 - 2.063, abs=0.001)
        assert (pressure["limit_MPa"], pressure["verdict"]) == (60, "within")
    assert not ANSWERS.is_valid({k: v for k, v in data.items() if k not in ("rows", "ball_joint")})
    assert not ANSWERS.is_valid({k: v for k, v in data.items() if k != "rows"})


@pytest.mark.parametrize("name", ["run", "check"])
def test_the_ball_joint_of_a_driveline_is_printed(name: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(TEXT + DRIVELINE)
    section = PART.text(ball_joint_figures(BallJointScene.parse(TEXT).ball_joint))
    options: list[str | Path] = ["--into", tmp_path] if name == "run" else []
    assert command(name, path, *options).output.count(f"\n\n{section}\n") == 1


def test_the_answer_has_the_figures_of_the_scene(tmp_path: Path) -> None:
    case = BallJointScene.parse(TEXT).ball_joint
    data = PART.data(ball_joint_figures(case))
    given = tomllib.loads(TEXT)["ball_joint"]
    for key in ("load_N", "radius_mm", "clearance_mm", "half_angle_deg"):
        assert data[key] == pytest.approx(given[key])
    for part in ("ball", "seat"):
        limit = data[f"{part}_pressure"]["limit_MPa"]
        assert limit == pytest.approx(given[part]["allowable_pressure_MPa"])
    # The page has the lower one as a line over the whole seat.
    write_report(BallJointScene.parse(TEXT), tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    drawn = curves(figure(page, "Pressure on the seat [MPa]"))
    theta, pressure = pressure_curve(case)
    line = drawn["pressure on the seat"]
    want = 1e-6 * np.interp(np.radians(line[:, 0]), theta, pressure)
    assert line[:, 1] == pytest.approx(want, abs=1.0)
    assert drawn["allowable for the seat"][:, 1] == pytest.approx(60.0, abs=0.5)


def test_a_joint_beyond_fails_the_check_of_a_good_driveline(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    good = DRIVELINE.replace("10", "1")
    path.write_text(TEXT + good)
    assert command("check", path).exit_code == 0
    path.write_text(replaced(TEXT, ("radius_mm = 16", "radius_mm = 12")) + good)
    assert command("check", path).exit_code == 1
    data = json.loads(command("check", path, "--json").stdout)
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


def test_arrows_on_the_page_are_as_long_as_the_pressure() -> None:
    alone = BallJointScene.parse(TEXT)
    case = alone.ball_joint
    drawing = PART.section(Answer(alone), ball_joint_figures(case))["drawing"]

    def points(path: str) -> np.ndarray:
        return np.array([pair.split() for pair in path.strip("MZ").split("L")], float)

    radii = np.hypot(*points(drawing["ball"]).T)
    assert np.ptp(radii) < 0.2
    theta, pressure = pressure_curve(case)
    assert len(drawing["arrows"]) > 4
    for arrow in drawing["arrows"]:
        foot, head = points(arrow)
        # From the surface of the ball outwards; the load points down.
        assert np.hypot(*foot) == pytest.approx(radii[0], abs=0.2)
        np.testing.assert_allclose(foot / np.hypot(*foot), head / np.hypot(*head), atol=0.01)
        angle = np.arctan2(foot[0], foot[1])
        share = np.interp(angle, theta, pressure) / pressure.max()
        longest = max(np.hypot(*np.diff(points(each), axis=0)[0]) for each in drawing["arrows"])
        assert np.hypot(*(head - foot)) == pytest.approx(share * longest, rel=0.03)


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


def test_a_report_of_both(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(TEXT + DRIVELINE)
    write_report(load_scene(path), tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert '<a href="#ball_joint">Ball joint</a>' in page
    assert page.count("Pressure on the seat, in section") == 1
    path.write_text(DRIVELINE)
    write_report(load_scene(path), tmp_path / "a.html")
    assert "ball_joint" not in (tmp_path / "a.html").read_text()


def test_titles_are_escaped(tmp_path: Path) -> None:
    text = replaced(TEXT, ('title = "Ball joint under a column"', 'title = "<b>&"'))
    scene = BallJointScene.parse(text)
    write_report(scene, tmp_path / "a.html")
    assert "<b>&" not in (tmp_path / "a.html").read_text()
    assert "&lt;b&gt;&amp;" in (tmp_path / "a.html").read_text()


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
