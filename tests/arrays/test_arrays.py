"""Arrays in and out: shapes, types, memory, and the words in which they are refused."""

from __future__ import annotations

import math
import os
import pickle
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, ArgumentTypeError, BallJoint, Driveline, Load, Result, approximations
from cardan.motion import workshop
from refusals import refusals

ONE = Driveline.from_bends([0.5])
THREE = Driveline.from_bends([0.5, 0.4, 0.3], [0.1, 0.2], [0.3, 0.9]).with_bearings(
    [(1, 0.7), (0, 0.1), (3, 0.2), (0, 0.2), (3, 0.3)], lengths=[0.3, 1.0, 1.2, 0.4]
)
GRID = np.linspace(-3.0, 9.0, 60)


def ratio(angle: Any, line: Driveline = ONE) -> Any:  # noqa: ANN401
    return line.evaluate(angle, "speed_ratio").speed_ratio


def test_scalars_give_scalars() -> None:
    got = ratio(0.3)
    assert isinstance(got, np.float64)
    assert got == ratio([0.3])[0] == ratio(np.array([[0.3]]))[0, 0]
    assert ONE.evaluate(0.3, "moment", load=Load(drive_torque=1)).moment.shape == (1, 3)
    assert ONE.evaluate(0.3, "moment", joints=0, load=Load(drive_torque=1)).moment.shape == (3,)


@pytest.mark.parametrize("shape", [(60,), (3, 20), (2, 3, 10), (60, 1), (1, 1, 60), (0,), (4, 0)])
def test_any_shape(shape: tuple[int, ...]) -> None:
    angle = GRID[: math.prod(shape)].reshape(shape)
    got = ratio(angle)
    assert got.shape == shape
    assert np.array_equal(got.reshape(-1), ratio(GRID)[: angle.size])


@pytest.mark.parametrize(
    ("lines", "angles"),
    [
        ((4,), (4,)),
        ((4, 1), (5,)),
        ((4, 1), (1, 5)),
        ((4,), (3, 4)),
        ((2, 1, 4), (3, 1)),
        ((2, 3, 1), (5,)),
        ((4,), ()),
        ((1,), (5,)),
        ((0,), (1,)),
        ((4, 1), (0,)),
    ],
)
def test_broadcasting(lines: tuple[int, ...], angles: tuple[int, ...]) -> None:
    random = np.random.default_rng(3)
    bends = random.uniform(0, 1.2, (*lines, 2))
    line = Driveline.from_bends(bends, 0.3, 0.8)
    angle = random.uniform(-5, 5, angles)
    load = Load(output_torque=random.uniform(1, 2, angles), speed=2.0, inertias=[1, 2, 3])
    names = ("angle", "torque", "support_moment")
    got = line.evaluate(angle, names, shafts=[0, 2], load=load)
    shape = np.broadcast_shapes(lines, angles)
    assert got.angle.shape == (2, *shape)
    assert got.support_moment.shape == (2, *shape, 3)
    spread = np.broadcast_to(angle, shape)
    torques = np.broadcast_to(load.torque, shape)
    for index in np.ndindex(shape):
        single = Driveline.from_bends(np.broadcast_to(bends, (*shape, 2))[index], 0.3, 0.8)
        one = Load(output_torque=torques[index], speed=2.0, inertias=[1, 2, 3])
        want = single.evaluate(spread[index], names, shafts=[0, 2], load=one)
        for name in names:
            assert np.array_equal(got[name][(slice(None), *index)], want[name]), name


def readonly(a: np.ndarray) -> np.ndarray:
    a = a.copy()
    a.flags.writeable = False
    return a


def unaligned(a: np.ndarray) -> np.ndarray:
    raw = np.zeros(a.nbytes + 1, np.uint8)
    view = raw[1:].view(np.float64)
    view[...] = a
    assert not view.flags.aligned
    return view


