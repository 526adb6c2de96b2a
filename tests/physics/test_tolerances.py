"""Tolerances: closed forms, brute force, statistics and bounds, none of which shares the code."""

from __future__ import annotations

import itertools
import math
import pickle
import re
import tracemalloc
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import cardan
import tiers
from cardan import Driveline, Load, Sweep
from cardan.tolerances import case
from cardan.tolerances.box import Sizes, boxes
from cardan.tolerances.case import all_corners, largest_in_box, largest_of_corners, zonotope_radius
from cardan.tolerances.chain import (
    Deviations,
    Nominal,
    _displacement,
    amplitude,
    as_drawn,
    bound_parts,
)
from oracle import Fold
from refusals import refusals

TRUCK = np.array([[0, 0, 0], [0.3, 0, 0], [1.5, -0.1, 0.02], [2.4, -0.25, 0.03], [2.8, -0.3, 0.04]])
BEND_FIGURES = ("equivalent_bend", "non_uniformity", "max_angle_error", "torsional_excitation")
INERTIA_FIGURES = ("inertia_excitation_driving", "inertia_excitation_coasting")


def three() -> Driveline:
    """The example of the theory page: 10/9/6° phased to constant velocity."""
    line = Driveline.from_bends([10, 9, 6], degrees=True)
    return line.with_phases(line.optimal_phases())


def exact_bend_deg(bends: Any, twists: Any, phases: Any) -> float:  # noqa: ANN401
    """The equivalent bend by a fold of 2x2 matrices in 50 digits."""
    fold = Fold.of(bends, twists, phases)
    return float(mpmath.degrees(2 * mpmath.atan(mpmath.sqrt(abs(fold.b / fold.a)))))


def direct(line: Driveline, deviations: dict[str, Any]) -> Any:  # noqa: ANN401
    """The core's driveline with the deviations added."""
    bends = line.bends + deviations.get("bends", 0.0)
    twists = line.twists + deviations.get("twists", 0.0)
    return Driveline.from_bends(bends, twists, line.phases + deviations.get("phases", 0.0))


@pytest.mark.parametrize(
    ("bend", "wrong", "printed"),
    [
        (5, 2, 1.321757686790),
        (10, 5, 4.183953922198),
        (20, 5, 8.424764063852),
        (30, 10, 17.989570631042),
    ],
)
def test_equal_joints_with_a_wrong_phase(bend: float, wrong: float, printed: float) -> None:
    with mpmath.workdps(40):
        side = mpmath.log(mpmath.sec(mpmath.radians(bend)))
        length = 2 * mpmath.asinh(mpmath.sinh(side) * mpmath.sin(mpmath.radians(wrong)))
        exact = float(mpmath.degrees(mpmath.acos(mpmath.exp(-length))))
    assert exact == pytest.approx(printed, abs=1e-12)
    line = Driveline.from_bends([bend, bend], degrees=True)
    for name in ("phases", "twists"):
        found = line.tolerances(**{name: float(wrong)}, degrees=True)  # type: ignore[arg-type]
        assert found.worst_deg == pytest.approx(exact, abs=1e-10)
        # Of one corner alone the triangle inequality is an equality.
        assert found.guaranteed_deg == pytest.approx(exact, abs=1e-10)
        assert found.linear_deg == pytest.approx(exact, rel=4e-3)


def test_equal_joints_with_one_wrong_bend() -> None:
    line = Driveline.from_bends([10, 10], degrees=True)
    found = line.tolerances(bends=[0.0, 0.5], degrees=True)
    exact = math.degrees(math.acos(math.cos(math.radians(10.5)) / math.cos(math.radians(10))))
    assert found.worst_deg == pytest.approx(exact, abs=1e-10)
    assert found.guaranteed_deg == pytest.approx(exact, abs=1e-10)
    assert np.degrees(found.worst_at["bends"]) == pytest.approx([0.0, 0.5])


def test_the_example_of_the_theory_page() -> None:
    line = three()
    found = line.tolerances(bends=0.25, phases=1.0, degrees=True, seed=1)
    assert found.nominal_deg < 1e-6
    assert found.linear_deg == pytest.approx(3.573528, abs=5e-7)
    assert found.worst_deg == pytest.approx(3.590742, abs=5e-7)
    assert found.guaranteed_deg == pytest.approx(4.222402, abs=5e-7)
    assert found.worst_kind == "box"
    # The page has 2.854° from a sample; a quantile of 1e5 samples scatters by 0.0032°.
    assert found.quantile_deg(0.95) == pytest.approx(2.854, abs=0.016)
    steps = itertools.product(
        *([-0.25, 0.0, 0.25] for _ in range(3)), *([-1.0, 0.0, 1.0] for _ in range(2))
    )
    brute = max(
        exact_bend_deg(
            [b + math.radians(d) for b, d in zip(line.bends.tolist(), step[:3], strict=True)],
            [0.0, 0.0],
            [p + math.radians(d) for p, d in zip(line.phases.tolist(), step[3:], strict=True)],
        )
        for step in steps
    )
    assert found.worst_deg == pytest.approx(brute, abs=1e-9)
    deviations = {group: np.asarray(value) for group, value in found.worst_at.items()}
    assert direct(line, deviations).equivalent().bend_deg == pytest.approx(brute, abs=1e-9)


@pytest.mark.parametrize("bend", [1e-9, 1.3e-5, 1e-3, 0.49, 0.51])
def test_the_bound_of_one_joint_is_its_largest_bend(bend: float) -> None:
    found = Driveline.from_bends([bend]).tolerances(bends=10.0 * bend if bend < 0.1 else 0.3)
    largest = 11.0 * bend if bend < 0.1 else bend + 0.3
    assert found.worst == pytest.approx(largest, rel=2e-15, abs=0.0)
    assert found.guaranteed == pytest.approx(largest, rel=2e-15, abs=0.0)


def test_the_worst_may_be_inside_the_box() -> None:
    # The phase of the largest bend, both bends adding up, is within the tolerance and no corner.
    line = Driveline.from_bends([12, 7], phases=[83.0], degrees=True)
    found = line.tolerances(phases=20.0, degrees=True)
    most = -math.log(math.cos(math.radians(12))) - math.log(math.cos(math.radians(7)))
    assert found.worst_deg == pytest.approx(math.degrees(math.acos(math.exp(-most))), abs=1e-9)
    assert np.degrees(found.worst_at["phases"]) == pytest.approx([7.0], abs=1e-3)
    middles = [line.with_phases(np.radians([83.0 + d])).equivalent().bend for d in (-20, 0, 20)]
    assert found.worst > max(middles) + 1e-4


def test_many_parameters_say_how_they_are_searched() -> None:
    line = Driveline.from_bends(np.full(7, 0.1), phases=0.3)
    found = line.tolerances(bends=0.004, twists=0.01, phases=0.02)
    assert found.worst_kind == "search"
    assert "(worst: search)" in repr(found)
    assert direct(line, found.worst_at).equivalent().bend == pytest.approx(found.worst, rel=1e-9)
    # To first order, the sum of what one parameter after another adds in the worst direction.
    slopes = []
    for group, tolerance in (("bends", 0.004), ("twists", 0.01), ("phases", 0.02)):
        count = 7 if group == "bends" else 6
        for unit in np.eye(count):
            step = 1e-4 * unit
            ends = [direct(line, {group: sign * step}).transmission().q for sign in (1, -1)]
            slopes.append(tolerance * (ends[0] - ends[1]) / 2e-4)
    q = complex(line.transmission().q)
    around = np.exp(-1j * np.linspace(0, math.tau, 200_001))
    support = np.real(q * around) + sum(np.abs(np.real(g * around)) for g in slopes)
    exact = 2 * math.atan(math.sqrt(support.max()))
    assert found.linear == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("seed", range(4))
