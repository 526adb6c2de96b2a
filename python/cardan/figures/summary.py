"""The short table of what an engineer wants to know about a scene, as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.figures.extremes import finite_or_none
from cardan.figures.rounding import first_peak, is_cancelled
from cardan.scene.scene import Scene, SceneResult
from cardan.scene.units import RPM, in_degrees


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

    def in_unit(self, radians: bool) -> tuple[float, ...]:
        """Return the values, angles in radians if these are wanted."""
        if self.unit == "deg" and radians:
            return tuple(math.radians(value) for value in self.values)
        return self.values


def summary(result: SceneResult) -> list[Row]:
    """Return the table of a scene: geometry, motion of the shafts asked for, torques and moments.

    Extremes of the motion are closed forms, those of torques and moments the largest samples of
    the curves, as far as the scene evaluates them. Where the bends were recorded the motion has
    no closed form either.
    """
    return [*_geometry(result), *_motion(result), *_loads(result)]


def summary_data(rows: Sequence[Row], *, radians: bool = False) -> list[dict[str, Any]]:
    """Return the table as plain data for JSON; what is not finite is ``None``."""
    unit = "rad" if radians else "deg"
    listed = []
    for row in rows:
        values = [finite_or_none(value) for value in row.in_unit(radians)]
        entry: dict[str, Any] = {"label": row.label, "values": values}
        entry["unit"] = unit if row.unit == "deg" else row.unit
        if row.at_deg is not None:
            entry[f"at_{unit}"] = finite_or_none(
                math.radians(row.at_deg) if radians else row.at_deg
            )
        if row.is_range:
            entry["range"] = True
        listed.append(entry)
    return listed


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
        yield _extent(f"{output.label}{of_shaft}", *in_degrees(values, output.unit))


def _extent(label: str, values: FloatArray, unit: str = "") -> Row:
    return Row(label, (float(np.nanmin(values)), float(np.nanmax(values))), unit, is_range=True)


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
    if is_cancelled(scene.line, joint):
        error = bend = non_uniformity = acceleration = 0.0
        slowest = fastest = 1.0
        place = None

    yield Row(f"equivalent bend{of_shaft}", (bend,), "deg")
    yield Row(f"largest angle error{of_shaft}", (error,), "deg", place)
    yield Row(f"non-uniformity U{of_shaft}", (non_uniformity,))
    yield Row(f"speed ratio{of_shaft}", (slowest, fastest), is_range=True)
    speed = scene.speed
    if speed:
        rpm = sorted(ratio * speed / RPM for ratio in (slowest, fastest))
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
    place, all_alike = first_peak(sizes)
    at = None if all_alike else result.scene.drive_angle_deg[place]
    return Row(label, (float(np.nanmax(sizes)),), "N m", at)


def _degrees(angles: FloatArray) -> tuple[float, ...]:
    """In degrees, within (-180, 180]."""
    return tuple(180.0 - (180.0 - degrees) % 360.0 for degrees in np.degrees(angles).tolist())
