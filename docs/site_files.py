"""Build hook of the documentation: what is made with it, such as pictures, schemas and machines."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import cases

import cardan
from cardan.app.answers.explain import reference
from cardan.app.answers.schema import answers_schema
from cardan.app.report.moving import moving_page

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parent.parent
# The folders of pictures, each with the script that draws it.
SCRIPTS = {"drawings": ROOT / "docs" / "drawings", "pictures": ROOT / "examples" / "pictures.py"}
CACHE = ROOT / "build" / "drawn"
_LINES = re.compile(r"L [-\d. ]+(?:\nL [-\d. ]+)+")
_PLACE = re.compile(r'\b(?:d|x|y)="[^"]*"|translate\([^)]*\)')
MACHINES = ("truck-shaft", "steering-column", "pto-shaft", "mill-spindle", "test-rig", "ship-shaft")
"""Their scenes, in the order of their pages."""
HEAD = "---\nfold: tables\nsearch: {exclude: true}\n---\n\n"


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add what is drawn and what moves, the JSON Schemas and the pictures of the benches."""
    from mkdocs.structure.files import File

    for uri, path in pictures().items():
        files.append(File.generated(config, uri, abs_src_path=str(path)))
    texts = {"reference/figures.md": f"{HEAD}{reference()}"}
    texts |= {"machines/moving.html": moving()}
    for path in (ROOT / "benches").glob("*.svg"):
        texts[f"benches/{path.name}"] = small(path.read_text("utf-8"))
    for uri, text in (schemas() | texts).items():
        files.append(File.generated(config, uri, content=text))
    return files


def on_post_build(config: MkDocsConfig) -> None:
    """Remove what no page loads: maps of scripts for debuggers, searches in other languages."""
    scripts = Path(config.site_dir) / "assets"
    for path in scripts.rglob("*.map"):
        path.unlink()
    shutil.rmtree(scripts / "javascripts" / "lunr")


def schemas() -> dict[str, str]:
    """Return what ``cardan schema`` prints, on one line, by address on the site."""
    made = {"scene": cardan.Scene.schema(), "answers": answers_schema()}
    return {
        f"{name}.schema.json": json.dumps(schema, separators=(",", ":"))
        for name, schema in made.items()
    }


def moving() -> str:
    """Return the page in which one of the machines is chosen and moved.

    It also has the scenes of the case book, which the links of that page choose.
    """
    folder = resources.files("cardan.app.scene").joinpath("machines")
    texts = {name: folder.joinpath(f"{name}.toml").read_text("utf-8") for name in MACHINES}
    texts |= cases.SCENES
    scenes = {name: cardan.Scene.parse(text, f"{name}.toml") for name, text in texts.items()}
    page = moving_page({name: cardan.Answer(scene) for name, scene in scenes.items()})
    assert page is not None
    for name in cases.SCENES:
        page = page.replace(f'<li><a href="?{name}">', f'<li hidden><a href="?{name}">')
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
            for path in folder.glob("*.svg"):
                path.write_text(small(path.read_text("utf-8")), "utf-8")
            drawn_from.write_text(current, "utf-8")
    return {path.relative_to(CACHE).as_posix(): path for path in CACHE.rglob("*.svg")}


def small(picture: str) -> str:
    """Return a picture of half the size: to a hundredth of a point, without metadata."""
    bare = re.sub(r"<metadata>.*?</metadata>", "", picture, flags=re.DOTALL)
    return _PLACE.sub(_rounded, re.sub(r"\s*\n\s*", "\n", bare))


def _rounded(match: re.Match[str]) -> str:
    path = re.sub(r"\d+\.\d+", lambda number: f"{round(float(number[0]), 2):g}", match[0])
    # A line goes on without a letter.
    return _LINES.sub(lambda lines: lines[0].replace("\nL ", "\n"), path)


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
