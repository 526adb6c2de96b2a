"""The command as a user meets it: what it prints, writes and says when something is wrong."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import textwrap
import time
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import cardan
from cardan.command import commands
from cardan.scene import Scene
from cardan.scene_format import FORMAT

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
SCRIPT = shutil.which("cardan", path=sysconfig.get_path("scripts"))


def run(*arguments: str | Path) -> Result:
    environment = {"COLUMNS": "80"}
    return CliRunner().invoke(
        commands(), [str(argument) for argument in arguments], env=environment
    )


def script(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    assert SCRIPT, "the script cardan is not installed"
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [SCRIPT, *arguments], capture_output=True, text=True, encoding="utf-8", **options
    )


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text("[driveline]\nbends_deg = [8.5]\n[output]\ncurves = 'a.csv'\npicture = 'a.svg'")
    return path


@pytest.fixture
def into(tmp_path: Path) -> Path:
    path = tmp_path / "into"
    path.mkdir()
    return path


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_runs(path: Path, into: Path) -> None:
    result = run("run", path, "--into", into)
    assert result.exit_code == 0, result.output
    written = {entry.name: entry.stat().st_size for entry in into.iterdir()}
    assert set(written) == {f"{path.stem}.csv", f"{path.stem}.svg"}
    assert min(written.values()) > 10_000
    lines = result.output.splitlines()
    assert lines[0] == Scene.load(path).title
    assert lines[-2:] == [
        f"wrote {into / path.stem}.csv (721 rows)",
        f"wrote {into / path.stem}.svg",
    ]
    assert max(map(len, lines[:-2])) <= 79


def test_installed_script(into: Path) -> None:
    """The README's command, in a real process; files go to the current folder."""
    foeppl = next(path for path in EXAMPLES if path.stem == "foeppl")
    done = script("run", foeppl, cwd=into)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == textwrap.dedent("""\
        Föppl's rig (Thoma 1920)

        bend                        8.500 deg
        equivalent bend             8.500 deg
        largest angle error         0.3164 deg at 44.84 deg
        non-uniformity U            0.02209
        speed ratio                 0.9890 to 1.0111
        speed, shaft 1              2967.0 to 3033.3 rpm
        largest acceleration ratio  0.02209
        largest acceleration        2180 rad/s²
        largest torque, shaft 1     43.61 N m at 44.50 deg
        largest moment, joint 0     43.85 N m at 44.00 deg

        After "at": drive angle; 0 deg has the driving pin in the plane of shafts 0, 1.

        wrote foeppl.csv (721 rows)
        wrote foeppl.svg
        """)
    assert {entry.name for entry in into.iterdir()} == {"foeppl.csv", "foeppl.svg"}


