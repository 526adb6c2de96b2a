"""Spreadsheets: tables of cells from CSV and XLSX files, and XLSX workbooks with whole doubles."""

from __future__ import annotations

import math
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count, zip_longest
from os import PathLike
from pathlib import Path
from typing import IO, Any, TypeAlias

from cardan.app.files.delimited import csv_rows, misfit, number_of, short
from cardan.arrays import import_optional

Cell: TypeAlias = str | float | bool | None
"""Value of a cell of a sheet."""

SHEET_ROWS = 1 << 20
"""Rows of a sheet, its head among them."""

_SHEET_COLUMNS = 1 << 14


# --- reading --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Table:
    """The cells of a CSV file or of a sheet, below their heads.

    Rows without any cell are left out.

    Attributes:
        name: of the file, and of the sheet if it has sheets.
        columns: the cells by head; an empty one is ``None``.
        rows: where each row is, as whoever opens the file finds it.
        delimiter: what separates the cells of a CSV file; "" of a sheet, whose numbers are some.
    """

    name: str
    columns: Mapping[str, Sequence[Any]]
    rows: Sequence[str]
    delimiter: str = ""

    def error(self, head: str, problem: str, row: int | None = None) -> ValueError:
        """Return the error that a column, or its cell in a row, has a problem."""
        return ValueError(f"{self._place(head, row)} {problem}")

    def _place(self, head: str, row: int | None) -> str:
        place = "" if row is None else f"{self.rows[row]}, "
        return f"{self.name}, {place}column {head!r}"

    def texts(self, head: str) -> list[Any]:
        """Return a column as texts, numbers of a sheet as well."""
        return [
            f"{cell:.15g}" if isinstance(cell, int | float) and not isinstance(cell, bool) else cell
            for cell in self.columns[head]
        ]

    def numbers(self, head: str) -> list[Any]:
        """Return a column as numbers; what a sheet has instead of one is left as it is.

        Where cells are separated by semicolons, decimals may have commas.
        """
        if not self.delimiter:
            return list(self.columns[head])
        found: list[float | None] = []
        for row, cell in enumerate(self.columns[head]):
            has_comma = self.delimiter == ";" and re.fullmatch(r"[-+]?\d*,\d+", cell or "")
            try:
                number = number_of(cell.replace(",", ".") if has_comma else cell or "")
            except ValueError as error:
                raise ValueError(f"{self._place(head, row)} {error}") from None
            found.append(None if cell is None else number)
        return found


TABLES = (".csv", ".xlsx")
"""Formats of tables that people write, by suffix."""


