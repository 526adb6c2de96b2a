"""Fuzz the boundary between Python and Rust: ``python fuzz/boundary.py [seconds]`` (atheris).

Arrays of any shape, type and layout, and nonsense, go to the public calls and straight to the
native module, which must not rely on what stands before it. Refusals are exceptions of the kinds
below; a panic is none of them and ends the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    import cardan
    from cardan import Driveline, Load, Sweep, _core

import numpy as np
from cases import main

REFUSED = (ValueError, TypeError, IndexError, MemoryError, OverflowError)
DTYPES = ("f4", "i8", "u1", "?", "f2", ">f8", "c16", "O", "S2", "m8[s]")
NUMBERS = (0.0, -0.0, 0.3, 1.5, -7.0, 1e-300, 5e-324, 1e12, 1e300, np.inf, -np.inf, np.nan)
REDUCTIONS = ("min", "max", "mean", "rms", "peak", "no")
MOST = 3000
"""Elements of an array, and joints of all drivelines together."""


class Input(atheris.FuzzedDataProvider):
    """Arguments from bytes: three times in four such as fit, else anything."""

    def __init__(self, data: bytes) -> None:
        """Take the bytes."""
        super().__init__(data)
        self.wild = self.ConsumeIntInRange(0, 3) == 0

    def often(self, usual: Any, *others: Any) -> Any:  # noqa: ANN401
        """Return what is usual, or, among anything, one of the others."""
        return self.pick(others) if self.wild and self.ConsumeBool() else usual

    def pick(self, options: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return one of the options."""
        return options[self.ConsumeIntInRange(0, len(options) - 1)]

    def shape(self) -> tuple[int, ...]:
        """Return a shape, mostly a small one."""
        if not self.wild:
            return (self.ConsumeIntInRange(0, MOST),) if self.ConsumeBool() else ()
        shape = [self.ConsumeIntInRange(0, 5) for _ in range(self.ConsumeIntInRange(0, 3))]
        if shape and self.ConsumeBool():
            shape[-1] = self.ConsumeIntInRange(0, MOST)
        return tuple(shape) if np.prod(shape) <= MOST else tuple(shape[:1])

    def array(self, shape: tuple[int, ...] | None = None, dtype: str = "f8") -> Any:  # noqa: ANN401
        """Return an array of any type and layout, or something like one."""
        shape = self.shape() if shape is None else shape
        values = [self.often(0.7, *NUMBERS), self.often(-2.0, self.ConsumeRegularFloat())]
        values += [self.ConsumeIntInRange(0, 15) / 10 for _ in range(3)]
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
        elif layout == 7:
            array = np.broadcast_to(array.reshape(-1)[:1].sum(), shape)
        elif layout == 5:
            return array.tolist()
        elif layout == 6:
            return self.pick((None, "a", 1j, object(), [[1], [1, 2]], {}, 10**400))
        array.flags.writeable = array.flags.writeable and self.often(True, False)
        return array

    def flat(self, most: int = 40) -> Any:  # noqa: ANN401
        """Return a flat array of doubles, as the native module takes them."""
        return np.linspace(0.0, 1.5, self.ConsumeIntInRange(0, most))

    def count(self) -> int:
        """Return a number of joints or the like, small or beyond all measure."""
        return self.pick((0, 1, 1, 2, 2, 3, 4, 2**40, 2**62, 2**63, 2**64 - 1, -1))

    def counts(self) -> list[int]:
        """Return some of them."""
        return [self.count() for _ in range(self.ConsumeIntInRange(0, 3))]

    def line(self) -> Driveline:
        """Return a driveline or a batch, from whatever goes."""
        make = self.ConsumeIntInRange(0, 4) if self.wild else 4
        degrees = self.ConsumeBool()
        if make == 0:
            return Driveline.from_bends(self.array(), degrees=degrees)
        if make == 1:
            return Driveline.from_directions(self.array(), self.array(), degrees=degrees)
        if make == 2:
            return Driveline.from_points(self.array(), self.array())
        if make == 3:
            return Driveline.from_slopes(self.array(), self.array(), degrees=degrees)
        batch = self.pick(((), (), (1,), (3, 1), (0, 1), (2, 3, 1)))
        bends = np.resize(self.flat() + 0.01, (*batch, self.ConsumeIntInRange(1, 4))) % 1.5
        return Driveline.from_bends(bends, self.array(()), self.array(()))


