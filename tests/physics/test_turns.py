"""Answers over a turn: recorded, each driveline for itself, and beside their slow twins."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import answers
from cardan import Driveline, Load, reference
from cardan.reference import wear as slow
from tiers import part

FRICTION: dict[str, Any] = {"friction": 0.02, "pin_radius": 0.011, "arm": 0.04}


def one_of_each(joints: int) -> tuple[Driveline, list[float], list[float], list[float]]:
    """A random driveline with moderate bends, and its bends, twists and phases."""
    random = np.random.default_rng(joints)
    bends, between = random.uniform(0.05, 0.6, joints), (2, joints - 1)
    twists, phases = random.uniform(-3.0, 3.0, between)
    line = Driveline.from_bends(bends, twists, phases)
    return line, bends.tolist(), twists.tolist(), phases.tolist()


def test_answers_are_as_recorded() -> None:
    known = answers.recorded()
    found = dict(answers.answers())
    assert found.keys() == known.keys()
    for name, answer in found.items():
        np.testing.assert_allclose(answer, known[name], rtol=1e-12, err_msg=name)


def of_batch(line: Driveline, torque: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Every answer over a turn, drivelines last."""
    joints = line.n_joints
    inertias = np.linspace(0.002, 0.001, joints + 1)
    load = Load(output_torque=torque, speed=40.0, inertias=inertias)
    life = line.life(load, rating=200.0)
    free = line.free_running(inertias)
    return {
        "losses": line.losses(load, **FRICTION, seal_torque=0.3).fraction,
        "hours": life.hours,
        "catalogue": life.catalogue,
        "least speed": np.asarray(free.min_speed_ratio),
        "largest speed": np.asarray(free.max_speed_ratio),
    }


@pytest.mark.parametrize("joints", [1, 2, 3, 5])
def test_an_answer_does_not_depend_on_its_neighbours(joints: int) -> None:
    """Not even on one that is bent by 89 degrees, which makes plans take other routes."""
    count = part(400)
    random = np.random.default_rng(joints)
    bends = np.radians(random.uniform(0.0, 60.0, (count, joints)))
    bends[:: max(1, count // 4), 0] = np.radians(89.0)
    line = Driveline.from_bends(
        bends,
        random.uniform(-3.0, 3.0, (count, joints - 1)),
        random.uniform(-3.0, 3.0, (count, joints - 1)),
    )
    torque = random.uniform(-100.0, 100.0, count)
    together = of_batch(line, torque)
    for i in range(1, count, max(1, count // 20)):
        for name, answer in of_batch(line[i], torque[i]).items():
            # What steep neighbours change is their arithmetic, which then has more digits.
            np.testing.assert_allclose(together[name][..., i], answer, rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("joints", [1, 2, 3, 4])
@pytest.mark.parametrize("inertia", [0.0, 0.004])
def test_losses_and_lives_beside_steps_of_the_reference(joints: int, inertia: float) -> None:
    line, *angles = one_of_each(joints)
    load: dict[str, Any] = {"output_torque": 60.0, "speed": 50.0}
    if inertia:
        load["inertias"] = [inertia] * (joints + 1)
    shafts = reference.from_bends(*angles)
    lost = slow.losses(shafts, 0.02, 0.011, 0.04, 0.3, **load)
    fast = line.losses(Load(**load), **FRICTION, seal_torque=0.3)
    np.testing.assert_allclose(fast.fraction, lost, rtol=2e-5)
    life = line.life(Load(**load), rating=200.0)
    known = slow.life(shafts, 200.0, **load)
    np.testing.assert_allclose(np.stack([life.hours, life.catalogue], -1), known, rtol=1e-4)


def test_torques_that_reverse_beside_many_samples() -> None:
    """Kinks at unknown angles, where sums over equal steps gain few digits."""
    line = answers.drivelines(3, 4, 85.0)
    load = Load(output_torque=30.0, speed=60.0, inertias=[0.0, 0.01, 0.02, 0.01])
    lost = line.losses(load, **FRICTION)
    count = 1 << 18
    angle = (np.arange(count) + 0.5) * np.pi / count
    names = ("torque", "speed_ratio", "pin_moment", "swing_driving", "swing_driven")
    reverses = 0
    for i in range(line.size):
        at = line[i].evaluate(angle, names, shafts=slice(None), joints=slice(None), load=load)
        way = np.abs(at.swing_driving) + np.abs(at.swing_driven)
        known = 0.02 * 0.011 / 0.04 * np.mean(at.pin_moment * way, axis=-1)
        np.testing.assert_allclose(
            lost.fraction[:, i], known / abs(np.mean(at.torque[0])), rtol=1e-9
        )
        reverses += bool(np.any(np.min(at.torque, axis=-1) * np.max(at.torque, axis=-1) < 0.0))
    assert reverses > 1


@pytest.mark.parametrize("joints", [1, 2, 3])
def test_a_free_drive_beside_its_equation_of_motion(joints: int) -> None:
    line, *angles = one_of_each(joints)
    inertias = np.linspace(0.3, 0.1, joints + 1)
    ends = slow.free_running(reference.from_bends(*angles), inertias.tolist())
    free = line.free_running(inertias)
    np.testing.assert_allclose([free.min_speed_ratio, free.max_speed_ratio], ends, rtol=2e-4)


def test_straight_joints_do_not_turn_their_pins() -> None:
    line = Driveline.from_bends([0.0, 0.0], 0.0, 0.0)
    load = Load(output_torque=100.0, speed=100.0 * math.pi / 30.0)
    assert np.all(line.losses(load, **FRICTION, seal_torque=1.0).fraction == 0.0)
    np.testing.assert_allclose(line.life(load, rating=100.0).hours, 5000.0, rtol=1e-14)
