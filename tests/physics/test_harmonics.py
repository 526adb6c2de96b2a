"""Harmonics of any output, against sums over exact samples and against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cardan import OUTPUTS, Driveline, Harmonics, Load, Sweep
from oracle import ExactTurn, Fold, MpNumber, mp
from refusals import refusals
from vectors import ExactLoads, Frames

MOTION = ("angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
VECTORS = ("moment", "support_moment")
KINKED = ("bending_driving", "bending_driven")
FORCES = ("joint_force", "bearing_force")  # of drivelines with lengths
PERIODIC = tuple(name for name in OUTPUTS if name not in ("angle", *FORCES))
PINS = ("driving_pin", "driven_pin")  # known at rest in space only
CROSS = ("tilt_driving", "tilt_driven", "swing_driving", "swing_driven", *PINS)
IN_AXES = {"space": PERIODIC, "shaft": tuple(name for name in PERIODIC if name not in PINS)}
ORDERS = np.arange(1, 13)
LINE = Driveline.from_bends([0.4, 0.3, 0.5], [0.3, -1.0], [0.7, 0.2])
LOAD = Load(drive_torque=3.0, speed=2.0, acceleration=0.5, inertias=[0.1, 0.02, 0.03, 0.04])


def series(values: list[MpNumber], orders: np.ndarray[Any, Any]) -> list[MpNumber]:
    """Mean and complex amplitudes of exact samples of a whole turn."""
    count = len(values)
    turns = [mp.expj(-2 * mp.pi * i / count) for i in range(count)]
    mean = mp.fsum(values) / count
    return [mean] + [
        2 * mp.fsum(value * turns[m * i % count] for i, value in enumerate(values)) / count
        for m in orders.tolist()
    ]


def check(found: Harmonics, name: str, wanted: list[MpNumber], *index: int) -> None:
    """The error is within the bound, except for the rounding of the exact numbers."""
    got = [float(found.mean[name][index]), *found.complex_amplitude[name][index].tolist()]
    error = max(float(abs(mp.mpmathify(x) - c)) for x, c in zip(got, wanted, strict=True))
    bound = float(found.error[name][index])
    assert error <= bound + 1e-50, (name, index, error, bound)


def turns(count: int) -> list[ExactTurn]:
    angles = [2 * mp.pi * i / count for i in range(count)]
    return [ExactTurn(angle, mp.sin(angle), mp.cos(angle)) for angle in angles]


@pytest.mark.parametrize(
    ("bends", "samples"),
    [([0.3], 128), ([0.0], 32), ([1.3], 512), ([0.5, 0.5], 256), ([0.4, 0.2, 0.6], 256)],
)
def test_motion_against_exact_samples(bends: list[float], samples: int) -> None:
    n = len(bends)
    random = np.random.default_rng(n)
    between = random.uniform(-4, 4, (2, n - 1))
    # Two equal joints without twist and phase compensate each other.
    line = Driveline.from_bends(bends, *(between if n != 2 else 0.0 * between))
    orders = np.arange(1, 9)
    found = line.plan(MOTION, shafts=slice(None)).harmonics(orders)
    for shaft in range(n + 1):
        between_them = max(shaft - 1, 0)
        fold = Fold.of(
            bends[:shaft],
            line.twists[:between_them].tolist(),
            line.phases[:between_them].tolist(),
        )
        for name in MOTION:
            values = [getattr(fold, name)(at) for at in turns(samples)]
            check(found, name, series(values, orders), shaft)
            assert found.error[name][shaft] <= 1e-12 * max(1.0, *map(abs, map(float, values)))


@pytest.mark.parametrize("bend", [1.1, 1.2, 1.25, 1.3])
def test_the_error_of_a_high_order_alone_is_known(bend: float) -> None:
    orders = np.array([40])
    found = Driveline.from_bends([bend]).plan("speed_ratio").harmonics(orders)
    fold = Fold.of([bend], [], [])
    check(found, "speed_ratio", series([fold.speed_ratio(at) for at in turns(512)], orders))


@pytest.mark.parametrize(
    "load",
    [
        {"drive_torque": 3.0},
        {"output_torque": -2.0},
        {"drive_torque": 3.0, "speed": 9.0, "acceleration": 4.0, "inertias": [0.02] * 4},
    ],
    ids=["drive", "output", "inertias"],
)
def test_loads_against_exact_samples(load: dict[str, Any]) -> None:
    samples = 160
    plan = LINE.plan(("torque", *VECTORS), shafts=slice(None), load=Load(**load))
    found = plan.harmonics(ORDERS)
    frames = Frames.of(LINE)
    exact = [ExactLoads.of(frames, at, **load) for at in turns(samples)]
    for shaft in range(4):
        check(found, "torque", series([at.torque[shaft] for at in exact], ORDERS), shaft)
        for axis in range(3):
            parts = [at.support_moment[shaft][axis] for at in exact]
            check(found, "support_moment", series(parts, ORDERS), shaft, axis)
    for joint in range(3):
        for axis in range(3):
            parts = [at.moment[joint][axis] for at in exact]
            check(found, "moment", series(parts, ORDERS), joint, axis)
    for name in plan.places:
        assert np.max(found.error[name]) <= 1e-13 * np.max(np.abs(found.mean[name]))


def test_tilts_against_exact_samples() -> None:
    names = ("tilt_driving", "tilt_driven")
    found = LINE.plan(names).harmonics(ORDERS)
    fold = Fold.of([], [], [])
    for joint in range(3):
        before = joint and Fold.of(
            LINE.bends[:joint].tolist(),
            LINE.twists[: joint - 1].tolist(),
            LINE.phases[: joint - 1].tolist(),
        ).past_shaft(float(LINE.twists[joint - 1]), float(LINE.phases[joint - 1]))
        tilts = [(before or fold).tilts(float(LINE.bends[joint]), at) for at in turns(160)]
        for i, name in enumerate(names):
            check(found, name, series([tilt[i] for tilt in tilts], ORDERS), joint)


def test_a_single_joint_bends_its_driving_shaft_by_the_magnitude_of_a_sine() -> None:
    bend, torque = 0.6, 5.0
    found = Driveline.from_bends([bend]).harmonics(
        ORDERS, outputs="bending_driving", load=Load(drive_torque=torque)
    )
    size = torque * math.tan(bend)
    # |sin a| = 2/pi - 4/pi sum cos(2 n a)/(4 n**2 - 1)
    assert found.mean["bending_driving"] == pytest.approx(2 * size / math.pi, rel=1e-14)
    even = ORDERS[1::2]
    wanted = -4 * size / math.pi / (even**2 - 1.0)
    amplitudes = found.complex_amplitude["bending_driving"][0]
    assert amplitudes[1::2] == pytest.approx(wanted, abs=1e-14)
    assert not np.any(amplitudes[::2])
    assert abs(found.phase["bending_driving"][0, 1]) == pytest.approx(math.pi)


@pytest.mark.parametrize("angle_of", ["drive", "driven"])
def test_magnitudes_with_kinks(angle_of: Any) -> None:  # noqa: ANN401
    load = Load(output_torque=2.0)
    plan = LINE.plan(KINKED, load=load, angle_of=angle_of)
    found = plan.harmonics(ORDERS)
    count = 1 << 18
    result = plan(Sweep.revolutions(1, count))
    for name in KINKED:
        # So many samples leave kinks an error of the square of the step.
        spectrum = np.fft.rfft(result[name]) / count
        assert found.mean[name] == pytest.approx(spectrum[:, 0].real, abs=1e-9)
        assert found.complex_amplitude[name] == pytest.approx(2 * spectrum[:, ORDERS], abs=1e-9)
        assert np.max(found.error[name]) < 1e-12


def test_kinks_where_an_inertia_reverses_the_torque_are_in_the_error() -> None:
    load = Load(drive_torque=0.1, speed=30.0, inertias=[0.0, 0.01, 0.01, 0.01])
    plan = LINE.plan(KINKED, load=load)
    found = plan.harmonics(ORDERS)
    count = 1 << 20
    result = plan(Sweep.revolutions(1, count))
    for name in KINKED:
        exact = 2 * np.fft.rfft(result[name])[:, ORDERS] / count
        off = np.max(np.abs(found.complex_amplitude[name] - exact), axis=-1)
        assert np.all(off <= found.error[name] + 1e-9)
        assert np.max(found.error[name]) < 1e-3


@pytest.mark.parametrize("axes", ["space", "shaft"])
@pytest.mark.parametrize("angle_of", ["drive", "driven"])
def test_the_series_is_the_output(axes: Any, angle_of: Any) -> None:  # noqa: ANN401
    names = [name for name in IN_AXES[axes] if name not in KINKED]
    plan = LINE.plan(names, shafts=[3, 1], load=LOAD, axes=axes, angle_of=angle_of)
    orders = np.arange(1, 61)
    found = plan.harmonics(orders)
    angle = np.linspace(-5.0, 5.0, 31)
    result = plan(angle)
    for name in names:
        amplitude, phase = found.amplitude[name], found.phase[name]
        waves = np.cos(np.multiply.outer(angle, orders) + phase[..., np.newaxis, :])
        sums = found.mean[name][..., np.newaxis] + np.sum(
            amplitude[..., np.newaxis, :] * waves, axis=-1
        )
        wanted = np.moveaxis(result[name], -1, -2) if OUTPUTS[name].vector else result[name]
        scale = max(1.0, np.max(np.abs(wanted)))
        assert sums == pytest.approx(wanted, abs=1e-12 * scale), name


@given(
    st.lists(st.floats(0.0, 0.9), min_size=1, max_size=3),
    st.lists(st.floats(-4.0, 4.0), min_size=4, max_size=4),
    st.sampled_from([name for name in PERIODIC if not OUTPUTS[name].vector]),
)
def test_parseval(bends: list[float], between: list[float], name: str) -> None:
    n = len(bends)
    line = Driveline.from_bends(bends, between[: n - 1], between[2 : n + 1])
    load = Load(output_torque=1.0)
    found = line.plan(name, load=load).harmonics(np.arange(1, 201))
    rms = line.evaluate(Sweep.revolutions(1, 4096), name, load=load, reduce="rms")[name]
    power = found.mean[name] ** 2 + 0.5 * np.sum(found.amplitude[name] ** 2, axis=-1)
    # The orders of a kink fall by their square, those beyond 200 have less power than 1e-7.
    close = 1e-6 if name in KINKED else 1e-12
    assert power == pytest.approx(rms**2, rel=close, abs=1e-24)


def test_half_a_turn_reverses_the_pins_and_nothing_else() -> None:
    axes: Any
    for axes, names in IN_AXES.items():
        found = LINE.plan(names, load=LOAD, axes=axes).harmonics(ORDERS)
        for name in names:
            even, odd = (found.amplitude[name][..., start::2] for start in (1, 0))
            if name in CROSS:
                assert np.all(np.max(odd[..., 0], axis=-1 if name in PINS else ()) > 0.0)
                assert not np.any(even)
                assert not np.any(found.mean[name])
            elif axes == "shaft" and OUTPUTS[name].vector:
                assert not np.any(odd[..., 0, :])
                assert not np.any(even[..., 1:, :])
            else:
                assert not np.any(odd)


def test_batches_and_loads_have_rows_of_their_own() -> None:
    random = np.random.default_rng(5)
    batch = Driveline.from_bends(
        random.uniform(0.0, 1.2, (4, 1, 2)), *random.uniform(-3, 3, (2, 4, 1, 1))
    )
    load = Load(
        drive_torque=[1.0, 2.0, 3.0],
        speed=random.uniform(0, 9, (4, 1)),
        inertias=random.uniform(0, 0.1, (4, 3, 3)),
    )
    whole = batch.plan(PERIODIC, joints=1, load=load).harmonics([1, 2, 4])
    assert whole.speed_ratio.shape == (4, 3, 3)
    assert whole.moment.shape == (4, 3, 3, 3)
    assert whole.mean["moment"].shape == whole.error["moment"].shape == (4, 3, 3)
    assert load.inertias is not None
    for i in range(4):
        for j in range(3):
            single = Load(
                drive_torque=load.torque[j], speed=load.speed[i, 0], inertias=load.inertias[i, j]
            )
            own = batch[i, 0].plan(PERIODIC, joints=1, load=single).harmonics([1, 2, 4])
            for name in PERIODIC:
                bound = whole.error[name][i, j] + own.error[name] + 1e-15
                off = own.complex_amplitude[name] - whole.complex_amplitude[name][i, j]
                assert np.all(np.abs(off) <= bound[..., np.newaxis])


def test_an_empty_batch_and_items_in_order() -> None:
    none = Driveline.from_bends(np.zeros((0, 2))).plan("tilt_driven").harmonics([1, 2])
    assert none.tilt_driven.shape == (2, 0, 2)
    both = LINE.plan(("tilt_driven", "torque"), shafts=[2, 0], joints=[2, 0], load=LOAD)
    found = both.harmonics([1, 2])
    each = LINE.plan(("tilt_driven", "torque"), shafts=slice(None), load=LOAD).harmonics([1, 2])
    assert np.array_equal(found.tilt_driven, each.tilt_driven[[2, 0]])
    assert np.array_equal(found.torque, each.torque[[2, 0]])


def test_over_the_driven_angle_one_order_is_left_of_a_joint() -> None:
    # 1/r of a joint is a Poisson kernel in the driven angle, so r has a mean and the order 2.
    bend = 1.1
    k = math.tan(bend / 2) ** 2
    found = Driveline.from_bends([bend]).plan("speed_ratio", angle_of="driven").harmonics([2, 4, 6])
    assert found.mean["speed_ratio"] == pytest.approx((1 + k * k) / (1 - k * k), rel=1e-14)
    assert found.speed_ratio == pytest.approx([2 * k / (1 - k * k), 0.0, 0.0], abs=1e-13)
    assert found.complex_amplitude["speed_ratio"][0].real > 0.0


def test_a_torque_into_a_chain_has_mean_and_order_2() -> None:
    found = LINE.harmonics([2, 4], shaft=3, outputs="torque", load=Load(drive_torque=2.0))
    k = float(LINE.equivalent().k)
    assert found.mean["torque"] == pytest.approx(2.0 * (1 + k * k) / (1 - k * k), rel=1e-13)
    assert found.torque == pytest.approx([4.0 * k / (1 - k * k), 0.0], abs=1e-14)


@pytest.mark.parametrize("bend", [85.0, 89.5])
def test_steep_joints_take_more_samples(bend: float) -> None:
    line = Driveline.from_bends([bend], degrees=True)
    found = line.plan(("tilt_driven", "torque"), load=Load(output_torque=1.0)).harmonics([1, 2])
    # The torque at the drive is the speed ratio.
    drive = line.harmonics([1, 2], 0, outputs="torque", load=Load(output_torque=1.0))
    ratio = line.harmonics([1, 2])
    assert drive.torque == pytest.approx(ratio.speed_ratio, abs=1e-11)
    assert np.all(np.abs(drive.torque - ratio.speed_ratio) <= drive.error["torque"])
    assert np.max(found.error["tilt_driven"]) < 1e-13


def test_digits_that_a_tolerance_leaves_are_in_the_error() -> None:
    plan = LINE.plan("moment", load=LOAD, tolerance=1e-6)
    rough, fine = plan.harmonics(ORDERS), LINE.plan("moment", load=LOAD).harmonics(ORDERS)
    off = np.abs(rough.complex_amplitude["moment"] - fine.complex_amplitude["moment"])
    assert np.all(off <= rough.error["moment"][..., np.newaxis])
    assert np.max(rough.error["moment"]) < 1e-4


def test_results_are_double_also_of_single_precision() -> None:
    found = LINE.plan("moment", load=LOAD, dtype=np.float32).harmonics([2])
    exact = LINE.plan("moment", load=LOAD).harmonics([2])
    assert found.complex_amplitude["moment"].dtype == np.complex128
    assert np.array_equal(found.moment, exact.moment)


def test_nothing_is_computed_of_what_is_not_a_number() -> None:
    found = LINE.plan("torque", load=Load(drive_torque=[1.0, math.nan])).harmonics([2])
    assert np.isnan(found.torque).tolist() == [[False], [True]]


def test_no_orders_leave_the_mean() -> None:
    plan = LINE.plan(("speed_ratio", "torque"), load=LOAD)
    none, some = plan.harmonics([]), plan.harmonics(2)
    for name in ("speed_ratio", "torque"):
        assert none.amplitude[name].shape == (0,)
        assert none.mean[name] == pytest.approx(some.mean[name], rel=1e-14)


def test_attributes() -> None:
    found = LINE.harmonics(2)
    assert found.orders.tolist() == [2]
    assert np.array_equal(found.speed_ratio, found.amplitude["speed_ratio"])
    assert "speed_ratio" in dir(found)
    assert not hasattr(found, "moment")
    with pytest.raises(AttributeError, match="the harmonics hold no 'angle_error_deg'"):
        _ = LINE.harmonics(2, outputs="speed_ratio").angle_error_deg


test_what_has_no_harmonics = refusals(
    {
        "outputs[0] is 'angle', which grows with every turn and has no harmonics; "
        "the periodic part is 'angle_error'": lambda: LINE.plan().harmonics(),
        "reduce is 'max'; harmonics need a plan without a reduction": lambda: LINE.plan(
            "speed_ratio", reduce="max"
        ).harmonics(),
        "orders[1] is 0; an order is at least": lambda: LINE.harmonics([2, 0]),
        "orders[1] is 1073741824; an order of tilt_driven is at most 262144": lambda: (
            LINE.harmonics([2, 1 << 30], outputs="tilt_driven")
        ),
        "orders has shape (1, 1); it must be a": lambda: LINE.harmonics([[2]]),
        "TypeError: orders has dtype float64; an order is an": lambda: LINE.harmonics([2.0]),
        "IndexError: shaft is 4; there are 4, counted from 0": lambda: LINE.harmonics(2, 4),
        "which needs a load": lambda: LINE.harmonics(2, outputs="moment"),
        "shapes do not broadcast: driveline (2,), torque (3,)": lambda: (
            Driveline.from_bends([[0.1], [0.2]])
            .plan("torque", load=Load(drive_torque=[1.0, 2.0, 3.0]))
            .harmonics()
        ),
    }
)


def test_forces_are_even() -> None:
    points = np.array([[0, 0, 0], [0.3, 0, 0], [1.5, -0.1, 0.05], [1.9, -0.2, 0.05]])
    line = Driveline.from_points(points).with_bearings([(0, 0.05), (0, 0.25), (2, 0.1), (2, 0.3)])
    plan = line.plan(FORCES, load=Load(drive_torque=100.0))
    found = plan.harmonics([1, 2, 3, 4])
    result = plan(np.arange(720) * np.pi / 360)
    for name in FORCES:
        sums = np.fft.rfft(result[name], axis=-2) / 360
        wanted = np.moveaxis(np.abs(sums[..., 1:5, :]), -2, -1)
        np.testing.assert_allclose(found.amplitude[name], wanted, atol=1e-11)
        assert np.all(found.amplitude[name][..., ::2] == 0)
        assert np.max(found.amplitude[name][..., 1]) > 0.1
