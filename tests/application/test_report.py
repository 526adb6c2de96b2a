"""The report: what it says, and what it does in a real browser."""

from __future__ import annotations

import base64
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from html.parser import HTMLParser
from itertools import combinations, pairwise, product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jinja2
import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from cardan import Driveline, Limits, Load, __version__
from cardan.app.answers.limits.figures import MotionFigures
from cardan.app.answers.names import column_name, key_name
from cardan.app.answers.printed import number_text
from cardan.app.answers.rows import rows_of
from cardan.app.answers.study.page import heat_map
from cardan.app.charts.charts import Curve, Panel, chart
from cardan.app.charts.drawing import views
from cardan.app.charts.samples import NOMINAL_TORQUE, evaluated
from cardan.app.command import commands
from cardan.app.pictures.space import pins
from cardan.app.report import write_report
from cardan.app.report.page import environment
from cardan.app.scene import Scene
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study.study import Column
from cardan.arrays import FloatArray
from cardan.design.judged import Finding
from cardan.design.quantities import label as label_of
from example_scenes import DRIVELINES, EXAMPLES, Answers
from pages import curves, near, scales, tables, three

MACHINES = [path.stem for path in EXAMPLES if path.parent.name == "machines"]
SMALL_PAGES = ("foeppl", "suspension", "recorded_run")
HOSTILE = (
    "</title><script>document.title = 'taken'</script>&amp;\"'<!-- \x01\x1b"
    " $title ${x} {{ title }} {% raw %} {#"
)

Z_SHAFT = """\
title = "Z shaft"
[driveline]
bends_deg = [12, 9]
twists_deg = [170]
phases_deg = [20]
[load]
speed_rpm = 1500
drive_torque_Nm = 300
inertias_kgm2 = [0, 0.1, 0.3]
"""
LINE = Driveline.from_bends([12, 9], [170], [20], degrees=True)
LOAD = Load(drive_torque=300.0, speed=50.0 * np.pi, inertias=[0.0, 0.1, 0.3])

ODD = {
    "hostile": f"title = {json.dumps(HOSTILE)}\n[driveline]\nbends_deg = [8.5]\n",
    "straight": "[driveline]\nbends_deg = [0, 0]\n[load]\noutput_torque_Nm = 5\n",
    "long": f"title = '{'Propellerwelle' * 8}'\n[driveline]\nbends_deg = {[3.0] * 40}\n",
    "steep": "[driveline]\nbends_deg = [89]\n[sweep]\nturns = 0.25\nstart_deg = -30\n",
    "cube": "[driveline]\nbends_deg = [5, 6]\n[load]\nspeed_rpm = 100\n[study]\n"
    "bends_deg.0 = {from = 0, to = 30, steps = 7}\nbends_deg.1 = [1, 2, 3]\n"
    "speed_rpm = [100, 200]\n",
    "states": "[driveline]\nbends_deg = [5, 6]\n[states]\n"
    f"bends_deg.0 = {list(range(12, 0, -1))}\n"
    f"names = {[f'ride height {place} mm, WWWWWWWWWWW' for place in range(12)]}\n",
}


def scene(text: str) -> Scene:
    return Scene.parse(text, "a.toml")


def written(of: Scene, folder: Path) -> str:
    write_report(of, folder / "a.html")
    return (folder / "a.html").read_text(encoding="utf-8")