def read_table(path: str | PathLike[str], sheet: str | None = None) -> Table:
    """Return the table of a CSV file, or of a sheet of an XLSX file.

    The heads are in the first row. A workbook with one sheet needs no name of it.

    Raises:
        ImportError: openpyxl is missing.
        OSError: the file cannot be read.
        ValueError: it is no such file or has no such sheet, a head is missing or there twice, or a
            formula has no value; one line with file, sheet, row and column.
    """
    name = os.fspath(path)
    if Path(path).suffix == ".xlsx":
        name, filled = _xlsx_rows(path, sheet)
        return _table(name, "row", filled)
    if sheet is not None:
        raise ValueError(f"{name} has no sheets; leave out sheet = {sheet!r}")
    try:
        with csv_rows(path) as (rows, delimiter):
            lines = [(rows.line_num, [cell.strip() or None for cell in row]) for row in rows]
        head = next((cells for _, cells in lines if cells), [])
        for line, cells in lines:
            if cells and len(cells) != len(head):
                raise ValueError(misfit(line, cells, head, delimiter))
    except UnicodeDecodeError as error:
        raise ValueError(f"{name}: not UTF-8 text at byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    return _table(name, "line", lines, delimiter)


def _table(
    name: str, row: str, lines: Iterable[tuple[int, Sequence[Any]]], delimiter: str = ""
) -> Table:
    filled = [(number, cells) for number, cells in lines if any(cell is not None for cell in cells)]
    if not filled:
        raise ValueError(f"{name} is empty; it needs a row of heads and rows below it")
    (top, heads), *below = filled
    if not below:
        raise ValueError(f"{name} has heads but no rows")
    places = [f"{row} {number}" for number, _ in below]
    columns: dict[str, list[Any]] = {}
    for place, (head, *cells) in enumerate(zip_longest(heads, *(cells for _, cells in below)), 1):
        if head is None and all(cell is None for cell in cells):
            continue
        if not isinstance(head, str):
            is_there = "is empty" if head is None else f"is {head!r}"
            raise ValueError(
                f"{name}, {row} {top}: the head of column {place} {is_there}; it must be text"
            )
        if head.strip() in columns:
            raise ValueError(f"{name}, {row} {top}: column {head.strip()!r} is there twice")
        columns[head.strip()] = cells
    return Table(name, columns, places, delimiter)


def _xlsx_rows(
    path: str | PathLike[str], sheet: str | None
) -> tuple[str, list[tuple[int, list[Any]]]]:
    """The name of a sheet with its file, and its rows by number; formulas as their last values."""
    openpyxl = import_optional("openpyxl", "app")
    name = os.fspath(path)
    with open(path, "rb") as file, warnings.catch_warnings():
        # It says what it leaves out: styles, rules for input.
        warnings.simplefilter("ignore")
        try:
            values = openpyxl.load_workbook(file, read_only=True, data_only=True)
            titles = [each.title for each in values.worksheets]
        except Exception as error:  # whatever a damaged part of it causes
            raise _unreadable(name, error) from None
        if sheet is None and len(titles) != 1:
            listed = ", ".join(map(repr, titles))
            raise ValueError(f"{name} has the sheets {short(listed)}; name one with sheet = …")
        if sheet is not None and sheet not in titles:
            listed = ", ".join(map(repr, titles))
            raise ValueError(f"{name} has no sheet {sheet!r}; there are {short(listed)}")
        title = sheet or titles[0]
        try:
            formulas = openpyxl.load_workbook(file, read_only=True)
            pairs = [list(_cells(book[title])) for book in (values, formulas)]
        except Exception as error:  # as above
            raise _unreadable(name, error) from None
    name = f"{name}, sheet {title!r}"
    lines = []
    for number, row, written in zip(count(1), *pairs, strict=False):
        for place, (cell, formula) in enumerate(zip(row, written, strict=True), start=1):
            if cell is None and formula is not None:
                column = openpyxl.utils.get_column_letter(place)
                raise ValueError(
                    f"{name}, cell {column}{number} is the formula {formula!r} without a value; "
                    "open and save the file in a spreadsheet, which computes it"
                )
        lines.append((number, row))
    return name, lines


def _unreadable(name: str, error: Exception) -> ValueError:
    return ValueError(f"{name}: not a readable XLSX file: {short(str(error))}")


def _cells(sheet: Any) -> Iterator[list[Any]]:  # noqa: ANN401 - of openpyxl
    # Some programs write a size of the sheet that is too small.
    sheet.reset_dimensions()
    for row in sheet.iter_rows(values_only=True):
        cells = (cell.strip() if isinstance(cell, str) else cell for cell in row)
        yield [None if cell == "" else cell for cell in cells]


# --- writing --------------------------------------------------------------------------------------


def write_sheets(file: IO[bytes], sheets: Mapping[str, Iterable[Sequence[Cell]]]) -> None:
    """Write a workbook: rows by the name of their sheet, of which the first is the head.

    Numbers are numbers with every digit of the doubles. What is no number is an empty cell, and
    text that begins with ``=`` is no formula. Names that are too long or not permitted are changed.
    """
    openpyxl = import_optional("openpyxl", "app")

    def cell(value: Cell) -> Any:  # noqa: ANN401 - of openpyxl
        """Make a cell of the kind of a value, which openpyxl would guess, with all its digits."""
        if value is None or isinstance(value, bool):
            return value
        if isinstance(value, str):
            text, kind = _written(value), "s"
        elif math.isfinite(value):
            text, kind = repr(value), "n"
        else:
            return None
        made = openpyxl.cell.WriteOnlyCell(sheet, text)
        made.data_type = kind
        return made

    book = openpyxl.Workbook(write_only=True)
    try:
        for title, rows in zip(_titles(sheets), sheets.values(), strict=True):
            sheet = book.create_sheet(title)
            sheet.freeze_panes = "A2"
            sheet.sheet_format.defaultColWidth = 20
            for row in rows:
                if len(row) > _SHEET_COLUMNS:
                    raise ValueError(
                        f"{len(row)} columns are too many for a sheet, which has {_SHEET_COLUMNS}"
                    )
                sheet.append([*map(cell, row)])
        book.save(file)
    except BaseException:
        # Sheets that are left open complain when they are gone.
        for sheet in book.worksheets:
            if not sheet.closed:
                sheet.close()
        raise


def _titles(names: Iterable[str]) -> list[str]:
    """The names as sheets may have them: short, and apart however they are written."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[\[\]:*?/\\']", "_", _written(name)) or "sheet"
        title, number = plain[:_LONGEST], 1
        while title.lower() in map(str.lower, found):
            number += 1
            ending = f" {number}"
            title = plain[: _LONGEST - len(ending)] + ending
        found.append(title)
    return found


_LONGEST = 31
# What XML cannot hold.
_UNWRITTEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def _written(text: str) -> str:
    return _UNWRITTEN.sub(lambda found: repr(found[0])[1:-1], text)
