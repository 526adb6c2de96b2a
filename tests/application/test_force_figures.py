"""Figures of forces: largest, mean, orders, against samples and exact sums."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cardan import Driveline, Load, Scene
from cardan.app.answers.forces.figures import force_figures

LINE = Driveline.from_points(
    [[0.0, 0, 0], [0.3, 0.05, 0], [1.5, -0.1, 0.1], [3.0, -0.4, 0], [3.3, -0.4, 0.1]],
    phases=[0.4, -1.0],
).with_bearings([(3, 0.05), (0, 0.05), (1, 1.0), (0, 0.2), (3, 0.2)])
LOAD = Load(drive_torque=100.0)


def test_figures_of_a_driveline() -> None:
    turn = np.arange(20_000) * (2 * math.pi / 20_000)
    samples = LINE.evaluate(turn, ("joint_force", "bearing_force"), load=LOAD)
    found = force_figures(LINE, LOAD)
    assert [(row.per, row.item) for row in found] == [("joint", i) for i in range(3)] + [
        ("bearing", i) for i in range(5)
    ]
    for row in found:
        values = samples[row.output][row.item]
        sizes = np.linalg.norm(values, axis=-1)
        assert row.largest == pytest.approx(sizes.max(), rel=1e-6)
        at = LINE.evaluate(row.places[0], row.output, load=LOAD)[row.output][row.item]
        assert np.linalg.norm(at) == pytest.approx(row.largest, rel=1e-12)
        assert row.mean == pytest.approx(np.linalg.norm(values.mean(axis=0)), rel=1e-9)
        for order, size in ((2, row.order_2), (4, row.order_4)):
            wave = [2 * (values * f(order * turn)[:, None]).mean(axis=0) for f in (np.cos, np.sin)]
            part = np.outer(np.cos(turn), wave[0]) + np.outer(np.sin(turn), wave[1])
            assert size == pytest.approx(np.linalg.norm(part, axis=-1).max(), rel=1e-6)


def test_a_force_that_is_not_determinate() -> None:
    with pytest.raises(ValueError, match="shaft 3 has 3 bearings"):
        force_figures(LINE.with_bearings([*LINE.bearings, (3, 0.25)]), LOAD)
    rows = force_figures(LINE.with_bearings([*LINE.bearings, (3, 0.25)]), LOAD, ["joint_force"])
    assert len(rows) == 3


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


def test_steep_bends_take_bounded_memory() -> None:
    # Samples in proportion to 1/cos of both bends would be thousands of millions.
    line = Driveline.from_bends([89.99, 89.99], degrees=True)
    line = line.with_bearings([(0, 0.1), (0, 0.6), (2, 0.1), (2, 0.6)], [1.0, 1.0, 1.0])
    for row in force_figures(line, LOAD):
        at = line.evaluate(row.places[0], row.output, load=LOAD)[row.output][row.item]
        assert np.linalg.norm(at) == pytest.approx(row.largest, rel=1e-9)
        assert 0.0 < row.mean < row.largest
        assert 0.0 < row.order_2 < 2.0 * row.largest