def test_scene_without_files(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("[driveline]\nbends_deg = [8.5]\n")
    result = run("run", path, "--into", tmp_path)
    assert result.exit_code == 0
    assert result.output.startswith("bend ")
    assert result.output.endswith("shafts 0, 1.\n")
    assert list(tmp_path.iterdir()) == [path]


def test_version() -> None:
    result = run("--version")
    assert (result.exit_code, result.output) == (0, f"cardan {cardan.__version__}\n")


def examples_of(*arguments: str) -> list[str]:
    text = run(*arguments, "--help")
    assert text.exit_code == 0
    return re.findall(r"^    cardan (.*)$", text.output, re.MULTILINE)


NAMES = list(commands().commands)
LANDED = {
    "explain": hasattr(cardan.Driveline, "plan"),
    "report": importlib.util.find_spec("cardan.report") is not None,
}


@pytest.mark.parametrize("name", NAMES)
def test_examples_of_the_help_work(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not LANDED.get(name, True):
        pytest.skip(f"{name} needs what is not there")
    monkeypatch.chdir(tmp_path)
    first, *others = examples_of()
    assert run(*first.split()).exit_code == 0
    examples = examples_of(name)
    assert examples
    assert all(example.split()[0] == name for example in examples)
    for example in [*others, *examples]:
        result = run(*example.split())
        # The Z shaft shakes its common shaft harder than the limit of practice.
        assert result.exit_code == (1 if example.startswith("check") else 0), result.output


def test_help_without_arguments() -> None:
    assert run().output == run("--help").output
    assert run("--help").exit_code == 0
    for name in NAMES:
        assert f"  {name} " in run("--help").output
        assert max(map(len, run(name, "--help").output.splitlines())) < 80


def test_help_lists_every_key_on_a_line_of_its_own() -> None:
    text = run("run", "--help").output
    for name, section in FORMAT.items():
        assert not name or f"\n  [{name}]  " in text
        for key in section.keys if name != "study" else ():
            assert f"\n    {key} " in text
    assert max(map(len, text.splitlines())) < 80


# What can go wrong: one line on stderr, exit status 2


def failed(result: Result, message: str) -> None:
    assert (result.exit_code, result.output) == (2, f"cardan: {message}\n")


def test_scene_errors(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    failed(run("run", path), f"{path}: No such file or directory")
    failed(run("run", tmp_path), f"{tmp_path}: Is a directory")
    path.write_text("[driveline]\nbends_deg = [8, 95]\n")
    failed(
        run("run", path),
        f"{path}, line 2: [driveline] bends_deg[1] is 95.0 deg; a bend must lie in [0, 90) deg",
    )
    path.write_text("[driveline\n")
    failed(
        run("run", path),
        f"{path}: not TOML: Expected ']' at the end of a table declaration (at line 1, column 11)",
    )


def test_usage_errors(scene: Path) -> None:
    assert run("rnu").output.startswith("cardan: No such command 'rnu'.")
    failed(run("run"), "Missing argument 'SCENE'.")
    assert run("run", scene, "--onto").output.startswith("cardan: No such option")
    failed(
        run("run", scene, "--into", "missing"),
        "Invalid value for '--into': Directory 'missing' does not exist.",
    )


def test_errors_go_to_stderr(tmp_path: Path) -> None:
    done = script("run", tmp_path / "missing.toml")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"cardan: {tmp_path / 'missing.toml'}: No such file or directory\n"


def test_unwritable(scene: Path, into: Path) -> None:
    (into / "a.csv").mkdir()
    result = run("run", scene, "--into", into)
    assert result.exit_code == 2
    assert result.output.splitlines()[-1] == f"cardan: {into / 'a.csv'}: Is a directory"
    assert [entry.name for entry in into.iterdir()] == ["a.csv"]


@pytest.mark.parametrize(
    ("module", "message", "left"),
    [
        ("pyarrow", "a .parquet file needs pyarrow: pip install 'cardan[table]'", []),
        ("matplotlib", "a picture needs matplotlib: pip install 'cardan[app]'", ["a.parquet"]),
    ],
)
def test_missing_extra(
    scene: Path,
    into: Path,
    module: str,
    message: str,
    left: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene.write_text(scene.read_text().replace("a.csv", "a.parquet"))
    monkeypatch.setitem(sys.modules, module, None)
    result = run("run", scene, "--into", into)
    assert result.exit_code == 2
    assert result.output.splitlines()[-1] == f"cardan: {message}"
    assert [entry.name for entry in into.iterdir()] == left


def test_without_click() -> None:
    """As after an installation without extras."""
    script = "import sys; sys.modules['click'] = None; from cardan.command import main; main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "cardan: the command needs click: pip install 'cardan[app]'\n"


def test_memory(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("cardan.scene.Scene.run", exhausted)
    failed(run("run", scene), "not enough memory; a smaller samples_per_turn or study needs less")


def test_terminal_that_lacks_characters(into: Path) -> None:
    foeppl = next(path for path in EXAMPLES if path.stem == "foeppl")
    environment = {**os.environ, "PYTHONIOENCODING": "iso8859-5"}
    done = script("run", foeppl, cwd=into, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("F?ppl's rig")


LARGE = """\
[driveline]
bends_deg = [8.5]
[sweep]
samples_per_turn = 4000000
[output]
curves = "a.csv"
"""


@pytest.mark.skipif(os.name != "posix", reason="POSIX signals")
def test_interrupt(scene: Path, into: Path) -> None:
    """Ctrl-C while a large file is being written."""
    assert SCRIPT
    scene.write_text(LARGE)
    process = subprocess.Popen(
        [SCRIPT, "run", scene, "--into", into],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A test run in the background may ignore Ctrl-C, and its children would inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        deadline = time.monotonic() + 60
        while not any(entry.stat().st_size > 1_000_000 for entry in into.iterdir()):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert list(into.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="POSIX limits")
def test_file_that_does_not_fit(scene: Path, into: Path) -> None:
    """A real failure half-way through the file: the system takes no more than 100 kB of it."""
    import resource

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

    scene.write_text(LARGE.replace("4000000", "40000"))
    done = script("run", scene, "--into", into, preexec_fn=limit)
    assert done.returncode == 2
    assert done.stderr == f"cardan: {into / 'a.csv'}: File too large\n"
    assert list(into.iterdir()) == []
