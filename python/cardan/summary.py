"""The short table of what an engineer wants to know about a scene."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cardan.arrays import FloatArray
from cardan.outputs import OUTPUTS

if TYPE_CHECKING:
    from cardan.scene import SceneResult

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
    """Return the table of a scene: geometry, motion of the last shaft, torques and moments.

    Extremes of the motion are closed forms, those of torques and moments the largest samples of
    the curves, as far as the scene evaluates them.
    """
    return [*_geometry(result), *_motion(result), *_loads(result)]


def summary_text(rows: Sequence[Row]) -> str:
    """Return the table as aligned plain text, at most 79 characters wide."""
    width = max(len(row.label) for row in rows) + 2
    lines = [
        textwrap.fill(
            _figures(row),
            width=79,
            initial_indent=f"{row.label:{width}}",
            subsequent_indent=" " * width,
        )
        for row in rows
    ]
    if any(row.at_deg is not None for row in rows):
        lines += [
            "",
            'After "at": drive angle; 0 deg has the driving pin in the plane of shafts 0, 1.',
        ]
    return "\n".join(lines)


def _geometry(result: SceneResult) -> Iterable[Row]:
    line = result.scene.line
    plural = "s" if line.n_joints > 1 else ""
    yield Row(f"bend{plural}", _degrees(line.bends), "deg")
    if line.n_joints > 1:
        between = "shaft 1" if line.n_joints == 2 else f"shafts 1 to {line.n_joints - 1}"
        yield Row(f"twist of bend planes, {between}", _degrees(line.twists), "deg")
        yield Row(f"phase of forks, {between}", _degrees(line.phases), "deg")


def _motion(result: SceneResult) -> Iterable[Row]:
    scene = result.scene
    joint = scene.line.equivalent()
    slowest, fastest = float(joint.min_speed_ratio), float(joint.max_speed_ratio)
    acceleration = float(joint.max_acceleration_ratio)
    error, bend = float(np.degrees(joint.max_angle_error)), float(np.degrees(joint.bend))
    non_uniformity = float(joint.non_uniformity)
    # Largest where tan**2 = cos(bend), counted from the equivalent joint's own plane.
    place: float | None = float(
        np.degrees(math.atan(math.sqrt(slowest)) - joint.angle_offset) % 180.0
    )
    if joint.k <= _CANCELLED * np.max(np.tan(scene.line.bends / 2.0) ** 2):
        error = bend = non_uniformity = acceleration = 0.0
        slowest = fastest = 1.0
        place = None

    yield Row("equivalent bend", (bend,), "deg")
    yield Row("largest angle error", (error,), "deg", place)
    yield Row("non-uniformity U", (non_uniformity,))
    yield Row("speed ratio", (slowest, fastest), is_range=True)
    speed = scene.speed
    if speed:
        rpm = sorted(ratio * speed * 60.0 / math.tau for ratio in (slowest, fastest))
        yield Row(f"speed, shaft {scene.line.n_joints}", tuple(rpm), "rpm", is_range=True)
    yield Row("largest acceleration ratio", (acceleration,))
    if speed:
        steady = ", steady drive" if scene.accelerates else ""
        yield Row(f"largest acceleration{steady}", (acceleration * speed * speed,), "rad/s²")


def _loads(result: SceneResult) -> Iterable[Row]:
    last = result.scene.line.n_joints
    for name, values in result.values.items():
        output = OUTPUTS[name]
        if not output.needs_load:
            continue
        sizes = np.linalg.norm(values, axis=-1) if output.vector else np.abs(values)
        label = f"largest {name.replace('_', ' ')}"
        if output.per == "shaft":
            yield _peak(result, f"{label}, shaft {last}", sizes)
        else:
            for joint, own in enumerate(sizes):
                yield _peak(result, f"{label}, joint {joint}", own)


def _peak(result: SceneResult, label: str, sizes: FloatArray) -> Row:
    # The first of equal peaks, however they are rounded.
    place = int(np.argmax(sizes >= (1.0 - 1e-9) * np.max(sizes)))
    at = None if np.ptp(sizes) <= 1e-9 * np.max(sizes) else result.scene.drive_angle_deg[place]
    return Row(label, (float(np.max(sizes)),), "N m", at)


def _degrees(angles: FloatArray) -> tuple[float, ...]:
    """In degrees, within (-180, 180]."""
    return tuple(180.0 - (180.0 - degrees) % 360.0 for degrees in np.degrees(angles).tolist())


def _figures(row: Row) -> str:
    low, high = row.values[0], row.values[-1]
    if row.is_range and 0.0 < high - low < math.inf:
        # Enough decimals for three digits of the difference.
        decimals = max(0, 2 - math.floor(math.log10(high - low)))
        text = f"{low:.{decimals}f} to {high:.{decimals}f}"
    elif row.is_range:
        text = _figure(low)
    else:
        text = ", ".join(map(_figure, row.values))
    if row.unit:
        text += f" {row.unit}"
    if row.at_deg is not None:
        text += f" at {row.at_deg:.2f} deg"
    return text


def _figure(value: float) -> str:
    """Four significant digits, without an exponent where that is readable."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(abs(value)))
    if not -5 < exponent < 7:
        return f"{value:.3e}"
    return f"{value:.{max(0, 3 - exponent)}f}"
