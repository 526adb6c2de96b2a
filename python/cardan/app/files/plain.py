"""Columns of large CSV files of plain numbers, which PyArrow reads without the interpreter."""

from __future__ import annotations

import csv
import os
from collections.abc import Generator, Sequence
from os import PathLike
from typing import Any

import numpy as np

from cardan.arrays import FloatArray, import_optional

# Bytes of lines that are read together.
_BLOCK = 1 << 23

# To import PyArrow takes as long as to read so many bytes without it.
_LARGE = 1 << 22


def plain_blocks(
    path: str | PathLike[str], names: Sequence[str], rows: int | None
) -> Generator[list[FloatArray], None, tuple[int, bool]]:
    """Yield columns of some lines at a time, up to the first lines that are not plain numbers.

    Numbers are plain if PyArrow reads them as Python does: digits, a decimal point, an exponent,
    ``nan`` or nothing, without quotes and one per column of the header. What is left is for whoever
    knows what is wrong with it. Without PyArrow, and of small files, nothing is plain. At most
    ``rows`` come at a time, or as many as are read together. Return how many rows were read, and
    whether that is all.
    """
    done = 0
    if os.path.getsize(path) < _LARGE:
        return done, False
    try:
        arrow: Any = import_optional("pyarrow.csv", "table")
        pyarrow: Any = import_optional("pyarrow", "table")
    except ModuleNotFoundError:
        return done, False
    with open(path, "rb") as file:
        header = file.readline().removeprefix(b"\xef\xbb\xbf")
        # Names may be in quotes, but on one line.
        if header.count(b'"') % 2 or not _is_plain(header.replace(b'"', b"")):
            return done, False
        text = header.decode()
        delimiter = max(",;\t", key=text.count)
        known = [name.strip() for name in next(csv.reader([text], delimiter=delimiter))]
        if any(known.count(name) != 1 for name in names):
            return done, False
        places = {name: str(known.index(name)) for name in names}
        wanted = {
            "parse_options": arrow.ParseOptions(delimiter=delimiter, quote_char=False),
            "read_options": arrow.ReadOptions(column_names=[*map(str, range(len(known)))]),
            "convert_options": arrow.ConvertOptions(
                column_types=dict.fromkeys(places.values(), pyarrow.float64()),
                include_columns=[*dict.fromkeys(places.values())],
                null_values=[""],
            ),
        }
        while lines := file.read(_BLOCK) + file.readline():
            if not _is_plain(lines):
                return done, False
            try:
                table = arrow.read_csv(pyarrow.BufferReader(lines), **wanted)
            except pyarrow.ArrowInvalid:
                return done, False
            found = {place: table[place].to_numpy() for place in places.values()}
            if not table.num_rows or any(np.isinf(column).any() for column in found.values()):
                return done, False
            for first in range(0, table.num_rows, rows or table.num_rows):
                part = slice(first, first + (rows or table.num_rows))
                yield [np.asarray(found[places[name]][part], np.float64) for name in names]
            done += table.num_rows
    return done, True


def _is_plain(lines: bytes) -> bool:
    """Whether quotes, letters of other scripts and unusual line ends are absent.

    A parenthesis may follow ``nan`` for PyArrow, but not for Python.
    """
    return (
        lines.isascii()
        and not any(mark in lines for mark in (b'"', b"(", b"\0"))
        and (b"\r" not in lines or lines.count(b"\r") == lines.count(b"\r\n"))
    )
