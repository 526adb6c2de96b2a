"""Channels of MDF files, as columns of scenes and of ``cardan identify``."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scripts
from cardan import Driveline
from cardan.app.files.recording import read_chunks, read_columns
from cardan.app.scene import Scene, stream
from cardan.app.scene.study.curves import write_curves

asammdf = pytest.importorskip("asammdf")

TIME = 0.001 * np.arange(2000)
SPEED = 600.0 + 30.0 * TIME
INVALID = np.isin(np.arange(2000), [7, 8])


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Two channel groups: speed and torque at 1 kHz, and a bend at 100 Hz."""

    def signal(samples: Any, times: Any, name: str, **others: Any) -> Any:  # noqa: ANN401
        return asammdf.Signal(samples, timestamps=times, name=name, **others)

    for version, suffix in (("4.10", "mf4"), ("3.30", "mdf")):
        with asammdf.MDF(version=version) as file:
            invalid = {"invalidation_bits": INVALID} if suffix == "mf4" else {}
            speed = signal(SPEED, TIME, "n", unit="rpm", **invalid)
            count = signal(np.arange(2000, dtype=np.int16), TIME, "count")
            file.append([speed, count], common_timebase=True)
            slow = TIME[5::10]
            file.append([signal(5.0 + slow, slow, "bend", unit="deg")])
            file.append([signal(np.array([b"R", b"D"]), TIME[:2], "gear", encoding="utf-8")])
            file.save(tmp_path / f"run.{suffix}", overwrite=True)
    return tmp_path / "run.mf4"


def test_channels_are_columns(recording: Path) -> None:
    time, speed, count = read_columns(recording, ["time", "n", "count"])
    np.testing.assert_array_equal(time, TIME)
    np.testing.assert_array_equal(speed, np.where(INVALID, np.nan, SPEED))
    np.testing.assert_array_equal(count, np.arange(2000.0))
    assert speed.dtype == count.dtype == np.float64
    older = read_columns(recording.with_suffix(".mdf"), ["time", "n", "count"])
    np.testing.assert_array_equal(older[1], SPEED)


@pytest.mark.parametrize("rows", [1, 600, 2000, 5000])
def test_channels_in_pieces(recording: Path, rows: int) -> None:
    if rows == 1:
        first = next(read_chunks(recording, ["time", "n"], rows))
        assert (first.columns[1].tolist(), first.total) == ([600.0], 2000)
        return
    chunks = list(read_chunks(recording, ["time", "n"], rows))
    parts = zip(*(chunk.columns for chunk in chunks), strict=True)
    for part, whole in zip(parts, read_columns(recording, ["time", "n"]), strict=True):
        np.testing.assert_array_equal(np.concatenate(part), whole)


def test_channels_on_a_raster(recording: Path) -> None:
    """Linear between the samples, only while all of them are recorded."""
    names = ["time", "n", "bend"]
    time, speed, bend = read_columns(recording, names, 0.0005)
    np.testing.assert_allclose(time, 0.005 + 0.0005 * np.arange(3981), rtol=0, atol=1e-12)
    np.testing.assert_allclose(speed, 600.0 + 30.0 * time, rtol=1e-13)
    np.testing.assert_allclose(bend, 5.0 + time, rtol=1e-13)
    chunks = list(read_chunks(recording, names, 1000, 0.0005))
    assert [len(chunk.columns[0]) for chunk in chunks] == [1000, 1000, 1000, 981]
    np.testing.assert_array_equal(np.concatenate([chunk.columns[2] for chunk in chunks]), bend)


SCENE = """\
[angles]
file = "run.mf4"
time_column_s = "time"
speed_column_rpm = "n"
"""


def test_a_scene_of_channels(recording: Path, tmp_path: Path) -> None:
    scene = Scene.parse(f"[driveline]\nbends_deg = [5]\n{SCENE}", folder=tmp_path)
    assert scene.missing == 2
    exact = np.pi / 30.0 * (600.0 * TIME + 15.0 * TIME**2)
    np.testing.assert_allclose(scene.drive_angle[~INVALID], exact[~INVALID], rtol=1e-13)
    # The bend has a raster of its own.
    bends = f"{SCENE}bend_columns_deg = ['bend']\n"
    with pytest.raises(ValueError, match="scene, line 1") as caught:
        Scene.parse(bends, folder=tmp_path)
    assert str(caught.value) == (
        f"scene, line 1: [angles] {tmp_path / 'run.mf4'}: the channels do not share "
        "their times; the channel groups are 'time' in 0, 1, 2; 'n' in 0; 'bend' in 1; raster_s of "
        "[angles] resamples measured speeds"
    )
    both = Scene.parse(f"{bends}raster_s = 0.01\n", folder=tmp_path)
    assert both.line.shape == (200,)
    np.testing.assert_allclose(both.line.bends_deg[:, 0], 5.005 + 0.01 * np.arange(200))


