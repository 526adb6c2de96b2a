"""Which tier of the tests runs: `pytest` alone is the short one, without the mark `long`."""

from __future__ import annotations

whole = False
"""Whether random searches run whole, as with ``-m "long or not long"``; `conftest.py` sets it."""


def part(number: int) -> int:
    """Return how many of the examples of a random search the tier tries: all, or a quarter."""
    return number if whole else max(1, number // 4)
