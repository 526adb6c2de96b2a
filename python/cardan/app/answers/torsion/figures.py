"""Torsional vibration of a scene: modes, critical speeds, response over speed, what it means."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of, schema_of
from cardan.app.answers.json_schema import answer, answer_schema
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

# Speeds on each side of a critical speed that are added to those of the scene, and how far they
# reach in shares of it.
_NEAR, _REACH = 20, 0.1

# Rounds in which the largest torque is located, each with so many speeds.
_ROUNDS, _EACH = 5, 9


@dataclass(frozen=True)
class SpeedRange:
    """A range of drive speeds."""

    start: float = figure("from", "rpm")
    stop: float = figure("to", "rpm")


@dataclass(frozen=True)
class Unstable(SpeedRange):
    """Speeds at which small deviations from the periodic motion grow."""

    multiplier: float = figure("growth", meaning="by how much at most in half a turn")


@dataclass(frozen=True)
class Missing(SpeedRange):
    """Speeds at which no periodic motion was found."""

    reason: str = word("reason")


@dataclass(frozen=True)
class Share:
    """The part of a compliant shaft in the energy of twist."""

    shaft: int = item("shaft")
    share: float = figure("share in the energy of twist", "percent")


@dataclass(frozen=True)
class Mode:
    """A natural frequency of the mean system."""

    number: int = item("mode")
    frequency: float = figure("natural frequency", "Hz", source="of the mean system")
    damping_ratio: float = figure("damping ratio", source="w/2 sum(share d/c)")
    shaft: int = count("shaft that is twisted most")
    shares: tuple[Share, ...] = parts("Shares in the energy of twist")


@dataclass(frozen=True)
class CriticalSpeed:
    """A drive speed at which an order meets a natural frequency."""

    mode: int = count("mode", "number of the natural frequency, the lowest being 0")
    order: int = count("order", "of the drive's rotation; joints excite even ones")
    speed: float = figure("drive speed", "rpm", source="natural frequency over the order")
    shaft: int = count("shaft that is twisted most")
    inside: bool = flag("inside", "whether it lies in the speed range of the scene")
    amplitude: float | None = figure(
        "amplitude",
        "Nm",
        "of this order of the torque of the shaft; null without a periodic motion",
    )


@dataclass(frozen=True)
class BendRule:
    """Whether the bend behind a compliant shaft permits unstable motion."""

    shaft: int = item("shaft")
    bend: float = figure("equivalent bend behind it", "deg", "up to the next compliant shaft")
    factor: float = figure("factor", source="tan²(bend/2)")
    damping_ratio: float = figure(
        "damping ratio", meaning="of the mode in which it is twisted most"
    )
    exceeded: bool = flag(
        "exceeded", "whether the factor exceeds the damping ratio: unstable motion is possible"
    )
    speed: float = figure(
        "around the speed", "rpm", "of the drive, at which unstable motion is possible"
    )
    inside: bool = flag("inside", "whether these speeds overlap the speed range")


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
        "Reversals", "speeds between which the torque changes its sign though its mean is not 0"
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


@dataclass(frozen=True)
class OrderResponse:
    """The amplitudes of one order of a torque."""

    order: int = item("order")
    amplitude: tuple[float, ...] = numbers("amplitude", "Nm")


@dataclass(frozen=True)
class ShaftResponse:
    """The torque of one shaft at each speed of the response."""

    shaft: int = item("shaft")
    mean: tuple[float, ...] = numbers("mean torque", "Nm")
    least: tuple[float, ...] = numbers("least torque", "Nm")
    largest: tuple[float, ...] = numbers("largest torque", "Nm")
    orders: tuple[OrderResponse, ...] = parts("Orders")


@dataclass(frozen=True)
class Response:
    """The periodic motion over the speed."""

    speed: tuple[float, ...] = numbers("drive speed", "rpm")
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
    speed_range: SpeedRange = parts("Speed range", "of the scene")
    modes: tuple[Mode, ...] = parts("Natural frequencies")
    critical_speeds: tuple[CriticalSpeed, ...] = parts("Critical speeds")
    rules: tuple[BendRule, ...] = parts(
        "Bends", "first region of the Whittaker-Hill equation, one compliant shaft"
    )

    def is_inside(self, speed: float) -> bool:
        """Whether a speed lies in the range of the scene."""
        return self.speed_range.start <= speed <= self.speed_range.stop


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsionFigures(TorsionBasics):
    """The torsional vibration of a scene.

    ``speed`` are the drive speeds in rad/s of the motions ``steady``: those of the scene, and more
    near resonances.
    """

    speed: FloatArray
    steady: SteadyState
    verdict: TorsionVerdict = word("verdict", "the worst of what happens in the speed range")
    largest: tuple[LargestTorque, ...] = parts("Largest torques", "of each compliant shaft")
    unstable: tuple[Unstable, ...] = parts("Unstable motion")
    missing: tuple[Missing, ...] = parts("Speeds without a periodic motion")
    motions: tuple[Motions, ...] = parts(
        "Periodic motions",
        "at the worst critical speed, at the speed of the largest torque and amid the most "
        "unstable range; the response has one at each speed",
    )
    response: Response = parts("Response over the speed")


def find(answer: Answer) -> TorsionBasics | None:
    """Return what a check says of a scene's torsional vibration; ``None`` without [torsion]."""
    return torsion_basics(answer.scene)


