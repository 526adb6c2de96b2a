"""What users read is plain English, in which one word always names one thing."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

AWKWARD = {
    r"keeps? the limits?": "is within the limit",
    r'after "at":': "Angles after 'at' are drive angles",
    r"set so(?! that)": "with this setting",
    r"(?<!\d)1 files": "1 file",
    r"of them found there": "already complete",
    r"is there \d+ times": "appears twice",
    r"has no such place": "does not exist",
    r"above all sections": "top level",
    r"in exactly one way; needed": "required; give exactly one",
    r"m across it": "bending moment of the shaft",
    r"what the bearings give each shaft": "bending reaction of each shaft",
    r"drawn true": "to scale",
    r"phased right": "only with the right bends and phasing",
    r"what an engineer wants to know": "say what",
    r"to hand on": "to share",
    r"turning at a slider": "with a slider that turns the driveline",
    r"angles of any number": "recordings of any length",
    r"is said in one line": "is reported in one line",
    r"beside it stands?": "also included",
    r"what repeats is computed once": "whole turns are computed once",
    r"that are there": "existing",
    r"read in grey": "readable in greyscale",
    r"and angles to the largest": "any angle",
    r"worst of (a search|all searches)": "worst error in long searches",
    r"where a peer wins": "where others are faster",
    r"at its error": "at equal error",
    r"the way of one call": "the path of a call",
    r"killed anywhere": "if the run stops",
    r"command goes on": "the command resumes",
    r"it is folded with error terms": "as accurate as …, because …",
    r"is wanted of it": "the results you want",
    r"count as slow": "are assumed to vary slowly",
    r"by chunks": "in chunks",
    r"says it all": "say it",
    r"what pays more": "better than lowering accuracy",
    r"cores, small ones one": "small calls use one thread",
    r"pass on a moment": "transmit a moment",
    r"make up for the rest": "supply the difference",
    r"decides on the inverse tangent": "determines the number of terms",
    r"sweep stands at": "a sweep uses the exact angles",
    r"nothing of it comes from": "shares no code with",
    r"have too few doubles": "would underflow",
    r"nothing holds in place": "behaviour that no test covers",
    r"a bar on the way": "a progress bar",
    r"the same bits as in one process": "identical to those of a single process",
    r"some tenths": "a few tenths",
    r"up to their sign": "sign left open",
    r"he sets right": "he corrects",
    r"along the travel": "from the drive towards the output",
}
"""Phrases at which a native engineer stumbles, as patterns, each with a plainer one."""

TERMS = {
    r"strings? of (three )?joints?": "multi-joint driveline",
    r"driving angles?": "drive angle; of a joint within a driveline: the joint's input angle",
    r"forks?": "yoke",
}
"""Words that the project does not use for what another word names."""

ALLOWED = {
    ("docs/glossary.md", "in catalogues also fork"): "forks?",
    ("docs/glossary.md", "the fork-shaped end of a shaft"): "forks?",
    ("docs/start.md", "its fork signs"): "forks?",
    ("docs/reference/lines.md", "its fork signs"): "forks?",
    ("python/cardan/figures/catalogue.py", "its fork signs"): "forks?",
    ("python/cardan/words/yokes.py", "its fork signs"): "forks?",
    ("docs/theory/sources.md", "in the catalogues: fork)"): "forks?",
    ("docs/decisions/0010-forked-processes-use-one-thread.md", "survive a fork."): "forks?",
    ("docs/decisions/0010-forked-processes-use-one-thread.md", "After a fork every"): "forks?",
    ("docs/decisions/0010-forked-processes-use-one-thread.md", "records the fork;"): "forks?",
    ("docs/decisions/0010-forked-processes-use-one-thread.md", "test forks three"): "forks?",
    ("docs/decisions/0010-forked-processes-use-one-thread.md", 'method "fork"'): "forks?",
}
"""Where a term is a catalogue's that is explained, or means something else."""


