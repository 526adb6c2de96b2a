"""Torsional vibration of a scene: modes, critical speeds, response over speed, what it means."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan._core import critical_speeds
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import listed, quantity
from cardan.app.answers.rows import (
    Judged,
    count,
    figure,
    flag,
    item,
    numbers,
    optional,
    parts,
    taken,
    word,
)
from cardan.app.answers.torsion.search import (
    Search,
    SofterCoupling,
    search_over,
    softer,
    torques_of,
)
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.torsion import Ratings, TorsionCase
from cardan.arrays import FloatArray
from cardan.torsion import SideBySide, SpeedResponse, SteadyState, UnstableRange
from cardan.torsion.analyses import harmonic_orders, has_kinks, located, ranges

TorsionVerdict = Literal["unstable", "runaway", "reversing", "resonant", "clear"]
"""The worst of what happens in the speed range, from the worst to the best.

``runaway``: the torque of a free drive must fall with its speed. ``reversing``: the torque of a
shaft changes its sign though its mean is not 0. ``resonant``: a critical speed lies in the range.
"""

# Amplitudes below this share of the largest torque are rounding.
_ROUNDING = 1e-9

NEGLIGIBLE = 0.01
"""The share of the mean torque of each shaft below which an order in resonance does not count.

With a tenth of the damping it would still be below a tenth.
"""

# What moves less than this share of the largest amplitude of a mode stands still.
_STILL = 0.1
_DIN = "DIN 740-2: frequency factor sqrt(f/10 Hz) above 10 Hz"


@dataclass(frozen=True)
class SpeedRange:
    """A range of drive speeds."""

    start: float = figure("from", "rpm")
    stop: float = figure("to", "rpm")


@dataclass(frozen=True)
class Unstable(SpeedRange):
    """Speeds at which small deviations from the periodic motion grow."""

    multiplier: float = figure(
        "growth in a period", meaning="at most; half a turn with joints alone, two with half orders"
    )


@dataclass(frozen=True)
class Runaway(SpeedRange):
    """Speeds from which a drive of constant torque runs away."""

    needed_slope: float = figure(
        "needed slope",
        "Nms_per_rad",
        "by more than this the torque of the drive must fall with its speed",
        rounds="up",
    )


@dataclass(frozen=True)
class Avoided(SpeedRange):
    """Speeds at which something is beyond what is permitted."""

    reason: str = word("reason")


@dataclass(frozen=True)
class Missing(SpeedRange):
    """Speeds at which no periodic motion was found."""

    reason: str = word("reason")


@dataclass(frozen=True)
class Share:
    """The part of a compliant shaft in the energy of twist."""

    shaft: int = item("shaft")
    share: float = figure("share in the energy of twist", "percent", digits="share")


@dataclass(frozen=True)
class Mode:
    """A natural frequency of the mean system."""

    number: int = item("mode")
    frequency: float = figure("natural frequency", "Hz", source="of the mean system")
    damping_ratio: float = figure("damping ratio", source="w/2 sum(share d/c)")
    shaft: int = count("shaft twisted most")
    shape: str = word("shape", "which shafts move most, and against what they turn", is_detail=True)
    shares: tuple[Share, ...] = parts("Shares in the energy of twist")


@dataclass(frozen=True)
class CriticalSpeed:
    """A drive speed at which an order meets a natural frequency."""

    mode: int = count("mode", "number of the natural frequency, the lowest being 0")
    order: float = figure(
        "order", meaning="of the drive's rotation; joints excite even ones", digits="given"
    )
    speed: float = figure("drive speed", "rpm", source="natural frequency over the order")
    shaft: int = count("shaft", "that is twisted most")
    inside: bool = flag("in the range", "whether it lies in the speed range of the scene")
    amplitude: float | None = figure(
        "amplitude",
        "Nm",
        "of this order of the torque of the shaft; null without a periodic motion",
    )
    excited_by: Literal["joints", "torques", "both", "nothing"] = word(
        "excited by",
        "what has this order: joints, torques of [[torsion.harmonic]], both or nothing",
    )
    negligible: bool = flag(
        "negligible",
        "whether this order is known to be below 1 % of the mean torque of each shaft",
        is_detail=True,
    )

    @property
    def is_excited(self) -> bool:
        """Whether joints or harmonic torques excite its order."""
        return self.excited_by != "nothing"


@dataclass(frozen=True)
class BendRule:
    """Whether the bend behind a compliant shaft permits unstable motion."""

    shaft: int = item("shaft")
    bend: float = figure("equivalent bend behind it", "deg", "up to the next compliant shaft")
    factor: float = figure("factor", source="tan²(bend/2)", apart="damping_ratio")
    damping_ratio: float = figure(
        "damping ratio", meaning="of the mode in which it is twisted most"
    )
    exceeded: bool = flag(
        "exceeded", "whether the factor exceeds the damping ratio: unstable motion is possible"
    )
    speed: float = figure(
        "around the speed", "rpm", "of the drive, at which unstable motion is possible"
    )
    inside: bool = flag("in the speed range", "whether these speeds overlap the speed range")


@dataclass(frozen=True)
class LargestTorque:
    """The largest torque of one shaft over the speed range.

    In a resonance without damping, where there is no periodic motion, it is infinite.
    """

    shaft: int = item("shaft")
    speed: float = figure("at the drive speed", "rpm")
    least: float = figure("least torque", "Nm", "over the turn at that speed")
    most: float = figure("largest torque", "Nm", "over the turn at that speed")
    mean: float = figure("mean torque", "Nm", "over the turn at that speed")
    reversals: tuple[SpeedRange, ...] = parts(
        "Reversals",
        "speeds between which the torque changes its sign though its mean is not 0",
        is_detail=True,
    )

    @property
    def size(self) -> float:
        """The largest magnitude in N m."""
        return max(abs(self.least), abs(self.most))


@dataclass(frozen=True)
class Motion:
    """One of the periodic motions at one drive speed."""

    size: float = figure("largest torque", "Nm", "of the shaft")
    stable: bool = flag("stable")


@dataclass(frozen=True)
class Motions:
    """The periodic motions that a search found at one drive speed."""

    speed: float = figure("drive speed", "rpm")
    number: int = count("motions")
    stable: int = count("stable motions")
    shaft: int = count("shaft with the largest torque")
    smallest: float = figure("least of their largest torques", "Nm")
    largest: float = figure("largest of their largest torques", "Nm")
    each: tuple[Motion, ...] = parts("Each motion", is_detail=True)


@dataclass(frozen=True, eq=False)
class OrderResponse:
    """The amplitudes of one order of a torque."""

    order: float = figure("order", digits="given")
    amplitude: FloatArray = numbers("amplitude", "Nm")


@dataclass(frozen=True, eq=False)
class ShaftResponse:
    """The torque of one shaft at each speed of the response."""

    shaft: int = item("shaft")
    mean: FloatArray = numbers("mean torque", "Nm")
    least: FloatArray = numbers("least torque", "Nm")
    largest: FloatArray = numbers("largest torque", "Nm")
    orders: tuple[OrderResponse, ...] = parts("Orders")


@dataclass(frozen=True, eq=False)
class Response:
    """The periodic motion over the speed."""

    speed: FloatArray = numbers("drive speed", "rpm")
    shafts: tuple[ShaftResponse, ...] = parts("Shafts")


@dataclass(frozen=True)
class CouplingTorques:
    """The torques of a coupling over the speed range, beside its ratings."""

    shaft: int = item("shaft")
    mean: Judged = figure(
        "mean torque in the coupling", "Nm", limit="[torsion] coupling.rated_torque_Nm"
    )
    vibratory: Judged = figure(
        "vibratory torque at 10 Hz in the coupling",
        "Nm",
        "half of largest less least torque, as if at 10 Hz: by the frequency of the largest order",
        source=_DIN,
        limit="[torsion] coupling.vibratory_torque_Nm",
    )
    largest: Judged = figure(
        "largest torque in the coupling",
        "Nm",
        "at any instant",
        limit="[torsion] coupling.largest_torque_Nm",
    )
    factor: float | None = figure(
        "least factor",
        meaning="rating over torque, of the one nearest to its rating",
        rounds="down",
    )
    mean_speed: float | None = figure("speed of the mean torque", "rpm", is_detail=True)
    vibratory_speed: float | None = figure("speed of the vibratory torque", "rpm", is_detail=True)
    largest_speed: float | None = figure("speed of the largest torque", "rpm", is_detail=True)


@dataclass(frozen=True)
class RunningSpeed:
    """A speed at which the motor of the scene drives what it is needed for."""

    speed: float = figure("drive speed", "rpm")
    torque: float = figure("mean torque", "Nm")
    slope: float = figure(
        "slope of the motor", "Nms_per_rad", "how much its torque falls with rising speed"
    )
    torque_slope: float = figure(
        "slope of the driveline", "Nms_per_rad", "what it needs more with its speed"
    )
    stable: bool = flag("stable", "whether speed and vibration return after a disturbance")


@dataclass(frozen=True, eq=False)
class TorsionBasics:
    """Figures of a check; ``torsion`` is the system of the scene.

    A search over the speeds is made of a scene with a free drive, harmonic torques, couplings or
    limits that need it. It is ``None`` of others.
    """

    torsion: TorsionCase
    search: Search | None
    margin: Judged = figure(
        "distance of the nearest critical speed",
        "percent",
        "of an order that joints or harmonic torques excite, from the speed range in shares of the "
        "critical speed; 0 within it. Negligible ones do not count",
        source="D. Thoma, 1920: joints bring new critical speeds",
        limit="[torsion] resonance_margin",
        at_zero="within the speed range",
    )
    unstable_share: Judged | None = figure(
        "share of unstable speeds",
        "percent",
        "of the speed range, in which vibration grows by itself or the speed runs away from the "
        "slope of the drive",
        source="Floquet multipliers of the periodic motion",
        limit="[torsion] unstable_percent",
    )
    rattle_share: Judged | None = figure(
        "share of rattling speeds",
        "percent",
        "of the speed range, in which the torque of a shaft changes its sign though its mean is "
        "not 0, or flanks come apart",
        limit="[torsion] rattle_percent",
    )
    without_effect: float | None = figure(
        "inertia without effect", "kgm2", "at the drive, which is held at constant speed"
    )
    speed_range: SpeedRange = parts("Speed range", "of the scene")
    running: tuple[RunningSpeed, ...] = optional(
        parts("Running speeds", "at which the torque of the motor is what is needed")
    )
    modes: tuple[Mode, ...] = parts("Natural frequencies")
    critical_speeds: tuple[CriticalSpeed, ...] = parts("Critical speeds")
    rules: tuple[BendRule, ...] = parts(
        "Bends", "first region of the Whittaker-Hill equation, one compliant shaft"
    )
    couplings: tuple[CouplingTorques, ...] = optional(parts("Couplings"))
    avoided: tuple[Avoided, ...] = optional(
        parts("Speeds to avoid", "at which something is beyond what is permitted", is_detail=True)
    )
    softer: tuple[SofterCoupling, ...] = optional(
        parts("Softer couplings", "which put a resonance below the speeds of the scene")
    )

    @property
    def resonances(self) -> list[CriticalSpeed]:
        """The critical speeds within the speed range that joints or harmonic torques excite."""
        return [each for each in self.critical_speeds if each.inside and each.is_excited]


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsionFigures(TorsionBasics):
    """The torsional vibration of a scene.

    ``speed`` are the drive speeds in rad/s of the motions ``steady``: those of the scene, and more
    near resonances.
    """

    speed: FloatArray
    steady: SteadyState
    verdict: TorsionVerdict = word(
        "verdict", "the worst of what happens in the speed range", is_detail=True
    )
    largest: tuple[LargestTorque, ...] = parts("Largest torques", "of each compliant shaft")
    unstable: tuple[Unstable, ...] = parts("Unstable motion")
    runaway: tuple[Runaway, ...] = parts(
        "Speed that runs away", "of a free drive; beyond resonances the torque falls with the speed"
    )
    missing: tuple[Missing, ...] = parts("Speeds without a periodic motion")
    motions: tuple[Motions, ...] = parts(
        "Periodic motions",
        "at the worst critical speed, at the speed of the largest torque and amid the most "
        "unstable range; the response has one at each speed",
    )
    response: Response = parts("Response over the speed", is_detail=True)


def find(answer: Answer) -> TorsionBasics | None:
    """Return what a check says of a scene's torsional vibration; ``None`` without [torsion]."""
    given = answer.scene.torsion
    if given is None:
        return None
    system, low, high = given.system, float(given.speed[0]), float(given.speed[-1])
    bodies = bodies_of(given)
    modes = tuple(
        taken(
            *(Mode, mode),
            number=number,
            shape=shape_text(mode.shape, bodies, is_free=system.free),
            shares=tuple(map(Share, system.compliant, mode.shares)),
        )
        for number, mode in enumerate(system.modes())
    )
    rules = tuple(
        taken(BendRule, rule, inside=rule.edges[0] <= high and rule.edges[1] >= low)
        for rule in system.bend_rules()
    )
    frequencies = [mode.frequency for mode in modes]
    orders = [(order, order in given.excited) for order in given.orders]
    at, away, _ = critical_speeds(frequencies, orders, (low, high))
    if system.stiffness_follows_speed:
        # The stiffnesses differ from speed to speed, so each critical speed has its own frequency.
        own = [
            critical_speeds((order * speeds).tolist(), [(order, excited)], (low, high))
            for (order, excited), speeds in zip(
                orders, system.critical_speeds(given.orders).T, strict=True
            )
        ]
        at = [speed for speeds, _, _ in own for speed in speeds]
        away = [distance for _, distances, _ in own for distance in distances]
    met = [(order, mode) for order in given.orders for mode in modes]
    by = {order: _excited_by(given, order) for order in given.orders}
    critical = tuple(
        CriticalSpeed(
            *(mode.number, order, speed, mode.shaft, not distance, None, by[order]),
            negligible=False,
        )
        for (order, mode), speed, distance in zip(met, at, away, strict=True)
    )
    search = search_over(given) if given.is_searched else None
    if search:
        critical = _with_amplitudes(given, critical, search)
    running = system.running_speeds(*given.motor) if given.motor else ()
    unstable_share = rattle_share = None
    if search:
        unstable = [each for each in search.unstable if _is_unstable(given, each)]
        grows = [(each.start, each.stop) for each in unstable]
        reverses = [ends for each in search.response.largest for ends in each.reversals]
        unstable_share = _share(given, search, grows, given.unstable)
        rattle_share = _share(given, search, reverses, given.rattle)
    return TorsionBasics(
        torsion=given,
        search=search,
        margin=_margin(given, critical, away),
        without_effect=given.without_effect or None,
        speed_range=SpeedRange(low, high),
        running=tuple(taken(RunningSpeed, each) for each in running),
        modes=modes,
        critical_speeds=critical,
        rules=rules,
        unstable_share=unstable_share,
        rattle_share=rattle_share,
        couplings=tuple(_couplings(given, search)) if search else (),
        avoided=tuple(_avoided(given, search)) if search else (),
        softer=tuple(softer(given, search)) if search and not has_kinks(system) else (),
    )