class PageText(HTMLParser):
    """The text of a page as it is shown and its elements, by the standard library's parser."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.text = ""
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self._inside = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self._inside = tag

    def handle_data(self, data: str) -> None:
        if self._inside not in ("script", "style"):
            self.text += data if self._inside == "pre" else re.sub(r"\s+", " ", data)


@pytest.mark.parametrize(
    "states", ["", "[states]\nbends_deg.0 = [15, 15]\nbends_deg.1 = [15, 15]\n"]
)
def test_joints_that_cancel_have_no_harmonics(tmp_path: Path, states: str) -> None:
    """What is left of them is rounding, 1e-16 deg here."""
    page = written(
        scene(f"[driveline]\nbends_deg = [15, 15]\ntwists_deg = [180]\n{states}"), tmp_path
    )
    (found,) = (rows for caption, rows in tables(page).items() if "Harmonics" in caption)
    assert [cells[1:] for cells in found[1:]] == 3 * [["0", "0"]]


def test_tables_are_the_librarys(tmp_path: Path) -> None:
    found = tables(written(scene(Z_SHAFT), tmp_path))
    assert ["Torque at the drive", "300 N m"] in found["Load and drive"]
    assert ["Speed of the drive", "157.1 rad/s, 1500 rpm"] in found["Load and drive"]

    series = LINE.harmonics((2, 4, 6))
    assert found["Harmonics of shaft 2: amplitudes"] == [
        ["Order of the drive's rotation", "Angle error [deg]", "Speed ratio"],
        *(
            [
                f"order {order}",
                *(number_text(each, "") for each in (error, ratio)),
            ]
            for order, error, ratio in zip(
                (2, 4, 6), series.angle_error_deg, series.speed_ratio, strict=True
            )
        ),
    ]

    def row(caption: str, name: str) -> list[str]:
        return next(cells[1:] for cells in found[caption] if cells[0] == name)

    motion = "Motion of the shafts over a whole turn at constant drive speed"
    joints = [LINE.equivalent(shaft) for shaft in (1, 2)]
    assert found[motion][0] == ["", "shaft 1", "shaft 2"]
    for name, values in {
        "Equivalent bend [deg]": [np.degrees(joint.bend) for joint in joints],
        "Largest angle error [deg]": [np.degrees(joint.max_angle_error) for joint in joints],
        "Non-uniformity U": [joint.non_uniformity for joint in joints],
        "Largest acceleration ratio": [joint.max_acceleration_ratio for joint in joints],
        "Largest acceleration [rad/s²]": [
            joint.max_acceleration_ratio * (50.0 * np.pi) ** 2 for joint in joints
        ],
    }.items():
        digits = {"Equivalent bend [deg]": 2, "Largest acceleration [rad/s²]": 0}.get(name)
        shown = three if digits is None else f"{{:.{digits}f}}".format
        assert row(motion, name) == [shown(float(value)) for value in values], name
    for name, factor in {"Speed ratio": 1.0, "Speed [rpm]": 1500.0}.items():
        for cell, joint in zip(row(motion, name), joints, strict=True):
            low, high = map(near, cell.split(" to "))
            assert factor * joint.min_speed_ratio == low
            assert factor * joint.max_speed_ratio == high

    loads = "Loads of the shafts, largest over a whole turn"
    turn = np.radians(np.arange(0.0, 360.25, 0.5))
    moments = LINE.evaluate(turn, "support_moment", shafts=slice(None), load=LOAD).support_moment
    assert found[loads][0] == ["", "shaft 0", "shaft 1", "shaft 2"]
    sizes = np.linalg.norm(moments, axis=-1)
    assert row(loads, "Largest support moment [N m]") == [
        three(size) for size in sizes.max(axis=-1)
    ]
    at = [cells[1:] for cells in found[loads] if cells[0] == "at drive angle [deg]"][1]
    for shaft, place in enumerate(at):
        there = LINE.evaluate(
            np.radians(float(place)), "support_moment", shafts=shaft, load=LOAD
        ).support_moment
        components = [float(row(loads, f"{axis} component there [N m]")[shaft]) for axis in "xyz"]
        # Shown to a tenth of a degree.
        assert components == pytest.approx(list(there), abs=2e-3 * sizes[shaft].max())


def test_many_shafts_are_rows_and_the_most_loaded_are_listed(tmp_path: Path) -> None:
    bends = np.array([3, 9, 1, 7, 12, 2, 8, 5, 4, 11, 6], dtype=float)
    page = written(scene(f"[driveline]\nbends_deg = {bends.tolist()}\n"), tmp_path)
    line = Driveline.from_bends(bends, np.zeros(10), np.zeros(10), degrees=True)
    moments = line.evaluate(
        np.radians(np.arange(0.0, 360.25, 0.5)),
        "support_moment",
        shafts=slice(None),
        load=Load(drive_torque=NOMINAL_TORQUE),
    ).support_moment
    peaks = np.linalg.norm(moments, axis=-1).max(axis=-1)
    most = sorted(np.argsort(-peaks)[:8])
    listed = re.findall(r"<li>shaft (\d+): up to ([\d.]+) N m</li>", page)
    assert listed == [(str(shaft), three(peaks[shaft])) for shaft in most]
    assert "each of the other 4 shafts: no more than these" in page
    motion = tables(page)["Motion of the shafts over a whole turn at constant drive speed"]
    assert [row[0] for row in motion] == ["", *(f"shaft {shaft}" for shaft in range(1, 12))]
    assert motion[0][1] == "Equivalent bend [deg]"
    assert motion[-1][1] == f"{float(np.degrees(line.equivalent().bend)):.2f}"


@pytest.mark.parametrize("main", [[1, 0.1, 0.2], [-1, 0.3, 0], [0.1, 1, 0], [0, -0.2, -1]])
def test_no_view_is_a_mirror_image(main: list[float]) -> None:
    """Right, up and towards the viewer are right-handed, whichever way the power flows."""
    named = views(np.array([[main]]))
    assert len(named) == 3
    for name, (right, down, viewer) in named.items():
        assert np.linalg.det([right, -down, viewer]) > 0.9, name
        # The drive is on the left.
        assert right @ main > 0.0
        said = re.fullmatch(r"(?:Side|Top) view: (-?[xyz]) to the right, (-?[xyz]) (up|down)", name)
        if said:
            axes = {
                f"{sign}{axis}": way
                for sign, ways in (("", np.eye(3)), ("-", -np.eye(3)))
                for axis, way in zip("xyz", ways, strict=True)
            }
            assert np.linalg.det([right, -down, viewer]) == pytest.approx(1.0)
            assert np.array_equal(axes[said[1]], right)
            assert np.array_equal(axes[said[2]], down if said[3] == "down" else -down)
        else:
            assert "looking from the drive towards the output" in name


def test_drawings_name_axes_and_the_way_of_the_power(tmp_path: Path) -> None:
    page = written(scene(Z_SHAFT), tmp_path)
    drawings = re.findall(r'<svg id="view-\d".*?</svg>', page, re.S)
    names = [re.findall(r"<text[^>]*>(.*?)</text>", drawing) for drawing in drawings]
    assert names == [
        # Of 9 deg in a plane that is turned by 10 deg.
        ["x", "y", "drive", "output", "12°", "8.87°"],
        ["x", "z", "drive", "output", "0°", "1.56°"],
        ["x", "y", "z", "drive", "output"],
    ]
    for drawing in drawings:
        places = {
            text: (float(x), float(y))
            for x, y, text in re.findall(r'<text x="(.*?)" y="(.*?)".*?>(.*?)<', drawing)
        }
        assert places["drive"][0] < places["output"][0]
        foot, head = re.findall(r'class="flow" d="M([\d.]+) [\d.]+L([\d.]+)', drawing)[0]
        assert places["drive"][0] < float(foot) < float(head) < places["output"][0]
        # The name of an axis lies beyond the head of its arrow, always as far.
        paths = re.findall(r'class="axis" d="M([-.\d]+) ([-.\d]+)L([-.\d]+) ([-.\d]+)M', drawing)
        for name, ends in zip((name for name in places if len(name) == 1), paths, strict=True):
            start, end = np.array(ends, dtype=float).reshape(2, 2)
            beyond = (end - start) / np.linalg.norm(end - start) * 20.0
            np.testing.assert_allclose(np.array(places[name]) - end, beyond, atol=0.4)
        # All arrows and names lie in the drawing; the arrow of view is in its middle.
        width, height = map(float, re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing)[0])
        arrows = re.findall(r'class="(?:flow|axis)" d="(.*?)"', drawing)
        ends = np.array(re.findall(r"[-.\d]+", " ".join(arrows)), dtype=float).reshape(-1, 2)
        for x, y in (*ends, *places.values()):
            assert 0.0 < x < width
            assert 0.0 < y < height
        middle = (np.array(places["drive"]) + places["output"]) / 2.0
        assert middle[0] == pytest.approx(width / 2.0, abs=0.1)
        feet = re.findall(r'class="axis" d="M[-.\d]+ ([-.\d]+)L', drawing)
        assert all(float(y) == pytest.approx(middle[1], abs=0.11) for y in feet)
        # The barbs of an arrow lie behind its head, one on either side.
        for path in re.findall(r'class="(?:flow|axis)" d="(.*?)"', drawing):
            points = np.array(re.findall(r"[-.\d]+", path), dtype=float).reshape(-1, 2)
            foot_at, head_at, left, _, right = points
            way = (head_at - foot_at) / np.linalg.norm(head_at - foot_at)
            aside = np.array([-way[1], way[0]])
            for barb, side in ((left, 1.0), (right, -1.0)):
                assert (barb - head_at) @ way == pytest.approx(-13.0, abs=0.3)
                assert side * (barb - head_at) @ aside == pytest.approx(6.5, abs=0.3)
        if "z" in places and "y" not in places:
            assert places["z"][1] > places["x"][1]
        if "y" in places:
            assert places["y"][1] < places["x"][1]


def test_head_names_file_date_and_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    said = PageText(written(scene(Z_SHAFT), tmp_path)).text
    assert f"Scene file a.toml. Report of 1970-01-02 by cardan {__version__}." in said
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    before = time.strftime("%Y-%m-%d")
    said = PageText(written(scene(Z_SHAFT), tmp_path)).text
    assert f"Report of {before} by" in said or f"Report of {time.strftime('%Y-%m-%d')} by" in said


def label_and_value(finding: Finding) -> tuple[str, str]:
    """What the page calls a figure of the motion, and its worst value with its unit."""
    rows = {name: row for name, row, _ in rows_of(MotionFigures)}
    unit = "°" if finding.unit == "deg" else f" {finding.unit}"
    return rows[finding.figure].label, f"{finding.worst:.{2 if unit == '°' else 0}f}{unit}"


def test_answers_are_the_librarys(tmp_path: Path) -> None:
    said = PageText(written(scene(Z_SHAFT), tmp_path)).text
    found = LINE.check(50.0 * np.pi)
    assert f"No. {found.heading}" in said
    assert found.heading == "The driveline is beyond the limits."
    for finding in found.findings:
        label, value = label_and_value(finding)
        stands = "not judged: no limit is given"
        if finding.limit:
            assert str(finding.verdict) == "beyond"
            over = finding.worst - finding.limit.limit
            stands = f"{over:.2f}° above the limit of {finding.limit.limit:g}°"
        assert f"{label}: {value}, {stands}" in said

    turn = np.radians(np.arange(0.0, 360.25, 0.5))
    moments = LINE.evaluate(turn, "support_moment", shafts=slice(None), load=LOAD).support_moment
    sizes = np.linalg.norm(moments, axis=-1)
    peaks = sizes.max(axis=-1)
    most = int(np.argmax(peaks))
    at = np.argmax(sizes[most] >= (1.0 - 1e-9) * peaks[most]) / 2.0
    assert (
        f"Highest bending reaction: shaft {most}, {three(peaks[most])} N m, "
        f"at {at:.1f}° and {at + 180.0:.1f}° of drive angle." in said
    )
    for shaft, peak in enumerate(peaks):
        assert f"shaft {shaft}: up to {three(peak)} N m" in said

    assert "Spatial arrangement: the bends lie in different planes." in said
    # 170 deg of twist are 10 deg counter-clockwise, and the yokes must follow.
    assert "input-side yoke, looking from the drive towards the output." in said
    assert "shaft 1: 10.0° counter-clockwise = 170.0° clockwise; turn it 30.0°" in said
    best = np.degrees(LINE.with_phases(LINE.optimal_phases()).equivalent().bend)
    assert f"with this setting {best:.2f}°" in said
    # By the last shaft's angle error, not by that of one before it.
    first, last = (three(np.degrees(float(LINE.equivalent(i).max_angle_error))) for i in (1, 2))
    assert first != last
    assert f"the last shaft leads and lags the drive by up to {last}°" in said


def test_verdicts_have_limits_speeds_and_sources(tmp_path: Path) -> None:
    """A figure that is within, one that is tolerable, one without a limit."""
    text = Z_SHAFT.replace("bends_deg = [12, 9]", "bends_deg = [12, 11.9]").replace(
        "phases_deg = [20]", "phases_deg = [-10]"
    )
    text += '[limits]\npreset = "industrial"\ntorsional_excitation_rad_s2 = [10, 400]\n'
    line = Driveline.from_bends([12, 11.9], [170], [-10], degrees=True)
    limits = Limits("industrial", torsional_excitation_rad_s2=(10, 400))
    found = line.check(50.0 * np.pi, limits)
    page = written(scene(text), tmp_path)
    assert '<p class="verdict fair">Tolerably. The driveline is tolerable' in page
    for sign, colour in (("✓", "good"), ("!", "fair"), ("-", "open")):
        assert f'<li class="{colour}"><span aria-hidden="true">{sign}</span> ' in page
    rows = {row[0]: row[1:] for row in tables(page)["Limits"]}
    names, *speeds = tables(page)["Limits are kept up to"]
    kept = dict(zip(names[1:], zip(*(row[1:] for row in speeds), strict=True), strict=True))
    for finding in found.findings:
        label, text = label_and_value(finding)
        value, verdict, limit, maximum, source = rows[label]
        assert value == text
        assert verdict == str(finding.verdict)
        if finding.limit:
            unit = value.lstrip("0123456789.")
            bounds = dict.fromkeys((finding.limit.limit, finding.limit.maximum))
            shown = [f"{bound:g}{unit}" for bound in bounds]
            assert [limit, *filter(None, [maximum])] == shown
            assert source == finding.limit.source
        else:
            assert (limit, maximum, source) == ("", "", "no limit given")
        ends = (finding.within_up_to, finding.tolerable_up_to)
        rpm = [f"{int(float(speed) * 30.0 / np.pi)}" for speed in ends if np.isfinite(speed)]
        assert [f"{each} rpm" for each in rpm] == list(kept.get(label_of(finding.figure), ()))
    verdicts = [str(finding.verdict) for finding in found.findings]
    assert {"within", "tolerable", "not judged"} == set(verdicts)


def test_remedies_for_a_single_joint(tmp_path: Path) -> None:
    for bend, said in ((8.5, True), (2.5, False)):
        text = f"[driveline]\nbends_deg = [{bend}]\n"
        page = PageText(written(scene(text), tmp_path)).text
        assert ("give joint 0 a bend of at most 3.00°, or add a second joint" in page) == said
        text += "[limits]\nequivalent_bend_deg = 2\n"
        page = PageText(written(scene(text), tmp_path)).text
        assert "give joint 0 a bend of at most 2.00°, or add a second joint" in page


def test_yokes_on_splines(tmp_path: Path) -> None:
    """What the teeth cost, and the phases that they allow."""
    text = Z_SHAFT.replace("phases_deg = [20]", "phases_deg = [20]\nteeth = 16")
    said = PageText(written(scene(text), tmp_path)).text
    # From 20 deg in steps of 22.5 deg; the best would be -10 deg.
    line = Driveline.from_bends([12, 9], [170], [-2.5], degrees=True)
    left = np.degrees(line.equivalent().bend)
    assert "shaft 1 (16 teeth): 2.5° counter-clockwise" in said
    assert "turn it 1 tooth counter-clockwise (22.5°)" in said
    assert f"on the best teeth {left:.2f}°." in said
    assert "To use it in the scene: phases_deg = [-2.5]" in said
    assert "On these teeth the driveline is still beyond limits:" in said


@pytest.mark.parametrize("signs", [[1, 1, -1], [1, -1, -1], [1, 1, 1]])
def test_catalogue_rule_beside_the_exact_bend(signs: list[int], tmp_path: Path) -> None:
    turned = [90.0 if a == b else 0.0 for a, b in pairwise(signs)]
    twists = [30.0, 180.0]
    phases = [turned[0] + 30.0, turned[1]]
    bends = [9.0, 6.0, 4.0]
    text = f"[driveline]\nbends_deg = {bends}\ntwists_deg = {twists}\nphases_deg = {phases}\n"
    line = Driveline.from_bends(bends, twists, phases, degrees=True)
    exact, rule = np.degrees([line.equivalent().bend, line.catalogue_bend(signs)])
    # Wrong signs would be far off.
    assert abs(exact - rule) < 0.05
    said = PageText(written(scene(text), tmp_path)).text
    written_signs = " ".join("+" if sign > 0 else "\N{MINUS SIGN}" for sign in signs)
    difference = f"{rule - exact:.2f}" if abs(rule - exact) > 0.005 else f"{rule - exact:.3f}"
    difference = difference.replace("-", "\N{MINUS SIGN}")
    row = f"as in the scene{exact:.2f}{rule:.2f}{difference}0{written_signs}"
    assert row in said


def test_without_a_load_moments_are_for_a_stated_torque(tmp_path: Path) -> None:
    """Also where the load is a speed alone, or inertias that nothing turns."""
    drive = "[driveline]\nbends_deg = [20]\n"
    for load in ("", "[load]\nspeed_rpm = 10\n", "[load]\nspeed_rpm = 0\ninertias_kgm2 = [0, 1]\n"):
        page = written(scene(drive + load), tmp_path)
        said = PageText(page).text
        peak = NOMINAL_TORQUE * np.tan(np.radians(20.0))
        assumed = f"for an assumed drive torque of {NOMINAL_TORQUE:g} N m"
        assert f"What loads the bearings, {assumed}?" in said
        headings = re.findall(r"<(h3|caption|figcaption)>(.*?)</", page)
        of_loads = [words for _, words in headings if re.search("[Ll]oads|torque|bend|mom", words)]
        assert len(of_loads) >= 7
        assert all(assumed in words.replace("\N{NO-BREAK SPACE}", " ") for words in of_loads)
        assert f"shaft 0: up to {three(peak)} N m" in said
    assert "assumed" not in PageText(written(scene(Z_SHAFT), tmp_path)).text


def test_a_study_answers_for_all_of_it(tmp_path: Path) -> None:
    of = scene(
        "[driveline]\nbends_deg = [5, 5]\n[study]\nbends_deg.0 = {from = 0, to = 10, steps = 11}\n"
    )
    said = PageText(written(of, tmp_path)).text
    bends = np.stack([np.arange(11.0), np.full(11, 5.0)], -1)
    within = np.count_nonzero(Driveline.from_bends(bends, degrees=True).check().passes)
    assert 0 < within < 11
    assert f"Drivelines of the study: {within} of 11 within, {11 - within} beyond." in said
    largest = np.degrees(np.max(Driveline.from_bends(bends, degrees=True).equivalent().bend))
    assert f"equivalent bend: {largest:.2f}° at bends_deg.0 = 10, " in said
    assert f", {largest - 3.0:.2f}° above the limit of 3°" in said
    assert "What varies: 11 drivelines" in said


GRID = """\
[driveline]
bends_deg = [5, 6]
twists_deg = [180]
[study]
bends_deg.0 = {from = 0, to = 30, steps = 31}
phases_deg.0 = {from = -90, to = 90, steps = 13}
speed_rpm = [2000, 1000]
[load]
output_torque_Nm = 100
[output]
quantities = ["bending_driven"]
reduce = ["peak", "mean"]
closed_forms = ["equivalent_bend", "max_speed_ratio"]
"""


def test_a_study_names_its_best_driveline(tmp_path: Path) -> None:
    """That which uses least of its tightest limit: two joints of 6 deg at the lower speed."""
    page = written(scene(GRID), tmp_path)
    said = PageText(page).text
    assert "bend, joint 0: 6 deg; phase, shaft 1: 0 deg; speed: 1000 rpm" in said
    best = Driveline.from_bends([6, 6], [180], [0], degrees=True).check(1000.0 * np.pi / 30.0)
    section = said[said.index("Best driveline") : said.index("What varies")]
    assert all(label_and_value(finding)[0] in section for finding in best.findings)
    assert "equivalent bend: 0°, within the limit of 3°" in section
    # Among equals the first, and how many there are.
    equal = GRID.replace("speed_rpm = [2000, 1000]", "output_torque_Nm = [100, 200]")
    said = PageText(written(scene(equal), tmp_path)).text
    assert "(the first of 2 that are as good)" in said


def test_a_study_says_what_its_figures_are(tmp_path: Path) -> None:
    page = written(scene(GRID), tmp_path)
    found = tables(page)
    assert [row[0] for row in found["What varies: 806 drivelines"][1:]] == [
        "bend, joint 0 [deg]",
        "phase, shaft 1 [deg]",
        "speed [rpm]",
    ]
    assert found["Extremes"][0][3:] == [
        "at bend, joint 0 [deg]",
        "at phase, shaft 1 [deg]",
        "at speed [rpm]",
    ]
    figures = ["equivalent bend, shaft 2 [deg]", "largest speed ratio, shaft 2"]
    figures += [
        f"{how} bending, driven side, joint {joint} [N m]"
        for how in ("largest", "mean")
        for joint in (0, 1)
    ]
    assert list(dict.fromkeys(row[0] for row in found["Extremes"][1:])) == figures
    study = page[page.index('id="study"') : page.index('id="pictures"')]
    assert re.findall("<figcaption>(.*?)</", study) == figures
    assert not re.search(r"[a-z]_[a-z]", PageText(study).text)
    # The third key is held where the best driveline has it.
    assert "Drawn for the best driveline's speed: 1000 rpm." in PageText(study).text


def test_names_of_keys_and_figures() -> None:
    assert key_name("points_mm.2-3.y") == "points 2 to 3, y [mm]"
    assert key_name("points_m.1.x") == "point 1, x [m]"
    assert key_name("bends_deg") == "bends [deg]"
    assert key_name("twists_deg.0") == "twist, shaft 1 [deg]"
    assert key_name("projected_bends_vertical_deg.1") == "bend in side view, joint 1 [deg]"
    assert key_name("acceleration_rad_s2") == "acceleration [rad/s²]"
    for column, name in (
        (Column("", "N m", "moment", "joint", 0, "rms", "x"), "rms moment, joint 0, x [N m]"),
        (
            Column("", "N m", "bending_driving", "joint", 1, "min"),
            "minimum bending, driving side, joint 1 [N m]",
        ),
        (
            Column("", "rad", "angle_error", "shaft", 2, "peak"),
            "largest angle error, shaft 2 [deg]",
        ),
        (Column("", "1", "non_uniformity", "shaft", 2, "value"), "non-uniformity U, shaft 2"),
        (
            Column("", "rad", "max_angle_error", "shaft", 1, "value"),
            "largest angle error, shaft 1 [deg]",
        ),
    ):
        assert column_name(column) == name


def test_all_curves_of_a_study_are_drawn_or_a_map(tmp_path: Path) -> None:
    """A curve for each value of the shorter key up to six; more make a map, none is dropped."""
    for steps in (6, 7):
        of = scene(
            "[driveline]\nbends_deg = [5, 5]\ntwists_deg = [180]\n[study]\n"
            f"bends_deg.0 = {{from = 1, to = {steps}, steps = {steps}}}\n"
            "bends_deg.1 = {from = 0, to = 30, steps = 61}\n"
            '[output]\nclosed_forms = ["equivalent_bend"]\n'
        )
        page = written(of, tmp_path)
        study = page[page.index('id="study"') : page.index('id="pictures"')]
        labels = re.findall(r"</svg> (.*?)</li>", study)
        if steps == 6:
            assert labels == [f"bend, joint 0: {value} deg" for value in range(1, 7)]
            assert study.count("<polyline") == 6
        else:
            assert "<polyline" not in study
            assert labels[0] == "0 to 5"
            assert "○ least value, at 1, 1" in study


def test_a_map_has_each_value_in_its_band() -> None:
    x = np.array(range(41), dtype=np.float64)
    y = np.array([-3.0, -1.0, 0.0, 4.0])
    values = np.hypot(x - 10.0, 5.0 * y[:, np.newaxis])
    made = heat_map(Panel("f", "deg", ()), x, y, values, ["a [deg]", "b"])
    seen = np.zeros(values.shape, dtype=int)
    frame, ends = made["frame"], [-3.0 - 1.0, 4.0 + 2.0]
    for band in made["bands"]:
        low, high = map(float, band["label"].split(" to "))
        for bar in band["path"].split("M")[1:]:
            left, bottom, right, top, _ = map(float, re.findall(r"[-.\d]+", bar))
            across = np.interp([left, right], [frame.left, frame.right], [-0.5, 40.5])
            up = np.interp([-bottom, -top], [-frame.bottom, -frame.top], ends)
            rows = (y > up[0]) & (y < up[1])
            columns = (x > across[0]) & (x < across[1])
            inside = values[np.ix_(rows, columns)]
            assert inside.size
            assert np.all((inside >= low) & (inside <= high))
            seen[np.ix_(rows, columns)] += 1
    assert np.all(seen == 1)
    assert made["least_at"] == "10, 0"


def test_pins_are_those_of_the_cross() -> None:
    """The moment that a cross passes on is normal to both its pins."""
    generator = np.random.default_rng(5)
    bends = generator.uniform(0.05, 1.2, (40, 3))
    twists, phases = generator.uniform(-3.0, 3.0, (2, 40, 2))
    angle = generator.uniform(-7.0, 7.0, 40)
    lines = Driveline.from_bends(bends, twists, phases)
    found = pins(lines, angle)
    moment = lines.evaluate(angle, "moment", load=Load(drive_torque=1.0)).moment
    for joint in range(3):
        driving, driven = np.moveaxis(found[:, joint], 1, 0)
        across = [
            np.sum(driving * lines.directions[:, joint], -1),
            np.sum(driven * lines.directions[:, joint + 1], -1),
            np.sum(driving * driven, -1),
            np.linalg.norm(driving, axis=-1) - 1.0,
        ]
        assert np.max(np.abs(across)) < 1e-14
        passed = moment[joint] / np.linalg.norm(moment[joint], axis=-1, keepdims=True)
        assert np.max(np.abs(np.sum(driving * passed, -1))) < 1e-12
        assert np.max(np.abs(np.sum(driven * passed, -1))) < 1e-12
    # One driveline over many angles gives what a batch of the same gives.
    one = pins(lines[0], angle)
    same = pins(lines[np.zeros(40, dtype=int)], angle)
    assert np.array_equal(one, same)


def test_a_long_recording_is_thinned(tmp_path: Path) -> None:
    degrees = np.linspace(0.0, 3600.0, 4001)
    np.savez(tmp_path / "run.npz", a=degrees)
    (tmp_path / "a.toml").write_text(
        "[driveline]\nbends_deg = [30]\n[angles]\nfile = 'run.npz'\nangle_column_deg = 'a'\n"
    )
    samples = evaluated(Scene.load(tmp_path / "a.toml"))
    assert samples.every == 3
    assert np.array_equal(samples.angle_deg, degrees[::3])
    # Peaks are of all samples.
    peak = next(one for one in samples.peaks if one.output.name == "support_moment")
    assert peak.size == pytest.approx(NOMINAL_TORQUE * np.tan(np.radians(30.0)), rel=1e-14)
    assert peak.at_deg == 90.0
    assert "One recorded sample in 3 is drawn; the tables use all of them." in written(
        Scene.load(tmp_path / "a.toml"), tmp_path
    )


@pytest.mark.parametrize("path", DRIVELINES, ids=lambda path: path.stem)
def test_every_example_has_a_page_that_needs_nothing_else(path: Path, answered: Answers) -> None:
    page = answered(path).page
    # The core for browsers and what moves the driveline, and the page that is there without them.
    moving = sum(
        map(len, re.findall(r'id="live-module">.*?</script>|\(\(\) => \{\n.*', page, re.S))
    )
    assert moving < 500_000
    assert len(page) - moving < 700_000
    for tag, attributes in PageText(page).elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")
    assert not re.search(r"@import|url\(|fetch\(|XMLHttp|innerHTML", page)
    assert str(Path(__file__).parents[2]) not in page


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=() if path.stem in SMALL_PAGES else pytest.mark.long)
        for path in DRIVELINES
    ],
    ids=lambda path: path.stem,
)
def test_a_page_is_the_same_every_time(path: Path, tmp_path: Path, answered: Answers) -> None:
    assert written(Scene.load(path), tmp_path) == answered(path).page


def test_title_is_escaped(tmp_path: Path) -> None:
    page = written(scene(ODD["hostile"]), tmp_path)
    parsed = PageText(page)
    assert sum(tag == "script" for tag, _ in parsed.elements) == 5
    assert parsed.text.count(HOSTILE) == 2
    script, style = (
        re.findall(rf"<{tag}>(.*?)</{tag}>", page, re.S)[-1] for tag in ("script", "style")
    )
    for text in (script, style):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in page


def test_names_of_files_are_escaped(tmp_path: Path) -> None:
    name = "<b>&amp;\"'{{ x }}"
    np.savez(tmp_path / f"{name}.npz", a=[0.0, 1.0])
    given = {"file": f"{name}.npz", "angle_column_deg": "a"}
    angles = "".join(f"{key} = {json.dumps(value)}\n" for key, value in given.items())
    path = tmp_path / f"{name}.toml"
    path.write_text(f"[driveline]\nbends_deg = [5]\n[angles]\n{angles}", encoding="utf-8")
    parsed = PageText(written(Scene.load(path), tmp_path))
    assert parsed.text.count(f"{name}.toml") == 3
    assert f"Recording{name}.npz" in parsed.text
    assert "b" not in [tag for tag, _ in parsed.elements]
    # A file's name that is no text, as the system hands it over.
    strange = Scene.parse("[driveline]\nbends_deg = [5]\n", "\udcff.toml")
    assert "<title>?.toml</title>" in written(strange, tmp_path)


def hostile(value: Any) -> Any:  # noqa: ANN401
    """The same data with a hostile end to every text that says something."""
    if isinstance(value, str):
        return value and value + HOSTILE
    if isinstance(value, dict):
        return {key: hostile(entry) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        entries = [hostile(entry) for entry in value]
        return type(value)(*entries) if hasattr(value, "_fields") else type(value)(entries)
    return value


@pytest.mark.parametrize("name", ["recorded_run", "truck", "suspension", "foeppl", "cube"])
def test_no_text_changes_the_page(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever Python hands to the templates stays text: the elements are the same."""
    paths = {path.stem: path for path in EXAMPLES}
    of = Scene.load(paths[name]) if name in paths else scene(ODD[name])
    tame = PageText(written(of, tmp_path))
    render, given = jinja2.Template.render, dict[str, Any]()

    def tampered(self: jinja2.Template, first: dict[str, Any], **more: Any) -> str:  # noqa: ANN401
        every = {**first, **more}
        own = {key: every.pop(key) for key in ("style", "script")}
        given.update(hostile(every))
        return render(self, given, **own)

    monkeypatch.setattr(jinja2.Template, "render", tampered)
    page = written(of, tmp_path)
    wild = PageText(page)
    assert [(tag, list(has)) for tag, has in wild.elements] == [
        (tag, list(has)) for tag, has in tame.elements
    ]
    assert wild.text.count(HOSTILE) > 50
    data = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page)
    assert json.loads(data[0]) == given["data"]


