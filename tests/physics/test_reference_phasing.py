"""Equivalent joint, transmission and best phases of the core against the turning yokes.

Tolerances follow from the reference's own errors. A rounding ``EPS`` of a pin is stretched by the
joints, up to ``1/c`` for angles, ``c`` being the product of the cosines of the bends; each
derivative stretches it once more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike

from cardan import Driveline, reference
from cardan.arrays import FloatArray
from cardan.reference import phasing as slow
from tiers import part

EPS = 2.0**-52

# Joints, and the least and the largest bend in degrees. Four steep joints have c = 1e-5 and less,
# which leaves accelerations no digits.
CHAINS = [*((n, 1.0, 45.0) for n in (1, 2, 3, 4, 5)), *((n, 70.0, 88.0) for n in (1, 2, 3))]

chains = pytest.mark.parametrize(("joints", "least", "most"), CHAINS)


def pair(
    bends: FloatArray, twists: FloatArray, phases: FloatArray
) -> tuple[Driveline, reference.Shafts]:
    shafts = reference.from_bends(bends.tolist(), twists.tolist(), phases.tolist())
    return Driveline.from_bends(bends, twists, phases), shafts


def drivelines(
    count: int, joints: int, least: float = 1.0, most: float = 45.0, seed: int = 0
) -> Iterator[tuple[Driveline, reference.Shafts]]:
    """Random drivelines with bends in degrees between two limits."""
    rng = np.random.default_rng([seed, joints, int(most)])
    for _ in range(count):
        bends = np.radians(rng.uniform(least, most, joints))
        yield pair(bends, *rng.uniform(-3.0, 3.0, (2, joints - 1)))


def turn(phases: ArrayLike, others: ArrayLike) -> float:
    """By how much yokes turn from one setting to another, each the same after half a turn."""
    off = np.subtract(phases, others)
    return float(np.linalg.norm(off - np.pi * np.round(off / np.pi)))


# --- the equivalent joint and q ------------------------------------------------------------------


@chains
def test_equivalent_joint(joints: int, least: float, most: float) -> None:
    for line, shafts in drivelines(part(8), joints, least, most):
        for shaft in range(1, joints + 1):
            got, want = line.equivalent(shaft), slow.equivalent(shafts, shaft)
            c = float(np.prod(np.cos(line.bends[:shaft])))
            unit = 8 * shaft * EPS
            assert abs(got.k - want.k) <= unit / c
            assert abs(got.max_angle_error - want.max_angle_error) <= unit / c
            assert abs(got.min_speed_ratio - want.min_speed_ratio) <= unit / c**2
            assert abs(got.max_speed_ratio - want.max_speed_ratio) <= unit / c**2
            assert abs(got.non_uniformity - want.non_uniformity) <= unit / c**2
            assert abs(got.max_acceleration_ratio - want.max_acceleration_ratio) <= unit / c**3
            # The spread of the speed is the square of the bend where that is small.
            assert abs(got.bend - want.bend) <= unit / c**2 / want.bend
            # A place is known as well as the acceleration over its slope there, 2 k at least.
            place = unit / c**3 / want.k
            assert turn(got.angle_offset, want.angle_offset) <= place
            assert turn(got.max_angle_error_at, want.max_angle_error_at) <= place


@pytest.mark.parametrize("joints", [2, 3, 4, 5])
def test_a_chain_turns_as_its_equivalent_joint_all_the_way(joints: int) -> None:
    """What the searches of the reference rest on, and that they found it, without the core."""
    for _, shafts in drivelines(part(8), joints):
        found = slow.equivalent(shafts)
        one = reference.from_bends([found.bend])
        c = math.prod(map(math.cos, shafts.bends))
        offset = reference.mean_offset(shafts)
        for angle in np.linspace(-1.0, 5.0, 60).tolist():
            chain = reference.motion(shafts, angle, offset=offset)
            joint = reference.motion(one, angle + found.angle_offset, offset=0.0)
            close = 16 * joints * EPS / c**4 / found.bend
            assert abs(chain.angle_error - joint.angle_error) <= close
            assert abs(chain.speed_ratio - joint.speed_ratio) <= close


@chains
def test_q(joints: int, least: float, most: float) -> None:
    for line, shafts in drivelines(part(8), joints, least, most, seed=1):
        c = float(np.prod(np.cos(line.bends)))
        q = slow.transmission(shafts).q
        assert abs(line.transmission().q - q) <= 8 * joints * EPS / c
        # Its size is the sine of the largest error, found without any sum.
        assert abs(abs(q) - slow.equivalent(shafts).k) <= 8 * joints * EPS / c


@pytest.mark.parametrize(("least", "most", "count"), [(5.0, 45.0, 4), (70.0, 80.0, 4)])
def test_motion_and_gradient_by_q(least: float, most: float, count: int) -> None:
    for line, shafts in drivelines(part(count), 2, least, most, seed=2):
        got, want = line.transmission(), slow.transmission(shafts)
        stretch = 2.0 / (1.0 - abs(want.q))
        for angle in (-0.7, 2.0):
            motion, there = got.motion(angle), want.motion(angle)
            chain = reference.motion(shafts, angle)
            for power, name in enumerate(motion._fields, 1):
                close = 64 * EPS * stretch**power / math.prod(map(math.cos, shafts.bends))
                assert abs(getattr(motion, name) - getattr(there, name)) <= close, name
                assert abs(getattr(chain, name) - getattr(there, name)) <= close, name
            slopes = zip(got.gradient(angle), want.gradient(angle), strict=True)
            for power, (slope, difference) in enumerate(slopes, 1):
                assert abs(slope - difference) <= 1e-10 * stretch**power, power


def test_derivatives_of_q() -> None:
    for line, shafts in drivelines(part(8), 3, 5.0, 60.0, seed=3):
        bends, twists, phases = (x.tolist() for x in (line.bends, line.twists, line.phases))
        of = {
            "bends": (lambda x, t=twists, p=phases: reference.from_bends(x, t, p), bends),
            "twists": (lambda x, b=bends, p=phases: reference.from_bends(b, x, p), twists),
            "phases": (lambda x, b=bends, t=twists: reference.from_bends(b, t, x), phases),
        }
        close = 1e-10 / math.prod(map(math.cos, shafts.bends))
        for by, (laid_out, at) in of.items():
            got = line.transmission().dq(by)  # type: ignore[arg-type]
            np.testing.assert_allclose(got, slow.dq(laid_out, at), rtol=0.0, atol=close)


def test_derivatives_of_q_by_points() -> None:
    points = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.9, 0.3, 0.4], [2.9, 0.0, 0.2]]
    got = Driveline.from_points(points, [0.4]).transmission().dq("points")

    def laid_out(flat: list[float]) -> reference.Shafts:
        return reference.from_points([flat[i : i + 3] for i in range(0, 12, 3)], [0.4])

    flat = [x for point in points for x in point]
    np.testing.assert_allclose(got.ravel(), slow.dq(laid_out, flat), rtol=0.0, atol=1e-9)


# --- the best phases -----------------------------------------------------------------------------


# Beside its least the error grows with the square of a turn, so that its rounding leaves the turn
# some 1e-7. Where good settings lie beside one another, the weight of a turn leaves 1e-8 of it.
SAME_TURN = 3e-6


def mean_k(
    shafts: Sequence[reference.Shafts], phases: FloatArray, weights: Sequence[float]
) -> float:
    """The root of the weighted mean of ``k**2`` with a setting of the yokes."""
    set_to = [replace(state, phases=tuple(phases.tolist())) for state in shafts]
    squares = [slow.equivalent(state).k ** 2 for state in set_to]
    return math.sqrt(float(np.average(squares, weights=weights)))


def check_phases(line: Driveline, shafts: reference.Shafts, *, near: bool) -> None:
    """The core's setting is as good as the reference's, and the same."""
    best = line.optimal_phases()
    found = np.array(slow.optimal_phases(shafts, starts=[best.tolist()] if near else None))
    c = float(np.prod(np.cos(line.bends)))
    off = mean_k([shafts], best, [1.0]) - mean_k([shafts], found, [1.0])
    assert abs(off) <= 16 * line.n_joints * EPS / c
    assert turn(found, best) <= SAME_TURN


@pytest.mark.parametrize("joints", [2, 3])
@pytest.mark.parametrize(("least", "most", "count"), [(5.0, 45.0, 8), (70.0, 88.0, 8)])
def test_best_phases(joints: int, least: float, most: float, count: int) -> None:
    for line, shafts in drivelines(part(count), joints, least, most, seed=4):
        check_phases(line, shafts, near=False)


@pytest.mark.parametrize("joints", [4, 5])
def test_best_phases_of_many_joints_are_least_in_their_neighbourhood(joints: int) -> None:
    for line, shafts in drivelines(part(8), joints, 10.0, 45.0, seed=5):
        check_phases(line, shafts, near=True)


@pytest.mark.parametrize("joints", [4, pytest.param(5, marks=pytest.mark.long)])
def test_the_search_of_the_reference_finds_nothing_better_for_many_joints(joints: int) -> None:
    for line, shafts in drivelines(part(4), joints, 10.0, 45.0, seed=6):
        core, own = line.optimal_phases(), np.array(slow.optimal_phases(shafts))
        off = mean_k([shafts], core, [1.0]) - mean_k([shafts], own, [1.0])
        assert abs(off) <= 16 * joints * EPS / np.prod(np.cos(line.bends))


@pytest.mark.parametrize(
    ("bends", "twists"), [([20, 0, 20], [10, 20]), ([0, 20, 20], [5, 0]), ([30, 0], [40])]
)
def test_best_phases_beside_straight_joints(bends: list[float], twists: list[float]) -> None:
    # Shafts beside a straight joint share the turn; a straight end leaves its shaft alone.
    line, shafts = pair(np.radians(bends), np.radians(twists), np.full(len(twists), 0.2))
    check_phases(line, shafts, near=False)


@pytest.mark.parametrize("bends", [[0.3], [0.0, 0.0, 0.0]])
def test_nothing_to_set(bends: list[float]) -> None:
    shafts = reference.from_bends(bends, phases=[0.4] * (len(bends) - 1))
    assert slow.optimal_phases(shafts) == shafts.phases


@pytest.mark.parametrize(("joints", "count"), [(2, 4), (3, 4), (4, 4)])
def test_common_phases(joints: int, count: int) -> None:
    rng = np.random.default_rng(joints)
    for _ in range(part(count)):
        bends = rng.uniform(0.05, 0.6, (3, joints))
        twists = rng.uniform(-3.0, 3.0, joints - 1) + rng.uniform(-0.4, 0.4, (3, joints - 1))
        phases, weights = rng.uniform(-3.0, 3.0, joints - 1), rng.uniform(0.2, 1.0, 3).tolist()
        both = [pair(*state, phases) for state in zip(bends, twists, strict=True)]
        shafts = [own for _, own in both]
        lines = Driveline.concatenate([line.reshape(1) for line, _ in both])
        best = lines.optimal_phases(states=0, weights=weights)
        # With four joints each may find another of many local minima.
        starts = [best.tolist()] if joints > 3 else None
        found = np.array(slow.optimal_phases(shafts, weights, starts))
        off = mean_k(shafts, best, weights) - mean_k(shafts, found, weights)
        assert abs(off) <= 1e-13
        assert turn(found, best) <= SAME_TURN


@pytest.mark.parametrize("teeth", [[16], [15], [6, 7], [8, 1], [4, 3, 5]])
def test_best_teeth(teeth: list[int]) -> None:
    joints = len(teeth) + 1
    rng = np.random.default_rng(sum(teeth))
    bends = rng.uniform(0.05, 0.6, (2, joints))
    twists = rng.uniform(-3.0, 3.0, joints - 1) + rng.uniform(-0.4, 0.4, (2, joints - 1))
    phases, weights = rng.uniform(-3.0, 3.0, joints - 1), [1.0, 0.4]
    both = [pair(*state, phases) for state in zip(bends, twists, strict=True)]
    lines = Driveline.concatenate([line.reshape(1) for line, _ in both])
    best = lines.optimal_phases(states=0, weights=weights, teeth=teeth)
    turns = np.array(slow.best_teeth([own for _, own in both], teeth, weights))
    np.testing.assert_allclose(best, phases + 2.0 * np.pi * turns / teeth, atol=1e-12)


@pytest.mark.parametrize(
    ("joints", "weights", "message"),
    [([2, 3], None, "states must be drivelines"), ([2, 2], [1.0], "weights has 1 values")],
)
def test_errors(joints: list[int], weights: list[float] | None, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        slow.optimal_phases([reference.from_bends([0.1] * n) for n in joints], weights)
