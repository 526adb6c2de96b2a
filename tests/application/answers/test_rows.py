"""What figures are called, with how many digits they are shown, and that labels are explained."""

from __future__ import annotations

import html
import json
import math
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import assume, example, given
from hypothesis import strategies as st

import tiers
from cardan.app.answers.answer import Answer
from cardan.app.answers.identification import Identified
from cardan.app.answers.limits import check_text
from cardan.app.answers.printed import (
    number_text,
    quantity,
    range_ends,
    row_text,
    use_text,
)
from cardan.app.answers.rows import DIGITS, UNITS, Judged, Rounds, Row, element_of, rows_of
from cardan.app.answers.states import StatesFigures
from cardan.app.answers.study import StudyFigures
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import TurnFigures
from cardan.app.answers.yokes.figures import YokeFigures, scene_advice, yoke_settings
from cardan.app.answers.yokes.text import remedies, yoke_lines, yoke_text
from cardan.app.command import commands
from cardan.app.scene import Scene, load_scene
from cardan.design.limits import PRESETS
from example_scenes import EXAMPLES, SHORT, Answers
from example_scenes import example as scene_of

# The answers of run, phase and identify, which are no parts of others.
OTHERS = {
    "run": TurnFigures,
    "run.study": StudyFigures,
    "run.states": StatesFigures,
    "phase": YokeFigures,
    "identify": Identified,
}


RECORD = Path(__file__).parent / "rows.txt"


def rows() -> Iterator[str]:
    """Yield a line for each field: its key, what it holds, its label and the key of its limit."""

    def of(path: str, figures: type) -> Iterator[str]:
        for name, row, hint in rows_of(figures):
            key = f"{path}.{name}{row.ending()}"
            yield "  ".join(filter(None, (key, row.kind, row.label, row.limit)))
            if row.kind == "parts":
                yield from of(key, element_of(hint))

    every = {name: part.figures() for name, part in PARTS.items()} | OTHERS
    for name, figures in every.items():
        yield from of(name, figures)


def test_units_are_what_they_are_called() -> None:
    """How many of each are one unit of the library: rad, m, Pa, rad/s, or a part of one."""
    turn = 2.0 * math.pi
    expected = {
        "deg": 360.0 / turn,
        "mm": 1000.0,
        "rpm": 60.0 / turn,
        "MPa": 1e-6,
        "percent": 100.0,
    }
    expected |= {"Hz": 1.0 / turn, "rpm_deg": 60.0 / turn * 360.0 / turn}
    expected |= {"GPa": 1e-9, "um_per_MPa": 1e12, "N_per_mm": 1e-3, "gmm": 1e6}
    inch, pound = 0.0254, 0.45359237
    force = 9.80665 * pound
    torque, pressure = 12.0 * inch * force, force / inch**2
    us = {"in": inch, "ft": 12.0 * inch, "lbf": force, "lbft": torque, "lbin": torque / 12.0}
    us |= {"lbin2": pound * inch**2, "lbft_per_rad": torque, "lbfts_per_rad": torque}
    us |= {"psi": pressure, "Mpsi": 1e6 * pressure, "uin_per_psi": 1e-6 * inch / pressure}
    us |= {"deg_per_klbft": 1.0 / torque, "in_per_klbft": 1000.0 * inch / torque}
    us |= {"lb": pound, "lb_in3": pound / inch**3}
    us |= {"lbf_per_in": force / inch, "lbfs_per_in": force / inch, "ozin": pound / 16.0 * inch}
    expected |= {name: 1.0 / size for name, size in us.items()}
    for name, unit in UNITS.items():
        assert unit.factor == pytest.approx(expected.get(name, 1.0), rel=1e-14), name


def test_every_figure_is_called_as_recorded() -> None:
    assert list(rows()) == RECORD.read_text(encoding="utf-8").splitlines()


if __name__ == "__main__":
    RECORD.write_text("".join(f"{row}\n" for row in rows()), encoding="utf-8")


# Kinds whose digits are a rule, not all that were given.
RULES = sorted(kind for kind, rule in DIGITS.items() if rule.decimals or rule.digits)


SIZES = st.floats(1e-4, 5e6)


VALUES = st.one_of(SIZES, SIZES.map(lambda size: -size))


def sides(value: float, other: float) -> int:
    return (value > other) - (value < other)


def every_row() -> Iterator[Row]:
    def of(figures: type) -> Iterator[Row]:
        for _, row, hint in rows_of(figures):
            yield row
            if row.kind == "parts":
                yield from of(element_of(hint))

    for figures in (*(part.figures() for part in PARTS.values()), *OTHERS.values()):
        yield from of(figures)


