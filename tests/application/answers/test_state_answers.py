"""Answers of scenes with states: each state as its own scene gives it, the worst by its name."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scripts
from cardan import Driveline
from cardan.app.answers.answer import Answer
from cardan.app.answers.over import check_scene
from cardan.app.scene import Scene, StatesResult
from example_scenes import example
from pages import figure, page_of

EXAMPLES = Path(__file__).parents[3] / "examples"
TRUCK = (EXAMPLES / "ride_heights.toml").read_text(encoding="utf-8")
COLUMN = example("steering-column.toml").read_text(encoding="utf-8")
NON_UNIFORMITY = "non-uniformity U, shaft 2"
HEIGHTS = range(-320, -159, 20)
NAMES = Scene.parse(TRUCK).states.names  # type: ignore[union-attr]


def single(height: int, phases: str = "[90, 0]") -> str:
    """The truck's scene at one height, without states."""
    head, _, tail = TRUCK.partition("[states]")
    output = tail[tail.index("[output]") :].replace('table = "ride_heights.csv"\n', "")
    head = head.replace("[3150, -240, 45]", f"[3150, {height}, 45]")
    head = head.replace("[3450, -262, 45]", f"[3450, {height - 22}, 45]")
    return head.replace("[90, 0]", phases) + output


def run(command: str, text: str, folder: Path, *options: str) -> tuple[int, str]:
    path = folder / "scene.toml"
    # What it draws is judged elsewhere.
    path.write_text(re.sub(r"(?m)^picture = .*$", "", text), encoding="utf-8")
    into = ["--into", str(folder)] if command == "run" else []
    result = scripts.run(command, path, *into, *options)
    return result.exit_code, result.output


def answer(command: str, text: str, folder: Path) -> Any:  # noqa: ANN401 - JSON
    return json.loads(run(command, text, folder, "--json")[1])


def test_figures_of_each_state_are_those_of_its_own_scene(tmp_path: Path) -> None:
    data = answer("run", TRUCK, tmp_path)["states"]
    assert data["names"] == list(NAMES)
    assert [key["key"] for key in data["keys"]] == ["points_mm.3.y", "points_mm.4.y"]
    figures = {figure["column"]: figure for figure in data["figures"]}
    closed = 'closed_forms = ["equivalent_bend", "non_uniformity", "max_angle_error"]\n'
    for i, height in enumerate(HEIGHTS):
        text = single(height) + closed + 'reduce = ["peak"]\nquantities = ["torque", "moment"]\n'
        study = Scene.parse(text).run().study
        assert study
        for column in study.columns:
            ending, value = study.figure(column, radians=False)
            assert figures[f"{column.name}{ending}"]["values"][i] == float(value)
    bends = figures["equivalent_bend_deg"]
    assert bends["largest"] == {"value": max(bends["values"]), "state": "bump +80 mm"}
    assert bends["least"]["state"] == NAMES[int(np.argmin(bends["values"]))]


