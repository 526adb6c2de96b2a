"""Fuzz what is built on evaluations: ``python fuzz/capabilities.py [seconds]`` (atheris).

Derivatives, forces, torsional systems, tolerances, the search for an optimum, drivelines in service
and ball joints are made from any arrays and nonsense. Every call gives a result or is refused by an
exception of the kinds in ``arguments.py``. What two calls must agree in is compared: threads, a
batch with its drivelines one by one, an array with a sweep, sums with their parts.
"""

from __future__ import annotations

from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    import cardan
    from cardan import BallJoint, Driveline, Load, Sweep, TorsionalSystem

import numpy as np
from arguments import REFUSED, Input
from cases import main

BY = ("bends", "twists", "phases", "points", "angle", "drive_torque", "output_torque", "inertias")
FIGURES = ("equivalent_bend", "non_uniformity", "max_angle_error", "torsional_excitation")
MANY = 6
"""Drivelines of a batch that is searched one by one."""
same = np.testing.assert_array_equal


def close(got: Any, want: Any, unit: Any) -> None:  # noqa: ANN401
    """Compare where everything is finite, within rounding of the unit."""
    got, want, unit = (np.asarray(x, dtype=float) for x in (got, want, unit))
    known = np.isfinite(got) & np.isfinite(want) & (unit < 1e250)
    permitted = 1e-9 * np.broadcast_to(unit, got.shape) + 1e-280
    assert np.all(np.abs(got - want)[known] <= permitted[known]), (got, want)


def case(data: bytes) -> None:
    """One use of one capability."""
    given = Input(data)
    use = given.pick((derivatives, forces, torsion, tolerances, optimum, service, ball_joint))
    try:
        use(given)
    except REFUSED as error:
        assert str(error), repr(error)


def mounted(given: Input) -> Driveline:
    """Return a driveline or a batch, perhaps of points and with bearings."""
    if given.ConsumeBool():
        return given.line()
    n = given.ConsumeIntInRange(1, 3)
    batch = given.pick(((), (), (2,)))
    points = np.zeros((*batch, n + 2, 3))
    points[..., 0] = np.arange(n + 2.0)
    for i in range(given.ConsumeIntInRange(0, 3 * n)):
        points[..., 1 + i % n, 1 + i % 2] = given.ConsumeIntInRange(-20, 20) / 40
    line = Driveline.from_points(points, given.array((), "f8"))
    if given.ConsumeBool():
        pairs = [(given.ConsumeIntInRange(0, n), 0.1 * given.ConsumeIntInRange(1, 9))]
        pairs += [(given.often(0, -1, 9), given.often(0.5, -1.0, 9.0, "a"))]
        line = line.with_bearings(pairs)
    return line


def load_of(given: Input, line: Driveline) -> Load:
    """Return a load of the driveline."""
    end = given.pick(("drive_torque", "output_torque"))
    options: Any = {end: given.often(50.0, given.array(()))}
    if given.ConsumeBool():
        options["speed"] = given.often(100.0, given.array())
        options["inertias"] = given.often(np.ones(line.n_joints + 1) / 8, given.array())
    return Load(**options)


def angles_of(given: Input) -> Any:  # noqa: ANN401
    """Return a few angles."""
    return given.often(np.linspace(-1.0, 5.0, given.ConsumeIntInRange(0, 40)), given.array())


