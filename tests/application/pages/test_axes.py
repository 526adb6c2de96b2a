"""Pictures on axes: what they show, that they can be read, and which arguments they refuse."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cardan import ArgumentError, reference
from cardan.app import plots
from cardan.app.pictures.space import View
from cardan.app.scene import Scene
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.sweep import Sweep
from cardan.reference import vectors
from cardan.reference.approximations import thoma_moment_ratios, thoma_small_angle
from drawn_texts import drawn, texts
from example_scenes import EXAMPLES

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


# --- figures of the sources ------------------------------------------------------------------


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


# What annotations refuse as well.
ANGLE: Any = "angle"
TWO: Any = [10.0, 20.0]
MOVED = [*POINTS[:3], [3150.0, -100.0, 45.0], POINTS[4]]
FEW = "at most 6 curves that can be told apart"
THREE_KEYS = (
    COMPENSATION.replace("[10, 10]", "[10, 10]\ntwists_deg = [0]") + "twists_deg.0 = [0, 1]"
)


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (
            partial(plots.plot_curves, SEVERAL[:, None]),
            r"shape \(3, 1\); .* batch of one dimension",
        ),
        (partial(plots.plot_curves, SEVERAL, "moment", load=FLYWHEEL), "shows one driveline"),
        (partial(plots.plot_curves, SINGLE, "angel"), "did you mean 'angle'"),
        (partial(plots.plot_curves, SINGLE, "angle", angle=1.0), r"angle has shape \(\)"),
        (partial(plots.plot_curves, SEVERAL, labels=["one"]), "1 entries; there are 3 curves"),
        (partial(plots.plot_curves, SINGLE, "torque"), "load"),
        (partial(plots.plot_curves, Driveline.from_bends(np.full((7, 1), 0.1))), FEW),
        (
            lambda: plots.plot_result(TRUCK.evaluate(np.zeros(3), "moment", load=FLYWHEEL)),
            r"9 curves of moment; .* evaluate fewer shafts, joints",
        ),
        (
            lambda: plots.plot_result(TRUCK.evaluate(np.zeros(3), "bearing_force", load=FLYWHEEL)),
            r"15 curves of .* draw each bearing with cardan",
        ),
        (partial(plots.plot_bend_vectors, SEVERAL, 1), "shows one driveline"),
        (partial(plots.plot_bend_vectors, SPATIAL, 0), "must lie between two joints"),
        (partial(plots.plot_bend_vectors, SPATIAL, -1), "must lie between two joints"),
        (
            partial(plots.plot_bend_vectors, Driveline.from_bends([0, 0.1])),
            "a straight joint beside",
        ),
        (partial(plots.plot_harmonics, SEVERAL[None]), "batch of one dimension"),
        (lambda: plots.plot_harmonics(SINGLE, ANGLE), "known are angle_error, speed_ratio"),
        (partial(plots.plot_harmonics, SINGLE, orders=[0]), "an order is at least 1"),
        (lambda: plots.plot_study(study(COMPENSATION), "bend"), "known are equivalent_bend, non_u"),
        (lambda: plots.plot_study(study(THREE_KEYS)), "varies 3 keys; a picture shows 1 or 2"),
        (partial(plots.plot_driveline, SEVERAL), "shows one driveline"),
        (
            partial(plots.plot_driveline, TRUCK, points=POINTS[:3]),
            r"points has shape \(3, 3\); it must be \(5, 3\)",
        ),
        (
            partial(plots.plot_driveline, TRUCK, points=MOVED),
            r"points\[2\] and \[3\] do not lie along shaft 2",
        ),
        *(
            (partial(draw, TWO), r"^bend_deg has shape \(2,\); it must be one number$")
            for draw in (
                plots.plot_driven_angle,
                plots.plot_torque_ratio,
                plots.plot_bending_moments,
            )
        ),
    ],
)
def test_what_makes_no_picture_is_refused(draw: Callable[[], Axes], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        draw()
    assert pyplot.get_fignums() == []