def _margin(given: TorsionCase, critical: Sequence[CriticalSpeed], away: Sequence[float]) -> Judged:
    """The distance of the nearest critical speed, of several in the range that of the largest."""
    excited = [
        (distance, each)
        for distance, each in zip(away, critical, strict=True)
        if each.is_excited and not each.negligible
    ]
    if not excited:
        why = "[torsion] orders lists no even order"
        if any(each.is_excited for each in critical):
            why = f"no order reaches {quantity(NEGLIGIBLE, 'percent')} of the mean torque"
        return Judged(None, given.margin, sense="least", why=why)

    def rank(found: tuple[float, CriticalSpeed]) -> tuple[float, float]:
        amplitude = found[1].amplitude
        return found[0], -math.inf if amplitude is None else -amplitude

    distance, nearest = min(excited, key=rank)
    where = f"at {quantity(nearest.speed, 'rpm')} (order {nearest.order:g})"
    return Judged(distance, given.margin, sense="least", state=where)


def whole(_: Answer, found: TorsionBasics) -> TorsionFigures:
    """Return the torsional vibration over the speeds of the scene."""
    given, system = found.torsion, found.torsion.system
    search = found.search or search_over(given)
    response = search.response
    largest = largest_of(search)
    critical_speeds = found.critical_speeds
    if found.search is None:
        # The check knew no amplitudes, so all critical speeds count in its margin.
        critical_speeds = tuple(
            replace(each, negligible=False)
            for each in _with_amplitudes(found.torsion, critical_speeds, search)
        )
    unstable = tuple(taken(Unstable, each) for each in search.unstable if not each.runs_away)
    runaway = runaway_of(search)
    happens: dict[TorsionVerdict, bool] = {
        "unstable": bool(unstable),
        "runaway": bool(runaway),
        "reversing": any(each.reversals for each in largest),
        "resonant": any(each.inside for each in critical_speeds),
        "clear": True,
    }
    verdict = next(word for word, is_so in happens.items() if is_so)
    basics = replace(found, search=search, critical_speeds=critical_speeds)
    searched = list(_worst(basics.resonances, largest, unstable))
    return TorsionFigures(
        **vars(basics),
        speed=response.speed,
        steady=response.steady,
        verdict=verdict,
        largest=largest,
        unstable=unstable,
        runaway=runaway,
        missing=tuple(missing_of(response)),
        motions=tuple(motions_of(each) for each in system.side_by_side(searched)),
        response=_response(response.speed, response.steady),
    )


