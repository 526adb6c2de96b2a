"""Curves as files, whole or not at all, and columns through files by chunks."""

from __future__ import annotations

import errno
import gc
import os
import subprocess
import sys
import threading
from collections.abc import Generator, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow import parquet

import scripts
from cardan import Driveline, Load
from cardan.app.answers.turn.figures import drive_angles
from cardan.app.answers.turn.text import angles_text, few_samples_text
from cardan.app.files import columns as curves
from cardan.app.files import map_parquet
from cardan.app.files.recording import read_ahead
from cardan.app.files.whole_file import whole_file
from cardan.app.scene import (
    Scene,
    SceneResult,
    stream,
)
from cardan.app.scene.study.curves import columns, write_curves, write_study
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import FloatArray

SCENE = """\
[driveline]
bends_deg = [10, 25]
twists_deg = [30]
[load]
speed_rpm = 3000
inertias_kgm2 = [0, 0.1, 0.02]
[sweep]
samples_per_turn = 90
turns = 2
[output]
quantities = ["angle", "speed_ratio", "torque", "support_moment", "moment", "tilt_driven"]
"""


NAMES = [
    "drive_angle_deg",
    "angle_deg",
    "speed_ratio",
    "torque_Nm",
    *(f"support_moment_{axis}_Nm" for axis in "xyz"),
    *(f"moment_{joint}_{axis}_Nm" for joint in (0, 1) for axis in "xyz"),
    "tilt_driven_0_deg",
    "tilt_driven_1_deg",
]


@pytest.fixture(scope="module")
def result() -> SceneResult:
    return Scene.parse(SCENE).run()


def test_columns(result: SceneResult) -> None:
    table = columns(result)
    assert list(table) == NAMES
    assert {len(curve) for curve in table.values()} == {181}
    np.testing.assert_array_equal(table["drive_angle_deg"], np.arange(181) * 4.0)
    np.testing.assert_array_equal(table["angle_deg"], np.degrees(result.values["angle"]))
    np.testing.assert_array_equal(table["moment_1_z_Nm"], result.values["moment"][1, :, 2])
    np.testing.assert_array_equal(
        table["support_moment_y_Nm"], result.values["support_moment"][:, 1]
    )
    np.testing.assert_array_equal(
        table["tilt_driven_1_deg"], np.degrees(result.values["tilt_driven"][1])
    )


@pytest.mark.parametrize("block", [1, 7, 181, 10_000])
def test_csv(
    result: SceneResult, tmp_path: Path, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "_BLOCK", block)
    path = tmp_path / "a.csv"
    assert write_curves(result, path) == 181
    head, *lines = path.read_text(encoding="ascii").splitlines()
    assert head.split(",") == NAMES
    # Every digit: the doubles are the same, not close.
    read = np.array([[float(figure) for figure in line.split(",")] for line in lines])
    np.testing.assert_array_equal(read.T, list(columns(result).values()))


