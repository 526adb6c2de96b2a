"""Load: mixed calls from several threads in one process, for as long as wanted.

    python tests/load.py --minutes 60

Every call's bits are compared with those of the first call of its kind. The process's memory is
read every few seconds; after a first third for caches and pools to fill, it must not grow. The
exit status is 1 if a bit differs, a call fails or memory grows by more than 3 % and by more than
one of the largest arrays for each thread, which the allocator may keep.
"""

from __future__ import annotations

import argparse
import hashlib
import resource
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from cardan import (
    Coupling,
    Driveline,
    ElasticBearing,
    LateralSystem,
    Load,
    Scene,
    Sweep,
    TorqueHarmonic,
    TorsionalSystem,
    identify,
    optimise,
    tube,
)

THREADS = 4
GROWTH = 0.03
"""What memory may grow by from the second third to the last: what is in use differs."""

SCENE = """
[driveline]
bends_deg = [5, 4, 3]
[load]
output_torque_Nm = 100
[output]
quantities = ["angle_error", "torque", "support_moment"]
"""

RATING = 900.0
"""Torque in N m that a joint carries for 5000 h."""


def jobs() -> dict[str, Callable[[], Any]]:
    """Return calls of every kind, each of some milliseconds at most."""
    random = np.random.default_rng(1920)
    angle = random.uniform(-9.0, 9.0, 150_000)
    small = angle[:720]
    chain = Driveline.from_bends([0.5, 0.0, 0.9], [0.3, -1.0], [0.7, 0.2])
    batch = Driveline.from_bends(random.uniform(0.0, 0.5, (500, 1, 2)), 0.1, 0.2)
    each = Driveline.from_bends(random.uniform(0.0, 0.5, (5000, 2)), 0.1, 0.2)
    load = Load(drive_torque=7.0, speed=30.0, inertias=[0.1, 0.2, 0.3, 0.4])
    plan = chain.plan(("angle", "moment"), load=load)
    points = random.normal(size=(200, 4, 3)) * 0.1 + np.arange(4.0)[:, np.newaxis] * [1.0, 0, 0]
    turns = Sweep.revolutions(20, 720)
    torque = Load(drive_torque=7.0)
    mounted = Driveline.from_points(points[0]).with_bearings([(0, 0.4), (0, 0.9)])
    slopes = chain.plan(("speed_ratio", "moment"), load=load)
    shaft = Driveline.from_bends([0.3, 0.25], 0.1, 0.2)
    system = TorsionalSystem(
        shaft,
        inertias=[[0.0, 0.0], [0.0, 0.05], [0.02, 0.1]],
        stiffnesses=[np.inf, 8000.0, 5000.0],
        damping_ratios=0.02,
        load_torque=30.0,
    )
    engine = TorsionalSystem(
        Driveline.from_bends([0.1]),
        inertias=[[0.5, 0.02], [0.01, 0.1]],
        stiffnesses=[np.inf, 900.0],
        dampings=[0.0, 2.0],
        drive="free",
        load_torque=30.0,
        harmonics=[TorqueHarmonic(0, "input", order, 90.0 / order) for order in (0.5, 1.0, 2.0)],
        couplings={0: Coupling(3000.0, play=0.01)},
    )
    corners = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [3.0, 0.1, 0.0], [3.5, 0.1, 0.0]]
    swinging = LateralSystem(
        Driveline.from_points(corners),
        shafts=[tube(0.09, 0.003, length=1.5), tube(0.09, 0.003, length=1.5), None],
        bearings=[ElasticBearing(0, at, 4e5, loss_factor=0.1) for at in (0.0, 1.3)],
    )
    as_built = shaft.with_deviations(driving_yoke=0.01, cross=[0.0, 0.02])
    forces = ("joint_force", "bearing_force")
    leaning = mounted.with_deviations(cross=0.01)
    pulled = leaning.plan(forces, load=torque)
    orders = shaft.plan(("speed_ratio", "moment"), load=torque)
    recorded = small + 0.02 * np.sin(2.0 * small)
    steps = Load(output_torque=[400.0, 700.0], speed_rpm=[1500.0, 900.0])

    def filled() -> Any:  # noqa: ANN401
        out = np.empty((3, angle.size))[1]
        return chain.evaluate(angle, "speed_ratio", out={"speed_ratio": out})

    def derived() -> Any:  # noqa: ANN401
        found = slopes.derivatives(small, ("bends", "phases", "drive_torque"))
        return {f"{name} {by}": found[name][by] for name in found for by in found[name]}

    def weighted() -> Any:  # noqa: ANN401
        found = slopes.gradient(angle[:5000], {"speed_ratio": 1.0, "moment": 0.5})
        return {name: getattr(found, name) for name in ("value", "bends", "twists", "inertias")}

    def pulling() -> Any:  # noqa: ANN401
        found = pulled.gradient(small, {"bearing_force": 1.0})
        return {name: getattr(found, name) for name in ("value", "deviations", "lengths")}

    def deviating() -> Any:  # noqa: ANN401
        found = shaft.order_tolerances(driving_yoke=0.001, cross=0.002)
        lash = as_built.lash(small, 0.05, 40.0)
        return {"worst": found.worst_deviations, "shares": found.shares, "lash": lash}

    def toleranced() -> Any:  # noqa: ANN401
        found = shaft.tolerances(phases=0.02, bends=0.01, samples=2000, seed=3)
        return {"worst": found.worst, "quantile": found.quantile([0.5, 0.99])}

    def vibrating() -> Any:  # noqa: ANN401
        found = system.steady([40.0, 150.0])
        stability = system.stability(150.0)
        return {"orders": found.torque_orders, "multipliers": stability.multipliers}

    def rattling() -> Any:  # noqa: ANN401
        return {"orders": engine.steady([90.0, 140.0]).torque_orders}

    def shaking() -> Any:  # noqa: ANN401
        found = swinging.response(np.linspace(20.0, 400.0, 100), torque)
        return {"force": found.bearing_force, "frequency": swinging.natural_frequencies(3)}

    def lasting() -> Any:  # noqa: ANN401
        found = shaft.reshape(1).life(steps, rating=RATING, shares=[0.7, 0.3])
        return {"hours": found.hours, "each": found.mean_hours}

    def analysed() -> Any:  # noqa: ANN401
        found = orders.harmonics(8)
        return {name: found.amplitude[name] for name in ("speed_ratio", "moment")}

    def identified() -> Any:  # noqa: ANN401
        found = identify(small, angle=recorded)
        return {"bend": found.bend, "deviation": found.std}

    def optimised() -> Any:  # noqa: ANN401
        best = optimise(
            lambda x: Driveline.from_bends([[0.3, 0.25], [0.31, 0.2]], 0.1, x[:1]),
            [0.7],
            phases=[0],
            starts=1,
        )
        return {"x": best.x, "value": best.value}

    def refused() -> Any:  # noqa: ANN401
        try:
            chain.evaluate(angle, "speed_ratio", out={"speed_ratio": np.empty(3)})
        except ValueError as error:
            return {"message": np.array(str(error))}
        raise AssertionError("it was not refused")

    return {
        "threaded": lambda: chain.evaluate(angle, ("angle", "acceleration_ratio")),
        "one thread": lambda: chain.evaluate(angle[:40_000], workers=1),
        "faithful": lambda: chain.evaluate(angle[:20_000], tolerance=0),
        "single": lambda: chain.evaluate(angle, dtype=np.float32),
        "plan": lambda: plan(small),
        "vectors": lambda: plan(angle[:20_000]),
        "batch": lambda: batch.evaluate(small, "angle_error"),
        "per sample": lambda: each.evaluate(angle[:5000], ("angle", "speed_ratio")),
        "reduced": lambda: batch.evaluate(turns, ("angle_error", "speed_ratio"), reduce="rms"),
        "sweep": lambda: chain.evaluate(turns, ("angle", "tilt_driven")),
        "filled": filled,
        "refused": refused,
        "made": lambda: {"bends": Driveline.from_points(points).bends},
        "phases": lambda: {"phases": batch.optimal_phases()},
        "equivalent": lambda: {"k": each.equivalent().k},
        "scene": lambda: Scene.parse(SCENE).run().values,
        "forces": lambda: mounted.evaluate(small, forces, load=torque),
        "forces as built": lambda: leaning.evaluate(small, forces, load=torque),
        "gradient of forces": pulling,
        "deviations": deviating,
        "derivatives": derived,
        "gradient": weighted,
        "tolerances": toleranced,
        "torsion": vibrating,
        "engine with play": rattling,
        "lateral": shaking,
        "life": lasting,
        "as built": lambda: as_built.evaluate(angle[:20_000], ("angle", "moment"), load=torque),
        "harmonics": analysed,
        "identified": identified,
        "optimum": optimised,
    }