def torsion_basics(scene: Scene) -> TorsionBasics | None:
    """Return what needs no search for periodic motions; ``None`` without [torsion]."""
    given = scene.torsion
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
    return TorsionBasics(given, margin, SpeedRange(low, high), modes, critical_speeds, rules)


def torsion_figures(scene: Scene) -> TorsionFigures | None:
    """Return the torsional vibration of a scene over its speeds; ``None`` without [torsion]."""
    basics = torsion_basics(scene)
    if basics is None:
        return None
    given, system = basics.torsion, basics.torsion.system
    speed = _speeds(basics)
    steady = system.steady(speed, given.orders)
    unstable = tuple(
        Unstable(each.start, each.stop, each.multiplier) for each in system.unstable_ranges(speed)
    )
    critical_speeds = tuple(_with_amplitude(given, each) for each in basics.critical_speeds)
    missing = tuple(
        Missing(float(speed[first]), float(speed[last]), str(steady.reasons[first]))
        for first, last in ranges(~steady.found)
    )
    largest = tuple(_largest(basics, critical_speeds, speed, steady))
    verdict: TorsionVerdict = "clear"
    if unstable:
        verdict = "unstable"
    elif any(each.reversals for each in largest):
        verdict = "reversing"
    elif any(each.inside for each in critical_speeds):
        verdict = "resonant"
    searched = list(_worst(critical_speeds, largest, unstable))
    return TorsionFigures(
        given,
        basics.margin,
        basics.speed_range,
        basics.modes,
        critical_speeds,
        basics.rules,
        speed=speed,
        steady=steady,
        verdict=verdict,
        largest=largest,
        unstable=unstable,
        missing=missing,
        motions=tuple(Motions(*astuple(each)) for each in system.side_by_side(searched)),
        response=_response(speed, steady),
    )


def _response(speed: FloatArray, steady: SteadyState) -> Response:
    def listed(values: Any) -> tuple[float, ...]:  # noqa: ANN401 - an array
        return tuple(values.tolist())

    return Response(
        listed(speed),
        tuple(
            ShaftResponse(
                shaft,
                listed(steady.torque_mean[place]),
                listed(steady.torque_min[place]),
                listed(steady.torque_max[place]),
                tuple(
                    OrderResponse(int(order), listed(np.abs(steady.torque_orders[place, :, i])))
                    for i, order in enumerate(steady.orders)
                ),
            )
            for place, shaft in enumerate(steady.compliant)
        ),
    )


def torsion_data(title: str, found: TorsionFigures, files: Sequence[str] = ()) -> dict[str, Any]:
    """Return the torsional vibration of a scene as plain data for JSON.

    Args:
        title: of the scene.
        found: its figures.
        files: what was written.
    """
    return answer("torsion", title, **data_of(found), files=list(files))


def needed_torsion(scene: Scene) -> TorsionFigures:
    """Return the torsional vibration of a scene.

    Raises:
        ValueError: it has no section [torsion].
    """
    found = torsion_figures(scene)
    if found is None:
        raise ValueError(
            f"{scene.name}: section [torsion] is missing; it gives stiffnesses and inertias"
        )
    return found


def _worst(
    critical_speeds: Sequence[CriticalSpeed],
    largest: Sequence[LargestTorque],
    regions: Sequence[Unstable],
) -> Iterator[float]:
    """The worst critical speed, that of the largest torque, and amid the most unstable range.

    There are no more than these, because a search takes seconds with eight compliant shafts.
    """
    inside = [part for part in critical_speeds if part.inside and part.order % 2 == 0]
    if inside:
        yield max(inside, key=lambda part: float(np.nan_to_num(part.amplitude or 0.0))).speed
    if largest:
        yield max(largest, key=lambda part: part.size).speed
    if regions:
        region = max(regions, key=lambda part: part.multiplier)
        yield 0.5 * (region.start + region.stop)


