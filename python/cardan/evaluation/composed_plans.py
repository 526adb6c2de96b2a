"""What evaluates by plans: at angles of the last shaft, in degrees, several reductions at once.

Of a driven angle the core finds the drive angles in closed form, each with an error term, and
evaluates at these sums: a steep chain would magnify the rounding of a drive angle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, adapter, array_namespace_of, as_float64, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_choice
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Reduction, Request
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline

# The most calls that a driveline remembers; one more replaces them all.
_MOST = 8


class DrivenPlan(Plan):
    """A plan that is called with angles of the last shaft; made by ``Driveline.plan``.

    The ``drive_angle`` of a result is the drive angle that belongs to each of them.
    """

    def __init__(self, at_drive: Plan) -> None:
        """Keep the plan that is called with drive angles."""
        super().__init__(at_drive.line, at_drive.request)
        self.request = self.request._replace(angle_of="driven")
        self._at_drive = at_drive

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate at mean-synchronous angles of the last shaft, as the output ``angle`` has them.

        The drive angles are stored, also if the outputs are reduced. Otherwise as for any plan.
        """
        if name := array_namespace_of(angle):
            if LIBRARIES[name].wraps and self.line.shape:
                problem = "has labels, and each driveline of the batch has different drive angles; "
                raise ArgumentValueError("angle", f"{problem}give its values")
            result = super().__call__(angle, out)
            if LIBRARIES[name].deferred:
                request = Request("angle", shafts=0, workers=self._workers)
                of_drive = DrivenPlan(Plan(self.line, request))
                drive = adapter(name).evaluate(of_drive, angle, None)["angle"]
                return Result(dict(result), result._labels, drive)
            return result
        drive, error_terms = self._sums(angle)
        evaluated = self._at_drive._run(drive, (drive, error_terms), out)
        assert evaluated is not None, "arrays that the core made lie one after another"
        return evaluated

    def _drive_angles(self, angle: ArrayLike | Sweep) -> FloatArray:
        return self._sums(angle)[0]

    def _sums(self, angle: ArrayLike | Sweep) -> tuple[FloatArray, FloatArray]:
        """Return the drive angles and their error terms."""
        given = angle if isinstance(angle, Sweep) else as_float64("angle", angle)
        angles = given._core if isinstance(given, Sweep) else given
        shape, workers = self._sample_shape(given.shape), threads.at_most(self._workers)
        found = self._core.drive_angles(shape, angles, workers, self._level)
        assert found is not None, "angles are aligned and in C order"
        return found[0, ...], found[1, ...]

    def _again(self, line: Driveline, request: Request) -> Plan:
        return DrivenPlan(self._at_drive._again(line, request))

    def explain(self, angle: ArrayLike | Sweep | None = None) -> str:
        """Return the steps at the drive angles, as ``Plan.explain`` does."""
        shape: Any = angle
        if isinstance(angle, Sweep):
            shape = np.broadcast_to(0.0, np.broadcast_shapes(self.line.shape, angle.shape))
        outputs = self._at_drive.explain(shape)
        return f"drive angles in closed form from angles of the last shaft\n{outputs}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the plan that is called with drive angles."""
        return (DrivenPlan, (self._at_drive,))


def planned(line: Driveline, request: Request) -> Plan:
    """Return the plan of a driveline for a request."""
    axes, angle_of = request.axes, request.angle_of
    if axes == "space" and angle_of == "drive":
        return Plan(line, request)
    line._geometry.check_ideal(
        'axes="shaft" and angle_of="driven" are', "use the axes of space and the drive angle"
    )
    check_choice("axes", axes, ("space", "shaft"))
    check_choice("angle_of", angle_of, ("drive", "driven"))
    plan = Plan(line, request)
    return DrivenPlan(plan) if angle_of == "driven" else plan


def remembered(line: Driveline, request: Request) -> Plan:
    """Return the plan of ``planned`` for this request, made by an earlier call if possible.

    Preparing a plan takes twice as long as evaluating it at a few angles. Only a second call with
    the same arguments keeps its plan: most drivelines of a list are evaluated once, and plans take
    memory.
    """
    if not isinstance(request.names, (str, tuple)):
        request = request._replace(names=tuple(request.names))
    load = request.load
    # 1.0 equals 1, but is no index and no number of threads.
    key = (request, type(request.shafts), type(request.joints), type(request.workers))
    plans = line._plans
    try:
        plan: Plan | None = plans.get(key)
    except TypeError:
        return planned(line, request)  # A list of shafts, say, has no hash.
    if plan is not None:
        return plan
    if key in plans:
        # A plan holds its driveline. If that held the plan, both would stay until the garbage
        # collector finds the cycle, so the plan holds another object with the same arrays.
        plan = plans[key] = planned(line._twin(), request)
        return plan
    # Of a load with arrays a plan would keep a copy.
    small = load is None or (
        isinstance(load, Load) and load.inertias is None and not any(load.shapes().values())
    )
    if small and not line.shape:
        if len(plans) >= _MOST:
            plans.clear()
        plans[key] = None
    return planned(line, request)


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
        """Evaluate as the plan does; a sweep must not have its ends in rad."""
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
            # Anything but a mapping of arrays is refused by the plan.
            filled = out.values() if isinstance(out, Mapping) else ()
            if any(isinstance(a, np.ndarray) and np.may_share_memory(angle, a) for a in filled):
                # The result shows the angles, which are about to be overwritten.
                angle = angle.copy()
        result = self._plan(radians, out)
        arrays = dict(result)
        for name, array in result.items():
            if OUTPUTS[name].unit == "rad":
                arrays[name] = np.degrees(array) if out is None else np.degrees(array, out=array)
        labels = None if result._labels is None else (*result._labels[:4], "deg")
        return Result(arrays, labels, np.degrees(result._angle) if self._driven else angle)


class PlanOfReductions:
    """A plan for each of several reductions; the results are stacked along a new axis."""

    def __init__(self, line: Driveline, request: Request, reductions: Sequence[Reduction]) -> None:
        """Make the plans of a request without a reduction, one for each reduction."""
        self._names = tuple(reductions)
        if not self._names:
            raise ArgumentValueError("reduce", "is empty; name at least one reduction")
        self._plans = [planned(line, request._replace(reduce=name)) for name in self._names]
        vectors = [name for name in self._plans[0].places if OUTPUTS[name].vector]
        if vectors and "peak" in self._names and len(set(self._names)) > 1:
            peak = f"the peak of {vectors[0]} is the length of a vector and has no components"
            problem = f"is {list(self._names)!r}; {peak}, so it cannot be stacked with other "
            raise ArgumentValueError("reduce", f"{problem}reductions")

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate as each plan does, without arrays to fill."""
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
