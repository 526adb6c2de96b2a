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
from collections.abc import Iterator
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jinja2
import numpy as np
import pytest
from click.testing import CliRunner
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from cardan import Driveline, Load
from cardan.arrays import FloatArray
from cardan.command import commands
from cardan.report import write_report
from cardan.report.charts import chart
from cardan.report.page import environment
from cardan.report.samples import NOMINAL_TORQUE, Curve, Panel, evaluated, pins
from cardan.scene import Scene
from cardan.words.summary import figure_text

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
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
}


def scene(text: str) -> Scene:
    return Scene.parse(text, "a.toml")


def written(of: Scene, folder: Path) -> str:
    write_report(of, folder / "a.html")
    return (folder / "a.html").read_text(encoding="utf-8")


class Text(HTMLParser):
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


def test_answers_are_the_librarys(tmp_path: Path) -> None:
    said = Text(written(scene(Z_SHAFT), tmp_path)).text
    found = LINE.check(50.0 * np.pi)
    wrong = sum(not finding.passes for finding in found.findings)
    assert f"No. It is above {wrong} of {len(found.findings)} limits." in said
    assert all(str(finding) in said for finding in found.findings)

    turn = np.radians(np.arange(0.0, 360.25, 0.5))
    moments = LINE.evaluate(turn, "support_moment", shafts=slice(None), load=LOAD).support_moment
    sizes = np.linalg.norm(moments, axis=-1)
    peaks = sizes.max(axis=-1)
    most = int(np.argmax(peaks))
    at = np.argmax(sizes[most] >= (1.0 - 1e-9) * peaks[most]) / 2.0
    assert f"Most on shaft {most}: {figure_text(peaks[most])} N m across it, at {at:.1f}°" in said
    for shaft, peak in enumerate(peaks):
        assert f"shaft {shaft}: up to {figure_text(peak)} N m" in said

    # 170 deg of twist are 10 deg counter-clockwise, and that is how the yokes must stand.
    assert (
        "shaft 1: 10.00° counter-clockwise = 170.00° clockwise; turn it 30.00° counter-clockwise"
        in said
    )
    best = np.degrees(LINE.with_phases(LINE.optimal_phases()).equivalent().bend)
    assert f"as it is, {best:.4g}° set so" in said
    assert scene(Z_SHAFT).explain() in said


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
    said = Text(written(scene(text), tmp_path)).text
    assert f"as it is{exact:.4f}{rule:.4f}{rule - exact:.4f}0.0000" in said


def test_without_a_load_moments_are_for_a_stated_torque(tmp_path: Path) -> None:
    """Also where the load is a speed alone, or inertias that nothing turns."""
    drive = "[driveline]\nbends_deg = [20]\n"
    for load in ("", "[load]\nspeed_rpm = 10\n", "[load]\nspeed_rpm = 0\ninertias_kgm2 = [0, 1]\n"):
        said = Text(written(scene(drive + load), tmp_path)).text
        peak = NOMINAL_TORQUE * np.tan(np.radians(20.0))
        assert f"With {NOMINAL_TORQUE:g} N m put into the drive" in said
        assert f"shaft 0: up to {figure_text(peak)} N m" in said
        assert re.findall(r"(?:support )?moment, size", said) == [
            "support moment, size",
            "moment, size",
        ]
    assert f"With {NOMINAL_TORQUE:g} N m" not in Text(written(scene(Z_SHAFT), tmp_path)).text


def test_a_study_answers_for_all_of_it(tmp_path: Path) -> None:
    of = scene(
        "[driveline]\nbends_deg = [5, 5]\n[study]\nbends_deg.0 = {from = 0, to = 10, steps = 11}\n"
    )
    said = Text(written(of, tmp_path)).text
    bends = np.stack([np.arange(11.0), np.full(11, 5.0)], -1)
    kept = np.count_nonzero(Driveline.from_bends(bends, degrees=True).check().passes)
    assert 0 < kept < 11
    assert f"No. {kept} of the study's 11 drivelines keep all limits." in said
    assert "What varies: 11 drivelines" in said


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
    peak = next(samples.support_peaks())
    assert peak.size == pytest.approx(NOMINAL_TORQUE * np.tan(np.radians(30.0)), rel=1e-14)
    assert peak.at_deg == 90.0
    assert "One in 3 recorded samples is shown." in written(
        Scene.load(tmp_path / "a.toml"), tmp_path
    )


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_has_a_page_that_needs_nothing_else(path: Path, tmp_path: Path) -> None:
    page = written(Scene.load(path), tmp_path)
    assert page == written(Scene.load(path), tmp_path)
    assert len(page) < 1_000_000
    for tag, attributes in Text(page).elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")
    assert not re.search(r"@import|url\(|fetch\(|XMLHttp|innerHTML", page)
    assert str(Path(__file__).parents[2]) not in page


