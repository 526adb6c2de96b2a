"""Studies on a dask cluster: a folder of Parquet files, one for each part of the grid.

dask decides which worker does what, what happens if a worker dies, and what stays in memory. Files
are written completely or not at all, so a run that was stopped resumes with the missing files.
"""

from __future__ import annotations

import contextlib
import errno
import functools
import hashlib
import json
import math
import os
from collections.abc import Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from cardan._core import __version__
from cardan.app.files.columns import write_columns
from cardan.app.files.whole_file import Progress, whole_file
from cardan.app.scene.language.units import System, converted
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.curves import study_columns
from cardan.app.scene.study.study import Column, Study
from cardan.arrays import FloatArray, import_optional
from cardan.evaluation.sweep import Sweep

MANIFEST = "_study.json"
"""File of the folder that says which study it holds; Parquet readers pass over it."""

# A part should be worth a task and a file, and cheap to lose: a few tenths of a second.
_SAMPLES = 1 << 26
_MOST_ROWS = 1 << 16


@dataclass(frozen=True)
class Written:
    """A folder that was written: its drivelines, its files, and how many were complete before."""

    folder: Path
    rows: int
    files: int
    found: int


@dataclass(frozen=True, eq=False)
class StudyFolder:
    """A study in the files of a folder, of which a column is read at a time."""

    study: Study
    folder: Path
    units: System = "si"

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Axes of the study."""
        return self.study.axes

    @functools.cached_property
    def columns(self) -> tuple[Column, ...]:
        """Columns of the figures."""
        return self.study.part(range(1)).columns

    def figure(self, column: Column, *, radians: bool) -> tuple[str, FloatArray]:
        """Return the ending of a column's SI unit and its values, angles as the files have them."""
        parquet = import_optional("pyarrow.parquet", "table")
        ending, _ = converted(np.empty(0), column.unit, radians)
        written, one = converted(np.ones(1), column.unit, radians, self.units)
        # Of an angle both are in degrees.
        size = 1.0 if written == ending else 1.0 / float(one[0])
        name = f"{column.name}{written}"
        parts = [
            parquet.read_table(file, columns=[name], partitioning=None)[name].to_numpy()
            for file in sorted(self.folder.glob("part-*.parquet"))
        ]
        return ending, size * np.concatenate(parts).reshape(self.study.shape)


@contextlib.contextmanager
def connect(scheduler: str | None = None, processes: int | None = None) -> Iterator[Any]:
    """Connect to a dask cluster at an address, or start one of processes until the end."""
    distributed = import_optional("distributed", "dask")
    with contextlib.ExitStack() as stack:
        cluster: Any = scheduler
        if scheduler is None:
            # Any port for its status pages, so that several runs do not want the same.
            cluster = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=processes, threads_per_worker=1, dashboard_address="127.0.0.1:0"
                )
            )
        try:
            if scheduler is not None:
                # A client of an address without meaning keeps its process from ending for a minute.
                distributed.comm.resolve_address(scheduler)
            client = distributed.Client(cluster, set_as_default=False)
        except (OSError, ValueError) as error:
            raise OSError(errno.ECONNREFUSED, "no dask scheduler answers", scheduler) from error
        stack.enter_context(client)
        # The default for this thread and as long as it lasts, however the cluster ends.
        stack.enter_context(client.as_current())
        stack.enter_context(
            import_optional("dask", "dask").config.set(scheduler="dask.distributed")
        )
        yield client


