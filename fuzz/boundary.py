"""Fuzz the boundary between Python and Rust: ``python fuzz/boundary.py [seconds]`` (atheris).

Arrays of any shape, type and layout, and nonsense, go to the public calls and straight to the
native module, which must not rely on what stands before it. Refusals are exceptions of the kinds
in ``arguments.py``; a panic is none of them and ends the run.
"""

from __future__ import annotations

from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    import cardan
    from cardan import Load, Sweep, _core

import numpy as np
from arguments import MOST, REFUSED, Input
from cases import main

REDUCTIONS = ("min", "max", "mean", "rms", "peak", "no")


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
    main("boundary", case, longest=400)