@pytest.mark.parametrize(
    "disguise",
    [
        list,
        tuple,
        readonly,
        unaligned,
        lambda a: np.repeat(a, 3)[::3],
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.astype(">f8"),
        lambda a: a.astype(np.longdouble),
        lambda a: memoryview(a),
    ],
)
def test_any_memory(disguise: Any) -> None:  # noqa: ANN401
    assert np.array_equal(ratio(disguise(GRID)), ratio(GRID))


def test_fortran_order_and_negative_strides() -> None:
    square = GRID.reshape(6, 10)
    assert np.array_equal(ratio(np.asfortranarray(square)), ratio(square))
    assert np.array_equal(ratio(square[::-1, ::-2]), ratio(square)[::-1, ::-2])
    assert np.array_equal(ratio(square.T), ratio(square).T)


def test_other_numbers_are_cast() -> None:
    whole = np.arange(-5, 6)
    for dtype in (np.int8, np.int64, np.float16, np.float32):
        assert np.array_equal(ratio(whole.astype(dtype)), ratio(whole.astype(float)))
    assert ratio(whole.astype(np.float32)).dtype == np.float64
    assert np.array_equal(ratio([True, False]), ratio([1.0, 0.0]))


@pytest.mark.parametrize("angle", [1j, [1j], "0.3", ["a"], None, [None], object(), [[1], [1, 2]]])
def test_what_is_no_real_number_is_refused(angle: Any) -> None:  # noqa: ANN401
    with pytest.raises((TypeError, ValueError)) as caught:
        ratio(angle)
    if not isinstance(angle, list) or np.ndim(angle[0]) == 0:
        assert caught.type is ArgumentTypeError
        assert "angle has dtype" in str(caught.value)


@pytest.mark.parametrize("name", OUTPUTS)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_nan_and_infinity_stay_at_their_sample(name: str, bad: float) -> None:
    angle = GRID.copy()
    angle[[0, 17]] = bad
    load = Load(drive_torque=1.0, speed=3.0, inertias=[0.1, 0.2, 0.3, 0.4])
    options: dict[str, Any] = {"shafts": slice(None), "load": load}
    got = THREE.evaluate(angle, name, **options)[name]
    want = THREE.evaluate(GRID, name, **options)[name]
    axis = 1
    keep = np.delete(np.arange(GRID.size), [0, 17])
    assert np.array_equal(got.take(keep, axis), want.take(keep, axis))
    lost = got.take([0, 17], axis)
    if OUTPUTS[name].needs_load:
        # The drive torque itself does not depend on the angle.
        lost = lost[1:] if name == "torque" else lost
    assert np.isnan(lost).all()


def test_bad_geometry_cannot_be_made_but_bad_loads_pass_through() -> None:
    load = Load(drive_torque=[1.0, math.nan, 3.0])
    got = ONE.evaluate([0.1, 0.2, 0.3], "torque", load=load).torque
    assert np.isnan(got).tolist() == [False, True, False]


