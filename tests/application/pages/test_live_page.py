"""The moving page in Chromium, against the package."""

from __future__ import annotations

import base64
import hashlib
import math
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.wait import WebDriverWait

import tiers
from cardan import __version__
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import number_text, quantity
from cardan.app.answers.schema import check_data
from cardan.app.report import write_report
from cardan.app.report.moving import moving_page
from cardan.app.scene import Scene
from cardan.arrays import FloatArray
from example_scenes import DRIVELINES, Answers, example
from live import (
    TRUCK,
    WEB,
    at,
    close,
    edited,
    texts,
    without_slow_parts,
)
from pages import (
    Drawn,
    chart_in,
    figures,
    handle,
    in_browser,
    js,
    opened,
    place_of,
    screen,
    settled,
    verdict_of,
)

MACHINES = [path.stem for path in DRIVELINES if path.parent.name == "machines"]
# With states and a duty cycle, with tolerances beyond a limit, with a steering column.
SHORT = ("truck-shaft", "test-rig", "steering-column")


# --- the page ---------------------------------------------------------------------------------


@in_browser
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_page_shows_what_the_check_says(
    name: str, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Every figure as drawn, its text and the verdict are those of ``cardan check --json``."""
    path = example(f"{name}.toml")
    opened(browser, answered(path).page, tmp_path)
    answer = Answer(Scene.load(path))
    data, written, shown = check_data(answer), texts(answer), figures(browser)
    assert verdict_of(browser) == data["verdict"]
    assert len(shown) >= 2
    for place, value, text in shown:
        expected = at(data, place)
        assert close(value, expected), place
        own = re.sub(r"\[\w+=(.*?)\]", r".\1", place[6:]).rpartition(".value")[0]
        if ending := re.search(r"torsion\..*(_Hz|_rpm|shaft)$", place):
            name = ending[1].strip("_")
            plain = str(expected) if name == "shaft" else f"{number_text(expected, name)} {name}"
            assert text == plain, place
        elif ".states[" in place or place[6:].startswith("states["):
            unit = "deg" if "bends" in place else "N"
            factor = 1.0 if unit == "N" else math.pi / 180.0
            assert text == quantity(factor * expected, unit).replace("-", "\u2212"), place
        else:
            assert text == written[own].replace("-", "\u2212"), place


@in_browser
def test_keys_move_a_joint_and_the_verdict_follows(truck: webdriver.Chrome) -> None:
    """Lowered by 24 mm the truck is within its limits, as the check says of the same points."""
    joint = handle(truck, 2)
    joint.send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + 4 * Keys.ARROW_DOWN)
    settled(truck)
    data = check_data(Answer(edited(TRUCK, 2, (0.0, -24.0, 0.0))))
    shown = figures(truck)
    for place, value, _ in shown:
        assert close(value, at(data, place)), place
    assert verdict_of(truck) == "within"
    assert "not computed here" in truck.find_element(By.CSS_SELECTOR, "#live-panel .why").text
    assert joint.get_attribute("aria-valuenow") == "-70"
    # Keys in quick succession are one step.
    truck.find_element(By.ID, "live-undo").click()
    assert verdict_of(truck) == "beyond"
    assert joint.get_attribute("aria-valuenow") == "-46"
    assert truck.find_element(By.ID, "live-undo").get_attribute("disabled")
    truck.find_element(By.ID, "live-redo").click()
    assert verdict_of(truck) == "within"
    truck.find_element(By.ID, "live-drawn").click()
    assert verdict_of(truck) == "beyond"


@in_browser
def test_critical_speeds_follow_a_joint_that_is_dragged(truck: webdriver.Chrome) -> None:
    """While it is held and then as the check of the changed scene has them, drawn as well."""

    def shown() -> dict[str, float]:
        return {path: value for path, value, _ in figures(truck) if "check:torsion." in path}

    card = truck.find_element(By.ID, "live-torsion")
    before, charted = shown(), chart_in(truck, card.find_element(By.TAG_NAME, "figure"))
    assert len(before) == 9
    assert not any(len(each) for each in charted.former)
    joint = handle(truck, 2)
    ActionChains(truck).click_and_hold(joint).move_by_offset(0, 40).perform()
    WebDriverWait(truck, 5).until(lambda _: shown() != before)
    ActionChains(truck).release().perform()
    settled(truck)
    moved = place_of(truck, 2)[1] + 46.0
    data = check_data(Answer(edited(TRUCK, 2, (0.0, moved, 0.0))))
    after = shown()
    assert all(value == at(data, path) for path, value in after.items())
    speeds = [path for path in after if path.endswith("_rpm")]
    assert len(speeds) == 4
    assert all(after[path] != before[path] for path in speeds)
    chart = chart_in(truck, card.find_element(By.TAG_NAME, "figure"))
    frequencies = [mode["frequency_Hz"] for mode in data["torsion"]["modes"]]
    drawn = [float(curve[0, 1]) for curve in chart.curves[:2]]
    assert drawn == pytest.approx(frequencies, abs=3.0)
    for order, ray in zip((2, 4), chart.curves[2:], strict=True):
        ends = ray[np.isfinite(ray[:, 0])]
        np.testing.assert_allclose(ends[:, 1], order * ends[:, 0] / 60.0, atol=3.0)
    assert len(chart.former) == 4
    assert "in the range" in card.text
    truck.find_element(By.ID, "live-drawn").click()
    assert shown() == before


@in_browser
def test_points_are_dragged_in_both_views(truck: webdriver.Chrome) -> None:
    """The pointer moves whole millimetres along the axes of the view; Escape gives it up."""
    for view, axis in ((0, 1), (1, 2)):
        before = place_of(truck, 2)
        ActionChains(truck).drag_and_drop_by_offset(handle(truck, 2, view), 0, 16).perform()
        after = place_of(truck, 2)
        moved = [a - b for a, b in zip(after, before, strict=True)]
        assert moved[axis] != 0.0
        assert [x for i, x in enumerate(moved) if i != axis] == [0.0, 0.0]
        assert after[axis] == round(after[axis])
        # One scale for both views: 16 px are as many millimetres, y up and z down.
        scale = js(truck, "return cardanPage.drawing.scale")
        assert abs(abs(moved[axis]) - 16.0 / scale) <= 2.0
        assert (moved[axis] < 0) == (view == 0)
    held = ActionChains(truck).click_and_hold(handle(truck, 2)).move_by_offset(5, 30)
    held.perform()
    # The figures of what is held still are its own.
    bend = "check:limits.equivalent_bend.value_deg"
    own = """const { model } = cardanPage;
    return model.rows().find((row) => row.path === arguments[0]).value;"""
    shown = "return Number(document.querySelector(`[data-path='${arguments[0]}']`).dataset.value)"
    expected = js(truck, f"cardanPage.model.compute(); {own}", bend)
    WebDriverWait(truck, 5).until(lambda truck: js(truck, shown, bend) == expected)
    assert place_of(truck, 2) != after
    ActionChains(truck).send_keys(Keys.ESCAPE).release().perform()
    assert place_of(truck, 2) == after
    for _ in range(2):
        truck.find_element(By.ID, "live-undo").click()
    assert place_of(truck, 2) == [1650.0, -46.0, 0.0]


def field(browser: webdriver.Chrome, label: str) -> WebElement:
    return browser.find_element(By.CSS_SELECTOR, f"input[aria-label^='{label},']")


@in_browser
def test_numbers_are_typed_stepped_and_dragged(truck: webdriver.Chrome) -> None:
    """Coordinates, torque and speed; what is no number is refused and loses nothing."""
    handle(truck, 2).send_keys(Keys.ARROW_RIGHT)
    settled(truck)
    y = field(truck, "y")
    assert y.get_attribute("value") == "\u221246.0"
    y.click()
    y.send_keys(Keys.CONTROL + "a")
    y.send_keys("-70,5" + Keys.ENTER)
    assert place_of(truck, 2) == [1651.0, -70.5, 0.0]
    y.send_keys(Keys.ARROW_UP + Keys.SHIFT + Keys.ARROW_UP)
    assert place_of(truck, 2) == [1651.0, -59.5, 0.0]
    for text, words in (("12x", "is no number"), ("1e9", "must be within"), ("", "is no number")):
        y.send_keys(Keys.CONTROL + "a" + Keys.NULL)
        y.send_keys((text or Keys.BACKSPACE) + Keys.ENTER)
        assert words in truck.find_element(By.ID, "live-refused").text
        assert y.get_attribute("value") == "\u221259.5"
        assert place_of(truck, 2) == [1651.0, -59.5, 0.0]
    torque = field(truck, "torque")
    truck.execute_script("document.activeElement.blur()")
    ActionChains(truck).drag_and_drop_by_offset(torque, 30, 0).perform()
    assert js(truck, "return cardanPage.model.loadOf('torque')") == 1600.0
    speed = field(truck, "speed")
    for own, most, words in ((speed, 100_000, "100\u2009000 rpm"), (torque, 10_000_000, "N m")):
        before = own.get_attribute("value")
        own.send_keys(Keys.CONTROL + "a" + Keys.NULL + f"{most + 1}" + Keys.ENTER)
        rule = truck.find_element(By.ID, "live-refused").text
        assert words in rule
        assert "more than any driveline has" in rule
        assert str(own.get_attribute("title")) in rule
        assert own.get_attribute("value") == before
    speed.click()
    speed.send_keys(Keys.ARROW_DOWN)
    settled(truck)
    changed = {
        "[1650, -46, 0]": "[1651, -59.5, 0]",
        "speed_rpm = 2200\n": "speed_rpm = 2190\n",
        "output_torque_Nm = 1500\n": "output_torque_Nm = 1600\n",
    }
    text = TRUCK.read_text(encoding="utf-8")
    for old, new in changed.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    data = check_data(Answer(Scene.parse(without_slow_parts(text, "tolerances|optimise"))))
    for path, value, _ in figures(truck):
        assert value == at(data, path), path
    assert saved(truck) == ["truck-shaft.changed.toml", text]


def saved(browser: webdriver.Chrome) -> list[str]:
    """Name and text of the file that the page lets the browser save."""
    script = """const [done] = arguments;
    URL.createObjectURL = (blob) => { window.blob = blob; return "#"; };
    HTMLAnchorElement.prototype.click = function () {
        window.blob.text().then((text) => done([this.download, text]));
    };
    document.getElementById("live-save").click();"""
    found = browser.execute_async_script(script)
    return [str(each) for each in found]


@in_browser
def test_a_link_carries_what_was_changed(truck: webdriver.Chrome) -> None:
    """The address follows; opened again it shows the same; a mistake in it shows the scene."""
    handle(truck, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + Keys.ARROW_DOWN)
    truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")[4].click()
    settled(truck)
    WebDriverWait(truck, 10).until(lambda truck: "state=" in truck.current_url)
    address = truck.current_url
    assert address.endswith("#point.2.y=-21&state=%2B80+mm")
    shown = figures(truck)
    truck.get("about:blank")
    truck.get(address)
    truck.find_element(By.CSS_SELECTOR, "#live-panel .rows li")
    assert figures(truck) == shown
    js(truck, "location.hash = '#point.2.y=-24'")
    settled(truck)
    assert place_of(truck, 2)[1] == -70.0
    js(truck, "location.hash = '#point.7.y=-24'")
    settled(truck)
    assert "nothing called" in truck.find_element(By.ID, "live-refused").text
    assert place_of(truck, 2)[1] == -70.0


@in_browser
def test_a_turn_plays_until_it_is_stopped(truck: webdriver.Chrome) -> None:
    angle, play = (truck.find_element(By.ID, f"live-{name}") for name in ("angle", "play"))
    js(truck, "arguments[0].click()", play)
    for _ in range(5):
        settled(truck)
    assert play.text == "Stop"
    turned = float(str(angle.get_property("value")))
    assert turned != 40.0
    js(truck, "arguments[0].click()", play)
    settled(truck)
    stopped = angle.get_property("value")
    settled(truck)
    assert angle.get_property("value") == stopped


@in_browser
def test_states_are_chosen_with_their_verdict(truck: webdriver.Chrome) -> None:
    chips = truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")
    assert [chip.get_attribute("aria-label") for chip in chips] == [
        "-80 mm, beyond",
        "-40 mm, beyond",
        "rest, within",
        "+40 mm, within",
        "+80 mm, beyond",
    ]
    assert [chip.get_attribute("aria-checked") for chip in chips].index("true") == 2
    chips[0].click()
    settled(truck)
    assert any("[state=-80 mm].bends_deg[1]" in path for path, _, _ in figures(truck))
    data = check_data(Answer(Scene.load(TRUCK)))
    for path, value, _ in figures(truck):
        assert close(value, at(data, path)), path


@in_browser
def test_a_suggestion_is_applied_with_a_click(truck: webdriver.Chrome) -> None:
    """It brings the truck within its limits, as the check confirms, and can be taken back."""
    offer = truck.find_element(By.CSS_SELECTOR, "#live-panel .ways button")
    assert offer.text.split("\n") == ["Move joint 1 by 24.0 mm along \u2212y", "all within here"]
    offer.click()
    assert verdict_of(truck) == "within"
    assert place_of(truck, 2) == [1650.0, -70.0, 0.0]
    (change,) = truck.find_elements(By.CSS_SELECTOR, "#live-panel .changes button")
    assert change.text.startswith("joint 1 y \u221224.0 mm")
    truck.execute_script("arguments[0].click()", change)
    assert verdict_of(truck) == "beyond"
    assert place_of(truck, 2) == [1650.0, -46.0, 0.0]


@in_browser
def test_yokes_are_turned_by_keys_and_buttons(truck: webdriver.Chrome) -> None:
    dial = truck.find_element(By.CSS_SELECTOR, "#live-dials [role=slider]")
    dial.send_keys(Keys.SHIFT + Keys.ARROW_RIGHT)
    dial.send_keys(2 * Keys.ARROW_LEFT)
    settled(truck)
    assert dial.get_attribute("aria-valuetext") == "8.0° clockwise"
    best, teeth = truck.find_elements(By.CSS_SELECTOR, "#live-dials button")
    truck.execute_script("arguments[0].click()", best)
    bend = "return document.querySelector(`[data-path='check:limits.equivalent_bend.value_deg']`)"
    least = float(js(truck, f"{bend}.dataset.value"))
    truck.execute_script("arguments[0].click()", teeth)
    on_teeth = float(js(truck, f"{bend}.dataset.value"))
    phases = js(truck, "return cardanPage.model.phases")
    assert np.allclose(np.mod(np.array(phases) + 5.0, 10.0), 5.0, atol=1e-6)
    assert min(least, on_teeth) < 4.27


@pytest.mark.long
@in_browser
def test_the_page_checks_itself(truck: webdriver.Chrome) -> None:
    """It says which core and which scene, and that this browser has the published results.

    Meanwhile it draws frames; the whole takes about a second.
    """
    foot = truck.find_element(By.ID, "live-trust")
    core = (WEB / "sources.sha256").read_text()[:12]
    text = hashlib.sha256(TRUCK.read_bytes()).hexdigest()[:12]
    assert f"cardan {__version__} ({core})" in foot.text
    assert f"truck-shaft.toml ({text})" in foot.text
    # What would help has been found.
    truck.find_element(By.CSS_SELECTOR, "#live-panel .ways button")
    js(
        truck,
        """let last = performance.now();
        window.longest = 0;
        arguments[0].click();
        requestAnimationFrame(function frame() {
            const now = performance.now();
            window.longest = Math.max(window.longest, now - last);
            last = now;
            if (arguments[0]) requestAnimationFrame(frame);
        });""",
        foot.find_element(By.TAG_NAME, "button"),
    )
    result = foot.find_element(By.CSS_SELECTOR, "[role=status].within, [role=status].beyond")
    assert result.text.startswith("All 10\u2009000 evaluations have the published results")
    assert 0.0 < float(js(truck, "return window.longest")) < 300.0


@in_browser
def test_a_notebook_shows_a_machine_that_can_be_moved(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    """In a frame that may run its scripts and save a file, and has no address to copy."""
    into = {"behavior": "allow", "downloadPath": str(tmp_path)}
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", into)
    shown = Scene.load(TRUCK)._repr_html_()
    (tmp_path / "notebook.html").write_text(
        f"<!DOCTYPE html><meta charset=utf-8><title>a</title>{shown}", "utf-8"
    )
    browser.get((tmp_path / "notebook.html").as_uri())
    browser.switch_to.frame(browser.find_element(By.TAG_NAME, "iframe"))
    try:
        assert js(browser, "return origin") == "null"
        browser.find_element(By.CSS_SELECTOR, "#live-panel .rows")
        assert verdict_of(browser) == "beyond"
        joint = handle(browser, 2)
        joint.send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + 4 * Keys.ARROW_DOWN)
        settled(browser)
        assert verdict_of(browser) == "within"
        assert not browser.find_element(By.ID, "live-link").is_displayed()
        browser.find_element(By.ID, "live-save").click()
        deadline = time.monotonic() + 10.0
        while not (tmp_path / "truck-shaft.changed.toml").exists():
            assert time.monotonic() < deadline
            time.sleep(0.02)
    finally:
        browser.switch_to.default_content()
    lowered = edited(TRUCK, 2, (0.0, -24.0, 0.0))
    assert Scene.load(tmp_path / "truck-shaft.changed.toml").points == pytest.approx(lowered.points)


@in_browser
@pytest.mark.parametrize("width", [1280, pytest.param(390, marks=pytest.mark.long)])
def test_a_machine_is_chosen(browser: webdriver.Chrome, tmp_path: Path, width: int) -> None:
    """By a link; nothing is wider than the screen."""
    screen(browser, width, 900)
    machines = [TRUCK, example("test-rig.toml")]
    page = moving_page({path.stem: Answer(Scene.load(path)) for path in machines})
    assert page is not None
    opened(browser, page, tmp_path)
    for path in reversed(machines):
        title = Scene.load(path).title
        browser.find_element(By.LINK_TEXT, title).click()
        browser.find_element(By.CSS_SELECTOR, "#live-panel .rows")
        assert browser.current_url.endswith(f"page.html?{path.stem}")
        assert browser.title == browser.find_element(By.TAG_NAME, "h1").text == title
        (chosen,) = browser.find_elements(By.CSS_SELECTOR, "nav [aria-current]")
        assert chosen.text == title
        assert verdict_of(browser) == check_data(Answer(Scene.load(path)))["verdict"]
        is_wide = "return document.documentElement.scrollWidth > innerWidth"
        assert not js(browser, is_wide)
        has_states = path == TRUCK
        key = browser.find_element(By.CSS_SELECTOR, ".live .key .rest")
        assert key.is_displayed() == has_states


@in_browser
def test_a_page_without_webassembly_is_the_report(
    browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """The live part stays hidden where the module cannot be loaded; all else is there."""
    (tmp_path / "page.html").write_text(answered(TRUCK).page, encoding="utf-8")
    without = {"source": "delete globalThis.WebAssembly"}
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", without)
    browser.get((tmp_path / "page.html").as_uri())
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)
    assert not browser.find_element(By.ID, "live-page").is_displayed()
    assert not browser.find_element(By.ID, "live-panel").is_displayed()
    assert browser.find_element(By.ID, "answer").is_displayed()
    assert browser.find_element(By.CSS_SELECTOR, "#tolerances .drawing figure").is_displayed()


def test_the_module_is_in_the_page(tmp_path: Path, answered: Answers) -> None:
    """Nothing is fetched: the page holds the compressed module, and pays for it only with it."""
    page = answered(TRUCK).page
    (module,) = re.findall(r'id="live-module">(.*?)</script>', page)
    assert base64.b64decode(module) == (WEB / "cardan.wasm.gz").read_bytes()
    (script,) = re.findall(r"<script>(.*?)</script>", page, re.S)
    assert not re.search(r"\b(import|export|eval|fetch)\b", script)
    recorded = Scene.parse("[driveline]\nbends_deg = [8]\n[study]\nbends_deg.0 = [1, 2]\n", "a")
    write_report(recorded, tmp_path / "b.html")
    assert "live-module" not in (tmp_path / "b.html").read_text(encoding="utf-8")


# --- curves over the turn -----------------------------------------------------------------------


def charts(browser: webdriver.Chrome) -> list[Drawn]:
    figures = browser.find_elements(By.CSS_SELECTOR, "#live-curves figure")
    return [chart_in(browser, figure) for figure in figures]


def over_the_turn(scene: Scene, name: str, state: str, degrees: FloatArray) -> FloatArray:
    """Accelerations, torques or sizes of bearing forces of all shafts or bearings of a state."""
    states = scene.states
    assert states
    number = states.names.index(state)
    line, load = states.driveline(number), states.load(number)
    assert load
    shafts = None if name == "bearing_force" else slice(None)
    found = line.evaluate(np.radians(degrees), name, shafts=shafts, load=load)
    values = np.asarray(getattr(found, name))
    if name == "acceleration_ratio":
        return values[1:] * float(load.speed) ** 2
    return values if name == "torque" else np.linalg.norm(values, axis=-1)


def drawn_as(scene: Scene, state: str, shown: list[Drawn], *, former: bool = False) -> None:
    """All curves stand where the axes say that the values of a scene are."""
    names = ("acceleration_ratio", "torque", "bearing_force")
    for chart, name in zip(shown, names, strict=True):
        curves = chart.former if former else chart.curves
        degrees = np.arange(0.0, 361.0, 3.0)
        values = over_the_turn(scene, name, state, degrees)
        assert len(values) == len(curves)
        # A tenth of a pixel.
        close = (chart.ticks["y"][-1] - chart.ticks["y"][0]) / 1000.0
        for curve, expected in zip(curves, values, strict=True):
            if np.ptp(expected) <= 0.01 * np.max(np.abs(expected)):
                assert len(curve) == 0
                continue
            assert np.allclose(curve[:, 0], degrees, atol=0.2)
            assert np.allclose(curve[:, 1], expected, atol=close), name


@in_browser
def test_curves_over_the_turn_stand_where_the_package_says(truck: webdriver.Chrome) -> None:
    """In the state shown, as drawn and after a move, with the scene as sent dashed behind it."""
    scene, moved = Scene.load(TRUCK), edited(TRUCK, 2, (0.0, -24.0, 0.0))
    shown = charts(truck)
    assert [chart.heading for chart in shown] == [
        "Acceleration [rad/s²]",
        "Torque [N m]",
        "Bearing force [N]",
    ]
    assert [chart.bounds for chart in shown] == [pytest.approx([-300, 300], abs=1.0), [], []]
    assert all("over drive angle [deg], from" in chart.spoken for chart in shown)
    drawn_as(scene, "rest", shown)
    assert not any(len(curve) for chart in shown for curve in chart.former)
    handle(truck, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN, Keys.NULL, 4 * Keys.ARROW_DOWN)
    truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")[0].click()
    settled(truck)
    drawn_as(moved, "-80 mm", charts(truck))
    drawn_as(scene, "-80 mm", charts(truck), former=True)
    assert "even" in charts(truck)[1].legend[-1]


@in_browser
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_sizes_of_curves_are_those_of_a_run(
    name: str, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Each that names its place in ``cardan run --json`` has the number there, exactly."""
    path = example(f"{name}.toml")
    opened(browser, answered(path).page, tmp_path)
    data, placed = answered(path).data("run"), 0
    for chip in browser.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]"):
        browser.execute_script("arguments[0].click()", chip)
        sizes = js(
            browser,
            """return [...document.querySelectorAll("#live-curves [data-path^='run:']")].map((e) =>
                [e.dataset.path, Number(e.dataset.value), e.textContent])""",
        )
        placed += len(sizes)
        for place, value, text in sizes:
            assert value == number_at(data, place), place
            shown = number_text(value, place.rpartition(".value")[2].removeprefix("_"))
            assert text.removeprefix("±") == shown.replace("-", "\u2212"), place
    assert placed


