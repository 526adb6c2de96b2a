"""Columns through files by chunks: the same rows as at once, in little memory."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

pyarrow = pytest.importorskip("pyarrow")
from pyarrow import parquet  # noqa: E402

from cardan import Driveline, Load  # noqa: E402
from cardan.app.answers.turn.figures import drive_angles  # noqa: E402
from cardan.app.answers.turn.text import angles_text, few_samples_text  # noqa: E402
from cardan.app.command import commands  # noqa: E402
from cardan.app.files import map_parquet, recording  # noqa: E402
from cardan.app.scene import Scene, stream  # noqa: E402
from cardan.app.scene.study.curves import write_curves  # noqa: E402

ROWS = 1000
RANDOM = np.random.default_rng(6)
RECORDED = {
    "turn_deg": RANDOM.uniform(-1e4, 1e4, ROWS),
    "front_deg": RANDOM.uniform(0, 40, ROWS),
    "rear_deg": RANDOM.integers(0, 40, ROWS),
}
SCENE = """\
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
    path.write_text(SCENE)
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
    result = CliRunner().invoke(commands(), ["stream", str(scene), "--into", str(tmp_path)])
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
    scene.write_text(SCENE.replace(before, after, 1))
    result = CliRunner().invoke(commands(), ["stream", str(scene), "--into", str(tmp_path)])
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


def test_too_many_rows_at_once(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "MOST_ROWS", ROWS - 1)
    with pytest.raises(ValueError, match="1000 rows are too many to be read at once, 999 at most"):
        Scene.load(scene)
