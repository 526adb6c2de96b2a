"""Two multibody engines behind one interface, for the driveline models of ``test_multibody.py``.

A model is a tree of rigid bodies, each held by its parent (or by the fixed frame) in one hinge or
slide through its origin; coordinate ``i`` is that of body ``i``, and a body stands in the list
directly after its parent or after the last body that its parent's other children carry, as both
engines number them. The engine supplies what its own kinematics and dynamics make of that:
placements, Jacobians, the mass matrix, the forces of motion, and the wrench in each bearing. Loops
are not the engine's affair: its own constraints are soft (MuJoCo) or proximal (Pinocchio), and
closing them by its Jacobians keeps all the digits it has.

Wrenches and velocities are six numbers in the axes of the frame at the origin of the body: moment
before force, turning before moving.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

# MuJoCo refuses a body without mass or inertia, and asks for more than 1e-15.
TRIFLE = 2e-15


@dataclass(frozen=True)
class Body:
    """One body, as it stands when all coordinates are zero; its axes are then the frame's."""

    parent: int | None
    origin: Doubles
    axis: Doubles
    inertia: float = 0.0  # about the axis; 0.7 of it across
    slides: bool = False

    @property
    def tensor(self) -> Doubles:
        along = np.outer(self.axis, self.axis)
        return self.inertia * (along + 0.7 * (np.eye(3) - along))


@dataclass(frozen=True)
class State:
    """What an engine finds for one set of coordinates and their rates."""

    origin: Doubles  # body, 3
    rotation: Doubles  # body, 3, 3: columns are the axes of the body
    jacobian: Doubles  # body, 6, coordinate
    drift: Doubles  # body, 6: the accelerations that are left when the second rates are zero
    mass: Doubles  # coordinate, coordinate
    bias: Doubles  # coordinate: the forces of motion when the second rates are zero


class Engine(Protocol):
    """What the tests ask of an engine."""

    def state(self, q: Doubles, v: Doubles) -> State: ...

    def bearings(self, q: Doubles, v: Doubles, a: Doubles, applied: Doubles) -> Doubles:
        """Return the wrench that each body gets from what holds it, with ``applied`` on it."""
        ...


class Pinocchio:
    """Pinocchio: Featherstone's algorithms, exact to rounding."""

    def __init__(self, pin: ModuleType, bodies: Sequence[Body]) -> None:
        self.pin = pin
        self.model = pin.Model()
        self.model.gravity.setZero()
        for number, body in enumerate(bodies):
            hinge = (
                pin.JointModelPrismaticUnaligned if body.slides else pin.JointModelRevoluteUnaligned
            )
            held = 0 if body.parent is None else body.parent + 1
            start = np.zeros(3) if body.parent is None else bodies[body.parent].origin
            placement = pin.SE3(np.eye(3), body.origin - start)
            joint = self.model.addJoint(held, hinge(*body.axis), placement, str(number))
            inertia = pin.Inertia(body.inertia, np.zeros(3), body.tensor)
            self.model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
        self.data = self.model.createData()

    def state(self, q: Doubles, v: Doubles) -> State:
        pin, model, data = self.pin, self.model, self.data
        mass = np.triu(pin.crba(model, data, q))
        bias = np.array(pin.nonLinearEffects(model, data, q, v))
        pin.computeJointJacobians(model, data, q)
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        joints = range(1, model.njoints)
        at = pin.LOCAL_WORLD_ALIGNED
        drifts = [pin.getClassicalAcceleration(model, data, j, at) for j in joints]
        # Pinocchio puts the force and the velocity before the moment and the turning.
        swap = [3, 4, 5, 0, 1, 2]
        return State(
            origin=np.array([data.oMi[j].translation for j in joints]),
            rotation=np.array([data.oMi[j].rotation for j in joints]),
            jacobian=np.array([pin.getJointJacobian(model, data, j, at)[swap] for j in joints]),
            drift=np.array([np.concatenate([drift.angular, drift.linear]) for drift in drifts]),
            mass=mass + np.triu(mass, 1).T,
            bias=bias,
        )

    def bearings(self, q: Doubles, v: Doubles, a: Doubles, applied: Doubles) -> Doubles:
        pin, model, data = self.pin, self.model, self.data
        pin.forwardKinematics(model, data, q)
        rotation = [data.oMi[j].rotation.copy() for j in range(1, model.njoints)]
        outer = pin.StdVec_Force()
        outer.append(pin.Force.Zero())
        for turn, wrench in zip(rotation, applied, strict=True):
            outer.append(pin.Force(turn.T @ wrench[3:], turn.T @ wrench[:3]))
        pin.rnea(model, data, q, v, a, outer)
        forces = [data.f[j] for j in range(1, model.njoints)]
        return np.array(
            [
                np.concatenate([turn @ force.angular, turn @ force.linear])
                for turn, force in zip(rotation, forces, strict=True)
            ]
        )


