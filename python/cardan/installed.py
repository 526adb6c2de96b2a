"""Drivelines as they are installed: what follows from lengths and from the inertia of the drive."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from cardan import free_running
from cardan.batch import Batch
from cardan.free_running import FreeRunning


class Installed(Batch):
    """Drivelines in a machine; ``Driveline`` adds how they are made and what is evaluated."""

    __slots__ = ()

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