def test_npz(result: SceneResult, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    assert write_curves(result, str(path)) == 181
    with np.load(path) as read:
        assert set(read) == {"drive_angle", *result.values}
        np.testing.assert_array_equal(read["drive_angle"], result.drive_angle)
        for name, values in result.values.items():
            np.testing.assert_array_equal(read[name], values)


def test_parquet(result: SceneResult, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "a.parquet"
    assert write_curves(result, path) == 181
    read = parquet.read_table(path)
    assert read.column_names == NAMES
    for name, curve in columns(result).items():
        np.testing.assert_array_equal(read[name].to_numpy(), curve)


def test_unknown_suffix(result: SceneResult, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\.ods must end in \.csv or .* or \.xlsx"):
        write_curves(result, tmp_path / "a.ods")
    assert list(tmp_path.iterdir()) == []


# Studies


@pytest.fixture(scope="module")
def study() -> StudyResult:
    result = Scene.parse(
        "[driveline]\nbends_deg = [10, 25]\n[load]\ndrive_torque_Nm = 5\n"
        "[study]\nbends_deg.1 = {from = 0, to = 30, steps = 7}\nphases_deg = [0, 45, 90]\n"
        "[output]\nquantities = ['moment', 'tilt_driven']\nreduce = ['peak', 'mean']\n"
        "joints = [1]\n"
        "[sweep]\nsamples_per_turn = 8\n"
    ).run()
    assert result.study is not None
    return result.study


STUDY_NAMES = [
    *("bends_deg.1", "phases_deg", "equivalent_bend_deg", "non_uniformity", "max_angle_error_deg"),
    "moment_1_peak_Nm",
    *(f"moment_1_{axis}_mean_Nm" for axis in "xyz"),
    *("tilt_driven_1_peak_deg", "tilt_driven_1_mean_deg"),
]


@pytest.mark.parametrize("block", [1, 4, 21, 1000])
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_study_rows(
    study: StudyResult, tmp_path: Path, suffix: str, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "_BLOCK", block)
    path = tmp_path / f"a.{suffix}"
    assert write_study(study, path) == 21
    if suffix == "csv":
        head, *lines = path.read_text(encoding="ascii").splitlines()
        names = head.split(",")
        rows = [[float(figure) for figure in line.split(",")] for line in lines]
        read = list(np.array(rows).T)
    else:
        table = pytest.importorskip("pyarrow.parquet").read_table(path)
        names, read = table.column_names, [column.to_numpy() for column in table.columns]
    assert names == STUDY_NAMES
    np.testing.assert_array_equal(read[0], np.repeat(np.arange(7) * 5.0, 3))
    np.testing.assert_array_equal(read[1], np.tile([0.0, 45.0, 90.0], 7))
    np.testing.assert_array_equal(read[2], np.degrees(study.values["equivalent_bend"]).ravel())
    np.testing.assert_array_equal(read[6], study.values["moment_1_x_mean"].ravel())


def test_study_as_a_grid(study: StudyResult, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    assert write_study(study, path) == 21
    with np.load(path) as read:
        assert set(read) == {"bends_deg.1", "phases_deg", *study.values}
        np.testing.assert_array_equal(read["bends_deg.1"], np.arange(7) * 5.0)
        for name, values in study.values.items():
            assert values.shape == (7, 3)
            np.testing.assert_array_equal(read[name], values)


def test_figures_of_one_driveline_are_one_row(tmp_path: Path) -> None:
    result = Scene.parse("[driveline]\nbends_deg = [10]\n[output]\nclosed_forms = ['k']").run()
    assert result.study is not None
    assert write_study(result.study, tmp_path / "a.csv") == 1
    k = result.scene.line.equivalent().k
    assert (tmp_path / "a.csv").read_text() == f"k\n{float(k)!r}\n"


def test_columns_of_shafts_and_in_radians() -> None:
    text = SCENE.replace("quantities", "shafts = [0, 2]\njoints = [1]\nquantities")
    result = Scene.parse(text).run()
    table = columns(result, radians=True)
    assert list(table) == [
        "drive_angle_rad",
        *("angle_0_rad", "angle_2_rad", "speed_ratio_0", "speed_ratio_2", "torque_0_Nm"),
        "torque_2_Nm",
        *(f"support_moment_{shaft}_{axis}_Nm" for shaft in (0, 2) for axis in "xyz"),
        *(f"moment_1_{axis}_Nm" for axis in "xyz"),
        "tilt_driven_1_rad",
    ]
    np.testing.assert_array_equal(table["drive_angle_rad"], result.drive_angle)
    np.testing.assert_array_equal(table["angle_2_rad"], result.values["angle"][1])
    np.testing.assert_array_equal(table["moment_1_y_Nm"], result.values["moment"][0, :, 1])


# Whole or not at all


def test_link_stays(tmp_path: Path) -> None:
    path, link = tmp_path / "a.csv", tmp_path / "link.csv"
    link.symlink_to(path)
    for text in (b"first", b"second"):
        with whole_file(link) as file:
            file.write(text)
        assert (link.readlink(), path.read_bytes()) == (path, text)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_keeps_what_is_no_file(tmp_path: Path) -> None:
    path = tmp_path / "pipe.csv"
    os.mkfifo(path)
    with pytest.raises(OSError, match="Not a plain file") as caught, whole_file(path):
        pass
    assert caught.value.filename == str(path)
    assert path.is_fifo()


@pytest.mark.parametrize("old", [True, False])
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit, MemoryError])
def test_interrupted(tmp_path: Path, error: type[BaseException], old: bool) -> None:
    path = tmp_path / "a.csv"
    if old:
        path.write_text("old")

    def write() -> None:
        with whole_file(path) as file:
            file.write(b"half")
            raise error

    with pytest.raises(error):
        write()
    assert [(entry, entry.read_text()) for entry in tmp_path.iterdir()] == [(path, "old")][:old]


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_disk_full(
    result: SceneResult, tmp_path: Path, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, step, full)
    with pytest.raises(OSError, match="No space") as caught:
        write_curves(result, path)
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(path))
    assert [(entry, entry.read_text()) for entry in tmp_path.iterdir()] == [(path, "old")]


def test_failing_writer_leaves_nothing(
    result: SceneResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first blocks are on their way when the rest fails."""

    def blocks(table: Mapping[str, FloatArray], _: object) -> Iterator[list[FloatArray]]:
        yield [column[:10] for column in table.values()]
        raise MemoryError

    monkeypatch.setattr(curves, "_blocks", blocks)
    with pytest.raises(MemoryError):
        write_curves(result, tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_progress_of_a_long_file(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    monkeypatch.setattr(curves, "_BLOCK", 4)
    seen: list[tuple[int, int]] = []
    table = {"a": np.arange(10.0)}
    curves.write_columns(tmp_path / f"a{suffix}", table, lambda *done: seen.append(done))
    assert seen == [(4, 10), (8, 10), (10, 10)]


pyarrow = pytest.importorskip("pyarrow")


ROWS = 1000


RANDOM = np.random.default_rng(6)


RECORDED = {
    "turn_deg": RANDOM.uniform(-1e4, 1e4, ROWS),
    "front_deg": RANDOM.uniform(0, 40, ROWS),
    "rear_deg": RANDOM.integers(0, 40, ROWS),
}


CHUNKS_SCENE = """\
[angles]
file = "in.parquet"
angle_column_deg = "turn_deg"
bend_columns_deg = ["front_deg", "rear_deg"]
[driveline]
twists_deg = [20]
phases_deg = [30]
[load]
speed_rpm = 600
output_torque_Nm = 250
[output]
quantities = ["angle_error", "speed_ratio", "moment"]
curves = "out.parquet"
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    parquet.write_table(pyarrow.table(RECORDED), tmp_path / "in.parquet", row_group_size=333)
    path = tmp_path / "scene.toml"
    path.write_text(CHUNKS_SCENE)
    return path


@pytest.mark.parametrize("rows", [4, 97, ROWS, 5000])
@pytest.mark.parametrize("radians", [True, False])
def test_a_scene_by_chunks_is_the_scene_at_once(
    scene: Path, tmp_path: Path, rows: int, radians: bool
) -> None:
    whole = tmp_path / "whole.parquet"
    write_curves(Scene.load(scene).run(), whole, radians=radians)
    steps: list[tuple[int, int]] = []
    path, written, missing, ends, turns, signals, *_ = stream(
        scene,
        tmp_path,
        radians=radians,
        rows=rows,
        progress=lambda done, total: steps.append((done, total)),
    )
    assert (path, written, missing) == (tmp_path / "out.parquet", ROWS, 0)
    found = drive_angles(Scene.load(scene))
    assert ends == (found.first, found.last)
    assert turns == pytest.approx(found.turns)
    assert signals == ()
    assert parquet.read_table(path).equals(parquet.read_table(whole))
    assert steps[-1] == (ROWS, ROWS)
    assert len(steps) >= ROWS // rows


def test_the_command_says_how_fast(scene: Path, tmp_path: Path) -> None:
    result = scripts.run("stream", scene, "--into", tmp_path)
    assert result.exit_code == 0, result.output
    assert result.output.startswith(f"wrote {tmp_path / 'out.parquet'} (1000 rows, ")
    rate, angles = result.stdout.splitlines()
    assert rate.endswith(" million a second)")
    found = drive_angles(Scene.load(scene))
    assert angles == f"drive angles {angles_text(found)}"
    assert result.stderr == (f"cardan: {few_samples_text(found)}\n")


def test_a_plan_for_a_column(scene: Path, tmp_path: Path) -> None:
    line = Driveline.from_bends([0.2, 0.3], phases=0.5)
    options: dict[str, Any] = {"load": Load(drive_torque=2.0), "shafts": [1, 2]}
    plan = line.plan(("angle", "moment"), **options)
    source, target = scene.with_name("in.parquet"), tmp_path / "motion.parquet"
    assert map_parquet(source, target, ["turn_deg"], plan, rows=64) == ROWS
    read = parquet.read_table(target)
    assert read.equals(plan(RECORDED["turn_deg"]).to_arrow())
    assert read.field("moment_0_x").metadata == {b"units": b"N m", b"long_name": b"moment 0 x"}


@pytest.mark.usefixtures("scene")
def test_a_function_of_several_columns(tmp_path: Path) -> None:
    def larger(front: Any, rear: Any) -> dict[str, Any]:  # noqa: ANN401
        assert front.dtype == rear.dtype == np.float64
        return {"larger": np.maximum(front, rear)}

    names = ["front_deg", "rear_deg"]
    map_parquet(tmp_path / "in.parquet", tmp_path / "a.parquet", names, larger, rows=10)
    got = parquet.read_table(tmp_path / "a.parquet")["larger"].to_numpy()
    assert np.array_equal(got, np.maximum(RECORDED["front_deg"], RECORDED["rear_deg"]))


MEMORY = """
import sys
import tracemalloc
import numpy as np
import pyarrow
from pyarrow import parquet
from cardan import Driveline
from cardan.app.files import map_parquet

rows = 4_000_000
plan = Driveline.from_bends([0.2]).plan("speed_ratio")
plan([0.0]).to_arrow()  # imports what it needs
tracemalloc.start()
map_parquet(sys.argv[1], sys.argv[2], ["angle"], plan, rows=50_000)
column = 8 * rows
assert tracemalloc.get_traced_memory()[1] < column / 4, tracemalloc.get_traced_memory()
assert pyarrow.default_memory_pool().max_memory() < column / 4
assert parquet.read_metadata(sys.argv[2]).num_rows == rows
"""


def test_memory_is_that_of_a_chunk(tmp_path: Path) -> None:
    """Even where the whole file is one row group."""
    source, target = tmp_path / "in.parquet", tmp_path / "out.parquet"
    angle = RANDOM.uniform(0, 1e3, 4_000_000)
    parquet.write_table(pyarrow.table({"angle": angle}), source, row_group_size=len(angle))
    assert parquet.read_metadata(source).num_row_groups == 1
    done = subprocess.run(
        [sys.executable, "-c", MEMORY, source, target], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("in.parquet", "in.csv", "in.csv'; it cannot be read: No such file or directory"),
        ("out.parquet", "out.csv", "line 13: [output] curves must name a .parquet file for a"),
        ('curves = "out.parquet"', "", "[output] curves must name a .parquet file"),
        ("curves", 'reduce = ["mean"]\ncurves', "reduce does not go with streaming; it needs all"),
        ("curves", 'picture = "a.svg"\ncurves', "picture does not go with streaming"),
        ("[output]", "[study]\nspeed_rpm = [1, 2]\n[output]", "no [study] and no"),
        ("out.parquet", "in.parquet", "is the recording that the scene reads"),
        ("front_deg", "frond_deg", "no column 'frond_deg'; did you mean 'front_deg'?"),
        ("quantities", "quantity", "unknown key 'quantity'"),
        ("[30]", "[30, 40]", "phases_deg has length 2; it needs 1"),
    ],
)
def test_scenes_that_cannot_be_streamed(
    scene: Path, tmp_path: Path, before: str, after: str, message: str
) -> None:
    scene.write_text(CHUNKS_SCENE.replace(before, after, 1))
    result = scripts.run("stream", scene, "--into", tmp_path)
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out.parquet").exists()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("turn_deg", np.inf, "row 701, counted from 1, column 'turn_deg' is inf; it must be"),
        ("front_deg", 90.0, "row 701, counted from 1, column 'front_deg' is 90.0; a bend must"),
    ],
)
def test_rows_are_counted_through(
    scene: Path, tmp_path: Path, column: str, value: float, message: str
) -> None:
    wrong: list[float] = RECORDED[column].tolist()
    wrong[700] = value
    source = tmp_path / "in.parquet"
    parquet.write_table(pyarrow.table({**RECORDED, column: wrong}), source)
    target = tmp_path / "out.parquet"
    target.write_bytes(b"earlier")
    with pytest.raises(ValueError, match=message) as caught:
        stream(scene, tmp_path, rows=64)
    assert str(caught.value).startswith(f"{scene}, line 1: [angles] {source}: ")
    # Nothing is left to the garbage collector, which may run inside the start of another thread.
    assert not [one for one in threading.enumerate() if one.name.startswith("cardan-")]
    # Whole or not at all.
    assert target.read_bytes() == b"earlier"
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".parquet", ".parquet", ".toml"]


