"""The boundary between Python and Rust: strange arrays and objects, threads, exit, memory, panics.

What test_arrays.py says of ordinary shapes, layouts and messages is not repeated here.
"""

from __future__ import annotations

import contextlib
import copy
import math
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import hypothesis.extra.numpy as arrays_of
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tiers
from cardan import OUTPUTS, BallJoint, Driveline, Load, Plan, Scene, Sweep, TorsionalSystem, _core
from refusals import refusals

LINE = Driveline.from_bends([0.5, 0.4], 0.3, 0.9)
LOAD = Load(drive_torque=2.0, speed=3.0, inertias=[0.1, 0.2, 0.3])
GRID = np.linspace(-3.0, 9.0, 60)
NAMES = ("angle", "torque", "moment")


def evaluate(angle: Any, out: Any = None, line: Driveline = LINE) -> Any:  # noqa: ANN401
    return line.evaluate(angle, NAMES, load=LOAD, out=out)


def same(got: Any, want: Any) -> None:  # noqa: ANN401
    for name in NAMES:
        assert np.array_equal(got[name], want[name]), name


# --- arrays ------------------------------------------------------------------------------------


def unaligned(array: np.ndarray) -> np.ndarray:
    raw = np.zeros(array.nbytes + 1, np.uint8)
    view = raw[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    assert not view.flags.aligned
    return view


class Subclass(np.ndarray):
    """An array of a kind of its own."""


LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "unaligned": unaligned,
    "byte-swapped": lambda a: a.astype(">f8"),
    "negative strides": lambda a: a[::-1].copy()[::-1],
    "every other": lambda a: np.repeat(a, 2, axis=-1)[..., ::2],
    "Fortran": np.asfortranarray,
    "read-only broadcast": lambda a: np.broadcast_to(a, (1, *a.shape))[0],
    "subclass": lambda a: a.view(Subclass),
    "column of a record": lambda a: np.rec.fromarrays([a, a]).f1,
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_geometry_and_loads_of_any_layout(layout: str) -> None:
    """Angles of most layouts are in test_arrays.py."""
    disguise = LAYOUTS[layout]
    bends, torque = np.array([[0.5, 0.4], [0.1, 1.2]]), np.array([2.0, 5.0])
    line, angle = Driveline.from_bends(disguise(bends), 0.3, 0.9), np.array([0.3, 4.0])
    assert type(line.bends) is np.ndarray
    got = line.evaluate(disguise(angle), NAMES, load=Load(output_torque=disguise(torque)))
    plain = Driveline.from_bends(bends, 0.3, 0.9)
    same(got, plain.evaluate(angle, NAMES, load=Load(output_torque=torque)))
    points = np.array([[0.0, 0, 0], [1, 0.1, 0], [2, 0.3, 0.1], [3, 0.1, 0.2]])
    assert np.array_equal(
        Driveline.from_points(disguise(points)).bends, Driveline.from_points(points).bends
    )


def test_memory_mapped_arrays(tmp_path: Path) -> None:
    GRID.tofile(tmp_path / "angle")
    angle = np.memmap(tmp_path / "angle", np.float64, "r")
    out = np.memmap(tmp_path / "out", np.float64, "w+", shape=(60,))
    got = evaluate(angle, {"angle": out})
    same(got, evaluate(GRID))
    out.flush()
    assert np.array_equal(np.fromfile(tmp_path / "out"), evaluate(GRID).angle)
    # A map that may not be written is refused, a copy on write is not written through.
    read_only = np.memmap(tmp_path / "out", np.float64, "r")
    with pytest.raises(ValueError, match="read-only"):
        evaluate(GRID, {"angle": read_only})
    evaluate(GRID + 1.0, {"angle": np.memmap(tmp_path / "out", np.float64, "c")})
    assert np.array_equal(np.fromfile(tmp_path / "out"), evaluate(GRID).angle)


@pytest.mark.parametrize("kind", [Subclass, np.matrix])
def test_subclasses_to_fill(kind: type[np.ndarray]) -> None:
    row = np.full((1, 60), np.nan).view(kind)
    got = evaluate(GRID[np.newaxis], {"angle": row})
    assert got.angle is row
    assert np.array_equal(np.asarray(row)[0], evaluate(GRID).angle)


def test_masks_are_not_lost() -> None:
    masked = np.ma.masked_array(GRID, GRID > 3)
    with pytest.raises(TypeError, match="angle has masked entries"):
        evaluate(masked)
    with pytest.raises(TypeError, match="MaskedArray; it must be an array"):
        evaluate(GRID, {"angle": masked.copy()})
    assert np.isnan(evaluate(masked.filled(math.nan)).angle).sum() == (GRID > 3).sum()


def test_zero_sizes() -> None:
    """An axis of length zero anywhere, beside others of any length."""
    for shape in ((0,), (0, 10**15), (3, 0), (0, 0)):
        angle = np.broadcast_to(1.0, shape)
        assert evaluate(angle).moment.shape == (2, *shape, 3)
    none = Driveline.from_bends(np.zeros((0, 2)))
    assert evaluate(np.zeros((3, 1)), line=none).moment.shape == (2, 3, 0, 3)
    assert none.optimal_phases().shape == (0, 1)
    assert none.equivalent().k.shape == (0,)
    assert dict(LINE.evaluate(GRID, (), reduce="max")) == {}
    with pytest.raises(ValueError, match="no driveline"):
        none.plan().explain()


# --- objects -----------------------------------------------------------------------------------


class Failing:
    """Whatever is asked of it fails with this."""

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:  # noqa: ANN401
        raise self.error

    def __index__(self) -> int:
        raise self.error

    def __float__(self) -> float:
        raise self.error


@pytest.mark.parametrize("error", [RuntimeError("no"), MemoryError("no"), KeyboardInterrupt("no")])
def test_errors_of_objects_come_through(error: BaseException) -> None:
    broken: Any = Failing(error)
    for call in (
        lambda: evaluate(broken),
        lambda: evaluate([broken]),
        lambda: Driveline.from_bends(broken),
        lambda: Load(speed=broken),
        lambda: LINE.evaluate(GRID, shafts=broken),
        lambda: LINE.evaluate(GRID, workers=broken),
        lambda: Sweep(broken, 1.0, 5),
        lambda: Sweep(0.0, 1.0, broken),
    ):
        with pytest.raises(type(error), match="no"):
            call()


class Wrong:
    """What it hands over is no array."""

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:  # noqa: ANN401
        return "an array"


test_what_else_is_refused = refusals(
    {
        "__array__": lambda: evaluate(Wrong()),
        "TypeError: out is ndarray; it must map names of outputs": lambda: evaluate(GRID, GRID),
        "TypeError: out is list; it must map": lambda: LINE.evaluate(GRID, out=[GRID]),  # type: ignore[arg-type]
        "a sweep has at most": lambda: Sweep.revolutions(1e300, 10),
        "start is inf rad": lambda: Sweep(10**400, 1.0, 5),
        "TypeError: it must be a number": lambda: LINE.evaluate(GRID, tolerance=10**400),
    }
)


def test_more_workers_than_can_be_counted() -> None:
    same(LINE.evaluate(GRID, NAMES, load=LOAD, workers=2**70), evaluate(GRID))


def test_everything_public_is_pickled_and_copied() -> None:
    scene = Scene.parse("[driveline]\nbends_deg = [8.5]\n")
    system = TorsionalSystem(
        LINE, inertias=0.1 * np.ones((3, 2)), stiffnesses=[np.inf, 9e3, 9e3], drive="held"
    )
    things = {
        "line": LINE,
        "plan": LINE.plan(NAMES, load=LOAD),
        "sweep": Sweep(0.0, 1.0, 7),
        "load": LOAD,
        "result": evaluate(GRID),
        "equivalent": LINE.equivalent(),
        "harmonics": LINE.harmonics([2, 4]),
        "check": LINE.check(100.0),
        "gradient": LINE.plan("moment", load=LOAD).gradient(GRID, {"moment": 1.0}),
        "losses": LINE.losses(LOAD, friction=0.02, pin_radius=0.008, arm=0.03),
        "tolerances": LINE.tolerances(bends=0.01, samples=10, seed=0),
        "order tolerances": LINE.order_tolerances(0.01),
        "free running": LINE.free_running([1.0, 0.5, 0.2]),
        "system": system,
        "transient": system.transient([0.0, 0.01], speed=90.0),
        "ball joint": BallJoint(0.02),
        "scene's line": scene.line,
        "output": OUTPUTS["angle"],
    }
    for name, thing in things.items():
        for again in (pickle.loads(pickle.dumps(thing)), copy.copy(thing), copy.deepcopy(thing)):
            assert type(again) is type(thing), name
            assert repr(again) == repr(thing), name
    assert " _" not in repr(things["free running"])
    plan = pickle.loads(pickle.dumps(things["plan"]))
    assert isinstance(plan, Plan)
    same(plan(GRID), evaluate(GRID))
    # What is native has no way of its own into a pickle, and says so.
    with pytest.raises(TypeError, match="cannot pickle"):
        pickle.dumps(LINE._lines)


# --- threads -----------------------------------------------------------------------------------

LONG = np.linspace(0.0, 700.0, 300_000)


def at_once(count: int, call: Callable[[int], Any]) -> list[Any]:
    """What each of so many threads gets from its call, or its error."""
    ready = threading.Barrier(count)

    def one(i: int) -> Any:  # noqa: ANN401
        ready.wait()
        try:
            return call(i)
        except RuntimeError as error:
            return error

    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(one, range(count)))


