"""Formulas of the sources that are not exact, each named as what it is."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, at_place, real


def catalogue_bend(bends: ArrayLike, fork_signs: ArrayLike) -> FloatArray:
    """Return ``sqrt|sum ± bend**2|`` over the joints, the last axis (catalogue 003, 6.4 and 6.5).

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a sign other than +1 and -1, shapes that do not fit.
    """
    bend, sign = real("bends", bends), real("fork_signs", fork_signs)
    wrong = np.abs(sign) != 1.0
    if wrong.any():
        raise ValueError(f"{at_place('fork_signs', sign, wrong)}; a fork sign is +1 or -1")
    return np.asarray(np.sqrt(np.abs(np.sum(sign * bend**2, axis=-1))))[()]
