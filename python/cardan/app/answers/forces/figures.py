"""The forces of a scene's bearings and joints over a turn, and why some are not known."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.paths import ForcePath, force_paths
from cardan.app.answers.forces.turn_forces import FORCES, ForceFigures, force_figures
from cardan.app.answers.json_schema import ANGLE, one_of, record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.turn.figures import first_place, noise
from cardan.app.scene.bearings import LENGTHS_NEEDED, has_lengths
from cardan.app.scene.scene import Scene
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline


@dataclass(frozen=True)
class Force:
    """The force of one joint or bearing of a scene.

    Attributes:
        figures: its figures in N; what is mere rounding is 0.
        shaft: the shaft of the bearing; ``None`` for a joint.
        at_deg: the first drive angle of the scene in degrees at which it is largest; ``None`` if it
            occurs at every angle, or not between the scene's drive angles.
        state: over states, the name of the one in which it is largest, to which the figures belong.
    """

    figures: ForceFigures
    shaft: int | None
    at_deg: float | None
    state: str = ""


@dataclass(frozen=True)
class SceneForces:
    """What a scene tells of forces.

    Attributes:
        forces: of the joints, then of the bearings.
        refused: the reason by output for those that are not determinate.
        has_order_1: whether the joints deviate from the drawing, so that forces change once per
            turn as well.
    """

    forces: tuple[Force, ...]
    refused: Mapping[str, str]
    has_order_1: bool = False


def scene_forces(scene: Scene) -> SceneForces | None:
    """Return the forces over a turn at the load of a scene.

    ``None`` where the scene describes no bearings and asks for no forces, where it has no load, or
    where the bends or the load were recorded and so are not those of a turn.
    """
    line, load = scene.line_as_built, scene.load_case
    asked = line.n_bearings > 0 or any(name in FORCES for name in scene.quantities)
    if not asked or load is None or _unknown(scene):
        return None
    least = noise(scene, "N")
    found: list[Force] = []
    refused = {}
    for name in _outputs(line):
        try:
            rows = force_figures(line, load, [name])
        except ArgumentValueError as error:
            # What the output is comes first; the reason follows.
            refused[name] = error.problem.partition("; ")[2]
            continue
        for row in rows:
            own = replace(
                row,
                largest=_rounded(row.largest, least),
                places=row.places if row.largest > least else (),
                mean=_rounded(row.mean, least),
                order_1=_rounded(row.order_1, least),
                order_2=_rounded(row.order_2, least),
                order_4=_rounded(row.order_4, least),
            )
            shaft = line.bearings[row.item][0] if row.per == "bearing" else None
            found.append(Force(own, shaft, first_place(scene, own.places)))
    return SceneForces(tuple(found), refused, line.has_deviations)


def scene_force_paths(scene: Scene) -> list[ForcePath]:
    """Return the paths of the forces of a scene's joints and bearings that are determinate.

    Those that bear no force have none. Over states, each is that of the state in which the force is
    largest.

    Raises:
        ValueError: there are none; the message says why.
    """
    if scene.states:
        return _largest_paths(scene, scene.states.names)
    line, load = scene.line_as_built, scene.load_case
    if reason := _unknown(scene):
        raise ValueError(f"{scene.name}: forces have no path over a turn: {reason}")
    assert load is not None
    found: list[ForcePath] = []
    problems = []
    for name in _outputs(line):
        try:
            paths = force_paths(line, load, [name])
        except ArgumentValueError as error:
            problems.append(error.problem.partition("; ")[2])
        else:
            least = noise(scene, "N")
            found += [path for path in paths if path.size > least]
    if not found:
        reason = f"not determinate: {problems[0]}" if problems else "all 0"
        raise ValueError(f"{scene.name}: forces are {reason}")
    return found


def _largest_paths(scene: Scene, names: Sequence[str]) -> list[ForcePath]:
    found: dict[tuple[str, int], ForcePath] = {}
    reason: ValueError | None = None
    for i, name in enumerate(names):
        try:
            paths = scene_force_paths(scene.in_state(i))
        except ValueError as error:
            reason = error
            continue
        for path in paths:
            key = (path.per, path.item)
            if key not in found or path.size > found[key].size:
                found[key] = replace(path, state=name)
    if not found and reason:
        raise reason
    return list(found.values())


def _outputs(line: Driveline) -> tuple[str, ...]:
    return FORCES if line.n_bearings else FORCES[:1]


def _unknown(scene: Scene) -> str:
    """Why a scene has no forces over a turn; "" if it has."""
    line, load = scene.line, scene.load_case
    if not has_lengths(line):
        return f"they need {LENGTHS_NEEDED}"
    if line.shape:
        return "its bends were recorded"
    if load is None or (not np.any(load.torque) and load.inertias is None):
        return "they need a torque or inertias in [load]"
    if any(np.ndim(part) for part in (load.torque, load.speed, load.acceleration)):
        return "its speed or its torque was recorded"
    return ""


def _rounded(size: float, least: float) -> float:
    return 0.0 if size <= least else size


_PARTS = ("largest", "mean", "order_2", "order_4")
_PARTS_AS_BUILT = ("largest", "mean", "order_1", "order_2", "order_4")


# --- plain data --------------------------------------------------------------------------------


def data(found: SceneForces, *, radians: bool = False) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SCHEMA`` describes it."""
    return {
        "figures": [_entry(force, found.has_order_1, radians) for force in found.forces],
        "not_determinate": [
            {"quantity": name, "reason": reason} for name, reason in found.refused.items()
        ],
    }


