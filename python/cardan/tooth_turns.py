"""The best setting of a driveline whose yokes sit on splines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.teeth import least_turned


def tooth_turns(line: Driveline, teeth: Sequence[int], best: FloatArray) -> NDArray[np.int64]:
    """Return by how many teeth to turn the output-side yokes for the least equivalent bend.

    ``least_turned`` says which settings are compared.

    Args:
        line: one driveline, with the yokes as they are.
        teeth: of the spline of each shaft between two joints, at least 1.
        best: the phases to come near to, in rad, ``(n - 1,)``.

    Returns:
        teeth by which to turn each yoke from where it is, positive clockwise, looking from the
        drive towards the output, ``(n - 1,)``.
    """

    def roots(phases: FloatArray) -> FloatArray:
        return np.asarray(line.with_phases(phases).equivalent().k)

    return least_turned(roots, line.phases, teeth, best)
