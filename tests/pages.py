"""What a page of the report shows and what a command prints, read back.

Of a page the cells of its tables and the values of its curves; of a text labels with their words,
rows of tables, numbers. In Chromium its live part is moved, and its figures are read.
"""

from __future__ import annotations

import html
import json
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement

from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene
from example_scenes import example

REQUIRED = bool(os.environ.get("CARDAN_REQUIRE_BROWSER"))
in_browser = pytest.mark.xdist_group("browser")
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
"""Scenes whose pages have something that others do not."""

EXAMPLES = Path(__file__).parents[1] / "examples"


def page_of(scene: Scene | str, folder: Path) -> str:
    """Return the page of a scene, or of the text of one, that is written into a folder."""
    scene = Scene.parse(scene, "a.toml") if isinstance(scene, str) else scene
    write_report(scene, folder / "a.html")
    return (folder / "a.html").read_text(encoding="utf-8")


def tables(page: str) -> dict[str, list[list[str]]]:
    """Return the rows of every table by its caption, the head first."""
    return {
        html.unescape(caption): [
            [plain(cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)]
            for row in re.findall(r"<tr>(.*?)</tr>", rows)
        ]
        for caption, rows in re.findall(r"<caption>(.*?)</caption>(.*?)</table>", page, re.S)
    }


def plain(cell: str) -> str:
    """Return the text of a cell with numbers as the terminal has them."""
    return re.sub(r"\N{MINUS SIGN}(?=[\d.])", "-", html.unescape(cell))


def drawings(page: str) -> list[Any]:
    """Return the data of everything that a page draws, in its order."""
    found = re.findall(r'<div class="drawing"><script[^>]*>(.*?)</script>', page)
    return [json.loads(data) for data in found]


def figure(page: str, heading: str) -> Any:  # noqa: ANN401 - JSON
    """Return the data of what has a heading with its unit; there must be exactly one."""
    found = [each for each in drawings(page) if headed(each) == heading]
    assert len(found) == 1, heading
    return found[0]


def headed(drawing: Any) -> str:  # noqa: ANN401 - JSON
    """Return the heading of a drawing as the page shows it."""
    unit = drawing.get("unit")
    return f"{drawing['heading']} [{unit}]" if unit else str(drawing["heading"])


def three(value: float) -> str:
    """Return three digits, or every one before the point."""
    return f"{value:.{max(0, 2 - int(f'{abs(value):.2e}'[5:]))}f}" if value else "0"


def near(text: str) -> Any:  # noqa: ANN401 - pytest gives it no type
    """Return what a printed number may be of: half of its last digit on either side."""
    digits = re.findall(r"-?\d+(?:\.(\d+))?", text)[0]
    return pytest.approx(first_number(text), abs=0.5000001 * 10.0 ** -len(digits))


def curves(chart: Any) -> dict[str, NDArray[np.float64]]:  # noqa: ANN401 - JSON
    """Return the points ``(n, 2)`` of every curve that is sent, by its label; gaps are NaN."""
    return {
        curve["label"]: np.array([chart["x"], curve["values"]], dtype=np.float64).T
        for curve in chart["curves"]
    }


def printed(command: str, name: str, *more: str | Path) -> str:
    """Return what a command prints of an example."""
    arguments = [command, str(example(f"{name}.toml")), *map(str, more)]
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    return result.output


def blocks(text: str) -> dict[str, dict[str, str]]:
    """Return the two columns below each heading, lines that are continued put together."""
    found: dict[str, dict[str, str]] = {}
    heading, label = "", ""
    for line in text.splitlines():
        if not line.startswith("  "):
            heading, label = line, ""
        elif line.startswith("      "):
            found[heading][label] += f" {line.strip()}"
        else:
            label, _, words = line.strip().partition("  ")
            found.setdefault(heading, {})[label] = words.strip()
    return found


def rows(text: str, heading: str) -> list[list[str]]:
    """Return the cells of the table below a heading, the head first."""
    lines = text.partition(f"{heading}\n")[2].partition("\n\n")[0].splitlines()
    return [re.split(r"\s{2,}", line.strip()) for line in lines]


def first_number(text: str) -> float:
    """Return the number with which a text begins."""
    found = re.match(r"-?[\d.]+", text)
    assert found, text
    return float(found[0])


class Drawn(NamedTuple):
    """A chart as a browser draws it; its curves are in the units of its axes."""

    heading: str
    spoken: str
    ticks: dict[str, list[float]]  # of "x" and "y"
    names: list[str]  # texts along x
    legend: list[str]
    curves: list[NDArray[np.float64]]  # points ``(n, 2)``; of gaps NaN; none where it is text
    former: list[NDArray[np.float64]]  # those of what was drawn before, dashed
    bounds: list[float]  # limits
    axes: dict[str, NDArray[np.float64]]  # from places to numbers

    def along(self, axis: str, places: list[float]) -> list[float]:
        """Return what an axis has at some places."""
        return [float(np.polyval(self.axes[axis], place)) for place in places]


