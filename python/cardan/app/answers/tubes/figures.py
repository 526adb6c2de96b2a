"""Stress and critical bending speed of a scene's tubes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.answers.rounding import alike
from cardan.app.answers.turn.extremes import peak
from cardan.app.scene.scene import Scene
from cardan.app.scene.units import RPM
from cardan.design.judged import is_within
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


@dataclass(frozen=True)
class TubeFigures:
    """One tube; ``None`` for what needs a load that the scene does not give.

    Attributes:
        shaft: its shaft.
        stiffness: in N m/rad.
        inertia: in kg m².
        mass: in kg.
        torque: largest torque in N m, over the turn, all states with the scene's load, and the
            duty cycle.
        torque_in: the state or the step of the duty cycle with it, "" if there is only one.
        stress: the shear stress that it causes, in Pa.
        permitted_stress: ``None`` if the scene permits any.
        critical_rpm: critical bending speed.
        speed_rpm: largest speed.
        least_margin: of the critical over the largest speed, ``None`` if any will do.
    """

    shaft: int
    stiffness: float
    inertia: float
    mass: float
    torque: float | None
    torque_in: str
    stress: float | None
    permitted_stress: float | None
    critical_rpm: float
    speed_rpm: float | None
    least_margin: float | None

    @property
    def margin(self) -> float | None:
        """Critical speed over the largest speed."""
        return None if self.speed_rpm is None else self.critical_rpm / self.speed_rpm

    @property
    def stress_passes(self) -> bool:
        """Whether the stress is permitted, or not judged."""
        if self.stress is None or self.permitted_stress is None:
            return True
        return is_within(self.stress, self.permitted_stress)

    @property
    def margin_passes(self) -> bool:
        """Whether the margin of the critical speed suffices, or is not judged."""
        if self.margin is None or self.least_margin is None:
            return True
        return is_within(self.margin, self.least_margin, most=False)

    @property
    def passes(self) -> bool:
        """Whether nothing exceeds what the scene permits."""
        return self.stress_passes and self.margin_passes


def find(answer: Answer) -> tuple[TubeFigures, ...]:
    """Return the tubes of a scene; none if it has none."""
    scene = answer.scene
    tubes, cases = scene.service.tubes, list(_cases(scene))
    if tubes is None:
        return ()
    found = tubes.tube
    # Without a torque or inertias there is no load to judge.
    worst = [_largest_torque(cases, shaft) for shaft in tubes.shafts]
    stresses = found.shear_stress([torque for torque, _ in worst])
    speed = max((abs(float(load.speed)) / RPM for _, _, load in cases), default=0.0)
    return tuple(
        TubeFigures(
            shaft,
            float(found.stiffness[i]),
            float(found.inertia[i]),
            float(found.mass[i]),
            worst[i][0] or None,
            worst[i][1],
            float(stresses[i]) or None,
            tubes.permitted_stress,
            float(found.critical_speed[i] / RPM),
            speed or None,
            tubes.least_margin,
        )
        for i, shaft in enumerate(tubes.shafts)
    )


_Case = tuple[str, Driveline, Load]


def _cases(scene: Scene) -> Iterator[_Case]:
    """Every load of the tubes with its name: each step of the duty cycle, [load] in each state."""
    duty, states = scene.service.duty, scene.states
    if duty is not None:
        for step, name in enumerate(duty.names):
            yield name, duty.line[step], duty.load_of(step)
    for i, name in enumerate(states.names if states else ("",)):
        each = scene.in_state(i) if states else scene
        load = each.load_case
        # A recorded load has no turn over which to look for the largest torque.
        if load is not None and not each.line.shape and not np.ndim(load.speed + load.torque):
            yield name, each.line, load


def _largest_torque(cases: Sequence[_Case], shaft: int) -> tuple[float, str]:
    """The largest magnitude of a shaft's torque over a turn, and the case that has it."""
    found = [peak(line, "torque", shaft, load).value for _, line, load in cases] or [0.0]
    worst = int(np.argmax(found))
    return found[worst], "" if alike(min(found), found[worst]) else cases[worst][0]


def data(found: tuple[TubeFigures, ...], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return tubes as plain data for JSON, as ``SCHEMA`` describes them."""
    return [
        {
            "shaft": tube.shaft,
            "stiffness_Nm_per_rad": tube.stiffness,
            "inertia_kgm2": tube.inertia,
            "mass_kg": tube.mass,
            "torque_Nm": tube.torque,
            "torque_in": tube.torque_in,
            "shear_stress_MPa": None if tube.stress is None else 1e-6 * tube.stress,
            "permitted_stress_MPa": None
            if tube.permitted_stress is None
            else 1e-6 * tube.permitted_stress,
            "critical_speed_rpm": tube.critical_rpm,
            "largest_speed_rpm": tube.speed_rpm,
            "margin": tube.margin,
            "least_margin": tube.least_margin,
            "passes": tube.passes,
        }
        for tube in found
    ]


_NUMBER: Mapping[str, Any] = {"type": "number"}
_MAYBE: Mapping[str, Any] = {"type": ["number", "null"]}

SCHEMA: Mapping[str, Any] = {
    "type": "array",
    "description": "the tubes of shafts, with the largest torque over the turn, the states and "
    "the duty cycle",
    "items": record(
        {
            "shaft": {"type": "integer", "minimum": 0},
            "stiffness_Nm_per_rad": _NUMBER,
            "inertia_kgm2": _NUMBER,
            "mass_kg": _NUMBER,
            "torque_Nm": _MAYBE,
            "torque_in": {"type": "string", "description": "state or step; empty if it is one"},
            "shear_stress_MPa": _MAYBE,
            "permitted_stress_MPa": _MAYBE,
            "critical_speed_rpm": _NUMBER,
            "largest_speed_rpm": _MAYBE,
            "margin": {"description": "critical speed over the largest speed", **_MAYBE},
            "least_margin": _MAYBE,
            "passes": {"type": "boolean"},
        }
    ),
}
"""JSON Schema of what ``data`` returns."""


def verdicts(found: tuple[TubeFigures, ...]) -> dict[str, str]:
    """Return the verdicts on what the scene limits."""
    return {f"shaft {tube.shaft}": "within" if tube.passes else "beyond" for tube in found}
