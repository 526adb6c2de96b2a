"""Whether a scene, or all of its study, keeps the limits."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.check import Check
from cardan.figures.rounding import alike
from cardan.files.progress import Progress
from cardan.scene.scene import Scene
from cardan.scene.study import Study


def check_scene(scene: Scene, progress: Progress | None = None) -> Check:
    """Check the driveline of a scene, or all of its study and say where the worst of it lies.

    ``progress`` is called after each block of the study with the rows done and all rows.
    """
    if scene.study is None or not scene.study.axes:
        return scene.without_missing().line.check(scene.speed or None)
    blocks = []
    rows = math.prod(scene.study.shape)
    for first, line, load in scene.study.blocks():
        speed = load.speed if load and np.any(load.speed) else None
        blocks.append(line.check(speed).findings)
        if progress:
            progress(first + line.shape[0], rows)
    findings = []
    for parts in zip(*blocks, strict=True):
        value = np.concatenate([np.ravel(part.value) for part in parts])
        findings.append(replace(parts[0], value=value, worst_at=_worst_at(scene.study, value)))
    return Check(tuple(findings))


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
