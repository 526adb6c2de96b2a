"""Whether a constant speed of the drive is a fair assumption, as a check reports it.

The loads of a scene assume a constant drive speed, or a given acceleration. A drive of finite
inertia gives way. The rule is this program's own: the assumption is fair while the drive, running
freely, varies by no more than a tenth of the variation of the shaft whose kinetic energy varies
most. For one joint that ratio is close to the driven inertia over the whole inertia, and inertia
torques are overestimated by about this share. D. Thoma (1920) asks for so large a drive without a
figure; ten times the driven inertia is just within the rule.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import record
from cardan.app.answers.rounding import is_cancelled
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.scene.scene import Scene

SHARE = 0.1
"""The largest share that is fair."""

SOURCE = "rule of this program"
"""Where the share comes from."""

SpeedVerdict = Literal["fair", "not fair", "no drive inertia"]


@dataclass(frozen=True)
class DriveSpeed:
    """How constant the speed of a drive is.

    Attributes:
        verdict: whether a constant speed is a fair assumption; ``no drive inertia`` where the
            scene gives shaft 0 none.
        variation: peak-to-peak variation of the freely running drive over its mean speed.
        shaft: the shaft whose kinetic energy varies most at constant drive speed.
        shaft_variation: its own variation at constant drive speed.
        inertia: of shaft 0 in kg m².
        needed: least inertia of shaft 0 that makes the assumption fair, in kg m².
        state: over states, the name of the one that needs the largest inertia, to which the
            figures belong.
    """

    verdict: SpeedVerdict
    variation: float
    shaft: int
    shaft_variation: float
    inertia: float
    needed: float
    state: str = ""

    @property
    def share(self) -> float:
        """The variation of the drive over that of the shaft."""
        return self.variation / self.shaft_variation


def drive_speed(scene: Scene) -> DriveSpeed | None:
    """Return how constant the speed of a scene's drive is, in the worst of its states.

    ``None`` where nothing depends on it: no speed, no inertia behind a joint, no variation, and
    for recorded bends or speeds; a measured drive shows how it gives way.
    """
    if scene.states:
        each = {name: drive_speed(scene.in_state(i)) for i, name in enumerate(scene.states.names)}
        known = [replace(found, state=name) for name, found in each.items() if found]
        return max(known, key=lambda found: found.needed, default=None)
    load, line = scene.load_case, scene.line
    if load is None or load.inertias is None or line.shape or not scene.speed:
        return None
    if scene.speed_recorded:
        return None
    inertias = np.asarray(load.inertias, dtype=np.float64)
    varying = {}
    for shaft in range(1, line.n_joints + 1):
        joint = line.equivalent(shaft)
        if inertias[shaft] > 0.0 and not is_cancelled(line, joint):
            varying[shaft] = float(joint.non_uniformity)
    if not any(varying.values()):
        return None
    shaft = max(varying, key=lambda shaft: inertias[shaft] * varying[shaft])
    shaft_variation = varying[shaft]
    free = line.free_running(inertias)
    needed = float(free.drive_inertia_for(SHARE * shaft_variation))
    verdict: SpeedVerdict = "no drive inertia"
    if inertias[0] > 0.0:
        verdict = "fair" if free.variation <= SHARE * shaft_variation else "not fair"
    return DriveSpeed(
        verdict, float(free.variation), shaft, shaft_variation, float(inertias[0]), needed
    )


def data(found: DriveSpeed, *, radians: bool = False) -> dict[str, Any]:
    """Return the same as plain data for JSON, as ``SCHEMA`` describes it."""
    return {
        "verdict": found.verdict,
        "variation": finite_or_none(found.variation),
        "shaft": found.shaft,
        "shaft_variation": finite_or_none(found.shaft_variation),
        "share": finite_or_none(found.share),
        "share_limit": SHARE,
        "inertia_kgm2": found.inertia,
        "needed_inertia_kgm2": finite_or_none(found.needed),
        "source": SOURCE,
        **({"state": found.state} if found.state else {}),
    }


_FIGURE = {"type": ["number", "null"]}

SCHEMA: Mapping[str, Any] = {
    "description": "variations are from peak to peak",
    **record(
        {
            "verdict": {"enum": ["fair", "not fair", "no drive inertia"]},
            "shaft": {"type": "integer", "minimum": 1},
            **dict.fromkeys(("variation", "shaft_variation", "share"), _FIGURE),
            "share_limit": {"type": "number"},
            "inertia_kgm2": {"type": "number"},
            "needed_inertia_kgm2": _FIGURE,
            "source": {"type": "string"},
        },
        {"state": {"type": "string", "description": "the state that needs most inertia"}},
    ),
}
"""JSON Schema of ``data``."""


def find(answer: Answer) -> DriveSpeed | None:
    """Return the figures of an answer's scene."""
    return drive_speed(answer.scene)