def test_the_worst_of_many_parameters_is_not_below_that_of_another_search(seed: int) -> None:
    """Drivelines near compensation, whose equivalent bend grows faster than its slopes say."""
    random = np.random.default_rng(seed)
    n = 3 + seed % 2
    steps = np.c_[random.uniform(0.3, 1.5, n + 1), random.uniform(-0.3, 0.3, (n + 1, 2))]
    points = np.cumsum(np.r_[np.zeros((1, 3)), steps], axis=0)
    phases = Driveline.from_points(points).optimal_phases()
    line = Driveline.from_points(points, phases)
    size = 0.01
    found = line.tolerances(points=size, phases=0.03)
    assert found.worst_kind == "search"

    def bends(signs: NDArray[np.float64]) -> NDArray[np.float64]:
        moved = points + size * signs[..., : points.size].reshape(-1, *points.shape)
        turned = phases + 0.03 * signs[..., points.size :]
        return np.asarray(Driveline.from_points(moved, turned).equivalent().bend)

    count = points.size + n - 1
    assert count > 16
    at = random.choice([-1.0, 1.0], (60, count))
    values = bends(at)
    turns = 1.0 - 2.0 * np.eye(count)
    for _ in range(count):
        beside = bends((at[:, np.newaxis] * turns).reshape(-1, count)).reshape(len(at), count)
        top = np.argmax(beside, axis=1)
        better = beside[np.arange(len(at)), top] > values
        if not np.any(better):
            break
        at[better] *= turns[top[better]]
        values[better] = beside[better, top[better]]
    assert found.worst >= values.max() * (1.0 - 1e-9)
    assert found.linear != pytest.approx(found.worst, rel=1e-3)


