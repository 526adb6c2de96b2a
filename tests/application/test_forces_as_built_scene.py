"""Scenes whose joints deviate from their drawing and whose shafts have bearings."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import pyplot

from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import BearingForce, Forces, JointForce, force_figures
from cardan.app.answers.forces.picture import scene_force_paths
from cardan.app.answers.schema import answers_schema, run_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import tolerance_figures
from cardan.app.answers.turn.figures import summary, turn_figures
from cardan.app.command import commands
from cardan.app.plots import plot_force_hodograph, plot_hodograph
from cardan.app.report import write_report
from cardan.app.scene import Scene
from cardan.app.scene.study.curves import columns, study_columns
from example_scenes import example, replaced

ANSWERS = jsonschema.Draft202012Validator(answers_schema())
DRAWN = example("bearings.toml").read_text(encoding="utf-8")
JOINTS = (
    "[joints]\ndriving_yoke_deg = [0.8, 0, -0.5]\ncross_deg = 0.4\ndriven_yoke_deg = [0, 0.6, 0]\n"
)
TEXT = f"{DRAWN}{JOINTS}"
DRAWING = Scene.parse(DRAWN).line
BUILT = DRAWING.with_deviations([0.8, 0.0, -0.5], 0.4, [0.0, 0.6, 0.0], degrees=True)
LOAD = Load(output_torque=1200.0)
TURN = np.arange(7200) * (2.0 * np.pi / 7200)
FORCES = ("joint_force", "bearing_force")
AT = BUILT.evaluate(TURN, FORCES, load=LOAD)


def command(*arguments: str | Path) -> str:
    done = CliRunner().invoke(commands(), [*map(str, arguments)])
    assert done.exit_code in (0, 1), done.output
    return done.stdout


def forces(scene: Scene) -> Forces:
    found: Forces | None = Answer(scene)["forces"]
    assert found is not None
    return found


def each(found: Forces) -> list[JointForce | BearingForce]:
    return [*found.joints, *found.bearings]


def order(values: np.ndarray, number: int) -> float:
    """The largest length of the part of vectors that changes so many times per turn."""
    wave = 2.0 * (values * np.exp(-1j * number * TURN)[:, np.newaxis]).mean(axis=0)
    part = (np.exp(1j * TURN)[:, np.newaxis] * wave).real
    return float(np.linalg.norm(part, axis=-1).max())


def test_curves_and_extremes_are_those_as_built() -> None:
    scene = Scene.parse(TEXT)
    result = scene.run()
    table = columns(result)
    wanted = BUILT.evaluate(scene.drive_angle, FORCES, load=LOAD)
    for name in FORCES:
        for item, force in enumerate(wanted[name]):
            for i, axis in enumerate("xyz"):
                np.testing.assert_allclose(table[f"{name}_{item}_{axis}_N"], force[:, i], atol=1e-9)
    rows = [row for row in summary(result) if row.unit == "N"]
    assert len(rows) == 8
    for row in rows:
        largest = np.linalg.norm(AT[row.quantity][row.item], axis=-1).max()
        assert row.value == pytest.approx(largest, rel=1e-6)


def test_figures_are_those_of_samples_of_a_whole_turn() -> None:
    found = each(forces(Scene.parse(TEXT)))
    drawn = force_figures(DRAWING, LOAD)
    for force, ideal in zip(found, drawn, strict=True):
        values = AT[ideal.output][force.number]
        sizes = np.linalg.norm(values, axis=-1)
        largest = force.largest.value
        assert largest == pytest.approx(sizes.max(), rel=1e-6)
        assert force.at is not None
        assert sizes[round(np.degrees(force.at) * 20) % 7200] == pytest.approx(largest, rel=1e-6)
        assert force.mean == pytest.approx(np.linalg.norm(values.mean(axis=0)), rel=1e-9)
        orders = {1: force.order_1, 2: force.order_2, 4: force.order_4}
        assert orders == pytest.approx({k: order(values, k) for k in orders}, rel=1e-5)
        assert force.order_1 is not None
        assert largest is not None
        assert force.order_1 > 0.01 * largest
        assert ideal.order_1 == 0.0
    # Some forces are largest in the second half of the turn only.
    assert any((force.at or 0.0) > np.pi for force in found)


def test_words_and_answers_have_order_1(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(TEXT, encoding="utf-8")
    found = forces(Scene.parse(TEXT))
    text = PARTS["forces"].text(found)
    assert max(map(len, text.splitlines())) <= 79
    assert " order 1 " in text
    for name, options in (("run", ["--into", str(tmp_path)]), ("check", [])):
        assert text in command(name, path, *options)
        data = json.loads(command(name, path, *options, "--json"))
        ANSWERS.validate(data)
        for entry, force in zip(data["forces"]["bearings"], found.bearings, strict=True):
            assert entry["order_1_N"] == pytest.approx(force.order_1, rel=1e-9)
    scene = Scene.parse(DRAWN)
    assert "order 1" not in PARTS["forces"].text(forces(scene))
    assert {force.order_1 for force in each(forces(scene))} == {None}
    page = tmp_path / "page.html"
    write_report(Scene.parse(TEXT), page)
    words = page.read_text(encoding="utf-8")
    assert "order 1</th>" in words
    said = run_data(Answer(Scene.parse(TEXT)), turn_figures(Scene.parse(TEXT).run()), None, [])
    ANSWERS.validate(said)


def test_paths_are_closed_after_a_whole_turn(tmp_path: Path) -> None:
    paths = scene_force_paths(Scene.parse(TEXT))
    assert len(paths) == 8
    for path in paths:
        sizes = np.linalg.norm(AT[f"{path.per}_force"][path.item], axis=-1)
        np.testing.assert_allclose(
            np.hypot(path.across, path.upwards)[:-1], sizes[::10], rtol=1e-9, atol=1e-9
        )
        assert path.angle_deg[-1] == 360.0
        assert (path.across[0], path.upwards[0]) == pytest.approx(
            (path.across[-1], path.upwards[-1]), abs=1e-9 * path.size
        )
    ideal = scene_force_paths(Scene.parse(DRAWN))
    assert {path.angle_deg[-1] for path in ideal} == {180.0}
    for plot, line in ((plot_force_hodograph, BUILT), (plot_hodograph, BUILT)):
        axes = plot(line, load=LOAD)
        assert 721 in {len(np.asarray(each.get_xdata())) for each in axes.get_lines()}
    pyplot.close("all")
    scene, picture = tmp_path / "scene.toml", tmp_path / "forces.svg"
    scene.write_text(TEXT, encoding="utf-8")
    command("plot", scene, "--what", "forces", "--output", picture)
    assert picture.stat().st_size > 1000


HEIGHTS = (-260.0, -220.0, -180.0)


def lines() -> list[Driveline]:
    found = []
    for height in HEIGHTS:
        y = f"{height}, 0]"
        text = replaced(
            DRAWN, ("[3000, -220, 0]", f"[3000, {y}"), ("[3250, -210, 0]", f"[3250, {y}")
        )
        found.append(Scene.parse(text).line.with_deviations(*BUILT.deviations.T))
    return found


@pytest.mark.parametrize("section", ["study", "states"])
def test_studies_and_states_have_forces_as_built(section: str) -> None:
    key = "points_mm.3-4.y" if section == "study" else '"points_mm.3-4.y"'
    text = TEXT.replace("[joints]", f"[{section}]\n{key} = {[*HEIGHTS]}\n[joints]")
    scene = Scene.parse(text)
    drivelines = lines()
    if section == "study":
        result = scene.run().study
        assert result is not None
        table = study_columns(result)
        for i, line in enumerate(drivelines):
            at = line.evaluate(scene.drive_angle, "bearing_force", load=LOAD).bearing_force
            for item, force in enumerate(at):
                peak = np.linalg.norm(force, axis=-1).max()
                assert table[f"bearing_force_{item}_peak_N"][i] == pytest.approx(peak, rel=1e-9)
        return
    found = forces(scene)
    of_states = [force_figures(line, LOAD) for line in drivelines]
    for i, force in enumerate(each(found)):
        worst = max((figures[i] for figures in of_states), key=lambda one: one.largest)
        assert force.largest.value == pytest.approx(worst.largest, rel=1e-9)
        assert force.order_1 == pytest.approx(worst.order_1, rel=1e-6)


def test_tolerances_of_forces_start_from_the_joints_as_measured() -> None:
    text = f'{TEXT}[tolerances]\ndriven_yoke_deg = 0.2\nof = "bearing_force_2_peak"\nsamples = 50\n'
    found = tolerance_figures(Scene.parse(text))
    assert found is not None
    (figure,) = found.figures
    peak = BUILT.evaluate(TURN[::20], "bearing_force", load=LOAD, reduce="peak").bearing_force[2]
    assert figure.nominal.value == pytest.approx(peak, rel=1e-9)
    corners = [
        BUILT.with_deviations(
            BUILT.deviations[:, 0], BUILT.deviations[:, 1], BUILT.deviations[:, 2] + half
        )
        for half in np.radians(0.2) * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    ]
    worst = max(
        line.evaluate(TURN[::20], "bearing_force", load=LOAD, reduce="peak").bearing_force[2]
        for line in corners
    )
    assert figure.worst.value == pytest.approx(worst, rel=1e-9)
