"""The main results of a scene as numbers: the rows of the printed table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from cardan.app.answers.rounding import CANCELLED, first_peak, is_cancelled
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.turn.extremes import (
    Peak,
    magnitudes,
    peak,
    period_of,
    shortest_arm,
    slowest,
)
from cardan.app.scene.language.units import RPM, ending_of, in_degrees
from cardan.app.scene.recording.signals import Signal, Way
from cardan.app.scene.scene import Scene, SceneResult
from cardan.arrays import FloatArray
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.motion.equivalent import EquivalentJoint

Statistic = Literal["value", "min", "max", "peak"]
"""What a figure is: the value itself, the least, the largest, the largest magnitude."""

Of = Literal["driveline", "turn", "samples"]
"""Of what it is: of the driveline itself, of a whole turn of the drive, of recorded samples."""

# What a turn repeats, and what has closed forms; of the others the extremes are searched.
_NOT_SEARCHED = ("angle", "angle_error", "speed_ratio", "acceleration_ratio")


@dataclass(frozen=True)
class SummaryRow:
    """One figure of the table.

    Attributes:
        quantity: what it is: the name of an output, or what the driveline has.
        per: ``"shaft"`` or ``"joint"``.
        item: of which.
        statistic: what is told of the quantity.
        value: the figure.
        unit: its unit, "" for a ratio.
        of: over what the statistic is.
        at_deg: drive angle in degrees at which the value occurs, the first one of the scene;
            ``None`` if it occurs everywhere, or not between the scene's drive angles.
    """

    quantity: str
    per: Literal["shaft", "joint", "bearing"]
    item: int
    statistic: Statistic
    value: float
    unit: str = ""
    of: Of = "turn"
    at_deg: float | None = None


def summary(result: SceneResult) -> list[SummaryRow]:
    """Return the table of a scene: geometry, motion of the shafts asked for, torques and moments.

    Extremes are of a whole turn, in closed form or found between samples, whatever part of it the
    scene sweeps. Where the drive angles were recorded they are of the samples.
    """
    rows = [*_geometry(result.scene), *_equivalent(result.scene)]
    if result.scene.recording is not None:
        return rows + list(_recorded(result))
    return rows + list(_motion(result.scene)) + list(_searched(result.scene))


def drive_angles(scene: Scene, *, radians: bool = False) -> dict[str, Any]:
    """Return the drive angles of a scene as plain data: where from, how many, from where to where.

    ``turns`` is the way that the drive goes, forward and back; a counter that starts anew at each
    turn goes on.
    """
    degrees = scene.without_missing().drive_angle_deg
    extent = None
    if scene.recording:
        way = Way()
        way.add(degrees)
        turns, extent = way.turns, way.extent
    else:
        turns = float(np.sum(np.abs(np.diff(degrees)))) / 360.0
    ends = (float(degrees[0]), float(degrees[-1]))
    found = recorded_angles(
        len(scene.drive_angle_deg), scene.missing, ends, turns, scene.signals, radians, extent
    )
    if scene.driven_angle_deg is not None:
        found["angle_of"] = "driven"
    if scene.deviations is not None:
        found["period_rad" if radians else "period_deg"] = math.tau if radians else 360.0
    return found if scene.recording else {**found, "source": "sweep"}


def recorded_angles(
    samples: int,
    missing: int,
    ends_deg: tuple[float, float],
    turns: float,
    signals: Sequence[Signal],
    radians: bool,
    extent_deg: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Return recorded drive angles as plain data, from what is known of them.

    A drive that turns back has the extent of its angles as well.
    """
    unit, turned = ("rad", math.radians) if radians else ("deg", float)
    data = {
        "source": "recording",
        "samples": samples,
        "missing_samples": missing,
        f"first_{unit}": turned(ends_deg[0]),
        f"last_{unit}": turned(ends_deg[1]),
        "turns": turns,
        "samples_per_turn": (samples - missing - 1) / turns if turns else None,
    }
    if extent_deg is not None:
        data |= {f"{e}_{unit}": turned(x) for e, x in zip(("min", "max"), extent_deg, strict=True)}
    if signals:
        data["signals"] = [_signal(signal) for signal in signals]
    return data


def _signal(signal: Signal) -> dict[str, Any]:
    """A signal as plain data.

    Only one that a filter derived has the samples of the filter, and only times have a rate and
    gaps.
    """
    data = asdict(signal)
    reach, _ = data.pop("reach"), data.pop("sampling")
    if reach:
        data["filter_samples"] = 2 * reach + 1
    if signal.sampling is not None:
        own = signal.sampling
        data |= {"samples_per_second": own.rate, "gaps": own.gaps}
        if own.gaps:
            data |= {"longest_gap_s": own.longest, "longest_gap_after_s": own.longest_after}
    return data


