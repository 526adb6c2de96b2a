"""What each choice of a caller gains: times of one run; writes ``choices.md``.

A section compares two or more ways to the same results. Its ways take turns in one process, so that
a factor is not affected by what the machine did meanwhile. ``docs/howto/speed.md`` says when which
way pays. ``--quick`` takes some seconds, prints and writes nothing.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

import cardan
import report
from shortest import digits, shortest, table

MOTION = ("angle", "speed_ratio", "acceleration_ratio")
ONE = cardan.Driveline.from_bends([0.5])
DRIVELINES, TURN = 1000, 720

Calls: TypeAlias = dict[str, Callable[[], object]]
"""Ways to the same results, by name; the factors of the others refer to the first."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small sizes; no file")
    quick: bool = parser.parse_args().quick
    seconds = 0.02 if quick else 0.2
    text = [
        "# Choices",
        "",
        "Written by `python benches/choices.py`. Unless a section says otherwise, a call evaluates",
        "angle, speed ratio and acceleration ratio of one joint on one thread, and the results go",
        "to existing arrays. Times are the shortest of several rounds. The brackets say how many",
        "times as fast a way is as the first line of the table.",
        "",
        "## Machine",
        "",
        "\n".join(report.machine()),
        "",
    ]
    nums: tuple[int, ...] = (8, 1000, 10**5)
    text += section("One call or a plan", "µs per call", of(plans, nums), [1e6] * 3, seconds)
    nums = (10**4, 10**5) if quick else (10**4, 10**6, 10**7)
    for title, ways in {
        "Outputs": outputs,
        "Fresh results or out": fresh,
        "Array or sweep": sweeps,
        "Accuracy": accuracies,
        "One thread or all": threads,
    }.items():
        scales = [1e9 / num for num in nums]
        text += section(title, "ns per angle", of(ways, nums), scales, seconds)
    for title, calls in {"Reduce or sample": reductions(), "Batch or loop": batches()}.items():
        heading = f"{TURN} angles of each of {DRIVELINES} drivelines"
        scales = [1e9 / DRIVELINES / TURN]
        text += section(title, "ns per angle", {heading: calls}, scales, seconds)
    print("\n".join(text))
    if not quick:
        (Path(__file__).parent / "choices.md").write_text("\n".join(text), encoding="utf-8")


def section(
    title: str, unit: str, columns: dict[str, Calls], scales: Sequence[float], seconds: float
) -> list[str]:
    """Measure the ways of each column in turn; return a heading and a table of scaled times."""
    cells: dict[str, list[str]] = {}
    for calls, scale in zip(columns.values(), scales, strict=True):
        times = shortest(list(calls.values()), seconds)
        for i, (way, best) in enumerate(zip(calls, times, strict=True)):
            factor = f" ({digits(times[0] / best)} times)" if i else ""
            cells.setdefault(way, []).append(digits(scale * best) + factor)
    return [
        f"## {title}",
        "",
        *table([unit, *columns], ([way, *own] for way, own in cells.items())),
    ]


def of(ways: Callable[[int], Calls], nums: Iterable[int]) -> dict[str, Calls]:
    """Return the ways for each number of angles, by what heads the column."""
    return {f"{report.size(num)} angles": ways(num) for num in nums}


def prepared(num: int, **options: Any) -> Callable[[], object]:
    """Return a call that fills existing arrays."""
    return filled(angles(num), num, **options)


def filled(
    angle: Any,
    num: int,
    names: Sequence[str] = MOTION,
    **options: Any,
) -> Callable[[], object]:
    plan = ONE.plan(names, **{"workers": 1, **options})
    out = {name: np.empty(num, options.get("dtype", float)) for name in names}
    return lambda: plan(angle, out)


def angles(num: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.linspace(-50.0, 50.0, num)


def plans(num: int) -> Calls:
    angle, plan = angles(num), ONE.plan(MOTION, workers=1)
    return {
        "`line.evaluate(angle, outputs)`": lambda: ONE.evaluate(angle, MOTION, workers=1),
        "`plan(angle)`": lambda: plan(angle),
        "`plan(angle, out)`": prepared(num),
        "for comparison: `np.sin(angle)`": lambda: np.sin(angle),
    }


def fresh(num: int) -> Calls:
    angle, plan = angles(num), ONE.plan(MOTION, workers=1)
    return {"`plan(angle)`": lambda: plan(angle), "`plan(angle, out)`": prepared(num)}


def sweeps(num: int) -> Calls:
    return {
        "an array of angles": prepared(num),
        "`Sweep(start, stop, num)`": filled(cardan.Sweep(-50.0, 50.0, num), num),
        "`Sweep.revolutions(num / 1000, 1000)`": filled(
            cardan.Sweep.revolutions(num // 1000, 1000), num
        ),
    }


def accuracies(num: int) -> Calls:
    return {
        "default": prepared(num),
        "`tolerance=0`": prepared(num, tolerance=0.0),
        "`tolerance=1e-6`": prepared(num, tolerance=1e-6),
        "`dtype=np.float32`": prepared(num, dtype=np.float32),
    }


def outputs(num: int) -> Calls:
    return {
        "three outputs": prepared(num),
        "`angle`, `speed_ratio`": prepared(num, names=MOTION[:2]),
        "`speed_ratio`": prepared(num, names=MOTION[1:2]),
    }


def threads(num: int) -> Calls:
    return {"`workers=1`": prepared(num), "default: all cores": prepared(num, workers=None)}


def reductions() -> Calls:
    lines, turn = batch()
    sampled = lines[:, None]
    return {
        "evaluate all samples, then `np.abs(…).max(axis=-1)`": lambda: np.abs(
            sampled.evaluate(turn, "angle_error", workers=1).angle_error
        ).max(axis=-1),
        '`reduce="peak"`': lambda: sampled.evaluate(turn, "angle_error", reduce="peak", workers=1),
        "`equivalent().max_angle_error`": lambda: lines.equivalent().max_angle_error,
    }


def batches() -> Calls:
    lines, turn = batch()
    rows = [lines[i] for i in range(DRIVELINES)]
    every = lines[:, None]
    return {
        "a loop over drivelines": lambda: [
            row.evaluate(turn, "speed_ratio", workers=1) for row in rows
        ],
        "one batch": lambda: every.evaluate(turn, "speed_ratio", workers=1),
        "one batch, all cores": lambda: every.evaluate(turn, "speed_ratio"),
    }


def batch() -> tuple[cardan.Driveline, cardan.Sweep]:
    bends = np.radians(np.linspace(1.0, 30.0, DRIVELINES))
    return cardan.Driveline.from_bends(bends[:, None]), cardan.Sweep.revolutions(1, TURN)


if __name__ == "__main__":
    main()
