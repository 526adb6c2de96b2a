"""Drivelines as they are installed: what follows from lengths and from the inertia of the drive."""

from __future__ import annotations

from typing import Any, SupportsIndex

from numpy.typing import ArrayLike

from cardan import free_running, slip
from cardan.bearings import Mounted
from cardan.free_running import FreeRunning
from cardan.slip import Lengths, SplineForce


class Installed(Mounted):
    """Drivelines in a machine; ``Driveline`` adds how they are made and what is evaluated."""

    __slots__ = ()

    def lengths(self) -> Lengths:
        """Return the lengths of the shafts, in the unit of the points.

        Over a batch of points, such as the positions of an axle, the travel of a shaft is what its
        spline must take up.

        Returns:
            length of every shaft of every driveline; shortest, longest and travel over the batch.

        Raises:
            ValueError: a driveline without lengths: one that was neither made from points nor given
                lengths by ``with_bearings``.

        >>> import cardan
        >>> heights = [[[0, 0, 0], [0.3, 0, 0], [1.5, y, 0], [1.8, y, 0]] for y in (-0.1, 0.0, 0.1)]
        >>> cardan.Driveline.from_points(heights).lengths().travel.round(5)
        array([0.     , 0.00416, 0.     ])
        """
        return slip.lengths(self._geometry)

    def spline_force(
        self,
        shaft: SupportsIndex,
        torque: ArrayLike,
        friction: ArrayLike,
        radius: ArrayLike,
    ) -> SplineForce:
        """Return the axial force of a loaded spline while it slides: ``F = mu |T|/r``.

        Over a turn, the largest torque gives the largest force; a spline of which the length
        changes slowly slides whenever the force suffices. The bends turn part of it across the
        shafts next to it.

        Args:
            shaft: index of the shaft with the spline.
            torque: torque of that shaft in N m; broadcasts against the batch.
            friction: coefficient of friction in the spline.
            radius: pitch radius of the spline in m.

        Returns:
            the force along the shaft, and on the shafts next to it as vectors and as parts along
            and across those shafts.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: values that are not real numbers.
            ValueError: a negative friction, a radius that is not positive, shapes that do not
                broadcast.
        """
        return slip.spline_force(self._geometry, shaft, torque, friction, radius)

    def free_running(self, inertias: ArrayLike) -> FreeRunning:
        """Return how the speed of the drive varies where no torque holds it.

        The kinetic energy of all shafts stays the same, so the speed of the drive goes as
        ``1/sqrt(I_0 + sum I_i r_i**2)`` with the speed ratios ``r_i``. A motor or a load changes
        this only as far as its torque varies within a turn.

        Args:
            inertias: moment of inertia of each shaft about its axis in kg m², with what turns with
                it, ``(..., n + 1)``; broadcasts against the batch. Shaft 0 is the drive.

        Returns:
            speed of the drive over its mean: at any angle, least, largest and the variation.

        Raises:
            TypeError: inertias that are not real numbers.
            ValueError: not one inertia per shaft, a negative one, all of them 0, shapes that do
                not broadcast.

        >>> import cardan
        >>> rig = cardan.Driveline.from_bends([8.5], degrees=True)
        >>> round(float(rig.free_running([10.0, 1.0]).variation), 5)
        0.00201
        """
        line: Any = self
        return free_running.free_running(line, inertias)