# --- items -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("items", "picked"),
    [
        (None, 3),
        (0, 0),
        (-1, 3),
        (np.int64(2), 2),
        (slice(None), [0, 1, 2, 3]),
        (slice(1, 3), [1, 2]),
        (slice(None, None, -1), [3, 2, 1, 0]),
        ([2], [2]),
        ([3, 0], [3, 0]),
        ((1, -1), [1, 3]),
        (np.array([1, 2]), [1, 2]),
        ([], []),
    ],
)
def test_shafts(items: Any, picked: int | list[int]) -> None:  # noqa: ANN401
    every = THREE.evaluate(GRID, "angle", shafts=slice(None)).angle
    assert np.array_equal(THREE.evaluate(GRID, "angle", shafts=items).angle, every[picked])


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"shafts": 4}, IndexError, "shafts is 4; there are 4, counted from 0"),
        ({"shafts": [0, -5]}, IndexError, "shafts[1] is -5; there are 4, counted from 0"),
        ({"shafts": [1, 1]}, ValueError, "shafts[1] is 1 again; name each once"),
        ({"shafts": 0.5}, TypeError, "shafts is 0.5; it must be an index, a slice or a list"),
        ({"shafts": "1"}, TypeError, "shafts is '1'; it must be an index, a slice or a list"),
        ({"joints": 3}, IndexError, "joints is 3; there are 3, counted from 0"),
        ({"workers": 0}, ValueError, "workers is 0; it must be positive, or -1 for all cores"),
        ({"workers": -2}, ValueError, "workers is -2; it must be positive, or -1 for all cores"),
        ({"workers": 1.5}, TypeError, "workers is 1.5; it must be an integer"),
        ({"outputs": "speed"}, ValueError, "outputs[0] is 'speed'; did you mean 'speed_ratio'?"),
        ({"outputs": ["angle", "x"]}, ValueError, "outputs[1] is 'x'; known are angle, angle_err"),
        ({"outputs": ["angle"] * 2}, ValueError, "outputs[1] is 'angle' again"),
        ({"outputs": [1]}, TypeError, "outputs[0] is 1; an output is asked for by its name"),
        ({"outputs": "torque"}, ValueError, 'outputs[0] is "torque", which needs a load'),
        ({"angle": np.zeros(7), "line": 5}, ValueError, "angle has shape (7,), which does not"),
    ],
)
def test_bad_requests(options: dict[str, Any], error: type[Exception], message: str) -> None:
    line = THREE
    if "line" in options:
        line = Driveline.from_bends(np.full((options.pop("line"), 2), 0.1))
    arguments = {"angle": GRID, "outputs": "angle", **options}
    with pytest.raises(error) as caught:
        line.evaluate(**arguments)
    assert message in str(caught.value)


TILTED = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0.1, 0], [3, 0, 0.1]])


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("angle", lambda x: THREE.evaluate(x)),
        ("angle", lambda x: workshop.turn(x)),
        ("speed", lambda x: THREE.check(x)),
        ("orders", lambda x: THREE.harmonics(x)),
        ("phases", lambda x: THREE.with_phases(x)),
        ("bends", lambda x: Driveline.from_bends(x)),
        ("twists", lambda x: Driveline.from_bends([0.1, 0.1], x)),
        ("phases", lambda x: Driveline.from_bends([0.1, 0.1], 0, x)),
        ("points", lambda x: Driveline.from_points(x)),
        ("phases", lambda x: Driveline.from_points(TILTED, x)),
        ("directions", lambda x: Driveline.from_directions(x)),
        ("phases", lambda x: Driveline.from_directions(np.diff(TILTED, axis=0), x)),
        ("vertical", lambda x: Driveline.from_slopes(x, [0, 0.1])),
        ("horizontal", lambda x: Driveline.from_slopes([0, 0.1], x)),
        ("phases", lambda x: Driveline.from_slopes([0, 0.1, 0], [0, 0, 0.1], x)),
        ("readings", lambda x: Driveline.from_readings(x)),
        ("lengths", lambda x: Driveline.from_readings([0, 0.1], x)),
        ("offsets", lambda x: Driveline.from_readings([0, 0.1], [1, 1], x)),
        ("phases", lambda x: Driveline.from_readings([0, 0.1, 0], phases=x)),
        ("vertical", lambda x: Driveline.from_projected_bends(x, [0, 0.1])),
        ("horizontal", lambda x: Driveline.from_projected_bends([0, 0.1], x)),
        ("phases", lambda x: Driveline.from_projected_bends([0.1, 0.1], [0, 0.1], x)),
        ("drive_torque", lambda x: Load(drive_torque=x)),
        ("output_torque", lambda x: Load(output_torque=x)),
        ("speed", lambda x: Load(speed=x)),
        ("acceleration", lambda x: Load(acceleration=x)),
        ("inertias", lambda x: Load(inertias=x)),
        ("angle", lambda x: approximations.thoma_small_angle(x, 0.1, inertia=1, speed=1)),
        ("bend", lambda x: approximations.thoma_small_angle(0, x, inertia=1, speed=1)),
        ("inertia", lambda x: approximations.thoma_small_angle(0, 0.1, inertia=x, speed=1)),
        ("speed", lambda x: approximations.thoma_small_angle(0, 0.1, inertia=1, speed=x)),
        ("angle", lambda x: approximations.thoma_moment_ratios(x, 0.1)),
        ("bend", lambda x: approximations.thoma_moment_ratios(0, x)),
        ("bends", lambda x: approximations.catalogue_bend(x, [1, 1])),
        ("fork_signs", lambda x: approximations.catalogue_bend([0.1, 0.1], x)),
        ("speed", lambda x: approximations.torsional_excitation([0.1], [1], x)),
        ("radius", lambda x: BallJoint(x)),
        ("half_angle", lambda x: BallJoint(1, x)),
        ("clearance", lambda x: BallJoint(1).with_clearance(x, compliance=1)),
        ("compliance", lambda x: BallJoint(1).with_clearance(0, compliance=x)),
        ("load", lambda x: BallJoint(1).peak_pressure(x)),
        ("theta", lambda x: BallJoint(1).pressure(x, 1)),
        ("load", lambda x: BallJoint(1).pressure(0, x)),
        ("directions", lambda x: BallJoint(1).pressure_at(x, [0, 0, 1])),
        ("load_vector", lambda x: BallJoint(1).pressure_at([0, 0, 1], x)),
        ("compliance", lambda x: BallJoint(1).approach(1, x)),
        ("friction", lambda x: BallJoint(1).friction_moment(1, x)),
        ("friction", lambda x: BallJoint(1).tilting_friction_moment(1, x)),
        ("load", lambda x: BallJoint.sized_for(x, 1)),
        ("allowable_pressure", lambda x: BallJoint.sized_for(1, x)),
    ],
)
def test_every_argument_is_called_by_its_name(name: str, make: Any) -> None:  # noqa: ANN401
    with pytest.raises(TypeError, match=rf"^{name} (has|have|is) "):
        make([1j, 2j])