def test_the_table_has_every_unit_and_every_kind_of_figure() -> None:
    assert set(UNITS) <= set(DIGITS)
    kinds = {row.digits for row in every_row()} - {""}
    assert kinds <= set(DIGITS)
    assert kinds >= {"phase", "margin", "given", "share"}
    assert {row.rounds for row in every_row()} == set(get_args(Rounds))
    # A page reads the table as data.
    data = json.loads(json.dumps({kind: rule._asdict() for kind, rule in DIGITS.items()}))
    assert data["deg"] == {"decimals": 2, "digits": None, "apart": None, "finest": 1e-6}


@pytest.mark.parametrize(
    ("number", "kind", "text"),
    [
        (4.27349, "deg", "4.27"),
        (19.3961, "phase", "19.4"),
        (1507.0412, "mm", "1507.0"),
        (636.6, "rad_s2", "637"),
        (10386.6, "h", "10387"),
        (36.273, "N", "36.3"),
        (99.96, "N", "100"),
        (228535.2, "Nm_per_rad", "228535"),
        (0.0055671, "", "0.00557"),
        (58.871, "MPa", "58.9"),
        (4.8689, "margin", "4.87"),
        (99.999, "percent", "99.999"),
        (100.0, "percent", "100"),
        (1.0000042, "speed_ratio", "1.000004"),
        (0.0, "mm", "0"),
        (-0.0, "deg", "0"),
        (-0.0, "N", "0"),
        (0.004, "deg", "0.004"),
        (-0.0004, "deg", "-0.0004"),
        (1e-9, "deg", "0"),
        (math.inf, "N", "inf"),
        (2.5e9, "N", "2.50e+09"),
        (-259.99999999999994, "given", "-260"),
        (0.00005, "given", "0.00005"),
    ],
)
def test_digits_follow_the_table(number: float, kind: str, text: str) -> None:
    assert number_text(number, kind) == text


@given(VALUES, st.sampled_from(RULES))
def test_a_figure_is_near_what_is_shown_and_never_reads_0(value: float, kind: str) -> None:
    text, rule = number_text(value, kind), DIGITS[kind]
    assume(abs(value) >= rule.finest)
    assert float(text) != 0.0
    assert "e" not in text
    decimals = len(text.partition(".")[2])
    assert abs(float(text) - value) <= 0.5000001 * 10.0**-decimals
    if rule.decimals is not None:
        assert decimals >= rule.decimals
    elif abs(value) < 99.0:
        assert len(re.sub(r"^-?0*\.?0*|\.", "", text)) >= (rule.digits or 0)


@given(SIZES, st.one_of(st.floats(-3e-7, 3e-7), st.floats(-0.5, 0.5)), st.sampled_from(RULES))
@example(3.0, 1e-6, "deg")
@example(4.0049, 4e-5, "deg")
@example(1e-4, 1.1e-7, "twist")  # a limit finer than what is shown of a twist
def test_a_figure_never_reads_as_its_limit(size: float, apart: float, kind: str) -> None:
    """Both are on their sides of each other, unless they differ by rounding only."""
    limit, value = float(f"{size:.6g}"), size * (1.0 + apart)
    assume(abs(value - limit) > 2e-9 * limit)
    shown = number_text(value, kind, apart_from=[limit])
    assert sides(float(shown), float(number_text(limit, "given"))) == sides(value, limit)
    assert abs(float(shown) - value) <= 0.5000001 * 10.0 ** -len(shown.partition(".")[2])


@given(SIZES, st.sampled_from(RULES))
def test_a_figure_at_its_limit_reads_as_it_is_given(size: float, kind: str) -> None:
    limit = float(f"{size:.6g}")
    assume(limit != DIGITS[kind].apart)
    shown = number_text(limit * (1.0 + 1e-13), kind, apart_from=[limit])
    assert shown == number_text(limit, "given")


@given(SIZES, st.sampled_from(RULES))
def test_what_must_suffice_is_rounded_to_the_safe_side(value: float, kind: str) -> None:
    """And not by more than a tenth, so that small changes stay small."""
    assume(value >= DIGITS[kind].finest)
    up, down = (float(number_text(value, kind, rounds=way)) for way in ("up", "down"))
    assert down * (1.0 - 1e-11) <= value <= up * (1.0 + 1e-11)
    assert up <= 1.11 * value
    assert down >= 0.89 * value


@given(VALUES, st.floats(2e-3, 1.0), st.sampled_from(RULES))
def test_both_ends_of_a_range_differ(low: float, share: float, kind: str) -> None:
    high = low + share * abs(low)
    assume(min(abs(low), abs(high)) >= max(1e-4, DIGITS[kind].finest))
    texts = range_ends(low, high, kind)
    assert float(texts[0]) < float(texts[1])
    assert not any(re.fullmatch(r"-?0\.?0*", text) for text in texts)


