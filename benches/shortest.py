"""The shortest time of calls that take turns, and tables of such times."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence

SHORTEST_SAMPLE = 2e-4  # s: shorter calls are timed several at a time
FEWEST = 3  # rounds


def shortest(calls: Sequence[Callable[[], object]], seconds: float) -> list[float]:
    """Return the shortest seconds of each of some calls, run in turn for ``seconds`` per call."""
    counts = []
    for call in calls:
        call()
        start = time.perf_counter()
        call()
        counts.append(max(1, round(SHORTEST_SAMPLE / (time.perf_counter() - start))))
    best = [float("inf")] * len(calls)
    end = time.perf_counter() + seconds * len(calls)
    rounds = 0
    while rounds < FEWEST or time.perf_counter() < end:
        for i, (call, count) in enumerate(zip(calls, counts, strict=True)):
            start = time.perf_counter()
            for _ in range(count):
                call()
            best[i] = min(best[i], (time.perf_counter() - start) / count)
        rounds += 1
    return best


def table(heads: Sequence[str], lines: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table in Markdown, and an empty one."""
    rows = [heads, ["---"] * len(heads), *lines]
    return [*("| " + " | ".join(row) + " |" for row in rows), ""]


def digits(figure: float, count: int = 3) -> str:
    """Write a figure with a number of digits, without an exponent."""
    return f"{float(f'{figure:.{count}g}'):g}"
