"""Settings of the test run."""

from __future__ import annotations

import hypothesis

# The same examples in every run: a failure anywhere can be repeated everywhere. No deadline,
# because a busy machine is no fault of the library's; no database, because there is nothing that
# a run must remember.
hypothesis.settings.register_profile(
    "cardan",
    derandomize=True,
    deadline=None,
    database=None,
    print_blob=False,
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.load_profile("cardan")
