"""The report in a real browser: its charts, keyboard, contrast, and what it lets run."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.wait import WebDriverWait

from cardan.app.answers.page import Curve, Panel, chart
from cardan.app.report.live import script
from cardan.app.report.page import environment
from cardan.app.report.study import heat_map
from example_scenes import DRIVELINES, EXAMPLES, Answers
from pages import (
    HOSTILE,
    ODD,
    Z_SHAFT,
    Drawn,
    chart_in,
    console,
    headed,
    in_browser,
    js,
    media,
    page_of,
    screen,
    settled,
    show,
)
from tiers import few

MACHINES = [path.stem for path in EXAMPLES if path.parent.name == "machines"]


SMALL_PAGES = ("foeppl", "suspension", "recorded_run")


# --- in a browser ----------------------------------------------------------------------------


@pytest.fixture
def page_named(tmp_path: Path, answered: Answers) -> Callable[[str], str]:
    """The page of an example or of an odd scene, by its name."""
    paths, texts = {path.stem: path for path in DRIVELINES}, {**ODD, "z": Z_SHAFT}

    def found(name: str) -> str:
        return answered(paths[name]).page if name in paths else page_of(texts[name], tmp_path)

    return found


PAGES = [*(path.stem for path in DRIVELINES), *ODD, "z"]


def until_live(browser: webdriver.Chrome) -> None:
    """Wait until the driveline of a page can be moved."""
    WebDriverWait(browser, 10).until(lambda _: js(browser, "return Boolean(window.cardanPage)"))


def stands_where_its_data_say(browser: webdriver.Chrome) -> list[Drawn]:
    """Everything that a page draws is read back from it and compared with what Python has sent."""
    found = []
    for place in js(browser, "return [...document.querySelectorAll('.drawing')]"):
        script = place.find_element(By.TAG_NAME, "script").get_attribute("textContent")
        sent, shown = json.loads(script or ""), place.find_element(By.TAG_NAME, "figure")
        {"chart": _is_chart, "map": _is_map, "bars": _is_bars}[sent["kind"]](browser, shown, sent)
        if sent["kind"] == "chart":
            found.append(chart_in(browser, shown))
    return found


def _is_chart(browser: webdriver.Chrome, shown: WebElement, sent: Any) -> None:  # noqa: ANN401
    chart = chart_in(browser, shown)
    assert chart.heading == headed(sent)
    labels = [curve["label"] for curve in sent["curves"]]
    assert chart.legend[: len(labels)] == labels
    assert len(chart.legend) == len(labels) + bool(sent["left_out"])
    is_named = bool(sent["names"]) and len(chart.names) == len(sent["names"])
    x = range(len(sent["x"])) if is_named else sent["x"]
    known = [y for curve in sent["curves"] for y in curve["values"] if y is not None]
    # A tenth of a pixel, or what is rounding.
    close = (chart.ticks["y"][-1] - chart.ticks["y"][0]) / 1000.0
    for curve, own in zip(sent["curves"], chart.curves, strict=True):
        points = [(a, y) for a, y in zip(x, curve["values"], strict=True) if y is not None]
        drawn = own[~np.isnan(own[:, 0])]
        assert np.allclose(drawn[:, 0], [a for a, _ in points], atol=(max(x) - min(x) + 1) / 1000)
        assert np.allclose(drawn[:, 1], [y for _, y in points], atol=close)
    low, high = chart.ticks["y"][0], chart.ticks["y"][-1]
    assert low <= min(known) + close
    assert max(known) - close <= high


def _is_bars(browser: webdriver.Chrome, shown: WebElement, sent: Any) -> None:  # noqa: ANN401
    read = """return [...arguments[0].querySelectorAll("rect")].map((bar) =>
        [bar.previousSibling.textContent, Number(bar.getAttribute("width")),
         bar.nextSibling.textContent])"""
    bars = js(browser, read, shown)
    most = max(size for _, size, _ in sent["items"])
    assert [[label, text] for label, _, text in bars] == [
        [label, text] for label, _, text in sent["items"]
    ]
    widths = [170.0 * size / most for _, size, _ in sent["items"]]
    assert [width for _, width, _ in bars] == pytest.approx(widths, abs=0.06)


def _is_map(browser: webdriver.Chrome, shown: WebElement, sent: Any) -> None:  # noqa: ANN401
    """Each value lies in one cell, of the band that the legend names."""
    paths, legend = js(
        browser,
        """const all = (query) => [...arguments[0].querySelectorAll(query)];
        return [all("path.band").map((path) => path.getAttribute("d")),
                all("li").map((li) => li.textContent.trim())]""",
        shown,
    )
    chart = chart_in(browser, shown)
    x, y, values = (np.array(sent[key], dtype=np.float64) for key in ("x", "y", "values"))
    seen = np.zeros(values.shape, dtype=int)
    for path, label in zip(paths, legend, strict=False):
        low, high = (float(end.replace("\N{MINUS SIGN}", "-")) for end in label.split(" to "))
        for bar in path.split("M")[1:]:
            left, bottom, right, top, _ = map(float, re.findall(r"[-.\d]+", bar))
            across = sorted(chart.along("x", [left, right]))
            up = sorted(chart.along("y", [bottom, top]))
            inside = np.ix_((y > up[0]) & (y < up[1]), (x > across[0]) & (x < across[1]))
            assert values[inside].size
            assert np.all((values[inside] >= low - 1e-9) & (values[inside] <= high + 1e-9))
            seen[inside] += 1
    assert np.all(seen == 1)
    least = np.array(sent["least"])
    mark = js(
        browser,
        "const it = arguments[0].querySelector('.least'); return ['cx', 'cy'].map((name) => "
        "Number(it.getAttribute(name)))",
        shown,
    )
    at = [chart.along("x", mark[:1])[0], chart.along("y", mark[1:])[0]]
    assert at == pytest.approx(least, abs=0.01 * max(np.ptp(x), np.ptp(y)))


def drawn(browser: webdriver.Chrome, folder: Path, *data: dict[str, Any]) -> list[Drawn]:
    """Charts of a page that holds nothing else, read back from it and compared with their data."""
    blocks = environment().from_string(
        '{% from "parts.html" import drawing %}{% for it in data %}{{ drawing(it) }}{% endfor %}'
    )
    text = f"<!DOCTYPE html><body>{blocks.render(data=data)}<script>{script()}</script></body>"
    show(browser, text, folder)
    return stands_where_its_data_say(browser)


@in_browser
def test_curves_stand_where_the_axes_say(browser: webdriver.Chrome, tmp_path: Path) -> None:
    x = np.linspace(-30.0, 240.0, 50)
    curves = (Curve("one", 3.7e-3 * x - 0.21), Curve("two", np.cos(x)))
    made = chart(Panel("a < b", "N m", curves), x, "drive angle [deg]")
    counted = np.array([1.0, 2.0, 4.0])
    whole = chart(Panel("a", "", (Curve("one", counted),)), np.arange(3.0), "counted from 0")
    first, second = drawn(browser, tmp_path, made, whole)
    assert first.heading == "a < b [N m]"
    assert first.ticks == {"x": [0.0, 90.0, 180.0], "y": [-1.0, -0.5, 0.0, 0.5, 1.0]}
    assert first.spoken == "a < b over drive angle [deg], from \u22121 to 1 N m: one, two"
    assert second.names == ["0", "1", "2"]


@in_browser
def test_what_is_flat_and_what_has_gaps(browser: webdriver.Chrome, tmp_path: Path) -> None:
    """What varies by rounding alone is level; a curve has gaps where it has no values."""
    noise = 1.0 + 1e-15 * np.random.default_rng(1).uniform(-1.0, 1.0, 50)
    gaps = [2.0 + slope * np.arange(10.0) for slope in (1.0, 0.0)]
    for values in gaps:
        values[[0, 4, 5]] = np.nan
    level, *pieces = drawn(
        browser,
        tmp_path,
        *(
            chart(Panel("ratio", "", (Curve("one", values),)), np.arange(float(len(values))), "x")
            for values in (noise, *gaps)
        ),
    )
    assert len(set(level.curves[0][:, 1])) == 1
    for chart_of_gaps, slope in zip(pieces, (1.0, 0.0), strict=True):
        (curve,) = chart_of_gaps.curves
        assert np.flatnonzero(np.isnan(curve[:, 0])).tolist() == [3]
        assert bool(np.ptp(curve[:3, 1]) > 1.0) == bool(slope)


@in_browser
def test_degrees_divide_the_turn(browser: webdriver.Chrome, tmp_path: Path) -> None:
    """At most six ticks, at multiples of a step that divides a turn or of whole turns."""
    steps = {4: 1, 9: 2, 25: 5, 40: 10, 60: 15, 140: 30, 200: 45, 900: 180}
    steps |= {1500: 360, 1800: 360, 1900: 720, 5000: 1080}
    made = []
    for span in steps:
        x = np.linspace(0.0, span, 50)
        made.append(chart(Panel("a", "", (Curve("one", x),)), x, "drive angle [deg]"))
    for shown, (span, step) in zip(drawn(browser, tmp_path, *made), steps.items(), strict=True):
        assert shown.ticks["x"] == list(np.arange(0.0, span + 1e-9, step))
        assert len(shown.names) <= 6


@in_browser
def test_names_are_tilted_as_far_as_needed(browser: webdriver.Chrome, tmp_path: Path) -> None:
    """Long ones are cut, and states that are too many for names have numbers."""
    cases = [(3, 8, 0), (7, 3, 0), (5, 12, 30), (12, 16, 60), (20, 16, 90), (2, 200, 45)]
    names = [[f"{i:x}".ljust(length, "x") for i in range(count)] for count, length, _ in cases]
    names += [["x" * 6] * 5, ["山" * 6] * 5, [f"height {i}" for i in range(40)]]
    made = []
    for each in names:
        values = np.arange(float(len(each)))
        panel = Panel("a", "", (Curve("one", values),))
        made.append(chart(panel, values, "state, counted from 0", ("state", each)))
    shown = drawn(browser, tmp_path, *made)
    read = """return [...document.querySelectorAll(".drawing figure > svg")].map((svg) => {
        const texts = [...svg.querySelectorAll("text")];
        return [/rotate\\(-(\\d+)/.exec(texts[0].getAttribute("transform"))?.[1] ?? "0",
                svg.viewBox.baseVal.height, texts[texts.length - 1].textContent] })"""
    found = js(browser, read)
    for (_, length, tilt), one, (angle, height, over) in zip(cases, shown, found, strict=False):
        assert (int(angle), over) == (tilt, "state")
        assert all(len(text) == min(length, 24) for text in one.names)
        assert all(text.endswith("…") == (length > 24) for text in one.names)
        # Below the frame there is room for the letters of a name that stands upright.
        assert height - 180.0 >= 5.0 * min(length, 24) * np.sin(np.radians(tilt))
    assert [int(angle) for angle, _, _ in found[-3:]] == [0, 30, 0]
    assert shown[-1].names == ["0", "10", "20", "30"]
    assert found[-1][1:] == [180, "state, counted from 0"]


@in_browser
def test_a_map_has_each_value_in_its_band(browser: webdriver.Chrome, tmp_path: Path) -> None:
    x = np.array(range(41), dtype=np.float64)
    y = np.array([-3.0, -1.0, 0.0, 4.0])
    values = np.hypot(x - 10.0, 5.0 * y[:, np.newaxis])
    made = heat_map(Panel("f", "deg", ()), x, y, values, ["a [deg]", "b"])
    drawn(browser, tmp_path, made)
    assert made["least"] == [10.0, 0.0]
    legend = js(browser, "return [...document.querySelectorAll('li')].map((li) => li.textContent)")
    assert [each.strip() for each in legend[-2:]] == ["30 to 40", "○ least value, at 10, 0"]


@in_browser
@pytest.mark.parametrize("name", few(["states", *MACHINES], ["states", "truck-shaft", "test-rig"]))
def test_texts_of_charts_are_apart(
    browser: webdriver.Chrome, page_named: Callable[[str], str], tmp_path: Path, name: str
) -> None:
    """In the browser's own font, every text is within its chart and covers no other."""
    show(browser, page_named(name), tmp_path)
    js(browser, 'document.getElementById("sent").open = true;')
    settled(browser)
    charts = js(
        browser,
        """return [...document.querySelectorAll(".drawing svg[role=img]")].map((svg) => ({
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


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether a side of one of two rectangles, by their corners, has all of the other beyond it."""
    for corners in (one, other):
        for side in (corners[1] - corners[0], corners[3] - corners[0]):
            first, second = one @ side, other @ side
            if first.max() <= second.min() or second.max() <= first.min():
                return True
    return False


@in_browser
# Pages of examples alike in what they show are opened in the long tier.
@pytest.mark.parametrize("name", few(PAGES, ["truck-shaft", "test-rig", *SMALL_PAGES, *ODD]))
def test_every_page(
    name: str, browser: webdriver.Chrome, page_named: Callable[[str], str], tmp_path: Path
) -> None:
    """No request, no sideways scrolling on a phone, charts of their data, headings in order."""
    screen(browser, 360, 800)
    show(browser, page_named(name), tmp_path)
    assert js(browser, "return performance.getEntriesByType('resource').length") == 0
    assert js(browser, "return document.documentElement.scrollWidth") <= 360
    assert "NaN" not in js(browser, "return document.querySelector('main').innerHTML")
    stands_where_its_data_say(browser)
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
def test_keyboard_reaches_everything(
    browser: webdriver.Chrome, page_named: Callable[[str], str], tmp_path: Path
) -> None:
    show(browser, page_named("z"), tmp_path)
    until_live(browser)
    body = browser.find_element(By.TAG_NAME, "body")
    body.send_keys(Keys.TAB)
    first = browser.switch_to.active_element
    assert first.text == "Skip to the answer"
    assert first.rect["x"] >= 0
    first.send_keys(Keys.ENTER)
    assert browser.current_url.endswith("#answer")
    assert browser.find_element(By.ID, "answer-heading").is_displayed()
    assert not browser.find_element(By.ID, "live-refused").text
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
    assert "Motion of the shafts over a whole turn at constant drive speed" in reached
    assert js(
        browser,
        """return [...document.querySelectorAll("svg:not([aria-hidden])")].every((svg) =>
            svg.getAttribute("aria-label") &&
            (svg.closest(".live") || svg.getAttribute("role") === "img"))""",
    )


@in_browser
def test_only_its_own_script_runs(
    chromium: webdriver.Chrome, page_named: Callable[[str], str], tmp_path: Path
) -> None:
    """Whatever might slip into the page, the policy in its head lets nothing run or load."""
    intruder = "<script>document.title = 'taken'</script><img src='data:,' onerror='alert()'>"
    show(chromium, page_named("z").replace("</main>", f"{intruder}</main>"), tmp_path)
    assert chromium.title == "Z shaft"
    refused = " ".join(console(chromium))
    assert "script-src" in refused
    until_live(chromium)
    assert chromium.find_elements(By.CSS_SELECTOR, "#live-curves path.curve")


def luminance(colour: str) -> float:
    parts = [float(part) / 255.0 for part in re.findall(r"[\d.]+", colour)[:3]]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


@in_browser
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_contrast(
    scheme: str, browser: webdriver.Chrome, page_named: Callable[[str], str], tmp_path: Path
) -> None:
    """Text 4.5 to 1, curves 3 to 1, by the Web Content Accessibility Guidelines."""
    media(browser, scheme=scheme)
    show(browser, page_named("truck"), tmp_path)
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
        """const svg = document.querySelector("#live-curves svg");
        const path = svg.querySelector("path.curve");
        return ["c0", "c1", "c2", "c3", "c4", "c5", "s0", "s1", "s2", "s3", "bound"].map((name) => {
            path.setAttribute("class", `curve ${name}`);
            return getComputedStyle(path).stroke;
        })""",
    )
    for colours, least in ((texts, 4.5), (strokes, 3.0)):
        for colour in colours:
            for ground in (page, tint):
                dark, light = sorted((luminance(colour), luminance(ground)))
                assert (light + 0.05) / (dark + 0.05) >= least, (colour, ground)
