"""Recorded columns of numbers from CSV, Parquet and NPZ files."""

from __future__ import annotations

import csv
import os
import zipfile
import zlib
from array import array
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from cardan.arrays import FloatArray
from cardan.outputs import nearest


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
    try:
        read = SUFFIXES[suffix](path, names)
        for name, column in zip(names, read, strict=True):
            if len(column) != len(read[0]):
                raise ValueError(
                    f"column {name!r} has {len(column)} rows, {names[0]!r} has {len(read[0])}"
                )
            if not len(column):
                raise ValueError(f"column {name!r} has no rows")
            wrong = np.flatnonzero(~np.isfinite(column))
            if wrong.size:
                row = int(wrong[0])
                raise ValueError(
                    f"row {row}, counted from 0, column {name!r} is {column[row]}; "
                    "it must be finite"
                )
    except UnicodeDecodeError as error:
        raise ValueError(f"{os.fspath(path)}: not UTF-8 text at byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None
    return read


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
    return text if len(text) <= 300 else f"{text[:297]}..."


def _parquet(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ModuleNotFoundError:
        hint = "a .parquet file needs pyarrow: pip install 'cardan[table]'"
        raise ModuleNotFoundError(hint) from None
    # Opened here, because pyarrow's own message for a missing file names no file.
    with open(path, "rb") as source:
        try:
            file = parquet.ParquetFile(source)
            schema = file.schema_arrow
            for name in names:
                kind = schema.field(_place(name, schema.names)).type
                if not (pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind)):
                    raise ValueError(f"column {name!r} holds {kind}; it must hold numbers")
            table = file.read(columns=list(names))
        except (pyarrow.ArrowException, OSError) as error:
            reason = " ".join(str(error).split())
            raise ValueError(f"not a readable Parquet file: {_short(reason)}") from None
    for name in names:
        if table[name].null_count:
            row = table[name].is_null().index(True).as_py()
            raise ValueError(f"row {row}, counted from 0, column {name!r} is empty")
    return [table[name].to_numpy().astype(np.float64) for name in names]


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
