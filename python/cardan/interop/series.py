"""Angles in a Series of pandas: the results are a DataFrame with the Series' index."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import import_optional
from cardan.arrays.errors import ArgumentTypeError
from cardan.evaluation.composed_plans import PlanInDegrees
from cardan.evaluation.plan import Plan
from cardan.interop.labelled import columns_of

if TYPE_CHECKING:
    import pandas


def evaluate(
    plan: Plan | PlanInDegrees, angle: pandas.Series, out: Mapping[str, NDArray[Any]] | None
) -> pandas.DataFrame:
    """Evaluate a plan at the angles of a Series.

    The columns are those of ``Result.to_pandas``. Rows of a batch have the number of the driveline
    in front of the Series' own index.

    Raises:
        TypeError: arrays to fill, which have no index; angles that are not real numbers.
    """
    if out is not None:
        raise ArgumentTypeError(
            "out", "does not go with an angle that is a Series; give its to_numpy()"
        )
    library = import_optional("pandas", "xarray")
    result = plan(angle.to_numpy())
    index, figures = columns_of(result)
    made: pandas.DataFrame = library.DataFrame({c.name: c.values for c in figures})
    made.attrs["units"] = {column.name: column.unit for column in figures}
    levels = [library.Index(c.values, name=c.name) for c in index if c.name != "drive_angle"]
    if len(levels) == len(index):
        # The angles are reduced.
        return made.set_index(levels) if levels else made
    if not levels:
        made.index = angle.index
        return made
    # Samples next to each other differ in the angle.
    own = angle.index[np.arange(len(made)) % max(1, len(angle))]
    levels += [own.get_level_values(level) for level in range(own.nlevels)]
    made.index = library.MultiIndex.from_arrays(levels)
    return made
