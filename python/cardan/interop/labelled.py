"""Results with labels: Datasets of xarray, frames of pandas, tables of Arrow.

Angles with labels of xarray or with an index of pandas give results that keep them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import array_namespace_of, import_optional
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.evaluation.evaluate import PlanInDegrees
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.evaluation.plan import Plan
from cardan.evaluation.reductions import REDUCTIONS
from cardan.evaluation.result import Result

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray

_UNITS = {"rad": ("rad", "radian", "radians", "1"), "deg": ("degree", "deg", "degrees")}

_HINT = ", or evaluate with degrees=True"

_DRIVE_ANGLE = {
    "long_name": "drive angle",
    "comment": "0 has the driving pin of joint 0 in the plane of shafts 0 and 1",
}


def evaluate(
    plan: Plan | PlanInDegrees,
    angle: Any,  # noqa: ANN401 - an array of xarray or pandas
    out: Mapping[str, NDArray[Any]] | None,
) -> xarray.Dataset | pandas.DataFrame:
    """Evaluate a plan at angles with labels, which the Dataset or DataFrame returned keeps."""
    of_pandas = array_namespace_of(angle) == "pandas"
    if out is not None:
        what = "Series; give its to_numpy()" if of_pandas else "DataArray; give its values"
        raise ArgumentTypeError("out", f"does not go with an angle that is a {what}")
    if of_pandas:
        return _with_index(plan(angle.to_numpy()), angle)
    wanted, hint = ("deg", "") if isinstance(plan, PlanInDegrees) else ("rad", _HINT)
    units = angle.attrs.get("units", wanted)
    if units not in _UNITS[wanted]:
        hint = hint if units in _UNITS["deg"] else ""
        rule = f"make it {wanted} and say so in attrs['units']{hint}"
        raise ArgumentValueError("angle", f"has units {units!r}; {rule}")
    return dataset(plan(angle.data), angle)


def dataset(result: Result, given: xarray.DataArray | None = None) -> xarray.Dataset:
    """Return what ``Result.to_xarray`` does, with the labels of the angles given."""
    library = import_optional("xarray", "xarray")
    samples = _Samples.of(result, given)
    taken = set() if given is None else {*map(str, given.dims), *map(str, given.coords)}
    coordinates: dict[str, Any] = {}
    if samples.angle is not None and "drive_angle" not in taken:
        named = {"units": _cf(result.units["drive_angle"]), **_DRIVE_ANGLE}
        coordinates["drive_angle"] = (samples.angle_dims, samples.angle, named)
    if "reduction" in samples.dims:
        coordinates["reduction"] = ("reduction", list(samples.reductions))
    variables = {}
    for name, array in result.items():
        output, items = OUTPUTS[name], samples.items[OUTPUTS[name].per]
        of_items = () if isinstance(items, int) else (output.per,)
        coordinates[output.per] = (of_items, items, {"long_name": f"{output.per}, counted from 0"})
        of_vector = ("component",) if output.vector and "peak" not in samples.reductions else ()
        if of_vector:
            axis = {"long_name": "component along one of the axes"}
            coordinates["component"] = ("component", list("xyz"), axis)
        attributes = {
            "units": _cf(result.units[name]),
            "long_name": name.replace("_", " "),
            "comment": output.meaning,
            **samples.cell_methods,
        }
        variables[name] = ((*of_items, *samples.dims, *of_vector), array, attributes)
    twice = {dim for dim in samples.dims if samples.dims.count(dim) > 1}
    for name in sorted(taken & {*variables, *coordinates} | twice):
        problem = f"has a dimension or coordinate {name!r}, as the result; rename it"
        raise ArgumentValueError("angle", problem)
    if given is not None:
        sizes = dict(zip(samples.dims, samples.shape, strict=True))
        for key, kept in given.coords.items():
            if all(sizes.get(str(dim)) == size for dim, size in kept.sizes.items()):
                coordinates[str(key)] = kept
    made: xarray.Dataset = library.Dataset(variables, coordinates)
    return made


class _Samples(NamedTuple):
    """How the samples of a result lie."""

    items: Mapping[str, int | list[int]]
    reductions: tuple[str, ...]
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    angle_dims: tuple[str, ...]
    angle: Any  # along these; None where its last axis is reduced
    cell_methods: Mapping[str, str]

    @classmethod
    def of(cls, result: Result, given: xarray.DataArray | None = None) -> _Samples:
        if result._labels is None:
            raise ValueError("the result has no labels; only one that was evaluated has")
        shafts, joints, line_shape, reduce, _ = result._labels
        angle = result._angle
        own = np.shape(angle) if given is None else given.shape
        shape = np.broadcast_shapes(line_shape, own)
        before = len(shape) - len(own)
        runs = [k for k in range(before, len(shape)) if own[k - before] == shape[k]]
        if given is not None:
            of_angle = {k: str(given.dims[k - before]) for k in runs}
        else:
            varied = (1,) * (len(shape) - len(line_shape)) + line_shape
            # As a dimension's own coordinate the angles would be computed at once.
            later = hasattr(angle, "__dask_graph__")
            alone = len(runs) == 1 and varied[runs[0]] == 1 and not later
            # Angles that each driveline has its own of vary along the batch as well.
            along_batch = {k for k in runs if varied[k] > 1}
            own_angles = along_batch if len(along_batch) < len(runs) else set()
            of_samples = [k for k in runs if k not in own_angles]
            of_angle = dict(zip(of_samples, _numbered("sample", len(of_samples)), strict=True))
            if alone:
                of_angle[runs[0]] = "drive_angle"
        others = [k for k in range(len(shape)) if k not in of_angle]
        names = of_angle | dict(zip(others, _numbered("driveline", len(others)), strict=True))
        dims = tuple(names[k] for k in range(len(shape)))
        angle_dims = tuple(names[k] for k in runs)
        methods = {}
        if reduce:
            if isinstance(reduce, str):
                methods = {"cell_methods": f"{dims[-1]}: {REDUCTIONS[reduce].cell_method}"}
            angle = None if runs and runs[-1] == len(shape) - 1 else angle
            dims, shape = dims[:-1], shape[:-1]
        if angle is not None:
            shown = result.drive_angle
            whole = shown if hasattr(shown, "__dask_graph__") else np.asarray(shown)
            angle = whole.reshape(tuple(own[k - before] for k in runs))
        reductions: tuple[str, ...] = ()
        if isinstance(reduce, str):
            reductions = (reduce,)
        elif reduce is not None:
            reductions = reduce
            dims, shape = ("reduction", *dims), (len(reduce), *shape)
        items = {"shaft": shafts, "joint": joints, "bearing": result._bearings}
        return cls(items, reductions, dims, shape, angle_dims, angle, methods)


def _cf(unit: str) -> str:
    """The unit as the CF conventions spell it."""
    return "degree" if unit == "deg" else unit


def _numbered(name: str, count: int) -> list[str]:
    return [name] if count == 1 else [f"{name}_{i}" for i in range(count)]


class LabelledColumn(NamedTuple):
    """Values of all samples in a row, with a name."""

    name: str
    values: NDArray[Any]
    unit: str
    long_name: str


def frame(result: Result) -> pandas.DataFrame:
    """Return what ``Result.to_pandas`` does."""
    library = import_optional("pandas", "xarray")
    index, figures = columns_of(result)
    columns = {column.name: column.values for column in (*index, *figures)}
    made: pandas.DataFrame = library.DataFrame(columns)
    made.attrs["units"] = {column.name: column.unit for column in (*index, *figures)}
    return made.set_index([column.name for column in index]) if index else made


def table(result: Result) -> pyarrow.Table:
    """Return what ``Result.to_arrow`` does."""
    pyarrow = import_optional("pyarrow", "table")
    index, figures = columns_of(result)
    fields = [
        pyarrow.field(
            column.name,
            pyarrow.array(column.values[:1]).type,
            metadata={"units": column.unit, "long_name": column.long_name},
        )
        for column in (*index, *figures)
    ]
    arrays = [column.values for column in (*index, *figures)]
    return pyarrow.table(arrays, schema=pyarrow.schema(fields))


def columns_of(result: Result) -> tuple[list[LabelledColumn], list[LabelledColumn]]:
    """Return what tells the samples apart, and the outputs, as columns of one length."""
    result = result.compute()
    samples = _Samples.of(result)
    index = []
    for k, dim in enumerate(samples.dims):
        if dim == "reduction":
            names = _spread(np.array(samples.reductions), (dim,), samples)
            index.append(LabelledColumn(dim, names, "1", "reduction over the drive angle"))
        if dim.startswith("driveline"):
            number = _spread(np.arange(samples.shape[k]), (dim,), samples)
            words = dim.replace("_", " ")
            index.append(LabelledColumn(dim, number, "1", f"{words}, counted from 0"))
    if samples.angle is not None:
        spread = _spread(samples.angle, samples.angle_dims, samples)
        index.append(
            LabelledColumn("drive_angle", spread, result.units["drive_angle"], "drive angle")
        )
    figures = []
    for name, array in result.items():
        output = OUTPUTS[name]
        for part, values in _parts(output, np.asarray(array), samples):
            flat = values.reshape(-1)
            figures.append(LabelledColumn(part, flat, result.units[name], part.replace("_", " ")))
    return index, figures


def _spread(values: NDArray[Any], dims: tuple[str, ...], samples: _Samples) -> NDArray[Any]:
    """Values along some dimensions as one for every sample."""
    own = tuple(
        size if dim in dims else 1 for dim, size in zip(samples.dims, samples.shape, strict=True)
    )
    return np.broadcast_to(values.reshape(own), samples.shape).reshape(-1)


def _parts(
    output: Output, array: NDArray[Any], samples: _Samples
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Each shaft, joint or bearing and component of an output under a separate name."""
    items = samples.items[output.per]
    named = {output.name: array}
    if not isinstance(items, int):
        named = {f"{output.name}_{item}": array[i] for i, item in enumerate(items)}
    for name, values in named.items():
        if output.vector and "peak" not in samples.reductions:
            for i, axis in enumerate("xyz"):
                yield f"{name}_{axis}", values[..., i]
        else:
            yield name, values


def _with_index(result: Result, angle: pandas.Series) -> pandas.DataFrame:
    """The columns of ``Result.to_pandas`` with the index of the angles.

    Rows of a batch have the number of the driveline in front of it.
    """
    library = import_optional("pandas", "xarray")
    index, figures = columns_of(result)
    made: pandas.DataFrame = library.DataFrame({c.name: c.values for c in figures})
    made.attrs["units"] = {column.name: column.unit for column in figures}
    levels = [library.Index(c.values, name=c.name) for c in index if c.name != "drive_angle"]
    if len(levels) == len(index):
        # The angles are reduced.
        return made.set_index(levels) if levels else made
    if not levels:
        made.index = angle.index
        return made
    # Samples next to each other differ in the angle.
    own = angle.index[np.arange(len(made)) % max(1, len(angle))]
    levels += [own.get_level_values(level) for level in range(own.nlevels)]
    made.index = library.MultiIndex.from_arrays(levels)
    return made
