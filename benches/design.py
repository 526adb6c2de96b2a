"""Time toleranced drivelines and the search for the best layout.

``python benches/design.py [--quick]`` prints a table: a million random drivelines of three joints
whose points have tolerances, with quantiles and the share within the limit, by number of threads;
the memory that they take beyond 8 bytes per driveline; and the layout of the same driveline over
nine ride heights. All figures are from one run, in which the calls take turns; the shortest time of
each counts.
"""

from __future__ import annotations

import argparse
import tracemalloc
from functools import partial

import numpy as np

import cardan
from shortest import digits, shortest, table

POINTS = np.array(
    [[0, 0, 0], [0.35, -0.02, 0], [1.65, -0.06, 0.01], [3.15, -0.18, 0], [3.45, -0.19, 0]]
)
PHASES = [10.0, 20.0]
HEIGHTS = np.linspace(-0.08, 0.08, 9)


def drawn(samples: int, workers: int) -> cardan.Tolerances:
    """Quantiles and passing share of toleranced drivelines."""
    line = cardan.Driveline.from_points(POINTS, PHASES, degrees=True)
    found = line.tolerances(points=1e-3, seed=1, samples=samples, workers=workers)
    found.quantile([0.5, 0.95, 0.99])
    _ = found.passing
    return found


def lines_of(x: np.ndarray) -> cardan.Driveline:
    """Return the driveline at each ride height: height of the centre bearing, then phases."""
    points = np.repeat(POINTS[np.newaxis], len(HEIGHTS), axis=0)
    points[:, 2, 1] = x[0]
    points[:, 3:, 1] += HEIGHTS[:, np.newaxis]
    return cardan.Driveline.from_points(points, x[1:])


def best() -> cardan.Optimum:
    """The least of the largest equivalent bends over the ride heights."""
    bounds = [(-0.1, -0.02), (-np.inf, np.inf), (-np.inf, np.inf)]
    variables = [("points", (2, 1)), ("phases", 0), ("phases", 1)]
    start = [-0.06, *np.radians(PHASES)]
    return cardan.optimise(lines_of, start, bounds, parameters=variables, phases=[1, 2])


def memory(samples: int) -> float:
    """Largest memory of a run with two threads, in MB, beyond 8 bytes per driveline."""
    tracemalloc.start()
    try:
        drawn(samples, 2)
        return (tracemalloc.get_traced_memory()[1] - 8 * samples) / 1e6
    finally:
        tracemalloc.stop()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a hundredth of the work")
    quick = parser.parse_args().quick
    samples, duration = (10_000, 0.05) if quick else (1_000_000, 3.0)
    calls = [partial(drawn, samples, 1), partial(drawn, samples, 2), best]
    one, two, layout = shortest(calls, duration)
    found = best()
    bends = [f"{np.degrees(bend):.4f}" for bend in (found.before, found.value)]
    rows = [
        (f"{samples} toleranced drivelines, one thread", f"{digits(one)} s"),
        (f"{samples} toleranced drivelines, two threads", f"{digits(two)} s"),
        (f"memory of {samples} beyond 8 bytes each", f"{digits(memory(samples))} MB"),
        (f"memory of {4 * samples} beyond 8 bytes each", f"{digits(memory(4 * samples))} MB"),
        (f"layout over nine ride heights, {bends[0]} to {bends[1]} deg", f"{digits(layout)} s"),
    ]
    print("\n".join(table(("work", "taken"), rows)))


if __name__ == "__main__":
    main()
