"""Recorded columns: what is read of every format, and what is said about a file that cannot be."""

from __future__ import annotations

import re
import tempfile
import zipfile
from collections.abc import Generator
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from cardan.app.files import delimited
from cardan.app.files.columns import write_columns
from cardan.app.files.recording import read_chunks, read_columns

ANGLE, BEND = [0.0, 0.5, -1e-3], [5.0, 6.25, 7.0]


@pytest.fixture(params=["cell by cell", "plain"])
def csv_reader(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both readers of CSV files; the one for large files from the first byte on."""
    if request.param == "plain":
        monkeypatch.setattr(delimited, "_LARGE", 0)
        monkeypatch.setattr(delimited, "_BYTES", 4096)


@pytest.mark.usefixtures("csv_reader")
def test_csv(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for text in (
        "angle,bend\n0,5\n0.5,6.25\n-1e-3,7\n",
        "\ufeffangle;bend\r\n0;5\r\n\r\n0.5;6.25\r\n-1e-3;7",
        'name\tbend\t"angle"\nx\t5\t0\ny\t6.25\t0.5\nz\t7\t-0.001\n',
        "angle, bend\n 0, 5\n 0.5, 6.25\n-1e-3, 7\n",
        'angle, "bend"\n0, 5\n0.5, "6.25"\n-1e-3, 7\n',
    ):
        path.write_text(text, encoding="utf-8", newline="")
        angle, bend = read_columns(path, ["angle", "bend"])
        assert (angle.tolist(), bend.tolist()) == (ANGLE, BEND)


def test_npz(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, angle=np.array(ANGLE), count=np.arange(3, dtype=np.int16), other=np.eye(3))
    angle, count = read_columns(str(path), ["angle", "count"])
    assert (angle.tolist(), count.tolist()) == (ANGLE, [0.0, 1.0, 2.0])
    assert count.dtype == np.float64


def test_parquet(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "a.parquet"
    single = pyarrow.array(BEND, pyarrow.float32())
    table = {"text": ["a", "b", "c"], "an angle": ANGLE, "bend": single, "n": [1, 2, 3]}
    parquet.write_table(pyarrow.table(table), path)
    angle, bend, n = read_columns(path, ["an angle", "bend", "n"])
    assert (angle.tolist(), bend.tolist(), n.tolist()) == (ANGLE, BEND, [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "angel,bend\n0,1\n",
            "no column 'angle'; did you mean 'angel'?; the columns are angel, bend",
        ),
        ("x,bend\n0,1\n", "no column 'angle'; the columns are x, bend"),
        ("", "no column 'angle'; the file has none"),
        ('"x\n(deg)",bend\n0,1\n', "no column 'angle'; the columns are x (deg), bend"),
        ("angle,angle,bend\n0,0,1\n", "column 'angle' appears 2 times"),
        ("angle,bend\n", "column 'angle' has no rows"),
        ("angle,bend\n0,1\nabc,2\n", "line 3, column 'angle' is 'abc'; it must be a number"),
        ("angle,bend\n0,1\n\n\n1,x\n", "line 5, column 'bend' is 'x'; it must be a number"),
        (
            "angle,bend\n0,1\n0\n",
            "line 3 has 1 cell, the header 2; every row must have as many cells as the header",
        ),
        (
            "angle,bend\n0;1\n",
            "line 2 has 1 cell, the header 2; every row must have as many cells as the header",
        ),
        (
            "angle,bend\n1,5,7,5\n",
            "line 2 has 4 cells, the header 2; every row must have as many cells as the header, "
            "and numbers a decimal point",
        ),
        (
            "angle;bend\n0;1;\n",
            "line 2 has 3 cells, the header 2; every row must have as many cells as the header",
        ),
        (
            "angle,bend\n0,1_000\n",
            "line 2, column 'bend' is '1_000'; it must be a number, without underscores",
        ),
        ("angle,bend\n0,\u0661\n", "line 2, column 'bend' is '\u0661'; it must be a number"),
        ("angle,bend\n0,  \n1,nan\n", "column 'bend' has no numbers, only empty cells or NaN"),
        ("angle,bend\n-inf,0\n", "line 2, column 'angle' is -inf; it must be finite"),
        (
            "angle;bend\n1,5;2\n",
            "line 2, column 'angle' is '1,5'; it must be a number, with a decimal point",
        ),
        (
            "angle;bend\n2;+1,5 \n",
            "line 2, column 'bend' is '+1,5 '; it must be a number, with a decimal point",
        ),
        ("angle;bend\n1,5,2;2\n", "line 2, column 'angle' is '1,5,2'; it must be a number"),
        ("angle;bend\nX1,5;2\n", "line 2, column 'angle' is 'X1,5'; it must be a number"),
        ("angle;bend\n1,x;2\n", "line 2, column 'angle' is '1,x'; it must be a number"),
        (
            f"angle,bend\n{'x' * 40},0\n",
            f"line 2, column 'angle' is '{'x' * 40}'; it must be a number",
        ),
        (
            f"angle,bend\n{'x' * 41},0\n",
            f"line 2, column 'angle' is '{'x' * 37}...'; it must be a number",
        ),
        (
            f"{'x' * 284},bend\n0,1\n",
            f"no column 'angle'; the nearest of 2 columns are bend, {'x' * 262}...",
        ),
        (
            f"{'x' * 278},bend\n0,1\n",
            f"no column 'angle'; the columns are {'x' * 278}, bend",
        ),
        (
            f"{'x' * 279},bend\n0,1\n",
            f"no column 'angle'; the nearest of 2 columns are bend, {'x' * 262}...",
        ),
        (
            f"angle,bend\n{'x' * 100},0\n",
            f"line 2, column 'angle' is '{'x' * 37}...'; it must be a number",
        ),
        ("angle,bend\n" + "1" * 200_000 + ",0\n", "line 2: not CSV: field larger than field limit"),
    ],
)
@pytest.mark.usefixtures("csv_reader")
def test_csv_messages(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"a\.csv") as caught:
        read_columns(path, ["angle", "bend"])
    assert str(caught.value).startswith(f"{path}: {message}")
    if "limit" not in message:
        assert str(caught.value) == f"{path}: {message}"


@pytest.mark.parametrize("row", [0, 1, 4096, 4097, 9999])
@pytest.mark.parametrize(
    ("cells", "read"),
    [
        ("1e3,2", [1e3, 2.0]),
        (",2", [np.nan, 2.0]),
        (" ,\t", [np.nan, np.nan]),
        ("nan,NaN", [np.nan, np.nan]),
        ("1_0,2", "column 'angle' is '1_0'; it must be a number, without underscores"),
        ("1,x", "column 'bend' is 'x'; it must be a number"),
        ("1,-inf", "column 'bend' is -inf; it must be finite"),
        ("1,٣", "column 'bend' is '٣'; it must be a number"),
        ("1", "has 1 cell, the header 2; every row must have as many cells as the header"),
        ("1,2,3", "has 3 cells, the header 2; every row must have as many cells as the header"),
    ],
)
@pytest.mark.usefixtures("csv_reader")
def test_long_csv(tmp_path: Path, row: int, cells: str, read: list[float] | str) -> None:
    """A cell is read alike wherever it is, and the first wrong one is named."""
    path = tmp_path / "a.csv"
    lines = ["angle,bend", *(f"{i},{-i}" for i in range(10_000))]
    lines[row + 1] = cells
    if isinstance(read, str):
        lines += ["later", "later,later"]
    path.write_text("\n".join(lines), encoding="utf-8")
    if isinstance(read, str):
        with pytest.raises(ValueError, match=rf"a\.csv: line {row + 2}[, ].*{re.escape(read)}"):
            read_columns(path, ["angle", "bend"])
        return
    want = np.arange(10_000.0)[:, np.newaxis] * [1, -1]
    want[row] = read
    np.testing.assert_array_equal(np.stack(read_columns(path, ["angle", "bend"]), -1), want)


@pytest.mark.parametrize("rows", [None, 100, 5000])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_plain_numbers_have_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rows: int | None, end: str, mark: str
) -> None:
    """Those that PyArrow reads are those of Python's ``float``."""
    rng = np.random.default_rng(3)
    numbers = rng.normal(size=(4000, 2)) * 10.0 ** rng.integers(-320, 300, (4000, 2))
    numbers[5, 0] = np.nan
    texts = [[f"{a!r}", "text", f"{b:.25e}"] for a, b in numbers.tolist()]
    texts[7][2] = ""
    path = tmp_path / "a.csv"
    lines = [mark.join(('"a"', "words", " b ")), *map(mark.join, texts)]
    path.write_bytes(f"{end.join(lines)}{end}".encode())
    monkeypatch.setattr(delimited, "_LARGE", 0)
    monkeypatch.setattr(delimited, "_BYTES", 4096)
    found = [chunk.columns for chunk in read_chunks(path, ["b", "a", "b"], rows)]
    b, a, again = map(np.concatenate, zip(*found, strict=True))
    np.testing.assert_array_equal(a, [float(text[0]) for text in texts])
    np.testing.assert_array_equal(b, [float(text[2] or "nan") for text in texts])
    np.testing.assert_array_equal(again, b)
    assert max(len(columns[0]) for columns in found) <= (rows or 4000)
    done, whole = 0, False

    def count() -> Generator[Any]:
        nonlocal done, whole
        done, whole = yield from delimited._plain_blocks(path, ["a"], rows)

    assert len(list(count())) > 1
    assert (done, whole) == (4000, True)


@pytest.mark.parametrize("odd", ["nan(1),2", '"1",2', "1,2\r3,4", "1,inf", "1,1e999"])
def test_what_pyarrow_reads_otherwise_is_not_plain(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, odd: str
) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"a,b\n" + b"1,2\n" * 5000 + odd.encode() + b"\n" + b"3,4\n" * 5000)
    monkeypatch.setattr(delimited, "_LARGE", 0)
    monkeypatch.setattr(delimited, "_BYTES", 4096)
    blocks = list(delimited._plain_blocks(path, ["a", "b"], None))
    assert 0 < sum(len(block[0]) for block in blocks) <= 5000


