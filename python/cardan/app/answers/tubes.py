"""Stress and critical bending speed of a scene's tubes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import Wherever, largest_torques
from cardan.app.answers.printed import given, place_of, quantity
from cardan.app.answers.rows import Judged, figure, item, optional, worst_of
from cardan.app.answers.torsion.figures import (
    TorsionBasics,
    judged_at,
    largest_of,
    missing_of,
)
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

_NEAR = 0.15  # of a speed at which bent joints can make a shaft vibrate
_STRAIGHT = 1e-6  # rad, of which the moments bend no shaft


@dataclass(frozen=True)
class TubeFigures:
    """The tube of a shaft."""

    shaft: int = item("shaft")
    stiffness: float = figure("torsional stiffness", "Nm_per_rad", source="G I_p/L")
    inertia: float = figure("moment of inertia", "kgm2", "about its axis", source="rho I_p L")
    mass: float = figure("mass", "kg")
    torque: Judged | None = figure(
        "largest torque", "Nm", "over the turn, without torsional vibration"
    )
    stress: Judged | None = figure(
        "shear stress",
        "MPa",
        "by the largest torque",
        source="T D/(2 I_p)",
        limit="[tubes] permitted_stress_MPa",
    )
    vibrating: Judged | None = optional(
        figure(
            "largest torque with vibration",
            "Nm",
            "of a shaft that is a spring of [torsion], where a check searches over its speeds",
        )
    )
    vibrating_stress: Judged | None = optional(
        figure(
            "shear stress with vibration",
            "MPa",
            "by that torque",
            source="T D/(2 I_p)",
            limit="[tubes] permitted_stress_MPa",
        )
    )
    critical: Judged | None = figure(
        "critical bending speed",
        "rpm",
        "of the tube, pinned at both ends, where it is longest",
        source="(pi/L)**2 sqrt(E I/(rho A))",
    )
    speed: Judged | None = figure("largest speed", "rpm", "of the shaft")
    margin: Judged | None = figure(
        "margin",
        "",
        "critical bending speed over the speed",
        limit="[tubes] least_margin",
        digits="margin",
    )
    half: Judged | None = figure(
        "distance from half critical",
        "percent",
        "of the speed from half the critical bending speed, in shares of that half; the moments of "
        "bent joints bend the shaft twice per turn",
        source="D. Thoma, 1920: impulses of bending of the second order",
        limit="[tubes] resonance_margin",
    )
    quarter: Judged | None = figure(
        "distance from a quarter critical",
        "percent",
        "of the speed from a quarter of the critical bending speed, in shares of that quarter; the "
        "torques of inertias at bent joints bend the shaft four times per turn as well",
        source="D. Thoma, 1920: impulses of bending of the fourth order",
        is_detail=True,
    )


def find(answer: Answer) -> tuple[TubeFigures, ...]:
    """Return the tubes of a scene; none if it has none."""
    scene, tubes = answer.scene, answer.scene.tubes
    if tubes is None:
        return ()

    def critical_of(line: Driveline, _: Load | None) -> FloatArray:
        return np.moveaxis(tubes.critical_speed(line), -1, 0)

    def margin_of(line: Driveline, load: Load | None) -> FloatArray | None:
        speed = speed_of(line, load)
        with np.errstate(divide="ignore"):
            return None if speed is None else critical_of(line, load) / speed

    def distance_of(order: int, line: Driveline, load: Load | None) -> FloatArray | None:
        speed = speed_of(line, load)
        if speed is None or load is None or (order > 2 and load.inertias is None):
            return None
        bends = np.pad(line.bends, [(0, 0)] * len(line.shape) + [(1, 1)])
        joints = np.maximum(bends[..., :-1], bends[..., 1:])[..., list(tubes.shafts)]
        resonant = critical_of(line, load) / order
        away = np.abs(speed - resonant) / resonant
        return np.where(np.moveaxis(joints, -1, 0) > _STRAIGHT, away, np.inf)

    torque = Wherever(scene, lambda line, load: _torques(scene, line, load))
    critical, speed = Wherever(scene, critical_of, "least"), Wherever(scene, speed_of)
    margin, tube = Wherever(scene, margin_of, "least"), tubes.tube
    half, quarter = (Wherever(scene, partial(distance_of, order), "least") for order in (2, 4))
    per_torque, permitted = tube.shear_stress(1.0), tubes.permitted_stress
    vibrating = _vibrating(answer)
    return tuple(
        TubeFigures(
            shaft,
            float(tube.stiffness[i]),
            float(tube.inertia[i]),
            float(tube.mass[i]),
            torque.worst(i),
            torque.worst(i, permitted, "the scene gives no torque", per_torque[i]),
            vibrating(shaft, None, 1.0),
            vibrating(shaft, permitted, float(per_torque[i])),
            critical.worst(i),
            speed.worst(0),
            margin.worst(i, tubes.least_margin, "the scene gives no speed"),
            half.worst(i, tubes.resonance_margin, "the scene gives no speed"),
            quarter.worst(i),
        )
        for i, shaft in enumerate(tubes.shafts)
    )


def _vibrating(answer: Answer) -> Callable[[int, float | None, float], Judged | None]:
    """Return a function for the largest torque of a shaft over the speeds of [torsion], if known.

    It takes the shaft, a limit, and a factor on the torque.
    """
    found = answer["torsion"]
    search = found.search if isinstance(found, TorsionBasics) else None
    largest = {each.shaft: each for each in largest_of(search)} if search else {}

    def judged(shaft: int, limit: float | None, factor: float) -> Judged | None:
        each = largest.get(shaft)
        if each is None or search is None:
            return None
        return judged_at(factor * each.size, each.speed, limit, [*missing_of(search.response)])

    return judged


def speed_of(line: Driveline, load: Load | None) -> FloatArray | None:
    """Return the speeds of the drive, ``(1, places, steps)``, if there are any."""
    if load is None or not np.any(load.speed):
        return None
    shape = np.broadcast_shapes(line.shape, load.speed.shape)
    return np.broadcast_to(np.abs(load.speed), shape)[np.newaxis]


def _torques(scene: Scene, line: Driveline, load: Load | None) -> FloatArray | None:
    """The largest torques of the tubes over a turn, ``(tubes, places, steps)``, if any."""
    if load is None:
        return None
    turns = np.any(load.speed) or np.any(load.acceleration)
    if not (np.any(load.torque) or (load.inertias is not None and turns)):
        return None
    assert scene.tubes
    return largest_torques(scene, line, load, scene.tubes.shafts)


def sentences(tubes: Sequence[TubeFigures]) -> Iterator[str]:
    """Say whether the tubes are within the limits of the scene, what is not judged and why."""
    judged = [
        each
        for tube in tubes
        for each in (tube.stress, tube.vibrating_stress, tube.margin, tube.half)
        if each
    ]
    for tube in tubes:
        margin = tube.margin
        for stress, by in ((tube.stress, ""), (tube.vibrating_stress, " with vibration")):
            if stress and stress.verdict == "beyond" and stress.value and stress.limit:
                yield (
                    f"The shear stress in the tube of shaft {tube.shaft}{by} is "
                    f"{quantity(stress, 'MPa')}{place_of(stress)}, beyond the permitted "
                    f"{given(stress.limit, 'MPa')}."
                )
        if margin and margin.verdict == "beyond" and margin.value and margin.limit:
            yield (
                f"The critical bending speed of shaft {tube.shaft} is "
                f"{quantity(margin, '', digits='margin')} "
                f"times its speed{place_of(margin)}; the scene requires "
                f"{given(margin.limit, '')} times."
            )
        yield from _bending(tube)
    verdict = worst_of(each.verdict for each in judged)
    if verdict == "within":
        yield "The tubes are within the limits that the scene gives."
    for why in dict.fromkeys(each.why for each in judged if each.why):
        yield f"The tubes are not judged by every limit: {why}."
    if not any(each.limit for each in judged):
        yield (
            "The tubes are not judged: the scene gives no permitted_stress_MPa, least_margin or "
            "resonance_margin."
        )


def _bending(tube: TubeFigures) -> Iterator[str]:
    """Say that the moments of bent joints can make a shaft vibrate, if it turns near that speed."""
    half = tube.half
    if half is None or half.value is None:
        return
    if half.verdict != "beyond" and (half.limit is not None or half.value > _NEAR):
        return
    share = quantity(half, "percent", rounds="up")
    near = f"within {share} of" if half.value else "at"
    required = "" if half.limit is None else f"; the scene requires {given(half.limit, 'percent')}"
    yield (
        f"Shaft {tube.shaft} turns {near} half its critical bending speed"
        f"{_speeds(tube.critical, half)}{place_of(half)}{required}: the moments of its bent joints "
        "bend it twice per turn and can make it vibrate (D. Thoma, 1920)."
    )


def _speeds(critical: Judged | None, half: Judged) -> str:
    """Return half the critical speed and that speed in the worst place, if they are known."""
    if critical is None or critical.value is None:
        return ""
    alike = not (critical.state or critical.at)
    there = critical.value if alike else critical.each.get(half.state)
    if there is None:
        return ""
    return f" ({quantity(0.5 * there, 'rpm').removesuffix(' rpm')} of {quantity(there, 'rpm')})"
