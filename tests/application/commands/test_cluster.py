"""Studies on a cluster: killed anywhere they go on, and end as in one process."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

import scripts

pytest.importorskip("distributed")
parquet = pytest.importorskip("pyarrow.parquet")

from cardan.app.answers.data import data_of  # noqa: E402
from cardan.app.answers.schema import answers_schema  # noqa: E402
from cardan.app.answers.study import study_figures, study_text  # noqa: E402
from cardan.app.answers.turn.figures import drive_angles  # noqa: E402
from cardan.app.command import commands  # noqa: E402
from cardan.app.scene import Scene  # noqa: E402
from cardan.app.scene.study import cluster, curves  # noqa: E402
from example_scenes import example, replaced  # noqa: E402

# One cluster serves all.
pytestmark = pytest.mark.xdist_group("cluster")

SCENE = """\
[driveline]
slopes_vertical_deg = [-3, -7, -4]
slopes_horizontal_deg = [0, 1.5, 0]
[load]
speed_rpm = 1000
output_torque_Nm = 50
[sweep]
samples_per_turn = 72
[study]
slopes_vertical_deg.1 = {from = -15, to = 2, steps = 61}
slopes_vertical_deg.2 = [-2, -3, -4]
[output]
quantities = ["speed_ratio", "moment"]
reduce = ["peak", "mean", "rms"]
table = "study.parquet"
"""
ROWS = 61 * 3
PART = 5
PARTS = 37

# A client with two worker processes that take their time and note what they have written.
CLIENT = """\
import os
import sys
import time

import distributed

from cardan.app.scene import Scene
from cardan.app.scene.study import cluster


class Slow(distributed.WorkerPlugin):
    def setup(self, worker):
        write = cluster.write_columns

        def slow(path, table):
            time.sleep(0.1)
            write(path, table)
            with open(sys_argv[3], "a") as log:
                log.write(f"{path.name}\\n")

        cluster.write_columns = slow


if __name__ == "__main__":
    sys_argv = sys.argv
    with cluster.connect(processes=2) as client:
        client.register_plugin(Slow())
        print(*client.run(os.getpid).values(), flush=True)
        cluster.write_study(Scene.load(sys.argv[1]).study, sys.argv[2], client, part_rows=5)
