"""Searches and torsion under faults: full disks, no memory, signals. Output is whole or absent."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from cardan import Driveline
from scripts import SCRIPT, heed_signals, largest_file, memory, posix, run, script, signals

pytestmark = [posix]

LINE = """\
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -330, 45], [3450, -350, 45]]
phases_deg = [90, 0]
teeth = 24
[load]
speed_rpm = 1500
output_torque_Nm = 400
[tubes]
outer_diameter_mm = 90
wall_mm = 3
[torsion]
inertias_kgm2 = [0, 0.004, 0.006, [0, 0.14]]
damping_ratio = 0.015
speed_rpm = {{from = 500, to = 3000, steps = {steps}}}
[tolerances]
phases_deg = 2
of = ["support_moment_0_peak", "equivalent_bend", "non_uniformity", "max_angle_error"]
samples = {samples}
[states]
names = ["low", "high"]
points_mm.3.y = [-330, -200]
[optimise]
vary = {{"phases_deg.0" = "free", "phases_deg.1" = "free"}}
minimise = "equivalent_bend"
starts = {starts}
"""
SHORT = {"steps": 5, "samples": 100, "starts": 1}
LONG = {"steps": 100_000, "samples": 100_000_000, "starts": 100_000}
WRITING = {
    "optimise": ["--to", "new.toml"],
    "tolerances": ["--output", "new.svg"],
    "torsion": ["--output", "new.svg"],
}
SIGNALS = [("SIGINT", 130), ("SIGTERM", -15), ("SIGKILL", -9)]
IDENTIFY = ["identify", "a.csv", "--drive", "drive", "--driven", "driven"]

needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc here")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scene and a recording; commands run in it."""
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(LINE.format(**SHORT))
    angle = np.linspace(0.0, 20.0, 400)
    driven = Driveline.from_bends([0.3]).evaluate(angle, "angle").angle
    table = np.degrees([angle, driven]).T
    np.savetxt("a.csv", table, delimiter=",", header="drive,driven", comments="")
    return tmp_path


def there(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("command", WRITING)
@pytest.mark.parametrize("old", [False, True])
def test_a_disk_that_is_full(folder: Path, command: str, old: bool) -> None:
    *_, new = WRITING[command]
    if old:
        Path(new).write_text("old")
    before = there(folder)
    with largest_file(500):
        done = run(command, "a.toml", *WRITING[command])
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == f"cardan: {new}: File too large\n"
    assert there(folder) == before
    assert not old or Path(new).read_text() == "old"


@pytest.mark.parametrize(
    "arguments",
    [IDENTIFY, *(pytest.param([name, "a.toml"], marks=pytest.mark.long) for name in WRITING)],
)
def test_an_answer_that_nobody_can_take(folder: Path, arguments: list[str]) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("there is no /dev/full")
    if arguments[0] == "optimise":
        arguments = [*arguments, "--to", "new.toml"]
    with full.open("w") as stdout:
        done = script(*arguments, stdout=stdout)
    assert done.returncode == 2
    assert done.stderr == "cardan: output: No space left on device\n"


@memory
def test_memory_that_does_not_suffice(folder: Path) -> None:
    import resource

    Path("a.toml").write_text(LINE.format(**SHORT | {"samples": LONG["samples"]}))
    before = there(folder)
    # The samples of all figures alone take 3.2 GB.
    limit = (3 << 30, 3 << 30)
    done = script(
        *("tolerances", "a.toml", "--output", "new.svg"),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limit),
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "cardan: not enough memory; fewer samples or a smaller study need less\n"
    )
    assert there(folder) == before


def busy(process: subprocess.Popen[str], seconds: float) -> bool:
    """Whether a process has computed for so long, which does not depend on other processes."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12]) > 100.0 * seconds


def interrupted(arguments: list[str], number: str) -> tuple[int, str, str]:
    """Start a command and send it a signal while it computes; return its status and output."""
    assert SCRIPT
    with subprocess.Popen(
        [SCRIPT, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_signals,
    ) as process:
        try:
            deadline = time.monotonic() + 120.0
            # Most of the first second is spent on imports.
            while not busy(process, 2.0):
                assert process.poll() is None, process.communicate()
                assert time.monotonic() < deadline
                time.sleep(0.01)
            process.send_signal(getattr(signal, number))
            out, errors = process.communicate(timeout=120)
        finally:
            process.kill()
    return process.returncode, out, errors.strip()


@needs_proc
@signals
@pytest.mark.parametrize(
    ("command", "number", "status"),
    [
        # In the short tier a command each for two of them; test_command.py interrupts a run.
        pytest.param(name, *one, marks=() if place == other > 0 else pytest.mark.long)
        for place, name in enumerate(WRITING)
        for other, one in enumerate(SIGNALS)
    ],
)
def test_a_signal_while_it_computes(folder: Path, command: str, number: str, status: int) -> None:
    Path("a.toml").write_text(LINE.format(**LONG))
    *_, new = WRITING[command]
    Path(new).write_text("old")
    before = there(folder)
    assert interrupted([command, "a.toml", *WRITING[command]], number) == (status, "", "")
    assert there(folder) == before
    assert Path(new).read_text() == "old"


@pytest.fixture
def recording(folder: Path) -> Path:
    """A recording whose identification takes some seconds and a gigabyte."""
    path = folder / "a.npz"
    angle = np.linspace(0.0, 1e5, 3_000_000)
    np.savez(path, drive=angle, driven=angle + 0.02 * np.sin(2.0 * angle))
    return path


@pytest.mark.long
@needs_proc
@signals
@pytest.mark.parametrize(
    ("number", "status"),
    [SIGNALS[0], *(pytest.param(*one, marks=pytest.mark.long) for one in SIGNALS[1:])],
)
def test_a_signal_while_it_identifies(recording: Path, number: str, status: int) -> None:
    arguments = ["identify", recording.name, *IDENTIFY[2:], "--radians"]
    assert interrupted(arguments, number) == (status, "", "")


@pytest.mark.long
@memory
def test_a_recording_that_does_not_fit_into_memory(recording: Path) -> None:
    import resource

    limit = (1_300_000_000, 1_300_000_000)
    done = script(
        *("identify", recording.name, *IDENTIFY[2:]),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limit),
    )
    assert (done.returncode, done.stdout) == (2, "")
    # The library of linear algebra may print a line before.
    assert done.stderr.endswith(
        "cardan: not enough memory; fewer samples or a smaller study need less\n"
    )