def motions_of(found: SideBySide) -> Motions:
    """Return the periodic motions at one speed."""
    each = tuple(map(Motion, found.sizes, found.stables))
    return taken(Motions, found, number=found.count, each=each)


def torsion_figures(scene: Scene) -> TorsionFigures | None:
    """Return the torsional vibration of a scene over its speeds; ``None`` without [torsion]."""
    answer = Answer(scene)
    found = find(answer)
    return None if found is None else whole(answer, found)


def _excited_by(
    given: TorsionCase, order: float
) -> Literal["joints", "torques", "both", "nothing"]:
    of_torques = order in harmonic_orders(given.system)
    if order % 2.0 == 0.0:
        return "both" if of_torques else "joints"
    return "torques" if of_torques else "nothing"


def largest_of(search: Search) -> tuple[LargestTorque, ...]:
    """Return the largest torque of each compliant shaft."""
    return tuple(
        taken(LargestTorque, each, reversals=tuple(SpeedRange(*ends) for ends in each.reversals))
        for each in search.response.largest
    )


def runaway_of(search: Search) -> tuple[Runaway, ...]:
    """Return the ranges of speeds from which a drive of constant torque runs away."""
    return tuple(taken(Runaway, each) for each in search.unstable if each.runs_away)


def missing_of(response: SpeedResponse) -> Iterator[Missing]:
    """Yield the ranges of speeds without a periodic motion."""
    speed, steady = response.speed, response.steady
    for first, last in ranges(~steady.found):
        yield Missing(float(speed[first]), float(speed[last]), str(steady.reasons[first]))