def test_threads_share_inputs_and_plans() -> None:
    plan, batch = LINE.plan("angle"), Driveline.from_bends(np.full((50, 1, 2), 0.4))
    want, wanted = plan(LONG).angle, batch.evaluate(LONG[:5000]).angle
    for got in at_once(4, lambda _: (plan(LONG).angle, batch.evaluate(LONG[:5000]).angle)):
        assert np.array_equal(got[0], want)
        assert np.array_equal(got[1], wanted)


def test_threads_share_what_they_fill() -> None:
    """One fills it, the others are refused; none sees half of another's result."""
    plan = LINE.plan("angle", tolerance=0)
    want, refused = plan(LONG).angle, 0
    out = np.empty_like(LONG)
    for _ in range(20):
        for got in at_once(4, lambda _: plan(LONG, out={"angle": out})):
            if isinstance(got, RuntimeError):
                assert str(got) == "out is in use by another call"
                refused += 1
        assert np.array_equal(out, want)
        if refused:
            break
    assert refused, "no two calls met"
    # Parts of one array that do not overlap are filled at the same time.
    parts = np.empty((4, LONG.size))
    for got in at_once(4, lambda i: plan(LONG, out={"angle": parts[i]})):
        assert not isinstance(got, RuntimeError)
    assert all(np.array_equal(part, want) for part in parts)