def _speeds(basics: TorsionBasics) -> FloatArray:
    """The speeds of the scene and more around critical speeds, whose peaks may be narrow."""
    given = basics.torsion
    around = [given.speed]
    for critical in basics.critical_speeds:
        if critical.order % 2 == 0:
            # The half-width of a resonance is its damping ratio.
            ratio = basics.modes[critical.mode].damping_ratio
            least = min(max(0.25 * ratio, 1e-4), 0.5 * _REACH)
            away = np.geomspace(least, _REACH, _NEAR)
            around.append(critical.speed * (1.0 + np.concatenate([-away, [0.0], away])))
    speeds = np.unique(np.concatenate(around))
    inside = (speeds >= given.speed[0]) & (speeds <= given.speed[-1])
    return np.asarray(speeds[inside], dtype=np.float64)


def _with_amplitude(given: TorsionCase, critical: CriticalSpeed) -> CriticalSpeed:
    found = given.system.steady(critical.speed, critical.order)
    place = given.system.compliant.index(critical.shaft)
    return replace(critical, amplitude=float(np.abs(found.torque_orders[place, 0])))


def is_unknown(critical: CriticalSpeed) -> bool:
    """Return whether there is no periodic motion at a critical speed."""
    return critical.amplitude is None or math.isnan(critical.amplitude)


def _largest(
    basics: TorsionBasics,
    critical_speeds: Sequence[CriticalSpeed],
    speed: FloatArray,
    response: SteadyState,
) -> Iterator[LargestTorque]:
    given = basics.torsion
    damped = bool(given.system.load_damping > 0.0) or bool(np.any(given.system.dampings > 0.0))
    for place, shaft in enumerate(given.system.compliant):
        reversals = tuple(_reversals(speed, response, place))
        unlimited = [
            critical.speed
            for critical in critical_speeds
            if critical.inside and is_unknown(critical) and not damped
        ]
        if unlimited:
            yield LargestTorque(shaft, unlimited[0], -math.inf, math.inf, math.nan, reversals)
        elif np.any(response.found):
            at, found, best = _located(given, place, speed, response)
            ends = (found.torque_min, found.torque_max, found.torque_mean)
            least, most, mean = (float(end[place, best]) for end in ends)
            yield LargestTorque(shaft, float(at[best]), least, most, mean, reversals)


def _located(
    given: TorsionCase, place: int, speed: FloatArray, response: SteadyState
) -> tuple[FloatArray, SteadyState, int]:
    """Speeds ever closer to the largest torque, the motion at them and the place of the largest."""
    at, found = speed, response
    best = int(np.nanargmax(_sizes(found, place)))
    for _ in range(_ROUNDS):
        low, high = at[max(best - 1, 0)], at[min(best + 1, len(at) - 1)]
        closer = np.union1d(np.linspace(low, high, _EACH), [at[best]])
        at, found = closer, given.system.steady(closer, given.orders)
        best = int(np.nanargmax(_sizes(found, place)))
    return at, found, best


def _sizes(found: SteadyState, place: int) -> FloatArray:
    return np.asarray(np.maximum(np.abs(found.torque_min), np.abs(found.torque_max))[place])


def _reversals(speed: FloatArray, response: SteadyState, place: int) -> Iterator[SpeedRange]:
    """Where the torque changes its sign though it has a mean, the ends interpolated."""
    if not np.any(response.found):
        return
    mean = response.torque_mean[place]
    largest = np.nanmax(_sizes(response, place))
    low = np.where(mean >= 0.0, response.torque_min[place], -response.torque_max[place])
    reverses: NDArray[np.bool_] = response.found & (low < 0.0) & (np.abs(mean) > 1e-9 * largest)
    for first, last in ranges(reverses):
        start, stop = float(speed[first]), float(speed[last])
        if first > 0 and low[first - 1] >= 0.0:
            start = _crossing(speed, low, first - 1)
        if last + 1 < len(speed) and low[last + 1] >= 0.0:
            stop = _crossing(speed, low, last)
        yield SpeedRange(start, stop)


def _crossing(speed: FloatArray, value: FloatArray, place: int) -> float:
    """The speed between two neighbours at which the value is 0, on a straight line."""
    before, after = value[place], value[place + 1]
    return float(speed[place] + (speed[place + 1] - speed[place]) * before / (before - after))


TORSION_SCHEMA = answer_schema(
    "torsion",
    "what cardan torsion prints with --json",
    {
        **schema_of(TorsionFigures)["properties"],
        "files": {"type": "array", "items": {"type": "string"}, "description": "what was written"},
    },
)
"""JSON Schema of what ``torsion_data`` returns."""
