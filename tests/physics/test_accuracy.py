"""The accuracy contract: how far results may lie from the exact ones, in ulp.

The exact result is that of the exact values of the doubles given as bends, angles and loads, with
60 digits; one ulp is the spacing of the doubles there. The contract holds for every bend in
[0, pi/2) and every finite angle, so the samples come from five generators, each every bend with
every angle: picked by hand, random, edges (multiples of pi/2 and the doubles beside them, tiny and
huge angles, bends from 1e-160 to the last double), spread over all orders of magnitude, and the
worst of a long search.

The jerk ratio is a difference of two terms; its errors are in ulp of the larger one.

Exact results below 1e-300 are left out: doubles below 2**-1022 are equally spaced, so that products
on the way can lose all their digits without any fault of the formula. Such results are reached only
by bends or angles below 1e-100. For the same reason subnormal angles need only give finite results.
Exact zeros stay in and must come out as zeros.

``pytest -s`` prints the worst case of each output.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np
import pytest

import tiers
from cardan import Driveline, Load, Result, _core
from oracle import EPS, Doubles, Exact, ExactJoint, ExactTurn, Fold, MpNumber, limits, mp, plan_at

# --- one joint -------------------------------------------------------------------------------

SAMPLES, KEPT, FAITHFUL, SINGLE = map(limits, ("samples", "kept", "tolerance_0", "single"))
MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
TORQUES = ("torque of the driven shaft", "torque of the driving shaft", "torque of a flywheel")
# The tolerance that single precision keeps.
COARSE = 1e-6

NORMAL = 2.0**-1022
TINY = 1e-300
RIGHT = math.pi / 2  # rounded down
LAST = math.nextafter(RIGHT, 0.0)
# From about here an angle takes the exact reduction instead of the fast one.
FAR = 2.0**40 * RIGHT


def beside(x: float, steps: int) -> list[float]:
    """Return a double and its neighbours to both sides."""
    near = [x]
    for _ in range(steps):
        near = [math.nextafter(near[0], -math.inf), *near, math.nextafter(near[-1], math.inf)]
    return near


def picked() -> tuple[list[float], list[float]]:
    bends = [0, 0.5, 1, 2, 3, 5, 8.5, 10, 12, 15, 18, 20, 25, 30, 35, 40, 45, 50, 60, 70, 75, 80]
    more = [85, 88, 89, 89.9, 89.99, 89.999999]
    angles = [*range(-360, 721, 15), 44.8, 44.1, 42.9, 1, 2, 3, 89, 91, 179, 181]
    extremes = [f(math.radians(b)) for b in bends[1:] for f in (steepest, farthest)]
    turns = [*map(math.radians, angles), *extremes, 0.1, 0.5, 1.0, 2.0, 3.0, 10.0, 100.0, 1e4]
    return [*map(math.radians, [*bends, *more]), 0.1, 0.3, 1.0, 1.5, 1.57], turns


def farthest(bend: float) -> float:
    """Return the angle of the largest angle error."""
    return math.atan(math.sqrt(math.cos(bend)))


def steepest(bend: float) -> float:
    """Return the angle of the largest acceleration."""
    p = (2 - math.sin(bend) ** 2) / math.sin(bend) ** 2
    return -0.5 * math.acos(4 / (p + math.sqrt(p * p + 8)))


def random() -> tuple[list[float], list[float]]:
    rng = np.random.default_rng(20)
    bends = [*rng.uniform(0, RIGHT, tiers.part(70)), *rng.uniform(0, 0.6, tiers.part(30))]
    angles = [*rng.uniform(-8, 8, 200), *rng.uniform(-1e3, 1e3, 60), *rng.uniform(-1e6, 1e6, 40)]
    return bends, angles


def closest() -> list[float]:
    """Return, for each size up to 2**60, the doubles that come closest to a multiple of pi/2.

    They are the convergents ``m/n`` of ``pi/2`` in units of the last place with ``m`` of 53 bits.
    """
    found = []
    for exponent in range(-52, 8):
        rest = mp.pi / 2 / mp.mpf(2) ** exponent
        (m, n), (before, n_before) = (int(mp.floor(rest)), 1), (1, 0)
        while m < 2**53:
            if m >= 2**52:
                found.append(math.ldexp(m, exponent))
            rest = 1 / (rest - mp.floor(rest))
            digit = int(mp.floor(rest))
            m, before = digit * m + before, m
            n, n_before = digit * n + n_before, n
    return found


def edges() -> tuple[list[float], list[float]]:
    bends = [0.0, 1e-160, 1e-60, 1e-12, 1e-9, 1e-8, 1.4e-8, 1.5e-8, 2.1e-8, 1e-6, 1e-4, 0.01]
    # Where another polynomial for the inverse tangent takes over.
    for tangent in (0.008, 0.1004, 0.32, 1.0):
        root = math.sqrt(1 + tangent**2) - tangent
        bends += beside(2 * math.atan(math.sqrt((1 - root**2) / (1 + root**2))), 2)
    bends += [RIGHT - 1e-3, RIGHT - 1e-6, RIGHT - 1e-9, RIGHT - 1e-12, *beside(LAST, 2)[:3]]
    angles = [0.0, -0.0, 5e-324, NORMAL, 1e-300, 1e-200, 1e-100, 1e-30, 1e-16, 1e-8, 1e-4]
    for turns in (1, 2, 3, 4, 5, 7, 100, 12345, 10**6, 10**9, 10**12, 10**15):
        angles += beside(turns * RIGHT, 3)
    # Half way between them the quadrant changes.
    for turns in (1, 3, 5, 101, 10**6 + 1):
        angles += beside(turns * RIGHT / 2, 2)
    angles += [*beside(FAR, 1), *(FAR + x for x in (-3, -1, 1, 3)), 1e15, 1e22, 2.0**120, 1e300]
    angles += closest()
    # The double nearest to a multiple of pi/2 (Muller et al., Handbook of Floating-Point
    # Arithmetic, 2018, section 10.2), and the largest one.
    angles += [math.ldexp(6381956970095103, 797), math.nextafter(math.inf, 0.0)]
    return bends, [*angles, *(-angle for angle in angles)]


def spread() -> tuple[list[float], list[float]]:
    small = [10.0**x for x in np.linspace(-14, 0.19, tiers.part(60))]
    steep = [RIGHT - 10.0**x for x in np.linspace(-14, 0, tiers.part(30))]
    angles = [10.0**x for x in np.linspace(-300, 300, 61)]
    angles += [10.0**x for x in np.linspace(-12, 12, 97)]
    return [*small, *steep], [angle * sign for angle in angles for sign in (1, -1)]


def searched() -> tuple[list[float], list[float]]:
    """Return the worst samples of a search among 10**9, where roundings happen to add up."""
    worst = [
        ("0x1.920e99757e082p+0", "-0x1.11d4accf59360p-16"),  # angle
        ("0x1.920f919333084p+0", "0x1.01d8b6a7bc70bp-17"),
        ("0x1.518f1bd76cbfep-2", "-0x1.e2f4a93b5879cp+2"),  # angle_error
        ("0x1.f6e9f4ea09590p-1", "-0x1.920bf644d18dep+2"),
        ("0x1.91d9d81009ae2p+0", "-0x1.2b7b24da1680dp+3"),  # speed_ratio
        ("0x1.921fb530d6e92p+0", "0x1.2b5e06180df34p+3"),
        ("0x1.8d7303b02e14fp+0", "-0x1.816c766b4c1ccp+1"),  # acceleration_ratio
        ("0x1.921f0e1c27b61p+0", "-0x1.2b648185811bdp+3"),
        ("0x1.921fb215b5111p+0", "-0x1.921ff85d63aabp+1"),  # jerk_ratio
        ("0x1.66e109be10589p-16", "-0x1.a71bbbbbe36a1p+19"),
        ("0x1.921fb52109c20p+0", "0x1.a300f1ee82950p+2"),  # torque
        ("0x1.921fb51bbbfdap+0", "-0x1.bcaa47021cee2p+1"),  # moment
    ]
    bends, angles = zip(*worst, strict=True)
    return [*map(float.fromhex, bends)], [*map(float.fromhex, angles)]


GENERATORS = {
    "picked": picked,
    "random": random,
    "edges": edges,
    "spread": spread,
    "searched": searched,
}


@dataclass(frozen=True)
class Grid:
    """Every bend with every angle, flat, the angles running fastest."""

    bends: list[float]
    angles: list[float]
    _known: dict[str, Exact] = field(default_factory=dict)

    @cached_property
    def torque(self) -> Doubles:
        """A torque for each angle, from 1e-3 to 1e3."""
        rng = np.random.default_rng(len(self.angles))
        torque: Doubles = 10 ** rng.uniform(-3, 3, len(self.angles)) * rng.choice([-1, 1])
        return torque

    def exact(self, name: str) -> Exact:
        if name not in self._known:
            self._known[name] = Exact.of(self._exact(name))
        return self._known[name]

    def _exact(self, name: str) -> Iterator[MpNumber]:
        turns = [ExactTurn.by(angle) for angle in self.angles]
        torques = [mp.mpf(float(torque)) for torque in self.torque]
        for joint in map(ExactJoint.bent, self.bends):
            for at, torque in zip(turns, torques, strict=True):
                match name:
                    case "angle":
                        yield at.angle + joint.angle_error(at)
                    case "torque of the driven shaft":
                        yield torque / joint.speed_ratio(at)
                    case "torque of the driving shaft":
                        yield torque * joint.speed_ratio(at)
                    case "torque of a flywheel":
                        yield torque * joint.acceleration_ratio(at)
                    case _:
                        yield getattr(joint, name)(at)

    def ulps(self, name: str, want: Exact, got: Doubles) -> Doubles:
        """Return errors in ulp of the exact results, or of the larger term of a difference."""
        unit = self.exact("jerk_term").ulp if name == "jerk_ratio" else want.ulp
        return want.distance(got) / unit

    def exact_moment(self) -> list[Exact]:
        """Return the moment per unit drive torque, a component at a time."""
        turns = [ExactTurn.by(angle) for angle in self.angles]
        moments = [j.moment(at) for j in map(ExactJoint.bent, self.bends) for at in turns]
        return [Exact.of(component) for component in zip(*moments, strict=True)]

    def evaluate(
        self,
        outputs: tuple[str, ...],
        *,
        level: str,
        apart: bool = False,
        tolerance: float | None = None,
        **options: object,
    ) -> Result:
        """Evaluate row by row, or with a driveline for each sample if ``apart``."""
        bends, angles = np.array(self.bends), np.array(self.angles)
        load = Load(**options) if options else None  # type: ignore[arg-type]
        if apart:
            bends, angles = (x.ravel() for x in np.broadcast_arrays(bends[:, None], angles))
            line = Driveline.from_bends(bends[:, None])
        else:
            line = Driveline.from_bends(bends[:, None, None])
        settings = {"shafts": [0, 1], "joints": 0, "load": load}
        return plan_at(line, outputs, **settings, level=level, tolerance=tolerance)(angles)


@cache
def grid(name: str) -> Grid:
    bends, angles = GENERATORS[name]()
    return Grid([*map(float, bends)], [*map(float, angles)])


def judge(where: str, name: str, samples: Grid, got: Doubles, want: Exact, ulps: Doubles) -> None:
    """Compare errors in ulp with the contract, and show the worst one."""
    assert np.isfinite(got).all()
    counts = (np.abs(want.high) >= TINY) | (want.high == 0)
    counts &= ~np.tile(np.abs(samples.angles) < NORMAL, len(samples.bends)) | (want.high == 0)
    ulps = np.where(counts, ulps, 0.0)
    worst = int(ulps.argmax())
    bend = samples.bends[worst // len(samples.angles)]
    angle = samples.angles[worst % len(samples.angles)]
    report = (
        f"{where}: {name} is {ulps[worst]:.3f} ulp off at bend {bend.hex()} = {bend!r}, "
        f"angle {angle.hex()} = {angle!r}: {float(got[worst]).hex()}, "
        f"nearest {float(want.high[worst]).hex()}"
    )
    print(report)
    if "faithful" in where:
        limit = FAITHFUL[name]
    else:
        limit = (KEPT if where.startswith("searched") else SAMPLES)[name]
    assert ulps[worst] <= limit, report


BEST = _core.levels()[0]
generators = pytest.mark.parametrize("generator", GENERATORS)
# One worker finds the exact results of an output for all of its tests.
motion = pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.xdist_group(f"exact {name}")) for name in MOTION],
)


def together(name: str) -> tuple[str, ...]:
    """Return what is evaluated beside an output of the motion, and itself."""
    rotation = "angle_error" if name == "angle_error" else "angle"
    return tuple(dict.fromkeys((rotation, "speed_ratio", "acceleration_ratio", name)))


@generators
@motion
def test_motion(generator: str, name: str) -> None:
    samples = grid(generator)
    want = samples.exact(name)
    got = samples.evaluate((name,), level=BEST)[name][1].ravel()
    judge(generator, name, samples, got, want, samples.ulps(name, want, got))
    # With a driveline for each sample another polynomial may serve.
    got = samples.evaluate((name,), level=BEST, apart=True)[name][1]
    judge(f"{generator}, apart", name, samples, got, want, samples.ulps(name, want, got))
    # One loop finds the first three together.
    got = samples.evaluate(together(name), level=BEST)[name][1].ravel()
    judge(f"{generator}, together", name, samples, got, want, samples.ulps(name, want, got))


@generators
@motion
def test_faithful_motion(generator: str, name: str) -> None:
    samples = grid(generator)
    want = samples.exact(name)
    # Error terms of smaller angles would be below the smallest double.
    counts = np.tile(np.abs(samples.angles) > 1e-280, len(samples.bends)) | (want.high == 0)
    for names in ((name,), together(name)):
        for apart in (False, True):
            result = samples.evaluate(names, level=BEST, apart=apart, tolerance=0)
            got = result[name][1].ravel()
            ulps = np.where(counts, samples.ulps(name, want, got), 0.0)
            judge(f"{generator}, faithful", name, samples, got, want, ulps)


@generators
@motion
def test_single_precision_keeps_its_tolerance(generator: str, name: str) -> None:
    samples = grid(generator)
    bends = np.array(samples.bends)
    joint = Driveline.from_bends(bends[:, None]).equivalent()
    largest = {
        "angle": np.full(bends.shape, 2 * np.pi),
        "angle_error": joint.max_angle_error,
        "speed_ratio": joint.max_speed_ratio,
        "acceleration_ratio": joint.max_acceleration_ratio,
        "jerk_ratio": 2 * joint.non_uniformity * joint.max_speed_ratio**2,
    }[name]
    want = samples.exact(name).high.reshape(len(bends), -1)
    got = samples.evaluate((name,), level=BEST, tolerance=COARSE)[name][1]
    got = got.reshape(want.shape)
    # Nothing smaller has all digits in single precision, and nothing larger is a number there.
    counts = (largest > 1e-30) & (largest < 1e38)
    size = np.maximum(largest[counts, None], np.abs(want[counts]) if name == "angle" else 0.0)
    error = np.max(np.abs(got[counts] - want[counts]) / size)
    print(f"{generator}: {name} in single precision is {error:.2e} off")
    assert error <= SINGLE[name]


@generators
def test_torque(generator: str) -> None:
    samples = grid(generator)
    torque = samples.torque
    inertias = torque[:, None] * [0, math.copysign(1, torque[0])]
    loads: tuple[dict[str, Any], ...] = (
        {"drive_torque": torque},
        {"output_torque": torque},
        {"speed": 1, "inertias": inertias},
    )
    for name, shaft, load in zip(TORQUES, (1, 0, 1), loads, strict=True):
        want = samples.exact(name)
        for where, tolerance in ((generator, None), (f"{generator}, faithful", 0)):
            result = samples.evaluate(("torque",), level=BEST, tolerance=tolerance, **load)
            got = result.torque[shaft].ravel()
            if name == "torque of a flywheel":
                got = got * math.copysign(1, torque[0])
            judge(where, name, samples, got, want, want.ulps(got))


@generators
def test_moment(generator: str) -> None:
    samples = grid(generator)
    want = samples.exact_moment()
    largest = np.argmax([np.abs(component.high) for component in want], axis=0)
    ulp = np.choose(largest, [component.ulp for component in want])
    for where, tolerance in ((generator, None), (f"{generator}, faithful", 0)):
        result = samples.evaluate(("moment",), level=BEST, drive_torque=1.0, tolerance=tolerance)
        moment = result.moment.reshape(-1, 3)
        for i, component in enumerate(want):
            got = moment[:, i]
            judge(where, "moment", samples, got, component, component.distance(got) / ulp)


# --- closed forms ----------------------------------------------------------------------------

CLOSED_FORMS = limits("joint", "equivalent")


@generators
@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_closed_forms_of_one_joint(generator: str, name: str) -> None:
    bends = grid(generator).bends
    joints = [ExactJoint.bent(bend) for bend in bends]
    match name:
        case "non_uniformity":
            want = Exact.of(j.sine**2 / j.cosine for j in joints)
        case "max_angle_error":
            want = Exact.of(mp.asin(j.k) for j in joints)
        case "min_speed_ratio":
            want = Exact.of(j.cosine for j in joints)
        case "max_speed_ratio":
            want = Exact.of(1 / j.cosine for j in joints)
        case _:
            want = Exact.of(getattr(j, name) for j in joints)
    got = getattr(Driveline.from_bends(np.array(bends)[:, None]).equivalent(), name)
    counts = (np.abs(want.high) >= TINY) | (want.high == 0)
    ulps = np.where(counts, want.ulps(got), 0.0)
    worst = int(ulps.argmax())
    report = f"{generator}: {name} is {ulps[worst]:.3f} ulp off at bend {bends[worst]!r}"
    print(report)
    assert ulps[worst] <= CLOSED_FORMS[name], report


def test_offset_of_one_joint_is_zero() -> None:
    for generator in GENERATORS:
        bends = np.array(grid(generator).bends)
        assert not Driveline.from_bends(bends[:, None]).equivalent().angle_offset.any()


# --- chains ----------------------------------------------------------------------------------

# A chain adds the rounding of its folding, in units of EPS = 2**-52 per joint, for twists and
# phases within +-pi (the difference of larger ones is itself rounded more coarsely). With K the sum
# of the joints' k, or 1 if that is more, and k that of the whole chain, the unit is
# K for k, K/(1 - k) for the angle error, 1/(1 - k)**2 for the speed ratio, K/(1 - k)**3 for the
# acceleration ratio and K/(1 - k)**4 for the jerk ratio: a change e of q = B/A turns
# 1 + q exp(-2 i angle) by up to e/(1 - k), and each derivative costs another 1/(1 - k).
# Rounding grows on its way through steep joints, by more the more there are: few are tested.
CHAINS = limits("chains") | limits("chains", "equivalent")
CHAIN_LENGTHS = {"any": (2, 3, 5, 8), "small": (2, 5), "compensated": (2, 3, 8), "steep": (2, 3)}
POWERS = {"k": 0, "angle_error": 1, "speed_ratio": 2, "acceleration_ratio": 3, "jerk_ratio": 4}


@dataclass(frozen=True)
class Chains:
    """Random chains of a kind."""

    line: Driveline
    folds: list[Fold]


def chains(kind: str, n: int) -> Chains:
    rng = np.random.default_rng([n, *kind.encode()])
    count = tiers.part(150)
    shape = (count, n)
    twists = rng.uniform(-math.pi, math.pi, (count, n - 1))
    phases = rng.uniform(-math.pi, math.pi, (count, n - 1))
    match kind:
        case "any":
            bends = rng.uniform(0, 1.2, shape)
        case "steep":
            bends = rng.uniform(1.2, RIGHT - 0.05, shape)
        case "small":
            bends = 10 ** rng.uniform(-9, -2, shape)
        case "compensated":
            # The exact equivalent joint has a k of 1e-16 or less for an even number of joints.
            bends = np.repeat(rng.uniform(0, 1.2, (count, 1)), n, axis=1)
            phases = np.where(rng.random(twists.shape) < 0.5, twists, twists - math.pi)
            phases = np.where(np.abs(phases) > math.pi, phases + 2 * math.pi, phases)
        case _:
            raise AssertionError(kind)
    lists = zip(bends.tolist(), twists.tolist(), phases.tolist(), strict=True)
    folds = [Fold.of(*angles) for angles in lists]
    return Chains(Driveline.from_bends(bends, twists, phases), folds)


@pytest.mark.parametrize(
    ("kind", "n"), [(kind, n) for kind, lengths in CHAIN_LENGTHS.items() for n in lengths]
)
def test_chains(kind: str, n: int) -> None:
    case = chains(kind, n)
    line, folds = case.line, case.folds
    k = Exact.of(fold.k for fold in folds)
    angle = np.random.default_rng(n).uniform(-4, 4, 8)
    turns = [ExactTurn.by(x) for x in angle.tolist()]
    apart = Driveline.from_bends(line.bends[:, None], line.twists[:, None], line.phases[:, None])
    result = apart.evaluate(angle, tuple(POWERS)[1:])
    total = np.minimum(1.0, (np.tan(line.bends / 2) ** 2).sum(axis=-1))
    for name, power in POWERS.items():
        if name == "k":
            error = k.distance(np.asarray(line.equivalent().k))
        else:
            exact = Exact.of(getattr(fold, name)(at) for fold in folds for at in turns)
            error = exact.distance(result[name].ravel()).reshape(-1, len(turns)).max(axis=1)
        if name != "speed_ratio":
            error = error / total
        units = error / (n * EPS) * (1 - k.high) ** power
        worst = int(units.argmax())
        report = f"{kind}, {n} joints: {name} is {units[worst]:.3f} units off"
        print(report)
        where = [getattr(line, part)[worst].tolist() for part in ("bends", "twists", "phases")]
        assert units[worst] <= CHAINS[name][kind], f"{report} at {where}"
