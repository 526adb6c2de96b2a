"""Which tier of the tests runs: `pytest` alone is the short one, without the mark `long`."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest

whole = False
"""Whether random searches run whole, as with ``-m "long or not long"``; `conftest.py` sets it."""


def part(number: int) -> int:
    """Return how many of the examples of a random search the tier tries: all, or an eighth."""
    return number if whole else max(1, number // 8)


def few(values: Iterable[Any], short: Collection[Any]) -> list[Any]:
    """Return the parameters of a test, of which the short tier tries few."""
    return [
        pytest.param(
            *(value if isinstance(value, tuple) else (value,)),
            marks=() if value in short else pytest.mark.long,
        )
        for value in values
    ]