@atheris.instrument_func
def derivatives(given: Input) -> None:
    """Differentiate every output, compare the gradient with the sum of the derivatives."""
    line = mounted(given)
    load = load_of(given, line) if given.ConsumeBool() else None
    known = [name for name, output in cardan.OUTPUTS.items() if load or not output.needs_load]
    names = [name for name in known if given.ConsumeIntInRange(0, 3) == 0]
    names += given.often([], ["moment"], "no")
    by = [name for name in BY if given.ConsumeIntInRange(0, 2) == 0] + given.often([], ["no"])
    reduce = given.pick((None, None, "peak", "mean", "rms", "max"))
    options: Any = {"load": load, "reduce": reduce, "angle_of": given.pick(("drive", "driven"))}
    plans = [line.plan(names, workers=workers, **options) for workers in (1, 2)]
    angle = angles_of(given)
    values = plans[0](angle)
    weights = {name: given.often(1.0, given.array()) for name in names}
    slopes, again = (plan.derivatives(angle, by) for plan in plans)
    sums, other = (plan.gradient(angle, weights) for plan in plans)
    for name in names:
        for variable in by:
            same(slopes[name][variable], again[name][variable])
            assert slopes[name][variable].shape[: np.ndim(values[name])] == np.shape(values[name])
    for variable in ("bends", "twists", "phases"):
        same(getattr(sums, variable), getattr(other, variable))
    if line.shape == () and not given.wild and by and names and by[0] not in ("angle", "points"):
        parts = [slopes[name][by[0]] for name in names]
        axes = [tuple(range(np.ndim(values[name]))) for name in names]
        total = sum(p.sum(axis=a) for p, a in zip(parts, axes, strict=True))
        unit = sum(np.abs(p).sum(axis=a) for p, a in zip(parts, axes, strict=True))
        if hasattr(sums, by[0]):
            close(getattr(sums, by[0]), total, np.max(unit, initial=1.0))


@atheris.instrument_func
def forces(given: Input) -> None:
    """Compare forces of arrays, sweeps, threads, given arrays and reductions."""
    line = mounted(given)
    names = ["joint_force", "bearing_force", "moment", "support_moment", "bending_driven"]
    names = [name for name in names if given.ConsumeBool()]
    axes = given.pick(("space", "shaft"))
    load = load_of(given, line)
    sweep = Sweep(0.0, 6.0, given.ConsumeIntInRange(1, 50))
    found = line.evaluate(sweep, names, load=load, axes=axes, workers=1)
    whole = line.evaluate(sweep, names, load=load, axes=axes, workers=2)
    most = line.evaluate(sweep, names, load=load, axes=axes, reduce="max")
    least = line.evaluate(sweep, names, load=load, axes=axes, reduce="min")
    for name in names:
        same(found[name], whole[name])
        vector = cardan.OUTPUTS[name].vector
        samples = np.moveaxis(found[name], -2 if vector else -1, 0)
        unit = np.abs(samples).max(axis=0)
        close(most[name], samples.max(axis=0), unit)
        close(least[name], samples.min(axis=0), unit)
        out = np.empty_like(found[name])
        again = line.evaluate(np.asarray(sweep), name, load=load, axes=axes, out={name: out})
        assert again[name] is out
        close(out, found[name], np.abs(out).max(initial=0.0))


@atheris.instrument_func
def torsion(given: Input) -> None:
    """Find periodic motions; compare threads, and a batch with its systems one by one."""
    line = mounted(given)
    n = line.n_joints
    inertias = [[0.0, given.ConsumeIntInRange(0, 20) / 100] for _ in range(n + 1)]
    stiff = [given.pick((np.inf, 500.0, 8000.0)) for _ in range(n)] + [8000.0]
    options: Any = {given.pick(("damping_ratios", "dampings")): given.pick((0.0, 0.02, 0.5))}
    options["load_torque"] = given.often(given.pick((0.0, 40.0)), given.array())
    system = TorsionalSystem(
        line,
        inertias=given.often(inertias, given.array()),
        stiffnesses=given.often(stiff, given.array()),
        **options,
    )
    speeds = given.often(np.array([30.0, 120.0, given.ConsumeIntInRange(1, 900)]), given.array())
    permitted = given.often(given.pick((1e-9, 1e-6)), 0.0, 1.0, np.nan)
    if line.shape:
        speeds = 75.0
    one, two = (system.steady(speeds, tolerance=permitted, workers=w) for w in (1, 2))
    same(one.found, two.found)
    same(one.torque_orders, two.torque_orders)
    same(one.torque_max, two.torque_max)
    for i in np.ndindex(line.shape) if line.shape else ():
        alone = TorsionalSystem(
            line[i],
            inertias=inertias,
            stiffnesses=stiff,
            dampings=system.dampings[i],
            load_torque=system.load_torque[i],
        )
        if not given.wild:
            same(alone.steady(speeds, tolerance=permitted).torque_max, one.torque_max[:, *i])
    orbit = system.orbit(speeds, 8, tolerance=permitted)
    same(orbit.found, one.found)
    unit = 1e-3 * np.abs(one.torque_max - one.torque_min)[..., np.newaxis] + 1e-6
    known = np.abs(orbit.torque) < 1e250
    below = orbit.torque <= one.torque_max[..., np.newaxis] + unit
    above = orbit.torque >= one.torque_min[..., np.newaxis] - unit
    assert np.all((below & above)[known])
    stability = system.stability(speeds, tolerance=permitted)
    same(np.isfinite(stability.multipliers).all(axis=-1), stability.found)
    assert not np.any(stability.found & ~one.found)
    one.evaluate(4, given.pick(("torque", "moment", "support_moment")))