def texts() -> Iterator[tuple[str, str]]:
    """What users read: the file that it is from, and a text with single spaces."""
    for path in _files():
        text = path.read_text(encoding="utf-8")
        parts = {".py": _constants, ".rs": _documentation, ".js": _quoted}.get(path.suffix)
        for part in parts(text) if parts else [text]:
            yield path.relative_to(ROOT).as_posix(), " ".join(part.split())


def _files() -> Iterator[Path]:
    for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "rust/core/README.md"):
        yield ROOT / name
    for folder, suffixes in {
        "docs": (".md", ".py"),
        "benches": (".md", ".py"),
        "examples": (".py", ".toml"),
        "python/cardan": (".py", ".pyi", ".html", ".js"),
        "rust/stress": (".md",),
        "rust/core/src": (".rs",),
    }.items():
        yield from (path for path in sorted((ROOT / folder).rglob("*")) if path.suffix in suffixes)


def _constants(source: str) -> Iterator[str]:
    """Docstrings and all other strings; what an f-string inserts reads as 2."""
    for node in ast.walk(ast.parse(source)):
        parts = node.values if isinstance(node, ast.JoinedStr) else [node]
        words = [part.value if isinstance(part, ast.Constant) else "2" for part in parts]
        if isinstance(node, ast.Constant | ast.JoinedStr):
            yield "".join(map(str, words))


def _documentation(source: str) -> Iterator[str]:
    """Comments that rustdoc shows, and strings on one line."""
    for block in re.findall(r"(?:^ *//[/!].*\n)+", source, re.MULTILINE):
        yield re.sub(r"^ *//[/!]", "", block, flags=re.MULTILINE)
    yield from _quoted(re.sub(r"^ *//.*", "", source, flags=re.MULTILINE))


def _quoted(source: str) -> list[str]:
    return re.findall(r'"[^"\n]*"|`[^`]*`', source)


def found(words: str, places: list[tuple[str, str]]) -> list[str]:
    """The files with a phrase, each with what is around it."""
    pattern = re.compile(rf"(?<!\w)(?:{words})(?!\w)", re.IGNORECASE)
    hits = []
    for file, text in places:
        for (where, phrase), allowed in ALLOWED.items():
            if (where, allowed) == (file, words):
                text = text.replace(phrase, "")
        for hit in pattern.finditer(text):
            hits.append(f"{file}: …{text[max(0, hit.start() - 40) : hit.end() + 40]}…")
    return hits


PLACES = list(texts())


@pytest.mark.parametrize("phrase", AWKWARD)
def test_no_awkward_phrase(phrase: str) -> None:
    hits = found(phrase, PLACES)
    assert not hits, "\n".join([f"write: {AWKWARD[phrase]}", *hits])


@pytest.mark.parametrize("term", TERMS)
def test_one_word_for_one_thing(term: str) -> None:
    hits = found(term, PLACES)
    assert not hits, "\n".join([f"write: {TERMS[term]}", *hits])


def test_exceptions_are_needed() -> None:
    for (file, phrase), term in ALLOWED.items():
        assert re.search(rf"\b(?:{term})\b", phrase)
        assert any(where == file and phrase in text for where, text in PLACES), (file, phrase)


def test_every_kind_of_text_is_read() -> None:
    def read(parts: Callable[[str], Iterable[str]], source: str) -> bool:
        return bool(found("driving angle", [("file", " ".join(p.split())) for p in parts(source)]))

    assert read(_constants, 'x = f"{1} driving angle"')
    assert "is 2 times" in _constants('x = f"is {3} times"')
    assert read(_constants, '"""Of a driving\n    angle."""')
    assert not read(_constants, "x = 1  # driving angle")
    assert read(_documentation, "    /// Of a driving\n    /// angle.\n    x();\n")
    assert read(_documentation, '#[error("driving angle")]\n')
    assert not read(_documentation, "// driving angle\nlet driving = angle;\n")
    assert {Path(file).suffix for file, _ in PLACES} >= {".md", ".py", ".rs", ".html", ".toml"}
