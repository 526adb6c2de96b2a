"""Torsional vibration against a multibody engine with a torsion spring.

Opt-in like ``test_multibody.py``, whose loops of hinges and crosses are used. The compliant shaft
is two bodies in one line; the hinge between them has the engine's own stiffness and damping. The
motion is integrated with the accelerations that the engine's mass matrix and forces give, and no
formula of a joint enters.
"""

from __future__ import annotations

import numpy as np
import pytest

import cardan
from engines import Body, Doubles, MuJoCo
from test_multibody import Drawing, Model, Rig

pytestmark = pytest.mark.physics

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.25, 0.1], [3.0, 0.3, 0.6]])
STIFFNESS, DAMPING, LOAD, SPEED = 6000.0, 3.0, 80.0, 130.0
INERTIAS = np.array([[0.0, 0.02], [0.01, 0.015], [0.02, 0.06]])
# Hinges: shaft 0, cross 0, the halves of shaft 1, cross 1, shaft 2.
TWIST, LAST = 3, 5


def rig_of(drawing: Drawing) -> Rig:
    engine = pytest.importorskip("mujoco")
    driving, _ = drawing.pins()
    u, v, w = drawing.axes
    near, far = drawing.points[1:3]
    bodies = [
        Body(None, near, u, INERTIAS[0].sum()),
        Body(0, near, driving[0]),
        Body(None, near, v, INERTIAS[1, 0]),
        Body(2, near, v, INERTIAS[1, 1]),
        Body(3, far, driving[1]),
        Body(None, far, w, INERTIAS[2].sum()),
    ]
    made = MuJoCo(engine, bodies)
    made.model.jnt_stiffness[TWIST], made.model.dof_damping[TWIST] = STIFFNESS, DAMPING
    return Rig(made, Model(bodies, [0, 2, LAST], [1, 4], [0, 1], forces=False), drawing)


def closed(rig: Rig, angle: float, twist: float) -> Doubles:
    """The coordinates of an angle of the drive and a twist, on the near side of every joint."""
    q = rig.close(angle, np.zeros(6))
    others = [1, 2, 4, LAST]
    for twisted in np.linspace(q[TWIST], twist, 20):
        q[TWIST] = twisted
        for _ in range(20):
            at = rig.closure(rig.engine.state(q, np.zeros(6)), np.zeros(6))
            q[others] -= np.linalg.solve(at.jacobian[:, others], at.gap)
    assert rig.as_drawn(q)
    return q


def test_the_orbit_is_that_of_the_engine() -> None:
    integrate = pytest.importorskip("scipy.integrate")
    drawing = Drawing(POINTS, phases=(0.5,))
    rig = rig_of(drawing)
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_points(POINTS, phases=[0.5]),
        inertias=INERTIAS,
        stiffnesses=[np.inf, STIFFNESS, np.inf],
        dampings=[0.0, DAMPING, 0.0],
        load_torque=LOAD,
    )
    samples, first = 64, 3
    orbit = system.orbit(SPEED, samples)
    twist = orbit.angle_error[1, 1] - orbit.angle_error[1, 0]
    rate = orbit.speed[1, 1] - orbit.speed[1, 0]
    assert np.ptp(twist) > 0.02

    q = closed(rig, float(orbit.drive_angle[first]), float(twist[first]))
    rows = rig.closure(rig.engine.state(q, np.zeros(6)), np.zeros(6)).jacobian
    given, others = np.zeros(6), [1, 2, 4, LAST]
    given[[0, TWIST]] = SPEED, rate[first]
    given[others] = np.linalg.solve(rows[:, others], -rows @ given)

    def slopes(_: float, state: Doubles) -> Doubles:
        q, v = state.reshape(2, 6)
        at = rig.engine.state(q, v)
        closure = rig.closure(at, v)
        passive = rig.engine.data.qfrc_passive  # type: ignore[attr-defined]
        forces = passive - at.bias - LOAD * np.eye(6)[LAST]
        rows, drive = closure.jacobian, np.eye(6)[:1]
        held = np.vstack([rows, drive])
        matrix = np.block([[at.mass, held.T], [held, np.zeros((len(held), len(held)))]])
        right = np.concatenate([forces, -closure.drift, [0.0]])
        return np.concatenate([v, np.linalg.solve(matrix, right)[:6]])

    angles = np.pi * np.arange(samples + 1) / samples
    found = integrate.solve_ivp(
        slopes,
        (0.0, np.pi / SPEED),
        np.concatenate([q, given]),
        method="DOP853",
        t_eval=angles / SPEED,
        rtol=1e-10,
        atol=1e-11,
    )
    turned, spinning = found.y[:6], found.y[6:]
    scale = np.abs(twist).max()
    later = (first + np.arange(samples + 1)) % samples
    assert turned[TWIST] == pytest.approx(twist[later], abs=1e-7 * scale)
    assert spinning[TWIST] == pytest.approx(rate[later], abs=1e-7 * np.abs(rate).max())
    assert spinning[LAST] == pytest.approx(orbit.speed[2, 1, later], abs=1e-7 * SPEED)
    torque = STIFFNESS * turned[TWIST] + DAMPING * spinning[TWIST]
    assert -torque == pytest.approx(orbit.torque[0, later], abs=1e-7 * np.abs(torque).max())
