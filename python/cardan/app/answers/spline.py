"""The spline of a scene: its travel over the study or states, what is left of it, its force."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import drivelines, largest_torques, over
from cardan.app.answers.printed import place_of, quantity
from cardan.app.answers.rows import Judged, count, figure, item, parts, word
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.slip import Slip
from cardan.arrays import FloatArray
from cardan.driveline import Driveline

# A shaft without a spline may change its length by this much, in m: less than any play.
_FIXED = 1e-5


@dataclass(frozen=True)
class Support:
    """Effect of the axial force on a shaft that holds the sliding one."""

    shaft: int = item("shaft")
    side: Literal["upstream", "downstream"] = word("side", "seen from the sliding shaft")
    axial: float = figure("force along it", "N", "largest part along that shaft")
    transverse: float = figure("force across it", "N", "largest part across it, at the joint")


@dataclass(frozen=True)
class BearingLoad:
    """Load of the axial force on a bearing of the shafts that hold the sliding one."""

    bearing: int = item("bearing")
    on_shaft: int = count("shaft", "shaft of the bearing")
    force: float = figure("radial force", "N", "largest over the states")


@dataclass(frozen=True)
class OtherShaft:
    """A shaft without a spline that changes its length."""

    shaft: int = item("shaft")
    travel: float = figure("travel", "mm", "longest less shortest length")


@dataclass(frozen=True)
class SplineFigures:
    """How a spline is used over the states or the study of a scene."""

    shaft: int = item("shaft")
    drivelines: int = count("drivelines", "states or drivelines of the study")
    length: float = figure(
        "length at the points of the scene", "mm", "distance of the joint centres"
    )
    shortest: Judged | None = figure("shortest length", "mm", "over the states or the study")
    longest: Judged | None = figure("longest length", "mm", "over the states or the study")
    travel: Judged | None = figure(
        "travel", "mm", "longest less shortest length", limit="[slip] travel_mm"
    )
    engaged: Judged | None = figure(
        "engaged length",
        "mm",
        "least length over which hub and shaft of the spline overlap",
        source="engaged length at the points of the scene less what the shaft grows",
        limit="[slip] least_engaged_mm",
    )
    push_in: Judged | None = figure(
        "left to push in",
        "mm",
        "what is left until the spline bottoms at the shortest length",
        limit="[slip] push_in_mm",
    )
    torque: Judged | None = figure("largest torque of the shaft", "Nm", "over the turn")
    force: float | None = figure(
        "largest axial force",
        "N",
        "while the spline slides under torque",
        source="friction times torque over the pitch radius",
    )
    no_force: str = word("axial force", "why it is not computed, although the scene gives friction")
    supports: tuple[Support, ...] = parts(
        "The axial force on the shafts that hold it", "what the force does to its neighbours"
    )
    bearings: tuple[BearingLoad, ...] = parts(
        "Added to the bearings", "across the shafts that hold the sliding one"
    )
    others: tuple[OtherShaft, ...] = parts(
        "Shafts without a spline that change their length", "by more than any play"
    )


def find(answer: Answer) -> SplineFigures | None:
    """Return how the spline of a scene is used over its study or states; ``None`` without one."""
    scene, slip = answer.scene, answer.scene.slip
    if slip is None:
        return None
    blocks = zip(*_places(scene, slip), strict=True)
    lengths, torques, bends, radial = (np.concatenate(parts) for parts in blocks)
    own, several = lengths[:, slip.shaft], len(lengths) > 1
    length = float(scene.line.lengths().each[slip.shaft])
    longest = over(scene, own)
    shortest = over(scene, own, sense="least")
    assert longest.value is not None
    assert shortest.value is not None
    torque: Judged | None = None
    force: float | None = None
    supports: tuple[Support, ...] = ()
    if np.isfinite(torques).all():
        torque = over(scene, torques)
        assert slip.friction is not None
        assert slip.radius is not None
        forces = slip.friction * torques / slip.radius
        force = float(np.max(forces))
        supports = _supports(slip, forces, bends)
    shafts = scene.line.spline_force(slip.shaft, 0.0, 0.0, 1.0).bearings
    travelled = np.max(lengths, axis=0) - np.min(lengths, axis=0)
    if moves(scene):
        travel = Judged(longest.value - shortest.value, _m(slip.travel), size=length)
    else:
        travel = Judged(None, _m(slip.travel), why="needs [states] or a [study] of points")
    return SplineFigures(
        slip.shaft,
        len(own),
        length,
        shortest if several else None,
        longest if several else None,
        travel if several or slip.travel is not None else None,
        _engaged(slip, own - length, scene, length),
        _push_in(slip, own - length, scene, length),
        torque,
        force,
        ""
        if torque or slip.friction is None
        else "the section [load] gives no torque and no inertia",
        supports,
        tuple(
            BearingLoad(i, shafts[i], float(largest))
            for i, largest in enumerate(np.max(radial, axis=0))
            if largest > 0.0
        ),
        tuple(
            OtherShaft(shaft, float(travel))
            for shaft, travel in enumerate(travelled)
            if shaft != slip.shaft and travel > _FIXED
        ),
    )


def moves(scene: Scene) -> bool:
    """Return whether states or a study give shafts several lengths."""
    given = scene.states or scene.study
    return any(
        axis.name.startswith(("points", "lengths")) for axis in (given.axes if given else ())
    )


def _m(millimetres: float | None) -> float | None:
    return None if millimetres is None else 1e-3 * millimetres


def _engaged(slip: Slip, growth: FloatArray, scene: Scene, length: float) -> Judged | None:
    if slip.engaged is None:
        return None
    left = 1e-3 * slip.engaged - growth
    limit = _m(slip.least_engaged)
    if limit is None and np.min(left) < 0.0:
        # What has come apart is beyond, whatever limit is given.
        return over(scene, left, 0.0, "least", size=length, source="a spline must not come apart")
    return over(scene, left, limit, "least", size=length)


def _push_in(slip: Slip, growth: FloatArray, scene: Scene, length: float) -> Judged | None:
    if slip.push_in is None:
        return None
    left = 1e-3 * slip.push_in + growth
    return over(scene, left, 0.0, "least", size=length, source="a spline must not bottom")


def _places(scene: Scene, slip: Slip) -> Iterator[tuple[FloatArray, ...]]:
    """Lengths, torque of the shaft, bends and forces of bearings, a row per driveline."""
    for lines, load, _ in drivelines(scene):
        torques = np.full(lines.shape[0], np.nan)
        loaded = load and (load.inertias is not None or np.any(load.torque != 0.0))
        if load and loaded and slip.friction is not None:
            torques = np.max(largest_torques(scene, lines, load, [slip.shaft])[0], axis=-1)
        drawn = lines[:, 0]
        yield drawn.lengths().each, torques, drawn.bends, _radial(slip, drawn, torques)


def _radial(slip: Slip, lines: Driveline, torques: FloatArray) -> FloatArray:
    """Return the force added to each bearing, ``(rows, bearings)``; no bearing if unknown."""
    if slip.friction is None or slip.radius is None or not np.isfinite(torques).all():
        return np.zeros((len(torques), 0))
    found = lines.spline_force(slip.shaft, torques, slip.friction, slip.radius)
    try:
        forces = found.bearing_force
    except ValueError:
        return np.zeros((len(torques), 0))
    return np.asarray(np.linalg.norm(forces, axis=-1).T)


def _supports(slip: Slip, forces: FloatArray, bends: FloatArray) -> tuple[Support, ...]:
    """Largest parts over the states: cosine and sine of the bend at that end of the shaft."""
    # An end of the driveline is straight.
    beside = np.pad(bends, ((0, 0), (1, 1)))
    sides: tuple[tuple[Literal["upstream", "downstream"], int, FloatArray], ...] = (
        ("upstream", max(slip.shaft - 1, 0), beside[:, slip.shaft]),
        ("downstream", min(slip.shaft + 1, bends.shape[-1]), beside[:, slip.shaft + 1]),
    )
    return tuple(
        Support(
            shaft,
            side,
            float(np.max(forces * np.cos(bend))),
            float(np.max(forces * np.sin(bend))),
        )
        for side, shaft, bend in sides
    )


def sentences(found: SplineFigures) -> Iterator[str]:
    """Say whether the spline suffices, what to change if not, and what the force loads."""
    yield from _verdict(found)
    for other in found.others:
        yield (
            f"Shaft {other.shaft} changes its length by {_length(other.travel)} as well, but the "
            f"spline is in shaft {found.shaft}. Move both ends of shaft {other.shaft} together, or "
            "give it a spline."
        )
    if found.no_force:
        yield f"The axial force is not computed: {found.no_force}."
    if found.supports:
        first, last = (support.shaft for support in found.supports)
        yield (
            "The axial force acts while the spline slides under torque: it pulls when the shaft "
            "becomes longer and pushes when it becomes shorter. The part along shafts "
            f"{first} and {last} loads their thrust bearings."
        )
    if found.supports and not found.bearings:
        yield (
            "The part across acts at the joint: with the distance a from the joint to the nearer "
            "bearing and b between the bearings, it adds (a + b)/b of itself to the nearer bearing "
            "and a/b to the other."
        )


def _verdict(found: SplineFigures) -> Iterator[str]:
    faults = [*_faults(found)]
    judged = [each for each in (found.travel, found.engaged, found.push_in) if each]
    if faults:
        yield f"The spline does not suffice: {'; '.join(faults)}."
    elif any(each.verdict == "within" for each in judged):
        yield "The spline is within the limits that the scene gives."
    elif not any(each.limit is not None for each in judged):
        yield (
            "The spline is not judged: "
            "the scene gives no travel_mm, least_engaged_mm or push_in_mm."
        )
    if found.drivelines == 1:
        yield "These are figures of one position; [states] or a [study] of points find the travel."
    elif found.longest and not (found.longest.at or found.longest.state):
        yield (
            f"The study does not change the length of shaft {found.shaft}; a [study] of "
            "points finds the travel."
        )


def _faults(found: SplineFigures) -> Iterator[str]:
    """Say which limits are exceeded, by how much and where."""
    travel, engaged, left = (
        each if each and each.verdict == "beyond" else None
        for each in (found.travel, found.engaged, found.push_in)
    )
    if travel:
        yield f"its travel exceeds the permitted one by {_length(travel.excess)}"
    if engaged:
        assert engaged.value is not None
        missing = f"{_length(engaged.excess)} of engaged length are missing"
        yield f"{'it comes apart' if engaged.value <= 0.0 else missing}{place_of(engaged)}"
    if left:
        yield f"it bottoms {_length(left.excess)} too early{place_of(left)}"


def _length(value: float) -> str:
    return quantity(value, "mm")
