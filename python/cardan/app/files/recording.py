"""Recorded columns of numbers from CSV, Parquet, NPZ and MDF files, at once or in pieces."""

from __future__ import annotations

import math
import os
import zipfile
import zlib
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from os import PathLike
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar

import numpy as np

from cardan.app.files.delimited import line_of, parts_of, place_of_column, read_csv, short
from cardan.app.files.mdf import read_mdf
from cardan.arrays import FloatArray, import_optional

_Columns = list[FloatArray]
# Columns of some rows, and the number of all rows.
_Pieces = Iterator[tuple[_Columns, int]]

MOST_ROWS = 100_000_000
"""Rows of a Parquet file that are read at once at most."""


def read_columns(
    path: str | PathLike[str], names: Sequence[str], raster_s: float | None = None
) -> _Columns:
    """Return columns of a file, all of one length, as doubles; what is missing is NaN.

    Missing are empty cells of a CSV file, nulls of a Parquet file, samples that an MDF file marks
    as invalid, and NaN anywhere.

    A CSV file has its names in the first line and commas, semicolons or tabs between the columns;
    of an NPZ file each array of one dimension is a column; of an MDF file each channel of one
    channel group, the time among them, or with ``raster_s`` channels of any groups, interpolated at
    steps of so many seconds. A ``ValueError`` says in one line which file, line or row, column and
    value is wrong.
    """
    chunks = [chunk.columns for chunk in read_chunks(path, names, None, raster_s)]
    return chunks[0] if len(chunks) == 1 else list(map(np.concatenate, zip(*chunks, strict=True)))


class Chunk(NamedTuple):
    """Some rows of columns."""

    first: int  # the first of the rows, counted from 0
    columns: list[FloatArray]  # the columns
    total: int  # the number of all rows; of a CSV file that of its lines until the last chunk


def read_chunks(
    path: str | PathLike[str], names: Sequence[str], rows: int | None, raster_s: float | None = None
) -> Generator[Chunk]:
    """Yield columns of a file in chunks of so many rows, each as ``read_columns`` does.

    Memory is that of a chunk, however long the file is; except for NPZ files, and MDF files with a
    raster, of which the columns must fit in memory. At most ``rows`` come at a time, or all. Errors
    are those of ``read_columns``.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    if raster_s is not None and suffix not in RASTERED:
        raise ValueError(f"{os.fspath(path)} has no channels to resample; only MDF files have")
    with _of_file(path):
        first = 0
        found = [False] * len(names)
        for read, total in SUFFIXES[suffix](path, names, rows, raster_s):
            _check_numbers(path, names, read, first)
            found = [
                some or not np.isnan(column[0]) or not np.isnan(column).all()
                for some, column in zip(found, read, strict=True)
            ]
            yield Chunk(first, read, total)
            first += len(read[0])
        for name, some in zip(names, found, strict=True):
            if not some:
                raise ValueError(f"column {name!r} has no numbers, only empty cells or NaN")


@contextmanager
def _of_file(path: str | PathLike[str]) -> Iterator[None]:
    """Put the file in front of what is wrong with it."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise ValueError(f"{os.fspath(path)}: not UTF-8 text at byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None


def _check_numbers(
    path: str | PathLike[str], names: Sequence[str], read: _Columns, first: int
) -> None:
    for name, column in zip(names, read, strict=True):
        if len(column) != len(read[0]):
            raise ValueError(
                f"column {name!r} has {len(column)} rows, {names[0]!r} has {len(read[0])}"
            )
    for name, column in zip(names, read, strict=True):
        if not len(column):
            raise ValueError(f"column {name!r} has no rows")
        # NaN and infinities show in one of them.
        if math.isfinite(column.min()) and math.isfinite(column.max()):
            continue
        infinite = np.isinf(column)
        if infinite.any():
            row = int(np.argmax(infinite))
            where = place_of(path, first + row)
            raise ValueError(f"{where}, column {name!r} is {column[row]}; it must be finite")


def place_of(path: str | PathLike[str], row: int) -> str:
    """Say where a row of a file is, which is counted from 0, as whoever opens the file finds it.

    Of a CSV file that is the line as editors count them, of other files the row, the first one 1.
    """
    if Path(path).suffix == ".csv":
        return f"line {line_of(path, row)}"
    return f"row {row + 1}, counted from 1"


def _parquet(path: str | PathLike[str], names: Sequence[str], rows: int | None, _: None) -> _Pieces:
    with _parquet_file(path, names) as file:
        total = file.metadata.num_rows
        if rows is None and total > MOST_ROWS:
            raise ValueError(
                f"{total} rows are too many to be read at once, "
                f"{MOST_ROWS} at most; cardan stream takes any number"
            )
        if rows is None or not total:
            yield _of_arrow(file.read(columns=list(names)), names), total
            return
        for batch in file.iter_batches(rows, columns=list(names)):
            yield _of_arrow(batch, names), total


