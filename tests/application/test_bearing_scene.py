"""Bearings in scenes: what makes them, errors, columns, studies, figures, words, answers."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import (
    BearingForce,
    Forces,
    JointForce,
    force_figures,
)
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import summary
from cardan.app.answers.turn.picture import plot_scene, quantities
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.report.samples import evaluated
from cardan.app.scene import Scene, SceneError, load_scene
from cardan.app.scene.study.cluster import _fingerprint
from cardan.app.scene.study.curves import columns, study_columns
from example_scenes import ANSWERS, SCENES, example, replaced
from pages import near, three

EXAMPLE = example("bearings.toml")
TEXT = EXAMPLE.read_text(encoding="utf-8")

POINTS = np.array([[0, 0, 0], [300, 0, 0], [1500, -60, 0], [3000, -220, 0], [3250, -210, 0]]) / 1e3
BEARINGS = [(0, 0.05), (0, 0.22), (1, 1.05), (3, 0.06), (3, 0.19)]
LOAD = Load(output_torque=1200.0)
LINE = Driveline.from_points(POINTS, phases=[90, 0], degrees=True).with_bearings(BEARINGS)


PART = PARTS["forces"]


def forces(text: str = TEXT) -> Forces:
    found: Forces | None = Answer(Scene.parse(text))["forces"]
    assert found is not None
    return found


def each(found: Forces) -> list[JointForce | BearingForce]:
    return [*found.joints, *found.bearings]


def sizes(found: Forces) -> list[float | None]:
    return [force.largest.value for force in each(found)]


def run(*arguments: str | Path) -> str:
    done = CliRunner().invoke(commands(), [*map(str, arguments)])
    assert done.exit_code in (0, 1), done.output
    return done.stdout


def test_a_scene_has_its_bearings_in_metres() -> None:
    line = Scene.parse(TEXT).line
    assert [shaft for shaft, _ in line.bearings] == [shaft for shaft, _ in BEARINGS]
    positions = [float(position) for _, position in line.bearings]
    np.testing.assert_allclose(positions, [position for _, position in BEARINGS], rtol=1e-15)
    np.testing.assert_allclose(line.lengths().each, LINE.lengths().each, rtol=1e-15)


def test_metres_and_inline_tables_are_the_same() -> None:
    in_m = replaced(TEXT, ("position_mm = 1050", "position_m = 1.05"))
    head, _, rest = TEXT.partition("[[bearing]]")
    inline = ", ".join(f"{{shaft = {k}, position_m = {x}}}" for k, x in BEARINGS)
    for text in (in_m, f"bearing = [{inline}]\n{head}{rest[rest.index('[load]') :]}"):
        SCENES.validate(tomllib.loads(text))
        for (shaft, place), (own, position) in zip(
            Scene.parse(text).line.bearings, BEARINGS, strict=True
        ):
            assert shaft == own
            assert float(place) == pytest.approx(position, rel=1e-15)


def test_two_bearings_in_one_place_but_for_rounding() -> None:
    """300 - 250 and 50 mm differ by rounding, and their forces would be those of nothing."""
    text = replaced(TEXT, ("position_mm = 220", "from_end_mm = 250"))
    with pytest.raises(
        SceneError, match="from_end_mm is 250 mm on shaft 0, the place of bearing 0"
    ):
        Scene.parse(text)
    assert Scene.parse(text.replace("= 250", "= 249.999")).line.n_bearings == 5


def test_columns_are_the_forces_of_the_library() -> None:
    scene = Scene.parse(TEXT)
    table = columns(scene.run())
    want = LINE.evaluate(scene.drive_angle, ("joint_force", "bearing_force"), load=LOAD)
    for name, count in (("joint_force", 3), ("bearing_force", 5)):
        for item in range(count):
            for i, axis in enumerate("xyz"):
                found = table[f"{name}_{item}_{axis}_N"]
                np.testing.assert_allclose(found, want[name][item][:, i], atol=1e-9)
    assert len(table) == 1 + 3 * 8


def test_rows_of_the_table_are_the_largest_over_the_turn() -> None:
    rows = [row for row in summary(Scene.parse(TEXT).run()) if row.unit == "N"]
    assert [(row.per, row.item) for row in rows] == [("joint", i) for i in range(3)] + [
        ("bearing", i) for i in range(5)
    ]
    turn = np.linspace(0, 2 * np.pi, 3601)
    for row in rows:
        values = LINE.evaluate(turn, row.quantity, load=LOAD)[row.quantity][row.item]
        assert row.value == pytest.approx(np.linalg.norm(values, axis=-1).max(), rel=1e-6)
        assert row.at_drive_angle is not None


def test_a_study_moves_points_and_keeps_the_bearings() -> None:
    text = TEXT + (
        'reduce = ["peak", "mean"]\n'
        "[study]\npoints_mm.3-4.y = {from = -220, to = -160, steps = 4}\n"
    )
    scene = Scene.parse(text)
    result = scene.run().study
    assert result is not None
    table = study_columns(result)
    for row, height in enumerate(np.linspace(-220, -160, 4)):
        points = POINTS.copy()
        points[3:, 1] = height / 1e3
        line = Driveline.from_points(points, phases=[90, 0], degrees=True).with_bearings(BEARINGS)
        found = line.evaluate(scene.drive_angle, "bearing_force", load=LOAD).bearing_force
        for item, values in enumerate(found):
            peak = np.linalg.norm(values, axis=-1).max()
            assert table[f"bearing_force_{item}_peak_N"][row] == pytest.approx(peak, rel=1e-12)
            mean = [table[f"bearing_force_{item}_{axis}_mean_N"][row] for axis in "xyz"]
            np.testing.assert_allclose(mean, values[:-1].mean(axis=0), rtol=5e-3, atol=1e-2 * peak)
    assert scene.study is not None
    assert scene.study.planes == 3 * 8


def test_states_have_the_bearings_and_lengths_of_their_points() -> None:
    text = f"{TEXT}[states]\npoints_mm.3-4.y = [-220, -160]\n"
    states = Scene.parse(text).states
    assert states is not None
    line = states.drivelines()
    points = np.array([POINTS, POINTS])
    points[:, 3:, 1] = [[-0.22], [-0.16]]
    wanted = Driveline.from_points(points).with_bearings(BEARINGS)
    np.testing.assert_allclose(line.lengths().each, wanted.lengths().each, rtol=1e-14)
    assert [shaft for shaft, _ in line.bearings] == [shaft for shaft, _ in BEARINGS]


def test_lengths_of_a_driveline_without_points() -> None:
    lengths = LINE.lengths().each
    bends, twists = LINE.bends_deg.tolist(), np.degrees(LINE.twists).tolist()
    head = f"[driveline]\nbends_deg = {bends}\ntwists_deg = {twists}\nphases_deg = [90, 0]\n"
    tables = TEXT[TEXT.index("[[bearing]]") :]
    for key, unit in (("lengths_m", 1.0), ("lengths_mm", 1e3)):
        text = f"{head}{key} = {(unit * lengths).tolist()}\n{tables}"
        SCENES.validate(tomllib.loads(text))
        assert sizes(forces(text)) == pytest.approx(sizes(forces()), rel=1e-9)
    # A floating shaft needs its length and no bearing.
    text = "[driveline]\nbends_deg = [5, 5]\n{}[load]\ndrive_torque_Nm = 9\n"
    text += '[output]\nquantities = ["joint_force"]\n'
    floating = forces(text.format("lengths_m = [1, 2, 1]\n"))
    want = Driveline.from_bends([5, 5], degrees=True).with_bearings([], [1, 2, 1])
    peak = want.evaluate(
        np.linspace(0, np.pi, 181), "joint_force", load=Load(drive_torque=9.0), reduce="peak"
    ).joint_force
    assert sizes(floating) == pytest.approx(peak, rel=1e-9)
    with pytest.raises(SceneError, match="is 'joint_force'; it needs points_mm or points_m, or"):
        Scene.parse(text.format(""))


ERRORS: list[tuple[str, str, str]] = [
    ("shaft = 1 ", "shaft = 4 ", "line 32: [[bearing]][2] shaft is 4; there are 4, counted from 0"),
    (
        "position_mm = 1050",
        "position_mm = 1250",
        "line 33: [[bearing]][2] position_mm is 1250 mm on shaft 1 of length 1201.499064 mm; a "
        "bearing must lie between the joints of its shaft",
    ),
    (
        "position_mm = 220",
        "position_m = 0.4",
        "line 29: [[bearing]][1] position_m is 0.4 m on shaft 0 of length 0.3 m; a bearing must "
        "lie between the end and the joint of its shaft",
    ),
    (
        "position_mm = 220",
        "position_mm = 50",
        "line 29: [[bearing]][1] position_mm is 50 mm on shaft 0, the place of bearing 0",
    ),
]

BROKEN_RULES: list[tuple[str, str, str]] = [
    ("shaft = 1 ", "", "line 31: [[bearing]][2] shaft is missing"),
    (
        "position_mm = 1050",
        "",
        "line 31: [[bearing]][2] position_mm is missing; or give position_m",
    ),
    (
        "position_mm = 1050",
        "position_mm = 1\nposition_m = 1",
        "line 33: [[bearing]][2] position_mm and position_m are both given; give one of them",
    ),
    (
        "position_mm = 1050",
        "position_mm = -1",
        "line 33: [[bearing]][2] position_mm is -1; it must not be negative",
    ),
    (
        "position_mm = 1050",
        "position_cm = 105",
        "line 33: [[bearing]][2] unknown key 'position_cm'; the name includes the unit: "
        "position_mm holds millimetres",
    ),
    (
        "phases_deg = [90, 0]",
        "phases_deg = [90, 0]\nposition_mm = 3",
        "line 22: [driveline] unknown key 'position_mm'; it belongs in [[bearing]]",
    ),
    (
        "phases_deg = [90, 0]",
        "phases_deg = [90, 0]\nlengths_mm = [1, 2, 3, 4]",
        "line 22: [driveline] lengths_mm does not go with points_mm, which says it already",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), ERRORS + BROKEN_RULES)
def test_errors(old: str, new: str, message: str) -> None:
    text = replaced(TEXT, (old, new))
    with pytest.raises(SceneError) as caught:
        Scene.parse(text, "a.toml")
    assert str(caught.value).startswith(f"a.toml, {message}")
    # What needs no geometry the schema knows as well.
    assert SCENES.is_valid(tomllib.loads(text)) == ((old, new, message) in ERRORS)


def test_an_error_has_the_number_of_its_bearing() -> None:
    with pytest.raises(SceneError) as caught:
        Scene.parse(replaced(TEXT, ("position_mm = 1050", "position_mm = 1250")), "a.toml")
    error = caught.value
    assert (error.section, error.argument, error.line) == ("bearing.2", "position_mm", 33)
    assert error.key == "bearing.2.position_mm"


@pytest.mark.parametrize("text", ["[bearing]\nshaft = 0\nposition_mm = 1\n", "bearing = 3\n"])
def test_a_single_section_is_no_array(text: str) -> None:
    whole = f"{text}[driveline]\nbends_deg = [5]\n"
    with pytest.raises(SceneError, match=r"line 1: bearing is .*; it must be sections \[\[bear"):
        Scene.parse(whole)
    assert not SCENES.is_valid(tomllib.loads(whole))


def test_all_wrong_bearings_are_found_at_once(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(replaced(TEXT, ("position_mm = 1050", "position_mm = -1"), ("= 190", "= 'a'")))
    found = Scene.validate(path)
    assert [problem.partition(": ")[2][:14] for problem in found] == [
        "[[bearing]][2]",
        "[[bearing]][4]",
    ]


def test_other_places_that_have_no_bearings(tmp_path: Path) -> None:
    bearing = "[[bearing]]\nshaft = 0\nposition_mm = 3\n"
    with pytest.raises(SceneError, match=r"\[\[bearing\]\]\[0\] shaft has no length; a bearing"):
        Scene.parse(f"[driveline]\nbends_deg = [5]\n{bearing}")
    with pytest.raises(SceneError, match="lengths_m has length 1; it needs 2, one per shaft"):
        Scene.parse(f"[driveline]\nbends_deg = [5]\nlengths_m = [1]\n{bearing}")
    path = tmp_path / "a.toml"
    path.write_text(f"[ball_joint]\nload_N = 3\nradius_mm = 5\n{bearing}")
    with pytest.raises(SceneError, match=r"section \[\[bearing\]\] needs a section \[driveline\]"):
        load_scene(path)


def test_a_study_that_moves_a_joint_over_a_bearing() -> None:
    study = "[study]\npoints_mm.2.x = [1500, 1300]\n"
    with pytest.raises(SceneError) as caught:
        Scene.parse(TEXT + study)
    assert "[study] at points_mm.2.x = 1300: position_mm is 1050 mm on shaft 1 of length" in str(
        caught.value
    )
    assert caught.value.key == "bearing.position_mm"


def test_forces_that_are_not_determinate() -> None:
    text = TEXT.replace("[load]", "[[bearing]]\nshaft = 3\nposition_mm = 240\n[load]")
    reason = "shaft 3 has 3 bearings; forces are determinate with two"
    with pytest.raises(SceneError) as caught:
        Scene.parse(text, "a.toml")
    assert str(caught.value).endswith(f'[output] quantities[1] is "bearing_force"; {reason}')
    found = forces(text.replace(', "bearing_force"', ""))
    assert [force.largest.why for force in found.joints] == [""] * 3
    assert [force.largest.why for force in found.bearings] == [reason] * 6
    assert all(force.largest.value is None for force in found.bearings)
    assert [*PART.sentences(found)] == [f"The forces of the bearings are not known: {reason}."]
    assert PART.data(found)["bearings"][5]["largest"]["why"] == reason


def test_figures_are_those_of_samples() -> None:
    turn = np.arange(7200) * (2 * np.pi / 7200)
    samples = LINE.evaluate(turn, ("joint_force", "bearing_force"), load=LOAD)
    found = forces()
    assert [force.shaft for force in found.bearings] == [k for k, _ in BEARINGS]
    for force in each(found):
        name = "joint_force" if isinstance(force, JointForce) else "bearing_force"
        values = samples[name][force.number]
        lengths = np.linalg.norm(values, axis=-1)
        assert force.largest.value == pytest.approx(lengths.max(), rel=1e-6)
        assert force.at is not None
        at = round(np.degrees(force.at) * 20) % 7200
        assert lengths[at] == pytest.approx(lengths.max(), rel=1e-6)
        assert force.mean == pytest.approx(np.linalg.norm(values.mean(axis=0)), rel=1e-9)
        for order, size in ((2, force.order_2), (4, force.order_4)):
            wave = 2 * (values * np.exp(1j * order * turn)[:, None]).mean(axis=0)
            part = (np.exp(-1j * turn)[:, None] * wave).real
            assert size == pytest.approx(np.linalg.norm(part, axis=-1).max(), rel=1e-5)


def test_words_are_the_figures() -> None:
    text = PART.text(forces())
    assert max(map(len, text.splitlines())) <= 79
    for name in ("largest", "mean", "order 2", "order 4"):
        label = f"{name} force" if name == "largest" else name
        rows = re.findall(rf"(?m)^ +{label}  +(.*)$", text)
        cells = [near(cell) for row in rows for cell in re.split(" {2,}", row)]
        key = name.replace(" ", "_")
        values = [getattr(force, key) for force in each(forces())]
        want = [value.value if name == "largest" else value for value in values]
        assert want == cells
    assert " 1.5708 rad" in PART.text(forces(), radians=True)


TWO = "points_mm.3-4.y = [-260, -220, -180]\n"


@pytest.mark.parametrize("kind", ["states", "study"])
def test_forces_are_judged_in_every_state_and_driveline_of_a_study(kind: str) -> None:
    alone = []
    for height in (-260, -220, -180):
        y = f"{height}, 0]"
        moved = (("[3000, -220, 0]", f"[3000, {y}"), ("[3250, -210, 0]", f"[3250, {y}"))
        alone.append(sizes(forces(replaced(TEXT, *moved))))
    largest = np.max(np.array(alone, dtype=float), axis=0)
    most = [float(np.max(part)) for part in (largest[:3], largest[3:])]
    for factor, verdict in ((1.001, "within"), (0.999, "beyond")):
        limits = "[limits]\nequivalent_bend_deg = 60\n" + "".join(
            f"{name}_force_N = {factor * size}\n"
            for name, size in zip(("joint", "bearing"), most, strict=True)
        )
        answer = Answer(Scene.parse(f"{TEXT}{limits}[{kind}]\n{TWO}"))
        found = answer["forces"]
        assert sizes(found) == pytest.approx(largest, rel=1e-5)
        assert answer.verdict == verdict
        worst = max(each(found), key=lambda force: force.largest.value or 0.0).largest
        assert worst.verdict == verdict
        if kind == "study":
            assert set(worst.at) == {"points_mm.3-4.y"}
        else:
            assert [*worst.each.values()] == pytest.approx(np.array(alone)[:, 3:].max(axis=1))


def test_a_limit_of_forces_that_cannot_be_judged_says_why() -> None:
    text = "[driveline]\nbends_deg = [5, 5]\n[limits]\njoint_force_N = 100\n"
    found = forces(text)
    assert {force.largest.verdict for force in found.joints} == {"not judged"}
    assert found.joints[0].largest.why.startswith("they need points_mm or points_m")
    third = TEXT.replace("[load]", "[[bearing]]\nshaft = 3\nposition_mm = 240\n[load]")
    third = third.replace(', "bearing_force"', "")
    found = forces(f"{third}[limits]\nbearing_force_N = 100\n")
    assert {force.largest.verdict for force in found.bearings} == {"not judged"}
    assert "shaft 3 has 3 bearings" in found.bearings[0].largest.why
    with pytest.raises(SceneError, match=r"bearing_force_N needs a section \[\[bearing\]\]"):
        Scene.parse(text.replace("joint_force", "bearing_force"))


def test_rounding_is_nothing_and_has_no_angle() -> None:
    """A Z arrangement: the floating shaft needs no force, and shafts 0 and 2 turn alike."""
    text = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, -60, 0], [1800, -60, 0]]
[load]
drive_torque_Nm = 1200
[output]
quantities = ["joint_force", "bearing_force"]
"""
    # The closer the bearings, the larger the forces and what rounding leaves of their order 4.
    for shaft, place in ((0, 50), (0, 50.0001), (2, 60), (2, 60.0001)):
        text += f"[[bearing]]\nshaft = {shaft}\nposition_mm = {place}\n"
    scene = Scene.parse(text)
    assert scene.load_case is not None
    raw = force_figures(scene.line, scene.load_case)
    assert all(row.largest > 0.0 and row.places for row in raw)
    assert max(row.order_4 for row in raw) > 1e-8
    found = Answer(scene)["forces"]
    for force in found.joints:
        assert (force.largest.value, force.mean, force.order_2, force.order_4) == (0.0,) * 4
        assert force.at is None
    for force in found.bearings:
        assert min(force.largest.value, force.order_2, force.mean) > 1e6
        assert force.order_4 == 0.0
    rows = [row for row in summary(scene.run()) if row.per == "joint" and row.unit == "N"]
    assert [(row.value, row.at_drive_angle) for row in rows] == [(0.0, None)] * 2
    peaks = [each for each in evaluated(scene).peaks if each.output.name == "joint_force"]
    assert [(each.size, each.at_deg) for each in peaks] == [(0.0, None)] * 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("output_torque_Nm = 1200", "speed_rpm = 100"),
        ("[load]\noutput_torque_Nm = 1200", ""),
    ],
)
def test_no_load_no_forces(old: str, new: str) -> None:
    quantities = 'quantities = ["joint_force", "bearing_force"]'
    assert Answer(Scene.parse(replaced(TEXT, (old, new), (quantities, ""))))["forces"] is None