def test_embedded_data_cannot_end_their_element() -> None:
    embedded = environment().from_string("{{ it|tojson }}")
    data = {"</script><!--": ["<", 0.1, None, "é"]}
    assert "<" not in embedded.render(it=data)
    assert json.loads(embedded.render(it=data)) == data
    with pytest.raises(ValueError, match="not JSON compliant"):
        embedded.render(it=np.nan)


def test_a_missing_name_is_an_error() -> None:
    with pytest.raises(jinja2.UndefinedError, match="'dict object' has no attribute 'b'"):
        environment().from_string("{{ a.b }}").render(a={})


def test_without_jinja2(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Known before the scene is run, and only a report needs it."""
    monkeypatch.setitem(sys.modules, "jinja2", None)
    monkeypatch.setattr(Scene, "run", None)
    with pytest.raises(ImportError, match=r"needs jinja2: pip install 'cardan\[app\]'"):
        write_report(scene(Z_SHAFT), tmp_path / "a.html")
    assert list(tmp_path.iterdir()) == []
    script = "import sys, cardan.app.command, cardan.app.report; assert 'jinja2' not in sys.modules"
    subprocess.run([sys.executable, "-c", script], check=True)


def drawn(panel: Panel, x: FloatArray, label: str) -> ElementTree.Element:
    """The figure of a chart, as the page has it."""
    figure = environment().from_string('{% from "parts.html" import chart %}{{ chart(it) }}')
    return ElementTree.fromstring(figure.render(it=chart(panel, x, label)))


def test_curves_stand_where_the_axes_say() -> None:
    x = np.linspace(-30.0, 240.0, 50)
    rising, other = 3.7e-3 * x - 0.21, np.cos(x)
    panel = Panel("a < b", "N m", (Curve("one", rising), Curve("two", other)))
    root = drawn(panel, x, "drive angle [deg]")
    assert root[0].text == "a < b [N m]"
    ticks = scales(root)
    assert [value for _, value in ticks["x"]] == [0.0, 90.0, 180.0]
    assert [value for _, value in ticks["y"]] == [-1.0, -0.5, 0.0, 0.5, 1.0]
    found = curves(root)
    assert list(found) == ["one", "two"]
    for points, values in zip(found.values(), (rising, other), strict=True):
        assert np.max(np.abs(points[:, 0] - x)) < 0.1
        assert np.max(np.abs(points[:, 1] - values)) < 0.01


@pytest.mark.parametrize(
    ("span", "step"),
    [
        *[(4, 1), (9, 2), (25, 5), (40, 10), (60, 15), (140, 30), (200, 45), (900, 180)],
        *[(1500, 360), (1800, 360), (1900, 720), (5000, 1080)],
    ],
)
def test_degrees_divide_the_turn(span: float, step: float) -> None:
    """At most six ticks, at multiples of a step that divides a turn or of whole turns."""
    x = np.linspace(0.0, span, 50)
    made = chart(Panel("a", "", (Curve("one", x),)), x, "drive angle [deg]")
    marks = [float(text) for _, text in made["x_ticks"]]
    assert marks == list(np.arange(0.0, span + 1e-9, step))
    assert len(marks) <= 6


def test_what_varies_by_rounding_alone_is_flat() -> None:
    noise = 1.0 + 1e-15 * np.random.default_rng(1).uniform(-1.0, 1.0, 50)
    figure = drawn(Panel("ratio", "", (Curve("one", noise),)), np.arange(50.0), "x")
    line = next(figure.iter("polyline"))
    assert len({point.split(",")[1] for point in line.attrib["points"].split()}) == 1
    assert curves(figure)["one"][:, 1] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("slope", [1.0, 0.0])
def test_a_curve_has_gaps_where_it_has_no_values(slope: float) -> None:
    values = 2.0 + slope * np.arange(10.0)
    values[[0, 4, 5]] = np.nan
    figure = drawn(Panel("ratio", "", (Curve("one", values),)), np.arange(10.0), "x")
    pieces = [line.attrib["points"].split() for line in figure.iter("polyline")]
    assert [len(piece) for piece in pieces] == [3, 4]
    assert {line.attrib["class"] for line in figure.iter("polyline")} == {"curve c0"}
    heights = [float(point.split(",")[1]) for piece in pieces for point in piece]
    assert np.all(np.diff(heights) < 0.0) == bool(slope)
    assert (len(set(heights)) == 1) != bool(slope)


def test_what_is_counted_has_whole_numbers() -> None:
    values = np.array([1.0, 2.0, 4.0])
    figure = drawn(Panel("a", "", (Curve("one", values),)), np.arange(3.0), "state, counted from 0")
    lines = [line for line in figure[1] if line.get("class") == "grid"]
    assert len([line for line in lines if line.get("x1") == line.get("x2")]) == 3


def run(*arguments: str | Path) -> tuple[int, str]:
    done = CliRunner().invoke(commands(), [str(argument) for argument in arguments])
    return done.exit_code, done.output


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("shaft.toml").write_text(Z_SHAFT)
    assert run("report", "shaft.toml") == (0, "wrote shaft.html\n")
    assert run("report", "shaft.toml", "--output", "b.htm") == (0, "wrote b.htm\n")
    assert Path("b.htm").read_bytes() == Path("shaft.html").read_bytes()
    assert sorted(path.name for path in Path().iterdir()) == ["b.htm", "shaft.html", "shaft.toml"]


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("no/a.html", "no/a.html: No such file or directory"),
        ("a.pdf", "a.pdf must end in .html or .htm"),
        (".", ".: Is a directory"),
    ],
)
def test_output_that_cannot_be(
    output: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(Z_SHAFT)
    assert run("report", "a.toml", "--output", output) == (2, f"cardan: {message}\n")
    assert [path.name for path in Path().iterdir()] == ["a.toml"]


def test_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that cannot be made leaves an earlier one as it is."""
    (tmp_path / "a.html").write_text("earlier")
    monkeypatch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space")))
    with pytest.raises(OSError, match="No space"):
        write_report(scene(Z_SHAFT), tmp_path / "a.html")
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]
    assert (tmp_path / "a.html").read_text() == "earlier"


