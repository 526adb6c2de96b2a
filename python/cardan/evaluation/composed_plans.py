"""What evaluates by plans: in degrees, and with several reductions at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import adapter, array_namespace_of, as_float64
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.driven_angle import planned
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.request import Reduction, Request
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


class PlanInDegrees:
    """A plan called with degrees; the results that are angles come in degrees as well."""

    def __init__(self, plan: Callable[[Any, Any], Result], driven: bool = False) -> None:
        """Keep what evaluates at angles in rad and fills arrays.

        With ``driven`` it takes angles of the last shaft. The drive angles then differ between the
        drivelines of a batch.
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
        arrays = dict(result)
        for name, array in result.items():
            if OUTPUTS[name].unit == "rad":
                arrays[name] = np.degrees(array) if out is None else np.degrees(array, out=array)
        labels = None if result._labels is None else (*result._labels[:4], "deg")
        return Result(arrays, labels, np.degrees(result._angle) if self._driven else angle)


def _arrays(out: Mapping[str, NDArray[Any]]) -> list[NDArray[Any]]:
    # Anything else is refused by the plan.
    values = out.values() if isinstance(out, Mapping) else ()
    return [array for array in values if isinstance(array, np.ndarray)]


class PlanOfReductions:
    """A plan for each of several reductions; the results are stacked along a new axis."""

    def __init__(self, line: Driveline, request: Request, reductions: Sequence[Reduction]) -> None:
        """Make the plans of a request without a reduction, one for each reduction.

        Raises:
            ValueError: no reduction, or a peak among other reductions of a vector.
        """
        self._names = tuple(reductions)
        if not self._names:
            raise ArgumentValueError("reduce", "is empty; name at least one reduction")
        self._plans = [planned(line, request._replace(reduce=name)) for name in self._names]
        vectors = [name for name in self._plans[0].places if OUTPUTS[name].vector]
        if vectors and "peak" in self._names and len(set(self._names)) > 1:
            raise ArgumentValueError(
                "reduce",
                f"is {list(self._names)!r}; the peak of {vectors[0]} is the length of a vector "
                "and has no components, so it cannot be stacked with other reductions",
            )

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate as each plan does.

        Raises:
            TypeError: arrays to fill.
            ValueError: as of the plans.
        """
        if out is not None:
            raise ArgumentTypeError("out", "does not go with several reductions")
        name = "" if isinstance(angle, Sweep) else array_namespace_of(angle)
        if name and LIBRARIES[name].wraps:
            labelled: Result = adapter(name).evaluate(self, angle, out)
            return labelled
        results = [plan(angle) for plan in self._plans]
        arrays = {}
        for output in results[0]:
            items = self._plans[0].places[output][1]
            stacked = [result[output] for result in results]
            arrays[output] = np.stack(stacked, axis=0 if items is None else 1)
        first = results[0]._labels
        labels = None if first is None else (*first[:3], self._names, first[4])
        return Result(arrays, labels, results[0]._angle)
