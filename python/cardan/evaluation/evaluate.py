"""What is asked of a driveline at drive angles: evaluations, plans and harmonics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan.arrays.indices import Items, is_index, item_index
from cardan.evaluation.composed_plans import PlanInDegrees, PlanOfReductions, planned, remembered
from cardan.evaluation.harmonics import Harmonics
from cardan.evaluation.load import Load
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import AngleOf, Axes, Reduction, Request
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


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
