"""dask arrays in, dask arrays out: the bits of NumPy's rows, by any scheduler, in any chunks."""

from __future__ import annotations

import copy
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")

from cardan import Driveline, Load, Result, Sweep  # noqa: E402
from cardan.app.scene.study import cluster  # noqa: E402
from cardan.arrays import threads  # noqa: E402
from cardan.evaluation.reductions import REDUCTIONS  # noqa: E402
from cardan.interop.lazy import LazyDriveline  # noqa: E402
from refusals import refusals  # noqa: E402

RANDOM = np.random.default_rng(7)
ANGLE = RANDOM.uniform(-9, 9, 200)
LINE = Driveline.from_bends([0.2, 0.3], 0.1, 0.4)
BENDS = RANDOM.uniform(0, 1, (30, 1, 2))
BATCH = Driveline.from_bends(BENDS, 0.1, [0.4])
LOAD = Load(drive_torque=2.0, speed=3.0, inertias=[0, 0.1, 0.2])
VARIED = Load(output_torque=ANGLE, speed=3.0, inertias=RANDOM.uniform(0, 1, (200, 3)))
NAMES = ("angle", "moment", "torque")


@pytest.fixture(autouse=True)
def in_this_thread() -> Iterator[None]:
    with dask.config.set(scheduler="synchronous"):
        yield


def chunked(array: Any, *sizes: int) -> Any:  # noqa: ANN401
    return da.from_array(array, chunks=sizes)


def lazily(bends: Any, *sizes: int) -> Any:  # noqa: ANN401
    """Drivelines as LINE and BATCH have them, of a dask array."""
    return Driveline.from_bends(chunked(np.asarray(bends), *sizes), 0.1, phases=[0.4])


def check(lazy: Result, want: Result, rtol: float = 0.0) -> None:
    for name, array in lazy.items():
        assert isinstance(array, da.Array), name
        assert (array.shape, array.dtype) == (want[name].shape, want[name].dtype)
    for name, array in lazy.compute().items():
        assert array.dtype == want[name].dtype
        np.testing.assert_allclose(array, want[name], rtol=rtol, atol=rtol)


@pytest.mark.parametrize("load", [LOAD, VARIED])
@pytest.mark.parametrize("options", [{}, {"shafts": [0, 1], "joints": 1}, {"dtype": np.float32}])
@pytest.mark.parametrize("size", [7, 64, 200])
def test_angles_in_chunks(load: Load, options: dict[str, Any], size: int) -> None:
    angle = chunked(ANGLE, size)
    for line in (LINE, BATCH):
        arguments: dict[str, Any] = {"load": load, **options}
        check(line.evaluate(angle, NAMES, **arguments), line.evaluate(ANGLE, NAMES, **arguments))


@pytest.mark.parametrize("angle", [ANGLE, chunked(ANGLE, 64), 0.3, Sweep.revolutions(2, 36)])
@pytest.mark.parametrize("size", [7, 30])
def test_geometry_in_chunks(angle: Any, size: int) -> None:  # noqa: ANN401
    line = lazily(BENDS, size, 1, 1)
    assert repr(line) == "<LazyDriveline batch (30, 1) of 2 joints>"
    want = BATCH.evaluate(
        np.asarray(angle) if isinstance(angle, da.Array) else angle, NAMES, load=LOAD
    )
    check(line.evaluate(angle, NAMES, load=LOAD), want)
    assert np.array_equal(line.compute().directions, BATCH.directions)


def test_geometry_and_angles_in_pairs() -> None:
    bends = RANDOM.uniform(0, 1, (200, 2))
    line = Driveline.from_bends(bends, 0.1, [0.4])
    want = line.evaluate(ANGLE, NAMES, load=VARIED)
    check(lazily(bends, 33, 2).evaluate(chunked(ANGLE, 50), NAMES, load=VARIED), want)
    check(line.evaluate(chunked(ANGLE, 50), NAMES, load=VARIED), want)


