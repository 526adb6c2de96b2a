"""Orbits that are found only from the straight driveline, along which the bends grow."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cardan
from cardan import reference
from cardan.reference import torsion


def bent(seed: int, which: int) -> tuple[cardan.TorsionalSystem, float]:
    """Two to five joints of up to 65 degrees with one to three compliant shafts, and a speed."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 6))
    bends = random.uniform(5.0, 65.0, n)
    twists, phases = random.uniform(-180.0, 180.0, n - 1), random.uniform(-90.0, 90.0, n - 1)
    count = int(random.integers(1, min(3, n + 1) + 1))
    compliant = sorted(random.choice(n + 1, count, replace=False))
    stiffnesses = np.full(n + 1, math.inf)
    stiffnesses[compliant] = 10 ** random.uniform(3.0, 5.0, count)
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends(bends, twists, phases, degrees=True),
        inertias=10 ** random.uniform(-3.0, -0.5, (n + 1, 2)),
        stiffnesses=stiffnesses,
        drive="held",
        damping_ratios=random.choice([0.02, 0.05, 0.1, 0.3]),
        load_torque=random.choice([0.0, 50.0, 200.0]),
        load_damping=random.choice([0.0, 0.2]),
    )
    shares = np.exp(random.uniform(math.log(0.2), math.log(12.0), 3))
    return system, float(shares[which] * system.natural_frequencies()[0])


# Newton's method alone finds none of them, nor do oscillations of up to 2 rad as a start.
SHORT = [(34, 1), (354, 0), (716, 1)]
LONG = [(112, 0), (217, 0), (476, 1), (509, 0), (563, 2), (901, 0), (953, 0)]


@pytest.mark.parametrize(
    ("seed", "which"), [*SHORT, *(pytest.param(*case, marks=pytest.mark.long) for case in LONG)]
)
def test_a_stable_orbit_is_found_and_brought_back_by_integration(seed: int, which: int) -> None:
    system, speed = bent(seed, which)
    found, orbit = system.stability(speed), system.orbit(speed, 1)
    assert found.found
    assert found.stable
    line = system.line
    slow = torsion.System(
        reference.from_bends(line.bends.tolist(), line.twists.tolist(), line.phases.tolist()),
        inertias=[(float(x), float(y)) for x, y in system.inertias],
        stiffnesses=system.stiffnesses.tolist(),
        dampings=system.dampings.tolist(),
        load_torque=float(system.load_torque),
        load_damping=float(system.load_damping),
    )
    ends = list(system.compliant)
    zeros = [torsion.zero_of(slow, i) for i in ends]
    angles, speeds = zeros + orbit.angle_error[ends, 1, 0], orbit.speed[ends, 1, 0]
    start = np.concatenate([[0.0], angles, [speed], speeds])
    steps = 160 if (seed, which) in SHORT else 2000
    known = torsion.orbit(slow, speed, start, steps=steps)
    scale = np.repeat([1.0, speed], len(ends) + 1)
    assert np.abs((known.state - start) / scale).max() < 1e-4
    assert np.abs(known.multipliers).max() == pytest.approx(np.abs(found.multipliers[0]), abs=1e-4)
    steady = system.steady(speed)
    largest = np.maximum(np.abs(steady.torque_min), np.abs(steady.torque_max))
    assert np.all(np.abs(known.motion.torque.max(axis=-1) - steady.torque_max) < 1e-3 * largest)


def test_a_curve_with_folds_is_followed_around_them() -> None:
    """In a resonance of little damping the shaft twists by more than four radians."""
    system, speed = bent(488, 0)
    assert system.steady(speed).torque_max > 4.0 * system.stiffnesses[system.compliant[0]]


@pytest.mark.long
def test_many_systems_have_an_orbit_at_every_speed() -> None:
    for seed in range(100):
        for which in range(3):
            system, speed = bent(seed, which)
            assert system.steady(speed).found, (seed, which)