# --- in a browser ----------------------------------------------------------------------------


in_browser = pytest.mark.xdist_group("browser")


@pytest.fixture(scope="module")
def chromium() -> Iterator[webdriver.Chrome]:
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        if os.environ.get("CARDAN_REQUIRE_BROWSER"):
            pytest.fail("CARDAN_REQUIRE_BROWSER is set and chromium or chromedriver is missing")
        pytest.skip("no chromium with chromedriver")
    options = Options()
    options.binary_location = browser
    # Containers have neither user namespaces nor room in /dev/shm.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = webdriver.Chrome(options, Service(driver))
    yield chrome
    chrome.quit()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, answered: Answers) -> Path:
    """A page of every example and of odd scenes."""
    folder = tmp_path_factory.mktemp("pages")
    for path in DRIVELINES:
        (folder / f"{path.stem}.html").write_text(answered(path).page, encoding="utf-8")
    for name, text in {**ODD, "z": Z_SHAFT}.items():
        write_report(scene(text), folder / f"{name}.html")
    return folder


PAGES = [*(path.stem for path in DRIVELINES), *ODD, "z"]


@pytest.fixture
def browser(chromium: webdriver.Chrome) -> Iterator[webdriver.Chrome]:
    """The browser as wide as a desk, in light, and no script error at the end."""
    screen(chromium, 1200)
    media(chromium)
    said(chromium)
    yield chromium
    assert said(chromium) == []