def test_the_table_has_a_row_per_state(tmp_path: Path) -> None:
    assert run("run", TRUCK, tmp_path)[0] == 0
    with open(tmp_path / "ride_heights.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["state"]) for row in rows] == list(range(9))
    assert [float(row["points_mm.3.y"]) for row in rows] == list(HEIGHTS)
    assert [float(row["points_mm.4.y"]) for row in rows] == [height - 22 for height in HEIGHTS]
    table = Scene.parse(TRUCK).run().study
    assert isinstance(table, StatesResult)
    assert [float(row["non_uniformity"]) for row in rows] == table.values["non_uniformity"].tolist()


def test_check_judges_every_state_and_names_the_worst(tmp_path: Path) -> None:
    status, text = run("check", TRUCK, tmp_path)
    assert status == 1
    assert text.startswith("Beyond its limit: the equivalent bend.")
    assert " in bump +80 mm, " in text
    data = answer("check", TRUCK, tmp_path)
    for state, height in zip(data["states"], HEIGHTS, strict=True):
        own = answer("check", single(height), tmp_path)["limits"]["equivalent_bend"]
        assert state["equivalent_bend_deg"] == own["value_deg"]
        assert state["verdict"] == own["verdict"]
    assert data["limits"]["equivalent_bend"]["state"] == "bump +80 mm"
    assert len(data["limits"]["equivalent_bend"]["states"]) == len(HEIGHTS)
    assert not data["passes"]
    turned = TRUCK.replace("[90, 0]", "[30, 10]")
    assert run("check", turned, tmp_path)[0] == 0


def test_a_state_has_its_bends_and_what_is_beyond_besides(tmp_path: Path) -> None:
    text = (
        "[driveline]\nbends_deg = [3, 5]\n[load]\nspeed_rpm = 6000\n"
        "[limits]\nequivalent_bend_deg = 7\ntorsional_excitation_rad_s2 = 100\n"
        "bend_difference_deg = 3\n[states]\nbends_deg.0 = [5, 3, 1]\n"
        'names = ["even", "apart", "far"]\n'
    )
    status, said = run("check", text, tmp_path)
    assert status == 1
    _, _, table = said.partition("Motion in each state\n")
    rows = [re.split("  +", line.strip()) for line in table.split("\n\n")[0].splitlines()]
    # Three columns are too wide.
    tables = {row[0]: rows[i + 2 : i + 5] for i, row in enumerate(rows) if len(row) == 1}
    assert tables["even"][:2] == [["bends", "5.00°, 5.00°"], ["verdict", "within"]]
    assert tables["apart"][0] == ["bends", "3.00°, 5.00°"]
    assert tables["apart"][2] == ["beyond", "torsional excitation"]
    assert tables["far"][2] == ["beyond", "bend difference, torsional excitation"]


def test_speeds_of_states_are_checked_with_their_own_state() -> None:
    text = (
        "[driveline]\nbends_deg = 5\n[load]\nspeed_rpm = 100\n"
        '[states]\nbends_deg = [5, 10]\nspeed_rpm = [3000, 1000]\nnames = ["a", "b"]\n'
    )
    found = {f.figure: f for f in check_scene(Scene.parse(text)).findings}["torsional_excitation"]
    exact = [
        float(line.check(rpm * np.pi / 30.0).findings[1].value)
        for line, rpm in (
            (Driveline.from_bends([5], degrees=True), 3000.0),
            (Driveline.from_bends([10], degrees=True), 1000.0),
        )
    ]
    np.testing.assert_allclose(found.value, exact, rtol=1e-13)
    assert found.worst_in == "ab"[int(np.argmax(exact))]


def test_forces_are_those_of_the_worst_state() -> None:
    found = Answer(Scene.parse(TRUCK))["forces"]
    assert found
    alone = [Answer(Scene.parse(single(height)))["forces"] for height in HEIGHTS]
    for kind in ("joints", "bearings"):
        for i, force in enumerate(getattr(found, kind)):
            largest = [getattr(own, kind)[i].largest.value for own in alone]
            assert force.largest.value == max(largest)
            assert force.largest.each == dict(zip(NAMES, largest, strict=True))
            worst = int(np.argmax(largest))
            assert force.largest.state == NAMES[worst]
            assert force.order_2 == getattr(alone[worst], kind)[i].order_2


def test_phase_gives_one_setting_for_all_states(tmp_path: Path) -> None:
    data = answer("phase", TRUCK, tmp_path)
    assert [tooth["phase_deg"] for tooth in data["teeth"]] == pytest.approx([30, 10])
    # From 90 deg to 30 deg and from 0 deg to 10 deg, with 36 teeth.
    turns = [(t["turn_teeth"], t["turn_deg"], t["turn_sense"]) for t in data["teeth"]]
    assert turns == [(6, 60.0, "counter-clockwise"), (1, 10.0, "clockwise")]
    for key, phases in (("present", "[90, 0]"), ("on_teeth", "[30, 10]")):
        for i, height in enumerate(HEIGHTS):
            own = Scene.parse(single(height, phases)).line.equivalent().bend_deg
            bend = data["states"]["equivalent_bend_deg"][key][i]
            np.testing.assert_allclose(bend, own, rtol=1e-9)
        bends = data["states"]["equivalent_bend_deg"][key]
        assert data["equivalent_bend_deg"][key] == max(bends)
        assert data["states"]["worst"][key] == NAMES[int(np.argmax(bends))]
    assert (data["cause"], data["above_limits"]) == ("phases", [])
    text = run("phase", TRUCK, tmp_path)[1]
    assert "On these teeth the driveline passes the check in every state." in text
    assert "at most 2.83° in bump +80 mm" in text


@pytest.mark.parametrize(("bend", "worst", "name"), [(5, "high", "W"), (3, "low", "Z")])
def test_the_arrangement_is_that_of_the_worst_state(
    tmp_path: Path, bend: int, worst: str, name: str
) -> None:
    """The joints of [driveline] are straight; of the states one is a Z, one a W."""
    text = (
        "[driveline]\nbends_deg = [0, 0]\ntwists_deg = [0]\nphases_deg = [90]\n"
        "[states]\nnames = ['level', 'low', 'high']\n"
        f"bends_deg.0 = [0, 4, {bend}]\nbends_deg.1 = [0, 4, {bend}]\ntwists_deg.0 = [0, 180, 0]\n"
    )
    assert answer("phase", text, tmp_path)["arrangement"] == name
    said = run("phase", text, tmp_path)[1]
    assert said.startswith(f"{name} arrangement (in {worst}): the bends lie in one plane, in ")
    assert "The best setting has the least weighted mean over the states" in said


def test_weights_move_the_setting_towards_a_state(tmp_path: Path) -> None:
    weights = "weights = [0.2, 0.5, 1, 2, 4, 2, 1, 0.5, 0.2]"
    last = TRUCK.replace(weights, "weights = [0, 0, 0, 0, 0, 0, 0, 0, 1]")
    bends = answer("phase", last, tmp_path)["states"]["equivalent_bend_deg"]["best"]
    own = Scene.parse(single(HEIGHTS[-1])).line
    least = own.with_phases(own.optimal_phases()).equivalent().bend_deg
    np.testing.assert_allclose(bends[-1], least, atol=1e-5)
    on_teeth = answer("phase", last, tmp_path)["states"]["equivalent_bend_deg"]["on_teeth"]
    steps = np.radians(np.arange(0, 180, 10))
    settings = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    np.testing.assert_allclose(
        on_teeth[-1], np.min(own.with_phases(settings).equivalent().bend_deg), rtol=1e-9
    )


def test_a_setting_that_not_every_state_passes_is_named(tmp_path: Path) -> None:
    fixed = TRUCK.replace("teeth = 36", "teeth = 1")
    data = answer("phase", fixed, tmp_path)
    assert data["states"]["equivalent_bend_deg"]["on_teeth"] == pytest.approx(
        data["states"]["equivalent_bend_deg"]["present"]
    )
    assert len(data["above_limits"]) == 1
    assert "in bump +80 mm" in data["above_limits"][0]
    text = run("phase", fixed, tmp_path)[1]
    assert "On these teeth the driveline does not pass the check in every state:" in text


def test_states_that_set_the_yokes_have_no_common_setting(tmp_path: Path) -> None:
    text = "[driveline]\nbends_deg = [5, 6]\n[states]\nphases_deg = [0, 90]\n"
    status, said = run("phase", text, tmp_path)
    assert status == 2
    assert "[states] gives phases_deg; one setting can serve all states only if" in said
    assert run("check", text, tmp_path)[0] == 1
    # One turn for all states is then no advice.
    assert "Turn the output-side yoke" not in run("check", text, tmp_path)[1]


def test_steering_over_the_tilt_of_a_column() -> None:
    """Against pins carried by a rotation matrix, and ratios to the left and to the right."""
    scene = Scene.parse(COLUMN)
    found = Answer(scene)["steering"]
    assert found
    lines, drawn = scene.drivelines(), scene.line
    normal, along = drawn.normals[0], drawn.directions[0]
    centre = np.radians(10)
    pin = np.cos(centre) * np.cross(normal, along) + np.sin(centre) * normal
    for i, name in enumerate(found.offset.each):
        # The column tilts about the lateral axis y, which is square to it in every state.
        tilted = lines.directions[i, 0]
        angle = np.arctan2(along[2], along[0]) - np.arctan2(tilted[2], tilted[0])
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]) @ pin
        own = lines.normals[i, 0]
        at = np.arctan2(turned @ own, turned @ np.cross(own, tilted))
        ratio = lines[i].evaluate(at, "speed_ratio").speed_ratio
        np.testing.assert_allclose(found.ratio.each[name], ratio, rtol=1e-12)
        away = np.linspace(0, 3, 31)
        turns = (found.turn_to_quick.each[name], found.turn_to_slow.each[name])
        symmetric = at + min(turns, key=abs)
        assert found.offset.each[name] == min(map(abs, turns))
        left, right = (
            lines[i].evaluate(symmetric + sign * away, "speed_ratio").speed_ratio
            for sign in (-1, 1)
        )
        np.testing.assert_allclose(left, right, rtol=1e-11)
    assert found.offset.verdict == "beyond"
    assert found.offset.state == "low"


