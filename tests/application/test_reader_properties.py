"""Whatever columns are recorded: every format gives the same doubles, in chunks of any length."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from cardan.app.files.columns import write_columns
from cardan.app.files.recording import read_chunks, read_columns

asammdf = pytest.importorskip("asammdf")
pytest.importorskip("pyarrow")

NAMES = ["time", "a", "b"]
values = st.one_of(st.floats(allow_infinity=False), st.integers(-1000, 1000).map(float))


@st.composite
def tables(draw: st.DrawFn) -> dict[str, Any]:
    """Times that increase, and two columns with a number at least."""
    rows = draw(st.integers(1, 60))
    table = {"time": np.arange(rows) / 128.0}
    for name in NAMES[1:]:
        column = np.array(draw(st.lists(values, min_size=rows, max_size=rows)))
        column[draw(st.integers(0, rows - 1))] = 1.5
        table[name] = column
    return table


def written(table: dict[str, Any], path: Path) -> None:
    """Write by the package, and MDF, which it only reads, by asammdf."""
    if path.suffix != ".mf4":
        write_columns(path, table)
        return
    with asammdf.MDF(version="4.10") as file:
        file.append(
            [
                asammdf.Signal(table[name], timestamps=table["time"], name=name)
                for name in NAMES[1:]
            ],
            common_timebase=True,
        )
        file.save(path, overwrite=True)


@settings(max_examples=15)
@given(tables(), st.integers(1, 70), st.permutations(NAMES))
@pytest.mark.parametrize("suffix", [".csv", ".npz", ".parquet", ".mf4"])
def test_columns_come_back(suffix: str, table: dict[str, Any], rows: int, names: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"run{suffix}")
        written(table, path)
        whole = read_columns(path, names)
        chunks = list(read_chunks(path, names, rows))
    assert [chunk.first for chunk in chunks] == list(range(0, len(table["time"]), rows))
    for number, name in enumerate(names):
        np.testing.assert_array_equal(whole[number], table[name])
        parts = [chunk.columns[number] for chunk in chunks]
        assert max(map(len, parts)) <= rows
        np.testing.assert_array_equal(np.concatenate(parts), table[name])
