"""The short tables of what an engineer wants to know about a scene and its study."""

from __future__ import annotations

import math
import sys
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.curves import converted

if TYPE_CHECKING:
    from cardan.driveline import Driveline
    from cardan.equivalent import EquivalentJoint
    from cardan.scene import Scene, SceneResult
    from cardan.study import StudyResult

# What joints leave of each other's k below this share is rounding of the geometry, not motion.
_CANCELLED = 1e-12


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes:
        label: what it is.
        values: a figure, or one per joint or shaft; a range if ``is_range``.
        unit: unit of the values, "" for a ratio.
        at_deg: drive angle in degrees where the value occurs, if it has a place.
        is_range: whether the two values are the ends of a range.
    """

    label: str
    values: tuple[float, ...]
    unit: str = ""
    at_deg: float | None = None
    is_range: bool = False


def summary(result: SceneResult) -> list[Row]:
    """Return the table of a scene: geometry, motion of the shafts asked for, torques and moments.

    Extremes of the motion are closed forms, those of torques and moments the largest samples of
    the curves, as far as the scene evaluates them. Where the bends were recorded the motion has
    no closed form either.
    """
    return [*_geometry(result), *_motion(result), *_loads(result)]


def summary_text(rows: Sequence[Row], *, radians: bool = False) -> str:
    """Return the table as aligned plain text, at most 79 characters wide."""
    text = _aligned([(row.label, row_text(row, radians)) for row in rows])
    if any(row.at_deg is not None for row in rows):
        text += (
            f'\n\nAfter "at": drive angle; 0 {"rad" if radians else "deg"} has the driving pin in '
            "the plane of shafts 0, 1."
        )
    return text


def summary_data(rows: Sequence[Row], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the table as plain data for JSON; what is not finite is ``None``."""
    unit = "rad" if radians else "deg"
    listed = []
    for row in rows:
        values = [_plain(value) for value in _in_unit(row, radians)]
        entry: dict[str, Any] = {"label": row.label, "values": values}
        entry["unit"] = unit if row.unit == "deg" else row.unit
        if row.at_deg is not None:
            entry[f"at_{unit}"] = _plain(math.radians(row.at_deg) if radians else row.at_deg)
        if row.is_range:
            entry["range"] = True
        listed.append(entry)
    return listed


def study_text(result: StudyResult, *, radians: bool = False) -> str:
    """Return the extent of a study and the extremes of its figures, as plain text."""
    lines = []
    if result.axes:
        steps = " x ".join(map(str, result.shape))
        count = f"{steps} = {result.rows}" if len(result.axes) > 1 else steps
        lines.append(("study", f"{count} driveline{'s' if result.rows > 1 else ''}"))
        for axis in result.axes:
            low, high = np.min(axis.values), np.max(axis.values)
            lines.append((axis.key, f"{low:.6g} to {high:.6g}"))
    placed = False
    for name, found in study_data(result, radians=radians)["figures"].items():
        low, high = found["least"], found["largest"]
        if low is None or high is None or alike(low, high):
            lines.append((name, "not finite" if low is None or high is None else figure_text(low)))
            continue
        placed = True
        ends = zip(range_ends(low, high), ("least", "largest"), strict=True)
        figures = [
            f"{figure} ({', '.join(f'{at:.6g}' for at in found[f'{which}_at'].values())})"
            for figure, which in ends
        ]
        lines.append((name, " to ".join(figures)))
    text = _aligned(lines)
    if placed:
        keys = ", ".join(axis.key for axis in result.axes)
        text += "\n\n" + textwrap.fill(f"In brackets: {keys}.", 79, break_on_hyphens=False)
    return text


def study_data(result: StudyResult, *, radians: bool = False) -> dict[str, Any]:
    """Return the extent of a study and the extremes of its figures, as plain data for JSON."""
    figures = {}
    for column in result.columns:
        suffix, values = converted(result.values[column.name], column.unit, radians)
        found: dict[str, Any] = {}
        # A point that is not a number is not an extreme; the file shows it.
        known = not np.isnan(values).all()
        for which, find in (("least", np.nanargmin), ("largest", np.nanargmax)):
            place = np.unravel_index(int(find(values)), values.shape) if known else ()
            found[which] = _plain(float(values[place])) if known else None
            if result.axes and known:
                found[f"{which}_at"] = {
                    axis.key: float(axis.values[i])
                    for axis, i in zip(result.axes, place, strict=True)
                }
        figures[f"{column.name}{suffix}"] = found
    axes = {axis.key: len(axis.values) for axis in result.axes}
    return {"rows": result.rows, "axes": axes, "figures": figures}