@pytest.mark.parametrize("reduce", REDUCTIONS)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_reductions(reduce: Any, dtype: Any) -> None:  # noqa: ANN401
    options: dict[str, Any] = {"load": LOAD, "reduce": reduce, "dtype": dtype}
    rounding = float(np.finfo(dtype).eps) * 8 if reduce in ("mean", "rms") else 0.0
    for line in (LINE, BATCH):
        want = line.evaluate(ANGLE, NAMES, **options)
        check(line.evaluate(chunked(ANGLE, 60), NAMES, **options), want, rounding)
        # A row that is not cut has one sum.
        check(line.evaluate(chunked(ANGLE, 200), NAMES, **options), want)
    sweep = Sweep.revolutions(2, 36)
    check(
        lazily(BENDS, 7, 1, 2).evaluate(sweep, NAMES, **options),
        BATCH.evaluate(sweep, NAMES, **options),
    )


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda line: pickle.loads(pickle.dumps(line))]
)
def test_pickles_and_copies(again: Callable[[Any], Any]) -> None:
    line = lazily(BENDS, 7, 1, 2)
    other = again(line)
    assert repr(other) == repr(line)
    check(other.evaluate(ANGLE, NAMES, load=LOAD), BATCH.evaluate(ANGLE, NAMES, load=LOAD))


def test_a_single_driveline_of_a_dask_array() -> None:
    line = lazily([0.2, 0.3], 1)
    for angle in (0.3, Sweep(0.0, 1.0, 5), ANGLE):
        check(line.evaluate(angle), LINE.evaluate(angle))
        if np.ndim(angle):
            check(line.evaluate(angle, reduce="max"), LINE.evaluate(angle, reduce="max"))
    check(LINE.evaluate(da.from_array(np.array(0.3))), LINE.evaluate(0.3))


def test_every_constructor() -> None:
    points = RANDOM.uniform(-0.1, 0.1, (9, 4, 3)) + np.arange(4)[:, None] * [1, 0, 0]
    slopes = RANDOM.uniform(-20, 20, (2, 9, 3))
    made: list[tuple[Any, tuple[Any, ...]]] = [
        (Driveline.from_points, (points,)),
        (Driveline.from_directions, (np.diff(points, axis=1),)),
        (Driveline.from_slopes, tuple(slopes)),
        (Driveline.from_projected_bends, tuple(slopes[..., :2])),
    ]
    for make, arrays in made:
        phases = RANDOM.uniform(-90, 90, (9, 1))
        want = make(*arrays, phases, degrees=True)
        pieces = [da.from_array(array, chunks=2) for array in arrays]
        for lazy in (
            make(*pieces, phases, degrees=True),
            make(*arrays, phases=da.from_array(phases, chunks=4), degrees=True),
        ):
            assert isinstance(lazy, LazyDriveline)
            assert (lazy.shape, lazy.n_joints) == (want.shape, want.n_joints)
            check(lazy.evaluate(0.7, "angle"), want.evaluate(0.7, "angle"))


def test_equivalent_joints() -> None:
    for shaft in (1, -1):
        lazy, want = lazily(BENDS, 7, 1, 2).equivalent(shaft), BATCH.equivalent(shaft)
        for name, array in vars(want).items():
            assert np.array_equal(getattr(lazy, name).compute(), array)


def test_labelled_angles_of_dask() -> None:
    xarray = pytest.importorskip("xarray")
    angle = xarray.DataArray(ANGLE, dims="time", coords={"time": np.arange(200)})
    lazy: Any = LINE.evaluate(angle.chunk(time=64), NAMES, load=LOAD)
    assert lazy.angle.chunks == ((64, 64, 64, 8),)
    assert lazy.compute().identical(LINE.evaluate(angle, NAMES, load=LOAD))
    bends = xarray.DataArray(BENDS).chunk(7)
    assert isinstance(Driveline.from_bends(bends), LazyDriveline)

    result = LINE.evaluate(chunked(ANGLE, 64), NAMES, load=LOAD)
    dataset = result.to_xarray()
    # Nothing is computed for a label.
    assert dataset.drive_angle.chunks == dataset.angle.chunks == ((64, 64, 64, 8),)
    assert dataset.angle.dims == ("sample",)
    want = LINE.evaluate(ANGLE, NAMES, load=LOAD)
    assert result.to_arrow().equals(want.to_arrow())


