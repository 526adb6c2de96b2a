"""What an evaluation returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import adapter, html_table, import_optional
from cardan.arrays.libraries import draw
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.reductions import Reduction
from cardan.evaluation.request import PlanePlace, view
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray
    from matplotlib.figure import Figure

Labels: TypeAlias = tuple[
    int | list[int], int | list[int], tuple[int, ...], Reduction | tuple[Reduction, ...] | None, str
]
"""Shafts and joints evaluated, shape of the driveline's batch, reductions, unit of angles."""


class Result(Mapping[str, NDArray[Any]]):
    """Read-only mapping of output names to arrays, with attribute access.

    ``result["speed_ratio"]`` and ``result.speed_ratio`` are the same array. The arrays themselves
    are yours to change. ``to_xarray``, ``to_pandas`` and ``to_arrow`` label them, and ``plot``
    draws them. The drive angles that they show are those of the evaluated array, which is not
    copied. ``units`` gives the unit of each output.

    ``==`` gives one answer and not one per sample. Results are equal if they have the same outputs
    in the same units and all values are the same, where NaN equals NaN. Arrays that are computed
    later are equal only to themselves. Compare ``result.angle == other.angle`` for an
    answer per sample.
    """

    __slots__ = ("_angle", "_labels", "_made", "_names", "_planes")

    _made: Any  # the arrays that exist, by name
    _planes: Any
    _names: Mapping[str, Any]  # all outputs in order: the arrays, or where they lie in the planes

    def __init__(
        self,
        arrays: Mapping[str, NDArray[Any]] | Mapping[str, PlanePlace],
        labels: Labels | None = None,
        angle: Any = None,  # noqa: ANN401 - an array of any library, or a sweep
        planes: NDArray[Any] | None = None,
    ) -> None:
        """Keep the arrays under their names.

        With ``planes``, ``arrays`` says where each output lies among them. Its view is made when it
        is asked for: making all of them takes a third of a call on a few angles.
        """
        self._names = arrays
        self._made = arrays if planes is None else {}
        self._labels = labels
        self._angle = angle
        self._planes = planes

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the array of one output; a ``KeyError`` lists those that there are."""
        try:
            array: NDArray[Any] | None = self._made.get(name)
            if array is None:
                # Threads that ask at the same time get the same array.
                array = self._made.setdefault(name, view(self._planes, self._names[name]))
            return array
        except (KeyError, TypeError):
            held = ", ".join(self._names)
            hint = ""
            if not isinstance(name, str):
                first = next(iter(self._names), "angle")
                hint = f"; samples are indexed in an output: result.{first}[{name!r}]"
            raise KeyError(f"{name!r} is no output; the result holds {held}{hint}") from None

    def __eq__(self, other: object) -> bool:
        """Compare outputs, units and all values; NaN equals NaN."""
        if not isinstance(other, Result):
            return NotImplemented
        if self.keys() != other.keys() or self._angle_unit != other._angle_unit:
            return False
        return all(_same(array, other[name]) for name, array in self._arrays.items())

    __hash__ = None  # type: ignore[assignment]

    @property
    def drive_angle(self) -> NDArray[Any]:
        """The drive angles that were evaluated, in the unit of ``units["drive_angle"]``."""
        if self._labels is None:
            raise ValueError("the result has no drive angles; only one that was evaluated has")
        if isinstance(self._angle, Sweep):
            in_degrees = self._angle_unit == "deg"
            return self._angle.in_degrees() if in_degrees else np.asarray(self._angle)
        angle: NDArray[Any] = self._angle
        return angle

    @property
    def units(self) -> Mapping[str, str]:
        """Unit of each output and of the drive angle: ``"N m"``, ``"1"`` for ratios."""
        angles = {name: OUTPUTS[name].unit for name in self._names if name in OUTPUTS}
        units = {name: self._angle_unit if u == "rad" else u for name, u in angles.items()}
        return MappingProxyType({**units, "drive_angle": self._angle_unit})

    @property
    def _arrays(self) -> Mapping[str, NDArray[Any]]:
        return self._names if self._planes is None else {name: self[name] for name in self._names}

    @property
    def _angle_unit(self) -> str:
        return "rad" if self._labels is None else self._labels[4]

    @property
    def _bearings(self) -> list[int]:
        """The numbers of the bearings, which are evaluated all or not at all."""
        of = (array for name, array in self.items() if OUTPUTS[name].per == "bearing")
        return next((list(range(array.shape[0])) for array in of), [])

    def __iter__(self) -> Iterator[str]:
        """Iterate over the output names, in the order asked for."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return the number of outputs."""
        return len(self._names)

    def __getattr__(self, name: str) -> NDArray[Any]:
        """Return the array of one output."""
        # Copying and unpickling ask for attributes before there is anything to look in.
        if name != "_names" and name in self._names:
            return self[name]
        raise AttributeError(f"the result holds no {name!r}")

    def __dir__(self) -> list[str]:
        """List the outputs and the methods."""
        return [*super().__dir__(), *self._names]

    def to_xarray(self) -> xarray.Dataset:
        """Return the outputs as variables of a Dataset, with units and long names.

        Dimensions are ``shaft``, ``joint`` and ``component`` (x, y, z) where an output has them,
        ``drive_angle`` for angles in one dimension, ``sample`` for those of dask or paired with the
        batch, ``driveline`` for the batch; several of a kind are numbered (``sample_0``).
        Attributes follow the CF conventions: ``units``, ``long_name``, ``comment``, and
        ``cell_methods`` of reduced outputs. Nothing is copied.

        Raises:
            ImportError: xarray is missing.
            ValueError: a result that does not come from an evaluation.
        """
        made: xarray.Dataset = adapter("xarray").dataset(self)
        return made

    def to_pandas(self) -> pandas.DataFrame:
        """Return the samples as rows, indexed by driveline and drive angle.

        A column is an output of one shaft or joint, and of one component: ``speed_ratio``,
        ``torque_1``, ``moment_0_x``. The units of all columns are in ``attrs["units"]``. Errors are
        as of ``to_xarray``.
        """
        # Frames and tables have the same labels.
        made: pandas.DataFrame = adapter("xarray").frame(self)
        return made

    def to_arrow(self) -> pyarrow.Table:
        """Return the samples as rows of a table, driveline and drive angle first.

        Columns and errors as of ``to_pandas``; fields have ``units`` and ``long_name`` as metadata.
        """
        made: pyarrow.Table = adapter("xarray").table(self)
        return made

    def plot(self) -> Figure:
        """Draw every output over the drive angle, as ``cardan.plots.plot_result`` does.

        Raises:
            ImportError: matplotlib is missing.
            ValueError: a result without a row of drive angles, more curves than can be told apart.
        """
        made: Figure = draw("plot_result", self)
        return made

    def compute(self, **options: Any) -> Result:  # noqa: ANN401 - those of dask
        """Return the result with NumPy arrays instead of dask's, all computed in one pass.

        Args:
            options: further arguments of ``dask.compute``.
        """
        if not any(hasattr(array, "__dask_graph__") for array in self._arrays.values()):
            return self
        arrays, angle = import_optional("dask", "dask").compute(
            self._arrays, self._angle, **options
        )
        return Result(arrays, self._labels, angle)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the arrays by name, with their labels."""
        return (Result, (self._arrays, self._labels, self._angle))

    def __repr__(self) -> str:
        """Show name, shape, extent and unit of every output."""
        rows = html_table.extents(self._arrays)
        units = {name: unit for name, unit in self._units().items() if unit != "1"}
        each = (
            f"{name}: {shape} {extent} {units.get(name, '')}".rstrip()
            for name, shape, extent in rows
        )
        return f"Result({', '.join(each)})"

    def _units(self) -> Mapping[str, str]:
        return {**dict.fromkeys(self._names, ""), **self.units}

    def _repr_html_(self) -> str:
        """Show name, unit, shape and extent of every output as a table."""
        return html_table.result(
            f"Result, angles in {self._angle_unit}", self._arrays, self._units()
        )


def _same(one: Any, other: Any) -> bool:  # noqa: ANN401 - arrays of any library
    """Whether two arrays hold the same values."""
    if one is other:
        return True
    if any(hasattr(array, "__dask_graph__") for array in (one, other)):
        return False
    return np.array_equal(one, other, equal_nan=True)
