"""A figure over the states or the study of a scene: its worst value, where it is, and its limit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.rounding import alike
from cardan.app.answers.rows import Judged
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.driveline import Driveline


def over(
    scene: Scene,
    values: FloatArray,
    limit: float | None = None,
    sense: Literal["most", "least"] = "most",
    **more: Any,  # noqa: ANN401 - further fields of Judged
) -> Judged:
    """Return the worst of the values of a figure, with its place and its limit.

    Args:
        scene: the scene.
        values: one for each state, for each driveline of the study, or a single one.
        limit: what they are judged against.
        sense: whether that is the most or the least.
        **more: further fields of ``Judged``.
    """
    place = int(np.argmax(values) if sense == "most" else np.argmin(values))
    found = Judged(float(values[place]), limit, sense=sense, **more)
    state, at, each = "", {}, {}
    if scene.states:
        each = dict(zip(scene.states.names, map(float, values), strict=True))
        if not alike(float(np.min(values)), float(np.max(values))):
            state = scene.states.names[place]
    elif scene.study and scene.study.axes and values.size > 1:
        at = at_keys(scene, values, place)
    return replace(found, state=state, at=at, each=each)


def drivelines(scene: Scene) -> Iterator[Driveline]:
    """Yield the drivelines that a scene judges, ``(rows,)`` each: its states, its study, or one."""
    if scene.states is None and scene.study and scene.study.axes:
        yield from (lines[:, 0] for _, lines, _ in scene.study.blocks())
    else:
        yield scene.drivelines()


def at_keys(scene: Scene, values: FloatArray, place: int) -> dict[str, float]:
    """Return the keys of a study on which values depend at a place, and their values there."""
    study = scene.study
    assert study
    grid = values.reshape(study.shape)
    index: tuple[Any, ...] = np.unravel_index(place, grid.shape)
    at = {}
    for number, axis in enumerate(study.axes):
        along = grid[(*index[:number], slice(None), *index[number + 1 :])]
        if not alike(float(np.min(along)), float(np.max(along))):
            at[axis.key] = float(axis.values[index[number]])
    return at
