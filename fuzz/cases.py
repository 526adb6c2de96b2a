"""What the Python fuzzers share: corpus, limits and how long."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import atheris

HERE = Path(__file__).parent


def main(name: str, case: Callable[[bytes], None], longest: int) -> None:
    """Fuzz for some seconds, or a number of cases from a fixed seed; new inputs go to ``found``.

    The same cases of a fresh clone are the same on every machine, whatever its speed, as long as
    ``PYTHONHASHSEED`` is fixed.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("seconds", nargs="?", default="60")
    parser.add_argument("--cases")
    how_long = parser.parse_args()
    limits = (
        ["-seed=1", f"-runs={how_long.cases}"]
        if how_long.cases
        else [f"-max_total_time={how_long.seconds}"]
    )
    found = HERE / "found" / name
    found.mkdir(parents=True, exist_ok=True)
    words = HERE / f"{name}.dict"
    atheris.Setup(
        [
            sys.argv[0],
            str(found),
            str(HERE / "corpus" / name),
            *limits,
            f"-max_len={longest}",
            "-timeout=100",
            "-rss_limit_mb=4096",
            "-print_final_stats=1",
            f"-artifact_prefix={found}-",
            *([f"-dict={words}"] if words.exists() else []),
        ],
        case,
    )
    atheris.Fuzz()