def test_a_scene_without_bearings_is_silent_on_forces() -> None:
    head, _, rest = TEXT.partition("[[bearing]]")
    text = head + rest[rest.index("[load]") : rest.index("quantities")]
    assert Answer(Scene.parse(text))["forces"] is None


@pytest.mark.parametrize("options", [[], ["--radians"]], ids=["deg", "rad"])
def test_answers(options: list[str], tmp_path: Path) -> None:
    data: Any = json.loads(run("run", EXAMPLE, "--json", *options, "--into", tmp_path))
    ANSWERS.validate(data)
    want = PART.data(forces(), radians=bool(options))
    assert data["forces"] == json.loads(json.dumps(want))
    assert [entry["joint"] for entry in data["forces"]["joints"]] == [0, 1, 2]
    entries = data["forces"]["bearings"]
    assert [entry["bearing"] for entry in entries] == [0, 1, 2, 3, 4]
    assert [entry["shaft"] for entry in entries] == [0, 0, 1, 3, 3]
    unit = "rad" if options else "deg"
    for entry, force in zip(entries, forces().bearings, strict=True):
        assert entry["largest"]["value_N"] == force.largest.value
        assert force.at is not None
        at = force.at if options else np.degrees(force.at)
        assert entry[f"at_{unit}"] == pytest.approx(at)


