"""Every printed label is explained: by a row of a part, or else by the page on printed lines.

That page explains what the rows do not, and nothing that nothing prints.
"""

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

import tiers
from cardan.app.answers.identification import Identified
from cardan.app.answers.rows import element_of, rows_of
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.design.limits import PRESETS
from example_scenes import EXAMPLES, SHORT, Answers, example

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGE = DOCS / "reference" / "lines.md"

_ITEM = r"(shaft|joint|bearing|point|mode)s? \d+(?:(?:, | to | and )\d+)*"
_NUMBER = r"-?\d+(?:\.\d+)?"
# A name of a column, of a key or of a file, which is the scene's or that of an output.
_NAME = re.compile(r"[\w-]+([._][\w-]+)+")
# What a paragraph begins with whose labels are those of rows: a part, a recording, a verdict.
_OWN = ("Beyond", "Tolerable", "What would help", "Not judged", "Constant drive speed")
_TITLES = "|".join([*(part.title for part in PARTS.values()), *_OWN])
_OF_ROWS = re.compile(rf"(?:{_TITLES})(?: of {_ITEM}|: .*)?$|\S+\.(?:csv|npz|mf4|parquet)$")


def normal(label: str) -> str:
    """A label without numbers of shafts and joints, states, units and values."""
    label = re.sub(
        r", in .*| \[.*?\]| \(.*\)$|, (?:before|after)$|, at (?:most|least) .*", "", label
    )
    label = re.sub(rf"(?:,| of) {_ITEM}(?=,|$)", "", label)
    label = re.sub(_ITEM, r"\1", label)
    label = re.sub(r"^point, [xz]$", "point, y", label)
    label = re.sub(r", column '.*'$", ", column", label)
    return label.strip().casefold()


def paragraphs(text: str, *, of_rows: bool) -> Iterator[list[str]]:
    """The lines of each paragraph of a printed answer, of those of rows or of the others."""
    for paragraph in text.split("\n\n"):
        lines = paragraph.strip("\n").splitlines()
        if lines and bool(_OF_ROWS.match(lines[0])) == of_rows:
            yield lines


def labels_of_rows(text: str) -> Iterator[str]:
    """The labels of parts in a printed answer, the first item of each table among them."""
    for lines in paragraphs(text, of_rows=True):
        for line in lines[1:]:
            cells = re.split(r" {2,}", line.strip())
            if len(cells) > 1:
                yield normal(cells[0])


def printed_labels(text: str) -> Iterator[str]:
    """The labels of a printed answer besides its parts: of lines, of the list of yokes, columns."""
    for lines in paragraphs(text, of_rows=False):
        for line in lines:
            if finding := re.match(r"- ([^:;.,]+): \S", line):
                yield normal(finding[1])
                continue
            cells = re.split(r" {2,}", line.strip())
            if len(cells) == 1 or (line.startswith("    ") and len(cells) < 3):
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
    """Labels that the program chose: not empty, not given by a scene, no names of columns.

    Rows of items without a name begin with a figure.
    """
    return {
        label
        for label in labels
        if label
        and label not in given()
        and not _NAME.fullmatch(label.split(" ")[0])
        and not re.fullmatch(rf"{_NUMBER}(?: rpm)?", label)
    }


@cache
def explained() -> frozenset[str]:
    """The labels of the page."""
    return frozenset(
        normal(label) for label in re.findall(r"^\| `(.+?)` \|", PAGE.read_text("utf-8"), re.M)
    )


def labels_in(of: type) -> Iterator[str]:
    """The labels of the rows of a dataclass, and of its parts."""
    for _, row, hint in rows_of(of):
        yield row.label
        if row.kind == "parts":
            yield from labels_in(element_of(hint))


@cache
def rows() -> frozenset[str]:
    """The labels of all rows, and what tables put below them."""
    found = [Identified, *(part.figures() for part in PARTS.values())]
    return frozenset(
        map(normal, ["limit", "worst", *(name for of in found for name in labels_in(of))])
    )


def shown_in_pages() -> Iterator[str]:
    """What the pages show that commands print, which their own test compares with the commands."""
    for page in DOCS.rglob("*.md"):
        texts = re.findall(
            r"^```sh\n(?:cardan [^\n]*\n)+```\n+```text\n(.*?)^```$",
            page.read_text("utf-8"),
            re.DOTALL | re.MULTILINE,
        )
        # Those that leave lines out do not say of which part a label is.
        yield from (text for text in texts if "…\n" not in text)


def done(*arguments: str) -> str:
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    return result.output


def labels_of_report(page: str) -> set[str]:
    # The rows of limits have the names of figures with those of their parts and items.
    page = re.sub(r"(<caption>Limits</caption>.*?</thead>).*?</table>", r"\1", page, flags=re.S)
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
Beyond its limit: the margin of the tube of shaft 1.

Beyond
- margin of the tube of shaft 1: 1.489, 0.01059 below the limit of 1.5 (own
  limit)

Spline of shaft 2
  shortest length  1501 mm in bump
  Added to the bearings
                      bearing 0  bearing 1
    force, at most 5 N      4 N        3 N
      worst             in bump  in bounce
  Critical speeds
    mode  drive speed
    0        2514 rpm

Equivalent bend    now   best
  ride height       2°     1°

A sentence of the answer, that is long: it has
two lines.
"""
    assert list(labels_of_rows(answer)) == [
        "shortest length",
        "bearing",
        "force",
        "worst",
        "mode",
        "0",
    ]
    assert list(printed_labels(answer)) == [
        "equivalent bend",
        "now",
        "best",
        "ride height",
    ]


@pytest.mark.parametrize("command", ["run", "check"])
def test_rows_and_page_explain_what_examples_print(command: str, answered: Answers) -> None:
    for scene in EXAMPLES if tiers.whole else SHORT:
        text = getattr(answered(scene), command).text
        of_rows, others = judged(labels_of_rows(text)), judged(printed_labels(text))
        assert of_rows | others
        assert (of_rows - rows() | others) - explained() == set(), scene.stem


@pytest.mark.long
def test_page_explains_what_rows_do_not_and_nothing_else(tmp_path: Path, answered: Answers) -> None:
    toleranced = tmp_path / "toleranced.toml"
    toleranced.write_text(TOLERANCED, encoding="utf-8")
    texts = [*shown_in_pages(), done("tolerances", str(toleranced))]
    texts += [answered(scene).run.text for scene in EXAMPLES]
    of_rows = judged(label for text in texts for label in labels_of_rows(text))
    for name in ("truck-shaft", "steering-column", "suspension", "run_up", "ball_joint"):
        of_rows |= labels_of_report(answered(example(f"{name}.toml")).page)
    assert len(of_rows) > 100
    others = judged(label for text in texts for label in printed_labels(text))
    # Published limits are listed by the names that scenes give them.
    assert (of_rows - rows() | others) - {*PRESETS} ^ explained() == set()
