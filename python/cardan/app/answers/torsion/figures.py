"""Torsional vibration of a scene: modes, critical speeds, response over speed, what it means."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.rows import Judged, count, figure, flag, item, numbers, parts, word
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.torsion import TorsionCase
from cardan.arrays import FloatArray
from cardan.torsion import SteadyState
from cardan.torsion.analyses import ranges

TorsionVerdict = Literal["unstable", "reversing", "resonant", "clear"]
"""The worst of what happens in the speed range, from the worst to the best.

``reversing``: the torque of a shaft changes its sign though its mean is not 0. ``resonant``: a
critical speed lies in the range.
"""

# Amplitudes below this share of the largest torque are rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class SpeedRange:
    """A range of drive speeds."""

    start: float = figure("from", "rpm")
    stop: float = figure("to", "rpm")


@dataclass(frozen=True)
class Unstable(SpeedRange):
    """Speeds at which small deviations from the periodic motion grow."""

    multiplier: float = figure("growth in half a turn", meaning="at most")


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
    shares: tuple[Share, ...] = parts("Shares in the energy of twist")


@dataclass(frozen=True)
class CriticalSpeed:
    """A drive speed at which an order meets a natural frequency."""

    mode: int = count("mode", "number of the natural frequency, the lowest being 0")
    order: int = count("order", "of the drive's rotation; joints excite even ones")
    speed: float = figure("drive speed", "rpm", source="natural frequency over the order")
    shaft: int = count("shaft twisted most")
    inside: bool = flag("in the range", "whether it lies in the speed range of the scene")
    amplitude: float | None = figure(
        "amplitude",
        "Nm",
        "of this order of the torque of the shaft; null without a periodic motion",
    )

    @property
    def is_excited(self) -> bool:
        """Whether joints excite its order."""
        return self.order % 2 == 0


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
class Motions:
    """The periodic motions that a search found at one drive speed."""

    speed: float = figure("drive speed", "rpm")
    number: int = count("motions")
    stable: int = count("stable motions")
    shaft: int = count("shaft with the largest torque")
    smallest: float = figure("least of their largest torques", "Nm")
    largest: float = figure("largest of their largest torques", "Nm")


@dataclass(frozen=True, eq=False)
class OrderResponse:
    """The amplitudes of one order of a torque."""

    order: int = item("order")
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


@dataclass(frozen=True, eq=False)
class TorsionBasics:
    """What needs no search for periodic motions; ``torsion`` is the system of the scene."""

    torsion: TorsionCase
    margin: Judged = figure(
        "distance of the nearest critical speed",
        "percent",
        "of an even order, from the speed range in shares of the critical speed; 0 within it",
        source="D. Thoma, 1920: joints bring new critical speeds",
        limit="[torsion] resonance_margin",
    )
    without_effect: float | None = figure(
        "inertia without effect", "kgm2", "at the drive, which is held at constant speed"
    )
    speed_range: SpeedRange = parts("Speed range", "of the scene")
    modes: tuple[Mode, ...] = parts("Natural frequencies")
    critical_speeds: tuple[CriticalSpeed, ...] = parts("Critical speeds")
    rules: tuple[BendRule, ...] = parts(
        "Bends", "first region of the Whittaker-Hill equation, one compliant shaft"
    )

    @property
    def resonances(self) -> list[CriticalSpeed]:
        """The critical speeds within the speed range that the joints excite."""
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
    modes = tuple(
        Mode(
            number,
            mode.frequency,
            mode.damping_ratio,
            mode.shaft,
            tuple(map(Share, system.compliant, mode.shares)),
        )
        for number, mode in enumerate(system.modes())
    )
    rules = tuple(
        BendRule(
            rule.shaft,
            rule.bend,
            rule.factor,
            rule.damping_ratio,
            rule.exceeded,
            rule.speed,
            rule.edges[0] <= high and rule.edges[1] >= low,
        )
        for rule in system.bend_rules()
    )
    critical_speeds = tuple(
        CriticalSpeed(
            mode.number,
            order,
            speed := mode.frequency / order,
            mode.shaft,
            low <= speed <= high,
            None,
        )
        for order in given.orders
        for mode in modes
    )
    excited = [each.speed for each in critical_speeds if each.order % 2 == 0]
    margin = Judged(None, given.margin, sense="least", why="[torsion] orders lists no even order")
    if excited:
        away = min(max(low - speed, speed - high, 0.0) / speed for speed in excited)
        margin = Judged(away, given.margin, sense="least")
    speeds = SpeedRange(low, high)
    return TorsionBasics(
        given, margin, given.without_effect or None, speeds, modes, critical_speeds, rules
    )


def whole(_: Answer, found: TorsionBasics) -> TorsionFigures:
    """Return the torsional vibration over the speeds of the scene."""
    given, system = found.torsion, found.torsion.system
    response = system.speed_response(given.speed, given.orders)
    speed, steady = response.speed, response.steady
    largest = tuple(
        LargestTorque(
            *(each.shaft, each.speed, each.least, each.most, each.mean),
            tuple(SpeedRange(*ends) for ends in each.reversals),
        )
        for each in response.largest
    )
    known = [torque.size for torque in largest if math.isfinite(torque.size)]
    critical_speeds = tuple(_with_amplitudes(found, _ROUNDING * max(known, default=0.0)))
    unstable = tuple(Unstable(*astuple(each)) for each in system.unstable_ranges(speed))
    missing = tuple(
        Missing(float(speed[first]), float(speed[last]), str(steady.reasons[first]))
        for first, last in ranges(~steady.found)
    )
    verdict: TorsionVerdict = "clear"
    if unstable:
        verdict = "unstable"
    elif any(each.reversals for each in largest):
        verdict = "reversing"
    elif any(each.inside for each in critical_speeds):
        verdict = "resonant"
    basics = replace(found, critical_speeds=critical_speeds)
    searched = list(_worst(basics.resonances, largest, unstable))
    return TorsionFigures(
        **vars(basics),
        speed=speed,
        steady=steady,
        verdict=verdict,
        largest=largest,
        unstable=unstable,
        missing=missing,
        motions=tuple(Motions(*astuple(each)) for each in system.side_by_side(searched)),
        response=_response(speed, steady),
    )


def torsion_figures(scene: Scene) -> TorsionFigures | None:
    """Return the torsional vibration of a scene over its speeds; ``None`` without [torsion]."""
    answer = Answer(scene)
    found = find(answer)
    return None if found is None else whole(answer, found)


def _with_amplitudes(found: TorsionBasics, noise: float) -> Iterator[CriticalSpeed]:
    """The critical speeds with the amplitudes of their orders, which are 0 up to the noise."""
    system = found.torsion.system
    for critical in found.critical_speeds:
        steady = system.steady(critical.speed, critical.order)
        size = float(np.abs(steady.torque_orders[system.compliant.index(critical.shaft), 0]))
        amplitude = None if math.isnan(size) else size if size > noise else 0.0
        yield replace(critical, amplitude=amplitude)


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
