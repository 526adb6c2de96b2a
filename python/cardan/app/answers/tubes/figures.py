"""Stress and critical bending speed of a scene's tubes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import Wherever, largest_torques
from cardan.app.answers.printed import figure_text, place_of, quantity
from cardan.app.answers.rows import Judged, figure, item, worst_of
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


@dataclass(frozen=True)
class TubeFigures:
    """The tube of a shaft."""

    shaft: int = item("shaft")
    stiffness: float = figure("torsional stiffness", "Nm_per_rad", source="G I_p/L")
    inertia: float = figure("moment of inertia", "kgm2", "about its axis", source="rho I_p L")
    mass: float = figure("mass", "kg")
    torque: Judged | None = figure("largest torque", "Nm", "over the turn")
    stress: Judged | None = figure(
        "shear stress",
        "MPa",
        "by the largest torque",
        source="T D/(2 I_p)",
        limit="[tubes] permitted_stress_MPa",
    )
    critical: Judged | None = figure(
        "critical bending speed",
        "rpm",
        "of the tube, pinned at both ends, where it is longest",
        source="(pi/L)**2 sqrt(E I/(rho A))",
    )
    speed: Judged | None = figure("largest speed", "rpm", "of the shaft")
    margin: Judged | None = figure(
        "margin", "", "critical bending speed over the speed", limit="[tubes] least_margin"
    )


def find(answer: Answer) -> tuple[TubeFigures, ...]:
    """Return the tubes of a scene; none if it has none."""
    return tuple(_tubes(answer.scene))


def _tubes(scene: Scene) -> Iterator[TubeFigures]:
    tubes = scene.tubes
    if tubes is None:
        return

    def critical_of(line: Driveline, _: Load | None) -> FloatArray:
        return np.moveaxis(tubes.critical_speed(line), -1, 0)

    def margin_of(line: Driveline, load: Load | None) -> FloatArray | None:
        speed = speed_of(line, load)
        with np.errstate(divide="ignore"):
            return None if speed is None else critical_of(line, load) / speed

    torque = Wherever(scene, lambda line, load: _torques(scene, line, load))
    critical, speed = Wherever(scene, critical_of, "least"), Wherever(scene, speed_of)
    margin, tube = Wherever(scene, margin_of, "least"), tubes.tube
    per_torque, permitted = tube.shear_stress(1.0), tubes.permitted_stress
    for i, shaft in enumerate(tubes.shafts):
        yield TubeFigures(
            shaft,
            float(tube.stiffness[i]),
            float(tube.inertia[i]),
            float(tube.mass[i]),
            torque.worst(i),
            torque.worst(i, permitted, "the scene gives no torque", per_torque[i]),
            critical.worst(i),
            speed.worst(0),
            margin.worst(i, tubes.least_margin, "the scene gives no speed"),
        )


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
    judged = [each for tube in tubes for each in (tube.stress, tube.margin) if each]
    for tube in tubes:
        stress, margin = tube.stress, tube.margin
        if stress and stress.verdict == "beyond" and stress.value and stress.limit:
            yield (
                f"The shear stress in the tube of shaft {tube.shaft} is "
                f"{quantity(stress.value, 'MPa')}{place_of(stress)}, beyond the permitted "
                f"{quantity(stress.limit, 'MPa')}."
            )
        if margin and margin.verdict == "beyond" and margin.value and margin.limit:
            yield (
                f"The critical bending speed of shaft {tube.shaft} is {figure_text(margin.value)} "
                f"times its speed{place_of(margin)}; the scene requires "
                f"{figure_text(margin.limit)} times."
            )
    verdict = worst_of(each.verdict for each in judged)
    if verdict == "within":
        yield "The tubes are within the limits that the scene gives."
    for why in dict.fromkeys(each.why for each in judged if each.why):
        yield f"The tubes are not judged by every limit: {why}."
    if not any(each.limit for each in judged):
        yield "The tubes are not judged: the scene gives no permitted_stress_MPa or least_margin."
