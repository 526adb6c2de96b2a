"""Pictures of load, heat and life of joints: the numbers drawn are the numbers computed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.patches import Rectangle

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures, needed
from cardan.app.plots import plot_heat, plot_part, plot_pin_load, plot_sizes, save
from cardan.app.scene import Scene
from pages import near

CONVEYOR = Path(__file__).parents[2] / "examples" / "conveyor.toml"
LINE = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)
LOAD = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
BEARINGS: dict[str, Any] = {"friction": [0.01, 0.02], "pin_radius": 0.008, "arm": 0.032}


def _found(scene: Scene) -> LifeFigures:
    return needed(Answer(scene))


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_pins_bear_the_moment_of_their_joint() -> None:
    axes = plot_pin_load(LINE, LOAD)
    curves = axes.get_lines()
    assert [curve.get_label() for curve in curves] == ["joint 0", "joint 1"]
    for joint, curve in enumerate(curves):
        angle, drawn = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert (angle[0], angle[-1]) == (0.0, pytest.approx(360.0))
        own = LINE.evaluate(np.radians(angle), "moment", joints=joint, load=LOAD).moment
        assert drawn == pytest.approx(np.linalg.norm(own, axis=-1), rel=1e-12)


def test_heat_grows_with_the_speed() -> None:
    axes = plot_heat(LINE, LOAD, **BEARINGS)
    for joint, curve in enumerate(axes.get_lines()):
        rpm, drawn = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert drawn[0] == rpm[0] == 0.0
        assert rpm[-1] == pytest.approx(1500.0)
        fraction = LINE.losses(cardan.Load(output_torque=400.0), **BEARINGS).fraction[joint]
        assert drawn == pytest.approx(fraction * 400.0 * rpm * math.pi / 30.0, rel=1e-12)


def test_bars_are_lives() -> None:
    found = _found(Scene.load(CONVEYOR))
    axes = plot_sizes(found)
    bars = [bar for bar in axes.patches if isinstance(bar, Rectangle)]
    assert [bar.get_width() for bar in bars] == [one.hours for one in found.sizes]
    names = [tick.get_text() for tick in axes.get_yticklabels()]
    assert names == [one.size for one in found.sizes]
    assert [bool(bar.get_hatch()) for bar in bars] == [not one.fits for one in found.sizes]
    (line,) = axes.get_lines()
    assert list(np.asarray(line.get_xdata())) == [8000.0, 8000.0]
    texts = [text.get_text() for text in axes.texts]
    assert texts == [f"{one.hours:.0f} h" for one in found.sizes]


def test_a_picture_has_what_the_scene_gives(tmp_path: Path) -> None:
    full = tmp_path / "full.svg"
    save(plot_part(Scene.load(CONVEYOR), "life"), full)
    text = full.read_text(encoding="utf-8")
    save(plot_part(Scene.load(CONVEYOR), "life"), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == full.read_bytes()
    plain = Scene.parse(
        "[driveline]\nbends_deg = [12, 18]\n[load]\nspeed_rpm = 9\noutput_torque_Nm = 7\n"
        "[joints]\nrating_Nm = 1200\n"
    )
    less = tmp_path / "less.svg"
    save(plot_part(plain, "life"), less)
    assert len(less.read_bytes()) < len(text)


def test_pins_and_heat_are_those_of_the_worst_steps() -> None:
    """The joints are hottest in the start and wear most when loaded, which lasts longer."""
    text = CONVEYOR.read_text(encoding="utf-8")
    text = text.replace("hours = [50, 45, 5]", "hours = [70, 29, 1]").replace(", 600]", ", 1500]")
    scene = Scene.parse(text, str(CONVEYOR), folder=CONVEYOR.parent)
    figure = plot_part(scene, "life")
    _, pins, heat = figure.axes
    angle, moment = np.asarray(pins.get_lines()[1].get_xydata()).T
    loaded = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    own = LINE.evaluate(np.radians(angle), "moment", joints=1, load=loaded).moment
    assert moment == pytest.approx(np.linalg.norm(own, axis=-1), rel=1e-12)
    start = cardan.Load(output_torque=700.0, speed_rpm=1500.0)
    watts = LINE.losses(start, friction=0.01, pin_radius=0.008, arm=0.032).power
    for joint, line in enumerate(heat.get_lines()):
        assert np.asarray(line.get_xydata())[-1] == pytest.approx([1500.0, watts[joint]])
    assert heat.get_xlim() == pytest.approx((0.0, 1500.0))


def test_heat_is_that_of_the_step_that_heats_one_joint_most() -> None:
    """The other joint is hottest in another step."""
    scene = Scene.parse(
        "[driveline]\nbends_deg = [18, 12]\nphases_deg = [90]\n[load]\nspeed_rpm = 1500\n"
        "[joints]\nfriction = [0.01, 0.02]\npin_radius_mm = 8\narm_mm = 32\n"
        "[life]\nbends_deg = [[18, 12], [12, 18]]\noutput_torque_Nm = 400\n"
    )
    figure = plot_part(scene, "life")
    watts = LINE.losses(LOAD, **BEARINGS).power
    ends = [np.asarray(line.get_ydata())[-1] for line in figure.axes[-1].get_lines()]
    assert ends == pytest.approx(watts)


def test_without_joints_there_is_no_heat() -> None:
    text = CONVEYOR.read_text(encoding="utf-8").replace('size = "1480"', "")
    found = _found(Scene.parse(text, str(CONVEYOR), folder=CONVEYOR.parent))
    assert found.sizes
    assert (found.joints, found.heat, found.efficiency) == ((), None, None)


def test_short_lives_and_names_are_written_in_full() -> None:
    """Lives have the digits of the answer; a name with dollar signs is no formula."""
    text = CONVEYOR.read_text(encoding="utf-8").replace("[400, 250, 700]", "[9000, 6000, 12000]")
    found = _found(Scene.parse(text, str(CONVEYOR), folder=CONVEYOR.parent))
    sizes = [replace(one, size=f"${one.size}$") for one in found.sizes]
    axes = plot_sizes(replace(found, sizes=tuple(sizes)))
    assert any(float(one.hours or 0.0) < 1.0 for one in sizes)
    for text_of_bar, one in zip(axes.texts, sizes, strict=True):
        assert one.hours == near(text_of_bar.get_text())
    for label, one in zip(axes.get_yticklabels(), sizes, strict=True):
        assert label.get_text() == one.size
        assert not label.get_parse_math()


def test_what_cannot_be_drawn_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"line has shape \(2,\); this picture shows one"):
        plot_pin_load(cardan.Driveline.from_bends([[0.1], [0.2]]), LOAD)
    with pytest.raises(ValueError, match="load has no speed; heat is drawn up to it"):
        plot_heat(LINE, cardan.Load(output_torque=1.0), **BEARINGS)
    scene = Scene.parse(
        "[driveline]\nbends_deg = 9\n[load]\nspeed_rpm = 9\noutput_torque_Nm = 7\n"
        "[joints]\nrating_Nm = 1200\n"
    )
    with pytest.raises(ValueError, match="no table of sizes whose life is known"):
        plot_sizes(_found(scene))
    with pytest.raises(ValueError, match="must end in"):
        save(plot_part(scene, "life"), tmp_path / "life.txt")
    assert list(tmp_path.iterdir()) == []
