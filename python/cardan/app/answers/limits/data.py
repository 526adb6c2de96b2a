"""Whether a scene, or all of its study, is within the limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.as_built.figures import AS_BUILT_SCHEMA, as_built_data, as_built_orders
from cardan.app.answers.axial_travel.figures import SLIDES_SCHEMA, scene_slides, slides_data
from cardan.app.answers.backlash.figures import BACKLASH_SCHEMA, backlash_data, scene_backlash
from cardan.app.answers.ball_joint.figures import (
    BALL_JOINT_SCHEMA,
    ball_joint_data,
)
from cardan.app.answers.drive_speed.figures import DRIVE_SPEED_SCHEMA, drive_speed_data
from cardan.app.answers.forces.figures import FORCES_SCHEMA, forces_data
from cardan.app.answers.json_schema import answer, answers_with, record
from cardan.app.answers.life.data import LIFE_PART, life_part
from cardan.app.answers.life.figures import life_figures
from cardan.app.answers.spline.figures import SLIP_SCHEMA, slip_data, slip_figures
from cardan.app.answers.states.figures import VERDICTS_SCHEMA, forces_of, verdicts_data
from cardan.app.answers.steering.figures import STEERING_SCHEMA, steering_data, steering_figures
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.tolerances.data import TOLERANCES_PART, tolerances_part
from cardan.app.answers.tolerances.figures import tolerance_figures
from cardan.app.answers.torsion.data import TORSION_CHECK_SCHEMA, torsion_check_data
from cardan.app.answers.torsion.modes import torsion_basics
from cardan.app.answers.tubes.figures import TUBES_SCHEMA, tube_figures, tubes_data
from cardan.app.answers.verdict import Verdict, verdict
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.scene import Scene
from cardan.app.scene.units import RPM
from cardan.design.judged import VERDICTS, Finding, non_uniformity

_ENDINGS = {"deg": "deg", "rad/s²": "rad_s2"}

_PRACTICE = {
    "bend_difference": "deg",
    "torsional_excitation": "rad_s2",
    "inertia_excitation_driving": "rad_s2",
    "inertia_excitation_coasting": "rad_s2",
}


def check_data(scene: Scene, judged: Verdict, advice: Sequence[str] = ()) -> dict[str, Any]:
    """Return a check as plain data for JSON, as ``CHECK_SCHEMA`` describes it.

    Args:
        scene: the scene that was checked.
        judged: the verdict on it, with its check.
        advice: what would bring it within the limits, a sentence each.
    """
    found = judged.motion
    assert found is not None
    by_figure = {finding.figure: finding for finding in found.findings}
    more: dict[str, Any] = {"drive_speed": drive_speed_data(scene)}
    if built := as_built_orders(scene):
        more["as_built"] = as_built_data(built)
    if (loose := scene_backlash(scene)) and scene.service.play:
        more["backlash"] = backlash_data(loose, scene.service.play)
    if forces := forces_of(scene):
        more["forces"] = forces_data(forces)
    if slip := slip_figures(scene):
        more["slip"] = slip_data(slip)
    if moved := scene_slides(scene):
        more["slides"] = slides_data(moved)
    if steered := steering_figures(scene):
        more["steering"] = steering_data(steered)
    if scene.states:
        more["states"] = verdicts_data(scene, found)
    if toleranced := tolerance_figures(scene):
        more["tolerances"] = tolerances_part(toleranced)
    if life := life_figures(scene):
        more["life"] = life_part(life)
    if tubes := tube_figures(scene):
        more["tubes"] = tubes_data(tubes)
    if compliant := torsion_basics(scene):
        more["torsion"] = torsion_check_data(compliant)
    if scene.ball_joint:
        more["ball_joint"] = ball_joint_data(scene.ball_joint)
    practice = {
        figure: _entry(by_figure[figure]) if figure in by_figure else None for figure in _PRACTICE
    }
    return answer(
        "check",
        scene.title,
        **_counts(found.ranks),
        **_overall(judged),
        preset=found.limits.preset,
        catalogue={
            **_verdict(found.catalogue.ranks),
            "equivalent_bend": _entry(by_figure["equivalent_bend"]),
        },
        practice={**_verdict(found.practice.ranks), **practice},
        advice=list(advice),
        **more,
    )


def ball_joint_check_data(scene: BallJointScene) -> dict[str, Any]:
    """Return the check of a ball joint alone as plain data for JSON."""
    data = ball_joint_data(scene.ball_joint)
    return answer("check", scene.title, **_overall(verdict(scene)), ball_joint=data)


def _overall(judged: Verdict) -> dict[str, Any]:
    return {"verdict": judged.word, "passes": judged.passes, "beyond": judged.beyond}


def _verdict(ranks: NDArray[np.int_]) -> dict[str, Any]:
    """The worst verdict, and how many drivelines have which."""
    return {"verdict": VERDICTS[int(np.max(ranks, initial=0))], **_counts(ranks)}


def _counts(ranks: NDArray[np.int_]) -> dict[str, Any]:
    counts = {
        name.replace(" ", "_"): int(np.count_nonzero(ranks == rank))
        for rank, name in enumerate(VERDICTS)
    }
    return {"drivelines": counts}


def _entry(finding: Finding) -> dict[str, Any]:
    """One figure as plain data."""
    unit, limit = _ENDINGS[finding.unit], finding.limit
    entry = {
        **_verdict(finding.ranks),
        f"value_{unit}": finite_or_none(finding.worst),
        f"limit_{unit}": limit.limit if limit else None,
        f"maximum_{unit}": limit.maximum if limit else None,
        f"margin_{unit}": finite_or_none(limit.limit - finding.worst) if limit else None,
        "source": limit.source if limit else None,
        "worst_at": [{"key": key, "value": value} for key, value in finding.worst_at.items()],
    }
    if finding.worst_in:
        entry["worst_in"] = finding.worst_in
    if finding.figure == "equivalent_bend" and limit:
        entry["non_uniformity"] = finite_or_none(non_uniformity(finding.worst))
        entry["non_uniformity_limit"] = non_uniformity(limit.limit)
    if finding.at_unit_speed is not None:
        for name, speeds in (
            ("within_up_to_rpm", finding.within_up_to),
            ("tolerable_up_to_rpm", finding.tolerable_up_to),
        ):
            entry[name] = finite_or_none(float(np.min(speeds, initial=math.inf)) / RPM)
    return entry


_NUMBER = {"type": ["number", "null"]}
_KEY = {"key": {"type": "string"}, "value": {"type": "number"}}
_VERDICT = {"enum": list(VERDICTS)}
_COUNTS = {
    "drivelines": record(
        {name.replace(" ", "_"): {"type": "integer", "minimum": 0} for name in VERDICTS}
    ),
}
_JUDGED = {"verdict": _VERDICT, **_COUNTS}


def _entry_schema(unit: str, more: Sequence[str]) -> dict[str, Any]:
    return record(
        {
            **_JUDGED,
            **{f"{name}_{unit}": _NUMBER for name in ("value", "limit", "maximum", "margin")},
            "source": {"type": ["string", "null"]},
            "worst_at": {"type": "array", "items": record(_KEY)},
            **dict.fromkeys(more, _NUMBER),
        },
        {"worst_in": {"type": "string", "description": "the state with the largest value"}},
    )


_SPEEDS = ("within_up_to_rpm", "tolerable_up_to_rpm")


def _practice(unit: str) -> dict[str, Any]:
    entry = _entry_schema(unit, _SPEEDS if unit == "rad_s2" else ())
    return {"oneOf": [entry, {"type": "null"}]}


CHECK_SCHEMA = answers_with(
    "check",
    "what cardan check prints with --json",
    {
        **_COUNTS,
        "preset": {"type": ["string", "null"]},
        "catalogue": record(
            {
                **_JUDGED,
                "equivalent_bend": _entry_schema("deg", ("non_uniformity", "non_uniformity_limit")),
            }
        ),
        "practice": record(
            {**_JUDGED, **{figure: _practice(unit) for figure, unit in _PRACTICE.items()}}
        ),
        "advice": {"type": "array", "items": {"type": "string"}},
    },
    {"ball_joint": BALL_JOINT_SCHEMA},
    needed={
        "verdict": {**_VERDICT, "description": "the worst of all that has a limit"},
        "passes": {"type": "boolean", "description": "whether nothing is beyond its maximum"},
        "beyond": {
            "type": "array",
            "items": {"type": "string"},
            "description": "what is beyond its limits besides the motion of the driveline",
        },
    },
    optional={
        "drive_speed": DRIVE_SPEED_SCHEMA,
        "as_built": AS_BUILT_SCHEMA,
        "backlash": BACKLASH_SCHEMA,
        "forces": FORCES_SCHEMA,
        "slip": SLIP_SCHEMA,
        "slides": SLIDES_SCHEMA,
        "steering": STEERING_SCHEMA,
        "states": VERDICTS_SCHEMA,
        "tolerances": TOLERANCES_PART,
        "life": LIFE_PART,
        "tubes": TUBES_SCHEMA,
        "torsion": TORSION_CHECK_SCHEMA,
    },
)
"""JSON Schema (draft 2020-12) of what ``check_data`` returns.

``value`` is the worst of a batch, a study or recorded bends, and ``worst_at`` the keys of a study
at which it occurs; ``drivelines`` counts them by verdict. A figure that the driveline does not have
is null, and so is a speed that is never reached.
"""