# --- loads -----------------------------------------------------------------------------------


test_bad_loads = refusals(
    {
        "are both given": lambda: Load(drive_torque=1, output_torque=1),
        "inertias[1] is -1.0; an inertia must not": lambda: Load(inertias=[0, -1]),
        "inertias are given without a speed or an acceleration": lambda: Load(
            inertias=[0, 1], drive_torque=1.0
        ),
        "speed and speed_rpm are both given; give one of them": lambda: Load(
            speed=1.0, speed_rpm=1.0
        ),
        "it needs one per shaft": lambda: Load(inertias=1.0),
        "TypeError: speed has dtype complex128": lambda: Load(speed=1j),
    }
)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (Load(speed=1.0, inertias=[1, 2]), "inertias has shape (2,); 4 shafts need (..., 4)"),
        (Load(drive_torque=np.zeros(7)), "drive_torque has shape (7,), which does not broadcast"),
        (Load(output_torque=np.zeros(7)), "output_torque has shape (7,), which does not broadcast"),
        (Load(acceleration=np.zeros(7)), "acceleration has shape (7,), which does not broadcast"),
        (Load(speed=np.zeros((2, 60))), "speed has shape (2, 60), which does not broadcast"),
        (
            Load(speed=1.0, inertias=np.ones((7, 4))),
            "inertias has shape (7,), which does not broadcast",
        ),
    ],
)
def test_loads_that_do_not_fit(load: Load, message: str) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        THREE.evaluate(GRID, "torque", load=load)
    assert message in str(caught.value)


def test_a_drive_at_rest_moves_no_inertia() -> None:
    stopped = Load(drive_torque=2.0, speed=0.0, inertias=[1.0, 1, 1, 1])
    at_rest = THREE.evaluate(GRID, "torque", load=stopped)
    without = THREE.evaluate(GRID, "torque", load=Load(drive_torque=2.0))
    assert np.array_equal(at_rest.torque, without.torque)


