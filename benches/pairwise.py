"""Compare the speed of two installed cardans.

``python benches/pairwise.py --base PYTHON_A --new PYTHON_B`` starts a worker in each interpreter.
They take turns on every case, many short rounds each, so that whatever disturbs the machine for
longer than a round disturbs both. The workers are started anew several times. A row shows the
median times, the median ratio new/base of the rounds and its range, and the ratio of the best times
of all rounds. A median above 1.02 is marked, with a question mark if the best times do not confirm
it.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, TypeAlias

SLOWER = 1.02  # ratios above it are marked
BUDGET, QUICK_BUDGET = 2.9, 0.3  # s per case
PASSES = 4  # with new processes each: two of one program differ by some percent as well
FEWEST = 2  # rounds of a pass

Round: TypeAlias = tuple[float, float]
"""Best times of base and new."""


class Worker:
    """Another interpreter with its cardan, on one thread."""

    def __init__(self, python: str) -> None:
        # Of the package that is installed there, and not one from the path of this process.
        own = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        self._process = subprocess.Popen(
            [python, str(Path(__file__).with_name("pairwise_worker.py"))],
            env={**own, "RAYON_NUM_THREADS": "1", "PYTHONHASHSEED": "0"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        greeting: dict[str, Any] = json.loads(self._answer())
        self.about: str = greeting["about"]
        self.cases: list[str] = greeting["cases"]

    def best(self, case: str) -> float:
        """Return the best time of a round of the case in seconds."""
        assert self._process.stdin is not None
        print(case, file=self._process.stdin, flush=True)
        return float(self._answer())

    def close(self) -> None:
        self._process.communicate()

    def _answer(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"{self._process.args[0]} ended; what it printed is above")
        return line


def main() -> int:
    given = _arguments()
    budget = QUICK_BUDGET if given.quick else BUDGET
    rounds: dict[str, list[Round]] = {}
    for number in range(PASSES):
        base, new = Worker(given.base), Worker(given.new)
        if not number:
            print(f"base: {base.about}\nnew:  {new.about}\n", flush=True)
        for case in (case for case in base.cases if given.only in case):
            rounds.setdefault(case, []).extend(_rounds(case, base, new, budget / PASSES))
        base.close()
        new.close()
    if not rounds:
        print(f"no case has {given.only!r} in its name", file=sys.stderr)
        return 2
    print(f"{'case':44} {'base/µs':>10} {'new/µs':>10}", end="  ")
    print(f"{'new/base':>8}  {'min to max':14}  {'best':>5} rounds")
    medians = [_shown(case, own) for case, own in rounds.items()]
    slower = sum(ratio > SLOWER for ratio in medians)
    mean = statistics.geometric_mean(medians)
    print(f"\n{slower} of {len(medians)} above {SLOWER}; geometric mean {mean:.3f}")
    return 0


def _rounds(case: str, base: Worker, new: Worker, budget: float) -> list[Round]:
    for worker in (base, new):
        worker.best(case)  # prepares the case
    rounds: list[Round] = []
    until = time.perf_counter() + budget
    while len(rounds) < FEWEST or time.perf_counter() < until:
        rounds.append((base.best(case), new.best(case)))
    return rounds


def _shown(case: str, rounds: list[Round]) -> float:
    """Print a row; return the median ratio."""
    ratios = [new / base for base, new in rounds]
    ratio = statistics.median(ratios)
    times = [*zip(*rounds, strict=True)]
    best = min(times[1]) / min(times[0])
    medians = "".join(f" {1e6 * statistics.median(own):10.2f}" for own in times)
    span = f"{min(ratios):.3f} to {max(ratios):.3f}"
    mark = "" if ratio <= SLOWER else "  slower" if best > SLOWER else "  slower?"
    print(f"{case:44}{medians}  {ratio:8.3f}  {span}  {best:5.3f} {len(rounds):6}{mark}")
    return ratio


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--base", required=True, metavar="PYTHON", help="interpreter to compare to")
    parser.add_argument("--new", required=True, metavar="PYTHON", help="interpreter to judge")
    parser.add_argument("--quick", action="store_true", help="40 s in place of four minutes")
    parser.add_argument("--only", default="", metavar="SUBSTRING", help="cases that have it")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
