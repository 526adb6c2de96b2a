"""What must hold for any driveline, whatever is built on its evaluation.

Derivatives, forces, torsional systems, tolerances, searches, life and ball joints: laws of scale
that hold to the last bit for powers of two, quantities that bound each other, and two ways to one
result.
"""

from __future__ import annotations

import math
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

import tiers
from cardan import BallJoint, Driveline, Load, Sweep, TorsionalSystem, optimise

few = settings(max_examples=tiers.part(20))
powers = st.integers(-8, 8).map(lambda n: 2.0**n)
angles = np.linspace(-2.0, 7.0, 41)
same = np.testing.assert_array_equal


@st.composite
def lines(draw: st.DrawFn, most: int = 4) -> Driveline:
    """Drivelines of moderate bends."""
    n = draw(st.integers(1, most))
    bends = draw(st.lists(st.floats(0.05, 0.9), min_size=n, max_size=n))
    turns = draw(st.lists(st.floats(-3.0, 3.0), min_size=2 * n - 2, max_size=2 * n - 2))
    return Driveline.from_bends(bends, turns[: n - 1], turns[n - 1 :])


@st.composite
def spans(draw: st.DrawFn) -> Any:  # noqa: ANN401 - an array
    """Points of three shafts that go about along x."""
    aside = draw(st.lists(st.floats(-0.2, 0.2), min_size=8, max_size=8))
    points = np.zeros((4, 3))
    points[:, 0] = 0.0, 0.3, 1.4, 1.8
    points[:, 1:] = np.reshape(aside, (4, 2))
    return points


@few
@given(lines())
def test_derivatives_by_the_angle_are_the_next_ratios(line: Driveline) -> None:
    names = ("angle", "speed_ratio", "acceleration_ratio")
    slopes = line.plan(names).derivatives(angles, "angle")
    next_ones = line.evaluate(angles, ("speed_ratio", "acceleration_ratio", "jerk_ratio"))
    for name, want in zip(names, next_ones.values(), strict=True):
        unit = np.max(np.abs(want))
        np.testing.assert_allclose(slopes[name]["angle"], want, rtol=0, atol=1e-12 * unit)


@few
@given(spans(), powers, powers)
def test_forces_scale_with_torque_and_length(points: Any, torque: float, length: float) -> None:  # noqa: ANN401
    def forces(scale: float, torque: float) -> Any:  # noqa: ANN401
        line = Driveline.from_points(scale * points, 0.4)
        ends = np.linalg.norm(np.diff(points, axis=0), axis=1)
        places = [(0, 0.25 * ends[0]), (0, 0.75 * ends[0]), (2, 0.5 * ends[2])]
        places += [(2, 0.875 * ends[2])]
        mounted = line.with_bearings([(shaft, scale * place) for shaft, place in places])
        names = ("joint_force", "bearing_force")
        return mounted.evaluate(Sweep(0.0, 3.0, 9), names, load=Load(output_torque=torque))

    one, other = forces(1.0, 8.0), forces(length, 8.0 * torque)
    for name, array in one.items():
        same(other[name], array * torque / length)


@few
@given(lines(3), powers, st.floats(0.5, 3.0))
def test_torsion_scales_with_inertia_and_time(
    line: Driveline, heavier: float, faster: float
) -> None:
    n = line.n_joints

    def torques(inertia: float, rate: float) -> Any:  # noqa: ANN401
        system = TorsionalSystem(
            line,
            inertias=inertia * np.tile([0.01, 0.04], (n + 1, 1)),
            drive="held",
            stiffnesses=[math.inf, *[inertia * rate**2 * 4000.0] * n],
            dampings=inertia * rate * 2.0,
            load_torque=inertia * rate**2 * 25.0,
        )
        return system.steady(rate * np.array([20.0, 70.0]))

    one, other = torques(1.0, 1.0), torques(heavier, faster)
    same(one.found, other.found)
    for name in ("torque_mean", "torque_min", "torque_max", "torque_orders"):
        want = getattr(one, name) * heavier * faster**2
        unit = np.max(np.abs(np.where(one.found, want, 0.0)))
        np.testing.assert_allclose(getattr(other, name), want, rtol=0, atol=1e-6 * unit)