"""


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with cluster.connect(processes=2) as connected:
        yield connected


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def wait_for(what: Callable[[], bool]) -> None:
    end = time.monotonic() + 60
    while not what():
        assert time.monotonic() < end, "waited a minute"
        time.sleep(0.01)


def alive(process: int) -> bool:
    try:
        # A process that has ended but not been waited for is still there.
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def in_one_process(scene: Path) -> Any:  # noqa: ANN401 - a table
    path = scene.with_name("one.parquet")
    result = Scene.load(scene).run().study
    assert result
    curves.write_study(result, path)
    return parquet.read_table(path)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc here")
def test_a_worker_and_then_the_run_are_killed_and_it_goes_on(
    scene: Path,
    tmp_path: Path,
    client: Any,  # noqa: ANN401
) -> None:
    folder, log, script = tmp_path / "study.parquet", tmp_path / "log", tmp_path / "client.py"
    script.write_text(CLIENT)

    def there() -> dict[str, tuple[int, int]]:
        found = {path.name: path.stat() for path in folder.glob("part-*.parquet")}
        return {name: (stat.st_ino, stat.st_mtime_ns) for name, stat in found.items()}

    with subprocess.Popen(
        [sys.executable, str(script), str(scene), str(folder), str(log)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as run:
        assert run.stdout
        workers = [int(word) for word in run.stdout.readline().split()]
        assert len(workers) == 2
        wait_for(lambda: len(there()) >= 3)
        os.kill(workers[0], signal.SIGKILL)
        before = len(there())
        # The other one alone would do: what the dead one was at must be done as well.
        wait_for(lambda: len(there()) >= before + 6)
        assert run.poll() is None
        run.kill()
    wait_for(lambda: not alive(workers[1]))
    kept = there()
    assert 9 <= len(kept) < PARTS
    # Whole or not at all.
    assert all(parquet.read_metadata(folder / name).num_rows for name in kept)

    study = Scene.load(scene).study
    assert study
    steps: list[tuple[int, int]] = []
    written = cluster.write_study(
        study, folder, client, progress=lambda done, rows: steps.append((done, rows))
    )
    assert written == cluster.Written(folder, ROWS, PARTS, len(kept))
    assert len(steps) == PARTS - len(kept)
    assert steps[-1] == (ROWS, ROWS)
    after = there()
    assert len(after) == PARTS
    assert {name: after[name] for name in kept} == kept
    assert max(Counter(log.read_text().split()).values()) == 1
    assert parquet.read_table(folder).equals(in_one_process(scene))
    assert sorted(path.name for path in folder.iterdir()) == ["_study.json", *sorted(after)]


def test_the_command_writes_a_folder_and_goes_on(
    scene: Path,
    tmp_path: Path,
    client: Any,  # noqa: ANN401
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # A speed ratio and two moments of three components, each by three reductions.
    monkeypatch.setattr(cluster, "_SAMPLES", 72 * 7 * 3 * 50)
    folder = tmp_path / "study.parquet"
    arguments = ["run", str(scene), "--into", str(tmp_path), "--scheduler"]
    arguments.append(client.scheduler.address)
    first = CliRunner().invoke(commands(), arguments)
    assert first.exit_code == 0, first.output
    assert f"wrote {folder} (183 rows in 4 files)\n" in first.output
    # Its summary is that of one process.
    one = Scene.load(scene)
    result = one.run().study
    assert result
    text = study_text(study_figures(result, 72), drive_angles(one))
    assert "Best drivelines\n" in text
    assert first.output.endswith(f"\n\n{text}\n")
    assert parquet.read_table(folder).equals(in_one_process(scene))
    (folder / "part-000002.parquet").unlink()
    again = scripts.run(*arguments, "--json")
    answer = json.loads(again.output)
    assert answer["files"] == [{"file": str(folder), "rows": 183, "parts": 4, "found": 3}]
    assert answer["study"] == data_of(study_figures(result, 72))
    jsonschema.Draft202012Validator(answers_schema()).validate(answer)
    assert parquet.read_table(folder).equals(in_one_process(scene))

    for line, other, differ in (
        ("speed_rpm = 1000", "speed_rpm = 1001", "load"),
        ("steps = 61", "steps = 62", "axes"),
        ("samples_per_turn = 72", "samples_per_turn = 73", "drive angles"),
        ('"rms"]', '"rms"]\ntolerance = 0', "options"),
    ):
        scene.write_text(SCENE.replace(line, other))
        refused = CliRunner().invoke(commands(), arguments)
        assert refused.exit_code == 2
        assert f"{folder} holds another study, of other {differ}; remove it" in refused.output
        assert refused.stderr.count("\n") == 1
    scene.write_text(f"title = 'other words'\n{SCENE}workers = 1\n")
    assert CliRunner().invoke(commands(), arguments).exit_code == 0


SECTIONS = {
    "bearings that move": replaced(
        example("bearings.toml").read_text(),
        (
            "[output]",
            "[study]\nbearing.2.position_mm = {from = 900, to = 1150, steps = 7}\n"
            "points_mm.1.y = [-20, 0, 20]\n[output]",
        ),
        ('curves = "bearings.csv"\npicture = "bearings.svg"\n', 'reduce = ["peak", "mean"]\n'),
    ),
    "points whose lengths make a spline slide": """[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, -150, 20], [1800, -150, 20]]
[load]
drive_torque_Nm = 80
speed_rpm = 1500
[slip]
shaft = 1
friction = 0.1
radius_mm = 20
[study]
points_mm.2.y = {from = -250, to = -50, steps = 11}
points_mm.1.y = [-20, 0, 20]
[output]
quantities = ["speed_ratio", "joint_force"]
""",
    "a steering column with a centred double joint": """[driveline]
