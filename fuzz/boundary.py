"""Calls of the library with arbitrary arguments, and of the native module behind it (atheris).

A case makes a driveline and goes on from object to object: it picks a function of the library or
something public of what was returned before, and draws each argument by the name of its parameter.
The native module is called with arguments of the right types only, and must not rely on what
stands before it. Every call gives a result or is refused by an exception of the kinds below. A
panic is none of them and ends the run. Threads, sweeps and arrays to fill give the same bits.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    import cardan
    from cardan import (
        BallJoint,
        Driveline,
        LateralSystem,
        Load,
        Plan,
        Sweep,
        TorsionalSystem,
        _core,
    )

import numpy as np

REFUSED = (ValueError, TypeError, LookupError, MemoryError, OverflowError)
DTYPES = ("f4", "i8", "u1", "?", "f2", ">f8", "c16", "O", "S2", "m8[s]")
NUMBERS = (0.0, -0.0, 0.3, 1.5, -7.0, 1e-300, 5e-324, 1e12, 1e300, np.inf, -np.inf, np.nan)
REDUCTIONS = ("min", "max", "mean", "rms", "peak", "no")
FIGURES = ("equivalent_bend", "max_angle_error", "angle_error_order_1", "joint_force_0_peak")
BY = ("bends", "twists", "phases", "points", "angle", "drive_torque", "inertias", "deviations")
FUNCTIONS = (
    *(BallJoint, Load, Sweep, TorsionalSystem, BallJoint.sized_for, Sweep.revolutions),
    *(LateralSystem, LateralSystem, cardan.firing_harmonics, cardan.Machine),
    *(cardan.identify, cardan.identify_two_joints, cardan.optimise, cardan.tube),
    *(getattr(Driveline, name) for name in dir(Driveline) if name.startswith("from_")),
)
# What other packages answer, and what takes as long as the time that it is asked for.
LEFT_OUT = ("plot", "to_arrow", "to_pandas", "to_xarray", "compute", "transient")
OPERATORS = ("__call__", "__getitem__", "__repr__")
LONGEST = 600
"""Samples, more than one chunk of the core has."""
MOST = 40
"""Elements of arrays that become joints, drivelines or orders."""


class Input(atheris.FuzzedDataProvider):
    """Arguments from bytes: three times in four such as fit, else anything."""

    def __init__(self, data: bytes) -> None:
        """Take the bytes."""
        super().__init__(data)
        self.wild = self.ConsumeIntInRange(0, 3) == 0
        self.line = Driveline.from_bends([0.3, 0.2], 0.1)

    def pick(self, options: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return one of the options."""
        return options[self.ConsumeIntInRange(0, len(options) - 1)]

    def often(self, usual: Any, *others: Any) -> Any:  # noqa: ANN401
        """Return what is usual, or, among anything, one of the others."""
        return self.pick(others) if self.wild and self.ConsumeBool() else usual

    def some(self, names: Sequence[str]) -> list[str]:
        """Return some of the names, or an unknown one."""
        return [name for name in names if self.ConsumeIntInRange(0, 3) == 0] + self.often([], ["?"])

    def shape(self, most: int) -> tuple[int, ...]:
        """Return a shape of at most so many elements."""
        if not self.wild:
            return (self.ConsumeIntInRange(0, most),) if self.ConsumeBool() else ()
        shape = [self.ConsumeIntInRange(0, 5) for _ in range(self.ConsumeIntInRange(0, 3))]
        if shape and self.ConsumeBool():
            shape[-1] = self.ConsumeIntInRange(0, most)
        return tuple(shape) if np.prod(shape) <= most else tuple(shape[:1])

    def array(
        self, shape: tuple[int, ...] | None = None, dtype: str = "f8", most: int = MOST
    ) -> Any:  # noqa: ANN401
        """Return an array of any type and layout, or something like one."""
        shape = self.shape(most) if shape is None else shape
        values = [self.often(0.7, *NUMBERS), self.often(0.4, self.ConsumeRegularFloat())]
        values += [self.ConsumeIntInRange(-3, 15) / 10 for _ in range(3)]
        dtype = self.often(dtype, *DTYPES)
        with np.errstate(all="ignore"):
            array = np.resize(np.array(values), shape).reshape(shape)
            array = array.astype("i8" if dtype == "m8[s]" else "f8").astype(dtype)
        layout = self.ConsumeIntInRange(0, 7 if self.wild else 4)
        if layout == 0:
            array = np.asfortranarray(array)
        elif layout == 1 and array.ndim:
            array = array[::-1]
        elif layout == 2 and array.ndim:
            array = np.repeat(array, 2, -1)[..., ::2]
        elif layout == 3 and not array.dtype.hasobject:
            raw = np.zeros(array.nbytes + 1, "u1")
            raw[1:] = np.frombuffer(array.tobytes(), "u1")
            array = raw[1:].view(array.dtype).reshape(array.shape)
        elif layout == 5:
            return array.tolist()
        elif layout == 6:
            return self.pick((None, "a", 1j, object(), [[1], [1, 2]], {}, 10**400))
        elif layout == 7:
            array = np.broadcast_to(array.reshape(-1)[:1].sum(), shape)
        array.flags.writeable = array.flags.writeable and self.often(True, False)
        return array

    def arguments(self, function: Any) -> tuple[list[Any], dict[str, Any]]:  # noqa: ANN401
        """Return arguments of a function, each by the name of its parameter."""
        parameters = inspect.signature(function).parameters.values()
        flat = [p.name for p in parameters if p.kind is p.VAR_POSITIONAL]
        named = [p for p in parameters if p.name not in flat]
        if function is LateralSystem:
            self.line = self.drawn_line()
        own = USUAL | OWN.get(function, {})
        return [self.argument(name, own) for name in flat], {
            # By default there are very many samples, others in every call.
            p.name: USUAL[p.name](self)
            if p.name in ("samples", "seed")
            else self.argument(p.name, own)
            for p in named
            if p.default is p.empty or p.name in ("samples", "seed") or self.ConsumeBool()
        }

    def argument(self, name: str, usual: dict[str, Any]) -> Any:  # noqa: ANN401
        """Return an argument that fits the driveline, or anything."""
        return self.often(usual[name](self), self.array()) if name in usual else self.array()

    def joints(self) -> np.ndarray:
        """Return a number for each of a few joints, of one driveline or several."""
        batch = self.pick(((), (), (1,), (3, 1), (0, 1), (2, 3, 1)))
        return np.resize(self.flat() + 0.01, (*batch, self.ConsumeIntInRange(1, 4))) % 1.5

    def points(self) -> np.ndarray:
        """Return points along x that go aside."""
        points = np.zeros((self.ConsumeIntInRange(3, 5), 3))
        points[:, 0] = np.arange(len(points))
        points[1:, 1:] = self.array((len(points) - 1, 2))
        return points

    def bearings(self) -> list[tuple[int, float]]:
        """Return two bearings on both outer shafts and one on each other shaft but the last."""
        n = self.line.n_joints
        pairs = [(shaft, at) for shaft in (0, n) for at in (0.2, 0.6)]
        return pairs + [(shaft, 0.5) for shaft in range(1, n - 1)]

    def elastic_bearings(self) -> list[Any]:
        """Return elastic bearings at the same places."""
        stiffness = self.often(2e5, self.array(), self.array((2,)))
        loss = self.pick((0.0, 0.1))
        return [
            cardan.ElasticBearing(i, at, stiffness, loss_factor=loss, damping=self.pick((0.0, 9.0)))
            for i, at in self.bearings()
        ]

    def drawn_line(self) -> Driveline:
        """Return a driveline whose shafts have lengths."""
        phases = self.often(0.2, self.array())
        return self.often(Driveline.from_points(self.points(), phases), self.line)

    def shafts(self) -> list[Any]:
        """Return what each shaft consists of: a tube, a stiff body or what is held in place."""
        inner = [
            cardan.tube(0.09, 0.003, length=1.0, rotary=self.ConsumeBool(), loss_factor=0.01),
            cardan.RigidShaft(self.often(8.0, self.array()), 0.5, 0.7, 0.01),
        ]
        return [self.pick([*inner, None]) for _ in range(self.line.n_joints + 1)]

    def masses(self) -> list[Any]:
        """Return masses on shafts."""
        mass = self.often(2.0, self.array())
        return [cardan.PointMass(self.pick((0, 1, -1)), self.pick((0.1, 0.5)), mass, 0.01, 0.02)]

    def harmonics(self) -> list[Any]:
        """Return torques of an engine."""
        end = self.pick(("input", "output"))
        return [cardan.TorqueHarmonic(0, end, self.pick((0.5, 1.0, 2.0)), self.often(90.0, np.inf))]

    def couplings(self) -> dict[int, Any]:
        """Return couplings with play, a table or a loss factor."""
        table = {"twist": [0.0, 0.05, 0.2], "torque": self.often([0.0, 20.0, 200.0], self.array())}
        kinds = [{"stiffness": 3000.0, "play": 0.02}, table, {"stiffness": 2e3, "loss_factor": 0.1}]
        return {self.pick((0, 1, -1)): cardan.Coupling(**self.pick(kinds))}

    def load(self) -> Load | None:
        """Return a load of the driveline, mostly one that suffices for everything."""
        end = self.pick(("drive_torque", "output_torque"))
        inertias = self.often(np.ones(self.line.n_joints + 1), self.array())
        rest = {"speed": self.often(2.0, self.array()), "inertias": inertias}
        return self.often(Load(**{end: 3.0}, **rest), None, Load(**{end: self.array()}))

    def states(self) -> Any:  # noqa: ANN401
        """Return drivelines as a search changes them."""
        return lambda x: Driveline.from_bends([[0.3, 0.32], [0.3, 0.25]], 0.1, x[..., None, :1])

    def flat(self, most: int = MOST) -> np.ndarray:
        """Return a flat array of doubles, as the native module takes them."""
        return np.linspace(0.0, 1.5, self.ConsumeIntInRange(0, most))

    def count(self) -> int:
        """Return a number of joints or the like, small or beyond all measure."""
        return self.pick((0, 1, 1, 2, 2, 3, 4, 2**40, 2**62, 2**63, 2**64 - 1, -1))

    def counts(self) -> list[int]:
        """Return some of them."""
        return [self.count() for _ in range(self.ConsumeIntInRange(0, 3))]


