"""Evaluation in degrees: a plan that takes its drive angles and returns its angles in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import adapter, array_namespace_of, as_float64
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep


class PlanInDegrees:
    """A plan called with degrees; the results that are angles come in degrees as well."""

    def __init__(self, plan: Callable[[Any, Any], Result], driven: bool = False) -> None:
        """Keep the plan, or what else evaluates at angles in rad, and fills arrays.

        Args:
            plan: evaluates.
            driven: whether it takes angles of the last shaft, so that the drivelines of
                a batch have different drive angles.
        """
        self._plan = plan
        self._driven = driven

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate as the plan does.

        Raises:
            ValueError: a sweep with ends in rad, and as of the plan.
        """
        radians: Any = angle
        if isinstance(angle, Sweep):
            if angle.unit == "rad":
                raise ArgumentValueError(
                    "angle", f"is {angle!r} in rad; for degrees make it with degrees=True"
                )
        elif name := array_namespace_of(angle):
            if LIBRARIES[name].wraps:
                labelled: Result = adapter(name).evaluate(self, angle, out)
                return labelled
            radians = np.radians(angle)
        else:
            angle = as_float64("angle", angle)
            radians = np.radians(angle)
            if out is not None and any(np.may_share_memory(angle, a) for a in _arrays(out)):
                # The result shows the angles, which are about to be overwritten.
                angle = angle.copy()
        result = self._plan(radians, out)
        arrays = {
            name: _in_degrees(array, filled=out is not None) if is_angle(name) else array
            for name, array in result.items()
        }
        labels = None if result._labels is None else (*result._labels[:4], "deg")
        return Result(arrays, labels, np.degrees(result._angle) if self._driven else angle)


def is_angle(name: str) -> bool:
    """Whether an output is an angle."""
    return OUTPUTS[name].unit == "rad"


def _arrays(out: Mapping[str, NDArray[Any]]) -> list[NDArray[Any]]:
    # Anything else is refused by the plan.
    values = out.values() if isinstance(out, Mapping) else ()
    return [array for array in values if isinstance(array, np.ndarray)]


def _in_degrees(array: Any, filled: bool) -> Any:  # noqa: ANN401 - an array of any library
    return np.degrees(array, out=array) if filled else np.degrees(array)