class MuJoCo:
    """MuJoCo: its kinematics, mass matrix and recursive Newton-Euler, without its soft solver."""

    def __init__(self, mujoco: ModuleType, bodies: Sequence[Body]) -> None:
        self.mujoco = mujoco
        spec = mujoco.MjSpec()
        spec.option.gravity = np.zeros(3)
        made: list[Any] = []
        for number, body in enumerate(bodies):
            held = spec.worldbody if body.parent is None else made[body.parent]
            start = np.zeros(3) if body.parent is None else bodies[body.parent].origin
            principal = np.zeros(4)
            mujoco.mju_quatZ2Vec(principal, body.axis)
            made.append(
                held.add_body(
                    name=str(number),
                    pos=body.origin - start,
                    mass=body.inertia + TRIFLE,
                    ipos=np.zeros(3),
                    iquat=principal,
                    inertia=body.inertia * np.array([0.7, 0.7, 1.0]) + TRIFLE,
                    explicitinertial=True,
                )
            )
            kind = mujoco.mjtJoint.mjJNT_SLIDE if body.slides else mujoco.mjtJoint.mjJNT_HINGE
            made[-1].add_joint(name=str(number), type=kind, axis=body.axis)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

    def _stand(self, q: Doubles, v: Doubles) -> None:
        mujoco, model, data = self.mujoco, self.model, self.data
        data.qpos, data.qvel = q, v
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)

    def state(self, q: Doubles, v: Doubles) -> State:
        mujoco, model, data = self.mujoco, self.model, self.data
        self._stand(q, v)
        mass, bias = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
        mujoco.mj_fullM(model, data, mass)
        mujoco.mj_rne(model, data, 0, bias)
        turning, moving = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        jacobian, drift = np.zeros((model.nv, 6, model.nv)), np.zeros((model.nv, 6))
        for body in range(1, model.nbody):  # the frame is body 0
            mujoco.mj_jacBody(model, data, moving, turning, body)
            jacobian[body - 1] = np.vstack([turning, moving])
            mujoco.mj_jacDot(model, data, moving, turning, data.xpos[body], body)
            drift[body - 1] = np.vstack([turning, moving]) @ v
        return State(
            origin=data.xpos[1:].copy(),
            rotation=data.xmat[1:].reshape(-1, 3, 3).copy(),
            jacobian=jacobian,
            drift=drift,
            mass=mass,
            bias=bias,
        )

    def bearings(self, q: Doubles, v: Doubles, a: Doubles, applied: Doubles) -> Doubles:
        mujoco, model, data = self.mujoco, self.model, self.data
        self._stand(q, v)
        data.qacc = a
        data.xfrc_applied[1:] = applied[:, [3, 4, 5, 0, 1, 2]]
        mujoco.mj_rnePostConstraint(model, data)
        # Kept about the centre of mass of the whole tree; wanted about the origin of the body.
        wrench: Doubles = data.cfrc_int[1:].copy()
        arm = data.subtree_com[model.body_rootid[1:]] - data.xpos[1:]
        wrench[:, :3] += np.cross(arm, wrench[:, 3:])
        return wrench
