"""The page on printed lines has every label that commands and reports print, and no other."""

from __future__ import annotations

import html
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from cardan.app.command import commands
from example_scenes import EXAMPLES, Answers, example

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGE = DOCS / "reference" / "lines.md"

_ITEM = r"(shaft|joint|bearing|point)s? \d+(?:(?:, | to | and )\d+)*"
_NUMBER = r"-?\d+(?:\.\d+)?"
# A name of a column, of a key or of a file, which is the scene's or that of an output.
_NAME = re.compile(r"[\w-]+([._][\w-]+)+")


def normal(label: str) -> str:
    """A label without numbers of shafts and joints, states, units and values."""
    label = re.sub(r", in .*| \[.*?\]| \(.*\)$|, (?:before|after)$|, at most .*", "", label)
    label = re.sub(r"^(?:a )?critical speeds? lies? .*", "critical speeds lie within", label)
    label = re.sub(rf", {_ITEM}(?=,|$)", "", label)
    label = re.sub(_ITEM, r"\1", label)
    label = re.sub(r", order \d+$", ", order", label)
    label = re.sub(r"^point, [xz]$", "point, y", label)
    label = re.sub(r", column '.*'$", ", column", label)
    label = re.sub(rf"^within {_NUMBER}(?:°| rad/s²)?$", "within", label)
    label = re.sub(rf"^{_NUMBER}(?= (?:%|Hz|rpm|to))", "N", label)
    label = re.sub(rf" to {_NUMBER} rpm$", " to N rpm", label)
    return label.strip().casefold()


def printed_labels(text: str) -> Iterator[str]:
    """The labels of a printed answer: of lines, findings and columns."""
    for paragraph in text.split("\n\n"):
        for line in paragraph.splitlines():
            if finding := re.match(r"- ([^:;.,]+(?:, (?:driving|coasting|last shaft))?): \S", line):
                yield normal(finding[1])
                continue
            cells = re.split(r" {2,}", line.strip())
            share = re.match(r" {4}(?:p|(?:cross|driving yoke|driven yoke) of )", line)
            if line.startswith("    ") and len(cells) < 3 and not share:
                continue
            if len(cells) == 1:
                continue
            is_head = len(cells) > 2 and not any(re.match(r"[-+\d]", cell) for cell in cells[1:])
            yield from map(normal, cells if is_head else cells[:1])


def names_of(scene: dict[str, Any]) -> Iterator[str]:
    """Names that a scene gives, which stand where labels do."""
    for section in ("states", "life"):
        yield from scene.get(section, {}).get("names", [])
    yield scene.get("title", "")


@cache
def given() -> frozenset[str]:
    """Names of states, steps and sizes in the examples, in the pages and in the table of sizes."""
    scenes = [path.read_text("utf-8") for path in EXAMPLES]
    for page in DOCS.rglob("*.md"):
        scenes += re.findall(
            r'^```toml title=".*?\.toml"\n((?!--8).*?)^```$', page.read_text("utf-8"), re.M | re.S
        )
    names = [name for scene in scenes for name in names_of(tomllib.loads(scene))]
    _, *sizes = (ROOT / "examples" / "joint_sizes.csv").read_text("utf-8").splitlines()
    return frozenset(map(normal, [*names, *(row.split(",")[0] for row in sizes)]))


def judged(labels: Iterator[str]) -> set[str]:
    """Labels that the program chose: not empty, not given by a scene, no names of columns."""
    return {
        label
        for label in labels
        if label and label not in given() and not _NAME.fullmatch(label.split(" ")[0])
    }


@cache
def explained() -> frozenset[str]:
    return frozenset(
        normal(label) for label in re.findall(r"^\| `(.+?)` \|", PAGE.read_text("utf-8"), re.M)
    )


def shown_in_pages() -> Iterator[str]:
    """What the pages show that commands print, which their own test compares with the commands."""
    for page in DOCS.rglob("*.md"):
        yield from re.findall(
            r"^```sh\n(?:cardan [^\n]*\n)+```\n+```text\n(.*?)^```$",
            page.read_text("utf-8"),
            re.DOTALL | re.MULTILINE,
        )


def done(*arguments: str) -> str:
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    return result.output


def labels_of_pages() -> set[str]:
    return judged(label for text in shown_in_pages() for label in printed_labels(text))


def labels_of_report(page: str) -> set[str]:
    cells = re.findall(r"<th[^>]*>(.*?)</th>", page, re.DOTALL)
    return judged(normal(html.unescape(re.sub("<.*?>", "", cell))) for cell in cells)


# What no example has: tolerances of twists, of crosses and of the teeth of splines.
TOLERANCED = """
[driveline]
bends_deg = [4, 4, 4]
[tolerances]
twists_deg = 1
cross_deg = 1
teeth = 36
samples = 100
"""


def test_labels_are_read_from_answers() -> None:
    answer = """
Forces over a turn [N]  largest      at   mean
  bearing 0, shaft 0      172.8  90.00°  84.09

Critical speeds
  2514 rpm   order 2 meets 83.79 Hz: 6863 N m of this order in shaft 2
             outside the speed range

Practice: within
- torsional excitation, last shaft: up to 9 rad/s²
    within the 300 rad/s² limit

A sentence of the answer, that is long: it has
two lines.
"""
    assert list(printed_labels(answer)) == [
        "forces over a turn",
        "largest",
        "at",
        "mean",
        "bearing",
        "n rpm",
        "torsional excitation, last shaft",
    ]


def test_page_explains_what_the_pages_show() -> None:
    found = labels_of_pages()
    assert len(found) > 100
    assert found - explained() == set()


@pytest.mark.parametrize("command", ["run", "check"])
def test_page_explains_what_examples_print(command: str, answered: Answers) -> None:
    for scene in EXAMPLES:
        found = judged(printed_labels(getattr(answered(scene), command).text))
        assert found
        assert found - explained() == set(), scene.stem


def test_page_explains_reports_and_nothing_else(tmp_path: Path, answered: Answers) -> None:
    found, toleranced = labels_of_pages(), tmp_path / "toleranced.toml"
    toleranced.write_text(TOLERANCED, encoding="utf-8")
    found |= judged(printed_labels(done("tolerances", str(toleranced))))
    for name in ("steering-column", "rumble"):
        found |= judged(printed_labels(answered(example(f"{name}.toml")).run.text))
    for name in ("truck-shaft", "steering-column", "suspension", "run_up", "ball_joint"):
        found |= labels_of_report(answered(example(f"{name}.toml")).page)
    assert found ^ explained() == set()