double_joint_deg = 30
joint_distance_mm = 60
synchronous_deg = 35
[study]
double_joint_deg = {from = 0, to = 40, steps = 21}
pivot_wear_mm = [0, 0.5]
[output]
quantities = ["angle_error", "speed_ratio", "jerk_ratio"]
reduce = ["peak"]
""",
}


@pytest.mark.parametrize("text", SECTIONS.values(), ids=SECTIONS)
def test_every_section_gives_the_bits_of_one_process(
    tmp_path: Path,
    client: Any,  # noqa: ANN401
    text: str,
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(f'{text}table = "study.parquet"\n')
    study = Scene.load(scene).study
    assert study
    folder = tmp_path / "study.parquet"
    cluster.write_study(study, folder, client, part_rows=PART)
    assert len(list(folder.glob("part-*"))) > 2
    assert parquet.read_table(folder).equals(in_one_process(scene))


def test_a_point_that_makes_no_driveline_is_named(
    scene: Path,
    tmp_path: Path,
    client: Any,  # noqa: ANN401
) -> None:
    # The ends of the axes are right, so that it is found on the way.
    text = "[driveline]\nslopes_vertical_deg = [0, 0]\nslopes_horizontal_deg = [0, 0]\n[study]\n"
    text += "slopes_vertical_deg.0 = [0, -60, 60]\nslopes_vertical_deg.1 = [0, 60]\n"
    scene.write_text(f"{text}[output]\ntable = 'study.parquet'")
    study = Scene.load(scene).study
    assert study
    point = r"slopes_vertical_deg\.0 = -60, slopes_vertical_deg\.1 = 60"
    with pytest.raises(ValueError, match=f"^at {point}: .* a bend must lie in"):
        cluster.write_study(study, tmp_path / "study.parquet", client, part_rows=2)


@pytest.mark.parametrize(
    ("scene_text", "options", "message"),
    [
        (SCENE, ["--local", "2", "--scheduler", "x"], "are both given; give one of them"),
        (SCENE.replace(".parquet", ".csv"), ["--local", "2"], "--local needs a scene with a study"),
        ("[driveline]\nbends_deg = [3]\n", ["--scheduler", "x"], "--scheduler needs a scene with"),
        (SCENE, ["--scheduler", "tcp://127.0.0.1:9"], "tcp://127.0.0.1:9: no dask scheduler"),
        (SCENE, ["--scheduler", ""], "--scheduler is empty; give an address"),
    ],
)
def test_what_cannot_be_done(
    tmp_path: Path, scene_text: str, options: list[str], message: str
) -> None:
    import dask

    path = tmp_path / "a.toml"
    path.write_text(scene_text)
    with dask.config.set({"distributed.comm.timeouts.connect": "300ms"}):
        result = scripts.run("run", path, *options)
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_file_in_the_place_of_the_folder_is_noticed_first(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "study.parquet").write_bytes(b"theirs")
    for name in ("run", "evaluate"):
        monkeypatch.setattr(Scene, name, pytest.fail)
    monkeypatch.setattr(cluster, "connect", pytest.fail)
    arguments = ["run", str(scene), "--into", str(tmp_path), "--local", "2"]
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code == 2
    assert "study.parquet is a file; a study on a cluster writes a folder" in result.stderr
    assert (tmp_path / "study.parquet").read_bytes() == b"theirs"


def test_a_run_whose_tasks_are_cancelled_says_so(
    scene: Path,
    tmp_path: Path,
    client: Any,  # noqa: ANN401
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # As when the scheduler is gone.
    submit = client.map

    def cancelled(*arguments: Any, **options: Any) -> Any:  # noqa: ANN401
        futures = submit(*arguments, **options)
        client.cancel(futures)
        return futures

    monkeypatch.setattr(client, "map", cancelled)
    study = Scene.load(scene).study
    assert study
    with pytest.raises(OSError, match="dask gave up"):
        cluster.write_study(study, tmp_path / "study.parquet", client, part_rows=PART)


def test_folders_of_others_are_left_alone(
    scene: Path,
    tmp_path: Path,
    client: Any,  # noqa: ANN401
) -> None:
    study = Scene.load(scene).study
    assert study
    folder = tmp_path / "study.parquet"
    folder.mkdir()
    (folder / "data.parquet").write_bytes(b"theirs")
    with pytest.raises(ValueError, match="contains other files; a study needs a separate folder"):
        cluster.write_study(study, folder, client)
    (folder / "_study.json").write_text("{}")
    with pytest.raises(ValueError, match="does not say to which study the folder belongs"):
        cluster.write_study(study, folder, client)
    assert sorted(os.listdir(folder)) == ["_study.json", "data.parquet"]
    file = tmp_path / "file.parquet"
    file.write_bytes(b"")
    with pytest.raises(OSError, match=r"file\.parquet"):
        cluster.write_study(study, file, client)
