"""Fuzz the readers of measured files: ``python fuzz/recordings.py [seconds]`` (atheris).

A CSV file is any text. NPZ, Parquet and MDF files are whole ones of which some bytes are changed,
cut off or inserted. A file gives columns of one length or is refused in one line. Read in chunks,
it gives the same bits, or is refused as well.
"""

from __future__ import annotations

import io
import tempfile
import zipfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["cardan"]):
    from cardan.files.recording import read_chunks, read_columns

import asammdf
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from cases import main

# The last one is never there.
NAMES = ("time", "a", "b", "no")
FOLDER = Path(tempfile.mkdtemp())


def whole_files() -> dict[str, bytes]:
    """Return a file of each format with the same three columns."""
    table = {"time": np.arange(40) / 100, "a": np.sin(np.arange(40.0)), "b": np.arange(40)}
    archive, parquet = io.BytesIO(), io.BytesIO()
    np.savez_compressed(archive, **table)
    gaps = pa.array([None if i % 7 == 3 else float(i) for i in range(40)])
    pq.write_table(pa.table({**table, "b": gaps}), parquet, row_group_size=16)
    plain = io.BytesIO()
    with zipfile.ZipFile(plain, "w") as file:
        for name, column in table.items():
            single = io.BytesIO()
            np.save(single, column)
            file.writestr(f"{name}.npy", single.getvalue())
    with asammdf.MDF(version="4.10") as file:
        signals = [
            asammdf.Signal(table[name], timestamps=table["time"], name=name) for name in "ab"
        ]
        file.append(signals, common_timebase=True)
        path = file.save(FOLDER / "whole.mf4", overwrite=True)
    return {
        ".npz": archive.getvalue(),
        ".plain.npz": plain.getvalue(),
        ".parquet": parquet.getvalue(),
        ".mf4": Path(path).read_bytes(),
    }


WHOLE = whole_files()


def case(data: bytes) -> None:
    """Write a file and read it at once and in chunks."""
    given = atheris.FuzzedDataProvider(data)
    kind = given.PickValueInList([".csv", ".csv", *WHOLE])
    names = [name for name in NAMES if given.ConsumeIntInRange(0, 3) < (1 if name == "no" else 3)]
    rows = given.ConsumeIntInRange(1, 50)
    raster = 0.004 if given.ConsumeIntInRange(0, 7) == 0 else None
    if kind == ".csv":
        content = data[-given.remaining_bytes() :] if given.remaining_bytes() else b""
    else:
        content = changed(WHOLE[kind], given)
    path = FOLDER / f"run{kind}"
    path.write_bytes(content)
    try:
        columns = read_columns(path, names or ["a"], raster)
    except (ValueError, OSError, MemoryError) as error:
        assert "\n" not in str(error), repr(str(error))
        assert str(error), repr(error)
        return
    assert len({len(column) for column in columns}) == 1
    assert all(column.dtype == np.float64 and not np.isinf(column).any() for column in columns)
    try:
        parts = [chunk.columns for chunk in read_chunks(path, names or ["a"], rows, raster)]
    except ValueError:
        # Of damaged records those of one chunk alone may be unreadable, and pyarrow checks more
        # of a row group that it reads in pieces.
        assert kind in (".mf4", ".parquet")
        return
    for column, *chunks in zip(columns, *parts, strict=True):
        np.testing.assert_array_equal(np.concatenate(chunks), column)


def changed(content: bytes, given: atheris.FuzzedDataProvider) -> bytes:
    """Return the bytes with a few of them replaced, inserted or left out."""
    for _ in range(given.ConsumeIntInRange(0, 4)):
        at = given.ConsumeIntInRange(0, len(content))
        what = given.ConsumeBytes(given.ConsumeIntInRange(0, 8))
        left_out = given.PickValueInList([0, len(what), len(what), len(content)])
        content = content[:at] + what + content[at + left_out :]
    return content


if __name__ == "__main__":
    np.seterr(all="ignore")
    main("recordings", case, longest=600)
