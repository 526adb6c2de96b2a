"""What Python computes on top of the core, against models that share none of it.

``python tests/stress.py --rows 2000`` judges random drivelines: harmonics, the figures of
tolerances, and tolerances of one order. ``cardan-stress`` judges what the core computes. Exits with
1 if anything is beyond its limit in ``data/limits.toml``.

Every error of a harmonic is divided by the bound that is returned with it. The model of ideal
chains is the map ``w -> A w + B conj(w)``. Its angle error is the argument of
``1 + q exp(-2 i a)``, at samples in extended precision. The model of joints as built turns the
driven pin until it has its angle to the driving one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan import Driveline
from limits import limits
from oracle import Doubles

Complexes = NDArray[np.clongdouble]
LIMITS = limits("worst", "python")
PI = np.longdouble("3.14159265358979323846264338327950288")
ORDERS = np.arange(1, 9)
SAMPLES = 512


def q_of(bends: Any, twists: Any, phases: Any) -> Complexes:  # noqa: ANN401
    """Return ``B/A`` of chains whose joints are on the last axis."""
    bends, twists, phases = (np.asarray(x, np.longdouble) for x in (bends, twists, phases))
    a: Complexes = np.ones(bends.shape[:-1], np.clongdouble)
    b: Complexes = np.zeros_like(a)
    for j in range(bends.shape[-1]):
        if j > 0:
            # A quarter turn more than the phase less the twist; ``1j`` is exact.
            turn = np.exp(1j * (phases[..., j - 1] - twists[..., j - 1])) * 1j
            a, b = a * turn, b * turn
        k = np.tan(bends[..., j] / 2) ** 2
        a, b = a - k * np.conj(b), b - k * np.conj(a)
    return np.asarray(b / a, np.clongdouble)


def orders_of(error: Any) -> Any:  # noqa: ANN401
    """Return complex amplitudes of samples of a turn on the last axis."""
    turns = np.exp(-2j * PI * (np.outer(np.arange(SAMPLES), ORDERS) % SAMPLES) / SAMPLES)
    return 2.0 / SAMPLES * (error @ turns)


def drawn(random: np.random.Generator, rows: int) -> tuple[Doubles, Doubles, Doubles]:
    """Return bends to 40 deg, twists and phases of drivelines with as many joints."""
    joints = int(random.integers(1, 5))
    bends = random.uniform(0.0, 0.7, (rows, joints)) ** random.uniform(1.0, 4.0)
    twists, phases = random.uniform(-np.pi, np.pi, (2, rows, joints - 1))
    return bends, twists, phases


def harmonics(random: np.random.Generator, rows: int) -> tuple[int, float]:
    """Orders of the motion of ideal chains."""
    bends, twists, phases = drawn(random, rows)
    names = ("angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
    line = Driveline.from_bends(bends, twists, phases)
    found = line.harmonics(ORDERS, outputs=names)
    angles = 2 * PI * np.arange(SAMPLES) / SAMPLES
    q = q_of(bends, twists, phases)[:, np.newaxis]
    exact = orders_of(np.angle(1 + q * np.exp(-2j * angles)))
    worst = 0.0
    for derivative, name in enumerate(names):
        wanted = exact * (1j * ORDERS) ** derivative
        off = np.abs(found.complex_amplitude[name] - wanted)
        # What the samples of the model lose of each order.
        bound = found.error[name][:, np.newaxis] + 1e-19 * ORDERS**derivative
        worst = max(worst, float(np.max(off / bound)))
    return rows * len(ORDERS) * len(names), worst


def turned_pins(
    bends: Doubles, twists: Doubles, phases: Doubles, deviations: Doubles, angle: Doubles
) -> Doubles:
    """Return the sum of angle errors with its mean at angles, by Newton's method."""
    error: Doubles = np.zeros(angle.shape)
    for j in range(bends.shape[-1]):
        if j > 0:
            angle = angle + (phases[..., j - 1] - twists[..., j - 1])[..., np.newaxis] + np.pi / 2
        lean, skew, lean_driven = (deviations[..., j, i][..., np.newaxis] for i in range(3))
        bend = bends[..., j][..., np.newaxis]
        sine, cosine = np.sin(angle), np.cos(angle)
        # The driving pin along e_out, m and v.
        out = np.cos(lean) * cosine * np.cos(bend) - np.sin(lean) * np.sin(bend)
        normal = np.cos(lean) * sine
        along = np.cos(lean) * cosine * np.sin(bend) + np.sin(lean) * np.cos(bend)
        own = np.arctan2(
            2 * np.sin(bend / 2) ** 2 * sine * cosine, np.cos(bend) * cosine**2 + sine**2
        )
        for _ in range(20):
            s, c = np.sin(angle + own), np.cos(angle + own)
            level = np.cos(lean_driven)
            residual = level * (c * normal - s * out) + np.sin(lean_driven) * along - np.sin(skew)
            own = own + residual / (level * (c * out + s * normal))
        error = error + own
        angle = angle + own
    return error