USUAL: dict[str, Any] = {
    "across": lambda _: 0.02,
    "along": lambda _: 0.01,
    "angle": lambda given: given.pick((Sweep(0.0, 6.0, 41), given.array(most=LONGEST))),
    "angle_of": lambda given: given.pick(("drive", "driven")),
    "arm": lambda _: 0.03,
    "axes": lambda given: given.pick(("space", "shaft")),
    "axis": lambda _: 0,
    "bearings": Input.bearings,
    "bends": Input.joints,
    "bound": lambda given: given.pick(("worst", "guaranteed")),
    "bounds": lambda _: [(-2.0, 2.0)],
    "by": lambda given: given.some(BY),
    "compliance": lambda _: 1e-15,
    "count": lambda given: given.ConsumeIntInRange(0, 9),
    "cross": lambda given: given.ConsumeIntInRange(0, 9) / 100,
    "damping_ratios": lambda given: given.pick((0.0, 0.02, 0.5)),
    "dampings": lambda _: None,
    "decimals": lambda _: 2,
    "degrees": lambda given: given.ConsumeBool(),
    "directions": lambda given: np.diff(given.points(), axis=0),
    "distribution": lambda given: given.pick(("uniform", "normal")),
    "driven_pin": lambda given: given.ConsumeIntInRange(0, 9) / 100,
    "driven_yoke": lambda given: given.ConsumeIntInRange(0, 9) / 100,
    "driving_yoke": lambda given: given.ConsumeIntInRange(0, 9) / 100,
    "dtype": lambda given: given.pick((None, np.float32)),
    "firing_order": lambda given: given.pick(([1, 3, 4, 2], [1, 2], given.counts())),
    "group": lambda given: given.pick(BY),
    "harmonics": lambda _: [(0.5, 90.0, 60.0)],
    "index": lambda given: given.pick((0, -1, ..., None, slice(None, None, -1), (0, 0))),
    "inertias": lambda given: np.ones(given.line.n_joints + 1),
    "jac": lambda _: None,
    "joints": lambda given: given.pick((None, slice(None), 0, [0])),
    "keep": lambda given: {given.pick(FIGURES): 0.5},
    "lengths": lambda given: np.ones(given.line.n_joints + 1),
    "limits": lambda _: None,
    "line": lambda given: given.line,
    "lines": lambda given: [given.line, given.line],
    "lines_of": Input.states,
    "load": Input.load,
    "minimise": lambda given: given.pick(FIGURES),
    "most": lambda given: given.ConsumeIntInRange(1, 3),
    "num": lambda given: given.ConsumeIntInRange(0, LONGEST),
    "of": lambda given: given.pick((*FIGURES, FIGURES[:2], "shaft", "driven_pin")),
    "order": lambda given: given.ConsumeIntInRange(0, 8),
    "orders": lambda given: given.pick(([1, 2, 6], given.array((3,), "i8"))),
    "other": lambda given: given.line,
    "out": lambda _: None,
    "outputs": lambda given: given.some(list(cardan.OUTPUTS)),
    "over": lambda given: given.pick(("largest", "rms")),
    "parameters": lambda _: None,
    "phases": lambda given: given.array(()),
    "points": Input.points,
    "probes": lambda given: given.pick(((), [(0, 0.5)], [(given.count(), 1.5)])),
    "reduce": lambda given: given.pick((None, *REDUCTIONS)),
    "reference": lambda given: given.pick(("common", "input", "output")),
    "samples": lambda given: given.ConsumeIntInRange(1, MOST),
    "seed": lambda given: given.ConsumeIntInRange(0, 9),
    "shaft": lambda given: given.pick((-1, 0, 1)),
    "shafts": lambda given: given.pick((None, slice(None), 0, [0, 1], -1)),
    "shape": lambda given: given.pick(((-1,), (1, -1), (1,))),
    "speeds": lambda given: given.pick(((5.0, 300.0), (0.0, np.inf), given.array((2,)))),
    "start": lambda given: given.array((1,)),
    "starts": lambda _: 1,
    "state": lambda _: 0,
    "states": lambda given: given.pick((None, 0)),
    "stiffnesses": lambda given: (
        [given.pick((np.inf, 500.0, 8000.0)) for _ in range(given.line.n_joints)] + [8000.0]
    ),
    "teeth": lambda given: given.pick((None, 17, 24)),
    "tolerance": lambda given: given.pick((1e-9, 1e-6, 0, None)),
    "weights": lambda given: {"angle": given.array()},
    "workers": lambda given: given.pick((None, 1, 2, 2**70)),
}


