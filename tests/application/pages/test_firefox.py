"""The live part of a page in Firefox: the figures, texts and verdict that it has in Chromium.

Both have those of ``cardan check``. Debian has no driver of Firefox for selenium, so this speaks
WebDriver BiDi with it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import websocket

from cardan.app.answers.answer import Answer
from cardan.app.answers.schema import check_data
from cardan.app.report.moving import moving_page
from cardan.app.scene import Scene
from example_scenes import DRIVELINES, Answers, example
from live import at, close, edited, texts

FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")
REQUIRED = bool(os.environ.get("CARDAN_REQUIRE_FIREFOX"))
MACHINES = [path for path in DRIVELINES if path.parent.name == "machines"]
TRUCK = example("truck-shaft.toml")

pytestmark = [
    pytest.mark.firefox,
    pytest.mark.long,
    pytest.mark.xdist_group("browser"),
    pytest.mark.skipif(FIREFOX is None and not REQUIRED, reason="needs Firefox"),
]

FIGURES = """[...document.querySelectorAll(".live [data-path^='check:']")]
    .filter((e) => e.textContent)
    .map((e) => [e.dataset.path, Number(e.dataset.value), e.textContent])"""
VERDICT = "document.querySelector('#live-panel .head').dataset.verdict"
ALIVE = """new Promise((done) => {
    const look = () => document.querySelector("#live-panel .head[data-verdict]")
        ? done(true) : setTimeout(look, 20);
    look();
})"""
KEYS = """(() => {
    const handle = document.querySelector(".handle[data-point='2'][data-view='0']");
    handle.focus();
    for (let i = 0; i < 6; i++) {
        const how = { key: "ArrowDown", shiftKey: i < 2, bubbles: true, cancelable: true };
        handle.dispatchEvent(new KeyboardEvent("keydown", how));
    }
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
})()"""
CHECKS = """new Promise((done) => {
    const foot = document.querySelector("#live-trust"), button = foot.querySelector("button");
    button.click();
    const look = () => button.disabled ? setTimeout(look, 50)
        : done(foot.querySelector("[role=status]").textContent);
    look();
})"""


class Firefox:
    """A browser that is asked one thing after the other."""

    def __init__(self, address: str) -> None:
        """Begin a session at the address of a browser."""
        self._socket = websocket.create_connection(address, timeout=60, suppress_origin=True)
        self._count = 0
        self.said: list[str] = []
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["log.entryAdded"])
        self._context = ""

    def ask(self, method: str, **parameters: Any) -> Any:  # noqa: ANN401
        """Return what the browser answers; what its console says meanwhile is kept."""
        self._count += 1
        self._socket.send(json.dumps({"id": self._count, "method": method, "params": parameters}))
        while True:
            told = json.loads(self._socket.recv())
            if told.get("method") == "log.entryAdded":
                self.said.append(str(told["params"]["text"]))
            elif told.get("id") == self._count:
                assert told["type"] == "success", told
                return told["result"]

    def close(self) -> None:
        """Say no more."""
        self._socket.close()

    def open(self, path: Path, query: str = "") -> None:
        """Open a page, or the frame in it, from a file and wait until its machine can be moved."""
        (page,) = self.ask("browsingContext.getTree")["contexts"]
        address, context = path.as_uri() + query, page["context"]
        self.ask("browsingContext.navigate", context=context, url=address, wait="complete")
        (page,) = self.ask("browsingContext.getTree")["contexts"]
        self._context = (page["children"] or [page])[0]["context"]
        assert self.js(ALIVE)

    def js(self, expression: str) -> Any:  # noqa: ANN401
        """Return the value of an expression, or what it promises."""
        found = self.ask(
            "script.evaluate",
            expression=f"(async () => JSON.stringify(await ({expression}) ?? null))()",
            target={"context": self._context},
            awaitPromise=True,
        )
        assert found["type"] == "success", found["exceptionDetails"]["text"]
        return json.loads(found["result"]["value"])


@pytest.fixture(scope="module")
def firefox(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    assert FIREFOX, "CARDAN_REQUIRE_FIREFOX is set and Firefox is missing"
    profile = tmp_path_factory.mktemp("profile")
    command = [FIREFOX, "--headless", "--no-remote", "--profile", str(profile)]
    environment = os.environ | {"HOME": str(profile)}
    process = subprocess.Popen(
        [*command, "--remote-debugging-port=0", "about:blank"],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr
        line = next(line for line in process.stderr if "WebDriver BiDi listening on" in line)
        browser = Firefox(f"{line.split()[-1]}/session")
        yield browser
        browser.close()
    finally:
        process.terminate()
        process.wait(30)
        if process.stderr:
            process.stderr.close()


@pytest.fixture
def browser(firefox: Firefox) -> Iterator[Firefox]:
    """The browser; at the end its console has said nothing."""
    yield firefox
    assert firefox.said == []


def test_what_firefox_complains_of_is_heard(
    firefox: Firefox, answered: Answers, tmp_path: Path
) -> None:
    """Without this, no other test would notice."""
    page = answered(TRUCK).page
    wrong = page.replace("modules.page.start();", "modules.page.start(); setTimeout(() => no.one);")
    assert wrong != page
    policy = re.sub("script-src '[^\"]*'", "script-src 'unsafe-inline' 'wasm-unsafe-eval'", wrong)
    (tmp_path / "page.html").write_text(policy, encoding="utf-8")
    firefox.open(tmp_path / "page.html")
    assert [words for words in firefox.said if "no is not defined" in words]
    firefox.said.clear()


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.stem)
def test_firefox_shows_what_the_check_says(
    path: Path, browser: Firefox, answered: Answers, tmp_path: Path
) -> None:
    (tmp_path / "page.html").write_text(answered(path).page, encoding="utf-8")
    browser.open(tmp_path / "page.html")
    answer = Answer(Scene.load(path))
    data, written = check_data(answer), texts(answer)
    assert browser.js(VERDICT) == data["verdict"]
    shown = browser.js(FIGURES)
    assert len(shown) >= 2
    for place, value, text in shown:
        assert close(value, at(data, place)), place
        own = re.sub(r"\[\w+=(.*?)\]", r".\1", place[6:]).rpartition(".value")[0]
        if own in written:
            assert text == written[own].replace("-", "\u2212"), place


def test_keys_move_a_joint_in_firefox(browser: Firefox, answered: Answers, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(answered(TRUCK).page, encoding="utf-8")
    browser.open(tmp_path / "page.html")
    browser.js(KEYS)
    data = check_data(Answer(edited(TRUCK, 2, (0.0, -24.0, 0.0))))
    assert browser.js(VERDICT) == "within"
    for place, value, _ in browser.js(FIGURES):
        assert close(value, at(data, place)), place


def test_firefox_computes_the_published_digest(browser: Firefox, tmp_path: Path) -> None:
    """In the page with a choice of machines, whose address has a query."""
    page = moving_page({path.stem: Answer(Scene.load(path)) for path in MACHINES[:2]})
    assert page is not None
    (tmp_path / "page.html").write_text(page, encoding="utf-8")
    browser.open(tmp_path / "page.html", f"?{MACHINES[1].stem}")
    assert browser.js("document.title") == Scene.load(MACHINES[1]).title
    assert browser.js(CHECKS).startswith("All 10\u2009000 evaluations have the published results")


def test_firefox_shows_the_frame_of_a_notebook(browser: Firefox, tmp_path: Path) -> None:
    shown = Scene.load(TRUCK)._repr_html_()
    (tmp_path / "a.html").write_text(f"<!DOCTYPE html><meta charset=utf-8>{shown}", "utf-8")
    browser.open(tmp_path / "a.html")
    assert browser.js("origin") == "null"
    assert browser.js(VERDICT) == "beyond"
    browser.js(KEYS)
    assert browser.js(VERDICT) == "within"
