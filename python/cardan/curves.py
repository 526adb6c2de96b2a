"""Curves and study tables as files: CSV, NPZ or Parquet, each whole or not there at all."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
from collections.abc import Callable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from cardan.scene import SceneResult
    from cardan.study import Progress, StudyPart, StudyResult


def columns(result: SceneResult, *, radians: bool = False) -> dict[str, FloatArray]:
    """Return the curves as columns of equal length, in SI units and angles in degrees.

    The names carry shaft or joint, component and unit: ``angle_error_deg``, ``moment_0_x_Nm``. The
    last shaft has no number where the scene names no shafts.

    Args:
        result: an evaluated scene.
        radians: whether angles are in radians instead.
    """
    scene = result.scene
    if radians:
        table = {"drive_angle_rad": scene.drive_angle}
    else:
        table = {"drive_angle_deg": scene.drive_angle_deg}
    for output, item, values in result.curves():
        last = output.per == "shaft" and scene.shafts is None
        name = output.name if last else f"{output.name}_{item}"
        parts = {name: values}
        if output.vector:
            parts = {f"{name}_{axis}": values[:, i] for i, axis in enumerate("xyz")}
        for part, curve in parts.items():
            suffix, in_unit = converted(curve, output.unit, radians)
            table[f"{part}{suffix}"] = in_unit
    return table


def study_columns(
    result: StudyResult | StudyPart, *, radians: bool = False
) -> dict[str, FloatArray]:
    """Return a study as columns: the keys varied, as the file has them, then the figures.

    The arrays have the shape of the grid, and its rows are their elements in order. Figures are in
    SI units and their angles in degrees, or radians; the names carry the unit.
    """
    table = result.coordinates()
    for column in result.columns:
        suffix, in_unit = converted(result.values[column.name], column.unit, radians)
        table[f"{column.name}{suffix}"] = in_unit
    return table


def converted(values: FloatArray, unit: str, radians: bool) -> tuple[str, FloatArray]:
    """Return the ending of a column's name and its values, angles in the unit asked for."""
    if unit == "rad" and not radians:
        return "_deg", np.degrees(values)
    return "" if unit == "1" else f"_{unit.replace(' ', '')}", values


def write_curves(
    result: SceneResult,
    path: str | PathLike[str],
    *,
    radians: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the curves in the format that the path's suffix names and return the number of rows.

    CSV and Parquet hold the columns of ``columns``, CSV with every digit of the doubles. NPZ holds
    the arrays as evaluated, in SI units under the names of the outputs, and ``drive_angle`` in rad.
    ``progress`` is called as ``write_columns`` does.

    Raises:
        ImportError: Parquet without pyarrow.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    if Path(path).suffix == ".npz":
        return write_columns(path, {"drive_angle": result.drive_angle, **result.values})
    return write_columns(path, columns(result, radians=radians), progress)


def write_study(
    result: StudyResult,
    path: str | PathLike[str],
    *,
    radians: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write a study in the format that the path's suffix names and return the number of rows.

    CSV and Parquet hold the columns of ``study_columns``. NPZ holds the grid: the values of each
    key that is varied in one dimension, and every figure in SI units with a dimension per key.
    ``progress`` is called as ``write_columns`` does.

    Raises:
        ImportError: Parquet without pyarrow.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    if Path(path).suffix == ".npz":
        write_columns(path, {**{axis.key: axis.values for axis in result.axes}, **result.values})
    else:
        write_columns(path, study_columns(result, radians=radians), progress)
    return result.rows


def write_columns(
    path: str | PathLike[str],
    table: Mapping[str, FloatArray],
    progress: Progress | None = None,
) -> int:
    """Write arrays of equal size in the format of the path's suffix; return the number of rows.

    In CSV and Parquet ``progress`` is called after each block with the rows written and all rows.

    Raises:
        ImportError: Parquet without pyarrow.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    with whole_file(path) as file:
        SUFFIXES[suffix](table, file, progress)
    return next(iter(table.values())).size


def _blocks(
    table: Mapping[str, FloatArray], progress: Progress | None
) -> Iterator[list[FloatArray]]:
    """Some rows of every column at a time.

    A grid's coordinates are views that would take memory as whole columns, and so would floats as
    objects.
    """
    rows = next(iter(table.values())).size
    for first in range(0, rows, _BLOCK):
        yield [column.flat[first : first + _BLOCK] for column in table.values()]
        if progress:
            progress(min(first + _BLOCK, rows), rows)


_BLOCK = 1 << 16


def _write_csv(table: Mapping[str, FloatArray], file: IO[bytes], progress: Progress | None) -> None:
    file.write(f"{','.join(table)}\n".encode())
    for block in _blocks(table, progress):
        rows = zip(*(column.tolist() for column in block), strict=True)
        file.writelines(f"{','.join(map(repr, row))}\n".encode() for row in rows)


def _write_npz(table: Mapping[str, FloatArray], file: IO[bytes], _: Progress | None) -> None:
    arrays: dict[str, Any] = dict(table)
    np.savez(file, **arrays)


def _write_parquet(
    table: Mapping[str, FloatArray], file: IO[bytes], progress: Progress | None
) -> None:
    try:
        import pyarrow
        from pyarrow import parquet
    except ModuleNotFoundError:
        hint = "a .parquet file needs pyarrow: pip install 'cardan[table]'"
        raise ModuleNotFoundError(hint) from None
    schema = pyarrow.schema([(name, pyarrow.float64()) for name in table])
    with parquet.ParquetWriter(file, schema) as writer:
        for block in _blocks(table, progress):
            writer.write_table(pyarrow.table(block, schema=schema))


_Writer = Callable[[Mapping[str, FloatArray], IO[bytes], "Progress | None"], None]

SUFFIXES: Mapping[str, _Writer] = {
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".parquet": _write_parquet,
}
"""Formats of a file of curves or a study, by suffix."""


def check_writable(path: str | PathLike[str]) -> None:
    """Refuse a file that could not be written, before the work for it is done.

    Raises:
        OSError: the folder takes no file, or the path is a folder; nothing is left behind.
    """
    with contextlib.suppress(_Tried), whole_file(path):
        raise _Tried


class _Tried(Exception):  # noqa: N818 - not an error
    """The file can be written."""


@contextlib.contextmanager
def whole_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file to write that takes its name only when it is complete.

    It is written under another name in the same folder, brought to the disk and renamed. Whatever
    interrupts that, an exception, Ctrl-C or a full disk, leaves nothing behind, and an earlier file
    of the name untouched. A link stays one; a folder, device or pipe is refused.

    Raises:
        OSError: the file cannot be written; the error names ``path``.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if os.path.exists(path) and not os.path.isfile(path):
        # Renaming would put a file in the place of a device.
        raise OSError(errno.EINVAL, "Not a plain file", os.fspath(path))
    temporary = target.with_name(f".{secrets.token_hex(8)}.part")
    try:
        with open(temporary, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            # The user knows nothing of the temporary name.
            reason = error.strerror or str(error)
            raise OSError(error.errno or errno.EIO, reason, os.fspath(path)) from error
        raise