@atheris.instrument_func
def tolerances(given: Input) -> None:
    """Compare worst case, bound and random drivelines; threads and seeds."""
    line = mounted(given)
    if line.size > MANY:
        return
    groups = ["phases", "bends", "twists"] if not line.has_points else ["points", "phases"]
    sizes: Any = {name: given.often(0.01, given.array()) for name in groups if given.ConsumeBool()}
    figures = [name for name in FIGURES if given.ConsumeBool()]
    figures += given.often([], ["support_moment_0_peak"], ["no"])
    options: Any = {"of": figures, "samples": 40, "seed": 3, "teeth": given.pick((None, 24, 17))}
    options["distribution"] = given.pick(("uniform", "normal"))
    options["states"] = 0 if line.shape and given.ConsumeBool() else None
    options["load"] = load_of(given, line) if given.ConsumeBool() else None
    options["speed"] = given.often(100.0, given.array())
    one, two = (line.tolerances(workers=workers, **sizes, **options) for workers in (1, 2))
    drawn, worst, sure, nominal = one.sampled, one.worst, one.guaranteed, one.nominal
    for name in figures:
        same(drawn[name], two.sampled[name])
        unit = np.asarray(worst[name])
        if name in sure:
            bound = np.asarray(sure[name])
            assert np.all(~(np.maximum(unit, nominal[name]) > bound * (1 + 1e-9) + 1e-12)), name
            if one.distribution == "uniform":
                assert np.all(~(drawn[name].max(axis=-1) > bound * (1 + 1e-9) + 1e-12)), name
        middle = one.quantile([0.0, 0.5, 1.0])[name]
        # Of torques near the largest double nothing is finite.
        assert np.all(~(np.diff(middle, axis=-1) < 0.0))
    for share in one.shares.values() if len(figures) > 1 else [one.shares]:
        assert share is not None
    for name in sizes if line.shape == () and len(figures) == 1 else ():
        one.permitted(name, bound=given.pick(("worst", "guaranteed")))


@atheris.instrument_func
def optimum(given: Input) -> None:
    """Search twice, and all variables at once: the start is never better, the seed decides."""
    bends = np.array([given.ConsumeIntInRange(1, 12) / 10 for _ in range(2)])
    states = np.array([-0.05, 0.02])

    def lines_of(x: Any) -> Driveline:  # noqa: ANN401
        each = np.stack([bends[0] + states, np.full(2, bends[1])], axis=-1)
        shape = np.shape(x)[:-1]
        each = np.broadcast_to(each, (*shape, 2, 2))
        return Driveline.from_bends(each, 0.3, np.asarray(x)[..., np.newaxis, :1])

    goal = given.often(given.pick(FIGURES[:3]), "no", "support_moment_0_peak", 3)
    options: Any = {
        "minimise": goal,
        "over": given.often(given.pick(("largest", "rms")), "no"),
        "starts": given.often(2, 0, -1, 2.5),
        "phases": given.often([0], [], [1], "a"),
        "teeth": given.often(given.pick((None, None, 24)), 0, -5),
        "keep": given.pick((None, {}, {"non_uniformity": given.ConsumeIntInRange(0, 8) / 4})),
        "decimals": given.pick((None, 2)),
        "load": given.pick((None, Load(drive_torque=3.0))),
    }
    start = given.often([given.ConsumeIntInRange(-4, 4) / 2], given.array((1,)), [])
    bounds = given.often(given.pick((None, [(-2.0, 2.0)])), given.array((1, 2)))
    found = cardan.optimise(lines_of, start, bounds, **options)
    again = cardan.optimise(lines_of, start, bounds, **options)
    many = cardan.optimise(lines_of, start, bounds, vectorised=True, **options)
    same(found.x, again.x)
    assert found.value == again.value == np.asarray(found.value)
    close(many.value, found.value, 1e4 * max(1e-6, abs(found.value)))
    if not options["keep"] and options["decimals"] is None:
        assert found.value <= found.before * (1 + 1e-9) + 1e-12