def number_at(data: Any, path: str) -> Any:  # noqa: ANN401
    """What a path names in JSON: ``run:rows[quantity=torque,shaft=3].value_Nm``."""
    for name, keys in re.findall(r"\.?(\w+)|\[([^\]]+)\]", path.partition(":")[2]):
        if name:
            data = data[name]
        else:
            wanted = dict(pair.split("=") for pair in keys.split(","))
            (data,) = [
                each for each in data if all(str(each.get(k)) == v for k, v in wanted.items())
            ]
    return data


@in_browser
def test_curves_are_copied(truck: webdriver.Chrome) -> None:
    """As text with a line of names and units."""
    button = truck.find_element(By.XPATH, "//button[.='Copy as CSV']")
    js(
        truck,
        """Object.defineProperty(navigator, "clipboard", { configurable: true, value: {
            writeText: async (text) => { window.copiedText = text; } } })""",
    )
    truck.execute_script("arguments[0].click()", button)
    head, *rows = js(truck, "return copiedText").splitlines()
    names = head.split(",")
    assert names[:2] == ["drive angle [deg]", "acceleration of shaft 1 [rad/s²] (rest)"]
    values = np.array([row.split(",") for row in rows], dtype=float)
    scene = Scene.load(TRUCK)
    expected = [
        over_the_turn(scene, name, "rest", values[:, 0])
        for name in ("acceleration_ratio", "torque", "bearing_force")
    ]
    assert values[:, 0].tolist() == list(range(0, 361, 3))
    assert np.allclose(values[:, 1:], np.concatenate(expected).T, rtol=1e-9, atol=1e-9)
    said = truck.find_element(By.CSS_SELECTOR, "#live-curves [role=status]")
    assert said.text == "copied"
