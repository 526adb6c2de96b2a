"""Evaluations over dask arrays: the same results, computed later, in pieces and on any machine.

Each piece of a result is one task, and each task uses one thread: the parallelism is dask's.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import array_namespace_of, as_float64, common_shape, import_optional
from cardan.arrays.errors import ArgumentTypeError, check_shape, require
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.evaluate import PlanInDegrees, planned
from cardan.evaluation.load import Load
from cardan.evaluation.plan import Plan
from cardan.evaluation.reductions import REDUCTIONS
from cardan.evaluation.request import components_first, view
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep
from cardan.geometry.geometry import Bearings, Geometry
from cardan.motion.equivalent import EquivalentJoint


class _Part(NamedTuple):
    """An array to cut into pieces, but not along its last axes."""

    array: Any
    whole: int

    @property
    def batch(self) -> tuple[int, ...]:
        return tuple(self.array.shape[: self.array.ndim - self.whole])


class LazyDriveline:
    """Drivelines whose geometry is in dask arrays; made by the constructors of ``Driveline``.

    Values are checked when they are computed, so a bend out of range is an error of its task. These
    drivelines are evaluated, mounted in bearings and reduced to equivalent joints. For everything
    else that a ``Driveline`` does, ``compute()`` makes the drivelines themselves.

    Attributes:
        n_joints: number of joints of each driveline.
        shape: shape of the batch.
    """

    __slots__ = ("_make", "_parts", "_stand_in", "n_joints", "shape")

    def __init__(
        self, make: Callable[..., Driveline], parts: Sequence[_Part], stand_in: Driveline
    ) -> None:
        """Keep the constructor, its arrays and a driveline of as many joints."""
        self._make = make
        self._parts = tuple(parts)
        self._stand_in = stand_in
        self.n_joints = stand_in.n_joints
        self.shape = np.broadcast_shapes(*(part.batch for part in parts))

    def __repr__(self) -> str:
        """Show the shape of the batch and the number of joints."""
        joints = f"{self.n_joints} joint{'s' if self.n_joints > 1 else ''}"
        return f"<LazyDriveline batch {self.shape} of {joints}>"

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - nothing is returned
        """Say where what only computed drivelines have is to be had."""
        known = not name.startswith("_") and hasattr(Driveline, name)
        hint = f"; compute() makes drivelines, which have {name!r}" if known else ""
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{hint}")

    def evaluate(
        self,
        angle: Any,  # noqa: ANN401 - an array of NumPy or dask, or a sweep
        outputs: str | Iterable[str] = ("angle", "speed_ratio"),
        *,
        out: Mapping[str, NDArray[Any]] | None = None,
        degrees: bool = False,
        **options: Any,  # noqa: ANN401 - as Driveline.evaluate has them
    ) -> Result:
        """Evaluate as ``Driveline.evaluate`` does; the arrays of the result are dask's.

        Errors are as there, for what is known before computing.
        """
        plan = self._stand_in.plan(outputs, **options)
        problem = "is 'driven'; drivelines of dask arrays take the drive angle"
        require("angle_of", plan.request.angle_of != "driven", problem)
        evaluated = functools.partial(_evaluated, plan, self._make, self._parts, self.shape)
        if not degrees:
            return evaluated(angle, out)
        bare = angle.data if array_namespace_of(angle) == "xarray" else angle
        return PlanInDegrees(evaluated)(bare, out)

    def with_bearings(self, bearings: Bearings, lengths: ArrayLike | None = None) -> LazyDriveline:
        """Return the drivelines with bearings, as ``Driveline.with_bearings`` does.

        Args:
            bearings: pairs of a shaft and one position for all drivelines.
            lengths: length of each shaft, ``(n + 1,)``, the same for all drivelines.
        """
        pairs = list(bearings)
        # Lengths that are computed later are checked then.
        known = np.full(self.n_joints + 1, np.finfo(float).max) if lengths is None else lengths
        stand_in = self._stand_in.with_bearings(pairs, known)
        require("bearings", not stand_in.shape, "must have the same places on all drivelines")
        make = functools.partial(_with_bearings, self._make, pairs, lengths)
        return LazyDriveline(make, self._parts, stand_in)

    def equivalent(self, shaft: int = -1) -> EquivalentJoint:
        """Return the equivalent joints as ``Driveline.equivalent`` does, as dask arrays."""
        index = item_index("shaft", shaft, self.n_joints + 1)
        names = [field.name for field in fields(EquivalentJoint)]
        task = functools.partial(_equivalent, make=self._make, shaft=index, names=names)
        planes, _ = _planes(task, self._parts, self.shape, len(names), np.dtype(np.float64))
        return EquivalentJoint(*(planes[i] for i in range(len(names))))

    def compute(self, **options: Any) -> Driveline:  # noqa: ANN401 - those of dask
        """Return the drivelines themselves.

        Args:
            options: further arguments of ``dask.compute``.

        Raises:
            ValueError: a value out of range, as of the constructor.
        """
        arrays = import_optional("dask", "dask").compute(
            *(part.array for part in self._parts), **options
        )
        return self._make(*arrays)


def construct(
    cls: type[Driveline],
    constructor: str,
    ends: int,
    whole: Mapping[str, int],
    given: dict[str, Any],
) -> LazyDriveline:
    """Make drivelines of dask arrays by the name of a constructor of ``Driveline``.

    ``ends`` and ``whole`` are those of ``cardan.arrays.deferring``.
    """
    parts = {
        name: _part(name, given.pop(name), axes)
        for name, axes in whole.items()
        if name in given and np.ndim(given[name])
    }
    first = next(iter(parts.values()))
    stand_in = cls.from_bends(np.zeros(first.array.shape[-first.whole] - ends))
    make = functools.partial(_made, cls, constructor, tuple(parts), given)
    return LazyDriveline(make, list(parts.values()), stand_in)


def evaluate(
    plan: Plan,
    angle: Any,  # noqa: ANN401 - a dask array
    out: Mapping[str, NDArray[Any]] | None,
) -> Result:
    """Evaluate a plan at the angles of a dask array; the arrays of the result are dask's."""
    line = plan.line
    if not line.shape:
        return _evaluated(plan, None, (), (), angle, out)
    parts = [_Part(array, array.ndim - len(line.shape)) for array in line._geometry.arrays]
    make = functools.partial(_copied, type(line), line._geometry.bearings)
    return _evaluated(plan, make, parts, line.shape, angle, out)