def bodies_of(given: TorsionCase) -> list[tuple[list[tuple[int, int]], str]]:
    """Return what moves as one between compliant shafts: the shaft ends, and what to call it.

    What is before a compliant shaft 0 is the drive. Any other body is called by the shaft with the
    largest inertia in it; two bodies of the same shaft are its ends.
    """
    system, inertias = given.system, given.system.inertias
    bodies: list[list[tuple[int, int]]] = [[]]
    for shaft in range(system.line.n_joints + 1):
        bodies[-1].append((shaft, 0))
        if shaft in system.compliant:
            bodies.append([])
        bodies[-1].append((shaft, 1))
    largest = [max(body, key=lambda end: float(inertias[end])) for body in bodies]
    shafts = [shaft for shaft, _ in largest]
    called = []
    for body, (shaft, end) in zip(bodies, largest, strict=True):
        name = f"the {given.names[shaft]}" if given.names else f"shaft {shaft}"
        if body == [(0, 0)]:
            name = "the drive"
        elif shafts.count(shaft) > 1:
            # A name is that of the whole shaft.
            own = f"shaft {shaft} ({given.names[shaft]})" if given.names else name
            name = f"the {'output' if end else 'input'} end of {own}"
        called.append((body, name))
    return called


def shape_text(
    shape: Sequence[Sequence[float]],
    bodies: Sequence[tuple[Sequence[tuple[int, int]], str]],
    *,
    is_free: bool,
) -> str:
    """Return which bodies move against which in a mode: ``"the propeller against the rest"``."""
    sizes = [shape[body[0][0]][body[0][1]] for body, _ in bodies]
    moving = [i for i, size in enumerate(sizes) if abs(size) >= _STILL]
    sides = [[i for i in moving if sizes[i] * sign > 0.0] for sign in (1.0, -1.0)]
    fewest = min(
        filter(None, sides), key=lambda side: (len(side), -max(abs(sizes[i]) for i in side))
    )
    others = [i for i in range(len(bodies)) if i not in fewest and (is_free or i)]
    rest = "the rest" if len(others) > 1 else "the drive" if not others else bodies[others[0]][1]
    if not is_free and not (sides[0] and sides[1]):
        rest = "the drive"
    return f"{listed([bodies[i][1] for i in fewest])} against {rest}"


