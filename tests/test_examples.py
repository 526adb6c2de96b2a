"""Every example script runs from top to bottom."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_script(script: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script)], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout
    if "grossmann" in script.stem:
        assert "0.77786" in done.stdout
        assert "<svg" in (tmp_path / "grossmann.svg").read_text(encoding="utf-8")
    elif "pictures" in script.stem:
        drawn = {path.name for path in (tmp_path / "pictures").iterdir()}
        assert drawn == {path.name for path in (ROOT / "docs" / "pictures").iterdir()}
    else:
        assert "The driveline passes." in done.stdout.split("turned against")[1]