def largest(result: Any) -> int:  # noqa: ANN401
    """Return the bytes of a result's largest array."""
    return max(np.asarray(result[name]).nbytes for name in result)


def digest(result: Any) -> bytes:  # noqa: ANN401
    """Return a fingerprint of all bits of a result."""
    sums = hashlib.blake2b()
    for name in result:
        sums.update(np.ascontiguousarray(result[name]).tobytes())
    return sums.digest()


def memory() -> int:
    """Return the process's memory in bytes: now, where the system says it, else its largest."""
    status = Path("/proc/self/statm")
    if status.exists():
        return int(status.read_text().split()[1]) * resource.getpagesize()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def main() -> int:
    """Run; print the record; return the exit status."""
    parser = argparse.ArgumentParser(description="mixed calls from several threads")
    parser.add_argument("--minutes", type=float, default=0.4)
    parser.add_argument("--threads", type=int, default=THREADS)
    options = parser.parse_args()
    calls = jobs()
    want = {name: digest(call()) for name, call in calls.items()}
    kept = options.threads * max(largest(call()) for call in calls.values())
    end = time.monotonic() + 60.0 * options.minutes
    counts: list[Counter[str]] = [Counter() for _ in range(options.threads)]
    wrong: list[str] = []

    def work(number: int) -> None:
        random = np.random.default_rng(number)
        names = list(calls)
        while time.monotonic() < end and not wrong:
            name = names[random.integers(len(names))]
            try:
                if digest(calls[name]()) != want[name]:
                    wrong.append(f"{name}: other bits")
            except Exception as error:
                wrong.append(f"{name}: {error!r}")
                raise
            counts[number][name] += 1

    threads = [threading.Thread(target=work, args=(i,)) for i in range(options.threads)]
    for thread in threads:
        thread.start()
    seen = []
    while any(thread.is_alive() for thread in threads):
        time.sleep(min(5.0, 60.0 * options.minutes / 60))
        seen.append(memory())
    total = sum(counts, Counter())
    third = len(seen) // 3
    before, after = median(seen[third : 2 * third]), median(seen[2 * third :])
    grown = after / before - 1.0
    print(f"{options.minutes:g} min, {options.threads} threads, {total.total()} calls")
    print(", ".join(f"{name} {total[name]}" for name in calls))
    print(f"memory: {before / 2**20:.1f} MiB in the second third, {after / 2**20:.1f} in the last")
    if grown > GROWTH and after - before > kept:
        wrong.append(f"memory grew by {grown:.1%}")
    print("\n".join(wrong) or "no other bits, no failure, no growth")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
