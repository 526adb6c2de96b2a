"""Build hook of the documentation: what is made with it, such as pictures, schemas and machines."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
from collections.abc import Mapping
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import cases

import cardan
from cardan.app.answers.explain import reference
from cardan.app.answers.schema import answers_schema
from cardan.app.command.terminal import as_json_text
from cardan.app.report.moving import moving_page

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parent.parent
# The folders of pictures, each with the script that draws it.
SCRIPTS = {"drawings": ROOT / "docs" / "drawings", "pictures": ROOT / "examples" / "pictures.py"}
CACHE = ROOT / "build" / "drawn"
MACHINES = ("truck-shaft", "steering-column", "pto-shaft", "mill-spindle", "test-rig", "ship-shaft")
"""Their scenes, in the order of their pages."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add what is drawn and what moves, the JSON Schemas and the pictures of the benches."""
    from mkdocs.structure.files import File

    benches = {f"benches/{path.name}": path for path in (ROOT / "benches").glob("*.svg")}
    for uri, path in (pictures() | benches).items():
        files.append(File.generated(config, uri, abs_src_path=str(path)))
    texts = {"reference/figures.md": reference()}
    texts |= {"machines/moving.html": machines(), "cases/moving.html": moving(cases.SCENES)}
    for uri, text in (schemas() | texts).items():
        files.append(File.generated(config, uri, content=text))
    return files


def schemas() -> dict[str, str]:
    """Return what ``cardan schema`` prints, by address on the site."""
    made = {"scene": cardan.Scene.schema(), "answers": answers_schema()}
    return {f"{name}.schema.json": f"{as_json_text(schema)}\n" for name, schema in made.items()}


def machines() -> str:
    """Return the page in which one of the machines is chosen and moved."""
    scenes = resources.files("cardan.app.scene").joinpath("machines")
    return moving({name: scenes.joinpath(f"{name}.toml").read_text("utf-8") for name in MACHINES})


def moving(scenes: Mapping[str, str]) -> str:
    """Return the page in which one of some scenes is chosen and moved."""
    parsed = {name: cardan.Scene.parse(text, f"{name}.toml") for name, text in scenes.items()}
    page = moving_page({name: cardan.Answer(scene) for name, scene in parsed.items()})
    assert page is not None
    return page


def pictures() -> dict[str, Path]:
    """Return the pictures by address on the site; draw those whose sources have changed."""
    for name, script in SCRIPTS.items():
        folder = CACHE / name
        # Written last, so that a drawing that was interrupted begins again.
        drawn_from, current = folder / "sources.sha256", sources(script)
        if not drawn_from.exists() or drawn_from.read_text("utf-8") != current:
            shutil.rmtree(folder, ignore_errors=True)
            # A process of its own draws with the modules as they are now.
            subprocess.run([sys.executable, str(script), str(folder)], check=True)
            drawn_from.write_text(current, "utf-8")
    return {path.relative_to(CACHE).as_posix(): path for path in CACHE.rglob("*.svg")}


def sources(script: Path) -> str:
    """Return a digest of what a script draws from: its folder, the package, matplotlib."""
    digest = hashlib.sha256(version("matplotlib").encode())
    beside = script if script.is_dir() else script.parent
    for folder in (beside, Path(cardan.__file__).parent):
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix != ".pyc":
                digest.update(path.relative_to(folder).as_posix().encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()