def _entry(force: Force, has_order_1: bool, radians: bool) -> dict[str, Any]:
    row, parts = force.figures, _PARTS_AS_BUILT if has_order_1 else _PARTS
    entry: dict[str, Any] = {row.per: row.item}
    if force.shaft is not None:
        entry["shaft"] = force.shaft
    entry |= {f"{part}_N": finite_or_none(getattr(row, part)) for part in parts}
    if force.state:
        entry["state"] = force.state
    if force.at_deg is not None:
        angle, turned = ("rad", math.radians) if radians else ("deg", float)
        entry[f"at_drive_angle_{angle}"] = turned(force.at_deg)
    return entry


_FORCE = {"type": ["number", "null"], "description": "null if it is not finite"}
_COUNT = {"type": "integer", "minimum": 0}

SCHEMA: Mapping[str, Any] = {
    "description": "forces over a turn, of joints and bearings, at the load of the scene",
    **record(
        {
            "figures": {
                "type": "array",
                "items": one_of(
                    {
                        "largest_N": _FORCE,
                        "mean_N": {**_FORCE, "description": "length of the mean force vector"},
                        **{
                            f"order_{order}_N": {
                                **_FORCE,
                                "description": f"largest part that changes {times} times per turn",
                            }
                            for order, times in ((2, "two"), (4, "four"))
                        },
                    },
                    {"joint": _COUNT, "bearing": _COUNT},
                    optional={
                        "shaft": {**_COUNT, "description": "of a bearing"},
                        "order_1_N": {
                            **_FORCE,
                            "description": "largest part that changes once per turn, if the joints "
                            "have deviations",
                        },
                        "state": {
                            "type": "string",
                            "description": "the state in which the force is largest; all figures "
                            "are those of this state",
                        },
                        **{f"at_drive_angle_{angle}": {"type": "number"} for angle in ANGLE},
                    },
                ),
            },
            "not_determinate": {
                "type": "array",
                "description": "what statics alone does not determine, and why",
                "items": record({"quantity": {"enum": list(FORCES)}, "reason": {"type": "string"}}),
            },
        }
    ),
}
"""JSON Schema of ``data``."""


def find(answer: Answer) -> SceneForces | None:
    """Return the forces of a scene over a turn; over its states, those of the worst state of each.

    ``None`` as for ``scene_forces``.
    """
    scene, states = answer.scene, answer.scene.states
    if states is None:
        return scene_forces(scene)
    each = [scene_forces(scene.in_state(i)) for i in range(states.count)]
    found = [(name, forces) for name, forces in zip(states.names, each, strict=True) if forces]
    if not found:
        return None
    refused: dict[str, str] = {}
    worst: dict[tuple[str, int], Force] = {}
    for name, forces in found:
        refused |= forces.refused
        for force in forces.forces:
            key = (force.figures.per, force.figures.item)
            if key not in worst or force.figures.largest > worst[key].figures.largest:
                worst[key] = replace(force, state=name)
    return SceneForces(tuple(worst.values()), refused, scene.deviations is not None)
