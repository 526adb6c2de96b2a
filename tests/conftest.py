"""Settings of the test run: its tier, its random searches, its threads."""

from __future__ import annotations

import os

import hypothesis
import pytest
from hypothesis.internal.conjecture import providers

import tiers


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
    # A worker of pytest-xdist has a processor for itself; threads of the core would only compete.
    if hasattr(config, "workerinput"):
        os.environ.setdefault("RAYON_NUM_THREADS", "1")
