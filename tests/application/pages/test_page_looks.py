"""How the live part of a page looks on screens of any size and on paper, in Chromium."""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

import pages
from cardan.app.scene import Scene
from cardan.app.scene.language.units import ENDINGS, US, ending_of
from cardan.app.scene.machine import machine_of
from example_scenes import Answers, example
from live import edited
from pages import handle, in_browser, js, media, opened, screen, settled
from tiers import few

TRUCK = example("truck-shaft.toml")
PAGES = [example(f"{name}.toml") for name in ("truck-shaft", "test-rig", "ship-shaft")]
EACH_PAGE = pytest.mark.parametrize("path", few(PAGES, [TRUCK]), ids=lambda path: path.stem)

pytestmark = in_browser
WHITE = "rgb(255, 255, 255)"


@pytest.fixture
def phone(browser: webdriver.Chrome) -> Iterator[webdriver.Chrome]:
    """The browser as narrow as a phone, and touched."""
    screen(browser, 390, 844)
    browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
    yield browser
    browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})


def box(browser: webdriver.Chrome, selector: str) -> dict[str, float]:
    script = "return document.querySelector(arguments[0]).getBoundingClientRect().toJSON()"
    found: dict[str, float] = js(browser, script, selector)
    return found


def touch(browser: webdriver.Chrome, kind: str, *at: float) -> None:
    points = [{"x": at[0], "y": at[1]}] if at else []
    event = {"type": f"touch{kind}", "touchPoints": points}
    browser.execute_cdp_cmd("Input.dispatchTouchEvent", event)


# --- narrow screens ---------------------------------------------------------------------------


