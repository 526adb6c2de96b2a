"""Recorded columns of numbers from CSV, Parquet and NPZ files."""

from __future__ import annotations

import csv
import os
import zipfile
import zlib
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cardan.arrays import FloatArray, import_optional
from cardan.outputs import nearest

MOST_ROWS = 100_000_000
"""Rows of a Parquet file that are read at once at most."""


def read_columns(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    """Return columns of a file, all of one length, as doubles.

    A CSV file has its names in the first line and commas, semicolons or tabs between the columns;
    of an NPZ file each array of one dimension is a column.

    Args:
        path: the file; its suffix names the format.
        names: the columns wanted.

    Raises:
        ImportError: Parquet without pyarrow.
        OSError: the file cannot be read.
        ValueError: a column that is missing, not of numbers or not finite, columns of different
            lengths, a damaged file; one line with file, line or row, column and value.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    with _of_file(path):
        read = SUFFIXES[suffix](path, names)
        for name, column in zip(names, read, strict=True):
            if len(column) != len(read[0]):
                raise ValueError(
                    f"column {name!r} has {len(column)} rows, {names[0]!r} has {len(read[0])}"
                )
        _check_finite(names, read, 0)
    return read


class Chunk(NamedTuple):
    """Some rows of columns."""

    first: int
    columns: list[FloatArray]
    total: int


def read_chunks(path: str | PathLike[str], names: Sequence[str], rows: int) -> Iterator[Chunk]:
    """Yield columns of a Parquet file in chunks of so many rows, each as ``read_columns`` does.

    Memory is that of a chunk, however long the file and its row groups are.

    Raises:
        ImportError: pyarrow is missing.
        OSError: the file cannot be read.
        ValueError: as for ``read_columns``; a file of another format.
    """
    if Path(path).suffix != ".parquet":
        raise ValueError(f"{os.fspath(path)} must end in .parquet to be read by chunks")
    with _of_file(path), _parquet_file(path, names) as file:
        total = file.metadata.num_rows
        if not total:
            _check_finite(names, [np.empty(0)], 0)
        first = 0
        for batch in file.iter_batches(rows, columns=list(names)):
            read = _of_arrow(batch, names, first)
            _check_finite(names, read, first)
            yield Chunk(first, read, total)
            first += batch.num_rows


@contextmanager
def _of_file(path: str | PathLike[str]) -> Iterator[None]:
    """Put the file in front of what is wrong with it."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise ValueError(f"{os.fspath(path)}: not UTF-8 text at byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None


def _check_finite(names: Sequence[str], read: Sequence[FloatArray], first: int) -> None:
    for name, column in zip(names, read, strict=False):
        if not len(column):
            raise ValueError(f"column {name!r} has no rows")
        finite = np.isfinite(column)
        if not finite.all():
            row = int(np.argmin(finite))
            raise ValueError(
                f"row {first + row}, counted from 0, column {name!r} is {column[row]}; "
                "it must be finite"
            )


def _csv(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    with open(path, encoding="utf-8-sig", newline="") as file:
        first = file.readline()
        file.seek(0)
        delimiter = max(",;\t", key=first.count)
        rows = csv.reader(file, delimiter=delimiter, skipinitialspace=True)
        try:
            header = [name.strip() for name in next(rows, [])]
            places = [_place(name, header) for name in names]
            read = [array("d") for _ in names]
            for row in rows:
                if not row:
                    continue
                for name, place, column in zip(names, places, read, strict=True):
                    column.append(_cell(row, place, f"line {rows.line_num}, column {name!r}"))
        except csv.Error as error:
            raise ValueError(f"line {rows.line_num}: not CSV: {error}") from None
    return [np.array(column, dtype=np.float64) for column in read]


def _cell(row: Sequence[str], place: int, where: str) -> float:
    if place >= len(row) or not row[place].strip():
        raise ValueError(f"{where} is empty; it must be a number")
    try:
        number = float(row[place])
    except ValueError:
        text = row[place] if len(row[place]) <= 40 else f"{row[place][:37]}..."
        hint = ", with a decimal point" if _decimal_comma(text) else ""
        raise ValueError(f"{where} is {text!r}; it must be a number{hint}") from None
    if not np.isfinite(number):
        raise ValueError(f"{where} is {number}; it must be finite")
    return number


def _decimal_comma(text: str) -> bool:
    return text.count(",") == 1 and text.replace(",", "").strip(" +-").isdigit()


def _place(name: str, columns: Sequence[str]) -> int:
    if name not in columns:
        there = f"the columns are {', '.join(columns)}" if columns else "the file has none"
        close = nearest(name, columns)
        meant = f"; {close}" if close.startswith("did") else ""
        raise ValueError(f"no column {name!r}{meant}; {_short(there)}")
    if columns.count(name) > 1:
        raise ValueError(f"column {name!r} is there {columns.count(name)} times")
    return columns.index(name)


def _short(text: str) -> str:
    # A quoted heading may go over several lines.
    text = " ".join(text.splitlines())
    return text if len(text) <= 300 else f"{text[:297]}..."


def _parquet(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    with _parquet_file(path, names) as file:
        if file.metadata.num_rows > MOST_ROWS:
            raise ValueError(
                f"{file.metadata.num_rows} rows are too many to be read at once, "
                f"{MOST_ROWS} at most; cardan stream takes any number"
            )
        return _of_arrow(file.read(columns=list(names)), names, 0)


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
                kind = schema.field(_place(name, schema.names)).type
                if not (pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind)):
                    raise ValueError(f"column {name!r} holds {kind}; it must hold numbers")
            yield file
        except (pyarrow.ArrowException, OSError) as error:
            reason = " ".join(str(error).split())
            raise ValueError(f"not a readable Parquet file: {_short(reason)}") from None


def _of_arrow(
    table: Any,  # noqa: ANN401 - a table or a batch of pyarrow
    names: Sequence[str],
    first: int,
) -> list[FloatArray]:
    for name in names:
        if table[name].null_count:
            row = int(np.argmin(np.asarray(table[name].is_valid())))
            raise ValueError(f"row {first + row}, counted from 0, column {name!r} is empty")
    return [np.asarray(table[name]).astype(np.float64, copy=False) for name in names]


# A RuntimeError is a flag of the archive that asks for what it does not have, as a password.
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError)


def _npz(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    with open(path, "rb") as source:
        try:
            file = np.load(source, allow_pickle=False)
            if not isinstance(file, np.lib.npyio.NpzFile):
                raise ValueError("one array without a name; a column needs one")
            for name in names:
                _place(name, file.files)
            read = [file[name] for name in names]
        except _DAMAGED as error:
            raise ValueError(f"not a readable NPZ file: {error}") from None
    for name, column in zip(names, read, strict=True):
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise ValueError(
                f"column {name!r} has shape {column.shape} and dtype {column.dtype}; "
                "it must hold numbers in one dimension"
            )
    return [column.astype(np.float64) for column in read]


SUFFIXES: Mapping[str, Callable[[str | PathLike[str], Sequence[str]], list[FloatArray]]] = {
    ".csv": _csv,
    ".npz": _npz,
    ".parquet": _parquet,
}
"""Formats of a file of recorded columns, by suffix."""
