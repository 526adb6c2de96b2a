"""The section [steering]: its figures against the library, and what it says of a yoke to turn."""

from __future__ import annotations

import numpy as np
import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.steering.figures import OnCentre, SteeringFigures
from cardan.app.answers.steering.text import steering_sentences
from cardan.app.scene import Scene

TEXT = """\
[driveline]
bends_deg = [20, 30]
twists_deg = [40]
phases_deg = [10]
[steering]
centre_deg = 25
"""


def test_a_turn_of_the_yoke_leads_to_the_largest_and_to_the_least_ratio() -> None:
    scene = Scene.parse(TEXT)
    found = Answer(scene)["steering"]
    assert found is not None
    (one,) = found.each
    ratio = scene.line.evaluate(np.linspace(0.0, np.pi, 721), "speed_ratio").speed_ratio
    ends = {one.turn_to_quick_deg: ratio.max(), one.turn_to_slow_deg: ratio.min()}
    assert len(ends) == 2
    for turn, extreme in ends.items():
        # Clockwise, looking towards the output, is the sense in which drive angles count.
        there = scene.line.evaluate(np.radians(25.0 + turn), "speed_ratio").speed_ratio
        assert there == pytest.approx(extreme, abs=1e-5)


def test_both_turns_are_named() -> None:
    one = OnCentre("", 1.02, 0.1, 12.0, "quick", 12.0, -34.0)
    *_, said = steering_sentences(SteeringFigures(25.0, None, (one,)))
    assert "by 12.00° clockwise (ratio largest straight ahead)" in said
    assert "or by 34.00° counter-clockwise (ratio least)" in said