def test_states_without_names_have_the_values_of_their_key(tmp_path: Path) -> None:
    """Those that fall have them as names."""
    text = "[driveline]\nbends_deg = [5, 6]\nphases_deg = 0\n[states]\n"
    falling = figure(page_of(f"{text}phases_deg.0 = [3, 1, -2]\n", tmp_path), NON_UNIFORMITY)
    assert falling["names"] == ["3", "1", "\N{MINUS SIGN}2"]
    assert falling["named"] == "phase, shaft 1 [deg]"
    rising = figure(page_of(f"{text}phases_deg.0 = [-2, 1, 3]\n", tmp_path), NON_UNIFORMITY)
    assert (rising["names"], rising["over"]) == ([], "phase, shaft 1 [deg]")
    assert rising["x"] == [-2.0, 1.0, 3.0]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("[study]\npoints_mm.2.y = [0, 1]\n", "sections [study] and [states] are both given; a "),
        ("[states]\npoints_mm.2.y = []\n", "line 2: [states] points_mm.2.y is []"),
    ],
)
def test_what_does_not_go_with_states(more: str, message: str) -> None:
    text = "[driveline]\npoints_mm = [[0, 0, 0], [1, 0, 0], [2, 1, 0]]\n"
    if "study" in more:
        more += "[states]\npoints_mm.2.y = [0, 1]\n"
    with pytest.raises(ValueError, match="states") as caught:
        Scene.parse(text + more)
    assert message.split(": ")[-1] in str(caught.value)


