"""The command in this process, and as one of its own that is limited or interrupted."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sysconfig
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from cardan.app.command import commands

SCRIPT = shutil.which("cardan", path=sysconfig.get_path("scripts"))
posix = pytest.mark.skipif(os.name != "posix", reason="POSIX signals, limits and terminals")
signals = pytest.mark.xdist_group("signals")
memory = pytest.mark.xdist_group("memory")


def run(*arguments: str | Path) -> Result:
    """Run the command in this process, in a terminal of 80 columns."""
    return CliRunner().invoke(commands(), list(map(str, arguments)), env={"COLUMNS": "80"})


@contextlib.contextmanager
def largest_file(size: int) -> Iterator[None]:
    """Let this process write no file beyond a size."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def script(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    """Run the command and return what it printed."""
    assert SCRIPT, "the script cardan is not installed"
    captured = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [SCRIPT, *arguments], text=True, encoding="utf-8", **captured
    )


def size_of(path: Path) -> int:
    """Bytes of a file; 0 of one that is gone, as the trial whether a folder can be written to."""
    with contextlib.suppress(FileNotFoundError):
        return path.stat().st_size
    return 0


def heed_signals() -> None:
    """Undo what a parent may have told its children to ignore, as ``nohup`` does."""
    for heeded in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(heeded, signal.SIG_DFL)


def failed(result: Result, message: str) -> None:
    assert (result.exit_code, result.output) == (2, f"cardan: {message}\n")
