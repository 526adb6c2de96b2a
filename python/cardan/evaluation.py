"""One evaluation: names, shapes and memory in; arrays out. The native module fills."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core, outputs, threads
from cardan.arrays import FloatArray, real, scalar_or_array
from cardan.load import Load
from cardan.result import Result

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Items: TypeAlias = int | slice | Sequence[int] | None

# A flat array and its strides, in elements, over the samples.
_Broadcast: TypeAlias = tuple[FloatArray, list[int]]


def evaluate(
    line: Driveline,
    angle: ArrayLike,
    names: str | Iterable[str],
    *,
    shafts: Items,
    joints: Items,
    load: Load | None,
    out: Mapping[str, FloatArray] | None,
    workers: int | None,
    level: str | None = None,
) -> Result:
    """Evaluate as ``Driveline.evaluate`` does; ``level`` forces an instruction set."""
    names = outputs.checked(names)
    items = {
        "shaft": _items("shafts", [-1] if shafts is None else shafts, line.n_joints + 1),
        "joint": _items("joints", slice(None) if joints is None else joints, line.n_joints),
    }
    # The last shaft is asked for, not a list of one.
    single = {"shaft": shafts is None or _is_index(shafts), "joint": _is_index(joints)}
    angles = real("angle", angle)
    shape = _sample_shape(line, angles)
    inertias = _inertias(line, load)
    plan = _core.Plan(
        line.n_joints,
        list(names),
        items["shaft"],
        items["joint"],
        load.end if load else None,
        list(inertias),
    )

    layout = {}
    for name in names:
        output = outputs.OUTPUTS[name]
        lead = () if single[output.per] else (len(items[output.per]),)
        layout[name] = (lead, (3,) if output.vector else ())
    given = _checked_out(out, {name: lead + shape + last for name, (lead, last) in layout.items()})

    arrays: dict[str, FloatArray] = {}
    flats: list[FloatArray] = []
    for name, (lead, last) in layout.items():
        target = given.get(name)
        # A plane per component is what the kernels fill; another layout is copied to.
        direct = target is not None and not last and target.flags.carray
        planes = target if target is not None and direct else np.empty(lead + last + shape)
        flats.append(planes.reshape(-1))
        arrays[name] = np.moveaxis(planes, len(lead), -1) if last else planes

    def apart(array: FloatArray) -> FloatArray:
        """What is read must not change while the results are written."""
        shared = any(np.may_share_memory(array, flat) for flat in flats)
        return array.copy() if shared else array

    plan.run(
        list(shape),
        [
            array.reshape(-1)
            for array in (line.bends, line.twists, line.phases, line.directions, line.normals)
        ],
        _strides(line.shape, shape),
        (apart(angles.reshape(-1)), _strides(angles.shape, shape)),
        _broadcast_load(load, inertias, shape, apart),
        flats,
        threads.at_most(workers),
        level,
    )
    for name, target in given.items():
        if arrays[name] is not target:
            target[...] = arrays[name]
    return Result({name: given.get(name, scalar_or_array(arrays[name])) for name in names})


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
    try:
        operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        return False
    return True


def _items(argument: str, value: int | slice | Sequence[int], count: int) -> list[int]:
    if isinstance(value, slice):
        return list(range(count))[value]
    if _is_index(value):
        return [item_index(argument, value, count)]  # type: ignore[arg-type]
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise TypeError(f"{argument} is {value!r}; it must be an index, a slice or a list")
    return [item_index(f"{argument}[{i}]", item, count) for i, item in enumerate(value)]


def _sample_shape(line: Driveline, angles: FloatArray) -> tuple[int, ...]:
    shape = _broadcast(line.shape, angles.shape)
    if shape is None:
        raise ValueError(
            f"angle has shape {angles.shape}, which does not broadcast against the driveline's "
            f"batch shape {line.shape}"
        )
    return shape


def _broadcast(*shapes: tuple[int, ...]) -> tuple[int, ...] | None:
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        return None


def _strides(own: tuple[int, ...], shape: tuple[int, ...]) -> list[int]:
    """Strides, in elements, of a contiguous array over the samples it is broadcast to."""
    strides = [0] * len(shape)
    step = 1
    for axis in range(-1, -len(own) - 1, -1):
        if own[axis] != 1:
            strides[axis] = step
        step *= own[axis]
    return strides


def _inertias(line: Driveline, load: Load | None) -> dict[int, FloatArray]:
    """The inertia of each shaft that has one, as a contiguous array."""
    if load is None or load.inertias is None:
        return {}
    count = line.n_joints + 1
    if load.inertias.shape[-1] != count:
        shape = load.inertias.shape
        raise ValueError(f"inertias has shape {shape}; {count} shafts need (..., {count})")
    columns = (np.array(load.inertias[..., shaft], order="C") for shaft in range(count))
    return {shaft: column for shaft, column in enumerate(columns) if np.any(column != 0.0)}


def _broadcast_load(
    load: Load | None,
    inertias: Mapping[int, FloatArray],
    shape: tuple[int, ...],
    apart: Callable[[FloatArray], FloatArray],
) -> tuple[_Broadcast, _Broadcast, _Broadcast, list[tuple[int, FloatArray, list[int]]]] | None:
    if load is None:
        return None

    def spread(name: str, array: FloatArray) -> _Broadcast:
        if _broadcast(array.shape, shape) != shape:
            raise ValueError(
                f"{name} has shape {array.shape}, which does not broadcast to the samples' {shape}"
            )
        return apart(array.reshape(-1)), _strides(array.shape, shape)

    return (
        spread(f"{load.end}_torque", load.torque),
        spread("speed", load.speed),
        spread("acceleration", load.acceleration),
        [(shaft, *spread("inertias", column)) for shaft, column in inertias.items()],
    )


def _checked_out(
    out: Mapping[str, FloatArray] | None, shapes: Mapping[str, tuple[int, ...]]
) -> dict[str, FloatArray]:
    if out is None:
        return {}
    checked: dict[str, FloatArray] = {}
    for name, array in out.items():
        if name not in shapes:
            raise ValueError(f"out[{name!r}] is not among the outputs asked for")
        if not isinstance(array, np.ndarray):
            raise TypeError(f"out[{name!r}] is {type(array).__name__}; it must be an array")
        if array.dtype != np.float64:
            raise ValueError(f"out[{name!r}] has dtype {array.dtype}; it must be float64")
        if array.shape != shapes[name]:
            wanted = shapes[name]
            raise ValueError(f"out[{name!r}] has shape {array.shape}; it must be {wanted}")
        if not array.flags.writeable:
            raise ValueError(f"out[{name!r}] is read-only; it must be writeable")
        for other, earlier in checked.items():
            if np.may_share_memory(array, earlier):
                raise ValueError(f"out[{name!r}] and out[{other!r}] share memory")
        checked[name] = array
    return checked
