"""Vectors in axes that turn with their shafts, against the pins of the vector picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cardan import ArgumentValueError, Driveline, Load, Sweep, reference
from cardan.reference.forces import forces
from oracle import ExactTurn, mp, plan_at
from vectors import ExactLoads, Frames, MpVector, cross, dot, length

NAMES = ("moment", "support_moment")
LOADS: dict[str, dict[str, Any]] = {
    "drive": {"drive_torque": 7.0},
    "braked": {"drive_torque": -7.0},
    "output": {"output_torque": 7.0},
    "inertias": {"output_torque": 1.0, "speed": 30.0, "acceleration": 5.0, "inertias": 0.02},
}
LINE = Driveline.from_bends([0.5, 0.3, 0.8], [0.4, -2.0], [0.3, 1.1])
BATCH = Driveline.from_bends(
    [[[0.4, 0.3]], [[0.1, 0.9]], [[0.0, 0.0]]], 0.2, [[[0.7]], [[1.0]], [[0.3]]]
)
LOAD = Load(drive_torque=3.0, speed=20.0, inertias=[0.1, 0.02, 0.03])
LOAD_OF_FOUR = Load(drive_torque=3.0, speed=20.0, inertias=[0.1, 0.02, 0.03, 0.01])
ANGLES = np.linspace(-9.0, 30.0, 41)


def of_line(load: dict[str, Any], line: Driveline) -> dict[str, Any]:
    inertias = {"inertias": [load["inertias"]] * (line.n_joints + 1)} if "inertias" in load else {}
    return {**load, **inertias}


def exact(line: Driveline, angle: float, load: dict[str, Any]) -> dict[str, list[MpVector]]:
    """The vectors along each shaft, its pin and their cross product."""
    frames, at = Frames.of(line), ExactTurn.by(angle)
    loads, pins = ExactLoads.of(frames, at, **load), frames.pins(at)
    along = [pins[0][0], *(driven for _, driven in pins)]

    def components(vector: MpVector, shaft: int) -> MpVector:
        u, pin = frames.directions[shaft], along[shaft]
        return (dot(vector, u), dot(vector, pin), dot(vector, cross(u, pin)))

    return {
        "moment": [components(m, j + 1) for j, m in enumerate(loads.moment)],
        "support_moment": [components(m, i) for i, m in enumerate(loads.support_moment)],
    }


def worst(line: Driveline, angle: float, load: dict[str, Any], **options: Any) -> float:  # noqa: ANN401
    """The largest error in ulp of the largest moment of all joints."""
    result = line.evaluate(
        angle, NAMES, load=Load(**load), shafts=slice(None), axes="shaft", **options
    )
    wanted = exact(line, angle, load)
    largest = max(float(length(vector)) for vector in wanted["moment"])
    return max(
        float(abs(mp.mpf(float(got)) - want) / np.spacing(largest))
        for name in NAMES
        for vector, exact_vector in zip(result[name], wanted[name], strict=True)
        for got, want in zip(vector, exact_vector, strict=True)
    )


@given(
    st.lists(st.one_of(st.just(0.0), st.floats(1e-5, 1.5)), min_size=1, max_size=4),
    st.lists(st.floats(-4.0, 4.0), min_size=6, max_size=6),
    st.floats(-20.0, 20.0),
    st.sampled_from([*LOADS]),
    st.sampled_from([None, 0.0]),
)
def test_axes_of_the_vector_picture(
    bends: list[float], between: list[float], angle: float, load: str, tolerance: float | None
) -> None:
    n = len(bends)
    twists, phases = between[: n - 1], between[3 : n + 2]
    bearings = [(0, 0.2), (0, 0.7), *((shaft, 0.4) for shaft in range(1, n + 1))]
    lengths = [1.0] * (n + 1)
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    own = of_line(LOADS[load], line)
    names = (*NAMES, "joint_force", "bearing_force")
    got = line.evaluate(
        angle, names, shafts=slice(None), load=Load(**own), axes="shaft", tolerance=tolerance
    )
    shafts = reference.from_bends(bends, twists, phases)
    loads, turning = reference.loads(shafts, angle, **own), reference.turning_axes(shafts, angle)
    supported = forces(shafts, loads, lengths, bearings)
    driven = range(1, n + 1)
    wanted = {
        "moment": (driven, loads.moment),
        "support_moment": (range(n + 1), loads.support_moment),
        "joint_force": (driven, supported.joint_force),
        "bearing_force": ([shaft for shaft, _ in bearings], supported.bearing_force),
    }
    # Steep joints stretch the rounding of the vectors, once in the pins and once in the loads.
    close = 4e-14 * (1.0 + abs(angle)) / math.prod(map(math.cos, bends)) ** 2
    for pair in (names[:2], names[2:]):
        vectors = [vector for name in pair for vector in wanted[name][1]]
        largest = max(map(math.hypot, *zip(*vectors, strict=True)))
        for name in pair:
            for found, shaft, vector in zip(got[name], *wanted[name], strict=True):
                components = np.array(turning[shaft]) @ np.array(vector)
                np.testing.assert_allclose(found, components, rtol=0.0, atol=close * largest)


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("joints", [1, 2, 4])
def test_components_are_those_along_shaft_and_pin(joints: int, load: dict[str, Any]) -> None:
    random = np.random.default_rng(joints)
    for tolerance, permitted in ((None, 8.0), (0.0, 3.0)):
        for _ in range(8):
            bends, between = random.uniform(0, 0.9, joints), random.uniform(-4, 4, (2, joints - 1))
            line = Driveline.from_bends(bends, *between)
            angle = float(random.uniform(-20, 20))
            off = worst(line, angle, of_line(load, line), tolerance=tolerance)
            assert off <= permitted, (bends, between, angle)


@given(
    st.lists(st.one_of(st.just(0.0), st.floats(1e-9, 1.5)), min_size=1, max_size=3),
    st.lists(st.floats(-4.0, 4.0), min_size=4, max_size=4),
    st.floats(-1e6, 1e6),
    st.sampled_from([*LOADS]),
)
def test_any_driveline(bends: list[float], between: list[float], angle: float, load: str) -> None:
    n = len(bends)
    line = Driveline.from_bends(bends, between[: n - 1], between[2 : n + 1])
    # Shafts between steep joints amplify the rounding of the chain.
    amplified = 1.0 / math.prod(math.cos(bend) for bend in bends)
    assert worst(line, angle, of_line(LOADS[load], line), tolerance=0) <= 4.0 * amplified


def test_a_steep_joint_keeps_its_digits() -> None:
    line = Driveline.from_bends([math.radians(89.9999)])
    for angle in (0.0, 1e-7, 0.3, math.pi / 2, 3.1):
        assert worst(line, angle, {"drive_torque": 2.0}, tolerance=0) <= 2.0


def test_the_moment_is_torque_and_bending() -> None:
    names = ("moment", "torque", "bending_driven")
    result = LINE.evaluate(ANGLES, names, shafts=[1, 2, 3], load=LOAD_OF_FOUR, axes="shaft")
    x, y, z = np.moveaxis(result.moment, -1, 0)
    # The torque is the power over the speed ratio, the moment a function of the torsion.
    np.testing.assert_array_max_ulp(x, result.torque, 4)
    assert not np.any(y)
    assert np.array_equal(np.abs(z), result.bending_driven)
    # The pin is back after a turn and reversed after half of one.
    for turn, sign in ((2.0 * math.pi, 1.0), (math.pi, -1.0)):
        later = LINE.evaluate(ANGLES + turn, "moment", load=LOAD_OF_FOUR, axes="shaft").moment[
            ..., 2
        ]
        assert later == pytest.approx(sign * z, abs=1e-12)


def test_lengths_are_those_in_space() -> None:
    options: dict[str, Any] = {"shafts": slice(None), "load": LOAD_OF_FOUR}
    space = LINE.evaluate(ANGLES, NAMES, **options)
    shaft = LINE.evaluate(ANGLES, NAMES, **options, axes="shaft")
    for name in NAMES:
        lengths = np.linalg.norm(space[name], axis=-1)
        assert np.linalg.norm(shaft[name], axis=-1) == pytest.approx(lengths, rel=1e-12)
    one = LINE.evaluate(ANGLES, NAMES, **options, reduce="peak")
    assert one == LINE.evaluate(ANGLES, NAMES, **options, reduce="peak", axes="shaft")


def test_batches_sweeps_and_items() -> None:
    names = ("speed_ratio", *NAMES)
    options: dict[str, Any] = {"load": LOAD, "axes": "shaft", "joints": 1, "shafts": [2, 0]}
    whole = BATCH.evaluate(ANGLES, names, **options)
    assert whole.moment.shape == (3, 41, 3)
    assert whole.support_moment.shape == (2, 3, 41, 3)
    for i, line in enumerate(BATCH[:, 0]):
        own = line.evaluate(ANGLES, names, **options)
        assert np.array_equal(own.moment, whole.moment[i])
        assert np.array_equal(own.support_moment, whole.support_moment[:, i])
    all_of_it = LINE.evaluate(ANGLES, NAMES, load=LOAD_OF_FOUR, axes="shaft", shafts=slice(None))
    some = LINE.evaluate(ANGLES, NAMES, load=LOAD_OF_FOUR, axes="shaft", joints=[2, 0], shafts=1)
    assert np.array_equal(some.moment, all_of_it.moment[[2, 0]])
    assert np.array_equal(some.support_moment, all_of_it.support_moment[1])
    sweep = Sweep(-9.0, 30.0, 41)
    swept = LINE.evaluate(sweep, NAMES, load=LOAD_OF_FOUR, axes="shaft", shafts=slice(None))
    for name in NAMES:
        assert swept[name] == pytest.approx(all_of_it[name], abs=1e-12)


@pytest.mark.parametrize("line", [LINE, BATCH], ids=["one", "batch"])
def test_reductions(line: Driveline) -> None:
    load = Load(drive_torque=3.0, speed=20.0, inertias=[0.01] * (line.n_joints + 1))
    options: dict[str, Any] = {"load": load, "axes": "shaft", "shafts": slice(None)}
    for angle in (ANGLES, Sweep.revolutions(1, 50)):
        samples = line.evaluate(angle, NAMES, **options)
        found = line.evaluate(angle, NAMES, reduce=["min", "max", "mean", "rms"], **options)
        for name in NAMES:
            array = samples[name]
            wanted = [f(array, axis=-2) for f in (np.min, np.max, np.mean)]
            wanted.append(np.sqrt(np.mean(array**2, axis=-2)))
            assert found[name] == pytest.approx(np.stack(wanted, axis=1), abs=1e-13)
    with_none = line.evaluate([1.0, math.nan], NAMES, reduce="max", **options)
    assert np.isnan(with_none.moment).all()


def test_reductions_of_loads_that_change_with_the_angle() -> None:
    load = Load(drive_torque=np.linspace(-1.0, 1.0, 41))
    found = LINE.evaluate(ANGLES, "moment", load=load, axes="shaft", reduce="max")
    samples = LINE.evaluate(ANGLES, "moment", load=load, axes="shaft")
    assert np.array_equal(found.moment, samples.moment.max(axis=1))


def test_arrays_to_fill_and_single_precision() -> None:
    plan = LINE.plan(("torque", "moment"), load=LOAD_OF_FOUR, axes="shaft", dtype=np.float32)
    new = plan(ANGLES)
    assert new.moment.dtype == np.float32
    double = LINE.evaluate(ANGLES, "moment", load=LOAD_OF_FOUR, axes="shaft").moment
    assert new.moment == pytest.approx(double, rel=1e-4, abs=1e-4)
    out = {"moment": np.empty((3, 41, 3), np.float32), "torque": np.empty(41, np.float32)}
    filled = plan(ANGLES, out=out)
    assert filled.moment is out["moment"]
    assert filled == new
    with pytest.raises(ArgumentValueError, match=r"out\['moment'\] has shape \(3,\)"):
        plan(ANGLES, out={"moment": np.empty(3, np.float32)})


@pytest.mark.parametrize("shape", [(0,), (0, 3), (3, 0)])
def test_no_angles_give_no_vectors(shape: tuple[int, ...]) -> None:
    result = LINE.evaluate(np.empty(shape), NAMES, load=LOAD_OF_FOUR, axes="shaft", shafts=[0, 2])
    assert result.moment.shape == (3, *shape, 3)
    assert result.support_moment.shape == (2, *shape, 3)


@pytest.mark.parametrize("reduce", [None, "mean"])
def test_no_drivelines_give_no_vectors(reduce: Any) -> None:  # noqa: ANN401
    got = BATCH[:0].evaluate(ANGLES, "moment", load=LOAD, axes="shaft", reduce=reduce)
    assert got == BATCH[:0].evaluate(ANGLES, "moment", load=LOAD, reduce=reduce)


def test_what_has_no_components_does_not_change() -> None:
    for names in ("angle", ("torque", "bending_driving")):
        one, other = (
            LINE.evaluate(ANGLES, names, load=LOAD_OF_FOUR, axes=a) for a in ("space", "shaft")
        )
        assert one == other


def test_no_angle_has_no_vector() -> None:
    result = LINE.evaluate([math.nan, 1.0], NAMES, load=LOAD_OF_FOUR, axes="shaft")
    assert np.isnan(result.moment[:, 0]).all()
    assert np.isnan(result.support_moment[0]).all()
    assert np.isfinite(result.moment[:, 1]).all()


@pytest.mark.parametrize("value", ["shafts", None, 3, ["shaft"]])
def test_unknown_axes_are_refused(value: Any) -> None:  # noqa: ANN401
    with pytest.raises(ArgumentValueError, match=r"axes is .*; it must be 'space' or 'shaft'"):
        LINE.evaluate(ANGLES, axes=value)


@pytest.mark.parametrize("joints", [1, 2, 4])
@pytest.mark.parametrize("tolerance", [None, 0.0])
def test_forces_are_turned_to_shaft_and_pin(joints: int, tolerance: float | None) -> None:
    """Components of the forces in space, along the exact pins."""
    random = np.random.default_rng(joints)
    for _ in range(8):
        bends, between = random.uniform(0, 0.9, joints), random.uniform(-4, 4, (2, joints - 1))
        bearings = [(0, 0.2), (0, 0.7), *((shaft, 0.4) for shaft in range(1, joints + 1))]
        line = Driveline.from_bends(bends, *between).with_bearings(bearings, np.ones(joints + 1))
        angle = float(random.uniform(-20, 20))
        options: dict[str, Any] = {"load": Load(drive_torque=7.0), "tolerance": tolerance}
        names = ("joint_force", "bearing_force")
        space = line.evaluate(angle, names, **options)
        turned = line.evaluate(angle, names, **options, axes="shaft")
        frames = Frames.of(line)
        pins = frames.pins(ExactTurn.by(angle))
        along = [pins[0][0], *(driven for _, driven in pins)]
        shafts = {"joint_force": range(1, joints + 1), "bearing_force": [s for s, _ in bearings]}
        largest = max(np.linalg.norm(space[name], axis=-1).max() for name in names)
        for name in names:
            for force, got, shaft in zip(space[name], turned[name], shafts[name], strict=True):
                u, pin = frames.directions[shaft], along[shaft]
                wanted = [float(dot(force.tolist(), axis)) for axis in (u, pin, cross(u, pin))]
                np.testing.assert_allclose(got, wanted, rtol=0, atol=8 * np.spacing(largest))


def test_forces_with_moments_batches_and_reductions() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0.1, 0.2], [3, 0.1, -0.1]])
    line = Driveline.from_points(points * np.array([1.0, 1.1])[:, None, None, None])
    line = line.with_bearings([(0, 0.2), (0, 0.7), (1, 0.4), (2, 0.5)])
    names = ("bearing_force", "torque", "moment", "joint_force")
    for angle in (ANGLES, Sweep(-9.0, 30.0, 41)):
        whole = line.evaluate(angle, names, load=LOAD, axes="shaft")
        for i, own in enumerate(line[:, 0]):
            alone = own.evaluate(angle, names, load=LOAD, axes="shaft")
            np.testing.assert_array_equal(whole.torque[i], alone.torque)
            for name in ("bearing_force", "moment", "joint_force"):
                np.testing.assert_array_equal(whole[name][:, i], alone[name])
        largest = line.evaluate(angle, names, load=LOAD, axes="shaft", reduce="max")
        np.testing.assert_array_equal(largest.bearing_force, whole.bearing_force.max(axis=-2))
        one = line.evaluate(angle, "joint_force", load=LOAD, axes="shaft", joints=1)
        np.testing.assert_array_equal(one.joint_force, whole.joint_force[1])
    text = line.plan(names, load=LOAD, axes="shaft").explain()
    assert "bearing 2: force, a sum of 6 terms, turned with the pin of shaft 1" in text


def test_plans_of_joints_as_built_have_axes_at_rest() -> None:
    line = LINE.with_deviations(cross=0.01)
    with pytest.raises(ArgumentValueError, match="axes is 'shaft'; moment is known in 'space'"):
        plan_at(line, "moment", load=LOAD_OF_FOUR, axes="shaft")


def test_labels_and_arrays_computed_later() -> None:
    array = pytest.importorskip("dask.array")
    expected = LINE.evaluate(ANGLES, NAMES, load=LOAD_OF_FOUR, axes="shaft")
    later = LINE.evaluate(
        array.from_array(ANGLES, chunks=9), NAMES, load=LOAD_OF_FOUR, axes="shaft"
    )
    assert later.compute() == expected
    lines = Driveline.from_bends(array.from_array(BATCH.bends), 0.2, BATCH.phases)
    batch = lines.evaluate(ANGLES, NAMES, load=LOAD, axes="shaft", reduce="max").compute()
    assert batch == BATCH.evaluate(ANGLES, NAMES, load=LOAD, axes="shaft", reduce="max")
    xarray = pytest.importorskip("xarray")
    data = LINE.evaluate(
        xarray.DataArray(ANGLES, dims="time"), NAMES, load=LOAD_OF_FOUR, axes="shaft"
    )
    assert np.array_equal(data.moment, expected.moment)


def test_the_plan_explains_its_axes() -> None:
    names = ("angle", *NAMES)
    options: dict[str, Any] = {"load": LOAD_OF_FOUR, "shafts": slice(None)}
    text = LINE.plan(names, **options, axes="shaft").explain()
    assert "joint 1: moment in axes that turn with its shaft, support moments in axes" in text
    assert "in axes" not in LINE.plan(names, **options).explain()
    # Lengths have no axes.
    for reduce, name in (("peak", "moment"), (None, "torque")):
        options["reduce"] = reduce
        turning = LINE.plan(name, **options, axes="shaft").explain(ANGLES)
        assert turning == LINE.plan(name, **options).explain(ANGLES)


def test_over_the_driven_angle() -> None:
    plan = LINE.plan(NAMES, load=LOAD_OF_FOUR, axes="shaft", angle_of="driven")
    result = plan(ANGLES)
    again = LINE.evaluate(result.drive_angle, NAMES, load=LOAD_OF_FOUR, axes="shaft")
    # The drive angles of the plan have an error term, which those of the result lack.
    for name in NAMES:
        size = np.abs(again[name]).max()
        np.testing.assert_allclose(result[name], again[name], rtol=0.0, atol=1e-14 * size)