def said(browser: webdriver.Chrome) -> list[str]:
    """What the browser's console has said since it was last asked."""
    return [entry["message"] for entry in browser.get_log("browser")]  # type: ignore[no-untyped-call]


def screen(browser: webdriver.Chrome, width: int) -> None:
    size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def media(browser: webdriver.Chrome, kind: str = "screen", scheme: str = "light") -> None:
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": kind, "features": [feature]})


def js(browser: webdriver.Chrome, script: str, *arguments: object) -> Any:  # noqa: ANN401
    return browser.execute_script(script, *arguments)


def opened(browser: webdriver.Chrome, folder: Path, name: str) -> WebElement:
    browser.get((folder / f"{name}.html").as_uri())
    return browser.find_element(By.ID, "sample")


def curves_shown(browser: webdriver.Chrome) -> dict[str, str]:
    """The numbers at the cursor by heading and legend, as a reader sees them."""
    shown: dict[str, str] = js(
        browser,
        """return Object.fromEntries([...document.querySelectorAll(".turn li")].map((li) => [
            `${li.closest("figure").querySelector("figcaption").textContent}, ` +
                li.textContent.trim().split(" ").slice(0, 2).join(" "),
            li.querySelector("output").textContent]))""",
    )
    return shown


def computed(sample: int) -> dict[str, float]:
    """The same of the Z shaft from the library."""
    got = LINE.evaluate(
        np.radians(0.5 * sample),
        (
            *("angle_error", "speed_ratio", "acceleration_ratio", "torque", "support_moment"),
            *("bending_driving", "bending_driven", "moment"),
        ),
        shafts=slice(None),
        load=LOAD,
    )
    curves = {}
    for shaft in (1, 2):
        curves[f"angle error [deg], shaft {shaft}"] = np.degrees(got.angle_error[shaft])
        curves[f"speed ratio, shaft {shaft}"] = got.speed_ratio[shaft]
        acceleration = got.acceleration_ratio[shaft] * (50.0 * np.pi) ** 2
        curves[f"acceleration [rad/s²], shaft {shaft}"] = acceleration
    for shaft in (0, 1, 2):
        curves[f"torque [N m], shaft {shaft}"] = got.torque[shaft]
        size = np.linalg.norm(got.support_moment[shaft])
        curves[f"support moment, magnitude [N m], shaft {shaft}"] = size
    for joint in (0, 1):
        curves[f"moment, magnitude [N m], joint {joint}"] = np.linalg.norm(got.moment[joint])
        curves[f"bending, driving side [N m], joint {joint}"] = got.bending_driving[joint]
        curves[f"bending, driven side [N m], joint {joint}"] = got.bending_driven[joint]
    return {name: float(value) for name, value in curves.items()}


