"""Yokes on splines: which tooth to take on each shaft."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cardan.arrays import FloatArray
    from cardan.driveline import Driveline

# So many settings are compared at once, in about a second for 15 joints.
_SETTINGS = 1 << 16

# What is left of k by rounding where joints cancel each other.
_ROUNDING = 1e-15


def tooth_turns(line: Driveline, teeth: Sequence[int], best: FloatArray) -> NDArray[np.int64]:
    """Return by how many teeth to turn the output-side yokes for the least equivalent bend.

    All positions of all shafts are compared if there are not too many, otherwise on each shaft
    those nearest to its best phase; beyond 16 shafts one shaft at a time, until none improves. Of
    settings that differ by rounding only, the one that turns the yokes least is taken.

    Args:
        line: one driveline, with the yokes as they are.
        teeth: of the spline of each shaft between two joints, at least 1.
        best: the phases to come near to, in rad, ``(n - 1,)``.

    Returns:
        teeth by which to turn each yoke from where it is, positive clockwise, looking from the
        drive towards the output, ``(n - 1,)``.
    """
    shafts = range(len(teeth))
    pitches = 2.0 * np.pi / np.asarray(teeth)
    at_once = 2 ** len(teeth) <= _SETTINGS
    most = max(int(_SETTINGS ** (1.0 / len(teeth))), 2) if at_once else _SETTINGS
    nearest = []
    for shaft, pitch in enumerate(pitches):
        steps = _steps(teeth[shaft])
        off = line.phases[shaft] + pitch * steps - best[shaft]
        order = np.argsort(np.abs(off - np.pi * np.round(off / np.pi)), kind="stable")
        nearest.append(steps[order])
    if np.prod([len(steps) for steps in nearest], dtype=float) > _SETTINGS:
        nearest = [steps[:most] for steps in nearest]
    turns = np.array([steps[0] for steps in nearest])
    least = np.inf
    while True:
        for group in [list(shafts)] if at_once else [[shaft] for shaft in shafts]:
            combinations = np.array(list(product(*(nearest[shaft] for shaft in group))))
            trials = np.tile(turns, (len(combinations), 1))
            trials[:, group] = combinations
            k = line.with_phases(line.phases + pitches * trials).equivalent().k
            size = np.sum((pitches * trials) ** 2, axis=-1)
            good = k <= np.min(k) * (1.0 + 1e-9) + _ROUNDING
            taken = int(np.argmin(np.where(good, size, np.inf)))
            turns, found = trials[taken], float(k[taken])
        if at_once or found >= least - _ROUNDING:
            return turns
        least = found


def _steps(teeth: int) -> NDArray[np.int64]:
    """Turns in teeth that give all positions of a yoke, which looks the same every 180°.

    With an odd number of teeth half a turn is no whole number of them, so that there are twice as
    many positions as within 180° of the spline.
    """
    period = teeth if teeth % 2 else teeth // 2
    return np.arange(period) - (period - 1) // 2
