"""Fuzz joints as built: ``python fuzz/as_built.py [seconds]`` (atheris).

Deviations, play, lash, wind-up and their tolerances are made from any arrays and nonsense. Every
call gives a result or is refused by an exception of the kinds in ``arguments.py``. What two calls
must agree in is compared: threads, an array with a sweep, a batch with its drivelines one by one,
both flanks with the lash between them, random drivelines with the worst of them.
"""

from __future__ import annotations

from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    import cardan
    from cardan import Driveline, Load, Sweep

import numpy as np
from arguments import REFUSED, Input
from cases import main

MOTION = ("angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
FIGURES = ("angle_error_order_1", "acceleration_order_2", "angle_error_peak", "torque_2_max")
KEYS = ("driving_yoke", "cross", "driven_yoke")
MANY = 6
"""Drivelines of a batch that is judged one by one."""
same = np.testing.assert_array_equal


def case(data: bytes) -> None:
    """One use of joints as built."""
    given = Input(data)
    use = given.pick((motion, play, winding, tolerances, orders))
    try:
        use(given)
    except REFUSED as error:
        assert str(error), repr(error)


def sizes(given: Input, most: float = 0.3) -> dict[str, Any]:
    """Return deviations or tolerances of some of the three kinds."""
    size = most * given.ConsumeIntInRange(0, 10) / 10
    return {name: given.often(size, given.array()) for name in KEYS if given.ConsumeBool()}


def as_built(given: Input) -> Driveline:
    """Return a driveline or a batch with deviations, and with bearings where joints are few."""
    line = given.line().with_deviations(**sizes(given), degrees=given.often(False, True))
    n = line.n_joints
    if n > MANY or not given.ConsumeBool():
        return line
    # Determinate: two on both outer shafts, one on each other shaft but the last of them.
    pairs = [(shaft, at) for shaft in (0, n) for at in (0.2, given.often(0.6, given.array(())))]
    pairs += [(shaft, 0.5) for shaft in range(1, n - 1)]
    return line.with_bearings(pairs, given.often(np.ones(n + 1), given.array()))


@atheris.instrument_func
def motion(given: Input) -> None:
    """Compare arrays, sweeps, threads, batches, gradients and harmonics."""
    line = as_built(given)
    loads = (None, Load(drive_torque=3.0, speed=9.0, inertias=np.ones(line.n_joints + 1)))
    load = given.pick(loads)
    known = [name for name, output in cardan.OUTPUTS.items() if load or not output.needs_load]
    names = [name for name in known if given.ConsumeIntInRange(0, 3) == 0]
    sweep = Sweep(0.0, 6.0, given.ConsumeIntInRange(1, 50))
    options: Any = {"load": load, "tolerance": given.pick((None, 0, 1e-12))}
    one, two = (line.evaluate(sweep, names, workers=workers, **options) for workers in (1, 2))
    for name in names:
        same(one[name], two[name])
    if line.shape and 0 < line.size <= MANY and not given.wild:
        for i in np.ndindex(line.shape[:-1]):
            alone = line[(*i, 0)].evaluate(sweep, "angle_error").angle_error
            whole = line.evaluate(sweep, "angle_error").angle_error[i]
            assert np.max(np.abs(alone - whole)) < 1e-12
    found = line.harmonics(given.often([1, 2, 3], given.array()), outputs=given.pick(MOTION))
    assert np.all(np.isfinite(next(iter(found.amplitude.values()))))
    plan = line.plan("angle_error")
    slopes = plan.derivatives(sweep, "deviations")["angle_error"]["deviations"]
    gradient = plan.gradient(sweep, {"angle_error": given.often(1.0, given.array())})
    if line.has_deviations and line.shape == () and not given.wild:
        unit = 1e-9 * (1.0 + np.abs(slopes).sum())
        assert np.all(np.abs(gradient.deviations - slopes.sum(axis=0)) < unit)


@atheris.instrument_func
def play(given: Input) -> None:
    """Lash is the angle between both flanks, never negative, and the same in any unit.

    It is NaN where the angle is not finite.
    """
    line = given.line().with_deviations(**sizes(given, 0.05))
    if line.size > MANY:
        return
    radial, arm = given.often(0.05, given.array()), given.often(40.0, given.array())
    flanks = line.with_play(radial, arm)
    assert flanks.shape[0] == 2
    same(flanks.deviations[0] + flanks.deviations[1], 2.0 * flanks.deviations.mean(axis=0))
    angle = given.often(np.linspace(0.0, 6.0, given.ConsumeIntInRange(0, 9)), given.array())
    lash = np.asarray(line.lash(angle, radial, arm, given.often(-1, 0, 99)))
    assert not np.any(lash < -1e-9)
    if not given.wild:
        assert np.all(np.isfinite(lash))
        again = np.asarray(line.lash(angle, 2.0 * radial, 2.0 * arm))
        same(lash, again)


@atheris.instrument_func
def winding(given: Input) -> None:
    """Wind-up is in proportion to the torque."""
    line = as_built(given)
    if line.size > MANY:
        return
    end = given.pick(("drive_torque", "output_torque"))
    torque, stiffness = given.often(5.0, given.array()), given.often(1e4, given.array())
    angle = given.often(np.linspace(0.0, 6.0, 5), given.array())
    one = np.asarray(line.wind_up(angle, Load(**{end: torque}), stiffness))
    if not given.wild:
        twice = np.asarray(line.wind_up(angle, Load(**{end: 2.0 * torque}), stiffness))
        same(twice, 2.0 * one)


@atheris.instrument_func
def tolerances(given: Input) -> None:
    """Compare threads, and random drivelines with the worst."""
    line = as_built(given) if given.ConsumeBool() else given.line()
    if line.size > MANY or line.n_joints > 2:
        return
    halves = sizes(given, 0.02)
    if given.ConsumeBool():
        halves["bends"] = given.often(0.01, given.array())
    figures = [name for name in FIGURES if given.ConsumeBool()]
    figures += given.often([], ["equivalent_bend"], ["angle_error_order_0"], ["joint_force_0_peak"])
    options: Any = {"of": figures, "samples": 30, "seed": 2}
    options["distribution"] = given.pick(("uniform", "normal"))
    options["load"] = given.pick((None, Load(drive_torque=3.0)))
    options["speed"] = given.often(100.0, given.array())
    options["shaft"] = given.often(-1, 0, 7)
    one, two = (line.tolerances(workers=workers, **halves, **options) for workers in (1, 2))
    for name in figures:
        same(one.sampled[name], two.sampled[name])
        worst = np.asarray(one.worst[name])
        most = one.sampled[name].max(axis=-1)
        if one.distribution == "uniform" and name.startswith(("angle_error_o", "acceleration_o")):
            assert np.all(most <= worst * (1.0 + 1e-6) + 1e-9), (name, most, worst)
    _ = one.linear, one.shares


@atheris.instrument_func
def orders(given: Input) -> None:
    """The worst of one order is that of its deviations, and not below the drawing."""
    line = as_built(given)
    # The time grows with the square of the number of joints.
    if line.n_joints > 30:
        return
    options: Any = {"order": given.often(1, 0, 2.5, 40), "shaft": given.often(-1, 0, 9)}
    found = line.order_tolerances(**sizes(given, 0.02), **options)
    assert found.worst >= abs(found.drawing) * (1.0 - 1e-6) - 1e-9
    built = line.with_deviations(*found.worst_deviations.T)
    again = built.harmonics([found.order], options["shaft"], outputs="angle_error").angle_error[0]
    assert abs(again - found.worst) < 1e-9 * (1.0 + again)
    _ = found.rms, found.shares, found.quantile(0.5, 100)


if __name__ == "__main__":
    np.seterr(all="ignore")
    main("as_built", case, longest=300)
