"""The formats of files that are written; columns of numbers, at once or in bounded memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.files.recording import read_ahead, read_chunks
from cardan.app.files.sheets import SHEET_ROWS, write_sheets
from cardan.app.files.whole_file import Progress, whole_file
from cardan.arrays import FloatArray, import_optional
from cardan.evaluation.result import Result


def write_columns(
    path: str | PathLike[str], table: Mapping[str, FloatArray], progress: Progress | None = None
) -> int:
    """Write arrays of equal size in the format of the path's suffix; return the number of rows.

    But for NPZ, ``progress`` is called after each block with the rows written and all rows. A file
    that cannot be written whole leaves nothing behind.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    rows = next(iter(table.values())).size
    check_rows(path, rows)
    with whole_file(path) as file:
        SUFFIXES[suffix](table, file, progress)
    return rows


def check_rows(path: str | PathLike[str], rows: int) -> None:
    """Refuse more rows than a file of the path's suffix has."""
    if Path(path).suffix == ".xlsx" and rows >= SHEET_ROWS:
        raise ValueError(
            f"{os.fspath(path)}: {rows} rows are too many for a sheet, which has {SHEET_ROWS} with "
            "the head; .csv, .npz and .parquet take any number"
        )


def check_library(path: str | PathLike[str]) -> None:
    """Refuse a file whose format needs a library that is not installed."""
    if needed := _LIBRARIES.get(Path(path).suffix):
        import_optional(*needed)


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


def _write_xlsx(
    table: Mapping[str, FloatArray], file: IO[bytes], progress: Progress | None
) -> None:
    rows = (
        row
        for block in _blocks(table, progress)
        for row in zip(*(column.tolist() for column in block), strict=True)
    )
    write_sheets(file, {"table": chain([tuple(table)], rows)})


_Writer = Callable[[Mapping[str, FloatArray], IO[bytes], Progress | None], None]

SUFFIXES: Mapping[str, _Writer] = {
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".parquet": _write_parquet,
    ".xlsx": _write_xlsx,
}
"""Formats of a file of curves or a study, by suffix."""

_LIBRARIES = {".parquet": ("pyarrow", "table"), ".xlsx": ("openpyxl", "app")}
"""Modules that formats need, and the extras that bring them."""

PICTURES: Mapping[str, dict[str, Any]] = {
    ".svg": {"Date": None},
    ".png": {},
    ".pdf": {"CreationDate": None},
}
"""Formats of a picture file, by suffix, and metadata: what differs from run to run is left out."""


# --- columns of any length, in chunks -------------------------------------------------------------

ROWS = 1 << 18
"""Rows of a chunk: enough to keep all threads busy, and few enough for the caches."""


def map_parquet(
    source: str | PathLike[str],
    target: str | PathLike[str],
    names: Sequence[str],
    function: Callable[..., Mapping[str, NDArray[Any]]],
    *,
    rows: int = ROWS,
    progress: Progress | None = None,
) -> int:
    """Apply a function to the columns of a Parquet file, write the result, and return the rows.

    Args:
        source: the file to read.
        target: the Parquet file, which is written completely or not at all.
        names: the columns to read, of numbers; missing values become NaN.
        function: takes one array per column, with some of the rows. It returns arrays of the same
            length by name, or a ``Result``, which is written as by its ``to_arrow``. A plan is such
            a function for a column of angles in rad.
        rows: largest number of rows at a time.
        progress: called after each chunk with the number of rows done and of all rows.

    Raises:
        ImportError: pyarrow is missing.
        OSError: a file cannot be read or written.
        ValueError: as for ``recording.read_columns``; a file that is not Parquet.
    """
    with closing(read_ahead(read_chunks(source, names, rows))) as chunks:
        pieces = ((function(*chunk.columns), chunk.total) for chunk in chunks)
        return write_pieces(target, pieces, progress)


def write_pieces(
    target: str | PathLike[str],
    pieces: Iterable[tuple[Mapping[str, NDArray[Any]], int]],
    progress: Progress | None,
) -> int:
    """Write pieces of a table, each with the rows of the whole, and return the rows."""
    if Path(target).suffix != ".parquet":
        raise ValueError(f"{os.fspath(target)} must end in .parquet")
    pyarrow, parquet = (
        import_optional("pyarrow", "table"),
        import_optional("pyarrow.parquet", "table"),
    )
    tables = (
        (piece.to_arrow() if isinstance(piece, Result) else pyarrow.table(dict(piece)), total)
        for piece, total in pieces
    )
    done = 0
    with closing(read_ahead(tables)) as ahead:
        # Before the file is begun, for errors within are taken for its own.
        first = next(ahead)
        # Doubles that hardly repeat gain nothing from a dictionary and little from compression.
        how: dict[str, Any] = {"use_dictionary": False, "compression": "none"}
        with (
            whole_file(target) as file,
            parquet.ParquetWriter(file, first[0].schema, **how) as writer,
        ):
            for table, total in chain([first], ahead):
                writer.write_table(table)
                done += table.num_rows
                if progress:
                    progress(done, total)
    return done
