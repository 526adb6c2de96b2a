"""Measures the built site in Chromium: ``python docs/measure.py build/site``.

A code block must not be cut on a screen of 1280 pixels, nothing may be wider than a phone of 390
pixels, a page has at most 15 000 pixels of height on the screen, the site at most 10 MB, and its
search puts the right page first for the words of ``searches.txt``. Prints what breaks this, and the
counts; needs the extra ``test``.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

TALLEST = 15_000
"""Pixels."""
LARGEST = 10e6
"""Bytes of the site."""

FOUND = """
const root = document.documentElement;
const height = root.scrollHeight;
// A fold that somebody opens must fit as well.
for (const fold of document.querySelectorAll('details')) fold.open = true;
const visible = (element) => element.offsetParent !== null;
const cut = [...document.querySelectorAll('.md-content pre > code')].filter(
  (code) => visible(code) && code.scrollWidth > code.clientWidth + 1);
const scrolls = (element) => element !== null && element !== document.body
  && (/auto|scroll|hidden/.test(getComputedStyle(element).overflowX)
    || scrolls(element.parentElement));
const wide = [...document.querySelectorAll('.md-content *')].filter((element) => visible(element)
  && element.getBoundingClientRect().right > root.clientWidth + 1
  && !scrolls(element.parentElement));
return [height, cut.map((code) => code.textContent.split('\\n', 1)[0]),
  wide.map((element) => element.outerHTML.slice(0, 80))];
"""

SEARCH = """
const [query, done] = arguments;
const [input, meta] = ['input', 'result__meta'].map(
  (part) => document.querySelector(`.md-search__${part}, .md-search-${part}`));
input.focus();
input.value = query;
meta.textContent = '';
for (const type of ['keyup', 'input']) input.dispatchEvent(new Event(type, { bubbles: true }));
const started = Date.now();
const look = () => {
  // What is shown right away is the result of the search before.
  const found = Date.now() - started > 100 && meta.textContent !== '';
  const first = document.querySelector('.md-search-result__list > li a');
  if (found) done(first ? first.href : '');
  else setTimeout(look, 20);
};
look();
"""


def searched(browser: webdriver.Chrome, site: Path) -> tuple[int, list[str]]:
    """Return the number of searches, and those that find another page first."""
    lines = Path(__file__).with_name("searches.txt").read_text("utf-8").splitlines()
    searches = [line.split(" | ") for line in lines if not line.startswith("#")]
    browser.get((site / "licence.html").absolute().as_uri())
    faults = []
    for words, page in searches:
        first = browser.execute_async_script(SEARCH, words)
        found = first.partition("?")[0].removeprefix(f"{site.absolute().as_uri()}/")
        if found != page.replace(".md", ".html"):
            faults.append(f"'{words}' finds {found or 'nothing'}, not {page}")
    return len(searches), faults


def main(site: Path) -> int:
    """Return the number of faults, which are printed."""
    options = Options()
    options.binary_location = shutil.which("chromium") or ""
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    # The search is left out: it reads its index on every page.
    options.page_load_strategy = "eager"
    pages = sorted(page for page in site.rglob("*.html") if 'class="md-' in page.read_text("utf-8"))
    faults, heights = [], {}
    with webdriver.Chrome(options, Service(shutil.which("chromedriver"))) as browser:
        for width in (1280, 390):
            screen = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
            for page in pages:
                name = page.relative_to(site).as_posix()
                browser.get(page.absolute().as_uri())
                height, cut, wide = browser.execute_script(FOUND)
                faults += [f"{name}: wider than {width}: {element}" for element in wide]
                if width == 1280:
                    heights[height] = name
                    faults += [f"{name}: code is cut: {line}" for line in cut]
        tried, missed = searched(browser, site)
        faults += missed
    faults += [f"{heights[high]} is {high} pixels tall" for high in heights if high > TALLEST]
    size = sum(file.stat().st_size for file in site.rglob("*") if file.is_file())
    if size > LARGEST:
        faults.append(f"the site has {size / 1e6:.1f} MB")
    print(*faults, sep="\n")
    print(f"{len(pages)} pages, {size / 1e6:.2f} MB, at most {max(heights)} pixels tall")
    print(f"{tried - len(missed)} of {tried} searches find their page first")
    return len(faults)


if __name__ == "__main__":
    sys.exit(bool(main(Path(sys.argv[1]))))
