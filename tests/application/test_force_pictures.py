"""Pictures of forces and of bearings: what is drawn is what the library computes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon

from cardan import Driveline, Load
from cardan.app.answers.forces.picture import ForcePath, force_paths, scene_force_paths
from cardan.app.command import commands
from cardan.app.pictures.driveline import _BEARING
from cardan.app.pictures.space import View
from cardan.app.plots import plot_driveline, plot_force_hodograph, plot_forces
from cardan.app.report import write_report
from cardan.app.report.results import inputs
from cardan.app.scene import Scene

EXAMPLE = Path(__file__).parents[2] / "examples" / "bearings.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")
POINTS = np.array([[0, 0, 0], [300, 0, 0], [1500, -60, 0], [3000, -220, 0], [3250, -210, 0]]) / 1e3
BEARINGS = [(0, 0.05), (0, 0.22), (1, 1.05), (3, 0.06), (3, 0.19)]
LOAD = Load(output_torque=1200.0)
LINE = Driveline.from_points(POINTS, phases=[90, 0], degrees=True).with_bearings(BEARINGS)
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


def test_of_equal_forces_the_arrow_is_the_first() -> None:
    """A path that repeats after 90°, whose second half is larger by rounding."""
    angle = np.arange(361) / 2.0
    size = 3.0 + np.sin(np.radians(4.0 * angle))
    path = ForcePath("joint", 0, 1, "y", angle, size * (1.0 + 1e-13 * (angle > 90.0)), 0.0 * angle)
    assert path.angle_deg[path.largest] == 22.5
    assert path.size == pytest.approx(4.0, rel=1e-12)


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


def test_a_shaft_along_y_has_z_upwards() -> None:
    turned = POINTS[:, [2, 0, 1]]
    line = Driveline.from_points(turned, phases=[90, 0], degrees=True).with_bearings(BEARINGS)
    axes = plot_force_hodograph(line, "bearing", 0, load=LOAD)
    assert axes.get_ylabel() == "force upwards, towards z [N]"
    # All is turned alike, so the view is the same.
    np.testing.assert_allclose(
        path_of(axes), path_of(plot_force_hodograph(LINE, load=LOAD)), atol=1e-9
    )


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


def test_headings_of_states_lie_within_the_page() -> None:
    names = [r"Rebound at $\axle$", "Bump " + "and more " * 9]
    states = f"[states]\nnames = {json.dumps(names)}\npoints_mm.2.y = [-60, -160]\n"
    scene = Scene.parse(TEXT + states)
    paths = scene_force_paths(scene)
    assert {path.state for path in paths} == set(names)
    figure = plot_forces(paths, scene.title)
    figure.canvas.draw()
    for axes, path in zip(figure.axes, paths, strict=True):
        heading = axes.get_title(loc="left")
        assert f"\nin {path.state[:16]}" in heading
        box = axes.get_tightbbox()
        assert box is not None
        assert box.x0 >= 0
        assert box.x1 <= figure.bbox.width


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


def test_points_in_another_unit_keep_bearings_in_place() -> None:
    axes, scaled = plot_driveline(LINE, ax=None), plot_driveline(LINE, points=1e3 * POINTS)
    for one, other in zip(axes.artists, scaled.artists, strict=True):
        assert isinstance(one, Polygon)
        assert isinstance(other, Polygon)
        np.testing.assert_allclose(1e3 * one.get_xy(), other.get_xy(), atol=1e-6)


def test_without_points_shafts_have_their_lengths() -> None:
    line = Driveline.from_bends([10, 10], degrees=True).with_bearings([], lengths=[1.0, 3.0, 2.0])
    own, given = plot_driveline(line), plot_driveline(line, points=places([1.0, 3.0, 2.0], line))
    for one, other in zip(own.get_lines(), given.get_lines(), strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())


def places(lengths: list[float], line: Driveline) -> np.ndarray:
    steps = np.array(lengths)[:, None] * line.directions
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


# --- the report ------------------------------------------------------------------------------


def report(tmp_path: Path, text: str = TEXT) -> str:
    write_report(Scene.parse(text), tmp_path / "a.html")
    return (tmp_path / "a.html").read_text(encoding="utf-8")


def test_a_page_has_bearings(tmp_path: Path) -> None:
    assert ">Bearings<" in report(tmp_path)
    table = inputs(Scene.parse(TEXT))["bearings"]
    assert table is not None
    assert table.rows[2] == ("bearing 2", "1", "1050")


def test_a_page_without_bearings_has_none(tmp_path: Path) -> None:
    page = report(tmp_path, "[driveline]\nbends_deg = [5, 5]\n")
    assert ">Bearings<" not in page
