"""The comparison as tables."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from job import JOBS, LEVEL, Method

if TYPE_CHECKING:
    from judge import ComparisonRow

# Errors this close to each other count as the same.
SAME = 3.0


def about(
    found: Sequence[Method], missing: dict[str, str], rounds: int, loads: Sequence[float]
) -> str:
    """Say where, with what and how it was measured."""
    notes = [note for note in dict.fromkeys(method.note for method in found) if note]
    lines = [
        *machine(),
        f"Instruction set: {LEVEL}.",
        "; ".join(notes) + ".",
        f"Load average of the machine at the start: {loads[0]:.1f}.",
        f"{rounds} rounds; in each, all methods run in turn in one process.",
    ]
    if missing:
        lines.append("Not installed: " + ", ".join(missing) + ".")
    return "\n".join(lines)


def machine() -> Iterable[str]:
    """Say what machine this is, and which commit and Python are measured."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text().splitlines() if path.exists() else []
    models = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    flags = next((line for line in lines if line.startswith("flags")), "")
    sets = [name for name in ("avx2", "fma", "avx512f") if f" {name} " in f"{flags} "]
    model = models[0] if models else platform.processor()
    yield f"{model}, {os.cpu_count()} cores, {' '.join(sets)}; {platform.system()}."
    yield f"cardan at commit {_commit()}; Python {platform.python_version()}."


def _commit() -> str:
    def git(*arguments: str) -> str:
        done = subprocess.run(
            ["git", *arguments], capture_output=True, text=True, cwd=Path(__file__).parent
        )
        return done.stdout.strip()

    changed = git("status", "--porcelain", "--", "../rust", "../python")
    return (git("rev-parse", "--short", "HEAD") or "no commit") + (", changed" if changed else "")


def write(path: Path, rows: Sequence[ComparisonRow], about: str) -> None:
    """Write the tables, and before them the cases in which others are faster."""
    text = [
        "# Comparison",
        "",
        "Written by `python benches/compare.py`. Times are in ns per angle: the shortest of the",
        "rounds, with the median in brackets. Compare only figures in the same column of the same",
        "table. Errors are against 60-digit arithmetic, the largest over all outputs and a sample",
        "of angles, which includes the 32 nearest to multiples of a quarter turn. They are given",
        "relative to the largest magnitude of the output, and in ulp of the exact double (for a",
        "vector, in ulp of its largest component). Behind three joints the ulp mean little,",
        "because an acceleration has few digits near its zero. The angles of a sweep are exact in",
        "cardan and rounded to doubles in all other packages.",
        "",
        about,
        "",
        f"![Error and time of each method]({path.stem}.svg)",
        "",
        *_wins(rows),
    ]
    for job in JOBS:
        own = [row for row in rows if row.job is job]
        if own:
            text += [f"## {job.name}: {job.title}", "", *_table(own), ""]
    path.write_text("\n".join(text), encoding="utf-8")


def columns(rows: Sequence[ComparisonRow]) -> list[tuple[int, int]]:
    """Sizes and numbers of threads that were measured."""
    return list(dict.fromkeys((row.num, row.threads) for row in rows))


def size(num: int) -> str:
    """Write a count as a power of ten where it is one."""
    exponent = round(np.log10(num))
    power = str(exponent).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{power}" if 10**exponent == num else str(num)


def case(num: int, threads: int) -> str:
    return f"{size(num)}, {threads} thread{'s' if threads > 1 else ''}"


def label(method: Method) -> str:
    """Name a method as the table and the picture do."""
    return f"cardan, {method.name}" if method.peer == "cardan" else method.name


def _table(rows: Sequence[ComparisonRow]) -> Iterable[str]:
    across = columns(rows)
    yield "| | error | ulp | " + " | ".join(case(*column) for column in across) + " |"
    yield "|---" * (3 + len(across)) + "|"
    for method in dict.fromkeys(row.method for row in rows):
        own = {(row.num, row.threads): row for row in rows if row.method is method}
        relative = max(row.verdict.relative for row in own.values())
        ulp = max(row.verdict.ulp for row in own.values())
        digits = f"{ulp:.2g}" if ulp < 99.5 else f"{ulp:.0f}" if ulp < 1e4 else ""
        cells = [f"{label(method)}", f"{relative:.1e}", digits]
        for column in across:
            row = own.get(column)
            cells.append(f"{row.best:.2f} ({row.median:.2f})" if row else "")
        yield "| " + " | ".join(cells) + " |"


def _wins(rows: Sequence[ComparisonRow]) -> Iterable[str]:
    """Say which peers are faster than everything of this package that is as accurate."""
    yield "## Where others are faster"
    yield ""
    yield "These are faster than cardan at every accuracy setting whose error is at most"
    yield f"{SAME:g} times as large:"
    yield ""
    lost = []
    for job in JOBS:
        for num, threads in columns(rows):
            here = [r for r in rows if (r.job, r.num, r.threads) == (job, num, threads)]
            right = sorted((r for r in here if not r.wrong), key=lambda r: r.verdict.relative)
            fastest = float("inf")
            for row in (r for r in right if r.method.peer != "cardan"):
                as_good = [
                    r.best
                    for r in right
                    if r.method.peer == "cardan"
                    and r.verdict.relative <= SAME * row.verdict.relative
                ]
                ours = min(as_good, default=float("nan"))
                if row.best < fastest and not ours <= row.best:
                    fastest = row.best
                    lost.append(
                        f"* {job.name}, {case(num, threads)}: {label(row.method)}, "
                        f"{row.best:.2f} ns against {ours:.2f} ns, error {row.verdict.relative:.1e}"
                    )
    yield from lost or ["None in this run."]
    yield ""
