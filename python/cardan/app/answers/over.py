"""A figure over the states or the study of a scene: its worst value, where it is, and its limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, Literal

import numpy as np

from cardan.app.answers.printed import place_text
from cardan.app.answers.rounding import alike
from cardan.app.answers.rows import UNITS, Judged
from cardan.app.answers.turn.extremes import peaks
from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.units import split
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.life import DutyCycle
from cardan.app.scene.study.axes import Axis
from cardan.arrays import FloatArray
from cardan.design.check import Check
from cardan.design.judged import Finding
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

MOST_LISTED = 100
"""Drivelines of a study up to which a figure has its value for each."""


def over(
    scene: Scene,
    values: FloatArray,
    limit: float | None = None,
    sense: Literal["most", "least"] = "most",
    names: Sequence[str] | None = None,
    **more: Any,  # noqa: ANN401 - further fields of Judged
) -> Judged:
    """Return the worst of the values of a figure, with its place and its limit.

    There is one for each state, for each driveline of the study, or a single one; ``names`` says
    what they are those of, if not of the states.
    """
    place = int(np.argmax(values) if sense == "most" else np.argmin(values))
    found = Judged(float(values[place]), limit, sense=sense, **more)
    state, at, each = "", {}, {}
    if names is None and scene.states:
        names = scene.states.names
    if names:
        each = dict(zip(names, map(float, values), strict=True)) if len(names) > 1 else {}
        if not alike(float(np.min(values)), float(np.max(values))):
            state = names[place]
    elif scene.study and scene.study.axes and values.size > 1:
        at = at_keys(scene.study.axes, values, place)
        if values.size <= MOST_LISTED:
            points = product(*(axis.values.tolist() for axis in scene.study.axes))
            rows = (dict(zip(scene.study.axes, point, strict=True)) for point in points)
            called = [
                place_text({axis.key: own for axis, own in row.items() if axis.values.size > 1})
                for row in rows
            ]
            each = dict(zip(called, map(float, values), strict=True))
    return replace(found, state=state, at=at, each=each)


def limit_of(scene: Scene, key: str) -> dict[str, Any]:
    """Return the fields of ``Judged`` that a key of [limits] gives; none if the scene lacks it."""
    found = scene.part_limits.get(key)
    if found is None:
        return {}
    factor = UNITS[split(key)[1]].factor
    maximum = None if found.maximum == found.limit else found.maximum / factor
    return {"limit": found.limit / factor, "maximum": maximum, "source": found.source}


def drivelines(
    scene: Scene, *, as_built: bool = False
) -> Iterator[tuple[Driveline, Load | None, DutyCycle | None]]:
    """Yield the drivelines that a scene judges, ``(places, 1)``, with their load and duty cycle.

    The places are its states, blocks of its study, or the drawing alone. Of a recording the second
    axis are the samples. As built, the joints have their deviations.
    """
    duty, states = scene.duty, scene.states
    blocks: Iterable[tuple[Driveline, Load | None, DutyCycle | None]]
    if scene.study and varies(scene):
        of_study = scene.study.blocks()
        blocks = ((line, load, duty and duty.of(line, load)) for _, line, load in of_study)
    elif states:
        loads = states.loads(scene.load_case)
        blocks = [(states.drivelines().reshape(-1, 1), loads and loads.at_any_angle(), duty)]
    else:
        known = scene.without_missing()
        blocks = [(known.line.reshape(1, -1), known.load_case, duty)]
    for line, load, own in blocks:
        if as_built and scene.deviations is not None:
            line = line.with_deviations(*scene.deviations.T)
        yield line, load, own


def varies(scene: Scene) -> bool:
    """Return whether a scene has a study of more than one driveline."""
    return bool(scene.study and scene.study.axes)


def largest_torques(scene: Scene, line: Driveline, load: Load, shafts: Sequence[int]) -> FloatArray:
    """Return the largest torques of shafts over a turn, ``(shafts, places, steps)``.

    Recorded loads and bends count as they are.
    """
    if np.ndim(load.speed + load.torque) == 1 or scene.line.shape:
        angle = scene.study.angle if scene.study else scene.without_missing().angle
        found = line.evaluate(angle, "torque", shafts=[*shafts], load=load)
        return np.asarray(np.abs(found.torque))
    return peaks(line, "torque", [*shafts], load)


@dataclass(frozen=True)
class Wherever:
    """A figure wherever a driveline runs: as it stands, and in its duty cycle."""

    scene: Scene
    # Of drivelines with their load, ``(items, places, steps)``, if it is known.
    figure: Callable[[Driveline, Load | None], FloatArray | None]
    sense: Literal["most", "least"] = "most"

    def worst(
        self, item: int, limit: float | None = None, why: str = "", factor: float = 1.0
    ) -> Judged | None:
        """Return the worst value of an item with its place, ``None`` if it is not known.

        ``why`` says why it is not known, for a limit that cannot be judged.
        """
        values, names = self._found
        if values is None:
            return None if limit is None else Judged(None, limit, sense=self.sense, why=why)
        return over(self.scene, factor * values[item], limit, self.sense, names)

    @cached_property
    def _found(self) -> tuple[FloatArray | None, Sequence[str] | None]:
        """The values, ``(items, places)``, and what the places are called."""
        scene, pick = self.scene, np.max if self.sense == "most" else np.min
        found: list[FloatArray] = []
        for line, load, duty in drivelines(scene):
            own = self.figure(line, load)
            steps = self.figure(duty.line, duty.load) if duty and duty.values else None
            alone = not varies(scene) and not (scene.states and duty and not duty.is_set)
            if duty and steps is not None and alone:
                if own is None:
                    return steps[:, 0], duty.names
                first = scene.states.names if scene.states else ("the drawing",)
                every = np.concatenate([steps[:, 0], pick(own, -1)], axis=1)
                return every, (*duty.names, *first)
            known = [pick(each, -1) for each in (own, steps) if each is not None]
            found += [pick(np.stack(known), 0)] if known else []
        return (np.concatenate(found, axis=1), None) if found else (None, None)


def at_keys(
    axes: Sequence[Axis], values: FloatArray, place: int, rounding: float | None = None
) -> dict[str, float]:
    """Return the keys of a study on which values depend at a place, and their values there.

    The place counts the grid's values in order. What differs by less than a rounding, or as
    ``alike`` has it, does not count.
    """
    grid = values.reshape([len(axis.values) for axis in axes])
    index: tuple[Any, ...] = np.unravel_index(place, grid.shape)
    at = {}
    for number, axis in enumerate(axes):
        along = grid[(*index[:number], slice(None), *index[number + 1 :])]
        low, high = float(np.nanmin(along)), float(np.nanmax(along))
        if not (alike(low, high) if rounding is None else high - low <= rounding):
            at[axis.key] = float(axis.values[index[number]])
    return at


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
        joined = _with(parts[0], lambda *own: np.concatenate([*map(np.ravel, own)]), *parts[1:])
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
