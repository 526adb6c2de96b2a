"""Pictures: what they show, that they can be read, that they are the same every time."""

from __future__ import annotations

import importlib
import inspect
import math
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib import font_manager, pyplot
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle, StepPatch
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from cardan import ArgumentError, reference
from cardan.app import plots
from cardan.app.answers.turn.figures import SummaryRow, summary
from cardan.app.answers.turn.orders import Bands
from cardan.app.answers.turn.picture import key_figures
from cardan.app.command import commands
from cardan.app.pictures import space, style
from cardan.app.pictures.labels import PlacedLabels
from cardan.app.pictures.space import View
from cardan.app.pictures.style import degree_ticks, text_width
from cardan.app.plots import plot_scene, write_picture
from cardan.app.scene import Scene, SceneResult
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.sweep import Sweep
from cardan.reference import vectors
from cardan.reference.approximations import thoma_moment_ratios, thoma_small_angle
from example_scenes import EXAMPLES, each_driveline
from heights import NAMES, drivelines, scene_text

DOCS = Path(__file__).parents[2] / "docs"
FOLDER = Path(__file__).parents[2] / "examples"

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


def drawn(result: SceneResult) -> Figure:
    figure = plot_scene(result)
    figure.draw_without_rendering()
    return figure


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


@pytest.mark.parametrize(("turns", "is_band"), [(3, False), (4, True)])
def test_few_turns_are_curves(turns: int, is_band: bool) -> None:
    axes = panels(drawn(many_joints(1, turns)))[0]
    assert bool(bands(axes)) == is_band
    assert axes.get_xlim() == pytest.approx((0, turns if is_band else 360 * turns))


def test_turns_of_a_recording() -> None:
    """Angles that begin anew each turn, samples that are missing, very many turns."""
    steps = np.arange(0, 360 * 5 + 1, 30, dtype=np.float64)
    whole, wrapped = Bands.of_turns(steps + 77), Bands.of_turns(steps % 360)
    assert whole is not None
    assert wrapped is not None
    np.testing.assert_array_equal(whole.part, wrapped.part)
    np.testing.assert_array_equal(np.bincount(whole.part), [12, 12, 12, 12, 13])
    gaps = steps.copy()
    gaps[[0, 20]] = np.nan
    missing = Bands.of_turns(gaps)
    assert missing is not None
    assert list(np.flatnonzero(missing.part < 0)) == [0, 20]
    values = np.arange(len(steps), dtype=np.float64)
    least, largest, mean = missing.extremes(values)
    assert (least[0], largest[0], mean[0]) == (1, 12, 6.5)
    long = Bands.of_turns(np.arange(0, 360 * 5000, 90, dtype=np.float64))
    assert long is not None
    assert len(long.edges) <= 401


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


@pytest.mark.parametrize(
    ("low", "high", "step"),
    [(0, 90, 30), (-45, 45, 30), (-180, 180, 90), (100, 460, 90), (0, 3600, 720), (3, 10, 2)],
)
def test_degrees_have_few_round_ticks(low: float, high: float, step: float) -> None:
    axes = given_axes()
    axes.set_xlim(low, high)
    degree_ticks(axes.xaxis, low, high)
    ticks = [tick for tick in axes.get_xticks() if low <= tick <= high]
    assert ticks == [step * i for i in range(-20, 20) if low <= step * i <= high]


@pytest.mark.parametrize("ticks", [[0.99, 0.995, 1.0], [0, 2.5, 5], [0, 90], [-0.25, 0.25]])
def test_ticks_of_an_axis_have_as_many_decimals(ticks: list[float]) -> None:
    figure = Figure(layout="constrained")
    axes = figure.add_subplot()
    axes.set_ylim(ticks[0], ticks[-1])
    style.value_ticks(axes.yaxis)
    figure.draw_without_rendering()
    shown = [label.get_text() for label in axes.get_yticklabels()]
    assert len({len(text.partition(".")[2]) for text in shown}) == 1
    # Negative ones have a true minus sign.
    assert "-" not in "".join(shown)
    values = [float(text.replace("\N{MINUS SIGN}", "-")) for text in shown]
    np.testing.assert_allclose(values, axes.get_yticks(), atol=1e-12)


def test_key_figures_of_a_page() -> None:
    result = foeppl()
    figure = drawn(result)
    written = page_texts(figure)
    for label, value in key_figures(summary(result), 99):
        assert label in written
        assert value in written


def test_key_figures_that_are_too_many() -> None:
    """Of many joints the largest stays, and its joint is named; a last line counts the rest."""
    loads = [
        SummaryRow("joint", "Nm", "moment", j, "peak", "turn", float(j % 3), 30.0) for j in range(4)
    ]
    bends = [
        SummaryRow("joint", "deg", "bend", j, "value", "driveline", float(j % 7), None)
        for j in range(9)
    ]
    assert len(key_figures(loads, 9)) == 4
    assert key_figures(loads, 3) == [("largest moment, joint 2", "2.00 N m at 30.0°")]
    assert key_figures(bends, 9) == [("largest bend, joint 6", "6.00°")]
    rows = [*loads, *bends, SummaryRow("shaft", "deg", "twist", 1, "value", "driveline", 0.0, None)]
    assert key_figures(rows, 2)[-1] == ("and 2 more", "")


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


@pytest.mark.parametrize("turns", [3, 4])
def test_the_angle_of_many_turns_needs_no_panel(turns: int) -> None:
    text = f"[driveline]\nbends_deg = 10\n[sweep]\nturns = {turns}\n"
    text += "[output]\nquantities = ['angle', 'angle_error']\n"
    figure = drawn(Scene.parse(text).run())
    assert ("angle, shaft 1 [deg]" in headings(figure)) == (turns == 3)
    assert (
        f"Without a curve: angle, shaft 1: 0 to {360 * turns}°." in " ".join(page_texts(figure))
    ) == (turns == 4)


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


def test_settings_of_the_caller_stay(tmp_path: Path) -> None:
    with matplotlib.rc_context({"font.size": 11.5, "svg.hashsalt": "own"}):
        before = dict(matplotlib.rcParams)
        write_picture(foeppl(), tmp_path / "a.svg")
        assert dict(matplotlib.rcParams) == before


