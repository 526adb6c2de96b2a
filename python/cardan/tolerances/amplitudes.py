"""The complex numbers of which figures of the motion are functions, for deviating drivelines."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.design.quantities import Amplitude
from cardan.tolerances.chain import (
    ComplexArray,
    Deviations,
    Nominal,
    joints_and_turns,
    q_of,
    reversed_deviations,
)


def amplitude(
    kind: Amplitude, nominal: Nominal, deviations: Deviations, shaft: int
) -> ComplexArray:
    """Return one of the complex numbers that ``MotionQuantity.amplitudes`` names.

    Args:
        kind: which one.
        nominal: the driveline as drawn.
        deviations: by how much it deviates in each sample.
        shaft: the shaft of ``"last"``, at least 1.
    """
    if kind == "coasting":
        deviations, nominal = reversed_deviations(nominal, deviations), nominal.reversed()
    joints, turns = joints_and_turns(nominal, deviations)
    if kind == "last":
        return q_of(joints[:shaft], turns[:shaft])
    total: Any = 0j
    for behind in range(1, nominal.n_joints):
        total = total + q_of(joints[:behind], turns[:behind])
    return np.asarray(total)
