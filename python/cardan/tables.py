"""Columns of any length: from one Parquet file into another, by chunks in bounded memory."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from cardan.arrays import module
from cardan.curves import columns, whole_file
from cardan.recording import read_chunks
from cardan.result import Result
from cardan.scene import Scene, SceneResult
from cardan.study import Progress

ROWS = 1 << 20
"""Rows of a chunk: enough to keep all threads busy, some 100 MB at most scenes."""


def through(
    source: str | PathLike[str],
    target: str | PathLike[str],
    names: Sequence[str],
    function: Callable[..., Mapping[str, NDArray[Any]]],
    *,
    rows: int = ROWS,
    progress: Progress | None = None,
) -> int:
    """Write what a function makes of the columns of a Parquet file, and return the rows.

    Args:
        source: the file to read.
        target: the file to write, likewise Parquet; it appears whole or not at all.
        names: the columns wanted, of finite numbers.
        function: takes an array for each of these, of some rows, and returns arrays as long by
            name, or a ``Result``, written as by its ``to_arrow``. A plan for a column of angles in
            rad is such a function.
        rows: at most so many at a time.
        progress: called after each chunk with the rows done and all rows.

    Raises:
        ImportError: pyarrow is missing.
        OSError: a file cannot be read or written.
        ValueError: as for ``recording.read_columns``; a file that is not Parquet.
    """
    pieces = ((function(*chunk.columns), chunk.total) for chunk in read_chunks(source, names, rows))
    return _write(target, pieces, progress)


def stream(
    scene: str | PathLike[str],
    into: str | PathLike[str] = ".",
    *,
    radians: bool = False,
    rows: int = ROWS,
    progress: Progress | None = None,
) -> tuple[Path, int]:
    """Write the curves of a scene with recorded angles, whose files may be of any length.

    The file has the rows and columns that ``cardan run`` writes, to the same bits; only where bends
    are recorded too, the steepest of those in a chunk decide on its inverse tangent, which may move
    last digits.

    Args:
        scene: a scene file with ``[angles]`` from a Parquet file and ``curves`` into one.
        into: folder for the curves.
        radians: whether angles are written in radians.
        rows: at most so many at a time.
        progress: called after each chunk with the rows done and all rows.

    Returns:
        the file written and its rows.

    Raises:
        ImportError: pyarrow is missing.
        OSError: a file cannot be read or written.
        ValueError: as for ``Scene.load``; keys of the scene that need all samples at once.
    """
    parts = Scene.parts(scene, rows)
    first, total = next(parts)
    assert first.curves_file
    path = Path(into) / first.curves_file
    if first.recording and path.exists() and path.samefile(first.recording):
        raise ValueError(f"{path} is the recording that the scene reads; it would be overwritten")

    def pieces() -> Iterable[tuple[Mapping[str, NDArray[Any]], int]]:
        yield curves(first), total
        for part, _ in parts:
            yield curves(part), total

    def curves(part: Scene) -> Mapping[str, NDArray[Any]]:
        return columns(SceneResult(part, part.evaluate()), radians=radians)

    return path, _write(path, pieces(), progress)


def _write(
    target: str | PathLike[str],
    pieces: Iterable[tuple[Mapping[str, NDArray[Any]], int]],
    progress: Progress | None,
) -> int:
    """Write pieces of a table, each with the rows of the whole, and return the rows."""
    if Path(target).suffix != ".parquet":
        raise ValueError(f"{os.fspath(target)} must end in .parquet")
    pyarrow, parquet = module("pyarrow", "table"), module("pyarrow.parquet", "table")
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
