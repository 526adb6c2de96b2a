"""Plans: what to evaluate of a driveline, prepared once for any number of calls."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan import _core, outputs, threads
from cardan.arrays import FloatArray, library, real
from cardan.load import Load
from cardan.result import Result
from cardan.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Items: TypeAlias = int | slice | Sequence[int] | None
Reduction: TypeAlias = Literal["min", "max", "mean", "rms", "peak"]

# A flat array and its strides, in elements, over the samples.
_Broadcast: TypeAlias = tuple[FloatArray, list[int]]

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
        "_arguments",
        "_core",
        "_dtype",
        "_inertias",
        "_labels",
        "_level",
        "_line_shape",
        "_load",
        "_places",
        "_plain",
        "_planes",
        "_reduce",
        "_steady",
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
        self._load = load
        self._inertias = _inertias(n, load)
        # Nothing but the angles changes from sample to sample.
        shape = line.shape
        self._steady = not shape and (load is None or _is_steady(load))
        self._line_shape = shape
        self._workers = workers
        self._level = level
        self._core = _core.Plan(
            line._lines,
            names,
            shaft_items,
            joint_items,
            load.end if load else None,
            [*self._inertias],
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
        plain = self._dtype is _DOUBLE and level is None and load is None and reduce is None
        self._plain = plain and alone and self._steady
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
        """
        if self._plain and type(angle) is np.ndarray and angle.dtype == _DOUBLE:
            result = self._at_once(angle, out)
            if result is not None:
                return result
        if isinstance(angle, Sweep):
            angles, own = None, angle.shape
        else:
            if type(angle) is not np.ndarray and (whose := library(angle)):
                there: Result = _elsewhere(whose, self, angle, out)
                return there
            angles = real("angle", angle)
            own = angles.shape
        shape = own if self._steady else self._sample_shape(own)
        rows = shape
        if self._reduce:
            rows = self._rows(shape)
        given = {} if out is None else self._checked_out(out, rows)
        if angles is not None and any(np.may_share_memory(angles, a) for a in given.values()):
            angles = angles.copy()
        shown = angle if angles is None else angles
        block: NDArray[Any] | None = None
        if self._reduce:
            block = np.empty((self._planes, *rows))
            flats: list[NDArray[Any]] = [block.reshape(-1)]
        elif not given:
            block = np.empty((self._planes, *rows), self._dtype)
            flats = [block.reshape(-1)]
        else:
            flats = self._planes_of(given, rows)

        def apart(array: FloatArray) -> FloatArray:
            """What is read must not change while the results are written."""
            shared = any(np.may_share_memory(array, flat) for flat in flats)
            return array.copy() if given and shared else array

        if self._steady and not self._reduce:
            samples, line = [math.prod(shape)], [0]
            steps = [1]
        else:
            samples, line = list(shape), _strides(self._line_shape, shape)
            steps = _strides(own, shape)
        self._core.run(
            samples,
            line,
            angle._core if isinstance(angle, Sweep) else None,
            None if angles is None else (apart(angles.reshape(-1)), steps),
            self._spread_load(samples, apart),
            flats,
            threads.at_most(self._workers),
            self._level,
        )
        if block is None:
            return Result(self._filled(given, flats, rows), self._labels, shown)
        if block.dtype != self._dtype:
            block = block.astype(self._dtype)
        arrays = {name: _view(block, place) for name, place in self._places.items()}
        for name, target in given.items():
            target[...] = arrays[name]
            arrays[name] = target
        return Result(arrays, self._labels, shown)

    def _at_once(self, angle: FloatArray, out: Mapping[str, NDArray[Any]] | None) -> Result | None:
        """Evaluate the short way of small calls, if the arrays are plain ones."""
        workers = threads.at_most(self._workers)
        if out is None:
            planes = np.empty((self._planes, *angle.shape))
            if not self._core.fill(angle, [planes], workers):
                return None
            # As many as there are places; to ask for that check would cost a tenth of the call.
            arrays = dict(zip(self._places, planes))  # noqa: B905
            return Result(arrays, self._labels, angle)
        # What is a dictionary is known at once, other mappings are looked up.
        if not isinstance(out, (dict, Mapping)) or out.keys() != self._places.keys():
            return None
        shape, arrays = angle.shape, {}
        for name in self._places:
            array = arrays[name] = out[name]
            if not (type(array) is np.ndarray and array.dtype == _DOUBLE and array.shape == shape):
                return None
        if not self._core.fill(angle, list(arrays.values()), workers):
            return None
        return Result(arrays, self._labels, angle)

    def explain(self) -> str:
        """Return the steps taken, the steps skipped and why, operations and bytes per sample.

        Operations are additions, multiplications (a multiplication and addition together is one),
        divisions and roots; for a batch they are counted on its first driveline.
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
        """Flat arrays to fill: those given where they lie plane by plane, else new ones."""
        flats = []
        for name, (_, items, vector) in self._places.items():
            target = given.get(name)
            if target is not None and vector:
                target = np.moveaxis(target, -1, 0 if items is None else 1)
            if target is None or not target.flags.carray:
                planes = (items or 1) * (3 if vector else 1)
                target = np.empty((planes, *rows), self._dtype)
            # Subclasses may have ideas of their own about shapes.
            flats.append(np.asarray(target).reshape(-1))
        return flats

    def _filled(
        self,
        given: Mapping[str, NDArray[Any]],
        flats: Sequence[NDArray[Any]],
        rows: tuple[int, ...],
    ) -> dict[str, NDArray[Any]]:
        arrays = {}
        for (name, (_, items, vector)), flat in zip(self._places.items(), flats, strict=True):
            target = given.get(name)
            if target is None or not np.may_share_memory(target, flat):
                array = _view(flat.reshape(-1, *rows), (0, items, vector))
                if target is not None:
                    target[...] = array
            arrays[name] = array if target is None else target
        return arrays

    def _spread_load(
        self,
        shape: list[int],
        apart: Any,  # noqa: ANN401 - the caller's function
    ) -> tuple[_Broadcast, _Broadcast, _Broadcast, list[tuple[int, FloatArray, list[int]]]] | None:
        load = self._load
        if load is None:
            return None

        def spread(name: str, array: FloatArray) -> _Broadcast:
            if array.ndim and _broadcast(array.shape, tuple(shape)) != tuple(shape):
                raise ValueError(
                    f"{name} has shape {array.shape}, which does not broadcast to the samples' "
                    f"{tuple(shape)}"
                )
            return apart(array.reshape(-1)), _strides(array.shape, shape)

        return (
            spread(f"{load.end}_torque", load.torque),
            spread("speed", load.speed),
            spread("acceleration", load.acceleration),
            [(shaft, *spread("inertias", column)) for shaft, column in self._inertias.items()],
        )


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
    if items is None:
        if not vector:
            return planes[first]
        return np.moveaxis(planes[first : first + 3], 0, -1)
    if not vector:
        return planes[first : first + items]
    part = planes[first : first + 3 * items]
    return np.moveaxis(part.reshape(items, 3, *planes.shape[1:]), 1, -1)


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


def _is_steady(load: Load) -> bool:
    arrays = (load.torque, load.speed, load.acceleration)
    if any(array.ndim for array in arrays):
        return False
    return load.inertias is None or load.inertias.ndim < 2


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


def _strides(own: tuple[int, ...], shape: Sequence[int]) -> list[int]:
    """Strides, in elements, of a contiguous array over the samples it is broadcast to."""
    strides = [0] * len(shape)
    step = 1
    for axis in range(-1, -len(own) - 1, -1):
        if own[axis] != 1:
            strides[axis] = step
        step *= own[axis]
    return strides