def _evaluated(
    plan: Plan,
    make: Callable[..., Driveline] | None,
    lines: Sequence[_Part],
    line_shape: tuple[int, ...],
    angle: Any,  # noqa: ANN401 - an array of NumPy or dask, or a sweep
    out: Mapping[str, NDArray[Any]] | None,
) -> Result:
    if out is not None:
        raise ArgumentTypeError("out", "does not go with dask arrays; their results are new arrays")
    request = plan.request
    plan = planned(plan.line, request._replace(workers=request.workers or 1))
    load, reduce = request.load, request.reduce
    sweep = angle if isinstance(angle, Sweep) else None
    more = {} if sweep else {"angle": _part("angle", angle, 0)}
    if load is not None:
        more |= _load_parts(load)
    own = sweep.shape if sweep else more["angle"].array.shape
    shape = common_shape(driveline=line_shape, angle=own)
    every = [*lines, *more.values()]
    common_shape(samples=shape, **{name: part.batch for name, part in more.items()})
    if np.broadcast_shapes(shape, *(part.batch for part in every)) != shape:
        raise ValueError(f"the load has more samples than drivelines and angles, {shape}")
    task = functools.partial(_task, plan=plan, make=make, sweep=sweep, more=tuple(more))
    length = 1 if reduce else shape[-1] if sweep else None
    planes, lengths = _planes(task, every, shape, plan.planes, plan.dtype, length, bool(sweep))
    if reduce and len(lengths) == 1:
        planes = planes[..., 0]
    elif reduce:
        shares = np.array(lengths) / sum(lengths)
        planes = REDUCTIONS[reduce].of_pieces(planes, shares).astype(plan.dtype)
    arrays = {name: view(planes, place) for name, place in plan.places.items()}
    return Result(arrays, (*plan.labels[:2], line_shape, reduce, plan.labels[4]), angle)