def test_run_and_check_tell_of_forces(tmp_path: Path) -> None:
    words = PART.text(forces())
    assert words in run("run", EXAMPLE, "--into", tmp_path)
    assert words in run("check", EXAMPLE)
    data = json.loads(run("check", EXAMPLE, "--json"))
    ANSWERS.validate(data)
    assert data["forces"] == json.loads(json.dumps(PART.data(forces())))


def test_pictures_have_a_panel_for_each_component() -> None:
    result = Scene.parse(TEXT).run()
    headings = [panel.heading for panel in quantities(result)]
    assert headings == [
        f"{name} force along {axis} [N]" for name in ("joint", "bearing") for axis in "xyz"
    ]
    figure = plot_scene(result)
    said = " ".join(text.get_text() for text in figure.texts)
    assert "Forces across the driveline have a separate scale." in said
    both = replaced(TEXT, ('"joint_force", ', '"moment", '))
    said = " ".join(text.get_text() for text in plot_scene(Scene.parse(both).run()).texts)
    assert "Moments and forces across the driveline" in said


def test_the_report_has_the_forces(tmp_path: Path) -> None:
    third = "[[bearing]]\nshaft = 3\nposition_mm = 240\n[load]"
    for name, text in (
        ("all", TEXT),
        ("unasked", replaced(TEXT, ('quantities = ["joint_force", "bearing_force"]', ""))),
        ("refused", replaced(TEXT, ("[load]", third), (', "bearing_force"', ""))),
    ):
        path = tmp_path / f"{name}.toml"
        path.write_text(text)
        write_report(Scene.load(path), tmp_path / "a.html")
        page = (tmp_path / "a.html").read_text("utf-8")
        if name == "refused":
            assert (
                "The forces of the bearings are not known: shaft 3 has 3 bearings; forces" in page
            )
            assert "Largest bearing force:" not in page
        else:
            assert "<p>Largest bearing force: bearing 3, shaft 3, 1360 N, at 90.0° of" in page
        cells = "".join(f"<td>{three(size)} N</td>" for size in sizes(forces(text))[:3])  # type: ignore[arg-type]
        assert f'<th scope="row">largest force</th>{cells}' in page
        assert ("Loads of the bearings, largest over a whole turn" in page) == (name == "all")


