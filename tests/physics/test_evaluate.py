"""Results against the vector model of ``cardan.reference`` and against independent numbers."""

from __future__ import annotations

import math
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from cardan import Driveline, Load, reference
from oracle import (
    EPS,
    angles,
    cosines,
    distinct,
    off_all,
    off_vectors,
    radians,
    read,
    start_angle,
    thoma_to_ours,
)

CHAINS = read("chains.json")["cases"]
KINEMATICS = read("single_kinematics.json")
MOMENTS = read("single_moments.json")["cases"]
MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
LOADS = ("torque", "support_moment", "moment", "bending_driving", "bending_driven")


def unit(line: Driveline) -> float:
    """Rounding of a few operations per joint, stretched as the joints stretch it."""
    return 32 * line.n_joints * EPS / float(np.prod(np.cos(line.bends))) ** 3


def expect_reference(
    line: Driveline, shafts: reference.Shafts, angle: float, load: dict[str, Any], close: float
) -> None:
    inertias = load["inertias"]
    got = line.evaluate(
        angle,
        (*MOTION, *LOADS, "tilt_driving", "tilt_driven"),
        shafts=slice(None),
        load=Load(**load),
    )
    for i in range(line.n_joints + 1):
        motion = reference.motion(shafts, angle, i)
        for name in MOTION:
            # The third derivative is stretched once more.
            stretch = 8 / cosines(shafts) if name == "jerk_ratio" else 1
            assert abs(got[name][i] - getattr(motion, name)) <= close * stretch, name
    want = reference.loads(shafts, angle, **load)
    scale = (
        1
        + float(np.max(np.abs(got.moment)))
        + sum(inertias) * (load["speed"] ** 2 + abs(load["acceleration"]))
    )
    for name in LOADS:
        assert np.max(np.abs(got[name] - np.array(getattr(want, name)))) <= close * scale, name
    tilts = np.array(reference.tilts(shafts, angle)).T
    assert np.max(np.abs(np.array([got.tilt_driving, got.tilt_driven]) - tilts)) <= close


loads = st.fixed_dictionaries(
    {
        "end": st.sampled_from(["drive_torque", "output_torque"]),
        "torque": st.floats(-10, 10),
        "speed": st.floats(-5, 5),
        "acceleration": st.floats(-5, 5),
        "seed": st.integers(0, 2**32 - 1),
    }
)


def load_of(draw: dict[str, Any], n: int) -> dict[str, Any]:
    inertias = np.random.default_rng(draw["seed"]).uniform(0, 1, n + 1).tolist()
    return {
        draw["end"]: draw["torque"],
        "speed": draw["speed"],
        "acceleration": draw["acceleration"],
        "inertias": inertias,
    }


@given(
    st.lists(st.one_of(st.just(0.0), st.floats(1e-5, 1.2)), min_size=1, max_size=5),
    st.lists(st.floats(-4, 4), min_size=8, max_size=8),
    st.floats(-20, 20),
    loads,
)
def test_bends_against_the_reference(
    bends: list[float], between: list[float], angle: float, load: dict[str, Any]
) -> None:
    n = len(bends)
    twists, phases = between[: n - 1], between[4 : 3 + n]
    line = Driveline.from_bends(bends, twists, phases)
    shafts = reference.from_bends(bends, twists, phases)
    assert np.max(np.abs(line.directions - np.array(shafts.directions))) < 8 * n * EPS
    assert np.max(np.abs(line.normals - np.array(shafts.normals))) < 8 * n * EPS
    expect_reference(line, shafts, angle, load_of(load, n), unit(line) * (1 + abs(angle)))


@given(
    st.integers(1, 4),
    st.integers(0, 2**32 - 1),
    st.lists(st.floats(-4, 4), min_size=3, max_size=3),
    st.floats(-20, 20),
    loads,
)
def test_points_against_the_reference(
    n: int, seed: int, between: list[float], angle: float, load: dict[str, Any]
) -> None:
    steps = np.random.default_rng(seed).uniform([1, -0.8, -0.8], [2, 0.8, 0.8], (n + 1, 3))
    points = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    phases = between[: n - 1]
    line = Driveline.from_points(points, phases)
    shafts = reference.from_points(points.tolist(), phases)
    # The plane of a joint is known as well as its bend allows.
    close = unit(line) * (1 + abs(angle)) * (1 + 1 / float(line.bends.min()))
    assert np.max(np.abs(line.bends - np.array(shafts.bends))) < 8 * EPS
    assert np.max(np.abs(line.directions - np.array(shafts.directions))) < 8 * EPS
    expect_reference(line, shafts, angle, load_of(load, n), close)


