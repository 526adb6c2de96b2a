"""The smallest single changes that bring everything about a scene's machine within its limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.rows import count, figure, word
from cardan.app.scene.machine import machine_of
from cardan.app.scene.scene import Scene
from cardan.design.machine import Change

# Points, bearings and the engaged length are tried up to this share of the length of the driveline.
_REACH = 0.05

# The parts that a machine has, and their figures that it does not: its heat is that of each step,
# its tubes have no half of a critical speed.
_TRIED = ("limits", "states", "forces", "spline", "steering", "backlash", "life", "tubes")
_UNTRIED = ("heat", "of_sizes", "half")

Variable = Literal["point", "phase", "bearing", "engaged", "rating"]


@dataclass(frozen=True)
class Move:
    """One change of the machine and what it leaves; ``None`` where another variable changes."""

    variable: Variable = word("variable", "what changes")
    number: int = count("number", "of the point from upstream, of the shaft, bearing or joint")
    of: str = word("of", "the same in words")
    axis: str | None = word("axis", "of a point")
    shift: float | None = figure("by", "mm", "of a point, a bearing or the engaged length")
    turn: float | None = figure("turned by", "deg", "of the output-side yoke of a shaft")
    rating: float | None = figure("rating", "Nm", "of a joint, in place of the one it has")
    verdict: str = word("verdict then")
    left: str | None = word("what is then worst")
    untried: str = word("not tried", "what else has a limit, which this search leaves out")


def find(answer: Answer) -> tuple[Move, ...]:
    """Return the changes, smallest first; none where everything is within its limits."""
    machine = machine_of(answer.scene)
    if machine is None:
        return ()
    scene = answer.scene
    found = machine.suggest(**search(scene))
    untried = [
        each.name
        for each in answer.judged
        if each.value.limit is not None
        and (each.part.name not in _TRIED or each.entry.path.rpartition(".")[2] in _UNTRIED)
    ]
    held = set_by_states(scene)
    return tuple(
        _move(change, scene.line.n_joints, ", ".join(untried))
        for change in found
        if (change.variable, change.item) not in held
    )


def search(scene: Scene) -> dict[str, Any]:
    """Return how far the search goes in a scene, the arguments of ``Machine.suggest``."""
    joints = scene.sizes
    sizes = [size.rating for size in joints.table if size.rating] if joints else []
    return {
        "reach": _REACH * float(np.sum(scene.line._geometry.lengths)),
        "teeth": scene.teeth,
        "ratings": sorted(set(sizes)),
    }


def set_by_states(scene: Scene) -> set[tuple[str, int]]:
    """Return variables and items that the states set, which no change of the drawing reaches."""
    # A change of the drawing turns with what a state turns.
    found = set(scene.states.turned) if scene.states else set()
    if scene.states and scene.states.set_phases:
        found |= {("phase", shaft) for shaft in range(scene.line.n_joints)}
    return found


def _move(change: Change, joints: int, untried: str) -> Move:
    by = change.change
    return Move(
        change.variable,
        change.item,
        _of(change, joints),
        None if change.axis is None else "xyz"[change.axis],
        by if change.variable in ("point", "bearing", "engaged") else None,
        by if change.variable == "phase" else None,
        change.end if change.variable == "rating" else None,
        change.verdict,
        None
        if change.worst is None or change.verdict == "within"
        else change.worst.kind.name.replace("_", " "),
        untried,
    )


def _of(change: Change, joints: int) -> str:
    if change.variable == "point":
        ends = {0: "the upstream end", joints + 1: "the downstream end"}
        return ends.get(change.item, f"joint {change.item - 1}")
    whose = {"phase": "shaft", "bearing": "bearing", "engaged": "the spline of shaft"}
    return f"{whose.get(change.variable, 'joint')} {change.item}"
