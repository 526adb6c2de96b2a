"""Loops that find their pins themselves give the bits of those that read them from a buffer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cardan import Driveline, Load, _core
from cardan.evaluation.result import Result
from oracle import plan_at

MOTION = ["angle", "speed_ratio", "acceleration_ratio"]
ALONE = [
    ["angle"],
    ["angle_error"],
    ["speed_ratio"],
    ["acceleration_ratio"],
    ["speed_ratio", "acceleration_ratio"],
    ["angle", "speed_ratio"],
    ["angle_error", "speed_ratio"],
    MOTION,
    ["jerk_ratio"],
]
LOADED = [["moment"], ["bending_driving"], ["bending_driven"], ["support_moment"]]
# In single precision only loops at moderate bends find pins: those of motions and of the moment
# vector of the first joint, strip by strip.
TIERS: dict[str, dict[str, Any]] = {
    "double": {},
    "float32": {"dtype": np.float32},
    "single precision in doubles": {"tolerance": 1e-6},
}
LINES = {
    "joint": Driveline.from_bends([0.5]),
    "small": Driveline.from_bends([0.01]),
    "middle": Driveline.from_bends([0.9]),
    "large": Driveline.from_bends([1.2]),
    "steep": Driveline.from_bends([1.4]),
    "chain": Driveline.from_bends([0.2, 0.3, 0.1], [0.3, 0.2], [0.1, 0.4]),
    "steep chain": Driveline.from_bends([0.9, 0.8, 0.4], [0.3, 0.2], [0.1, 0.4]),
}


def angles() -> NDArray[np.float64]:
    """Several chunks; some of them hold angles that the fast reduction cannot take."""
    angle = np.linspace(-40.0, 60.0, 5000)
    for i, value in enumerate([1e13, -3e18, 1e300, np.inf, -np.inf, np.nan, 1.7e12, -0.0, 0.0]):
        angle[1030 + 17 * i] = value
    angle[-1] = 5e15
    return angle


def equal(one: Result, other: Result | dict[str, Any], names: list[str]) -> bool:
    return all(one[name].tobytes() == other[name].tobytes() for name in names)


@pytest.mark.parametrize("tier", TIERS)
@pytest.mark.parametrize("level", _core.levels())
@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_another_output_changes_no_bit(line: Driveline, level: str, tier: str) -> None:
    # Another shaft or joint, or the jerk, needs a second loop, so that the pins are stored.
    angle, load, options = angles(), Load(drive_torque=50.0), {**TIERS[tier], "level": level}
    for names in ALONE:
        more = [*names, "jerk_ratio"] if names != ["jerk_ratio"] else [*names, "speed_ratio"]
        alone, together = (plan_at(line, which, **options)(angle) for which in (names, more))
        assert equal(alone, together, names), names
    for names in LOADED:
        more = [*names, "tilt_driven"] if names[0] != "moment" else [*names, "bending_driven"]
        plans = (plan_at(line, which, load=load, **options) for which in (names, more))
        alone, together = (plan(angle) for plan in plans)
        assert equal(alone, together, names), names


@pytest.mark.parametrize(
    ("names", "tier"),
    [
        (["angle", "speed_ratio"], "double"),
        (["speed_ratio"], "double"),
        (["moment"], "double"),
        (MOTION, "float32"),
        (["moment"], "float32"),
        (["moment"], "single precision in doubles"),
        (MOTION, "single precision in doubles"),
    ],
)
def test_results_past_the_caches_have_the_bits_of_short_calls(names: list[str], tier: str) -> None:
    line, load = LINES["joint"], Load(drive_torque=50.0)
    angle = np.linspace(0.0, 1e4, 3_300_000)
    angle[2_000_003], angle[3_299_999] = 1e200, np.nan
    plan = plan_at(line, names, load=load, **TIERS[tier])
    # New results pass through the caches, and results that are filled do not.
    new = plan(angle)
    whole = {name: np.zeros_like(new[name]) for name in names}
    plan(angle, out=whole)
    assert equal(new, whole, names)
    piece = slice(1_990_000, 2_010_000)
    for part in (piece, slice(3_290_000, None), slice(0, 1000)):
        own = plan(angle[part].copy())
        for name in names:
            found = whole[name][:, part] if name == "moment" else whole[name][part]
            np.testing.assert_array_equal(found, own[name])
