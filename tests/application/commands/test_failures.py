"""What a user or the system can get wrong: one line on stderr, output whole or absent."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cardan import Driveline
from cardan.app.files.whole_file import check_writable
from scripts import SCRIPT, heed_signals, largest_file, memory, posix, run, script, signals, size_of

JOINT = "[driveline]\nbends_deg = [8.5]\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refused(text: str, message: str, command: str = "run") -> None:
    """The scene beside what it reads is refused in these words, and nothing is written."""
    Path("a.toml").write_text(text)
    before = sorted(Path().iterdir())
    done = run(command, "a.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", f"cardan: {message}\n")
    assert sorted(Path().iterdir()) == before


@pytest.mark.parametrize("command", ["run", "check", "phase", "plot", "explain"])
def test_unknown_key(folder: Path, command: str) -> None:
    refused(
        "[driveline]\nbend_deg = [8.5]\n",
        "a.toml, line 2: [driveline] unknown key 'bend_deg'; did you mean 'bends_deg'?",
        command,
    )


def test_missing_recording(folder: Path) -> None:
    refused(
        JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'crank'\n",
        "a.toml, line 4: [angles] file is 'run.csv'; it cannot be read: No such file or directory",
    )


STUDY = JOINT + (
    "[study]\nbends_deg = {from = 0, to = 30, steps = 1000000}\n"
    "[output]\nclosed_forms = ['k']\ntable = 'a.csv'\n"
)


@pytest.mark.parametrize("command", ["run", "plot", "schema"])
def test_unwritable_output(folder: Path, command: str) -> None:
    """Said before the work is done, not after."""
    Path("a.toml").write_text(STUDY)
    Path("a.csv").mkdir()
    arguments = {"run": ["a.toml"], "schema": []}.get(command, ["a.toml"])
    if command != "run":
        arguments += ["--output", "missing/a.svg"]
    done = run(command, *arguments)
    path, reason = "a.csv", "Is a directory"
    if command != "run":
        path, reason = "missing/a.svg", "No such file or directory"
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == f"cardan: {path}: {reason}\n"
    assert {entry.name for entry in Path().iterdir()} == {"a.toml", "a.csv"}


@posix
@pytest.mark.parametrize(
    "command",
    [
        "run a.toml",
        "--help",
        *(
            pytest.param(other, marks=pytest.mark.long)
            for other in ("check a.toml --json", "schema")
        ),
    ],
)
def test_output_that_takes_nothing(folder: Path, command: str) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("there is no /dev/full")
    Path("a.toml").write_text(JOINT)
    with full.open("w") as stdout:
        done = script(*command.split(), stdout=stdout)
    assert done.returncode == 2
    assert done.stderr == "cardan: output: No space left on device\n"


@posix
@signals
def test_reader_that_has_seen_enough(folder: Path) -> None:
    """As in: cardan schema | head -1."""
    assert SCRIPT
    process = subprocess.Popen(
        [SCRIPT, "schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == ""
    process.stderr.close()
    assert process.wait(timeout=60) == -signal.SIGPIPE


@posix
def test_table_that_does_not_fit(folder: Path) -> None:
    Path("a.toml").write_text(STUDY)
    with largest_file(100_000):
        done = run("run", "a.toml")
    assert done.exit_code == 2
    assert done.stderr == "cardan: a.csv: File too large\n"
    assert [entry.name for entry in Path().iterdir()] == ["a.toml"]


@contextlib.contextmanager
def writing_a_table(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that is in the midst of a long table."""
    assert SCRIPT
    Path("a.toml").write_text(STUDY)
    process = subprocess.Popen(
        [SCRIPT, "run", "a.toml"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_signals,
    )
    try:
        deadline = time.monotonic() + 60
        while not any(size_of(entry) > 1_000_000 for entry in folder.iterdir()):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        yield process
    finally:
        process.kill()
        process.communicate()


@posix
@signals
@pytest.mark.parametrize("old", [True, pytest.param(False, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    ("number", "status"),
    [
        ("SIGINT", 130),
        ("SIGTERM", -15),
        pytest.param("SIGHUP", -1, marks=pytest.mark.long),
    ],
)
def test_interrupt_while_a_table_is_written(
    folder: Path, old: bool, number: str, status: int
) -> None:
    if old:
        Path("a.csv").write_text("old")
    with writing_a_table(folder) as process:
        process.send_signal(getattr(signal, number))
        _, errors = process.communicate(timeout=60)
    assert process.returncode == status
    assert errors.strip() == ""
    left = {entry.name: entry.read_text() for entry in folder.iterdir()}
    assert left == {"a.toml": STUDY} | ({"a.csv": "old"} if old else {})


@posix
@signals
def test_next_run_removes_what_a_killed_one_left(folder: Path) -> None:
    other = Path(".0123456789abcdef.part")
    other.write_text("of something else")
    with writing_a_table(folder) as process:
        # While it lives, its file stays.
        check_writable("a.csv")
        check_writable("b.csv")
        assert len(list(folder.glob(".cardan-*.part"))) == 1
        process.kill()
    assert len(list(folder.glob(".cardan-*.part"))) == 1
    check_writable("b.csv")
    assert len(list(folder.glob(".cardan-*.part"))) == 1
    check_writable("a.csv")
    assert {entry.name for entry in folder.iterdir()} == {"a.toml", other.name}


ESCAPES = "\x1b[2J\x1b]52;c;Y2FyZGFu\x07\x9b2J\u202e"


CONTROL = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_control_characters_of_a_title_are_not_printed(folder: Path, options: list[str]) -> None:
    written = "".join(f"\\u{ord(character):04x}" for character in ESCAPES)
    Path("a.toml").write_text(f'title = "Rig{written}"\n{JOINT}')
    done = run("run", "a.toml", *options)
    assert (done.exit_code, done.stderr) == (0, "")
    assert not CONTROL.search(done.stdout)
    if options:
        assert json.loads(done.stdout)["title"] == f"Rig{ESCAPES}"
    else:
        assert done.stdout.startswith("Rig\\x1b[2J\\x1b]52;c;Y2FyZGFu\\x07\\x9b2J\\u202e\n")


def test_control_characters_in_errors_are_not_printed(folder: Path) -> None:
    for arguments in (
        ["run", f"{ESCAPES}.toml"],
        [ESCAPES],
        ["schema", "--output", f"{ESCAPES}/a"],
    ):
        done = run(*arguments)
        assert (done.exit_code, done.stdout, done.stderr.count("\n")) == (2, "", 1)
        assert not CONTROL.search(done.stderr[:-1])
    Path("run.csv").write_text(f"crank\x1b[2J\n1\n{ESCAPES}\n")
    refused(
        JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'crnk'\n",
        "a.toml, line 3: [angles] run.csv: no column 'crnk'; did you mean 'crank\\x1b[2J'?; "
        "the columns are crank\\x1b[2J",
    )


def test_module_runs_as_the_script(folder: Path) -> None:
    module = [sys.executable, "-m", "cardan"]
    arguments = ["run", "missing.toml"]
    done = subprocess.run([*module, *arguments], capture_output=True, text=True)
    asked = script(*arguments)
    assert (done.returncode, done.stdout, done.stderr) == (
        asked.returncode,
        asked.stdout,
        asked.stderr,
    )


def on_a_terminal(*arguments: str, **environment: str) -> tuple[int, str, str]:
    """Run the command with stderr a terminal; return status, output and what the terminal got."""
    import pty

    leader, follower = pty.openpty()
    settings = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
    assert SCRIPT
    process = subprocess.Popen(
        [SCRIPT, *arguments],
        stdout=subprocess.PIPE,
        stderr=follower,
        env={**settings, "TERM": "xterm-256color", **environment},
        text=True,
    )
    os.close(follower)
    seen = b""
    while True:
        try:
            part = os.read(leader, 4096)
        except OSError:
            # How Linux says that the other end is closed.
            break
        if not part:
            break
        seen += part
    os.close(leader)
    output = process.communicate(timeout=60)[0]
    return process.returncode, output, seen.decode()


LONG = JOINT + (
    "[study]\nbends_deg = {from = 0, to = 30, steps = 9000}\n"
    "[output]\nquantities = ['speed_ratio']\nreduce = 'peak'\n"
)


@posix
def test_progress_bar_only_on_a_terminal(folder: Path) -> None:
    Path("a.toml").write_text(LONG)
    status, output, seen = on_a_terminal("run", "a.toml")
    assert status == 0
    assert "study" in seen
    assert "100%" in seen
    done = run("run", "a.toml")
    assert (done.exit_code, done.stderr, done.stdout) == (0, "", output)
    # A long table takes its time as well.
    table = "[output]\ncurves = 'a.csv'\n[sweep]\nsamples_per_turn = 70000\n"
    Path("a.toml").write_text(JOINT + table)
    assert "a.csv" in on_a_terminal("run", "a.toml")[2]
    Path("a.toml").write_text(LONG.replace("9000", "90000"))
    assert "study" in on_a_terminal("check", "a.toml")[2]
    # A short study needs none.
    Path("a.toml").write_text(LONG.replace("9000", "90"))
    assert on_a_terminal("run", "a.toml")[2] == ""


@posix
@pytest.mark.parametrize("environment", [{"TERM": "dumb"}, {"NO_COLOR": "1"}])
def test_terminal_without_colour(folder: Path, environment: dict[str, str]) -> None:
    Path("a.toml").write_text(LONG)
    status, output, seen = on_a_terminal("run", "a.toml", **environment)
    assert (status, "\x1b" in output) == (0, False)
    assert "\x1b[3" not in seen
    assert ("\x1b" in seen) == ("NO_COLOR" in environment)


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


FAULTS_LONG = {"steps": 100_000, "samples": 100_000_000, "starts": 100_000}


WRITING = {
    "optimise": ["--to", "new.toml"],
    "tolerances": ["--output", "new.svg"],
    "torsion": ["--output", "new.svg"],
}


SIGNALS = [("SIGINT", 130), ("SIGTERM", -15), ("SIGKILL", -9)]


IDENTIFY = ["identify", "a.csv", "--drive", "drive", "--driven", "driven"]


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc here")


@pytest.fixture
def faults_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scene and a recording; commands run in it."""
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(LINE.format(**SHORT))
    angle = np.linspace(0.0, 20.0, 400)
    driven = Driveline.from_bends([0.3]).evaluate(angle, "angle").angle
    table = np.degrees([angle, driven]).T
    np.savetxt("a.csv", table, delimiter=",", header="drive,driven", comments="")
    return tmp_path


def there(faults_folder: Path) -> set[str]:
    return {path.name for path in faults_folder.iterdir()}


@pytest.mark.parametrize("command", WRITING)
@pytest.mark.parametrize("old", [False, True])
def test_a_disk_that_is_full(faults_folder: Path, command: str, old: bool) -> None:
    *_, new = WRITING[command]
    if old:
        Path(new).write_text("old")
    before = there(faults_folder)
    with largest_file(500):
        done = run(command, "a.toml", *WRITING[command])
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == f"cardan: {new}: File too large\n"
    assert there(faults_folder) == before
    assert not old or Path(new).read_text() == "old"


@pytest.mark.parametrize(
    "arguments",
    [IDENTIFY, *(pytest.param([name, "a.toml"], marks=pytest.mark.long) for name in WRITING)],
)
def test_an_answer_that_nobody_can_take(faults_folder: Path, arguments: list[str]) -> None:
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
def test_memory_that_does_not_suffice(faults_folder: Path) -> None:
    import resource

    Path("a.toml").write_text(LINE.format(**SHORT | {"samples": FAULTS_LONG["samples"]}))
    before = there(faults_folder)
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
    assert there(faults_folder) == before


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
def test_a_signal_while_it_computes(
    faults_folder: Path, command: str, number: str, status: int
) -> None:
    Path("a.toml").write_text(LINE.format(**FAULTS_LONG))
    *_, new = WRITING[command]
    Path(new).write_text("old")
    before = there(faults_folder)
    assert interrupted([command, "a.toml", *WRITING[command]], number) == (status, "", "")
    assert there(faults_folder) == before
    assert Path(new).read_text() == "old"


@pytest.fixture
def recording(faults_folder: Path) -> Path:
    """A recording whose identification takes some seconds and a gigabyte."""
    path = faults_folder / "a.npz"
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
