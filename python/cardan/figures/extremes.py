"""The extremes of a study's figures and where they lie."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cardan.scene.study import StudyResult
from cardan.scene.units import converted


def study_data(result: StudyResult, *, radians: bool = False) -> dict[str, Any]:
    """Return the extent of a study and the extremes of its figures, as plain data for JSON."""
    figures = {}
    for column in result.columns:
        suffix, values = converted(result.values[column.name], column.unit, radians)
        found: dict[str, Any] = {}
        # A point that is not a number is not an extreme; the file shows it.
        known = not np.isnan(values).all()
        for which, find in (("least", np.nanargmin), ("largest", np.nanargmax)):
            place = np.unravel_index(int(find(values)), values.shape) if known else ()
            found[which] = finite_or_none(float(values[place])) if known else None
            if result.axes and known:
                found[f"{which}_at"] = {
                    axis.key: float(axis.values[i])
                    for axis, i in zip(result.axes, place, strict=True)
                }
        figures[f"{column.name}{suffix}"] = found
    axes = {axis.key: len(axis.values) for axis in result.axes}
    return {"rows": result.rows, "axes": axes, "figures": figures}


def finite_or_none(value: float) -> float | None:
    """Return a number for JSON, which knows none that is not finite."""
    return float(value) if math.isfinite(value) else None
