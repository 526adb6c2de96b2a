"""Plans: what to evaluate of a driveline, prepared once for any number of calls."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan import _core, outputs, threads
from cardan._core import Sweep as NativeSweep
from cardan.arrays import FloatArray, library, real
from cardan.load import Load
from cardan.result import Result
from cardan.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Items: TypeAlias = int | slice | Sequence[int] | None
Reduction: TypeAlias = Literal["min", "max", "mean", "rms", "peak"]

REDUCTIONS: tuple[Reduction, ...] = ("min", "max", "mean", "rms", "peak")
"""What rows of samples can be reduced to."""


_Place: TypeAlias = tuple[int, int | None, bool]
"""Where an output lies in the planes of a result: the first plane, how many items (``None``: one
without an axis of its own), whether it is a vector."""


class Plan:
    """The steps that evaluate some outputs of a driveline; made by ``Driveline.plan``.

    Calling it evaluates, as ``Driveline.evaluate`` does; ``explain`` says what is done and what is
    skipped. A plan never changes and may be shared among threads.
    """

    __slots__ = (
        "_alone",
        "_arguments",
        "_core",
        "_dtype",
        "_even",
        "_labels",
        "_level",
        "_line_shape",
        "_load",
        "_places",
        "_plain",
        "_planes",
        "_reduce",
        "_steady",
        "_word",
        "_workers",
    )

    def __init__(
        self,
        line: Driveline,
        names: str | Iterable[str],
        shafts: Items = None,
        joints: Items = None,
        load: Load | None = None,
        reduce: Reduction | None = None,
        dtype: DTypeLike | None = None,
        tolerance: float | None = None,
        workers: int | None = None,
        level: str | None = None,
    ) -> None:
        """Prepare as ``Driveline.plan`` does; ``level`` forces an instruction set."""
        names = outputs.checked(names)
        n = line.n_joints
        shaft_items = [n] if shafts is None else _items("shafts", shafts, n + 1)
        joint_items = [*range(n)] if joints is None else _items("joints", joints, n)
        # In the order of this method, for pickling.
        arguments = (line, names, shafts, joints, load, reduce, dtype, tolerance, workers)
        self._arguments: tuple[Any, ...] = arguments
        self._dtype = _word(dtype)
        self._reduce = _reduction(reduce)
        # What rows are reduced to is found in double.
        self._word = _DOUBLE if reduce else self._dtype
        inertias = _inertias(n, load)
        # Read at every call.
        self._load = () if load is None else (load.torque, load.speed, load.acceleration)
        # Nothing but the angles changes from sample to sample.
        shape = line.shape
        self._steady = not shape and not (load and _changes(*self._load, *inertias.values()))
        self._even = self._steady and not reduce
        self._line_shape = shape
        self._workers = workers
        self._level = level
        self._core = _core.Plan(
            line._lines,
            names,
            shaft_items,
            joint_items,
            None if load is None else (load.end, *self._load, [*inertias.items()]),
            _permitted(tolerance),
            self._dtype is _SINGLE,
            reduce,
        )
        # The last shaft is asked for, not a list of one.
        one_shaft = shafts is None or _is_index(shafts)
        one_joint = joints is not None and _is_index(joints)
        shafts_shown = shaft_items[0] if one_shaft else shaft_items
        joints_shown = joint_items[0] if one_joint else joint_items
        self._labels = (shafts_shown, joints_shown, shape, reduce)
        self._places: dict[str, _Place] = {}
        first, alone = 0, True
        for name in names:
            output = outputs.OUTPUTS[name]
            per_shaft = output.per == "shaft"
            vector = output.vector and reduce != "peak"
            count = len(shaft_items if per_shaft else joint_items)
            items = None if (one_shaft if per_shaft else one_joint) else count
            self._places[name] = (first, items, vector)
            first += 3 * count if vector else count
            alone = alone and items is None and not vector
        self._planes = first
        self._alone = alone
        self._plain = alone and self._even and self._word is self._dtype
        threads.at_most(workers)

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate at drive angles.

        Args:
            angle: drive angles in rad, any shape, or a ``Sweep``; broadcasts against the batch.
            out: arrays to fill, by output name, of the right shape and dtype. One may be the array
                of angles itself.

        Raises:
            TypeError: angles that are not real numbers.
            ValueError: shapes that do not broadcast, an ``out`` of the wrong shape or type.
            MemoryError: results that do not fit in memory.
            RuntimeError: ``out`` is in use by another call.
        """
        if self._plain and out is None and type(angle) is np.ndarray and angle.dtype is _DOUBLE:
            # The usual call: on a few angles every question shows, that for equal lengths too.
            block = self._core.run(None, angle, None, threads.at_most(self._workers), self._level)
            if block is not None:
                return Result(dict(zip(self._places, block)), self._labels, angle)  # noqa: B905
        angles: FloatArray | NativeSweep
        if type(angle) is np.ndarray and angle.dtype == _DOUBLE:
            angles = angle
        elif isinstance(angle, Sweep):
            angles = angle._core
        elif type(angle) is not np.ndarray and (whose := library(angle)):
            there: Result = _elsewhere(whose, self, angle, out)
            return there
        else:
            angles = angle = real("angle", angle)
        shape = angle.shape if self._steady else self._sample_shape(angle.shape)
        rows = self._rows(shape) if self._reduce else shape
        samples = None if self._even else shape
        workers = threads.at_most(self._workers)
        if out is not None:
            return self._into(out, angle, angles, samples, rows, workers)
        block = self._core.run(samples, angles, None, workers, self._level)
        if block is None:
            # The angles do not lie one after another.
            return self(real("angle", angle))
        if self._word is not self._dtype:
            block = block.astype(self._dtype)
        arrays = {name: _view(block, place) for name, place in self._places.items()}
        return Result(arrays, self._labels, angle)

    def _into(
        self,
        out: Mapping[str, NDArray[Any]],
        angle: FloatArray | Sweep,
        angles: FloatArray | NativeSweep,
        samples: tuple[int, ...] | None,
        rows: tuple[int, ...],
        workers: int | None,
    ) -> Result:
        """Evaluate into arrays that are there: as they are, if all are plain ones."""
        # What is a dictionary is known at once, other mappings are looked up.
        if isinstance(out, (dict, Mapping)) and out.keys() == self._places.keys():
            alone, dtype, wanted = self._alone, self._dtype, rows
            arrays, planes = {}, []
            for name in self._places:
                array = arrays[name] = out[name]
                if not alone:
                    wanted = self._shape(self._places[name], rows)
                if type(array) is not np.ndarray or array.dtype != dtype or array.shape != wanted:
                    break
                planes.append(array if alone else _components_first(array, self._places[name]))
            else:
                run, level = self._core.run, self._level
                if dtype is self._word and run(samples, angles, planes, workers, level) is not None:
                    return Result(arrays, self._labels, angle)
        return self._with_care(out, angle, angles, samples, rows, workers)

    def _with_care(
        self,
        out: Mapping[str, NDArray[Any]],
        angle: FloatArray | Sweep,
        angles: FloatArray | NativeSweep,
        samples: tuple[int, ...] | None,
        rows: tuple[int, ...],
        workers: int | None,
    ) -> Result:
        """Evaluate into arrays of any layout, or say what is wrong with them."""
        given = self._checked_out(out, rows)
        if angles is angle:
            angles = angle = real("angle", angle)
            if any(np.may_share_memory(angle, array) for array in given.values()):
                angles = angle = angle.copy()
        planes = self._planes_of(given, rows)
        if self._core.run(samples, angles, planes, workers, self._level) is None:
            raise RuntimeError("out is in use by another call")
        return Result(self._filled(given, planes, rows), self._labels, angle)

    def explain(self) -> str:
        """Return the steps taken, the steps skipped and why, and bytes per sample.

        For a batch the steps are those of its first driveline.
        """
        line, names, *_ = self._arguments
        batch = f" of {math.prod(line.shape)} drivelines" if line.shape else ""
        joints = f"{line.n_joints} joint{'s' if line.n_joints > 1 else ''}"
        text = self._core.explain(False, self._dtype == np.float32)
        return f"plan for {', '.join(names)}; {joints}{batch}\n{text}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what it was made from."""
        return (Plan, self._arguments)

    def __repr__(self) -> str:
        """Show the driveline and the outputs."""
        line, names, *_ = self._arguments
        return f"<Plan of {', '.join(names)} for {line!r}>"

    def _sample_shape(self, own: tuple[int, ...]) -> tuple[int, ...]:
        shape = _broadcast(self._line_shape, own)
        if shape is None:
            raise ValueError(
                f"angle has shape {own}, which does not broadcast against the driveline's batch "
                f"shape {self._line_shape}"
            )
        return shape

    def _rows(self, shape: tuple[int, ...]) -> tuple[int, ...]:
        """What is left of the samples' shape when the last axis is reduced."""
        if not shape:
            raise ValueError("reduce works over the last axis of the samples; one angle has none")
        if shape[-1] == 0:
            raise ValueError(f"reduce finds no samples in the last axis of {shape}")
        return shape[:-1]

    def _shape(self, place: _Place, rows: tuple[int, ...]) -> tuple[int, ...]:
        _, items, vector = place
        lead = () if items is None else (items,)
        return lead + rows + ((3,) if vector else ())

    def _checked_out(
        self, out: Mapping[str, NDArray[Any]], rows: tuple[int, ...]
    ) -> dict[str, NDArray[Any]]:
        checked: dict[str, NDArray[Any]] = {}
        if not isinstance(out, Mapping):
            raise TypeError(f"out is {type(out).__name__}; it must map names of outputs to arrays")
        for name, array in out.items():
            if name not in self._places:
                raise ValueError(f"out[{name!r}] is not among the outputs asked for")
            if not isinstance(array, np.ndarray) or isinstance(array, np.ma.MaskedArray):
                raise TypeError(f"out[{name!r}] is {type(array).__name__}; it must be an array")
            if array.dtype != self._dtype:
                raise ValueError(
                    f"out[{name!r}] has dtype {array.dtype}; it must be {self._dtype.name}"
                )
            wanted = self._shape(self._places[name], rows)
            if array.shape != wanted:
                raise ValueError(f"out[{name!r}] has shape {array.shape}; it must be {wanted}")
            if not array.flags.writeable:
                raise ValueError(f"out[{name!r}] is read-only; it must be writeable")
            for other, earlier in checked.items():
                if np.may_share_memory(array, earlier):
                    raise ValueError(f"out[{name!r}] and out[{other!r}] share memory")
            checked[name] = array
        return checked

    def _planes_of(
        self, given: Mapping[str, NDArray[Any]], rows: tuple[int, ...]
    ) -> list[NDArray[Any]]:
        """Planes to fill: of the arrays given where they lie plane by plane, else new ones."""
        planes = []
        for name, place in self._places.items():
            _, items, vector = place
            # Subclasses may have ideas of their own about shapes.
            target = _components_first(np.asarray(given[name]), place) if name in given else None
            if (
                target is None
                or target.dtype != self._word
                or not target.flags.carray
                or any(np.may_share_memory(target, array) for array in self._load)
            ):
                count = (1 if items is None else items) * (3 if vector else 1)
                target = np.empty((count, *rows), self._word)
            planes.append(target)
        return planes

    def _filled(
        self,
        given: Mapping[str, NDArray[Any]],
        planes: Sequence[NDArray[Any]],
        rows: tuple[int, ...],
    ) -> dict[str, NDArray[Any]]:
        arrays = {}
        for (name, (_, items, vector)), own in zip(self._places.items(), planes, strict=True):
            target = given.get(name)
            if target is None or not np.may_share_memory(target, own):
                own = own.astype(self._dtype, copy=False)
                array = _view(own.reshape(-1, *rows), (0, items, vector))
                if target is not None:
                    target[...] = array
            arrays[name] = array if target is None else target
        return arrays