def test_recorded_bends_have_forces_at_their_samples_and_none_over_a_turn(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("deg,b0,b1\n0,5,6\n10,5.5,6\n20,6,7\n30,,7\n40,6,7\n")
    text = "[driveline]\nlengths_m = [1, 1.5, 1]\n[angles]\nfile = 'a.csv'\n"
    text += "angle_column_deg = 'deg'\nbend_columns_deg = ['b0', 'b1']\n"
    text += "[load]\ndrive_torque_Nm = 9\n[output]\nquantities = ['bearing_force']\n"
    for place in (0.1, 0.6):
        text += f"[[bearing]]\nshaft = 2\nposition_m = {place}\n"
    SCENES.validate(tomllib.loads(text))
    scene = Scene.parse(text, folder=tmp_path)
    assert Answer(scene)["forces"] is None
    found = scene.run().values["bearing_force"]
    for sample, bends in enumerate([(5, 6), (5.5, 6), (6, 7), None, (6, 7)]):
        if bends is None:
            assert np.isnan(found[:, sample]).all()
            continue
        line = Driveline.from_bends(bends, degrees=True)
        line = line.with_bearings([(2, 0.1), (2, 0.6)], [1.0, 1.5, 1.0])
        angle = np.radians(10.0 * sample)
        want = line.evaluate(angle, "bearing_force", load=Load(drive_torque=9.0)).bearing_force
        np.testing.assert_allclose(found[:, sample], want, rtol=1e-12, atol=1e-12)
    write_report(scene, tmp_path / "a.html")
    assert "Loads of the bearings" in (tmp_path / "a.html").read_text("utf-8")


def test_a_moved_bearing_is_another_study_on_a_cluster() -> None:
    study = "[study]\npoints_mm.2.x = [1500, 1510]\n"
    lengths = (
        "[driveline]\nbends_deg = [5, 5]\nlengths_m = [1, 1, {}]\n[study]\nbends_deg = [4, 5]\n"
    )
    moved = replaced(TEXT, ("position_mm = 1050", "position_mm = 1051"))
    for one, other, differ in (
        (TEXT + study, moved + study, "bearings"),
        (lengths.format(1), lengths.format(2), "lengths"),
    ):
        prints = []
        for text in (one, other):
            found = Scene.parse(text).study
            assert found is not None
            prints.append(_fingerprint(found, radians=False))
        assert [key for key in prints[0] if prints[0][key] != prints[1][key]] == [differ]
    assert prints[0]["bearings"] is None


def test_a_place_counts_from_either_end() -> None:
    given = "position_mm = 1050"
    assert given in TEXT
    length = 1e3 * float(LINE.lengths().each[1])
    far = TEXT.replace(given, f"from_end_mm = {length - 1050!r}")
    assert Scene.parse(far).line.bearings[2][1] == pytest.approx(1.05, rel=1e-14)
    # It keeps its distance from that end in states and studies that move a point.
    for section in ("states", "study"):
        moved = Scene.parse(f"{far}[{section}]\npoints_mm.2.x = [1500, 1800]\n")
        if moved.states:
            line = moved.states.drivelines()
        else:
            assert moved.study
            line = next(moved.study.blocks())[1].reshape(2)
        ends = line.lengths().each[:, 1] - line.bearings[2][1]
        np.testing.assert_allclose(ends, 1e-3 * (length - 1050), rtol=1e-12)
    varied = Scene.parse(f"{far}[study]\nbearing.2.from_end_mm = [50, 100]\n").study
    assert varied
    line = next(varied.blocks())[1].reshape(2)
    np.testing.assert_allclose(line.bearings[2][1], length / 1e3 - np.array([0.05, 0.1]))
    with pytest.raises(SceneError, match=r"from_end_mm is 1000000 mm on shaft 1 of length"):
        Scene.parse(TEXT.replace(given, "from_end_mm = 1e6"))
    with pytest.raises(SceneError, match="position_mm and from_end_mm are both given"):
        Scene.parse(TEXT.replace(given, f"{given}\nfrom_end_mm = 3"))
