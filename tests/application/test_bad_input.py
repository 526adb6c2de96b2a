"""What a user can get wrong at the command line: one line on stderr, status 2, no traceback."""

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

import pytest

from cardan.app.files.whole_file import check_writable
from scripts import SCRIPT, heed_signals, largest_file, posix, run, script, signals, size_of

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


def test_wrong_unit(folder: Path) -> None:
    refused(
        "[driveline]\nbends_rad = [0.1]\n",
        "a.toml, line 2: [driveline] unknown key 'bends_rad'; "
        "the name includes the unit: bends_deg holds degrees",
    )


def test_missing_column(folder: Path) -> None:
    Path("run.csv").write_text("time_s,crank,front\n0,0,5\n")
    refused(
        JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'crnk'\n",
        "a.toml, line 3: [angles] run.csv: no column 'crnk'; did you mean 'crank'?; "
        "the columns are time_s, crank, front",
    )


def test_text_in_a_number_column(folder: Path) -> None:
    Path("run.csv").write_text("crank\n0\n1\nn/a\n")
    refused(
        JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'crank'\n",
        "a.toml, line 3: [angles] run.csv: line 4, column 'crank' is 'n/a'; it must be a number",
    )


def test_missing_recording(folder: Path) -> None:
    refused(
        JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'crank'\n",
        "a.toml, line 4: [angles] file is 'run.csv'; it cannot be read: No such file or directory",
    )


def test_truncated_parquet(folder: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(pyarrow.table({"crank": [0.0, 1.0]}), "run.parquet")
    whole = Path("run.parquet").read_bytes()
    Path("run.parquet").write_bytes(whole[:-20])
    Path("a.toml").write_text(
        JOINT + "[angles]\nfile = 'run.parquet'\nangle_column_deg = 'crank'\n"
    )
    done = run("run", "a.toml")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(
        "cardan: a.toml, line 3: [angles] run.parquet: not a readable Parquet file: "
    )
    assert done.stderr.count("\n") == 1


def test_study_of_a_billion_rows(folder: Path) -> None:
    began = time.monotonic()
    refused(
        "[driveline]\nbends_deg = [8, 8]\n[study]\n"
        "bends_deg.0 = {from = 0, to = 30, steps = 100_000}\n"
        "bends_deg.1 = {from = 0, to = 30, steps = 10_000}\n",
        "a.toml, line 4: [study] bends_deg.0 makes the study 100000 x 10000 = 1000000000 rows; "
        "it takes at most 10000000: give fewer steps or vary fewer keys",
    )
    # Nothing of it was begun; this bound is not a measurement.
    assert time.monotonic() - began < 60.0


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


@posix
def test_errors_on_a_terminal_have_no_colour(folder: Path) -> None:
    Path("a.toml").write_text("[driveline]\nbends_deg = [99]\n")
    status, output, seen = on_a_terminal("run", "a.toml", TERM="dumb", NO_COLOR="1")
    assert (status, output) == (2, "")
    assert seen.startswith("cardan: a.toml, line 2: [driveline] bends_deg[0] is 99 deg")
    assert "\x1b" not in seen


def test_errors_of_a_long_study_name_the_point(folder: Path) -> None:
    """The corner of the grid that makes no driveline is met in the run, not before."""
    refused(
        "[driveline]\npoints_m = [[0, 0, 0], [0, 1, 0], [0, 5, 0]]\n"
        "[study]\npoints_m.1.x = [0, 1, 1.9]\npoints_m.1.y = [2, 0.8, 4.1]\n",
        "a.toml: [study] at points_m.1.x = 1.9, points_m.1.y = 0.8: points_m give joint 0 "
        "a bend of 91.507436 deg at point 1, between points 0 and 2; "
        "a bend must lie in [0, 90) deg",
    )
