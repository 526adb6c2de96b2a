"""Whether a scene, or all of its study, is within the limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.figures.answers import answer, answers_with, record
from cardan.app.figures.as_built import AS_BUILT_SCHEMA, as_built_data, as_built_orders
from cardan.app.figures.backlash import BACKLASH_SCHEMA, backlash_data, scene_backlash
from cardan.app.figures.ball_joint import (
    BALL_JOINT_SCHEMA,
    ball_joint_data,
    ball_joint_figures,
)
from cardan.app.figures.drive_speed import DRIVE_SPEED_SCHEMA, drive_speed_data
from cardan.app.figures.extremes import finite_or_none
from cardan.app.figures.life import life_figures
from cardan.app.figures.life_answer import LIFE_PART, life_part
from cardan.app.figures.rounding import alike
from cardan.app.figures.scene_forces import FORCES_SCHEMA, forces_data
from cardan.app.figures.slides import SLIDES_SCHEMA, scene_slides, slides_data
from cardan.app.figures.slip import SLIP_SCHEMA, slip_data, slip_figures
from cardan.app.figures.states import VERDICTS_SCHEMA, forces_of, verdicts_data
from cardan.app.figures.steering import STEERING_SCHEMA, steering_data, steering_figures
from cardan.app.figures.tolerance_answers import TOLERANCES_PART, tolerances_part
from cardan.app.figures.tolerances import tolerance_figures
from cardan.app.figures.torsion_answer import TORSION_CHECK_SCHEMA, torsion_check_data
from cardan.app.figures.torsion_modes import torsion_basics
from cardan.app.figures.tubes import TUBES_SCHEMA, tube_figures, tubes_data
from cardan.app.files.progress import Progress
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.scene import Scene
from cardan.app.scene.study import Study
from cardan.app.scene.units import RPM
from cardan.arrays import FloatArray
from cardan.design.check import Check
from cardan.design.judged import VERDICTS, Finding, non_uniformity
from cardan.driveline import Driveline

_ENDINGS = {"deg": "deg", "rad/s²": "rad_s2"}

_PRACTICE = {
    "bend_difference": "deg",
    "torsional_excitation": "rad_s2",
    "inertia_excitation_driving": "rad_s2",
    "inertia_excitation_coasting": "rad_s2",
}


def check_scene(scene: Scene, progress: Progress | None = None) -> Check:
    """Check the driveline of a scene, or all of its study or states, and say where the worst lies.

    ``progress`` is called after each block of the study with the rows done and all rows.
    """
    if scene.states:
        return check_states(scene, scene.drivelines())
    if scene.study is None or not scene.study.axes:
        known = scene.without_missing()
        # Bends that were recorded go with the speeds of their samples; of fixed ones the largest
        # speed is the worst.
        if known.line.shape and known.speed_recorded and known.load_case is not None:
            return known.line.check(known.load_case.speed, scene.limits)
        return known.line.check(scene.speed or None, scene.limits)
    turns = scene.speed != 0.0 or any(axis.key.startswith("speed_") for axis in scene.study.axes)
    blocks = []
    rows = math.prod(scene.study.shape)
    for first, line, load in scene.study.blocks():
        # Of a recorded speed the largest counts.
        speed = scene.speed if scene.speed_recorded else load.speed if load and turns else None
        blocks.append(line.check(speed, scene.limits).findings)
        if progress:
            progress(first + line.shape[0], rows)
    findings = []
    for parts in zip(*blocks, strict=True):
        value = _joined([part.value for part in parts])
        at_unit_speed = None
        if parts[0].at_unit_speed is not None:
            at_unit_speed = _joined([part.at_unit_speed for part in parts])
        worst_at = {} if parts[0].needs_speed else _worst_at(scene.study, value)
        findings.append(
            replace(parts[0], value=value, at_unit_speed=at_unit_speed, worst_at=worst_at)
        )
    return Check(tuple(findings), scene.limits)


def check_states(scene: Scene, lines: Driveline) -> Check:
    """Check the drivelines ``(states,)`` of the states of a scene, each at its own speed."""
    states = scene.states
    assert states
    loads = [states.load(i) for i in range(states.count)]
    speeds = np.array([scene.speed if load is None else load.speed for load in loads])
    # Of a recorded speed the largest counts.
    speed = scene.speed if scene.speed_recorded else speeds
    found = lines.check(speed if np.any(speed) else None, scene.limits)
    findings = []
    for finding in found.findings:
        value = np.broadcast_to(finding.value, (states.count,))
        worst = "" if finding.needs_speed else states.names[int(np.argmax(value))]
        findings.append(replace(finding, value=value, worst_in=worst))
    return Check(tuple(findings), scene.limits)


def _joined(parts: Sequence[FloatArray | None]) -> FloatArray:
    return np.concatenate([np.ravel(np.asarray(part)) for part in parts])


def _worst_at(study: Study, value: FloatArray) -> dict[str, float]:
    """The keys of a study on which its largest value depends, and their values there."""
    grid = value.reshape(study.shape)
    place: tuple[Any, ...] = np.unravel_index(np.argmax(grid), grid.shape)
    found = {}
    for number, axis in enumerate(study.axes):
        along = grid[(*place[:number], slice(None), *place[number + 1 :])]
        if not alike(float(np.min(along)), float(np.max(along))):
            found[axis.key] = float(axis.values[place[number]])
    return found


def check_data(scene: Scene, found: Check, advice: Sequence[str] = ()) -> dict[str, Any]:
    """Return a check as plain data for JSON, as ``CHECK_SCHEMA`` describes it.

    Args:
        scene: the scene that was checked.
        found: its check.
        advice: what would bring it within the limits, a sentence each.
    """
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
        **_verdict(found.ranks),
        passes=bool(np.all(found.passes)) and passes(scene),
        preset=found.limits.preset,
        catalogue={
            **_verdict(found.catalogue.ranks),
            "equivalent_bend": _entry(by_figure["equivalent_bend"]),
        },
        practice={**_verdict(found.practice.ranks), **practice},
        advice=list(advice),
        **more,
    )


def passes(scene: Scene | BallJointScene) -> bool:
    """Whether what a scene has besides its driveline is within what the scene allows."""
    return not parts_beyond(scene)


def parts_beyond(scene: Scene | BallJointScene) -> list[str]:
    """Return what a scene has besides its driveline that is beyond what the scene allows."""
    beyond = []
    if isinstance(scene, Scene):
        slip, steered, life = slip_figures(scene), steering_figures(scene), life_figures(scene)
        judged = {
            "the spline": slip is None or slip.passes,
            "the symmetry of the steering": steered is None or steered.passes,
            "the life of the joints": life is None or life.passes,
            **{f"the tube of shaft {tube.shaft}": tube.passes for tube in tube_figures(scene)},
        }
        beyond = [name for name, is_within in judged.items() if not is_within]
    if scene.ball_joint and not ball_joint_figures(scene.ball_joint).passes:
        beyond.append("the ball joint")
    return beyond


def ball_joint_check_data(scene: BallJointScene) -> dict[str, Any]:
    """Return the check of a ball joint alone as plain data for JSON."""
    data = ball_joint_data(scene.ball_joint)
    return answer("check", scene.title, passes=passes(scene), ball_joint=data)


def _verdict(ranks: NDArray[np.int_]) -> dict[str, Any]:
    """The worst verdict, and how many drivelines have which."""
    counts = {
        name.replace(" ", "_"): int(np.count_nonzero(ranks == rank))
        for rank, name in enumerate(VERDICTS)
    }
    return {"verdict": VERDICTS[int(np.max(ranks, initial=0))], "drivelines": counts}


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
_JUDGED = {
    "verdict": {"enum": list(VERDICTS)},
    "drivelines": record(
        {name.replace(" ", "_"): {"type": "integer", "minimum": 0} for name in VERDICTS}
    ),
}


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
        **_JUDGED,
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
    needed={"passes": {"type": "boolean", "description": "whether nothing is beyond its maximum"}},
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
