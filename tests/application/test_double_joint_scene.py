"""Centred double joints in scenes: the same drivelines as the library's, alone and in studies."""

from __future__ import annotations

import re

import numpy as np
import pytest

import cardan
from cardan.app.answers.moves import held_in
from cardan.app.answers.yokes.figures import yoke_settings
from cardan.app.answers.yokes.text import yoke_text
from cardan.app.scene import Scene, SceneError

TEXT = """\
[driveline]
double_joint_deg = 30
joint_distance_mm = 60
synchronous_deg = 35
"""
PLACE = 30.0 / np.cos(np.radians(17.5))


def bends(total: float, pivot: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return cardan.Driveline.from_double_joint(total, 60.0, pivot, degrees=True).bends


def test_a_scene_is_the_driveline_of_the_library() -> None:
    line = Scene.parse(TEXT).line
    own = cardan.Driveline.from_double_joint(30.0, 60.0, synchronous=35.0, degrees=True)
    assert line.shape == ()
    assert line.bends == pytest.approx(own.bends, rel=1e-14)
    worn = Scene.parse(f"{TEXT}pivot_wear_mm = -0.3\n").line
    assert worn.bends == pytest.approx(bends(30.0, PLACE - 0.3), rel=1e-14)


def test_a_study_varies_bend_and_wear() -> None:
    text = f"{TEXT}[study]\ndouble_joint_deg = [0, 20, 50]\npivot_wear_mm = [-0.2, 0.1]\n"
    study = Scene.parse(text).run().study
    assert study is not None
    (name,) = (column.name for column in study.columns if column.quantity == "equivalent_bend")
    grid = study.values[name]
    assert grid.shape == (3, 2)
    for i, total in enumerate((0.0, 20.0, 50.0)):
        for j, wear in enumerate((-0.2, 0.1)):
            own = cardan.Driveline.from_bends(bends(total, PLACE + wear)).equivalent()
            assert grid[i, j] == pytest.approx(own.bend, rel=1e-9)


def test_states_are_steering_angles() -> None:
    states = "[states]\ndouble_joint_deg = [5, 35]\nnames = ['ahead', 'turn']\n"
    lines = Scene.parse(f"{TEXT}{states}").drivelines()
    assert lines.bends[1] == pytest.approx(np.radians([17.5, 17.5]))
    assert lines.bends[0] == pytest.approx(bends(5.0, PLACE))


def test_only_the_yokes_behind_a_double_joint_are_set() -> None:
    """Its middle piece has no spline, and the setting is a key that its scene takes."""
    alone = yoke_settings(Scene.parse(TEXT))
    assert not alone.turned
    assert "In the scene" not in yoke_text("", alone)
    behind = Scene.parse(f"{TEXT}single_bend_deg = 6\nsingle_phase_deg = 20\n")
    found = yoke_settings(behind)
    assert [shaft.shaft for shaft in found.turned] == [2]
    line = yoke_text("", found).rpartition("In the scene: ")[2].strip()
    set_line = Scene.parse(f"{TEXT}single_bend_deg = 6\n{line}\n").line
    assert set_line.equivalent().bend < behind.line.equivalent().bend
    assert ("phase", 1) in held_in(behind)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("= 30", "= 185"), "double_joint_deg is 185 deg; a total bend must lie in [0, 180) deg"),
        (("= 30", "= [30, 31]"), "double_joint_deg is [30, 31]; it must be a list of one number"),
        (("= 60", "= 0"), "joint_distance_mm is 0; it must lie in [0.001, 1e+06]"),
        (("= 35", "= 120"), "synchronous_deg is 120 deg; it must lie in [0, 120) deg"),
        (("joint_distance_mm = 60\n", ""), "joint_distance_mm is missing"),
        (
            ("= 35\n", "= 35\npivot_wear_mm = 40\n"),
            "pivot_wear_mm puts the pivot beyond the joints",
        ),
        (("= 35\n", "= 35\nbends_deg = 3\n"), "bends_deg and double_joint_deg are both given"),
        (("= 35\n", "= 35\nphases_deg = 3\n"), "phases_deg does not go with double_joint_deg"),
        (("= 30", "= 170"), "double_joint_deg is 170.0 deg, which bends joint 0 by"),
    ],
)
def test_what_is_refused(change: tuple[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        Scene.parse(TEXT.replace(*change))
    assert re.match(r"scene, line \d: \[driveline\]", str(caught.value)), caught.value


def test_a_single_joint_behind() -> None:
    text = """\
[driveline]
double_joint_deg = 40
joint_distance_mm = 70
synchronous_deg = 50
single_bend_deg = 12
single_twist_deg = 25
single_phase_deg = 90
"""
    line = Scene.parse(text).line
    double = cardan.Driveline.from_double_joint(40.0, 0.07, synchronous=50.0, degrees=True)
    expected = cardan.Driveline.from_bends(
        [*np.degrees(double.bends), 12.0], [0.0, 25.0], [0.0, 90.0], degrees=True
    )
    assert line.approx_equal(expected, 1e-14)
    varied = text + "[study]\nsingle_bend_deg = [0, 12]\ndouble_joint_deg = [20, 40, 60]\n"
    study = Scene.parse(varied).study
    assert study
    _, lines, _ = next(study.blocks())
    assert lines.shape == (6, 1)
    assert lines[4, 0].approx_equal(expected, 1e-14)
    assert np.all(lines.bends[:3, 0, 2] == 0.0)
    with pytest.raises(SceneError, match="single_twist_deg needs single_bend_deg"):
        Scene.parse(text.replace("single_bend_deg = 12\n", ""))
