"""The command as a process: started, limited and interrupted."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sysconfig
from pathlib import Path

import pytest

SCRIPT = shutil.which("cardan", path=sysconfig.get_path("scripts"))
posix = pytest.mark.skipif(os.name != "posix", reason="POSIX signals, limits and terminals")


def script(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    """Run the command and return what it printed."""
    assert SCRIPT, "the script cardan is not installed"
    captured = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [SCRIPT, *arguments], text=True, encoding="utf-8", **captured
    )


def heed_signals() -> None:
    """Undo what a parent may have told its children to ignore, as ``nohup`` does."""
    for heeded in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(heeded, signal.SIG_DFL)