def test_title_is_escaped(tmp_path: Path) -> None:
    page = written(scene(ODD["hostile"]), tmp_path)
    parsed = Text(page)
    assert sum(tag == "script" for tag, _ in parsed.elements) == 2
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
    parsed = Text(written(Scene.load(path), tmp_path))
    assert parsed.text.count(f"{name}.toml") == 3
    assert f"Recorded in{name}.npz" in parsed.text
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
    tame = Text(written(of, tmp_path))
    render, given = jinja2.Template.render, dict[str, Any]()

    def tampered(self: jinja2.Template, first: dict[str, Any], **more: Any) -> str:  # noqa: ANN401
        own = {key: more.pop(key) for key in ("style", "script")}
        given.update(hostile({**first, **more}))
        return render(self, given, **own)

    monkeypatch.setattr(jinja2.Template, "render", tampered)
    page = written(of, tmp_path)
    wild = Text(page)
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
    script = "import sys, cardan.command, cardan.report; assert 'jinja2' not in sys.modules"
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
    ticks: dict[str, list[tuple[float, float]]] = {"x": [], "y": []}
    for line, text in pairwise(root[1]):
        if line.get("class") == "grid":
            axis = "x" if line.get("x1") == line.get("x2") else "y"
            value = float((text.text or "").replace("\N{MINUS SIGN}", "-"))
            ticks[axis].append((float(line.attrib[f"{axis}1"]), value))
    assert [value for _, value in ticks["x"]] == [0.0, 90.0, 180.0]
    assert [value for _, value in ticks["y"]] == [-1.0, -0.5, 0.0, 0.5, 1.0]
    x_axis, y_axis = (
        np.polyfit([place for place, _ in found], [value for _, value in found], 1)
        for found in ticks.values()
    )
    for line, values in zip(root.iter("polyline"), (rising, other), strict=True):
        points = np.array([point.split(",") for point in line.attrib["points"].split()], float)
        assert np.max(np.abs(np.polyval(x_axis, points[:, 0]) - x)) < 0.1
        assert np.max(np.abs(np.polyval(y_axis, points[:, 1]) - values)) < 0.01


def test_what_varies_by_rounding_alone_is_flat() -> None:
    noise = 1.0 + 1e-15 * np.random.default_rng(1).uniform(-1.0, 1.0, 50)
    figure = drawn(Panel("ratio", "", (Curve("one", noise),)), np.arange(50.0), "x")
    line = next(figure.iter("polyline"))
    assert len({point.split(",")[1] for point in line.attrib["points"].split()}) == 1


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
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page of every example and of odd scenes."""
    folder = tmp_path_factory.mktemp("pages")
    for path in EXAMPLES:
        write_report(Scene.load(path), folder / f"{path.stem}.html")
    for name, text in {**ODD, "z": Z_SHAFT}.items():
        write_report(scene(text), folder / f"{name}.html")
    return folder


PAGES = [*(path.stem for path in EXAMPLES), *ODD, "z"]


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
        ("angle_error", "speed_ratio", "acceleration_ratio", "torque", "support_moment", "moment"),
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
        curves[f"support moment, size [N m], shaft {shaft}"] = size
    for joint in (0, 1):
        curves[f"moment, size [N m], joint {joint}"] = np.linalg.norm(got.moment[joint])
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


def test_drawing_shows_the_pins(browser: webdriver.Chrome, folder: Path) -> None:
    """Side view: x to the right, y up. The marks sit at one end of each pin."""
    opened(browser, folder, "z")
    for sample in (0, 77, 410):
        moved(browser, sample)
        marks = js(
            browser,
            """return [...document.querySelectorAll("#view-1 .mark")].map((mark) =>
                [mark.cx.baseVal.value, mark.cy.baseVal.value])""",
        )
        found = pins(LINE, np.radians([0.5 * sample]))[0]
        centres = np.cumsum(LINE.directions * np.array([[0.75], [1.0], [0.75]]), axis=0)
        ends = [centres[j] + 0.19 * pin for j in (0, 1) for pin in found[j]]
        want = np.array([[end[0], -end[1]] for end in ends])
        got = np.array(marks)
        # Up to where the view stands and its scale.
        scale = np.ptp(got[:, 0]) / np.ptp(want[:, 0])
        assert 200.0 < scale < 400.0
        assert np.max(np.abs(got - got[0] - scale * (want - want[0]))) < 0.3


@pytest.mark.parametrize("name", PAGES)
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
        assert outputs
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
    assert {"What the bearings give each shaft", "sample"} <= reached
    assert browser.find_element(By.CSS_SELECTOR, "label[for=sample]").text == "Drive angle"
    assert js(
        browser,
        """return [...document.querySelectorAll("svg:not([aria-hidden])")].every((svg) =>
            svg.getAttribute("role") === "img" && svg.getAttribute("aria-label"))""",
    )


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
        """return ["body", "header p", ".good", ".bad", "thead th", "a[href='#inputs']", "pre"].map(
            (name) => getComputedStyle(document.querySelector(name)).color)""",
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