def agrees(browser: webdriver.Chrome, sample: int) -> None:
    shown, want = curves_shown(browser), computed(sample)
    assert set(shown) == set(want)
    for name, text in shown.items():
        digits = len(text.partition(".")[2])
        assert (
            text.replace("\N{MINUS SIGN}", "-") == f"{round(want[name], digits) + 0.0:.{digits}f}"
        ), name
        assert digits >= ("acceleration" not in name)
    assert browser.find_element(By.CSS_SELECTOR, "output[for=sample]").text == f"{sample / 2:.1f}°"


@in_browser
def test_keys_move_the_numbers_to_what_the_library_computes(
    browser: webdriver.Chrome, folder: Path
) -> None:
    slider = opened(browser, folder, "z")
    agrees(browser, 0)
    slider.send_keys(Keys.ARROW_RIGHT * 7)
    agrees(browser, 7)
    slider.send_keys(Keys.ARROW_LEFT * 2)
    agrees(browser, 5)
    slider.send_keys(Keys.END)
    agrees(browser, 720)
    slider.send_keys(Keys.HOME)
    agrees(browser, 0)
    assert slider.get_attribute("aria-valuetext") == "0.0°"
    assert js(browser, "return document.activeElement.id") == "sample"


def moved(browser: webdriver.Chrome, sample: int) -> None:
    js(
        browser,
        """const slider = document.getElementById("sample");
        slider.value = arguments[0];
        slider.dispatchEvent(new Event("input"));""",
        sample,
    )


