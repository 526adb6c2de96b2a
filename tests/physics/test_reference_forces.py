"""Forces of the core against those of the slow reference, and the reference against statics."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from cardan import Driveline, Load, reference
from cardan.reference_forces import forces
from equilibrium import assignments
from equilibrium import forces as solved

ANGLES = np.linspace(-3.0, 4.0, 5)


def case(counts: tuple[int, ...]) -> tuple[Driveline, reference.Shafts, list[float], list]:  # type: ignore[type-arg]
    n = len(counts) - 1
    rng = np.random.default_rng(counts)
    bends, twists, phases = (rng.uniform(-1.0, 1.0, k) for k in (n, n - 1, n - 1))
    lengths = rng.uniform(0.3, 2.0, n + 1).tolist()
    bearings = [
        (shaft, lengths[shaft] * at)
        for shaft, count in enumerate(counts)
        for at in (0.25, 0.8)[:count]
    ]
    line = Driveline.from_bends(abs(bends), twists, phases).with_bearings(bearings, lengths)
    shafts = reference.from_bends(abs(bends).tolist(), twists.tolist(), phases.tolist())
    return line, shafts, lengths, bearings


@pytest.mark.parametrize(
    "counts", [c for n in (1, 2, 3, 4) for c in itertools.product(range(3), repeat=n + 1)]
)
def test_every_arrangement(counts: tuple[int, ...]) -> None:
    line, shafts, lengths, bearings = case(counts)
    load = {"drive_torque": 7.0, "speed": 5.0, "acceleration": 2.0}
    inertias = np.linspace(0.1, 0.5, len(counts)).tolist()
    ways = list(assignments(len(counts) - 1, counts))
    at = [reference.loads(shafts, a, inertias=inertias, **load) for a in ANGLES.tolist()]
    if len(ways) != 1:
        with pytest.raises(ValueError, match=r"bearings leave shaft \d with"):
            forces(shafts, at[0], lengths, bearings)
        return
    names = ("joint_force", "bearing_force")[: 2 if bearings else 1]
    got = line.evaluate(ANGLES, names, load=Load(**load, inertias=inertias))
    for k, loads in enumerate(at):
        want = forces(shafts, loads, lengths, bearings)
        scale = max(map(math.hypot, *zip(*want.joint_force, *want.bearing_force, strict=True)))
        np.testing.assert_allclose(got.joint_force[:, k], want.joint_force, atol=1e-12 * scale)
        if bearings:
            np.testing.assert_allclose(
                got.bearing_force[:, k], want.bearing_force, atol=1e-12 * scale
            )
        # The reference itself, against all shafts solved as one system.
        of_bearings, of_joints = solved(
            np.array(shafts.directions),
            np.array(lengths),
            np.array(loads.moment),
            bearings,
            ways[0],
        )
        np.testing.assert_allclose(want.joint_force, of_joints, atol=1e-10 * scale)
        if bearings:
            np.testing.assert_allclose(want.bearing_force, of_bearings, atol=1e-10 * scale)


def test_what_statics_does_not_determine() -> None:
    _, shafts, lengths, bearings = case((2, 0, 2))
    loads = reference.loads(shafts, 0.3, drive_torque=1.0)
    with pytest.raises(ValueError, match="are 3 on shaft 0; forces are determinate with two"):
        forces(shafts, loads, lengths, [*bearings, (0, 0.1)])
    with pytest.raises(ValueError, match="lengths has 2 values; there are 3 shafts"):
        forces(shafts, loads, lengths[:2], bearings)
