"""Drivelines whose points follow the torque."""

from __future__ import annotations

import numpy as np
import pytest

import cardan
from cardan.arrays import FloatArray
from cardan.reference import design

POINTS = np.array([[0, 0, 0], [0.35, -0.02, 0], [1.65, -0.05, 0], [3.15, -0.18, 0.05]])
LINE = cardan.Driveline.from_points(POINTS, phases=[0.3])
ABOUT, AXIS = np.array([3.0, -0.4, 0.1]), np.array([0.1, -0.2, 0.9])
UNIT = AXIS / np.linalg.norm(AXIS)
TURN, SHIFT = 5e-5, np.array([1e-6, 2e-6, -3e-6])


def vector(array: FloatArray) -> tuple[float, float, float]:
    x, y, z = array.tolist()
    return x, y, z


def test_points_turn_and_move_in_proportion_to_the_torque() -> None:
    torque = np.array([[-300.0, 0.0, 200.0], [1500.0, 7.0, 1e-3]])
    found = LINE.wound_up(torque, [2, 3], turn=TURN, about=ABOUT, axis=AXIS, shift=SHIFT)
    assert found.shape == torque.shape
    for place, size in np.ndenumerate(torque):
        shift = vector(size * SHIFT)
        own = design.under_torque(
            [*map(vector, POINTS)], [2, 3], size * TURN, vector(ABOUT), vector(UNIT), shift
        )
        line = cardan.Driveline.from_points(own, phases=[0.3])
        np.testing.assert_allclose(found[place].bends, line.bends, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found[place].directions, line.directions, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found[place].lengths().each, line.lengths().each, rtol=1e-14)
        np.testing.assert_array_equal(found[place].phases, [0.3])


def test_what_does_not_yield_keeps_its_bits() -> None:
    found = LINE.wound_up([0.0, 1e4], slice(2, 4))
    for one in found:
        np.testing.assert_array_equal(one.bends, LINE.bends)
        np.testing.assert_array_equal(one.directions, LINE.directions)


def test_batches_broadcast_and_bearings_stay() -> None:
    lines = cardan.Driveline.from_points(np.stack([POINTS, 1.1 * POINTS]), phases=[0.3])
    held = lines.with_bearings([(1, 1.2), (2, [0.2, 0.3])])
    torque = [[100.0], [500.0], [900.0]]
    found = held.wound_up(torque, 3, shift=[0, 1e-5, 0])
    assert found.shape == (3, 2)
    one = held[1].wound_up(500.0, 3, shift=[0, 1e-5, 0])
    np.testing.assert_allclose(found[1, 1].bends, one.bends, rtol=1e-14)
    load = cardan.Load(output_torque=500.0)
    ends = 1.1 * POINTS + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 5e-3, 0]]
    by_hand = cardan.Driveline.from_points(ends, phases=[0.3])
    by_hand = by_hand.with_bearings([(1, 1.2), (2, 0.3)])
    ours = one.evaluate(0.4, "bearing_force", load=load).bearing_force
    known = by_hand.evaluate(0.4, "bearing_force", load=load).bearing_force
    np.testing.assert_allclose(np.asarray(ours), np.asarray(known), rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "argument", "words"),
    [
        ({"axis": [0, 0, 0]}, "axis", "an axis needs a direction"),
        ({"about": [0, 0]}, "about", r"has shape \(2,\); it must be \(3,\)"),
        ({"shift": [0, np.nan, 0]}, "shift", "it must be finite"),
        ({"turn": [1, 2]}, "turn", "one number"),
        ({"torque": np.inf}, "torque", "finite"),
        ({"torque": [1.0, 4e4]}, "points", "a bend must lie"),
    ],
)
def test_what_is_wrong(change: dict[str, object], argument: str, words: str) -> None:
    given = {"torque": 100.0, "points": [2, 3], "turn": TURN, "about": ABOUT, **change}
    torque, points = given.pop("torque"), given.pop("points")
    with pytest.raises(cardan.ArgumentValueError, match=words) as error:
        LINE.wound_up(torque, points, **given)  # type: ignore[arg-type]
    assert error.value.argument == argument


def test_lengths_and_points_are_needed() -> None:
    with pytest.raises(cardan.ArgumentValueError, match="has no lengths; make it of points"):
        cardan.Driveline.from_bends([0.1, 0.1]).wound_up(1.0, 1)
    with pytest.raises(IndexError, match="points"):
        LINE.wound_up(1.0, 4)


@pytest.mark.long
def test_a_pinion_on_a_spring_settles_there() -> None:
    """A body on a hinge with a spring, under a torque until it rests, in a multibody engine."""
    mujoco = pytest.importorskip("mujoco")
    stiffness, torque = 2e4, 900.0
    ends = "".join(
        f'<site name="{i}" pos="{" ".join(map(repr, (POINTS[i] - ABOUT).tolist()))}"/>'
        for i in (2, 3)
    )
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option gravity="0 0 0" timestep="1e-3" integrator="implicit"/>
        <worldbody><body pos="{" ".join(map(repr, ABOUT.tolist()))}">
        <joint type="hinge" axis="{" ".join(map(repr, UNIT.tolist()))}" stiffness="{stiffness}"
        damping="400"/><inertial pos="0 0 0" mass="10" diaginertia="2 2 2"/>{ends}
        </body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = torque
    for _ in range(2000):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    assert abs(data.qvel[0]) < 1e-12
    settled = POINTS.copy()
    settled[2:] = data.site_xpos
    engine = cardan.Driveline.from_points(settled, phases=[0.3])
    ours = LINE.wound_up(torque, [2, 3], turn=1.0 / stiffness, about=ABOUT, axis=AXIS)
    np.testing.assert_allclose(ours.bends, engine.bends, rtol=1e-8)
    np.testing.assert_allclose(ours.equivalent().bend, engine.equivalent().bend, rtol=1e-8)
    assert np.max(np.abs(ours.bends - LINE.bends)) > 0.015