@in_browser
@pytest.mark.parametrize("name", ["states", *MACHINES])
def test_texts_of_drawings_and_charts_of_states_are_apart(
    browser: webdriver.Chrome, folder: Path, name: str
) -> None:
    """In the browser's own font, every text is within its drawing and covers no other."""
    opened(browser, folder, name)
    charts = js(
        browser,
        """return [...document.querySelectorAll("#states figure > svg, .views svg")].map((svg) => ({
            size: [svg.viewBox.baseVal.width, svg.viewBox.baseVal.height],
            texts: [...svg.querySelectorAll("text")].map((text) => {
                const box = text.getBBox(), at = svg.createSVGPoint();
                const turned = text.transform.baseVal.consolidate();
                return [[0, 0], [1, 0], [1, 1], [0, 1]].map(([x, y]) => {
                    at.x = box.x + x * box.width;
                    at.y = box.y + y * box.height;
                    const placed = turned ? at.matrixTransform(turned.matrix) : at;
                    return [placed.x, placed.y];
                });
            }),
        }))""",
    )
    assert charts
    for drawn_chart in charts:
        texts = np.array(drawn_chart["texts"])
        assert texts.min() >= 0.0
        assert np.all(texts.max(axis=(0, 1)) <= drawn_chart["size"])
        for one, other in combinations(texts, 2):
            assert apart(one, other)


