"""The forces of a scene's bearings and joints over a turn, and why some are not known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import drivelines, limit_of, over
from cardan.app.answers.printed import items_text, place_of, quantity
from cardan.app.answers.rows import Judged, count, figure, item, parts
from cardan.app.answers.turn.extremes import peak, peaks
from cardan.app.answers.turn.figures import first_place, noise
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import LENGTHS_NEEDED, has_lengths
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS

_Row: TypeAlias = tuple[Judged, Any, Any, Any, Any, Any]

FORCES = ("joint_force", "bearing_force")
"""The outputs that are forces."""

ForceSource: TypeAlias = Literal["joint", "bearing"]
"""Kind of part on which a force acts."""


def force_source(output: str) -> ForceSource:
    """Return what an output is a force of."""
    return "joint" if OUTPUTS[output].per == "joint" else "bearing"


@dataclass(frozen=True)
class ForceFigures:
    """The force of one joint or bearing over a turn, in N if lengths are in metres."""

    output: str  # name of the output
    per: ForceSource  # what it is a force of
    item: int  # number of the joint or bearing
    largest: float  # the largest length of the force
    # Drive angles in rad within the period of the driveline, half a turn or with deviations a whole
    # one, at which it occurs, each again a period later; none if the force has the same length at
    # every angle.
    places: tuple[float, ...]
    mean: float  # length of the mean force
    order_1: float  # largest length of the part that changes once per turn; 0 of ideal joints
    order_2: float  # largest length of the part that changes twice per turn
    order_4: float  # likewise four times


def force_figures(
    line: Driveline, load: Load, outputs: Iterable[str] = FORCES
) -> list[ForceFigures]:
    """Return the figures of every joint and bearing of one driveline at a constant load.

    A ``ValueError`` says which force is not determinate, or that lengths are missing.
    """
    names = tuple(outputs)
    orders = line.harmonics((1, 2, 4), outputs=names, load=load)
    found = []
    for name in names:
        per = force_source(name)
        sums = zip(orders.mean[name], orders.complex_amplitude[name], strict=True)
        for place, (mean, amplitudes) in enumerate(sums):
            largest = peak(line, name, place, load)
            size = float(np.linalg.norm(mean))
            parts = (length(amplitudes[:, i]) for i in range(3))
            found.append(
                ForceFigures(name, per, place, largest.value, largest.places, size, *parts)
            )
    return found


def length(amplitude: NDArray[np.complex128]) -> float:
    """Return the largest length of ``Re(amplitude exp(i t))``, of a vector."""
    square = np.sum(np.abs(amplitude) ** 2) + np.abs(np.sum(amplitude**2))
    return math.sqrt(float(square) / 2.0)


# --- rows ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OverTurn:
    """The force of one joint or bearing; all but the largest in the state where that is worst."""

    number: int = item("")
    largest: Judged = figure("largest force", "N")
    at: float | None = figure(
        "at", "deg", "first drive angle at which it is largest", digits="phase"
    )
    mean: float | None = figure("mean", "N", "length of the mean force vector")
    order_1: float | None = figure(
        "order 1", "N", "largest part that changes once per turn, if the joints have deviations"
    )
    order_2: float | None = figure("order 2", "N", "largest part that changes twice per turn")
    order_4: float | None = figure("order 4", "N", "largest part that changes four times per turn")


@dataclass(frozen=True)
class JointForce(OverTurn):
    """The force of a joint on its driven shaft."""

    number: int = item("joint")
    largest: Judged = figure("largest force", "N", "over the turn", limit="[limits] joint_force_N")


@dataclass(frozen=True)
class BearingForce(OverTurn):
    """The force of a bearing on its shaft."""

    number: int = item("bearing")
    largest: Judged = figure(
        "largest force", "N", "over the turn", limit="[limits] bearing_force_N"
    )
    shaft: int = count("shaft")


@dataclass(frozen=True)
class Forces:
    """The forces over a turn at the load of a scene, in all of its states or its study.

    Those of the ``elastic`` bearings are by statics, without resonances.
    """

    joints: tuple[JointForce, ...] = parts("Forces of the joints")
    bearings: tuple[BearingForce, ...] = parts("Forces of the bearings")
    elastic: tuple[int, ...] = ()


def find(answer: Answer) -> Forces | None:
    """Return the forces of a scene over a turn.

    ``None`` where the scene has neither bearings nor limits of forces and asks for none, and, if
    it has no such limits, where there is no load, or where the bends or the load were recorded and
    so are not those of a turn.
    """
    scene = answer.scene
    line = scene.line
    limits = {name: limit_of(scene, f"{name}_N") for name in FORCES}
    limited = any(limits.values())
    why = unknown(scene)
    asked = line.n_bearings > 0 or any(name in FORCES for name in scene.quantities)
    if not limited and (why or not asked):
        return None
    joints, bearings = (_over_turn(scene, name, why, limits[name]) for name in FORCES)
    return Forces(
        tuple(JointForce(i, *row) for i, row in enumerate(joints)),
        tuple(
            BearingForce(i, *row, shaft)
            for i, (row, (shaft, _)) in enumerate(zip(bearings, line.bearings, strict=True))
        ),
        scene.lateral.elastic if scene.lateral else (),
    )


def _over_turn(scene: Scene, name: str, why: str, limit: dict[str, Any]) -> list[_Row]:
    """The figures of each joint or bearing; of those that are not known, why."""
    line = scene.line
    items = line.n_joints if force_source(name) == "joint" else line.n_bearings
    each = [scene.in_state(i) for i in range(scene.states.count)] if scene.states else [scene]
    try:
        if not why and items:
            found = [
                force_figures(one.line_as_built, one.load_case, [name])
                for one in each
                if one.load_case is not None
            ]
            sizes = _sizes(scene, name)
    except ArgumentValueError as error:
        # What the output is comes first; the reason follows.
        why = error.problem.partition("; ")[2]
    if why:
        return [(Judged(None, why=why, **limit), None, None, None, None, None)] * items
    rows: list[_Row] = []
    for i in range(items):
        own = [of_state[i].largest for of_state in found]
        worst = int(np.argmax(own))
        one, of_one = each[worst], found[worst][i]
        least, first_at = noise(one, "N"), first_place(one, of_one.places)
        values = np.array(own) if sizes is None else sizes[i]
        shown = (of_one.mean, of_one.order_1, of_one.order_2, of_one.order_4)
        mean, first, second, fourth = (0.0 if size <= least else size for size in shown)
        rows.append(
            (
                over(scene, np.where(values > least, values, 0.0), **limit),
                None if first_at is None or own[worst] <= least else math.radians(first_at),
                mean,
                first if scene.deviations is not None else None,
                second,
                fourth,
            )
        )
    return rows


def _sizes(scene: Scene, name: str) -> FloatArray | None:
    """The largest forces over the study, ``(items, rows)``; ``None`` without one."""
    if scene.study is None or not scene.study.axes:
        return None
    per = scene.line.n_joints if force_source(name) == "joint" else scene.line.n_bearings
    found = [
        peaks(lines, name, [*range(per)], load)[..., 0]
        for lines, load, _ in drivelines(scene, as_built=True)
    ]
    return np.concatenate(found, axis=-1)


def unknown(scene: Scene) -> str:
    """Return why a scene has no forces over a turn; "" if it has."""
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


def sentences(found: Forces) -> Iterator[str]:
    """Say why forces are missing, and which have resonances."""
    each: tuple[tuple[str, tuple[OverTurn, ...]], ...]
    each = (("joints", found.joints), ("bearings", found.bearings))
    for name, forces in each:
        if forces and (why := forces[0].largest.why):
            yield f"The forces of the {name} are not known: {why}."
    if found.elastic:
        bearings = items_text("bearing", found.elastic)
        yield (
            f"The force of {bearings} is that by statics; the lateral vibration has it over the "
            "speeds, with resonances."
        )


def largest_text(found: Forces) -> str:
    """Say which bearing bears the largest force; nothing without bearings."""
    force = max(found.bearings, key=lambda force: force.largest.value or 0.0, default=None)
    if force is None or not force.largest.value:
        return ""
    at = (
        ""
        if force.at is None
        else f", at {quantity(force.at, 'deg', digits='phase')} of drive angle"
    )
    return (
        f"Largest bearing force: bearing {force.number}, shaft {force.shaft}, "
        f"{quantity(force.largest, 'N')}{place_of(force.largest)}{at}."
    )