def judged_at(
    value: float, at: float, limit: float | None, missing: Sequence[Missing], size: float = 0.0
) -> Judged:
    """Return a figure with the speed at which it is worst, not judged if it may be worse."""
    found = Judged(value, limit, size=size, state=f"at {quantity(at, 'rpm')}" if at else "")
    if missing and found.verdict == "within":
        start = quantity(missing[0].start, "rpm")
        why = f"no periodic motion was found at {start}"
        return replace(found, why=why, may_be_worse=True)
    return found


def _share(
    given: TorsionCase,
    search: Search,
    parts: Sequence[tuple[float, float]],
    limit: float | None,
) -> Judged:
    """The share of the speed range that is in any of some ranges."""
    covered, reached = 0.0, -math.inf
    for start, stop in sorted(parts):
        covered += max(stop, reached) - max(start, reached)
        reached = max(stop, reached)
    share = covered / float(given.speed[-1] - given.speed[0])
    return judged_at(share, 0.0, limit, [*missing_of(search.response)], 1.0)


def _is_unstable(given: TorsionCase, part: UnstableRange) -> bool:
    """Whether a range is one for the drive of the scene; one without a slope is governed."""
    return not part.runs_away or given.system.drive_slope > 0.0


def _limits(rated: Ratings) -> tuple[float | None, float | None, float | None]:
    """The limits of mean, vibratory and largest torque."""
    return rated.rated, rated.vibratory, rated.largest