def test_speed_per_minute() -> None:
    speeds = np.array([0.0, 60.0, 1500.0])
    load = Load(speed_rpm=speeds, inertias=[0.0, 1.0])
    assert load.speed == pytest.approx(speeds / 60.0 * 2.0 * np.pi, rel=1e-15)
    assert Load(acceleration=1.0, inertias=[0.0, 1.0]).speed == 0.0


def test_a_load_keeps_its_own_arrays() -> None:
    torque = np.ones(3)
    load = Load(drive_torque=torque)
    torque[:] = 9
    assert load.torque.tolist() == [1, 1, 1]
    again = pickle.loads(pickle.dumps(load))
    assert again.end == "drive"
    assert again.torque.tolist() == [1, 1, 1]


# --- out -------------------------------------------------------------------------------------


def test_out_for_some_outputs_only() -> None:
    out = {"speed_ratio": np.empty(60)}
    got = ONE.evaluate(GRID, ("angle", "speed_ratio"), out=out)
    assert got.speed_ratio is out["speed_ratio"]
    assert np.array_equal(got.angle, ONE.evaluate(GRID).angle)


def test_out_may_be_the_angles() -> None:
    for view in (slice(None), slice(None, None, 2), slice(None, None, -1)):
        angle = GRID.copy()[view]
        want = ONE.evaluate(angle.copy(), "speed_ratio").speed_ratio
        ONE.evaluate(angle, "speed_ratio", out={"speed_ratio": angle})
        assert np.array_equal(angle, want)
    # Overlapping by a part.
    both = np.concatenate([GRID, GRID])
    want = ONE.evaluate(both[10:70].copy(), "angle").angle
    ONE.evaluate(both[10:70], "angle", out={"angle": both[:60]})
    assert np.array_equal(both[:60], want)


def test_out_may_be_a_torque() -> None:
    torque = np.linspace(1, 2, 60)
    want = ONE.evaluate(GRID, "torque", load=Load(drive_torque=torque)).torque
    load = Load(drive_torque=torque)
    ONE.evaluate(GRID, "torque", load=load, out={"torque": load.torque})
    assert np.array_equal(load.torque, want)


