"""Pictures and page of torsional vibration show the numbers that the library computes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle
from matplotlib.text import Annotation

from cardan.app.answers.torsion.figures import TorsionFigures, torsion_figures
from cardan.app.plots import (
    plot_campbell,
    plot_part,
    plot_stability,
    plot_torsion,
    plot_torsion_response,
)
from cardan.app.report import write_report
from cardan.app.scene import Scene
from engine_cases import ENGINE
from example_scenes import Answers, example, replaced
from pages import curves, figure

ROOT = Path(__file__).parents[2]
RPM = np.pi / 30.0
TRUCK, RIG = (Scene.load(ROOT / "examples" / f"{name}_torsion.toml") for name in ("truck", "rig"))


@pytest.fixture(scope="module")
def truck() -> TorsionFigures:
    found = torsion_figures(TRUCK)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def rig() -> TorsionFigures:
    found = torsion_figures(RIG)
    assert found is not None
    return found


@pytest.fixture(autouse=True)
def _closed() -> object:
    yield
    pyplot.close("all")


def vertical_lines(axes: Axes) -> list[float]:
    """The speeds of dashed lines from bottom to top."""
    lines = [line for line in axes.get_lines() if np.asarray(line.get_ydata()).tolist() == [0, 1]]
    return sorted(float(np.asarray(line.get_xdata())[0]) for line in lines)


def marks(axes: Axes) -> list[Annotation]:
    """The texts that are at a place of the axes."""
    return [text for text in axes.texts if isinstance(text, Annotation)]


def test_the_response_has_torques_and_critical_speeds(truck: TorsionFigures) -> None:
    assert TRUCK.torsion is not None
    for place, shaft in enumerate((1, 2)):
        axes = plot_torsion_response(truck, shaft)
        most, least, mean = axes.get_lines()[:3]
        x = np.asarray(most.get_xdata(), dtype=np.float64)
        chosen = [0, len(x) // 3, len(x) // 2, -1]
        own = TRUCK.torsion.system.steady(x[chosen] * RPM)
        for line, values in ((most, own.torque_max), (least, own.torque_min)):
            drawn = np.asarray(line.get_ydata(), dtype=np.float64)[chosen]
            assert drawn == pytest.approx(values[place], rel=1e-9)
        assert np.asarray(mean.get_ydata())[chosen] == pytest.approx(own.torque_mean[place])
        # Both orders of the lower natural frequency; the other one is above the range.
        natural = TRUCK.torsion.system.natural_frequencies()[0] / RPM
        assert vertical_lines(axes) == pytest.approx([natural / 4, natural / 2])
        labels = [text.get_text() for text in axes.texts]
        assert sorted(labels) == ["2", "4"]
        places = {mark.get_text(): float(mark.xy[0]) for mark in marks(axes)}
        assert places["2"] == pytest.approx(natural / 2)
        assert axes.get_xlim() == pytest.approx((500, 3000))
        assert axes.get_ylabel() == f"torque of shaft {shaft} [N m]"
        # The peak is drawn, not cut between two speeds of the scene.
        largest = truck.largest[place]
        assert np.max(np.asarray(most.get_ydata())) == pytest.approx(largest.most, rel=1e-2)
    with pytest.raises(ValueError, match="shaft is 0; compliant shafts: 1, 2"):
        plot_torsion_response(truck, 0)


def test_orders_that_joints_do_not_excite_are_not_marked() -> None:
    text = (ROOT / "examples" / "rig_torsion.toml").read_text(encoding="utf-8")
    found = torsion_figures(Scene.parse(text.replace("[2, 4, 6]", "[2, 3]")))
    assert found is not None
    speeds = vertical_lines(plot_torsion_response(found))
    assert speeds == pytest.approx([found.modes[0].frequency / RPM / 2])


def test_the_response_marks_unstable_speeds(rig: TorsionFigures) -> None:
    axes = plot_torsion_response(rig)
    spans = [
        (patch.get_x(), patch.get_x() + patch.get_width())
        for patch in axes.patches
        if isinstance(patch, Rectangle) and patch.get_hatch()
    ]
    expected = [(part.start / RPM, part.stop / RPM) for part in rig.unstable]
    assert np.array(spans) == pytest.approx(np.array(expected))
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()].count("unstable") == 1
    # Each edge separates stable from unstable speeds.
    assert RIG.torsion is not None
    edges = np.array(spans).ravel()
    outside = edges * np.tile([1.0 - 1e-4, 1.0 + 1e-4], len(spans)) * RPM
    inside = edges * np.tile([1.0 + 1e-4, 1.0 - 1e-4], len(spans)) * RPM
    assert RIG.torsion.system.stability(outside).stable.all()
    assert not RIG.torsion.system.stability(inside).stable.any()


def test_campbell_lines_cross_at_the_critical_speeds(truck: TorsionFigures) -> None:
    axes = plot_campbell(truck)
    rays = {line.get_label(): line for line in axes.get_lines()}
    points = next(line for line in axes.get_lines() if line.get_marker() == "o")
    x, y = (np.asarray(data, dtype=np.float64) for data in points.get_data())
    assert TRUCK.torsion is not None
    frequencies = TRUCK.torsion.system.natural_frequencies() / (2.0 * np.pi)
    assert len(x) == 4
    for order in (2, 4):
        (start, stop) = np.asarray(rays[f"order {order}"].get_xdata(), dtype=np.float64)
        low, high = np.asarray(rays[f"order {order}"].get_ydata(), dtype=np.float64)
        assert (start, low) == (0.0, 0.0)
        slope = high / stop
        assert slope == pytest.approx(order / 60.0)
        for frequency in frequencies:
            assert np.any(np.isclose(x, frequency / slope) & np.isclose(y, frequency))
    shaded = next(patch for patch in axes.patches if isinstance(patch, Rectangle | Polygon))
    assert isinstance(shaded, Rectangle)
    assert shaded.get_x() == pytest.approx(500)
    assert shaded.get_x() + shaded.get_width() == pytest.approx(3000)
    heights = [mark.xy[1] for mark in marks(axes)]
    assert heights == pytest.approx(frequencies)


def test_the_map_of_stability_is_that_of_the_library(rig: TorsionFigures) -> None:
    axes = plot_stability(rig)
    unstable = axes.collections[0]
    assert RIG.torsion is not None
    given = RIG.torsion
    points = np.array(
        [(3030, 25), (3030, 20), (3030, 12), (2600, 25), (3400, 25), (2800, 38), (2000, 8)]
    )
    paths = unstable.get_paths()
    inside = [any(path.contains_point(point) for path in paths) for point in points]
    line = type(given.system.line)
    for (speed, bend), drawn in zip(points, inside, strict=True):
        changed = given.system.changed(line.from_bends([bend], degrees=True))
        assert drawn != bool(changed.stability(speed * RPM).stable), (speed, bend)
    assert inside == [True, True, False, False, False, True, False]
    # The lowest unstable bend is that of the rule, tan²(bend/2) = damping ratio, to leading order.
    corners = np.concatenate([np.asarray(path.vertices, dtype=np.float64) for path in paths])
    lowest = np.min(corners[np.abs(corners[:, 0] - 3030) < 200, 1])
    assert lowest == pytest.approx(2.0 * np.degrees(np.arctan(np.sqrt(0.02))), abs=0.5)
    assert axes.get_ylabel() == "bend of joint 0 [deg]"
    assert axes.get_ylim() == pytest.approx((0.0, 50.0))
    assert np.max(corners[:, 1]) == pytest.approx(50.0)
    marked = next(line for line in axes.get_lines() if line.get_label() == "bend of the scene")
    assert np.asarray(marked.get_ydata()) == pytest.approx(25.0)
    with pytest.raises(ValueError, match="joint is 1; there are 1, counted from 0"):
        plot_stability(rig, 1)


def test_a_figure_has_a_panel_for_each_compliant_shaft(truck: TorsionFigures) -> None:
    figure = plot_torsion(truck, title="A truck")
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "torque of shaft 1 [N m]",
        "torque of shaft 2 [N m]",
    ]
    (width, _) = figure.get_size_inches()
    assert width == pytest.approx(80.0 / 25.4)
    assert figure.get_suptitle() == "A truck"
    assert len(plot_part(TRUCK, "campbell").axes) == 1
    with pytest.raises(ValueError, match="name is 'map'; known are drive_speed, backlash"):
        plot_part(TRUCK, "map")


def test_the_page_has_a_section(tmp_path: Path, truck: TorsionFigures, answered: Answers) -> None:
    page = answered(example("truck_torsion.toml")).page
    section = page.partition('<section id="torsion"')[2].partition("</section>")[0]
    assert '<a href="#torsion">Torsional vibration</a>' in page
    assert "<td>2514 rpm</td>" in section
    assert "<td>83.8 Hz</td>" in section
    assert re.search(r'class="verdict fair">The torque changes its sign in every turn', section)
    # The highest point of the curve of shaft 1 is its largest torque.
    chart = figure(page, "Torque of shaft 1 over a turn [N m]")
    largest = curves(chart)["largest"]
    highest = largest[np.argmax(largest[:, 1])]
    torque = truck.largest[0]
    assert highest == pytest.approx([torque.speed / RPM, torque.most], rel=0.005)
    bare = tmp_path / "bare.html"
    write_report(Scene.parse("[driveline]\nbends_deg = [10, 10]\n"), bare)
    assert "orsional vibration" not in bare.read_text(encoding="utf-8").split("<script")[0]


def test_pictures_of_an_engine() -> None:
    found = torsion_figures(Scene.parse(ENGINE))
    assert found is not None
    axes = plot_campbell(found)
    lines = {str(line.get_label()): line for line in axes.get_lines()}
    assert {"order 1.5", "order 2", "order 3", "order 4", "of torques"} <= lines.keys()
    assert {name: lines[name].get_linestyle() for name in ("order 1.5", "order 2")} == {
        "order 1.5": "--",
        "order 2": "-",
    }
    assert "engine" in [text.get_text().split("\n")[-1] for text in axes.texts]
    axes = plot_torsion_response(found, 0)
    drawn = next(line for line in axes.get_lines() if line.get_label() == "order 1.5")
    x, y = (np.asarray(data, dtype=np.float64)[::20] for data in drawn.get_data())
    steady = found.torsion.system.steady(x * RPM, 1.5)
    assert y == pytest.approx(np.abs(steady.torque_orders[0, :, 0]), rel=1e-6)
    assert [text.get_text() for text in axes.texts] == ["1.5"]


def test_more_orders_than_a_legend_has_stand_at_their_lines() -> None:
    many = replaced(
        ENGINE,
        ("[0.5, 1, 1.5, 2, 3]", "[0.5, 1, 1.5, 3, 4.5, 6, 7.5, 9]"),
        ("[90, 70, 50, 20, 10]", "[90, 70, 50, 10, 4, 3, 2, 1]"),
        ("sin_Nm = [60, 120, 90, 60, 20]\n", ""),
    )
    found = torsion_figures(Scene.parse(many))
    assert found is not None
    axes = plot_campbell(found)
    texts = [text.get_text() for text in axes.texts]
    assert texts[:8] == ["1.5", "2", "3", "4", "4.5", "6", "7.5", "9"]
    for mark, order in zip(marks(axes), (1.5, 2, 3, 4, 4.5, 6, 7.5, 9), strict=False):
        speed, frequency = mark.xy
        assert frequency == pytest.approx(order * speed / 60.0)


@pytest.mark.long
def test_each_of_several_motions_is_drawn() -> None:
    text = """
    [driveline]
    bends_deg = [30, 30]
    [torsion]
    drive = "held"
    inertias_kgm2 = [0, [0, 0.004], [0.1, 0]]
    stiffnesses_Nm_per_rad = ["rigid", 9000, "rigid"]
    damping_ratio = 0.013
    load_torque_Nm = 20
    orders = 2
    speed_rpm = {from = 1200, to = 1600, steps = 5}
    """
    found = torsion_figures(Scene.parse(text))
    assert found is not None
    lines = {str(line.get_label()): line for line in plot_torsion_response(found).get_lines()}
    speed = found.critical_speeds[0].speed
    orbits = found.torsion.system.coexisting(speed)
    sizes = np.fmax(-orbits.torque_min, orbits.torque_max)[0, : int(orbits.count)]
    stable = orbits.stable[: int(orbits.count)]
    for name, which in (("stable motion", stable), ("unstable motion", ~stable)):
        x, y = (np.asarray(data, dtype=np.float64) for data in lines[name].get_data())
        here = np.isclose(x, speed / RPM)
        assert sorted(y[here]) == pytest.approx(sorted(sizes[which]), rel=1e-4)