def _elsewhere(
    whose: str,
    plan: Plan,
    angle: Any,  # noqa: ANN401 - an array of that library
    out: Mapping[str, NDArray[Any]] | None,
) -> Any:  # noqa: ANN401 - a result or a Dataset
    """Evaluate at the angles of another library's array."""
    # Here, because these two are built upon plans.
    from cardan import labelled, lazy

    return (labelled if whose == "xarray" else lazy).evaluate(plan, angle, out)


def _view(planes: NDArray[Any], place: _Place) -> Any:  # noqa: ANN401 - an array or a scalar
    first, items, vector = place
    if items is None and not vector:
        return planes[first]
    if items is None:
        return _moved(planes[first : first + 3], 0, -1)
    if not vector:
        return planes[first : first + items]
    part = planes[first : first + 3 * items]
    return _moved(part.reshape(items, 3, *planes.shape[1:]), 1, -1)


def _components_first(array: NDArray[Any], place: _Place) -> NDArray[Any]:
    """An output plane by plane: a vector's components before the samples."""
    return _moved(array, -1, 0 if place[1] is None else 1) if place[2] else array


def _moved(array: NDArray[Any], source: int, to: int) -> NDArray[Any]:
    """As ``numpy.moveaxis``, which takes ten times as long."""
    axes = [*range(array.ndim)]
    axis = axes.pop(source)
    axes.insert(to % array.ndim, axis)
    return array.transpose(axes)


