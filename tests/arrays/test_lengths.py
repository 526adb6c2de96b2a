"""Drivelines from points remember the lengths of their shafts."""

import pickle

import numpy as np
import pytest

import cardan

POINTS = np.array([[0.0, 0, 0], [3, 4, 0], [3, 5, 1], [3.5, 7, 5], [5, 8, 8]])


def lengths(line: cardan.Driveline) -> np.ndarray:
    """What later calls of the driveline find."""
    return line._geometry.lengths


def test_lengths_are_the_distances_between_successive_points() -> None:
    expected = [5.0, np.sqrt(2.0), np.sqrt(20.25), np.sqrt(12.25)]
    np.testing.assert_allclose(lengths(cardan.Driveline.from_points(POINTS)), expected, rtol=1e-15)
    huge = cardan.Driveline.from_points(POINTS * 1e200)
    np.testing.assert_allclose(lengths(huge), 1e200 * np.array(expected), rtol=1e-15)
    tiny = cardan.Driveline.from_points(POINTS * 1e-200)
    np.testing.assert_allclose(lengths(tiny), 1e-200 * np.array(expected), rtol=1e-15)


def test_drivelines_made_otherwise_have_no_lengths() -> None:
    assert lengths(cardan.Driveline.from_bends([0.1, 0.2])).shape == (0,)
    assert lengths(cardan.Driveline.from_directions(POINTS[1:])).shape == (0,)


def test_lengths_follow_the_batch() -> None:
    batch = np.stack([POINTS, 2 * POINTS, 3 * POINTS])
    line = cardan.Driveline.from_points(batch, phases=np.zeros((2, 1, 2)))
    assert line.shape == (2, 3)
    one = lengths(cardan.Driveline.from_points(POINTS))
    expected = np.broadcast_to(one * np.array([[1], [2], [3]]), (2, 3, 4))
    for made, want in [
        (line, expected),
        (line[1, 2], expected[1, 2]),
        (line[:, None, ::-1], expected[:, None, ::-1]),
        (line.reshape(-1), expected.reshape(6, 4)),
        (line.with_phases(np.ones((5, 1, 1, 2))), np.broadcast_to(expected, (5, 2, 3, 4))),
        (line.reversed(), expected[..., ::-1]),
        (pickle.loads(pickle.dumps(line)), expected),
        (cardan.Driveline.concatenate([line, line[:1]]), np.concatenate([expected, expected[:1]])),
    ]:
        np.testing.assert_allclose(lengths(made), want, rtol=1e-15)
        assert not lengths(made).flags.writeable


def test_a_joined_batch_has_lengths_only_if_all_have() -> None:
    line = cardan.Driveline.from_points(POINTS)
    bare = cardan.Driveline.from_directions(line.directions)
    assert lengths(cardan.Driveline.concatenate([line, bare])).shape == (2, 0)


def test_evaluation_in_pieces_keeps_them() -> None:
    dask = pytest.importorskip("dask.array")
    line = cardan.Driveline.from_points(np.stack([POINTS, 2 * POINTS]))
    angle = dask.linspace(0.0, 1.0, 6, chunks=3)[:, None]
    result = line.evaluate(angle, "speed_ratio").compute()
    np.testing.assert_array_equal(
        result.speed_ratio, line.evaluate(np.linspace(0.0, 1.0, 6)[:, None]).speed_ratio
    )
