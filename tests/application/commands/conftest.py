"""A scene that writes files, and a folder for them."""

from __future__ import annotations

from pathlib import Path

import pytest


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
