"""The formats of files that are written; columns of numbers into CSV, NPZ and Parquet files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import IO, Any

import numpy as np

from cardan.app.files.whole_file import Progress, whole_file
from cardan.arrays import FloatArray


def write_columns(
    path: str | PathLike[str], table: Mapping[str, FloatArray], progress: Progress | None = None
) -> int:
    """Write arrays of equal size in the format of the path's suffix; return the number of rows.

    In CSV and Parquet ``progress`` is called after each block with the rows written and all rows. A
    file that cannot be written whole leaves nothing behind.
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


_Writer = Callable[[Mapping[str, FloatArray], IO[bytes], Progress | None], None]

SUFFIXES: Mapping[str, _Writer] = {
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".parquet": _write_parquet,
}
"""Formats of a file of curves or a study, by suffix."""

PICTURES: Mapping[str, dict[str, Any]] = {
    ".svg": {"Date": None},
    ".png": {},
    ".pdf": {"CreationDate": None},
}
"""Formats of a picture file, by suffix, and metadata: what differs from run to run is left out."""
