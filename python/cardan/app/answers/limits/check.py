"""The check of a scene's driveline, of all of its study or of its states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.app.answers.over import at_keys
from cardan.app.files.whole_file import Progress
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.design.check import Check
from cardan.design.judged import Finding
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


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
    blocks = []
    rows = math.prod(scene.study.shape)
    for first, line, load in scene.study.blocks():
        blocks.append(line.check(_speed(scene, load), scene.limits).findings)
        if progress:
            progress(first + line.shape[0], rows)
    findings = []
    for parts in zip(*blocks, strict=True):
        joined = _with(parts[0], _joined, *parts[1:])
        if np.isfinite(joined.value).any():
            at = at_keys(scene.study.axes, np.asarray(joined.value), joined.worst_place)
            joined = replace(joined, worst_at=at)
        findings.append(joined)
    return Check(tuple(findings), scene.limits)


def check_row(scene: Scene, row: int) -> Check:
    """Check one driveline of the study of a scene."""
    assert scene.study
    _, line, load = next(scene.study.blocks(range(row, row + 1)))
    speed = _speed(scene, load)
    return line[0, 0].check(None if speed is None else np.max(speed), scene.limits)


def _speed(scene: Scene, load: Load | None) -> FloatArray | float | None:
    """The speeds of drivelines of the study; of a recorded speed the largest counts."""
    axes = scene.study.axes if scene.study else ()
    turns = scene.speed != 0.0 or any(axis.key.startswith("speed_") for axis in axes)
    if scene.speed_recorded:
        return scene.speed
    return load.speed if load and turns else None


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
        each = _with(finding, lambda own: np.broadcast_to(own, (states.count,)))
        worst = "" if finding.needs_speed else states.names[each.worst_place]
        findings.append(replace(each, worst_in=worst))
    return Check(tuple(findings), scene.limits)


def _with(finding: Finding, made: Callable[..., FloatArray], *more: Finding) -> Finding:
    """A figure with what is made of its arrays, and of those of others of its kind."""
    arrays: dict[str, Any] = {}
    for name in ("value", "at_unit_speed", "limits", "maxima", "undecided"):
        each = [getattr(one, name) for one in (finding, *more)]
        if each[0] is not None:
            arrays[name] = made(*each)
    return replace(finding, **arrays)


def _joined(*parts: FloatArray) -> FloatArray:
    return np.concatenate([np.ravel(np.asarray(part)) for part in parts])
