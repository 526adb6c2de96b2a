"""Parts of lateral systems, of which every number may be an array of a batch, and results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import ComplexArray, FloatArray
from cardan.arrays.errors import check_choice


@dataclass(frozen=True, eq=False)
class RigidShaft:
    """A shaft that moves across its axis and does not bend.

    Attributes:
        mass: in kg.
        centre: distance of the centre of mass from the upstream end in m.
        across: moment of inertia about an axis across the shaft through the centre in kg m².
        along: moment of inertia about the shaft's axis in kg m².
    """

    mass: ArrayLike
    centre: ArrayLike
    across: ArrayLike
    along: ArrayLike = 0.0


@dataclass(frozen=True, eq=False)
class ElasticBearing:
    """A bearing of stiffness ``k (1 + i loss_factor sign(w)) + i w damping`` at ``w`` in rad/s.

    Attributes:
        shaft: that it holds.
        position: distance from the upstream end of the shaft in m.
        stiffness: dynamic stiffness in N/m, one number or ``(..., 2)``: along the part of ``axis``
            across the shaft, and along ``u x`` that, with the direction ``u`` of the shaft. A batch
            that is alike in both directions is ``(..., 1)``.
        axis: any vector not along the shaft; needed if the two directions differ.
        loss_factor: of both directions, or of each; that of rubber at the frequencies of interest.
        damping: of both directions, or of each, in N s/m.
    """

    shaft: int
    position: ArrayLike
    stiffness: ArrayLike
    axis: ArrayLike | None = None
    loss_factor: ArrayLike = 0.0
    damping: ArrayLike = 0.0


@dataclass(frozen=True, eq=False)
class PointMass:
    """A yoke, flange or disc on a shaft.

    Attributes:
        shaft: that carries it.
        position: distance from the upstream end of the shaft in m.
        mass: in kg.
        across: moment of inertia about an axis across the shaft in kg m².
        along: moment of inertia about the shaft's axis in kg m².
    """

    shaft: int
    position: ArrayLike
    mass: ArrayLike
    across: ArrayLike = 0.0
    along: ArrayLike = 0.0


@dataclass(frozen=True, eq=False)
class Unbalance:
    """A force ``mass_arm * speed**2`` that turns with the drive, of order 1.

    Attributes:
        shaft: on which it acts.
        position: distance from the upstream end of the shaft in m.
        mass_arm: mass times distance from the axis in kg m.
        direction: any vector whose part across the shaft is where the force points at the drive
            angle 0.
    """

    shaft: int
    position: ArrayLike
    mass_arm: ArrayLike
    direction: ArrayLike


ITEMS: dict[str, tuple[type[Any], dict[str, int]]] = {
    "bearings": (
        ElasticBearing,
        {"position": 1, "stiffness": 2, "axis": 3, "loss_factor": 2, "damping": 2},
    ),
    "masses": (PointMass, {"position": 1, "mass": 1, "across": 1, "along": 1}),
    "unbalance": (Unbalance, {"position": 1, "mass_arm": 1, "direction": 3}),
}
"""Class of each kind of item, and sizes of the numbers in its fields, in the core's order."""

Vectors: TypeAlias = Literal[
    "bearing_force", "bearing_displacement", "joint_force", "joint_displacement", "displacement"
]
"""Names of the vectors of a response."""

VECTORS: tuple[Vectors, ...] = get_args(Vectors)


