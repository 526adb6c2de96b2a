"""Pictures: what they show, that they can be read, that they are the same every time."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import font_manager
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle, StepPatch

from cardan.app.answers.turn.figures import summary
from cardan.app.answers.turn.picture import key_figures
from cardan.app.command import commands
from cardan.app.plots import plot_scene, write_picture
from cardan.app.scene import Scene, SceneResult
from drawn_texts import drawn, texts
from example_scenes import EXAMPLES, each_driveline
from heights import NAMES, drivelines, scene_text

FOLDER = Path(__file__).parents[3] / "examples"

TALL = """\
title = "A title longer than a column is wide, which costs $_{5$ and breaks into three lines"
[driveline]
bends_deg = [12, 12, 0]
twists_deg = [180, 0]
[load]
speed_rpm = 12000
output_torque_Nm = 1234567
[sweep]
turns = 3
start_deg = -90
[output]
quantities = ["angle", "angle_error", "speed_ratio", "acceleration_ratio", "torque",
              "support_moment", "moment", "tilt_driving", "bending_driving"]
"""


def panels(figure: Figure) -> list[Axes]:
    """The axes of the page's curves, without those of its sketch."""
    return [axes for axes in figure.axes if axes.get_label() != "driveline"]


def headings(figure: Figure) -> list[str]:
    return [axes.get_title(loc="left") for axes in panels(figure)]


def foeppl() -> SceneResult:
    return Scene.load(next(path for path in EXAMPLES if path.stem == "foeppl")).run()


def characters(font: str) -> set[str]:
    family = font_manager.FontProperties(family=[font])
    found = font_manager.get_font(font_manager.findfont(family))
    return set(map(chr, found.get_charmap()))