def script(code: str, *arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:  # noqa: ANN401
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, **options)


LEAVING = """
import sys, threading, time
import numpy as np
from cardan import Driveline

line = Driveline.from_bends([0.5, 0.4])
angle = np.linspace(0, 6, int(sys.argv[1]))
begun = threading.Barrier(4)

def work(workers):
    line.evaluate(angle, workers=workers)
    begun.wait()
    while True:
        line.evaluate(angle, workers=workers)

class Slow:
    def __del__(self):
        time.sleep(0.3)

slow = Slow()  # falls when the interpreter is being taken down, while the threads go on
for workers in (1, 2, None):
    threading.Thread(target=work, args=(workers,), daemon=True).start()
begun.wait()
"""


@pytest.mark.parametrize("length", [300, 30_000, 3_000_000])
def test_the_interpreter_ends_during_a_call(length: int) -> None:
    done = script(LEAVING, str(length))
    assert (done.returncode, done.stderr) == (0, "")


FORKING = """
import os, sys, threading
import numpy as np
from cardan import Driveline, Sweep

line = Driveline.from_bends([0.5, 0.4])
angle = np.linspace(0, 6, 3_000_000)
want = line.evaluate(angle).angle
busy = threading.Thread(target=lambda: [line.evaluate(angle) for _ in range(5)])
busy.start()
for _ in range(3):
    child = os.fork()
    if not child:
        right = np.array_equal(line.evaluate(angle).angle, want)  # long enough to be watched
        right &= line.evaluate(Sweep(0, 6, 3_000_000), reduce="max").angle == want.max()
        os._exit(0 if right else 1)
    assert os.waitpid(child, 0)[1] == 0
busy.join()
"""


