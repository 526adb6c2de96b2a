"""The section [steering]: its figures against the library, and what it says of a yoke to turn."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.table import PARTS
from cardan.app.scene import Scene

TEXT = """\
[driveline]
bends_deg = [20, 30]
twists_deg = [40]
phases_deg = [10]
[steering]
centre_deg = 25
"""


def figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["steering"]
    assert found is not None
    return found


def test_a_turn_of_the_yoke_leads_to_the_largest_and_to_the_least_ratio() -> None:
    line, one = Scene.parse(TEXT).line, figures(TEXT)
    ratio = line.evaluate(np.linspace(0.0, np.pi, 721), "speed_ratio").speed_ratio
    ends = {one.turn_to_quick.value: ratio.max(), one.turn_to_slow.value: ratio.min()}
    assert len(ends) == 2
    for turn, extreme in ends.items():
        # Clockwise, looking towards the output, is the sense in which drive angles count.
        there = line.evaluate(np.radians(25.0) + turn, "speed_ratio").speed_ratio
        assert there == pytest.approx(extreme, abs=1e-5)


def test_both_turns_are_named() -> None:
    found = figures(TEXT)
    *_, said = PARTS["steering"].sentences(found)
    for turn, ratio in (
        (found.turn_to_quick, "largest straight ahead"),
        (found.turn_to_slow, "least"),
    ):
        sense = "clockwise" if turn.value > 0.0 else "counter-clockwise"
        assert f"by {abs(np.degrees(turn.value)):.2f}° {sense} (ratio {ratio})" in said


def test_the_ratio_to_the_left_and_to_the_right_is_judged() -> None:
    away = np.linspace(0.0, np.pi / 2.0, 9001)
    left, right = (
        Scene.parse(TEXT).line.evaluate(np.radians(25.0) + side * away, "speed_ratio").speed_ratio
        for side in (-1.0, 1.0)
    )
    worst = float(np.max(np.abs(left - right)))
    for percent, verdict in ((101.0 * worst, "within"), (99.0 * worst, "beyond")):
        found = figures(f"{TEXT}ratio_percent = {percent}\n")
        assert found.difference.value == pytest.approx(worst, rel=1e-6)
        assert found.difference.verdict == verdict
        assert Answer(Scene.parse(f"{TEXT}ratio_percent = {percent}\n")).verdict == "beyond"
    assert figures(TEXT).difference.verdict == "not judged"


def test_a_perfect_column_is_symmetric_wherever_its_angle_is() -> None:
    """Its equivalent bend is rounding, so an angle of symmetry says nothing."""
    perfect = """
[driveline]
bends_deg = [30, 30]
twists_deg = [180]
phases_deg = [0.0001]
[steering]
centre_deg = 20
offset_deg = 2
ratio_percent = 0.1
"""
    found = figures(perfect)
    assert found.difference.value < 1e-5
    assert (found.offset.value, found.offset.verdict) == (0.0, "within")
    assert list(PARTS["steering"].sentences(found)) == ["Left and right are symmetric."]
    assert figures(perfect.replace("0.0001", "30")).offset.verdict == "beyond"


def test_every_driveline_of_a_study_is_judged() -> None:
    text = """
[driveline]
bends_deg = [30, 12]
phases_deg = [90]
[steering]
offset_deg = 2
[study]
phases_deg.0 = [90, 45, 0]
"""
    found = figures(text)
    assert found.offset.verdict == "beyond"
    assert np.degrees(found.offset.value) == pytest.approx(4.35, abs=0.005)
    assert found.offset.at == {"phases_deg.0": 45.0}
    assert Answer(Scene.parse(text)).verdict == "beyond"


def test_ratio_and_turns_are_those_where_the_column_is_farthest_from_symmetry() -> None:
    text = """[driveline]
    points_mm = [[0, 0, 0], [550, 0, -280], [780, 90, -520], [900, 100, -600]]
    [steering]
    centre_deg = 10
    [states]
    names = ["high", "low"]
    "points_mm.0.z" = [30, -30]
    """
    scene, found = Scene.parse(text), figures(text)
    own = scene.drivelines().steering(np.radians(10.0), drawn=scene.line)
    far = int(np.argmax(np.abs(own.offset)))
    assert (found.offset.state, found.ratio.state) == ("low", "low")
    assert far == 1
    for name in ("ratio", "slope", "turn_to_quick", "turn_to_slow"):
        assert getattr(found, name).value == getattr(own, name)[far]