def item_index(argument: str, value: SupportsIndex, count: int) -> int:
    """Return the index of a shaft or joint counted from 0; negative ones count from the end."""
    try:
        index = operator.index(value)
    except TypeError:
        raise TypeError(f"{argument} is {value!r}; it must be an integer") from None
    if not -count <= index < count:
        raise IndexError(f"{argument} is {index}; there are {count}, counted from 0")
    return index % count


def _is_index(value: Items) -> bool:
    # NumPy's arrays have it as well, whatever their shape.
    return isinstance(value, int) or (hasattr(value, "__index__") and np.ndim(value) == 0)  # type: ignore[arg-type]


def _items(argument: str, value: int | slice | Sequence[int], count: int) -> list[int]:
    if isinstance(value, slice):
        return list(range(count))[value]
    if _is_index(value):
        return [item_index(argument, value, count)]  # type: ignore[arg-type]
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise TypeError(f"{argument} is {value!r}; it must be an index, a slice or a list")
    return [item_index(f"{argument}[{i}]", item, count) for i, item in enumerate(value)]


_DOUBLE, _SINGLE = np.dtype(np.float64), np.dtype(np.float32)


def _word(dtype: DTypeLike | None) -> np.dtype[Any]:
    if dtype is None:
        return _DOUBLE
    try:
        word = np.dtype(dtype)
    except TypeError:
        word = np.dtype(object)
    for known in (_DOUBLE, _SINGLE):
        if word == known:
            return known
    raise ValueError(f"dtype is {dtype!r}; it must be float64 or float32")


