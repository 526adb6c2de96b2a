"""Columns of any length: from one Parquet file to another, in chunks and bounded memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from cardan.arrays import import_optional
from cardan.files.progress import Progress
from cardan.files.recording import read_chunks
from cardan.files.whole_file import whole_file
from cardan.result import Result

ROWS = 1 << 20
"""Rows of a chunk: enough to keep all threads busy, some 100 MB at most scenes."""


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
        target: the Parquet file to write; it appears complete or not at all.
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
    pieces = ((function(*chunk.columns), chunk.total) for chunk in read_chunks(source, names, rows))
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
    done = 0
    writer = None
    pieces = iter(pieces)
    # Before the file is begun, for errors within are taken for its own.
    first = next(pieces)
    with whole_file(target) as file:
        try:
            for piece, total in chain([first], pieces):
                if isinstance(piece, Result):
                    table = piece.to_arrow()
                else:
                    table = pyarrow.table(dict(piece))
                # Doubles that hardly repeat gain nothing from a dictionary.
                writer = writer or parquet.ParquetWriter(file, table.schema, use_dictionary=False)
                writer.write_table(table)
                done += table.num_rows
                if progress:
                    progress(done, total)
        finally:
            if writer:
                writer.close()
    return done
