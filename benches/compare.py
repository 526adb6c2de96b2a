"""Run the same jobs in this package and in every peer that is installed.

``python benches/compare.py`` measures all methods in turn in one process, round after round, holds
every result against exact numbers, and writes ``compare.md`` and ``compare.svg`` beside itself. On
a processor with AVX-512 another process then does the same with AVX2, as most processors have it,
and writes ``compare-avx2.md`` and ``compare-avx2.svg``. ``--quick`` takes a minute, prints and
writes nothing. The exit status is 1 when a result is wrong.
"""

from __future__ import annotations

import argparse
import gc
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import picture
import report
from cardan import _core
from job import JOBS, LEVEL, Call, Job, JobRun, Method, recorded_angles
from judge import ComparisonRow, Judge, WorstErrors
from peers import PEERS, methods

SHORTEST_SAMPLE = 1e-3  # s: shorter calls are timed several at a time
LEVELS = {"avx512": "compare", "avx2": "compare-avx2"}
"""The files of each instruction set."""

LONGEST = 3.0  # s: what calls of one method may take in all rounds of a case


# What keeps other packages from AVX-512. They read it when they are loaded.
WITHOUT_AVX512 = {
    "MKL_ENABLE_INSTRUCTIONS": "AVX2",
    # The names of NumPy 2.4 and those before.
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR AVX512F AVX512CD AVX512_SKX",
    "NUMBA_CPU_NAME": "haswell",
    "NUMBA_CPU_FEATURES": "",
    "XLA_FLAGS": "--xla_cpu_max_isa=AVX2",
}


def main() -> int:
    given = _arguments()
    if "BENCH_LEVEL" not in os.environ:
        return max(_at(level) for level in LEVELS if level in _core.levels())
    found, missing = methods(given.peers)
    for name, reason in missing.items():
        print(f"without {name}: {reason}")
    rows: list[ComparisonRow] = []
    loads = os.getloadavg()
    for num in given.sizes:
        for threads in sorted({1, os.cpu_count() or 1}):
            if threads > 1 and num < given.threads_from:
                continue
            for job in JOBS:
                rows += _case(job, num, threads, found, given.rounds)
    if not given.quick:
        about = report.about(found, missing, given.rounds, loads)
        folder = Path(__file__).parent
        report.write(folder / f"{LEVELS[LEVEL]}.md", rows, about)
        picture.draw(rows, folder / f"{LEVELS[LEVEL]}.svg")
    wrong = [row for row in rows if row.wrong]
    for row in wrong:
        print(f"wrong: {report.label(row.method)}, {row.job.name}, {row.num} angles: {row.verdict}")
    return 1 if wrong else 0


def _at(level: str) -> int:
    """Run this program with an instruction set, and return its exit status."""
    limits = WITHOUT_AVX512 if level == "avx2" else {}
    environment = {**os.environ, "BENCH_LEVEL": level, **limits}
    return subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="this package and NumPy, small sizes")
    parser.add_argument("--peers", nargs="+", choices=PEERS, help="only these")
    parser.add_argument("--sizes", nargs="+", type=lambda text: int(float(text)))
    parser.add_argument("--rounds", type=int)
    given = parser.parse_args()
    given.peers = given.peers or (["cardan", "numpy"] if given.quick else None)
    given.sizes = given.sizes or ([10_000] if given.quick else [10_000, 100_000, 10_000_000])
    given.rounds = given.rounds or (3 if given.quick else 11)
    # Nobody gains from threads where a call takes some ten microseconds.
    given.threads_from = 0 if given.quick else 100_000
    return given


def _case(
    job: Job, num: int, threads: int, found: list[Method], rounds: int
) -> list[ComparisonRow]:
    words = {method.word for method in found}
    planes = {word: np.empty((job.planes, num), word) for word in words}
    case = JobRun(job, num, threads, recorded_angles(num), planes)
    judge = Judge(case, 200)
    calls: list[tuple[Method, Call, WorstErrors]] = []
    for method in found:
        call = method.prepare(case)
        if call is None:
            continue
        for plane in planes.values():
            plane.fill(np.nan)
        calls.append((method, call, judge(call())))
    times: list[list[float]] = [[] for _ in calls]
    gc.collect()
    gc.disable()
    for _ in range(rounds):
        for (_, call, _), taken in zip(calls, times, strict=True):
            # The slowest have fewer rounds.
            if sum(taken) < LONGEST:
                taken.append(_time(call, taken, threads))
    gc.enable()
    rows = []
    print(f"\n{job.title}; {num} angles, {threads} thread{'s' if threads > 1 else ''}")
    for (method, _, verdict), taken in zip(calls, times, strict=True):
        best, median = (1e9 / num * t for t in (min(taken), statistics.median(taken)))
        rows.append(ComparisonRow(job, num, threads, method, best, median, verdict))
        error = f"error {verdict.relative:.1e}, {verdict.ulp:.3g} ulp"
        print(f"  {report.label(method):24} {best:8.2f} {median:8.2f} ns  {error}", flush=True)
    return rows


def _time(call: Call, before: list[float], threads: int) -> float:
    """Seconds per call; several calls are one sample where one is too short to time."""
    count = max(1, round(SHORTEST_SAMPLE / min(before))) if before else 1
    if threads > 1:
        time.sleep(0.005)  # idle threads of the method before spin for a while
    if count > 1:
        call()  # wakes threads, fills caches
    start = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - start) / count


if __name__ == "__main__":
    sys.exit(main())
