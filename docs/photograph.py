"""Photographs the page of a scene for the README: ``python docs/photograph.py``; needs ``test``."""

from __future__ import annotations

import io
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

from cardan.app.report import write_report
from cardan.app.scene import Scene

DOCS = Path(__file__).parent
SCENE = DOCS.parent / "examples" / "ride_heights.toml"
SIZE = (1240, 828)
"""Down to the slider below the drawing."""


def main() -> None:
    """Write ``page.png``."""
    options = Options()
    options.binary_location = shutil.which("chromium") or ""
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    with (
        tempfile.TemporaryDirectory() as folder,
        webdriver.Chrome(options, Service(shutil.which("chromedriver"))) as browser,
    ):
        write_report(Scene.load(SCENE), Path(folder) / "a.html")
        screen = {"width": SIZE[0], "height": SIZE[1], "deviceScaleFactor": 1, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
        browser.get((Path(folder) / "a.html").as_uri())
        # The module has computed the verdict when the first suggestion is there.
        browser.implicitly_wait(20)
        browser.find_element("css selector", "#live-panel .ways button")
        picture = Image.open(io.BytesIO(browser.get_screenshot_as_png()))
    # A quarter of the size, and the same to the eye.
    picture.quantize(96).save(DOCS / "page.png", optimize=True)


if __name__ == "__main__":
    main()
