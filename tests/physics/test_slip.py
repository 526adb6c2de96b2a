"""Lengths of shafts, engagement of splines, and the parts of their axial force."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cardan
from refusals import refusals

HEIGHTS = np.linspace(-0.12, 0.08, 41)


def axle(height: np.ndarray) -> np.ndarray:
    """Points of a shaft whose driven end rises and falls."""
    points = np.zeros((*height.shape, 4, 3))
    points[..., 1, :] = 0.3, 0.0, 0.0
    points[..., 2, :] = 1.5, 0.05, 0.1
    points[..., 3, :] = 1.8, 0.05, 0.1
    points[..., 2:, 1] += height[..., np.newaxis]
    return points


AXLES = cardan.Driveline.from_points(axle(HEIGHTS))


def test_lengths_over_a_batch() -> None:
    found = cardan.Driveline.from_points(axle(HEIGHTS)).lengths()
    middle = [math.dist((0.3, 0, 0), (1.5, 0.05 + y, 0.1)) for y in HEIGHTS.tolist()]
    assert found.each.shape == (41, 3)
    assert found.each[:, 1] == pytest.approx(middle, rel=1e-15)
    assert found.shortest == pytest.approx([0.3, min(middle), 0.3])
    assert found.longest == pytest.approx([0.3, max(middle), 0.3])
    assert found.travel[1] == pytest.approx(max(middle) - min(middle), rel=1e-12)
    assert np.abs(found.travel[[0, 2]]).max() < 1e-15
    single = cardan.Driveline.from_points(axle(HEIGHTS)[3]).lengths()
    assert single.travel.tolist() == [0.0, 0.0, 0.0]
    assert single.each.tolist() == found.each[3].tolist()


def test_a_longer_shaft_has_pulled_its_spline_out() -> None:
    found = cardan.Driveline.from_points(axle(HEIGHTS)).lengths()
    at = found.each[12, 1]
    left = found.engagement(1, 0.08, at)
    assert left[12] == pytest.approx(0.08)
    assert left + found.each[:, 1] == pytest.approx(0.08 + at)
    assert left.min() == pytest.approx(0.08 - (found.longest[1] - at))
    assert found.engagement(-2, [[0.08], [0.09]], at).shape == (2, 41)


def test_parts_along_and_across_the_next_shafts() -> None:
    lines = cardan.Driveline.from_points(axle(HEIGHTS))
    found = lines.spline_force(1, 400.0, friction=0.12, radius=0.02)
    for vector, along, across, u in (
        (found.upstream, found.upstream_axial, found.upstream_transverse, lines.directions[:, 0]),
        (
            -found.downstream,
            found.downstream_axial,
            found.downstream_transverse,
            lines.directions[:, 2],
        ),
    ):
        part = np.sum(vector * u, axis=-1)
        assert along == pytest.approx(part, rel=1e-12)
        assert across == pytest.approx(
            np.linalg.norm(vector - part[:, np.newaxis] * u, axis=-1), abs=1e-9
        )
        # Across, it points into the plane of the bend.
    assert np.hypot(along, across) == pytest.approx(found.axial, rel=1e-12)


def mounted(line: cardan.Driveline, *bearings: tuple[int, float]) -> cardan.Driveline:
    """The driveline with bearings at positions along its shafts."""
    shafts, places = zip(*bearings, strict=True)
    positions = np.broadcast_to(places, (*line.shape, len(places))).copy()
    return line._of(line._geometry._replace(bearings=shafts, positions=positions))


def test_what_the_bearings_of_the_next_shafts_give() -> None:
    """Forces and moments on each of these shafts balance."""
    bare = cardan.Driveline.from_points(axle(HEIGHTS))
    places = ((2, 0.06), (0, 0.05), (0, 0.2), (2, 0.16))
    found = mounted(bare, *places).spline_force(1, 400.0, 0.12, 0.02)
    assert found.bearings == (2, 0, 0, 2)
    assert found.bearing_force.shape == (4, 41, 3)
    for shaft, force, joint in ((0, found.upstream, 0.3), (2, found.downstream, 0.0)):
        u = bare.directions[:, shaft]
        across = force - np.sum(force * u, axis=-1, keepdims=True) * u
        own = [(found.bearing_force[i], at) for i, (of, at) in enumerate(places) if of == shaft]
        total = across + sum(given for given, _ in own)
        turning = joint * across + sum(at * given for given, at in own)
        assert np.abs(total).max() < 1e-9
        assert np.abs(turning).max() < 1e-9
    # (a + b)/b and a/b of the part across.
    sizes = np.linalg.norm(found.bearing_force, axis=-1)
    assert sizes[0] == pytest.approx(1.6 * found.downstream_transverse, abs=1e-9)
    assert sizes[3] == pytest.approx(0.6 * found.downstream_transverse, abs=1e-9)


@pytest.mark.parametrize(
    ("bearings", "message"),
    [
        ((), "the driveline has no bearings"),
        (((2, 0.1), (2, 0.2)), "shaft 0 has 0 bearings; two bear the part"),
        (((0, 0.1), (0, 0.2), (2, 0.1)), "shaft 2 has 1 bearing; two bear the part"),
    ],
)
def test_bearings_that_do_not_determine_it(
    bearings: tuple[tuple[int, float], ...], message: str
) -> None:
    line = cardan.Driveline.from_points(axle(np.array(0.06)))
    found = (mounted(line, *bearings) if bearings else line).spline_force(1, 1.0, 0.1, 0.02)
    assert found.axial == pytest.approx(5.0)
    with pytest.raises(ValueError, match=message):
        found.bearing_force  # noqa: B018


def test_lengths_given_with_the_bearings() -> None:
    line = cardan.Driveline.from_bends([0.1]).with_bearings([], lengths=[[0.5, 1.0], [0.5, 1.25]])
    assert line.lengths().travel.tolist() == [0.0, 0.25]


def test_the_representation_has_no_private_fields() -> None:
    line = cardan.Driveline.from_points(axle(np.array(0.06)))
    assert " _" not in repr(line.spline_force(1, 1.0, 0.1, 0.02))


def test_the_end_shafts_hold_themselves() -> None:
    line = cardan.Driveline.from_points(axle(np.array(0.06)))
    first, last = (line.spline_force(shaft, -100.0, 0.1, 0.02) for shaft in (0, -1))
    assert (first.upstream_axial, first.upstream_transverse) == (500.0, 0.0)
    assert first.downstream_transverse == pytest.approx(500.0 * math.sin(line.bends[0]))
    assert (last.downstream_axial, last.downstream_transverse) == (500.0, 0.0)
    assert last.upstream_axial == pytest.approx(500.0 * math.cos(line.bends[1]))


def test_everything_broadcasts() -> None:
    lines = cardan.Driveline.from_points(axle(HEIGHTS))
    found = lines.spline_force(1, np.ones((5, 1)), [[0.1]] * 5, 0.02)
    assert found.axial.shape == found.upstream_transverse.shape == (5, 41)
    assert found.upstream.shape == found.downstream.shape == (5, 41, 3)
    bends = cardan.Driveline.from_bends([0.2, 0.3])
    assert bends.spline_force(1, 1.0, 0.1, 0.1).upstream_axial == pytest.approx(math.cos(0.2))


test_refusals = refusals(
    {
        "others get them with with_bearings": lambda: cardan.Driveline.from_bends([0.1]).lengths(),
        "friction is -0.1; it must be finite": lambda: AXLES.spline_force(1, 1.0, -0.1, 0.02),
        "radius is 0.0; it must be positive": lambda: AXLES.spline_force(1, 1.0, 0.1, 0.0),
        "engaged is -1.0; it must be": lambda: AXLES.lengths().engagement(1, -1.0, 1.0),
        "length is 0.0; it must be": lambda: AXLES.lengths().engagement(1, 1.0, 0.0),
        "an empty batch has no shortest": lambda: AXLES[:0].lengths().travel,
        "shapes do not broadcast: driveline (41,), torque (2,)": lambda: AXLES.spline_force(
            1, [1.0, 2.0], 0.1, 0.02
        ),
    }
)


def test_shafts_that_do_not_exist() -> None:
    line = cardan.Driveline.from_points(axle(HEIGHTS))
    with pytest.raises(IndexError, match="shaft is 3"):
        line.spline_force(3, 1.0, 0.1, 0.02)
    with pytest.raises(IndexError, match="shaft is -4"):
        line.lengths().engagement(-4, 1.0, 1.0)
