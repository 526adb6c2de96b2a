"""With how many digits figures are shown: by one table, and never so that they mislead."""

from __future__ import annotations

import html
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from test_rows import OTHERS

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits import check_text
from cardan.app.answers.printed import number_text, quantity, range_ends, row_text, use_text
from cardan.app.answers.rows import DIGITS, UNITS, Judged, Rounds, Row, element_of, rows_of
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import scene_advice, yoke_settings
from cardan.app.answers.yokes.text import remedies, yoke_lines, yoke_text
from cardan.app.scene import Scene, load_scene
from example_scenes import example as scene_of
from pages import page_of

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


def test_a_limit_used_exactly_is_used_by_100_percent() -> None:
    assert use_text(1.0) == use_text(1.0 + 1e-12) == "100%"


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


def test_numbers_of_a_page_have_a_true_minus(tmp_path: Path) -> None:
    page = page_of(Scene.load(scene_of("steering-column.toml")), tmp_path)
    cells = [html.unescape(cell) for cell in re.findall(r"<td[^>]*>(.*?)</td>", page)]
    assert "\N{MINUS SIGN}12.22°" in cells
    assert not [cell for cell in cells if re.search(r"(?<!\S)-\d", cell)]
