"""What the documentation shows is what happens: every snippet of every page runs, in order."""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from itertools import combinations, pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from click.testing import CliRunner

import cardan
from cardan import torsion
from cardan.app.command import commands
from cardan.app.scene.starters import STARTERS

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
HOME = (DOCS / "index.md").read_text("utf-8")
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


@pytest.mark.parametrize(
    ("text", "right"),
    [
        ("a\nb\nc", True),
        ("a\n…\nc", True),
        ("…\nc", True),
        ("a\n…", True),
        ("a\nc", False),
        ("…\nb", False),
        ("…\na\n…", False),
        ("c\n…", False),
    ],
)
def test_what_a_page_leaves_out_is_marked(text: str, right: bool) -> None:
    assert shows(text, "a\nb\nc\n") == right


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


@pytest.mark.parametrize(
    ("before", "leading"),
    [
        ("<mo>&#x0003D;</mo>", True),
        ('<mo>&#x0002C;</mo><mspace width="0.278em" />', True),
        ('<mo stretchy="false">&#x00028;</mo>', True),
        ('<mo stretchy="false">&#x00029;</mo>', False),
        ("<mi>a</mi>", False),
    ],
)
def test_a_minus_with_nothing_before_it_stands_next_to_its_term(
    before: str, leading: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    converter = ModuleType("latex2mathml.converter")
    row = f"<mrow>{before}<mo>&#x02212;</mo><mi>b</mi></mrow>"
    monkeypatch.setattr(converter, "convert", lambda *_, **__: row, raising=False)
    monkeypatch.setitem(sys.modules, "latex2mathml", ModuleType("latex2mathml"))
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", converter)
    monkeypatch.syspath_prepend(DOCS)
    hooks = _module(DOCS / "hooks.py")
    shown = re.sub(hooks._FORMULA, hooks._formula, '<span class="arithmatex">-b</span>')
    assert ('<mo form="prefix">&#x02212;</mo>' in shown) == leading


def test_pages_name_the_files_of_their_scenes() -> None:
    """Who reads a page in the repository does not see what the site includes."""
    for page in PAGES:
        text = page.read_text("utf-8")
        for title, file in re.findall(r'^```toml title="(.*?)"\n--8<-- "(.*?)"\n', text, re.M):
            named = f"This scene is `{file}` in the repository." in text
            saved = f"Save this scene as `{title}`. In the repository it is `{file}`." in text
            writes = f"`cardan new {Path(title).stem} {title}` writes this scene."
            new = f"{writes} In the repository it is\n`{file}`." in text
            assert named or saved or new or page.name == "examples.md", page


def test_attributes_of_pictures_are_on_one_line() -> None:
    """An attribute list that is broken over two lines would be shown as text."""
    for page in PAGES:
        assert not re.search(r"\)\{[^}\n]*$", page.read_text("utf-8"), re.MULTILINE), page


def test_snippets_use_what_is_public() -> None:
    private = re.compile(r"\b(from|import) cardan\.(app|arrays|design|evaluation|motion)\b")
    found = {
        page.name
        for page in PAGES
        for block in blocks(page.read_text(encoding="utf-8"))
        if block.language == "python" and private.search(block.text)
    }
    assert found == set()


def test_there_is_something_to_run() -> None:
    languages = [block.language for page in PAGES for block in blocks(page.read_text("utf-8"))]
    assert languages.count("python") >= 30
    assert languages.count("text") >= 35


def test_drawings_of_machines_have_lengths_and_bends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each number is what the scene gives, and no label covers another or leaves its drawing."""
    monkeypatch.syspath_prepend(DOCS / "drawings")
    drawn_states = {"pto-shaft": 2}
    kinds = [kind for kind, starter in STARTERS.items() if starter.machine]
    drawings = _module(DOCS / "drawings" / "machines.py").DRAWINGS
    for kind, draw in zip(kinds, drawings, strict=True):
        scene = cardan.Scene.parse(STARTERS[kind].text)
        line = scene.in_state(drawn_states[kind]).line if kind in drawn_states else scene.line
        drawn = draw()
        texts = [text for text, _ in drawn.labels]
        for length in 1e3 * line.lengths().each[1:-1]:
            assert texts.count(f"{length:.4g} mm") == 1
        for joint, bend in enumerate(np.degrees(line.bends)):
            # The rig has arcs of its two bends.
            named = "9°" if kind == "test-rig" else f"joint {joint}, {bend:.3g}°"
            assert named in texts
        for (_, one), (_, other) in combinations(drawn.labels, 2):
            aside = one[2] < other[0] or other[2] < one[0]
            assert aside or one[3] < other[1] or other[3] < one[1]
        for _, (left, low, right, high) in drawn.labels:
            assert min(left, low) >= 0.0
            assert right <= drawn.size[0]
            assert high <= drawn.size[1]


@pytest.mark.parametrize("name", ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"])
def test_links(name: str) -> None:
    text = (ROOT / name).read_text("utf-8")
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", text)
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_contributing_names_what_ci_runs() -> None:
    ci = "".join((ROOT / ".ci" / name).read_text("utf-8") for name in ("run", "packages"))
    shown = [block.text for block in blocks((ROOT / "CONTRIBUTING.md").read_text("utf-8"))]
    before_a_change = next(text for text in shown if "cargo clippy" in text)
    steps = {step.split("#")[0].strip() for step in re.split(r"&&|\n", before_a_change)} - {""}
    assert {step for step in steps if step not in ci and "pip install" not in step} == set()


def test_the_navigation_is_short_and_leads_to_every_page() -> None:
    """Pages that are not in it are on the pages that overviews and others link to."""
    text = (ROOT / "mkdocs.yml").read_text("utf-8")
    listed = re.findall(r"- (?:Home: )?([\w/-]+\.md)$", text.partition("\nnav:\n")[2], re.M)
    # The list of figures is made when the site is built, and all decisions are on one page.
    decisions = set((DOCS / "decisions").glob("0*.md"))
    pages = {page.relative_to(DOCS).as_posix() for page in set(PAGES) - decisions}
    pages.add("reference/figures.md")
    assert len(listed) <= 52
    assert len(pages) <= 80
    assert set(listed) <= pages
    found, ahead = set[str](), set(listed)
    while ahead:
        found |= ahead
        ahead = {link for page in ahead for link in links(page)} & pages - found
    assert found == pages


def links(page: str) -> Iterator[str]:
    """The pages that a page links to, as paths below the documentation."""
    path = DOCS / page
    text = path.read_text("utf-8") if path.exists() else ""
    for link in re.findall(r"\]\((?!https?:)([^)#\s]+\.md)", text):
        yield Path(os.path.normpath(Path(page).parent / link)).as_posix()


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("Which bearing carries how many newtons?", "bearing 0"),
        ("How do I phase three joints?", "optimal_phases"),
        ("How accurate is it?", "ulp"),
        ("A million geometries", "A million drivelines"),
        ("It shudders at launch", "cardan lateral"),
        ("I have an inclinometer and three readings", "readings_deg"),
    ],
)
def test_home_answers_a_question_with_its_link(question: str, answer: str) -> None:
    link = re.search(rf"\[\*\*{re.escape(question)}\*\*\]\((.*?\.md)", HOME)
    assert link is not None
    assert answer in (DOCS / link[1]).read_text("utf-8")


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


def _module(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