@given(st.integers(1, 9), st.integers(0, 1 << 30))
@settings(max_examples=tiers.part(60))
def test_the_farthest_vertex_of_a_zonotope(count: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    parts = random.normal(size=count) + 1j * random.normal(size=count) * random.integers(0, 2)
    centre = complex(*random.normal(size=2))
    signs = np.array(list(itertools.product((-1, 1), repeat=count)))
    assert zonotope_radius(centre, parts) == pytest.approx(np.abs(centre + signs @ parts).max())
    # Parts along the axes, of either sign, lie at the edges of half-planes.
    parts = parts.real * random.choice([1.0, 1.0j], size=count)
    assert zonotope_radius(centre, parts) == pytest.approx(np.abs(centre + signs @ parts).max())


@pytest.mark.parametrize("joints", [1, 2, 3, 5])
def test_q_is_that_of_the_core(joints: int) -> None:
    random = np.random.default_rng(joints)
    for _ in range(20):
        bends = random.uniform(0.0, 1.3, joints)
        twists, phases = random.uniform(-4, 4, (2, joints - 1))
        line = Driveline.from_bends(bends, twists, phases)
        nominal = Nominal(bends, twists, phases)
        found = as_drawn("last", nominal, joints)
        assert abs(found - line.transmission().q) < 2e-14
        # Beyond straight a joint bends to the other side.
        moved: Deviations = {("bends", (0,)): np.array([-2.0 * bends[0]])}
        (found,) = amplitude("last", nominal, joints, moved, 1)
        flipped = twists + np.pi * (np.arange(joints - 1) == 0)
        assert abs(found - Driveline.from_bends(bends, flipped, phases).transmission().q) < 2e-14


def test_a_nearly_straight_first_joint_keeps_the_linear_case() -> None:
    # Its plane turns by 45° within the tolerance, and with it the drive angle, but nothing else.
    points = [[0.0, 0.0, 0.0], [1.0, 1e-3, 0.0], [2.0, 3e-3, 0.0], [3.0, 0.2, 0.1]]
    line = Driveline.from_points(points, 0.3)
    found = line.tolerances(points=5e-4)
    assert found.linear == pytest.approx(found.worst, rel=2e-3)
    parts = found.shares["points"]
    assert parts[0].sum() < 1e-3 * parts[2].sum()


@pytest.mark.parametrize("straight", [(), (0,), (1,), (0, 1), (1, 2), (0, 1, 2, 3)])
def test_q_of_points_is_that_of_the_core(straight: tuple[int, ...]) -> None:
    random = np.random.default_rng(len(straight))
    spans = random.uniform(-1, 1, (5, 3)) + np.array([2, 0, 0])
    for joint in straight:
        spans[joint + 1] = spans[joint] * (1.0 + joint)
    points = np.concatenate([np.zeros((1, 3)), np.cumsum(spans, axis=0)])
    phases = random.uniform(-3, 3, 3)
    line = Driveline.from_points(points, phases)
    nominal = Nominal(line.bends, line.twists, phases, points)
    # It does not turn with the plane of joint 0, from which the drive angle counts.
    found = abs(as_drawn("last", nominal, 4))
    assert found == pytest.approx(abs(line.transmission().q), abs=2e-14)
    # Through the samples as well: the points as drawn, and a bent joint 0.
    deviations: Deviations = {("points", (0, 1)): np.array([0.0, 0.2])}
    each = np.abs(amplitude("last", nominal, 4, deviations, 2))
    for got, deviation in zip(each, (0.0, 0.2), strict=True):
        moved = points.copy()
        moved[0, 1] += deviation
        assert got == pytest.approx(Driveline.from_points(moved, phases).equivalent().k, abs=2e-14)


def kolmogorov(values: np.ndarray, distribution: Any) -> float:  # noqa: ANN401
    """The statistic sqrt(n) D; above 2 with a probability of 0.0007."""
    ordered = distribution(np.sort(values))
    n = len(ordered)
    steps = np.arange(n + 1) / n
    return float(math.sqrt(n) * max((steps[1:] - ordered).max(), (ordered - steps[:-1]).max()))


def test_a_single_joint_scatters_as_its_bend() -> None:
    line = Driveline.from_bends([0.2])
    uniform = line.tolerances(bends=0.01, seed=3).sampled
    assert kolmogorov(uniform, lambda x: (x - 0.19) / 0.02) < 2.0
    normal = line.tolerances(bends=0.03, seed=4, distribution="normal").sampled
    erf = np.vectorize(math.erf)
    assert kolmogorov(normal, lambda x: 0.5 * (1 + erf((x - 0.2) / 0.01 / math.sqrt(2)))) < 2.0
    # A statistic that can fail: the other distribution of the same spread.
    assert kolmogorov(uniform, lambda x: 0.5 * (1 + erf((x - 0.2) / 0.00577 / math.sqrt(2)))) > 5.0


def test_yokes_set_by_teeth_are_off_by_up_to_half_a_tooth() -> None:
    line = Driveline.from_bends([10, 10], degrees=True)
    found = line.tolerances(teeth=36, seed=5)
    half, side = math.radians(5.0), -math.log(math.cos(math.radians(10)))
    assert found.worst_deg == pytest.approx(4.183953922198, abs=1e-10)
    # The size of the error of phase is uniform, and the bend follows from it.
    length = -np.log(np.cos(found.sampled))
    wrong = np.arcsin(np.sinh(length / 2) / math.sinh(side))
    assert kolmogorov(wrong, lambda x: x / half) < 2.0
    both = line.tolerances(teeth=36, phases=1.0, degrees=True, seed=5)
    sine = math.sinh(side) * math.sin(math.radians(6.0))
    assert both.worst == pytest.approx(math.acos(math.exp(-2 * math.asinh(sine))), abs=1e-10)
    wide = np.arcsin(np.sinh(-np.log(np.cos(both.sampled)) / 2) / math.sinh(side))
    own = math.radians(1.0)
    # The sum of two uniform errors has the variance of both.
    assert np.mean(wide**2) == pytest.approx((half**2 + own**2) / 3, rel=0.01)
    assert both.shares["phases"] == pytest.approx([1.0])
    # To both sides alike, seen where the phase is wrong on the drawing already.
    off = line.with_phases([0.3]).tolerances(teeth=36, seed=5).sampled
    wrong = np.arcsin(np.sinh(-np.log(np.cos(off)) / 2) / math.sinh(side))
    assert kolmogorov(wrong, lambda x: (x - 0.3 + half) / (2 * half)) < 2.0
    # Half a tooth is uniform also where other tolerances are normal.
    mixed = line.tolerances(teeth=36, twists=half, distribution="normal").shares
    assert mixed["twists"] / mixed["phases"] == pytest.approx([3 / 9], rel=1e-6)


@pytest.mark.parametrize("distribution", ["uniform", "normal"])
def test_quantiles_are_those_of_drivelines_drawn_elsewhere(distribution: Any) -> None:  # noqa: ANN401
    line, count = three(), 200_000
    found = line.tolerances(
        bends=0.25, phases=1.0, degrees=True, seed=7, samples=count, distribution=distribution
    )
    random = np.random.default_rng(99)

    def draw(size: int, tolerance: float) -> np.ndarray:
        t = math.radians(tolerance)
        if distribution == "uniform":
            return random.uniform(-t, t, (count, size))
        return random.normal(0.0, t / 3, (count, size))

    other = direct(line, {"bends": draw(3, 0.25), "phases": draw(2, 1.0)}).equivalent().bend
    for share in (0.1, 0.5, 0.95, 0.99):
        below = np.mean(other <= found.quantile(share))
        # Both scatter: five standard deviations of the difference.
        assert below == pytest.approx(share, abs=5 * math.sqrt(2 * share * (1 - share) / count))
    assert found.passing == np.mean(found.sampled <= math.radians(3.0))
    assert found.passing == pytest.approx(np.mean(other <= math.radians(3.0)), abs=0.003)


def test_points_scatter_as_drivelines_drawn_elsewhere() -> None:
    line = Driveline.from_points(TRUCK)
    line, count = line.with_phases(line.optimal_phases()), 50_000
    tolerance = np.array([[0.0], [1e-3], [2e-3], [1e-3], [0.0]])
    found = line.tolerances(points=tolerance, seed=8, samples=count)
    random = np.random.default_rng(5)
    points = TRUCK + tolerance * random.uniform(-1, 1, (count, 5, 3))
    other = Driveline.from_points(points, line.phases).equivalent().bend
    for share in (0.1, 0.5, 0.95):
        below = np.mean(other <= found.quantile(share))
        assert below == pytest.approx(share, abs=5 * math.sqrt(2 * share * (1 - share) / count))
    assert found.worst_kind == "box"
    # Corner by corner.
    signs = np.array(list(itertools.product((-1, 1), repeat=9))).reshape(-1, 3, 3)
    corners = np.repeat(TRUCK[np.newaxis], len(signs), axis=0)
    corners[:, 1:4] += signs * tolerance[1:4]
    corner = Driveline.from_points(corners, line.phases).equivalent().bend.max()
    assert corner - 1e-12 <= found.worst <= found.guaranteed
    assert found.worst < 1.02 * corner


def test_samples_depend_on_the_seed_alone() -> None:
    line = Driveline.from_points(TRUCK)
    of = {
        workers: line.tolerances(points=1e-3, seed=3, workers=workers).sampled for workers in (1, 2)
    }
    assert np.array_equal(of[1], of[2])
    again = line.tolerances(points=1e-3, seed=4).sampled
    assert not np.any(of[1] == again)
    # No chunk repeats another one.
    assert len(np.unique(of[1])) == of[1].size
    fresh = line.tolerances(points=1e-3, samples=100)
    assert line.tolerances(points=1e-3, samples=100).seed != fresh.seed
    repeated = line.tolerances(points=1e-3, samples=100, seed=fresh.seed)
    assert np.array_equal(fresh.sampled, repeated.sampled)
    copy = pickle.loads(pickle.dumps(fresh))
    assert np.array_equal(copy.sampled, fresh.sampled)


def peak_beyond_the_samples(line: Driveline, samples: int, **given: Any) -> float:  # noqa: ANN401
    """Bytes of memory at most, less 8 for each sample and figure."""
    tracemalloc.start()
    try:
        found = line.tolerances(seed=1, samples=samples, **given)
        found.quantile([0.5, 0.95, 0.99])
        _ = found.passing
        return tracemalloc.get_traced_memory()[1] - 8.0 * len(given["of"]) * samples
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("of", [("equivalent_bend",), ("equivalent_bend", "max_angle_error")])
def test_memory_is_eight_bytes_per_sample_and_figure(of: tuple[str, ...]) -> None:
    line = Driveline.from_bends([0.2, 0.1])
    few, many = (
        peak_beyond_the_samples(line, samples, of=of, phases=0.01, workers=1)
        for samples in (200_000, 2_000_000)
    )
    # Not even one byte per further sample; the arrays of a chunk are small against a copy.
    assert few < 8e6
    assert many < few + 1_000_000


def test_memory_of_toleranced_points_is_eight_bytes_per_sample() -> None:
    line = Driveline.from_points(TRUCK)
    few, many = (
        peak_beyond_the_samples(line, samples, of=("equivalent_bend",), points=1e-3)
        for samples in (300_000, 1_500_000)
    )
    # The threads of the pool hold more or fewer chunks at the same time.
    assert many < few + 1_000_000 + 0.3 * few


@pytest.mark.parametrize("drawn_first", [False, True])
@pytest.mark.parametrize("samples", [1, 2, 1001])
def test_quantiles_and_the_passing_share_are_those_of_the_samples(
    samples: int, drawn_first: bool
) -> None:
    heights = np.repeat(TRUCK[np.newaxis], 6, axis=0).reshape(3, 2, *TRUCK.shape)
    heights[..., 2, 1] += np.linspace(-0.1, 0.1, 6).reshape(3, 2)
    line = Driveline.from_points(heights)
    of = ("equivalent_bend", "non_uniformity")
    found = line.tolerances(points=1e-3, of=of, seed=1, samples=samples)
    sampled = found.sampled if drawn_first else None
    shares = np.array([[0.0, 0.123, 0.5], [0.95, 0.999, 1.0]])
    got, passing = found.quantile(shares), found.passing
    again = line.tolerances(points=1e-3, of=of, seed=1, samples=samples).sampled
    for name, values in (sampled or found.sampled).items():
        np.testing.assert_array_equal(values, again[name])
        np.testing.assert_array_equal(found.ascending[name], np.sort(values, axis=-1))
        want = np.moveaxis(np.quantile(values, shares, axis=-1), (0, 1), (-2, -1))
        np.testing.assert_allclose(got[name], want, rtol=1e-14)
        np.testing.assert_array_equal(passing[name], np.mean(values <= found.limit[name], axis=-1))
        with pytest.raises(ValueError, match="read-only"):
            found.ascending[name][0, 0, 0] = 0.0


def test_a_driveline_at_its_limit_passes() -> None:
    found = Driveline.from_bends([0.04, 0.02], [0.3]).tolerances(phases=0.1, seed=1, samples=9)
    value = found.ascending[4]
    same = Driveline.from_bends([0.04, 0.02], [0.3]).tolerances(
        phases=0.1, seed=1, samples=9, limit=value
    )
    assert same.passing == 5 / 9


@st.composite
def toleranced(draw: st.DrawFn) -> tuple[Driveline, dict[str, Any]]:
    """A driveline by angles or points, sometimes at constant velocity, and tolerances."""
    n, seed = draw(st.integers(1, 4)), draw(st.integers(0, 1 << 30))
    random = np.random.default_rng(seed)
    phases = random.uniform(-3, 3, n - 1)
    size = draw(st.sampled_from([1e-3, 1e-2, 5e-2]))
    if draw(st.booleans()):
        rough = draw(st.sampled_from([0.0, 0.05, 0.2]))
        points = np.cumsum([1, 0, 0] + random.normal(size=(n + 2, 3)) * rough, axis=0)
        line, given_ = Driveline.from_points(points, phases), {"points": size}
    else:
        bends = random.uniform(0, draw(st.sampled_from([0.02, 0.3, 1.0])), n)
        line = Driveline.from_bends(bends, random.uniform(-3, 3, n - 1), phases)
        given_ = {"bends": size, "twists": draw(st.sampled_from([0.0, 0.1]))}
    if draw(st.booleans()):
        line = line.with_phases(line.optimal_phases())
    return line, {**given_, "phases": draw(st.sampled_from([0.0, 0.01, 0.3]))}


@given(toleranced())
@settings(max_examples=tiers.part(60))
def test_bounds_are_in_order(case: tuple[Driveline, dict[str, Any]]) -> None:
    line, tolerances = case
    of = BEND_FIGURES + (INERTIA_FIGURES if line.n_joints > 1 else ())
    found = line.tolerances(**tolerances, of=of, speed=1.0, samples=2000, seed=1)
    for name in of:
        assert found.nominal[name] <= found.worst[name] * (1 + 1e-12)
        assert found.worst[name] <= found.guaranteed[name] * (1 + 1e-9) + 1e-15
        assert found.sampled[name].max() <= found.guaranteed[name]
        if found.worst_kind[name] == "box":
            assert found.sampled[name].max() <= found.worst[name] * (1 + 1e-9)
        assert found.quantile(1.0)[name] == found.sampled[name].max()


def test_the_bound_of_points_is_near_through_a_straight_joint() -> None:
    # Half a millimetre on a straight shaft makes a bend of its own, and none that the bound misses.
    line = Driveline.from_points([[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    found = line.tolerances(points=5e-4)
    span = np.array([1.0, 0, 0])
    corner = span + np.array([-1, 1, 1]) * 1e-3
    cone = math.acos(corner[0] / np.linalg.norm(corner))
    assert found.worst <= found.guaranteed == pytest.approx(2 * cone)
    # One point moves both spans, so the two cones are never used up together to the last.
    assert found.worst > 0.99 * found.guaranteed


def test_figures_are_those_of_the_core() -> None:
    line, speed = three().with_phases([0.3, -0.2]), 104.7
    of = BEND_FIGURES + INERTIA_FIGURES
    found = line.tolerances(bends=1e-3, of=of, speed=speed, limit={"max_angle_error": 0.02})
    joint, check = line.equivalent(), {f.figure: f.value for f in line.check(speed).findings}
    assert found.nominal["equivalent_bend"] == pytest.approx(joint.bend, rel=1e-13)
    assert found.nominal["non_uniformity"] == pytest.approx(joint.non_uniformity, rel=1e-13)
    assert found.nominal["max_angle_error"] == pytest.approx(joint.max_angle_error, rel=1e-13)
    for name in of[3:]:
        assert found.nominal[name] == pytest.approx(check[name], rel=1e-12)
    assert found.limit["equivalent_bend"] == math.radians(3.0)
    limit = Driveline.from_bends([3.0], degrees=True).equivalent()
    assert found.limit["non_uniformity"] == pytest.approx(limit.non_uniformity, rel=1e-13)
    assert found.limit["max_angle_error"] == 0.02
    assert math.isnan(found.limit["torsional_excitation"])
    assert set(found.passing) == set(of[:3])
    # They all grow with the same complex number, so the same driveline is the worst.
    for name in of[:4]:
        at = direct(line, found.worst_at[name])
        worst = {"torsional_excitation": at.check(speed).findings[1].value}
        want = worst.get(name, getattr(at.equivalent(), name.replace("equivalent_", ""), None))
        assert found.worst[name] == pytest.approx(want, rel=1e-9)
    straight = Driveline.from_bends([0.0]).tolerances(bends=0.0, teeth=None, of=of[:4], speed=1.0)
    assert straight.worst == dict.fromkeys(of[:4], 0.0)


def test_an_intermediate_shaft() -> None:
    line = three()
    found = line.tolerances(bends=0.25, phases=1.0, degrees=True, shaft=2)
    two = Driveline.from_bends(line.bends[:2], phases=line.phases[:1])
    alone = two.tolerances(bends=0.25, phases=1.0, degrees=True)
    assert found.worst == pytest.approx(alone.worst, rel=1e-12)
    assert found.guaranteed == pytest.approx(alone.guaranteed, rel=1e-12)
    assert found.shares["bends"][2] == 0.0


def test_shares_are_those_of_the_variances() -> None:
    line = three().with_phases([0.3, -0.2])
    tolerance = {"bends": np.array([1e-3, 2e-3, 0.0]), "phases": np.array([0.01, 0.03])}
    for distribution in ("uniform", "normal"):
        found = line.tolerances(**tolerance, distribution=distribution).shares  # type: ignore[arg-type]
        parts: dict[str, list[float]] = {}
        for group, sizes in tolerance.items():
            for unit, size in zip(np.eye(len(sizes)), sizes, strict=True):
                ends = [direct(line, {group: s * 1e-6 * unit}).transmission().q for s in (1, -1)]
                parts.setdefault(group, []).append(abs((ends[0] - ends[1]) / 2e-6 * size) ** 2)
        total = sum(map(sum, parts.values()))
        for group, squares in parts.items():
            assert found[group] == pytest.approx(np.array(squares) / total, rel=1e-5)
    assert sum(array.sum() for array in found.values()) == pytest.approx(1.0)
    # The error of a twist is that of a phase, in the opposite sense.
    both = line.tolerances(twists=0.02, phases=0.02).shares
    assert both["twists"] == pytest.approx(both["phases"], rel=1e-6)


def test_permitted_tolerances_reach_the_limit() -> None:
    line = Driveline.from_bends([10, 10], degrees=True)
    found = line.tolerances(phases=5.0, degrees=True)
    sides = [-math.log(math.cos(math.radians(bend))) for bend in (3, 10)]
    exact = math.degrees(math.asin(math.sinh(sides[0] / 2) / math.sinh(sides[1])))
    for bound in ("worst", "guaranteed"):
        assert 5.0 * found.permitted("phases", bound=bound) == pytest.approx(exact, rel=1e-9)
    tight = line.tolerances(phases=5.0, bends=0.2, degrees=True)
    factor = tight.permitted("phases")
    assert factor < found.permitted("phases")
    again = line.tolerances(phases=5.0 * factor, bends=0.2, degrees=True)
    assert again.worst_deg == pytest.approx(3.0, abs=1e-6)
    for bends in (0.3, 2.0):
        rough = line.tolerances(phases=1.0, bends=bends, degrees=True)
        for bound in ("worst", "linear", "guaranteed"):
            assert math.isnan(rough.permitted("phases", bound=bound))
    # Half a tooth stays.
    splined = line.tolerances(phases=1.0, teeth=200, degrees=True)
    factor = splined.permitted("phases")
    again = line.tolerances(phases=factor, teeth=200, degrees=True)
    assert again.worst_deg == pytest.approx(3.0, abs=1e-6)
    small = Driveline.from_bends([1, 1], degrees=True).tolerances(phases=1.0, degrees=True)
    assert small.permitted("phases") == math.inf


def test_a_batch_is_its_drivelines() -> None:
    line = Driveline.from_bends([[10, 9, 6], [8, 7, 5]], degrees=True)
    bends = np.array([[[0.1]], [[0.25]], [[0.5]]]) * np.ones(3)
    options: dict[str, Any] = {"phases": 1.0, "degrees": True, "seed": 2, "samples": 500}
    found = line.tolerances(bends=bends, **options)
    assert found.shape == found.worst.shape == found.passing.shape == (3, 2)
    assert found.sampled.shape == (3, 2, 500)
    assert found.quantile([0.5, 0.9]).shape == (3, 2, 2)
    assert found.shares["bends"].shape == (3, 2, 3)
    one = line[1].tolerances(bends=0.5, **options)
    assert one.worst.shape == ()
    for name in ("nominal", "worst", "linear", "guaranteed", "passing", "sampled", "worst_deg"):
        assert np.array_equal(getattr(found, name)[2, 1], getattr(one, name))
    assert np.array_equal(found.quantile(0.9)[2, 1], one.quantile(0.9))
    assert np.array_equal(found.shares["phases"][2, 1], one.shares["phases"])
    empty = line[:0].tolerances(bends=0.1)
    assert empty.worst.shape == (0,)


def test_reduced_outputs_are_those_of_the_drivelines() -> None:
    line = Driveline.from_bends([0.005, 9e-2], phases=[0.4])
    load = Load(output_torque=100.0, speed=50.0, inertias=[0.1, 0.2, 0.3])
    of = ("bending_driven", "support_moment", "torque")
    found = line.tolerances(
        bends=0.01, phases=0.05, of=of, load=load, samples=3000, seed=1, limit={"torque": 101.0}
    )
    turn = Sweep.revolutions(1, 360)

    def peak(at: Driveline, name: str) -> float:
        return float(np.max(at.evaluate(turn, name, load=load, reduce="peak")[name]))

    for name in of:
        assert found.nominal[name] == pytest.approx(peak(line, name), rel=1e-12)
        assert found.worst_kind[name] == "box"
        at = {group: np.asarray(value) for group, value in found.worst_at[name].items()}
        bends = line.bends + at["bends"]
        # Through straight to the other side, the plane turns by 180°.
        twist = np.pi * float((bends[0] < 0.0) != (bends[1] < 0.0))
        worst = Driveline.from_bends(np.abs(bends), twist, line.phases + at["phases"])
        assert found.worst[name] == pytest.approx(peak(worst, name), rel=1e-12)
        assert found.sampled[name].max() <= found.worst[name] * (1 + 1e-9)
        assert sum(part.sum() for part in found.shares[name].values()) == pytest.approx(1.0)
    assert set(found.passing) == {"torque"}
    assert found.passing["torque"] == np.mean(found.sampled["torque"] <= 101.0)
    assert found.guaranteed == {}
    alone = line.tolerances(bends=0.01, of="torque", load=load)
    with pytest.raises(ValueError, match=r"of is 'torque'; a guaranteed bound is known"):
        _ = alone.guaranteed


def test_a_joint_that_bends_to_the_other_side() -> None:
    line, load = Driveline.from_bends([0.0, 0.09]), Load(output_torque=100.0)
    of = {"of": "support_moment", "load": load, "shafts": 1, "samples": 4000, "seed": 1}
    found = line.tolerances(bends=[0.02, 0.0], **of)  # type: ignore[arg-type]
    turn = Sweep.revolutions(1, 360)
    ends = [
        Driveline.from_bends([0.02, 0.09], twist)
        .evaluate(turn, "support_moment", load=load, shafts=1, reduce="peak")
        .support_moment
        for twist in (0.0, np.pi)
    ]
    assert max(ends) > 1.2 * min(ends)
    assert found.worst == pytest.approx(max(ends), rel=1e-9)
    assert found.sampled.max() == pytest.approx(max(ends), rel=1e-3)
    assert found.sampled.min() == pytest.approx(min(ends), rel=1e-3)


@pytest.mark.parametrize("by", ["points", "angles"])
def test_coasting_is_driving_of_the_reversed_driveline(by: str) -> None:
    random = np.random.default_rng(4)
    if by == "points":
        line = Driveline.from_points(TRUCK, [0.3, -0.4])
        sizes = {"points": random.uniform(0, 2e-3, (5, 1)), "phases": np.array([0.01, 0.04])}
    else:
        line = Driveline.from_bends([0.2, 0.1, 0.15], [0.3, -0.8], [0.3, -0.4])
        sizes = {
            "bends": np.array([1e-3, 4e-3, 0.0]),
            "twists": np.array([0.0, 0.03]),
            "phases": np.array([0.01, 0.04]),
        }
    turned = {group: array[::-1] for group, array in sizes.items()}
    coasting, driving = (f"inertia_excitation_{way}" for way in ("coasting", "driving"))
    one = line.tolerances(**sizes, of=coasting, speed=1.0)  # type: ignore[arg-type]
    other = line.reversed().tolerances(**turned, of=driving, speed=1.0)  # type: ignore[arg-type]
    for name in ("nominal", "worst", "linear", "guaranteed"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-7), name


def minimal_rotation(start: np.ndarray, end: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Carry a vector from one unit direction to another along the shorter arc."""
    cross = np.cross(start, end)
    along = np.dot(start, end)
    turned = along * vector + np.cross(cross, vector)
    return np.asarray(turned + cross * np.dot(cross, vector) / (1 + along))


def disc_map(directions: Any, frames: Any) -> Any:  # noqa: ANN401
    """A joint as a map of the disc, from the frame of its driven to that of its driving shaft."""
    (u, v), (f, g) = directions, frames
    x, y, z = np.dot(v, f), np.dot(v, np.cross(u, f)), np.dot(u, v)
    end = ((x + 1j * y) / (1 + z)) ** 2
    carried = minimal_rotation(u, v, f)
    turn = complex(np.dot(g, carried), np.dot(g, np.cross(v, carried))) ** 2
    return lambda w: (end + turn * w) / (1 + np.conj(end) * turn * w)


def test_the_picture_of_directions_in_the_disc_is_that_of_the_core() -> None:
    random = np.random.default_rng(3)
    for _ in range(20):
        spans = random.normal(size=(4, 3)) * 0.4 + np.array([2, 0, 0])
        units = spans / np.linalg.norm(spans, axis=1, keepdims=True)
        frames = [np.cross(u, random.normal(size=3)) for u in units]
        frames = [frame / np.linalg.norm(frame) for frame in frames]
        point: complex = 0.0
        for j in (2, 1, 0):
            # Frames are drawn at random, so what stands in one is the same in the next.
            point = disc_map(units[j : j + 2], frames[j : j + 2])(point)
            # A shaft whose yokes lie in one plane turns the polygon back: p = 90° - twist.
            point = -point
        line = Driveline.from_directions(spans, 0.0)
        assert abs(point) == pytest.approx(float(line.equivalent().k), abs=1e-13)


def test_the_bound_holds_where_a_side_moves_far_ends_apart() -> None:
    # A U of long legs opens by more than its base becomes longer: L grows as cosh of the legs.
    bends = [1.3, 0.1, 1.3]
    line = Driveline.from_bends(bends, phases=[np.pi / 4, np.pi / 4])
    found = line.tolerances(bends=[0.0, 0.02, 0.0])
    sides = [-np.log(np.cos(bend)) for bend in (found.nominal, found.worst, found.guaranteed)]
    base = math.log(math.cos(0.1) / math.cos(0.12))
    assert sides[1] - sides[0] > 1.5 * base
    assert sides[1] <= sides[2]


@pytest.mark.long
def test_the_lemma_of_the_bound_of_points() -> None:
    # What moves is the far end of a polygon behind one joint; far away the turns decide.
    random, sharpest = np.random.default_rng(8), 0.0
    for _ in range(2000):
        bend, far = random.uniform(0.3, 1.2), random.uniform(0.0, 9.0)
        size = random.uniform(0.001, 0.03)
        line = Driveline.from_points(
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1 + math.cos(bend), math.sin(bend), 0.0]]
        )
        _, _, (box,) = boxes(line, Sizes({"points": size}))
        _, changes, _, turned = bound_parts(box)
        assert box.nominal.points is not None
        corner = box.nominal.points + size * random.choice([-1, 1], (3, 3))
        pairs = []
        for points in (box.nominal.points, corner):
            spans = np.diff(points, axis=0)
            pairs.append(spans / np.linalg.norm(spans, axis=1, keepdims=True))
        frames = [np.array([0.0, 0, 1]), np.array([0.0, 0, 1])]
        moved = [minimal_rotation(u, v, f) for u, v, f in zip(*pairs, frames, strict=True)]
        w = math.tanh(far / 2) * np.exp(1j * np.linspace(0, math.tau, 40))
        a, b = disc_map(pairs[0], frames)(w), disc_map(pairs[1], moved)(w)
        room = (1 - np.abs(a) ** 2) * (1 - np.abs(b) ** 2)
        distance = float(np.max(2 * np.arcsinh(np.abs(a - b) / np.sqrt(room))))
        swing = 2 * math.asinh(math.sinh(far) * math.sin(min(turned[0], math.pi / 2)))
        shift = 2 * math.asinh(math.sinh(changes[0] / 2) * math.cosh(far))
        assert distance <= (shift + swing) * (1 + 1e-6)
        sharpest = max(sharpest, distance / (shift + swing))
    # Not so wide that it says nothing.
    assert sharpest > 0.5


def holonomy(pairs: Any, frames: Any) -> float:  # noqa: ANN401
    """By how much what is behind a joint turns when the joint moves, apart from its shift."""
    ends, turns = [], []
    for (u, v), (f, g) in zip(pairs, frames, strict=True):
        ends.append(disc_map((u, v), (f, g))(0.0))
        carried = minimal_rotation(u, v, f)
        turns.append(complex(np.dot(g, carried), np.dot(g, np.cross(v, carried))) ** 2)
    shift = (ends[1] - ends[0]) / (1 - np.conj(ends[0]) * ends[1])
    return float(abs(np.angle(turns[1] / turns[0] * (1 + np.conj(ends[0]) * shift) ** 2)))


@pytest.mark.parametrize("bend", [0.3, 0.6, 1.0, 1.2])
@pytest.mark.parametrize(("moved", "sharp"), [((0, 0, 1), 0.995), ((1, 0, 0), 0.3), ((1, 0, 1), 0)])
def test_the_turn_behind_a_joint_is_bounded_sharply(
    bend: float, moved: tuple[int, int, int], sharp: float
) -> None:
    """Points that move across the bend plane turn what is behind by the bound itself."""
    points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1 + math.cos(bend), math.sin(bend), 0.0]]
    line, size = Driveline.from_points(points), np.zeros((3, 3))
    size[:, 2] = 3e-3 * np.array(moved)
    _, _, (box,) = boxes(line, Sizes({"points": size}))
    *_, turned = bound_parts(box)
    assert box.nominal.points is not None
    largest = 0.0
    for signs in itertools.product((-1.0, 1.0), repeat=3):
        pairs = []
        for corner in (box.nominal.points, box.nominal.points + np.array(signs)[:, None] * size):
            spans = np.diff(corner, axis=0)
            pairs.append(spans / np.linalg.norm(spans, axis=1, keepdims=True))
        across = np.array([0.0, 0.0, 1.0])
        turned_across = [minimal_rotation(u, v, across) for u, v in zip(*pairs, strict=True)]
        own = [(across, across), tuple(turned_across)]
        largest = max(largest, holonomy(pairs, own))
    # Two half turns are a turn.
    assert sharp * 2.0 * turned[0] <= largest <= 2.0 * turned[0] * (1 + 1e-9)


def test_the_bound_of_bends_alone_is_the_sum_of_their_changes() -> None:
    bend, size = 0.4, 0.03
    line = Driveline.from_bends([bend, bend])
    line = line.with_phases(line.optimal_phases())
    change = math.log(math.cos(bend) / math.cos(bend + size))
    found = line.tolerances(bends=size)
    assert found.guaranteed == pytest.approx(math.acos(math.exp(-2.0 * change)), rel=1e-9)


def test_the_bound_of_one_shaft_between_two_joints_is_exact() -> None:
    """Its excitation depends on the bend before it alone."""
    found = Driveline.from_bends([0.9, 0.2]).tolerances(
        bends=[0.2, 0.0], of="inertia_excitation_driving", speed=3.0
    )
    assert found.guaranteed == pytest.approx(4.0 * 9.0 * math.tan(0.55) ** 2, rel=1e-9)
    assert found.worst == pytest.approx(found.guaranteed, rel=1e-9)


def test_the_bound_of_a_shaft_is_the_sum_of_the_sides_before_it() -> None:
    """Yokes that may have any phase; the third joint lies behind the shaft."""
    line = Driveline.from_bends([0.3, 0.2, 0.9], phases=[0.8, 0.0])
    found = line.tolerances(phases=[math.pi / 2, math.pi / 2], shaft=2)
    straight = math.acos(math.cos(0.3) * math.cos(0.2))
    assert found.guaranteed == pytest.approx(straight, rel=1e-12)
    assert found.worst == pytest.approx(straight, rel=1e-9)


def test_a_search_follows_a_ridge_and_several_starts() -> None:
    def ridge(x: NDArray[np.float64]) -> NDArray[np.float64]:
        """With its top inside the box, away from all corners and middles."""
        return np.asarray(-4.0 * (x[0] - x[1]) ** 2 - (x[0] + x[1] - 0.7) ** 2)

    value, at = largest_in_box(ridge, all_corners(2))
    assert value == pytest.approx(0.0, abs=1e-6)
    assert at == pytest.approx([0.35, 0.35], abs=1e-3)

    def hill(x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Higher than the best corner, but not from there."""
        apart = (x[0] + 0.5) ** 2 + (x[1] + 1.0) ** 2
        return np.asarray(np.where(x[0] + x[1] > 1.9, 1.0, 2.0 * np.exp(-9.0 * apart)))

    value, at = largest_in_box(hill, all_corners(2))
    assert value == pytest.approx(2.0)
    assert at == pytest.approx([-0.5, -1.0], abs=1e-3)


def test_corners_are_followed_to_the_last() -> None:
    def below(x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Each end counts once those before it are right."""
        right = np.cumprod(x > 0.0, axis=0)
        return np.asarray(np.sum(right, axis=0, dtype=np.float64))

    assert largest_of_corners(below, -np.ones(5))[0] == 5.0


def test_blocks_of_outputs_are_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for block in (2048, 100):
        monkeypatch.setattr(case, "_BLOCK", block)
        asked = three().tolerances(
            bends=0.01, of="torque_2_peak", load=Load(drive_torque=9.0), samples=250, seed=1
        )
        found.append(asked.sampled)
    np.testing.assert_array_equal(*found)


def test_a_limit_of_a_ratio_has_no_degrees() -> None:
    line = Driveline.from_bends([10.0, 9.0], degrees=True)
    of = ("non_uniformity", "max_angle_error")
    limits = {"non_uniformity": 0.01, "max_angle_error": 0.2}
    found = line.tolerances(bends=0.1, of=of, limit=limits, degrees=True, samples=10)
    assert found.limit == {"non_uniformity": 0.01, "max_angle_error": math.radians(0.2)}


def test_a_hyperbolic_disc_reaches_farthest_towards_the_centre() -> None:
    line = Driveline.from_bends([0.9, 0.2])
    _, _, (box,) = boxes(line, Sizes({"bends": np.array([0.2, 0.0])}))
    parts = bound_parts(box)
    q, r = math.tan(0.45) ** 2, math.tanh(0.5 * parts[1][0])
    rim = r * np.exp(1j * np.linspace(0.0, math.tau, 2001))
    reach = np.max(np.abs((q + rim) / (1.0 + q * rim) - q))
    assert _displacement(box.nominal, 1, *parts) == pytest.approx(reach, rel=1e-6)


def test_large_tolerances_leave_no_bend_beyond_a_right_angle_to_first_order() -> None:
    line = Driveline.from_bends([60.0, 60.0], phases=90.0, degrees=True)
    names = ("equivalent_bend", "non_uniformity")
    found = line.tolerances(bends=25.0, degrees=True, of=names)
    assert found.linear["equivalent_bend"] <= math.pi / 2
    assert found.linear["non_uniformity"] > found.nominal["non_uniformity"] > 0.0


def test_half_a_tooth_scatters_evenly_whatever_the_distribution() -> None:
    """Against tolerances of phases alone that have the same standard deviations."""
    line = Driveline.from_bends([0.3, 0.2, 0.25], [0.3, 0.1], [0.2, -0.5])
    fine, half = 10**9, math.pi / 36
    teeth = line.tolerances(phases=[0.05, 0.0], teeth=[fine, 36]).shares["phases"]
    alone = line.tolerances(phases=[0.05, half]).shares["phases"]
    assert teeth == pytest.approx(alone, rel=1e-6)
    normal = line.tolerances(
        phases=[0.05 * math.sqrt(3.0), 0.0], teeth=[fine, 36], distribution="normal"
    ).shares["phases"]
    assert normal == pytest.approx(alone, rel=1e-6)
    assert 0.05 < alone[0] < 0.95


def heights() -> Driveline:
    """The truck at three ride heights."""
    points = np.repeat(TRUCK[np.newaxis], 3, axis=0)
    points[:, 3:, 1] += [[-0.03], [0.0], [0.05]]
    return Driveline.from_points(points, [0.4, -0.1])


def test_a_figure_over_states_is_the_largest_of_the_same_drivelines() -> None:
    line = heights()
    sizes: dict[str, Any] = {"points": 1e-3, "phases": 0.03, "samples": 2000, "seed": 5}
    found = line.tolerances(**sizes, states=0)
    each = [line[i].tolerances(**sizes) for i in range(3)]
    assert (found.shape, found.n_states) == ((), 3)
    np.testing.assert_array_equal(found.sampled, np.max([one.sampled for one in each], axis=0))
    for name in ("nominal", "worst", "linear", "guaranteed"):
        assert getattr(found, name) == max(getattr(one, name) for one in each)
    worst = int(np.argmax([one.worst for one in each]))
    assert found.worst_state == worst
    np.testing.assert_array_equal(found.shares["points"], each[worst].shares["points"])
    for i, one in enumerate(each):
        alone = found.in_state(i)
        assert alone.n_states is None
        np.testing.assert_array_equal(alone.sampled, one.sampled)
        assert alone.worst == one.worst


def test_a_driveline_passes_if_it_does_in_every_state() -> None:
    """Judged by deviations drawn elsewhere and added to the points of every state."""
    points = np.repeat(TRUCK[np.newaxis], 3, axis=0)
    points[:, 3:, 1] += [[-0.03], [-0.025], [0.05]]
    line, count = Driveline.from_points(points, [0.4, -0.1]), 40_000
    drawn = line.equivalent().bend
    limit = float(drawn.max() + 1e-4)
    found = line.tolerances(points=2e-3, states=0, limit=limit, samples=count, seed=2)
    random = np.random.default_rng(17)
    moved = points + random.uniform(-2e-3, 2e-3, (count, 1, 5, 3))
    bends = Driveline.from_points(moved, [0.4, -0.1]).equivalent().bend
    passing = np.mean(np.all(bends <= limit, axis=-1))
    scatter = 5.0 * math.sqrt(2.0 * passing * (1.0 - passing) / count)
    assert found.passing == pytest.approx(passing, abs=scatter)
    # It is not the share in the worst state, nor the product of the shares.
    shares = np.mean(bends <= limit, axis=0)
    assert passing < shares.min() - scatter
    assert passing > np.prod(shares) + scatter


def test_the_worst_over_states_and_how_exact_the_yokes_must_be() -> None:
    line = heights()
    found = line.tolerances(phases=[0.03, 0.01], states=0, limit=0.08)
    levels = np.linspace(-1.0, 1.0, 81)
    first, second = np.meshgrid(0.03 * levels, 0.01 * levels, indexing="ij")
    phases = np.array([0.4, -0.1]) + np.stack([first, second], axis=-1)[:, :, np.newaxis]
    bends = line.with_phases(phases).equivalent().bend
    assert found.worst >= bends.max()
    assert found.worst == pytest.approx(bends.max(), rel=1e-6)
    assert found.worst_state == np.unravel_index(bends.argmax(), bends.shape)[2]
    at = line.with_phases([0.4, -0.1] + found.worst_at["phases"]).equivalent().bend
    assert at.max() == pytest.approx(found.worst, rel=1e-9)
    factor = found.permitted("phases")
    scaled = line.tolerances(phases=factor * np.array([0.03, 0.01]), states=0)
    assert scaled.worst == pytest.approx(0.08, rel=1e-8)


def test_states_on_another_axis_with_speeds_and_loads() -> None:
    line = Driveline.from_bends(np.radians([[[10, 9], [12, 5], [3, 4]], [[8, 8], [2, 9], [5, 6]]]))
    speeds, torques = np.array([50.0, 80.0, 120.0]), np.array([100.0, 150.0, 900.0])
    of = ("inertia_excitation_driving", "support_moment_1_peak")
    asked: dict[str, Any] = {"bends": 0.01, "of": of, "samples": 100, "seed": 1}
    load = Load(output_torque=torques, speed=speeds, inertias=np.full((3, 3), 0.1))
    found = line.tolerances(**asked, speed=speeds, load=load, states=-1)
    assert found.shape == (2,)
    for row in range(2):
        each = [
            line[row, i].tolerances(
                **asked,
                speed=float(speeds[i]),
                load=Load(output_torque=torques[i], speed=speeds[i], inertias=[0.1] * 3),
            )
            for i in range(3)
        ]
        for name in of:
            assert found.worst[name][row] == pytest.approx(max(one.worst[name] for one in each))
            assert found.worst_state[name][row] == np.argmax([one.worst[name] for one in each])
            sampled = np.max([one.sampled[name] for one in each], axis=0)
            np.testing.assert_allclose(found.sampled[name][row], sampled, rtol=1e-12)
    crossed = line.tolerances(**asked, speed=speeds, load=load, states=0)
    assert crossed.shape == (3,)
    copy = pickle.loads(pickle.dumps(found))
    assert copy.worst_state["support_moment_1_peak"].tolist() == found.worst_state[of[1]].tolist()
    assert repr(found).startswith(
        "<Tolerances of 2 parameters of a batch of shape (2,) in 3 states"
    )


test_states_are_checked = refusals(
    {
        "states is given, but the driveline has no batch axis": lambda: three().tolerances(
            bends=0.01, states=0
        ),
        "IndexError: states is 1; there are 1, counted from 0": lambda: heights().tolerances(
            phases=0.01, states=1
        ),
        "states have different tolerances; they are positions of one driveline": lambda: (
            heights().tolerances(phases=[[0.01], [0.02], [0.01]] * np.ones(2), states=0)
        ),
        "do not broadcast": lambda: heights().tolerances(
            phases=0.01, of="torsional_excitation", speed=[1.0, 2.0]
        ),
        "IndexError: state is 3; there are 3, counted from 0": lambda: (
            heights().tolerances(phases=0.01, states=0).in_state(3)
        ),
    }
)


def test_the_inertia_excitation_is_the_larger_of_both() -> None:
    line = Driveline.from_bends([4, 9, 12], phases=[10, 80], degrees=True)
    of = ("inertia_excitation", *INERTIA_FIGURES)
    sizes: dict[str, Any] = {"bends": 0.5, "phases": 3.0}
    found = line.tolerances(**sizes, degrees=True, of=of, speed=50.0, samples=500, seed=1)
    for result in (found.nominal, found.worst, found.linear, found.guaranteed, found.sampled):
        both, *each = (result[name] for name in of)
        np.testing.assert_array_equal(both, np.maximum(*each))
    larger = max(INERTIA_FIGURES, key=lambda name: float(found.worst[name]))
    for group, shares in found.shares["inertia_excitation"].items():
        np.testing.assert_array_equal(shares, found.shares[larger][group])


@pytest.mark.parametrize(
    ("name", "bare"),
    [
        ("support_moment_1_peak", {"of": "support_moment", "shafts": 1}),
        ("torque_rms", {"of": "torque", "reduce": "rms"}),
        ("bending_driven_1_mean", {"of": "bending_driven", "joints": 1, "reduce": "mean"}),
        ("tilt_driving_0_max", {"of": "tilt_driving", "joints": 0, "reduce": "max"}),
    ],
)
def test_a_reduced_output_has_one_name(name: str, bare: dict[str, Any]) -> None:
    load = Load(output_torque=100.0)
    asked: dict[str, Any] = {"bends": 0.01, "phases": 0.05, "samples": 300, "seed": 1}
    one, other = (three().tolerances(**asked, load=load, **of) for of in ({"of": name}, bare))
    np.testing.assert_array_equal(one.sampled, other.sampled)
    # The tilt of a joint has a whole turn as its period.
    output = bare["of"]
    values = three().evaluate(
        np.linspace(0.0, math.tau, 360, endpoint=False),
        output,
        load=load,
        reduce=bare.get("reduce", "peak"),
        **{key: bare[key] for key in ("shafts", "joints") if key in bare},
    )[output]
    assert one.nominal == pytest.approx(float(values), rel=1e-12)


@pytest.mark.parametrize(
    ("of", "error", "message"),
    [
        (
            "torque_1_min",
            ValueError,
            "of[0] is 'torque_1_min'; its reduction must be one of 'peak'",
        ),
        ("torque_9_peak", IndexError, "shaft of torque is 9; there are 4, counted from 0"),
        ("bearing_force_0_peak", IndexError, "bearing of bearing_force is 0; there are 0"),
        ("torque_1", ValueError, "did you mean 'torque'? (an output has the number"),
    ],
)
def test_names_of_reduced_outputs_are_checked(of: str, error: Any, message: str) -> None:  # noqa: ANN401
    with pytest.raises(error, match=re.escape(message)):
        three().tolerances(bends=0.01, of=of, load=Load(output_torque=100.0))


@pytest.mark.parametrize("name", ["bearing_force_1_peak", "joint_force_2_rms", "moment_0_rms"])
@pytest.mark.parametrize("by", ["points", "angles"])
def test_forces_have_shares_and_a_linear_worst_case(by: str, name: str) -> None:
    """Against differences of drivelines built anew, and against the corners of the box."""
    output, number, last = name.rsplit("_", 2)
    reduce: Any = last
    bearings, load = [(0, 0.1), (0, 0.25), (1, 0.9), (3, 0.1), (3, 0.2)], Load(output_torque=100.0)
    drawn = Driveline.from_points(TRUCK, [0.3, -0.4])
    sizes: dict[str, Any] = {"phases": np.array([0.02, 0.01])}
    if by == "points":
        sizes["points"] = np.zeros((5, 3))
        sizes["points"][1:3, 1:] = [[5e-4, 2e-4], [1e-3, 3e-4]]
    else:
        sizes |= {"bends": np.array([2e-3, 1e-3, 4e-3]), "twists": np.array([0.03, 0.0])}

    def figure(changes: dict[str, Any]) -> float:
        phases = drawn.phases + changes["phases"]
        if by == "points":
            line = Driveline.from_points(TRUCK + changes["points"], phases)
        else:
            angles = drawn.bends + changes["bends"], drawn.twists + changes["twists"], phases
            line = Driveline.from_bends(*angles)
        line = line.with_bearings(bearings, drawn._geometry.lengths if by == "angles" else None)
        samples = line.evaluate(np.linspace(0.0, math.pi, 180, endpoint=False), output, load=load)
        lengths = np.linalg.norm(samples[output][int(number)], axis=-1)
        return float(np.max(lengths) if reduce == "peak" else np.sqrt(np.mean(lengths**2)))

    line = drawn.with_bearings(bearings)
    found = line.tolerances(**sizes, of=name, load=load, samples=200, seed=1)
    parts = {}
    for group, size in sizes.items():
        parts[group] = np.zeros(size.shape)
        for place in zip(*np.nonzero(size), strict=True):
            ends = []
            for sign in (1.0, -1.0):
                changes = {other: np.zeros(whole.shape) for other, whole in sizes.items()}
                changes[group][place] = 1e-3 * sign * size[place]
                ends.append(figure(changes))
            parts[group][place] = (ends[0] - ends[1]) / 2e-3
    drawn_figure = figure({group: np.zeros(size.shape) for group, size in sizes.items()})
    assert found.nominal == pytest.approx(drawn_figure, rel=1e-12)
    total = sum(np.sum(np.abs(part)) for part in parts.values())
    assert found.linear - found.nominal == pytest.approx(total, rel=1e-5)
    squares = sum(np.sum(part**2) for part in parts.values())
    for group, part in parts.items():
        np.testing.assert_allclose(found.shares[group], part**2 / squares, atol=1e-5)
    corner = {group: size * np.sign(parts[group]) for group, size in sizes.items()}
    assert found.worst_kind == "box"
    assert figure(corner) * (1.0 - 1e-9) <= found.worst <= 1.01 * figure(corner)
    assert found.worst == pytest.approx(figure(found.worst_at), rel=1e-9)
    assert found.sampled.max() <= found.worst
    if output == "moment":
        bare = line.tolerances(
            **sizes, of=output, joints=int(number), reduce=reduce, load=load, samples=200, seed=1
        )
        np.testing.assert_array_equal(bare.sampled, found.sampled)
        np.testing.assert_array_equal(bare.linear, found.linear)


def test_the_worst_of_many_parameters_is_not_below_their_corners() -> None:
    """A peak has kinks: the linear worst case is below random drivelines here."""
    points = np.array(
        [[0, 0, 0], [420, -15, 0], [1480, -60, 10], [2630, -260, 25], [2990, -275, 25]]
    )
    bearings = [(0, 0.1), (0, 0.3), (1, 0.98), (3, 0.06), (3, 0.25)]
    load = Load(output_torque=220.0)
    sizes = np.zeros((5, 3))
    sizes[1:4, 1:], sizes[4] = 1e-3, 1e-3
    sizes[0, 1:] = 2e-3
    phases = [0.087, -0.209]
    line = Driveline.from_points(1e-3 * points, phases).with_bearings(bearings)
    found = line.tolerances(points=sizes, of="joint_force_1_peak", load=load, seed=1)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=11)))
    moved = np.repeat(1e-3 * points[np.newaxis], len(signs), axis=0)
    moved[:, sizes > 0.0] += signs * sizes[sizes > 0.0]
    lines = Driveline.from_points(moved, phases).with_bearings(bearings)
    turn = np.linspace(0.0, math.pi, 180, endpoint=False)
    plan = lines[:, np.newaxis].plan("joint_force", joints=1, load=load, reduce="peak")
    corners = np.asarray(plan(turn)["joint_force"])
    assert found.worst_kind == "search"
    assert found.linear < found.sampled.max() < found.worst
    # The largest is just beside a corner.
    assert corners.max() <= found.worst < corners.max() * (1.0 + 1e-5)


def test_reduced_outputs_keep_bearings_and_points() -> None:
    line = Driveline.from_points(TRUCK).with_bearings([(1, 0.4)])
    load = Load(output_torque=100.0)
    found = line.tolerances(
        points=1e-3, of="bearing_force", load=load, samples=50, seed=1, reduce="peak"
    )
    turn = Sweep.revolutions(1, 360)
    result = line.evaluate(turn, "bearing_force", load=load, reduce="peak").bearing_force
    assert found.nominal == pytest.approx(result.max(), rel=1e-12)
    assert found.worst_kind == "search"
    assert found.worst > found.sampled.max() > found.nominal
    assert found.unit("bearing_force") == "N"


test_what_is_refused = refusals(
    {
        "tolerances are missing; give at least one of bends, twists, phases, points, "
        "driving_yoke, cross, driven_yoke and teeth": {},
        "bends is -0.1; a tolerance must be finite and not negative": {"bends": -0.1},
        "bends[1] is nan; a tolerance must be finite": {"bends": [0.1, np.nan, 0.1]},
        "bends has shape (2,); it must be one number or (..., 3)": {"bends": [0.1, 0.1]},
        "phases has shape (3,); it must be one number or (..., 2)": {"phases": [0.1] * 3},
        "TypeError: bends has dtype <U4; it must hold real numbers": {"bends": "much"},
        "bends permit a bend of 95.9437 deg at joint 0; every bend must stay": {"bends": 1.5},
        "bends permit a bend of 95.9437 deg at joint 0 at six standard deviations; every": {
            "bends": 0.75,
            "distribution": "normal",
        },
        "points have tolerances, but the driveline was not made from points": {"points": 1e-3},
        "distribution is 'flat'; it must be 'uniform'": {"bends": 0.1, "distribution": "flat"},
        "teeth is 2.5; it must be a whole number, at least 1": {"teeth": 2.5},
        "teeth[1] is 0.0; it must be a whole number, at least 1": {"teeth": [16, 0]},
        "teeth has shape (3,); it must be one number or (..., 2)": {"teeth": [16] * 3},
        "of[0] is 'bend'; ": {"bends": 0.1, "of": "bend"},
        "of is empty; name at least one figure": {"bends": 0.1, "of": ()},
        "of[1] is 'torque' again; name each figure": {"bends": 0.1, "of": ["torque", "torque"]},
        "TypeError: of[0] is 3; a figure is asked for by its name": {"bends": 0.1, "of": [3]},
        "speed is missing; 'torsional_excitation'": {"bends": 0.1, "of": "torsional_excitation"},
        "reduce is 'min'; it must be 'peak',": {"bends": 0.1, "of": "torque", "reduce": "min"},
        "limit['equivalent_bend'] is 0.0; it must be a positive": {"bends": 0.1, "limit": 0.0},
        "limit names 'torque'; ": {"bends": 0.1, "limit": {"torque": 3.0}},
        "TypeError: limit is 3.0; with several figures it must be a mapping by their names": {
            "bends": 0.1,
            "of": ["torque", "angle_error"],
            "limit": 3.0,
        },
        "speed is inf; it must be finite, in rad/s": {"bends": 0.1, "speed": np.inf},
        "samples is 0; it must be at least 1": {"bends": 0.1, "samples": 0},
        "TypeError: samples is 10.0; it must be an integer": {"bends": 0.1, "samples": 10.0},
        "seed is -1; it must be at least 0": {"bends": 0.1, "seed": -1},
        "TypeError: seed is 'x'; it must be an integer": {"bends": 0.1, "seed": "x"},
        "shaft is 0; the drive shaft turns without errors": {"bends": 0.1, "shaft": 0},
        "IndexError: shaft is 4; there are 4, counted from 0": {"bends": 0.1, "shaft": 4},
    },
    three().tolerances,
)


def test_what_is_refused_of_points() -> None:
    line = Driveline.from_points(TRUCK)
    with pytest.raises(cardan.ArgumentValueError, match="bends do not go with points"):
        line.tolerances(points=1e-3, bends=0.1)
    with pytest.raises(cardan.ArgumentValueError, match=r"points permit a bend of .* at joint 0"):
        line.tolerances(points=0.2)
    with pytest.raises(cardan.ArgumentValueError, match=r"points has shape \(3,\)"):
        line.tolerances(points=[1e-3] * 3)


def test_what_is_refused_of_the_result() -> None:
    found = three().tolerances(bends=0.1, degrees=True, of="non_uniformity", samples=10)
    with pytest.raises(ValueError, match="of has 'non_uniformity' in 1; only angles have degrees"):
        _ = found.worst_deg
    with pytest.raises(ValueError, match=r"share is 1.5; it must lie in \[0, 1\]"):
        found.quantile(1.5)
    with pytest.raises(ValueError, match="group is 'phases'; it has no tolerances"):
        found.permitted("phases")
    with pytest.raises(ValueError, match="bound is 'most'; it must be"):
        found.permitted("bends", bound="most")
    load = Load(output_torque=1.0)
    without = three().tolerances(bends=0.1, degrees=True, of="torque", load=load, samples=10)
    for name in ("passing", "permitted"):
        with pytest.raises(ValueError, match="limit is missing; 'torque' has no default limit"):
            _ = without.passing if name == "passing" else without.permitted("bends")
