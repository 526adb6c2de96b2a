"""Gradients and derivatives over batches, sweeps and threads, and what they refuse."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import OUTPUTS, Driveline, Load, Sweep, _core
from oracle import plan_at
from refusals import refusals

MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
PINS = tuple(name for name, own in OUTPUTS.items() if own.vector and own.of_cross)
LOADS = tuple(
    name for name, own in OUTPUTS.items() if own.unit != "N" and name not in (*MOTION, *PINS)
)
POINTS = np.array([[0, 0, 0], [1, 0.1, 0], [2, 0.3, 0.4], [3.2, 0.3, 0.3], [4, 0.2, 0.2]])
RNG = np.random.default_rng(20261122)
BATCH = Driveline.from_points(POINTS + RNG.normal(0, 0.05, (3, 1, 5, 3)), [0.3, 0.4])
LOAD = Load(output_torque=10.0, speed=3.0, inertias=[0.1, 0.2, 0.3, 0.4])
ONE = Driveline.from_bends([0.3, 0.2], 0.4, -1.1)


def close(got: Any, want: Any) -> bool:  # noqa: ANN401
    return bool(np.max(np.abs(got - want)) <= 1e-12 * np.max(np.abs(want)))


@pytest.mark.parametrize(
    ("names", "load"),
    [(MOTION, None), (MOTION + LOADS, LOAD), (MOTION + PINS, None)],
    ids=["motion", "load", "pins"],
)
@pytest.mark.parametrize("line", [BATCH[0, 0], BATCH], ids=["one", "batch"])
@pytest.mark.parametrize(
    "angle",
    [0.3, np.linspace(-3, 9, 1001), Sweep.revolutions(1, 700), RNG.normal(size=(4, 3, 7))],
    ids=["scalar", "array", "sweep", "axes"],
)
def test_gradients_are_sums_of_derivatives(
    names: tuple[str, ...],
    line: Driveline,
    angle: Any,  # noqa: ANN401
    load: Load | None,
) -> None:
    plan = line.plan(names, shafts=slice(None), load=load)
    result = plan(angle)
    weights = {name: RNG.normal(size=result[name].shape) for name in names}
    gradient = plan.gradient(angle, weights)
    by = ("bends", "twists", "phases", "points", *(("output_torque", "inertias") if load else ()))
    derivatives = plan.derivatives(angle, by)
    shape = np.broadcast_shapes(line.shape, np.shape(angle))
    padded = (1,) * (len(shape) - len(line.shape)) + line.shape
    summed = tuple(axis for axis, length in enumerate(padded) if length == 1)
    value: Any = 0.0
    totals: dict[str, Any] = dict.fromkeys(by, 0.0)
    for name in names:
        vector = cardan.OUTPUTS[name].vector
        part = weights[name] * result[name]
        value = value + (part.sum(axis=-1) if vector else part).sum(axis=0)
        for kind in by:
            derivative = derivatives[name][kind]
            own = {"points": 2, "output_torque": 0}.get(kind, 1)
            assert derivative.shape[: derivative.ndim - own] == result[name].shape
            weight = weights[name].reshape(weights[name].shape + (1,) * own)
            part = weight * derivative
            totals[kind] = totals[kind] + (part.sum(axis=1 + len(shape)) if vector else part).sum(0)
    assert gradient.value.shape == line.shape
    assert close(gradient.value, value.sum(axis=summed).reshape(line.shape))
    for kind in by:
        want = totals[kind].sum(axis=summed)
        got = getattr(gradient, kind)
        assert got.shape == line.shape + want.shape[want.ndim - (got.ndim - len(line.shape)) :]
        assert close(got, want.reshape(got.shape))


@pytest.mark.parametrize("end", ["drive_torque", "output_torque"])
@pytest.mark.parametrize("count", [1, 15, 16, 128, 300])
def test_loads_of_each_sample(end: str, count: int) -> None:
    # Few samples, whole chunks and part of one are summed in different ways.
    inertias = RNG.uniform(0.1, 1.0, (count, 4))
    inertias[:, 2] = 0.0
    torque, speed, acceleration = RNG.uniform(-4.0, 4.0, (3, count))
    load = Load(**{end: torque}, speed=speed, acceleration=acceleration, inertias=inertias)
    line = BATCH[1, 0].with_bearings([(0, 0.2), (0, 0.7), (1, 0.5)])
    names = (*LOADS, "speed_ratio", "joint_force", "bearing_force")
    plan, angle = line.plan(names, shafts=[0, 3, 1], load=load), RNG.uniform(-9, 9, count)
    result = plan(angle)
    weights = {name: RNG.normal(size=result[name].shape) for name in names}
    gradient = plan.gradient(angle, weights)
    assert close(gradient.value, sum(np.sum(weights[name] * result[name]) for name in names))
    by = ("bends", "twists", "phases", "points", end, "inertias", "lengths", "positions")
    derivatives = plan.derivatives(angle, by)
    scale = 1e-3 * np.max(np.abs(gradient.bends))
    for kind in by:
        want = sum(
            np.tensordot(weights[name], derivatives[name][kind], weights[name].ndim)
            for name in names
        )
        got = getattr(gradient, kind)
        assert np.max(np.abs(got - want)) <= 1e-12 * max(scale, np.max(np.abs(want))), kind


def test_a_driveline_for_each_angle() -> None:
    lines = Driveline.from_bends(RNG.uniform(0.1, 0.6, (50, 3)), 0.3, 0.2)
    angle = RNG.uniform(-3, 3, 50)
    whole = lines.plan("speed_ratio").gradient(angle, {"speed_ratio": 2.0})
    assert whole.bends.shape == (50, 3)
    for i in range(50):
        alone = lines[i].plan("speed_ratio").gradient(angle[i], {"speed_ratio": 2.0})
        assert np.array_equal(alone.bends, whole.bends[i])
        assert alone.value == whole.value[i]
    sweep = lines.plan("speed_ratio").gradient(Sweep(0.0, 1.0, 50), {"speed_ratio": 1.0})
    array = lines.plan("speed_ratio").gradient(np.linspace(0.0, 1.0, 50), {"speed_ratio": 1.0})
    assert close(sweep.phases, array.phases)


@pytest.mark.parametrize("load", [None, LOAD], ids=["motion", "load"])
def test_any_number_of_threads_has_the_same_bits(load: Load | None) -> None:
    names = ("acceleration_ratio", "angle_error", *(("moment",) if load else ()))
    angle = RNG.uniform(-10, 10, 70_001)
    found = []
    for workers in (1, 2, 4):
        plan = BATCH[0, 0].plan(names, load=load, workers=workers)
        gradient = plan.gradient(angle, dict.fromkeys(names, 0.7))
        found.append((gradient.value, gradient.points.tobytes(), gradient.phases.tobytes()))
    assert found[0] == found[1] == found[2]


@pytest.mark.parametrize("leans", [False, True], ids=["ideal", "as built"])
def test_gradients_of_many_samples_are_sums_of_those_of_pieces(leans: bool) -> None:
    # Many samples are summed block by block, and the blocks by several threads.
    count, size = 20_000, 4_000
    line = ONE.with_deviations(0.01, -0.02, 0.03) if leans else BATCH[2, 0]
    names = ("angle_error", "acceleration_ratio", "moment")
    angle, speed, weights = *RNG.uniform(-9, 9, (2, count)), RNG.normal(size=(3, count))
    inertias = RNG.uniform(0.1, 1.0, (count, line.n_joints + 1))

    def gradient(part: slice) -> Any:  # noqa: ANN401
        load = Load(output_torque=10.0, speed=speed[part], inertias=inertias[part])
        plan = line.plan(names, shafts=line.n_joints, joints=0, load=load)
        weight = dict(zip(names, weights[:, part], strict=True))
        weight["moment"] = weight["moment"][..., np.newaxis] * [1.0, -0.5, 0.3]
        return plan.gradient(angle[part], weight)

    whole = gradient(slice(None))
    pieces = [gradient(slice(first, first + size)) for first in range(0, count, size)]
    own = ("deviations",) if leans else ("points",)
    for name in ("value", "bends", "twists", "phases", "output_torque", "inertias", *own):
        parts = np.array([getattr(piece, name) for piece in pieces])
        scale = np.max(np.sum(np.abs(parts), axis=0))
        assert np.max(np.abs(getattr(whole, name) - parts.sum(axis=0))) <= 1e-12 * scale, name


def test_far_angles_and_sweeps_agree_with_arrays() -> None:
    plan = ONE.plan(("speed_ratio", "angle_error"))
    weights = {"speed_ratio": 1.0, "angle_error": 0.3}
    far = np.array([1e15, -3e300, 2.5])
    one_by_one = [plan.gradient(x, weights).bends for x in far]
    assert close(plan.gradient(far, weights).bends, np.sum(one_by_one, axis=0))
    sweep = Sweep.revolutions(3, 5000)
    assert close(
        plan.gradient(sweep, weights).phases, plan.gradient(np.asarray(sweep), weights).phases
    )


def test_nan_stays_in_its_sample_of_derivatives_and_spoils_a_sum() -> None:
    plan = ONE.plan("speed_ratio")
    found = plan.derivatives([0.3, np.nan, 0.5], "bends")["speed_ratio"]["bends"]
    assert np.isnan(found).all(axis=-1).tolist() == [False, True, False]
    assert np.isnan(plan.gradient([0.3, np.nan], {"speed_ratio": 1.0}).bends).all()


def test_outputs_without_weights_do_not_count() -> None:
    plan = ONE.plan(("angle", "speed_ratio"))
    alone = ONE.plan("speed_ratio").gradient([0.3, 0.9], {"speed_ratio": 1.0})
    assert close(plan.gradient([0.3, 0.9], {"speed_ratio": [1.0, 1.0]}).bends, alone.bends)
    assert not plan.gradient([0.3, 0.9], {}).bends.any()


def test_empty_calls_have_the_shapes_of_others() -> None:
    plan = BATCH.plan("moment", load=LOAD)
    gradient = plan.gradient(np.empty(0), {"moment": 1.0})
    assert gradient.points.shape == (3, 1, 5, 3)
    assert not gradient.points.any()
    found = plan.derivatives(np.empty(0), ("points", "angle"))["moment"]
    assert found["points"].shape == (3, 3, 0, 3, 5, 3)
    assert found["angle"].shape == (3, 3, 0, 3)


def test_lines_made_from_points_remember_it() -> None:
    assert BATCH.has_points
    for line in (
        BATCH[0],
        BATCH.reshape(3),
        BATCH.with_phases(0.1),
        BATCH.reversed(),
        Driveline.concatenate([BATCH, BATCH]),
        pickle.loads(pickle.dumps(BATCH)),
        BATCH.with_bearings([(1, 0.5)]),
    ):
        assert line.has_points
    assert not ONE.has_points
    assert not BATCH.with_bearings([], lengths=np.ones(4)).has_points
    assert not ONE.with_bearings([], lengths=np.ones(3)).has_points


@pytest.mark.parametrize("by", ["bends", "twists", "phases", "points"])
def test_derivatives_of_q_over_batches(by: Any) -> None:  # noqa: ANN401
    many = Driveline.from_points(POINTS + RNG.normal(0, 0.05, (1500, 5, 3)), [0.3, 0.4])
    transmission = many.transmission(2)
    dq, d_abs2 = transmission.dq(by), transmission.d_abs2(by)
    for i in (0, 700, 1499):
        assert np.array_equal(many[i].transmission(2).dq(by), dq[i])
        assert np.array_equal(many[i].transmission(2).d_abs2(by), d_abs2[i])
    if by != "points":
        # Nothing behind the shaft acts on it.
        assert not dq[:, 2 if by == "bends" else 1 :].any()
    assert dq[:, 0].any()


def test_missing_derivatives_say_what_they_need() -> None:
    gradient = ONE.plan("speed_ratio").gradient(0.3, {"speed_ratio": 1.0})
    for name, need in (
        ("points", "a driveline made from points"),
        ("inertias", "a load"),
        ("drive_torque", "a load with a drive_torque"),
    ):
        assert not hasattr(gradient, name)
        with pytest.raises(AttributeError, match=need):
            getattr(gradient, name)
    loaded = ONE.plan("torque", load=Load(drive_torque=1.0)).gradient(0.3, {"torque": 1.0})
    assert loaded.drive_torque.shape == ()
    assert not hasattr(loaded, "output_torque")
    assert not hasattr(loaded, "lengths")
    mounted = BEARINGS.plan("bearing_force", load=TORQUE).gradient(0.3, {"bearing_force": 1.0})
    assert (mounted.lengths.shape, mounted.positions.shape) == ((3,), (2,))


@pytest.mark.parametrize("level", _core.levels())
def test_every_level_has_the_same_bits(level: str) -> None:
    lines = BATCH.with_bearings([(0, 0.2), (0, 0.7), (1, 0.5)])
    forces = ("joint_force", "bearing_force")
    cases: list[tuple[tuple[str, ...], Load | None]] = [
        (MOTION, None),
        (MOTION + LOADS + forces, LOAD),
    ]
    for names, load in cases:
        for angle in (RNG.uniform(-20, 20, 1501), Sweep(0.1, 43.0, 1100), np.array([1e15, 0.2])):
            found = []
            for forced in (None, level):
                plan = plan_at(lines, names, load=load, level=forced)
                result = plan.gradient(angle, dict.fromkeys(names, 0.7))
                each = plan.derivatives(angle[:3] if isinstance(angle, np.ndarray) else 0.3)
                found.append(
                    (
                        *(getattr(result, kind).tobytes() for kind in ("value", "bends", "points")),
                        *(array.tobytes() for kinds in each.values() for array in kinds.values()),
                    )
                )
            assert found[0] == found[1]


PLAN = ONE.plan("speed_ratio")
BEARINGS = ONE.with_bearings([(0, 0.2), (0, 0.7)], lengths=[1.0, 1.0, 1.0])
TORQUE = Load(output_torque=1.0)


test_refusals = refusals(
    {
        "did you mean 'bends'": lambda: PLAN.derivatives(0.1, "bend"),
        "again": lambda: PLAN.derivatives(0.1, ("bends", "bends")),
        "TypeError: must be a name": lambda: PLAN.derivatives(0.1, 3),  # type: ignore[arg-type]
        "by[0] is 'points'; only drivelines from points": lambda: PLAN.derivatives(0.1, "points"),
        "'inertias'; the plan has no load": lambda: PLAN.derivatives(0.1, "inertias"),
        "'drive_torque'; the plan has no load": lambda: PLAN.derivatives(0.1, "drive_torque"),
        "TypeError: angle": lambda: PLAN.derivatives("a"),
        "TypeError: must map names": lambda: PLAN.gradient(0.1, 3.0),  # type: ignore[arg-type]
        "not an output of the plan": lambda: PLAN.gradient(0.1, {"angle": 1.0}),
        "d_abs2(by)": lambda: PLAN.gradient(0.1, {"bend": 1.0}),
        "shape (3,); it must be (2,)": lambda: PLAN.gradient(
            [0.1, 0.2], {"speed_ratio": [1.0] * 3}
        ),
        "the driveline does not have": lambda: PLAN.derivatives(0.1, "lengths"),
        "has no bearings": lambda: PLAN.derivatives(0.1, "positions"),
        "broadcast": lambda: BATCH.plan().derivatives(np.zeros((2, 2, 2))),
        "by is 'angle'": lambda: ONE.transmission().dq("angle"),  # type: ignore[arg-type]
        "only drivelines from points": lambda: ONE.transmission().dq("points"),
        "TypeError: d_abs2": lambda: ONE.transmission().d_bend(),
    }
)


def test_axes_of_a_batch_behind_those_of_the_angles() -> None:
    bends = np.random.default_rng(3).uniform(0.1, 0.6, (2, 3, 2))
    line, angle = Driveline.from_bends(bends), np.linspace(0.2, 2.9, 4).reshape(4, 1, 1)
    found = line.plan(("speed_ratio", "moment"), load=Load(drive_torque=3.0)).derivatives(
        angle, ("bends", "angle")
    )
    for place in np.ndindex(2, 3):
        plan = line[place].plan(("speed_ratio", "moment"), load=Load(drive_torque=3.0))
        alone = plan.derivatives(angle.ravel(), ("bends", "angle"))
        for name, before in (("speed_ratio", 0), ("moment", 1)):
            for by in ("bends", "angle"):
                where = (*(slice(None),) * (before + 1), *place)
                np.testing.assert_array_equal(found[name][by][where], alone[name][by])
