"""Optimal phases, harmonics and the catalogue rule beside them."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from cardan import Driveline

EPS = 2.0**-52


def lengths(bends: np.ndarray) -> np.ndarray:
    return np.asarray(-np.log(np.cos(bends)))


def phased(line: Driveline) -> Driveline:
    return line.with_phases(line.optimal_phases())


def test_the_example_of_three_joints_closes() -> None:
    line = Driveline.from_bends([10, 9, 6], degrees=True)
    turned = np.degrees(line.optimal_phases()) + 90
    # One of the two mirrored triangles, each turn modulo 180 degrees.
    expected = np.array([80.2756, 180 - 145.9401])
    offset = np.minimum(np.abs(turned - expected), np.abs(turned + expected - 180) % 180)
    assert np.max(offset % 180) < 5e-5
    assert phased(line).equivalent().k < 4 * EPS


@given(
    st.lists(st.floats(0.01, 1.4), min_size=2, max_size=7),
    st.integers(0, 2**32 - 1),
)
def test_the_least_bend_that_the_polygon_allows(bends: list[float], seed: int) -> None:
    random = np.random.default_rng(seed)
    n = len(bends)
    twists, phases = random.uniform(-4, 4, (2, n - 1))
    line = Driveline.from_bends(bends, twists, phases)
    best = phased(line).equivalent()
    sides = lengths(np.array(bends))
    shortfall = 2 * sides.max() - sides.sum()
    # The rounding of each turn is stretched by the joints around it.
    unit = 16 * n * EPS / np.prod(np.cos(bends))
    if shortfall <= 0:
        assert best.k <= unit
    else:
        least = math.tanh(shortfall / 2)
        assert best.k == pytest.approx(least, abs=unit)


@given(st.lists(st.floats(0.05, 1.0), min_size=2, max_size=3), st.integers(0, 2**32 - 1))
def test_no_smaller_turn_does_as_well(bends: list[float], seed: int) -> None:
    # Up to three joints the candidates are few: each yoke modulo 180 degrees, and the mirror image.
    random = np.random.default_rng(seed)
    n = len(bends)
    twists, phases = random.uniform(-4, 4, (2, n - 1))
    line = Driveline.from_bends(bends, twists, phases)
    best = line.optimal_phases()
    turn = best + math.pi / 2 - twists
    for candidate in (turn, -turn):
        change = candidate - math.pi / 2 + twists - phases
        change -= math.pi * np.round(change / math.pi)
        assert np.sum((best - phases) ** 2) <= np.sum(change**2) + 1e-9
    assert np.all(np.abs(best - phases) <= math.pi / 2 + 1e-12)


def folded(bends: np.ndarray, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """``A`` and ``B`` of the map ``w -> A w + B conj(w)`` of joints with turns ``(n - 1, ...)``."""
    a, b = np.ones(turns.shape[1:], dtype=complex), np.zeros(turns.shape[1:], dtype=complex)
    for j, k in enumerate(np.tan(bends / 2) ** 2):
        if j > 0:
            a, b = a * np.exp(1j * turns[j - 1]), b * np.exp(1j * turns[j - 1])
        a, b = a - k * np.conj(b), b - k * np.conj(a)
    return a, b


def closing_turns(bends: np.ndarray, steps: int) -> np.ndarray:
    """Turns ``(3, ...)`` that close four joints: the first over a half turn, the others solved.

    The law of cosines, ``cosh L_E = cosh L_1 cosh L_2 + sinh L_1 sinh L_2 cos 2p``, gives the last
    turn: the second pair of joints must amount to as much as the first. The middle turn sets the
    two against each other, ``A' e^(ip) B + B' e^(-ip) conj(A) = 0``.
    """
    cosh, sinh = np.cosh(lengths(bends)), np.sinh(lengths(bends))
    first = math.pi / steps * np.arange(steps)
    pair = cosh[0] * cosh[1] + sinh[0] * sinh[1] * np.cos(2 * first)
    cosine = (pair - cosh[2] * cosh[3]) / (sinh[2] * sinh[3])
    first, last = first[np.abs(cosine) < 1], np.arccos(cosine[np.abs(cosine) < 1]) / 2
    first, last = np.concatenate([first, first]), np.concatenate([last, -last])
    (a, b), (a2, b2) = folded(bends[:2], first[None]), folded(bends[2:], last[None])
    return np.stack([first, np.angle(-b2 * np.conj(a) / (a2 * b)) / 2, last])


def test_four_joints_turn_as_little_as_a_fine_search_finds() -> None:
    random = np.random.default_rng(4)
    closed = 0
    for _ in range(200):
        bends = random.uniform(0.2, 0.5, 4)
        twists, phases = random.uniform(-1, 1, (2, 3))
        if 2 * lengths(bends).max() > lengths(bends).sum():
            continue
        closed += 1
        start = phases - twists + math.pi / 2
        found = Driveline.from_bends(bends, twists, phases).optimal_phases() - phases
        assert abs(folded(bends, start + found)[1]) < 1e-12
        # From both ends, because each lies thin where its first turn is as large as it can be.
        ends = closing_turns(bends, 1000), closing_turns(bends[::-1], 1000)[::-1]
        others = np.concatenate(ends, axis=1)
        assert np.max(np.abs(folded(bends, others)[1])) < 1e-9
        others -= start[:, None]
        others -= math.pi * np.round(others / math.pi)
        # Least within its neighbourhood.
        beside = others[:, np.max(np.abs(others - found[:, None]), axis=0) < 0.1]
        assert beside.shape[1] > 10
        assert np.sum(found**2) <= np.min(np.sum(beside**2, axis=0)) + 1e-9
    assert closed > 100


def test_what_is_smooth_already_stays() -> None:
    line = Driveline.from_bends([15, 15], twists=180, degrees=True)
    assert np.max(np.abs(line.optimal_phases() - line.phases)) < 1e-15
    line = phased(Driveline.from_bends([10, 9, 6, 4], 0.3, 0.2, degrees=True))
    assert np.max(np.abs(line.optimal_phases() - line.phases)) < 1e-9


def test_three_joints_turn_to_the_nearer_of_both_triangles() -> None:
    rng = np.random.default_rng(4)
    line = Driveline.from_bends(rng.uniform(0.2, 1.2, (2000, 3)), 0, rng.uniform(-3, 3, (2000, 2)))
    best = line.optimal_phases()

    def turn(phases: np.ndarray) -> np.ndarray:
        turns = phases - line.phases
        return np.asarray(((turns - np.pi * np.round(turns / np.pi)) ** 2).sum(axis=-1))

    assert np.all(turn(best) <= turn(-best) + 1e-9)


def test_shafts_that_share_a_turn_count_for_the_nearer_triangle() -> None:
    """Both shafts beside a straight joint turn by half of what a single shaft would."""
    rng = np.random.default_rng(4)
    bends = np.insert(rng.uniform(0.2, 1.2, (2000, 3)), 1, 0.0, axis=-1)
    line = Driveline.from_bends(bends, 0, rng.uniform(-3, 3, (2000, 3)))
    best = line.optimal_phases()

    def turn(phases: np.ndarray) -> np.ndarray:
        turns = np.add.reduceat(phases - line.phases, [0, 2], axis=-1)
        return np.asarray((turns - np.pi * np.round(turns / np.pi)) ** 2 @ [0.5, 1.0])

    assert np.all(turn(best) <= turn(-best) + 1e-9)


def test_what_is_nearly_smooth_turns_little() -> None:
    bends = np.random.default_rng(3).uniform(0.2, 0.5, (50, 6))
    smooth = phased(Driveline.from_bends(bends))
    pushed = smooth.with_phases(smooth.phases + 0.01)
    turns = pushed.optimal_phases() - pushed.phases
    assert np.all((turns**2).sum(axis=-1) <= 1.01 * 5 * 0.01**2)


def test_shafts_beside_a_straight_joint_share_the_turn() -> None:
    line = Driveline.from_bends([20, 0, 20], twists=[10, 20], degrees=True)
    change = np.degrees(line.optimal_phases())
    assert change == pytest.approx([15 - 45, 15 - 45]) or change == pytest.approx([60, 60])
    assert phased(line).equivalent().k < 4 * EPS
    # A straight end leaves its shaft alone.
    line = Driveline.from_bends([0, 20, 20], degrees=True)
    assert np.degrees(line.optimal_phases()) == pytest.approx([0, 0])


@pytest.mark.parametrize("bends", [[0.3], [0.0], [0.0, 0.0], [0.3, 0.0], [0.0, 0.3, 0.0]])
def test_nothing_to_phase(bends: list[float]) -> None:
    line = Driveline.from_bends(bends)
    assert line.optimal_phases().tolist() == line.phases.tolist()


@pytest.mark.parametrize("twist", [1e17, 1e300, 1.79e308, -1.79e308])
def test_whole_turns_of_a_twist_change_no_phase(twist: float) -> None:
    bends, angle = [0.3, 0.4, 0.35], math.atan2(math.sin(twist), math.cos(twist))
    best, plain = (Driveline.from_bends(bends, t).optimal_phases() for t in (twist, angle))
    np.testing.assert_allclose(best, plain, rtol=0, atol=1e-13)


@pytest.mark.parametrize("twist", [0.0, 0.5, math.pi / 2])
def test_what_compensates_exactly_has_no_negative_equivalent(twist: float) -> None:
    bends = np.radians([45.0, 35.264389682754654, 54.735610317245346])
    line = Driveline.from_bends(bends, twist)
    assert 0.0 <= line.with_phases(line.optimal_phases()).equivalent().k < 1e-15


def test_batches_give_what_single_drivelines_give() -> None:
    random = np.random.default_rng(1)
    bends = random.uniform(0, 0.6, (50, 50, 4)) * (random.random((50, 50, 4)) > 0.2)
    twists, phases = random.uniform(-4, 4, (2, 50, 50, 3))
    best = Driveline.from_bends(bends, twists, phases).optimal_phases()
    assert best.shape == (50, 50, 3)
    for i, j in random.integers(0, 50, (40, 2)):
        single = Driveline.from_bends(bends[i, j], twists[i, j], phases[i, j]).optimal_phases()
        assert np.array_equal(best[i, j], single)


@pytest.mark.parametrize("phases", [[0.7, -0.4], [0.0, 0.0]])
def test_harmonics_are_those_of_the_sampled_motion(phases: list[float]) -> None:
    line = Driveline.from_bends([0.5, 0.7, 0.3], [0.2, 0.9], phases)
    samples = 256
    angle = np.arange(samples) * (2 * math.pi / samples)
    for shaft in range(4):
        motion = line.evaluate(angle, ("angle_error", "speed_ratio"), shafts=shaft)
        orders = np.arange(1, 40)
        found = line.harmonics(orders, shaft)
        for name in ("angle_error", "speed_ratio"):
            spectrum = 2 * np.abs(np.fft.rfft(motion[name])) / samples
            assert getattr(found, name) == pytest.approx(spectrum[orders], abs=1e-14)


def test_harmonics_of_a_batch() -> None:
    line = Driveline.from_bends([[0.1], [0.5]])
    found = line.harmonics([2, 4, 7])
    k = np.tan([[0.05], [0.25]]) ** 2
    assert found.speed_ratio == pytest.approx(np.hstack([2 * k, 2 * k**2, 0 * k]))
    assert found.angle_error == pytest.approx(np.hstack([k, k**2 / 2, 0 * k]))


@pytest.mark.parametrize(
    ("bends", "signs", "rule"),
    [
        ([10, 8], [1, -1], 6.0),
        ([20, 25, 15], [1, -1, 1], 0.0),
        ([20, -25, 15], [1, 1, 1], None),
    ],
)
def test_the_catalogue_rule(bends: list[float], signs: list[int], rule: float | None) -> None:
    if rule is None:
        with pytest.raises(ValueError, match="bends"):
            Driveline.from_bends(bends, degrees=True)
        return
    line = Driveline.from_bends(bends, degrees=True)
    assert math.degrees(line.catalogue_bend(signs)) == pytest.approx(rule, abs=1e-6)


def test_the_catalogue_rule_can_miss_altogether() -> None:
    # Crossed yokes against the middle joint: the rule says 0, the exact bend is 3.143 degrees.
    line = Driveline.from_bends([20, 25, 15], degrees=True)
    assert math.degrees(line.catalogue_bend([1, -1, 1])) == pytest.approx(0.0, abs=1e-6)
    assert math.degrees(line.equivalent().bend) == pytest.approx(3.143, abs=5e-4)