def summary_data(rows: Sequence[SummaryRow], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the table as plain data for JSON; what is not finite is ``None``."""
    return [_entry(row, radians) for row in rows]


def _entry(row: SummaryRow, radians: bool) -> dict[str, Any]:
    angle = "rad" if radians else "deg"
    turned = math.radians if radians else float
    entry: dict[str, Any] = {
        "quantity": row.quantity,
        row.per: row.item,
        "statistic": row.statistic,
        "of": row.of,
    }
    value = turned(row.value) if row.unit == "deg" else row.value
    key = f"value_{angle}" if row.unit == "deg" else f"value{ending_of(row.unit)}"
    entry[key] = finite_or_none(value)
    if row.at_deg is not None:
        entry[f"at_drive_angle_{angle}"] = turned(row.at_deg)
    return entry


def _geometry(scene: Scene) -> Iterator[SummaryRow]:
    line = scene.line
    for joint in range(line.n_joints):
        yield from _extent("bend", "joint", joint, np.degrees(line.bends[..., joint]), "deg")
    for name, array in (("twist", line.twists), ("phase", line.phases)):
        # Recorded bends leave the yokes as they are.
        for i, angle in enumerate(array[(0,) * len(line.shape)]):
            yield SummaryRow(
                name, "shaft", i + 1, "value", float(within_turn(angle)), "deg", "driveline"
            )


def _equivalent(scene: Scene) -> Iterator[SummaryRow]:
    joints = [(shaft, scene.line.equivalent(shaft)) for shaft in _shafts(scene)]
    for name, unit in (("equivalent_bend", "deg"), ("non_uniformity", "")):
        for shaft, joint in joints:
            values = np.degrees(joint.bend) if unit else joint.non_uniformity
            if not scene.line.shape and is_cancelled(scene.line, joint):
                values = np.zeros(())
            yield from _extent(name, "shaft", shaft, values, unit)


def _extent(
    name: str, per: Literal["shaft", "joint", "bearing"], item: int, values: FloatArray, unit: str
) -> Iterator[SummaryRow]:
    """The value, or the ends of what was recorded."""
    if not np.ndim(values):
        yield SummaryRow(name, per, item, "value", float(values), unit, "driveline")
        return
    for statistic, find in _ENDS:
        yield SummaryRow(name, per, item, statistic, float(find(values)), unit, "samples")


_ENDS: tuple[tuple[Statistic, Any], ...] = (("min", np.nanmin), ("max", np.nanmax))


def _recorded(result: SceneResult) -> Iterator[SummaryRow]:
    degrees = result.scene.drive_angle_deg
    least = _least(result.scene)
    for output, item, values in result.curves():
        if output.per == "shaft" and not output.needs_load:
            shown, unit = in_degrees(values, output.unit)
            for statistic, find in _ENDS:
                value = float(find(shown))
                yield SummaryRow(output.name, "shaft", item, statistic, value, unit, "samples")
        elif output.needs_load:
            sizes = magnitudes(output, values)
            place, everywhere = first_peak(sizes)
            value, at = float(np.nanmax(sizes)), None if everywhere else float(degrees[place])
            if value <= least[output.unit]:
                value, at = 0.0, None
            yield SummaryRow(
                output.name, output.per, item, "peak", value, output.unit, "samples", at
            )


# Statistic, speed ratio, input angle of the equivalent joint.
_End = tuple[Statistic, float, float]


def _motion(scene: Scene) -> Iterator[SummaryRow]:
    of_shaft = _shaft_motion if scene.deviations is None else _motion_as_built
    per_shaft = [list(of_shaft(scene, shaft)) for shaft in _shafts(scene)]
    for same_quantity in zip(*per_shaft, strict=True):
        yield from same_quantity


def _shaft_motion(scene: Scene, shaft: int) -> Iterator[SummaryRow]:
    joint = scene.line.equivalent(shaft)
    slowest, fastest = float(joint.min_speed_ratio), float(joint.max_speed_ratio)
    acceleration = float(joint.max_acceleration_ratio)
    error = float(np.degrees(joint.max_angle_error))
    still = is_cancelled(scene.line, joint)
    if still:
        error = acceleration = 0.0
        slowest = fastest = 1.0

    def row(
        name: str, statistic: Statistic, value: float, unit: str, driving: Sequence[float]
    ) -> SummaryRow:
        places = () if still else [place - float(joint.angle_offset) for place in driving]
        return SummaryRow(
            name, "shaft", shaft, statistic, value, unit, "turn", first_place(scene, places)
        )

    # Driving angles of the equivalent joint; the error is largest where tan**2 = cos(bend).
    lead, steep = math.atan(math.sqrt(slowest)), _steepest(joint)
    ends: list[_End] = [("min", slowest, math.pi / 2), ("max", fastest, 0.0)]
    yield row("angle_error", "peak", error, "deg", (lead, -lead))
    for statistic, ratio, place in ends:
        yield row("speed_ratio", statistic, ratio, "", (place,))
    speed = scene.speed
    if speed:
        for statistic, ratio, place in ends if speed > 0.0 else _swapped(ends):
            yield row("speed", statistic, ratio * speed / RPM, "rpm", (place,))
    yield row("acceleration_ratio", "peak", acceleration, "", (steep, -steep))
    if speed:
        value = acceleration * speed * speed
        yield row("acceleration_at_steady_drive", "peak", value, "rad/s²", (steep, -steep))


def _motion_as_built(scene: Scene, shaft: int) -> Iterator[SummaryRow]:
    """The same for joints with deviations, whose extremes have no closed form."""
    line, speed = scene.line_as_built, scene.speed

    def row(name: str, statistic: Statistic, found: Peak, factor: float, unit: str) -> SummaryRow:
        at = first_place(scene, found.places)
        value = found.value * factor
        return SummaryRow(name, "shaft", shaft, statistic, value, unit, "turn", at)

    yield row("angle_error", "peak", peak(line, "angle_error", shaft), math.degrees(1.0), "deg")
    least, most = slowest(line, shaft), peak(line, "speed_ratio", shaft)
    yield row("speed_ratio", "min", least, 1.0, "")
    yield row("speed_ratio", "max", most, 1.0, "")
    if speed:
        low, high = (least, most) if speed > 0.0 else (most, least)
        yield row("speed", "min", low, speed / RPM, "rpm")
        yield row("speed", "max", high, speed / RPM, "rpm")
    steepest = peak(line, "acceleration_ratio", shaft)
    yield row("acceleration_ratio", "peak", steepest, 1.0, "")
    if speed:
        yield row("acceleration_at_steady_drive", "peak", steepest, speed * speed, "rad/s²")


def _swapped(
    ends: Iterable[tuple[Statistic, float, float]],
) -> list[tuple[Statistic, float, float]]:
    """The ends of a drive that turns backwards."""
    (least, slowest, slow), (largest, fastest, fast) = ends
    return [(least, fastest, fast), (largest, slowest, slow)]


def _steepest(joint: EquivalentJoint) -> float:
    """The input angle at which the acceleration is largest.

    Its cosine of twice the angle is (-p + sqrt(p**2 + 8))/2 with p = (2 - s)/s and s the square of
    the bend's sine; multiplied through, s may be 0.
    """
    s = math.sin(float(joint.bend)) ** 2
    return math.acos(min(1.0, 4.0 * s / (2.0 - s + math.hypot(2.0 - s, math.sqrt(8.0) * s)))) / 2.0


def _searched(scene: Scene) -> Iterator[SummaryRow]:
    shafts = _shafts(scene)
    items = {
        "shaft": shafts,
        "joint": range(scene.line.n_joints) if scene.joints is None else scene.joints,
        "bearing": range(scene.line.n_bearings),
    }
    least = _least(scene)
    for name in scene.quantities:
        output: Output = OUTPUTS[name]
        if name in _NOT_SEARCHED:
            continue
        for item in items[output.per]:
            found = peak(
                scene.line_as_built, name, item, scene.load_case if output.needs_load else None
            )
            value, places = found.value, found.places
            if value <= (least[output.unit] if output.needs_load else CANCELLED):
                value, places = 0.0, ()
            if output.unit == "rad":
                value = math.degrees(value)
            unit = {"rad": "deg", "1": ""}.get(output.unit, output.unit)
            at = first_place(scene, places)
            yield SummaryRow(name, output.per, item, "peak", value, unit, "turn", at)


def _shafts(scene: Scene) -> tuple[int, ...]:
    return (scene.line.n_joints,) if scene.shafts is None else scene.shafts


def _least(scene: Scene) -> dict[str, float]:
    """What is rounding of the loads that a scene asks for, by their unit."""
    outputs = (OUTPUTS[name] for name in scene.quantities)
    units = {output.unit for output in outputs if output.needs_load}
    return {unit: noise(scene, unit) for unit in units}


def noise(scene: Scene, unit: str = "N m") -> float:
    """Return what of a torque or a moment is rounding: of the load and of the geometry.

    Args:
        scene: the scene.
        unit: ``"N m"``, or ``"N"`` for forces: those of such a moment on the shortest lever arm.
    """
    load = scene.load_case
    if load is None:
        return 0.0
    size = float(np.nanmax(np.abs(load.torque)))
    if load.inertias is not None:
        unevenness = np.max(np.tan(scene.line.bends / 2.0) ** 2)
        rate = scene.speed**2 * unevenness + np.nanmax(np.abs(load.acceleration))
        size += float(np.sum(load.inertias)) * float(rate)
    return CANCELLED * (size / shortest_arm(scene.line) if unit == "N" else size)


def first_place(scene: Scene, places: Iterable[float]) -> float | None:
    """Return the first drive angle of a scene in degrees at one of some places, if any.

    Args:
        scene: the scene.
        places: drive angles in rad, which repeat after the period of the driveline.
    """
    first, last = scene.drive_angle_deg[[0, -1]]
    period = math.degrees(period_of(scene.line_as_built))
    found = []
    for place in np.degrees(list(places)):
        ahead = (place - first) % period
        # Just before the first angle by rounding is there.
        found.append(first + (ahead if ahead < period - 1e-6 else ahead - period))
    at = min(found, default=math.inf)
    return float(at) if at <= last + 1e-6 else None


def within_turn(angle: float | FloatArray) -> FloatArray:
    """In degrees, within (-180, 180]."""
    return np.asarray(180.0 - (180.0 - np.degrees(angle)) % 360.0)
