"""Scenes with recorded angles of any length, in chunks and bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from cardan.app.files.tables import ROWS, write_pieces
from cardan.app.files.whole_file import Progress
from cardan.app.scene.recording.signals import Signal, Way, joined
from cardan.app.scene.scene import Scene, SceneResult
from cardan.app.scene.study.curves import columns


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


def stream(
    scene: str | PathLike[str],
    into: str | PathLike[str] = ".",
    *,
    radians: bool = False,
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
            return columns(SceneResult(part, part.evaluate()), radians=radians)

        written = write_pieces(path, pieces(), progress)
        # A recording without any number is refused.
        return Streamed(path, written, missing, (ends[0], ends[1]), way.turns, signals, way.extent)
