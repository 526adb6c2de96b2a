"""Every example script runs from top to bottom, and prints what the documentation shows."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# What draws the pictures of the documentation has a test of its own, as they have.
SCRIPTS = sorted(set((ROOT / "examples").glob("*.py")) - {ROOT / "examples" / "pictures.py"})
# The scripts of the documentation's page, and what it says that they print.
SHOWN = dict(
    re.findall(
        r'--8<-- "examples/(\w+)\.py"\n```\n+```text\n(.*?)```',
        (ROOT / "docs" / "examples.md").read_text(encoding="utf-8"),
        re.DOTALL,
    )
)


@pytest.mark.parametrize(
    "script",
    [
        # Tests of pictures draw each of them as well.
        pytest.param(path, marks=pytest.mark.long if path.stem == "pictures" else ())
        for path in SCRIPTS
    ],
    ids=lambda path: path.stem,
)
def test_script(script: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script)], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == SHOWN.get(script.stem, done.stdout)
    assert done.stdout
    if script.stem == "grossmann":
        assert "<svg" in (tmp_path / "grossmann.svg").read_text(encoding="utf-8")


def test_the_documentation_shows_them() -> None:
    assert set(SHOWN) == {script.stem for script in SCRIPTS}
