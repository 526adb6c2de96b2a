"""The spline of a scene: its travel over the study or states, what is left of it, its force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.json_schema import record
from cardan.app.answers.rounding import alike
from cardan.app.answers.study.extremes import End, finite_or_none
from cardan.app.answers.turn.extremes import peak
from cardan.app.scene.scene import Scene
from cardan.app.scene.slip import Slip
from cardan.app.scene.study import Study
from cardan.arrays import FloatArray
from cardan.design.judged import LimitVerdict, is_within, worst_of
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

# A shaft without a spline may change its length by this much, in mm: less than any play.
_FIXED_MM = 0.01


@dataclass(frozen=True)
class Support:
    """What the axial force does to a shaft that holds the sliding one; in N.

    Attributes:
        side: where it is, seen from the sliding shaft.
        shaft: which shaft bears the force; an end shaft bears its own.
        axial: largest part along that shaft.
        transverse: largest part across it, at the joint.
    """

    side: Literal["upstream", "downstream"]
    shaft: int
    axial: float
    transverse: float


@dataclass(frozen=True)
class BearingLoad:
    """What the axial force adds to a bearing of the shafts that hold the sliding one.

    Attributes:
        bearing: which bearing, in the order of the scene.
        shaft: its shaft.
        force: largest radial force over the states in N.
    """

    bearing: int
    shaft: int
    force: float


@dataclass(frozen=True)
class Limited:
    """A figure of the spline beside its limit; mm.

    Attributes:
        value: the figure, ``None`` if the scene does not determine it.
        limit: what is permitted, ``None`` if the scene does not say.
        verdict: whether it is.
    """

    value: float | None
    limit: float | None
    verdict: LimitVerdict


@dataclass(frozen=True)
class SlipFigures:
    """How a spline is used; lengths in mm.

    Attributes:
        slip: the spline.
        drivelines: how many states the figures are of.
        length: of the shaft at the points of the scene.
        shortest: least length over the study.
        longest: largest length over the study.
        travel: difference of the two, and its limit.
        engaged: least engaged length, and its limit.
        push_in: what is left until the spline bottoms at the shortest length; its limit is 0.
        torque: largest torque of the shaft in N m, ``None`` without a friction and a load.
        force: largest axial force in N.
        supports: what the force does upstream and downstream.
        bearings: what it adds to bearings; empty where the scene does not determine it.
        others: shafts without a spline that change their length, and by how much.
    """

    slip: Slip
    drivelines: int
    length: float
    shortest: End
    longest: End
    travel: Limited
    engaged: Limited
    push_in: Limited
    torque: End | None
    force: float | None
    supports: tuple[Support, ...]
    bearings: tuple[BearingLoad, ...]
    others: tuple[tuple[int, float], ...]

    @property
    def verdict(self) -> LimitVerdict:
        """The worst of the limits."""
        return worst_of(part.verdict for part in (self.travel, self.engaged, self.push_in))

    @property
    def passes(self) -> bool:
        """Whether no limit is exceeded."""
        return self.verdict != "beyond"


def slip_figures(scene: Scene) -> SlipFigures | None:
    """Return how the spline of a scene is used over its study or states; ``None`` without one."""
    slip = scene.slip
    if slip is None:
        return None
    blocks = zip(*_states(scene), strict=True)
    lengths, torques, bends, radial = (np.concatenate(parts) for parts in blocks)
    lengths = 1e3 * lengths
    own = lengths[:, slip.shaft]
    length = 1e3 * float(scene.line.lengths().each[slip.shaft])
    shortest, longest = _ends(scene, own)
    torque: End | None = None
    force: float | None = None
    supports: tuple[Support, ...] = ()
    if np.isfinite(torques).all():
        torque = _largest(scene, torques)
        assert slip.friction is not None
        assert slip.radius is not None
        forces = slip.friction * torques / slip.radius
        force = float(np.max(forces))
        supports = _supports(slip, forces, bends)
    shafts = scene.line.spline_force(slip.shaft, 0.0, 0.0, 1.0).bearings
    engaged = _less(slip.engaged, longest.value - length)
    apart = engaged is not None and engaged < 0.0 and slip.least_engaged is None
    travelled = np.max(lengths, axis=0) - np.min(lengths, axis=0)
    return SlipFigures(
        slip,
        len(own),
        length,
        shortest,
        longest,
        _limited(longest.value - shortest.value, slip.travel, length, most=True),
        # What has come apart is beyond, whatever limit is given.
        _limited(engaged, 0.0 if apart else slip.least_engaged, length),
        _limited(
            _less(slip.push_in, length - shortest.value),
            None if slip.push_in is None else 0.0,
            length,
        ),
        torque,
        force,
        supports,
        tuple(
            BearingLoad(i, shafts[i], float(largest))
            for i, largest in enumerate(np.max(radial, axis=0))
            if largest > 0.0
        ),
        tuple(
            (shaft, float(travel))
            for shaft, travel in enumerate(travelled)
            if shaft != slip.shaft and travel > _FIXED_MM
        ),
    )


def _states(scene: Scene) -> Iterator[tuple[FloatArray, FloatArray, FloatArray, FloatArray]]:
    """Lengths, torque of the shaft, bends and forces of bearings, a row per driveline."""
    slip = scene.slip
    assert slip is not None
    if scene.states:
        for i in range(scene.states.count):
            yield from _states(scene.in_state(i))
        return
    if scene.study is None or not scene.study.axes:
        line, load = scene.line, scene.load_case
        torque = np.nan
        if _is_loaded(slip, load):
            torque = peak(line, "torque", slip.shaft, load).value
        torques = np.array([torque])
        radial = _radial(slip, line, torques)
        yield line.lengths().each[None], torques, line.bends[None], radial
        return
    for _, lines, load in scene.study.blocks():
        torques = np.full(lines.shape[0], np.nan)
        if _is_loaded(slip, load):
            torques = _peaks(lines, load, slip.shaft, scene.study)
        radial = _radial(slip, lines[:, 0], torques)
        yield lines.lengths().each[:, 0], torques, lines.bends[:, 0], radial


def _radial(slip: Slip, lines: Driveline, torques: FloatArray) -> FloatArray:
    """What the axial force adds to each bearing, ``(rows, bearings)``; none where that is open."""
    if slip.friction is None or slip.radius is None or not np.isfinite(torques).all():
        return np.zeros((len(torques), 0))
    found = lines.spline_force(slip.shaft, torques, slip.friction, slip.radius)
    try:
        forces = found.bearing_force
    except ValueError:
        return np.zeros((len(torques), 0))
    return np.asarray(np.linalg.norm(forces, axis=-1).T)


def _is_loaded(slip: Slip, load: Load | None) -> bool:
    if load is None or slip.friction is None:
        return False
    return load.inertias is not None or bool(np.any(load.torque != 0.0))


def _peaks(lines: Driveline, load: Load | None, shaft: int, study: Study) -> FloatArray:
    found = lines.evaluate(study.angle, "torque", shafts=shaft, load=load, reduce="peak")
    return np.asarray(found.torque)


def _limited(
    value: float | None, limit: float | None, length: float, *, most: bool = False
) -> Limited:
    if value is None or limit is None:
        return Limited(value, limit, "not judged")
    within = is_within(value, limit, most=most, size=length)
    return Limited(value, limit, "within" if within else "beyond")


def _less(known: float | None, taken: float) -> float | None:
    return None if known is None else known - taken


def _supports(slip: Slip, forces: FloatArray, bends: FloatArray) -> tuple[Support, ...]:
    """Largest parts over the states: cosine and sine of the bend at that end of the shaft."""
    last = bends.shape[-1]
    sides: tuple[tuple[Literal["upstream", "downstream"], int, int | None], ...] = (
        ("upstream", max(slip.shaft - 1, 0), slip.shaft - 1 if slip.shaft else None),
        (
            "downstream",
            min(slip.shaft + 1, last),
            slip.shaft if slip.shaft < last else None,
        ),
    )
    found = []
    for side, shaft, joint in sides:
        bend = np.zeros(len(forces)) if joint is None else bends[:, joint]
        parts = (float(np.max(forces * part(bend))) for part in (np.cos, np.sin))
        found.append(Support(side, shaft, *parts))
    return tuple(found)


def _ends(scene: Scene, values: FloatArray) -> tuple[End, End]:
    least = _largest(scene, -values)
    return replace(least, value=-least.value), _largest(scene, values)


def _largest(scene: Scene, values: FloatArray) -> End:
    """The largest of the values, with the state or the keys of a study on which it depends."""
    top, study = float(np.max(values)), scene.study
    if scene.states:
        varies = not alike(float(np.min(values)), top)
        return End(top, {}, scene.states.names[int(np.argmax(values))] if varies else "")
    if study is None or not study.axes:
        return End(top, {})
    grid = values.reshape(study.shape)
    place: tuple[Any, ...] = np.unravel_index(np.argmax(grid), grid.shape)
    at = {}
    for number, axis in enumerate(study.axes):
        along = grid[(*place[:number], slice(None), *place[number + 1 :])]
        if not alike(float(np.min(along)), float(np.max(along))):
            at[axis.key] = float(axis.values[place[number]])
    return End(top, at)


# --- plain data --------------------------------------------------------------------------------


def slip_data(found: SlipFigures) -> dict[str, Any]:
    """Return the figures as plain data for JSON, as ``SLIP_SCHEMA`` describes it."""
    data: dict[str, Any] = {
        "shaft": found.slip.shaft,
        "verdict": found.verdict,
        "drivelines": found.drivelines,
        "length_mm": found.length,
        "shortest": _end_data(found.shortest, "mm"),
        "longest": _end_data(found.longest, "mm"),
    }
    for name, part in (
        ("travel", found.travel),
        ("engaged", found.engaged),
        ("push_in", found.push_in),
    ):
        data[name] = {"value_mm": part.value, "limit_mm": part.limit, "verdict": part.verdict}
    data["torque"] = None if found.torque is None else _end_data(found.torque, "Nm")
    data["axial_force_N"] = None if found.force is None else finite_or_none(found.force)
    data["supports"] = [
        {
            "side": support.side,
            "shaft": support.shaft,
            "axial_N": finite_or_none(support.axial),
            "transverse_N": finite_or_none(support.transverse),
        }
        for support in found.supports
    ]
    data["bearings"] = [
        {"bearing": load.bearing, "shaft": load.shaft, "force_N": finite_or_none(load.force)}
        for load in found.bearings
    ]
    data["other_shafts"] = [
        {"shaft": shaft, "travel_mm": finite_or_none(travel)} for shaft, travel in found.others
    ]
    return data


def _end_data(end: End, unit: str) -> dict[str, Any]:
    at = [{"key": key, "value": value} for key, value in end.at.items()]
    state = {"state": end.state} if end.state else {}
    return {f"value_{unit}": finite_or_none(end.value), "at": at, **state}


_NUMBER = {"type": ["number", "null"]}
_COUNT = {"type": "integer", "minimum": 0}
_VERDICT = {"enum": ["beyond", "within", "not judged"]}
_LIMITED = record({"value_mm": _NUMBER, "limit_mm": _NUMBER, "verdict": _VERDICT})


def _end_schema(unit: str) -> dict[str, Any]:
    at = record({"key": {"type": "string"}, "value": {"type": "number"}})
    return record(
        {f"value_{unit}": _NUMBER, "at": {"type": "array", "items": at}},
        {"state": {"type": "string", "description": "name of the state in which it is so"}},
    )


SLIP_SCHEMA: Mapping[str, Any] = record(
    {
        "shaft": _COUNT,
        "verdict": _VERDICT,
        "drivelines": _COUNT,
        "length_mm": {"type": "number", "description": "at the points of the scene"},
        "shortest": _end_schema("mm"),
        "longest": _end_schema("mm"),
        "travel": _LIMITED,
        "engaged": {**_LIMITED, "description": "least engaged length of the spline"},
        "push_in": {**_LIMITED, "description": "what is left until the spline bottoms"},
        "torque": {"oneOf": [{"type": "null"}, _end_schema("Nm")]},
        "axial_force_N": _NUMBER,
        "supports": {
            "type": "array",
            "items": record(
                {
                    "side": {"enum": ["upstream", "downstream"]},
                    "shaft": _COUNT,
                    "axial_N": _NUMBER,
                    "transverse_N": _NUMBER,
                }
            ),
        },
        "bearings": {
            "type": "array",
            "description": "what the axial force adds across the shafts that hold the sliding one",
            "items": record({"bearing": _COUNT, "shaft": _COUNT, "force_N": _NUMBER}),
        },
        "other_shafts": {
            "type": "array",
            "description": "shafts without a spline that change their length",
            "items": record({"shaft": _COUNT, "travel_mm": _NUMBER}),
        },
    }
)
"""JSON Schema of ``slip_data``: what the scene has no input for is null."""
