"""The report: what it says, and what it does in a real browser."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import time
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import pytest

from cardan import Driveline, Limits, Load, __version__
from cardan.app.answers.limits import MotionFigures
from cardan.app.answers.printed import number_text
from cardan.app.answers.rows import rows_of
from cardan.app.report.live import views
from cardan.app.report.samples import NOMINAL_TORQUE, evaluated
from cardan.app.scene import Scene
from cardan.design.judged import Finding
from cardan.design.quantities import label as label_of
from example_scenes import DRIVELINES, EXAMPLES, Answers, each_driveline
from pages import (
    HOSTILE,
    ODD,
    Z_SHAFT,
    drawings,
    headed,
    near,
    page_of,
    tables,
    three,
)
from tiers import few

LINE = Driveline.from_bends([12, 9], [170], [20], degrees=True)
LOAD = Load(drive_torque=300.0, speed=50.0 * np.pi, inertias=[0.0, 0.1, 0.3])


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
    page = page_of(f"[driveline]\nbends_deg = [15, 15]\ntwists_deg = [180]\n{states}", tmp_path)
    (found,) = (rows for caption, rows in tables(page).items() if "Harmonics" in caption)
    assert [cells[1:] for cells in found[1:]] == 3 * [["0", "0"]]


def test_tables_are_the_librarys(tmp_path: Path) -> None:
    found = tables(page_of(Z_SHAFT, tmp_path))
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
    page = page_of(f"[driveline]\nbends_deg = {bends.tolist()}\n", tmp_path)
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
    assert len(named) == 2
    for name, (right, down, viewer) in named.items():
        assert np.linalg.det([right, -down, viewer]) == pytest.approx(1.0), name
        # The drive is on the left.
        assert right @ main > 0.0
        said = re.fullmatch(r"(?:Side|Top) view: (-?[xyz]) to the right, (-?[xyz]) (up|down)", name)
        assert said
        axes = {
            f"{sign}{axis}": way
            for sign, ways in (("", np.eye(3)), ("-", -np.eye(3)))
            for axis, way in zip("xyz", ways, strict=True)
        }
        assert np.array_equal(axes[said[1]], right)
        assert np.array_equal(axes[said[2]], down if said[3] == "down" else -down)


def test_head_names_file_date_and_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    said = PageText(page_of(Z_SHAFT, tmp_path)).text
    assert f"Scene file a.toml. Report of 1970-01-02 by cardan {__version__}." in said
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    before = time.strftime("%Y-%m-%d")
    said = PageText(page_of(Z_SHAFT, tmp_path)).text
    assert f"Report of {before} by" in said or f"Report of {time.strftime('%Y-%m-%d')} by" in said


def label_and_value(finding: Finding) -> tuple[str, str]:
    """What the page calls a figure of the motion, and its worst value with its unit."""
    rows = {name: row for name, row, _ in rows_of(MotionFigures)}
    unit = "°" if finding.unit == "deg" else f" {finding.unit}"
    return rows[finding.figure].label, f"{finding.worst:.{2 if unit == '°' else 0}f}{unit}"


def test_answers_are_the_librarys(tmp_path: Path) -> None:
    said = PageText(page_of(Z_SHAFT, tmp_path)).text
    found = LINE.check(50.0 * np.pi)
    assert "No. The motion is beyond the limits." in said
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
    page = page_of(text, tmp_path)
    assert '<p class="verdict fair">Tolerably. The motion is tolerable' in page
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


def test_without_a_load_moments_are_for_a_stated_torque(tmp_path: Path) -> None:
    """Also where the load is a speed alone, or inertias that nothing turns."""
    drive = "[driveline]\nbends_deg = [20]\n"
    for load in ("", "[load]\nspeed_rpm = 10\n", "[load]\nspeed_rpm = 0\ninertias_kgm2 = [0, 1]\n"):
        page = page_of(drive + load, tmp_path)
        said = PageText(page).text
        peak = NOMINAL_TORQUE * np.tan(np.radians(20.0))
        assumed = f"for an assumed drive torque of {NOMINAL_TORQUE:g} N m"
        assert f"What loads the bearings, {assumed}?" in said
        headings = re.findall(r"<(h3|caption)>(.*?)</", page)
        of_loads = [words for _, words in headings if re.search("[Ll]oads|torque|bend|mom", words)]
        assert len(of_loads) >= 3
        assert all(assumed in words.replace("\N{NO-BREAK SPACE}", " ") for words in of_loads)
        assert f"shaft 0: up to {three(peak)} N m" in said
    assert "assumed" not in PageText(page_of(Z_SHAFT, tmp_path)).text


def test_a_study_answers_for_all_of_it(tmp_path: Path) -> None:
    of = Scene.parse(
        "[driveline]\nbends_deg = [5, 5]\n[study]\nbends_deg.0 = {from = 0, to = 10, steps = 11}\n"
    )
    said = PageText(page_of(of, tmp_path)).text
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
    page = page_of(GRID, tmp_path)
    said = PageText(page).text
    assert "bend, joint 0: 6 deg; phase, shaft 1: 0 deg; speed: 1000 rpm" in said
    best = Driveline.from_bends([6, 6], [180], [0], degrees=True).check(1000.0 * np.pi / 30.0)
    section = said[said.index("Best driveline") : said.index("What varies")]
    assert all(label_and_value(finding)[0] in section for finding in best.findings)
    assert "equivalent bend: 0°, within the limit of 3°" in section
    # Among equals the first, and how many there are.
    equal = GRID.replace("speed_rpm = [2000, 1000]", "output_torque_Nm = [100, 200]")
    said = PageText(page_of(equal, tmp_path)).text
    assert "(the first of 2 that are as good)" in said


def test_a_study_says_what_its_figures_are(tmp_path: Path) -> None:
    page = page_of(GRID, tmp_path)
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
    assert [headed(each) for each in drawings(study)] == figures
    assert not re.search(r"[a-z]_[a-z]", PageText(study).text)
    # The third key is held where the best driveline has it.
    assert "Drawn for the best driveline's speed: 1000 rpm." in PageText(study).text


def test_all_curves_of_a_study_are_drawn_or_a_map(tmp_path: Path) -> None:
    """A curve for each value of the shorter key up to six; more make a map, none is dropped."""
    for steps in (6, 7):
        of = Scene.parse(
            "[driveline]\nbends_deg = [5, 5]\ntwists_deg = [180]\n[study]\n"
            f"bends_deg.0 = {{from = 1, to = {steps}, steps = {steps}}}\n"
            "bends_deg.1 = {from = 0, to = 30, steps = 61}\n"
            '[output]\nclosed_forms = ["equivalent_bend"]\n'
        )
        page = page_of(of, tmp_path)
        study = page[page.index('id="study"') : page.index('id="pictures"')]
        (made,) = drawings(study)
        if steps == 6:
            labels = [curve["label"] for curve in made["curves"]]
            assert labels == [f"bend, joint 0: {value} deg" for value in range(1, 7)]
        else:
            assert made["kind"] == "map"
            assert np.shape(made["values"]) == (7, 61)
            assert made["least"] == [1.0, 1.0]


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
    assert "One recorded sample in 3 is drawn; the tables use all of them." in page_of(
        Scene.load(tmp_path / "a.toml"), tmp_path
    )


@each_driveline
def test_every_example_has_a_page_that_needs_nothing_else(path: Path, answered: Answers) -> None:
    page = answered(path).page
    assert len(page.encode()) < 760_000
    for tag, attributes in PageText(page).elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")
    assert not re.search(r"@import|url\(|fetch\(|XMLHttp|innerHTML", page)
    assert str(Path(__file__).parents[3]) not in page


@pytest.mark.parametrize(
    "path",
    few(DRIVELINES, [path for path in DRIVELINES if path.stem in ("foeppl", "suspension")]),
    ids=lambda path: path.stem,
)
def test_a_page_is_the_same_every_time(path: Path, tmp_path: Path, answered: Answers) -> None:
    assert page_of(Scene.load(path), tmp_path) == answered(path).page


def test_title_is_escaped(tmp_path: Path) -> None:
    page = page_of(ODD["hostile"], tmp_path)
    parsed = PageText(page)
    assert sum(tag == "script" for tag, _ in parsed.elements) == 3
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
    parsed = PageText(page_of(Scene.load(path), tmp_path))
    assert parsed.text.count(f"{name}.toml") == 3
    assert f"Recording{name}.npz" in parsed.text
    assert "b" not in [tag for tag, _ in parsed.elements]
    # A file's name that is no text, as the system hands it over.
    strange = Scene.parse("[driveline]\nbends_deg = [5]\n", "\udcff.toml")
    assert "<title>?.toml</title>" in page_of(strange, tmp_path)


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
    of = Scene.load(paths[name]) if name in paths else Scene.parse(ODD[name])
    tame = PageText(page_of(of, tmp_path))
    render, given = jinja2.Template.render, dict[str, Any]()

    def tampered(self: jinja2.Template, first: dict[str, Any], **more: Any) -> str:  # noqa: ANN401
        every = {**first, **more}
        own = {key: every.pop(key) for key in ("style", "script")}
        given.update(hostile(every))
        return render(self, given, **own)

    monkeypatch.setattr(jinja2.Template, "render", tampered)
    page = page_of(of, tmp_path)
    wild = PageText(page)
    assert [(tag, list(has)) for tag, has in wild.elements] == [
        (tag, list(has)) for tag, has in tame.elements
    ]
    assert wild.text.count(HOSTILE) > 50
    for each in given["charts"]:
        assert each in drawings(page)


def test_a_straight_driveline_loads_no_bearing(tmp_path: Path) -> None:
    said = PageText(page_of("[driveline]\nbends_deg = [0, 0]\n", tmp_path)).text
    assert "No joint is bent, so the joints put no moment on the bearings." in said
    assert "Highest bending reaction" not in said
