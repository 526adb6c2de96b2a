"""Lateral vibration of a scene: moments that bend the shafts, resonances, forces of bearings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import length
from cardan.app.answers.forces.figures import unknown as forces_unknown
from cardan.app.answers.lateral.remedy import Remedy, remedies
from cardan.app.answers.lateral.vibration import (
    ALL,
    Met,
    Vibration,
)
from cardan.app.answers.over import limit_of, over
from cardan.app.answers.printed import given, listed, quantity
from cardan.app.answers.rows import (
    Judged,
    count,
    figure,
    flag,
    item,
    numbers,
    optional,
    parts,
    word,
)
from cardan.app.answers.torsion.figures import SpeedRange
from cardan.app.scene.language.units import RPM
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.lateral import LateralCase
from cardan.arrays import FloatArray
from cardan.evaluation.load import Load

_THOMA = "D. Thoma, 1920: impulses of bending of the second and fourth order"
# A bearing or a middle that moves this share of the most moving one moves with a shape.
_MOVES = 0.3
# A shape is that of shafts on a bearing if this has so much of the elastic energy.
_HELD = 0.3
# Couples below this share of the largest are what a drawing does not tell.
_DRAWN = 1e-5


@dataclass(frozen=True)
class BendingCouples:
    """The couples by which both joints bend one shaft, split into a bow and a tilt.

    The bow bends the shaft symmetrically and shakes it at half its critical speed; the tilt loads
    bearings and joints.
    """

    shaft: int = item("shaft")
    mean_bow: float = figure("mean bow", "Nm", "constant part of half the difference of its ends")
    mean_tilt: float = figure("mean tilt", "Nm", "constant part of half the sum of its ends")
    bow: float = figure(
        "order 2 bow", "Nm", "largest part that changes twice per turn, of half the difference"
    )
    tilt: float = figure("order 2 tilt", "Nm", "likewise of half the sum")


@dataclass(frozen=True)
class NaturalFrequency:
    """A natural frequency at rest without damping; of two nearly alike, the lower one."""

    number: int = item("mode")
    frequency: float = figure("natural frequency", "Hz", "at rest, without damping")
    energy: float = figure(
        "energy in bearings",
        "percent",
        "share of the elastic bearings in the elastic energy",
        digits="share",
    )
    loss: float = figure("loss factor", "", "of orders 2 and 4, from bearings and tubes")
    shape: str = word("shape", "what moves most", is_detail=True)


@dataclass(frozen=True)
class Resonance:
    """An order that meets a natural frequency.

    Where the loss factor of its bearings, or of all if tubes bend much, is below 0.05, the peak is
    not known: there is a band around it.
    """

    order: int = count("order", "of the drive's rotation")
    mode: int = count("mode")
    speed: float = figure("drive speed", "rpm", "natural frequency over the order")
    inside: bool = flag("in the range", "whether it lies in the speed range of the scene")
    excited: bool = flag("excited", "whether joints or an unbalance excite it")
    peak: float | None = figure(
        "largest force", "N", "of this order at a bearing, where the damping is known"
    )
    peak_speed: float | None = figure(
        "at", "rpm", "where the peak is; damping moves it", is_detail=True
    )
    bearing: int | None = optional(count("bearing", "that bears it", is_detail=True))
    moved: float | None = figure(
        "displacement", "mm", "of the shaft in this bearing there", digits="small"
    )
    start: float = figure("band from", "rpm", "16 % below", is_detail=True)
    stop: float = figure("band to", "rpm", "16 % above", is_detail=True)
    known: bool = flag(
        "peak known",
        "whether the loss factor of the resonance is 0.05 or more, or that of the bearings where "
        "they have most of the elastic energy",
        is_detail=True,
    )


@dataclass(frozen=True)
class BearingVibration:
    """The force of an elastic bearing on its shaft over the speeds."""

    bearing: int = item("bearing")
    shaft: int = count("shaft")
    static: float | None = figure(
        "order 2 slowly", "N", "by statics, as if all bearings were rigid"
    )
    largest: Judged = figure(
        "largest dynamic force",
        "N",
        "of all orders and the mean together, outside bands of unknown damping",
        limit="[limits] bearing_force_N",
    )
    speed: float | None = figure("at", "rpm", "drive speed of the largest force")
    mean: float | None = figure("mean", "N", "length of the mean force")
    order_1: float | None = figure("order 1 up to", "N", "over the speeds")
    order_2: float | None = figure("order 2 up to", "N", "over the speeds", source=_THOMA)
    order_4: float | None = figure("order 4 up to", "N", "over the speeds", source=_THOMA)
    displacement: Judged = figure(
        "largest displacement",
        "mm",
        "of the shaft in the bearing over a turn, outside bands of unknown damping",
        digits="small",
        limit="[limits] bearing_displacement_mm",
    )


@dataclass(frozen=True)
class StaticForce:
    """Order 2 of the force of a bearing without its stiffness, by statics."""

    bearing: int = item("bearing")
    shaft: int = count("shaft")
    static: float = figure("order 2 slowly", "N", "part that changes twice per turn")


@dataclass(frozen=True)
class MiddleOfTube:
    """Motion of the middle of a tube over the speeds."""

    shaft: int = item("shaft")
    moved: float = figure(
        "largest displacement of the middle",
        "mm",
        "outside bands of unknown damping",
        digits="small",
    )
    speed: float = figure("at", "rpm", "drive speed of this displacement")


@dataclass(frozen=True, eq=False)
class OrderForce:
    """The force of one order over the speeds of the response."""

    order: int = item("order")
    force: FloatArray = numbers("force", "N", "largest length over a turn")


@dataclass(frozen=True, eq=False)
class BearingResponse:
    """The force of one bearing at each speed of the response."""

    bearing: int = item("bearing")
    largest: FloatArray = numbers("largest force", "N", "of all orders and the mean")
    displacement: FloatArray = numbers("largest displacement", "mm")
    orders: tuple[OrderForce, ...] = parts("Orders")


@dataclass(frozen=True, eq=False)
class Response:
    """The vibration over the speed; in bands it is as uncertain as the damping."""

    speed: FloatArray = numbers("drive speed", "rpm")
    bearings: tuple[BearingResponse, ...] = parts("Bearings")


@dataclass(frozen=True, eq=False, kw_only=True)
class LateralFigures:
    """The lateral vibration of a scene.

    Attributes:
        vibration: that of the driveline, over states of the worst of them.
        state: the name of that state; "" without states.
        why: why forces are not known; "" if they are.
    """

    vibration: Vibration = field(repr=False)
    state: str = ""
    why: str = ""
    margin: Judged | None = figure(
        "distance of the nearest resonance",
        "percent",
        "of order 1, which any unbalance excites, or of 2 and 4 if joints excite them, from the "
        "speed range, in shares of the resonance; 0 within it",
        source=_THOMA,
        limit="[lateral] resonance_margin",
    )
    torque_margin: Judged | None = figure(
        "margin of the torque",
        "",
        "torque at which vibration of order 1 grows by itself, over that of the load",
        source="stiffness that turns with the shaft: |k - m w² + i c w| > |kappa|",
        limit="[lateral] least_torque_margin",
    )
    speed_range: SpeedRange | None = parts("Speed range", "of the scene")
    sliding: str = word("sliding", "which shaft slides in its spline at each joint", is_detail=True)
    couples: tuple[BendingCouples, ...] = parts("Couples that bend the shafts")
    statics: tuple[StaticForce, ...] = optional(parts("Forces of bearings"))
    modes: tuple[NaturalFrequency, ...] = parts("Natural frequencies")
    resonances: tuple[Resonance, ...] = parts("Resonances")
    bearings: tuple[BearingVibration, ...] = parts("Bearings")
    middles: tuple[MiddleOfTube, ...] = parts("Tubes")
    remedies: tuple[Remedy, ...] = optional(parts("Changes", is_detail=True))
    response: Response | None = optional(parts("Response over the speed", is_detail=True))


def find(answer: Answer) -> LateralFigures | None:
    """Return the lateral vibration of a scene in its worst state; ``None`` without [lateral]."""
    scene, case = answer.scene, answer.scene.lateral
    if case is None:
        return None
    each = [scene.in_state(i) for i in range(scene.states.count)] if scene.states else [scene]
    why = forces_unknown(scene)
    loads = [None if why else one.load_case for one in each]
    if not case.rigid_bearings:
        loads = [load and _at_steady_speed(load) for load in loads]
    found = [Vibration(case, one.line, load) for one, load in zip(each, loads, strict=True)]
    worst = 0 if why else int(np.argmax([_size(one) for one in found]))
    one = found[worst]
    state = scene.states.names[worst] if scene.states and len(found) > 1 else ""
    couples = () if why else tuple(_couples(one))
    if case.rigid_bearings:
        unknown: Any = dict.fromkeys(("margin", "torque_margin", "speed_range", "response"))
        none: Any = dict.fromkeys(("modes", "resonances", "bearings", "middles", "remedies"), ())
        own: Any = {"couples": couples, "statics": tuple(_statics(one)), "sliding": ""}
        return LateralFigures(vibration=one, state=state, why=why, **own, **unknown, **none)
    shapes = _shapes(one)
    low, high = float(case.speed[0]), float(case.speed[-1])
    return LateralFigures(
        vibration=one,
        state=state,
        why=why,
        margin=_margin(scene, found),
        torque_margin=_torque_margin(scene, found),
        speed_range=SpeedRange(low, high),
        sliding=", ".join(
            f"shaft {shaft} at joint {joint}" for joint, shaft in enumerate(one.system.sliding)
        ),
        couples=couples,
        statics=(),
        modes=tuple(
            NaturalFrequency(
                group.number, group.frequency, min(1.0, group.shares.sum()), group.loss[1], shape
            )
            for group, shape in zip(one.groups, shapes, strict=True)
            if group.frequency <= 4.0 * 1.5 * high
        ),
        resonances=tuple(_resonance(one, met) for met in one.met),
        bearings=tuple(_bearings(scene, found, one)),
        middles=() if why else tuple(_middles(one)),
        remedies=() if why else tuple(_remedies(found, one)),
        response=None,
    )


def whole(_: Answer, found: LateralFigures) -> LateralFigures:
    """Return the lateral vibration with its response over the speeds."""
    one = found.vibration
    if one.load is None or one.case.rigid_bearings:
        return found
    response = one.response
    forces, moved = (response.largest(f"bearing_{name}") for name in ("force", "displacement"))
    orders = response.of_order("bearing_force")
    own = Response(
        one.speed,
        tuple(
            BearingResponse(
                number,
                forces[i],
                moved[i],
                tuple(OrderForce(order, orders[i, :, k]) for k, order in enumerate(ALL)),
            )
            for i, number in enumerate(one.case.elastic)
        ),
    )
    return replace(found, response=own)


def _size(found: Vibration) -> float:
    """How large order 2 is, to find the worst of several states."""
    if found.statics is not None and found.statics.size:
        return max(map(length, found.statics))
    return max((length(ends[0, 1] - ends[1, 1]) for ends in found.couples), default=0.0)


def _couples(found: Vibration) -> Iterator[BendingCouples]:
    least = _DRAWN * float(np.max(np.abs(found.couples), initial=0.0))
    for shaft, (upstream, downstream) in zip(found.case.moving, found.couples, strict=True):
        halves = (0.5 * (upstream - downstream), 0.5 * (upstream + downstream))
        means = [float(np.linalg.norm(half[0].real)) for half in halves]
        sizes = [length(half[1]) for half in halves]
        own = [0.0 if size <= least else size for size in (*means, *sizes)]
        yield BendingCouples(shaft, *own)


def _statics(found: Vibration) -> Iterator[StaticForce]:
    if found.statics is None:
        return
    for i in found.case.rigid_bearings:
        yield StaticForce(i, found.line.bearings[i][0], length(found.statics[i]))


def _shapes(found: Vibration) -> list[str]:
    """Say what moves most in each group of natural frequencies."""
    bearings = [(shaft, float(at)) for shaft, at in found.line.bearings]
    elastic = [bearings[i] for i in found.case.elastic]
    probes = [*elastic, *found.middles]
    names = [
        *(f"shaft {found.line.bearings[i][0]} in bearing {i}" for i in found.case.elastic),
        *(f"the middle of shaft {shaft}" for shaft, _ in found.middles),
    ]
    if not probes:
        return ["rigid shafts"] * len(found.groups)
    count = max(group.number for group in found.groups) + 1
    moved = np.linalg.norm(found.system.modes(count, probes=probes).displacement, axis=-1)
    shapes = []
    for group in found.groups:
        own = moved[:, group.number]
        most = sorted(zip(own, names, strict=True), reverse=True)
        shapes.append(listed([name for size, name in most if size >= _MOVES * most[0][0]]))
    return shapes


def _resonance(found: Vibration, met: Met) -> Resonance:
    low, high = found.case.speed[0], found.case.speed[-1]
    inside, excited = bool(low <= met.speed <= high), met.order in found.excited
    peak = None
    if found.load is not None and inside and excited and met.is_known:
        peak = found.peak(met)
    bearing, speed, force, moved = peak or (None, None, None, None)
    return Resonance(
        *(met.order, met.group.number, met.speed, inside, excited, force, speed),
        *(None if bearing is None else found.case.elastic[bearing], moved),
        *met.band,
        known=met.is_known,
    )


def _at_steady_speed(load: Load) -> Load:
    """Return a load without its acceleration."""
    torque: Any = {f"{load.end}_torque": load.torque}
    return Load(speed=load.speed, inertias=load.inertias, **torque)


def _margin(scene: Scene, found: Sequence[Vibration]) -> Judged:
    """The distance of the nearest resonance of order 1 or another order that is excited."""
    case = found[0].case
    low, high = case.speed[0], case.speed[-1]
    away = []
    for one in found:
        every = [
            max(low - speed, speed - high, 0.0) / speed
            for group in one.groups
            for order in {1, *one.excited}
            for speed in [group.frequency / order]
        ]
        away.append(min(every))
    return over(scene, np.array(away), case.margin, "least", _names(scene))


def _names(scene: Scene) -> Sequence[str]:
    """The states; a study is not evaluated."""
    return scene.states.names if scene.states else ("the drawing",)


def _torque_margin(scene: Scene, found: Sequence[Vibration]) -> Judged | None:
    """The least torque that makes the motion unstable, over that of the load."""
    case = found[0].case
    damped = any(group.loss[0] > 0.0 for one in found for group in one.groups)
    if not damped or any(one.load is None for one in found):
        return None
    low, high = float(case.speed[0]), float(case.speed[-1])
    margins = []
    for one in found:
        assert one.load
        own = [met.speed for met in one.met if met.order == 1 and low <= met.speed <= high]
        torque = float(abs(one.load.torque))
        if torque:
            most = one.system.largest_stable_torque(np.array([low, *own, high]))
            margins.append(float(np.min(most)) / torque)
    known = [margin for margin in margins if np.isfinite(margin)]
    if len(known) < len(found):
        return None
    return over(scene, np.array(known), case.torque_margin, "least", _names(scene))


def _bearings(
    scene: Scene, found: Sequence[Vibration], worst: Vibration
) -> Iterator[BearingVibration]:
    limits = {key: limit_of(scene, f"bearing_{key}") for key in ("force_N", "displacement_mm")}
    for i, number in enumerate(worst.case.elastic):
        shaft = worst.line.bearings[number][0]
        static = worst.statics
        size = None if static is None else length(static[number])
        if worst.load is None:
            force, moved = (
                Judged(None, why=forces_unknown(scene), **limit) for limit in limits.values()
            )
            yield BearingVibration(number, shaft, None, force, None, None, None, None, None, moved)
            continue
        force, moved = (
            _over_speeds(scene, found, name, i, limits[key])
            for name, key in (
                ("bearing_force", "force_N"),
                ("bearing_displacement", "displacement_mm"),
            )
        )
        outside, speed = ~worst.unknown, None
        most: dict[int, float | None] = dict.fromkeys(ALL)
        if np.any(outside):
            own = worst.response.largest("bearing_force")[i, outside]
            speed = float(worst.speed[outside][np.argmax(own)])
            sizes = np.max(worst.response.of_order("bearing_force")[i, outside], axis=0)
            found_orders = dict(zip(ALL, sizes.tolist(), strict=True))
            known = (0, *worst.excited)
            most = {order: found_orders[order] * (order in known) for order in ALL}
        yield BearingVibration(
            number, shaft, size, force, speed, most[0], most[1], most[2], most[4], moved
        )


def _over_speeds(
    scene: Scene, found: Sequence[Vibration], name: str, bearing: int, limit: dict[str, Any]
) -> Judged:
    """The largest value over the speeds; not judged if it may be larger in a band."""
    values: list[float] = []
    bands: list[Met] = []
    for one in found:
        if np.all(one.unknown):
            why = "the damping is not known at any of the speeds"
            return Judged(None, why=f"{why} ({_needs(one.bands)})", **limit)
        values.append(float(np.max(one.response.largest(name)[bearing, ~one.unknown])))
        bands += one.bands
    judged = over(scene, np.array(values), names=_names(scene), **limit)
    judged = replace(judged, may_be_worse=bool(bands))
    if bands and judged.verdict in ("within", "tolerable"):
        return replace(judged, why=_why(judged, bands, found[0].case))
    return judged


def _why(judged: Judged, bands: Sequence[Met], case: LateralCase) -> str:
    """Say at which speeds a limit is kept, and why it is not judged at the others."""
    met = {
        (each.order, quantity(each.speed, "rpm"), _place(each, case)): each.lack for each in bands
    }
    called = listed([f"order {order} at {speed}{place}" for order, speed, place in met])
    resonances = "resonance" if len(met) == 1 else "resonances"
    lack = " or ".join(sorted(set(met.values()), reverse=True))
    ranges = [" to ".join(quantity(end, "rpm") for end in ends) for ends in _outside(bands, case)]
    kept = "kept" if judged.verdict == "within" else judged.verdict
    # Bands of several states may reach all speeds.
    where = f"it is {kept} from {listed(ranges)}; at the other speeds " if ranges else ""
    return (
        f"{where}the damping of the {resonances} of {called} is {lack} ({_needs(bands)})"
        f"{_free(bands, case)}"
    )


def _place(met: Met, case: LateralCase) -> str:
    """Say whether a resonance is that of tubes, and above the speeds."""
    said = {"of tubes": met.is_of_tubes, "above the speed range": met.speed > case.speed[-1]}
    words = ", ".join(word for word, holds in said.items() if holds)
    return words and f" ({words})"


def _free(bands: Sequence[Met], case: LateralCase) -> str:
    """Say how far the speeds may go where only resonances above them reach into them."""
    if min(each.speed for each in bands) <= case.speed[-1]:
        return ""
    stop = math.floor(min(each.band[0] for each in bands) / RPM) * RPM
    return f"; a speed range up to {given(stop, 'rpm')} is judged" if stop > case.speed[0] else ""


def _needs(bands: Sequence[Met]) -> str:
    """Name the keys that would make the damping of resonances known, that of tubes first."""
    return "; ".join(sorted({each.needs for each in bands}, reverse=True))


def _outside(bands: Sequence[Met], case: LateralCase) -> Iterator[tuple[float, float]]:
    """Yield the ranges of speeds that no band reaches."""
    start, stop = float(case.speed[0]), float(case.speed[-1])
    for low, high in sorted(each.band for each in bands):
        if low > start:
            yield start, low
        start = max(start, high)
    if start < stop:
        yield start, stop


def _middles(found: Vibration) -> Iterator[MiddleOfTube]:
    outside = ~found.unknown
    if not np.any(outside):
        return
    for i, (shaft, _) in enumerate(found.middles):
        moved = found.response.largest("displacement")[i, outside]
        at = int(np.argmax(moved))
        yield MiddleOfTube(shaft, float(moved[at]), float(found.speed[outside][at]))


def _remedies(every: Sequence[Vibration], found: Vibration) -> Iterator[Remedy]:
    """Yield remedies for the largest resonance of order 2 of a bearing in the range."""
    low, high = found.case.speed[0], found.case.speed[-1]
    inside = [
        met
        for met in found.met
        if met.order == 2 and low <= met.speed <= high and np.any(met.group.shares > _HELD)
    ]
    if not inside or 2 not in found.excited:
        return
    peaks = [found.peak(met) if met.is_known else None for met in inside]
    worst = int(np.argmax([peak[2] if peak else 0.0 for peak in peaks]))
    peak, met = peaks[worst], inside[worst]
    yield from remedies(every, found, met, peak[0] if peak else int(np.argmax(met.group.shares)))