@pytest.mark.xdist_group("fork")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_fork_during_a_call() -> None:
    """That forked processes evaluate at all is in test_arrays.py."""
    done = script("import warnings; warnings.simplefilter('ignore')\n" + FORKING)
    assert done.returncode == 0, done.stderr


# --- memory ------------------------------------------------------------------------------------


@pytest.mark.xdist_group("memory")
@pytest.mark.parametrize(
    "call",
    [
        lambda: evaluate(np.broadcast_to(1.0, (10**15,))),
        lambda: evaluate(np.broadcast_to(1.0, (10**6, 1, 10**9))),
        lambda: evaluate(np.zeros((10**6, 1)), line=Driveline.from_bends(np.ones((10**6, 2)))),
        lambda: evaluate(np.broadcast_to(True, (2**40, 2**20))),
        lambda: Driveline.from_bends(np.full((4096, 1, 1), 0.3)).evaluate(Sweep(0.0, 1.0, 2**50)),
        lambda: Driveline.from_bends(np.broadcast_to(0.5, (10**15, 1))),
        lambda: Driveline.from_bends(np.broadcast_to(0.5, (1, 10**15))),
        lambda: LINE.evaluate(Sweep(0.0, 1.0, 10**12)),
        lambda: LINE.evaluate(Sweep(0.0, 1.0, 10**12), dtype=np.float32),
        lambda: LINE.evaluate(Sweep(0.0, 1.0, 2**50), reduce="rms"),
        lambda: np.asarray(Sweep(0.0, 1.0, 10**12)),
        lambda: _core.from_bends(2, [2**40, 2**40], GRID, GRID, GRID),
        lambda: _core.from_bends(2**63, [1], GRID, GRID, GRID),
    ],
)
def test_sizes_beyond_memory(call: Callable[[], Any]) -> None:
    with pytest.raises(MemoryError):
        call()


TIGHT = """
import resource, sys
import numpy as np
from cardan import Driveline, Load, Sweep

angle = np.linspace(0, 6, 200_000)
Driveline.from_bends([0.5]).evaluate(angle)  # the threads are there
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
left = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_AS, (used + left, used + left))

def chain(joints, batch=()):
    return Driveline.from_bends(np.full((*batch, joints), 0.1))

load = Load(drive_torque=1.0)
for call in (
    lambda: chain(3).evaluate(angle, ("angle", "moment"), load=load),
    lambda: chain(256, (400,)),
    lambda: chain(256, (120,)).plan("angle"),
    lambda: chain(256).evaluate(angle[:2000], ("moment", "support_moment"), load=load),
    lambda: chain(64, (3000,)).evaluate(angle[:3000], "speed_ratio"),
    lambda: chain(8, (20_000, 1)).evaluate(Sweep(0, 6, 50), "angle", reduce="max"),
    lambda: chain(8, (20_000,)).equivalent(),
    lambda: chain(3, (2_000,)).optimal_phases(),
):
    try:
        call()
    except MemoryError:
        pass
"""


@pytest.mark.xdist_group("memory")
@pytest.mark.skipif(sys.platform != "linux", reason="a limit of address space")
@pytest.mark.parametrize("megabytes", [1, 4, 16, 64])
def test_memory_that_runs_out(megabytes: int) -> None:
    """With little left every call is done or raises MemoryError; the process never aborts."""
    done = script(TIGHT, str(megabytes << 20))
    assert (done.returncode, done.stderr) == (0, "")


NO_POOL = """
import resource, sys
import numpy as np
import cardan
from cardan import Driveline

angle, line = np.linspace(0, 6, 3_000_000), Driveline.from_bends([0.5])
out = {"angle": np.empty_like(angle)}
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
# Less than one thread's stack.
resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 20), used + (1 << 20)))
line.evaluate(angle, "angle", out=out)
assert out["angle"][-1] > 5
"""


@pytest.mark.xdist_group("memory")
@pytest.mark.skipif(sys.platform != "linux", reason="a limit of address space")
def test_no_thread_can_be_made() -> None:
    done = script(NO_POOL)
    assert (done.returncode, done.stderr) == (0, "")


# --- panics ------------------------------------------------------------------------------------