@given(st.floats(1e-3, 20.0))
@example(0.9999)
@example(1.0001)
def test_only_a_limit_that_is_used_exactly_is_used_by_100_percent(share: float) -> None:
    percent = int(use_text(share).removesuffix("%"))
    assert (percent > 100) - (percent < 100) == sides(share, 1.0)
    assert abs(percent - 100.0 * share) <= 1.0


def test_a_judged_figure_is_told_apart_from_limit_and_maximum() -> None:
    bend = Judged(math.radians(4.004), math.radians(4.0), math.radians(4.01))
    row = Row("figure", "bend", "deg", limit="[limits] equivalent_bend_deg")
    assert row_text(bend, row) == "4.004°"
    assert row_text(Judged(math.radians(4.0), math.radians(4.0)), row) == "4°"
    assert quantity(math.radians(4.004), "deg") == "4.00°"
    shown = row_text(bend, row, radians=True)
    assert math.radians(4.0) < float(shown.removesuffix(" rad")) < math.radians(4.01)


SCENE = """[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [900, 200, 0], [1200, 231.4, 0]]
[limits]
equivalent_bend_deg = {limit}
"""


def test_a_bend_just_beyond_its_limit_is_seen_everywhere() -> None:
    bend = float(np.degrees(Scene.parse(SCENE.format(limit=3)).line.equivalent().bend))
    scene = Scene.parse(SCENE.format(limit=round(bend - 4e-4, 5)))
    answer, advice = Answer(scene), scene_advice(scene)
    assert advice
    for text, said in (
        (PARTS["limits"].text(answer["limits"], brief=True), r"([\d.]+)°; at most ([\d.]+)°"),
        (check_text(answer), r"([\d.]+)°, 0.0004° above the limit of ([\d.]+)°"),
        (yoke_text("", yoke_settings(scene)), r"([\d.]+)°, 0.0004° above the limit of ([\d.]+)°"),
        (" ".join(remedies(advice)), r"leaves ([\d.]+)°\..*limit of ([\d.]+)°"),
    ):
        found = re.search(said, " ".join(text.split()))
        assert found, text
        assert float(found[1]) > float(found[2]) == round(bend - 4e-4, 5)


@pytest.mark.parametrize("limit", [0.1, 0.3, 3.0])
def test_turns_of_yokes_keep_the_limit_as_they_are_said(limit: float) -> None:
    """Of bends that cancel each other the twentieth of a degree leaves 0.4 degrees."""
    text = f"""[driveline]
    bends_deg = [10, 10]
    twists_deg = 33.377
    [limits]
    equivalent_bend_deg = {limit}
    """
    scene = Scene.parse(text)
    found = yoke_settings(scene)
    (line,) = yoke_lines(found)
    said, sense = re.findall(r"turn it ([\d.]+)° (clockwise|counter-clockwise)", line)[0]
    turn = math.radians(float(said)) * (1.0 if sense == "clockwise" else -1.0)
    left = scene.line.with_phases(scene.line.phases + turn).equivalent().bend
    assert math.degrees(left) <= limit
    assert (len(said.partition(".")[2]) > 1) == (limit < 0.2)


def test_scenes_are_shown_as_they_were_given() -> None:
    text = PARTS["life"].text(Answer(load_scene(scene_of("truck-shaft.toml")))["life"])
    assert re.search(r"torque +4000 N m +1500 N m +900 N m\n", text)
    assert "required life  15000 h" in text


ROOT = Path(__file__).parents[3]


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
def lines_given() -> frozenset[str]:
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
        and label not in lines_given()
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
def lines_rows() -> frozenset[str]:
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
        assert (of_rows - lines_rows() | others) - explained() == set(), scene.stem


@pytest.mark.long
def test_page_explains_what_rows_do_not_and_nothing_else(tmp_path: Path, answered: Answers) -> None:
    toleranced = tmp_path / "toleranced.toml"
    toleranced.write_text(TOLERANCED, encoding="utf-8")
    texts = [*shown_in_pages(), done("tolerances", str(toleranced))]
    texts += [answered(scene).run.text for scene in EXAMPLES]
    of_rows = judged(label for text in texts for label in labels_of_rows(text))
    for name in ("truck-shaft", "steering-column", "suspension", "run_up", "ball_joint"):
        of_rows |= labels_of_report(answered(scene_of(f"{name}.toml")).page)
    supported = tmp_path / "supported.toml"
    text = scene_of("shudder.toml").read_text("utf-8")
    two = "stiffness_N_per_mm = [300, 250]\naxis = [0, 1, 0]\ndamping_Ns_per_m = 100"
    supported.write_text(text.replace("stiffness_N_per_mm = 300", two), encoding="utf-8")
    of_rows |= labels_of_report(answered(supported).page)
    assert len(of_rows) > 100
    others = judged(label for text in texts for label in printed_labels(text))
    # Published limits are listed by the names that scenes give them.
    assert (of_rows - lines_rows() | others) - {*PRESETS} ^ explained() == set()
