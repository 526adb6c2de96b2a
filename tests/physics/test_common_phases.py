"""One setting of the yokes for all states, judged by grids, by one state alone and by hand."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cardan import Driveline
from cardan.arrays import FloatArray
from phase_oracle import Chains, least, least_turned
from refusals import refusals


def mean_square(line: Driveline, phases: FloatArray, weights: FloatArray | None = None) -> float:
    """The weighted mean of |q|² over the states, by the core's equivalent joint."""
    return float(np.average(line.with_phases(phases).equivalent().k ** 2, weights=weights))


def states_of(rng: np.random.Generator, joints: int, states: int, most: float = 0.5) -> Driveline:
    bends = rng.uniform(0.0, most, (states, joints))
    twists = rng.uniform(-3.0, 3.0, joints - 1) + rng.uniform(-0.4, 0.4, (states, joints - 1))
    return Driveline.from_bends(bends, twists, rng.uniform(-3.0, 3.0, joints - 1))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("joints", "grid"), [(2, 20_000), (3, 250), (4, 36)])
def test_no_point_of_a_grid_is_better(seed: int, joints: int, grid: int) -> None:
    rng = np.random.default_rng(seed)
    line = states_of(rng, joints, 5, 0.3 + 0.15 * seed)
    weights = rng.uniform(0.0, 1.0, 5)
    found = mean_square(line, line.optimal_phases(states=0, weights=weights), weights)
    axis = np.linspace(0.0, np.pi, grid, endpoint=False)
    tried = np.stack(np.meshgrid(*[axis] * (joints - 1), indexing="ij"), axis=-1)
    k = line.with_phases(tried.reshape(-1, 1, joints - 1)).equivalent().k
    least = float(np.min(np.average(k**2, axis=-1, weights=weights)))
    assert found <= least * (1.0 + 1e-12)
    # The grid is fine enough to find the same valley.
    step = np.pi / grid
    assert least <= found + joints**2 * step**2


@pytest.mark.parametrize("states", [1, 3, 8])
@pytest.mark.parametrize(("joints", "most"), [(2, 1.5), (3, 0.1), (3, 1.2), (4, 0.5), (6, 1.2)])
@pytest.mark.parametrize("teeth", [None, 16, 7])
@pytest.mark.parametrize("fixed", [None, 1])
def test_a_search_in_numpy_finds_nothing_better(
    states: int, joints: int, most: float, teeth: int | None, fixed: int | None
) -> None:
    rng = np.random.default_rng([states, joints])
    line = states_of(rng, joints, states, most)
    weights = rng.uniform(0.1, 1.0, states)
    found = line.optimal_phases(states=0, weights=weights, teeth=teeth, fixed=fixed)
    chains = Chains(line.bends, line.twists, weights / np.sum(weights))
    free = np.arange(1, joints) != fixed
    now = line.phases[0]
    other = least(chains, now, line.optimal_phases(), free)
    if teeth is not None:
        counts = np.where(free, teeth, 1).tolist()
        turns = least_turned(chains.root, now, counts, other)
        other = now + 2.0 * np.pi * turns / np.array(counts)
    root, best = chains.root(np.array([found, other]))
    # What the search calls as good.
    assert root <= best * (1.0 + 1e-9) + 1e-12


def test_two_joints_have_a_closed_form_up_to_the_product_of_their_k() -> None:
    """Least of |k1 + k2 exp(-2ip)|²: twice the phase is opposite to the sum of the states."""
    rng = np.random.default_rng(5)
    line = states_of(rng, 2, 7, 0.05)
    k = np.tan(line.bends / 2.0) ** 2
    turned = np.sum(k[:, 0] * k[:, 1] * np.exp(-2j * (0.5 * np.pi - line.twists[:, 0])))
    closed = (np.angle(turned) - np.pi) / 2.0
    off = line.optimal_phases(states=0)[0] - closed
    assert abs(off - np.pi * round(off / np.pi)) < 5.0 * np.max(k) ** 2