def _couplings(given: TorsionCase, search: Search) -> Iterator[CouplingTorques]:
    """The torques of couplings with their ratings; without a periodic motion they are not known."""
    system, response = given.system, search.response
    missing = [*missing_of(response)]
    largest_torques = {each.shaft: each for each in response.largest}
    for shaft, rated in given.ratings.items():
        place, largest = system.compliant.index(shaft), largest_torques.get(shaft)
        if largest is None:
            why = f"no periodic motion was found: {missing[0].reason}"
            rows = [Judged(None, limit, why=why) for limit in _limits(rated)]
            yield CouplingTorques(shaft, rows[0], rows[1], rows[2], None, None, None, None)
            continue
        mean, vibratory, _ = torques_of(place)
        means = mean(response.speed, response.steady)
        best = int(np.nanargmax(means))
        found = [(float(means[best]), float(response.speed[best]))]
        rounds = (0,) if has_kinks(system) else ()
        at, steady, best = located(system, response.speed, response.steady, vibratory, *rounds)
        found.append((float(vibratory(at, steady)[best]), float(at[best])))
        found.append((max(abs(largest.least), abs(largest.most)), largest.speed))
        if math.isinf(largest.most):
            found[1] = found[2]
        rows = [
            judged_at(value, speed, limit, missing)
            for (value, speed), limit in zip(found, _limits(rated), strict=True)
        ]
        factors = [
            each.limit / each.value for each in rows if each.limit is not None and each.value
        ]
        speeds = [speed for _, speed in found]
        factor = min(factors, default=None)
        yield CouplingTorques(shaft, rows[0], rows[1], rows[2], factor, *speeds)