def test_the_verdict_of_a_phone_is_a_sheet_that_opens(
    phone: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    opened(phone, answered(TRUCK).page, tmp_path)
    figures = phone.find_element(By.ID, "live-figures")
    button = phone.find_element(By.CSS_SELECTOR, "#live-panel .opener")

    def is_open() -> bool:
        assert button.get_attribute("aria-expanded") == str(figures.is_displayed()).lower()
        panel = box(phone, "#live-panel")
        assert panel["bottom"] == 844
        assert panel["height"] <= (0.7 * 844 + 1 if figures.is_displayed() else 64)
        return figures.is_displayed()

    assert not is_open()
    for y in (600, 10_000, 0):
        js(phone, "scrollTo(0, arguments[0])", y)
        assert not is_open()
    words = phone.find_element(By.CSS_SELECTOR, "#live-panel .head").text.split("\n")
    assert words[0] == "Beyond its limits"
    # In the order of the list below, in which what is not computed here comes last.
    assert words[1] == (
        "3 of 14 beyond: L10 life of joint 1; equivalent bend; "
        "equivalent bend, worst with tolerances"
    )
    assert js(phone, "return document.querySelector('#live-panel .why').clientHeight") < 20
    button.click()
    assert is_open()
    assert js(phone, "const e = document.getElementById('live-panel'); "
        "return e.scrollHeight > e.clientHeight + 100")  # fmt: skip
    phone.find_element(By.CSS_SELECTOR, "#live-panel summary").send_keys(Keys.ESCAPE)
    assert not is_open()
    assert phone.switch_to.active_element == button
    button.send_keys(Keys.ENTER)
    assert is_open()
    # Its first figure is the next stop of the Tab key.
    button.send_keys(Keys.TAB)
    assert phone.switch_to.active_element.tag_name == "summary"
    js(phone, "scrollTo(0, 150)")
    touch(phone, "Start", 200, 120)
    touch(phone, "End")
    assert not is_open()


@EACH_PAGE
def test_a_phone_shows_everything_within_its_width(
    path: Path, phone: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """In the order of the design, and large enough to be touched."""
    opened(phone, answered(path).page, tmp_path)
    phone.find_element(By.CSS_SELECTOR, "#live-panel .opener").click()
    assert js(phone, "return document.documentElement.scrollWidth") == 390
    small = js(
        phone,
        """const touched = ".live button, .live summary, .live input, .live [role=slider], nav a";
        return [...document.querySelectorAll(touched)].filter((e) => {
            const { width, height } = e.getBoundingClientRect();
            return width && Math.min(width, height) < 39.99;
        }).map((e) => e.outerHTML)""",
    )
    assert small == []
    order = ("h1", ".tools", "#live-drawing", ".foot", "#live-states", "#live-dials", "#answer")
    tops = [box(phone, each)["top"] for each in order if is_shown(phone, each)]
    assert tops == sorted(tops)
    assert len(tops) >= 5


def is_shown(browser: webdriver.Chrome, selector: str) -> bool:
    return browser.find_element(By.CSS_SELECTOR, selector).is_displayed()


def test_a_finger_scrolls_the_page_by_the_drawing_and_drags_handles(
    phone: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    opened(phone, answered(TRUCK).page, tmp_path)

    def swipe(x: float, y: float) -> tuple[float, float]:
        """How far the page is scrolled and where a joint is as a finger goes up by 80 px."""
        touch(phone, "Start", x, y)
        for i in range(1, 9):
            touch(phone, "Move", x, y - 10 * i)
        touch(phone, "End")
        settled(phone)
        return js(phone, "return scrollY"), pages.place_of(phone, 2)[1]

    ring = box(phone, ".handle[data-point='2'] .ring")
    x, y = (ring["left"] + ring["right"]) / 2, (ring["top"] + ring["bottom"]) / 2
    # Within the reach of a finger, but outside the circle. What is not chosen does not move.
    scrolled, height = swipe(x + 15, y + 22)
    assert scrolled > 30
    assert height == -46.0
    opened(phone, answered(TRUCK).page, tmp_path)
    touch(phone, "Start", x + 15, y + 22)
    touch(phone, "End")
    settled(phone)
    scrolled, height = swipe(x + 15, y + 22)
    assert scrolled == 0
    assert height > 100
    scrolled, then = swipe(x - 70, y + 40)
    assert scrolled > 30
    assert then == height


def test_fingers_step_numbers_by_buttons(
    phone: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """As large as a finger needs, one undo for some of them, and none for a mouse."""
    opened(phone, answered(TRUCK).page, tmp_path)
    ring = box(phone, ".handle[data-point='2'] .ring")
    touch(phone, "Start", (ring["left"] + ring["right"]) / 2, (ring["top"] + ring["bottom"]) / 2)
    touch(phone, "End")
    settled(phone)
    buttons = phone.find_elements(By.CSS_SELECTOR, ".live .number button")
    assert len(buttons) == 2 * (2 + 3)
    for each in buttons:
        assert each.is_displayed()
        assert min(each.size.values()) >= 44
    less, more = phone.find_elements(By.CSS_SELECTOR, "#live-place button[aria-label$=' y']")
    assert less.get_attribute("aria-label") == "less y"
    for each in (less, less, less, more):
        js(phone, "arguments[0].click()", each)
    settled(phone)
    assert pages.place_of(phone, 2) == [1650.0, -48.0, 0.0]
    js(phone, "document.querySelector('[aria-label=\"more torque\"]').click()")
    settled(phone)
    assert js(phone, "return cardanPage.model.loadOf('torque')") == 1510.0
    for _ in range(2):
        phone.find_element(By.ID, "live-undo").click()
        settled(phone)
    assert js(phone, "return cardanPage.model.isDrawn")
    phone.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})
    screen(phone, 1280, 900)
    assert not less.is_displayed()


# --- wide screens -----------------------------------------------------------------------------


@EACH_PAGE
def test_the_panel_of_a_desk_stays_within_the_screen(
    path: Path, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    opened(browser, answered(path).page, tmp_path)
    for y in (0, 60, 400):
        js(browser, "scrollTo(0, arguments[0])", y)
        panel = box(browser, "#live-panel")
        assert 0 <= panel["top"] <= panel["bottom"] <= 900
        assert panel["left"] > box(browser, "#live-page")["right"]


def test_the_head_counts_what_the_list_shows(truck: webdriver.Chrome) -> None:
    """In its order, and how many of each colour."""
    # By the square of the speed the torsional excitation is between its limit and its maximum.
    js(truck, "location.hash = 'speed.0=2300'")
    settled(truck)
    rows = truck.find_elements(By.CSS_SELECTOR, "#live-panel .rows li")
    colours = [str(row.get_attribute("class")) for row in rows]
    assert colours == ["beyond"] * 2 + ["tolerable"] + ["within"] * 10
    names = [row.find_element(By.CLASS_NAME, "name").get_property("textContent") for row in rows]
    words = truck.find_element(By.CSS_SELECTOR, "#live-panel .why").text.replace("\u00a0", " ")
    named = "; ".join(map(str, names[:2])).replace("\u00a0", " ")
    assert words.startswith(f"2 of 13 beyond: {named}. 1 tolerable. Something has moved")


def test_states_and_buttons_say_what_they_are(truck: webdriver.Chrome) -> None:
    states = truck.find_element(By.ID, "live-states")
    assert states.text.startswith("States of joint 2 and the downstream end\n")
    assert states.accessible_name == "States of joint 2 and the downstream end"
    dials = truck.find_element(By.ID, "live-dials")
    assert [each.text for each in dials.find_elements(By.TAG_NAME, "button")] == [
        "Best phases",
        "Best on 36 teeth",
    ]
    assert "the smallest equivalent bend over all states by their weights" in dials.text
    assert "hatched: beyond" in truck.find_element(By.CSS_SELECTOR, ".live .key").text


# --- paper ------------------------------------------------------------------------------------


@EACH_PAGE
def test_paper_has_the_verdict_and_no_controls(
    path: Path, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Light and still whatever the screen is; all judged figures with their limits."""
    opened(browser, answered(path).page, tmp_path)
    shown = len(browser.find_elements(By.CSS_SELECTOR, "#live-panel .rows li"))
    media(browser, "print", "dark")
    changed = browser.find_element(By.ID, "live-changed")
    assert changed.text == "As sent."
    controls = ".live button:not(.chip), .live input[type=range], .hint, .live .hit, .live .ring"
    for each in browser.find_elements(By.CSS_SELECTOR, controls):
        assert not each.is_displayed(), each.get_attribute("outerHTML")
    assert js(browser, "return getComputedStyle(document.body).backgroundColor") == WHITE
    rows = browser.find_elements(By.CSS_SELECTOR, "#live-panel .rows li")
    assert len(rows) == shown > 0
    for row in rows:
        assert row.is_displayed()
        assert row.find_element(By.CSS_SELECTOR, ".value span span").text
    for selector in ("#live-panel .head", "#live-drawing", ".live .key"):
        assert is_shown(browser, selector)
    assert not is_shown(browser, ".live .key .heights")


def test_paper_names_what_was_changed(
    phone: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Printed from a phone too, it has the drawing of a desk and no sheet."""
    opened(phone, answered(TRUCK).page, tmp_path)
    handle(phone, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN)
    handle(phone, 2).send_keys(4 * Keys.ARROW_DOWN)
    settled(phone)
    width = "return document.getElementById('live-drawing').viewBox.baseVal.width"
    narrow = js(phone, width)
    js(
        phone,
        """addEventListener("beforeprint", () => {
            window.printed = document.getElementById("live-drawing").viewBox.baseVal.width;
        });""",
    )
    # A medium that is emulated is that of paper as well.
    media(phone, "")
    printed = base64.b64decode(phone.print_page())
    assert printed.startswith(b"%PDF")
    # Tables that are narrow stand side by side, and no section begins a page.
    assert 5 <= len(re.findall(rb"/Type\s*/Page\b", printed)) <= 11
    assert js(phone, "return printed") == 680 > narrow
    assert (
        js(phone, "return document.getElementById('live-drawing').viewBox.baseVal.width") == narrow
    )
    media(phone, "print")
    assert phone.find_element(By.ID, "live-changed").text == "Changed: joint 1 y \u221224.0 mm."
    assert is_shown(phone, "#live-figures")
    # The report of the scene as sent, which a screen has collapsed.
    assert is_shown(phone, "#answer")
    assert js(phone, "return getComputedStyle(document.getElementById('live-panel')).position") == (
        "static"
    )
    assert js(phone, "return document.querySelector('.ghost').getAttribute('points')")


# --- the drawing ------------------------------------------------------------------------------


def slopes(browser: webdriver.Chrome) -> dict[str, tuple[float, str]]:
    """Every slope that is written, in degrees and as text."""
    found = js(
        browser,
        """return [...document.querySelectorAll("#live-drawing .slope")]
            .filter((e) => e.textContent)
            .map((e) => [e.dataset.path, [Number(e.dataset.value), e.textContent]])""",
    )
    return {path: (value, text) for path, (value, text) in found}


def test_slopes_are_those_of_the_shafts(truck: webdriver.Chrome) -> None:
    """In both views, to a hundredth of a degree, also of what is moved and stretched."""
    for name in ("live-true", "live-high"):
        truck.find_element(By.ID, name).click()
        points = [pages.place_of(truck, i) for i in range(5)]
        shown = slopes(truck)
        for view, axis in ((0, 1), (1, 2)):
            for shaft in (1, 2):
                value, text = shown[f"derived:slopes_deg[view={view},shaft={shaft}]"]
                along = np.subtract(points[shaft + 1], points[shaft])
                assert value == pytest.approx(math.degrees(math.atan(along[axis] / along[0])))
                minus = text.removeprefix("slope ").removesuffix("°").replace("\u2212", "-")
                assert float(minus) == round(value, 2)
        handle(truck, 2).send_keys(Keys.SHIFT + 3 * Keys.ARROW_UP)
        settled(truck)
    assert shown["derived:slopes_deg[view=0,shaft=1]"][1] == "slope 0.35°"


def test_stretched_heights_are_dragged_exactly(truck: webdriver.Chrome) -> None:
    high = truck.find_element(By.ID, "live-high")
    wide = js(truck, "return cardanPage.drawing.scale")
    high.click()
    settled(truck)
    assert high.get_attribute("aria-pressed") == "true"
    assert js(truck, "return cardanPage.drawing.scale") == wide
    knobs = [box(truck, f".handle[data-point='{i}'] .knob") for i in (1, 3)]
    fall = (knobs[1]["top"] - knobs[0]["top"]) / wide
    assert fall == pytest.approx(4 * (180 - 24), abs=3)
    for view, axis, sign in ((0, 1, -1.0), (1, 2, 1.0)):
        before = pages.place_of(truck, 2)
        js(truck, "arguments[0].scrollIntoView({ block: 'center' })", handle(truck, 2, view))
        ActionChains(truck).drag_and_drop_by_offset(handle(truck, 2, view), 0, 24).perform()
        after = pages.place_of(truck, 2)
        assert after[axis] - before[axis] == pytest.approx(sign * 6.0 / wide, abs=0.6)
        assert after[0] == before[0]
    truck.find_element(By.ID, "live-true").click()
    assert high.get_attribute("aria-pressed") == "false"


def test_arrows_are_the_forces_of_the_bearings(truck: webdriver.Chrome) -> None:
    """At the drive angle and in the state that are shown, in both views with one scale."""
    scene = Scene.load(TRUCK)
    states = scene.states
    assert states
    for state, angle in ((2, 40.0), (0, 130.0)):
        truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")[state].click()
        js(
            truck,
            """const angle = document.getElementById("live-angle");
            angle.value = arguments[0];
            angle.dispatchEvent(new Event("input"));""",
            angle,
        )
        settled(truck)
        load = states.load(state)
        found = scene.drivelines()[state].evaluate(np.radians([angle]), "bearing_force", load=load)
        forces = found.bearing_force.reshape(5, 3)
        scale = js(truck, "return cardanPage.drawing.push")
        paths = js(
            truck,
            "return [...document.querySelectorAll('.arrow')].map((e) => e.getAttribute('d'))",
        )
        for axis, drawn in ((1, paths[:5]), (2, paths[5:])):
            down = -1.0 if axis == 1 else 1.0
            for force, path in zip(forces, drawn, strict=True):
                want = scale * np.array([force[0], down * force[axis]])
                if not path:
                    assert np.hypot(*want) < 5.0
                    continue
                start, end = np.array(re.findall(r"[-\d.]+", path), float).reshape(-1, 2)[:2]
                np.testing.assert_allclose(end - start, want, atol=0.11)
        assert sum(bool(path) for path in paths) > 4


HATCHED = """const { top } = document.getElementById("live-drawing").getBoundingClientRect();
const lines = document.querySelector(".ribbon .hatch").getAttribute("d");
return [...lines.matchAll(/M\\S+ (\\S+?)l/g)].map(([, y]) => top + Number(y));"""


def test_a_ribbon_shows_at_which_heights_the_verdict_holds(truck: webdriver.Chrome) -> None:
    """As the core judges the same heights; found in slices, and gone while somebody drags."""
    ribbon = truck.find_element(By.CSS_SELECTOR, "#live-drawing .ribbon")
    assert ribbon.get_attribute("visibility") == "hidden"
    joint = handle(truck, 2)
    joint.send_keys("")
    truck.find_element(By.CSS_SELECTOR, "#live-drawing .ribbon[visibility=visible]")
    bands = js(
        truck,
        """return [...document.querySelectorAll("#live-drawing .ribbon rect")].map((e) => {
            const { top, bottom } = e.getBoundingClientRect();
            return [(top + bottom) / 2, e.getAttribute("class"), top, bottom];
        })""",
    )
    knob = box(truck, ".handle[data-point='2'] .knob")
    middle, scale = (
        (knob["top"] + knob["bottom"]) / 2,
        js(truck, "return cardanPage.drawing.scale"),
    )
    assert len(bands) > 30
    step = 0.035 * 3450.0 / 20.0
    hatched = js(truck, HATCHED)
    for at, verdict, top, bottom in bands:
        place = round((middle - at) / scale / step)
        assert abs((middle - at) / scale - step * place) < 1.0
        machine = machine_of(edited(TRUCK, 2, (0.0, step * place, 0.0)))
        assert machine
        assert verdict == machine.verdict()
        # Colour alone would not tell them apart.
        if any(top < line < bottom - 0.3 for line in hatched):
            assert verdict == "beyond"
    # Bands lie on each other by 0.2 px.
    red = sum(bottom - top - 0.2 for _, verdict, top, bottom in bands if verdict == "beyond")
    assert len(hatched) == pytest.approx(red / 4.0, rel=0.15)
    assert {band[1] for band in bands} == {"within", "beyond"}
    words = ribbon.get_attribute("aria-label")
    assert words == "Within all limits with y from \u2212112.4 to \u221270.2 mm"
    slices = js(truck, "return cardanPage.ribbon.slices")
    assert sum(count for count, _ in slices) == len(bands)


APART = """const svg = document.getElementById("live-drawing").getBoundingClientRect();
const texts = [...document.querySelectorAll("#live-drawing text")].filter((e) => {
    const { visibility } = getComputedStyle(e);
    return e.textContent && visibility !== "hidden";
}).map((e) => [e.textContent, e.getBoundingClientRect()]);
const isOutside = ({ left, right, top, bottom }) => left < svg.left - 1
    || right > svg.right + 1 || top < svg.top - 1 || bottom > svg.bottom + 1;
const found = [];
texts.forEach(([text, a], i) => {
    if (isOutside(a)) found.push([text, "outside"]);
    for (const [other, b] of texts.slice(i + 1)) {
        const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        // Boxes have some room above and below the letters.
        if (across > 0 && down > 5) found.push([text, other]);
    }
});
for (const arrow of document.querySelectorAll("#live-drawing .arrow")) {
    const a = arrow.getBoundingClientRect();
    if (a.width && isOutside(a)) found.push(["arrow", "outside"]);
}
return found;"""


@pytest.mark.long
@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
@pytest.mark.parametrize("width", [1280, 390])
def test_texts_of_the_drawing_are_apart_and_arrows_within_it(
    path: Path, width: int, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """In every state, at some drive angles, true to scale and stretched."""
    screen(browser, width, 900)
    opened(browser, answered(path).page, tmp_path)
    for name in ("live-high", "live-true"):
        js(browser, f"document.getElementById('{name}').click()")
        for state in range(js(browser, "return cardanPage.model.sent.states.length")):
            js(browser, "document.querySelectorAll('.chip')[arguments[0]]?.click()", state)
            for angle in (40, 90, 150):
                js(
                    browser,
                    """const angle = document.getElementById("live-angle");
                    angle.value = arguments[0];
                    angle.dispatchEvent(new Event("input"));""",
                    angle,
                )
                settled(browser)
                assert js(browser, APART) == [], (name, state, angle)


def test_texts_of_what_comes_near_are_apart(
    browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Labels of forces, slopes and joints stay apart where parts are close together."""
    screen(browser, 390, 900)
    opened(browser, answered(TRUCK).page, tmp_path)
    for address in ("bearing.2=-1050", "bearing.2=-900&bearing.1=80", "point.2.x=-1150"):
        js(browser, "location.hash = arguments[0]", address)
        settled(browser)
        assert not js(browser, "return cardanPage.model.isDrawn")
        assert js(browser, APART) == [], address


def test_what_is_dragged_is_written_beside_it(truck: webdriver.Chrome) -> None:
    """The coordinates that the view shows, until it is let go."""
    callout = truck.find_element(By.CSS_SELECTOR, "#live-drawing .callout")

    def called(selector: str, by: tuple[int, int]) -> str:
        held = truck.find_element(By.CSS_SELECTOR, selector)
        ActionChains(truck, duration=10).click_and_hold(held).move_by_offset(*by).perform()
        settled(truck)
        words, own, knob = callout.text, box(truck, ".callout"), box(truck, f"{selector} .knob")
        assert callout.get_attribute("visibility") == "visible"
        assert abs(own["left"] + own["right"] - knob["left"] - knob["right"]) < 4
        assert 20 < knob["top"] - own["bottom"] < 70
        ActionChains(truck, duration=10).release().perform()
        assert callout.get_attribute("visibility") == "hidden"
        return words.replace("\u2212", "-")

    assert callout.get_attribute("visibility") == "hidden"
    words = called(".handle[data-point='2'][data-view='0']", (0, 20))
    x, y, _ = pages.place_of(truck, 2)
    assert words == f"x {x:.1f}, y {y:.1f} mm"
    words = called(".handle[data-point='2'][data-view='1']", (10, 15))
    x, _, z = pages.place_of(truck, 2)
    assert words == f"x {x:.1f}, z {z:.1f} mm"
    words = called(".handle[data-bearing='2'][data-view='0']", (-30, 0))
    assert words == f"{1e3 * js(truck, 'return cardanPage.model.part(`positions`, 2)'):.1f} mm"


def test_each_point_is_one_stop_of_the_tab_key(truck: webdriver.Chrome) -> None:
    """In the order in which power flows; keys move it along all three axes."""
    stops = js(
        truck,
        """return [...document.querySelectorAll(".handle[tabindex='0']")]
            .map((e) => e.getAttribute("aria-label"))""",
    )
    assert [stop.removesuffix(", side view") for stop in stops] == [
        *("upstream end", "bearing 0", "bearing 1", "joint 0", "bearing 2", "joint 1", "joint 2"),
        *("bearing 3", "bearing 4", "downstream end"),
    ]
    joint = handle(truck, 2)
    joint.send_keys(Keys.PAGE_UP * 3 + Keys.ARROW_UP + Keys.ARROW_RIGHT + Keys.PAGE_DOWN)
    settled(truck)
    assert pages.place_of(truck, 2) == [1651.0, -45.0, 2.0]
    handle(truck, 2, view=1).send_keys(Keys.PAGE_DOWN + Keys.ARROW_DOWN)
    settled(truck)
    assert pages.place_of(truck, 2) == [1651.0, -46.0, 3.0]


# --- snapping ---------------------------------------------------------------------------------


def dragged(
    browser: webdriver.Chrome, by: tuple[int, int], key: str = ""
) -> tuple[list[float], dict[str, dict[str, float]]]:
    """Drag joint 1 by some px; return where it is, and the words and lines that appear."""
    actions = ActionChains(browser, duration=10).click_and_hold(handle(browser, 2))
    if key:
        actions.key_down(key)
    actions.move_by_offset(*by).perform()
    settled(browser)
    found = js(
        browser,
        """return Object.fromEntries([...document.querySelectorAll("text.snap[visibility=visible]")]
            .map((e) => [e.textContent, e.previousSibling.getBoundingClientRect().toJSON()]))""",
    )
    at = pages.place_of(browser, 2)
    actions = ActionChains(browser, duration=10).release()
    if key:
        actions.key_up(key)
    actions.perform()
    assert not js(browser, "return document.querySelector('.snap[visibility=visible]')")
    return at, found


def test_a_point_snaps_to_what_it_is_near(truck: webdriver.Chrome) -> None:
    """To where it was drawn and to the level of its neighbours, with a line and a word."""
    truck.find_element(By.ID, "live-high").click()
    scale = js(truck, "return cardanPage.drawing.scale")
    up = 4 * scale
    # Joint 0 is 22 mm higher; the pointer stops 2 mm before it, which are fewer than 5 px.
    level, words = dragged(truck, (0, round(-20 * up)))
    assert level == [1650.0, -24.0, 0.0]
    assert list(words) == ["level with joint 0"]
    knob, line = box(truck, ".handle[data-point='2'] .knob"), words["level with joint 0"]
    assert line["top"] == pytest.approx((knob["top"] + knob["bottom"]) / 2, abs=1.0)
    assert line["width"] > 300
    # 10 mm are more than 5 px.
    away, words = dragged(truck, (0, round(10 * up)))
    assert away[1] == pytest.approx(-34.0, abs=1.0)
    assert away[1] == round(away[1])
    assert words == {}
    back, words = dragged(truck, (0, round(10 * up)))
    assert back == [1650.0, -46.0, 0.0]
    assert list(words) == ["as drawn"]
    # To the right of where it was drawn, and back: a coordinate snaps by itself.
    assert dragged(truck, (60, round(40 * up)))[0][0] == pytest.approx(1650 + 60 / scale, abs=1)
    at, words = dragged(truck, (-59, 0))
    assert at[0] == 1650.0
    assert list(words) == ["as drawn"]
    assert words["as drawn"]["height"] > words["as drawn"]["width"]


def test_keys_hold_a_drag_straight_or_make_it_fine(truck: webdriver.Chrome) -> None:
    scale = js(truck, "return cardanPage.drawing.scale")
    straight, _ = dragged(truck, (30, 40), Keys.SHIFT)
    assert straight[0] == 1650.0
    assert straight[1] == pytest.approx(-46.0 - 40 / scale, abs=1.0)
    truck.find_element(By.ID, "live-undo").click()
    straight, _ = dragged(truck, (40, 30), Keys.SHIFT)
    assert straight[1] == -46.0
    assert straight[0] == pytest.approx(1650.0 + 40 / scale, abs=1.0)
    truck.find_element(By.ID, "live-undo").click()
    fine, words = dragged(truck, (3, 10), Keys.ALT)
    assert fine[:2] == pytest.approx([1650.0 + 0.3 / scale, -46.0 - 1.0 / scale], abs=0.06)
    assert fine[1] != round(fine[1]) or fine[0] != round(fine[0])
    assert words == {}


# --- curves -----------------------------------------------------------------------------------


@EACH_PAGE
def test_no_two_curves_of_a_chart_look_alike(
    path: Path, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Those of one colour, such as the bearings of one shaft, differ by dashes."""
    opened(browser, answered(path).page, tmp_path)
    charts = js(
        browser,
        """const look = (e) => {
            const { stroke, strokeDasharray } = getComputedStyle(e);
            return `${stroke} ${strokeDasharray}`;
        };
        return [...document.querySelectorAll("#live-curves figure")].map((figure) =>
            ["figure > svg .curve:not(.former)", ".swatch .curve"].map((query) =>
                [...figure.querySelectorAll(query)].map(look)))""",
    )
    assert charts
    for curves, legend in charts:
        assert curves == legend
        assert len(set(curves)) == len(curves) > 0


# --- units and colours ------------------------------------------------------------------------


@EACH_PAGE
def test_lengths_are_shown_in_inches(
    path: Path, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """To a thousandth, and forces in pounds; what stands behind a figure stays in SI units."""
    opened(browser, answered(path).page, tmp_path)
    before = pages.figures(browser)
    inch = browser.find_element(By.ID, "live-us")
    if not inch.is_displayed():
        assert not any(text.endswith(" mm") for _, _, text in before)
        return
    inch.click()
    settled(browser)
    after = pages.figures(browser)
    assert [each[:2] for each in after] == [each[:2] for each in before]
    for (_, value, text), (_, _, then) in zip(before, after, strict=True):
        if us := US.get(ending_of(text.partition(" ")[2])[1:]):
            (number, unit), own = then.split(" "), ENDINGS[us[0]]
            assert unit == own.symbol
            near = pytest.approx(value / own.size, rel=0.0 if unit == "in" else 0.005, abs=0.0005)
            assert float(number.replace("\u2212", "-")) == near
        else:
            assert then == text
    texts = browser.find_elements(By.CSS_SELECTOR, ".rows .value, .changes, .foot, .handle")
    shown = [f"{each.text} {each.get_attribute('aria-valuetext') or ''}" for each in texts]
    # Names of states have their own unit.
    assert not re.search(r"[\d.]+ mm(?!\u201d)", " ".join(shown).partition("Drag a")[0])
    browser.find_element(By.ID, "live-si").click()
    assert pages.figures(browser) == before


def test_inches_are_typed_and_listed(truck: webdriver.Chrome) -> None:
    truck.find_element(By.ID, "live-us").click()
    steps = truck.find_element(By.ID, "live-steps")
    assert steps.text == "0.01 in, with Shift 0.1 in, with Alt 0.001 in"
    handle(truck, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN)
    settled(truck)
    field = truck.find_element(By.CSS_SELECTOR, "input[aria-label='y, in']")
    assert field.get_attribute("value") == "\u22122.011"
    assert truck.find_element(By.ID, "live-moved").text == "moved y \u22120.200 in"
    (change,) = truck.find_elements(By.CSS_SELECTOR, "#live-panel .changes button")
    assert js(truck, "return arguments[0].textContent", change) == "joint 1 y \u22120.200 in ✕"
    bound = "//li[contains(., 'ngaged length')]//*[@class='value']"
    engaged = truck.find_element(By.XPATH, bound).get_attribute("textContent")
    assert "at least 2.75591 in" in str(engaged)
    js(truck, "arguments[0].focus()", field)
    field.send_keys(Keys.CONTROL + "a" + Keys.NULL + "-2" + Keys.ENTER)
    settled(truck)
    assert pages.place_of(truck, 2) == [1650.0, pytest.approx(-50.8, abs=1e-9), 0.0]
    field.send_keys(Keys.ARROW_UP)
    settled(truck)
    assert pages.place_of(truck, 2)[1] == pytest.approx(-50.8 + 0.254, abs=1e-6)


CONTRAST = """
const channels = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
const over = ([r, g, b, a = 1], below) => [r, g, b].map((x, i) => a * x + (1 - a) * below[i]);
const light = (color) => color.reduce((sum, x, i) => {
    const s = x / 255, linear = s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
    return sum + [0.2126, 0.7152, 0.0722][i] * linear;
}, 0);
const ratio = (a, b) => {
    const [low, high] = [light(a), light(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
};
const ground = (e) => {
    if (!e) return [255, 255, 255];
    return over(channels(getComputedStyle(e).backgroundColor), ground(e.parentElement));
};
const opacity = (e) => e ? Number(getComputedStyle(e).opacity) * opacity(e.parentElement) : 1;
const said = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
const found = [];
for (const e of document.querySelectorAll(".live, .live *, header *")) {
    const box = e.getBoundingClientRect(), style = getComputedStyle(e);
    if (!box.width || style.visibility === "hidden") continue;
    if (e.closest("button:disabled, .pale")) continue;
    const below = ground(e);
    const seen = ([r, g, b, a = 1]) => over([r, g, b, a * opacity(e)], below);
    const name = `${e.tagName} ${e.getAttribute("class") || e.id} ${e.textContent.slice(0, 20)}`;
    const svg = e instanceof SVGElement;
    if ((said(e) && e.tagName !== "STYLE") || e.matches("input[type=text]")) {
        found.push(["text", ratio(seen(channels(svg ? style.fill : style.color)), below), name]);
    }
    if (e.matches(".tube, .other, .box, .knob, .arrow, .ghost, .fork:not(.far)")) {
        found.push(["line", ratio(seen(channels(style.stroke)), below), name]);
    }
}
return found;
"""


@EACH_PAGE
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_everything_stands_out(
    path: Path, theme: str, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Text by 4.5 to 1 and lines by 3 to 1, whether the system or a button chose the colours."""
    media(browser, "screen", theme)
    opened(browser, answered(path).page, tmp_path)
    by_system = js(browser, CONTRAST)
    media(browser, "screen", "dark" if theme == "light" else "light")
    button = browser.find_element(By.ID, "live-theme")
    for _ in range(1 if theme == "light" else 2):
        button.click()
    assert button.text == f"Colours: {theme}"
    if js(browser, "return cardanPage.model.movable"):
        handle(browser, 1).send_keys(Keys.SHIFT + 3 * Keys.ARROW_DOWN)
        settled(browser)
    by_button = js(browser, CONTRAST)
    assert len(by_button) >= len(by_system) > 60
    for kind, ratio, name in by_system + by_button:
        assert ratio >= (4.5 if kind == "text" else 3.0), name
