"""Settings of the test run: its tier, its random searches, its threads."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

# NumPy reads this when it is imported. Threads of its linear algebra would wait for each other ten
# times as long as the small systems of the tests take.
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import hypothesis
import numpy as np
import pytest
from hypothesis.internal.conjecture import providers
from xdist.scheduler import LoadGroupScheduling

import tiers

if TYPE_CHECKING:
    from selenium import webdriver

    from example_scenes import Answers
    from live import Run

_starts: dict[np.random.Generator, Any] = {}
"""How random generators that modules of tests share are after their import."""


def pytest_configure(config: pytest.Config) -> None:
    # Before a test module is imported: what its decorators ask for depends on the tier.
    tiers.whole = config.option.markexpr != "not long"
    # No deadline, because a busy machine is no fault of the library's; no database, because there
    # is nothing that a run must remember.
    hypothesis.settings.register_profile(
        "fresh",
        deadline=None,
        database=None,
        print_blob=True,
        max_examples=tiers.part(100),
        suppress_health_check=[hypothesis.HealthCheck.too_slow],
    )
    # The same examples in every run: a failure anywhere can be repeated everywhere.
    hypothesis.settings.register_profile(
        "same", hypothesis.settings.get_profile("fresh"), derandomize=True, print_blob=False
    )
    # Hypothesis loads another one after this if its option --hypothesis-profile names it.
    hypothesis.settings.load_profile("same")
    if config.getoption("--hypothesis-profile") != "fresh":
        # Hypothesis also draws constants from the source of the modules that are imported and not
        # installed, so that examples would depend on which tests run before.
        providers.is_local_module_file = lambda path: False  # type: ignore[assignment,attr-defined]
    # Long calls take several threads on any machine, also with a worker of pytest-xdist for each
    # processor: what a thread may break is tested by all of them. Only a long call makes threads.
    os.environ["RAYON_NUM_THREADS"] = "4"


class _ByFiles(LoadGroupScheduling):
    """Gives a worker a group, a file of many short tests, or else one test."""

    def _split_scope(self, nodeid: str) -> str:
        scope, file = super()._split_scope(nodeid), nodeid.partition("::")[0]
        is_short = file.startswith(("tests/arrays/", "tests/physics/"))
        return file if scope == nodeid and is_short else scope


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> LoadGroupScheduling | None:  # noqa: ANN401
    # In the long tier a file may take longer than all else that is left.
    is_short = config.option.dist == "loadgroup" and not tiers.whole
    return _ByFiles(config, log) if is_short else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for module in {getattr(item, "module", None) for item in items} - {None}:
        for value in vars(module).values():
            if isinstance(value, np.random.Generator):
                _starts.setdefault(value, value.bit_generator.state)


def pytest_runtest_setup(item: pytest.Item) -> None:
    # Which tests run before, in this worker, changes no random number of a test.
    for value in vars(getattr(item, "module", None) or object).values():
        if isinstance(value, np.random.Generator):
            value.bit_generator.state = _starts[value]


@pytest.fixture(scope="session")
def answered(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Answers:
    """What cardan answers to an example; every worker finds what another has found."""
    # Tests of the library alone run without what the application needs.
    from example_scenes import Answered

    folder = tmp_path_factory.getbasetemp()
    if hasattr(request.config, "workerinput"):
        folder = folder.parent
    return lambda path: Answered(path, folder / "examples")


@pytest.fixture(scope="session")
def node() -> Iterator[Run]:
    """One process of Node for all scripts: that it starts takes longer than most of them."""
    import live

    yield from live.scripts()


@pytest.fixture(scope="session")
def chromium() -> Iterator[webdriver.Chrome]:
    """One browser for all tests that need one, which xdist gives to one worker."""
    import pages

    yield from pages.started()


@pytest.fixture
def browser(chromium: webdriver.Chrome) -> Iterator[webdriver.Chrome]:
    """The browser as wide as a desk, in light; at the end its console has said nothing."""
    import pages

    pages.at_rest(chromium)
    yield chromium
    assert pages.console(chromium) == []


@pytest.fixture
def truck(browser: webdriver.Chrome, answered: Answers, tmp_path: Path) -> webdriver.Chrome:
    """The browser with the page of a truck, which can be moved."""
    import pages
    from example_scenes import example

    pages.opened(browser, answered(example("truck-shaft.toml")).page, tmp_path)
    return browser


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene that writes its curves and its picture."""
    path = tmp_path / "scene.toml"
    path.write_text("[driveline]\nbends_deg = [8.5]\n[output]\ncurves = 'a.csv'\npicture = 'a.svg'")
    return path


@pytest.fixture
def into(tmp_path: Path) -> Path:
    """An empty folder."""
    path = tmp_path / "into"
    path.mkdir()
    return path


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--slowest",
        type=int,
        default=0,
        help="print so many tests without the mark long, by the time that processors took",
    )


def _processor_time() -> float:
    """Return the time of this process and of its children that have ended, in s."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    before = _processor_time()
    try:
        return (yield)
    finally:
        if item.get_closest_marker("long") is None:
            # A worker hands this to the process that reports.
            item.user_properties.append(("processor time", _processor_time() - before))


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:  # noqa: ANN401
    times = {
        report.nodeid: value
        for reports in terminalreporter.stats.values()
        for report in reports
        if getattr(report, "when", None) == "call"
        for name, value in report.user_properties
        if name == "processor time"
    }
    slowest = sorted(times.items(), key=lambda item: -item[1])[: config.getoption("--slowest")]
    for test, seconds in slowest:
        mark = "  above 5 s" if seconds > 5.0 else ""
        terminalreporter.write_line(f"{seconds:6.1f} s  {test}{mark}")