@few
@given(lines(3), st.floats(0.001, 0.03), st.integers(0, 99))
def test_tolerances_bound_each_other(line: Driveline, size: float, seed: int) -> None:
    names = ("equivalent_bend", "non_uniformity", "max_angle_error")
    one, two = (
        line.tolerances(bends=size, of=names, samples=300, seed=seed, workers=workers)
        for workers in (1, 2)
    )
    batch = Driveline.concatenate([line.reshape(1), line.reshape(1)]).tolerances(
        bends=size, of=names, samples=300, seed=seed
    )
    for name in names:
        same(one.sampled[name], two.sampled[name])
        same(batch.sampled[name][1], one.sampled[name])
        bound = one.guaranteed[name] * (1.0 + 1e-12)
        assert one.nominal[name] <= one.worst[name] <= bound
        assert np.max(one.sampled[name]) <= bound
        assert one.quantile(1.0)[name] == np.max(one.sampled[name])


@settings(max_examples=tiers.part(8))
@given(st.floats(0.1, 0.6), st.floats(0.1, 0.6), st.floats(-3.0, 3.0), st.floats(-2.0, 2.0))
def test_a_search_is_never_worse_than_its_start(
    first: float, second: float, twist: float, start: float
) -> None:
    def lines_of(x: Any) -> Driveline:  # noqa: ANN401
        states = np.array([[first, second], [first + 0.05, second]])
        each = np.broadcast_to(states, (*np.shape(x)[:-1], 2, 2))
        return Driveline.from_bends(each, twist, np.asarray(x)[..., np.newaxis, :])

    one, again = (optimise(lines_of, [start], phases=[0], starts=2) for _ in "12")
    many = optimise(lines_of, [start], phases=[0], starts=2, vectorised=True)
    same(one.x, again.x)
    assert one.value <= one.before
    assert one.value == pytest.approx(many.value, rel=1e-5, abs=1e-9)
    # The best phase of two joints leaves the difference of the bends, at the larger state.
    best = max(
        lines_of(np.array([twist + math.pi / 2 * k]))[i].equivalent().bend
        for i in range(2)
        for k in [round((one.x[0] - twist) / (math.pi / 2))]
    )
    assert one.value <= best + 1e-9


@few
@given(lines(3), powers)
def test_life_follows_the_law_of_the_catalogue(line: Driveline, stronger: float) -> None:
    load = Load(output_torque=200.0, speed=90.0)
    one, other = (line.life(load, rating=rating) for rating in (700.0, 700.0 * stronger))
    np.testing.assert_allclose(other.hours, one.hours * stronger ** (10.0 / 3.0), rtol=1e-12)
    steps = Load(output_torque=[200.0, 200.0], speed=90.0)
    split = line.reshape(1).life(steps, rating=700.0, shares=[0.3, 0.7])
    np.testing.assert_allclose(split.hours, one.hours, rtol=1e-12)


@few
@given(st.floats(0.2, 1.5), st.floats(1e-6, 1e-4), st.floats(1.0, 1e6), powers)
def test_ball_joints(half_angle: float, clearance: float, load: float, larger: float) -> None:
    radii = np.array([0.01, 0.02, 0.04])
    joints = BallJoint(radii, half_angle).with_clearance(clearance, compliance=1e-13)
    peak = joints.peak_pressure(load)
    np.testing.assert_allclose(joints.allowable_load(peak), load, rtol=1e-8)
    # Everything larger alike, the load by the area: the same pressure.
    scaled = BallJoint(larger * radii, half_angle).with_clearance(
        larger * clearance, compliance=larger * 1e-13
    )
    np.testing.assert_allclose(scaled.peak_pressure(larger**2 * load), peak, rtol=1e-9)
    assert np.all(joints.peak_pressure(2.0 * load) > peak)
    for radius, want in zip(radii, peak, strict=True):
        alone = BallJoint(radius, half_angle).with_clearance(clearance, compliance=1e-13)
        assert alone.peak_pressure(load) == want