OWN: dict[Any, dict[str, Any]] = {
    LateralSystem: {
        "shafts": Input.shafts,
        "bearings": Input.elastic_bearings,
        "masses": Input.masses,
        "unbalance": lambda given: [cardan.Unbalance(0, 0.3, 1e-4, given.often([0, 1, 0], 0.5))],
        "sliding": lambda given: given.pick((None, None, [1], given.counts())),
    },
    TorsionalSystem: {
        "couplings": Input.couplings,
        "drive": lambda given: given.pick(("held", "free")),
        "harmonics": Input.harmonics,
        "inertias": lambda given: np.ones((given.line.n_joints + 1, 2)),
        "loss_factors": lambda given: given.pick((None, 0.1)),
    },
}
"""What an argument of these means by the same name."""


@functools.cache
def public(kind: type) -> list[str]:
    """Return what is public of a class of the library, and its operators."""
    names = [name for name in dir(kind) if name not in LEFT_OUT]
    return [name for name in names if name[0] != "_" or name in OPERATORS]


def case(data: bytes) -> None:
    """Some calls of the library, or one of the native module."""
    given = Input(data)
    things: list[Any] = [given.line]
    steps = [native] if given.ConsumeIntInRange(0, 3) == 0 else [called] * 8
    for step in steps[: given.ConsumeIntInRange(1, 8)]:
        try:
            step(given, things)
        except REFUSED as error:
            assert str(error), repr(error)


