"""What the Python fuzzers share: corpus, limits and how long."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import atheris

HERE = Path(__file__).parent


def main(name: str, case: Callable[[bytes], None], longest: int) -> None:
    """Fuzz for the seconds of the command line; new inputs go to ``found``."""
    seconds = sys.argv[1] if len(sys.argv) > 1 else "60"
    found = HERE / "found" / name
    found.mkdir(parents=True, exist_ok=True)
    words = HERE / f"{name}.dict"
    atheris.Setup(
        [
            sys.argv[0],
            str(found),
            str(HERE / "corpus" / name),
            f"-max_total_time={seconds}",
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