@contextmanager
def _parquet_file(path: str | PathLike[str], names: Sequence[str]) -> Iterator[Any]:
    """An open Parquet file that has the columns, of numbers."""
    pyarrow, parquet = (
        import_optional("pyarrow", "table"),
        import_optional("pyarrow.parquet", "table"),
    )
    # Opened here, because pyarrow's own message for a missing file names no file.
    with open(path, "rb") as source:
        try:
            # With a buffer a row group is read bit by bit.
            file = parquet.ParquetFile(source, buffer_size=1 << 20, pre_buffer=False)
            schema = file.schema_arrow
            for name in names:
                kind = schema.field(place_of_column(name, schema.names)).type
                if not (pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind)):
                    raise ValueError(f"column {name!r} holds {kind}; it must hold numbers")
            yield file
        except (pyarrow.ArrowException, OSError) as error:
            reason = " ".join(str(error).split())
            raise ValueError(f"not a readable Parquet file: {short(reason)}") from None


def _of_arrow(table: Any, names: Sequence[str]) -> _Columns:  # noqa: ANN401 - of pyarrow
    """Columns of a table or a batch; Arrow's nulls become NaN."""
    columns = []
    for name in names:
        column = table[name]
        if column.null_count:
            column = column.cast("float64")
        columns.append(np.asarray(column).astype(np.float64, copy=False))
    return columns


# A RuntimeError is a flag of the archive that asks for what it does not have, as a password.
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError)


def _npz(path: str | PathLike[str], names: Sequence[str], rows: int | None, _: None) -> _Pieces:
    with open(path, "rb") as source:
        try:
            _check_archive(source)
            with np.load(source, allow_pickle=False) as file:
                for name in names:
                    place_of_column(name, file.files)
                read = [_array(file, name) for name in names]
        except _DAMAGED as error:
            raise ValueError(f"not a readable NPZ file: {error}") from None
    for name, column in zip(names, read, strict=True):
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise ValueError(
                f"column {name!r} has shape {column.shape} and dtype {column.dtype}; "
                "it must hold numbers in one dimension"
            )
    total = max(map(len, read))
    for part in parts_of(total, rows):
        yield [column[part].astype(np.float64) for column in read], total


def _check_archive(source: IO[bytes]) -> None:
    """Refuse what is no archive of arrays before NumPy takes it for a pickle."""
    if source.read(6) == b"\x93NUMPY":
        raise ValueError("one array without a name; a column needs one, as np.savez gives it")
    if not zipfile.is_zipfile(source):
        raise ValueError("not a readable NPZ file; np.savez writes one")
    with zipfile.ZipFile(source) as archive:
        # Whatever else an archive holds is none of a message's business.
        if not all(name.endswith(".npy") for name in archive.namelist()):
            raise ValueError("a ZIP file, but not one of arrays; np.savez writes one")
    source.seek(0)


def _array(file: Any, name: str) -> Any:  # noqa: ANN401 - an open NPZ file and an array of it
    try:
        return file[name]
    except _DAMAGED:
        raise
    except ValueError:
        # NumPy would advise to read pickles, which may run anything.
        raise ValueError(f"column {name!r} holds objects; it must hold numbers") from None


_Read = Callable[[str | PathLike[str], Sequence[str], int | None, Any], _Pieces]

SUFFIXES: Mapping[str, _Read] = {
    ".csv": read_csv,
    ".npz": _npz,
    ".parquet": _parquet,
    ".mf4": read_mdf,
    ".mdf": read_mdf,
}
"""Formats of a file of recorded columns, by suffix, and what reads its columns in pieces."""

RASTERED = (".mf4", ".mdf")
"""Formats in which each column has its times, which a raster replaces."""

_Item = TypeVar("_Item")


def read_ahead(items: Generator[_Item]) -> Generator[_Item]:
    """Yield the items of a generator, while a second thread makes the next one.

    One item at most is ready ahead. The generator is closed with this one.
    """
    from concurrent.futures import ThreadPoolExecutor

    # After the thread has ended, because a generator that runs cannot be closed.
    with closing(items), ThreadPoolExecutor(1, "cardan-read") as thread:
        coming = thread.submit(_next, items)
        while item := coming.result():
            coming = thread.submit(_next, items)
            yield item[0]


def _next(items: Generator[_Item]) -> tuple[_Item] | None:
    for item in items:
        return (item,)
    return None
