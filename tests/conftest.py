"""Settings of the test run: its tier, its random searches, its threads."""

from __future__ import annotations

import os

import hypothesis
import pytest

import tiers
from example_scenes import Answered, Answers


def pytest_configure(config: pytest.Config) -> None:
    # Before a test module is imported: what its decorators ask for depends on the tier.
    tiers.whole = config.option.markexpr != "not long"
    # The same examples in every run: a failure anywhere can be repeated everywhere. No deadline,
    # because a busy machine is no fault of the library's; no database, because there is nothing
    # that a run must remember.
    hypothesis.settings.register_profile(
        "cardan",
        derandomize=True,
        deadline=None,
        database=None,
        print_blob=False,
        max_examples=tiers.part(100),
        suppress_health_check=[hypothesis.HealthCheck.too_slow],
    )
    hypothesis.settings.load_profile("cardan")
    # Each worker of pytest-xdist has a processor for itself; threads of the core would only compete.
    if hasattr(config, "workerinput"):
        os.environ.setdefault("RAYON_NUM_THREADS", "1")


@pytest.fixture(scope="session")
def answered(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Answers:
    """What cardan answers to an example; every worker finds what another has found."""
    folder = tmp_path_factory.getbasetemp()
    if hasattr(request.config, "workerinput"):
        folder = folder.parent
    return lambda path: Answered(path, folder / "examples")
