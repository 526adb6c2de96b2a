"""The files that the documentation makes when it is built: pictures and JSON Schemas."""

from __future__ import annotations

import importlib.util
import json
import re
from importlib import resources
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import cases
import pytest

from cardan.app.answers.schema import answers_schema
from cardan.app.scene import Scene

DOCS = Path(__file__).parents[2] / "docs"
MACHINES = Path(str(resources.files("cardan"))) / "app/scene/machines"


@pytest.fixture
def site_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The hook, with an empty cache."""
    spec = importlib.util.spec_from_file_location("site_files", DOCS / "site_files.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "CACHE", tmp_path / "drawn")
    return module


def linked(pattern: str) -> set[str]:
    """The addresses on the site of the files that pages link to."""
    found = set()
    for page in DOCS.rglob("*.md"):
        for link in re.findall(rf"\]\(({pattern})\)", page.read_text("utf-8")):
            found.add((page.parent / link).resolve().relative_to(DOCS).as_posix())
    return found


@pytest.mark.long
def test_pages_show_every_picture_that_is_drawn(
    site_files: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONWARNINGS", "error")
    drawn = site_files.pictures()
    assert set(drawn) == linked(r"[^)\s]*\.svg")
    for path in drawn.values():
        text = path.read_text("utf-8")
        # What a browser sets in a font of its own could be cut.
        assert "<text" not in text
        marks = [element.attrib for element in ElementTree.fromstring(text).iter()]
        outlines = [mark.get("d", "") + mark.get("points", "") for mark in marks]
        assert len(list(filter(None, outlines))) >= 5
        assert not re.search("nan|inf", "".join(outlines))


def test_pictures_are_drawn_again_when_their_sources_have_changed(
    site_files: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "scripts" / "draw.py"
    script.parent.mkdir()
    text = """
import sys, pathlib
folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True)
(folder / "{name}.svg").write_text("")
"""
    script.write_text(text.format(name="one"))
    monkeypatch.setattr(site_files, "SCRIPTS", {"pictures": script})
    one = site_files.pictures()
    assert list(one) == ["pictures/one.svg"]
    drawn = one["pictures/one.svg"].stat().st_mtime_ns
    assert site_files.pictures() == one
    assert one["pictures/one.svg"].stat().st_mtime_ns == drawn
    script.write_text(text.format(name="other"))
    assert list(site_files.pictures()) == ["pictures/other.svg"]
    script.write_text(text.format(name="third") + "raise SystemExit(1)")
    for _ in range(2):
        with pytest.raises(site_files.subprocess.CalledProcessError):
            site_files.pictures()


def test_every_machine_and_case_can_be_chosen_and_moved(site_files: ModuleType) -> None:
    """In one page that holds the core once; pages of machines and the case book link to it."""
    page = site_files.moving()
    assert len(page) < 900_000
    assert re.findall(r'<li><a href="\?(.*?)">', page) == list(site_files.MACHINES)
    assert re.findall(r'<li hidden><a href="\?(.*?)">', page) == list(cases.SCENES)
    names = [*site_files.MACHINES, *cases.SCENES]
    for name in names:
        assert f'<script type="application/json" id="{name}">' in page
    assert set(site_files.MACHINES) == {path.stem for path in MACHINES.glob("*.toml")}
    assert linked(r"[^)\s?]*moving\.html[^)]*") == {
        "machines/moving.html",
        *(f"machines/moving.html?{name}" for name in site_files.MACHINES),
    }
    chosen = re.findall(r"\(machines/moving\.html\?(.*?)\)", cases.book())
    assert set(chosen) == set(cases.SCENES)
    assert 'src="machines/moving.html"' in (DOCS / "index.md").read_text("utf-8")


def test_pages_link_to_the_schemas(site_files: ModuleType) -> None:
    made = {name: json.loads(text) for name, text in site_files.schemas().items()}
    assert made == {"scene.schema.json": Scene.schema(), "answers.schema.json": answers_schema()}
    assert set(made) == linked(r"[^)\s]*\.schema\.json")
