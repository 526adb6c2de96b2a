"""The curves of a scene and the table of its study, as columns, as files, and in chunks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import closing
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardan.app.files.columns import ROWS, write_columns, write_pieces
from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.units import System, converted
from cardan.app.scene.recording.signals import Signal, Way, joined
from cardan.app.scene.scene import Scene, SceneResult
from cardan.app.scene.study.study import StudyPart, StudyResult
from cardan.arrays import FloatArray


def columns(result: SceneResult, *, radians: bool = False) -> dict[str, FloatArray]:
    """Return the curves as columns of equal length, in the units of the scene.

    The names carry shaft or joint, component and unit: ``angle_error_deg``, ``moment_0_x_Nm``. The
    last shaft has no number where the scene names no shafts. A drive that was recorded over time
    has ``time_s``, ``drive_speed_rad_s`` and ``drive_acceleration_rad_s2`` as well. A scene that
    gives angles of the driven shaft has them as ``driven_angle_deg``, before the drive angles.
    """
    scene = result.scene
    unit, angle = "rad" if radians else "deg", scene.driven_angle_deg
    table: dict[str, FloatArray] = {}
    if angle is not None:
        table[f"driven_angle_{unit}"] = np.radians(angle) if radians else angle
    table[f"drive_angle_{unit}"] = scene.drive_angle if radians else scene.drive_angle_deg
    table |= _drive(scene, with_units=True)
    for output, item, values in result.curves():
        last = output.per == "shaft" and scene.shafts is None
        name = output.name if last else f"{output.name}_{item}"
        parts = {name: values}
        if output.vector:
            parts = {f"{name}_{axis}": values[:, i] for i, axis in enumerate("xyz")}
        for part, curve in parts.items():
            suffix, in_unit = converted(curve, output.unit, radians, scene.units)
            table[f"{part}{suffix}"] = in_unit
    return table


def _drive(scene: Scene, *, with_units: bool) -> dict[str, FloatArray]:
    """The time and the motion of a drive that was recorded over time."""
    if scene.time is None or scene.load_case is None:
        return {}
    found = {
        ("time", "_s"): scene.time,
        ("drive_speed", "_rad_s"): scene.load_case.speed,
        ("drive_acceleration", "_rad_s2"): scene.load_case.acceleration,
    }
    return {name + unit * with_units: values for (name, unit), values in found.items()}


def study_columns(
    result: StudyResult | StudyPart, *, radians: bool = False, units: System = "si"
) -> dict[str, FloatArray]:
    """Return a study as columns: the keys varied, as the file has them, then the figures.

    The arrays have the shape of the grid, and its rows are their elements in order. Figures are in
    SI or US units and their angles in degrees, or radians; the names carry the unit.
    """
    table = result.coordinates()
    for column in result.columns:
        suffix, in_unit = converted(result.values[column.name], column.unit, radians, units)
        table[f"{column.name}{suffix}"] = in_unit
    return table


def write_curves(
    result: SceneResult,
    path: str | PathLike[str],
    *,
    radians: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the curves in the format that the path's suffix names and return the number of rows.

    CSV and Parquet hold the columns of ``columns``, CSV with every digit of the doubles. NPZ holds
    the arrays as evaluated, in SI units under the names of the outputs, and ``drive_angle`` in rad;
    ``driven_angle`` too if the scene gives angles of the driven shaft. Nothing is left behind of a
    file that cannot be written.
    """
    if Path(path).suffix == ".npz":
        drive = {"drive_angle": result.drive_angle, **_drive(result.scene, with_units=False)}
        if result.scene.driven_angle_deg is not None:
            drive["driven_angle"] = np.radians(result.scene.driven_angle_deg)
        return write_columns(path, {**drive, **result.values})
    return write_columns(path, columns(result, radians=radians), progress)


def write_study(
    result: StudyResult,
    path: str | PathLike[str],
    *,
    radians: bool = False,
    units: System = "si",
    progress: Progress | None = None,
) -> int:
    """Write a study in the format that the path's suffix names and return the number of rows.

    CSV and Parquet hold the columns of ``study_columns``. NPZ holds the grid: the values of each
    key that is varied in one dimension, and every figure in SI units with a dimension per key.
    """
    if Path(path).suffix == ".npz":
        write_columns(path, {**result.grid(), **result.values})
    else:
        write_columns(path, study_columns(result, radians=radians, units=units), progress)
    return result.rows


class Streamed(NamedTuple):
    """A file of curves that was written."""

    path: Path
    rows: int
    missing: int
    """Recorded samples that are missing."""
    ends_deg: tuple[float, float]
    """First and last drive angle in degrees."""
    turns: float
    """How far the drive goes, forward and back, in turns."""
    signals: tuple[Signal, ...]
    """The extents of what was recorded besides angles and bends."""
    extent_deg: tuple[float, float] | None
    """The least and the largest drive angle of a drive that turns back."""
    units: System
    """Units in which the columns are written."""


def stream(
    scene: str | PathLike[str],
    into: str | PathLike[str] = ".",
    *,
    radians: bool = False,
    units: System | None = None,
    rows: int = ROWS,
    progress: Progress | None = None,
) -> Streamed:
    """Write the curves of a scene with recorded angles, whose files may be of any length.

    The file has the same rows, columns and bits as that of ``cardan run``, with one exception: if
    bends are recorded too, the steepest in a chunk determines the polynomial for the inverse
    tangent, which may change the last digits. Memory is that of a chunk; of an NPZ file, and of an
    MDF file with ``raster_s``, that of the columns as well.

    Args:
        scene: a scene file with ``[angles]``, and ``curves`` into a Parquet file.
        into: folder for the curves.
        radians: whether angles are written in radians.
        units: in which columns are written; by default those of the scene.
        rows: largest number of rows at a time.
        progress: called after each chunk with the number of rows done and of all rows.

    Raises:
        ImportError: pyarrow is missing.
        OSError: the scene cannot be read or the curves not be written.
        ValueError: as for ``Scene.load``; keys of the scene that need all samples at once.
    """
    with closing(Scene.parts(scene, rows)) as parts:
        first, total = next(parts)
        assert first.curves_file
        path = Path(into) / first.curves_file
        if first.recording and path.exists() and path.samefile(first.recording):
            raise ValueError(
                f"{path} is the recording that the scene reads; it would be overwritten"
            )

        missing, way = 0, Way()
        ends: list[float] = []
        signals: tuple[Signal, ...] = ()

        def pieces() -> Iterable[tuple[Mapping[str, NDArray[Any]], int]]:
            yield curves(first), total
            for part, _ in parts:
                yield curves(part), total

        def curves(part: Scene) -> Mapping[str, NDArray[Any]]:
            nonlocal missing, signals
            missing += part.missing
            signals = joined(signals, part.signals)
            known = part.without_missing().drive_angle_deg
            way.add(known)
            if known.size:
                ends[:] = [*(ends or known[:1].tolist())[:1], float(known[-1])]
            part = replace(part, units=units or part.units)
            return columns(SceneResult(part, part.evaluate()), radians=radians)

        written = write_pieces(path, pieces(), progress)
        # A recording without any number is refused.
        way_of = ((ends[0], ends[1]), way.turns, signals, way.extent)
        return Streamed(path, written, missing, *way_of, units or first.units)