@atheris.instrument_func
def service(given: Input) -> None:
    """Losses, life, slides, play of a spline and a drive that runs freely."""
    line = mounted(given)
    # Means over a turn take a time that grows with the square of the number of joints.
    if line.size > MANY or line.n_joints > 60:
        return
    load = load_of(given, line)
    if max(load.torque.size, load.speed.size) > MANY:
        return
    what = given.ConsumeIntInRange(0, 4)
    three: Any = {"friction": 0.05, "pin_radius": 0.008, "arm": 0.03}
    three = {name: given.often(value, given.array()) for name, value in three.items()}
    if what == 0:
        lost = line.losses(load, seal_torque=given.often(0.0, given.array()), **three)
        angle = angles_of(given)
        assert np.all(np.asarray(lost.fraction)[np.isfinite(lost.fraction)] >= 0.0)
        added = lost.torque(angle)
        assert added.shape[1:] == np.shape(lost.efficiency_at(angle))
        _ = lost.power, lost.moment(angle), lost.efficiency
    elif what == 1:
        speed = given.often(100.0, given.array())
        lasts = line.life(load, rating=given.often(500.0, given.array()), speed=speed)
        assert not np.any(lasts.hours < 0.0)
        _ = lasts.mean_hours, lasts.decisive
    elif what == 2:
        slides = line.slides(driving_pin=given.often(0.3, given.array()), cross=given.array(()))
        turn = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
        for of in ("shaft", "driving_pin", "driven_pin"):
            travel = slides.travel(of)
            if line.shape == () and travel.ndim == 1:
                seen = np.ptp(slides.at(turn, of), axis=-1)
                close(seen, travel, 1.0 + seen)
    elif what == 3:
        inertias = given.often(np.ones(line.n_joints + 1), given.array())
        free = line.free_running(inertias)
        ratio = free.speed_ratio(angles_of(given))
        assert not np.any(ratio <= 0.0)
        assert not np.any(np.asarray(free.variation) < 0.0)
    else:
        shaft = given.often(0, 5, -1, 2**70)
        line.spline_force(shaft, given.array(), given.array(()), given.often(0.02, given.array()))
        _ = line.lengths().travel


@atheris.instrument_func
def ball_joint(given: Input) -> None:
    """Every result of ball joints: the sizes fit the loads, a batch is its joints."""
    radius = given.often(np.array([0.01, 0.02, 0.05]), given.array())
    joint = BallJoint(radius, given.often(1.2, given.array()))
    if given.ConsumeBool():
        compliance = given.often(1e-15, given.array())
        joint = joint.with_clearance(given.often(2e-5, given.array()), compliance=compliance)
    load = given.often(10.0 ** given.ConsumeIntInRange(-3, 6), given.array())
    peak = joint.peak_pressure(load)
    if not given.wild:
        close(np.asarray(joint.allowable_load(peak)) / load, 1.0, 1e3)
        for i, r in enumerate(radius):
            alone = BallJoint(r, joint.half_angle)
            if joint.compliance is not None:
                alone = alone.with_clearance(joint.clearance, compliance=joint.compliance)
            same(alone.peak_pressure(load), peak[i])
        sized = BallJoint.sized_for(
            load, peak, joint.half_angle, clearance=joint.clearance, compliance=joint.compliance
        )
        close(np.asarray(sized.radius) / radius, 1.0, 1e3)
    joint.contact_angle(load)
    joint.friction_moment(load, 0.1)
    joint.tilting_friction_moment(load, given.often(0.1, given.array()))
    joint.pressure(given.often(0.3, given.array()), load)
    joint.pressure_at(given.array((3,)), given.array((3,)))
    joint.approach(load, given.often(None, 1e-15, given.array()))


if __name__ == "__main__":
    np.seterr(all="ignore")
    main("capabilities", case, longest=300)