test_what_cannot_be_done = refusals(
    {
        "TypeError: angle has dtype complex128": lambda: LINE.evaluate(da.ones(5, dtype=complex)),
        "TypeError: out does not go with dask arrays": lambda: LINE.evaluate(da.ones(5), out={}),
        'is "torque", which needs a load': lambda: LINE.evaluate(da.ones(5), "torque"),
        "shapes do not broadcast: driveline": lambda: BATCH.evaluate(da.ones((4, 5))),
        "shapes do not broadcast: samples (7,), angle (7,), torque (200,)": lambda: LINE.evaluate(
            da.ones(7), "torque", load=VARIED
        ),
        "the load has more samples than drivelines and angles, (1,)": lambda: LINE.evaluate(
            da.ones(1), "torque", load=VARIED
        ),
        "angle has chunks of unknown size; call its compute_chunk_sizes first": lambda: (
            LINE.evaluate(chunked(ANGLE, 9)[chunked(ANGLE, 9) > 0])
        ),
        "TypeError: speed is a dask.Array; make it an array of": lambda: Load(speed=da.ones(5)),
        "points has shape (3,); it needs 2": lambda: Driveline.from_points(da.ones(3)),
        "a driveline has no joint": lambda: Driveline.from_bends(da.ones((3, 0))),
        "TypeError: 'degree'": lambda: Driveline.from_bends(da.ones(3), degree=True),  # type: ignore[call-arg]
        "outputs[0] is 'spin'": lambda: lazily(BENDS, 7, 1, 2).evaluate(0.1, "spin"),
        "IndexError: shaft is 3": lambda: lazily(BENDS, 7, 1, 2).equivalent(3),
        "angle_of is 'driven'; drivelines of dask arrays take the drive angle": lambda: lazily(
            BENDS, 7, 1, 2
        ).evaluate(0.1, "speed_ratio", angle_of="driven"),
        "a bend must lie in [0, pi/2), with pi/2 as a double": lambda: (
            lazily(BENDS + 1, 7, 1, 2).evaluate(0.1).compute()
        ),
    }
)


def test_a_task_keeps_to_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    lazy = lazily(BENDS, 7, 1, 2).evaluate(chunked(ANGLE, 64), NAMES, load=LOAD)
    more = LINE.evaluate(chunked(ANGLE, 64), NAMES, load=LOAD, workers=3)
    asked: list[int | None] = []

    def at_most(workers: int | None) -> int | None:
        asked.append(workers)
        return workers

    monkeypatch.setattr(threads, "at_most", at_most)
    lazy.compute()
    assert set(asked) == {1}
    more.compute()
    assert set(asked) == {1, 3}


@pytest.mark.long
def test_on_a_cluster_of_processes() -> None:
    pytest.importorskip("distributed")
    with cluster.connect(processes=2) as client, dask.config.set(scheduler=None):
        assert len(set(client.run(os.getpid).values())) == 2
        check(
            LINE.evaluate(chunked(ANGLE, 64), NAMES, load=LOAD),
            LINE.evaluate(ANGLE, NAMES, load=LOAD),
        )
        check(
            lazily(BENDS, 7, 1, 2).evaluate(chunked(ANGLE, 64), NAMES, load=VARIED),
            BATCH.evaluate(ANGLE, NAMES, load=VARIED),
        )
        evaluated = client.run(lambda: "cardan.interop.lazy" in sys.modules)
        assert list(evaluated.values()) == [True, True]


def test_degrees_of_later() -> None:
    turn = np.linspace(0.0, 360.0, 40)
    line = Driveline.from_bends([0.3, 0.4])
    want = line.evaluate(turn, degrees=True)
    later = line.evaluate(da.from_array(turn, chunks=16), degrees=True)
    assert later.units["angle"] == "deg"
    assert later != want
    assert later.compute() == want
    lazy = Driveline.from_bends(da.from_array(np.array([[0.3, 0.4]]), chunks=1))
    assert lazy.evaluate(turn, degrees=True).compute() == want


@pytest.mark.parametrize("name", ["lengths", "free_running", "spline_force", "harmonics", "plan"])
def test_what_only_computed_drivelines_do(name: str) -> None:
    lazy = lazily(BENDS, 7, 1, 2)
    with pytest.raises(AttributeError, match=rf"{name}'; compute\(\) makes drivelines, which have"):
        getattr(lazy, name)
    assert hasattr(lazy.compute(), name)
    with pytest.raises(AttributeError, match=r"has no attribute 'lenghts'$"):
        _ = lazy.lenghts
    assert pickle.loads(pickle.dumps(lazy)).shape == lazy.shape
