"""Plans: what to evaluate of a driveline, prepared once for any number of calls."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan._core import Sweep as NativeSweep
from cardan.arrays import FloatArray, adapter, array_namespace_of, as_float64, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_shape
from cardan.evaluation.derivatives import (
    Derivatives,
    Gradient,
    derivatives,
    gradient,
    reduced_derivatives,
    reduced_gradient,
)
from cardan.evaluation.harmonics import Harmonics, harmonics
from cardan.evaluation.load import require_load
from cardan.evaluation.request import (
    DOUBLE,
    SINGLE,
    Request,
    checked_dtype,
    checked_tolerance,
    components_first,
    layout_of,
    planes_of,
    view,
)
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


class Plan:
    """The steps that evaluate some outputs of a driveline; made by ``Driveline.plan``.

    Call the plan to evaluate, as with ``Driveline.evaluate``. ``explain`` lists the steps and what
    is skipped. A plan never changes, so threads may share it.
    """

    # What can be read of a plan; the rest is for its calls.
    __slots__ = ("__dict__", "dtype", "labels", "line", "places", "planes", "request")

    def __init__(self, line: Driveline, request: Request, level: str | None = None) -> None:
        """Prepare as ``Driveline.plan`` does; ``level`` forces an instruction set."""
        n, shape = line.n_joints, line.shape
        names, shafts, joints, load, reduce, dtype, tolerance, workers, axes, _ = request
        layout = layout_of(names, n, shafts, joints, reduce, line.n_bearings)
        if load is not None:
            require_load(load)
        self.line = line
        # Without the last, so that a plan takes drive angles.
        self.request = Request(layout.names, *request[1:-1])
        self.dtype = DOUBLE if dtype is None else checked_dtype(dtype)
        self._reduce = reduce
        # What rows are reduced to is found in double.
        self._word = DOUBLE if reduce else self.dtype
        inertias = {} if load is None else load.inertias_by_shaft(n)
        # Read at every call.
        self._load = () if load is None else (load.torque, load.speed, load.acceleration)
        # Nothing but the angles changes from sample to sample.
        of_load = (*self._load, *inertias.values())
        self._only_angle_varies = not shape and not any(array.ndim for array in of_load)
        self._single_row = self._only_angle_varies and not reduce
        self._workers = workers
        self._level = level
        self._core = _core.Plan(
            line._lines,
            layout.names,
            layout.shapes,
            layout.shafts,
            layout.joints,
            None if load is None else (load.end, *self._load, [*inertias.items()]),
            None if tolerance is None else checked_tolerance(tolerance),
            self.dtype is SINGLE,
            reduce,
            # Lengths are the same in all axes.
            "space" if reduce == "peak" else axes,
        )
        self.labels = (*layout.shown, shape, reduce, "rad")
        self.places = layout.places
        self.planes = layout.planes
        self._fast_path = self._single_row and self._word is self.dtype
        if workers is not None:
            threads.at_most(workers)

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate at drive angles.

        Args:
            angle: drive angles in rad, any shape, or a ``Sweep``; broadcasts against the batch.
            out: arrays to fill, by output name, as of ``Driveline.evaluate``, like the errors.
        """
        named = out if type(out) is dict else None
        if self._fast_path and named is out and type(angle) is np.ndarray and angle.dtype is DOUBLE:
            # The usual call: on a few angles every question shows, that for equal lengths too.
            filled = self._core.run(None, angle, named, threads.at_most(self._workers), self._level)
            if filled is not None:
                return self._result(angle, filled, named)
        angles: FloatArray | NativeSweep
        if type(angle) is np.ndarray and (angle.dtype is DOUBLE or angle.dtype == DOUBLE):
            angles = angle
        elif isinstance(angle, Sweep):
            angles = angle._core
        elif type(angle) is not np.ndarray and (name := array_namespace_of(angle)):
            elsewhere: Result = adapter(name).evaluate(self, angle, out)
            return elsewhere
        else:
            angles = angle = as_float64("angle", angle)
        result = self._run(angle, angles, out)
        # Otherwise the angles do not lie one after another.
        return self(as_float64("angle", angle)) if result is None else result

    def _run(
        self,
        angle: Any,  # noqa: ANN401 - an array or a sweep
        angles: FloatArray | tuple[FloatArray, FloatArray] | NativeSweep,
        out: Mapping[str, NDArray[Any]] | None,
    ) -> Result | None:
        """Evaluate at angles as the native module takes them, if it can."""
        # The native module takes new results and dictionaries. Other arrays are looked at below.
        named = out if type(out) is dict else None
        shape = angle.shape if self._only_angle_varies else self._sample_shape(angle.shape)
        rows = self._rows(shape) if self._reduce else shape
        samples = None if self._single_row else shape
        workers = threads.at_most(self._workers)
        if named is out and (named is None or self._word is self.dtype):
            filled = self._core.run(samples, angles, named, workers, self._level)
            if filled is not None:
                return self._result(angle, filled, named)
        if out is not None:
            return self._call_into_arbitrary_layout(out, angle, angles, samples, rows, workers)
        return None

    def _result(self, angle: Any, filled: Any, named: object) -> Result:  # noqa: ANN401
        """Return the result of a run that has filled a new array, or arrays by name."""
        if named is not None:
            return Result(filled, self.labels, angle)
        block = filled if self._word is self.dtype else filled.astype(self.dtype)
        return Result(self.places, self.labels, angle, block)

    def _call_into_arbitrary_layout(
        self,
        out: Mapping[str, NDArray[Any]],
        angle: FloatArray | Sweep,
        angles: FloatArray | tuple[FloatArray, FloatArray] | NativeSweep,
        samples: tuple[int, ...] | None,
        rows: tuple[int, ...],
        workers: int | None,
    ) -> Result:
        """Evaluate into arrays of any layout, or say what is wrong with them."""
        given = self._checked_out(out, rows)
        if angles is angle:
            angles = angle = as_float64("angle", angle)
            if any(np.may_share_memory(angle, array) for array in given.values()):
                angles = angle = angle.copy()
        planes = self._planes_of(given, rows)
        if self._core.run(samples, angles, planes, workers, self._level) is None:
            raise RuntimeError("out is in use by another call")
        return Result(self._filled(given, planes, rows), self.labels, angle)

    def harmonics(self, orders: ArrayLike = (2, 4, 6, 8)) -> Harmonics:
        """Return the mean and the orders of each output over a turn of the drive.

        The load is constant over the turn. Its arrays broadcast against the batch, so that each
        value belongs to one driveline. The motion has its series in closed form (Fourier series of
        Thoma's 4). Everything else is summed over as many samples as its steepest joint and the
        highest order need. Half as many samples give a second sum, and the difference is part of
        the ``error``. It is far below rounding, except where an inertia reverses the torque, at
        which the magnitudes of moments have kinks.

        Half a turn only reverses the pins of ideal joints, so that an order is exactly 0 where it
        must be: the even ones of tilts, swings and pins and of what is along the axes y and z of
        ``axes="shaft"``, and the odd ones of everything else. Joints with deviations have all
        orders, each summed. Orders are those of the angle that the plan takes.

        Args:
            orders: positive integers, ``(m,)`` or one, as ``range(1, 13)``.

        Raises:
            TypeError: orders that are not integers.
            ValueError: an order below 1, or above 2**18 of what is summed; the output ``angle``,
                which is not periodic; a plan with a reduction; a load that does not broadcast
                against the batch.
        """
        return harmonics(self, orders)

    def derivatives(
        self, angle: ArrayLike | Sweep, by: str | Iterable[str] = ("bends", "twists", "phases")
    ) -> Derivatives:
        """Return the derivatives of every output at every sample.

        Each is a partial derivative. With respect to bends, twists and phases, everything else is
        held; with respect to points, bends and twists follow and the phases are held. Drivelines
        given by angles keep their first shaft and first bend plane in space.

        Derivatives with respect to points are smooth through straight joints, whose bend plane is
        arbitrary. The drive angle counts from the plane of joint 0; where that joint is straight,
        its plane is held. Magnitudes (``bending_driving``, ``bending_driven``) have derivative 0
        where they vanish. Bearings keep their distance from the upstream end of their shaft when
        points move.

        With ``angle_of="driven"`` the angle of the last shaft is held, and the drive angle follows.
        A reduced output has the derivatives of the sample where it is least or largest, of the
        first if there are several, and otherwise those of its formula. They are found from those
        of every sample, and take as much memory.

        Args:
            angle: drive angles in rad, any shape, or a ``Sweep``, as for a call.
            by: names among ``"bends"``, ``"twists"``, ``"phases"``, ``"points"``, ``"angle"`` (the
                angle of the call), ``"drive_torque"`` or ``"output_torque"`` (that of the load),
                ``"inertias"``, ``"lengths"`` (of the shafts, directions held), ``"positions"`` (of
                the bearings) and ``"deviations"`` (of the joints, ideal ones as well).

        Returns:
            arrays by output and variable: the output's shape, then that of the variable, such as
            ``(n,)`` for bends, as ``Gradient`` lists them.

        Raises:
            TypeError: angles that are not real numbers, variables that are not names.
            ValueError: an unknown variable, points of a driveline that was not made from points
                or has deviations, a torque, lengths or positions that there are not, the angle of
                reduced outputs, components of forces with ``axes="shaft"``; for deviations,
                ``axes="shaft"`` and ``angle_of="driven"``.

        >>> import cardan
        >>> plan = cardan.Driveline.from_bends([0.5]).plan("speed_ratio")
        >>> plan.derivatives(0.0, by="bends")["speed_ratio"]["bends"].round(6)
        array([0.622508])
        """
        if self._reduce:
            return reduced_derivatives(self._of_samples(), self._reduce, angle, by)
        return derivatives(self, self._drive_angles(angle), by)

    def gradient(self, angle: ArrayLike | Sweep, weights: Mapping[str, ArrayLike]) -> Gradient:
        """Return ``sum(weights * outputs)`` and its gradient with respect to all parameters.

        Optimisers need this sum (reverse mode): one pass gives the derivatives with respect to all
        parameters, whatever their number, and stores nothing per sample. The results do not depend
        on the number of threads.

        Args:
            angle: drive angles in rad, any shape, or a ``Sweep``, as for a call.
            weights: arrays by output, each of the output's shape or one that broadcasts to it;
                outputs without weights count with 0. For a mean square these are ``2 * output /
                samples``. Reduced outputs have weights of their reduced shape.

        Raises:
            TypeError: angles or weights that are not real numbers, weights that are no mapping.
            ValueError: weights of something that is not an output of the plan or of a wrong shape,
                components of forces with ``axes="shaft"``.

        >>> import cardan
        >>> line = cardan.Driveline.from_bends([0.3, 0.2], phases=0.1)
        >>> plan = line.plan("acceleration_ratio")
        >>> turn = cardan.Sweep.revolutions(1, 360)
        >>> acceleration = plan(turn)["acceleration_ratio"]
        >>> plan.gradient(turn, {"acceleration_ratio": 2 * acceleration / 360}).bends.round(4)
        array([ 0.0322, -0.02  ])
        """
        if self._reduce:
            whole = self._of_samples()
            return reduced_gradient(whole, self._reduce, self.places, angle, weights)
        return gradient(self, self._drive_angles(angle), weights)

    def _drive_angles(self, angle: ArrayLike | Sweep) -> ArrayLike | Sweep:
        return angle

    def _again(self, line: Driveline, request: Request) -> Plan:
        """Return a plan of the same kind for another request."""
        return Plan(line, request)

    def _of_samples(self) -> Plan:
        """Return the plan that reduces nothing."""
        return self._again(self.line, self.request._replace(reduce=None, dtype=None))

    def explain(self, angle: ArrayLike | Sweep | None = None) -> str:
        """Return the steps, the steps skipped and why, and the bytes per sample.

        The steps depend on the argument of the call: a sweep has different steps, and so has a
        batch along the axis of the angles. For a batch the steps are those of its first driveline.

        Args:
            angle: the drive angles or the ``Sweep`` of the call, of which only shape and kind
                matter; it broadcasts against the batch. By default an array of angles along the
                last axis.
        """
        line, load = self.line, self.request.load
        batch = f" of {math.prod(line.shape)} drivelines" if line.shape else ""
        joints = f"{line.n_joints} joint{'s' if line.n_joints > 1 else ''}"
        if angle is None:
            of_load = () if load is None else load.shapes().values()
            fixed = _broadcast(line.shape, *of_load) or line.shape
            shape = _broadcast(fixed, (2,)) or fixed
        else:
            own = angle.shape if isinstance(angle, Sweep) else np.shape(angle)
            shape = self._sample_shape(own) or (1,)
        sweep = angle._core if isinstance(angle, Sweep) else None
        text = self._core.explain(shape, sweep)
        return f"plan for {', '.join(self.places)}; {joints}{batch}\n{text}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what it was made from."""
        return (Plan, (self.line, self.request))

    def __repr__(self) -> str:
        """Show the driveline and the outputs."""
        return f"<Plan of {', '.join(self.places)} for {self.line!r}>"

    def _sample_shape(self, own: tuple[int, ...]) -> tuple[int, ...]:
        shape = _broadcast(self.line.shape, own)
        if shape is None:
            against = f"the driveline's batch shape {self.line.shape}"
            problem = f"has shape {own}, which does not broadcast against {against}"
            raise ArgumentValueError("angle", problem)
        return shape

    def _rows(self, shape: tuple[int, ...]) -> tuple[int, ...]:
        """Return the samples' shape without the reduced last axis."""
        if not shape:
            problem = "works over the last axis of the samples; one angle has none"
            raise ArgumentValueError("reduce", problem)
        if shape[-1] == 0:
            raise ArgumentValueError("reduce", f"finds no samples in the last axis of {shape}")
        return shape[:-1]

    def _checked_out(
        self, out: Mapping[str, NDArray[Any]], rows: tuple[int, ...]
    ) -> dict[str, NDArray[Any]]:
        checked: dict[str, NDArray[Any]] = {}
        if not isinstance(out, Mapping):
            problem = f"is {type(out).__name__}; it must map names of outputs to arrays"
            raise ArgumentTypeError("out", problem)
        for name, array in out.items():
            if name not in self.places:
                raise ArgumentValueError("out", "is not one of the requested outputs", (name,))
            if not isinstance(array, np.ndarray) or isinstance(array, np.ma.MaskedArray):
                problem = f"is {type(array).__name__}; it must be an array"
                raise ArgumentTypeError("out", problem, (name,))
            if array.dtype != self.dtype:
                problem = f"has dtype {array.dtype}; it must be {self.dtype.name}"
                raise ArgumentValueError("out", problem, (name,))
            wanted = self.places[name].shape(rows)
            check_shape("out", array, array.shape == wanted, f"it must be {wanted}", (name,))
            if not array.flags.writeable:
                raise ArgumentValueError("out", "is read-only; it must be writeable", (name,))
            for other, earlier in checked.items():
                if np.may_share_memory(array, earlier):
                    raise ArgumentValueError("out", f"and out[{other!r}] share memory", (name,))
            checked[name] = array
        return checked

    def _planes_of(
        self, given: Mapping[str, NDArray[Any]], rows: tuple[int, ...]
    ) -> list[NDArray[Any]]:
        """Planes to fill: of the arrays given where they lie plane by plane, else new ones."""
        planes = []
        for name, place in self.places.items():
            # A subclass may have other rules of shapes.
            target = components_first(np.asarray(given[name]), place) if name in given else None
            if (
                target is None
                or target.dtype != self._word
                or not target.flags.carray
                or any(np.may_share_memory(target, array) for array in self._load)
            ):
                target = np.empty((place.planes, *rows), self._word)
            planes.append(target)
        return planes

    def _filled(
        self,
        given: Mapping[str, NDArray[Any]],
        planes: Sequence[NDArray[Any]],
        rows: tuple[int, ...],
    ) -> dict[str, NDArray[Any]]:
        arrays = {}
        for (name, place), own in zip(self.places.items(), planes, strict=True):
            target = given.get(name)
            if target is None or not np.may_share_memory(target, own):
                own = own.astype(self.dtype, copy=False)
                array = view(planes_of(own, len(rows)), place._replace(first=0))
                if target is not None:
                    target[...] = array
            arrays[name] = array if target is None else target
        return arrays


def _broadcast(*shapes: tuple[int, ...]) -> tuple[int, ...] | None:
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        return None
