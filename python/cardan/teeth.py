"""Yokes on splines: which tooth to take on each shaft."""

from __future__ import annotations

import math
import operator
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cardan.errors import ArgumentTypeError, ArgumentValueError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from cardan.arrays import FloatArray

# So many settings, and the teeth of so many neighbouring shafts, are compared at once.
_SETTINGS, _SHAFTS = 1 << 16, 12

# What is left of k by rounding where joints cancel each other.
_ROUNDING = 1e-15


def least_turned(
    objective: Callable[[FloatArray], FloatArray],
    present: FloatArray,
    teeth: Sequence[int],
    best: FloatArray,
) -> NDArray[np.int64]:
    """Return by how many teeth to turn the output-side yokes for the least objective.

    All positions of all shafts are compared if there are not too many: three shafts of 80 teeth, or
    five of 18. Otherwise it is the positions nearest to the best phases, of twelve neighbouring
    shafts at a time until nothing improves. Of settings that differ by rounding only, the one that
    turns the yokes least is taken.

    Args:
        objective: of settings in rad, ``(trials, n - 1)``; linear in the error of a setting near
            its least, as ``k`` is.
        present: the phases from which teeth count, ``(n - 1,)``.
        teeth: of the spline of each shaft between two joints.
        best: the phases to come near to, ``(n - 1,)``.
    """
    n, pitches = len(teeth), 2.0 * np.pi / np.asarray(teeth)
    width = min(n, _SHAFTS)
    steps = [_steps(count) for count in teeth]
    if math.prod(map(len, steps)) > _SETTINGS:
        most = int(_SETTINGS ** (1.0 / width))
        for shaft, own in enumerate(steps):
            off = present[shaft] + pitches[shaft] * own - best[shaft]
            order = np.argsort(np.abs(off - np.pi * np.round(off / np.pi)))
            steps[shaft] = own[order[:most]]
    turns = np.array([own[0] for own in steps])
    groups = [slice(first, first + width) for first in range(0, n - width + 1, width // 2 or 1)]
    groups += [slice(n - width, n)] if n > width else []
    least = np.inf
    while True:
        for group in groups:
            chosen = np.array(list(product(*steps[group])))
            trials = np.tile(turns, (len(chosen), 1))
            trials[:, group] = chosen
            k = objective(present + pitches * trials)
            size = np.sum((pitches * trials) ** 2, axis=-1)
            good = k <= np.min(k) * (1.0 + 1e-9) + _ROUNDING
            taken = int(np.argmin(np.where(good, size, np.inf)))
            turns, found = trials[taken], float(k[taken])
        if len(groups) == 1 or found >= least - _ROUNDING:
            return turns
        least = found


def _steps(teeth: int) -> NDArray[np.int64]:
    """Turns in teeth that give all positions of a yoke, which looks the same every 180°.

    With an odd number of teeth half a turn is no whole number of them, so that there are twice as
    many positions as within 180° of the spline.
    """
    period = teeth if teeth % 2 else teeth // 2
    return np.arange(period) - (period - 1) // 2


def teeth_of(teeth: int | Sequence[int], shafts: int) -> NDArray[np.int64]:
    """Return the teeth of each shaft between two joints, from one number for all or one each.

    Raises:
        TypeError: what are not integers.
        ValueError: not one per shaft, or less than 1.
    """
    try:
        counts = [operator.index(count) for count in np.atleast_1d(teeth)]
    except TypeError:
        problem = f"is {teeth!r}; it must be a whole number or one per shaft"
        raise ArgumentTypeError("teeth", problem) from None
    if np.ndim(teeth) and len(counts) != shafts:
        problem = f"has length {len(counts)}; it must be {shafts}, one per shaft between two joints"
        raise ArgumentValueError("teeth", problem)
    for i, count in enumerate(counts):
        if count < 1:
            place = (i,) if np.ndim(teeth) else ()
            raise ArgumentValueError("teeth", f"is {count}; a spline has at least 1 tooth", place)
    return np.broadcast_to(np.array(counts, dtype=np.int64), (shafts,))
