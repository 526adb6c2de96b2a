"""Columns of any length: from one Parquet file to another, in chunks and bounded memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from numpy.typing import NDArray

from cardan.app.files.recording import read_chunks
from cardan.app.files.whole_file import Progress, whole_file
from cardan.arrays import import_optional
from cardan.evaluation.result import Result

if TYPE_CHECKING:
    from concurrent.futures import Future

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


# --- a second thread that reads ahead and writes behind, in bounded memory ------------------------

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


def write_behind(write: Callable[[_Item], None], items: Iterable[_Item]) -> Generator[_Item]:
    """Yield the items that are written, which a second thread does while the next one is made.

    One item at most is being written. Close the generator to wait for it.
    """
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1, "cardan-write") as thread:
        writing: tuple[Future[None], _Item] | None = None
        for item in items:
            if writing:
                yield _written(*writing)
            writing = thread.submit(write, item), item
        if writing:
            yield _written(*writing)


def _written(writing: Future[None], item: _Item) -> _Item:
    writing.result()
    return item
