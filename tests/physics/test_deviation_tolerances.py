"""Tolerances of joints as built: loops of pins, all corners, random drivelines drawn elsewhere."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cardan import ArgumentValueError, Driveline, Load, Sweep
from cardan.design.quantities import farthest_signs, order_amplitude
from cardan.tolerances import JOINT_GROUPS
from cardan.tolerances.case import _root
from deviation_oracle import LeaningChain, LeaningJoint
from refusals import refusals
from tiers import few

BENDS, TWISTS, PHASES = [0.2, 0.35], [0.4], [1.0]
LINE = Driveline.from_bends(BENDS, TWISTS, PHASES)
YOKES: dict[str, Any] = {"driving_yoke": [0.003, 0.002], "driven_yoke": [0.002, 0.004]}
HALVES = np.array([[0.003, 0.0, 0.002], [0.002, 0.0, 0.004]])
SPEED = 100.0 * np.pi
POINTS = np.array([[0, 0, 0], [0.3, 0, 0], [1.5, -0.1, 0.02], [2.4, -0.25, 0.03]])


def by_pins(deviations: Any, order: int) -> complex:  # noqa: ANN401
    """Amplitude of an order of the angle error, from vectors along the pins alone."""
    joints = [LeaningJoint(b, e) for b, e in zip(BENDS, np.asarray(deviations), strict=True)]
    chain = LeaningChain(joints, TWISTS, PHASES)
    turn = 2.0 * np.pi * np.arange(32) / 32
    lags = np.array([float(chain.lag(angle)) for angle in turn])
    return complex(2.0 * np.mean(lags * np.exp(-1j * order * turn)))


def sizes(line: Driveline, deviations: NDArray[np.float64], order: int = 1) -> NDArray[np.float64]:
    """Amplitudes of drivelines as built, by sums over a turn of their angle error."""
    built = line.with_deviations(*np.moveaxis(deviations, -1, 0))
    turn = Sweep.revolutions(1, 64)
    errors = built.reshape(-1, 1).evaluate(turn, "angle_error").angle_error
    wave = np.exp(-2j * np.pi * order * np.arange(64) / 64)
    return np.asarray(np.abs(2.0 * np.mean(errors * wave, axis=-1)))


def test_the_worst_of_an_order_is_the_worst_corner_as_built() -> None:
    found = LINE.tolerances(**YOKES, of="angle_error_order_1")
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=6)]).reshape(-1, 2, 3)
    assert found.worst == pytest.approx(sizes(LINE, signs * HALVES).max(), rel=1e-9)
    at = np.stack([found.worst_at.get(group, np.zeros(2)) for group in JOINT_GROUPS], axis=-1)
    assert found.worst == pytest.approx(abs(by_pins(at, 1)), rel=1e-9)
    assert found.worst_kind == "box"
    assert found.nominal == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_first_order_is_that_of_differences_between_loops_of_pins(order: int) -> None:
    tolerances: dict[str, Any] = {**YOKES, "cross": 0.002}
    found = LINE.tolerances(**tolerances, of=f"angle_error_order_{order}")
    halves = np.where(HALVES > 0.0, HALVES, 0.002)
    vectors = []
    for place in np.ndindex(2, 3):
        step = np.zeros((2, 3))
        step[place] = 1e-3 * halves[place]
        vectors.append((by_pins(step, order) - by_pins(-step, order)) / 2e-3)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=6)])
    linear = np.abs(by_pins(np.zeros((2, 3)), order) + signs @ np.array(vectors)).max()
    assert found.linear == pytest.approx(linear, rel=1e-7)
    variances = np.abs(vectors).reshape(2, 3) ** 2
    for column, group in enumerate(JOINT_GROUPS):
        shares = variances[:, column] / variances.sum()
        np.testing.assert_allclose(found.shares[group], shares, rtol=1e-6, atol=1e-12)
    own = LINE.order_tolerances(*halves.T, order=order)
    assert np.abs(own.drawing + signs @ own.contributions.ravel()).max() == pytest.approx(linear)


def test_the_signs_of_the_farthest_sum_are_those_of_all_trials() -> None:
    random = np.random.default_rng(11)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=7)])
    for _ in range(20):
        middle, *vectors = random.normal(size=8) + 1j * random.normal(size=8)
        farthest = np.abs(middle + signs @ np.array(vectors)).max()
        found = farthest_signs(complex(middle), np.array(vectors))
        assert abs(middle + found @ np.array(vectors)) == pytest.approx(farthest, rel=1e-12)


def test_an_acceleration_is_that_of_the_speed() -> None:
    of = ("angle_error_order_3", "acceleration_order_3")
    found = LINE.tolerances(**YOKES, of=of, speed=SPEED, samples=50, seed=1)
    ratio = (3.0 * SPEED) ** 2
    for name in ("worst", "linear"):
        each = getattr(found, name)
        assert each[of[1]] == pytest.approx(ratio * each[of[0]], rel=1e-12)
    np.testing.assert_allclose(found.sampled[of[1]], ratio * found.sampled[of[0]], rtol=1e-12)
    assert found.unit(of[1]) == "rad/s²"
    # The acceleration itself, of one driveline as built.
    built = LINE.with_deviations(*HALVES.T)
    own = built.tolerances(cross=1e-9, of=of[1], speed=SPEED)
    turn = built.evaluate(Sweep.revolutions(1, 64), "acceleration_ratio").acceleration_ratio
    wave = np.exp(-6j * np.pi * np.arange(64) / 64)
    assert own.nominal == pytest.approx(abs(2.0 * np.mean(turn * wave)) * SPEED**2, rel=1e-9)


@pytest.mark.parametrize("distribution", few(["uniform", "normal"], ["normal"]))
def test_quantiles_are_those_of_drivelines_drawn_elsewhere(distribution: Any) -> None:  # noqa: ANN401
    random, count = np.random.default_rng(7), 20_000
    if distribution == "normal":
        drawn = random.standard_normal((count, 2, 3)) / 3.0
    else:
        drawn = random.uniform(-1.0, 1.0, (count, 2, 3))
    found = LINE.tolerances(
        **YOKES, of="angle_error_order_1", distribution=distribution, samples=count, seed=3
    )
    elsewhere = sizes(LINE, drawn * HALVES)
    for share in (0.5, 0.95):
        assert found.quantile(share) == pytest.approx(np.quantile(elsewhere, share), rel=0.02)
    linear = LINE.order_tolerances(*HALVES.T, distribution=distribution)
    assert np.sqrt(np.mean(found.sampled**2)) == pytest.approx(linear.rms, rel=0.02)


def test_measured_deviations_are_the_middle_of_their_tolerances() -> None:
    own = np.array([[0.01, 0.002, -0.004], [0.0, 0.0, 0.006]])
    built = LINE.with_deviations(*own.T)
    found = built.tolerances(**YOKES, of="angle_error_order_1", samples=400, seed=2)
    assert found.nominal == pytest.approx(abs(by_pins(own, 1)), rel=1e-9)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=6)]).reshape(-1, 2, 3)
    assert found.worst == pytest.approx(sizes(LINE, own + signs * HALVES).max(), rel=1e-9)
    assert found.ascending[-1] < found.worst
    assert found.ascending[0] > 0.0


def test_layout_and_joints_have_tolerances_together() -> None:
    found = LINE.tolerances(bends=0.01, phases=0.05, driving_yoke=0.003, of="angle_error_order_1")
    best = 0.0
    for b0, b1, p, e0, e1 in itertools.product((-1.0, 0.0, 1.0), repeat=5):
        line = Driveline.from_bends(
            [BENDS[0] + 0.01 * b0, BENDS[1] + 0.01 * b1], TWISTS, [PHASES[0] + 0.05 * p]
        )
        deviations = np.array([[0.003 * e0, 0.0, 0.0], [0.003 * e1, 0.0, 0.0]])
        best = max(best, float(sizes(line, deviations)[0]))
    assert found.worst == pytest.approx(best, rel=1e-6)
    assert found.shares["driving_yoke"].sum() == pytest.approx(1.0)


def test_many_parameters_are_searched_and_not_below_their_corners() -> None:
    line = Driveline.from_bends([0.1, 0.15, 0.2, 0.12], phases=[0.3, 0.6, 0.2])
    tolerances: dict[str, Any] = {"driving_yoke": 0.01, "cross": 0.01, "driven_yoke": 0.01}
    found = line.tolerances(**tolerances, of="angle_error_order_1")
    assert found.worst_kind == "search"
    own = line.order_tolerances(**tolerances)
    assert found.worst >= own.worst
    assert found.worst == pytest.approx(own.worst, rel=0.02)


def test_a_first_joint_that_is_straight_keeps_orders_smooth() -> None:
    # A small bend to either side turns the plane from which drive angles count by half a turn.
    line = Driveline.from_bends([0.0, 0.2])
    found = line.tolerances(
        bends=[0.01, 0.0], driving_yoke=[0.0, 0.01], cross=[0.004, 0.0], of="angle_error_order_1"
    )
    assert found.linear == pytest.approx(0.01 * np.tan(0.2), rel=0.02)
    assert found.worst == pytest.approx(found.linear, rel=0.02)
    built = line.with_deviations(driving_yoke=[0.0, 0.01])
    measured = built.tolerances(bends=[0.01, 0.0], of="angle_error_order_1")
    assert measured.linear == pytest.approx(float(measured.nominal), rel=1e-3)
    assert measured.worst == pytest.approx(float(measured.nominal), rel=1e-3)


def test_points_turn_the_plane_and_not_the_orders() -> None:
    points = np.array([[0, 0, 0], [0.3, 0, 0], [1.5, 1e-3, 1e-3], [2.4, -0.25, 0.03]])
    line = Driveline.from_points(points)
    tolerances = np.zeros((4, 3))
    tolerances[2, 1:] = 3e-3
    of = "angle_error_order_2"
    found = line.tolerances(points=tolerances, of=of, samples=300, seed=0)
    q = line.tolerances(points=tolerances, samples=300, seed=0)
    # Of ideal joints order 2 is |q|, of which the library has derivatives in axes that stay.
    assert found.linear == pytest.approx(np.tan(q.linear / 2.0) ** 2, rel=1e-4)
    np.testing.assert_allclose(found.sampled, np.tan(q.sampled / 2.0) ** 2, rtol=1e-8, atol=1e-13)


def test_outputs_are_those_of_a_whole_turn_as_built() -> None:
    load = Load(drive_torque=100.0)
    for name in ("angle_error_peak", "support_moment_1_peak"):
        found = LINE.tolerances(**YOKES, of=name, load=load, samples=60, seed=4)
        best = 0.0
        output = name.removesuffix("_peak").removesuffix("_1")
        for signs in itertools.product((-1.0, 1.0), repeat=4):
            e = np.reshape(signs, (2, 2)) * HALVES[:, ::2]
            built = LINE.with_deviations(e[:, 0], 0.0, e[:, 1])
            turn, shaft = Sweep.revolutions(1, 360), 1 if "support" in name else -1
            values = built.evaluate(turn, output, load=load, shafts=shaft, reduce="peak")[output]
            best = max(best, float(values))
        assert found.worst == pytest.approx(best, rel=1e-9), name
        assert found.ascending[-1] <= found.worst
        assert found.linear == pytest.approx(found.worst, rel=0.02)
        assert sum(part.sum() for part in found.shares.values()) == pytest.approx(1.0)


def test_outputs_of_points_and_joints_have_shares() -> None:
    line = Driveline.from_points(POINTS)
    found = line.tolerances(points=1e-3, driving_yoke=0.01, of="angle_error_peak", samples=10)
    by_bends = Driveline.from_bends(line.bends, line.twists, line.phases)
    alone = by_bends.tolerances(driving_yoke=0.01, of="angle_error_peak", samples=10)
    ratio = found.shares["driving_yoke"] / alone.shares["driving_yoke"]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-5)
    assert found.worst_kind == "search"


def test_states_have_the_same_deviations() -> None:
    lines = Driveline.from_bends([[0.1, 0.2], [0.2, 0.1], [0.05, 0.15]])
    of = "angle_error_order_1"
    found = lines.tolerances(**YOKES, of=of, states=0, samples=100, seed=6)
    each = [lines[i].tolerances(**YOKES, of=of, samples=100, seed=6) for i in range(3)]
    assert found.worst == pytest.approx(max(float(one.worst) for one in each))
    np.testing.assert_allclose(found.sampled, np.max([one.sampled for one in each], axis=0))


def test_permitted_tolerances_reach_the_limit() -> None:
    found = LINE.tolerances(**YOKES, of="acceleration_order_1", speed=SPEED, limit=300.0, seed=0)
    factor = found.permitted("driving_yoke")
    wider: dict[str, Any] = {**YOKES, "driving_yoke": factor * np.array(YOKES["driving_yoke"])}
    again = LINE.tolerances(**wider, of="acceleration_order_1", speed=SPEED)
    assert again.worst == pytest.approx(300.0, rel=1e-9)


def test_a_figure_that_is_infinite_from_somewhere_on_has_its_last_number() -> None:
    for blocked in (0.3, 1.0, 139.0):

        def excess(factor: float, end: float = blocked) -> float:
            return -1.0 if factor < end else np.inf

        found = _root(excess)
        assert blocked * 0.999 <= found < blocked


@pytest.mark.long
def test_where_joints_block_before_a_limit_the_permitted_tolerances_end() -> None:
    bend, half = np.radians(10.0), 0.01
    line = Driveline.from_bends([bend])
    found = line.tolerances(
        driving_yoke=half, of="angle_error_order_1", limit=100.0, samples=10, seed=1
    )
    # A yoke may lean until its pin is in line with the driven shaft.
    blocked = (0.5 * np.pi - bend) / half
    assert blocked * 0.999 <= found.permitted("driving_yoke") < blocked


def test_the_amplitude_is_that_of_the_angle_error() -> None:
    built = LINE.with_deviations(*HALVES.T)
    for order in (1, 2, 5):
        assert order_amplitude(built, order, 2) == pytest.approx(by_pins(HALVES, order), abs=1e-15)


test_what_does_not_hold_is_refused = refusals(
    {
        "of is 'equivalent_bend', a figure of ideal joints; joints with": {"driving_yoke": 0.1},
        "of[1] is 'max_angle_error', a figure of ideal joints": {
            "cross": 0.1,
            "bends": 0.1,
            "of": ["torque", "max_angle_error"],
        },
        "speed is missing; 'acceleration_order_1'": {"cross": 0.1, "of": "acceleration_order_1"},
        "of[0] is 'angle_error_order_0'; did you mean 'angle_error_order_1'?": {
            "cross": 0.1,
            "of": "angle_error_order_0",
        },
        "cross is -0.1; a tolerance must be": {"cross": -0.1, "of": "angle_error_order_1"},
        "driven_yoke has shape (3,)": {"driven_yoke": [0.1] * 3, "of": "angle_error_order_1"},
        "cross and the others permit deviations of 74.4845 deg and a bend of 20.0535 deg "
        "together at joint 1; their sum must stay below 90 deg so that the joint can turn": {
            "driven_yoke": 0.7,
            "cross": 0.6,
            "of": "angle_error_order_1",
        },
    },
    LINE.tolerances,
)


def test_what_a_driveline_as_built_refuses() -> None:
    built = LINE.with_deviations(driving_yoke=0.7)
    with pytest.raises(ArgumentValueError, match="a figure of ideal joints"):
        built.tolerances(bends=0.1)
    with pytest.raises(ArgumentValueError, match="bends and the others permit deviations of 40"):
        built.tolerances(bends=0.8, of="angle_error_order_1")
    normal: dict[str, Any] = {
        "driving_yoke": 0.3,
        "distribution": "normal",
        "of": "angle_error_order_1",
    }
    with pytest.raises(ArgumentValueError, match="joint 1 at six standard deviations; their sum"):
        built.tolerances(**normal)
    found = LINE.tolerances(cross=0.1, of="angle_error_order_1")
    with pytest.raises(ArgumentValueError, match="a guaranteed bound is known for equivalent_bend"):
        _ = found.guaranteed