@dataclass(frozen=True, eq=False)
class LateralResponse:
    """The vibration at steady speeds; ``...`` is the shape of systems, speeds and loads.

    A quantity is ``Re(sum(orders * exp(1j * m * angle)))`` with the drive angle and the order
    ``m``; order 0 is its mean. The drive angle is 0 when the driving pin of joint 0 lies in the
    plane of shafts 0 and 1.

    Attributes:
        orders: multiples of the drive speed, ``(orders,)``.
        bearing_force: of each bearing on its shaft in N, ``(bearings, ..., orders, 3)``.
        bearing_displacement: of each shaft in its bearing in m, likewise.
        joint_force: of each joint on its driven shaft in N, across the sliding shaft,
            ``(joints, ..., orders, 3)``.
        joint_displacement: of the end that slides in m, likewise.
        displacement: of the probes in m, ``(probes, ..., orders, 3)``.
        bearing_power: mean power lost in each bearing in W, ``(bearings, ..., orders)``.
        tube_power: mean power lost in all tubes in W, ``(..., orders)``.
        given_power: mean power of all excitations in W, ``(..., orders)``.
    """

    orders: FloatArray
    bearing_force: ComplexArray
    bearing_displacement: ComplexArray
    joint_force: ComplexArray
    joint_displacement: ComplexArray
    displacement: ComplexArray
    bearing_power: FloatArray
    tube_power: FloatArray
    given_power: FloatArray

    def largest(self, name: Vectors) -> FloatArray:
        """Return the largest length of a vector over the turn, ``(items, ...)``.

        All orders of the response act together.

        Args:
            name: of a vector of the response, such as ``"bearing_force"``.

        Raises:
            ValueError: an unknown name, orders that do not repeat within 16 turns.
        """
        check_choice("name", name, VECTORS)
        amplitudes: ComplexArray = getattr(self, name)
        found = _core.largest_over_turn(amplitudes.ravel(), self.orders.tolist())
        return found.reshape(amplitudes.shape[:-2])

    def of_order(self, name: Vectors) -> FloatArray:
        """Return the largest length over the turn of each order alone, ``(items, ..., orders)``.

        Arguments and errors are as of ``largest``. It is ``sqrt((|x|**2 + |x . x|)/2)``.
        """
        check_choice("name", name, VECTORS)
        amplitudes: ComplexArray = getattr(self, name)
        each = [
            _core.largest_over_turn(np.ascontiguousarray(amplitudes[..., i, :]).ravel(), [order])
            for i, order in enumerate(self.orders.tolist())
        ]
        shape = (len(self.orders), *amplitudes.shape[:-2])
        return np.moveaxis(np.array(each).reshape(shape), 0, -1)


@dataclass(frozen=True, eq=False)
class LateralModes:
    """Natural frequencies at rest and without damping, lowest first.

    Attributes:
        frequencies: in rad/s, ``(..., count)``; infinite where the system has fewer.
        displacement: of the probes, ``(probes, ..., count, 3)``, scaled so that the longest of a
            mode has the length 1.
    """

    frequencies: FloatArray
    displacement: FloatArray


@dataclass(frozen=True)
class LateralResonance:
    """A drive speed at which an order meets a natural frequency.

    Attributes:
        speed: in rad/s.
        order: multiple of the drive speed.
        frequency: the natural frequency in rad/s.
        shaft: on which the place lies that moves most.
        position: of this place, from the upstream end of the shaft in m.
        direction: unit vector along which it moves.
    """

    speed: float
    order: float
    frequency: float
    shaft: int
    position: float
    direction: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class TorqueStiffness:
    """How the moments of the joints change where a steady torque displaces points of a driveline.

    The points are the ends of shafts that can move, each with two components across its shaft.
    Their forces are ``(mean + Re(turning exp(2 i angle))) d`` for displacements ``d``.

    Attributes:
        mean: in N/m, ``(..., m, m)``; an antisymmetric part is circulatory.
        turning: complex amplitude of order 2 in N/m, likewise.
    """

    mean: FloatArray
    turning: ComplexArray

    @property
    def kappa(self) -> FloatArray:
        """Size of ``kappa`` in ``kappa exp(2 i angle) conj(z)`` in N/m, ``(...)``.

        Of several points it is the largest.
        """
        if not self.turning.shape[-1]:
            return np.zeros(self.turning.shape[:-2])
        return np.asarray(np.linalg.norm(self.turning, 2, axis=(-2, -1)) / 2.0)
