"""Tolerances of joints, against every corner and random drivelines as built."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from cardan import Driveline
from refusals import refusals

LINE = Driveline.from_bends([0.2, 0.35], [0.4], [1.0])
HALVES = np.array([[0.003, 0.001, 0.002], [0.002, 0.001, 0.002]])
FOUND = LINE.order_tolerances(*HALVES.T)


def order_1(deviations: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Amplitudes of order 1 of drivelines with these deviations, ``(..., n, 3)``."""
    lines = LINE.with_deviations(*np.moveaxis(deviations, -1, 0))
    found: np.ndarray[Any, Any] = lines.harmonics([1], outputs="angle_error").angle_error[..., 0]
    return found


def test_the_worst_corner_is_the_worst_of_all() -> None:
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=6)]).reshape(-1, 2, 3)
    # To first order a cross has no part in order 1, but it has one in the worst corner.
    assert pytest.approx(order_1(signs * HALVES).max(), rel=1e-9) == FOUND.worst
    assert pytest.approx(order_1(FOUND.worst_deviations), rel=1e-12) == FOUND.worst
    assert np.array_equal(np.abs(FOUND.worst_deviations), HALVES)


@pytest.mark.parametrize("distribution", ["uniform", "normal"])
def test_the_spread_is_that_of_random_drivelines(distribution: Any) -> None:  # noqa: ANN401
    random = np.random.default_rng(5)
    if distribution == "normal":
        drawn = random.standard_normal((4000, 2, 3)) / 3.0
    else:
        drawn = random.uniform(-1.0, 1.0, (4000, 2, 3))
    sizes = order_1(drawn * HALVES)
    found = LINE.order_tolerances(*HALVES.T, distribution=distribution)
    assert found.rms == pytest.approx(np.sqrt(np.mean(sizes**2)), rel=0.03)
    for probability in (0.5, 0.95):
        assert found.quantile(probability) == pytest.approx(
            np.quantile(sizes, probability), rel=0.04
        )


def test_one_yoke_of_one_joint_adds_its_tolerance_times_the_tangent() -> None:
    found = Driveline.from_bends([0.2]).order_tolerances(0.001)
    assert found.worst == pytest.approx(0.001 * np.tan(0.2), rel=0.03)
    assert found.rms == pytest.approx(found.worst / np.sqrt(3.0), rel=1e-4)
    np.testing.assert_allclose(found.shares, [[1.0, 0.0, 0.0]], atol=1e-15)


def test_order_2_has_that_of_the_drawing() -> None:
    found = LINE.order_tolerances(cross=0.002, order=2)
    drawn = LINE.harmonics([2], outputs="angle_error").angle_error[0]
    assert abs(found.drawing) == pytest.approx(drawn, rel=1e-12)
    assert found.worst > drawn
    none = LINE.order_tolerances(order=2)
    assert none.worst == pytest.approx(drawn, rel=1e-12)
    assert np.array_equal(none.shares, np.zeros((2, 3)))


test_wrong_tolerances_are_refused = refusals(
    {
        "cross is -0.1": {"cross": -0.1},
        "order is 0; it must be at least 1": {"cross": 0.1, "order": 0},
        "distribution is 'flat'": {"cross": 0.1, "distribution": "flat"},
        "cannot turn": {"cross": 1.5},
        "driven_yoke has shape (3,)": {"driven_yoke": [0.1] * 3},
    },
    LINE.order_tolerances,
)

test_what_one_driveline_alone_has = refusals(
    {
        "it must be one driveline": lambda: LINE.reshape(1).order_tolerances(0.1),
        "probability is 1": lambda: FOUND.quantile(1.0),
    }
)