def _planes(
    task: Callable[..., NDArray[Any]],
    parts: Sequence[_Part],
    shape: tuple[int, ...],
    count: int,
    dtype: np.dtype[Any],
    length: int | None = None,
    whole_rows: bool = False,
) -> tuple[Any, tuple[int, ...]]:
    """``count`` planes of samples, a task for each piece, and the lengths of the pieces of a row.

    A task makes the planes of a piece from the pieces of the arrays. Of each piece of a row it
    makes ``length`` samples, by default as many as there are.
    """
    dask_array = import_optional("dask.array", "dask")
    # Axes are told by their number from the last one on; those that stay whole by larger ones.
    pairs: list[Any] = []
    for number, (array, whole) in enumerate(parts):
        array = dask_array.asarray(array)
        before = array.ndim - whole
        stays = list(range(before, array.ndim))
        if whole_rows and before:
            stays.append(before - 1)
        ones = [1000 * (number + 1) + i for i in range(whole)]
        pairs += [array.rechunk(dict.fromkeys(stays, -1)), (*reversed(range(before)), *ones)]
    chunks, arrays = dask_array.core.unify_chunks(*pairs)
    pairs[::2] = arrays
    axes = range(len(shape))
    planes = dask_array.blockwise(
        task,
        (len(shape), *reversed(axes)),
        *pairs,
        dtype=dtype,
        meta=np.empty((0,) * (len(shape) + 1), dtype),
        new_axes={len(shape): count} | {axis: length for axis in axes if axis not in chunks},
        adjust_chunks=None if length is None or 0 not in chunks else {0: lambda _: length},
        concatenate=True,
    )
    return planes, chunks.get(0, (length,))


def _task(
    *pieces: NDArray[Any],
    plan: Plan,
    make: Callable[..., Driveline] | None,
    sweep: Sweep | None,
    more: Sequence[str],
) -> NDArray[Any]:
    """The planes of one piece of the samples."""
    named = dict(zip(more, pieces[len(pieces) - len(more) :], strict=True))
    angle = sweep or named.pop("angle")
    request = plan.request
    if make or named:
        line = make(*pieces[: len(pieces) - len(more)]) if make else plan.line
        request = request._replace(load=_loaded(request.load, named))
        plan = planned(line, request)
    result = plan(angle)
    rows = np.broadcast_shapes(plan.line.shape, angle.shape)
    rows = (*rows[:-1], 1) if request.reduce else rows
    planes = [
        np.reshape(components_first(np.asarray(result[name]), place), (-1, *rows))
        for name, place in plan.places.items()
    ]
    return np.concatenate(planes)


def _equivalent(
    *pieces: NDArray[Any], make: Callable[..., Driveline], shaft: int, names: Sequence[str]
) -> NDArray[Any]:
    joint = make(*pieces).equivalent(shaft)
    return np.stack([getattr(joint, name) for name in names])


def _made(
    cls: type[Driveline],
    constructor: str,
    names: Sequence[str],
    options: Mapping[str, Any],
    *arrays: NDArray[Any],
) -> Driveline:
    given = dict(zip(names, arrays, strict=True))
    line: Driveline = getattr(cls, constructor)(**given, **options)
    return line


def _with_bearings(
    make: Callable[..., Driveline],
    bearings: Bearings,
    lengths: ArrayLike | None,
    *arrays: NDArray[Any],
) -> Driveline:
    return make(*arrays).with_bearings(bearings, lengths)


def _copied(cls: type[Driveline], bearings: tuple[int, ...], *arrays: NDArray[Any]) -> Driveline:
    # A driveline makes its arrays read-only, and these may be dask's.
    return cls._of(Geometry._make((*map(np.array, arrays), bearings, False)))


def _load_parts(load: Load) -> dict[str, _Part]:
    """What of a load changes from sample to sample."""
    parts = {
        name: _Part(array, 0)
        for name in ("torque", "speed", "acceleration")
        if (array := getattr(load, name)).ndim
    }
    if load.inertias is not None and load.inertias.ndim > 1:
        parts["inertias"] = _Part(load.inertias, 1)
    return parts


def _loaded(load: Load | None, pieces: Mapping[str, NDArray[Any]]) -> Load | None:
    if load is None or not pieces:
        return load
    names = ("torque", "speed", "acceleration", "inertias")
    values = {name: pieces.get(name, getattr(load, name)) for name in names}
    return Load(**{f"{load.end}_torque": values.pop("torque")}, **values)


def _part(name: str, value: Any, whole: int) -> _Part:  # noqa: ANN401 - an array of any library
    array = value.data if array_namespace_of(value) == "xarray" else value
    if array_namespace_of(array) != "dask":
        return _Part(as_float64(name, array), whole)
    as_float64(name, np.empty(0, array.dtype))
    problem = "has chunks of unknown size; call its compute_chunk_sizes first"
    require(name, not any(math.isnan(size) for size in array.shape), problem)
    check_shape(name, array, array.ndim >= whole, f"it needs {whole} dimensions or more")
    return _Part(array, whole)