@pytest.mark.parametrize("joints", [2, 3, 5])
def test_of_one_state_it_is_the_optimum_of_that_state(joints: int) -> None:
    rng = np.random.default_rng(joints)
    line = states_of(rng, joints, 1)
    bend = line.with_phases(line.optimal_phases()).equivalent().bend
    common = line.with_phases(line.optimal_phases(states=0)).equivalent().bend
    np.testing.assert_allclose(common, bend, rtol=1e-9, atol=3e-8)


def test_yokes_that_are_set_as_well_as_can_be_stay() -> None:
    """Four joints have a continuum of settings that run uniformly, and any of them will do."""
    line = Driveline.from_bends([[0.2, 0.15, 0.18, 0.1]], [[0.3, -0.4, 1.0]], [[0.5, 1.0, -0.6]])
    first = line.with_phases(line.optimal_phases(states=0))
    np.testing.assert_allclose(first.optimal_phases(states=0), first.phases[0], atol=1e-7)


def test_of_two_settings_that_are_as_good_the_yokes_turn_to_the_nearer_one() -> None:
    """Shafts that all turn the other way from phase - twist = 90° run as uniformly."""
    rng = np.random.default_rng(6)
    twists = np.array([0.4, -0.9])
    best = rng.uniform(0.2, 0.25, 3)
    chosen = []
    for present in rng.uniform(-3.0, 3.0, (12, 2)):
        line = Driveline.from_bends([best], [twists], present)
        found = line.optimal_phases(states=0)
        mirrored = 2.0 * twists - np.pi - found
        both = [mean_square(line, phases) for phases in (found, mirrored)]
        assert max(both) < 1e-16
        turned = np.array([found, mirrored]) - present
        turned -= np.pi * np.round(turned / np.pi)
        own, other = np.linalg.norm(turned, axis=-1)
        assert own < other
        chosen.append(found)
    assert np.ptp(np.exp(2j * np.array(chosen)).imag, axis=0).min() > 0.1


def test_a_state_of_weight_zero_does_not_count() -> None:
    line = states_of(np.random.default_rng(3), 3, 4)
    found = line.optimal_phases(states=0, weights=[1.0, 0.0, 2.0, 1.0])
    others = line[[0, 2, 3]].optimal_phases(states=0, weights=[0.5, 1.0, 0.5])
    turned = found - others
    np.testing.assert_allclose(turned - np.pi * np.round(turned / np.pi), 0.0, atol=1e-9)


def test_states_are_any_axis_and_the_rest_stays_a_batch() -> None:
    rng = np.random.default_rng(4)
    bends = rng.uniform(0.05, 0.4, (3, 4, 3))
    twists = rng.uniform(-0.5, 0.5, (3, 4, 2))
    line = Driveline.from_bends(bends, twists)
    by_last = line.optimal_phases(states=-1)
    assert by_last.shape == (3, 2)
    for i in range(3):
        assert np.array_equal(by_last[i], line[i].optimal_phases(states=0))
    swapped = Driveline.from_bends(bends.swapaxes(0, 1), twists.swapaxes(0, 1))
    assert np.array_equal(swapped.optimal_phases(states=0), by_last)
    assert np.array_equal(np.degrees(by_last), line.optimal_phases(states=1, degrees=True))


@pytest.mark.parametrize("states", [None, 0])
def test_no_yoke_turns_by_more_than_a_quarter(states: int | None) -> None:
    # It looks the same after half a turn.
    line = states_of(np.random.default_rng(8), 4, 3)
    turned = line.optimal_phases(states=states, fixed=2) - line.phases
    assert np.all(np.abs(turned) <= 0.5 * np.pi)


@pytest.mark.parametrize("seed", range(4))
def test_fixed_shafts_stay_and_the_others_make_the_best_of_it(seed: int) -> None:
    line = states_of(np.random.default_rng(seed), 3, 4)
    found = line.optimal_phases(states=0, fixed=[1])
    assert found[0] == line.phases[0, 0]
    tried = np.empty((20_000, 1, 2))
    tried[..., 0] = line.phases[0, 0]
    tried[:, 0, 1] = np.linspace(0.0, np.pi, 20_000)
    k = line.with_phases(tried).equivalent().k
    assert mean_square(line, found) <= np.min(np.mean(k**2, axis=-1)) * (1.0 + 1e-12)
    both = line.optimal_phases(states=0, fixed=[1, 2])
    assert np.array_equal(both, line.phases[0])


