"""What a lateral system consists of beside tubes: rigid shafts, bearings, masses and unbalances.

Every number may be an array that broadcasts to the batch of the system.
"""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike


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
