"""The accuracy contract of chains: what ``tolerance`` promises, up to the last double below 90 deg.

With ``tolerance=0`` every output of the motion is within its limit in plain ulp, for every chain
and every angle. So the samples are random ones and the hardest: beside the multiples of a quarter
turn of the equivalent joint's driving angle, where a chain is fastest or turns with the drive, and
beside the zeros of the shaft's angle, each at all distances down to the nearest double. The exact
results are those of the map ``w -> a w + b conj(w)`` with as many digits as the steepest chains
leave of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Sweep
from oracle import Doubles, Exact, ExactJoint, ExactTurn, Fold, MpNumber, limits, mp, read

DIGITS = 260
MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
CROSS = ("tilt_driving", "tilt_driven", "swing_driving", "swing_driven")
FAITHFUL = limits("tolerance_0")
COARSE = limits("single_chain")
LAST = math.nextafter(math.pi / 2, 0.0)


@dataclass(frozen=True)
class SteepChain:
    """A chain and its exact map."""

    bends: tuple[float, ...]
    twists: tuple[float, ...]
    phases: tuple[float, ...]

    @property
    def line(self) -> Driveline:
        return Driveline.from_bends(self.bends, self.twists, self.phases)

    @cached_property
    def fold(self) -> Fold:
        with mp.workdps(DIGITS):
            return Fold.of(self.bends, self.twists, self.phases)

    def before(self, joint: int) -> Fold:
        """Return the map to the driving yoke of a joint behind the first."""
        with mp.workdps(DIGITS):
            cut = joint - 1
            fold = Fold.of(self.bends[:joint], self.twists[:cut], self.phases[:cut])
            return fold.past_shaft(self.twists[cut], self.phases[cut])

    @cached_property
    def zeros(self) -> list[MpNumber]:
        """Drive angles at quarter turns of the equivalent joint and at a zero of the angle."""
        with mp.workdps(DIGITS):
            product = self.fold.b * mp.conj(self.fold.a)
            if product == 0:
                return [mp.mpf(0)]
            start = mp.arg(-product) / 2
            square = abs(self.fold.a) ** 2
            still = -mp.atan2(mp.im(product), square - mp.re(product))
            return [start, start + mp.pi / 2, start + 5 * mp.pi, still]

    def angles(self, rng: np.random.Generator) -> list[float]:
        random = [*rng.uniform(-4, 4, 8), *rng.uniform(-1e3, 1e3, 2)]
        beside = [
            zero + float(rng.choice([-1, 1]) * 10.0**-distance * rng.uniform(0.3, 1))
            for zero in self.zeros
            for distance in (1, 2, 3, 4, 5, 6, 7, 9, 11, 13, 15, 40)
        ]
        return [*map(float, random), *map(float, beside), 0.0]


ChainKind = Callable[[np.random.Generator], Iterator[SteepChain]]


def chain(rng: np.random.Generator, bends: Doubles) -> SteepChain:
    n = len(bends) - 1
    twists, phases = rng.uniform(-3.1, 3.1, (2, n)).tolist()
    return SteepChain(tuple(bends.tolist()), tuple(twists), tuple(phases))


def ordinary(rng: np.random.Generator) -> Iterator[SteepChain]:
    for n in (2, 2, 2, 3, 5, 8):
        yield chain(rng, rng.uniform(0, 1.2, n))


def near_straight(rng: np.random.Generator) -> Iterator[SteepChain]:
    for n in (2, 3, 20):
        yield chain(rng, 10 ** rng.uniform(-12, -2, n))


def one_steep(rng: np.random.Generator) -> Iterator[SteepChain]:
    """One joint 1e-4 to 3 degrees from 90, at each place of chains of two and three."""
    for n, place in ((2, 0), (2, 1), (3, 0), (3, 1), (3, 2)):
        for _ in range(3):
            bends = rng.uniform(0, 1.2, n)
            bends[place] = math.pi / 2 - 10 ** rng.uniform(math.log10(1.7e-6), math.log10(0.0524))
            yield chain(rng, bends)
    # What was once 19 ulp off.
    yield SteepChain(
        (0.138639674003652, 1.5704521238623042), (1.6680718368567717,), (4.0429819484237,)
    )


def steepest(rng: np.random.Generator) -> Iterator[SteepChain]:
    """Every joint steep, up to the last double."""
    for n in (2, 2, 3, 3, 4):
        yield chain(rng, np.minimum(math.pi / 2 - 10 ** rng.uniform(-16, -1, n), LAST))
    yield chain(rng, np.array([LAST, LAST]))
    yield chain(rng, np.array([LAST, LAST, 0.3]))


def compensated(rng: np.random.Generator) -> Iterator[SteepChain]:
    """Joints that undo each other: quite, nearly, and with a straight shaft between them."""
    for bend in (0.3, 1.1, math.pi / 2 - 1e-6, LAST):
        twist = float(rng.uniform(-3, 3))
        yield SteepChain((bend, bend), (twist,), (twist,))
        yield SteepChain((bend, bend), (twist,), (twist + math.pi,))
        yield SteepChain((bend, bend), (twist,), (math.nextafter(twist, 9.0),))
        yield SteepChain((bend, math.nextafter(bend, 0.0)), (twist,), (twist + 1e-9,))
        yield SteepChain((bend, 0.0, bend), (twist, 0.7), (twist, 0.7))


def first_straight(rng: np.random.Generator) -> Iterator[SteepChain]:
    for bend in (1e-3, 0.8, LAST):
        yield chain(rng, np.array([0.0, bend]))
        yield SteepChain((0.0, bend), (0.25,), (1e14,))


KINDS: dict[str, ChainKind] = {
    kind.__name__: kind
    for kind in (ordinary, near_straight, one_steep, steepest, compensated, first_straight)
}


@dataclass(frozen=True)
class ChainSamples:
    """Chains of a kind, angles for each, and the exact results."""

    kind: str
    chains: list[SteepChain]
    angles: list[list[float]]

    def exact(self, name: str) -> list[Exact]:
        return exact(self.kind, name)

    def judge(self, where: str, name: str, i: int, got: Doubles) -> None:
        """Compare the results of a chain with the limit."""
        want = self.exact(name)[i]
        unit = want.ulp
        if name == "jerk_ratio":
            unit = np.maximum(unit, self.exact("jerk_term")[i].ulp)
        # What is left of an exact zero is smaller than the last digit of the oracle.
        zero = np.abs(want.high) < 1e-200
        assert (np.abs(got[zero]) < 1e-200).all(), (where, name, self.chains[i])
        # Products of larger numbers overflow on the way.
        counts = ~zero & (np.abs(want.high) < 1e300)
        ulps = np.where(counts, want.distance(got) / unit, 0.0)
        worst = int(np.nanargmax(np.where(np.isnan(ulps), np.inf, ulps)))
        assert ulps[worst] <= FAITHFUL[name], (
            f"{where}: {name} is {ulps[worst]:.3g} ulp off behind {self.chains[i]!r} at "
            f"{self.angles[i][worst]!r}: {got[worst]!r}, nearest {want.high[worst]!r}"
        )


@cache
def samples(kind: str) -> ChainSamples:
    rng = np.random.default_rng([7, *kind.encode()])
    chains = list(KINDS[kind](rng))
    return ChainSamples(kind, chains, [chain.angles(rng) for chain in chains])


@cache
def exact(kind: str, name: str) -> list[Exact]:
    of = samples(kind)
    with mp.workdps(DIGITS):
        return [
            Exact.of(getattr(chain.fold, name)(ExactTurn.by(x)) for x in angles)
            for chain, angles in zip(of.chains, of.angles, strict=True)
        ]


kinds = pytest.mark.parametrize("kind", KINDS)


@kinds
def test_motion_is_faithful(kind: str) -> None:
    of = samples(kind)
    for i, (chain, angles) in enumerate(zip(of.chains, of.angles, strict=True)):
        alone = {name: chain.line.evaluate(angles, (name,), tolerance=0)[name] for name in MOTION}
        together = chain.line.evaluate(angles, MOTION, tolerance=0)
        for name in MOTION:
            of.judge(f"{kind}, alone", name, i, alone[name])
            of.judge(f"{kind}, together", name, i, together[name])


@kinds
def test_motion_is_faithful_in_batches_and_with_bends_per_sample(kind: str) -> None:
    of = samples(kind)
    for i, (chain, angles) in enumerate(zip(of.chains, of.angles, strict=True)):
        size = len(angles)
        parts = [np.array(part) for part in (chain.bends, chain.twists, chain.phases)]
        other = chain.line.evaluate(angles, MOTION, tolerance=0)
        # Beside a chain of another kind, which must not matter.
        mixed = [np.stack([0.5 * part, part])[:, None] for part in parts]
        batch = Driveline.from_bends(*mixed).evaluate(angles, MOTION, tolerance=0)
        each = [np.repeat(part[None], size, axis=0) for part in parts]
        apart = Driveline.from_bends(*each).evaluate(angles, MOTION, tolerance=0)
        for name in MOTION:
            of.judge(f"{kind}, in a batch", name, i, batch[name][1])
            of.judge(f"{kind}, bends per sample", name, i, apart[name])
            assert other[name].tobytes() == batch[name][1].tobytes()


@kinds
def test_long_sweeps_are_faithful(kind: str) -> None:
    of = samples(kind)
    for chain in of.chains[:4]:
        zero = float(chain.zeros[0])
        sweep = Sweep(zero - 0.2, zero + 0.3, 5000)
        got = chain.line.evaluate(sweep, MOTION, tolerance=0)
        picked = [0, 17, *range(1990, 2010), 4999]
        with mp.workdps(DIGITS):
            start, stop = mp.mpf(zero - 0.2), mp.mpf(zero + 0.3)
            exact = [start + i * (stop - start) / 4999 for i in picked]
            turns = [ExactTurn(x, mp.sin(x), mp.cos(x)) for x in exact]
        for name in ("speed_ratio", "jerk_ratio"):
            with mp.workdps(DIGITS):
                want = Exact.of(getattr(chain.fold, name)(at) for at in turns)
                term = Exact.of(chain.fold.jerk_term(at) for at in turns)
            unit = np.maximum(want.ulp, term.ulp) if name == "jerk_ratio" else want.ulp
            assert (want.distance(got[name][picked]) <= FAITHFUL[name] * unit).all(), chain


def test_a_long_sweep_is_faithful_beside_quarter_turns() -> None:
    """Every 4096th sample is a rounding before or behind one, and its remainder is as small."""
    start, stop = 9 * math.pi, math.pi
    sweep = Sweep(start, stop, 2**16 + 1)
    got = Driveline.from_bends([1.5]).evaluate(sweep, "acceleration_ratio", tolerance=0)
    with mp.workdps(DIGITS):
        exact = [start + i * (mp.mpf(stop) - start) / 16 for i in range(17)]
        turns = [ExactTurn(x, mp.sin(x), mp.cos(x)) for x in exact]
        want = Exact.of(ExactJoint.bent(1.5).acceleration_ratio(at) for at in turns)
        rests = [x - mp.nint(2 * x / mp.pi) * mp.pi / 2 for x in exact]
        ratios = [float(abs(x / rest)) for x, rest in zip(exact, rests, strict=True)]
    # The remainder has the rounding of an angle with error terms.
    unit = want.ulp + np.abs(want.high) * ratios * 2.0**-104
    assert (want.distance(got.acceleration_ratio[::4096]) <= unit).all()


@kinds
def test_tilts_and_swings_are_faithful(kind: str) -> None:
    of = samples(kind)
    rng = np.random.default_rng(5)
    for chain in of.chains:
        last = len(chain.bends) - 1
        with mp.workdps(DIGITS):
            before = chain.before(last)
            rows = (
                (mp.re(before.a + before.b), mp.im(before.b - before.a)),
                (mp.im(before.a + before.b), mp.re(before.a - before.b)),
            )
            zeros = [-mp.atan(cosine / sine) if sine else mp.pi / 2 for cosine, sine in rows]
        angles = [*rng.uniform(-4, 4, 5).tolist(), 0.0]
        for zero in zeros:
            angles += [
                float(zero + 10.0**-d * rng.uniform(0.3, 1)) for d in (1, 3, 5, 7, 9, 12, 40)
            ]
        got = chain.line.evaluate(angles, CROSS, joints=last, tolerance=0)
        exact = []
        with mp.workdps(DIGITS):
            for at in map(ExactTurn.by, angles):
                t1, t2 = before.tilts(chain.bends[last], at)
                ratio = before.speed_ratio(at)
                exact.append((t1, t2, ratio * mp.cos(t1) * mp.tan(t2), -ratio * mp.sin(t1)))
        for name, column in zip(CROSS, zip(*exact, strict=True), strict=True):
            want = Exact.of(column)
            ulps = np.where(np.abs(want.high) > 1e-280, want.ulps(got[name]), 0.0)
            worst = int(ulps.argmax())
            assert ulps[worst] <= FAITHFUL[name], (name, ulps[worst], chain, angles[worst])


@kinds
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9, 1e-14])
def test_every_tolerance_is_kept(kind: str, tolerance: float) -> None:
    of = samples(kind)
    for i, (chain, angles) in enumerate(zip(of.chains, of.angles, strict=True)):
        # Single precision is asked for by the type of the results too.
        single = tolerance == 1e-6
        got = chain.line.evaluate(
            angles,
            MOTION,
            dtype=np.float32 if single else np.float64,
            tolerance=None if single else tolerance,
        )
        with mp.workdps(DIGITS):
            # Joints that compensate each other leave the errors of the joints.
            k = max(chain.fold.k, *(ExactJoint.bent(bend).k for bend in chain.bends))
            gap = chain.fold.complement / abs(chain.fold.a) ** 2 / (1 + k)
            largest = {
                "angle_error": mp.asin(min(k, mp.mpf(1))),
                "speed_ratio": (1 + k) / gap,
                "acceleration_ratio": 2 * k / gap**2,
                "jerk_ratio": 2 * k * (1 + k) / gap**3,
            }
        for name, most in largest.items():
            if not 1e-30 < most < 1e37:
                continue
            error = of.exact(name)[i].distance(got[name].astype(np.float64)) / float(most)
            limit = COARSE.get(name, tolerance) if single else tolerance
            assert error.max() <= limit, (name, error.max(), chain)


def test_steep_chains_carry_error_terms_by_default() -> None:
    for x, terms in ((0.4, False), (0.12, False), (0.09, True), (1e-9, True)):
        line = Driveline.from_bends([math.pi / 2 - x, 0.0], [0.0], [0.3])
        assert ("with error terms" in line.plan("speed_ratio").explain()) == terms
        assert "with error terms" not in line.plan("speed_ratio", shafts=1).explain()


def test_zeros_are_positive() -> None:
    angle = np.array([-2.0, -0.0, 0.0, 0.7, 2.0])
    outputs = ("angle_error", "acceleration_ratio", "jerk_ratio")
    alone = Driveline.from_bends([0.0])
    batch = Driveline.from_bends(np.array([[0.4], [0.0]])[:, None])
    for tolerance in (None, 0, 1e-6):
        for line in (alone, batch):
            result = line.evaluate(angle, outputs, tolerance=tolerance)
            for name in outputs:
                zeros = result[name][result[name] == 0]
                assert zeros.size
                assert not np.signbit(zeros).any(), (name, tolerance)


def test_large_phases_and_twists_keep_their_difference() -> None:
    """The difference of angles of many turns is rounded by far more than a result may be off."""
    rng = np.random.default_rng(3)
    for phase, twist in ((1e12, 0.3), (0.7, -1.1e12), (2.0**40 + 0.1, 1.3), (1e15, 0.2)):
        chain = SteepChain((0.9, 0.7, 0.5), (twist, 0.1), (phase, 0.4))
        angles = rng.uniform(-4, 4, 20).tolist()
        with mp.workdps(DIGITS):
            want = Exact.of(chain.fold.speed_ratio(ExactTurn.by(x)) for x in angles)
        for tolerance in (None, 0):
            got = chain.line.evaluate(angles, "speed_ratio", tolerance=tolerance).speed_ratio
            assert want.distance(got).max() < 1e-14


@pytest.mark.parametrize("case", read("worst_chains.json")["cases"], ids=lambda c: len(c["bends"]))
def test_angles_that_are_less_than_the_angle_error(case: dict[str, Any]) -> None:
    """The worst that cardan-stress found: drive angle and angle error cancel to a fifth."""
    chain = SteepChain(*(tuple(case[name]) for name in ("bends", "twists", "phases")))
    with mp.workdps(DIGITS):
        want = Exact.of([chain.fold.angle(ExactTurn.by(case["angle"]))])
    got = chain.line.evaluate([case["angle"]], ("angle", "angle_error"), tolerance=0)
    assert want.distance(got.angle).max() <= limits("tolerance_0_chain")["angle"] * want.ulp[0]
    assert 3.0 < abs(got.angle_error[0] / got.angle[0]) < 5.0
