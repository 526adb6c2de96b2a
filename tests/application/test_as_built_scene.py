"""Scenes whose joints deviate from their drawing."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from cardan import Driveline
from cardan.app.answers.answer import Answer
from cardan.app.answers.as_built import BY_DRAWING, ORDERS, OrderFigures
from cardan.app.answers.schema import check_data, run_data
from cardan.app.answers.tolerances.figures import tolerance_figures
from cardan.app.answers.turn.figures import SummaryRow, summary, turn_figures
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene, SceneError
from example_scenes import ANSWERS, Answers, example

HEAD = "[driveline]\nbends_deg = [8, 8]\n[load]\nspeed_rpm = 3000\ndrive_torque_Nm = 100\n"
JOINTS = "[joints]\ndriving_yoke_deg = [0.143, 0]\ncross_deg = 0.01\n"
OUTPUT = '[output]\nquantities = ["angle_error", "torque", "tilt_driving"]\n'
TEXT = HEAD + JOINTS + OUTPUT
IDEAL = Driveline.from_bends([8.0, 8.0], degrees=True)
BUILT = IDEAL.with_deviations([0.143, 0.0], 0.01, degrees=True)
TURN = np.linspace(0.0, 2.0 * np.pi, 20_001)
SPEED = 100.0 * np.pi


def orders(scene: Scene) -> tuple[OrderFigures, ...]:
    found: tuple[OrderFigures, ...] = Answer(scene)["as_built"]
    return found


def amplitudes(found: tuple[OrderFigures, ...], name: str) -> list[float]:
    return [getattr(each, name).value for each in found]


def command(*arguments: str | Path) -> Result:
    return CliRunner().invoke(commands(), [*map(str, arguments)])


def test_the_curves_are_those_as_built() -> None:
    scene = Scene.parse(TEXT)
    values = scene.run().values
    wanted = BUILT.evaluate(scene.drive_angle, scene.quantities, load=scene.load_case)
    for name, array in wanted.items():
        np.testing.assert_allclose(values[name], array, rtol=0, atol=1e-12, err_msg=name)
    assert not scene.line.has_deviations
    assert "as built" in scene.explain()


def test_the_orders_are_those_of_both_drivelines() -> None:
    found = orders(Scene.parse(TEXT))
    built = BUILT.harmonics(ORDERS, outputs=("angle_error", "acceleration_ratio"))
    assert [(each.order, each.shaft) for each in found] == [(order, 2) for order in ORDERS]
    own = amplitudes(found, "angle_error")
    np.testing.assert_allclose(own, built.angle_error, rtol=1e-9, atol=1e-12)
    faster = amplitudes(found, "acceleration")
    np.testing.assert_allclose(faster, built.acceleration_ratio * SPEED**2, rtol=1e-6, atol=1e-6)
    # Both joints cancel each other on the drawing.
    assert amplitudes(found, "angle_error_drawn") == [0.0] * len(ORDERS)
    assert [each.angle_error_worst for each in found] == [None] * len(ORDERS)
    assert orders(Scene.parse(HEAD)) == ()


def test_extremes_are_those_of_a_whole_turn_as_built() -> None:
    at = BUILT.evaluate(TURN, ("angle_error", "speed_ratio", "acceleration_ratio", "tilt_driving"))
    rows: dict[tuple[str, int, str], SummaryRow] = {
        (row.quantity, row.item, row.statistic): row for row in summary(Scene.parse(TEXT).run())
    }
    wanted = {
        ("angle_error", 2, "peak"): np.degrees(np.abs(at.angle_error)).max(),
        ("speed_ratio", 2, "min"): at.speed_ratio.min(),
        ("speed_ratio", 2, "max"): at.speed_ratio.max(),
        ("acceleration_at_steady_drive", 2, "peak"): (
            np.abs(at.acceleration_ratio).max() * SPEED**2
        ),
        ("tilt_driving", 1, "peak"): np.degrees(np.abs(at.tilt_driving[1])).max(),
    }
    for key, value in wanted.items():
        assert rows[key].value == pytest.approx(value, rel=1e-6), key
    place = rows["angle_error", 2, "peak"].at_drive_angle
    assert place is not None
    size = abs(BUILT.evaluate(np.radians(place), "angle_error").angle_error)
    assert np.degrees(size) == pytest.approx(wanted["angle_error", 2, "peak"], rel=1e-6)


def test_commands_and_report_show_order_1(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(TEXT)
    for name in ("run", "check"):
        text = command(name, path).output
        table = text[text.index("Joints as built: amplitudes by order") :].splitlines()
        assert table[1].split()[:4] == ["order", "1", "order", "2"]
        acceleration = next(row for row in table if row.startswith("  acceleration "))
        assert float(acceleration.split()[1]) == 35.0
        assert BY_DRAWING in " ".join(" ".join(table).split())
    assert "Each extreme recurs every turn." in command("run", path).output
    page = tmp_path / "page.html"
    write_report(Scene.load(path), page)
    for words in ("Joints as built: amplitudes by order of the drive", BY_DRAWING):
        assert words in page.read_text("utf-8")


@pytest.mark.parametrize("radians", [False, True])
def test_answers_have_the_orders(radians: bool) -> None:
    scene = Scene.parse(TEXT)
    data = run_data(Answer(scene), turn_figures(scene.run()), None, [], radians=radians)
    ANSWERS.validate(data)
    first = data["as_built"][0]
    assert (first["shaft"], first["order"]) == (2, 1)
    error = first["angle_error"]["value_rad" if radians else "value_deg"]
    exact = BUILT.harmonics([1], outputs="angle_error").angle_error[0]
    assert error == pytest.approx(exact if radians else np.degrees(exact), rel=1e-9)
    checked = check_data(Answer(scene))
    ANSWERS.validate(checked)
    assert len(checked["as_built"]) == len(ORDERS)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "[joints]\ncross_deg = [1]\n", "cross_deg has length 1; it needs 2"),
        (HEAD + "[joints]\ncross_deg = 95\n", "cross_deg is 95 deg; it must lie between"),
        (HEAD + "[joints]\ncross_deg = 84\n", "the joint cannot turn"),
        (
            TEXT + '[optimise]\nvary = {"phases_deg.0" = "free"}\n',
            "driving_yoke_deg does not go with [optimise], which searches drivelines of ideal",
        ),
        (
            HEAD + "[joints]\ncross_deg = 40\n[study]\nbends_deg.0 = [0, 60]\n",
            "and the deviations in [joints]",
        ),
        (
            HEAD + JOINTS + '[output]\naxes = "shaft"\n',
            "axes is 'shaft'; joints with deviations have 'space' only",
        ),
    ],
)
def test_what_does_not_go_with_deviations_is_refused(text: str, message: str) -> None:
    with pytest.raises(SceneError, match=re.escape(message)):
        Scene.parse(text)


def test_sizes_and_deviations_share_a_section() -> None:
    scene = Scene.parse(HEAD + JOINTS + "rating_Nm = 900\n")
    assert scene.sizes is not None
    assert scene.sizes.each[0].rating == 900.0
    assert Scene.parse(TEXT).sizes is None


MM = HEAD + "[joints]\narm_mm = [40, 50]\ndriving_yoke_mm = [0.1, 0]\ncross_deg = 0.01\n"
TOLERANCED = HEAD + (
    "[tolerances]\ndriving_yoke_mm = 0.1\ndriven_yoke_deg = [0, 0.2]\narm_mm = 40\nsamples = 500\n"
)
HALVES = np.array([[0.0025, 0.0025], [0.0, 0.0], [0.0, np.radians(0.2)]])


def test_millimetres_at_an_arm_are_angles() -> None:
    scene = Scene.parse(MM)
    assert scene.deviations is not None
    want = [[0.1 / 40.0, np.radians(0.01), 0.0], [0.0, np.radians(0.01), 0.0]]
    np.testing.assert_allclose(scene.deviations, want, rtol=1e-15)
    # The arm of a size of joint serves as well, and then the joint rubs.
    sized = MM.replace("[40, 50]", "40\nfriction = 0.05\npin_radius_mm = 8")
    rubbing = Scene.parse(sized)
    assert rubbing.sizes is not None
    assert rubbing.sizes.each[1].arm == 0.04
    assert Scene.parse(MM).sizes is None
    toleranced = Scene.parse(MM + "[tolerances]\ncross_mm = 0.2\nsamples = 9\n").tolerances
    assert toleranced is not None
    np.testing.assert_allclose(toleranced.given["cross"], [0.2 / 40.0, 0.2 / 50.0], rtol=1e-15)


def test_tolerances_of_joints_are_those_of_the_library() -> None:
    scene = Scene.parse(TOLERANCED)
    found = tolerance_figures(scene)
    assert found is not None
    own = IDEAL.tolerances(
        driving_yoke=HALVES[0],
        driven_yoke=HALVES[2],
        of="acceleration_order_1",
        speed=SPEED,
        samples=500,
        seed=0,
    )
    (figure,) = found.figures
    assert figure.name == "acceleration_order_1"
    assert figure.worst.value == pytest.approx(own.worst, rel=1e-12)
    quantiles = (figure.half, figure.most, figure.nearly)
    assert quantiles == pytest.approx(own.quantile([0.5, 0.95, 0.99]), rel=1e-12)
    assert figure.guaranteed is None
    given = {each.group: each for each in found.given}
    assert (given["driving_yoke"].unit, given["driven_yoke"].unit) == ("mm", "deg")
    assert given["driving_yoke"].least == given["driving_yoke"].largest
    assert given["driving_yoke"].largest == pytest.approx(1e-4, rel=1e-12)
    assert given["driven_yoke"].largest == pytest.approx(np.radians(0.2), rel=1e-12)
    still = Scene.parse(TOLERANCED.replace("speed_rpm = 3000\n", "")).tolerances
    assert still is not None
    assert still.of == ("angle_error_order_1",)


def test_figures_of_the_layout_are_those_of_ideal_joints() -> None:
    scene = Scene.parse(TOLERANCED.replace("samples", "phases_deg = 2\nsamples") + JOINTS)
    found = tolerance_figures(scene)
    assert found is not None
    bend, order = found.figures
    alone = IDEAL.tolerances(phases=2.0, degrees=True)
    assert bend.label == "equivalent bend of ideal joints"
    assert bend.worst.value == pytest.approx(alone.worst, rel=1e-12)
    assert bend.guaranteed is not None
    assert bend.guaranteed.value == pytest.approx(alone.guaranteed, rel=1e-12)
    assert [share.label for share in found.shares if share.name == bend.name] == [
        "phase of shaft 1"
    ]
    assert (bend.measured, order.measured) == (False, True)
    first = BUILT.harmonics([1], outputs="acceleration_ratio").acceleration_ratio[0] * SPEED**2
    assert order.nominal.value == pytest.approx(first, rel=1e-9)
    # Parameters of the joints do not count among those over which its worst case is searched.
    four = HEAD.replace("[8, 8]", "[8, 8, 5, 5]") + (
        "[tolerances]\nphases_deg = 2\ncross_deg = 0.1\ndriving_yoke_deg = 0.1\n"
        "driven_yoke_deg = 0.1\nbends_deg = 0.1\nsamples = 9\nof = 'equivalent_bend'\n"
    )
    many = tolerance_figures(Scene.parse(four))
    assert many is not None
    assert many.figures[0].worst_kind == "box"
    only = TOLERANCED.replace("samples", "of = 'equivalent_bend'\nsamples")
    with pytest.raises(SceneError, match=re.escape("of is 'equivalent_bend', a figure of ideal")):
        Scene.parse(only)


def test_the_table_has_the_worst_of_each_order() -> None:
    found = orders(Scene.parse(TOLERANCED))
    assert [each.angle_error_drawn for each in found] == [None] * len(ORDERS)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=4)])
    lines = IDEAL.with_deviations(
        signs[:, :2] * HALVES[0], 0.0, signs[:, 2:] * HALVES[2]
    ).harmonics([1, 3], outputs="angle_error")
    worst = lines.angle_error.max(axis=0)
    own = amplitudes(found, "angle_error_worst")
    np.testing.assert_allclose(own[::2], worst, rtol=1e-9)
    faster = amplitudes(found, "acceleration_worst")
    np.testing.assert_allclose(faster[::2], worst * np.square([1, 3]) * SPEED**2, rtol=1e-9)


@pytest.mark.long
def test_the_example_answers_in_millimetres(answered: Answers) -> None:
    path = example("rumble.toml")
    answer = answered(path)
    for text in (answer.run.text, answer.check.text):
        row = next(row for row in text.splitlines() if row.startswith("  worst acceleration"))
        assert float(row.split()[2]) > 0.0
    text = command("tolerances", path).output
    assert re.search(r"least tolerance, ± +0\.1 mm +0\.1 mm\n", text)
    assert re.search(r"in the middle of the tolerances +35 rad/s²\n", text)
    assert "As measured, the driveline is within the 100 rad/s² limit." in text
    limit = re.search(r"driving yokes are exact to\s±([0-9.]+) mm", text)
    assert limit
    measured = np.array([0.0025, 0.0])
    yokes: dict[str, Any] = {"driving_yoke": float(limit[1]) / 40.0, "driven_yoke": 0.0025}
    found = IDEAL.with_deviations(measured).tolerances(
        **yokes, of="acceleration_order_1", speed=SPEED
    )
    assert 99.5 < found.worst <= 100.0
    data = json.loads(command("tolerances", path, "--json").output)
    ANSWERS.validate(data)
    assert data["permitted"][0]["unit"] == "mm"
    first = answer.data("check")["as_built"][0]
    assert first["acceleration_worst"]["value_rad_s2"] == pytest.approx(
        data["figures"][0]["worst"]["value"], rel=1e-9
    )
    words = answer.page
    assert "worst acceleration" in words
    assert "As measured, the driveline is within the 100 rad/s² limit." in words


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("driving_yoke_mm = 0.1\n", "driving_yoke_mm needs arm_mm"),
        ("driving_yoke_mm = 0.1\ndriving_yoke_deg = 0.1\narm_mm = 40\n", "driving_yoke_mm"),
        ("cross_mm = [0.1]\narm_mm = 40\n", "cross_mm has length 1; it needs 2, one per joint"),
        ("cross_mm = 0.1\narm_mm = [40]\n", "arm_mm has length 1; it needs 2, one per joint"),
        ("driven_yoke_deg = -1\n", "driven_yoke_deg is -1; it must not be negative"),
        ("driven_yoke_mm = 60\narm_mm = 40\n", "driven_yoke_mm and the others permit"),
    ],
)
def test_wrong_tolerances_of_joints_are_refused(text: str, message: str) -> None:
    with pytest.raises(SceneError, match=re.escape(message)):
        Scene.parse(f"{HEAD}[tolerances]\n{text}")


LINES = [Driveline.from_bends([8.0, bend], degrees=True) for bend in (5.0, 8.0, 11.0)]
VARIED = TEXT.replace('"angle_error", "torque", "tilt_driving"', '"angle_error", "torque"')


@pytest.mark.parametrize("section", ["study", "states"])
def test_studies_and_states_have_outputs_as_built(section: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    key = "bends_deg.1" if section == "study" else '"bends_deg.1"'
    path.write_text(f"{VARIED}[{section}]\n{key} = [5, 8, 11]\n")
    scene = Scene.load(path)
    table = scene.run().study
    assert table is not None
    turn = np.asarray(scene.angle)
    for i, line in enumerate(LINES):
        built = line.with_deviations([0.143, 0.0], 0.01, degrees=True)
        at = built.evaluate(turn, ("angle_error", "torque"), load=scene.load_case)
        for name, values in at.items():
            found = table.values[f"{name}_peak"][i]
            assert found == pytest.approx(np.abs(values).max(), rel=1e-12), name
        assert table.values["equivalent_bend"][i] == pytest.approx(line.equivalent().bend, abs=1e-9)
    for name in ("run", "check"):
        assert "Joints as built" in command(name, path).output
    assert command("report", path, "--output", tmp_path / "page.html").exit_code == 0
    assert "as built" in scene.explain()


def test_the_state_with_the_largest_order_1_is_told() -> None:
    text = f'{VARIED}[states]\n"bends_deg.1" = [5, 8, 11]\nnames = ["low", "mid", "high"]\n'
    scene = Scene.parse(text.replace("[0.143, 0]", "[0, 0.143]"))
    found = orders(scene)
    each = [line.with_deviations([0.0, 0.143], 0.01, degrees=True) for line in LINES]
    for i, order in enumerate(ORDERS):
        own = [line.harmonics(order, outputs="angle_error").angle_error for line in each]
        error = found[i].angle_error
        assert [*error.each.values()] == pytest.approx(own, rel=1e-9, abs=1e-12)
        assert error.value == pytest.approx(max(own), rel=1e-9, abs=1e-12)
    assert found[0].angle_error.state == "high"
    data = check_data(Answer(scene))
    ANSWERS.validate(data)
    assert data["as_built"][0]["angle_error"]["state"] == "high"
