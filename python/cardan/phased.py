"""Drivelines whose yokes are to be set: the phases with the least equivalent bend."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core, threads
from cardan.arrays import FloatArray
from cardan.common_phases import common_phases
from cardan.in_service import InService


class Phased(InService):
    """One or more drivelines and the best setting of their yokes."""

    __slots__ = ()

    def optimal_phases(
        self,
        *,
        states: int | None = None,
        weights: ArrayLike | None = None,
        teeth: int | Sequence[int] | None = None,
        fixed: int | Sequence[int] | None = None,
        degrees: bool = False,
    ) -> FloatArray:
        """Return the phases that bring the last shaft closest to constant velocity.

        With ``L = ln sec(bend)`` exact constant velocity is possible if and only if the largest
        ``L`` is not more than all others together; then these phases reach it. Otherwise they line
        all joints up against the largest, which leaves the least possible equivalent bend. Of all
        such phases they are those to which the yokes turn least from their present ones (least sum
        of squares; with four or more bent joints least within their neighbourhood).

        Two joints at ``p = phase - twist + 90°`` make ``cosh L = cosh L_1 cosh L_2 + sinh L_1 sinh
        L_2 cos 2p`` (from Thoma 4), the law of cosines of the hyperbolic plane, where constant
        velocity is a closed polygon of sides ``L``.

        With ``states``, ``teeth`` or ``fixed`` they minimise the weighted mean of ``k**2 =
        tan(bend/2)**4`` of the equivalent joint over the states: exact derivatives and several
        starts, because settings have many local minima.

        Args:
            states: an axis of the batch whose drivelines are the states of one driveline, such as
                ride heights, and share one setting. It is missing from the result, which broadcasts
                in ``with_phases`` if it is axis 0.
            weights: how much each state counts, ``(states,)``; by default all alike.
            teeth: of the spline of each shaft between two joints, ``(n - 1,)`` or one for all; the
                phases are then those that teeth permit, counted from the present ones. All
                combinations are compared up to 65 536, beyond that the nearest to good phases.
            fixed: shafts, counted from 0, whose yokes stay as they are.
            degrees: whether to return the phases in degrees.

        Returns:
            phases in rad or degrees, ``(..., n - 1)``, for ``with_phases``.

        Raises:
            TypeError: an axis, teeth or shafts that are not integers.
            ValueError: an axis or a shaft that does not exist, weights or teeth that do not fit,
                teeth or fixed shafts whose present phases differ between the states.
        """
        self._geometry.check_ideal(
            "best phases follow from one equivalent joint, which exists",
            "cardan.optimise minimises an output as built, such as 'angle_error_peak'",
        )
        if states is weights is teeth is fixed is None:
            bends, twists, now, *_ = self._geometry.flat()
            best = _core.optimal_phases(self.n_joints, bends, twists, now, threads.at_most(None))
            phases = best.reshape(self.phases.shape)
        else:
            phases = common_phases(self, states, weights, teeth, fixed)
        return np.degrees(phases) if degrees else phases
