"""What ARCHITECTURE.md and the decisions name exists."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = next(folder for folder in Path(__file__).parents if (folder / "ARCHITECTURE.md").exists())
TEXT = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
DECISIONS = ROOT / "docs" / "decisions"
FILES = sorted(path for path in DECISIONS.glob("*.md") if path.name != "index.md")
# Number, decision and measurement of each row.
ROWS = re.findall(
    r'^\| <a id="(\d+)"></a>(\d+) \| (.+) \| (.+) \|$',
    (DECISIONS / "index.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)
SECTIONS = ["Context", "Decision", "Measurement", "Consequences"]


def paths(text: str) -> set[str]:
    """The paths in backticks: words with a slash, and names of files."""
    names = re.findall(r"`([\w./-]+)`", text)
    suffix = re.compile(r"\.(?:json|md|py|rs|toml|ya?ml)$")
    return {name for name in names if "/" in name or suffix.search(name)}


def test_paths_are_recognised() -> None:
    text = "`rust/core/` `deny.toml` `plan.explain()` `app` `cardan._core` `x → y/z`, a/b"
    assert paths(text) == {"rust/core/", "deny.toml"}


def test_every_path_exists() -> None:
    named = paths(TEXT)
    assert len(named) > 30
    assert {name for name in named if not (ROOT / name).exists()} == set()


def test_folders_are_written_as_folders() -> None:
    assert {name for name in paths(TEXT) if (ROOT / name).is_dir() != name.endswith("/")} == set()


@pytest.mark.parametrize(
    "part", ["rust/core/src", "python/cardan"], ids=["the core", "the package"]
)
def test_every_module_is_on_the_map(part: str) -> None:
    modules = {
        f"{part}/{folder.name}/"
        for folder in (ROOT / part).iterdir()
        if folder.is_dir() and any(file.suffix in {".py", ".rs"} for file in folder.iterdir())
    }
    assert modules <= paths(TEXT.partition("\n## Modules\n")[2].partition("\n## ")[0])


def imported(tree: ast.AST) -> Iterator[str]:
    """What a module imports while it runs, and not for annotations alone."""
    if isinstance(tree, ast.If) and ast.unparse(tree.test) == "TYPE_CHECKING":
        return
    if isinstance(tree, ast.ImportFrom) and tree.module:
        yield from (f"{tree.module}.{name.name}" for name in tree.names)
    if isinstance(tree, ast.Import):
        yield from (f"{name.name}." for name in tree.names)
    for child in ast.iter_child_nodes(tree):
        yield from imported(child)


def test_imports_go_one_way_among_files_and_among_rooms() -> None:
    package = ROOT / "python"
    paths = {
        ".".join(path.relative_to(package).with_suffix("").parts).removesuffix(".__init__"): path
        for path in package.glob("cardan/**/*.py")
    }
    arrows: dict[str, set[str]] = {name: set() for name in paths if name != "cardan"}
    for name in arrows:
        for target in imported(ast.parse(paths[name].read_text("utf-8"))):
            # A module, or something that is in one.
            module = target if target in paths else target.rpartition(".")[0]
            arrows[name] |= {module} & arrows.keys() - {name}
    assert len(arrows["cardan.driveline"]) > 10
    rooms: dict[str, set[str]] = {}
    for name, above in arrows.items():
        room = name.split(".")[1]
        rooms.setdefault(room, set()).update({other.split(".")[1] for other in above} - {room})
    for graph in (arrows, rooms):
        TopologicalSorter(graph).prepare()
    library = rooms.keys() - {"app", "__main__"}
    assert not any("app" in rooms[room] for room in library)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_decision_has_its_parts(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    number = int(path.name[:4])
    title = re.match(rf"# {number}\. (.+)\n\n\* Date: \d{{4}}-\d\d-\d\d.*\n\* Status: (.+)\n", text)
    assert title is not None
    assert title[2].startswith(("accepted", "superseded "))
    assert re.findall(r"^## (.+)$", text, re.MULTILINE) == SECTIONS
    assert ROWS[number - 1][2].startswith(f"[{title[1]}]({path.name})")


def test_decisions_are_numbered_without_gaps() -> None:
    assert len(ROWS) >= 66
    for number, (anchor, shown, _, _) in enumerate(ROWS, 1):
        assert (anchor, shown) == (str(number), str(number))


def test_links_to_decisions_have_their_target() -> None:
    names = {path.name for path in FILES} | {"index.md", *(f"index.md#{row[0]}" for row in ROWS)}
    linked = set()
    for folder in ("", "benches", "records", "docs/**"):
        for page in ROOT.glob(f"{folder}/*.md" if folder else "*.md"):
            text = page.read_text(encoding="utf-8")
            beside = "" if page.parent == DECISIONS else r"[\w./]*decisions/"
            linked |= set(re.findall(rf"\]\({beside}(\d{{4}}-[^)]+|index\.md[^)]*)\)", text))
    assert len(linked) > 20
    assert linked <= names