def test_files_that_cannot_be_streamed(scene: Path, tmp_path: Path) -> None:
    plan = Driveline.from_bends([0.2]).plan()
    source, target = tmp_path / "in.parquet", tmp_path / "out.parquet"
    with pytest.raises(ValueError, match=r"out\.csv must end in \.parquet"):
        map_parquet(source, tmp_path / "out.csv", ["turn_deg"], plan)
    with pytest.raises(FileNotFoundError, match="none"):
        map_parquet(tmp_path / "none.parquet", target, ["turn_deg"], plan)
    parquet.write_table(pyarrow.table({"turn_deg": np.empty(0)}), source)
    with pytest.raises(ValueError, match=r"in\.parquet: column 'turn_deg' has no rows"):
        map_parquet(source, target, ["turn_deg"], plan)
    assert not target.exists()


def _counting(made: list[int], end: int = 5) -> Generator[int]:
    try:
        for item in range(end):
            made.append(item)
            yield item
    finally:
        made.append(-1)


def test_items_come_in_order_and_are_made_elsewhere() -> None:
    """Items that count as false are items too."""
    threads = set()

    def items() -> Generator[int]:
        for item in (0, 0, 1):
            threads.add(threading.current_thread())
            yield item

    assert list(read_ahead(items())) == [0, 0, 1]
    assert len(threads) == 1
    assert threading.current_thread() not in threads


def test_an_error_arrives_after_the_items_before_it() -> None:
    def items() -> Generator[int]:
        yield 1
        raise ValueError("damaged")

    ahead = read_ahead(items())
    assert next(ahead) == 1
    with pytest.raises(ValueError, match="damaged"):
        next(ahead)


def test_an_abandoned_reader_ends_its_thread() -> None:
    """Whoever collects it may be inside anything, and must not wait for a thread that is gone."""
    made: list[int] = []
    items = read_ahead(_counting(made))
    next(items)
    circle: list[object] = [items]
    circle.append(circle)
    del items, circle
    gc.collect()
    assert made[-1] == -1
    assert not [one for one in threading.enumerate() if one.name.startswith("cardan-read")]