def test_title_in_characters_of_another_font(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is drawn from an installed font that has them; warnings are errors here."""
    other = characters("STIXGeneral") - characters("DejaVu Sans")
    title = "Joint " + "".join(sorted(c for c in other if c.isalpha())[:3])
    scene = Scene.parse(f"title = '{title}'\n[driveline]\nbends_deg = [8]\n")
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
    figures: list[Figure] = []
    write_picture(scene.run(), tmp_path / "a.svg")
    (named,) = (text for text in figures[0].texts if title in text.get_text())
    known = set().union(*(characters(family) for family in named.get_fontfamily()))
    assert set(title) - {" "} <= known


def test_title_in_characters_of_no_font(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "matplotlib.font_manager.fontManager.ttflist",
        [e for e in font_manager.fontManager.ttflist if e.name in ("DejaVu Sans", "Last Resort")],
    )
    scene = Scene.parse("title = '駆動軸'\n[driveline]\nbends_deg = [8]\n")
    with pytest.warns(UserWarning, match="font") as caught:
        write_picture(scene.run(), tmp_path / "a.svg")
    assert [str(warning.message) for warning in caught] == [
        "no installed font has the characters 駆動軸; the picture shows boxes in their place"
    ]


def test_one_page_with_a_panel_per_quantity() -> None:
    result = foeppl()
    figure = drawn(result)
    assert headings(figure) == [
        "angle error, shaft 1 [deg]",
        "speed ratio, shaft 1",
        "acceleration, shaft 1 [rad/s²]",
        "torque, shaft 1 [N m]",
        "moment about x, joint 0 [N m]",
        "moment about y, joint 0 [N m]",
        "moment about z, joint 0 [N m]",
    ]
    assert figure.get_size_inches() * 25.4 == pytest.approx([297, 210])
    assert figure.texts[0].get_text() == "Föppl's rig (Thoma 1920)"
    assert "drive angle 0° to 360°, 721 samples, drive at 3000 rpm" in page_texts(figure)
    last = panels(figure)[-1]
    assert last.get_xlabel() == "drive angle [deg]"
    assert [tick for tick in last.get_xticks() if 0 <= tick <= 360] == [0, 90, 180, 270, 360]


def page_texts(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.texts]


def test_curves_are_the_values() -> None:
    result = foeppl()
    values, speed2 = result.values, (100 * np.pi) ** 2
    want = [
        np.degrees(values["angle_error"]),
        values["speed_ratio"],
        values["acceleration_ratio"] * speed2,
        values["torque"],
        *values["moment"][0].T,
    ]
    for axes, values_there in zip(panels(drawn(result)), want, strict=True):
        (line,) = axes.get_lines()
        np.testing.assert_array_equal(line.get_xdata(), result.scene.drive_angle_deg)
        np.testing.assert_allclose(np.asarray(line.get_ydata(), float), values_there, rtol=1e-14)


def many_joints(shafts: int, turns: float = 1.0) -> SceneResult:
    bends = ", ".join(str(1 + joint / shafts) for joint in range(shafts))
    listed = ", ".join(str(shaft) for shaft in range(1, shafts + 1))
    return Scene.parse(
        f"title = 'many'\n[driveline]\nbends_deg = [{bends}]\n[load]\noutput_torque_Nm = 100\n"
        f"[sweep]\nturns = {turns}\nsamples_per_turn = 90\n[output]\nshafts = [{listed}]\n"
        "quantities = ['angle_error', 'bending_driven', 'moment']\n"
    ).run()


def test_shafts_share_a_panel_and_a_scale() -> None:
    """However many there are; at most six are drawn, those that vary most."""
    counts = []
    for shafts in (1, 3, 6, 64):
        result = many_joints(shafts)
        figure = drawn(result)
        counts.append(len(panels(figure)))
        errors = np.degrees(result.values["angle_error"])
        shown = sorted(np.argsort(-np.ptp(errors, axis=1), kind="stable")[:6])
        lines = panels(figure)[0].get_lines()
        for line, shaft in zip(lines, shown, strict=True):
            np.testing.assert_allclose(np.asarray(line.get_ydata(), float), errors[shaft])
        low, high = panels(figure)[0].get_ylim()
        assert low < errors[shown].min() < errors[shown].max() < high
        legend = panels(figure)[0].get_legend()
        names = [f"shaft {shown[0] + 1}", *(str(shaft + 1) for shaft in shown[1:])]
        named = [] if legend is None else [text.get_text() for text in legend.get_texts()]
        assert named == (names if shafts > 1 else [])
        # They can be told apart in grey.
        dashes = {str(line._dash_pattern) for line in panels(figure)[0].get_lines()}  # type: ignore[attr-defined]
        assert len(dashes) == min(shafts, 6)
        capped = "6 of 64" in headings(figure)[0]
        assert capped == any("left out" in text for text in page_texts(figure)) == (shafts > 6)
    # With few joints of small bends the moment along the shafts is steady.
    assert counts == [4, 4, 4, 5]


def test_bending_is_not_drawn_on_the_scale_of_the_torque() -> None:
    """The axes across the driveline share a scale, the one along it has its own."""
    for path, along in ((EXAMPLES, 0), (None, 2)):
        if path:
            result, whose = foeppl(), "x: along shaft 0; z: normal of the bend plane of joint 0"
        else:
            # Points of which the shafts follow z.
            text = (
                "[driveline]\npoints_mm = [[0, 0, 0], [30, 0, 300], [0, 20, 900], [0, 0, 1000]]\n"
            )
            text += "[load]\noutput_torque_Nm = 100\n[output]\nquantities = ['moment']\n"
            result, whose = Scene.parse(text).run(), "x, y, z: axes of the points"
        figure = drawn(result)
        scales = np.array([axes.get_ylim() for axes in panels(figure)[-3:]])
        across = np.delete(np.arange(3), along)
        np.testing.assert_array_equal(scales[across[0]], scales[across[1]])
        assert np.ptp(scales[across[0]]) < np.ptp(scales[along]) + 40
        parts = result.values["moment"][..., across]
        assert scales[across[0]] == pytest.approx(
            [parts.min() - 0.05 * np.ptp(parts), parts.max() + 0.05 * np.ptp(parts)], rel=0.2
        )
        assert any(text.startswith(whose) for text in page_texts(figure))


def bands(axes: Axes) -> list[StepPatch]:
    return [patch for patch in axes.get_children() if isinstance(patch, StepPatch)]


def test_many_turns_are_bands_of_the_extremes_of_each() -> None:
    path = next(path for path in EXAMPLES if path.stem == "recorded_run")
    result = Scene.load(path).run()
    figure = drawn(result)
    turn = np.floor((result.scene.drive_angle_deg - result.scene.drive_angle_deg[0]) / 360)
    # What is left behind the last turn is too little for a turn of its own.
    turn = np.minimum(turn, 7)
    values = np.degrees(result.values["angle_error"])
    axes = panels(figure)[0]
    (band,) = bands(axes)
    largest, edges, least = band.get_data()
    (line,) = axes.get_lines()
    assert len(largest) == 8
    np.testing.assert_allclose(edges[:-1], np.arange(8), atol=1e-12)
    for i in range(8):
        own = values[turn == i]
        assert (np.asarray(least)[i], largest[i]) == (own.min(), own.max())
        assert np.asarray(line.get_ydata())[i] == pytest.approx(own.mean(), rel=1e-9)
    assert axes.get_xlabel() == "turns of the drive"
    assert any("Bands: from the least to the largest" in text for text in page_texts(figure))


def test_acceleration_is_a_ratio_without_a_speed() -> None:
    scene = "[driveline]\nbends_deg = [8.5]\n"
    assert headings(drawn(Scene.parse(scene).run())) == [
        "angle error, shaft 1 [deg]",
        "speed ratio, shaft 1",
        "acceleration ratio, shaft 1",
    ]
    scene += "[load]\nspeed_rpm = 1\nacceleration_rad_s2 = 1\n"
    assert "acceleration at steady drive, shaft 1 [rad/s²]" in headings(
        drawn(Scene.parse(scene).run())
    )


@each_driveline
def test_nothing_overlaps(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    apart(Scene.load(path), monkeypatch)


def test_nothing_overlaps_on_a_tall_page(monkeypatch: pytest.MonkeyPatch) -> None:
    apart(Scene.parse(TALL), monkeypatch)


def apart(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every text of the page of a scene lies in it and covers no other."""
    figure = plot_scene(scene.run())
    figure.set_dpi(200)
    page = figure.bbox
    found = texts(figure, monkeypatch, largest=11.0)
    assert len(found) > 25
    for text, box in found:
        assert page.x0 <= box.x0 <= box.x1 <= page.x1, text
        assert page.y0 <= box.y0 <= box.y1 <= page.y1, text
    for (one, here), (other, there) in combinations(found, 2):
        assert not here.overlaps(there), (one, other)
    for axes in panels(figure):
        low, high = axes.get_ylim()
        assert len([tick for tick in axes.get_yticks() if low <= tick <= high]) >= 2
        assert axes.yaxis.get_offset_text().get_text() == ""


def test_key_figures_of_a_page() -> None:
    result = foeppl()
    figure = drawn(result)
    written = page_texts(figure)
    for label, value in key_figures(summary(result), 99):
        assert label in written
        assert value in written


def test_rounding_does_not_fill_a_panel() -> None:
    scene = "[driveline]\nbends_deg = [33, 33]\ntwists_deg = [10]\nphases_deg = [190]\n"
    scene += "[load]\noutput_torque_Nm = 5000\n"
    figure = drawn(Scene.parse(scene).run())
    said = "angle error, shaft 2: 0°; speed ratio, shaft 2: 1; acceleration ratio, shaft 2: 0; "
    assert f"Without a curve: {said}torque, shaft 2: 5000 N m." in " ".join(page_texts(figure))
    assert [name[:6] for name in headings(figure)] == ["moment"] * 3


def test_what_varies_by_less_than_a_hundredth_is_a_line_of_text() -> None:
    """A joint of 5.7° makes a torque of 1 % of its size; one of 5.8° has a curve."""
    for bend, is_line in ((5.7, True), (5.8, False)):
        text = f"[driveline]\nbends_deg = {bend}\n[load]\noutput_torque_Nm = 1000\n"
        text += "[output]\nshafts = [0, 1]\nquantities = ['torque', 'angle_error']\n"
        figure = drawn(Scene.parse(text).run())
        assert ("torque [N m]" in headings(figure)) == (not is_line)
        assert "angle error [deg]" in headings(figure)
        low, high = 1000.0 * np.array([np.cos(np.radians(bend)), 1.0 / np.cos(np.radians(bend))])
        said = f"torque of shaft 0: {low:.1f} to {high:.1f} N m, 1: 1000 N m."
        assert any(said in each for each in page_texts(figure)) == is_line


def test_magnitudes_of_a_torque_that_reverses_have_its_sign() -> None:
    """They pass through 0 without a cusp: no step of their slope is larger than that of a sine."""
    text = "[driveline]\nbends_deg = [35, 35]\nphases_deg = 90\n[load]\nspeed_rpm = 540\n"
    text += "output_torque_Nm = 600\ninertias_kgm2 = [0, 0.2, {}]\n"
    text += "[output]\nquantities = ['pin_moment', 'bending_driven']\n"
    for inertia, reverses in ((0.02, False), (3.0, True)):
        result = Scene.parse(text.format(inertia)).run()
        figure = drawn(result)
        ending = ", with the sign of the torque" if reverses else ""
        names = [f"{name}{ending} [N m]" for name in ("pin moment", "bending, driven side")]
        assert headings(figure) == names
        for axes, name in zip(panels(figure), ("pin_moment", "bending_driven"), strict=True):
            for line, size in zip(axes.get_lines(), result.values[name], strict=True):
                curve = np.asarray(line.get_ydata(), np.float64)
                np.testing.assert_allclose(np.abs(curve), size, rtol=1e-12)
                assert (np.min(curve) < 0.0) == reverses
                if reverses and name == "pin_moment":
                    bow = np.abs(np.diff(curve, 2))
                    assert bow.max() < 0.05 * np.abs(np.diff(curve)).max()


@pytest.mark.parametrize(
    ("suffix", "start", "date"),
    [
        (".svg", b"<?xml", b"dc:date"),
        pytest.param(".png", b"\x89PNG", b"tIME", marks=pytest.mark.long),
        pytest.param(".pdf", b"%PDF", b"CreationDate", marks=pytest.mark.long),
    ],
)
def test_files_are_the_same_every_time(
    tmp_path: Path, suffix: str, start: bytes, date: bytes
) -> None:
    one, other = tmp_path / f"one{suffix}", tmp_path / f"other{suffix}"
    result = foeppl()
    write_picture(result, one)
    write_picture(result, other)
    assert one.read_bytes().startswith(start)
    assert date not in one.read_bytes()
    assert one.read_bytes() == other.read_bytes()
    assert sorted(tmp_path.iterdir()) == [one, other]


def figure_of(
    command: str, text: str, monkeypatch: pytest.MonkeyPatch, folder: Path, *options: str
) -> Figure:
    """The figure that a command writes of a scene."""
    (folder / "a.toml").write_text(text, encoding="utf-8")
    for table in FOLDER.glob("*.csv"):
        (folder / table.name).write_bytes(table.read_bytes())
    figures: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: figures.append(self))
    arguments = [command, str(folder / "a.toml"), *options, "--output", str(folder / "a.svg")]
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    (figure,) = figures
    return figure


