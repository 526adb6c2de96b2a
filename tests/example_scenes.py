"""The examples as texts with parts replaced, what the command answers to them, and the schemas."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import jsonschema
import pytest
from click.testing import CliRunner
from filelock import FileLock

from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene, load_scene
from tiers import few

_ROOT = Path(__file__).parents[1]
_PACKAGED = _ROOT / "python" / "cardan" / "app" / "scene"
EXAMPLES = sorted([*(_ROOT / "examples").glob("*.toml"), *_PACKAGED.rglob("*.toml")])
"""The scenes of the folder of examples and those that the package has, as of machines."""

DRIVELINES = [path for path in EXAMPLES if isinstance(load_scene(path), Scene)]
"""Those of a driveline; one is a ball joint alone."""

LONG = (
    *("bearings", "drive_inertia", "mill-spindle", "ride_heights", "rumble", "ship-shaft", "slip"),
    *("spatial_shaft", "three_joints_by_points", "truck"),
)
"""Whose sections others have too: what is asked of every example, the long tier asks of these."""

SHORT = [path for path in EXAMPLES if path.stem not in LONG]
"""The other examples, which together have every section."""

each_example, each_driveline = (
    pytest.mark.parametrize("path", few(paths, SHORT), ids=lambda path: path.stem)
    for paths in (EXAMPLES, DRIVELINES)
)

ANSWERS = jsonschema.Draft202012Validator(answers_schema())
SCENES = jsonschema.Draft202012Validator(Scene.schema())


def example(name: str) -> Path:
    """Return the path of an example or of a scene that the package has."""
    return next(_PACKAGED.rglob(name), _ROOT / "examples" / name)


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    """Return a text with parts replaced, each of which stands in it once."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


class Printed(NamedTuple):
    """The exit status of a command and what it printed."""

    status: int
    text: str


class Answered:
    """What cardan answers to an example, found once in a session by the first test that asks."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.path = path
        self._kept = folder / path.stem
        self.files = self._kept / "files"
        """Where `run` wrote its files."""
        self.files.mkdir(parents=True, exist_ok=True)

    @property
    def run(self) -> Printed:
        """The answer of ``cardan run``."""
        return self._printed("run", "--into", self.files)

    @property
    def check(self) -> Printed:
        """The answer of ``cardan check``."""
        return self._printed("check")

    def data(self, command: str, *options: str) -> Any:  # noqa: ANN401 - JSON
        """The answer with ``--json``; `run` draws no picture for it."""
        into = ("--into", self._kept) if command == "run" else ()
        with mock.patch("cardan.app.plots.write_picture"):
            return json.loads(self._printed(command, "--json", *options, *into).text)

    @property
    def page(self) -> str:
        """The page of ``cardan report``."""
        page = self._once("page.html", lambda path: write_report(load_scene(self.path), path))
        return page.read_text("utf-8")

    def _printed(self, command: str, *options: str | Path) -> Printed:
        def invoke(path: Path) -> None:
            arguments = [command, str(self.path), *map(str, options)]
            result = CliRunner().invoke(commands(), arguments, env={"COLUMNS": "80"})
            assert result.exit_code in (0, 1), result.output
            path.write_text(json.dumps([result.exit_code, result.output]), encoding="utf-8")

        name = "".join(str(part) for part in (command, *options) if not isinstance(part, Path))
        kept = self._once(f"{name}.printed", invoke)
        return Printed(*json.loads(kept.read_text("utf-8")))

    def _once(self, name: str, make: Callable[[Path], object]) -> Path:
        path = self._kept / name
        with FileLock(f"{path}.lock"):
            if not path.exists():
                make(path)
        return path


Answers = Callable[[Path], Answered]
"""How a test asks for what is answered to an example, by its path."""