def test_a_cluster_takes_studies_only(tmp_path: Path) -> None:
    text = TRUCK.replace("ride_heights.csv", "ride_heights.parquet")
    status, said = run("run", text, tmp_path, "--local", "1")
    assert status == 2
    assert "states are evaluated in one process; only a study is distributed" in said


def test_a_run_says_what_is_of_the_driveline_alone(tmp_path: Path) -> None:
    status, text = run("run", TRUCK, tmp_path)
    assert status == 0
    before, note, after = text.partition("above are those of [driveline]; the states follow.\n")
    assert note
    assert "Over a whole turn" in before
    assert "Largest over the states" in after
    assert "[driveline]" not in run("run", single(-240), tmp_path)[1]


def test_a_constant_drive_speed_is_judged_in_the_worst_state(tmp_path: Path) -> None:
    inertias = "inertias_kgm2 = [0.5, 0.1, 0.2, 0.3]\n"
    text = TRUCK.replace("[load]\n", f"[load]\n{inertias}")
    data = answer("check", text, tmp_path)["drive_speed"]
    each = [
        answer("check", single(height).replace("[load]\n", f"[load]\n{inertias}"), tmp_path)
        for height in HEIGHTS
    ]
    needed = [one["drive_speed"]["needed_kgm2"] for one in each]
    worst = int(np.argmax(needed))
    assert data == each[worst]["drive_speed"] | {"state": NAMES[worst]}
    assert f", judged in {NAMES[worst]}\n" in run("check", text, tmp_path)[1]
