"""What must hold for every driveline to 64 joints, straight, near-straight or near 90 degrees.

``test_laws.py`` has the laws of short and moderate ones. Here the bounds are conditions: a change
of every bend and of every angle along the driveline by ``e`` changes what the last shaft does by at
most ``e`` times a gain, which is summed up joint by joint from the speed ratios.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import hypothesis.strategies as st
import numpy as np
from hypothesis import given, settings

import tiers
from cardan import Driveline, Load, Sweep
from oracle import EPS, Doubles

ANGLE = np.concatenate([np.linspace(-3.0, 9.0, 61), np.pi / 2 + 10.0 ** np.arange(-9.0, 0)])
MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")

few = settings(max_examples=tiers.part(40))


@st.composite
def lines(draw: st.DrawFn, most: int = 64) -> Driveline:
    """Random drivelines of which few joints are bent much, so that no speed leaves all bounds."""
    n = draw(st.integers(1, most))
    straight = st.one_of(st.just(0.0), st.just(0.0), st.floats(-12, -2).map(lambda x: 10.0**x))
    bends = np.array(draw(st.lists(straight, min_size=n, max_size=n)))
    steep = st.floats(-4, -1).map(lambda x: math.pi / 2 - 10.0**x)
    moderate = st.floats(0.01, 1.2)
    for bend in draw(st.lists(st.one_of(moderate, moderate, steep), min_size=1, max_size=3)):
        bends[draw(st.integers(0, n - 1))] = bend
    turns = np.array(draw(st.lists(st.floats(-4, 4), min_size=2 * n, max_size=2 * n)))
    twists, phases = turns[: n - 1], turns[n : 2 * n - 1]
    if n > 1 and draw(st.booleans()):
        # Two joints that compensate each other.
        at = draw(st.integers(0, n - 2))
        bends[at + 1] = bends[at]
        phases[at] = twists[at] + draw(st.sampled_from([0.0, math.pi]))
    return Driveline.from_bends(bends, twists, phases)


def gains(line: Driveline, angle: Doubles) -> tuple[Doubles, Doubles]:
    """Return by what changes of all bends and angles change the last angle and its relative speed.

    With a joint's own driving angle ``a`` and ratio ``q = cos b/(cos^2 b cos^2 a + sin^2 a)``: the
    driven angle changes by ``q`` times the change of ``a`` and by at most ``tan b/2`` times that of
    the bend, ``log q`` by at most ``sin b tan b`` and ``tan b`` times these.
    """
    ratio = line.evaluate(angle, "speed_ratio", shafts=slice(None)).speed_ratio
    turned, hastened = np.ones_like(angle), np.zeros_like(angle)
    for j, bend in enumerate(line.bends.tolist()):
        tangent = math.tan(bend)
        hastened = hastened + math.sin(bend) * tangent * turned + tangent
        turned = turned * ratio[j + 1] / ratio[j] + tangent / 2 + 1
    return turned, hastened


def expect_same_motion(
    line: Driveline, other: Driveline, change: float, shift: float = 0.0
) -> None:
    """Compare last shafts whose bends and angles are ``change`` apart, drive angles ``shift``."""
    got, want = (x.evaluate(ANGLE, ("angle_error", "speed_ratio")) for x in (other, line))
    turned, hastened = gains(line, ANGLE)
    ratio = want.speed_ratio
    steepness = np.abs(line.evaluate(ANGLE, "acceleration_ratio").acceleration_ratio)
    # An error is known to some ulp, its drive angle to one of a unit turn.
    known = change + 2 * EPS
    close = known * turned + shift * np.abs(ratio - 1) + 8 * EPS * np.abs(want.angle_error)
    assert np.all(np.abs(got.angle_error - want.angle_error) <= 2 * close)
    close = known * hastened * ratio + (shift + 2 * EPS) * steepness + 16 * EPS * ratio
    assert np.all(np.abs(got.speed_ratio - ratio) <= 2 * close)


@few
@given(lines(), st.integers(0, 2**32 - 1))
def test_rigid_motion_and_scale(line: Driveline, seed: int) -> None:
    # A plane that is hardly one would be another after rounding.
    bends = np.array(line.bends)
    bends[0] = max(bends[0], 0.01)
    line = Driveline.from_bends(bends, line.twists, line.phases)
    random = np.random.default_rng(seed)
    rotation, _ = np.linalg.qr(random.normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    spans = line.directions * random.uniform(0.5, 2, (line.n_joints + 1, 1))
    points = np.vstack([np.zeros(3), np.cumsum(spans, axis=0)])
    scale = float(10 ** random.uniform(-6, 6))
    moved = scale * points @ rotation.T + scale * random.uniform(-9, 9, 3)
    # Points are known to some ulp of the farthest, directions to that over the shortest span.
    change = 8 * EPS * float(np.abs(points).max() + 10) / 0.5
    first, second = (Driveline.from_points(p, line.phases) for p in (points, moved))
    # The drive angle counts from the plane of the first two shafts.
    plane = float(first.bends[0])
    expect_same_motion(first, second, 2 * change, 2 * change / math.sin(plane))


@few
@given(lines(), st.integers(0, 62), st.floats(-4, 4), st.floats(-4, 4))
def test_a_straight_joint_within_a_shaft(
    line: Driveline, at: int, twist: float, phase: float
) -> None:
    if line.n_joints < 2:
        return
    at = 1 + at % (line.n_joints - 1)
    # p = delta - tau + 90 degrees of the two halves must add up to that of the whole.
    bends = np.insert(line.bends, at, 0.0)
    twists, phases = np.insert(line.twists, at - 1, twist), np.insert(line.phases, at - 1, phase)
    twists[at] = line.twists[at - 1] - twist
    phases[at] = line.phases[at - 1] - phase - math.pi / 2
    # Two differences of up to 8 and one of up to 10 are rounded.
    expect_same_motion(line, Driveline.from_bends(bends, twists, phases), 3 * 8 * EPS)


@few
@given(lines(), st.integers(0, 62))
def test_half_a_turn_of_a_yoke(line: Driveline, shaft: int) -> None:
    if line.n_joints < 2:
        return
    phases = np.array(line.phases)
    phases[shaft % phases.size] += math.pi
    # A sum of up to 8 is rounded, and so is pi.
    expect_same_motion(line, line.with_phases(phases), 5 * EPS)


@few
@given(lines())
def test_reversal_keeps_the_equivalent_bend(line: Driveline) -> None:
    got, want = (float(x.equivalent().k) for x in (line.reversed(), line))
    assert min(got, want) >= 0.0
    # Each joint and shaft is folded with sines and cosines within 2**-62; steep joints stretch
    # that by 1/|A|, A with the lengths of the pins left in.
    determinant = float(np.prod(np.cos(line.bends)))
    length = math.sqrt(determinant / (1 - want**2)) if want < 1 else math.sqrt(determinant)
    fold = line.n_joints * 2.0**-60 * min(1.0, float((np.tan(line.bends / 2) ** 2).sum()))
    assert abs(got - want) <= 4 * np.spacing(want) + fold / length


@few
@given(lines(), st.booleans(), st.integers(0, 2**32 - 1))
def test_power_and_moments_balance_at_every_joint(line: Driveline, drive: bool, seed: int) -> None:
    random = np.random.default_rng(seed)
    inertias = random.uniform(0, 1, line.n_joints + 1)
    torque, speed, acceleration = random.uniform(-5, 5, 3)
    load = Load(
        **{"drive_torque" if drive else "output_torque": torque},
        speed=speed,
        acceleration=acceleration,
        inertias=inertias,
    )
    names = ("speed_ratio", "acceleration_ratio", "torque", "moment", "support_moment")
    got = line.evaluate(ANGLE, names, shafts=slice(None), load=load)
    ratio, moment, entering = got.speed_ratio, got.moment, got.torque
    taken = inertias[:, np.newaxis] * (speed**2 * got.acceleration_ratio + acceleration * ratio)
    leaving = entering - taken
    # Power is a running sum, rounded at every shaft.
    sizes = np.abs(taken * ratio).sum(axis=0) + abs(torque) * np.max(ratio, axis=0)
    power = 16 * (line.n_joints + 1) * EPS * sizes
    size = np.linalg.norm(moment, axis=-1)
    zero = np.zeros_like(moment[0])
    for j, bend in enumerate(line.bends.tolist()):
        u, v = line.directions[j], line.directions[j + 1]
        tangent = math.tan(bend)
        passed = leaving[j] * ratio[j] - entering[j + 1] * ratio[j + 1]
        assert np.all(np.abs(passed) <= power)
        # The moment's parts along both shafts are their torsions. Its directions are known to a few
        # EPS, its own driving angle to a few EPS times size over length of the map from the drive
        # to it: the size is at most the product of 1 + k of the joints before, the length the root
        # of that of 1 - k^2 over the speed ratio, and (1 - k)/(1 + k) is the cosine of a bend.
        own = 8 * EPS * size[j] * (1 + tangent)
        assert np.all(np.abs(moment[j] @ u - leaving[j]) <= own + power / ratio[j])
        known = np.sqrt(ratio[j] / float(np.prod(np.cos(line.bends[:j]))))
        steep = 8 * EPS * np.abs(leaving[j]) * math.sin(bend) * tangent * (1 + known)
        off = np.abs(moment[j] @ v - entering[j + 1])
        assert np.all(off <= own + steep + power / ratio[j + 1])
    for i, u in enumerate(line.directions):
        before = moment[i - 1] if i > 0 else zero
        behind = moment[i] if i < line.n_joints else zero
        net = before - behind
        across = net - (net @ u)[:, np.newaxis] * u
        # As above, with the moments of the joints on both sides.
        allowed = np.zeros_like(ANGLE)
        for j in {i - 1, i} & set(range(line.n_joints)):
            tangent = math.tan(float(line.bends[j]))
            known = np.sqrt(ratio[j] / float(np.prod(np.cos(line.bends[:j]))))
            steep = np.abs(leaving[j]) * tangent * (1 + known)
            allowed += 16 * EPS * (size[j] * (1 + tangent) + steep) + power / ratio[j]
        assert np.all(np.linalg.norm(got.support_moment[i] + across, axis=-1) <= allowed)


def load_of(line: Driveline) -> Load:
    return Load(drive_torque=7.0, speed=3.0, inertias=np.linspace(0.1, 0.4, line.n_joints + 1))


def rates(line: Driveline) -> dict[str, float]:
    """Return how fast each of the motion changes with the drive angle at most."""
    joint = line.equivalent()
    k, stretch = float(joint.k), (float(joint.max_speed_ratio) + 1) / 2
    return {
        "angle": 2 * k * stretch,
        "angle_error": 2 * k * stretch,
        "speed_ratio": float(joint.max_acceleration_ratio),
        "acceleration_ratio": 16 * k * stretch**3,
        "jerk_ratio": 96 * k * stretch**4,
    }


def largest_jerk(line: Driveline) -> float:
    """Return the largest jerk ratio, where the shaft is fastest: 2 sin^2 b/cos^3 b."""
    joint = line.equivalent()
    return 2 * float(joint.non_uniformity) * float(joint.max_speed_ratio) ** 2


def folding(line: Driveline, name: str) -> float:
    """Return what sines and cosines within 2**-62 of all joints and shafts change of the motion.

    Steep joints stretch that by 1/|A|, as in docs/testing.md.
    """
    joint = line.equivalent()
    k, stretch = float(joint.k), (float(joint.max_speed_ratio) + 1) / 2
    total = float((np.tan(line.bends / 2) ** 2).sum())
    length = math.sqrt(float(np.prod(np.cos(line.bends))) / (1 - k**2 if k < 1 else 1))
    gain = 96 * stretch**4 if name == "jerk_ratio" else 4 * stretch**3
    return line.n_joints * 2.0**-60 * min(1.0, total) * gain / length


def of_two(line: Driveline) -> Driveline:
    """The driveline as the second of a batch, beside a straight one."""
    bends = np.stack([np.zeros(line.n_joints), line.bends])
    return Driveline.from_bends(bends, line.twists, line.phases)


@few
@given(lines(), st.sampled_from([None, 0, 1e-6]))
def test_every_path_gives_the_same_bits(line: Driveline, tolerance: float | None) -> None:
    names = (*MOTION, "torque", "support_moment", "moment", "tilt_driven")
    joints = [0, line.n_joints - 1] if line.n_joints > 1 else [0]
    options: dict[str, Any] = {
        "shafts": [0, line.n_joints],
        "joints": joints,
        "load": load_of(line),
        "tolerance": tolerance,
    }
    want = line.evaluate(ANGLE, names, **options)
    plan = line.plan(names, **options)
    paths = [
        plan(ANGLE),
        plan(ANGLE, out={name: np.empty_like(want[name]) for name in names}),
        line.evaluate(ANGLE[::-1].copy()[::-1], names, **options),
        line.evaluate(ANGLE, names, workers=2, **options),
    ]
    for got in paths:
        for name in names:
            assert np.array_equal(got[name], want[name]), name
    for name in names:
        alone = line.evaluate(ANGLE, name, **options)[name]
        assert np.array_equal(alone, want[name]), name
    # In a batch, and once per sample.
    each = Driveline.from_bends(np.tile(line.bends, (ANGLE.size, 1)), line.twists, line.phases)
    rows = of_two(line)[:, np.newaxis].evaluate(ANGLE, names, **options)
    samples = each.evaluate(ANGLE, MOTION, tolerance=tolerance)
    for name in names:
        lead = want[name].ndim - 1 - (want[name].shape[-1] == 3)
        got = rows[name][(slice(None),) * lead + (1,)]
        assert np.array_equal(got, want[name]), name
    # Per sample the inverse tangent, and with error terms the formulas, are those for any chain of
    # such bends: both keep their limit. Steep chains carry error terms by default as well.
    terms = "with error terms" in plan.explain()
    error = np.abs(want.angle_error[1])
    limit = {None: 2 * 6, 0: 2, 1e-6: 2 * 6}[tolerance]
    spacing = np.spacing(error if tolerance != 1e-6 else error.astype(np.float32))
    for name in MOTION:
        by_tangent = name.startswith("angle")
        exact = terms and (tolerance == 0 or not by_tangent)
        size = limit * spacing if by_tangent else 0.0
        ulp = np.abs(np.spacing(want[name][1])) if name == "angle" else 0.0
        if tolerance == 1e-6 and name == "angle":
            ulp = np.spacing(np.abs(want.angle[1]).astype(np.float32))
        if exact or by_tangent:
            # To what the equivalent joint's own drive angle is known.
            turn = 2.0**-57 if exact else {None: EPS, 1e-6: 2.0**-23}[tolerance]
            size = size + turn * rates(line)[name] + 2 * folding(line, name)
            ulp = 2 * np.spacing(np.abs(want[name][1])) if exact else ulp
        assert np.all(np.abs(samples[name] - want[name][1]) <= size + ulp), name


@settings(max_examples=tiers.part(10))
@given(lines(), st.integers(2, 4))
def test_threads_share_the_samples(line: Driveline, workers: int) -> None:
    names = ("angle", "acceleration_ratio", "moment")
    options: dict[str, Any] = {"joints": line.n_joints - 1, "load": load_of(line)}
    # Fewer samples than 65536 stay on one thread.
    angle = np.tile(ANGLE, 1500)
    want = line.evaluate(ANGLE, names, **options)
    got = line.evaluate(angle, names, workers=workers, **options)
    for name in names:
        parts = got[name].reshape(1500, *want[name].shape)
        assert np.array_equal(parts, np.broadcast_to(want[name], parts.shape)), name


@st.composite
def sweeps(draw: st.DrawFn, farthest: float) -> Sweep:
    """Sweeps of both kinds: of one sample, parts of turns, whole turns, near and far."""
    num = draw(st.one_of(st.just(1), st.integers(1, 5000)))
    if draw(st.booleans()):
        per_turn = draw(st.integers(1, 900))
        turns = draw(st.one_of(st.integers(1, 6), st.integers(1, 6), st.just(num / per_turn)))
        return Sweep.revolutions(turns, per_turn)
    start = draw(st.one_of(st.floats(-10, 10), st.floats(-farthest, farthest)))
    return Sweep(start, start + draw(st.floats(-10, 10)), num)


@few
@given(lines(), sweeps(10))
def test_sweeps(line: Driveline, sweep: Sweep) -> None:
    angle = np.asarray(sweep)
    got, want = (line.evaluate(x, MOTION) for x in (sweep, angle))
    rows = of_two(line)[:, np.newaxis].evaluate(sweep, MOTION)
    # The array's angles are rounded.
    turned, hastened = gains(line, angle)
    known = EPS * (4 + np.abs(angle))
    steepest = float(line.equivalent().max_acceleration_ratio)
    slopes: dict[str, Any] = {
        "angle": turned,
        "angle_error": turned,
        "speed_ratio": want.speed_ratio * (16 + hastened),
        "acceleration_ratio": 16 * steepest + rates(line)["acceleration_ratio"],
        "jerk_ratio": 16 * largest_jerk(line) + rates(line)["jerk_ratio"],
    }
    for name, rate in slopes.items():
        for other in (got[name], rows[name][1]):
            assert np.all(np.abs(other - want[name]) <= 4 * known * rate), name


REDUCED: dict[Any, Callable[[Doubles], Any]] = {
    "min": np.min,
    "max": np.max,
    "mean": np.mean,
    "rms": lambda x: np.sqrt(np.mean(x * x)),
    "peak": lambda x: np.max(np.abs(x)),
}


@settings(max_examples=tiers.part(100))
@given(
    lines(),
    sweeps(1e11),
    st.sets(st.sampled_from([*MOTION[1:], "tilt_driven", "torque"])),
    st.booleans(),
    st.booleans(),
    st.sampled_from([None, 0, 1e-12, 1e-6]),
    st.sampled_from([np.float64, np.float32]),
)
def test_reductions_of_sweeps(
    line: Driveline,
    sweep: Sweep,
    names: set[str],
    turned: bool,
    steady: bool,
    tolerance: float | None,
    dtype: Any,  # noqa: ANN401
) -> None:
    # What repeats from turn to turn is cut short, but not beside angles or loads that change.
    wanted = sorted(names | {"angle"} if turned else names)
    torque = 7.0 if steady else np.linspace(-5.0, 7.0, len(sweep))
    load = Load(drive_torque=torque) if "torque" in names else None
    options: dict[str, Any] = {"load": load, "tolerance": tolerance, "dtype": dtype, "joints": -1}
    samples = line.evaluate(sweep, wanted, **options)
    joint = line.equivalent()
    largest = {
        "angle": 10.0 + np.abs(np.asarray(sweep)).max(),
        "angle_error": joint.max_angle_error,
        "speed_ratio": joint.max_speed_ratio,
        "acceleration_ratio": joint.max_acceleration_ratio,
        "jerk_ratio": largest_jerk(line),
        "tilt_driven": 2.0,
        "torque": 7.0 * joint.max_speed_ratio,
    }
    # Sums of at most 5400 numbers; an extreme in closed form finds its own sine.
    close = 1e-13 if dtype == np.float64 and tolerance != 1e-6 else 4e-6
    for how, plain in REDUCED.items():
        for drivelines, place in ((line, ...), (of_two(line)[:, np.newaxis], 1)):
            got = drivelines.evaluate(sweep, wanted, reduce=how, **options)
            for name in wanted:
                off = np.abs(got[name][place] - plain(samples[name].astype(np.float64)))
                assert off <= close * float(largest[name]) + 1e-37, (name, how)


@few
@given(lines())
def test_less_accuracy_keeps_its_bounds(line: Driveline) -> None:
    want = line.evaluate(ANGLE, MOTION, tolerance=0)
    joint = line.equivalent()
    ratio = float(joint.max_speed_ratio)
    largest = {
        "angle": 10.0,
        "angle_error": float(joint.max_angle_error),
        "speed_ratio": ratio,
        "acceleration_ratio": float(joint.max_acceleration_ratio),
        "jerk_ratio": largest_jerk(line),
    }
    for options, limit in (
        ({"tolerance": 1e-6}, 1e-6),
        ({"dtype": np.float32}, 1e-6),
        ({"tolerance": 1e-6, "dtype": np.float32}, 1e-6),
        ({"tolerance": 1e-14}, 1e-14),
        ({}, 1e-14),
    ):
        got = line.evaluate(ANGLE, MOTION, **options)
        # The equivalent joint's turn is an angle of this precision.
        turn = 2 * (2.0**-24 if limit == 1e-6 else EPS)
        for name, rate in rates(line).items():
            size = largest[name]
            off = np.max(np.abs(got[name] - want[name]))
            # Single precision has no numbers below 1e-38.
            assert off <= limit * size + turn * rate + folding(line, name) + 1e-37, (name, options)
