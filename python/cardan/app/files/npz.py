"""Columns of NPZ files, the archives of NumPy."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator, Sequence
from os import PathLike
from typing import IO, Any

import numpy as np

from cardan.app.files.headings import place_of_column
from cardan.arrays import FloatArray

# A RuntimeError is a flag of the archive that asks for what it does not have, as a password.
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError)


def read_npz(
    path: str | PathLike[str], names: Sequence[str], rows: int | None
) -> Iterator[tuple[list[FloatArray], int]]:
    """Yield columns of some rows, and the number of all rows.

    Args:
        path: the file.
        names: of the columns.
        rows: how many at once; ``None`` for all.
    """
    with open(path, "rb") as source:
        try:
            _check_archive(source)
            with np.load(source, allow_pickle=False) as file:
                for name in names:
                    place_of_column(name, file.files)
                read = [_array(file, name) for name in names]
        except _DAMAGED as error:
            raise ValueError(f"not a readable NPZ file: {error}") from None
    for name, column in zip(names, read, strict=True):
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise ValueError(
                f"column {name!r} has shape {column.shape} and dtype {column.dtype}; "
                "it must hold numbers in one dimension"
            )
    total = max(map(len, read))
    step = rows or max(1, total)
    for first in range(0, max(1, total), step):
        part = slice(first, first + step)
        yield [column[part].astype(np.float64) for column in read], total


def _check_archive(source: IO[bytes]) -> None:
    """Refuse what is no archive of arrays before NumPy takes it for a pickle."""
    if source.read(6) == b"\x93NUMPY":
        raise ValueError("one array without a name; a column needs one, as np.savez gives it")
    if not zipfile.is_zipfile(source):
        raise ValueError("not a readable NPZ file; np.savez writes one")
    with zipfile.ZipFile(source) as archive:
        # Whatever else an archive holds is none of a message's business.
        if not all(name.endswith(".npy") for name in archive.namelist()):
            raise ValueError("a ZIP file, but not one of arrays; np.savez writes one")
    source.seek(0)


def _array(file: Any, name: str) -> Any:  # noqa: ANN401 - an open NPZ file and an array of it
    try:
        return file[name]
    except _DAMAGED:
        raise
    except ValueError:
        # NumPy would advise to read pickles, which may run anything.
        raise ValueError(f"column {name!r} holds objects; it must hold numbers") from None
