"""Settings of the test run: its tier, its random searches, its threads."""

from __future__ import annotations

import os
from typing import Any

# NumPy reads this when it is imported. Threads of its linear algebra would wait for each other ten
# times as long as the small systems of the tests take.
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import hypothesis
import numpy as np
import pytest
from hypothesis.internal.conjecture import providers

import tiers

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
