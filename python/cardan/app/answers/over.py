"""A figure over the states or the study of a scene: its worst value, where it is, and its limit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.rounding import alike
from cardan.app.answers.rows import UNITS, Judged
from cardan.app.scene.scene import Scene
from cardan.app.scene.units import split
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


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


def limit_of(scene: Scene, key: str) -> dict[str, Any]:
    """Return the fields of ``Judged`` that a key of [limits] gives; none if the scene lacks it."""
    found = scene.part_limits.get(key)
    if found is None:
        return {}
    factor = UNITS[split(key)[1]].factor
    maximum = None if found.maximum == found.limit else found.maximum / factor
    return {"limit": found.limit / factor, "maximum": maximum, "source": found.source}


def cases(scene: Scene, *, as_built: bool = False) -> Iterator[tuple[Driveline, Load | None]]:
    """Yield the drivelines that a scene judges, ``(rows, 1)``, with their loads.

    They are those of its states, one by one, those of its study in blocks, or its only one.

    Args:
        scene: the scene.
        as_built: whether the joints have their deviations.
    """
    if scene.states:
        for i in range(scene.states.count):
            yield from cases(scene.in_state(i), as_built=as_built)
        return
    blocks: Iterable[tuple[int, Driveline, Load | None]]
    blocks = [(0, scene.line.reshape(1, 1), scene.load_case)]
    if scene.study and scene.study.axes:
        blocks = scene.study.blocks()
    for _, lines, load in blocks:
        if as_built and scene.deviations is not None:
            yield lines.with_deviations(*scene.deviations.T), load
        else:
            yield lines, load


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
