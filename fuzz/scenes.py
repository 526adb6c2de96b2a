"""Scene files, what commands answer to them, and measured files (atheris).

A scene is an example, perhaps with a section of another one, of which some values are replaced or
left out. Every command gives an answer that is JSON, or refuses the scene in one line with exit
status 2. Of a whole file of each format some bytes are changed: it is read, in pieces as well with
the same bits, or is refused in one line.
"""

from __future__ import annotations

import copy
import io
import json
import shutil
import sys
import tempfile
import tomllib
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    from cardan import Scene
    from cardan.app.command import commands
    from cardan.app.files.recording import read_chunks, read_columns

import asammdf
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

ROOT = Path(__file__).parent.parent
EXAMPLES = ROOT / "examples"
PATHS = [*EXAMPLES.glob("*.toml"), *ROOT.glob("python/cardan/app/scene/**/*.toml")]
TEXTS = [path.read_bytes() for path in sorted(PATHS)]
# Pictures take long and are not what is answered.
SCENES = [tomllib.loads(text.decode()) | {"output": {}} for text in TEXTS]
PARTS = [part for scene in SCENES for part in scene.values() if isinstance(part, dict)]
KEYS = ["", *sorted({key for part in PARTS for key in part})]
COMMANDS = ["check", "phase", "optimise", "tolerances", "life", "torsion", "lateral", "run"]
# Studies and searches as short as they are still something.
SHORT = {"steps": 3, "samples": 50, "samples_per_turn": 36, "starts": 1, "turns": 1}
NUMBERS = [0, -1, 1, 0.5, 1e-9, 89.999, 90, 1e300, float("nan"), float("inf"), 7]
OTHERS = ["", "free", True, [], {}, [[1, 2], [3]], "rest"]
# What matters in files: decimal commas, quotes, ends of lines, sections and values.
TOKENS = [b",", b";", b'"', b"\r\n", b"\n\n", b"\xef\xbb\xbf", b"nan", b" = [", b"1e308", b"[a]\n"]
# The same for all inputs: click keeps each stream that it wrote to.
STREAMS = [io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2)]
FOLDER = Path(tempfile.mkdtemp())
for recording in EXAMPLES.glob("*.csv"):
    shutil.copy(recording, FOLDER)


def recordings() -> dict[str, bytes]:
    """Return a file of each format with the same three columns."""
    table = {"time": np.arange(40) / 100, "a": np.sin(np.arange(40.0)), "b": np.arange(40)}
    text, packed, plain, parquet = (io.BytesIO() for _ in range(4))
    np.savetxt(text, np.stack([*table.values()], 1), "%.17g", ",", header="time,a,b", comments="")
    np.savez_compressed(packed, **table)
    np.savez(plain, **table)
    gaps = pa.array([None if i % 7 == 3 else float(i) for i in range(40)])
    pq.write_table(pa.table({**table, "b": gaps}), parquet, row_group_size=16)
    with asammdf.MDF(version="4.10") as file:
        signals = [asammdf.Signal(table[name], table["time"], name=name) for name in "ab"]
        file.append(signals, common_timebase=True)
        path = file.save(FOLDER / "whole.mf4", overwrite=True)
    buffers = {".csv": text, ".npz": packed, ".plain.npz": plain, ".parquet": parquet}
    return {end: buffer.getvalue() for end, buffer in buffers.items()} | {
        ".mf4": Path(path).read_bytes()
    }


RECORDINGS = recordings()


def case(data: bytes) -> None:
    """Ask one command about one scene, or read one file."""
    given = atheris.FuzzedDataProvider(data)
    # One command takes as long as many files.
    given.PickValueInList([text_of] * 4 + [columns_of] * 4 + [answer])(given)


def text_of(given: atheris.FuzzedDataProvider) -> None:
    """Read the text of a scene, and plan what it describes."""
    text = changed(given.PickValueInList(TEXTS), given).decode("utf-8", "replace")
    try:
        Scene.parse(text, "a.toml", FOLDER).plan()
    except (ValueError, OSError) as error:
        refused(error)


def columns_of(given: atheris.FuzzedDataProvider) -> None:
    """Write a recording and read it at once and in pieces."""
    end = given.PickValueInList([".csv", ".csv", *RECORDINGS])
    names = [name for name in ("time", "a", "b") if given.ConsumeIntInRange(0, 3)] or ["a"]
    names += ["no"] * (given.ConsumeIntInRange(0, 15) == 1)
    raster = 0.004 if given.ConsumeIntInRange(0, 7) == 1 else None
    rows = given.ConsumeIntInRange(1, 50)
    path = FOLDER / f"run{end}"
    path.write_bytes(changed(RECORDINGS[end], given))
    try:
        columns = read_columns(path, names, raster)
    except (ValueError, OSError, MemoryError) as error:
        refused(error)
        return
    assert len({len(column) for column in columns}) == 1
    assert all(column.dtype == np.float64 and not np.isinf(column).any() for column in columns)
    try:
        pieces = [chunk.columns for chunk in read_chunks(path, names, rows, raster)]
    except ValueError:
        # Of damaged records those of one chunk alone may be unreadable, and pyarrow checks more
        # of a row group that it reads in pieces.
        assert end in (".mf4", ".parquet")
        return
    for column, *parts in zip(columns, *pieces, strict=True):
        np.testing.assert_array_equal(np.concatenate(parts), column)


