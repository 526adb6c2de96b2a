"""Identification from recordings of multibody engines, with noise, drift and counters.

The bends and the phase less the twist follow from the points of the drawing alone; no formula of a
joint's motion appears.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from cardan import identify, identify_two_joints
from engines import Doubles
from test_multibody import ANGLES, ENGINES, Drawing, in_bearings, rig

pytestmark = pytest.mark.physics

TURNS = 20
NOISE = math.radians(0.05)


def recording(engine: str, name: str) -> tuple[Doubles, list[Doubles], Drawing]:
    """Return the counts of an encoder on each shaft, that of the drive first, and the drawing.

    The engine stands at the same angles in every turn. The encoders of the driven shafts have noise
    and start anew at each turn, the last of them drifts, and a tenth of the samples is lost.
    """
    random = np.random.default_rng(len(name))
    engine_rig = rig(engine, name, in_bearings)
    stands = np.array(engine_rig.stands)[:, engine_rig.model.shafts]
    turns = np.arange(TURNS)[:, None]
    drive = (ANGLES + 2.0 * math.pi * turns).ravel()
    shafts = [np.tile(column, TURNS) for column in stands.T[1:]]
    noisy = [shaft + random.normal(0.0, NOISE, shaft.size) for shaft in shafts]
    noisy[-1] += np.radians(0.5) * np.linspace(0.0, 1.0, drive.size)
    kept = random.random(drive.size) < 0.9
    return drive[kept], [np.mod(shaft[kept], 2.0 * math.pi) for shaft in noisy], engine_rig.drawing


def angle_between(u: Doubles, v: Doubles) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ["joint-10", "joint-30", "joint-60"])
def test_the_bend_of_a_joint(engine: str, name: str) -> None:
    drive, (driven,), drawing = recording(engine, name)
    found = identify(drive, angle=driven)
    bend = angle_between(*drawing.axes)
    assert found.detected
    assert 0.0 < found.std < math.radians(0.1)
    assert abs(found.bend - bend) < 4.0 * found.std
    assert abs(math.sin(found.angle_offset)) < 4.0 * found.std / bend
    # Order 4 of a bend of 10 deg is within the noise.
    if bend > 0.5:
        assert found.purity == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", ["z-space", "w-space"])
def test_both_bends_and_the_phase(engine: str, name: str) -> None:
    drive, (middle, driven), drawing = recording(engine, name)
    found = identify_two_joints(drive, middle, driven)
    (u, v, w), (m, n) = drawing.axes, drawing.normals
    for bend, std, wanted in zip(
        found.bends, found.std, (angle_between(u, v), angle_between(v, w)), strict=True
    ):
        assert 0.0 < std < math.radians(0.2)
        assert abs(bend - wanted) < 4.0 * std
    twist = math.atan2(float(v @ np.cross(m, n)), float(m @ n))
    off = found.phase_less_twist - (drawing.phases[0] - twist)
    assert abs(math.sin(off)) < 4.0 * float(max(found.std / found.bends))


@pytest.mark.parametrize("engine", ENGINES)
def test_noise_hides_the_smallest_bend(engine: str) -> None:
    """At 1 deg the order 2 is a tenth of the noise of a sample."""
    drive, (driven,), _ = recording(engine, "joint-1")
    found = identify(drive, angle=driven)
    assert found.detected == (found.bend > found.detection_limit)
    assert math.radians(1.0) < found.detection_limit