@pytest.mark.parametrize("case", CHAINS, ids=lambda case: case["name"])
def test_chains(case: dict[str, Any]) -> None:
    points = [[float(x) for x in point] for point in case["points"]]
    line = Driveline.from_points(points, [float(x) for x in case["yoke_phase"]])
    start = start_angle(case, tuple(line.directions[0]), tuple(line.normals[0]))
    static = Load(drive_torque=1.0)
    dynamic = Load(
        output_torque=-float(case["T_load"]),
        speed=float(case["omega0"]),
        acceleration=float(case["eps0"]),
        inertias=[float(x) for x in case["inertia"]],
    )
    # Of the largest component, a few 1e-15: two per joint, stretched as the joints stretch them.
    close = 2 * line.n_joints * EPS / float(np.prod(np.cos(line.bends))) ** 2
    first = line.evaluate(angles(case, start)[0], "angle", shafts=slice(None)).angle
    for angle, step in zip(angles(case, start), case["steps"], strict=True):
        motion = line.evaluate(angle, MOTION, shafts=slice(None))
        assert off_all(motion.speed_ratio, step["ratio"]) <= close
        assert off_all(motion.acceleration_ratio, step["accel_unit"]) <= 4 * close
        turned = motion.angle - first
        want = np.array([float(x) for x in step["theta"]])
        wrapped = (turned - want + math.pi) % (2 * math.pi) - math.pi
        assert np.max(np.abs(wrapped)) <= 16 * close
        for key, load in (("static_T0_1", static), ("dynamic", dynamic)):
            got = line.evaluate(angle, LOADS, shafts=slice(None), load=load)
            expected = step[key]
            scale = max(1.0, *(abs(float(x)) for v in expected["M"] for x in v))
            assert off_vectors(got.moment, expected["M"]) <= 2 * close * scale
            assert off_vectors(got.support_moment, expected["support_moment"]) <= 2 * close * scale
            assert off_all(got.bending_driving, expected["bend_on_driver"]) <= 2 * close * scale
            assert off_all(got.bending_driven, expected["bend_on_driven"]) <= 2 * close * scale


@pytest.mark.parametrize("bend", distinct(KINEMATICS["degrees"], "beta_deg"))
def test_single_joint_in_degrees(bend: str) -> None:
    rows = [row for row in KINEMATICS["degrees"] if row["beta_deg"] == bend]
    line = Driveline.from_bends([float(bend)], degrees=True)
    angle = np.array([radians(row["alpha1_deg"]) for row in rows])
    got = line.evaluate(angle, MOTION)
    # The rounding of bend and angle from degrees to radians is stretched once per power of cos.
    c = math.cos(math.radians(float(bend)))
    error = np.radians([float(row["delta_deg"]) for row in rows])
    assert np.max(np.abs(got.angle_error - error)) <= 4 * EPS / c
    assert off_all(got.speed_ratio, [row["ratio"] for row in rows]) <= 8 * EPS / c**2
    assert off_all(got.acceleration_ratio, [row["accel"] for row in rows]) <= 32 * EPS / c**3


@pytest.mark.parametrize("bend", distinct(MOMENTS, "beta_deg"))
def test_single_joint_moments(bend: str) -> None:
    line = Driveline.from_bends([float(bend)], degrees=True)
    c = math.cos(math.radians(float(bend)))
    for case in (case for case in MOMENTS if case["beta_deg"] == bend):
        angle = radians(case["phi_deg"])
        bend_radians = float(line.bends[0])
        got = line.evaluate(angle, ("moment", "torque"), load=Load(drive_torque=1.0))
        want = thoma_to_ours(bend_radians, case["static"]["M_on_shaft2_xyz"])
        assert off_vectors(got.moment, [want]) <= 8 * EPS / c**2
        flywheel = case["flywheel"]
        got = line.evaluate(angle, ("moment", "torque"), load=Load(speed=1.0, inertias=[0, 1]))
        # Thoma (8): the torque is that of the flywheel's acceleration, exactly.
        assert off_all([float(got.torque)], [flywheel["Mt"]]) <= 32 * EPS / c**3
        want = thoma_to_ours(bend_radians, flywheel["M_on_shaft2_xyz"])
        assert off_vectors(got.moment, [want]) <= 32 * EPS / c**3


def test_the_flywheel_takes_inertia_times_acceleration() -> None:
    line = Driveline.from_bends([8.5], degrees=True)
    angle = np.linspace(0, 7, 999)
    got = line.evaluate(
        angle, ("acceleration_ratio", "torque"), load=Load(speed=300.0, inertias=[0.0, 0.02])
    )
    assert got.torque == pytest.approx(0.02 * 300.0**2 * got.acceleration_ratio, rel=1e-14)