def write_study(
    study: Study,
    folder: str | PathLike[str],
    client: Any,  # noqa: ANN401 - distributed.Client
    *,
    radians: bool = False,
    units: System = "si",
    part_rows: int | None = None,
    progress: Progress | None = None,
) -> Written:
    """Evaluate a study on a cluster into a folder of Parquet files; complete files are kept.

    Together the files contain the rows and columns that ``scene.curves.write_study`` writes, with
    the same bits on machines of the same kind. ``pyarrow.parquet.read_table(folder)`` reads them.
    Every worker must see the folder under the same name. A file has a few tenths of a second of
    work, or so many rows; a folder that was started with another number keeps that number.

    Raises OSError also where dask gave up, because a part ended one worker after another or the
    scheduler is gone, and ValueError for a folder that holds another study or none.
    """
    import_optional("pyarrow", "table")
    distributed = import_optional("distributed", "dask")
    folder = Path(folder).absolute()
    rows = math.prod(study.shape)
    planes = study.planes * len(study.reductions)
    many = min(_MOST_ROWS, max(1, _SAMPLES // max(1, planes * len(study.angle))))
    manifest = _open_manifest(folder, _fingerprint(study, radians, units), part_rows or many)
    step = manifest["part_rows"]
    parts = [range(rows)[i : i + step] for i in range(0, rows, step)]
    missing = [number for number in range(len(parts)) if not _file(folder, number).exists()]
    written = Written(folder, rows, len(parts), len(parts) - len(missing))
    done = rows - sum(len(parts[number]) for number in missing)
    # A part that another client of the scheduler is at has the same key and is waited for.
    token = hashlib.sha256(f"{folder}{json.dumps(manifest)}".encode()).hexdigest()[:16]
    # As the result of a task and not as data that dask only keeps: it outlives its worker.
    study = replace(study, options={**study.options, "workers": 1})
    held = client.submit(_itself, study, key=f"study-{token}")
    futures = client.map(
        _write_part,
        [_file(folder, number) for number in missing],
        [parts[number] for number in missing],
        key=[f"part-{token}-{number}" for number in missing],
        study=held,
        radians=radians,
        units=units,
    )
    try:
        for _, size in distributed.as_completed(futures, with_results=True):
            if isinstance(size, CancelledError):  # handed out like a result
                raise size
            done += size
            if progress:
                progress(done, rows)
    except (distributed.KilledWorker, CancelledError) as error:
        raise OSError(errno.EIO, f"dask gave up: {error}", os.fspath(folder)) from error
    finally:
        client.cancel(futures)
    for number in missing:
        if not _file(folder, number).exists():
            reason = "a worker wrote it elsewhere; all must see the same folder"
            raise OSError(errno.ENOENT, reason, os.fspath(_file(folder, number)))
    for left_behind in folder.glob(".*.part"):
        left_behind.unlink(missing_ok=True)
    return written


def _write_part(path: Path, rows: range, study: Study, radians: bool, units: System) -> int:
    # There already if a worker died between writing it and saying so.
    if not path.exists():
        write_columns(path, study_columns(study.part(rows), radians=radians, units=units))
    return len(rows)


def _itself(study: Study) -> Study:
    return study


def _file(folder: Path, number: int) -> Path:
    return folder / f"part-{number:06}.parquet"


def _open_manifest(folder: Path, fingerprint: dict[str, Any], part_rows: int) -> dict[str, Any]:
    """The manifest of a folder, which is made if it is not there."""
    path = folder / MANIFEST
    folder.mkdir(exist_ok=True)
    if not path.exists():
        if any(not name.startswith(".") for name in os.listdir(folder)):
            raise ValueError(f"{folder} contains other files; a study needs a separate folder")
        with whole_file(path) as file:
            file.write(
                json.dumps({"study": fingerprint, "part_rows": part_rows}, indent=1).encode()
            )
    try:
        manifest: dict[str, Any] = json.loads(path.read_bytes())
        differ = [key for key in fingerprint if manifest["study"].get(key) != fingerprint[key]]
    except (ValueError, LookupError, TypeError, AttributeError):
        raise ValueError(f"{path} does not say to which study the folder belongs") from None
    if differ:
        raise ValueError(
            f"{folder} holds another study, of other {', '.join(differ)}; "
            "remove it or give the table another name"
        )
    return manifest


def _fingerprint(study: Study, radians: bool, units: System = "si") -> dict[str, Any]:
    """All that the figures depend on, as plain data; long arrays by their hash."""

    def plain(value: object) -> object:
        if isinstance(value, np.ndarray) and value.size > 64:
            return hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
        return repr(value) if isinstance(value, Sweep) else np.asarray(value).tolist()

    fingerprint = {
        "axes": {axis.key: axis.values for axis in study.axes},
        "turns": {axis.key: axis.rotation for axis in study.axes if axis.rotation} or None,
        "driveline": study.layout.driveline,
        # A key that a folder lacks counts as null.
        "bearings": study.layout.mounting.given or None,
        "lengths": study.layout.mounting.lengths,
        "load": study.layout.load,
        "drive angles": study.angle,
        "quantities": study.quantities,
        "reductions": study.reductions,
        "closed forms": study.closed_forms,
        "shafts": study.shafts,
        "joints": study.joints,
        "options": {key: value for key, value in study.options.items() if key != "workers"},
        "angle unit": "rad" if radians else "deg",
        "units": None if units == "si" else units,
        "version": __version__,
    }
    as_read: dict[str, Any] = json.loads(json.dumps(fingerprint, default=plain))
    return as_read
