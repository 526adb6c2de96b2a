"""What is asked of a driveline at drive angles: evaluations, plans and harmonics.

Plans are called at drive angles, at angles of the last shaft, in degrees, and for several
reductions at once. Of a driven angle the core finds the drive angles in closed form, each with an
error term, and evaluates at these sums: a steep chain would magnify the rounding of a drive angle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan.arrays import FloatArray, adapter, array_namespace_of, as_float64, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_choice
from cardan.arrays.indices import Items, is_index, item_index
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.harmonics import Harmonics
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.plan import Plan
from cardan.evaluation.reductions import Reduction
from cardan.evaluation.request import AngleOf, Axes, Request
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
                problem = f"is {angle!r} in rad; for degrees make it with degrees=True"
                raise ArgumentValueError("angle", problem)
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


def evaluate(
    line: Driveline,
    angle: ArrayLike | Sweep,
    outputs: str | Iterable[str] = ("angle", "speed_ratio"),
    *,
    shafts: Items = None,
    joints: Items = None,
    load: Load | None = None,
    reduce: Reduction | list[Reduction] | tuple[Reduction, ...] | None = None,
    out: Mapping[str, NDArray[Any]] | None = None,
    dtype: DTypeLike | None = None,
    tolerance: float | None = None,
    workers: int | None = None,
    degrees: bool = False,
    axes: Axes = "space",
    angle_of: AngleOf = "drive",
) -> Result:
    """Evaluate outputs over drive angles.

    Only what the outputs need is computed. The result of one output has the shape
    ``([items,] *broadcast(line.shape, angle.shape) [, 3])``. The axis of shafts or joints comes
    first and is dropped for a single index. The components of a vector come last.

    Args:
        angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch. NaN
            and infinite angles give NaN for that sample only. A dask array gives a result of
            dask arrays, with one task of one thread per chunk. An xarray DataArray gives an
            ``xarray.Dataset`` with the same coordinates, and a pandas Series gives a DataFrame
            with the same index.
        outputs: names from ``cardan.OUTPUTS``.
        shafts: shafts for the outputs per shaft: an index, a slice or a list; default: the last
            shaft.
        joints: joints for the outputs per joint; default: all.
        load: the load, for the outputs that need one.
        reduce: ``"min"``, ``"max"``, ``"mean"``, ``"rms"`` or ``"peak"`` over the last axis of
            the samples, which is dropped; no sample is stored. The peak is the largest
            magnitude; for a vector it is the largest length, without an axis of components. The
            other reductions treat the components of a vector separately. NaN among the samples
            gives NaN. A list of reductions gives each array an axis with one entry per
            reduction, after the axis of shafts or joints.
        out: arrays to fill, by output name, of the right shape and dtype. They become the
            arrays of the result. One of them may be the array of angles itself. Existing arrays
            save the operating system the work of providing new memory, which beyond some 10⁶
            angles can take as long as the evaluation. Vectors need no copy if their components
            are stored plane by plane, as in ``numpy.moveaxis(numpy.empty((3, n)), 0, -1)``.
            Ctrl-C stops an evaluation within a fraction of a second and leaves the arrays
            partly filled. While a call fills an array, calls on other threads cannot use it.
        dtype: ``float64`` (default) or ``float32``, the dtype of the results. ``float32`` also
            uses single precision after an exact reduction of the angles, unless ``tolerance``
            says otherwise.
        tolerance: permitted error, relative to each output's largest magnitude over a turn; the
            cheapest arithmetic that keeps it is chosen. 0 asks for results within 1 ulp (2 for
            moments and torques), 1e-6 and more for single precision; the default is the fast
            double, some ulp (the documentation's page Accuracy has the table). The steeper a
            chain, the more careful the arithmetic that is chosen. Where joints compensate each
            other, a tolerance above 0 is relative to the largest magnitude behind one of them
            alone. The results are those of the doubles in ``bends``, ``twists`` and ``phases``;
            vectors are laid out from the first of ``directions`` and of ``normals``. With 0,
            loads lose digits only where their terms cancel to less than 1e-13 of themselves, or
            where the cosines of all bends multiply to less than 1e-13.
        workers: largest number of threads, ``-1`` for all cores; default: all cores for calls
            that are large enough. The environment variable ``RAYON_NUM_THREADS`` limits the
            number; a forked process uses one thread. The results do not depend on it.
        degrees: whether the drive angle is in degrees. Outputs that are angles are then in
            degrees as well; all others do not change. Both conversions round. A ``Sweep``
            must have been made with ``degrees=True`` or by ``Sweep.revolutions``.
        axes: axes of vectors, at rest (``"space"``) or turning with the shaft on which the
            vector acts (``"shaft"``): x along the shaft, y along its input-side pin (shaft 0:
            its output-side pin), z their cross product. A ``moment`` and a ``joint_force`` act
            on the joint's driven shaft; the moment is ``(torque, 0, ± bending_driven)``.
        angle_of: the shaft whose angle ``angle`` is: that of the drive (``"drive"``), or the output
            ``angle`` of the last shaft (``"driven"``), as an encoder at the output measures it. The
            drive angles are then found in closed form and are the ``drive_angle`` of the result.
            The results are those before their rounding. They are stored, also with ``reduce``.

    Raises:
        IndexError: a shaft or joint that does not exist.
        MemoryError: results or intermediate arrays that do not fit in memory.
        RuntimeError: an ``out`` that another thread is filling.
        TypeError: angles that are not plain real numbers (masked or with a unit), indices that
            are not integers.
        ValueError: an unknown output, reduction or dtype, a load that is missing or does not
            fit, shapes that do not broadcast, an ``out`` of the wrong shape or type.
    """
    one = None if isinstance(reduce, (list, tuple)) else reduce
    request = Request(outputs, shafts, joints, load, one, dtype, tolerance, workers, axes, angle_of)
    plan: Plan | PlanOfReductions
    if isinstance(reduce, (list, tuple)):
        plan = PlanOfReductions(line, request, reduce)
    else:
        plan = remembered(line, request)
    if degrees:
        return PlanInDegrees(plan, angle_of == "driven")(angle, out)
    return plan(angle, out)


def plan(
    line: Driveline,
    outputs: str | Iterable[str] = ("angle", "speed_ratio"),
    *,
    shafts: Items = None,
    joints: Items = None,
    load: Load | None = None,
    reduce: Reduction | None = None,
    dtype: DTypeLike | None = None,
    tolerance: float | None = None,
    workers: int | None = None,
    axes: Axes = "space",
    angle_of: AngleOf = "drive",
) -> Plan:
    """Prepare an evaluation for any number of calls ``plan(angle, out=...)``.

    The plan decides once which steps the outputs need; ``print(plan.explain())`` shows them.

    Args:
        outputs: names from ``cardan.OUTPUTS``; they and all other arguments as for ``evaluate``.

    Returns:
        the plan; calling it gives the result of ``evaluate``.

    Raises:
        IndexError: a shaft or joint that does not exist.
        TypeError: outputs that are not names, indices that are not integers, a tolerance that is
            not a number.
        ValueError: an unknown output, reduction or dtype, a load that is missing or has not one
            inertia per shaft, a tolerance or number of threads out of range.
    """
    request = Request(
        outputs, shafts, joints, load, reduce, dtype, tolerance, workers, axes, angle_of
    )
    return planned(line, request)


def harmonics(
    line: Driveline,
    orders: ArrayLike = (2, 4, 6, 8),
    shaft: Items = -1,
    *,
    outputs: str | Iterable[str] = ("angle_error", "speed_ratio"),
    joints: Items = None,
    load: Load | None = None,
    axes: Axes = "space",
) -> Harmonics:
    """Return the mean of outputs over a turn, and their amplitudes and phases by order.

    At order ``2 n`` the amplitudes are ``k**n / n`` of the angle error and ``2 k**n`` of the
    speed ratio, with the ``k`` of ``equivalent``: the Fourier series of Thoma's (4). With
    deviations there are odd orders as well, and everything is summed over a turn.
    ``Plan.harmonics`` has the details and the errors.

    Args:
        orders: positive integers, ``(m,)`` or one; odd orders of the motion of ideal joints
            have amplitude 0. By default the first four even orders.
        shaft: shaft for the outputs per shaft, by default the last; also a slice or a list.
        outputs: names from ``cardan.OUTPUTS``, except ``angle``.
        joints: as for ``evaluate``, like the following arguments.
        load: constant over the turn.
        axes: of vectors.
    """
    if is_index(shaft):
        shaft = item_index("shaft", shaft, line.n_joints + 1)  # type: ignore[arg-type]
    return planned(line, Request(outputs, shaft, joints, load, axes=axes)).harmonics(orders)
