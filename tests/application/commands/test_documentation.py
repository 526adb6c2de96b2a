"""What the documentation, README and examples show happens, and what they name exists."""

from __future__ import annotations

import ast
import importlib.util
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from graphlib import TopologicalSorter
from importlib import resources
from io import StringIO
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import cases
import pytest
from click.testing import CliRunner

import cardan
import scripts
from cardan import torsion
from cardan.app.command import commands
from oracle import OUTPUT_LIMITS

ROOT = Path(__file__).parents[3]


DOCS = ROOT / "docs"


PAGES = sorted(DOCS.rglob("*.md"))


LONG_PAGES = {
    *("cluster.md", "report.md", "ride-heights.md", "shudder.md", "tolerances.md", "torsion.md"),
    *(page.name for page in (DOCS / "machines").glob("*.md")),
}


"""Pages whose snippets compute for more than a second."""


FIGURE = r"\d+(?:\.\d+)?[°%]?"


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, the file it stands for, its text."""

    language: str
    title: str
    text: str


def blocks(page: str) -> Iterator[Block]:
    """The fenced blocks of a page, with what they include."""
    for language, title, text in re.findall(
        r'^```(\w+)(?: title="(.*?)")?\n(.*?)^```$', page, re.DOTALL | re.MULTILINE
    ):
        yield Block(language, title, re.sub(r'--8<-- "(.*?)"\n', _file, text))


def _file(match: re.Match[str]) -> str:
    return (ROOT / match[1]).read_text(encoding="utf-8")


def run_block(block: Block, names: dict[str, object]) -> str:
    """Do what a block shows, in the working directory; return what it prints."""
    if block.language == "python":
        printed = StringIO()
        with redirect_stdout(printed):
            exec(block.text, names)
        return printed.getvalue()
    if block.language == "sh":
        return "".join(_command(line) for line in block.text.splitlines())
    if block.language == "toml" and block.title.endswith(".toml"):
        Path(block.title).write_text(block.text, encoding="utf-8")
    return ""


def shows(text: str, printed: str) -> bool:
    """Whether a text is what was printed; a line ``…`` stands for lines that it leaves out."""
    pieces = re.split(r"^…\n", text.rstrip("\n") + "\n", flags=re.MULTILINE)
    whole = r"(?:.*\n)+?".join(re.escape(piece) for piece in pieces)
    return re.fullmatch(whole, printed.rstrip("\n") + "\n") is not None


def _command(line: str) -> str:
    program, *arguments = shlex.split(line)
    if program != "cardan":
        return ""
    result = CliRunner().invoke(commands(), arguments)
    # A check that finds a limit exceeded is no error.
    wanted = {0, 1} if arguments[0] == "check" else {0}
    assert result.exit_code in wanted, result.output
    return result.output


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(
            page,
            id=str(page.relative_to(DOCS)),
            marks=pytest.mark.long if page.name in LONG_PAGES else (),
        )
        for page in PAGES
    ],
)
def test_snippets(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    names: dict[str, object] = {"__name__": "__main__"}
    text = page.read_text(encoding="utf-8")
    shown = [*blocks(text), Block("", "", "")]
    # A page may show the answer before the scene; of several of one name the first is saved.
    for block in reversed(shown):
        if f"Save this scene as `{block.title}`" in text:
            run_block(block, names)
    for block, following in pairwise(shown):
        printed = run_block(block, names)
        if block.language != "text" and following.language == "text":
            assert shows(following.text, printed), printed
        elif block.language == "python":
            assert not printed, "it prints something that is not shown"


@pytest.mark.parametrize(
    "page", sorted((DOCS / "machines").glob("*.md")), ids=lambda page: page.stem
)
def test_machine_pages_answer_with_printed_figures(page: Path) -> None:
    """Each figure in the table of answers is in an output of the page."""
    text = page.read_text("utf-8")
    outputs = "\n".join(block.text for block in blocks(text) if block.language == "text")
    printed = set(re.findall(FIGURE, outputs.replace(" deg", "°")))
    answers = re.findall(r"^\| [^|]*\? \| (.*) \|$", text, re.MULTILINE)
    assert len(answers) >= 4
    found = set(re.findall(FIGURE, " ".join(answers).replace(" %", "%")))
    assert found - printed == set()


def test_snippets_use_what_is_public() -> None:
    private = re.compile(r"\b(from|import) cardan\.(app|arrays|design|evaluation|motion)\b")
    found = {
        page.name
        for page in PAGES
        for block in blocks(page.read_text(encoding="utf-8"))
        if block.language == "python" and private.search(block.text)
    }
    assert found == set()


@pytest.mark.parametrize("name", ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"])
def test_links(name: str) -> None:
    text = (ROOT / name).read_text("utf-8")
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", text)
    assert [link for link in links if not (ROOT / link).exists()] == []


def links(page: str) -> Iterator[str]:
    """The pages that a page links to, as paths below the documentation."""
    path = DOCS / page
    text = path.read_text("utf-8") if path.exists() else ""
    for link in re.findall(r"\]\((?!https?:)([^)#\s]+\.md)", text):
        yield Path(os.path.normpath(Path(page).parent / link)).as_posix()


def test_the_reference_has_every_public_name() -> None:
    pages = "".join(page.read_text("utf-8") for page in (DOCS / "reference").glob("*.md"))
    public = set(vars(cardan)["__all__"])
    names = {f"cardan.{name}" for name in public} - {"cardan.__version__"}
    names |= {f"cardan.interop.{name}" for name in ("jax", "scipy", "torch")}
    names |= {f"cardan.scene.{name}" for name in ("SceneResult", "StudyResult", "stream")}
    names |= {"cardan.interop.lazy.LazyDriveline", "cardan.files.map_parquet"}
    names |= {f"cardan.torsion.{name}" for name in set(torsion.__all__) - public}
    names |= {f"cardan.scene.cluster.{name}" for name in ("connect", "write_study", "Written")}
    assert {name for name in names if not re.search(rf"{re.escape(name)}\b", pages)} == set()


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
def test_script(script: Path, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    # Warnings are errors as they are in the tests.
    warnings = [f"-W{each}" for each in pytestconfig.getini("filterwarnings")]
    done = subprocess.run(
        [sys.executable, *warnings, str(script)], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == SHOWN.get(script.stem, done.stdout)
    assert done.stdout
    if script.stem == "grossmann":
        assert "<svg" in (tmp_path / "grossmann.svg").read_text(encoding="utf-8")


def test_the_documentation_shows_them() -> None:
    assert set(SHOWN) == {script.stem for script in SCRIPTS}


README = (ROOT / "README.md").read_text(encoding="utf-8")


SNIPPETS = re.findall(r"```(\w+)\n(.*?)```", README, re.DOTALL)


def test_the_python_snippets_print_what_stands_below_them() -> None:
    names: dict[str, object] = {}
    compared = 0
    for (language, code), (following, shown) in pairwise(SNIPPETS):
        if language == "python":
            assert following == "text"
            printed = StringIO()
            with redirect_stdout(printed):
                exec(code, names)
            assert printed.getvalue() == shown
            compared += 1
    assert compared == 2


def test_the_first_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = next(code for language, code in SNIPPETS if "cardan run" in code)
    scene = re.search(r"cardan run (\S+)", command)
    assert scene is not None
    shown = next(code for language, code in SNIPPETS if language == "text")
    monkeypatch.chdir(tmp_path)
    result = scripts.run("run", ROOT / scene[1])
    assert result.exit_code == 0, result.output
    assert result.output == shown
    shown = next(code for language, code in SNIPPETS if language == "toml")
    assert tomllib.loads(shown) == tomllib.loads((ROOT / scene[1]).read_text(encoding="utf-8"))


def test_the_accuracy_table_has_the_limits() -> None:
    table = README.split("## Accuracy and speed")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([^`]+)`.*? \| (\d+) ulp \| (\d+) ulp \|.*\| (\d+) ulp", table, re.M)
    assert len(rows) == table.count("\n| `") == 6
    for name, *shown in rows:
        row = OUTPUT_LIMITS[name]
        columns = (row["samples"], row["worst"], row["tolerance_0"])
        assert tuple(map(int, shown)) == columns, name


SITE_DOCS = Path(__file__).parents[3] / "docs"


MACHINES = Path(str(resources.files("cardan"))) / "app/scene/machines"


@pytest.fixture
def site_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The hook, with an empty cache."""
    spec = importlib.util.spec_from_file_location("site_files", SITE_DOCS / "site_files.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "CACHE", tmp_path / "drawn")
    return module


def linked(pattern: str) -> set[str]:
    """The addresses on the site of the files that pages link to."""
    found = set()
    for page in SITE_DOCS.rglob("*.md"):
        for link in re.findall(rf"\]\(({pattern})\)", page.read_text("utf-8")):
            found.add((page.parent / link).resolve().relative_to(SITE_DOCS).as_posix())
    return found


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
    assert 'src="machines/moving.html"' in (SITE_DOCS / "index.md").read_text("utf-8")


MAP_ROOT = next(
    folder for folder in Path(__file__).parents if (folder / "ARCHITECTURE.md").exists()
)


TEXT = (MAP_ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")


DECISIONS = MAP_ROOT / "docs" / "decisions"


FILES = sorted(path for path in DECISIONS.glob("*.md") if path.name != "index.md")


# Number, decision and measurement of each row.
ROWS = re.findall(
    r'^\| <a id="(\d+)"></a>(\d+) \| (.+) \| (.+) \|$',
    (DECISIONS / "index.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)


def paths(text: str) -> set[str]:
    """The paths in backticks: words with a slash, and names of files."""
    names = re.findall(r"`([\w./-]+)`", text)
    suffix = re.compile(r"\.(?:json|md|py|rs|toml|ya?ml)$")
    return {name for name in names if "/" in name or suffix.search(name)}


def test_every_path_exists() -> None:
    named = paths(TEXT)
    assert len(named) > 30
    assert {name for name in named if not (MAP_ROOT / name).exists()} == set()


@pytest.mark.parametrize(
    "part", ["rust/core/src", "python/cardan"], ids=["the core", "the package"]
)
def test_every_module_is_on_the_map(part: str) -> None:
    modules = {
        f"{part}/{folder.name}/"
        for folder in (MAP_ROOT / part).iterdir()
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
    package = MAP_ROOT / "python"
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


def test_links_to_decisions_have_their_target() -> None:
    names = {path.name for path in FILES} | {"index.md", *(f"index.md#{row[0]}" for row in ROWS)}
    linked = set()
    for folder in ("", "benches", "records", "docs/**"):
        for page in MAP_ROOT.glob(f"{folder}/*.md" if folder else "*.md"):
            text = page.read_text(encoding="utf-8")
            beside = "" if page.parent == DECISIONS else r"[\w./]*decisions/"
            linked |= set(re.findall(rf"\]\({beside}(\d{{4}}-[^)]+|index\.md[^)]*)\)", text))
    assert len(linked) > 20
    assert linked <= names
