"""What a user of NumPy expects of any library: arrays of other kinds, pickles, copies, threads."""

from __future__ import annotations

import copy
import dataclasses
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import BallJoint, Driveline, Load, Plan, Scene, Sweep
from cardan.app.scene import SceneResult
from cardan.app.scene.study.study import StudyResult
from cardan.arrays import as_float64

GRID = np.linspace(-3.0, 9.0, 60)
LINE = Driveline.from_bends([0.5, 0.4], 0.1, 0.3)
LOAD = Load(drive_torque=2.0, speed=GRID, inertias=[0.0, 0.1, 0.2])

# --- arrays of other kinds ---------------------------------------------------------------------


class Plain(np.ndarray[Any, Any]):
    """A subclass that is only an array."""


class Quantity(np.ndarray[Any, Any]):
    """As of astropy: an array that carries a unit."""

    unit = "deg"


class Duck:
    """As of sparse or cupy: an array that is none of NumPy's."""

    shape = (2,)
    ndim = 1

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:  # noqa: ANN401
        return np.zeros(2)

    def __array_function__(self, *arguments: object) -> Any:  # noqa: ANN401
        return NotImplemented


class DuckQuantity(Duck):
    """As of pint."""

    units = "degree"


class Convertible:
    """What says itself how to become an array, as a frame's column does."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:  # noqa: ANN401
        return GRID[:2].copy()


MASKED = np.ma.masked_array([0.1, 0.2], [False, True])

TAKERS: dict[str, Callable[[Any], Any]] = {
    "angle": LINE.evaluate,
    "bends": Driveline.from_bends,
    "phases": lambda value: Driveline.from_bends([0.1, 0.1, 0.1], phases=value),
    "speed": lambda value: Load(speed=value),
    "radius": BallJoint,
}


@pytest.mark.parametrize("name", TAKERS)
@pytest.mark.parametrize(
    ("value", "message"),
    [
        (MASKED, "has masked entries; fill them or leave them out"),
        (np.ma.masked, "has masked entries"),
        (np.zeros(2).view(Quantity), "is a tests.Quantity in deg; give plain numbers in the unit"),
        (DuckQuantity(), "is a tests.DuckQuantity in degree; give plain numbers"),
        (Duck(), "is a tests.Duck; make it an array of NumPy first"),
        (np.array([1j, 2]), "has dtype complex128; it must hold real numbers"),
        (np.array([0.1, 0.2], dtype=object), "has dtype object; it must hold real numbers"),
        (np.array(["1", "2"]), "has dtype <U1; it must hold real numbers"),
        (np.zeros(2, "m8[s]"), "has dtype timedelta64[s]; it must hold real numbers"),
        (np.zeros(2, [("x", float)]), "has dtype [('x', '<f8')]; it must hold real numbers"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_would_lose_something_is_refused(name: str, value: object, message: str) -> None:
    message = message.replace("tests.", f"{__name__.partition('.')[0]}.")
    with pytest.raises(TypeError) as caught:
        TAKERS[name](value)
    assert str(caught.value).startswith(f"{name} {message}")


@pytest.mark.parametrize(
    "kind",
    [
        lambda a: a.view(Plain),
        lambda a: np.ma.masked_array(a),
        lambda a: Convertible(),
    ],
)
def test_other_kinds_give_plain_arrays(kind: Callable[[Any], Any]) -> None:
    got = LINE.evaluate(kind(GRID[:2]), "angle").angle
    assert type(got) is np.ndarray
    assert np.array_equal(got, LINE.evaluate(GRID[:2], "angle").angle)


def test_a_memory_map_is_read_where_it_lies(tmp_path: Path) -> None:
    mapped = np.memmap(tmp_path / "a", np.float64, "w+", shape=GRID.shape)
    mapped[:] = GRID
    assert np.array_equal(LINE.evaluate(mapped).angle, LINE.evaluate(GRID).angle)
    assert np.shares_memory(as_float64("angle", mapped), mapped)


def test_single_precision_in_double_precision_out() -> None:
    single = GRID.astype(np.float32)
    double = single.astype(np.float64)
    names = ("angle", "moment")
    for options in ({}, {"reduce": "mean"}, {"tolerance": 1e-6}):
        arguments: dict[str, Any] = {"load": LOAD, **options}
        plan = LINE.plan(names, **arguments)
        got = plan(single)
        for name in names:
            assert got[name].dtype == np.float64
            assert np.array_equal(got[name], plan(double)[name])
    assert LINE.evaluate(double, dtype=np.float32).angle.dtype == np.float32
    line = Driveline.from_bends(np.array([0.1, 0.2], np.float32))
    assert line.bends.dtype == np.float64
    assert BallJoint(np.float32(0.1)).peak_pressure(np.float32(3)).dtype == np.float64


# --- pickles and copies ------------------------------------------------------------------------

SCENE = Scene.parse(
    """
    [driveline]
    projected_bends_vertical_deg = [15, -11.5]
    projected_bends_horizontal_deg = [7, 12]
    [load]
    speed_rpm = 1000
    output_torque_Nm = 5
    [sweep]
    samples_per_turn = 24
    [study]
    projected_bends_vertical_deg.1 = {from = -12, to = 0, steps = 5}
    [output]
    shafts = [1, 2]
    tolerance = 0
    """
)
RESULT = SCENE.run()
BATCH = Driveline.from_bends([[0.1, 0.2], [0.3, 0.4]])

DRIVEN = LINE.evaluate(GRID, "angle", shafts=[1, 2]).angle
SUPPORTED = Driveline.from_points([[0.0, 0.0], [0.3, 0.0], [1.5, -0.1], [1.9, -0.1]] @ np.eye(2, 3))
SUPPORTED = SUPPORTED.with_bearings([(0, 0.05), (0, 0.25)])

OPTIMUM = cardan.optimise(
    lambda x: Driveline.from_bends([[x[0], 0.1]]), [0.3], [(0.2, 0.4)], starts=1
)
TORSIONAL = cardan.TorsionalSystem(
    LINE,
    inertias=[0.1] * 3,
    stiffnesses=[1e4, np.inf, np.inf],
    dampings=[1.0, 0.0, 0.0],
    drive="free",
    harmonics=[cardan.TorqueHarmonic(0, "input", 1.5, 3.0)],
)
LATERAL = cardan.LateralSystem(
    SUPPORTED,
    shafts=[None, cardan.RigidShaft(10.0, 0.6, 1.0), None],
    bearings=[cardan.ElasticBearing(1, 0.5, [[1e5, 2e5], [2e5, 3e5]], (0, 1, 1), 0.1)],
    masses=[cardan.PointMass(1, 0.2, 1.0)],
    unbalance=[cardan.Unbalance(1, 0.2, 1e-3, (0, 1, 0))],
)
OBJECTS = [
    cardan.Answer(SCENE),
    LINE,
    BATCH,
    LOAD,
    Load(),
    LINE.plan(("angle", "moment"), shafts=slice(None), joints=0, load=LOAD, tolerance=0),
    BATCH[:, None].plan("speed_ratio", reduce="peak", dtype=np.float32, workers=1),
    LINE.plan(("angle", "moment"), load=LOAD, axes="shaft"),
    LINE.plan(("angle", "moment"), load=LOAD, axes="shaft", angle_of="driven"),
    LINE.evaluate(GRID, ("angle", "moment"), load=LOAD),
    LINE.evaluate(Sweep.revolutions(2, 12), reduce="max"),
    Sweep(0.0, 1.0, 11),
    Sweep.revolutions(2, 12),
    LINE.equivalent(),
    LINE.transmission(),
    BATCH.transmission(1).motion(0.3),
    BATCH.harmonics([2, 4]),
    LINE.steering(0.3),
    LINE.slides(driving_pin=0.001),
    LINE.losses(LOAD, friction=0.01, pin_radius=0.01, arm=0.03),
    LINE.life(cardan.Load(drive_torque=1.0, speed=1.0), rating=100.0),
    LINE.tolerances(bends=0.01, samples=100, seed=1),
    LINE.order_tolerances(driving_yoke=0.002),
    LINE.plan("speed_ratio").gradient(GRID, {"speed_ratio": 1.0}),
    LINE.plan("speed_ratio").derivatives(GRID, "bends"),
    cardan.tube(0.09, 0.003, length=1.5),
    cardan.Machine(BATCH.reshape(-1), limits={"equivalent_bend": 0.05}),
    TORSIONAL,
    TORSIONAL.harmonics[0],
    cardan.Coupling(twist=[0, 0.02, 0.04], torque=[0, 100, 400]),
    TORSIONAL.steady(20.0),
    TORSIONAL.orbit(20.0, 4),
    TORSIONAL.stability(20.0),
    TORSIONAL.coexisting(20.0),
    LATERAL,
    LATERAL.shafts[1],
    LATERAL.bearings[0],
    LATERAL.masses[0],
    LATERAL.unbalance[0],
    LATERAL.modes(2, [(1, 0.5)]),
    LATERAL.response([[10.0], [20.0]], Load(drive_torque=2.0)),
    LATERAL.torque_stiffness(5.0),
    OPTIMUM,
    OPTIMUM.active[0],
    LINE.free_running([1.0] + [0.1] * LINE.n_joints),
    SUPPORTED,
    SUPPORTED.lengths(),
    SUPPORTED.spline_force(1, 100.0, 0.1, 0.02),
    cardan.identify(GRID, angle=DRIVEN[1]),
    cardan.identify_two_joints(GRID, *DRIVEN),
    BATCH.check(3.0),
    BATCH.check(3.0, "truck").findings[0],
    cardan.Limits("industrial", equivalent_bend_deg=(4, 5), source="a book"),
    cardan.Limit(1.0, 2.0, "a book"),
    BallJoint(0.05),
    BallJoint([0.05, 0.1], 1.0).with_clearance(1e-4, compliance=1e-12),
    cardan.ArgumentError("shafts", "is 1 again; name each once", (1,)),
    cardan.ArgumentTypeError("workers", "is 'a'; it must be an integer"),
    cardan.ArgumentValueError("out", "is read-only; it must be writeable", ("angle",)),
    cardan.OUTPUTS,
    cardan.OUTPUTS["moment"],
    cardan.workshop.turn(LINE.phases),
    SCENE,
    RESULT,
    RESULT.study,
]


def same(one: object, other: object) -> None:
    """Check that two objects hold the same."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        np.testing.assert_array_equal(one, other)
    elif isinstance(one, MethodType):
        assert one == other
    elif isinstance(one, Exception):
        assert str(one) == str(other)
        assert vars(one) == vars(other)
    elif isinstance(one, Plan):
        assert isinstance(other, Plan)
        assert one.explain() == other.explain()
        same(one(GRID), other(GRID))
    elif isinstance(one, cardan.Transmission):
        assert isinstance(other, cardan.Transmission)
        same(one.q, other.q)
        same(one.motion(GRID), other.motion(GRID))
    elif isinstance(one, cardan.Answer):
        assert isinstance(other, cardan.Answer)
        same(one.of, other.of)
        assert one.verdict == other.verdict
    elif isinstance(one, cardan.Tolerances):
        assert isinstance(other, cardan.Tolerances)
        same(one.worst, other.worst)
        same(one.quantile(0.9), other.quantile(0.9))
    elif isinstance(one, cardan.TorsionalSystem):
        assert isinstance(other, cardan.TorsionalSystem)
        same(one.orbit(20.0, 4), other.orbit(20.0, 4))
    elif isinstance(one, cardan.LateralSystem):
        assert isinstance(other, cardan.LateralSystem)
        same(one.sliding, other.sliding)
        same(one.response(20.0), other.response(20.0))
    elif isinstance(one, Driveline):
        for name in ("bends", "twists", "phases", "directions", "normals"):
            same(getattr(one, name), getattr(other, name))
            assert not getattr(other, name).flags.writeable
    elif dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            same(getattr(one, field.name), getattr(other, field.name))
        if isinstance(one, Load):
            assert isinstance(other, Load)
            same(*(LINE.evaluate(GRID, "torque", load=load).torque for load in (one, other)))
    elif isinstance(one, Mapping):
        assert isinstance(other, Mapping)
        assert list(one) == list(other)
        for key in one:
            same(one[key], other[key])
        if hasattr(one, "to_arrow"):
            assert one.to_arrow().equals(other.to_arrow(), check_metadata=True)  # type: ignore[attr-defined]
    elif isinstance(one, tuple | list):
        assert isinstance(other, tuple | list)
        assert len(one) == len(other)
        for mine, theirs in zip(one, other, strict=True):
            same(mine, theirs)
    else:
        assert one == other