def called(given: Input, things: list[Any]) -> None:
    """Call a function, or something public of one of the last things; keep what it returns."""
    thing = given.pick((None, *things[-2:]))
    name = "" if thing is None else given.pick(public(type(thing)))
    # Some hold only what was asked for.
    found = getattr(thing, name, None) if name else given.pick((*[given.line.plan] * 9, *FUNCTIONS))
    if isinstance(thing, Plan) and name == "__call__":
        found = evaluated(thing, given)
    elif name == "" or str(getattr(found, "__module__", None)).startswith("cardan"):
        found = result_of(found, given)
    if type(found).__module__.startswith("cardan"):
        things.append(found)
    if isinstance(found, Driveline):
        given.line = found


def result_of(function: Any, given: Input) -> Any:  # noqa: ANN401
    """Return what a function makes of its arguments: the same, however many threads there are."""
    flat, named = given.arguments(function)
    found = function(*flat, **named)
    if "workers" in named and not isinstance(found, Plan):
        again = function(*flat, **named | {"workers": 2})
        outputs = found if isinstance(found, cardan.Result) else ()
        for name in (*public(type(found)), *outputs):
            with suppress(*REFUSED):
                one, two = getattr(found, name), getattr(again, name)
                if isinstance(one, np.ndarray):
                    np.testing.assert_array_equal(one, two)
    return found


