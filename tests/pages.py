"""What a page of the report shows and what a command prints, read back.

Of a page the cells of its tables and the values of its curves; of a text labels with their words,
rows of tables, numbers. In Chromium its live part is moved, and its figures are read.
"""

from __future__ import annotations

import html
import os
import re
import shutil
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement

from cardan.app.charts.charts import FRAME
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene
from example_scenes import example

REQUIRED = bool(os.environ.get("CARDAN_REQUIRE_BROWSER"))
in_browser = pytest.mark.xdist_group("browser")
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


def figure(page: str, heading: str) -> ElementTree.Element:
    """Return the figure with a heading; there must be exactly one."""
    found = [
        element
        for element in map(ElementTree.fromstring, re.findall(r"<figure>.*?</figure>", page, re.S))
        if element[0].text == heading
    ]
    assert len(found) == 1, heading
    return found[0]


def three(value: float) -> str:
    """Return three digits, or every one before the point."""
    return f"{value:.{max(0, 2 - int(f'{abs(value):.2e}'[5:]))}f}" if value else "0"


def near(text: str) -> Any:  # noqa: ANN401 - pytest gives it no type
    """Return what a printed number may be of: half of its last digit on either side."""
    digits = re.findall(r"-?\d+(?:\.(\d+))?", text)[0]
    return pytest.approx(first_number(text), abs=0.5000001 * 10.0 ** -len(digits))


def value(text: str) -> float:
    """Return a number as the page writes it, with a true minus sign."""
    return float(text.replace("\N{MINUS SIGN}", "-"))


def scales(
    chart: ElementTree.Element, names: Sequence[str] = ()
) -> dict[str, list[tuple[float, float]]]:
    """Return place and value of every tick of each axis; a name along x has its number."""
    ticks: dict[str, list[tuple[float, float]]] = {"x": [], "y": []}
    for line, text in pairwise(chart[1]):
        if line.get("class") == "grid":
            axis = "x" if line.get("x1") == line.get("x2") else "y"
            shown = text.text or ""
            number = names.index(shown) if axis == "x" and names else value(shown)
            ticks[axis].append((float(line.attrib[f"{axis}1"]), number))
    return ticks


def legend_of(chart: ElementTree.Element) -> list[str]:
    """Return the words beside the curves or bands."""
    return [" ".join("".join(item.itertext()).split()) for item in chart[2]]


def curves(chart: ElementTree.Element, names: Sequence[str] = ()) -> dict[str, NDArray[np.float64]]:
    """Return the points ``(n, 2)`` of every curve by its legend, as its axes say where they are.

    Along an axis of names they have the numbers of these.

    None of them lies outside the frame.
    """
    ticks = {axis: np.array(found) for axis, found in scales(chart, names).items()}
    x_axis, y_axis = (np.polyfit(ticks[axis][:, 0], ticks[axis][:, 1], 1) for axis in "xy")
    found: dict[str, list[str]] = {}
    for line in chart.iter("polyline"):
        label = legend_of(chart)[int(line.attrib["class"].removeprefix("curve c"))]
        found.setdefault(label, []).extend(line.attrib["points"].split())
    drawn = {}
    for label, points in found.items():
        x, y = np.transpose([point.split(",") for point in points]).astype(np.float64)
        for places, low, high in (
            (x, FRAME.left, FRAME.right),
            (y, FRAME.top, FRAME.bottom),
        ):
            assert low - 0.1 <= places.min() <= places.max() <= high + 0.1, label
        drawn[label] = np.stack([np.polyval(x_axis, x), np.polyval(y_axis, y)], axis=-1)
    return drawn


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


# --- in Chromium ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def chromium() -> Iterator[webdriver.Chrome]:
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        if REQUIRED:
            pytest.fail("CARDAN_REQUIRE_BROWSER is set and chromium or chromedriver is missing")
        pytest.skip("no chromium with chromedriver")
    options = Options()
    options.binary_location = browser
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = webdriver.Chrome(options, Service(driver))
    chrome.implicitly_wait(10)
    yield chrome
    chrome.quit()


@pytest.fixture
def browser(chromium: webdriver.Chrome) -> Iterator[webdriver.Chrome]:
    """The browser as wide as a desk; at the end its console has said nothing."""
    size = {"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    chromium.get_log("browser")  # type: ignore[no-untyped-call]
    yield chromium
    assert chromium.get_log("browser") == []  # type: ignore[no-untyped-call]


def opened(browser: webdriver.Chrome, page: str, folder: Path) -> None:
    (folder / "page.html").write_text(page, encoding="utf-8")
    browser.get((folder / "page.html").as_uri())
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