def _avoided(given: TorsionCase, search: Search) -> Iterator[Avoided]:
    """The speeds at which a coupling is overloaded, motion is unstable or the torque reverses."""
    speed, steady = search.response.speed, search.response.steady
    words = ("mean", "vibratory", "largest")
    for shaft, rated in given.ratings.items():
        place = given.system.compliant.index(shaft)
        for what, value, limit in zip(words, torques_of(place), _limits(rated), strict=True):
            if limit is None:
                continue
            over = np.nan_to_num(value(speed, steady) - limit, nan=-limit)
            for first, last in ranges(over > _ROUNDING * limit):
                ends = (_end(speed, over, first, -1), _end(speed, over, last, 1))
                yield Avoided(
                    *ends, f"the {what} torque in the coupling of shaft {shaft} is above its rating"
                )
    for part in search.unstable:
        if _is_unstable(given, part):
            reason = "the speed runs away" if part.runs_away else "vibration grows by itself"
            yield Avoided(part.start, part.stop, reason)
    for torque in search.response.largest if given.rattle is not None else ():
        for start, stop in torque.reversals:
            yield Avoided(start, stop, f"the torque of shaft {torque.shaft} changes its sign")


def _end(speed: FloatArray, over: FloatArray, place: int, step: int) -> float:
    """The speed at which a value passes 0 beside a place, on a straight line."""
    beside = place + step
    if not 0 <= beside < len(speed):
        return float(speed[place])
    share = over[place] / (over[place] - over[beside])
    return float(speed[place] + share * (speed[beside] - speed[place]))


def _with_amplitudes(
    given: TorsionCase, critical_speeds: Sequence[CriticalSpeed], search: Search
) -> tuple[CriticalSpeed, ...]:
    """The critical speeds with the amplitudes of their orders, which are 0 up to the noise."""
    system, found = given.system, []
    known = [torque.size for torque in largest_of(search) if math.isfinite(torque.size)]
    noise = _ROUNDING * max(known, default=0.0)
    for critical in critical_speeds:
        steady = system.steady(critical.speed, critical.order)
        sizes = np.abs(steady.torque_orders[:, 0])
        size = float(sizes[system.compliant.index(critical.shaft)])
        amplitude = None if math.isnan(size) else size if size > noise else 0.0
        # Of an unknown motion nothing is small, and of an unstable one it does not stay so.
        is_small = bool(np.all(sizes < NEGLIGIBLE * np.abs(steady.torque_mean)))
        negligible = is_small and not any(
            part.start <= critical.speed <= part.stop and not part.runs_away
            for part in search.unstable
        )
        found.append(replace(critical, amplitude=amplitude, negligible=negligible))
    return tuple(found)


def _response(speed: FloatArray, steady: SteadyState) -> Response:
    shafts = (
        ShaftResponse(
            shaft,
            steady.torque_mean[place],
            steady.torque_min[place],
            steady.torque_max[place],
            tuple(
                map(OrderResponse, steady.orders.tolist(), np.abs(steady.torque_orders[place]).T)
            ),
        )
        for place, shaft in enumerate(steady.compliant)
    )
    return Response(speed, tuple(shafts))


def _worst(
    resonances: Sequence[CriticalSpeed],
    largest: Sequence[LargestTorque],
    regions: Sequence[Unstable],
) -> Iterator[float]:
    """The worst critical speed, that of the largest torque, and amid the most unstable range.

    There are no more than these, because a search takes seconds with eight compliant shafts.
    """
    if resonances:
        yield max(resonances, key=lambda part: part.amplitude or 0.0).speed
    if largest:
        yield max(largest, key=lambda part: part.size).speed
    if regions:
        region = max(regions, key=lambda part: part.multiplier)
        yield 0.5 * (region.start + region.stop)