@pytest.mark.parametrize("teeth", [[16, 15], [36, 1], [7, 24]])
def test_teeth_are_the_best_of_all_combinations(teeth: list[int]) -> None:
    line = states_of(np.random.default_rng(sum(teeth)), 3, 4)
    weights = np.array([1.0, 3.0, 0.5, 1.0])
    found = line.optimal_phases(states=0, weights=weights, teeth=teeth)
    turned = (found - line.phases[0]) * np.array(teeth) / (2.0 * np.pi)
    np.testing.assert_allclose(turned, np.round(turned), atol=1e-9)
    settings = itertools.product(*(range(count) for count in teeth))
    pitches = 2.0 * np.pi / np.array(teeth)
    all_of_them = [mean_square(line, line.phases[0] + pitches * s, weights) for s in settings]
    np.testing.assert_allclose(mean_square(line, found, weights), min(all_of_them), rtol=1e-9)


def test_teeth_beyond_the_number_that_is_compared_come_near_the_best_phases() -> None:
    line = states_of(np.random.default_rng(8), 4, 3)
    best = mean_square(line, line.optimal_phases(states=0))
    fine = mean_square(line, line.optimal_phases(states=0, teeth=3000))
    coarse = mean_square(line, line.optimal_phases(states=0, teeth=10))
    assert best < fine < best + 1e-5
    assert fine < coarse


def test_teeth_and_fixed_shafts_need_no_states() -> None:
    line = states_of(np.random.default_rng(9), 3, 2)
    each = line.optimal_phases(teeth=40)
    assert each.shape == (2, 2)
    for i in range(2):
        assert np.array_equal(each[i], line[i].optimal_phases(teeth=[40, 40]))
    assert line[0].optimal_phases(fixed=2)[1] == line.phases[0, 1]


def test_straight_joints_and_single_joints_have_nothing_to_set() -> None:
    straight = Driveline.from_bends(np.zeros((3, 3)), phases=[0.3, -0.4])
    assert np.allclose(straight.optimal_phases(states=0), [0.3, -0.4])
    assert Driveline.from_bends([[0.1], [0.2]]).optimal_phases(states=0).shape == (0,)


LINE = Driveline.from_bends(np.full((2, 3), 0.1), phases=[[0.0, 0.1], [0.0, 0.2]])


test_errors = refusals(
    {
        "states is 1; the batch has shape (2,)": {"states": 1},
        "TypeError: states is 'a'; it must be the number of an axis": {"states": "a"},
        "weights needs states": {"weights": [1, 1]},
        "weights has shape (1,); it must be (2,)": {"states": 0, "weights": [1]},
        "weights[1] is -1.0; it must be finite": {"states": 0, "weights": [1, -1]},
        "weights are all 0": {"states": 0, "weights": [0, 0]},
        "fixed is 3; shafts 1 to 2 have yokes at both": {"states": 0, "fixed": 3},
        "TypeError: fixed is 1.5; it must list numbers of shafts": {"states": 0, "fixed": 1.5},
        "fixed needs one present phase of shaft 2; it": {"states": 0, "fixed": 2},
        "teeth needs one present phase of shaft 2; it": {"states": 0, "teeth": 9},
        "teeth has length 1; it must be 2, one per": {"states": 0, "teeth": [9]},
        "teeth[1] is 0; a spline has at least 1": {"states": 0, "teeth": [9, 0]},
        "TypeError: teeth is 1.5; it must be a whole number or one": {"states": 0, "teeth": 1.5},
    },
    LINE.optimal_phases,
)


def test_no_driveline_needs_no_setting() -> None:
    none = Driveline.from_bends(np.empty((0, 2, 3)))
    assert none.optimal_phases(states=1, teeth=16).shape == (0, 2)
    assert none.optimal_phases(fixed=1).shape == (0, 2, 2)


def test_an_empty_axis_has_no_setting() -> None:
    with pytest.raises(ValueError, match="states is 0; that axis of the batch is empty"):
        Driveline.from_bends(np.empty((0, 2))).optimal_phases(states=0)
