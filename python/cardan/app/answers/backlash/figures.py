"""How far the last shaft is loose while the drive is held, and how far torque winds it up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep

TURN = Sweep.revolutions(721 / 720, 720)
"""A turn in steps of half a degree, both ends included."""


@dataclass(frozen=True, eq=False)
class Backlash:
    """Lash and wind-up of the last shaft over a turn, ``(samples,)`` in rad.

    Attributes:
        lash: angle by which it is loose while the drive is held.
        wind_up: angle by which the torque winds it up beyond its flank; 0 with rigid crosses.
        torque: which makes the wind-up, in N m.
        end: where the torque acts, ``"drive"`` or ``"output"``.
    """

    lash: FloatArray
    wind_up: FloatArray
    torque: float
    end: str

    def loop(self, sample: int) -> tuple[FloatArray, FloatArray]:
        """Return the loop at one sample: angle of the shaft in rad and torque in N m, ``(4,)``.

        From full torque through the play to the opposite torque. The angle counts from the middle
        of the play; under a positive torque the shaft lags.
        """
        half, wound = 0.5 * self.lash[sample], self.wind_up[sample]
        angle = np.array([-half - wound, -half, half, half + wound])
        return angle, self.torque * np.array([1.0, 0.0, 0.0, -1.0])


def backlash(
    line: Driveline,
    radial: ArrayLike,
    arm: ArrayLike,
    load: Load,
    stiffness: ArrayLike | None = None,
) -> Backlash:
    """Return lash and wind-up of one driveline over ``TURN``.

    Args:
        line: one driveline.
        radial: play of the pins, as for ``Driveline.with_play``.
        arm: of the joints, likewise.
        load: its torque alone acts, which must be one number.
        stiffness: of the crosses, as for ``Driveline.wind_up``; rigid by default.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a batch, a torque that is 0 or recorded, and as for ``Driveline.lash``.
    """
    if line.shape:
        raise ArgumentValueError(
            "driveline", f"has shape {line.shape}; backlash is that of one driveline"
        )
    if load.torque.ndim or load.torque == 0.0:
        raise ArgumentValueError(
            "load", "must have one torque that is not 0; backlash is the angle over this torque"
        )
    torque = abs(float(load.torque))
    lash = np.asarray(line.lash(TURN, radial, arm))
    wind_up = np.zeros(len(lash))
    if stiffness is not None:
        alone: dict[str, Any] = {f"{load.end}_torque": torque}
        wind_up = np.asarray(line.wind_up(TURN, Load(**alone), stiffness))
    return Backlash(lash, wind_up, torque, load.end)


def scene_backlash(scene: Scene) -> Backlash | None:
    """Return lash and wind-up of a scene, in the state with the largest lash.

    ``None`` without play or without one torque, and for recorded bends.
    """
    play, load = scene.service.play, scene.load_case
    if play is None or load is None or scene.line.shape or load.torque.ndim or not load.torque:
        return None
    lines = [scene.line_as_built]
    if scene.states:
        lines = [scene.in_state(i).line_as_built for i in range(scene.states.count)]
    found = [backlash(line, play.radial, play.arm, load, play.stiffness) for line in lines]
    return max(found, key=lambda one: float(np.max(one.lash)))


def drawn_backlash(scene: Scene) -> Backlash:
    """Return lash and wind-up of a scene to draw.

    Raises:
        ValueError: a scene without play, without one torque, or with recorded bends.
    """
    found = scene_backlash(scene)
    if found is None:
        raise ValueError(
            f"{scene.name}: backlash needs play_mm and arm_mm in [joints], one torque in [load] "
            "that is not 0, and bends that were not recorded"
        )
    return found


def data(found: Backlash, *, radians: bool = False) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes it."""
    unit = "rad" if radians else "deg"
    data: dict[str, Any] = {"torque_Nm": found.torque, "end": found.end}
    rows = {"lash": found.lash}
    if np.any(found.wind_up):
        rows["wind_up"] = found.wind_up
    for name, values in rows.items():
        shown = values if radians else np.degrees(values)
        data[f"{name}_{unit}"] = {"min": float(shown.min()), "max": float(shown.max())}
    return data


_RANGE = record({"min": {"type": "number"}, "max": {"type": "number"}})

SCHEMA: Mapping[str, Any] = {
    **record(
        {"torque_Nm": {"type": "number"}, "end": {"enum": ["drive", "output"]}},
        dict.fromkeys(("lash_deg", "lash_rad", "wind_up_deg", "wind_up_rad"), _RANGE),
    ),
    "description": "how far the last shaft is loose while the drive is held, over a turn",
}
"""JSON Schema of ``data``."""


def find(answer: Answer) -> Backlash | None:
    """Return the figures of an answer's scene."""
    return scene_backlash(answer.scene)
