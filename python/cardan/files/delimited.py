"""Columns of numbers from CSV files, of which every row must fit the header."""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from os import PathLike
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.files.headings import place_of_column

# Rows that are read at a time: what takes Python long is to look at each number by itself.
_BLOCK = 4096

_NO_TABLE = "the file is not a table of numbers with headings"


def read_csv(path: str | PathLike[str], names: Sequence[str]) -> list[FloatArray]:
    """Return columns of a CSV file; an empty cell is NaN.

    Raises:
        OSError: the file cannot be read.
        ValueError: a column that is missing, a cell that is no number, a row that does not fit the
            header, a file that is not a table.
    """
    with _rows(path) as (rows, delimiter):
        header = [name.strip() for name in next(rows, [])]
        read = [array("d") for _ in names]
        filled = ((rows.line_num, row) for row in rows if row)
        begun = list(islice(filled, 1))
        # What else a file holds, as one of passwords, is not shown.
        is_table = any(len(row) == len(header) and any(map(_is_number, row)) for _, row in begun)
        if header and not is_table and not set(names) <= set(header):
            raise ValueError(f"no column {_first_missing(names, header)!r}; {_NO_TABLE}")
        places = [place_of_column(name, header) for name in names]
        while block := begun + list(islice(filled, _BLOCK)):
            begun = []
            found = _fast_numbers([row for _, row in block], places, len(header))
            if found is not None:
                for numbers, column in zip(found, read, strict=True):
                    column.extend(numbers)
                continue
            for line, row in block:
                if len(row) != len(header):
                    raise ValueError(_misfit(line, row, header, delimiter))
                for name, place, column in zip(names, places, read, strict=True):
                    try:
                        column.append(_number(row[place]))
                    except ValueError as error:
                        shown = error if is_table else f"is no number; {_NO_TABLE}"
                        raise ValueError(f"line {line}, column {name!r} {shown}") from None
    return [np.array(column, dtype=np.float64) for column in read]


def line_of(path: str | PathLike[str], row: int) -> int:
    """Return the line on which a row of a CSV file ends, the first line 1 and the first row 0."""
    with _rows(path) as (rows, _):
        next(rows, None)
        next(islice((filled for filled in rows if filled), row, None), None)
        return int(rows.line_num)


@contextmanager
def _rows(path: str | PathLike[str]) -> Iterator[tuple[Any, str]]:
    """The rows of a file, header first, and what separates their cells."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        first = file.readline()
        file.seek(0)
        delimiter = max(",;\t", key=first.count)
        rows = csv.reader(file, delimiter=delimiter, skipinitialspace=True)
        try:
            yield rows, delimiter
        except csv.Error as error:
            raise ValueError(f"line {rows.line_num}: not CSV: {error}") from None


def _first_missing(names: Sequence[str], header: Sequence[str]) -> str:
    return next(name for name in names if name not in header)


def _misfit(line: int, row: Sequence[str], header: Sequence[str], delimiter: str) -> str:
    cells = f"{len(row)} cell{'s' if len(row) > 1 else ''}"
    rule = "every row must have as many cells as the header"
    if delimiter == "," and len(row) > len(header):
        rule += ", and numbers a decimal point"
    return f"line {line} has {cells}, the header {len(header)}; {rule}"


def _fast_numbers(
    rows: Sequence[Sequence[str]], places: Sequence[int], width: int
) -> list[array[float]] | None:
    """Columns of rows in which Python reads each cell as ``_number`` does; ``None`` of others."""
    if any(len(row) != width for row in rows):
        return None
    read = []
    for place in places:
        cells = [row[place] for row in rows]
        text = "".join(cells)
        if "_" in text or not text.isascii():
            return None
        try:
            numbers = array("d", [float(cell or "nan") for cell in cells])
        except ValueError:
            return None
        if np.isinf(numbers).any():
            return None
        read.append(numbers)
    return read


def _number(cell: str) -> float:
    """The number of a cell, or NaN; the error says what the cell is instead."""
    if not cell or cell.isspace():
        return math.nan
    number: float | None = None
    # Python takes 1_000 for 1000, and digits of any script.
    if "_" not in cell and cell.isascii():
        with suppress(ValueError):
            number = float(cell)
    if number is None:
        text = cell if len(cell) <= 40 else f"{cell[:37]}..."
        raise ValueError(f"is {text!r}; it must be a number{_hint(cell)}")
    if math.isinf(number):
        raise ValueError(f"is {number}; it must be finite")
    return number


def _hint(cell: str) -> str:
    if re.fullmatch(r"\s*[+-]?[0-9]+,[0-9]+\s*", cell):
        return ", with a decimal point"
    return ", without underscores" if re.fullmatch(r"\s*[+-]?[0-9_.]+\s*", cell) else ""


def _is_number(cell: str) -> bool:
    try:
        return not math.isnan(_number(cell))
    except ValueError:
        return bool(_hint(cell))