def _reduction(reduce: str | None) -> str | None:
    if reduce is not None and reduce not in REDUCTIONS:
        raise ValueError(f"reduce is {reduce!r}; {outputs.nearest(str(reduce), REDUCTIONS)}")
    return reduce


def _permitted(tolerance: float | None) -> float | None:
    if tolerance is None:
        return None
    try:
        permitted = float(tolerance)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"tolerance is {tolerance!r}; it must be a number") from None
    if not permitted >= 0.0:
        raise ValueError(f"tolerance is {permitted}; it must not be negative")
    return permitted


def _changes(*arrays: FloatArray) -> bool:
    return any(array.ndim for array in arrays)


def _inertias(n: int, load: Load | None) -> dict[int, FloatArray]:
    """The inertia of each shaft that has one, as a contiguous array."""
    if load is None or load.inertias is None:
        return {}
    if load.inertias.shape[-1] != n + 1:
        shape = load.inertias.shape
        raise ValueError(f"inertias has shape {shape}; {n + 1} shafts need (..., {n + 1})")
    columns = (np.array(load.inertias[..., shaft], order="C") for shaft in range(n + 1))
    return {shaft: column for shaft, column in enumerate(columns) if np.any(column != 0.0)}


def _broadcast(*shapes: tuple[int, ...]) -> tuple[int, ...] | None:
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        return None