@pytest.mark.parametrize("rows", [64, 5000])
def test_a_stream_of_channels(recording: Path, tmp_path: Path, rows: int) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    text = f"[driveline]\nbends_deg = [5]\n{SCENE}[output]\ncurves = 'a.parquet'\n"
    (tmp_path / "run.toml").write_text(text)
    write_curves(Scene.load(tmp_path / "run.toml").run(), tmp_path / "whole.parquet")
    done = stream(tmp_path / "run.toml", tmp_path, rows=rows)
    assert (done.rows, done.missing) == (2000, 2)
    got, whole = (parquet.read_table(tmp_path / f"{name}.parquet") for name in ("a", "whole"))
    for name in whole.column_names:
        np.testing.assert_array_equal(got[name].to_numpy(), whole[name].to_numpy())


def test_the_bend_in_channels(tmp_path: Path) -> None:
    line = Driveline.from_bends([11], degrees=True)
    drive = 40.0 * TIME
    with asammdf.MDF() as file:
        angles = {"crank": drive, "axle": line.evaluate(drive, "angle").angle}
        signals = [
            asammdf.Signal(np.degrees(angle) % 360.0, timestamps=TIME, name=name)
            for name, angle in angles.items()
        ]
        file.append(signals, common_timebase=True)
        file.save(tmp_path / "run.mf4")
    arguments = ["identify", str(tmp_path / "run.mf4"), "--drive", "crank", "--driven", "axle"]
    found = scripts.run(*arguments, "--json")
    assert found.exit_code == 0, found.output
    joint = json.loads(found.stdout)
    assert joint["equivalent_bend_deg"] == pytest.approx(11.0, abs=1e-8)


@pytest.mark.parametrize(
    ("names", "raster", "message"),
    [
        (["time", "N"], None, "no column 'N'; did you mean 'n'?; the columns are time, n, count,"),
        (["gear"], None, "column 'gear' has shape (2,) and dtype |S1; it must hold numbers in one"),
        (["n", "bend"], None, "do not share their times; the channel groups are 'n' in 0;"),
        (["time"], 0.1, "raster_s needs a channel besides the time"),
        (["time", "n"], 1e-9, "raster_s is 1e-09; that makes more than 100000000 rows"),
    ],
)
def test_what_is_refused(
    recording: Path, names: list[str], raster: float | None, message: str
) -> None:
    with pytest.raises(ValueError, match=r"run\.mf4") as caught:
        read_columns(recording, names, raster)
    assert message in str(caught.value)


def test_damaged_files(recording: Path) -> None:
    whole = recording.read_bytes()
    for length in (0, 3, 100, 2000, len(whole) // 2, len(whole) - 300):
        recording.write_bytes(whole[:length])
        with pytest.raises(ValueError, match=r"run\.mf4: ") as caught:
            read_columns(recording, ["time", "n"])
        assert "\n" not in str(caught.value)
    recording.write_text("t,n\n1,2\n")
    with pytest.raises(ValueError, match=r"run\.mf4: not an MDF file$"):
        read_columns(recording, ["n"])


def changed(path: Path, group: int, change: Callable[[Any], None]) -> None:
    """Change a channel group of the file, as a damaged byte does."""
    with asammdf.MDF(path) as file:
        one = file.groups[group]
        change(one)
        blocks = [one.channel_group, *one.channels]
        content = bytearray(path.read_bytes())
        for block in blocks:
            new = bytes(block)
            content[block.address : block.address + len(new)] = new
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("channel", "raster", "what"),
    [
        (0, None, "column 'time'"),
        (1, None, "column 'n'"),
        (0, 0.1, "the time of column 'n'"),
        (1, 0.1, "column 'n'"),
    ],
)
def test_a_channel_outside_its_records(
    recording: Path, channel: int, raster: float | None, what: str
) -> None:
    def outside(group: Any) -> None:  # noqa: ANN401
        group.channels[channel].byte_offset = 2_637_321_393

    changed(recording, 0, outside)
    with pytest.raises(ValueError, match=f"{what} lies outside the records of its channel group$"):
        read_columns(recording, ["time", "n"], raster)


@pytest.mark.parametrize("flags", [0, 1 + 4])
def test_a_file_whose_logger_was_switched_off(
    recording: Path, flags: int, capfd: pytest.CaptureFixture[str]
) -> None:
    content = bytearray(recording.read_bytes())
    content[:8], content[60] = b"UnFinMF ", flags
    recording.write_bytes(content)
    time, count = read_columns(recording, ["time", "count"])
    np.testing.assert_array_equal(time, TIME)
    np.testing.assert_array_equal(count, np.arange(2000.0))
    # Without data nothing can be finished.
    recording.write_bytes(content[: content.index(b"##DT") + 2])
    with pytest.raises(ValueError, match="not a readable MDF file: "):
        read_columns(recording, ["time"])
    assert capfd.readouterr() == ("", "")


def test_without_asammdf(recording: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(ImportError, match=r"needs asammdf: pip install 'cardan\[mdf\]'"):
        read_columns(recording, ["n"])
    options = ["--drive", "n", "--driven", "m"]
    result = scripts.run("identify", recording, *options)
    assert result.exit_code == 2
    assert result.stderr == "cardan: this needs asammdf: pip install 'cardan[mdf]'\n"
