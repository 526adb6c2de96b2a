"""Columns of numbers from CSV files, of which every row must fit the header; the headings."""

from __future__ import annotations

import csv
import difflib
import math
import os
import re
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from os import PathLike
from typing import Any

import numpy as np

from cardan.arrays import FloatArray, import_optional

# Rows that are read at a time: what takes Python long is to look at each number by itself.
_BLOCK = 4096

_NO_TABLE = "the file is not a table of numbers with headings"


def read_csv(
    path: str | PathLike[str], names: Sequence[str], rows: int | None = None, _: None = None
) -> Iterator[tuple[list[FloatArray], int]]:
    """Yield columns of a CSV file and the number of all rows; an empty cell is NaN.

    At most ``rows`` come at a time, some 4000 read together, or all. The number of all rows is then
    that of the lines until the last piece. A ``ValueError`` says which column is missing, which
    cell is no number or which row does not fit the header.
    """
    lines = 0 if rows is None else _lines(path)

    def blocks() -> Iterator[list[FloatArray]]:
        """Blocks of plain numbers, then those that are looked at cell by cell."""
        read, whole = yield from _plain_blocks(path, names, rows)
        if not whole:
            yield from _blocks(path, names, _BLOCK if rows is None else min(rows, _BLOCK), read)

    held: list[list[FloatArray]] = []
    count = done = 0
    for block in blocks():
        if rows is not None and count + len(block[0]) > rows:
            done += count
            yield _joined(held, names), max(lines, done + 1)
            held, count = [], 0
        held.append(block)
        count += len(block[0])
    yield _joined(held, names), done + count


def _joined(blocks: Sequence[list[FloatArray]], names: Sequence[str]) -> list[FloatArray]:
    if not blocks:
        return [np.empty(0) for _ in names]
    return [np.concatenate(columns) for columns in zip(*blocks, strict=True)]


def _lines(path: str | PathLike[str]) -> int:
    """The line ends of a file."""
    with open(path, "rb") as file:
        parts = iter(lambda: file.read(1 << 20), b"")
        # NumPy counts what occurs often faster than bytes.count.
        return sum(int(np.count_nonzero(np.frombuffer(part, np.uint8) == 10)) for part in parts)


def _blocks(
    path: str | PathLike[str], names: Sequence[str], size: int, done: int
) -> Iterator[list[FloatArray]]:
    """Columns of some rows at a time, after those that have been read."""
    with csv_rows(path) as (rows, delimiter):
        header = [name.strip() for name in next(rows, [])]
        filled = ((rows.line_num, row) for row in rows if row)
        begun = list(islice(filled, 1))
        # What else a file holds, as one of passwords, is not shown.
        kinds = _kinds(begun, header)
        is_table = "number" in kinds
        if not is_table and "word" in kinds:
            begun += islice(filled, 1)
            if "number" in _kinds(begun[1:], header):
                raise ValueError(_second_heading(*begun[0], names, header))
        missing = next((name for name in names if name not in header), None)
        if header and not is_table and missing is not None:
            raise ValueError(f"no column {missing!r}; {_NO_TABLE}")
        places = [place_of_column(name, header) for name in names]
        if done:
            more = done - len(begun)
            next(islice(filled, more, more), None)
            begun = []
        while block := begun + list(islice(filled, max(0, size - len(begun)))):
            begun = []
            found = _fast_numbers([row for _, row in block], places, len(header))
            if found is not None:
                yield found
                continue
            read: list[list[float]] = [[] for _ in names]
            for line, row in block:
                if len(row) != len(header):
                    raise ValueError(misfit(line, row, header, delimiter))
                for name, place, column in zip(names, places, read, strict=True):
                    try:
                        column.append(number_of(row[place]))
                    except ValueError as error:
                        shown = error if is_table else f"is no number; {_NO_TABLE}"
                        raise ValueError(f"line {line}, column {name!r} {shown}") from None
            yield [np.array(column) for column in read]


def _kinds(begun: Sequence[tuple[int, Sequence[str]]], header: Sequence[str]) -> set[str]:
    """Return the kinds of cells in the first row, if it fits the header."""
    return set().union(*(map(_kind, row) for _, row in begun[:1] if len(row) == len(header)))


def _kind(cell: str) -> str:
    """Whether a cell is a number, if in another way of writing, or a word; "" of an empty one."""
    try:
        return "" if math.isnan(number_of(cell)) else "number"
    except ValueError:
        return "number" if _hint(cell) else "word"


