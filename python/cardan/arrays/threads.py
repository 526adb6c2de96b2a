"""How many threads an evaluation may use."""

from __future__ import annotations

import os
import sys
from typing import SupportsIndex

from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import integer

# The thread pool does not survive a fork: its threads stay behind in the parent, and waiting for
# them would last for ever. Forked processes are themselves the parallelism of their program, so
# there every call runs on its own thread.
_forked = False


def _after_fork() -> None:
    global _forked
    _forked = True


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def at_most(workers: SupportsIndex | None) -> int | None:
    """Return the number of threads as the native module counts them; ``None`` leaves it to it."""
    if workers is None:
        return 1 if _forked else None
    count = integer("workers", workers)
    if count < 1 and count != -1:
        raise ArgumentValueError("workers", f"is {count}; it must be positive, or -1 for all cores")
    if _forked:
        return 1
    return None if count == -1 else min(count, sys.maxsize)
