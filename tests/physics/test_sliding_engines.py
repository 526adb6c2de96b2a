"""Mechanisms that slide, closed by multibody engines: a centred double joint, and a spline.

The models hold no bend, no length and no force: a shaft slides along its axis, and the engine's
placements and Jacobians say where everything stands once the loop is closed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from cardan import Driveline
from engines import Body, Doubles, Engine, MuJoCo, Pinocchio
from test_multibody import ENGINES

pytestmark = pytest.mark.physics

X, Y, Z = np.eye(3)


def made(engine: str, bodies: Sequence[Body]) -> Engine:
    """Return the engine, or skip the test if it is not installed."""
    if engine == "mujoco":
        return MuJoCo(pytest.importorskip("mujoco"), bodies)
    return Pinocchio(pytest.importorskip("pinocchio"), bodies)


class Loop:
    """A tree whose last cross must end in a shaft: its centre there, its pin along the shaft's.

    Attributes:
        q: coordinates; the first is the angle of the drive.
    """

    def __init__(self, engine: Engine, count: int, cross: int, shaft: int, pins: Doubles) -> None:
        self.engine, self.cross, self.shaft = engine, cross, shaft
        # The pin in the cross; the shaft's own pin is perpendicular to these two in the shaft.
        self.pin, self.perpendicular = pins[0], pins[1:]
        self.q = np.zeros(count)

    def gap(self, goal: Doubles | None) -> tuple[Doubles, Doubles]:
        """Return what is open, and its derivatives by the coordinates."""
        state = self.engine.state(self.q, np.zeros_like(self.q))
        end = state.origin[self.shaft] if goal is None else goal
        pin = state.rotation[self.cross] @ self.pin
        turning, moving = state.jacobian[self.cross, :3], state.jacobian[self.cross, 3:]
        own = state.jacobian[self.shaft]
        gaps, rows = [state.origin[self.cross] - end], [moving - own[3:] * (goal is None)]
        for direction in self.perpendicular:
            other = state.rotation[self.shaft] @ direction
            gaps.append(np.array([pin @ other]))
            rows.append((np.cross(pin, other) @ (turning - own[:3]))[np.newaxis])
        return np.concatenate(gaps), np.vstack(rows)

    def closed(self, drive: float, goal: Doubles | None = None) -> Doubles:
        """Close the loop at an angle of the drive; return the derivatives of the gap."""
        self.q[0] = drive
        for _ in range(60):
            gap, slopes = self.gap(goal)
            step = np.linalg.lstsq(slopes[:, 1:], -gap, rcond=None)[0]
            self.q[1:] += step * min(1.0, 0.3 / float(np.max(np.abs(step)) + 1e-300))
            if np.max(np.abs(step)) < 1e-15:
                break
        assert np.max(np.abs(self.gap(goal)[0])) < 1e-13
        return self.gap(goal)[1]


def direction(bend: float) -> Doubles:
    return np.array([math.cos(bend), math.sin(bend), 0.0])


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("pivot", [0.5, 0.53, 0.62])
@pytest.mark.parametrize("total", [4.0, 25.0, 50.0])
def test_a_centred_double_joint(engine: str, pivot: float, total: float) -> None:
    """The driven shaft slides through the pivot, which stands on the axis of the driving one."""
    axis, length = direction(math.radians(total)), 0.06
    foot = pivot * length * X
    bodies = [
        Body(None, np.zeros(3), X),  # the driving shaft, its pin along y
        Body(0, np.zeros(3), Y),  # cross 0
        Body(1, np.zeros(3), Z),  # the piece between, both of its pins along z
        Body(2, length * X, Z),  # cross 1
        Body(None, foot, axis, slides=True),
        Body(4, foot, axis),  # the driven shaft
    ]
    loop = Loop(made(engine, bodies), 6, 3, 5, np.array([Y, axis, Z]))
    loop.q[4] = (1.0 - pivot) * length
    line = Driveline.from_double_joint(total, length, pivot * length, degrees=True)
    for drive in np.linspace(0.0, 3.0, 13):
        slopes = loop.closed(float(drive))
        found = line.evaluate(drive, ("angle", "speed_ratio"))
        assert abs(loop.q[5] - found.angle) < 1e-12
        ratio = np.linalg.solve(slopes[:, 1:], -slopes[:, 0])[4]
        assert abs(ratio - found.speed_ratio) < 1e-11


@pytest.mark.parametrize("engine", ENGINES)
def test_the_length_of_a_spline_and_the_force_in_it(engine: str) -> None:
    """The slide of the shaft, and what its friction does where the next shaft's joint moves.

    Friction that resists a shaft that becomes longer does work in the slide and at that joint, and
    only there: the crosses and the drive transmit none of it.
    """
    drawn = np.array([[-0.3, 0.0, 0.0], [0.0, 0.0, 0.0], [1.1, 0.1, -0.05]])
    last = np.array([0.28, -0.06, 0.03])
    bodies = [
        Body(None, np.zeros(3), X),
        Body(0, np.zeros(3), Y),
        Body(1, np.zeros(3), Z),
        Body(2, np.zeros(3), X, slides=True),  # the shaft behind the spline
        Body(3, X, Z),  # cross 1, a metre from cross 0 before it slides
        Body(None, np.zeros(3), last / math.sqrt(last @ last)),  # the last shaft turns anywhere
    ]
    pins = np.array([Y, *(v / math.sqrt(v @ v) for v in (last, np.cross(last, Y)))])
    loop = Loop(made(engine, bodies), 6, 4, 5, pins)
    for move in (np.zeros(3), np.array([0.02, -0.2, 0.1]), np.array([-0.05, 0.3, 0.0])):
        joint = drawn[2] + move
        line = Driveline.from_points([*drawn[:2], joint, joint + last])
        slopes = loop.closed(0.7, joint)
        assert abs(1.0 + loop.q[3] - line.lengths().each[1]) < 1e-13
        # How the slide follows the joint while the drive is held.
        goal = np.zeros((5, 3))
        goal[:3] = np.eye(3)
        slide = np.linalg.solve(slopes[:, 1:], goal)[2]
        force = line.spline_force(1, torque=500.0, friction=0.1, radius=0.02)
        assert force.axial == pytest.approx(2500.0, rel=1e-15)
        np.testing.assert_allclose(force.downstream, -force.axial * slide, rtol=0, atol=1e-8)
        along = last / math.sqrt(last @ last)
        assert abs(force.downstream_axial - force.axial * abs(slide @ along)) < 1e-8
        aside = np.linalg.norm(slide - along * (slide @ along))
        assert abs(force.downstream_transverse - force.axial * aside) < 1e-8
