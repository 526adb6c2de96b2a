"""The evaluations whose bits ``bits.py`` records: a name and arrays each.

Nothing here follows from the package's own lists, so that what is added to it leaves them as they
are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import cardan
from cardan import Driveline, Load, Sweep, _core
from oracle import plan_at

Arrays: TypeAlias = Mapping[str, NDArray[Any]]
BitsCase: TypeAlias = tuple[str, Arrays]

SHAFT_MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio")
SHAFT_LOADS = ("torque", "support_moment")
TILTS = ("tilt_driving", "tilt_driven")
JOINT_LOADS = ("moment", "bending_driving", "bending_driven")
OUTPUTS = (*SHAFT_MOTION, *SHAFT_LOADS, *JOINT_LOADS, *TILTS)
# Combinations for which a plan takes other steps than for all outputs at once.
TOGETHER = (
    ("angle", "speed_ratio"),
    ("speed_ratio", "acceleration_ratio"),
    ("angle", "speed_ratio", "acceleration_ratio"),
    ("angle_error", "acceleration_ratio"),
    ("torque", "moment"),
    TILTS,
)
REDUCTIONS = ("min", "max", "mean", "rms", "peak")
DTYPES = ("float64", "float32")
TIERS: dict[str, dict[str, Any]] = {
    f"{dtype} {tolerance}": {"tolerance": tolerance, "dtype": dtype}
    for tolerance in (None, 0.0, 1e-6, 1e-12)
    for dtype in DTYPES
}

RANDOM = np.random.default_rng(1939)
MANY = RANDOM.uniform(-20.0, 20.0, 2500)
MANY[:8] = [0.0, -0.0, np.pi / 2, -np.pi / 2, np.pi, 1e-9, -1e-300, 5e-324]
EIGHT = np.linspace(-4.0, 9.0, 8)
HUGE = np.array([1e5, -1e8, 1e12, 2.0**60, -1e100, 1e300, np.finfo(float).max, 3.0, 1e15])
GAPS = np.where(np.arange(80) % 7 == 3, [np.nan, np.inf, -np.inf, 0.5] * 20, MANY[100:180])
POINTS = RANDOM.normal(0.0, 0.3, (6, 5, 3)) + np.arange(5.0)[:, np.newaxis] * [2.0, 0.0, 0.0]

ANGLES: dict[str, Any] = {
    "no angle": np.empty(0),
    "one angle": 0.7,
    "8 angles": EIGHT,
    "a table": MANY[:1200].reshape(24, 50),
    "every third, backwards": MANY[1500::-3],
    "a table's columns": MANY[:1200].reshape(24, 50)[:, 3:40:5],
    "huge angles": HUGE,
    "gaps": GAPS,
    "float32 angles": MANY[:300].astype(np.float32),
}
SWEEPS: dict[str, Sweep] = {
    "half a turn": Sweep.revolutions(0.5, 128),
    "odd turns": Sweep.revolutions(4, 359),
    "samples by 8 and more": Sweep.revolutions(2, 2052),
    "no turns": Sweep(0.1, 37.0, 9001),
    "backwards": Sweep(20.0, -3.0, 1777),
    "far away": Sweep(1e9, 1e9 + 40.0, 1500),
    "one sample": Sweep(0.3, 0.3, 1),
    "at rest": Sweep(0.4, 0.4, 70),
}


def bent(bends: Any, twists: Any = 0.0, phases: Any = 0.0) -> Driveline:  # noqa: ANN401
    return Driveline.from_bends(bends, twists, phases, degrees=True)


LINES = {
    "1 straight": bent([0.0]),
    "1 slight": bent([0.01]),
    "1 small": bent([4.0]),
    "1 moderate": bent([28.0]),
    "1 steep": bent([85.0]),
    "1 right": bent([89.9999]),
    "2 compensated": bent([17.0, 17.0]),
    "2 planar": bent([12.0, 31.0], 0.0, 90.0),
    "2 spatial": bent([25.0, 40.0], 33.0, -14.0),
    "2 steep": bent([85.0, 80.0], -50.0, 20.0),
    "3 with a straight one": bent([30.0, 0.0, 50.0], [17.0, -60.0], [40.0, 11.0]),
    "3 spatial": bent([8.0, 22.0, 35.0], [80.0, 130.0], [5.0, -95.0]),
    "3 right": bent([89.9999, 10.0, 85.0], [1.0, 2.0], [3.0, 4.0]),
    "5 planar": bent([5.0, 10.0, 0.0, 15.0, 20.0], 0.0, [0.0, 90.0, 0.0, 90.0]),
    "5 spatial": bent([9.0, 33.0, 21.0, 47.0, 14.0], [15.0, 75.0, -20.0, 160.0], 37.0),
    "from points": Driveline.from_points(POINTS[0], [0.3, -0.4]),
}
FULL_TURNS = Sweep.revolutions(3, 720)
SOME = ("1 moderate", "2 spatial", "3 with a straight one", "5 spatial")


def batch(seed: int, shape: tuple[int, ...], joints: int) -> Driveline:
    random = np.random.default_rng(seed)
    bends, between = random.uniform(0.0, 80.0, (*shape, joints)), (*shape, joints - 1)
    bends[..., -1] *= random.uniform(0.0, 1.0, shape) > 0.2
    return bent(bends, random.uniform(-180.0, 180.0, between), random.uniform(-90.0, 90.0, between))


def loads(joints: int, samples: int) -> dict[str, Load]:
    inertias = np.linspace(0.1, 0.4, joints + 1)
    inertias[0] = 0.0
    turning: dict[str, Any] = {"inertias": inertias, "speed": 30.0, "acceleration": -2.0}
    torque, speed, acceleration = np.random.default_rng(7).uniform(-9.0, 9.0, (3, samples))
    varying: dict[str, Any] = {**turning, "speed": speed, "acceleration": acceleration}
    return {
        "driven": Load(drive_torque=7.0),
        "braked": Load(output_torque=-3.0),
        "driven inertias": Load(drive_torque=7.0, **turning),
        "braked inertias": Load(output_torque=4.0, **turning),
        "varying": Load(drive_torque=torque),
        "varying inertias": Load(output_torque=torque, **varying),
        "inertias that vary": Load(speed=8.0, inertias=inertias * speed[:, np.newaxis] ** 2),
    }


def case(name: str, line: Driveline, angle: Any, names: Any = OUTPUTS, **options: Any) -> BitsCase:  # noqa: ANN401
    """One evaluation, under full load and of every shaft unless the options say otherwise."""
    full = loads(line.n_joints, 1)["driven inertias"]
    settings = {"shafts": slice(None), "load": full, **options}
    out = settings.pop("out", None)
    return name, plan_at(line, names, **settings)(angle, out)


def of_lines() -> Iterator[BitsCase]:
    """Every driveline at every tier, all outputs together and each alone."""
    for line, own in LINES.items():
        for tier, options in TIERS.items():
            yield case(f"{line}, 2500 angles, {tier}", own, MANY, **options)
            yield case(f"{line}, turns, {tier}", own, FULL_TURNS, **options)
        yield case(f"{line}, 8 angles", own, EIGHT)
        for name in OUTPUTS:
            yield case(f"{line}, alone", own, MANY[:200], name, shafts=None)
            for tier in TIERS if line in SOME else ():
                yield case(f"{line}, alone, {tier}", own, MANY[:99], name, **TIERS[tier])


def of_angles() -> Iterator[BitsCase]:
    """Angles in every form."""
    for line in SOME:
        for angle, values in {**ANGLES, **SWEEPS}.items():
            for tier in TIERS if line == "2 spatial" else ("float64 None",):
                yield case(f"{line}, {angle}, {tier}", LINES[line], values, **TIERS[tier])


def of_reductions() -> Iterator[BitsCase]:
    rows, three = batch(3, (5, 1), 2), LINES["3 spatial"]
    samples = {**ANGLES, **SWEEPS}
    del samples["no angle"], samples["one angle"]
    for how in REDUCTIONS:
        for line, own in LINES.items():
            yield case(f"{line}, {how}", own, FULL_TURNS, reduce=how)
        for name in OUTPUTS if how in ("max", "peak") else ():
            yield case(f"batch, {how} alone", rows, FULL_TURNS, name, shafts=None, reduce=how)
        for angle, values in samples.items():
            yield case(f"3 spatial, {how}, {angle}", three, values, reduce=how)
        for tier, options in TIERS.items():
            yield case(f"3 spatial, {how}, {tier}", three, MANY, reduce=how, **options)
            yield case(f"batch, {how}, {tier}", rows, MANY, reduce=how, **options)


def of_loads() -> Iterator[BitsCase]:
    loaded = (*SHAFT_LOADS, *JOINT_LOADS)
    for line in SOME:
        own = LINES[line]
        for load, values in loads(own.n_joints, 2160).items():
            for tier in ("float64 None", "float64 0.0", "float32 None"):
                for angle, drive in (("angles", MANY[:2160]), ("turns", FULL_TURNS)):
                    name = f"{line}, {load}, {angle}, {tier}"
                    yield case(name, own, drive, loaded, load=values, **TIERS[tier])
            name = f"{line}, {load}, peak"
            yield case(name, own, FULL_TURNS, loaded, load=values, reduce="peak")


def of_batches() -> Iterator[BitsCase]:
    for joints in (1, 2, 3, 5):
        rows, each = batch(joints, (4, 1), joints), batch(joints + 10, (600,), joints)
        for tier, options in TIERS.items():
            yield case(f"{joints}, rows, {tier}", rows, MANY[:500], **options)
            yield case(f"{joints}, each its own, {tier}", each, MANY[:600], **options)
        yield case(f"{joints}, rows over turns", rows, Sweep.revolutions(2, 360))
        yield case(f"{joints}, each at one angle", each, 0.4)
        yield case(f"{joints}, each its own of a sweep", each, Sweep(0.0, 3.0, 600))
        table = batch(joints + 20, (3, 40), joints)
        yield case(f"{joints}, table", table, MANY[:120].reshape(3, 40)[:, ::-1])


def of_choices() -> Iterator[BitsCase]:
    """Combinations of outputs, shafts, joints, arrays to fill, threads and instruction sets."""
    few, turns = ("angle", "speed_ratio", "moment"), Sweep.revolutions(30, 4001)
    for line in SOME:
        own, n = LINES[line], LINES[line].n_joints
        for names in TOGETHER:
            for angle, values in {"angles": MANY[:300], **SWEEPS}.items():
                yield case(f"{line}, {'+'.join(names)}, {angle}", own, values, names, shafts=None)
        yield case(f"{line}, first and last", own, EIGHT, shafts=[0, -1], joints=[-1])
        yield case(f"{line}, single items", own, EIGHT, shafts=1, joints=0)
        for level in ("avx2", "sse2"):
            # On a machine without it, its own must give the same bits.
            usable = level if level in _core.levels() else _core.levels()[0]
            for tier in ("float64 None", "float64 0.0", "float32 None"):
                chosen = {"level": usable, **TIERS[tier]}
                yield case(f"{line}, {level}, {tier}", own, MANY[:999], **chosen)
            yield case(f"{line}, {level}, sweep", own, SWEEPS["no turns"], level=usable)
        for workers in (1, 2):
            long = np.resize(MANY, 100_003)
            yield case(f"{line}, {workers} threads", own, long, few, workers=workers)
            yield case(f"{line}, {workers} threads, turns", own, turns, few, workers=workers)
        for word in DTYPES:
            out = {
                "angle": np.empty((n + 1, 99), word),
                "moment": np.moveaxis(np.empty((n, 3, 99), word), 1, -1),
                "tilt_driven": np.empty((n, 198), word)[:, ::2],
            }
            yield case(f"{line}, filled, {word}", own, MANY[:99], tuple(out), out=out, dtype=word)


def of_closed_forms() -> Iterator[BitsCase]:
    """What is found without samples."""
    lines = {**LINES, "points": Driveline.from_points(POINTS, 0.2)}
    lines |= {f"batch of {joints}": batch(joints, (7, 3), joints) for joints in (1, 2, 3, 4, 5)}
    for name, line in lines.items():
        for shaft in range(line.n_joints + 1):
            yield f"{name}, equivalent {shaft}", vars(line.equivalent(shaft))
        series = line.harmonics([1, 2, 4, 6, 40])
        yield f"{name}, harmonics", digits({"orders": series.orders, **series.amplitude})
        findings = line.check(90.0).findings
        yield f"{name}, check", {f.figure: np.asarray(f.value) for f in findings}
        yield name, {"optimal_phases": line.optimal_phases()}
        yield name, {part: getattr(line, part) for part in ("bends", "directions", "normals")}


def digits(arrays: Arrays) -> Arrays:
    return {name: np.vectorize("{:.11e}".format)(array) for name, array in arrays.items()}


def of_jerk() -> Iterator[BitsCase]:
    """The jerk ratio alone and with the rest of the motion, and the transmissions to one shaft."""
    names = (*SHAFT_MOTION, "jerk_ratio")
    for line, own in LINES.items():
        for tier, options in TIERS.items():
            yield case(f"{line}, alone, {tier}", own, MANY[:500], "jerk_ratio", **options)
        yield case(f"{line}, together", own, MANY[:500], names)
        for sweep, values in SWEEPS.items() if line in SOME else ():
            yield case(f"{line}, {sweep}", own, values, names)
        for how in REDUCTIONS:
            yield case(f"{line}, {how}", own, FULL_TURNS, "jerk_ratio", reduce=how)
    for tier, options in TIERS.items():
        yield case(f"rows, {tier}", batch(2, (4, 1), 2), MANY[:500], "jerk_ratio", **options)
        yield case(f"each, {tier}", batch(12, (600,), 2), MANY[:600], "jerk_ratio", **options)
    for line, own in {**LINES, "batch": batch(3, (5, 1), 3)}.items():
        transmission = own.transmission()
        yield f"{line}, q", {"q": transmission.q}
        yield f"{line}, motion", transmission.motion(EIGHT)._asdict()
        yield f"{line}, gradient", transmission.gradient(EIGHT)._asdict()


def of_forces() -> Iterator[BitsCase]:
    """A floating shaft, one bearing on every shaft, and two on every shaft."""
    arrangements = {
        "floating": [(0, 0.3), (0, 0.9), (1, 0.7), (3, 0.2), (3, 1.1)],
        "one each": [(0, 0.3), (0, 0.9), (1, 0.7), (2, 0.4), (3, 1.1)],
        "two each": [(shaft, at) for shaft in range(4) for at in (0.2, 0.8)],
    }
    planar = Driveline.from_points(POINTS[0] * [1.0, 1.0, 0.0], [0.3, -0.4])
    spatial = Driveline.from_points(POINTS, [0.3, -0.4])
    forces = ("joint_force", "bearing_force")
    for name, bearings in arrangements.items():
        lines = spatial.with_bearings(bearings)
        load = Load(output_torque=7.0, speed=20.0, inertias=[0.1, 0.02, 0.03, 0.01])
        for tier, options in TIERS.items():
            one = lines[0]
            yield case(f"{name}, {tier}", one, MANY[:700], forces, load=load, **options)
        flat = planar.with_bearings(bearings)
        yield case(f"{name}, in a plane", flat, FULL_TURNS, forces, load=load)
        yield case(f"{name}, batch", lines[:, None], MANY[:70], forces, load=load)
        yield case(f"{name}, each", lines, MANY[:6], forces, load=load)
        for how in REDUCTIONS:
            options = {"load": load, "reduce": how}
            yield case(f"{name}, {how}", lines[:, None], FULL_TURNS, forces, **options)


def of_crosses() -> Iterator[BitsCase]:
    """The moment of the pins, their rates and their directions."""
    names = tuple(name for name, output in cardan.OUTPUTS.items() if output.ideal)
    for line, own in LINES.items():
        for tier, options in TIERS.items():
            yield case(f"{line}, {tier}", own, MANY[:500], names, **options)
        for sweep, values in SWEEPS.items() if line in SOME else ():
            yield case(f"{line}, {sweep}", own, values, names)
        for how in REDUCTIONS:
            yield case(f"{line}, {how}", own, FULL_TURNS, names, reduce=how)
    for tier, options in TIERS.items():
        yield case(f"rows, {tier}", batch(2, (4, 1), 2), MANY[:500], names, **options)
        yield case(f"each, {tier}", batch(12, (600,), 2), MANY[:600], names, **options)


def of_shaft_axes() -> Iterator[BitsCase]:
    """Moments in axes that turn with their shafts, and forces."""
    names = ("torque", "moment", "support_moment")
    options: dict[str, Any] = {"axes": "shaft"}
    for line, own in LINES.items():
        for tier, more in TIERS.items():
            yield case(f"{line}, {tier}", own, MANY[:500], names, **options, **more)
        for angle, values in {"gaps": GAPS, **SWEEPS}.items() if line in SOME else ():
            yield case(f"{line}, {angle}", own, values, names, **options)
        for how in REDUCTIONS:
            yield case(f"{line}, {how}", own, FULL_TURNS, names, **options, reduce=how)
    for load, given in loads(3, 500).items():
        yield case(load, LINES["3 spatial"], MANY[:500], names, **options, load=given)
    forces = ("joint_force", "bearing_force")
    bearings = [(0, 0.3), (0, 0.9), (1, 0.7), (2, 0.4), (3, 1.1)]
    lines = Driveline.from_points(POINTS, [0.3, -0.4]).with_bearings(bearings)
    for load, given in loads(3, 1).items():
        options["load"] = given
        for tier, more in TIERS.items():
            yield case(f"forces, {load}, {tier}", lines[0], MANY[:99], forces, **options, **more)
        yield case(f"forces, {load}, each", lines, MANY[:6], forces, **options)
    for tier, more in TIERS.items():
        turning = {"axes": "shaft", **more}
        yield case(f"rows, {tier}", batch(2, (4, 1), 2), MANY[:500], names, **turning)
        yield case(f"each, {tier}", batch(12, (600,), 2), MANY[:600], names, **turning)


def of_built() -> Iterator[BitsCase]:
    """Joints as built: each output alone, and all together."""
    names = (*OUTPUTS, "jerk_ratio")
    own = (0.01, [-0.004, 0.006, 0.0], -0.02)
    for name, line in {"3 spatial": LINES["3 spatial"], "rows": batch(3, (4, 1), 3)}.items():
        built = line.with_deviations(*own)
        for tier in ("float64 None", "float64 0.0"):
            yield case(f"{name}, {tier}", built, MANY[:500], names, **TIERS[tier])
        for output in names:
            yield case(f"{name}, alone", built, MANY[:200], output)


GROUPS = (
    of_lines,
    of_angles,
    of_reductions,
    of_loads,
    of_forces,
    of_batches,
    of_choices,
    of_closed_forms,
    of_jerk,
    of_crosses,
    of_shaft_axes,
    of_built,
)
