"""Times calls of the installed cardan for ``pairwise.py``.

It prints what it runs with and the names of its cases as one line of JSON. Then it reads names of
cases line by line and answers each with the best time of a call in seconds. It keeps the last case
only, so that two workers fit in memory.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

import cardan
from cardan import Driveline, Load, Sweep

SAMPLE = 2e-3  # s: shorter calls are timed several at a time
SAMPLES = 4  # per round
ROUNDS = 4  # until a case is prepared anew, since it matters where its arrays happen to lie
WARM_UP = 0.02  # s

Call = Callable[[], object]

RANDOM = np.random.default_rng(1939)
ANGLES = RANDOM.uniform(-20.0, 20.0, 10**6)
ONE = Driveline.from_bends([0.5])
THREE = Driveline.from_bends([0.5, 0.2, 0.9], [0.3, -1.0], [0.7, 0.2])
TORQUE = Load(drive_torque=7.0)
TURNING: dict[str, Any] = {"drive_torque": 7.0, "speed": 30.0, "acceleration": 2.0}
INERTIAS = Load(inertias=[0.1, 0.4, 0.2, 0.3], **TURNING)
MOTION = ("angle", "speed_ratio", "acceleration_ratio")

# Name of the case: driveline, outputs, settings.
JOBS: dict[str, tuple[Driveline, Iterable[str], dict[str, Any]]] = {
    "angle": (ONE, MOTION[:1], {}),
    "speed_ratio": (ONE, MOTION[1:2], {}),
    "angle+ratio": (ONE, MOTION[:2], {}),
    "angle+ratio+acceleration": (ONE, MOTION, {}),
    "chain of three": (THREE, MOTION[:2], {}),
    "moment": (ONE, ["moment"], {"load": TORQUE}),
    "support_moment": (THREE, ["support_moment"], {"load": TORQUE, "shafts": 1}),
    "torque with inertias": (THREE, ["torque"], {"load": INERTIAS}),
    "tilt": (ONE, ["tilt_driving", "tilt_driven"], {"joints": 0}),
}
TIERS: dict[str, dict[str, Any]] = {
    "tolerance=0": {"tolerance": 0.0},
    "tolerance=1e-6": {"tolerance": 1e-6},
    "float32": {"dtype": "float32"},
}
SWEEPS = {
    "turns": Sweep.revolutions(1000, 720),
    "long sweep": Sweep(0.1, 4321.0, 720_000),
}


def cases() -> dict[str, Callable[[], Call]]:
    """Return by name what prepares a case and gives its call."""
    eight = ANGLES[:8].copy()
    found: dict[str, Callable[[], Call]] = {}
    for count in (1, 2, 3):
        found[f"plan, 8 angles, {count} outputs"] = lambda k=count: called(
            ONE.plan(MOTION[:k]), eight
        )
    found["plan, 8 angles, moment"] = lambda: called(ONE.plan("moment", load=TORQUE), eight)
    for name, (line, names, options) in JOBS.items():
        job = (line, tuple(names), options)
        found[f"evaluate, 8 angles, {name}"] = lambda j=job: (
            lambda: j[0].evaluate(eight, j[1], **j[2])
        )
    for label, count in (("10^4", 10**4), ("10^6", 10**6)):
        for name, (line, names, options) in JOBS.items():
            job = (line, tuple(names), options)
            found[f"{label} angles, {name}"] = lambda j=job, n=count: filled(*j, ANGLES[:n])
        for tier, settings in TIERS.items():
            job = (ONE, MOTION[:2], settings)
            found[f"{label} angles, {tier}"] = lambda j=job, n=count: filled(*j, ANGLES[:n])
    for label, sweep in SWEEPS.items():
        for name in ("angle+ratio", "angle+ratio+acceleration", "chain of three", "moment"):
            line, names, options = JOBS[name]
            job = (line, tuple(names), options)
            found[f"{label}, {name}"] = lambda j=job, s=sweep: filled(*j, s)
        for tier, settings in TIERS.items():
            job = (ONE, MOTION[:2], settings)
            found[f"{label}, {tier}"] = lambda j=job, s=sweep: filled(*j, s)
    return found | batches()


def batches() -> dict[str, Callable[[], Call]]:
    bends = RANDOM.uniform(0.0, 1.2, (10**5, 3))
    twists = RANDOM.uniform(-3.0, 3.0, (10**5, 2))
    steps = np.arange(5.0)[:, np.newaxis] * [1.0, 0.0, 0.0]
    points = RANDOM.uniform(-0.2, 0.2, (10**4, 5, 3)) + steps
    few, turn = slice(1000), np.linspace(0.0, 2.0 * np.pi, 720)

    def rows() -> Driveline:
        return Driveline.from_bends(bends[few, np.newaxis], twists[few, np.newaxis])

    def each(joints: int) -> Driveline:
        return Driveline.from_bends(bends[:, :joints], twists[:, : joints - 1])

    def chains() -> Driveline:
        return Driveline.from_bends(bends[few], twists[few])

    def peak(name: str, load: Load | None = None) -> Call:
        return called(rows().plan(name, reduce="peak", load=load, workers=1), turn)

    return {
        "batch x 720, peak of angle_error": lambda: peak("angle_error"),
        "batch x 720, peak of moment": lambda: peak("moment", TORQUE),
        "a bend per sample, one joint": lambda: filled(each(1), MOTION[:2], {}, ANGLES[: 10**5]),
        "a bend per sample, three joints": lambda: filled(each(3), MOTION[:2], {}, ANGLES[: 10**5]),
        "from_bends of a batch": lambda: chains,
        "from_points of a batch": lambda: lambda: Driveline.from_points(points),
        "optimal_phases of a batch": lambda: chains().optimal_phases,
        "equivalent": lambda: THREE.equivalent,
        "equivalent of a batch": lambda: chains().equivalent,
    }


def called(plan: Any, angle: Any) -> Call:
    return lambda: plan(angle)


def filled(line: Driveline, names: tuple[str, ...], options: dict[str, Any], angle: Any) -> Call:
    """Evaluate into existing arrays, without a copy."""
    plan = line.plan(names, workers=1, **options)
    out = {name: np.zeros_like(array, order="K") for name, array in plan(angle).items()}
    return lambda: plan(angle, out=out)


def elapsed(call: Call, times: int) -> float:
    """Return the seconds of one call, the mean of some."""
    start = time.perf_counter()
    for _ in range(times):
        call()
    return (time.perf_counter() - start) / times


def warmed_up(call: Call) -> int:
    """Return how many calls make a sample."""
    until, best = time.perf_counter() + WARM_UP, elapsed(call, 1)
    while time.perf_counter() < until:
        best = min(best, elapsed(call, 1))
    return max(1, round(SAMPLE / best))


def main() -> None:
    gc.disable()
    found = cases()
    about = f"cardan {cardan.__version__} of {cardan.__file__}"
    print(json.dumps({"about": about, "cases": list(found)}), flush=True)
    last, call, times, rounds = "", None, 0, 0
    for line in sys.stdin:
        name = line.strip()
        if name != last or rounds == ROUNDS:
            call = None  # frees its arrays before the next are made
            call = found[name]()
            last, times, rounds = name, warmed_up(call), 0
        rounds += 1
        print(min(elapsed(call, times) for _ in range(SAMPLES)), flush=True)


if __name__ == "__main__":
    main()
