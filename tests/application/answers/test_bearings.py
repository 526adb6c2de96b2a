"""Bearings in scenes: what makes them, errors, columns, studies, figures and pictures."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon

import scripts
from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import (
    BearingForce,
    Forces,
    JointForce,
    force_figures,
)
from cardan.app.answers.forces.picture import force_paths, scene_force_paths
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import summary
from cardan.app.command import commands
from cardan.app.pictures.driveline import _BEARING
from cardan.app.pictures.space import View
from cardan.app.plots import plot_driveline, plot_force_hodograph, plot_forces
from cardan.app.report import write_report
from cardan.app.report.results import inputs
from cardan.app.report.samples import evaluated
from cardan.app.scene import Scene, SceneError, load_scene
from example_scenes import SCENES, example, replaced

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
    done = scripts.run(*arguments)
    assert done.exit_code in (0, 1), done.output
    return done.stdout


def test_two_bearings_in_one_place_but_for_rounding() -> None:
    """300 - 250 and 50 mm differ by rounding, and their forces would be those of nothing."""
    text = replaced(TEXT, ("position_mm = 220", "from_end_mm = 250"))
    with pytest.raises(
        SceneError, match="from_end_mm is 250 mm on shaft 0, the place of bearing 0"
    ):
        Scene.parse(text)
    assert Scene.parse(text.replace("= 250", "= 249.999")).line.n_bearings == 5


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


@pytest.mark.parametrize("text", ["[bearing]\nshaft = 0\nposition_mm = 1\n", "bearing = 3\n"])
def test_a_single_section_is_no_array(text: str) -> None:
    whole = f"{text}[driveline]\nbends_deg = [5]\n"
    with pytest.raises(SceneError, match=r"line 1: bearing is .*; it must be sections \[\[bear"):
        Scene.parse(whole)
    assert not SCENES.is_valid(tomllib.loads(whole))


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


def test_scenes_give_forces_in_newtons_whatever_the_unit_of_their_points() -> None:
    points = [[0, 0, 0], [300, 0, 0], [1500, -60, 20], [1800, -20, 30]]
    scene = """
    [driveline]
    {key} = {points}
    [load]
    output_torque_Nm = 100
    [output]
    quantities = ["joint_force"]
    """
    in_mm = Scene.parse(scene.format(key="points_mm", points=points))
    in_m = Scene.parse(scene.format(key="points_m", points=(np.array(points) / 1e3).tolist()))
    line = Driveline.from_points(np.array(points) / 1e3)
    turn = in_m.drive_angle
    want = line.evaluate(turn, "joint_force", load=Load(output_torque=100.0)).joint_force
    size = np.abs(want).max()
    for found in (in_mm, in_m):
        np.testing.assert_allclose(found.run().values["joint_force"], want, atol=1e-12 * size)
    assert 10.0 < size < 20.0


PICTURES_EXAMPLE = Path(__file__).parents[3] / "examples" / "bearings.toml"


TEXT = PICTURES_EXAMPLE.read_text(encoding="utf-8")


HALF_TURN = np.radians(np.arange(361) / 2.0)


FORCES = LINE.evaluate(HALF_TURN, ("joint_force", "bearing_force"), load=LOAD)


@pytest.fixture(autouse=True)
def _no_figure_stays() -> Iterator[None]:
    yield
    pyplot.close("all")


def path_of(axes: Axes) -> np.ndarray:
    (line,) = (line for line in axes.get_lines() if len(np.asarray(line.get_xdata())) == 361)
    return np.asarray(line.get_xydata(), dtype=float)


# --- hodographs ------------------------------------------------------------------------------


@pytest.mark.parametrize("bearing", range(5))
def test_the_path_of_a_bearing_is_its_force_across_the_shaft(bearing: int) -> None:
    x, y = path_of(plot_force_hodograph(LINE, "bearing", bearing, load=LOAD)).T
    force = FORCES.bearing_force[bearing]
    # Looking along x with y up, z is to the right; shafts 1 and 3 lead a little down and up.
    np.testing.assert_allclose(x, force[:, 2], atol=1e-9)
    np.testing.assert_allclose(np.hypot(x, y), np.linalg.norm(force, axis=-1), rtol=1e-9)
    assert np.sign(y[45]) == np.sign(force[45, 1]) != 0.0


@pytest.mark.parametrize(("joint", "shaft"), [(0, 1), (1, 2), (2, 2)])
def test_the_path_of_a_joint_is_seen_along_the_shaft_that_it_supports(
    joint: int, shaft: int
) -> None:
    axes = plot_force_hodograph(LINE, "joint", joint, load=LOAD)
    assert axes.get_title(loc="left").endswith(f"seen along shaft {shaft}")
    x, y = path_of(axes).T
    sizes = np.linalg.norm(FORCES.joint_force[joint], axis=-1)
    np.testing.assert_allclose(np.hypot(x, y), sizes, rtol=1e-9, atol=1e-9)


def test_angles_and_the_largest_force_are_marked() -> None:
    axes = plot_force_hodograph(LINE, "bearing", 2, load=LOAD)
    path = path_of(axes)
    named = {text.get_text(): text.xy for text in axes.texts if text.get_text()}  # type: ignore[attr-defined]
    assert list(named) == [f"{angle}°" for angle in range(0, 180, 30)]
    for name, at in named.items():
        np.testing.assert_array_equal(at, path[2 * int(name[:-1])])
    (arrow,) = (text for text in axes.texts if not text.get_text())
    np.testing.assert_array_equal(arrow.xy, path[np.argmax(np.hypot(*path.T))])  # type: ignore[attr-defined]
    assert axes.get_title(loc="left").startswith("Bearing 2, up to 139 N")
    assert axes.get_aspect() == 1.0


def test_angles_lie_within_the_axes() -> None:
    """Those of bearings 0 and 1 lie on the horizontal axis, to the left and to the right."""
    figure = plot_forces(force_paths(LINE, LOAD))
    figure.draw_without_rendering()
    for axes in figure.axes:
        room = axes.get_window_extent()
        for text in axes.texts:
            at = text.get_window_extent()
            if text.get_text():
                assert room.x0 < at.x0 < at.x1 < room.x1, text
                assert room.y0 < at.y0 < at.y1 < room.y1, text


def test_hodographs_that_cannot_be() -> None:
    with pytest.raises(ValueError, match="shows one driveline"):
        plot_force_hodograph(Driveline.from_bends([[0.1], [0.2]]), load=LOAD)
    with pytest.raises(ValueError, match="per is 'shaft'; it must be 'joint' or 'bearing'"):
        plot_force_hodograph(LINE, "shaft", load=LOAD)  # type: ignore[arg-type]
    with pytest.raises(IndexError, match="item is 5; there are 5"):
        plot_force_hodograph(LINE, "bearing", 5, load=LOAD)


def test_a_page_has_the_path_of_every_force() -> None:
    scene = Scene.parse(TEXT)
    figure = plot_forces(scene_force_paths(scene), scene.title)
    assert len(figure.axes) == 8
    for axes, force in zip(figure.axes, [*FORCES.joint_force, *FORCES.bearing_force], strict=True):
        sizes = np.linalg.norm(force, axis=-1)
        np.testing.assert_allclose(np.hypot(*path_of(axes).T), sizes, rtol=1e-9, atol=1e-9)


def plot(tmp_path: Path, text: str, *options: str) -> tuple[int, str]:
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    arguments = ["plot", str(tmp_path / "a.toml"), "--output", str(tmp_path / "a.svg"), *options]
    done = CliRunner().invoke(commands(), arguments)
    return done.exit_code, done.output


def test_command_draws_forces(tmp_path: Path) -> None:
    assert plot(tmp_path, TEXT, "--what", "forces")[0] == 0
    assert (tmp_path / "a.svg").stat().st_size > 1000
    status, said = plot(tmp_path, TEXT, "--what", "forces", "--over", "turns")
    assert (status, said) == (2, "cardan: --what does not go with --over\n")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[driveline]\nbends_deg = [5]\n", "over a turn: they need points_mm or points_m, or"),
        (
            "[driveline]\nbends_deg = [5]\nlengths_m = [1, 1]\n",
            "over a turn: they need a torque or inertias in [load]",
        ),
        (
            "[driveline]\nbends_deg = [5, 5, 5]\nlengths_m = [1, 1, 1, 1]\n"
            "[load]\noutput_torque_Nm = 1\n",
            "not determinate: ",
        ),
    ],
)
def test_forces_that_make_no_picture(text: str, reason: str, tmp_path: Path) -> None:
    status, said = plot(tmp_path, text, "--what", "forces")
    assert status == 2
    assert reason in said
    assert not (tmp_path / "a.svg").exists()


def test_joints_and_bearings_without_force_have_no_path(tmp_path: Path) -> None:
    # Every shaft has its own bearings, so the joints transmit moments alone.
    text = (
        "[driveline]\nbends_deg = [10]\nlengths_m = [1, 1]\n[load]\ndrive_torque_Nm = 9\n"
        + "".join(
            f"[[bearing]]\nshaft = {shaft}\nposition_m = {x}\n"
            for shaft in (0, 1)
            for x in (0.2, 0.8)
        )
    )
    paths = scene_force_paths(Scene.parse(text))
    assert [(path.per, path.item) for path in paths] == [("bearing", i) for i in range(4)]
    straight = text.replace("[10]", "[0]")
    assert "forces are all 0" in plot(tmp_path, straight, "--what", "forces")[1]


# --- bearings in drawings --------------------------------------------------------------------


def test_bearings_are_drawn_at_their_positions() -> None:
    axes = plot_driveline(LINE)
    flat = View.of(LINE.directions).axes[:2].T
    rings = [
        np.asarray(patch.get_xy())
        for patch in (*axes.artists, *axes.patches)
        if isinstance(patch, Polygon) and patch.get_facecolor() == to_rgba(_BEARING)
    ]
    assert len(rings) == 5
    centres = sorted(((ring.min(axis=0) + ring.max(axis=0)) / 2.0).tolist() for ring in rings)
    want = [(POINTS[shaft] + x * LINE.directions[shaft]) @ flat for shaft, x in BEARINGS]
    np.testing.assert_allclose(centres, sorted(map(list, want)), atol=1e-3)
    names = {text.get_text() for text in axes.texts}
    assert {"bearing 0", "bearing 2", "bearing 3"} <= names


# --- the report ------------------------------------------------------------------------------


def report(tmp_path: Path, text: str = TEXT) -> str:
    write_report(Scene.parse(text), tmp_path / "a.html")
    return (tmp_path / "a.html").read_text(encoding="utf-8")


def test_a_page_has_bearings(tmp_path: Path) -> None:
    assert ">Bearings<" in report(tmp_path)
    table = inputs(Scene.parse(TEXT))["bearings"]
    assert table is not None
    assert table.rows[2] == ("bearing 2", "1", "1050.0")
