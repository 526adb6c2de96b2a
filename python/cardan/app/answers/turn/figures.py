"""The main results of a scene: its drive angles, and what its quantities are or reach."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardan.app.answers.rounding import CANCELLED, first_peak, is_cancelled
from cardan.app.answers.rows import (
    UNITS,
    as_shown,
    count,
    figure,
    item,
    key_of,
    optional,
    parts,
    taken,
    word,
)
from cardan.app.answers.turn.extremes import (
    Peak,
    ideal_peak,
    magnitudes,
    peak,
    period_of,
    shortest_arm,
)
from cardan.app.scene.language.units import in_degrees
from cardan.app.scene.recording.signals import Measured, Signal, Way
from cardan.app.scene.scene import Scene, SceneResult
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.outputs import OUTPUTS, Output

Statistic = Literal["value", "min", "max", "peak"]
Of = Literal["driveline", "turn", "samples"]
Per = Literal["shaft", "joint", "bearing"]

# Outputs whose extremes are not searched: they have rows of their own.
_NOT_SEARCHED = ("angle", "angle_error", "speed_ratio", "acceleration_ratio")

# Quantity, the output that it is, statistic, unit, and the power of the drive's speed in it.
_MOTION: tuple[tuple[str, str, Statistic, str, int], ...] = (
    ("angle_error", "angle_error", "peak", "deg", 0),
    ("speed_ratio", "speed_ratio", "min", "", 0),
    ("speed_ratio", "speed_ratio", "max", "", 0),
    ("speed", "speed_ratio", "min", "rpm", 1),
    ("speed", "speed_ratio", "max", "rpm", 1),
    ("acceleration_ratio", "acceleration_ratio", "peak", "", 0),
    ("acceleration_at_steady_drive", "acceleration_ratio", "peak", "rad_s2", 2),
)

_ENDS: tuple[Statistic, Statistic] = ("min", "max")


@dataclass(frozen=True)
class SummaryRow:
    """One figure of the table; angles are in degrees, speeds in rpm."""

    per: Per
    unit: str
    quantity: str = word("quantity", "an output, or what the driveline has")
    item: int = item("own")
    statistic: Statistic = word("statistic", "peak is the largest magnitude")
    of: Of = word("of", "over what the statistic is")
    value: float = as_shown(figure("value", "each", "null if it is not finite"))
    at_drive_angle: float | None = optional(
        as_shown(figure("at", "deg", "absent if every angle has it, or none of the scene"))
    )


@dataclass(frozen=True)
class SignalFigures:
    """The extent of a recorded signal."""

    signal: Measured = word("signal")
    column: str | None = word("column", "the recorded column; null of what was derived from others")
    unit: str = word("unit", "s, rpm, rad/s, rad/s² or N m")
    first: float = figure("first")
    last: float = figure("last")
    min: float = figure("least")
    max: float = figure("largest")
    filter_samples: int | None = optional(
        count("filter", "samples of the parabola that derived it by differentiating")
    )
    noise: float | None = optional(
        figure("noise", "", "of an acceleration, rms, by the scatter of the samples")
    )
    quiet_reach: int | None = optional(
        count(
            "filter_reach for less noise",
            "of an acceleration that is mostly noise: with it, the noise is a tenth",
        )
    )
    samples_per_second: float | None = optional(
        figure("samples per second", "", "of times, without gaps")
    )
    gaps: int | None = optional(count("gaps", "of times: steps far longer than those around them"))
    longest_gap: float | None = optional(figure("longest gap", "s"))
    longest_gap_after: float | None = optional(
        figure("after", "s", "the time of the sample before the longest gap")
    )


@dataclass(frozen=True)
class DriveAngles:
    """The drive angles of a scene in degrees: where from, how many, from where to where."""

    source: Literal["sweep", "recording"] = word("source")
    samples: int = count("samples")
    missing_samples: int = count("missing samples")
    first: float = as_shown(figure("first", "deg"))
    last: float = as_shown(figure("last", "deg"))
    turns: float = figure("turns", "", "the way of the drive, forward and back")
    samples_per_turn: float | None = figure("samples per turn")
    min: float | None = optional(
        as_shown(figure("least", "deg", "of a recorded drive that turns back"))
    )
    max: float | None = optional(
        as_shown(figure("largest", "deg", "of a recorded drive that turns back"))
    )
    signals: tuple[SignalFigures, ...] = optional(parts("Recording"))
    angle_of: Literal["driven", ""] = optional(
        word(
            "angle of",
            "the scene gives angles of the last shaft; these drive angles follow from them",
        )
    )
    period: float | None = optional(
        as_shown(
            figure(
                "period",
                "deg",
                "after which extremes recur, if joints have deviations; otherwise half a turn",
            )
        )
    )


@dataclass(frozen=True)
class TurnFigures:
    """The table of a scene, and over which drive angles it is."""

    drive_angles: DriveAngles = parts("Drive angles")
    rows: tuple[SummaryRow, ...] = parts("Figures")


def turn_figures(result: SceneResult) -> TurnFigures:
    """Return the table of an evaluated scene with its drive angles."""
    return TurnFigures(drive_angles(result.scene), tuple(summary(result)))


def summary(result: SceneResult) -> list[SummaryRow]:
    """Return the table of a scene: geometry, motion of the shafts asked for, torques and moments.

    Extremes are of a whole turn, in closed form or found between samples, whatever part of it the
    scene sweeps. Where the drive angles were recorded they are of the samples.
    """
    scene = result.scene
    rows = [*_geometry(scene), *_equivalent(scene)]
    if scene.recording is not None:
        return rows + list(_recorded(result))
    return rows + list(_motion(scene)) + list(_searched(scene))


def drive_angles(scene: Scene) -> DriveAngles:
    """Return the drive angles of a scene; a counter that starts anew at each turn goes on."""
    degrees = scene.without_missing().drive_angle_deg
    ends = (float(degrees[0]), float(degrees[-1]))
    samples, missing = len(scene.drive_angle_deg), scene.missing
    turns, extent = float(np.sum(np.abs(np.diff(degrees)))) / 360.0, None
    if scene.recording:
        way = Way()
        way.add(degrees)
        turns, extent = way.turns, way.extent
    return replace(
        recorded_angles(samples, missing, ends, turns, scene.signals, extent),
        source="recording" if scene.recording else "sweep",
        angle_of="" if scene.driven_angle_deg is None else "driven",
        period=None if scene.deviations is None else 360.0,
    )


def recorded_angles(
    samples: int,
    missing: int,
    ends_deg: tuple[float, float],
    turns: float,
    signals: Sequence[Signal],
    extent_deg: tuple[float, float] | None = None,
) -> DriveAngles:
    """Return recorded drive angles; of a drive that turns back also their extent."""
    return DriveAngles(
        "recording",
        samples,
        missing,
        *ends_deg,
        turns,
        (samples - missing - 1) / turns if turns else None,
        None if extent_deg is None else extent_deg[0],
        None if extent_deg is None else extent_deg[1],
        tuple(map(_signal, signals)),
        "",
        None,
    )


def _signal(signal: Signal) -> SignalFigures:
    """Only a derived signal has the samples of a filter, only times have a rate and gaps."""
    own = signal.sampling
    return taken(
        *(SignalFigures, signal),
        filter_samples=2 * signal.reach + 1 if signal.reach else None,
        noise=signal.scatter.noise if signal.scatter else None,
        quiet_reach=(signal.scatter.reach or None) if signal.scatter else None,
        samples_per_second=own.rate if own else None,
        gaps=own.gaps if own else None,
        longest_gap=own.longest if own and own.gaps else None,
        longest_gap_after=own.longest_after if own and own.gaps else None,
    )


def _geometry(scene: Scene) -> Iterator[SummaryRow]:
    line = scene.line
    for joint in range(line.n_joints):
        yield from _extent("bend", "joint", joint, np.degrees(line.bends[..., joint]), "deg")
    for name, array in (("twist", line.twists), ("phase", line.phases)):
        # Recorded bends leave the yokes as they are.
        for shaft, angle in enumerate(array[(0,) * len(line.shape)], start=1):
            yield from _extent(name, "shaft", shaft, within_turn(angle), "deg")


def _equivalent(scene: Scene) -> Iterator[SummaryRow]:
    joints = [(shaft, scene.line.equivalent(shaft)) for shaft in _shafts(scene)]
    for name, unit in (("equivalent_bend", "deg"), ("non_uniformity", "")):
        for shaft, joint in joints:
            values = np.degrees(joint.bend) if unit else joint.non_uniformity
            if not scene.line.shape and is_cancelled(scene.line, joint):
                values = np.zeros(())
            yield from _extent(name, "shaft", shaft, values, unit)


def _extent(name: str, per: Per, item: int, values: FloatArray, unit: str) -> Iterator[SummaryRow]:
    """The value, or the ends of what was recorded."""
    if not np.ndim(values):
        yield SummaryRow(per, unit, name, item, "value", "driveline", float(values), None)
        return
    for statistic, end in zip(_ENDS, (np.nanmin(values), np.nanmax(values)), strict=True):
        yield SummaryRow(per, unit, name, item, statistic, "samples", float(end), None)


def _recorded(result: SceneResult) -> Iterator[SummaryRow]:
    degrees = result.scene.drive_angle_deg
    for output, number, values in result.curves():
        if output.per == "shaft" and not output.needs_load:
            shown, _ = in_degrees(values, output.unit)
            yield from _extent(output.name, "shaft", number, shown, key_of(output.unit))
        elif output.needs_load:
            sizes = magnitudes(output, values)
            place, everywhere = first_peak(sizes)
            value, at = float(np.nanmax(sizes)), None if everywhere else float(degrees[place])
            if value <= noise(result.scene, output.unit):
                value, at = 0.0, None
            unit = key_of(output.unit)
            yield SummaryRow(output.per, unit, output.name, number, "peak", "samples", value, at)


def _motion(scene: Scene) -> Iterator[SummaryRow]:
    speed, line = scene.speed, scene.line_as_built
    for quantity, output, statistic, unit, power in _MOTION:
        if power and not speed:
            continue
        # Of a drive that turns backwards the least speed is that of the largest ratio.
        is_least = statistic == ("max" if power == 1 and speed < 0.0 else "min")
        for shaft in _shafts(scene):
            found = motion_peak(scene, line, output, shaft, is_least=is_least)
            value = found.value * speed**power * UNITS[unit].factor
            at = first_place(scene, found.places)
            yield SummaryRow("shaft", unit, quantity, shaft, statistic, "turn", value, at)


def motion_peak(
    scene: Scene, line: Driveline, output: str, shaft: int, *, is_least: bool = False
) -> Peak:
    """Return the largest or the least motion of a shaft: in closed form, or as built searched."""
    if scene.deviations is not None:
        return peak(line, output, shaft, is_least=is_least)
    return ideal_peak(line, output, shaft, is_least=is_least)


def _searched(scene: Scene) -> Iterator[SummaryRow]:
    items = {
        "shaft": _shafts(scene),
        "joint": range(scene.line.n_joints) if scene.joints is None else scene.joints,
        "bearing": range(scene.line.n_bearings),
    }
    for name in scene.quantities:
        output: Output = OUTPUTS[name]
        if name in _NOT_SEARCHED:
            continue
        load = scene.load_case if output.needs_load else None
        least = noise(scene, output.unit) if output.needs_load else CANCELLED
        unit = key_of(output.unit)
        for number in items[output.per]:
            found = peak(scene.line_as_built, name, number, load)
            if found.value <= least:
                found = Peak(0.0, ())
            value, at = found.value * UNITS[unit].factor, first_place(scene, found.places)
            yield SummaryRow(output.per, unit, name, number, "peak", "turn", value, at)


def _shafts(scene: Scene) -> tuple[int, ...]:
    return (scene.line.n_joints,) if scene.shafts is None else scene.shafts


def noise(scene: Scene, unit: str = "N m") -> float:
    """Return what of a torque or a moment is rounding: of the load and of the geometry.

    Of forces, whose unit is ``"N"``, it is that of such a moment on the shortest lever arm.
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
    """Return the first drive angle of a scene in degrees at one of some places in rad, if any.

    The places repeat after the period of the driveline.
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
    """Return an angle in degrees, within (-180, 180]."""
    return np.asarray(180.0 - (180.0 - np.degrees(angle)) % 360.0)