@in_browser
@pytest.mark.parametrize("name", ["truck-shaft", "test-rig", "ship-shaft"])
def test_names_of_bearings_lie_beyond_the_yokes(
    browser: webdriver.Chrome, folder: Path, name: str
) -> None:
    opened(browser, folder, name)
    boxes = """return ["#view-0", "#view-1"].map((view) => arguments[0].map((kind) =>
        [...document.querySelectorAll(`${view} ${kind}`)]
            .filter((element) => kind !== "text" || element.textContent.startsWith("B"))
            .map((element) => {
                const {x, y, width, height} = element.getBBox();
                return [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
            })))"""
    for names_of_view, yokes in js(browser, boxes, ["text", ".yoke"]):
        assert len(names_of_view) == Scene.parse(STARTERS[name].text).line.n_bearings
        for one, other in product(np.array(names_of_view), np.array(yokes)):
            assert apart(one, other)


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether a side of one of two rectangles, by their corners, has all of the other beyond it."""
    for corners in (one, other):
        for side in (corners[1] - corners[0], corners[3] - corners[0]):
            first, second = one @ side, other @ side
            if first.max() <= second.min() or second.max() <= first.min():
                return True
    return False


@in_browser
def test_script_moves_numbers_cursor_and_drawing(browser: webdriver.Chrome, folder: Path) -> None:
    opened(browser, folder, "z")
    drawings, cursors = set(), []
    for sample in (0, 33, 180, 361, 500):
        moved(browser, sample)
        agrees(browser, sample)
        lines = js(
            browser,
            """return [...document.querySelectorAll(".turn .charts svg")].flatMap((svg) =>
                [...svg.querySelectorAll("polyline")].map((line) => {
                    const cursor = svg.querySelector(".cursor"), dot = line.nextElementSibling;
                    const point = line.points.getItem(arguments[0]);
                    return [cursor.x1.baseVal.value, cursor.x2.baseVal.value,
                            dot.cx.baseVal.value, dot.cy.baseVal.value, point.x, point.y];
                }))""",
            sample,
        )
        assert len(lines) == len(computed(0))
        for x1, x2, cx, cy, x, y in lines:
            assert x1 == x2 == cx == x
            assert cy == y
        cursors.append(lines[0][0])
        drawings.add(js(browser, "return document.querySelector('.views').innerHTML"))
    assert len(drawings) == 5
    # Even in the angle: the cursor stands where the axis says.
    assert np.ptp(np.diff(cursors) / np.diff([0, 33, 180, 361, 500])) < 0.01


@in_browser
def test_drawing_shows_the_pins(browser: webdriver.Chrome, folder: Path) -> None:
    """Side view: x to the right, y up; top view: x to the right, z down. The marks sit at one end
    of each pin, the yokes on the side of their shafts, at which these end, and what is beyond a
    shaft is faint."""
    opened(browser, folder, "z")
    views = {"view-0": ([0, 1], [1.0, -1.0], 2), "view-1": ([0, 2], [1.0, 1.0], 1)}
    for sample, (view, (shown, signs, towards)) in product((0, 77, 410), views.items()):
        moved(browser, sample)
        marks, bases, shafts = js(
            browser,
            """const all = (name) => [...document.querySelectorAll(`#${arguments[0]} .${name}`)];
            return [
                all("mark").map((mark) => [mark.cx.baseVal.value, mark.cy.baseVal.value]),
                all("yoke").map((yoke) => [
                    ...yoke.getAttribute("d").match(/[-.\\d]+/g).slice(0, 2).map(Number),
                    yoke.classList.contains("far"),
                ]),
                all("shaft").map((shaft) => shaft.getAttribute("d").match(/[-.\\d]+/g).map(Number)),
            ]""",
            view,
        )
        found = pins(LINE, np.radians([0.5 * sample]))[0]
        centres = np.cumsum(LINE.directions * np.array([[0.75], [1.0], [0.75]]), axis=0)
        ends = np.array([centres[j] + 0.19 * pin for j in (0, 1) for pin in found[j]])
        # The driving yoke is on the drive's side of the cross, the driven one on the output's.
        roots = [
            centres[j] + side * 0.22 * LINE.directions[j + (side > 0)]
            for j in (0, 1)
            for side in (-1, 1)
        ]
        # Shaft ends: that of the drive, the roots of the yokes in their order, that of the output.
        ways = [np.zeros(3), *roots, centres[-1]]
        want = np.array([*ends, *(root for root in roots for _ in "12"), *ways])[:, shown] * signs
        got = np.array([*marks, *(base[:2] for base in bases), *np.reshape(shafts, (-1, 2))])
        # Up to where the view is and its scale.
        scale = np.ptp(got[:, 0]) / np.ptp(want[:, 0])
        assert 200.0 < scale < 400.0
        assert np.max(np.abs(got - got[0] - scale * (want - want[0]))) < 0.3
        # The viewer is at the end of the third axis.
        away = [sign * pin[towards] < 0 for j in (0, 1) for pin in found[j] for sign in (1, -1)]
        assert [base[2] for base in bases] == away


@in_browser
@pytest.mark.parametrize(
    "name",
    [
        # Pages of examples alike in what they show are opened in the long tier.
        pytest.param(
            name, marks=() if name in {*MACHINES, *SMALL_PAGES, *ODD} else pytest.mark.long
        )
        for name in PAGES
    ],
)
def test_every_page(name: str, browser: webdriver.Chrome, folder: Path) -> None:
    """No request, no sideways scrolling on a phone, every number there at both ends, in order."""
    screen(browser, 360)
    slider = opened(browser, folder, name)
    assert js(browser, "return performance.getEntriesByType('resource').length") == 0
    assert js(browser, "return document.documentElement.scrollWidth") <= 360
    for key in (Keys.END, Keys.HOME):
        slider.send_keys(key)
        outputs = js(
            browser,
            "return [...document.querySelectorAll('.turn output')].map((o) => o.textContent)",
        )
        assert bool(outputs) == (name != "straight")
        assert all(re.fullmatch(r"\N{MINUS SIGN}?\d+(\.\d+)?", text) for text in outputs)
        assert "NaN" not in js(browser, "return document.querySelector('main').innerHTML")
    levels = js(
        browser,
        "return [...document.querySelectorAll('h1,h2,h3')].map((heading) => +heading.tagName[1])",
    )
    assert levels[0] == 1
    assert all(1 < level <= before + 1 for before, level in pairwise(levels))
    assert js(
        browser,
        """return [...document.querySelectorAll("a[href]")].every((link) =>
            document.querySelector(link.getAttribute("href")))""",
    )
    title = js(browser, "return document.querySelector('title').textContent")
    assert title == js(browser, "return document.querySelector('h1').textContent")
    assert (title == HOSTILE) == (name == "hostile")


@in_browser
def test_keyboard_reaches_everything(browser: webdriver.Chrome, folder: Path) -> None:
    opened(browser, folder, "z")
    body = browser.find_element(By.TAG_NAME, "body")
    body.send_keys(Keys.TAB)
    first = browser.switch_to.active_element
    assert first.text == "Skip to the answer"
    assert first.rect["x"] >= 0
    first.send_keys(Keys.ENTER)
    assert browser.current_url.endswith("#answer")
    reached: set[str] = set()
    while "Equivalent bend" not in reached and len(reached) < 40:
        browser.switch_to.active_element.send_keys(Keys.TAB)
        style = js(
            browser,
            """const it = document.activeElement, style = getComputedStyle(it);
            return [it.id || it.getAttribute("href") || it.getAttribute("aria-label"),
                    it === document.body || style.outlineStyle !== "none"]""",
        )
        reached.add(style[0])
        assert style[1], f"no mark of the focus on {style[0]}"
    assert {"Motion of the shafts over a whole turn at constant drive speed", "sample"} <= reached
    assert browser.find_element(By.CSS_SELECTOR, "label[for=sample]").text == "Drive angle"
    assert js(
        browser,
        """return [...document.querySelectorAll("svg:not([aria-hidden])")].every((svg) =>
            svg.getAttribute("aria-label") &&
            (svg.closest(".live") || svg.getAttribute("role") === "img"))""",
    )


@in_browser
def test_only_its_own_script_runs(chromium: webdriver.Chrome, folder: Path, tmp_path: Path) -> None:
    """Whatever might slip into the page, the policy in its head lets nothing run or load."""
    page = (folder / "z.html").read_text(encoding="utf-8")
    intruder = "<script>document.title = 'taken'</script><img src='data:,' onerror='alert()'>"
    (tmp_path / "taken.html").write_text(page.replace("</main>", f"{intruder}</main>"))
    opened(chromium, tmp_path, "taken")
    assert chromium.title == "Z shaft"
    refused = " ".join(said(chromium))
    assert "script-src" in refused
    assert curves_shown(chromium)


def luminance(colour: str) -> float:
    parts = [float(part) / 255.0 for part in re.findall(r"[\d.]+", colour)[:3]]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


@in_browser
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_contrast(scheme: str, browser: webdriver.Chrome, folder: Path) -> None:
    """Text 4.5 to 1, curves 3 to 1, by the Web Content Accessibility Guidelines."""
    media(browser, scheme=scheme)
    opened(browser, folder, "truck")
    page, tint = js(
        browser,
        """return [document.body, document.querySelector(".cards section")].map((element) =>
            getComputedStyle(element).backgroundColor)""",
    )
    assert (luminance(page) < 0.2) == (scheme == "dark")
    texts = js(
        browser,
        """document.querySelector(".good").insertAdjacentHTML("afterend", "<p class=fair>!</p>");
        const names = ["body", "header p", ".good", ".fair", ".bad", "thead th", "nav a", "code"];
        return names.map((name) => getComputedStyle(document.querySelector(name)).color)""",
    )
    strokes = js(
        browser,
        """return [0, 1, 2, 3, 4].map((i) =>
            getComputedStyle(document.querySelector(`polyline.c${i}`)).stroke)""",
    )
    for colours, least in ((texts, 4.5), (strokes, 3.0)):
        for colour in colours:
            for ground in (page, tint):
                dark, light = sorted((luminance(colour), luminance(ground)))
                assert (light + 0.05) / (dark + 0.05) >= least, (colour, ground)


@in_browser
def test_print(browser: webdriver.Chrome, folder: Path) -> None:
    media(browser, "print", "dark")
    slider = opened(browser, folder, "truck")
    assert not slider.is_displayed()
    assert luminance(js(browser, "return getComputedStyle(document.body).color")) < 0.1
    assert js(browser, "return getComputedStyle(document.querySelector('.scroll')).overflowX") == (
        "visible"
    )
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"paperWidth": 8.27, "paperHeight": 11.69})
    document = base64.b64decode(printed["data"])
    assert document.startswith(b"%PDF")
    assert 3 <= len(re.findall(rb"/Type\s*/Page\b", document)) <= 8


def test_twists_lie_within_half_a_turn(tmp_path: Path) -> None:
    """A twist of -180 deg is printed as the 180 deg that cardan run prints."""
    text = "[driveline]\nbends_deg = [8, 8]\ntwists_deg = [-180]\nphases_deg = [350]\n"
    said = PageText(written(scene(text), tmp_path)).text
    assert "-180" not in said
    assert "350" not in said


def test_a_straight_driveline_loads_no_bearing(tmp_path: Path) -> None:
    said = PageText(written(scene("[driveline]\nbends_deg = [0, 0]\n"), tmp_path)).text
    assert "No joint is bent, so the joints put no moment on the bearings." in said
    assert "Highest bending reaction" not in said