_READ_CHART = """
const figure = arguments[0], svg = figure.querySelector(":scope > svg");
const all = (query) => [...svg.querySelectorAll(query)];
const texts = (name) => all(`text[${name}]`);
const paths = (query) => all(query).map((path) => path.getAttribute("d") ?? "");
return {
    heading: figure.querySelector("figcaption").textContent,
    spoken: svg.getAttribute("aria-label"),
    x: texts("data-x").map((t) => [Number(t.getAttribute("x")), Number(t.dataset.x)]),
    y: texts("data-y").map((t) => [Number(t.getAttribute("y")) - 4, Number(t.dataset.y)]),
    names: texts("data-x").map((t) => t.textContent),
    legend: [...figure.querySelectorAll("li")].map((li) => li.textContent.trim()),
    curves: paths(".curve:not(.former)"),
    former: paths(".former"),
    bounds: paths(".bound").join(""),
};
"""


def chart_in(browser: Any, figure: Any) -> Drawn:  # noqa: ANN401 - selenium's own
    """Read a chart back from its figure; no curve lies outside its frame."""
    read = browser.execute_script(_READ_CHART, figure)
    ticks = {axis: np.array(read[axis], dtype=np.float64) for axis in "xy"}
    axes = {axis: np.polyfit(each[:, 0], each[:, 1], 1) for axis, each in ticks.items()}
    low, high = sorted((read["y"][0][0], read["y"][-1][0]))

    def points(path: str) -> NDArray[np.float64]:
        pieces = []
        for piece in filter(None, path.split("M")):
            places = np.array([point.split() for point in piece.split("L")], dtype=float)
            assert low - 0.1 <= places[:, 1].min() <= places[:, 1].max() <= high + 0.1
            own = [
                np.polyval(axes[axis], column) for axis, column in zip("xy", places.T, strict=True)
            ]
            pieces += [np.stack(own, axis=-1), np.full((1, 2), np.nan)]
        return np.concatenate(pieces[:-1]) if pieces else np.empty((0, 2))

    bounds = [float(y) for y in re.findall(r"M[\d.]+ ([-\d.]+)", read["bounds"])]
    return Drawn(
        read["heading"],
        read["spoken"],
        {axis: [value for _, value in read[axis]] for axis in "xy"},
        read["names"],
        read["legend"],
        [points(path) for path in read["curves"]],
        [points(path) for path in read["former"]],
        [float(np.polyval(axes["y"], y)) for y in bounds],
        axes,
    )


# --- in Chromium ------------------------------------------------------------------------------


def started() -> Iterator[webdriver.Chrome]:
    """A browser, until it is no longer needed."""
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        if REQUIRED:
            pytest.fail("CARDAN_REQUIRE_BROWSER is set and chromium or chromedriver is missing")
        pytest.skip("no chromium with chromedriver")
    options = Options()
    options.binary_location = browser
    # Containers have neither user namespaces nor room in /dev/shm.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = webdriver.Chrome(options, Service(driver))
    chrome.implicitly_wait(10)
    yield chrome
    chrome.quit()


def at_rest(browser: webdriver.Chrome) -> None:
    """As wide as a desk, in light, with nothing said on its console."""
    screen(browser, 1280, 900)
    media(browser)
    console(browser)


def console(browser: webdriver.Chrome) -> list[str]:
    """What the browser's console has said since it was last asked."""
    return [entry["message"] for entry in browser.get_log("browser")]  # type: ignore[no-untyped-call]


def screen(browser: webdriver.Chrome, width: int, height: int) -> None:
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def media(browser: webdriver.Chrome, kind: str = "screen", scheme: str = "light") -> None:
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": kind, "features": [feature]})


def show(browser: webdriver.Chrome, page: str, folder: Path) -> None:
    (folder / "page.html").write_text(page, encoding="utf-8")
    browser.get((folder / "page.html").as_uri())


def opened(browser: webdriver.Chrome, page: str, folder: Path) -> None:
    """Show a page and wait until what it shows can be moved."""
    show(browser, page, folder)
    browser.find_element(By.CSS_SELECTOR, "#live-panel .rows, #live-panel .why")


def js(browser: webdriver.Chrome, script: str, *arguments: object) -> Any:  # noqa: ANN401
    return browser.execute_script(script, *arguments)


def figures(browser: webdriver.Chrome) -> list[tuple[str, float, str]]:
    """Every figure of the live part that the check has: its path, its value and its text."""
    found = js(
        browser,
        """return [...document.querySelectorAll(".live [data-path^='check:']")]
            .filter((e) => e.textContent)
            .map((e) => [e.dataset.path, Number(e.dataset.value), e.textContent])""",
    )
    return [(path, value, text) for path, value, text in found]


def verdict_of(browser: webdriver.Chrome) -> str:
    return str(js(browser, "return document.querySelector('#live-panel .head').dataset.verdict"))


def handle(browser: webdriver.Chrome, point: int, view: int = 0) -> WebElement:
    return browser.find_element(
        By.CSS_SELECTOR, f".handle[data-point='{point}'][data-view='{view}']"
    )


def settled(browser: webdriver.Chrome) -> None:
    """Wait until what was asked for has been drawn and judged."""
    browser.execute_async_script(
        "const [done] = arguments; requestAnimationFrame(() => requestAnimationFrame(done))"
    )


def place_of(browser: webdriver.Chrome, point: int) -> list[float]:
    script = "return cardanPage.model.points(cardanPage.model.state)[arguments[0]]"
    found = js(browser, script, point)
    return [float(x) for x in found]
