"""Scenes whose joints deviate from their drawing."""

from __future__ import annotations

import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner, Result

from cardan import Driveline
from cardan.command import commands
from cardan.figures.as_built import ORDERS, as_built_orders
from cardan.figures.limits import check_data, check_scene
from cardan.figures.run import run_data
from cardan.figures.schema import answers_schema
from cardan.figures.summary import SummaryRow, summary
from cardan.report import write_report
from cardan.scene import Scene, SceneError

ANSWERS = jsonschema.Draft202012Validator(answers_schema())
HEAD = "[driveline]\nbends_deg = [8, 8]\n[load]\nspeed_rpm = 3000\ndrive_torque_Nm = 100\n"
JOINTS = "[joints]\ndriving_yoke_deg = [0.143, 0]\ncross_deg = 0.01\n"
OUTPUT = '[output]\nquantities = ["angle_error", "torque", "tilt_driving"]\n'
TEXT = HEAD + JOINTS + OUTPUT
IDEAL = Driveline.from_bends([8.0, 8.0], degrees=True)
BUILT = IDEAL.with_deviations([0.143, 0.0], 0.01, degrees=True)
TURN = np.linspace(0.0, 2.0 * np.pi, 20_001)
SPEED = 100.0 * np.pi


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
    (found,) = as_built_orders(Scene.parse(TEXT))
    built = BUILT.harmonics(ORDERS, outputs=("angle_error", "acceleration_ratio"))
    assert found.shaft == 2
    np.testing.assert_allclose(found.angle_error[0], built.angle_error, rtol=1e-9, atol=1e-12)
    assert found.acceleration is not None
    np.testing.assert_allclose(
        found.acceleration[0], built.acceleration_ratio * SPEED**2, rtol=1e-6, atol=1e-6
    )
    # Both joints cancel each other on the drawing.
    assert np.array_equal(found.angle_error[1], np.zeros(len(ORDERS)))
    assert as_built_orders(Scene.parse(HEAD)) == []


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
    place = rows["angle_error", 2, "peak"].at_deg
    assert place is not None
    size = abs(BUILT.evaluate(np.radians(place), "angle_error").angle_error)
    assert np.degrees(size) == pytest.approx(wanted["angle_error", 2, "peak"], rel=1e-6)


def test_commands_and_report_show_order_1(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(TEXT)
    for name in ("run", "check"):
        text = command(name, path).output
        table = text[text.index("Joints as built") :].splitlines()
        assert table[0].split()[-8:] == [word for order in ORDERS for word in ("order", str(order))]
        acceleration = next(row for row in table if "acceleration [rad/s²]" in row)
        assert float(acceleration.split()[-4]) == pytest.approx(34.6, abs=0.1)
        assert "Equivalent bend, non-uniformity and limits are those of the drawing." in table
    assert "Each extreme recurs every turn." in command("run", path).output
    page = tmp_path / "page.html"
    write_report(Scene.load(path), page)
    caption = "Joints as built: amplitudes by order of the drive. Equivalent bend"
    assert caption in page.read_text("utf-8")


@pytest.mark.parametrize("radians", [False, True])
def test_answers_have_the_orders(radians: bool) -> None:
    scene = Scene.parse(TEXT)
    data = run_data(scene, summary(scene.run()), None, [], radians=radians)
    ANSWERS.validate(data)
    first = data["as_built"][0]
    assert (first["shaft"], first["order"]) == (2, 1)
    error = first["as_built"]["angle_error_rad" if radians else "angle_error_deg"]
    exact = BUILT.harmonics([1], outputs="angle_error").angle_error[0]
    assert error == pytest.approx(exact if radians else np.degrees(exact), rel=1e-9)
    checked = check_data(scene, check_scene(scene))
    ANSWERS.validate(checked)
    assert len(checked["as_built"]) == len(ORDERS)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "[joints]\ncross_deg = [1]\n", "cross_deg has length 1; it needs 2"),
        (HEAD + "[joints]\ncross_deg = 95\n", "cross_deg is 95 deg; it must lie between"),
        (HEAD + "[joints]\ncross_deg = 84\n", "the joint cannot turn"),
        (
            TEXT + "[study]\nphases_deg.0 = [0, 90]\n",
            "driving_yoke_deg does not go with [study]",
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
    assert scene.service.joints is not None
    assert scene.service.joints.each[0].rating == 900.0
    assert Scene.parse(TEXT).service.joints is None