def _aligned(lines: Sequence[tuple[str, str]]) -> str:
    width = max(len(label) for label, _ in lines) + 2
    return "\n".join(
        textwrap.fill(
            text,
            width=79,
            initial_indent=f"{label:{width}}",
            subsequent_indent=" " * width,
            break_long_words=False,
            break_on_hyphens=False,
        )
        for label, text in lines
    )


def _plain(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def equivalent_bend_deg(line: Driveline) -> float:
    """Return the equivalent bend of one driveline in degrees; what is mere rounding is 0."""
    joint = line.equivalent()
    return 0.0 if _is_cancelled(line, joint) else float(np.degrees(joint.bend))


def _is_cancelled(line: Driveline, joint: EquivalentJoint) -> bool:
    return bool(joint.k <= _CANCELLED * np.max(np.tan(line.bends / 2.0) ** 2))


def _geometry(result: SceneResult) -> Iterable[Row]:
    line = result.scene.line
    if line.shape:
        for joint in range(line.n_joints):
            yield _extent(f"bend, joint {joint}", np.degrees(line.bends[..., joint]), "deg")
    else:
        plural = "s" if line.n_joints > 1 else ""
        yield Row(f"bend{plural}", _degrees(line.bends), "deg")
    if line.n_joints > 1:
        between = "shaft 1" if line.n_joints == 2 else f"shafts 1 to {line.n_joints - 1}"
        # Recorded bends leave the yokes as they are.
        twists, phases = (
            array.reshape(-1, line.n_joints - 1) for array in (line.twists, line.phases)
        )
        yield Row(f"twist of bend planes, {between}", _degrees(twists[0]), "deg")
        yield Row(f"phase of forks, {between}", _degrees(phases[0]), "deg")


def _motion(result: SceneResult) -> Iterable[Row]:
    scene = result.scene
    shafts = (scene.line.n_joints,) if scene.shafts is None else scene.shafts
    named = "" if scene.shafts is None else f", shaft {shafts[0]}"
    if scene.line.shape:
        for shaft in shafts:
            yield from _recorded_motion(result, shaft, named and f", shaft {shaft}")
    elif len(shafts) == 1:
        yield from _shaft_motion(scene, shafts[0], named)
    else:
        run = shafts == tuple(range(shafts[0], shafts[-1] + 1))
        listed = f"{shafts[0]} to {shafts[-1]}" if run else ", ".join(map(str, shafts))
        listed = f", shafts {listed}"
        for rows in zip(*(_shaft_motion(scene, shaft, listed) for shaft in shafts), strict=True):
            # Ranges and places of several shafts would not be read.
            if not rows[0].is_range:
                values = tuple(row.values[0] for row in rows)
                yield Row(rows[0].label, values, rows[0].unit)


def _recorded_motion(result: SceneResult, shaft: int, of_shaft: str) -> Iterable[Row]:
    joint = result.scene.line.equivalent(shaft)
    yield _extent(f"equivalent bend{of_shaft}", np.degrees(joint.bend), "deg")
    yield _extent(f"non-uniformity U{of_shaft}", joint.non_uniformity)
    for output, item, values in result.curves():
        if item != shaft or output.per != "shaft" or output.needs_load:
            continue
        in_unit = np.degrees(values) if output.unit == "rad" else values
        unit = "deg" if output.unit == "rad" else ""
        yield _extent(f"{output.label}{of_shaft}", in_unit, unit)


def _extent(label: str, values: FloatArray, unit: str = "") -> Row:
    return Row(label, (float(np.min(values)), float(np.max(values))), unit, is_range=True)


def _shaft_motion(scene: Scene, shaft: int, of_shaft: str) -> Iterable[Row]:
    joint = scene.line.equivalent(shaft)
    slowest, fastest = float(joint.min_speed_ratio), float(joint.max_speed_ratio)
    acceleration = float(joint.max_acceleration_ratio)
    error, bend = float(np.degrees(joint.max_angle_error)), float(np.degrees(joint.bend))
    non_uniformity = float(joint.non_uniformity)
    # Largest where tan**2 = cos(bend), counted from the equivalent joint's own plane.
    place: float | None = float(
        np.degrees(math.atan(math.sqrt(slowest)) - joint.angle_offset) % 180.0
    )
    if _is_cancelled(scene.line, joint):
        error = bend = non_uniformity = acceleration = 0.0
        slowest = fastest = 1.0
        place = None

    yield Row(f"equivalent bend{of_shaft}", (bend,), "deg")
    yield Row(f"largest angle error{of_shaft}", (error,), "deg", place)
    yield Row(f"non-uniformity U{of_shaft}", (non_uniformity,))
    yield Row(f"speed ratio{of_shaft}", (slowest, fastest), is_range=True)
    speed = scene.speed
    if speed:
        rpm = sorted(ratio * speed * 60.0 / math.tau for ratio in (slowest, fastest))
        yield Row(f"speed, shaft {shaft}", tuple(rpm), "rpm", is_range=True)
    yield Row(f"largest acceleration ratio{of_shaft}", (acceleration,))
    if speed:
        steady = ", steady drive" if scene.accelerates else ""
        value = acceleration * speed * speed
        yield Row(f"largest acceleration{of_shaft}{steady}", (value,), "rad/s²")


def _loads(result: SceneResult) -> Iterable[Row]:
    for output, item, values in result.curves():
        if output.needs_load:
            sizes = np.linalg.norm(values, axis=-1) if output.vector else np.abs(values)
            label = f"largest {output.label}, {output.per} {item}"
            yield _peak(result, label, sizes)


def _peak(result: SceneResult, label: str, sizes: FloatArray) -> Row:
    # The first of equal peaks, however they are rounded.
    place = int(np.argmax(sizes >= (1.0 - 1e-9) * np.max(sizes)))
    at = None if np.ptp(sizes) <= 1e-9 * np.max(sizes) else result.scene.drive_angle_deg[place]
    return Row(label, (float(np.max(sizes)),), "N m", at)


def _degrees(angles: FloatArray) -> tuple[float, ...]:
    """In degrees, within (-180, 180]."""
    return tuple(180.0 - (180.0 - degrees) % 360.0 for degrees in np.degrees(angles).tolist())


def _in_unit(row: Row, radians: bool) -> tuple[float, ...]:
    if row.unit == "deg" and radians:
        return tuple(math.radians(value) for value in row.values)
    return row.values


def row_text(row: Row, radians: bool = False) -> str:
    """Return the value of a row with unit and place."""
    values = _in_unit(row, radians)
    text = _range(values[0], values[-1]) if row.is_range else ", ".join(map(figure_text, values))
    if row.unit:
        text += " rad" if row.unit == "deg" and radians else f" {row.unit}"
    if row.at_deg is not None:
        at = f"{math.radians(row.at_deg):.4f} rad" if radians else f"{row.at_deg:.2f} deg"
        text += f" at {at}"
    return text


def _range(low: float, high: float) -> str:
    return " to ".join(range_ends(low, high)) if 0.0 < high - low < math.inf else figure_text(low)


def alike(low: float, high: float) -> bool:
    """Whether the ends of a range differ by no more than rounding."""
    return high - low <= 1e-9 * max(abs(low), abs(high))


def range_ends(low: float, high: float) -> tuple[str, str]:
    """Write both ends of a range with enough decimals for three digits of the difference."""
    decimals = 2 - math.floor(math.log10(min(high - low, sys.float_info.max)))
    if decimals > 9 or high - low >= 1e7:
        return figure_text(low), figure_text(high)
    return f"{low:.{max(0, decimals)}f}", f"{high:.{max(0, decimals)}f}"


def figure_text(value: float) -> str:
    """Four significant digits, without an exponent where that is readable."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 < exponent < 7:
        return f"{value:.3e}"
    return f"{value:.{max(0, 3 - exponent)}f}"