def _second_heading(
    line: int, row: Sequence[str], names: Sequence[str], header: Sequence[str]
) -> str:
    """Return the error message for a line of units below the headings."""
    name = next((name for name in names if name in header), header[0])
    place = header.index(name)
    cell = row[place] if place < len(row) else ""
    return (
        f"line {line}, column {name!r} is {cell!r}; it must be a number: remove the second line of "
        "headings, such as units"
    )


def line_of(path: str | PathLike[str], row: int) -> int:
    """Return the line on which a row of a CSV file ends, the first line 1 and the first row 0."""
    with csv_rows(path) as (rows, _):
        next(rows, None)
        next(islice((filled for filled in rows if filled), row, None), None)
        return int(rows.line_num)


@contextmanager
def csv_rows(path: str | PathLike[str]) -> Iterator[tuple[Any, str]]:
    """Open the rows of a file, header first, and say what separates their cells."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        first = file.readline()
        file.seek(0)
        delimiter = max(",;\t", key=first.count)
        rows = csv.reader(file, delimiter=delimiter, skipinitialspace=True)
        try:
            yield rows, delimiter
        except csv.Error as error:
            raise ValueError(f"line {rows.line_num}: not CSV: {error}") from None


def misfit(line: int, row: Sequence[Any], header: Sequence[Any], delimiter: str) -> str:
    """Say that a row has not as many cells as the header."""
    cells = f"{len(row)} cell{'s' if len(row) > 1 else ''}"
    rule = "every row must have as many cells as the header"
    if delimiter == "," and len(row) > len(header):
        rule += ", and numbers a decimal point"
    return f"line {line} has {cells}, the header {len(header)}; {rule}"


def _fast_numbers(
    rows: Sequence[Sequence[str]], places: Sequence[int], width: int
) -> list[FloatArray] | None:
    """Columns of rows in which Python reads each cell as ``number_of`` does; ``None`` of others."""
    if any(len(row) != width for row in rows):
        return None
    read = []
    for cells in ([row[place] for row in rows] for place in places):
        text = "".join(cells)
        if "_" in text or not text.isascii():
            return None
        try:
            read.append(np.array([float(cell or "nan") for cell in cells]))
        except ValueError:
            return None
    return None if any(np.isinf(numbers).any() for numbers in read) else read


def number_of(cell: str) -> float:
    """Return the number of a cell, or NaN; the error says what the cell is instead."""
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


# --- large files of plain numbers, which PyArrow reads without the interpreter -------------------

# Bytes of lines that are read together.
_BYTES = 1 << 23

# To import PyArrow takes as long as to read so many bytes without it.
_LARGE = 1 << 22


def _plain_blocks(
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
        while lines := file.read(_BYTES) + file.readline():
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


def parts_of(total: int, rows: int | None) -> Iterator[slice]:
    """Yield the parts of so many rows, at most so many each, or all; one if there are none."""
    step = rows or max(1, total)
    yield from (slice(first, min(total, first + step)) for first in range(0, max(1, total), step))


# --- headings: which column is wanted, and which was meant ----------------------------------------

_MOST = 300


def place_of_column(name: str, columns: Sequence[str]) -> int:
    """Return the place of a column.

    A ``ValueError`` names the nearest of a name that is missing or not the only one.
    """
    if name not in columns:
        raise ValueError(f"no column {name!r}{_meant(name, columns)}; {_listed(name, columns)}")
    if columns.count(name) > 1:
        raise ValueError(f"column {name!r} appears {columns.count(name)} times")
    return columns.index(name)


def _meant(name: str, columns: Sequence[str]) -> str:
    if name.lower() in map(str.lower, columns):
        close = [column for column in columns if column.lower() == name.lower()]
    else:
        close = difflib.get_close_matches(name, columns, n=1)
    return f"; did you mean {close[0]!r}?" if close else ""


def _listed(name: str, columns: Sequence[str]) -> str:
    if not columns:
        return "the file has none"
    listed = f"the columns are {', '.join(columns)}"
    if len(listed) <= _MOST:
        return short(listed)
    # Of a logger's thousands the first say nothing.
    nearest = difflib.get_close_matches(name, columns, n=5, cutoff=0.0)
    return short(f"the nearest of {len(columns)} columns are {', '.join(nearest)}")


def short(text: str) -> str:
    """Return a text on one line and not long."""
    # A quoted heading may go over several lines.
    text = " ".join(text.splitlines())
    return text if len(text) <= _MOST else f"{text[: _MOST - 3]}..."