def as_built_harmonics(random: np.random.Generator, rows: int) -> tuple[int, float]:
    """Orders of the angle error of drivelines of joints as built."""
    bends, twists, phases = drawn(random, rows)
    deviations = random.uniform(-0.03, 0.03, (*bends.shape, 3))
    line = Driveline.from_bends(bends, twists, phases)
    line = line.with_deviations(*np.moveaxis(deviations, -1, 0))
    found = line.harmonics(ORDERS, outputs="angle_error")
    angles = np.broadcast_to(2 * np.pi * np.arange(SAMPLES) / SAMPLES, (rows, SAMPLES))
    exact = orders_of(turned_pins(bends, twists, phases, deviations, angles))
    off = np.abs(found.complex_amplitude["angle_error"] - exact)
    bound = found.error["angle_error"][:, np.newaxis] + 1e-15
    return rows * len(ORDERS), float(np.max(off / bound))


def tolerances(random: np.random.Generator, rows: int) -> tuple[int, float]:
    """Figures of tolerances: no driveline exceeds the worst, which one has, nor any the bound."""
    bends, twists, phases = (array[0] for array in drawn(random, 1))
    line = Driveline.from_bends(bends, twists, phases)
    size = 10.0 ** random.uniform(-4.0, -1.5)
    given: dict[str, Any] = {"bends": size * random.uniform(0.1, 1.0, bends.shape)}
    if len(phases):
        given["phases"] = size * random.uniform(0.1, 3.0, phases.shape)
    found = line.tolerances(**given)
    count = 200 * rows

    def within(of: str, drawing: Doubles) -> Doubles:
        share = random.uniform(-1.0, 1.0, (count, *drawing.shape))
        # Half of them are corners.
        share[::2] = np.sign(share[::2])
        return np.asarray(drawing + share * given.get(of, 0.0))

    # A bend that changes its sign is a bend to the other side.
    q = q_of(within("bends", bends), twists, within("phases", phases))
    largest = float(np.max(2 * np.arctan(np.sqrt(np.abs(q)))))
    at = found.worst_at
    worst = q_of(bends + at["bends"], twists, phases + at.get("phases", 0.0))
    own = float(2 * np.arctan(np.sqrt(np.abs(worst))))
    beyond = max(largest - found.worst, own - found.guaranteed, abs(own - found.worst))
    return count, max(0.0, beyond)


def order_tolerances(random: np.random.Generator, rows: int) -> tuple[int, float]:
    """Contributions of deviations to an order, against differences of joints as built."""
    del rows
    bends, twists, phases = (array[0] for array in drawn(random, 1))
    line = Driveline.from_bends(bends, twists, phases)
    halves = random.uniform(1e-4, 1e-2, (len(bends), 3))
    order = int(random.integers(1, 5))
    found = line.order_tolerances(*halves.T, order=order)
    angles = 2 * np.pi * np.arange(SAMPLES) / SAMPLES

    def amplitude(deviations: Doubles) -> complex:
        each = turned_pins(bends, twists, phases, deviations, angles)
        return complex(orders_of(each)[order - 1])

    worst: float = abs(abs(amplitude(found.worst_deviations)) - found.worst)
    for place in np.ndindex(halves.shape):
        step = np.zeros(halves.shape)
        step[place] = 1e-3
        near, far = (amplitude(x * step) - amplitude(-x * step) for x in (1.0, 2.0))
        slope = (8.0 * near - far) / 12e-3
        worst = max(worst, float(abs(found.contributions[place] - slope * halves[place])))
    return halves.size + 1, worst


SURFACES: dict[str, Callable[[np.random.Generator, int], tuple[int, float]]] = {
    "harmonics": harmonics,
    "harmonics as built": as_built_harmonics,
    "tolerances": tolerances,
    "order tolerances": order_tolerances,
}


def stress(rows: int, rounds: int, seed: int) -> dict[str, tuple[int, float]]:
    """Return the number of results and the worst error of each surface."""
    found = {}
    for name, judge in SURFACES.items():
        random = np.random.default_rng([seed, len(name)])
        each = [judge(random, rows) for _ in range(rounds)]
        found[name] = (sum(count for count, _ in each), max(worst for _, worst in each))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=200, help="drivelines of a round")
    parser.add_argument("--rounds", type=int, default=10, help="rounds of each surface")
    parser.add_argument("--seed", type=int, default=1, help="another run")
    options = parser.parse_args()
    failed = False
    for name, (count, worst) in stress(options.rows, options.rounds, options.seed).items():
        print(f"{name:20} {worst:.2e} of {LIMITS[name]:g} in {count} results")
        failed |= not worst <= LIMITS[name]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