def test_pyplot_stays_out(tmp_path: Path) -> None:
    script = (
        "import sys; from cardan import Scene; from cardan.app.plots import write_picture\n"
        "assert 'matplotlib' not in sys.modules\n"
        "result = Scene.parse('[driveline]\\nbends_deg = [8.5]').run()\n"
        f"write_picture(result, {str(tmp_path / 'a.png')!r})\n"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_without_matplotlib(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"needs matplotlib: pip install 'cardan\[plot\]'"):
        write_picture(foeppl(), tmp_path / "a.svg")
    assert list(tmp_path.iterdir()) == []


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


def test_unknown_suffix(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\.jpg must end in \.svg or \.png or \.pdf"):
        write_picture(foeppl(), tmp_path / "a.jpg")
    assert list(tmp_path.iterdir()) == []


def test_failing_picture_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: Figure, file: object, **_: object) -> None:
        file.write(b"half")  # type: ignore[attr-defined]
        raise KeyboardInterrupt

    monkeypatch.setattr(Figure, "savefig", fail)
    with pytest.raises(KeyboardInterrupt):
        write_picture(foeppl(), tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


# --- pictures on axes ------------------------------------------------------------------------

SPATIAL = Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
SINGLE = Driveline.from_bends([50], degrees=True)
SEVERAL = Driveline.from_bends([[10], [20], [30]], degrees=True)
POINTS: list[list[float]] = [
    [0, 0, 0],
    [350, -24, 0],
    [1650, -46, 0],
    [3150, -180, 45],
    [3450, -196, 45],
]
SHORT: list[list[float]] = [[0, 0, 0], [1, 0.1, 0], [1.1, 0, 0], [2.5, 0, 0.1], [2.7, 0, 0]]
TRUCK = Driveline.from_points(POINTS, phases=[0.3, -0.7]).with_bearings(
    [(0, 100), (0, 300), (1, 1200), (3, 60), (3, 200)]
)
FLYWHEEL = Load(speed=100.0, inertias=[0.0, 0.1, 0.2, 0.3], output_torque=50.0)
COMPENSATION = """\
[driveline]
bends_deg = [10, 10]
[study]
bends_deg.1 = {from = 14, to = 6, steps = 81}
phases_deg.0 = {from = -15, to = 15, steps = 61}
"""

SUSPENSION = next(path for path in EXAMPLES if path.stem == "suspension").read_text("utf-8")


def study(text: str) -> StudyResult:
    result = Scene.parse(text).run().study
    assert result is not None
    return result


Picture = Callable[..., Axes]

PICTURES: dict[str, tuple[str, Picture]] = {
    "driven angle": ("rectilinear", plots.plot_driven_angle),
    "angle error": ("rectilinear", plots.plot_angle_error),
    "largest angle error": ("rectilinear", plots.plot_largest_angle_error),
    "non-uniformity": ("rectilinear", plots.plot_non_uniformity),
    "bend vectors": ("rectilinear", partial(plots.plot_bend_vectors, SPATIAL)),
    "bend vectors of a truck": ("rectilinear", partial(plots.plot_bend_vectors, TRUCK, 2)),
    "torque": ("rectilinear", plots.plot_torque_ratio),
    "bending": ("polar", plots.plot_bending_moments),
    "Mt": ("rectilinear", plots.plot_small_angle),
    "Mx": ("rectilinear", partial(plots.plot_small_angle, "moment_x", 8.5)),
    "Mz": ("rectilinear", partial(plots.plot_small_angle, "moment_z")),
    "batch": ("rectilinear", partial(plots.plot_curves, SEVERAL, "acceleration_ratio")),
    "vector": (
        "rectilinear",
        partial(plots.plot_curves, TRUCK, "support_moment", shaft=2, load=FLYWHEEL),
    ),
    "harmonics": ("rectilinear", partial(plots.plot_harmonics, SEVERAL)),
    "ratio harmonics": ("rectilinear", partial(plots.plot_harmonics, TRUCK, "speed_ratio")),
    "map": ("rectilinear", partial(plots.plot_study, study(COMPENSATION))),
    "suspension": ("rectilinear", partial(plots.plot_study, study(SUSPENSION))),
    "map of U": ("rectilinear", partial(plots.plot_study, study(COMPENSATION), "non_uniformity")),
    "hodograph": ("rectilinear", partial(plots.plot_hodograph, SINGLE)),
    "loaded hodograph": ("rectilinear", partial(plots.plot_hodograph, TRUCK, 1, load=FLYWHEEL)),
    "spatial": ("rectilinear", partial(plots.plot_driveline, SPATIAL)),
    "truck": ("rectilinear", partial(plots.plot_driveline, TRUCK, 1.0, points=POINTS)),
    "plane": (
        "rectilinear",
        partial(plots.plot_driveline, Driveline.from_bends([10], degrees=True)),
    ),
    "straight": ("rectilinear", partial(plots.plot_driveline, Driveline.from_bends([0, 0, 0]))),
    "eight": ("rectilinear", partial(plots.plot_driveline, Driveline.from_bends([0.1] * 8))),
    "short": (
        "rectilinear",
        partial(plots.plot_driveline, Driveline.from_points(SHORT), points=SHORT),
    ),
    "ring": ("rectilinear", partial(plots.plot_driveline, Driveline.from_bends([0.087] * 64))),
}
IN_SPACE = ("spatial", "truck", "plane", "straight", "eight", "short", "ring")
each_picture = pytest.mark.parametrize("name", PICTURES)


@pytest.fixture(autouse=True)
def _no_figure_stays() -> Iterator[None]:
    pyplot.switch_backend("agg")
    yield
    pyplot.close("all")


def given_axes(projection: str = "rectilinear") -> Axes:
    axes: Axes = Figure(layout="constrained").add_subplot(projection=projection)
    return axes


def texts(
    figure: Figure, monkeypatch: pytest.MonkeyPatch, largest: float = 8.0
) -> list[tuple[str, Bbox]]:
    """Every text as it is drawn and its place; ticks out of view are not drawn."""
    found: list[tuple[str, Bbox]] = []
    draw = Text.draw

    def record(self: Text, renderer: RendererBase) -> None:
        draw(self, renderer)
        if self.get_visible() and self.get_text():
            assert 5.8 < float(self.get_fontsize()) <= largest, self.get_text()
            found.append((self.get_text(), Text.get_window_extent(self, renderer)))

    monkeypatch.setattr(Text, "draw", record)
    figure.draw_without_rendering()
    monkeypatch.undo()
    return found


def curve(axes: Axes, place: int) -> tuple[Any, Any]:
    line = axes.get_lines()[place]
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


@each_picture
def test_texts_can_be_read_at_80_mm(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    picture = PICTURES[name][1]
    before = dict(matplotlib.rcParams)
    axes = picture()
    assert dict(matplotlib.rcParams) == before
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    assert figure.get_figwidth() == pytest.approx(80 / 25.4)
    figure.set_dpi(300)
    found = texts(figure, monkeypatch)
    assert len(found) >= 8
    for text, box in found:
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1, text
        assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1, text
    for (one, here), (other, there) in combinations(found, 2):
        assert not here.overlaps(there), (one, other)
    legend = axes.get_legend()
    if legend is not None:
        over = legend.get_window_extent()
        for line in axes.get_lines():
            seen = line.get_transform().transform(line.get_xydata())
            assert not any(over.contains(x, y) for x, y in seen), line


@each_picture
def test_axes_are_taken_and_returned_with_curves_that_can_be_told_apart_in_grey(name: str) -> None:
    projection, picture = PICTURES[name]
    axes = given_axes(projection)
    with matplotlib.rc_context({"font.size": 11.5}):
        before = dict(matplotlib.rcParams)
        assert picture(ax=axes) is axes
        assert dict(matplotlib.rcParams) == before
    assert axes.has_data()
    assert pyplot.get_fignums() == []

    def looks(line: Line2D) -> tuple[Any, ...]:
        dashes = str(line._dash_pattern)  # type: ignore[attr-defined]
        return dashes, line.get_marker(), float(line.get_linewidth())

    labelled = {
        str(line.get_label()): looks(line)
        for line in axes.get_lines()
        if not str(line.get_label()).startswith("_")
    }
    assert len(set(labelled.values())) == len(labelled)
    handles, labels = axes.get_legend_handles_labels()
    assert (axes.get_legend() is not None) == bool(labels) == bool(handles)


@pytest.mark.parametrize(
    "name",
    [
        name
        for name, (kind, _) in PICTURES.items()
        if kind == "rectilinear" and name not in IN_SPACE
    ],
)
def test_axes_are_labelled(name: str) -> None:
    axes = PICTURES[name][1]()
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    for label in (axes.get_xlabel(), axes.get_ylabel(), axes.get_title(loc="left")):
        if "angle" in label and "ratio" not in label:
            assert "[deg]" in label


@pytest.mark.parametrize(
    "name",
    [
        *("driven angle", "angle error", "largest angle error", "non-uniformity", "torque"),
        *("Mt", "Mx", "Mz", "batch", "vector"),
    ],
)
def test_a_frame_is_as_wide_as_its_curves_and_holds_them(name: str) -> None:
    axes = PICTURES[name][1]()
    x, y = np.concatenate(
        [np.asarray(line.get_xydata()) for line in axes.get_lines() if line.get_label()]
    ).T
    assert axes.get_xlim() == pytest.approx((x.min(), x.max()))
    low, high = axes.get_ylim()
    assert low <= y.min() < y.max() <= high
    # Curves over the bend begin at 0, those over the turn cover half of it or all of it.
    left, right = axes.get_xlim()
    turn = (180.0, 360.0) if "angle" in axes.get_xlabel() else (45.0,)
    assert (left, right in turn) == (0.0, True)
    ticks = [tick for tick in axes.get_xticks() if left <= tick <= right]
    assert ticks == np.arange(0.0, right + 1.0, 90.0 if right > 180.0 else ticks[1]).tolist()


def test_more_curves_than_can_be_told_apart_are_refused() -> None:
    many = Driveline.from_bends(np.arange(1.0, 8.0)[:, None], degrees=True)
    with pytest.raises(ValueError, match="at most 6 curves that can be told apart"):
        plots.plot_curves(many)
    joints = TRUCK.evaluate(np.zeros(3), "moment", load=FLYWHEEL)
    with pytest.raises(ValueError, match=r"9 curves of moment; .* evaluate fewer shafts, joints"):
        plots.plot_result(joints)
    bearings = TRUCK.evaluate(np.zeros(3), "bearing_force", load=FLYWHEEL)
    with pytest.raises(ValueError, match=r"15 curves of .* draw each bearing with cardan"):
        plots.plot_result(bearings)
    assert pyplot.get_fignums() == []


# --- curves over the turn --------------------------------------------------------------------


@pytest.mark.parametrize("name", OUTPUTS)
def test_curves_of_every_output(name: str) -> None:
    output, angle = OUTPUTS[name], np.linspace(-1.0, 7.0, 50)
    axes = plots.plot_curves(TRUCK, name, shaft=2, joint=1, bearing=3, load=FLYWHEEL, angle=angle)
    want = TRUCK.evaluate(angle, name, shafts=2, joints=1, load=FLYWHEEL)[name]
    want = want[3] if output.per == "bearing" else want
    if output.unit == "rad":
        want = np.degrees(want)
    rows = want.T if output.vector else [want]
    assert len(axes.get_lines()) == len(rows)
    for place, row in enumerate(rows):
        x, y = curve(axes, place)
        np.testing.assert_array_equal(x, np.degrees(angle))
        np.testing.assert_array_equal(y, row)
    unit = {"rad": " [deg]", "1": ""}.get(output.unit, f" [{output.unit}]")
    item = {"shaft": "shaft 2", "joint": "joint 1", "bearing": "bearing 3"}[output.per]
    assert axes.get_ylabel() == f"{output.label}\n{item}{unit}"


def test_curves_of_a_batch() -> None:
    axes = plots.plot_curves(SEVERAL, "speed_ratio")
    turn = Sweep.revolutions(721 / 720, 720)
    want = SEVERAL[:, None].evaluate(turn, "speed_ratio").speed_ratio
    for place, row in enumerate(want):
        np.testing.assert_array_equal(curve(axes, place)[1], row)
    assert [str(line.get_label()) for line in axes.get_lines()] == [
        "bend 10°",
        "bend 20°",
        "bend 30°",
    ]


def test_curves_add_up_on_the_same_axes() -> None:
    smooth = Driveline.from_bends([33, 33], twists=[10], phases=[10], degrees=True)
    axes = plots.plot_curves(smooth, labels=["phased"])
    assert axes.get_ylim() == pytest.approx((-1, 1))
    plots.plot_curves(smooth.with_phases(0.0), labels=["as it was"], ax=axes)
    low, high = axes.get_ylim()
    y = curve(axes, 1)[1]
    assert low < y.min() < y.max() < high
    first, second = axes.get_lines()
    assert first.get_color() != second.get_color()
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["phased", "as it was"]


@pytest.mark.parametrize(
    ("line", "output", "options", "message"),
    [
        (SEVERAL[:, None], "angle", {}, r"shape \(3, 1\); .* batch of one dimension"),
        (SEVERAL, "moment", {"load": FLYWHEEL}, r"shape \(3,\); .* shows one driveline"),
        (SINGLE, "angel", {}, "did you mean 'angle'"),
        (SINGLE, "angle", {"angle": 1.0}, r"angle has shape \(\)"),
        (SEVERAL, "angle", {"labels": ["one"]}, "labels has 1 entries; there are 3 curves"),
        (SINGLE, "torque", {}, "load"),
    ],
)
def test_curves_that_make_no_picture(
    line: Driveline, output: str, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        plots.plot_curves(line, output, **options)


# --- figures of the sources ------------------------------------------------------------------


def test_driven_angle() -> None:
    axes = plots.plot_driven_angle(40.0)
    driving, driven = np.radians(curve(axes, 0))
    np.testing.assert_allclose(
        np.sin(driven) * np.cos(np.radians(40)) * np.cos(driving),
        np.cos(driven) * np.sin(driving),
        atol=1e-15,
    )
    np.testing.assert_array_equal(*curve(axes, 1))


def test_locus_runs_through_the_extremes_of_the_curves() -> None:
    axes = plots.plot_angle_error()
    step = 0.25
    above, maxima, below, minima = (curve(axes, place) for place in (3, 4, 5, 6))
    # The catalogue's own table under Bild 11, whose first maximum is cut off, not rounded.
    np.testing.assert_allclose(maxima[0], [44.8, 44.1, 42.9], atol=0.05)
    np.testing.assert_allclose(maxima[1], [0.4385, 1.782, 4.117], atol=0.0005)
    for place in range(3):
        x, y = curve(axes, place)
        for locus, points, extreme in (
            (above, maxima, np.argmax(y)),
            (below, minima, np.argmin(y)),
        ):
            assert points[0][place] == pytest.approx(x[extreme], abs=step)
            assert points[1][place] == pytest.approx(y[extreme], rel=1e-4)
            order = np.argsort(np.abs(locus[1]))
            on_locus = np.interp(abs(y[extreme]), np.abs(locus[1])[order], locus[0][order])
            assert on_locus == pytest.approx(x[extreme], abs=step)


def test_sizes_over_the_bend() -> None:
    bend, error = np.radians(curve(plots.plot_largest_angle_error(50.0), 0))
    want = np.arctan((1 - np.cos(bend)) / (2 * np.sqrt(np.cos(bend))))
    np.testing.assert_allclose(error, want, rtol=1e-12, atol=1e-15)
    bend_deg, size = curve(plots.plot_non_uniformity(), 0)
    bend = np.radians(bend_deg)
    assert bend_deg[-1] == pytest.approx(45.0)
    np.testing.assert_allclose(size, np.tan(bend) * np.sin(bend), rtol=1e-12, atol=1e-15)


def test_bend_vectors_of_the_catalogues_example() -> None:
    axes = plots.plot_bend_vectors(SPATIAL)
    first, tip, second, _, rings, reach, arc = (curve(axes, place) for place in range(7))
    assert (first[0][1], first[1][1]) == (tip[0][0], tip[1][0])
    ends = np.array([first, second])[:, :, 1]
    np.testing.assert_allclose(np.linalg.norm(ends, axis=1), [16.4225, 16.3956], atol=5e-5)
    # To the right and upwards, as the drawing has them.
    given = np.array([[7.0, 15.0], [12.0, -11.5]])
    np.testing.assert_allclose(np.transpose(rings), given, atol=1e-12)
    slope = np.tan(np.radians(given))
    np.testing.assert_allclose(np.arctan2(*ends.T[::-1]), np.arctan2(*slope.T[::-1]), rtol=1e-12)
    # Counter-clockwise as printed there, from the first vector to the line of the second.
    angles = np.degrees(np.unwrap(np.arctan2(arc[1], arc[0])))
    assert angles[-1] - angles[0] == pytest.approx(70.8728, abs=5e-5)
    assert np.tan(np.radians(angles[-1])) == pytest.approx(slope[1, 1] / slope[1, 0])
    # The line of the second leads from the middle to the size of the angle, across the arc's end.
    end = np.array(reach)[:, 1]
    assert (reach[0][0], reach[1][0]) == (0.0, 0.0)
    np.testing.assert_allclose(end / np.hypot(*end), np.array(arc)[:, -1] / np.hypot(*arc)[-1])
    assert np.hypot(*end) > np.hypot(*arc)[-1]
    (size,) = (text for text in axes.texts if text.get_text())
    assert (size.get_text(), size.xy) == ("70.9°", tuple(end))  # type: ignore[attr-defined]


def test_bend_vectors_of_a_shaft_that_points_up_have_x_upwards() -> None:
    """Turned as a whole until the shaft is level, with x up, the driveline looks the same."""
    points = np.array([[-1, -4, 0.5], [0, 0, 0], [0, 9, 0], [1, 12, 0.7]])
    upright = plots.plot_bend_vectors(Driveline.from_points(points), -2)
    level = plots.plot_bend_vectors(Driveline.from_points(points[:, [1, 0, 2]] * (1, 1, -1)))
    for place in (0, 2, 4, 5, 6):
        np.testing.assert_allclose(curve(upright, place), curve(level, place), atol=1e-9)
    # Joint 0 bends to the side on which shaft 0 lies, by atan(1 / 4) and atan(0.5 / 4).
    ends = np.transpose(curve(upright, 4))
    np.testing.assert_allclose(np.abs(ends[0]), np.degrees(np.arctan([0.5 / 4, 1 / 4])))


@pytest.mark.parametrize(
    ("line", "shaft", "message"),
    [
        (SEVERAL, 1, "shows one driveline"),
        (SPATIAL, 0, "must lie between two joints"),
        (SPATIAL, -1, "must lie between two joints"),
        (Driveline.from_bends([0, 5], degrees=True), 1, "a straight joint beside it"),
    ],
)
def test_bend_vectors_that_make_no_picture(line: Driveline, shaft: int, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        plots.plot_bend_vectors(line, shaft)


def test_grossmanns_figures() -> None:
    angle_deg, torque = curve(plots.plot_torque_ratio(), 0)
    bend, angle = np.radians(50.0), np.radians(angle_deg)
    want = np.cos(bend) * (1 + (np.tan(bend) * np.sin(angle)) ** 2)  # his (7)
    np.testing.assert_allclose(torque, want, rtol=1e-13)
    polar = plots.plot_bending_moments()
    driving, first = curve(polar, 0)
    driven, second = curve(polar, 1)
    np.testing.assert_allclose(first, np.tan(bend) * np.abs(np.sin(driving)), atol=1e-15)  # (6)
    cosine = np.abs(np.cos(driven))
    want = np.tan(bend) / np.cos(bend) * cosine / (1 + (np.tan(bend) * cosine) ** 2)  # (8)
    np.testing.assert_allclose(second, want, atol=1e-14)
    assert second.max() == pytest.approx(0.77786, abs=5e-6)


def test_thomas_curves() -> None:
    turn = np.asarray(Sweep.revolutions(721 / 720, 720))
    line = Driveline.from_bends([30], degrees=True)
    torque = line.evaluate(turn, "torque", load=Load(speed=1.0, inertias=[0, 1])).torque
    ratios = thoma_moment_ratios(turn, np.radians(30))
    small = thoma_small_angle(turn, np.radians(30), 1.0, 1.0)
    low_by = {"torque": 0.09, "moment_x": 0.26, "moment_z": 0.21}
    exact = {"torque": torque, "moment_x": ratios.x * torque, "moment_z": ratios.z * torque}
    for component, want in exact.items():
        axes = plots.plot_small_angle(component)  # type: ignore[arg-type]
        (x, drawn), (_, approximate) = curve(axes, 0), curve(axes, 1)
        np.testing.assert_allclose(x, np.degrees(turn), rtol=1e-15)
        np.testing.assert_allclose(drawn, want, atol=1e-15)
        np.testing.assert_array_equal(approximate, getattr(small, component))
        low = 1 - np.max(np.abs(approximate)) / np.max(np.abs(drawn))
        assert low == pytest.approx(low_by[component], abs=0.005)
    with pytest.raises(ValueError, match="component is 'Mt'; it must be 'torque'"):
        plots.plot_small_angle("Mt")  # type: ignore[arg-type]


# --- harmonics, studies, hodograph -----------------------------------------------------------


def test_harmonics() -> None:
    axes = plots.plot_harmonics(SEVERAL, orders=range(1, 7))
    for place, bend in enumerate(np.radians([10, 20, 30])):
        x, y = curve(axes, place)
        n = np.array([1, 2, 3])
        np.testing.assert_allclose(x, 2 * n, atol=0.5)
        np.testing.assert_allclose(y, np.degrees(np.tan(bend / 2) ** (2 * n) / n), rtol=1e-13)
    assert axes.get_ylim()[0] < min(curve(axes, 0)[1])


def test_harmonics_of_what_turns_evenly() -> None:
    axes = plots.plot_harmonics(Driveline.from_bends([0.0]), "speed_ratio")
    assert axes.get_yscale() == "linear"
    assert len(curve(axes, 0)[0]) == 0


@pytest.mark.parametrize(
    ("line", "options", "message"),
    [
        (SEVERAL[None], {}, "batch of one dimension"),
        (SINGLE, {"quantity": "angle"}, "known are angle_error, speed_ratio"),
        (SINGLE, {"orders": [0]}, "an order is at least 1"),
    ],
)
def test_harmonics_that_make_no_picture(
    line: Driveline, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        plots.plot_harmonics(line, **options)


def test_lines_of_a_map_lie_where_the_library_has_them() -> None:
    axes = plots.plot_study(study(COMPENSATION))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("bend, joint 1 [deg]", "phase, shaft 1 [deg]")
    assert axes.get_title(loc="left") == "equivalent bend [deg]"
    filled, *lines = (item for item in axes.collections if isinstance(item, ContourSet))
    assert filled.get_clim()[0] <= 0.0
    checked = []
    for contour in lines:
        for level, parts in zip(contour.levels, contour.allsegs, strict=True):
            x, y = np.concatenate(parts).T
            bends = np.stack([np.full_like(x, 10.0), x], axis=-1)
            there = Driveline.from_bends(bends, phases=y[:, None], degrees=True).equivalent().bend
            # Straight between points of the grid, a tenth of a degree of bend apart.
            np.testing.assert_allclose(np.degrees(there), level, atol=0.05)
            checked.append(float(level))
    assert sorted(checked) == pytest.approx([2, 3, 4, 6, 8, 10])
    assert [text.get_text() for text in axes.texts] == ["4", "6", "8", "10"]


def test_a_study_of_one_key_is_a_curve() -> None:
    text = "[driveline]\nbends_deg = [10, 10]\n[load]\nspeed_rpm = 600\noutput_torque_Nm = 1\n"
    text += "[study]\nbends_deg.1 = [12, 8, 10]\nspeed_rpm = [600]\n"
    text += "[output]\nclosed_forms = ['equivalent_bend', 'non_uniformity']\n"
    axes = plots.plot_study(study(text))
    x, y = curve(axes, 0)
    np.testing.assert_array_equal(x, [8, 10, 12])
    line = Driveline.from_bends(np.array([[10, 8], [10, 10], [10, 12]]), degrees=True)
    np.testing.assert_allclose(y, np.degrees(line.equivalent().bend), rtol=1e-12, atol=1e-7)
    np.testing.assert_allclose(curve(axes, 1)[1], 3.0, rtol=1e-15)
    bare = plots.plot_study(study(text), "non_uniformity")
    assert len(bare.get_lines()) == 1
    assert bare.get_legend() is None
    limited = plots.plot_study(study(text), "non_uniformity", limit=0.0027)
    legend = limited.get_legend()
    assert legend is not None
    assert legend.get_texts()[0].get_text() == "limit 0.0027"


@pytest.mark.parametrize("few_first", [False, True])
def test_a_key_of_few_values_makes_a_curve_of_each(few_first: bool) -> None:
    few, many = "phases_deg.0 = [5, 0]\n", "bends_deg.1 = {from = 5, to = 15, steps = 11}\n"
    text = "[driveline]\nbends_deg = [10, 10]\nphases_deg = [0]\n[study]\n"
    axes = plots.plot_study(study(text + (few + many if few_first else many + few)))
    bends = np.array([[10.0, bend] for bend in range(5, 16)])
    for place, phase in enumerate((0.0, 5.0)):
        x, y = curve(axes, place)
        np.testing.assert_array_equal(x, bends[:, 1])
        want = Driveline.from_bends(bends, phases=phase, degrees=True).equivalent().bend
        np.testing.assert_allclose(y, np.degrees(want), rtol=1e-12, atol=1e-6)
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_title().get_text() == "phase, shaft 1 [deg]"
    assert [text.get_text() for text in legend.get_texts()] == ["0", "5", "limit 3 deg"]
    assert axes.get_xlabel() == "bend, joint 1 [deg]"


def test_a_flat_map_shows_no_rounding() -> None:
    text = "[driveline]\nbends_deg = [7, 7]\n[study]\nbends_deg.0-1 = [7, 7, 7, 7, 7, 7]\n"
    text += "phases_deg.0 = {from = 0, to = 1800, steps = 11}\n"
    axes = plots.plot_study(study(text), "non_uniformity")
    lines = [item for item in axes.collections if isinstance(item, ContourSet)]
    assert len(lines) == 1
    assert list(lines[0].levels) == [-1.0, 1.0]


def test_studies_that_make_no_picture() -> None:
    with pytest.raises(ValueError, match="known are equivalent_bend, non_uniformity"):
        plots.plot_study(study(COMPENSATION), "bend")
    text = COMPENSATION.replace("[10, 10]", "[10, 10]\ntwists_deg = [0]")
    with pytest.raises(ValueError, match="varies 3 keys; a picture shows 1 or 2"):
        plots.plot_study(study(text + "twists_deg.0 = [0, 1]\n"))


def test_hodograph_is_a_circle_and_an_ellipse() -> None:
    axes = plots.plot_hodograph(SINGLE)
    bend, turn = np.radians(50.0), np.radians(np.arange(361) / 2)
    found = SINGLE.evaluate(
        turn, ("bending_driving", "bending_driven"), joints=0, load=Load(drive_torque=1.0)
    )
    (x, y), (_, _), (across, up), (marks, _) = (curve(axes, place) for place in range(4))
    np.testing.assert_allclose(np.hypot(x - np.tan(bend) / 2, y), np.tan(bend) / 2, rtol=1e-13)
    np.testing.assert_allclose(np.hypot(x, y), found.bending_driving, atol=1e-14)
    np.testing.assert_allclose(np.hypot(across, up), found.bending_driven, atol=1e-14)
    assert [text.get_text() for text in axes.texts[:6]] == [f"{a}°" for a in range(0, 180, 30)]
    np.testing.assert_array_equal(marks, across[:360:60])
    assert axes.get_xlabel() == "moment in the bend plane / drive torque"
    loaded = plots.plot_hodograph(TRUCK, 1, load=FLYWHEEL)
    assert loaded.get_xlabel() == "moment in the bend plane [N m]"
    with pytest.raises(ValueError, match="shows one driveline"):
        plots.plot_hodograph(SEVERAL)


# --- driveline in space ----------------------------------------------------------------------


def test_yoke_pins_are_those_of_the_vector_picture() -> None:
    shafts = reference.from_points(POINTS, phases=[0.3, -0.7])
    for angle in (0.0, 1.0, 4.0):
        pins = plots.yoke_pins(TRUCK, angle)
        for joint, (driving, driven) in zip(vectors._joints(shafts, angle), pins, strict=True):
            np.testing.assert_allclose(driving, joint.a, atol=1e-14)
            np.testing.assert_allclose(driven, joint.b, atol=1e-14)
    with pytest.raises(ValueError, match="shows one driveline"):
        plots.yoke_pins(SEVERAL)


def lines_named(axes: Axes, name: str) -> list[FloatArray]:
    """The lines of a label, ``(points, 2)``."""
    return [
        np.asarray(line.get_xydata(), float)
        for line in axes.get_lines()
        if line.get_label() == f"_{name}"
    ]


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_yokes_end_at_their_pins(angle: float) -> None:
    axes = plots.plot_driveline(TRUCK, angle, points=POINTS)
    assert (axes.get_aspect(), axes.get_adjustable()) == (1.0, "datalim")
    flat = View.of(TRUCK.directions).axes[:2].T
    sizes = []
    joints = vectors._joints(reference.from_points(POINTS, phases=[0.3, -0.7]), angle)
    for number, joint in enumerate(joints):
        centre = np.array(POINTS[number + 1]) @ flat
        pins = lines_named(axes, f"pin {number}")
        assert len(pins) == 4
        for name, pin, along in (
            ("driving yoke", joint.a, -TRUCK.directions[number]),
            ("driven yoke", joint.b, TRUCK.directions[number + 1]),
        ):
            halves = lines_named(axes, f"{name} {number}")
            first, last = halves if np.allclose(halves[0][-1], halves[1][0]) else halves[::-1]
            size = float(np.linalg.norm(first[0] - centre) / np.linalg.norm(pin @ flat))
            sizes.append(size)
            tips, base = np.array([pin, np.negative(pin)]) @ flat, np.asarray(along) @ flat
            np.testing.assert_allclose([first[0], last[-1]], centre + size * tips, rtol=1e-12)
            np.testing.assert_allclose(first[-1], last[0])
            np.testing.assert_allclose(first[-1], centre + 1.3 * size * base, rtol=1e-12)
            for tip in centre + size * tips:
                assert sum(bool(np.allclose(bar, [centre, tip])) for bar in pins) == 1
    np.testing.assert_allclose(sizes, sizes[0], rtol=1e-9)


@pytest.mark.parametrize("line", [SPATIAL, TRUCK])
def test_a_driveline_is_not_mirrored(line: Driveline) -> None:
    right, up, viewer = View.of(line.directions).axes
    assert np.cross(right, up) @ viewer > 0.0
    np.testing.assert_allclose([right @ viewer, up @ viewer], 0.0, atol=1e-12)
    assert right[0] > 0.8  # x to the right
    assert up[1] > 0.8  # y upwards
    assert viewer[2] > 0.8  # z towards the reader
    assert viewer[0] < 0.0  # who sees the drive's end
    axes = plots.plot_driveline(line)
    places = {text.get_text(): text.get_position() for text in axes.texts}
    assert places["drive"][0] < places["output"][0]
    assert "looking from the drive towards the output" in places
    # The axes beside it have the directions of the view.
    size = axes.bbox.size
    origin = np.array([13.0, 11.0])
    for i, name in enumerate("xyz"):
        towards = np.array(places[name]) * size * 72.0 / axes.figure.dpi - origin
        along = np.array([right[i], up[i]])
        np.testing.assert_allclose(
            towards / np.linalg.norm(towards), along / np.linalg.norm(along), atol=1e-9
        )


def test_a_shaft_that_falls_falls_in_the_picture() -> None:
    """Lengths and heights in the plane of the side view are those of the points, to scale."""
    points = [[0, 0, 0], [300, 0, 0], [1500, -255, 0], [1800, -255, 0]]
    axes = plots.plot_driveline(Driveline.from_points(points), points=points)
    centres = [lines_named(axes, f"pin {joint}")[0][0] for joint in range(2)]
    np.testing.assert_allclose(centres[1] - centres[0], [1200.0, -255.0])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_any_direction_points_to_the_right(axis: int, sign: float) -> None:
    directions = np.zeros((3, 3))
    directions[:, axis] = sign
    right, up, viewer = View.of(directions).axes
    assert sign * right[axis] > 0.8
    assert np.cross(right, up) @ viewer > 0.0
    # Shafts that come back are seen as the drive's shaft lies.
    back = np.concatenate([directions, -directions])
    np.testing.assert_array_equal(View.of(back).axes, [right, up, viewer])
    # A shaft along the line of sight can be drawn, too.
    assert np.isfinite(
        np.concatenate(space.tube(viewer, 3 * viewer, 1.0, View.of(directions)))
    ).all()


def test_labels_cover_no_part_of_a_driveline(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in IN_SPACE:
        axes = PICTURES[name][1]()
        figure = axes.get_figure()
        assert isinstance(figure, Figure)
        found = texts(figure, monkeypatch)
        for line in axes.get_lines():
            seen = line.get_transform().transform(line.get_xydata())
            if not seen.size:
                continue
            starts, steps = seen[:-1, None], np.diff(seen, axis=0)[:, None]
            dense = (starts + np.linspace(0, 1, 20)[:, None] * steps).reshape(-1, 2)
            for text, box in found:
                x, y = dense.T
                inside = (box.x0 < x) & (x < box.x1) & (box.y0 < y) & (y < box.y1)
                assert not inside.any(), (name, text)


def test_labels_lie_in_the_nearest_free_place() -> None:
    size = float(matplotlib.rcParams["font.size"])
    width, height = text_width("joint 0", size), 1.25 * size
    anchor = np.array([200.0, 150.0])

    def labels_among(*bars: float) -> PlacedLabels:
        """Bars from side to side so far above the anchor."""
        along = np.linspace(0.0, 400.0, 201)
        drawn = [np.stack([along, np.full(201, anchor[1] + bar)], axis=-1) for bar in bars]
        return PlacedLabels(Figure().add_subplot(), (400.0, 300.0), np.concatenate(drawn))

    def placed(labels: PlacedLabels, *, above: bool) -> tuple[float, float]:
        """Offset of the middle of a new label from the anchor."""
        assert labels.beside(anchor, "joint 0", 5.0, above=above)
        box = labels.boxes[-1]
        assert (box[2] - box[0], box[3] - box[1]) == pytest.approx((width, height))
        middle = np.array([(box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0])
        written = np.multiply(labels.axes.texts[-1].xy, labels.size)  # type: ignore[attr-defined]
        np.testing.assert_allclose(written, middle, atol=1e-9)
        x, y = middle - anchor
        return float(x), float(y)

    labels = labels_among(0.0)
    assert placed(labels, above=True) == pytest.approx((0.0, 5.0 + height / 2.0))
    assert placed(labels, above=True) == pytest.approx((0.0, -5.0 - height / 2.0))
    assert not labels.axes.lines
    # All other places are taken, or a line to them would run through a label.
    assert not labels.beside(anchor, "joint 0", 5.0, above=True)
    assert len(labels.boxes) == len(labels.axes.texts) == 2
    # In steps of 2, with room of 2 around the label. A line leads to one that is so far.
    for above, side in ((True, 1.0), (False, -1.0)):
        labels = labels_among(14.0, -14.0)
        x, y = placed(labels, above=above)
        assert (x, y) == pytest.approx((0.0, side * (5.0 + 12.0 + height / 2.0)))
        (line,) = labels.axes.lines
        ends = np.asarray(line.get_xydata()) * labels.size - anchor
        np.testing.assert_allclose(ends, [[0.0, side * 5.0], [0.0, side * 17.0]], atol=1e-9)
    # Below is nearer than above by more than the preference.
    assert placed(labels_among(18.0), above=True)[1] < 0.0
    # To the left or to the right, where something is drawn on the other side.
    for side in (1.0, -1.0):
        labels = labels_among(0.0)
        upright = anchor + np.stack([np.full(99, -5.0 * side), np.linspace(-150, 150, 99)], axis=-1)
        labels.drawn = np.concatenate([labels.drawn, upright])
        assert placed(labels, above=True) == pytest.approx((14.0 * side, 5.0 + height / 2.0))
    # Farther aside a line leads to it.
    labels = labels_among(0.0)
    assert labels.beside(np.array([3.0, 290.0]), "joint 0", 5.0, above=True)
    (line,) = labels.axes.lines
    ends = np.asarray(line.get_xydata()) * labels.size
    np.testing.assert_allclose(ends, [[3.0, 285.0], [31.0, 285.0]], atol=1e-9)
    # No label leaves the drawing.
    assert not labels_among(0.0).beside(np.array([-20.0, 290.0]), "joint 0", 5.0, above=True)


def test_bends_and_phases_are_named() -> None:
    axes = plots.plot_driveline(TRUCK, points=POINTS)
    named = {text.get_text() for text in axes.texts}
    for joint, bend in enumerate(np.degrees(TRUCK.bends)):
        assert f"joint {joint}\n{round(bend, 2):g}°" in named
    for shaft, phase in ((1, "17.2"), (2, "\N{MINUS SIGN}40.1")):
        assert f"shaft {shaft}\nphase {phase}°" in named


def named_lengths(axes: Axes) -> list[str]:
    """The last lines of the labels of shafts that have more than name and phase."""
    texts = [text.get_text().split("\n") for text in axes.texts]
    return [lines[2] for lines in texts if lines[0].startswith("shaft") and len(lines) > 2]


def test_lengths_are_named_in_the_unit_of_the_scene() -> None:
    straight = np.linalg.norm(np.diff(POINTS, axis=0), axis=-1)[1:-1]
    for unit, factor in (("mm", 1e-3), ("m", 1.0)):
        text = f"[driveline]\npoints_{unit} = {(np.array(POINTS)).tolist()}\n"
        result = Scene.parse(text).run()
        np.testing.assert_allclose(result.scene.line.lengths().each[1:-1], factor * straight)
        (axes,) = (axes for axes in drawn(result).axes if axes.get_label() == "driveline")
        shown = named_lengths(axes)
        assert [name.split()[1] for name in shown] == [unit, unit]
        found = [float(name.split()[0]) for name in shown]
        np.testing.assert_allclose(found, straight, rtol=5e-4)
    for text in ("lengths_mm = [200, 1234.56, 300]", "lengths_m = [0.2, 1.23456, 0.3]"):
        result = Scene.parse(f"[driveline]\nbends_deg = [5, 5]\n{text}\n").run()
        (axes,) = (axes for axes in drawn(result).axes if axes.get_label() == "driveline")
        assert named_lengths(axes) == ["1234.6 mm" if "mm" in text else "1.2346 m"]


def test_lengths_that_are_not_known_or_not_wanted_are_not_named() -> None:
    assert named_lengths(plots.plot_driveline(TRUCK, points=POINTS)) == []
    line = Driveline.from_bends([5, 5], degrees=True)
    assert named_lengths(plots.plot_driveline(line, length_unit="mm")) == []
    assert (
        len(named_lengths(plots.plot_driveline(Driveline.from_points(POINTS), length_unit="m")))
        == 2
    )
    with pytest.raises(ValueError, match="length_unit is 'inch'; it must be 'mm' or 'm'"):
        plots.plot_driveline(line, length_unit="inch")  # type: ignore[arg-type]


def test_bends_lie_in_their_planes() -> None:
    for joint, centre in enumerate(np.array(POINTS)[1:-1]):
        before, after = TRUCK.directions[joint : joint + 2]
        area = space.wedge(centre, before, after, 2.0) - centre
        np.testing.assert_allclose(area @ TRUCK.normals[joint], 0.0, atol=1e-9)
        np.testing.assert_allclose(area[[1, -1]], 2.0 * np.array([before, after]), atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(area[1:], axis=1), 2.0)


def test_a_scene_of_points_is_drawn_with_its_lengths() -> None:
    path = next(path for path in EXAMPLES if path.stem == "three_joints_by_points")
    result = Scene.load(path).run()
    (axes,) = (axes for axes in drawn(result).axes if axes.get_label() == "driveline")
    right, up = View.of(result.scene.line.directions).axes[:2]
    centres = [lines_named(axes, f"pin {joint}")[0][0] for joint in range(3)]
    np.testing.assert_allclose(centres, np.array(POINTS)[1:-1] @ np.stack([right, up]).T)


def test_drivelines_that_make_no_picture() -> None:
    with pytest.raises(ValueError, match="shows one driveline"):
        plots.plot_driveline(SEVERAL)
    with pytest.raises(ValueError, match=r"points has shape \(3, 3\); it must be \(5, 3\)"):
        plots.plot_driveline(TRUCK, points=POINTS[:3])
    moved = np.array(POINTS)
    moved[3, 1] = -100
    with pytest.raises(ValueError, match=r"points\[2\] and \[3\] do not lie along shaft 2"):
        plots.plot_driveline(TRUCK, points=moved)


@pytest.mark.parametrize("name", ["angle error", "map", "truck"])
def test_saved_pictures_are_the_same_every_time(name: str, tmp_path: Path) -> None:
    for path in (tmp_path / "one.svg", tmp_path / "other.svg"):
        figure = PICTURES[name][1]().get_figure()
        assert isinstance(figure, Figure)
        plots.save(figure, path)
    text = (tmp_path / "one.svg").read_bytes()
    assert text == (tmp_path / "other.svg").read_bytes()
    assert b"dc:date" not in text
    assert float(re.findall(rb'width="([0-9.]+)pt"', text)[0]) == pytest.approx(80 / 25.4 * 72)


# --- pictures of the documentation -----------------------------------------------------------

DRAWINGS = DOCS / "drawings"


def drawings() -> list[Any]:
    sys.path.insert(0, str(DRAWINGS))
    try:
        modules = [importlib.import_module(name) for name in ("draw", "mechanisms", "machines")]
        return [draw() for module in modules for draw in module.DRAWINGS]
    finally:
        sys.path.remove(str(DRAWINGS))


def test_labels_of_drawings_lie_in_them_and_clear_of_lines() -> None:
    for drawing in drawings():
        boxes = [(text, Bbox.from_extents(box)) for text, box in drawing.labels]
        pairs = np.array([pair for line in drawing.lines for pair in pairwise(line)])
        starts, steps = pairs[:, :1], np.diff(pairs, axis=1)
        drawn = (starts + np.linspace(0, 1, 99)[:, None] * steps).reshape(-1, 2)
        for text, box in boxes:
            assert min(box.x0, box.y0) >= 0, text
            assert box.x1 <= drawing.size[0], text
            assert box.y1 <= drawing.size[1], text
            x, y = drawn.T
            inside = (box.x0 < x) & (x < box.x1) & (box.y0 < y) & (y < box.y1)
            assert not inside.any(), text
        for (one, here), (other, there) in combinations(boxes, 2):
            assert not here.overlaps(there), (one, other)


JOINTS = Driveline.from_bends([0.3, 0.2])
SOUND: dict[str, Any] = {"line": JOINTS, "length": 60.0, "synchronous_deg": 30.0}
"""What the pictures take that need nothing else."""


@pytest.mark.parametrize("name", [name for name in plots.__all__ if name.startswith("plot_")])
@pytest.mark.parametrize(
    "wrong",
    [[[10.0, 20.0]], math.nan, object(), Driveline.from_bends(np.zeros((0, 2)))],
    ids=["nested list", "nan", "object", "no driveline"],
)
def test_arguments_of_a_wrong_kind_are_named(name: str, wrong: object) -> None:
    function = getattr(plots, name)
    parameters = inspect.signature(function).parameters.values()
    needed = [p.name for p in parameters if p.default is inspect.Parameter.empty]
    first = next(iter(parameters)).name
    # What is asked for is read after what is drawn.
    judged = [p.name for p in parameters] if set(needed) <= SOUND.keys() else [first]
    for argument in set(judged) - {"load", "bearing", "joint"}:
        given = {own: SOUND.get(own, wrong) for own in needed} | {argument: wrong}
        if (argument, type(wrong)) == ("orders", Driveline):
            continue
        with pytest.raises(ArgumentError) as error:
            function(**given)
        assert error.value.argument in (argument, f"{argument}s"), error.value
    pyplot.close("all")


@pytest.mark.parametrize(
    "draw", [plots.plot_driven_angle, plots.plot_torque_ratio, plots.plot_bending_moments]
)
def test_a_picture_of_one_bend_refuses_several(draw: Callable[..., Axes]) -> None:
    """The last of them would draw two joints as one."""
    with pytest.raises(ArgumentError, match=r"^bend_deg has shape \(2,\); it must be one number$"):
        draw([10.0, 20.0])