def case(data: bytes) -> None:
    """One call of one of the two kinds."""
    given = Input(data)
    try:
        (native if given.ConsumeIntInRange(0, 2) == 0 else public)(given)
    except REFUSED as error:
        assert str(error), repr(error)


@atheris.instrument_func
def public(given: Input) -> None:
    """Make a driveline and evaluate it."""
    line = given.line()
    what = given.ConsumeIntInRange(0, 5)
    if what == 0:
        line.optimal_phases()
        line.equivalent(given.ConsumeIntInRange(-3, 3))
        names = given.pick((("angle_error",), ("tilt_driven", "speed_ratio")))
        line.harmonics(given.often([1, 2, 6], given.array()), outputs=names)
        line.check(given.array())
        line.with_phases(given.array())
        return
    load = None
    if given.ConsumeBool():
        end = given.pick(("drive_torque", "output_torque"))
        inertias = np.ones(line.n_joints + 1)
        options: Any = {end: given.array(()), "speed": given.often(2.0, given.array())}
        options["inertias"] = given.often(inertias, given.array())
        load = Load(**{key: value for key, value in options.items() if given.ConsumeBool()})
    known = [name for name, output in cardan.OUTPUTS.items() if load or not output.needs_load]
    names = [name for name in known if given.ConsumeBool()] + given.often([], ["moment"], "no")
    plan = line.plan(
        names,
        shafts=given.often(given.pick((None, slice(None), 0, [0, 1], -1)), "x", 5),
        joints=given.often(given.pick((None, slice(None), 0, [0])), 7),
        load=load,
        reduce=given.pick((None, None, *REDUCTIONS[:5], given.often(None, "no"))),
        dtype=given.often(given.pick((None, np.float32)), "f8", "i4"),
        tolerance=given.often(given.pick((None, 0, 1e-6)), -1.0, np.nan),
        workers=given.often(given.pick((None, 1, 2)), -1, 0, 2**70),
    )
    if what == 1:
        plan.explain()
    angle: Any = given.array()
    if given.ConsumeIntInRange(0, 3) == 0:
        angle = Sweep(
            *(given.ConsumeRegularFloat() for _ in range(2)), given.ConsumeIntInRange(0, MOST)
        )
    result = plan(angle)
    for name, array in result.items():
        # An array to fill, of any layout and three times in four of the right shape.
        target = given.array(np.shape(array), array.dtype.str)
        again = plan(angle, {name: target})
        np.testing.assert_array_equal(again[name], array)


@atheris.instrument_func
def native(given: Input) -> None:
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
        plan = _core.Plan(
            lines,
            tuple(name for name in cardan.OUTPUTS if given.ConsumeBool()),
            given.counts(),
            given.counts(),
            load,
            given.pick((None, 0.0, 1e-9, 1e-3, float("nan"))),
            single,
            reduction,
        )
        sweep = _core.Sweep((0.0, 1.0), given.ConsumeIntInRange(1, 9), 0)
        if given.ConsumeBool():
            plan.explain(tuple(given.counts()), sweep if given.ConsumeBool() else None)
        shape = given.counts() if given.ConsumeBool() else [given.ConsumeIntInRange(0, 9)]
        word = np.float32 if single and reduction is None else np.float64
        plan.run(
            tuple(shape) if given.ConsumeBool() else None,
            sweep if given.ConsumeBool() else given.flat(),
            [given.flat().astype(word) for _ in range(given.ConsumeIntInRange(0, 3))]
            if given.ConsumeBool()
            else None,
            given.pick((None, 0, 1, 2)),
            given.pick((None, "scalar", "?")),
        )


if __name__ == "__main__":
    np.seterr(all="ignore")
    main("boundary", case, longest=400)
