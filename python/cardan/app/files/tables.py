"""Columns of any length: from one Parquet file to another, in chunks and bounded memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from cardan.app.files.ahead import read_ahead, write_behind
from cardan.app.files.progress import Progress
from cardan.app.files.recording import read_chunks
from cardan.app.files.whole_file import whole_file
from cardan.arrays import import_optional
from cardan.evaluation.result import Result

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
    # Before the file is begun, for errors within are taken for its own.
    first = next(tables)
    done = 0
    with (
        whole_file(target) as file,
        # Doubles that hardly repeat gain nothing from a dictionary and little from compression.
        parquet.ParquetWriter(
            file, first[0].schema, use_dictionary=False, compression="none"
        ) as writer,
        closing(
            write_behind(lambda piece: writer.write_table(piece[0]), chain([first], tables))
        ) as written,
    ):
        for table, total in written:
            done += table.num_rows
            if progress:
                progress(done, total)
    return done