COUNTS = st.one_of(st.integers(0, 4), st.sampled_from([2**40, 2**62, 2**63, 2**64 - 1]))
FLAT = arrays_of.arrays(np.float64, st.integers(0, 12), elements=st.floats(0.0, 1.5))
INDICES = st.lists(COUNTS, max_size=3)
SOURCES = arrays_of.arrays(
    np.float64,
    arrays_of.array_shapes(min_dims=0, max_dims=2, min_side=0, max_side=5),
    elements=st.floats(0.0, 1.5),
)


@settings(max_examples=tiers.part(400))
@given(st.data())
def test_the_native_module_takes_nothing_on_trust(data: st.DataObject) -> None:
    """Arguments of the right types only, whatever they hold: results or refusals, no panic."""
    draw = data.draw
    n, shape = draw(COUNTS), draw(INDICES)
    first, second, third = draw(FLAT), draw(FLAT), draw(FLAT)
    fitting = draw(st.booleans())
    if fitting:
        n = draw(st.integers(1, 3))
        first, second, third = np.full(n, 0.3), np.zeros(n - 1), np.zeros(n - 1)
    rest, bearings = [first, third, draw(FLAT), draw(FLAT)], draw(INDICES)
    if fitting:
        bearings = draw(st.lists(st.integers(0, n), max_size=4))
        sizes = (3 * (n + 1), 3 * n, n + 1, len(bearings))
        rest = [np.full(size, 0.5) for size in sizes]
    for call in (
        lambda: _core.from_bends(n, shape, first, second, third),
        lambda: _core.from_directions(n, shape, first, second),
        lambda: _core.from_points(n, shape, first, second),
        lambda: _core.equivalent(n, shape[0] if shape else 1, first, second, third),
        lambda: _core.optimal_phases(n, first, second, third, draw(st.sampled_from([None, 0, 1]))),
        lambda: _core.Sweep(draw(st.sampled_from([None, (0.0, 1.0)])), n, 7).fill(0, np.empty(5)),
        lambda: planned(
            draw, _core.Lines(n, [] if fitting else shape, [first, second, third, *rest], bearings)
        ),
    ):
        with contextlib.suppress(ValueError, MemoryError):
            call()


def planned(draw: Any, lines: _core.Lines) -> None:  # noqa: ANN401
    with contextlib.suppress(IndexError):
        transmission = _core.Transmission(lines, draw(COUNTS))
        transmission.motion(np.array([0, min(draw(COUNTS), 2**62)]), np.array([0.1, np.nan]))
    single = draw(st.booleans())
    reduction = draw(st.sampled_from([None, "max", "rms", "peak"]))
    loads = st.tuples(
        st.sampled_from(["drive", "output", "?"]),
        *[SOURCES] * 3,
        st.lists(st.tuples(COUNTS, SOURCES), max_size=2),
    )
    names = tuple(draw(st.lists(st.sampled_from(sorted(OUTPUTS)), max_size=4)))
    plan = _core.Plan(
        lines,
        names,
        draw(st.lists(st.tuples(st.one_of(st.none(), COUNTS), st.booleans()), max_size=4)),
        draw(st.sampled_from([[], [0], [1], [0, 1], [7]])),
        draw(st.sampled_from([[], [0], [7]])),
        draw(st.one_of(st.none(), loads)),
        draw(st.sampled_from([None, 0.0, 1e-9, 1e-3])),
        single,
        reduction,
        draw(st.sampled_from(["space", "shaft", "?"])),
    )
    shapes = st.lists(st.one_of(st.integers(0, 5), COUNTS), max_size=2).map(tuple)
    sweep = draw(st.sampled_from([None, _core.Sweep(None, 7, 3)]))
    with contextlib.suppress(ValueError, MemoryError):
        plan.explain(draw(shapes), sweep)
    word = np.float32 if single and reduction is None else np.float64
    planes = [draw(SOURCES).astype(word) for _ in range(draw(st.integers(0, 3)))]
    named = {name: draw(SOURCES).astype(word) for name in names}
    out = draw(st.sampled_from([None, planes, named]))
    done = plan.run(
        draw(st.one_of(st.none(), shapes)),
        draw(st.one_of(SOURCES, st.just(_core.Sweep((0.0, 1.0), 5, 0)))),
        out,
        draw(st.sampled_from([None, 0, 1, 2])),
        None,
    )
    if out is named:
        assert done is None or list(done) == list(names)
    else:
        assert done is None or done is out or (out is None and done.dtype == word)