def changed(content: bytes, given: atheris.FuzzedDataProvider) -> bytes:
    """Return the bytes with a few of them replaced, inserted or left out."""
    for _ in range(given.ConsumeIntInRange(0, 4)):
        at = given.ConsumeIntInRange(0, len(content))
        words = [*TOKENS, *(key.encode() for key in KEYS)]
        what = given.PickValueInList([*words, given.ConsumeBytes(given.ConsumeIntInRange(0, 8))])
        left_out = given.PickValueInList([0, len(what), len(what), len(content)])
        content = content[:at] + what + content[at + left_out :]
    return content


def refused(error: Exception) -> None:
    """Hold the refusal to one line that says something."""
    assert str(error), repr(error)
    assert "\n" not in str(error), repr(str(error))


def answer(given: atheris.FuzzedDataProvider) -> None:
    """Ask one command about one scene."""
    scene = copy.deepcopy(given.PickValueInList(SCENES))
    for _ in range(given.ConsumeIntInRange(0, 2)):
        other = given.PickValueInList(SCENES)
        name = given.PickValueInList(sorted(other))
        scene[name] = copy.deepcopy(other[name])
    for _ in range(given.ConsumeIntInRange(0, 3)):
        change(scene, given)
    shorten(scene)
    text = "".join(f"{json.dumps(name)} = {toml(part)}\n" for name, part in scene.items())
    path = FOLDER / "scene.toml"
    path.write_text(text)
    command = given.PickValueInList(COMMANDS)
    options = {"run": ["--into", str(FOLDER)], "optimise": ["--to", str(FOLDER / "best.toml")]}
    arguments = [command, str(path), "--json", *options.get(command, [])]
    try:
        with redirect_stdout(STREAMS[0]), redirect_stderr(STREAMS[1]):
            commands().main(arguments, "cardan")
    except SystemExit as end:
        status = end.code
    except Exception as error:
        raise AssertionError(f"{arguments}\n{text}") from error
    stdout, stderr = map(taken, STREAMS)
    if status == 2:
        assert not stdout, (text, stdout)
        assert stderr.startswith("cardan: "), (text, stderr)
        assert stderr.count("\n") == 1, (text, stderr)
        return
    assert status in (0, 1), (status, text)
    json.loads(stdout, parse_constant=no_json)


def taken(stream: io.TextIOWrapper[io.BytesIO]) -> str:
    """Return what was written to a stream, and empty it."""
    written = stream.buffer.getvalue().decode()
    stream.seek(0)
    stream.truncate()
    return written


def no_json(constant: str) -> None:
    """Refuse what JSON does not have."""
    raise AssertionError(f"{constant} is not JSON")


def change(scene: dict[str, Any], given: atheris.FuzzedDataProvider) -> None:
    """Replace, add or leave out one value somewhere."""
    at: Any = scene
    while isinstance(at, dict | list) and at:
        keys = sorted(at) if isinstance(at, dict) else range(len(at))
        key = given.PickValueInList(list(keys))
        deeper = isinstance(at[key], dict | list) and at[key]
        if deeper and given.ConsumeIntInRange(0, 5):
            at = at[key]
            continue
        what = given.ConsumeIntInRange(0, 5)
        if what == 0:
            del at[key]
        elif what == 1:
            at[key] = copy.deepcopy(given.PickValueInList(OTHERS))
        elif what == 2 and isinstance(at, dict):
            new = copy.deepcopy(given.PickValueInList([*NUMBERS, *OTHERS]))
            at[given.PickValueInList(KEYS)] = new
        elif what == 3 and isinstance(at[key], int | float):
            at[key] = at[key] * given.ConsumeIntInRange(-20, 40) / 10
        else:
            at[key] = given.PickValueInList(NUMBERS)
        return


def shorten(table: Any) -> None:  # noqa: ANN401
    """Make numbers of steps and samples small, wherever they are."""
    parts = table.values() if isinstance(table, dict) else table
    for key, short in SHORT.items():
        if isinstance(table, dict) and isinstance(table.get(key), int | float):
            table[key] = min(table[key], short)
    for part in parts:
        if isinstance(part, dict | list):
            shorten(part)


def toml(value: Any) -> str:  # noqa: ANN401
    """Return a value as TOML: tables and lists on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


if __name__ == "__main__":
    np.seterr(all="ignore")
    atheris.Setup(sys.argv, case)
    atheris.Fuzz()