def evaluated(plan: Plan, given: Input) -> Any:  # noqa: ANN401
    """Evaluate a plan, and again into arrays, mostly of the right shape."""
    angle = given.argument("angle", USUAL)
    result = plan(angle)
    for name, array in result.items():
        target = given.array(np.shape(array), array.dtype.str)
        np.testing.assert_array_equal(plan(angle, {name: target})[name], array)
    return result


@atheris.instrument_func
def native(given: Input, _: list[Any]) -> None:
    """Call the native module with arguments of the right types only."""
    n = given.count()
    five = [given.flat() for _ in range(5)]
    what = given.ConsumeIntInRange(0, 5)
    if what == 0:
        _core.from_bends(n, given.counts(), *five[:3])
    elif what == 1:
        _core.from_directions(n, given.counts(), *five[:2])
        _core.from_points(n, given.counts(), *five[:2])
    elif what == 2:
        _core.equivalent(n, given.count(), *five[:3])
    elif what == 3:
        _core.optimal_phases(n, *five[:3], given.pick((None, 0, 1, 2)))
    elif what == 4:
        sweep = _core.Sweep((0.0, 1.0) if given.ConsumeBool() else None, given.count(), n)
        sweep.fill(given.count(), given.flat())
    else:
        fitting = given.ConsumeBool()
        if fitting:
            n = given.ConsumeIntInRange(1, 4)
            sizes = (n, n - 1, n - 1, 3 * (n + 1), 3 * n)
            five = [np.linspace(0.1, 1.0, size) for size in sizes]
            bearings = [given.ConsumeIntInRange(0, n) for _ in range(given.ConsumeIntInRange(0, 4))]
            more = [np.full(size, 0.5) for size in (n + 1, len(bearings))]
        else:
            more, bearings = [given.flat(), given.flat()], given.counts()
        shape = [] if fitting else given.counts()
        lines = _core.Lines(n, shape, [*five, *more], bearings)
        inertias = [(given.count(), given.flat())] if given.ConsumeBool() else []
        end = given.pick((None, "drive", "output", "?"))
        load = end and (end, given.flat(), given.flat(), np.array(1.0), inertias)
        single = given.ConsumeBool()
        reduction = given.pick((None, *REDUCTIONS))
        items = (None, given.count())
        places = [(given.pick(items), given.ConsumeBool()) for _ in given.counts()]
        names = tuple(name for name in cardan.OUTPUTS if given.ConsumeBool())
        plan = _core.Plan(
            lines,
            names,
            places,
            given.counts(),
            given.counts(),
            load,
            given.pick((None, 0.0, 1e-9, 1e-3, float("nan"))),
            single,
            reduction,
            given.pick(("space", "shaft")),
        )
        sweep = _core.Sweep((0.0, 1.0), given.ConsumeIntInRange(1, 9), 0)
        if given.ConsumeBool():
            plan.explain(tuple(given.counts()), sweep if given.ConsumeBool() else None)
        shape = given.counts() if given.ConsumeBool() else [given.ConsumeIntInRange(0, 9)]
        word = np.float32 if single and reduction is None else np.float64
        planes = [given.flat().astype(word) for _ in range(given.ConsumeIntInRange(0, 3))]
        named = {name: given.array(dtype=word.__name__) for name in names}
        plan.run(
            tuple(shape) if given.ConsumeBool() else None,
            sweep if given.ConsumeBool() else given.flat(),
            given.pick((None, planes, named)),
            given.pick((None, 0, 1, 2)),
            given.pick((None, "scalar", "?")),
        )


if __name__ == "__main__":
    np.seterr(all="ignore")
    atheris.Setup(sys.argv, case)
    atheris.Fuzz()
