"""Forces of joints and bearings against the equilibrium of all shafts, solved as one system.

``tests/equilibrium.py`` has the equations, ``tests/vectors.py`` the exact moments of the joints.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import pytest

from cardan import Driveline, Load, Sweep, reference
from cardan.reference import forces as twin
from deviation_oracle import LeaningFrames
from equilibrium import BearingPlace, assignments, forces, solved, system
from oracle import LIMIT_TABLE, Doubles, Exact, ExactTurn, mp, read
from vectors import ExactLoads, Frames

ANGLES = np.linspace(-3.0, 4.0, 7)

Assignment: TypeAlias = tuple[int | None, ...]
"""Which shaft each joint supports."""


def driveline(rng: np.random.Generator, n: int, steepest: float = 1.0) -> Driveline:
    bends = rng.uniform(0.0, steepest, n)
    line = Driveline.from_bends(bends, *rng.uniform(-math.pi, math.pi, (2, n - 1)))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    spans = line.directions @ turn * rng.uniform(0.3, 2.0, (n + 1, 1))
    points = np.concatenate([rng.normal(size=(1, 3)), spans]).cumsum(axis=0)
    return Driveline.from_points(points, line.phases)


def mounted(
    rng: np.random.Generator, line: Driveline, counts: Sequence[int]
) -> tuple[Driveline, list[tuple[int, float]]]:
    """Return the driveline with so many bearings on each shaft, in any order."""
    bearings = [
        (shaft, line._geometry.lengths[shaft] * at)
        for shaft, count in enumerate(counts)
        for at in rng.permutation([0.2, 0.45, 0.85])[:count] + rng.uniform(-0.1, 0.1)
    ]
    rng.shuffle(bearings)
    return line.with_bearings(bearings), bearings


def load_of(rng: np.random.Generator, n: int) -> dict[str, Any]:
    end = ("drive_torque", "output_torque")[rng.integers(2)]
    return {
        end: float(rng.uniform(-9, 9)),
        "inertias": rng.uniform(0, 0.1, n + 1).tolist(),
        "speed": float(rng.uniform(1, 9)),
        "acceleration": float(rng.uniform(-3, 3)),
    }


@pytest.mark.parametrize(
    "counts", [c for n in (1, 2, 3) for c in itertools.product(range(4), repeat=n + 1)]
)
def test_every_arrangement(counts: tuple[int, ...]) -> None:
    """Forces are those of the equilibrium, or refused because there is not exactly one."""
    n = len(counts) - 1
    rng = np.random.default_rng(counts)
    line, bearings = mounted(rng, driveline(rng, n), counts)
    ways, given = list(assignments(n, counts)), load_of(rng, n)
    load = Load(**given)
    shafts = reference.from_directions(line.directions.tolist(), line.phases.tolist())
    lengths = line._geometry.lengths.tolist()
    at = [reference.loads(shafts, angle, **given) for angle in ANGLES.tolist()]
    names = ("moment", "joint_force", "bearing_force")[: 3 if bearings else 2]
    if len(ways) != 1:
        with pytest.raises(ValueError, match=r'outputs\[1\] is "joint_force"; .*(shaft|joint) \d'):
            line.evaluate(ANGLES, names, load=load)
        with pytest.raises(ValueError, match=r"bearings leave shaft \d with|are 3 on shaft"):
            twin.forces(shafts, at[0], lengths, bearings)
        return
    if max(counts) > 2:
        with pytest.raises(ValueError, match=r'"bearing_force"; shaft \d has 3 bearings'):
            line.evaluate(ANGLES, "bearing_force", load=load)
        got = line.evaluate(ANGLES, ("moment", "joint_force"), load=load)
        reduced = [b for b in bearings if counts[b[0]] < 3]
        rest = [shaft for shaft, count in enumerate(counts) if count > 2]
        # Two of the bearings, whichever they are, leave the joints the same forces.
        bearings = reduced + [b for shaft in rest for b in [*bearings_on(bearings, shaft)][:2]]
    else:
        got = line.evaluate(ANGLES, names, load=load)
    for sample in range(len(ANGLES)):
        of_bearings, of_joints = forces(
            line.directions, line._geometry.lengths, got.moment[:, sample], bearings, ways[0]
        )
        size = max(np.abs(of_joints).max(), np.abs(of_bearings).max(initial=0.0))
        np.testing.assert_allclose(got.joint_force[:, sample], of_joints, atol=1e-12 * size)
        if max(counts) > 2:
            continue
        own = twin.forces(shafts, at[sample], lengths, bearings)
        np.testing.assert_allclose(own.joint_force, of_joints, atol=1e-10 * size)
        if bearings:
            np.testing.assert_allclose(got.bearing_force[:, sample], of_bearings, atol=1e-12 * size)
            np.testing.assert_allclose(own.bearing_force, of_bearings, atol=1e-10 * size)


def bearings_on(bearings: list[tuple[int, float]], shaft: int) -> list[tuple[int, float]]:
    return [bearing for bearing in bearings if bearing[0] == shaft]


def test_a_floating_shaft_passes_its_support_moment_on_as_a_pair() -> None:
    rng = np.random.default_rng(1)
    line = driveline(rng, 2)
    load = Load(drive_torque=100.0)
    got = line.evaluate(ANGLES, ("joint_force", "support_moment"), shafts=1, load=load)
    length = line._geometry.lengths[1]
    pair = np.cross(line.directions[1], got.support_moment) / length
    np.testing.assert_allclose(got.joint_force, [pair, pair], atol=1e-13 * np.abs(pair).max())


def test_two_bearings_by_hand() -> None:
    """At 90° the cross bends the driving shaft by T tan 30°, in the plane across the bend plane."""
    line = Driveline.from_bends([30], degrees=True).with_bearings([(0, 0.1), (0, 0.3)], [0.4, 1.0])
    got = line.evaluate([0.0, math.pi / 2], "bearing_force", load=Load(drive_torque=100.0))
    force = 100.0 * math.tan(math.radians(30)) / 0.2
    want = [[[0.0, 0.0, 0.0], [0.0, 0.0, force]], [[0.0, 0.0, 0.0], [0.0, 0.0, -force]]]
    np.testing.assert_allclose(got.bearing_force, want, atol=1e-12 * force)


TRUCK = (2, 1, 0, 2)
"""Gearbox, a shaft with a centre bearing, a floating shaft, axle."""


def test_bearings_of_a_batch_move_with_it() -> None:
    rng = np.random.default_rng(3)
    lines = [driveline(rng, 3) for _ in range(4)]
    batch = Driveline.concatenate(lines).reshape(2, 2)
    lengths = batch._geometry.lengths
    at = lengths[..., 1] * np.array([0.6, 0.9])
    places = [(1, at), (0, 0.1 * lengths[..., 0]), (0, 0.9 * lengths[..., 0])]
    places += [(3, 0.5 * lengths[..., 3]), (3, 0.25 * lengths[..., 3])]
    load = Load(drive_torque=[[3.0], [4.0]], speed=2.0, inertias=[0.1, 0.2, 0.3, 0.4])
    names = ("joint_force", "bearing_force", "moment")
    together = batch.with_bearings(places)[..., None].evaluate(
        ANGLES, names, load=Load(**{**vars_of(load), "drive_torque": [[[3.0]], [[4.0]]]})
    )
    for i, j in np.ndindex(2, 2):
        own = [(shaft, position[i, j]) for shaft, position in places]
        (way,) = assignments(3, TRUCK)
        for sample in range(len(ANGLES)):
            of_bearings, of_joints = forces(
                batch.directions[i, j], lengths[i, j], together.moment[:, i, j, sample], own, way
            )
            size = np.abs(of_bearings).max()
            found = together.bearing_force[:, i, j, sample]
            np.testing.assert_allclose(found, of_bearings, atol=1e-12 * size)
            found = together.joint_force[:, i, j, sample]
            np.testing.assert_allclose(found, of_joints, atol=1e-12 * size)


def vars_of(load: Load) -> dict[str, Any]:
    return {"speed": load.speed, "inertias": load.inertias}


# --- accuracy ----------------------------------------------------------------------------------

LIMITS = LIMIT_TABLE["force"]


def frames_of(line: Driveline) -> Frames:
    return LeaningFrames.of(line) if line.has_deviations else Frames.of(line)


def exact(
    line: Driveline,
    frames: Frames,
    loads: ExactLoads,
    bearings: Sequence[BearingPlace],
    way: Assignment,
) -> dict[str, list[list[Any]]]:
    lengths = [mp.mpf(x) for x in line._geometry.lengths.tolist()]
    places = [(shaft, mp.mpf(at)) for shaft, at in bearings]
    rows, right = system(frames.directions, lengths, loads.moment, places, way)
    found = solved(rows, right)
    both = [found[i : i + 3] for i in range(0, len(found), 3)]
    return {"bearing_force": both[: len(bearings)], "joint_force": both[len(bearings) :]}


def shortest_span(line: Driveline, bearings: Sequence[BearingPlace], way: Assignment) -> float:
    """Return the smallest distance between the two supports of a shaft."""
    places: list[list[float]] = [[] for _ in range(line.n_joints + 1)]
    for shaft, position in bearings:
        places[shaft].append(position)
    for joint, held in enumerate(way):
        if held is not None:
            places[held].append(line._geometry.lengths[held] if held == joint else 0.0)
    return min(abs(b - a) for a, b in (pair for pair in places if len(pair) == 2))


def errors(
    line: Driveline,
    bearings: Sequence[BearingPlace],
    way: Assignment,
    angles: list[float],
    load: dict[str, Any],
    tolerance: float | None,
) -> dict[str, float]:
    """Return the largest errors, of a vector in ulp of its largest component.

    With the default the terms of a force may cancel: the unit is the ulp of the largest force, or
    of the largest moment of the joints over the smallest distance between the supports of a shaft
    if that is larger.
    """
    names = ("joint_force", "bearing_force") if bearings else ("joint_force",)
    got = line.evaluate(angles, names, load=Load(**load), tolerance=tolerance)
    frames, span = frames_of(line), mp.mpf(shortest_span(line, bearings, way))
    worst = dict.fromkeys(names, 0.0)
    for sample, angle in enumerate(angles):
        loads = ExactLoads.of(frames, ExactTurn.by(angle), **load)
        wanted = exact(line, frames, loads, bearings, way)
        vectors = {
            name: [Exact.of(x if abs(x) > 1e-40 else mp.mpf(0) for x in v) for v in wanted[name]]
            for name in names
        }
        largest = max(abs(x) for moment in loads.moment for x in moment) / span
        largest = max(largest, *(abs(x) for of in wanted.values() for v in of for x in v))
        largest = Exact.of([largest]).ulp[0]
        for name in names:
            for found, v in zip(got[name][:, sample], vectors[name], strict=True):
                unit = v.ulp[np.abs(v.high).argmax()] if tolerance == 0 else largest
                worst[name] = max(worst[name], float(v.distance(found).max() / unit))
    return worst


def judged(tier: str, rng: np.random.Generator, counts: Sequence[int], steepest: float) -> Doubles:
    n = len(counts) - 1
    line, bearings = mounted(rng, driveline(rng, n, steepest), counts)
    (way,) = assignments(n, counts)
    load = load_of(rng, n)
    if rng.random() < 0.6:
        load = {name: load[name] for name in load if "torque" in name}
    tolerance = 0 if tier == "tolerance_0" else None
    found = errors(line, bearings, way, rng.uniform(-4, 4, 3).tolist(), load, tolerance)
    return np.array([found["joint_force"], found.get("bearing_force", 0.0)])


KINDS = {
    "floating": ((0, 0, 0), 1.0),
    "own": ((2, 2, 2), 1.0),
    "truck": (TRUCK, 1.0),
    "one each": ((1, 2, 1), 1.0),
    "chain": ((2, 1, 1, 0, 0), 1.0),
    "steep": (TRUCK, 1.45),
}


@pytest.mark.parametrize("tier", ["tolerance_0", "default"])
@pytest.mark.parametrize("kind", KINDS)
def test_errors_in_ulp(kind: str, tier: str) -> None:
    counts, steepest = KINDS[kind]
    rng = np.random.default_rng([len(kind), len(counts)])
    worst = np.max([judged(tier, rng, counts, steepest) for _ in range(12)], axis=0)
    limits = [LIMITS[name][tier] for name in ("joint_force", "bearing_force")]
    assert np.all(worst <= limits), f"{kind}, {tier}: {worst} ulp"


# --- the worst that cardan-stress found ---------------------------------------------------------

WORST = read("worst_forces.json")["cases"]


@pytest.mark.parametrize("case", WORST, ids=lambda case: f"{case['tolerance']} {case['output']}")
def test_the_worst_forces_keep_their_limits(case: dict[str, Any]) -> None:
    """Forces of several shafts nearly cancel at this drive angle: over the turn they are larger."""
    line = Driveline.from_bends(case["bends"], case["twists"], case["phases"])
    bearings = list(zip(case["bearings"], case["positions"], strict=True))
    line = line.with_bearings(bearings, case["lengths"])
    way, tolerance, name = case["supported"], case["tolerance"], case["output"]
    off = errors(line, bearings, way, [case["angle"]], case["load"], tolerance)[name]
    limit = LIMITS[name]["worst"] if tolerance is None else LIMITS[name]["single"] * 2.0**53
    assert off <= limit
    over_the_turn = line.evaluate(
        Sweep.revolutions(1, 720), name, load=Load(**case["load"]), tolerance=0
    )
    at = line.evaluate(case["angle"], name, load=Load(**case["load"]), tolerance=0)
    assert np.max(np.abs(over_the_turn[name])) > 3.0 * np.max(np.abs(at[name]))


def test_what_statics_does_not_determine_of_the_reference() -> None:
    shafts = reference.from_bends([0.3, 0.4])
    loads = reference.loads(shafts, 0.3, drive_torque=1.0)
    bearings = [(0, 0.1), (0, 0.2), (2, 0.1), (2, 0.2)]
    with pytest.raises(ValueError, match="are 3 on shaft 0; forces are determinate with two"):
        twin.forces(shafts, loads, [1.0, 1.0, 1.0], [*bearings, (0, 0.3)])
    with pytest.raises(ValueError, match="lengths has 2 values; there are 3 shafts"):
        twin.forces(shafts, loads, [1.0, 1.0], bearings)
