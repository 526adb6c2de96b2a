"""Move machines in their pages at random for so many minutes: no complaint, no leak, no NaN.

``python tests/page_soak.py MINUTES``. Handles are dragged, keys pressed, numbers typed, right and
wrong ones, changes undone, suggestions taken, states chosen and addresses read. Between the rounds
the page must have all figures, its console no message, its heap no more than after the first
rounds, and the memory of its module no more than after half of them.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

from cardan.app.report import write_report
from cardan.app.scene import Scene
from example_scenes import DRIVELINES

# Of a module after its largest search.
MOST_MB = 6.0

ROUND = """const [seed, done] = arguments;
let state = seed;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
const any = (list) => list[Math.floor(random() * list.length)];
const svg = document.getElementById("live-drawing");
svg.setPointerCapture = () => {};
const { drawing, model } = cardanPage;
let held = 0;
const pointer = (name, [x, y]) => {
    const box = svg.getBoundingClientRect();
    const where = { clientX: box.left + x, clientY: box.top + y, button: 0, pointerId: 1 };
    const how = { bubbles: true, cancelable: true, pointerType: "mouse" };
    svg.dispatchEvent(new PointerEvent(name, { ...where, ...how }));
};
const key = (element, key) => {
    const held = { shiftKey: random() < 0.4, altKey: random() < 0.2 };
    const how = { ...held, bubbles: true, cancelable: true };
    element?.dispatchEvent(new KeyboardEvent("keydown", { key, ...how }));
};
const click = (selector) => any([...document.querySelectorAll(selector)])?.click();
const arrows = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
const acts = [
    () => {
        if (!drawing.handles.length) return;
        pointer("pointerdown", any(drawing.handles).at);
        held = 8;
    },
    () => key(any(drawing.handles)?.element, any(arrows)),
    () => key(any([...document.querySelectorAll("#live-dials svg")]), any(arrows)),
    () => {
        const input = any([...document.querySelectorAll("input[inputmode=decimal]")]);
        if (!input) return;
        input.value = any(["1e9", "x", "", "1,5", "-12", "0", String(Math.round(4000 * random()))]);
        input.dispatchEvent(new Event("input"));
        input.dispatchEvent(new Event("change"));
    },
    () => click("#live-undo, #live-redo"),
    () => click("#live-states button"),
    () => click("#live-panel .ways button, #live-panel .changes button"),
    () => click("#live-dials button"),
    () => { if (random() < 0.2) document.getElementById("live-drawn").click(); },
    () => {
        const old = model.address;
        if (random() < 0.9) return; // Browsers refuse more than some addresses a second.
        const moved = "#point.2.y=" + (200 * random() - 100);
        location.hash = any([moved, "#phase.1=9&x=1", "#a=b", "#" + old]);
    },
];
let left = 300;
const step = () => {
    if (held > 1) pointer("pointermove", [1000 * random(), 450 * random()]);
    else if (held === 1) pointer(random() < 0.1 ? "pointercancel" : "pointerup", [0, 0]);
    else any(acts)();
    held = Math.max(0, held - 1);
    if (left-- > 0) return setTimeout(step, 3);
    document.getElementById("live-drawn").click();
    const words = document.querySelector("main").textContent;
    done([/NaN|undefined|Infinity/.test(words), model.figures.length]);
};
step();"""


def main() -> None:
    minutes = float(sys.argv[1])
    machines = [path for path in DRIVELINES if path.parent.name == "machines"]
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    browser.set_script_timeout(600)
    with tempfile.TemporaryDirectory() as folder:
        for number, path in enumerate(machines):
            write_report(Scene.load(path), Path(folder) / f"{path.stem}.html")
            browser.get((Path(folder) / f"{path.stem}.html").as_uri())
            browser.implicitly_wait(20)
            browser.find_element("css selector", "#live-panel .why")
            until = time.monotonic() + 60.0 * minutes / len(machines)
            sizes: list[tuple[float, float]] = []
            while len(sizes) < 4 or time.monotonic() < until:
                bad, figures = browser.execute_async_script(ROUND, 7 + number + 97 * len(sizes))
                complaints = browser.get_log("browser")  # type: ignore[no-untyped-call]
                if bad or not figures or complaints:
                    raise SystemExit(f"{path.stem}, round {len(sizes)}: {complaints or 'a figure'}")
                browser.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
                heap = browser.execute_cdp_cmd("Runtime.getHeapUsage", {})["usedSize"]
                memory = browser.execute_script("return cardanPage.memory()")
                sizes.append((heap / 1e6, memory / 1e6))
            print(path.stem, len(sizes), "rounds, MB:", sizes[1], sizes[-1], flush=True)
            # The memory of a module never shrinks: one search takes most, and none later more.
            most = min(sizes[len(sizes) // 2][1] + 1.0, MOST_MB)
            if sizes[-1][0] > 1.2 * sizes[1][0] + 1.0 or sizes[-1][1] > most:
                raise SystemExit(f"{path.stem}: memory grows, in MB: {sizes}")
    browser.quit()


if __name__ == "__main__":
    main()
