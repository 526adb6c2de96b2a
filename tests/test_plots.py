"""The picture of a scene: what it shows, that it can be read, that it is the same every time."""

from __future__ import annotations

import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from cardan.plots import plot_scene, write_picture
from cardan.scene import Scene, SceneResult

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))

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
    FigureCanvasAgg(figure).draw()  # type: ignore[no-untyped-call]
    return figure


def headings(figure: Figure) -> list[str]:
    return [axes.get_title(loc="left") for axes in figure.axes]


def foeppl() -> SceneResult:
    return Scene.load(next(path for path in EXAMPLES if path.stem == "foeppl")).run()


def test_one_panel_per_quantity() -> None:
    result = foeppl()
    figure = drawn(result)
    assert headings(figure) == [
        "angle error, shaft 1 [deg]",
        "speed ratio, shaft 1",
        "acceleration, shaft 1 [rad/s²]",
        "torque, shaft 1 [N m]",
        "moment, joint 0 [N m]",
    ]
    assert figure.axes[-1].get_xlabel() == "drive angle [deg]"
    assert figure.get_suptitle() == "Föppl's rig (Thoma 1920)"
    assert figure.get_figwidth() == pytest.approx(80 / 25.4)
    ticks = [tick for tick in figure.axes[-1].get_xticks() if 0 <= tick <= 360]
    assert ticks == [0, 90, 180, 270, 360]


def test_curves_are_the_values() -> None:
    result = foeppl()
    values, speed2 = result.values, (100 * np.pi) ** 2
    want = [
        [np.degrees(values["angle_error"])],
        [values["speed_ratio"]],
        [values["acceleration_ratio"] * speed2],
        [values["torque"]],
        list(values["moment"][0].T),
    ]
    for axes, curves in zip(drawn(result).axes, want, strict=True):
        for line, curve in zip(axes.get_lines(), curves, strict=True):
            np.testing.assert_array_equal(line.get_xdata(), result.scene.drive_angle_deg)
            np.testing.assert_allclose(np.asarray(line.get_ydata(), float), curve, rtol=1e-14)


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


@pytest.mark.parametrize("text", [*(path.read_text("utf-8") for path in EXAMPLES), TALL])
def test_nothing_overlaps(text: str) -> None:
    figure = drawn(Scene.parse(text, folder=EXAMPLES[0].parent).run())

    def tick_boxes(axes: Axes) -> list[Bbox]:
        low, high = axes.get_ylim()
        ticks = zip(axes.get_yticks(), axes.get_yticklabels(), strict=True)
        return [label.get_window_extent() for tick, label in ticks if low <= tick <= high]

    def heading_box(axes: Axes) -> Bbox:
        heading = axes.get_title(loc="left")
        (box,) = (
            child.get_window_extent()
            for child in axes.get_children()
            if isinstance(child, Text) and child.get_text() == heading
        )
        return box

    page = figure.bbox
    for axes in figure.axes:
        heading, legend, ticks = heading_box(axes), axes.get_legend(), tick_boxes(axes)
        assert len(ticks) >= 2
        assert page.x0 <= heading.x0
        assert heading.x1 <= page.x1
        for one, other in pairwise(ticks):
            assert not one.overlaps(other)
        for box in ticks:
            assert page.x0 <= box.x0
            assert not box.overlaps(heading)
        if legend is not None:
            assert not legend.get_window_extent().overlaps(heading)
            assert not any(legend.get_window_extent().overlaps(line) for line in ticks)
        assert axes.yaxis.get_offset_text().get_text() == ""
    for upper, lower in pairwise(figure.axes):
        assert upper.get_window_extent().y0 > heading_box(lower).y1
    title = figure.texts[0].get_window_extent()
    assert page.x0 <= title.x0
    assert title.x1 <= page.x1
    assert title.y0 > heading_box(figure.axes[0]).y1


def test_components_can_be_told_apart_in_grey() -> None:
    lines = drawn(foeppl()).axes[-1].get_lines()
    assert [line.get_label() for line in lines] == ["x", "y", "z"]
    assert len({str(line._dash_pattern) for line in lines}) == 3  # type: ignore[attr-defined]


def test_rounding_does_not_fill_a_panel() -> None:
    scene = "[driveline]\nbends_deg = [33, 33]\ntwists_deg = [10]\nphases_deg = [190]\n"
    scene += "[load]\noutput_torque_Nm = 5000\n"
    figure = drawn(Scene.parse(scene).run())
    limits = dict(zip(headings(figure), (axes.get_ylim() for axes in figure.axes), strict=True))
    assert limits["angle error, shaft 2 [deg]"] == pytest.approx((-1, 1))
    assert limits["speed ratio, shaft 2"] == pytest.approx((0.95, 1.05))
    assert limits["torque, shaft 2 [N m]"] == pytest.approx((4750, 5250))


@pytest.mark.parametrize(
    ("suffix", "start"), [(".svg", b"<?xml"), (".png", b"\x89PNG"), (".pdf", b"%PDF")]
)
def test_files_are_the_same_every_time(tmp_path: Path, suffix: str, start: bytes) -> None:
    one, other = tmp_path / f"one{suffix}", tmp_path / f"other{suffix}"
    write_picture(foeppl(), one)
    write_picture(foeppl(), other)
    assert one.read_bytes().startswith(start)
    assert one.read_bytes() == other.read_bytes()
    assert sorted(tmp_path.iterdir()) == [one, other]


@pytest.mark.parametrize(("suffix", "date"), [(".svg", b"dc:date"), (".pdf", b"CreationDate")])
def test_files_have_no_date(tmp_path: Path, suffix: str, date: bytes) -> None:
    path = tmp_path / f"a{suffix}"
    write_picture(foeppl(), path)
    assert date not in path.read_bytes()


def test_settings_of_the_caller_stay(tmp_path: Path) -> None:
    with matplotlib.rc_context({"font.size": 11.5, "svg.hashsalt": "own"}):
        before = dict(matplotlib.rcParams)
        write_picture(foeppl(), tmp_path / "a.svg")
        assert dict(matplotlib.rcParams) == before


def test_pyplot_stays_out(tmp_path: Path) -> None:
    script = (
        "import sys; from cardan.scene import Scene; from cardan.plots import write_picture\n"
        "assert 'matplotlib' not in sys.modules\n"
        "result = Scene.parse('[driveline]\\nbends_deg = [8.5]').run()\n"
        f"write_picture(result, {str(tmp_path / 'a.png')!r})\n"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_without_matplotlib(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"needs matplotlib: pip install 'cardan\[app\]'"):
        write_picture(foeppl(), tmp_path / "a.svg")
    assert list(tmp_path.iterdir()) == []


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
