"""How time grows with joints, angles, drivelines and threads; writes ``scaling.md``.

One method, this package's default, so what is compared is the package with itself. All figures of a
table come from one process (threads: one for each line, since the pool is as large as it began).
``--quick`` stops at a hundredth of the sizes.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

import cardan
import report
from shortest import digits, shortest, table

MOTION = ("angle", "speed_ratio", "acceleration_ratio")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a hundredth of the sizes; no file")
    parser.add_argument("--threads", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    largest = 10**6 if given.quick else 10**8
    if given.threads:
        print(*_threads(largest // 10))
        return
    text = [
        "# Scaling",
        "",
        "Written by `python benches/scaling.py`. It measures only cardan, at the default accuracy",
        "unless a table says otherwise. Times are the shortest of several rounds. Three outputs",
        "are angle, speed ratio and acceleration ratio. Results go to existing arrays (`out=`)",
        "unless a column names a new array.",
        "",
        "\n".join(report.machine()),
        "",
        *_joints(100_000),
        *_angles(largest),
        *_drivelines(largest // 100),
        *_pools(given.quick),
    ]
    print("\n".join(text))
    if not given.quick:
        (Path(__file__).parent / "scaling.md").write_text("\n".join(text), encoding="utf-8")


def _times(calls: Sequence[Callable[[], object]]) -> list[float]:
    return shortest(calls, 0.1 if "--quick" in sys.argv else 0.6)


def _line(n: int) -> cardan.Driveline:
    """A driveline of joints of 5° with yokes in no special position."""
    between = np.arange(max(n - 1, 0))
    return cardan.Driveline.from_bends(
        np.radians(np.full(n, 5.0)), twists=0.3 * between, phases=0.2 + 0.1 * between
    )


def _joints(num: int) -> list[str]:
    counts = (1, 2, 4, 8, 16, 32, 64)
    angle = np.linspace(-50.0, 50.0, num)
    out = {name: np.empty(num) for name in MOTION}
    plans = [_line(n).plan(MOTION, workers=1) for n in counts]
    prepared = _times([partial(plan, angle, out) for plan in plans])
    folding = _times([lambda n=n: _line(n).plan(MOTION, workers=1) for n in counts])
    return [
        f"## Joints ({report.size(num)} angles, three outputs, one thread)",
        "",
        *table(
            ["joints", *map(str, counts)],
            [
                ["ns per angle", *(f"{1e9 * t / num:.2f}" for t in prepared)],
                ["µs to create the driveline and the plan", *(f"{1e6 * t:.0f}" for t in folding)],
            ],
        ),
    ]


def _angles(largest: int) -> list[str]:
    nums = [10**e for e in range(2, 9) if 10**e <= largest]
    plans = {workers: _line(1).plan("speed_ratio", workers=workers) for workers in (1, -1)}
    lines = []
    for num in nums:
        angle = np.linspace(-50.0, 50.0, num)
        out = {"speed_ratio": np.empty(num)}
        best = _times(
            [
                partial(plans[1], angle, out),
                partial(plans[-1], angle, out),
                partial(plans[-1], angle),
                partial(np.copyto, out["speed_ratio"], angle),
            ]
        )
        lines.append([report.size(num), *(digits(1e9 * t / num) for t in best)])
    heads = ["angles", "one thread", "all threads", "all threads, new array", "one thread copying"]
    return ["## Angles (`speed_ratio` of one joint, ns per angle)", "", *table(heads, lines)]


def _drivelines(largest: int) -> list[str]:
    nums = [10**e for e in range(7) if 10**e <= largest]
    turn = cardan.Sweep.revolutions(1, 720)
    load = cardan.Load(drive_torque=100.0)
    lines = []
    for num in nums:
        bends = np.radians(np.linspace(1.0, 30.0, 3 * num).reshape(num, 3))
        own = cardan.Driveline.from_bends(bends)
        batch = own[:, None]
        angles = np.full(num, 0.3)
        best = _times(
            [
                partial(cardan.Driveline.from_bends, bends),
                partial(own.evaluate, angles, "speed_ratio"),
                partial(batch.evaluate, turn, "angle_error", reduce="peak"),
                partial(batch.evaluate, turn, "moment", load=load, reduce="peak"),
            ]
        )
        counts = (num, num, 720 * num, 2160 * num)
        figures = (digits(1e9 * t / n) for t, n in zip(best, counts, strict=True))
        lines.append([report.size(num), *figures])
    heads = [
        "drivelines of three joints",
        "creating them, ns each",
        "`speed_ratio` at one angle each, ns each",
        "peak of `angle_error` over 720 angles, ns per angle",
        "peak of `moment` of three joints, ns per angle and joint",
    ]
    return ["## Drivelines (all threads)", "", *table(heads, lines)]


def _threads(num: int) -> Iterable[str]:
    """What one line of the table of threads shows, in a process of its own."""
    angle = np.linspace(-50.0, 50.0, num)
    out = {name: np.empty(num) for name in MOTION}
    turn = cardan.Sweep.revolutions(1, 720)
    batch = cardan.Driveline.from_bends(np.radians(np.linspace(1.0, 30.0, num // 1000))[:, None])
    best = _times(
        [
            lambda: _line(1).evaluate(angle, MOTION, out=out),
            lambda: _line(1).evaluate(angle, MOTION, out=out, tolerance=0.0),
            lambda: batch[:, None].evaluate(turn, "angle_error", reduce="peak"),
        ]
    )
    counts = (num, num, batch.shape[0] * 720)
    return (digits(1e9 * t / n) for t, n in zip(best, counts, strict=True))


def _pools(quick: bool) -> list[str]:
    cores = os.cpu_count() or 1
    counts = sorted({1, cores, *(2**e for e in range(8) if 2**e < cores)})
    lines = []
    for count in counts:
        command = [sys.executable, __file__, "--threads", *(["--quick"] if quick else [])]
        environment = {**os.environ, "RAYON_NUM_THREADS": str(count)}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        lines.append([str(count), *done.stdout.split()])
    num = 10**5 if quick else 10**7
    heads = [
        "threads",
        f"three outputs, {report.size(num)} angles",
        "the same with `tolerance=0`",
        f"peak of `angle_error` over 720 angles, {report.size(num // 1000)} drivelines",
    ]
    return ["## Threads (`RAYON_NUM_THREADS`, ns per angle)", "", *table(heads, lines)]


if __name__ == "__main__":
    main()
