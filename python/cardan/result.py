"""What an evaluation returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from numpy.typing import NDArray

from cardan.arrays import adapter, import_optional

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray

Labels: TypeAlias = tuple[int | list[int], int | list[int], tuple[int, ...], str | None]
"""Shafts and joints evaluated, shape of the driveline's batch, reduction."""


class Result(Mapping[str, NDArray[Any]]):
    """Read-only mapping of output names to arrays, with attribute access.

    ``result["speed_ratio"]`` and ``result.speed_ratio`` are the same array. The arrays themselves
    are yours to change. ``to_xarray``, ``to_pandas`` and ``to_arrow`` label them; the drive angles
    that they show are those of the array that was evaluated, which is not copied.
    """

    __slots__ = ("_angle", "_arrays", "_labels")

    def __init__(
        self,
        arrays: Mapping[str, NDArray[Any]],
        labels: Labels | None = None,
        angle: Any = None,  # noqa: ANN401 - an array of any library, or a sweep
    ) -> None:
        """Keep the arrays under their names."""
        self._arrays = arrays
        self._labels = labels
        self._angle = angle

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the array of one output."""
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the output names, in the order asked for."""
        return iter(self._arrays)

    def __len__(self) -> int:
        """Return the number of outputs."""
        return len(self._arrays)

    def __getattr__(self, name: str) -> NDArray[Any]:
        """Return the array of one output."""
        # Copying and unpickling ask for attributes before there is anything to look in.
        if name != "_arrays" and name in self._arrays:
            return self._arrays[name]
        raise AttributeError(f"the result holds no {name!r}")

    def __dir__(self) -> list[str]:
        """List the outputs beside the methods."""
        return [*super().__dir__(), *self._arrays]

    def to_xarray(self) -> xarray.Dataset:
        """Return the outputs as variables of a Dataset, with units and long names.

        Dimensions are ``shaft``, ``joint`` and ``component`` (x, y, z) where an output has them,
        ``drive_angle`` for angles in one dimension, ``sample`` for those of dask or paired with the
        batch, ``driveline`` for the batch; several of a kind are numbered (``sample_0``).
        Attributes follow the CF conventions: ``units``, ``long_name``, ``comment``, and
        ``cell_methods`` of reduced outputs. Nothing is copied.

        Raises:
            ImportError: xarray is missing.
            ValueError: a result that was not evaluated but put together.
        """
        made: xarray.Dataset = _labels().dataset(self)
        return made

    def to_pandas(self) -> pandas.DataFrame:
        """Return the samples as rows, indexed by driveline and drive angle in rad.

        A column is an output of one shaft or joint, and of one component: ``speed_ratio``,
        ``torque_1``, ``moment_0_x``. The units of all columns stand in ``attrs["units"]``.

        Raises:
            ImportError: pandas is missing.
            ValueError: a result that was not evaluated but put together.
        """
        made: pandas.DataFrame = _labels().frame(self)
        return made

    def to_arrow(self) -> pyarrow.Table:
        """Return the samples as rows of a table, driveline and drive angle in rad first.

        Columns as of ``to_pandas``; every field has ``units`` and ``long_name`` as metadata.

        Raises:
            ImportError: pyarrow is missing.
            ValueError: a result that was not evaluated but put together.
        """
        made: pyarrow.Table = _labels().table(self)
        return made

    def compute(self, **options: Any) -> Result:  # noqa: ANN401 - those of dask
        """Return the result with arrays of NumPy in place of dask's, all computed in one pass.

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
        """Show names and shapes."""
        shapes = ", ".join(f"{name}: {array.shape}" for name, array in self._arrays.items())
        return f"Result({shapes})"


def _labels() -> Any:  # noqa: ANN401 - a module
    """The adapter of labelled arrays; frames and tables have the same labels."""
    return adapter("xarray")