def test_out_of_any_layout() -> None:
    load = Load(drive_torque=2.0)
    want = THREE.evaluate(GRID.reshape(6, 10), ("angle", "moment"), load=load)
    out = {
        "angle": np.empty((6, 20))[:, ::2],
        "moment": np.asfortranarray(np.empty((3, 6, 10, 3))),
    }
    THREE.evaluate(GRID.reshape(6, 10), ("angle", "moment"), load=load, out=out)
    assert np.array_equal(out["angle"], want.angle)
    assert np.array_equal(out["moment"], want.moment)
    odd = unaligned(np.empty(60))
    ONE.evaluate(GRID, "angle", out={"angle": odd})
    assert np.array_equal(odd, ONE.evaluate(GRID, "angle").angle)
    # A scalar's array is filled and stays an array.
    zero = np.empty(())
    assert ONE.evaluate(0.3, "angle", out={"angle": zero}).angle is zero


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        ({"angle": np.empty(59)}, ValueError, "out['angle'] has shape (59,); it must be (60,)"),
        ({"angle": np.empty(60, np.float32)}, ValueError, "has dtype float32; it must be float64"),
        ({"angle": np.empty(60, ">f8")}, ValueError, "has dtype >f8; it must be float64"),
        ({"angle": readonly(GRID)}, ValueError, "out['angle'] is read-only"),
        ({"angle": [0.0] * 60}, TypeError, "out['angle'] is list; it must be an array"),
        ({"torque": np.empty(60)}, ValueError, "out['torque'] is not one of the requested outputs"),
        (
            {"angle": GRID, "speed_ratio": GRID},
            ValueError,
            "out['speed_ratio'] and out['angle'] share memory",
        ),
    ],
)
def test_bad_out(out: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        ONE.evaluate(GRID.copy(), ("angle", "speed_ratio"), out=out)
    assert message in str(caught.value)


def test_the_result_is_a_mapping_with_attributes() -> None:
    got = THREE.evaluate(GRID, ("speed_ratio", "angle"))
    assert list(got) == ["speed_ratio", "angle"]
    assert len(got) == 2
    assert got["angle"] is got.angle
    assert "angle" in dir(got)
    assert repr(got) == (
        "Result(speed_ratio: (60,) 0.955042 to 1.04722, angle: (60,) -2.98759 to 8.98717 rad)"
    )
    with pytest.raises(AttributeError, match="holds no 'torque'"):
        _ = got.torque
    with pytest.raises(KeyError):
        _ = got["torque"]
    assert not hasattr(got, "__setitem__")
    again = pickle.loads(pickle.dumps(got))
    assert isinstance(again, Result)
    assert np.array_equal(again.angle, got.angle)


def test_arrays_of_a_result_are_made_once_and_keep_their_order() -> None:
    names = ("moment", "speed_ratio", "angle")
    load = Load(drive_torque=1.0)
    got, other = (THREE.evaluate(GRID, names, load=load) for _ in range(2))
    last = got.angle
    assert last is got["angle"]
    assert last is [*got.values()][2]
    assert tuple(got) == tuple(dict(got)) == tuple(pickle.loads(pickle.dumps(got))) == names
    assert got == other
    last[:] = 7.0
    assert (dict(got)["angle"] == 7.0).all()
    assert (pickle.loads(pickle.dumps(got)).angle == 7.0).all()
    assert got != other
    assert got.moment.base is last.base


def test_what_was_asked_before_changes_nothing() -> None:
    wanted = ONE.evaluate(GRID, ["angle"], shafts=1)
    with pytest.raises(TypeError, match=r"shafts is 1\.0"):
        ONE.evaluate(GRID, ["angle"], shafts=1.0)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="shafts is True"):
        ONE.evaluate(GRID, ["angle"], shafts=True)
    assert ONE.evaluate(GRID, ["angle"], shafts=np.int64(1)) == wanted  # type: ignore[arg-type]
    names = ["angle"]
    assert [*ONE.evaluate(GRID, names)] == names
    names.append("speed_ratio")
    assert [*ONE.evaluate(GRID, names)] == names
    once = iter(names)
    assert [*ONE.evaluate(GRID, once)] == names
    assert [*ONE.evaluate(GRID, once)] == []
    assert [type(name) for name in ONE.evaluate(GRID, (np.str_("angle"),))] == [str]
    assert THREE.evaluate(GRID, "angle").angle.shape == GRID.shape
    assert THREE.evaluate(GRID, "tilt_driven").tilt_driven.shape == (3, *GRID.shape)
    assert ONE.evaluate(GRID, "tilt_driven").tilt_driven.shape == (1, *GRID.shape)


def test_vectors_are_planes_behind_the_scenes() -> None:
    moment = THREE.evaluate(GRID, "moment", load=Load(drive_torque=1.0)).moment
    assert moment.shape == (3, 60, 3)
    assert np.moveaxis(moment, -1, 1).flags.c_contiguous


def test_only_what_is_asked_for_is_there() -> None:
    assert dict(ONE.evaluate(GRID, ())) == {}
    assert set(ONE.evaluate(GRID, ["tilt_driven"])) == {"tilt_driven"}


FORKING = """
import multiprocessing
import numpy as np
from cardan import Driveline

line = Driveline.from_bends([0.5, 0.4])
lines = Driveline.from_bends(np.full((1100, 4), 0.2))  # enough for threads
angle = np.linspace(0, 6, 200_000)
want = line.evaluate(angle).angle
lines.optimal_phases()

def job(_):
    lines.optimal_phases()
    return np.array_equal(line.evaluate(angle).angle, want)

with multiprocessing.get_context("fork").Pool(2) as pool:
    assert pool.map_async(job, range(4)).get(timeout=50) == [True] * 4
"""


@pytest.mark.xdist_group("fork")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_forked_processes_evaluate() -> None:
    done = subprocess.run([sys.executable, "-c", FORKING], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