def through_a_message(thing: object) -> object:
    """Pickle with the arrays' memory apart, to be found anywhere in a message."""
    apart: list[pickle.PickleBuffer] = []
    pickled = pickle.dumps(thing, 5, buffer_callback=apart.append)
    return pickle.loads(pickled, buffers=[memoryview(b"." + part.raw())[1:] for part in apart])


@pytest.mark.parametrize("thing", OBJECTS, ids=lambda thing: type(thing).__name__)
@pytest.mark.parametrize(
    "again",
    [copy.copy, copy.deepcopy, through_a_message]
    + [
        lambda thing, protocol=protocol: pickle.loads(pickle.dumps(thing, protocol))
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)
    ],
)
def test_pickles_and_copies(thing: object, again: Callable[[object], object]) -> None:
    same(thing, again(thing))


def test_every_public_object_is_pickled_above() -> None:
    public = [getattr(cardan, name) for name in vars(cardan)["__all__"]]
    classes = {value for value in public if isinstance(value, type)}
    assert classes | {SceneResult, StudyResult} <= {type(thing) for thing in OBJECTS}
    others = [
        thing for thing in public if not isinstance(thing, type | FunctionType | ModuleType | str)
    ]
    assert all(any(other is thing for thing in OBJECTS) for other in others)


def test_a_pickled_scene_still_runs() -> None:
    again: Scene = pickle.loads(pickle.dumps(SCENE))
    same(again.run(), RESULT)


# --- threads -----------------------------------------------------------------------------------

THREADS = """
import os
import numpy as np
from cardan import Driveline

line, angle = Driveline.from_bends([0.5]), np.linspace(0, 6, 1_000_000)
before = len(os.listdir("/proc/self/task"))
line.evaluate(angle)
print(len(os.listdir("/proc/self/task")) - before)
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no /proc here")
@pytest.mark.parametrize("threads", [1, 3])
def test_the_environment_limits_the_threads(threads: int) -> None:
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    done = subprocess.run(
        [sys.executable, "-c", THREADS], env=environment, capture_output=True, text=True
    )
    assert (done.stderr, int(done.stdout)) == ("", threads)
