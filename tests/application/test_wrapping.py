"""Filled text keeps every number on the line of its unit."""

from __future__ import annotations

import re

import pytest

from cardan.design.wrapping import fill, wrap

SENTENCES = [
    "with these tolerances 99.83 % of the drivelines are within it",
    "move joint 1 by 40 mm along -y and by 12.4 m along +x",
    "the axial force is 19247 N and the torque 139.2 to 221.3 N m at 3030 rpm",
    "accelerations from -65 to 193 rad/s² and an inertia of 0.02 kg m² at 1200 rad/s",
]
PARTED = re.compile(r"(?:\d\n(?:%|mm|m|N|rpm|rad/s²?|kg)\b|\d\n%|N\nm\b|kg\nm)")


@pytest.mark.parametrize("text", SENTENCES)
def test_no_width_parts_a_number_from_its_unit(text: str) -> None:
    for width in range(24, 80):
        filled = fill(text, width)
        assert not PARTED.search(filled), filled
        assert max(map(len, filled.splitlines())) <= width
        assert filled.replace("\n", " ") == text


def test_a_word_after_a_number_is_no_unit() -> None:
    assert wrap("state 0 moves", 8) == ["state 0", "moves"]
    assert wrap("joint 1 may turn", 8) == ["joint 1", "may turn"]
    assert wrap("shaft 2 has 3 splines", 7) == ["shaft 2", "has 3", "splines"]