def test_decimal_commas_in_a_single_column(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a\n1,5\n2,5\n")
    with pytest.raises(ValueError, match=r"a\.csv: line 2 has 2 cells, the header 1; .* decimal"):
        read_columns(path, ["a"])


@pytest.mark.parametrize(
    ("text", "name", "message"),
    [
        ("root:x:0:0\nme:x:1:1\n", "a", "no column 'a'; the file is not a table of"),
        ("root,x,0\n", "a", "no column 'a'; the file is not a table of"),
        ("root,x,0\nsecret,s\n", "a", "no column 'a'; the file is not a table of"),
        ("-- KEY --\nsecret\n", "-- KEY --", "line 2, column '-- KEY --' is no number; the file"),
    ],
)
def test_what_is_no_table_is_not_shown(tmp_path: Path, text: str, name: str, message: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"a\.csv") as caught:
        read_columns(path, [name])
    assert str(caught.value).startswith(f"{path}: {message}")
    problem = str(caught.value).removeprefix(str(path))
    assert "root" not in problem
    assert "secret" not in problem


def test_missing_samples_keep_their_place(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("angle,bend\n0,\nNaN,1\n  ,2\n3,4\n")
    angle, bend = read_columns(path, ["angle", "bend"])
    np.testing.assert_array_equal(angle, [0.0, np.nan, np.nan, 3.0])
    np.testing.assert_array_equal(bend, [np.nan, 1.0, 2.0, 4.0])
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "a.parquet"
    parquet.write_table(pyarrow.table({"a": [1.0, None, np.nan], "n": [1, None, 3]}), path)
    angle, count = read_columns(path, ["a", "n"])
    np.testing.assert_array_equal(angle, [1.0, np.nan, np.nan])
    np.testing.assert_array_equal(count, [1.0, np.nan, 3.0])


def test_many_columns_name_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    names = [f"channel {i}" for i in range(500)] + ["crank angle"]
    path.write_text(",".join(names) + "\n" + ",".join("0" * len(names)) + "\n")
    with pytest.raises(ValueError, match="the nearest of 501 columns are crank angle, "):
        read_columns(path, ["angle"])
    with pytest.raises(ValueError, match="; did you mean 'crank angle'"):
        read_columns(path, ["CRANK ANGLE"])


def test_csv_that_is_not_text(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"angle,bend\n0,\xff\n")
    with pytest.raises(ValueError, match=r"a\.csv: not UTF-8 text at byte 13$"):
        read_columns(path, ["angle", "bend"])


def test_npz_messages(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"

    def refused(message: str) -> None:
        with pytest.raises(ValueError, match=message):
            read_columns(path, ["angle", "bend"])

    path.write_bytes(b"angle,bend\n")
    refused(r"a\.npz: ")
    path.write_bytes(b"")
    refused(r"a\.npz: not a readable NPZ file")
    np.savez(path, angle=np.zeros(3), bond=np.zeros(3))
    whole = path.read_bytes()
    refused(r"a\.npz: no column 'bend'; did you mean 'bond'\?; the columns are angle, bond$")
    path.write_bytes(whole[: len(whole) // 2])
    refused(r"a\.npz: not a readable NPZ file")
    np.savez(path, angle=np.zeros(3), bend=np.zeros(4))
    refused(r"a\.npz: column 'bend' has 4 rows, 'angle' has 3$")
    np.savez(path, angle=np.zeros((3, 1)), bend=np.zeros(3))
    refused(r"column 'angle' has shape \(3, 1\) and dtype float64; it must hold numbers in one")
    np.savez(path, angle=np.array(["a"]), bend=np.zeros(1))
    refused(r"column 'angle' has shape \(1,\) and dtype <U1")
    np.savez(path, angle=np.array([0.0, np.inf]), bend=np.zeros(2))
    refused(r"row 2, counted from 1, column 'angle' is inf; it must be finite$")
    np.savez(path, angle=np.array([0.0, 1.0]), bend=np.full(2, np.nan))
    refused(r"column 'bend' has no numbers, only empty cells or NaN$")
    np.savez(path, angle=np.array([{}]), bend=np.zeros(1))
    refused(r"a\.npz: column 'angle' holds objects; it must hold numbers$")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("secret.txt", "secret")
    refused(r"a\.npz: a ZIP file, but not one of arrays; np\.savez writes one$")
    with open(path, "wb") as file:
        np.save(file, np.zeros(3))
    refused(r"a\.npz: one array without a name; a column needs one, as np\.savez gives it$")


def test_parquet_messages(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "a.parquet"

    def refused(message: str) -> None:
        with pytest.raises(ValueError, match=message) as caught:
            read_columns(path, ["angle", "bend"])
        assert "\n" not in str(caught.value)

    parquet.write_table(pyarrow.table({"angle": ANGLE, "bend": BEND}), path)
    whole = path.read_bytes()
    for length in (0, 3, 40, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        refused(r"a\.parquet: not a readable Parquet file: ")
    parquet.write_table(pyarrow.table({"angle": ["a"], "bend": [1.0]}), path)
    refused(r"a\.parquet: column 'angle' holds string; it must hold numbers$")
    parquet.write_table(pyarrow.table({"angle": [1.0, None, -np.inf], "bend": [1.0] * 3}), path)
    refused(r"a\.parquet: row 3, counted from 1, column 'angle' is -inf; it must be finite$")
    parquet.write_table(pyarrow.table({"a": [1.0]}), path)
    refused(r"a\.parquet: no column 'angle'; the columns are a$")


def test_other_files(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\.xls must end in \.csv or \.npz or \.parquet"):
        read_columns(tmp_path / "a.xls", ["angle"])
    for suffix in ("csv", "npz", "parquet"):
        with pytest.raises(FileNotFoundError) as caught:
            read_columns(tmp_path / f"a.{suffix}", ["angle"])
        assert Path(caught.value.filename) == tmp_path / f"a.{suffix}"


@pytest.mark.usefixtures("csv_reader")
@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_pieces_know_how_many_rows_there_are(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    if suffix == ".csv":
        path.write_text("angle\n" + "1.5\n" * 3000)
    else:
        np.savez(path, angle=np.full(3000, 1.5))
    totals = [chunk.total for chunk in read_chunks(path, ["angle"], 1000)]
    # The heading is a line as well, until it is known that there is one.
    assert totals[-1] == 3000
    assert all(total in (3000, 3001) for total in totals)
    assert [chunk.total for chunk in read_chunks(path, ["angle"], None)] == [3000]


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