@pytest.mark.parametrize(
    ("name", "option"),
    [
        ("axial_travel", "--what=axial_travel"),
        ("worn_joints", "--what=backlash"),
        ("suspension", "--study=equivalent_bend"),
        ("foeppl", "--over=turns"),
    ],
)
def test_titles_are_written_as_they_are(
    name: str, option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dollar signs make no formula, and a long title has several lines."""
    title = r"Joints at $\each$, in a title that is much longer than its picture is wide"
    text = (FOLDER / f"{name}.toml").read_text("utf-8")
    (given,) = re.findall("^title = .*$", text, re.M)
    text = text.replace(given, f"title = '{title}'")
    figure = figure_of("plot", text, monkeypatch, tmp_path, option)
    found = figure.get_suptitle() or "\n".join(text.get_text() for text in figure.texts)
    assert title in " ".join(found.split())
    for shown, box in texts(figure, monkeypatch, 12.0):
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1, shown


def test_a_picture_of_states_has_their_figures_and_the_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = scene_text(20.0, "[limits]\nequivalent_bend_deg = 4")
    figure = figure_of("plot", text, monkeypatch, tmp_path, "--study=equivalent_bend")
    (axes,) = figure.axes
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    bars = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    assert [bar.get_width() for bar in bars] == pytest.approx(bends)
    assert [bool(bar.get_hatch()) for bar in bars] == [bend > 4.0 for bend in bends]
    (limit,) = axes.get_lines()
    np.testing.assert_allclose(np.asarray(limit.get_xdata()), 4.0)
    assert limit.get_label() == "limit 4 deg"
    assert [label.get_text() for label in axes.get_yticklabels()] == list(NAMES)
    # The first state is on top.
    assert axes.transData.transform([0, 0])[1] > axes.transData.transform([0, 1])[1]


@pytest.mark.parametrize(
    ("command", "name", "option"),
    [
        ("life", "conveyor", ()),
        ("tolerances", "workshop", ()),
        ("plot", "axial_travel", ("--what=axial_travel",)),
        ("plot", "worn_joints", ("--what=backlash",)),
        ("plot", "truck", ("--over", "orders")),
        ("plot", "ball_joint", ()),
        ("plot", "bearings", ("--what=forces",)),
    ],
)
def test_frames_hold_what_they_show_and_are_little_larger(
    command: str,
    name: str,
    option: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = (FOLDER / f"{name}.toml").read_text("utf-8")
    figure = figure_of(command, text, monkeypatch, tmp_path, *option)
    figure.draw_without_rendering()
    for axes in figure.axes:
        if axes.get_label() == "driveline":
            continue
        ends = zip(axes.dataLim.intervalx, axes.dataLim.intervaly, strict=True)
        (left, low), (right, high) = ends
        for first, last, view in (
            (left, right, axes.get_xlim()),
            (low, high, axes.get_ylim()),
        ):
            span = max(view) - min(view)
            assert min(view) - 1e-9 * span <= first <= last <= max(view) + 1e-9 * span
            # The arrow of a force begins at 0, however short its path is.
            assert last - first > 0.45 * span or "--what=forces" in option
        # Curves with a name have it in a legend, two scales of one frame in one of them.
        bounds = axes.get_position().bounds
        same = [other for other in figure.axes if other.get_position().bounds == bounds]
        named = any(other.get_legend_handles_labels()[0] for other in same)
        assert named == any(other.get_legend() for other in same)
        if axes.yaxis_inverted():
            # Bars begin at 0; their sizes are written beside the axes, where no line crosses them.
            assert axes.get_xlim()[0] == left == 0.0
            assert all(label.get_window_extent().x0 >= axes.bbox.x1 for label in axes.texts)
            assert all(label.get_window_extent().x1 <= figure.bbox.x1 for label in axes.texts)
